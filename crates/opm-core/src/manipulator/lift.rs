//! Lifts: the joints that carry the height of a Schoenflies section.
//!
//! A Schoenflies displacement is a planar one and a translation along the plane's normal, which commute
//! ([`Height`](crate::task::Task)). One joint of each leg's section changes the height, the *lift*, and the others only
//! move in the plane or about its normals. So the height tells the lift's displacement, wherever in the leg it is, and
//! the other joints are a chain in the plane.
//!
//! A slider along the normal does nothing in the plane. A screw also turns what follows it, and an inclined slider moves
//! that: these lifts *lean*. At one height the displacement `D` in the plane that a lift makes is known, and the chain
//!
//! ```text
//! E₁ … Eₖ · D · Eₖ₊₁ … Eₙ = E₁ … Eₖ · (D Eₖ₊₁ D⁻¹) … (D Eₙ D⁻¹) · D
//! ```
//!
//! has the joints behind the lift displaced by `D`. It has to reach the target times `D⁻¹`.
//!
//! A cylinder beside the section may have an axis that is inclined to the direction. A displacement τ along it has a part
//! in the height: the leg has a height of its own, higher than the section's by a multiple of τ
//! ([`Height::slope`](crate::task::Height)). In the plane it is a slide by the rest of τ. Where that slider is in the
//! section's chain ([`Slider`](super::section::Slider)), τ follows from the chain, and the height from τ; so a lift that
//! leans has to be in a leg whose imaginary joint is in the other section.

use super::leg::{CompileContext, CompiledLeg};
use super::refused::RefusedLeg;
use super::section::{ChainCoordinate, coordinate_number};
use super::{LegSolution, Manipulator, Section, Solution};
use crate::chain::limits::Limits;
use crate::chain::planar::PlanarChain;
use crate::chain::screws::screw;
use crate::chain::{Chain, ChainJoint, ReachDeficit};
use crate::decomposition::{Freedom, LegSplit, height};
use crate::group::subspace::TOLERANCE;
use crate::group::{JointDisplacement, LocalTwist, Planar, PlanarDisplacement, Subgroup, Subspace};
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;
use nalgebra::Unit;
use std::borrow::Cow;

/// The joint that carries the height of a leg's section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift {
    pub coordinate: ChainCoordinate,
    /// Its displacement for a unit of height: 1, or -1 where it moves down, for a slider along the direction.
    pub rate: f64,
    /// What a unit of the leg's displacement along the intersection motion adds to the height: see
    /// [`Height::slope`](crate::task::Height).
    pub slope: f64,
}

/// The motion of a lift in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lean {
    /// The section.
    pub section: Section,
    /// The number of joints before the lift in the section's chain.
    pub before: usize,
    /// Its screw at home, for a unit of height, in the plane's frame.
    pub screw: LocalTwist,
}

impl Lift {
    /// The displacement of the joint at a height above home, metres.
    #[inline]
    pub fn displacement(&self, rise: f64) -> f64 {
        self.rate * rise
    }

    /// The height above home at a displacement of the joint, metres.
    pub fn rise(&self, displacement: f64) -> f64 {
        displacement / self.rate
    }
}

impl Lean {
    /// The displacement in the plane that the lift makes at a height above home, metres.
    fn displacement(&self, rise: f64) -> PlanarDisplacement {
        Planar::exponential(&(self.screw * rise))
    }

    /// The lift's screw for a unit of height, where the joints of its section's chain have these displacements.
    pub fn moved_screw(
        &self,
        leg: &CompiledLeg,
        displacements: &[JointDisplacement; 3],
    ) -> LocalTwist {
        let joints = leg.section(self.section).screws.iter().zip(displacements);
        let before =
            joints.take(self.before).fold(PlanarDisplacement::IDENTITY, |g, (screw, step)| {
                g.after(&PlanarDisplacement::along_screw(screw, *step))
            });
        Planar::adjoint(&before, &self.screw)
    }
}

