//! Where points of the bodies are over a box of poses: linear functions of the pose, with certain bounds of their errors.
//!
//! The displacements of the joints over the box ([`super::chain`]) and those of the sections ([`target`]) move the points.
//! A link of the lower section is moved by the joints before it, or by the displacement of the whole section and the
//! inverse of those behind it, whichever are fewer; one of the upper section from the platform likewise.

use super::target::{self, Coordinate};
use super::{LegConditions, Side, Upper};
use crate::boxes::Affine;
use crate::boxes::{Enclosed, Target, dot};
use crate::enclosure::BoxQuery;
use crate::group::screw::Screw;
use crate::group::{CylindricalDisplacement, Subspace};
use crate::manipulator::{Choices, Manipulator, Mode};
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Section;
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;

/// A point of a body that moves, where it is at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPoint {
    /// The body.
    pub body: MovingBody,
    /// The point at home, in base coordinates, metres.
    pub home: Point3<f64>,
}

/// A body that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovingBody {
    /// The link behind some joints of a leg.
    Link {
        /// The number of the leg.
        leg: usize,
        /// The number of joints before the link.
        joints: usize,
    },
    /// The platform.
    Platform,
}

impl MovingBody {
    /// The number of the leg that it is a link of.
    fn leg(self) -> Option<usize> {
        match self {
            Self::Link { leg, .. } => Some(leg),
            Self::Platform => None,
        }
    }
}

/// A point that some joint coordinates of a leg move, where it is at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriedPoint {
    /// The number of the leg.
    pub leg: usize,
    /// The number of joint coordinates of the leg that move the point: none for a point of the base, all for one of the
    /// platform.
    pub coordinates: usize,
    /// The point at home, in base coordinates, metres.
    pub home: Point3<f64>,
}

/// A point over a box, in base coordinates, metres.
pub type Place<const N: usize> = [Affine<N>; 3];

/// A point at home.
fn at_home<const N: usize>(point: &Point3<f64>) -> Place<N> {
    [point.x, point.y, point.z].map(Affine::constant)
}

/// The place, if anything is known of it: an unbounded error may have become NaN.
fn known<const N: usize>(place: Place<N>) -> Option<Place<N>> {
    place.iter().all(|x| x.radius().is_finite()).then_some(place)
}

impl Manipulator {
    /// Whether [`Manipulator::places_over`] knows anything of this mechanism. It does not where coordinates of the pose
    /// depend on each other, nor where an inclined joint carries the height of a Schoenflies section.
    #[doc(hidden)]
    pub fn encloses_places(&self) -> bool {
        let whole = |section: Section, leg: usize| {
            let section = self.legs[leg].section(section);
            section.partial.is_none() && section.offset.is_none() && section.slider.is_none()
        };
        !self.is_whole()
            && self.dependent.is_none()
            && self.task().slope() == 0.0
            && (0..self.legs.len()).all(|leg| {
                self.legs[leg].lean.is_none()
                    && whole(Section::Lower, leg)
                    && whole(Section::Upper, leg)
            })
    }

    /// Where points of the bodies are at every pose of a box that one working mode reaches, as functions of the sides that have
    /// a width, in the order of these; `None` where nothing is known. The box has a side for every task coordinate; no
    /// coordinate is replaced by its cosine or sine, and at most two have a width.
    ///
    /// # Panics
    /// If the number of sides is another, or more than two of them have a width.
    #[doc(hidden)]
    pub fn places_over(
        &self,
        mode: Mode,
        sides: &[Side],
        points: &[BodyPoint],
        out: &mut Vec<Option<Place<2>>>,
    ) {
        out.clear();
        assert_eq!(sides.len(), self.task().coordinates.len(), "a side for every coordinate");
        if !self.encloses_places() {
            out.resize(points.len(), None);
            return;
        }
        let asked = |leg: usize| points.iter().any(|point| point.body.leg() == Some(leg));
        let places = Places::<2>::new(self, mode, sides, asked);
        out.extend(points.iter().map(|point| places.of(point)));
    }

