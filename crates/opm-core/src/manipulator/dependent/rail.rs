//! Legs of a slider, a ball, and a slider or a hinge: the ball slides on a line.
//!
//! A ball between two sliders (PSP) makes a line of the platform meet one of the base: with the directions `d` and `e` and the
//! ball at `c`, `(d × R e) · (c − P − R c) = 0`, a [row](super::rows).
//!
//! With a slider and a hinge (PSR, the last leg of a 2PUR-PSR) the ball at `c + s d` of the base is on the circle of the platform
//! about `o` with the axis `m` and the radius `ρ`. With `w = c + s d − P − R o`, that is `R m · w = 0`, a row with one unknown more,
//! and `|w| = ρ`. The rows are linear in the positions and in `s`, so `w` is linear in `s`, and the length is a quadratic
//! equation. The unknown is not eliminated: at home `R m · d = 0`, and both of its values are at one pose.
//! A hinge at the base and a slider at the platform are the same with base and platform exchanged.

use super::rows::{HOLDS, LEVEL, Row};
use crate::chain::ReachDeficit;
use crate::group::screw::Screw;
use crate::mechanism::leg::Leg;
use nalgebra::{Matrix3, Point3, Vector3, Vector6};

/// The ball of a leg with one joint before it and one behind it.
pub(super) struct Ball {
    leg: usize,
    /// From the platform's reference point, over the size.
    point: Vector3<f64>,
    /// The joints at the base and at the platform, with axes through that point.
    ends: [End; 2],
}

/// A joint beside a ball, with a unit vector.
#[derive(Clone, Copy)]
enum End {
    Slider(Vector3<f64>),
    /// The axis, and the point on it that is nearest to the ball.
    Hinge(Vector3<f64>, Vector3<f64>),
}

impl Ball {
    /// That of a leg of five joints; the ball may be three axes through a point.
    pub fn new(leg: &Leg, number: usize, reference: &Point3<f64>, size: f64) -> Option<Self> {
        let screws = leg.screws();
        let [first, ball @ .., last] = &screws[..] else { return None };
        let turns = |screw: &Screw| {
            let turn = screw.angular.norm();
            turn > LEVEL && screw.angular.dot(&screw.linear).abs() <= HOLDS * size * turn
        };
        if ball.len() != 3 || !ball.iter().all(turns) {
            return None;
        }
        // A point `x` of an axis has `x × ω = v`.
        let squares = ball.iter().fold(Matrix3::zeros(), |sum, screw| {
            let cross = screw.angular.cross_matrix();
            sum - cross * cross
        });
        let moments = ball.iter().map(|screw| screw.angular.cross(&screw.linear));
        let point = squares.try_inverse()? * moments.sum::<Vector3<f64>>();
        let misses = |screw: &Screw| (point.cross(&screw.angular) - screw.linear).norm();
        let axes = Matrix3::from_fn(|i, j| ball[j].angular[i]);
        if axes.determinant().abs() < LEVEL || ball.iter().any(|s| misses(s) > HOLDS * size) {
            return None;
        }
        let from = |point: Vector3<f64>| (point - reference.coords) / size;
        let end = |screw: &Screw| {
            if screw.angular == Vector3::zeros() {
                return Some(End::Slider(screw.linear.normalize()));
            }
            let axis = screw.angular.normalize();
            let on_axis = screw.angular.cross(&screw.linear) / screw.angular.norm_squared();
            let nearest = on_axis + axis * axis.dot(&(point - on_axis));
            turns(screw).then(|| End::Hinge(axis, from(nearest)))
        };
        Some(Self { leg: number, point: from(point), ends: [end(first)?, end(last)?] })
    }

    /// The equation that a line of the platform meets one of the base, between two sliders that are not parallel at home.
    pub fn lines(&self) -> Option<Row> {
        let [End::Slider(base), End::Slider(own)] = self.ends else { return None };
        let turn =
            self.point.cross(&base) * own.transpose() - base * own.cross(&self.point).transpose();
        let row = Row {
            leg: self.leg,
            carried: true,
            across: Some(base),
            direction: -own,
            turn,
            constant: 0.0,
            at_home: Vector6::zeros(),
        };
        (base.cross(&own).norm() > LEVEL).then(|| row.normalized())
    }

    /// How the ball slides on a line, and stays on a circle.
    pub fn rail(&self) -> Option<Rail> {
        let (at_base, along, axis, centre) = match self.ends {
            [End::Slider(along), End::Hinge(axis, centre)] => (true, along, axis, centre),
            [End::Hinge(axis, centre), End::Slider(along)] => (false, along, axis, centre),
            _ => return None,
        };
        let (leg, ball, unit) = (self.leg, self.point, 1.0);
        let radius = (ball - centre).norm();
        let mut found = Rail { leg, at_base, ball, along, axis, centre, radius, unit };
        found.unit = found.wrench_at_home().norm();
        (radius > LEVEL && found.unit > LEVEL).then_some(found)
    }
}

