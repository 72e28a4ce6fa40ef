//! Boxes of poses: guaranteed lower and upper bounds of the share of a box that is in reach and within the
//! limits.
//!
//! The closed forms that decide on one pose ([`crate::manipulator`]) are evaluated for a whole box at once,
//! in affine arithmetic (`opm_geometry::boxes`): every quantity is a linear function of the box's coordinates, with a
//! bound of the error, rounding included. So every condition on a pose, that a chain closes or that a joint
//! is within its limits, is met on one side of a plane up to a known error, and the share of the box on that
//! side has a closed form (`boxes/share.rs`). Shares of several conditions are combined by inequalities that hold
//! however the conditions depend on each other.
//!
//! Where legs with too few freedoms tie coordinates together, a box has the independent ones, and the others follow as functions
//! of these (`dependent.rs`).
//!
//! Where a section moves in a plane, a box that has a range of both coordinates of a place is integrated over them
//! exactly (`slice.rs`, `area.rs`), so that only its other coordinates are ever split.
//!
//! The bounds hold for the poses that [`Manipulator::inverse`] finds in reach and within limits, including
//! its tolerance for rounding on a limit or on the boundary of reach, a fraction of 1e-12.
//!
//! The coordinates of a box are lengths and angles, except for `xi`, `pitch` and `nu`, which tilt an axis
//! in a sphere. For these the coordinate is the cosine or the sine, so that all points of a box have the same
//! weight in the invariant measure of rotations (Haar's, `sin xi`, `cos pitch`) and of directions (`cos nu`).

mod area;
mod boundary;
mod dependent;
mod legs;
mod places;
mod raised;
mod slice;
mod target;

use crate::boxes::{Enclosed, Plane, Share};
use crate::group::JointDisplacement;
use crate::manipulator::{Choices, Manipulator, Mode};
use crate::mechanism::leg::Section;
use crate::task::{CoordinateKind, TaskCoordinate};
use legs::{LegConditions, Upper, any, within};
use slice::Bounded;
use std::f64::consts::PI;
use target::Coordinate;

pub use crate::boxes::{Affine, MOST};
pub use places::{BodyPoint, CarriedPoint, MovingBody, Place};

/// So many sides at most have numbers of their own.
const MIDDLE: usize = 5;

/// One coordinate of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// The middle: a value in radians or metres, or the cosine or sine that replaces it in a `half_turn`.
    pub middle: f64,
    /// The distance from the middle to either end; zero where the coordinate has a single value.
    pub half: f64,
    /// Where the coordinate is an angle replaced by its cosine or sine, the interval of it: see [`HalfTurn`].
    pub half_turn: Option<HalfTurn>,
}

/// An interval of an angle `α` from one multiple of π to the next, over which `-cos α` or `cos α` grows from
/// -1 to 1. The one that grows replaces the angle. `α` is `xi`, `pitch` plus π/2, or `nu` minus its
/// value at home plus π/2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfTurn {
    /// The beginning of the interval, in multiples of π.
    pub number: i64,
}

impl HalfTurn {
    /// The interval that contains an angle, radians.
    pub fn of(angle: f64) -> Self {
        Self { number: (angle / PI).floor() as i64 }
    }

    /// The angle minus the beginning of the interval, clamped to `[0, π]`, radians.
    pub fn within(self, angle: f64) -> f64 {
        (angle - self.start()).clamp(0.0, PI)
    }

    /// The angle, radians, that a number from -1 to 1 replaces.
    pub fn angle(self, at: f64) -> f64 {
        self.start() + (-at).clamp(-1.0, 1.0).acos()
    }

    fn start(self) -> f64 {
        self.number as f64 * PI
    }

    /// The sign of the sine over the interval.
    fn sign(self) -> f64 {
        if self.number.rem_euclid(2) == 0 { 1.0 } else { -1.0 }
    }
}

/// A condition on the poses of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxQuery {
    /// The poses are in reach and within all limits. The box has a side for every task coordinate.
    Whole,
    /// The upper section alone is in reach and within its limits. The box has a side for every task coordinate
    /// of `b`.
    Upper,
    /// The lower section alone is in reach and within its limits, with the displacements along the
    /// intersection motion given. The box has a side for every task coordinate of `v`, and then one for the
    /// displacement of every leg that is split in its upper section, leg by leg.
    Lower,
}

/// The bounds of the share of a box that meets a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// At least this share of the box meets the query; 1 where all of it does.
    pub lower: f64,
    /// At most this share of the box meets the query; 0 where no part of it does.
    pub upper: f64,
    /// The number of the side to bisect so that the bounds get closer; `None` where no bisection helps.
    pub split: Option<usize>,
}