    /// Where points of the links are at every pose of a box that one working mode reaches, as functions of the sides that have
    /// a width, in the order of these; `None` where nothing is known. The box is one as for [`Manipulator::places_over`], of
    /// which at most `N` sides have a width.
    ///
    /// # Panics
    /// If the number of sides is another, or more than `N` of them have a width.
    #[doc(hidden)]
    pub fn carried_over<const N: usize>(
        &self,
        mode: Mode,
        sides: &[Side],
        points: &[CarriedPoint],
    ) -> Vec<Option<Place<N>>> {
        assert_eq!(sides.len(), self.task().coordinates.len(), "a side for every coordinate");
        if !self.encloses_places() {
            return vec![None; points.len()];
        }
        let asked = |leg: usize| points.iter().any(|point| point.leg == leg);
        let places = Places::<N>::new(self, mode, sides, asked);
        let place = |point: &CarriedPoint| {
            known(places.behind(point.leg, point.coordinates, at_home(&point.home))?)
        };
        points.iter().map(place).collect()
    }
}

/// The displacements over a box.
struct Places<'a, const N: usize> {
    manipulator: &'a Manipulator,
    lower: Target<N>,
    upper: Target<N>,
    /// The height above home, metres.
    rise: Affine<N>,
    /// Those of the legs that have some of the points.
    legs: Vec<Option<LegPlaces<N>>>,
}

/// The displacements of a leg over a box.
struct LegPlaces<const N: usize> {
    /// What the lower section displaces.
    lower: Target<N>,
    /// The screw and the displacement of every coordinate of the leg, from base to platform. Those of a spherical joint
    /// are one rotation, which is `None`.
    coordinates: Vec<(Screw, Option<Enclosed<N>>)>,
    /// The number of coordinates of the lower section.
    split: usize,
    /// For each number of joints, the number of their coordinates.
    ends: Vec<usize>,
    /// Whether anything is known of it.
    known: bool,
}

impl<'a, const N: usize> Places<'a, N> {
    /// The displacements of those legs that are asked for.
    fn new(
        manipulator: &'a Manipulator,
        mode: Mode,
        sides: &[Side],
        asked: impl Fn(usize) -> bool,
    ) -> Self {
        let task = manipulator.task();
        let mut next = 0;
        let coordinates: Vec<_> = sides
            .iter()
            .map(|side| {
                let value = if side.half > 0.0 {
                    next += 1;
                    Affine::<N>::coordinate(side.middle, side.half, next - 1)
                } else {
                    Affine::constant(side.middle)
                };
                Coordinate::Linear(value)
            })
            .collect();
        let rise = manipulator.rise_over(BoxQuery::Whole, &coordinates);
        let rise = rise.unwrap_or(Affine::constant(0.0));
        let (lower, upper) = coordinates.split_at(task.lower_count);
        let (v, b) = (target::task::lower(task, lower), Upper::new(task, upper));
        let conditions = LegConditions { manipulator, choices: Choices::of(mode), rise };
        let mut first = 0;
        let legs = manipulator.mechanism().legs.iter().enumerate().map(|(number, own)| {
            let places = asked(number).then(|| LegPlaces::new(&conditions, number, first, &v, &b));
            first += own.coordinates().count();
            places
        });
        let legs = legs.collect();
        Self { manipulator, lower: v, upper: b.target, rise, legs }
    }

    fn of(&self, point: &BodyPoint) -> Option<Place<N>> {
        let place = at_home(&point.home);
        let place = match point.body {
            MovingBody::Platform => self.on_platform(place),
            MovingBody::Link { leg, joints } => self.on_link(leg, joints, place)?,
        };
        known(place)
    }

    fn on_platform(&self, point: Place<N>) -> Place<N> {
        let task = self.manipulator.task();
        let moved = apply(&task.upper, &self.upper, &point);
        let moved = self.raised(Section::Upper, moved);
        self.raised(Section::Lower, apply(&task.lower, &self.lower, &moved))
    }

    /// A point behind `joints` joints of a leg; `None` where nothing is known of it.
    fn on_link(&self, leg: usize, joints: usize, point: Place<N>) -> Option<Place<N>> {
        self.behind(leg, self.legs[leg].as_ref()?.ends[joints], point)
    }

