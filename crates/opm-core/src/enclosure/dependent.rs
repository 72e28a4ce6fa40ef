//! The dependent coordinates of a box of poses: what [`Dependent::complete`](crate::manipulator::Dependent) does for one
//! pose, with bounds.

use super::LegConditions;
use super::target::{self, Coordinate};
use crate::boxes::Share;
use crate::boxes::chain::share;
use crate::boxes::{Affine, Plane};
use crate::boxes::{Enclosed, Target};
use crate::chain::REACH_TOLERANCE;
use crate::group::SubspaceKind;
use crate::manipulator::CompiledLeg;
use crate::manipulator::dependent::constraint::{Constraint, follows};
use crate::manipulator::dependent::one_joint::OneJoint;
use crate::manipulator::dependent::zeros::Function;
use crate::manipulator::dependent::{Closed, Step};
use crate::mechanism::leg::Section;
use crate::numeric::Quantity;
use std::f64::consts::{PI, TAU};

/// Half a revolution, and the rounding of an angle that is within it.
const HALF_TURN: f64 = PI * (1.0 + 1e-12);

/// Of a coordinate that may be farther than this from its middle, radians or metres, nothing is known.
const MOST: f64 = 1e9;

/// The end of a range without an end.
const INFINITE: f64 = f64::INFINITY;

impl<const N: usize> LegConditions<'_, N> {
    /// Writes the dependent coordinates, which are at home so far, to their places among all those of a box. Returns the share of the box for which they
    /// exist, with the choices that are given.
    ///
    /// # Errors
    /// Too little is known of a coordinate for bounds of anything else: the share of the box for which the others exist, as
    /// the most that meets any query.
    pub(super) fn complete(&self, pose: &mut [Coordinate<N>]) -> Result<Share<N>, Share<N>> {
        let mut share = Share::ALL;
        let Some(dependent) = &self.manipulator.dependent else { return Ok(share) };
        for step in dependent.steps() {
            share = share.and(self.take(step, pose));
            if share.is_none() {
                break;
            }
            let unknown = |&coordinate: &usize| !pose[coordinate].is_within(MOST);
            if step.solution.coordinates().iter().any(unknown) {
                let given =
                    dependent.independent.iter().map(|&coordinate| pose[coordinate].spread());
                let spread =
                    given.fold([0.0; N], |sum, own| std::array::from_fn(|i| sum[i] + own[i]));
                return Err(Share::undecided(
                    &Affine::unknown(0.0, 1.0, &spread),
                    0.0,
                    share.upper,
                ));
            }
        }
        Ok(share)
    }

    /// Takes one step of the solution. Returns the share for which its coordinates exist.
    fn take(&self, step: &Step, pose: &mut [Coordinate<N>]) -> Share<N> {
        let sign = step.sign(self.choices.chosen);
        match &step.solution {
            // They are at home.
            Closed::Constant { .. } => Share::ALL,
            Closed::Condition { constraint, coordinate, function } => {
                let Constraint { leg, section, condition } = constraint;
                let (known, tau) = self.tau_before(*leg, *section, pose);
                let values = function.places().map(|place| {
                    pose[*coordinate] = Coordinate::Linear(Affine::constant(place));
                    condition.value(&self.target_of(*leg, *section, tau, pose))
                });
                let (exists, found) = zero(function, constraint.has_choice(function), values, sign);
                let found =
                    if function.harmonic { self.near_home(found, function.home) } else { found };
                pose[*coordinate] = Coordinate::Linear(found);
                known.and(exists)
            }
            Closed::Joint(joint) => {
                let (known, tau) = self.tau_before(joint.leg, joint.section, pose);
                known.and(self.take_joint(joint, sign, tau, pose))
            }
        }
    }

    /// Takes the coordinates of a section with one joint. Returns the share for which they exist.
    fn take_joint(
        &self,
        joint: &OneJoint,
        sign: f64,
        tau: Enclosed<N>,
        pose: &mut [Coordinate<N>],
    ) -> Share<N> {
        let task = self.manipulator.task();
        let kind = match joint.section {
            Section::Lower => task.lower.kind,
            Section::Upper => task.upper.kind,
        };
        let at = std::array::from_fn(|i| match joint.all.get(i).map(|&i| pose[i]) {
            Some(Coordinate::Linear(value)) => value,
            // It tells nothing.
            Some(Coordinate::Polar(_)) | None => Affine::constant(0.0),
        });
        let (exists, found) = joint.found(self.manipulator, tau, sign, at);
        let exists = share(&exists, REACH_TOLERANCE);
        for ((follows, &coordinate), value) in joint.follows.iter().zip(&joint.all).zip(found) {
            let home = task.coordinates[coordinate].home;
            pose[coordinate] = Coordinate::Linear(match follows {
                Some(Quantity::Angle) if kind != SubspaceKind::Cylindrical => {
                    self.near_home(value, home)
                }
                Some(_) => value,
                None => continue,
            });
        }
        exists
    }

    /// The displacement τ of a leg along the intersection motion, where that follows from the section other than this one,
    /// and the share for which that is in reach; zero otherwise.
    fn tau_before(
        &self,
        number: usize,
        section: Section,
        pose: &[Coordinate<N>],
    ) -> (Share<N>, Enclosed<N>) {
        let (leg, task) = (self.leg(number), self.manipulator.task());
        let joint = leg.imaginary_joint().filter(|_| follows(task, leg, section));
        let Some(joint) = joint else {
            return (Share::ALL, Enclosed::Value(Affine::constant(0.0)));
        };
        let bridge = leg.split_section;
        let target = self.displacement(bridge, pose);
        let chain = self.chain(number, bridge, &target);
        let branch = self.manipulator.branches(self.choices.chosen, number).of(bridge);
        let step = chain.displacements(branch)[joint];
        let step = if leg.unwinds() { Enclosed::Value(near(step.number(), 0.0)) } else { step };
        let tau = if bridge == Section::Lower { step.inverse() } else { step };
        (chain.closes(), tau)
    }

    /// The displacement of a section.
    fn displacement(&self, section: Section, pose: &[Coordinate<N>]) -> Target<N> {
        let task = self.manipulator.task();
        match section {
            Section::Lower => target::task::lower(task, &pose[..task.lower_count]),
            Section::Upper => target::task::upper(task, &pose[task.lower_count..]),
        }
    }

    /// What a section's constraint is on: its displacement, after that of the imaginary joint if that belongs to the other
    /// section.
    fn target_of(
        &self,
        leg: usize,
        section: Section,
        tau: Enclosed<N>,
        pose: &[Coordinate<N>],
    ) -> Target<N> {
        let (task, own) = (self.manipulator.task(), self.displacement(section, pose));
        match section {
            _ if !follows(task, self.leg(leg), section) => own,
            Section::Lower => task.lower_intersection.after(&own, tau),
            Section::Upper => task.upper_intersection.before(&own, tau.inverse()),
        }
    }

    /// An angle up to full revolutions as the one that is nearest to `home`. A box that contains both ends of the range of these
    /// gets two ranges of angles that join, unless revolutions are counted anywhere.
    fn near_home(&self, angle: Affine<N>, home: f64) -> Affine<N> {
        let counted = self.manipulator.legs.iter().any(CompiledLeg::unwinds);
        if !counted && angle.radius() < PI {
            return angle - TAU * turns(angle, home);
        }
        near(angle, home)
    }
}