impl Manipulator {
    /// Bounds of the share of a box of poses that meets a query, in one working mode, or (`None`) in any.
    ///
    /// # Panics
    /// If the number of sides is not that of the query, or more than [`MOST`] sides have a width. If the mechanism has no
    /// bounds ([`Manipulator::has_enclosures`]), or a section alone is asked for and its coordinates depend on the other one's.
    #[doc(hidden)]
    pub fn enclose(&self, query: BoxQuery, mode: Option<Mode>, sides: &[Side]) -> Verdict {
        let plane = self.plane(query, mode, sides);
        let of = if plane.is_some() { 2 } else { 0 };
        let request = Request { query, mode, sides, plane };
        let wide = sides.iter().filter(|side| side.half > 0.0).count() - of;
        match wide {
            0..=2 => self.enclose_in::<2>(request),
            3 => self.enclose_in::<3>(request),
            4..=MIDDLE if !self.is_whole() => self.enclose_in::<MIDDLE>(request),
            _ => self.enclose_in::<MOST>(request),
        }
    }

    /// Bounds of the values of the imaginary joints over a box of poses, in one working mode, or (`None`) in any: at every pose
    /// that is in reach in such a mode they are within these. They are in the order of [`Manipulator::imaginary`], radians and
    /// metres, and reversed where no mode reaches anything. The box has a side for every task coordinate, of which at most two
    /// have a width.
    ///
    /// # Panics
    /// As [`Manipulator::enclose`], or if more than two sides have a width.
    #[doc(hidden)]
    pub fn imaginary_over(&self, mode: Option<Mode>, sides: &[Side]) -> Vec<[f64; 2]> {
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.imaginary().len()];
        let unknown = || vec![[f64::NEG_INFINITY, f64::INFINITY]; self.imaginary().len()];
        let (coordinates, _) = self.coordinates_over::<2>(BoxQuery::Whole, None, sides);
        let rise = self.rise_over(BoxQuery::Whole, &coordinates).unwrap_or(Affine::constant(0.0));
        for choices in self.completions(mode) {
            let conditions = LegConditions { manipulator: self, choices, rise };
            let mut coordinates = coordinates.clone();
            match conditions.complete(&mut coordinates) {
                Ok(exist) if exist.is_none() => continue,
                Ok(_) => {}
                Err(_) => return unknown(),
            }
            for (number, leg) in self.legs.iter().enumerate() {
                let Some(imaginary) = leg.imaginary else { continue };
                let of_joint = &self.imaginary()[imaginary];
                let [from, to] = &mut ranges[imaginary];
                for tau in conditions.taus(number, &coordinates) {
                    let tau = match tau {
                        Enclosed::Value(tau) if !leg.unwinds() => tau,
                        angle => dependent::near(angle.number(), 0.0),
                    };
                    if !tau.radius().is_finite() {
                        return unknown();
                    }
                    for end in [tau.low(), tau.high()] {
                        let value = of_joint.value(JointDisplacement::Value(end), of_joint.home);
                        (*from, *to) = (from.min(value), to.max(value));
                    }
                }
            }
        }
        ranges
    }

    /// The coordinates of a box, and the numbers of the sides that have a width. Where the box is integrated over a plane of
    /// places, these are at home.
    fn coordinates_over<const N: usize>(
        &self,
        query: BoxQuery,
        plane: Option<[usize; 2]>,
        sides: &[Side],
    ) -> (Vec<Coordinate<N>>, [Option<usize>; N]) {
        let mut numbers = [None; N];
        let mut next = 0;
        let coordinate = |(number, side): (usize, &Side)| {
            let task = self.coordinate_of(query, number);
            let value =
                if let Some(task) = task.filter(|_| plane.is_some_and(|p| p.contains(&number))) {
                    // The area is that of the places about home.
                    Affine::constant(task.home)
                } else if side.half > 0.0 {
                    numbers[next] = Some(number);
                    next += 1;
                    Affine::<N>::coordinate(side.middle, side.half, next - 1)
                } else {
                    Affine::constant(side.middle)
                };
            match side.half_turn {
                None => Coordinate::Linear(value),
                Some(half_turn) => {
                    Coordinate::Polar(polar(half_turn, value, task.map(TaskCoordinate::kind)))
                }
            }
        };
        let given = sides.iter().enumerate().map(coordinate).collect();
        (self.all_coordinates(query, given), numbers)
    }

    fn enclose_in<const N: usize>(&self, request: Request<'_>) -> Verdict {
        let Request { query, mode, sides, plane } = request;
        let (coordinates, numbers) = self.coordinates_over::<N>(query, plane, sides);
        let rise = self.rise_over(query, &coordinates);
        let conditions = |choices| {
            let rise = rise.unwrap_or(Affine::constant(0.0));
            LegConditions { manipulator: self, choices, rise }
        };
        let Bounded { lower, upper, contributions } = match plane {
            Some(plane) => {
                let rectangle = self.rectangle(plane, sides);
                let choices = mode.map_or_else(Choices::default, Choices::of);
                conditions(choices).over_rectangle(query, &coordinates, rise, rectangle)
            }
            None => {
                let share = any(self.completions(mode), |choices| {
                    let (conditions, mut coordinates) = (conditions(choices), coordinates.clone());
                    match conditions.complete(&mut coordinates) {
                        Ok(exist) if exist.is_none() => exist,
                        Ok(exist) => exist.and(conditions.over_box(query, &coordinates)),
                        Err(at_most) => at_most,
                    }
                });
                let share = rise.map_or(share, |rise| share.and(self.lifts_within(rise)));
                let contributions = share.contributions();
                Bounded { lower: share.lower, upper: share.upper, contributions }
            }
        };
        let mut split = None;
        for (&contribution, number) in contributions.iter().zip(numbers) {
            let larger = split.is_none_or(|(_, most)| contribution > most);
            if contribution > 0.0 && larger {
                split = number.map(|number| (number, contribution));
            }
        }
        let split = match split {
            Some((number, _)) => Some(number),
            // It is unknown which coordinate causes the difference of the bounds.
            None if contributions.iter().any(|c| !c.is_finite()) => numbers[0],
            None => None,
        };
        Verdict { lower, upper, split }
    }
}

