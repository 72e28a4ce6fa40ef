//! Lifts: the joints that carry the height of a Schoenflies section.
//!
//! A Schoenflies displacement is a planar one followed by a translation along the plane's normal, and the two commute
//! ([`Height`](crate::task::Task)). One slider of each leg's section moves along the normal, the *lift*, and the others
//! only move in the plane or about its normals. Then the lift's displacement is the height, wherever in the leg it is,
//! and the other joints are a chain in the plane.

use super::leg::{ChainCoordinate, CompileContext, RefusedLeg, coordinate_number};
use super::{Manipulator, Section};
use crate::chain::limits::Limits;
use crate::decomposition::{Freedom, LegSplit, height};
use crate::group::JointDisplacement;
use crate::mechanism::leg::Leg;

/// The joint that carries the height of a leg's section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift {
    pub coordinate: ChainCoordinate,
    /// Its displacement for a unit of height: 1, or -1 where it moves down.
    pub sign: f64,
}

impl Lift {
    /// The displacement of the joint at a height above home, metres.
    #[inline]
    pub fn displacement(&self, rise: f64) -> f64 {
        self.sign * rise
    }

    /// The height above home at a displacement of the joint, metres.
    pub fn rise(&self, displacement: f64) -> f64 {
        self.sign * displacement
    }
}

/// The joint of a leg that carries the height, and the split of the leg's other joints; `None` without a height.
///
/// # Errors
/// There is no such joint, or several joints have a part in the height.
pub(super) fn separate(
    leg: &Leg,
    split: &LegSplit,
    first: usize,
    context: CompileContext<'_>,
) -> Result<Option<(Lift, LegSplit)>, RefusedLeg> {
    let Some(height) = &context.task.height else { return Ok(None) };
    let freedoms = match height.section {
        Section::Lower => &split.lower,
        Section::Upper => &split.upper,
    };
    let (lift, sign) = height::lift(leg, freedoms, &height.up, context.size)?;
    let others = |list: &[Freedom]| list.iter().copied().filter(|f| *f != lift).collect();
    let mut rest = split.clone();
    match height.section {
        Section::Lower => rest.lower = others(&split.lower),
        Section::Upper => rest.upper = others(&split.upper),
    }
    let number = first + coordinate_number(leg, lift);
    let coordinate = ChainCoordinate { number, actuated: context.actuated[number] };
    Ok(Some((Lift { coordinate, sign }, rest)))
}

impl Manipulator {
    /// The lifts, leg by leg; none without a height.
    #[inline]
    pub(crate) fn lifts(&self) -> impl Iterator<Item = &Lift> {
        let any = self.task().height.is_some();
        self.legs.iter().take(if any { usize::MAX } else { 0 }).filter_map(|leg| leg.lift.as_ref())
    }

    /// The value and whether it is within its limits of a lift at a height above home, metres.
    #[inline]
    pub(super) fn lifted(&self, lift: &Lift, rise: f64) -> (f64, bool) {
        let number = lift.coordinate.number;
        let displacement = lift.displacement(rise);
        let within = self.limits()[number].admits(JointDisplacement::Value(displacement));
        (self.coordinates()[number].home + displacement, within)
    }

    /// Whether all lifts are within their limits at a height above home, metres.
    #[inline]
    pub(super) fn lifts_admit(&self, rise: f64) -> bool {
        self.lifts().all(|lift| self.lifted(lift, rise).1)
    }

    /// Whether all lifts of a section are within their limits, for the values of the section's coordinates.
    #[doc(hidden)]
    pub fn height_admitted(&self, section: Section, of_section: &[f64]) -> bool {
        let Some(place) = self.task().height_in(section) else { return true };
        let home = self.task().coordinates[self.task().range(section)][place].home;
        self.lifts_admit(of_section[place] - home)
    }

    /// The limits of the heights above home that the lifts admit.
    pub(crate) fn lift_limits(&self) -> impl Iterator<Item = (&Lift, &Limits)> {
        self.lifts().map(|lift| (lift, &self.limits()[lift.coordinate.number]))
    }
}
