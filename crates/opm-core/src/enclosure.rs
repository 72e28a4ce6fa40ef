//! Boxes of poses: guaranteed lower and upper bounds of the share of a box that is in reach and within the
//! limits.
//!
//! The closed forms that decide on one pose ([`crate::manipulator`]) are evaluated for a whole box at once,
//! in affine arithmetic (`affine.rs`): every quantity is a linear function of the box's coordinates, with a
//! bound of the error, rounding included. So every condition on a pose, that a chain closes or that a joint
//! is within its limits, is met on one side of a plane up to a known error, and the share of the box on that
//! side has a closed form (`share.rs`). Shares of several conditions are combined by inequalities that hold
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
//! The coordinates of a box are lengths and angles, except for `xi` and `nu`, which tilt an axis in a
//! sphere. For these the coordinate is the cosine or the sine, so that all points of a box have the same
//! weight in the invariant measure of rotations (Haar's, `sin xi`) and of directions (`cos nu`).

mod affine;
mod area;
mod boundary;
mod chain;
mod condition;
mod dependent;
mod one_joint;
mod opening;
mod partial;
mod places;
mod planar;
mod raised;
mod share;
mod slice;
mod target;

use crate::chain::limits::Limits;
use crate::chain::partial::PartialChain;
use crate::chain::{Branch, Chain};
use crate::group::JointDisplacement;
use crate::manipulator::{Choices, CompiledLeg, CompiledSection, Manipulator, Mode};
use crate::mechanism::leg::Section;
use crate::task::{CoordinateKind, Task, TaskCoordinate};
use affine::Plane;
use raised::RaisedChain;
use share::Share;
use slice::{Bounded, Rectangle, Slice};
use std::f64::consts::{PI, TAU};
use target::{Coordinate, Enclosed, Target};

pub use affine::Affine;
pub use places::{BodyPoint, CarriedPoint, MovingBody, Place};
pub use share::MOST;

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
/// -1 to 1. The one that grows replaces the angle. `α` is `xi`, or `nu` minus its value at home plus π/2.
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
            4..=5 => self.enclose_in::<5>(request),
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
    /// obeyed is a matter of a tolerance.
    ///
    /// ```
    /// # use opm_core::Manipulator;
    /// assert!(Manipulator::example("five-bar")?.has_enclosures());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn has_enclosures(&self) -> bool {
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

/// The unit vector at the angle that `at` replaces: `xi`, or `nu` minus its value at home.
fn polar<const N: usize>(
    half_turn: HalfTurn,
    at: Affine<N>,
    kind: Option<CoordinateKind>,
) -> Plane<N> {
    let sign = half_turn.sign();
    let (cosine, sine) = (at * -sign, (-at.square() + 1.0).sqrt() * sign);
    let alpha = Plane { re: cosine, im: sine };
    // nu is α - π/2.
    if kind == Some(CoordinateKind::Nu) { Plane { re: alpha.im, im: -alpha.re } } else { alpha }
}

/// The share for which all legs meet their conditions. Legs after one that reaches nothing are skipped.
fn all<const N: usize>(
    legs: impl Iterator<Item = usize>,
    mut of_leg: impl FnMut(usize) -> Share<N>,
) -> Share<N> {
    let mut common = Share::ALL;
    for leg in legs {
        common = common.and(of_leg(leg));
        if common.is_none() {
            break;
        }
    }
    common
}

/// The share for which any of several options meets its conditions.
fn any<T, const N: usize>(
    options: impl IntoIterator<Item = T>,
    mut share_of: impl FnMut(T) -> Share<N>,
) -> Share<N> {
    options.into_iter().fold(Share::NONE, |share, option| share.or(share_of(option)))
}

/// The chain of a section over a box of targets.
enum SectionChain<'a, const N: usize> {
    /// With the joints at home where they are.
    Fixed(&'a Chain, &'a Target<N>),
    /// At the heights of the box.
    Raised(RaisedChain<N>),
    /// With fewer joints than the subspace has dimensions, whose constraints the targets satisfy.
    Partial(&'a PartialChain, &'a Target<N>),
}