    /// A point behind `at` joint coordinates of a leg; `None` where nothing is known of it.
    fn behind(&self, leg: usize, at: usize, point: Place<N>) -> Option<Place<N>> {
        let of = self.legs[leg].as_ref().filter(|of| of.known)?;
        let all = of.coordinates.len();
        let (start, end) = if at <= of.split { (0, of.split) } else { (of.split, all) };
        let inner = || of.outward(start..at, point);
        let outer = || {
            let point = of.inward(at..end, point)?;
            Some(if at <= of.split {
                self.behind_lower(of, point)
            } else {
                self.on_platform(point)
            })
        };
        let from_start = || {
            let point = inner()?;
            Some(if at <= of.split { point } else { self.behind_lower(of, point) })
        };
        // What is nearer is the better bound, unless there is a spherical joint between.
        if at - start < end - at {
            from_start().or_else(outer)
        } else {
            outer().or_else(from_start)
        }
    }

    /// A point that the lower section of a leg displaces.
    fn behind_lower(&self, leg: &LegPlaces<N>, point: Place<N>) -> Place<N> {
        let moved = apply(&self.manipulator.task().lower, &leg.lower, &point);
        self.raised(Section::Lower, moved)
    }

    /// A point, raised by the height if that belongs to this section.
    fn raised(&self, section: Section, point: Place<N>) -> Place<N> {
        match &self.manipulator.task().height {
            Some(height) if height.section == section => {
                let up = height.up;
                [0, 1, 2].map(|i| point[i] + self.rise * up[i])
            }
            _ => point,
        }
    }
}

impl<const N: usize> LegPlaces<N> {
    fn new(
        conditions: &LegConditions<'_, N>,
        number: usize,
        first: usize,
        v: &Target<N>,
        b: &Upper<N>,
    ) -> Self {
        let manipulator = conditions.manipulator;
        let task = manipulator.task();
        let leg = conditions.leg(number);
        let branch = |section| conditions.branches(number, section).next().unwrap_or_default();
        let solve = |section: Section, target: &Target<N>| {
            conditions.chain(number, section, target).displacements(branch(section))
        };
        let mut known = true;
        let (lower, [below, above]) = match leg.split_section {
            Section::Upper => {
                let above = solve(Section::Upper, b.of_chain(leg));
                let mut tau = b.step(leg, &above);
                if leg.unwinds() && !matches!(tau, Enclosed::Value(_)) {
                    // Where revolutions are counted, the displacement is within π of home.
                    let angle = tau.number();
                    let turns = (angle.centre / (2.0 * PI)).round();
                    let near = angle - 2.0 * PI * turns;
                    known = near.low() > -PI && near.high() < PI;
                    tau = Enclosed::Value(near);
                }
                let lower = task.lower_intersection.after(v, tau);
                (lower, [solve(Section::Lower, &lower), above])
            }
            Section::Lower => {
                let below = solve(Section::Lower, v);
                let joint = leg.imaginary_joint();
                let none = Enclosed::Value(Affine::constant(0.0));
                let step = joint.map_or(none, |joint| below[joint]);
                let above = task.upper_intersection.before(&b.target, step);
                // The last joint of the chain is the imaginary one: the links are displaced by `v` and its inverse.
                let lower = task.lower_intersection.after(v, step.inverse());
                (lower, [below, solve(Section::Upper, &above)])
            }
        };
        let joints = &manipulator.mechanism().legs[number].joints;
        let mut coordinates = Vec::new();
        let mut ends = vec![0];
        for joint in joints {
            coordinates.extend(joint.screws().into_iter().map(|screw| (screw, None)));
            ends.push(coordinates.len());
        }
        for (section, found) in [(&leg.lower, below), (&leg.upper, above)] {
            for (coordinate, displacement) in section.coordinates.iter().zip(found) {
                if let Some(coordinate) = coordinate {
                    coordinates[coordinate.number - first].1 = Some(displacement);
                }
            }
        }
        if let Some(lift) = &leg.lift {
            let displacement = conditions.rise * lift.rate;
            coordinates[lift.coordinate.number - first].1 = Some(Enclosed::Value(displacement));
        }
        for (joint, end) in joints.iter().zip(&ends[1..]) {
            if joint.kind == JointKind::Spherical {
                coordinates[end - 3..*end].iter_mut().for_each(|(_, found)| *found = None);
            }
        }
        // A rotation is a unit vector from here on: it moves many points.
        for (screw, found) in &mut coordinates {
            if screw.angular != Vector3::zeros() && screw.angular.dot(&screw.linear) == 0.0 {
                *found = found.map(|turn| Enclosed::UnitDirection(turn.unit_vector()));
            }
        }
        let split = manipulator.decomposition().legs[number].lower.len();
        Self { lower, coordinates, split, ends, known }
    }