/// An angle up to full revolutions as the one that is within half a revolution of `home`.
pub fn near<const N: usize>(angle: Affine<N>, home: f64) -> Affine<N> {
    let near = angle - TAU * turns(angle, home);
    let within = near.low() >= home - PI && near.high() <= home + PI;
    if within { near } else { Affine::unknown(home, HALF_TURN, &near.spread()) }
}

/// The full revolutions from `home` to the middle of an angle's range.
fn turns<const N: usize>(angle: Affine<N>, home: f64) -> f64 {
    ((angle.centre - home) / TAU).round()
}

/// The zero at which a function with these values rises or falls (see [`Function::zero`]), and the share of the box for which
/// there is one.
fn zero<const N: usize>(
    function: &Function,
    has_choice: bool,
    [first, second, third]: [Affine<N>; 3],
    sign: f64,
) -> (Share<N>, Affine<N>) {
    let unit = function.unit;
    if function.harmonic {
        // c₀ + c₁ cos u + c₂ sin u, which rises before its crest.
        let c0 = (first + third) * 0.5;
        let axis = Plane { re: (first - third) * 0.5, im: second - c0 };
        let ahead = axis.norm_sqr() - c0.square();
        // It counts as zero as far as this beside the crest.
        let slack = REACH_TOLERANCE * unit * (2.0 * c0.furthest() + REACH_TOLERANCE * unit);
        let exists = Share::within(&ahead, [0.0, INFINITE], slack);
        let from_crest = Plane { re: -c0, im: ahead.sqrt() }.argument();
        return (exists, axis.argument() - from_crest * sign + function.home);
    }
    let (slope, bend) = ((third - first) * 0.5, (third + first) * 0.5 - second);
    if !has_choice {
        // A line.
        return (Share::ALL, -second * slope.recip() * function.step + function.home);
    }
    // The slope at a zero is the root of this.
    let square = slope.square() - bend * second * 4.0;
    let exists = Share::within(&square, [0.0, INFINITE], REACH_TOLERANCE * unit * unit);
    let u = (square.sqrt() * sign - slope) * (bend * 2.0).recip();
    (exists, u * function.step + function.home)
}
