//! The rows of a section's closure equations with its inputs locked, and their units.
//!
//! Rows of a planar, a cylindrical or a translational section give velocities, in units of the
//! characteristic length. Rows of a spherical section give angular velocities. Columns have units of their
//! own, so that every entry, and a determinant too, is dimensionless.

use super::section::Differential;
use crate::chain::Chain;
use crate::group::{
    IntersectionMotion, LocalTwist, SubspaceKind, angular_and_linear, linear, quarter,
};
use crate::manipulator::{CompiledLeg, CompiledSection, Section};
use nalgebra::DMatrix;

/// A link shorter than this share of the characteristic length is not used as a unit of length.
const SHORT: f64 = 1e-6;

/// Which joints of a leg's section are its inputs, which are held when the section is locked: the actuated
/// joints, those that are always locked, and the imaginary joint if the section takes it as an input.
pub(super) fn inputs(leg: &CompiledLeg, section: Section) -> [bool; 3] {
    let compiled = leg.section(section);
    let mut inputs = [0, 1, 2].map(|joint| compiled.is_held(joint));
    if let Some(joint) = leg.imaginary_joint() {
        inputs[joint] |= match (leg.split_section, section) {
            (Section::Upper, Section::Upper) => true,
            (Section::Lower, Section::Lower) => leg.passes_on(),
            (Section::Upper, Section::Lower) | (Section::Lower, Section::Upper) => false,
        };
    }
    inputs
}

/// The constraints of a section's locked inputs, and their number: screws that are reciprocal to the
/// section's passive joints, as many as there are inputs. They give velocities, or angular velocities in a
/// spherical section.
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
            let [a, b] = constraints_of_passive(kind, &moved[first(false)], length);
            (rows[0], rows[1]) = (a, b);
        }
        _ => {
            let angular = match kind {
                SubspaceKind::Planar => length,
                SubspaceKind::Identity
                | SubspaceKind::Spherical
                | SubspaceKind::Cylindrical
                | SubspaceKind::TranslationalPlane
                | SubspaceKind::TranslationalSpace => 1.0,
            };
            rows = [LocalTwist::x() * angular, LocalTwist::y(), LocalTwist::z()];
        }
    }
    (rows, count)
}

/// The unit of the cross product of the two screws other than that of `input`. Divided by it, the product
/// gives a velocity, or an angular velocity in a spherical section.
fn cross_unit(kind: SubspaceKind, section: &CompiledSection, input: usize, length: f64) -> f64 {
    let [a, b] = [section.screws[(input + 1) % 3], section.screws[(input + 2) % 3]];
    let rotates = |screw: &LocalTwist| screw.x != 0.0;
    match kind {
        SubspaceKind::Identity
        | SubspaceKind::Spherical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => 1.0,
        // One of the two screws is padding. If the other one is a slider, the locked input constrains the
        // angle.
        SubspaceKind::Cylindrical => {
            let screw = if input == 0 { a } else { b };
            if rotates(&screw) { 1.0 } else { 1.0 / length }
        }
        SubspaceKind::Planar => match (rotates(&a), rotates(&b)) {
            (true, true) => {
                let link = (quarter(linear(&b)) * b.x - quarter(linear(&a)) * a.x).norm();
                // Two joints that follow each other are at the ends of one link.
                if input != 1 && link > SHORT * length { link } else { length }
            }
            (false, false) => 1.0 / length,
            _ => 1.0,
        },
    }
}

/// Two screws that are reciprocal to the one passive joint of a section, and whose cross product is the
/// screw of that joint.
fn constraints_of_passive(
    kind: SubspaceKind,
    passive: &LocalTwist,
    length: f64,
) -> [LocalTwist; 2] {
    match kind {
        // They give the velocity of the point on the joint's axis.
        SubspaceKind::Planar if passive.x != 0.0 => {
            let p = quarter(linear(passive)) * passive.x;
            let [a, b] = [LocalTwist::new(-p.im, 1.0, 0.0), LocalTwist::new(p.re, 0.0, 1.0)];
            if passive.x > 0.0 { [a, b] } else { [b, a] }
        }
        SubspaceKind::Planar => {
            [angular_and_linear(0.0, quarter(linear(passive))), LocalTwist::x() * length]
        }
        SubspaceKind::Spherical | SubspaceKind::TranslationalSpace => {
            let other = if passive.x.abs() > 0.9 { LocalTwist::y() } else { LocalTwist::x() };
            let first = passive.cross(&other).normalize();
            [first, passive.cross(&first)]
        }
        SubspaceKind::Cylindrical => [LocalTwist::x() * length, LocalTwist::y()],
        SubspaceKind::Identity | SubspaceKind::TranslationalPlane => {
            [LocalTwist::x(), LocalTwist::y()]
        }
    }
}

/// The unit of a rate along the intersection motion: one radian or the characteristic length. If that motion swings the last link
/// of a planar section, from the leg's last pivot to the axis, it is the angle by which the end of that link
/// moves one characteristic length.
pub(super) fn along_unit(leg: &CompiledLeg, motion: IntersectionMotion, length: f64) -> f64 {
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
            Chain::Rigid
            | Chain::Part(_)
            | Chain::Spherical(_)
            | Chain::Ball(_)
            | Chain::Cylindrical(_)
            | Chain::Translational(_)
            | Chain::Spatial(_),
            Section::Lower | Section::Upper,
        ) => 1.0,
    }
}

/// The unit of a row: the characteristic length for a velocity, one radian for an angular velocity.
pub(super) fn row_unit(kind: SubspaceKind, length: f64) -> f64 {
    match kind {
        SubspaceKind::Identity | SubspaceKind::Spherical => 1.0,
        SubspaceKind::Planar
        | SubspaceKind::Cylindrical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => length,
    }
}

/// The unit of a component of a twist, divided by the unit of its row.
pub(super) fn twist_unit(kind: SubspaceKind, twist: &LocalTwist, length: f64) -> f64 {
    match kind {
        SubspaceKind::Planar | SubspaceKind::Cylindrical => {
            if twist.x != 0.0 {
                1.0 / length
            } else {
                1.0
            }
        }
        SubspaceKind::Identity
        | SubspaceKind::Spherical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => 1.0,
    }
}

/// The determinant of a block of a matrix, which is given by its ranges of rows and columns. It is the volume
/// of the columns if there are more rows than columns, and `None` if there are fewer.
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

/// The determinant of the first `n` rows and columns, by elimination with row pivoting, in place.
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