impl<const N: usize> SectionChain<'_, N> {
    /// The share for which the chain closes.
    fn closes(&self) -> Share<N> {
        match self {
            Self::Fixed(chain, target) => chain::closes(chain, target),
            Self::Raised(raised) => raised.closes(),
            Self::Partial(..) => Share::ALL,
        }
    }

    /// The joints' displacements. The bounds hold where the chain closes.
    fn displacements(&self, branch: Branch) -> [Enclosed<N>; 3] {
        match self {
            Self::Fixed(chain, target) => chain::displacements(chain, target, branch),
            Self::Raised(raised) => raised.displacements(branch),
            Self::Partial(chain, target) => partial::displacements(chain, target),
        }
    }
}

/// The displacement `b` over a box.
struct Upper<const N: usize> {
    target: Target<N>,
    /// The same as a rotation along the intersection motion and another displacement, where a coordinate rotates.
    turned: Option<(Affine<N>, Target<N>)>,
}

impl<const N: usize> Upper<N> {
    fn new(task: &Task, pose: &[Coordinate<N>]) -> Self {
        let turned = target::task::upper_turned(task, pose);
        Self { target: target::task::upper(task, pose), turned }
    }

    /// What the chain of a leg has to reach, but for that rotation where its imaginary joint adds it.
    fn of_chain(&self, leg: &CompiledLeg) -> &Target<N> {
        let turned = self.turned.as_ref().filter(|_| leg.bridge() == Some(Section::Upper));
        turned.map_or(&self.target, |(_, other)| other)
    }

    /// The displacement along the intersection motion, from the displacements of the chain's joints.
    fn step(&self, leg: &CompiledLeg, displacements: &[Enclosed<N>; 3]) -> Enclosed<N> {
        match (leg.imaginary_joint(), &self.turned) {
            (None, _) => Enclosed::Value(Affine::constant(0.0)),
            (Some(joint), None) => displacements[joint],
            (Some(joint), Some((turn, _))) => displacements[joint].turned(*turn),
        }
    }
}

/// A leg's conditions over a box.
struct LegConditions<'a, const N: usize> {
    manipulator: &'a Manipulator,
    choices: Choices,
    /// The height above home, metres; zero where there is none.
    rise: Affine<N>,
}