/// A leg without its lift.
pub(super) struct Separated {
    pub lift: Lift,
    /// What it does in the plane; `None` for a slider along the direction.
    pub lean: Option<Lean>,
    /// The number of the lift among the leg's joints.
    pub joint: usize,
    /// The split of the leg's other joints.
    pub rest: LegSplit,
}

/// Separates a leg from the joint that carries the height; `None` without a height.
///
/// # Errors
/// There is no such joint, or several joints have a part in the height.
pub(super) fn separate(
    leg: &Leg,
    split: &LegSplit,
    first: usize,
    context: CompileContext<'_>,
) -> Result<Option<Separated>, RefusedLeg> {
    let Some(height) = &context.task.height else { return Ok(None) };
    let (freedoms, subspace) = match height.section {
        Section::Lower => (&split.lower, &context.task.lower),
        Section::Upper => (&split.upper, &context.task.upper),
    };
    let (lift, advance) = height::lift(leg, freedoms, &height.up, context.size)?;
    let others: Vec<Freedom> = freedoms.iter().copied().filter(|f| *f != lift).collect();
    let lean = in_plane(leg, lift, subspace, height.section)?.map(|screw| Lean {
        section: height.section,
        before: freedoms.iter().take_while(|f| **f != lift).count(),
        screw: screw / advance,
    });
    let mut rest = split.clone();
    match height.section {
        Section::Lower => rest.lower = others,
        Section::Upper => rest.upper = others,
    }
    let number = first + coordinate_number(leg, lift);
    let coordinate = context.coordinates[number];
    let joint = lift.joint;
    let lift = Lift { coordinate, rate: advance.recip(), slope: height.slope };
    Ok(Some(Separated { lift, lean, joint, rest }))
}

/// The screw in the plane's frame of what a lift does in the plane; `None` for a slider along the direction.
fn in_plane(
    leg: &Leg,
    lift: Freedom,
    subspace: &Subspace,
    section: Section,
) -> Result<Option<LocalTwist>, RefusedLeg> {
    let joint = &leg.joints[lift.joint];
    let joints = vec![joint.name.clone()];
    let refused = |error| RefusedLeg::Chain { section, joints, error };
    match joint.kind {
        JointKind::Helical { .. } => {
            let turn = ChainJoint::Screw { axis: joint.axis, point: joint.point, pitch: 0.0 };
            screw(subspace, &turn).map(Some).map_err(refused)
        }
        _ => {
            let up = subspace.axes.column(2);
            let part = joint.axis.into_inner() - up * up.dot(&joint.axis);
            let Some((along, length)) = Unit::try_new_and_get(part, TOLERANCE) else {
                return Ok(None);
            };
            let slide = screw(subspace, &ChainJoint::Slide { axis: along }).map_err(refused)?;
            Ok(Some(slide * length))
        }
    }
}

impl CompiledLeg {
    /// The leg as it is at a height above home, metres: as it is always, unless its lift leans.
    ///
    /// # Errors
    /// The joints of its section are dependent at this height. There the leg has no closed form, and counts as out of
    /// reach.
    pub fn at(&self, rise: f64) -> Result<Cow<'_, Self>, (Section, ReachDeficit)> {
        match &self.lean {
            Some(lean) => self.raised(lean, rise).map(Cow::Owned),
            None => Ok(Cow::Borrowed(self)),
        }
    }

    /// The leg with a lift that leans at a height above home, metres, as one without such a lift.
    #[cold]
    #[inline(never)]
    pub fn raised(&self, lean: &Lean, rise: f64) -> Result<Self, (Section, ReachDeficit)> {
        let step = lean.displacement(rise);
        let mut leg = self.clone();
        leg.lean = None;
        let section = match lean.section {
            Section::Lower => &mut leg.lower,
            Section::Upper => &mut leg.upper,
        };
        let Chain::Planar(chain) = &section.chain else { return Ok(leg) };
        let mut joints = chain.joints();
        for joint in &mut joints[lean.before..] {
            *joint = joint.carried(&step);
        }
        let chain = PlanarChain::new(joints)
            .map_err(|_| (lean.section, ReachDeficit::length(f64::INFINITY)))?;
        section.chain = Chain::Planar(chain);
        for screw in &mut section.screws[lean.before..] {
            *screw = Planar::adjoint(&step, screw);
        }
        section.offset = Some(step.inverse().into());
        Ok(leg)
    }
}