/// How a ball moves; lengths over the size, points from the platform's reference point, all at home.
#[derive(Clone, Debug)]
pub(super) struct Rail {
    /// The number of the leg.
    pub leg: usize,
    /// Whether the slider is at the base, and not at the platform.
    at_base: bool,
    /// The ball, and the direction in which it slides.
    ball: Vector3<f64>,
    along: Vector3<f64>,
    /// The axis of the circle, a unit vector, its centre and its radius.
    axis: Vector3<f64>,
    centre: Vector3<f64>,
    radius: f64,
    /// The length of the row's wrench at home, by which the row is divided.
    unit: f64,
}

/// Where a ball is, from the circle's centre: it is linear in what it slides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliding {
    pub start: Vector3<f64>,
    pub by: Vector3<f64>,
}

impl Rail {
    /// The wrench by which the leg holds the platform at home: along the ball's way, and along the circle, it does no work.
    fn wrench_at_home(&self) -> Vector6<f64> {
        let away = self.ball - self.centre;
        let force = self.axis * away.dot(&self.along) - away * self.axis.dot(&self.along);
        let moment = self.ball.cross(&force);
        Vector6::new(moment.x, moment.y, moment.z, force.x, force.y, force.z)
    }

    /// The number of the slider among the leg's freedoms, from base to platform.
    pub fn freedom(&self) -> usize {
        if self.at_base { 0 } else { 4 }
    }

    /// The equation that the ball is in the plane of the circle, where it does not slide.
    pub fn row(&self) -> Row {
        // Both are `m · (R⁻¹ (c − P) − o)`, or with base and platform exchanged.
        let (direction, turn): (Vector3<f64>, Matrix3<f64>) = match self.at_base {
            true => (-self.axis, self.ball * self.axis.transpose()),
            false => (self.axis, self.axis * self.ball.transpose()),
        };
        let constant = -self.axis.dot(&self.centre);
        let at_home = self.wrench_at_home() / self.unit;
        let (direction, turn, constant) =
            (direction / self.unit, turn / self.unit, constant / self.unit);
        let (leg, carried) = (self.leg, self.at_base);
        Row { leg, carried, across: None, direction, turn, constant, at_home }
    }

    /// By how much the equation changes as the ball slides.
    pub fn by_slider(&self, r: &Matrix3<f64>) -> f64 {
        let along = match self.at_base {
            true => (r * self.axis).dot(&self.along),
            false => self.axis.dot(&(r * self.along)),
        };
        along / self.unit
    }

    /// Where the ball is from the circle's centre, as base axes say, at an orientation and with positions that change by `by` as the
    /// ball slides.
    pub fn sliding(&self, r: &Matrix3<f64>, p: &Vector3<f64>, by: &Vector3<f64>) -> Sliding {
        match self.at_base {
            true => Sliding { start: self.ball - p - r * self.centre, by: self.along - by },
            false => Sliding { start: p + r * self.ball - self.centre, by: r * self.along + by },
        }
    }

    /// What the ball has slid where it is on the circle, and by how much it does not reach it otherwise. `sign` is that
    /// of the slope of the ball's distance from the circle's centre.
    ///
    /// # Errors
    /// The distance that is missing, over the size.
    pub fn slide(&self, Sliding { start, by }: Sliding, sign: f64) -> Result<f64, ReachDeficit> {
        let (square, half) = (by.norm_squared(), start.dot(&by));
        if square < LEVEL * LEVEL {
            return Err(ReachDeficit::length(f64::INFINITY));
        }
        let nearest = (start - by * (half / square)).norm();
        let left = (self.radius - nearest) * (self.radius + nearest);
        if left < 0.0 {
            return Err(ReachDeficit::length(nearest - self.radius));
        }
        Ok((sign * (left * square).sqrt() - half) / square)
    }

    /// By how much a pose misses the equation of the plane, at that place of the ball on the circle that misses least.
    pub fn miss(&self, row: &Row, r: &Matrix3<f64>, p: &Vector3<f64>) -> f64 {
        let sliding = self.sliding(r, p, &Vector3::zeros());
        let miss = |sign: f64| {
            let slid = self.slide(sliding, sign).ok()?;
            Some((row.value(r, p) + slid * self.by_slider(r)).abs())
        };
        [1.0, -1.0].into_iter().filter_map(miss).fold(f64::INFINITY, f64::min)
    }

    /// Whether the leg, in a mode that has it slide by `slid`, slides there where the constraint has it, `wanted`, and not to the
    /// other place from which the ball reaches the circle at a pose.
    pub fn agrees(&self, sliding: Sliding, [slid, wanted]: [f64; 2]) -> bool {
        // The places are equally far from that where the ball is nearest.
        let middle = -sliding.start.dot(&sliding.by) / sliding.by.norm_squared();
        (slid - middle) * (wanted - middle) >= 0.0
    }
}