impl<const N: usize> LegConditions<'_, N> {
    fn leg(&self, number: usize) -> &CompiledLeg {
        &self.manipulator.legs[number]
    }

    /// The branches of a leg's section with the choices that are given.
    fn branches(&self, leg: usize, section: Section) -> impl Iterator<Item = Branch> + use<N> {
        let Choices { given, chosen } = self.choices;
        let of = |mode: Mode| self.manipulator.branches(mode, leg).of(section);
        let (first, other) = (of(chosen), of(chosen.with(given.opposite())));
        [Some(first), (other != first).then_some(other)].into_iter().flatten()
    }

    /// The share for which a section closes within its limits, and its joints' displacements meet the condition
    /// `then`.
    fn section(
        &self,
        leg: usize,
        section: Section,
        target: &Target<N>,
        then: impl Fn(&[Enclosed<N>; 3]) -> Share<N>,
    ) -> Share<N> {
        let compiled = self.leg(leg).section(section);
        let chain = self.chain(leg, section, target);
        let closes = chain.closes();
        if closes.is_none() {
            return closes;
        }
        closes.and(any(self.branches(leg, section), |branch| {
            let displacements = chain.displacements(branch);
            let within = self.admits(compiled, &displacements);
            if within.is_none() { within } else { within.and(then(&displacements)) }
        }))
    }

    /// The chain of a section with what it has to reach.
    fn chain<'t>(
        &'t self,
        leg: usize,
        section: Section,
        target: &'t Target<N>,
    ) -> SectionChain<'t, N> {
        let compiled = self.leg(leg).section(section);
        match (&compiled.partial, self.raised(leg, section, target)) {
            (Some(partial), _) => SectionChain::Partial(partial, target),
            (None, Some(raised)) => SectionChain::Raised(raised),
            (None, None) => SectionChain::Fixed(&compiled.chain, target),
        }
    }

    /// The chain of a section that the leg's lift is in, if that leans, at the heights of the box.
    fn raised(&self, leg: usize, section: Section, target: &Target<N>) -> Option<RaisedChain<N>> {
        let lean = self.leg(leg).lean.as_ref().filter(|lean| lean.section == section)?;
        match &self.leg(leg).section(section).chain {
            Chain::Planar(chain) => Some(RaisedChain::new(lean, chain, self.rise, target.planar())),
            _ => None,
        }
    }

    /// The share of a box that meets a query.
    fn over_box(&self, query: BoxQuery, coordinates: &[Coordinate<N>]) -> Share<N> {
        let task = self.manipulator.task();
        let legs = 0..self.manipulator.legs.len();
        let (lower, others) = match query {
            BoxQuery::Upper => {
                let b = target::task::upper(task, coordinates);
                return all(legs, |leg| self.upper(leg, &b));
            }
            BoxQuery::Whole | BoxQuery::Lower => coordinates.split_at(task.lower_count),
        };
        let v = target::task::lower(task, lower);
        if query == BoxQuery::Whole {
            let b = Upper::new(task, others);
            return all(legs, |leg| self.whole(leg, &v, &b));
        }
        let mut taus = others.iter();
        all(legs, |leg| self.lower(leg, &v, self.next_tau(leg, &mut taus)))
    }

    /// The same for a box with a rectangle of the plane, whose place in the coordinates is home.
    fn over_rectangle(
        &self,
        query: BoxQuery,
        coordinates: &[Coordinate<N>],
        rise: Option<Affine<N>>,
        rectangle: Rectangle,
    ) -> Bounded<N> {
        let task = self.manipulator.task();
        let (lower, others) = coordinates.split_at(task.lower_count);
        let v = target::task::lower(task, lower);
        let b = (query == BoxQuery::Whole).then(|| Upper::new(task, others));
        let mut taus = others.iter();
        let mut slice = Slice::new(self, rectangle);
        let lifts = rise.map_or(Share::ALL, |rise| self.manipulator.lifts_within(rise));
        let reached = slice.require(lifts)
            && (0..self.manipulator.legs.len()).all(|leg| match &b {
                Some(b) => slice.leg(leg, &v, Some(b), None),
                None => slice.leg(leg, &v, None, Some(self.next_tau(leg, &mut taus))),
            });
        if reached { slice.share() } else { Bounded::NONE }
    }

    /// The displacement of a leg along the intersection motion, where these are coordinates of the box.
    fn next_tau<'t>(
        &self,
        leg: usize,
        taus: &mut impl Iterator<Item = &'t Coordinate<N>>,
    ) -> Affine<N> {
        match self.leg(leg).bridge() {
            Some(Section::Upper) => match taus.next() {
                Some(&Coordinate::Linear(tau)) => tau,
                _ => unreachable!(
                    "a length or an angle for the intersection displacement of every leg"
                ),
            },
            Some(Section::Lower) | None => Affine::constant(0.0),
        }
    }

    /// The displacements of a leg along the intersection motion, one for each branch of the section that tells it.
    fn taus(&self, leg: usize, coordinates: &[Coordinate<N>]) -> Vec<Enclosed<N>> {
        let (task, compiled) = (self.manipulator.task(), self.leg(leg));
        let (lower, upper) = coordinates.split_at(task.lower_count);
        match compiled.split_section {
            Section::Upper => {
                let b = Upper::new(task, upper);
                let chain = self.chain(leg, Section::Upper, b.of_chain(compiled));
                let branches = self.branches(leg, Section::Upper);
                branches.map(|branch| b.step(compiled, &chain.displacements(branch))).collect()
            }
            Section::Lower => {
                let v = target::task::lower(task, lower);
                let chain = self.chain(leg, Section::Lower, &v);
                let branches = self.branches(leg, Section::Lower);
                let joint = compiled.imaginary_joint();
                let step = |branch| Some(chain.displacements(branch)[joint?].inverse());
                branches.filter_map(step).collect()
            }
        }
    }

    fn upper(&self, leg: usize, b: &Target<N>) -> Share<N> {
        match self.leg(leg).split_section {
            Section::Upper => self.section(leg, Section::Upper, b, |_| Share::ALL),
            Section::Lower => Share::ALL,
        }
    }

    fn lower(&self, leg: usize, v: &Target<N>, tau: Affine<N>) -> Share<N> {
        match self.leg(leg).split_section {
            Section::Upper => self.reaches(leg, v, Enclosed::Value(tau)),
            Section::Lower => self.section(leg, Section::Lower, v, |_| Share::ALL),
        }
    }

    fn whole(&self, leg: usize, v: &Target<N>, b: &Upper<N>) -> Share<N> {
        let compiled = self.leg(leg);
        match compiled.split_section {
            Section::Upper => {
                self.section(leg, Section::Upper, b.of_chain(compiled), |displacements| {
                    let tau = b.step(compiled, displacements);
                    self.unwound(compiled, tau, |tau| self.reaches(leg, v, tau))
                })
            }
            Section::Lower => self.section(leg, Section::Lower, v, |displacements| {
                if !compiled.upper_constrains {
                    return Share::ALL;
                }
                let joint = compiled.imaginary_joint();
                let still = Enclosed::Value(Affine::constant(0.0));
                let step = joint.map_or(still, |joint| displacements[joint]);
                self.unwound(compiled, step, |step| {
                    let motion = self.manipulator.task().upper_intersection;
                    let target = target::before(motion, &b.target, step);
                    self.section(leg, Section::Upper, &target, |_| Share::ALL)
                })
            }),
        }
    }

    /// The share for which the lower section closes at `v · exp(I τ)` within its limits.
    fn reaches(&self, leg: usize, v: &Target<N>, tau: Enclosed<N>) -> Share<N> {
        let target = target::after(self.manipulator.task().lower_intersection, v, tau);
        self.section(leg, Section::Lower, &target, |_| Share::ALL)
    }

    /// The share that `then` gives for a displacement along the intersection motion. Where revolutions are
    /// counted, the displacement is within π of home; a box may contain both ends of that range.
    fn unwound(
        &self,
        leg: &CompiledLeg,
        tau: Enclosed<N>,
        then: impl Fn(Enclosed<N>) -> Share<N>,
    ) -> Share<N> {
        if !leg.unwinds() || matches!(tau, Enclosed::Value(_)) {
            return then(tau);
        }
        let number = tau.number();
        let turns = (number.centre / TAU).round();
        let near = number - TAU * turns;
        let here = then(Enclosed::Value(near));
        if near.low() > -PI && near.high() < PI {
            return here;
        }
        let shift = if near.centre > 0.0 { -TAU } else { TAU };
        here.either(then(Enclosed::Value(near + shift)))
    }

    /// The share for which a section's joints are within their limits.
    fn admits(&self, section: &CompiledSection, displacements: &[Enclosed<N>; 3]) -> Share<N> {
        if !section.limited {
            return Share::ALL;
        }
        let limits = self.manipulator.limits();
        let joints = section.coordinates.iter().zip(displacements);
        joints.fold(Share::ALL, |share, (coordinate, displacement)| match coordinate {
            Some(coordinate) if !share.is_none() => {
                share.and(within(&limits[coordinate.number], displacement))
            }
            _ => share,
        })
    }
}

/// The share for which a joint's displacement is within its limits.
fn within<const N: usize>(limits: &Limits, displacement: &Enclosed<N>) -> Share<N> {
    match (limits, displacement) {
        (Limits::Free, _) => Share::ALL,
        (Limits::Range { low, high, .. }, Enclosed::Value(value)) => {
            Share::within(value, [*low, *high], 0.0)
        }
        (Limits::Range { arc: None, .. }, _) => Share::ALL,
        (Limits::Range { low, high, .. }, turn) => {
            Share::within_turns(&turn.number(), [*low, *high], TAU)
        }
    }
}