impl Manipulator {
    /// The lifts, leg by leg; none without a height.
    #[inline]
    pub(crate) fn lifts(&self) -> impl Iterator<Item = &Lift> {
        self.lifts_of_legs().map(|(_, lift)| lift)
    }

    /// The lifts with the numbers of their legs; none without a height.
    #[inline]
    pub(crate) fn lifts_of_legs(&self) -> impl Iterator<Item = (usize, &Lift)> {
        let legs = if self.task().height.is_some() { &*self.legs } else { &[] };
        legs.iter().enumerate().filter_map(|(number, leg)| Some((number, leg.lift.as_ref()?)))
    }

    /// The names of the joints that carry the height of a Schoenflies section and also move their legs in the plane:
    /// inclined sliders and screws. Where there are any, legs have other chains at every height: a sweep through many
    /// heights makes them anew for each, which takes microseconds.
    pub fn leaning_joints(&self) -> impl Iterator<Item = &str> {
        let leaning = self.legs.iter().filter(|leg| leg.lean.is_some());
        leaning.filter_map(|leg| {
            Some(self.coordinates()[leg.lift.as_ref()?.coordinate.number].name.as_str())
        })
    }

    /// The legs at heights above home that `rise` gives, metres. One without a closed form there does not close: it is as
    /// it is at home, as one is whose height is not given, with its lift.
    pub(crate) fn legs_at(
        &self,
        rise: impl Fn(&CompiledLeg) -> Option<f64>,
    ) -> Cow<'_, [CompiledLeg]> {
        if self.lifts_straight() {
            return Cow::Borrowed(&self.legs);
        }
        let at = |leg: &CompiledLeg| {
            let raised = rise(leg).map(|rise| leg.at(rise));
            raised.and_then(Result::ok).map_or_else(|| leg.clone(), Cow::into_owned)
        };
        self.legs.iter().map(at).collect()
    }

    /// Whether the legs' chains are the same at every height.
    pub fn lifts_straight(&self) -> bool {
        self.leaning_joints().next().is_none()
    }

    /// The height above home of a leg's own section at a solution, metres.
    #[inline]
    pub(crate) fn leg_rise(&self, at: &Solution, number: usize) -> f64 {
        self.task().rise_of_leg(self.task().rise(&at.solved.pose), at.legs[number].tau)
    }

    /// Whether a solution of a leg is within its limits, with the Schoenflies section at a height above home, metres.
    #[inline]
    pub(super) fn admits(&self, leg: &CompiledLeg, solution: &LegSolution, rise: f64) -> bool {
        let lifted = |lift: &Lift| self.lifted(lift, self.task().rise_of_leg(rise, solution.tau)).1;
        leg.lower.admits(&solution.lower)
            && leg.upper.admits(&solution.upper)
            && leg.lift.as_ref().is_none_or(lifted)
            && leg.whole.as_ref().is_none_or(|whole| whole.admits(solution))
            && leg.within_cones(solution)
    }

    /// The value and whether it is within its limits of a lift at a height above home, metres.
    #[inline]
    pub(crate) fn lifted(&self, lift: &Lift, rise: f64) -> (f64, bool) {
        let number = lift.coordinate.number;
        let displacement = lift.displacement(rise);
        let within = self.limits()[number].admits(JointDisplacement::Value(displacement));
        (self.coordinates()[number].home + displacement, within)
    }

    /// The limits of the heights above home that the lifts admit.
    pub(crate) fn lift_limits(&self) -> impl Iterator<Item = (&Lift, &Limits)> {
        self.lifts().map(|lift| (lift, &self.limits()[lift.coordinate.number]))
    }
}