/// A question about a box.
#[derive(Clone, Copy)]
struct Request<'a> {
    query: BoxQuery,
    mode: Option<Mode>,
    sides: &'a [Side],
    /// The numbers of the sides that are integrated over as places in the plane.
    plane: Option<[usize; 2]>,
}

impl Manipulator {
    /// Whether boxes of poses have bounds. They have none where several legs impose the same constraint: whether it is
    /// obeyed is a matter of a tolerance; nor where legs are solved whole and coordinates depend on each other, or spherical
    /// joints are limited; nor where joints have cones, or their differences limits.
    ///
    /// ```
    /// # use opm_core::Manipulator;
    /// assert!(Manipulator::example("five-bar")?.has_enclosures());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn has_enclosures(&self) -> bool {
        if self.shares_limits() {
            return false;
        }
        if self.is_whole() {
            // They would be a tenth of the explorer's page, which asks for none.
            return !cfg!(target_arch = "wasm32") && self.reaches_whole();
        }
        self.dependent.as_ref().is_none_or(|dependent| dependent.checked().next().is_none())
    }

    /// The task coordinate that a side of a box is; `None` for the displacement of an imaginary joint.
    fn coordinate_of(&self, query: BoxQuery, side: usize) -> Option<&TaskCoordinate> {
        let number = match (query, &self.dependent) {
            (BoxQuery::Upper, _) => self.task().lower_count + side,
            (BoxQuery::Whole, Some(dependent)) => dependent.independent[side],
            (BoxQuery::Whole | BoxQuery::Lower, _) => side,
        };
        self.task().coordinates.get(number)
    }

    /// All coordinates of a box from those of its sides; dependent ones, which are not known yet, are at home.
    fn all_coordinates<const N: usize>(
        &self,
        query: BoxQuery,
        given: Vec<Coordinate<N>>,
    ) -> Vec<Coordinate<N>> {
        let Some(dependent) = &self.dependent else { return given };
        assert_eq!(query, BoxQuery::Whole, "one section depends on the other");
        assert!(self.has_enclosures(), "legs that repeat a constraint");
        let home = |c: &TaskCoordinate| Coordinate::Linear(Affine::constant(c.home));
        let mut all: Vec<_> = self.task().coordinates.iter().map(home).collect();
        dependent.independent.iter().zip(given).for_each(|(&number, given)| all[number] = given);
        all
    }

    /// The heights above home in a box, metres; `None` if the sections of the query have no height.
    fn rise_over<const N: usize>(
        &self,
        query: BoxQuery,
        coordinates: &[Coordinate<N>],
    ) -> Option<Affine<N>> {
        let height = self.task().height.as_ref()?;
        let first = match (query, height.section) {
            (BoxQuery::Whole, _) | (BoxQuery::Lower, Section::Lower) => 0,
            (BoxQuery::Upper, Section::Upper) => self.task().lower_count,
            (BoxQuery::Lower, Section::Upper) | (BoxQuery::Upper, Section::Lower) => return None,
        };
        let home = self.task().coordinates[height.coordinate].home;
        Some(coordinates[height.coordinate - first].minus(home))
    }

    /// The share of a box for which the lifts are within their limits at these heights above home, metres.
    fn lifts_within<const N: usize>(&self, rise: Affine<N>) -> Share<N> {
        self.lift_limits().fold(Share::ALL, |share, (lift, limits)| {
            share.and(within(limits, &Enclosed::Value(rise * lift.rate)))
        })
    }
}

/// The unit vector at the angle that `at` replaces: `xi`, `pitch`, or `nu` minus its value at home.
fn polar<const N: usize>(
    half_turn: HalfTurn,
    at: Affine<N>,
    kind: Option<CoordinateKind>,
) -> Plane<N> {
    let sign = half_turn.sign();
    let (cosine, sine) = (at * -sign, (-at.square() + 1.0).sqrt() * sign);
    let alpha = Plane { re: cosine, im: sine };
    // pitch and nu are α - π/2.
    if matches!(kind, Some(CoordinateKind::Pitch | CoordinateKind::Nu)) {
        Plane { re: alpha.im, im: -alpha.re }
    } else {
        alpha
    }
}
