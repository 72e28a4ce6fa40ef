//! The rows of a section's closure with its inputs locked, and what they are measured in.
//!
//! Rows in a plane, on an axis and in a translational plane give velocities, in units of the characteristic
//! length; in a sphere angular velocities. Columns have units of their own, so that every entry is a
//! number, and a determinant too.

use super::section::Differential;
use crate::chain::Chain;
use crate::group::{
    IntersectionMotion, LocalTwist, SubspaceKind, angular_and_linear, linear, quarter,
};
use crate::manipulator::{CompiledLeg, CompiledSection, Section};
use nalgebra::DMatrix;

/// Shorter than this share of the mechanism, a link is too short to measure by.
const SHORT: f64 = 1e-6;

/// Which joints of a leg's section are inputs, that is held when it is locked: those that are actuated,
/// and the cut where it is solved from there.
pub(super) fn inputs(leg: &CompiledLeg, section: Section) -> [bool; 3] {
    let compiled = leg.section(section);
    let mut inputs =
        compiled.coordinates.map(|slot| slot.is_some_and(|slot| slot.actuated.is_some()));
    match (leg.split_section, section) {
        (Section::Upper, Section::Upper) => inputs[0] = true,
        (Section::Lower, Section::Lower) if leg.upper.driven => {
            inputs[compiled.chain.freedoms() - 1] = true;
        }
        _ => {}
    }
    inputs
}

/// What a section's locked inputs hold: screws reciprocal to its passive joints, as many as there are
/// inputs. In a plane and on an axis they give a velocity, in a sphere an angular velocity.
pub(super) fn section_rows(
    leg: &CompiledLeg,
    section: Section,
    differential: &Differential,
    length: f64,
) -> ([LocalTwist; 3], usize) {
    let compiled = leg.section(section);
    let inputs = inputs(leg, section);
    let kind = differential.screws.kind;
    let moved = &differential.screws.moved;
    let mut rows = [LocalTwist::zeros(); 3];
    let count = inputs.iter().filter(|input| **input).count();
    let first = |wanted: bool| inputs.iter().position(|input| *input == wanted).unwrap_or_default();
    match count {
        0 => {}
        1 => {
            let input = first(true);
            let unit = cross_unit(kind, compiled, input, length);
            rows[0] = differential.crosses[input] / unit;
        }
        2 => {
            let [a, b] = square_to(kind, &moved[first(false)], length);
            (rows[0], rows[1]) = (a, b);
        }
        _ => {
            let turn = match kind {
                SubspaceKind::Planar => length,
                SubspaceKind::Spherical
                | SubspaceKind::Cylindrical
                | SubspaceKind::TranslationalPlane => 1.0,
            };
            rows = [LocalTwist::x() * turn, LocalTwist::y(), LocalTwist::z()];
        }
    }
    (rows, count)
}

/// What the cross product of the two screws beside `input` is measured in, so that it gives a
/// velocity, or an angular velocity in a sphere.
fn cross_unit(kind: SubspaceKind, section: &CompiledSection, input: usize, length: f64) -> f64 {
    let [a, b] = [section.screws[(input + 1) % 3], section.screws[(input + 2) % 3]];
    let turns = |screw: &LocalTwist| screw.x != 0.0;
    match kind {
        SubspaceKind::Spherical | SubspaceKind::TranslationalPlane => 1.0,
        // One of them only makes up the number: a slider holds an angle.
        SubspaceKind::Cylindrical => {
            let screw = if input == 0 { a } else { b };
            if turns(&screw) { 1.0 } else { 1.0 / length }
        }
        SubspaceKind::Planar => match (turns(&a), turns(&b)) {
            (true, true) => {
                let link = (quarter(linear(&b)) * b.x - quarter(linear(&a)) * a.x).norm();
                // Neighbours are on one link.
                if input != 1 && link > SHORT * length { link } else { length }
            }
            (false, false) => 1.0 / length,
            _ => 1.0,
        },
    }
}

