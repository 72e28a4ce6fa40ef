//! The conditions that a pose has to meet, leg by leg, over a box.

use super::raised::RaisedChain;
use super::slice::{Bounded, Rectangle, Slice};
use super::target::{self, Coordinate};
use super::{BoxQuery, MIDDLE};
use crate::boxes::Affine;
use crate::boxes::Share;
use crate::boxes::chain;
use crate::boxes::whole::enclose;
use crate::boxes::{Enclosed, Target};
use crate::chain::limits::Limits;
use crate::chain::partial::PartialChain;
use crate::chain::{Branch, Chain};
use crate::manipulator::{Choices, CompiledLeg, CompiledSection, Manipulator, Mode};
use crate::mechanism::leg::Section;
use crate::task::Task;
use std::f64::consts::{PI, TAU};

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
pub fn any<T, const N: usize>(
    options: impl IntoIterator<Item = T>,
    mut share_of: impl FnMut(T) -> Share<N>,
) -> Share<N> {
    options.into_iter().fold(Share::NONE, |share, option| share.or(share_of(option)))
}

/// The chain of a section over a box of targets.
#[expect(clippy::large_enum_variant, reason = "there is one at a time, on the stack")]
pub enum SectionChain<'a, const N: usize> {
    /// With the joints at home where they are.
    Fixed(&'a Chain, &'a Target<N>),
    /// At the heights of the box.
    Raised(RaisedChain<N>),
    /// With fewer joints than the subspace has dimensions, whose constraints the targets satisfy.
    Partial(&'a PartialChain, &'a Target<N>),
}

impl<const N: usize> SectionChain<'_, N> {
    /// The share for which the chain closes.
    pub fn closes(&self) -> Share<N> {
        match self {
            Self::Fixed(chain, target) => chain::closes(chain, target),
            Self::Raised(raised) => raised.closes(),
            Self::Partial(..) => Share::ALL,
        }
    }

    /// The joints' displacements. The bounds hold where the chain closes.
    pub fn displacements(&self, branch: Branch) -> [Enclosed<N>; 3] {
        match self {
            Self::Fixed(chain, target) => chain::displacements(chain, target, branch),
            Self::Raised(raised) => raised.displacements(branch),
            Self::Partial(chain, target) => chain.inverse(target),
        }
    }
}

/// The displacement `b` over a box.
pub struct Upper<const N: usize> {
    pub target: Target<N>,
    /// The same as a rotation along the intersection motion and another displacement, where a coordinate rotates.
    pub turned: Option<(Affine<N>, Target<N>)>,
}

impl<const N: usize> Upper<N> {
    pub fn new(task: &Task, pose: &[Coordinate<N>]) -> Self {
        let turned = target::task::upper_turned(task, pose);
        Self { target: target::task::upper(task, pose), turned }
    }

    /// What the chain of a leg has to reach, but for that rotation where its imaginary joint adds it.
    pub fn of_chain(&self, leg: &CompiledLeg) -> &Target<N> {
        let turned = self.turned.as_ref().filter(|_| leg.bridge() == Some(Section::Upper));
        turned.map_or(&self.target, |(_, other)| other)
    }

    /// The displacement along the intersection motion, from the displacements of the chain's joints.
    pub fn step(&self, leg: &CompiledLeg, displacements: &[Enclosed<N>; 3]) -> Enclosed<N> {
        match (leg.imaginary_joint(), &self.turned) {
            (None, _) => Enclosed::Value(Affine::constant(0.0)),
            (Some(joint), None) => displacements[joint],
            (Some(joint), Some((turn, _))) => displacements[joint].turned(*turn),
        }
    }
}

/// A leg's conditions over a box.
pub struct LegConditions<'a, const N: usize> {
    pub manipulator: &'a Manipulator,
    pub choices: Choices,
    /// The height above home, metres; zero where there is none.
    pub rise: Affine<N>,
}

impl<const N: usize> LegConditions<'_, N> {
    pub fn leg(&self, number: usize) -> &CompiledLeg {
        &self.manipulator.legs[number]
    }

    /// The branches of a leg's section with the choices that are given.
    pub fn branches(&self, leg: usize, section: Section) -> impl Iterator<Item = Branch> + use<N> {
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
    pub fn chain<'t>(
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
    pub fn raised(
        &self,
        leg: usize,
        section: Section,
        target: &Target<N>,
    ) -> Option<RaisedChain<N>> {
        let lean = self.leg(leg).lean.as_ref().filter(|lean| lean.section == section)?;
        match &self.leg(leg).section(section).chain {
            Chain::Planar(chain) => Some(RaisedChain::new(lean, chain, self.rise, target.planar())),
            _ => None,
        }
    }

    /// The share of a box that meets a query.
    pub fn over_box(&self, query: BoxQuery, coordinates: &[Coordinate<N>]) -> Share<N> {
        if self.manipulator.is_whole() {
            return self.over_whole(coordinates);
        }
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

    /// The same where legs are solved whole.
    fn over_whole(&self, coordinates: &[Coordinate<N>]) -> Share<N> {
        // There are no boxes of so many sides here (`Manipulator::enclose`): code for them would be of no use.
        if cfg!(target_arch = "wasm32") || N == MIDDLE {
            return Share::ANY;
        }
        let (manipulator, task) = (self.manipulator, self.manipulator.task());
        let (lower, upper) = coordinates.split_at(task.lower_count);
        let v = target::task::lower(task, lower);
        let target = task.placed(&v, &target::task::upper(task, upper), self.rise).parts();
        all(0..manipulator.legs.len(), |number| {
            let whole = self.leg(number).whole.as_ref();
            let Some((whole, reach)) = whole.and_then(|whole| Some((whole, whole.reach.as_ref()?)))
            else {
                return Share::ANY;
            };
            any(manipulator.branches_of(self.choices, number), |branches| {
                let signs = [branches.lower.sign(), branches.upper.sign()];
                let (share, displacements) = enclose(reach, target, signs);
                whole.limited(manipulator).fold(share, |share, (freedom, limits)| {
                    match share.is_none() {
                        true => share,
                        false => share.and(within(limits, &displacements[freedom])),
                    }
                })
            })
        })
    }

    /// The same for a box with a rectangle of the plane, whose place in the coordinates is home.
    pub fn over_rectangle(
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
    pub fn taus(&self, leg: usize, coordinates: &[Coordinate<N>]) -> Vec<Enclosed<N>> {
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
                    let target = motion.before(&b.target, step);
                    self.section(leg, Section::Upper, &target, |_| Share::ALL)
                })
            }),
        }
    }

    /// The share for which the lower section closes at `v · exp(I τ)` within its limits.
    fn reaches(&self, leg: usize, v: &Target<N>, tau: Enclosed<N>) -> Share<N> {
        let target = self.manipulator.task().lower_intersection.after(v, tau);
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
    pub fn admits(&self, section: &CompiledSection, displacements: &[Enclosed<N>; 3]) -> Share<N> {
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
pub fn within<const N: usize>(limits: &Limits, displacement: &Enclosed<N>) -> Share<N> {
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