    /// A point, displaced by some coordinates of the leg.
    fn outward(&self, range: std::ops::Range<usize>, point: Place<N>) -> Option<Place<N>> {
        self.coordinates[range].iter().rev().try_fold(point, |point, (screw, displacement)| {
            Some(displaced(screw, (*displacement)?, &point))
        })
    }

    /// A point, displaced by the inverse of some coordinates.
    fn inward(&self, range: std::ops::Range<usize>, point: Place<N>) -> Option<Place<N>> {
        self.coordinates[range].iter().try_fold(point, |point, (screw, displacement)| {
            Some(displaced(screw, (*displacement)?.inverse(), &point))
        })
    }
}

/// The point that a displacement along a screw moves a point to.
fn displaced<const N: usize>(
    screw: &Screw,
    displacement: Enclosed<N>,
    point: &Place<N>,
) -> Place<N> {
    let Screw { angular, linear } = *screw;
    if angular == Vector3::zeros() {
        let by = displacement.number();
        return [0, 1, 2].map(|i| point[i] + by * linear[i]);
    }
    // The axis has unit length, and passes through this point.
    let foot = angular.cross(&linear);
    let pitch = angular.dot(&linear);
    let arm: Place<N> = [0, 1, 2].map(|i| point[i] - foot[i]);
    let along = dot(&angular, &arm);
    let across: Place<N> = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        arm[k] * angular[j] - arm[j] * angular[k]
    });
    let e = displacement.unit_vector();
    let rotated: Place<N> = [0, 1, 2].map(|i| {
        let fixed = along * angular[i];
        Affine::products([[&(arm[i] - fixed), &e.re], [&across[i], &e.im]]) + fixed + foot[i]
    });
    if pitch == 0.0 {
        return rotated;
    }
    let advance = displacement.number() * pitch;
    [0, 1, 2].map(|i| rotated[i] + advance * angular[i])
}

/// The point that a displacement of a subspace moves a point to, base coordinates.
fn apply<const N: usize>(subspace: &Subspace, target: &Target<N>, point: &Place<N>) -> Place<N> {
    let (origin, axes) = (subspace.origin.coords, &subspace.axes);
    let arm: Place<N> = [0, 1, 2].map(|i| point[i] - origin[i]);
    let local: Place<N> = [0, 1, 2].map(|i| dot(&axes.column(i).into_owned(), &arm));
    let rotated = |e: &crate::boxes::Plane<N>| {
        [
            Affine::products([[&local[0], &e.re], [&-local[1], &e.im]]),
            Affine::products([[&local[0], &e.im], [&local[1], &e.re]]),
        ]
    };
    let moved: Place<N> = match target {
        Target::Identity(_) => return *point,
        Target::Planar(g) => {
            let [x, y] = rotated(&g.rotation);
            [x + g.translation.re, y + g.translation.im, local[2]]
        }
        Target::Spherical(rotation) => rotation.0.map(|row| {
            Affine::products([[&row[0], &local[0]], [&row[1], &local[1]], [&row[2], &local[2]]])
        }),
        Target::Cylindrical(CylindricalDisplacement { angle, advance }) => {
            let [x, y] = rotated(&angle.unit_vector());
            [x, y, local[2] + *advance]
        }
        Target::Translational(by) => [local[0] + by.re, local[1] + by.im, local[2]],
        Target::Spatial(by) => [0, 1, 2].map(|i| local[i] + by[i]),
    };
    [0, 1, 2].map(|i| dot(&axes.row(i).transpose(), &moved) + origin[i])
}