/// Two screws that one passive joint is reciprocal to, whose cross product is its screw.
fn square_to(kind: SubspaceKind, passive: &LocalTwist, length: f64) -> [LocalTwist; 2] {
    match kind {
        // The velocity of its point.
        SubspaceKind::Planar if passive.x != 0.0 => {
            let at = quarter(linear(passive)) * passive.x;
            let [a, b] = [LocalTwist::new(-at.im, 1.0, 0.0), LocalTwist::new(at.re, 0.0, 1.0)];
            if passive.x > 0.0 { [a, b] } else { [b, a] }
        }
        SubspaceKind::Planar => {
            [angular_and_linear(0.0, quarter(linear(passive))), LocalTwist::x() * length]
        }
        SubspaceKind::Spherical => {
            let other = if passive.x.abs() > 0.9 { LocalTwist::y() } else { LocalTwist::x() };
            let first = passive.cross(&other).normalize();
            [first, passive.cross(&first)]
        }
        SubspaceKind::Cylindrical => [LocalTwist::x() * length, LocalTwist::y()],
        SubspaceKind::TranslationalPlane => [LocalTwist::x(), LocalTwist::y()],
    }
}

/// What a rate along the cut is measured in: radians or the characteristic length; where it swings
/// the last link of a planar section, from the leg's last pivot to the axis, what that link makes of
/// it.
pub(super) fn cut_unit(leg: &CompiledLeg, motion: IntersectionMotion, length: f64) -> f64 {
    if !motion.is_rotation() {
        return length;
    }
    match (&leg.lower.chain, leg.split_section) {
        (Chain::Planar(_), Section::Upper) => {
            let last = leg.lower.screws[2];
            let link = linear(&last).norm();
            if last.x != 0.0 && link > SHORT * length { length / link } else { 1.0 }
        }
        (Chain::Planar(_), Section::Lower)
        | (
            Chain::Spherical(_) | Chain::Ball(_) | Chain::Cylindrical(_) | Chain::Translational(_),
            Section::Lower | Section::Upper,
        ) => 1.0,
    }
}

/// What a row is measured in: a velocity in the characteristic length, an angular one in radians.
pub(super) fn row_unit(kind: SubspaceKind, length: f64) -> f64 {
    match kind {
        SubspaceKind::Spherical => 1.0,
        SubspaceKind::Planar | SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => {
            length
        }
    }
}

/// What a component of a twist is measured in, over its row's unit.
pub(super) fn twist_unit(kind: SubspaceKind, twist: &LocalTwist, length: f64) -> f64 {
    match kind {
        SubspaceKind::Planar | SubspaceKind::Cylindrical => {
            if twist.x != 0.0 {
                1.0 / length
            } else {
                1.0
            }
        }
        SubspaceKind::Spherical | SubspaceKind::TranslationalPlane => 1.0,
    }
}

/// The determinant of a block; the volume of its columns where it has more rows than columns; `None`
/// where it has fewer.
pub(super) fn volume(
    matrix: &DMatrix<f64>,
    [top, bottom]: [usize; 2],
    [left, right]: [usize; 2],
    work: &mut DMatrix<f64>,
) -> Option<f64> {
    let (rows, n) = (bottom - top, right - left);
    let entry = |i: usize, j: usize| matrix[(top + i, left + j)];
    if rows < n {
        return None;
    }
    let square = rows == n;
    for i in 0..n {
        for j in 0..n {
            work[(i, j)] = if square {
                entry(i, j)
            } else {
                (0..rows).map(|k| entry(k, i) * entry(k, j)).sum()
            };
        }
    }
    let determinant = determinant(work, n);
    Some(if square { determinant } else { determinant.max(0.0).sqrt() })
}

/// By elimination with row pivoting, in place.
fn determinant(m: &mut DMatrix<f64>, n: usize) -> f64 {
    let mut product = 1.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[(i, k)].abs().total_cmp(&m[(j, k)].abs()));
        let pivot = pivot.unwrap_or(k);
        if m[(pivot, k)] == 0.0 {
            return 0.0;
        }
        if pivot != k {
            m.swap_rows(pivot, k);
            product = -product;
        }
        product *= m[(k, k)];
        for i in k + 1..n {
            let factor = m[(i, k)] / m[(k, k)];
            for j in k + 1..n {
                m[(i, j)] -= factor * m[(k, j)];
            }
        }
    }
    product
}
