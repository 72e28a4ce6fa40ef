//! The actuated joints, held at given displacements, and what they impose on the sections.

use super::along::{self, along};
use crate::chain::condition::{Condition, flat_joints};
use crate::chain::planar::PlanarJoint;
use crate::chain::track::Track;
use crate::chain::{Branch, Chain, ReachDeficit, planar};
use crate::group::{Displacement, JointDisplacement, LocalTwist, SubspaceKind};
use crate::manipulator::plan::{Anchor, Plan, Tracked};
use crate::manipulator::{CompiledLeg, Manipulator, Section};
use crate::numeric::angle::whole_turns;
use nalgebra::Complex;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// The possible values of a leg's displacement τ along the intersection motion.
pub(super) enum Taus {
    /// One value, or two.
    At([Option<JointDisplacement>; 2]),
    /// No actuated joint fixes τ, or nothing depends on it.
    Free,
    /// The leg is out of reach, by this deficit at least.
    None(ReachDeficit),
}

/// The actuated joints of a manipulator, held at given displacements.
pub(super) struct Held<'a> {
    pub manipulator: &'a Manipulator,
    pub plan: &'a Plan,
    /// The displacements of the actuated joints from home, radians and metres.
    pub displacements: &'a [f64],
    /// The height above home, metres, of the first actuated lift.
    pub rise: f64,
    /// The legs at that height, or at their own. A leg whose own height is not known is as it is at home, with its lift.
    pub legs: Cow<'a, [CompiledLeg]>,
}

/// The heights above home that the actuated lifts give, metres.
fn rises<'a>(m: &'a Manipulator, displacements: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    m.lifts().filter_map(|lift| Some(lift.rise(displacements[lift.coordinate.actuated?])))
}

impl<'a> Held<'a> {
    /// Nothing is allocated where the legs are the same at every height.
    pub fn new(manipulator: &'a Manipulator, plan: &'a Plan, displacements: &'a [f64]) -> Self {
        let rise = rises(manipulator, displacements).next().unwrap_or(0.0);
        // Where legs have heights of their own, that of an actuated lift is known.
        let of_leg = |leg: &CompiledLeg| match &leg.lift {
            Some(lift) if lift.slope != 0.0 => {
                Some(lift.rise(displacements[lift.coordinate.actuated?]))
            }
            _ => Some(rise),
        };
        let legs = manipulator.legs_at(of_leg);
        Self { manipulator, plan, displacements, rise, legs }
    }

    /// By how much the heights of the actuated lifts differ from the first one, in shares of the size.
    pub fn contradiction_of_heights(&self) -> f64 {
        let apart = |rise: f64| (rise - self.rise).abs() / self.manipulator.closure.size;
        rises(self.manipulator, self.displacements).map(apart).fold(0.0, f64::max)
    }

    /// The displacement of a joint of a leg's chain; zero if that joint is not actuated.
    fn displacement(&self, leg: usize, section: Section, joint: usize) -> JointDisplacement {
        let coordinate = self.legs[leg].section(section).coordinates[joint];
        let actuated = coordinate.and_then(|coordinate| coordinate.actuated);
        JointDisplacement::Value(actuated.map_or(0.0, |number| self.displacements[number]))
    }

    /// The condition that an actuated joint of the lower section puts on `v`, or on `v · exp(I τ)`.
    fn lower_condition(&self, leg: usize, joint: usize) -> Option<Condition> {
        self.legs[leg].lower.condition(joint, self.displacement(leg, Section::Lower, joint))
    }

    /// The track on which a leg keeps the axis of the intersection motion.
    fn track(&self, leg: usize, joint: usize) -> Option<Track> {
        let compiled = &self.legs[leg];
        match compiled.split_section {
            Section::Lower => Track::of_condition(&self.lower_condition(leg, joint)?),
            Section::Upper => {
                let displacements =
                    [0, 1, 2].map(|joint| self.displacement(leg, Section::Lower, joint));
                let foot = match &compiled.lower.offset {
                    None => Complex::ZERO,
                    Some(offset) => offset.inverse().planar().translation,
                };
                Track::of_chain(&compiled.lower.chain, joint, &displacements, foot)
            }
        }
    }

    /// The displacements `v` at which two legs meet that keep the axis of the intersection motion on a track each.
    /// `None` where they meet on a whole track.
    pub fn meetings(&self, tracked: &[Tracked; 2]) -> Option<[Option<Displacement>; 2]> {
        let [Some(first), Some(second)] =
            tracked.map(|tracked| self.track(tracked.leg, tracked.joint))
        else {
            return Some([None; 2]);
        };
        first.meetings(&second, self.manipulator.closure.size)
    }

    /// The displacement `v` perpendicular to the intersection motion that an actuated joint of a leg fixes.
    pub fn level(&self, leg: usize, joint: usize) -> Displacement {
        let kind = self.manipulator.task().lower.kind;
        match self.lower_condition(leg, joint) {
            Some(Condition::Flat { normal, value }) => {
                kind.of_sum(&(normal * (value / normal.norm_squared())))
            }
            _ => unreachable!("a plan has such an anchor in a commutative subspace only"),
        }
    }

    /// The displacement of the lower section of a leg whose lower joints are all actuated.
    pub fn actuated_lower_section(&self, leg: usize) -> Displacement {
        let q = [0, 1, 2].map(|joint| self.displacement(leg, Section::Lower, joint));
        let lower = &self.legs[leg].lower;
        let reached = match &lower.chain {
            // A plan is of legs that are split.
            Chain::Rigid | Chain::Part(_) => SubspaceKind::Identity.identity(),
            Chain::Planar(chain) => Displacement::Planar(planar::forward(&chain.joints(), &q)),
            Chain::Spherical(chain) => Displacement::Spherical(chain.forward(&q)),
            Chain::Ball(ball) => Displacement::Spherical(ball.forward(&q)),
            Chain::Cylindrical(chain) => Displacement::Cylindrical(chain.forward(&[q[0], q[1]])),
            Chain::Translational(chain) => {
                Displacement::Translational(chain.forward(&[q[0], q[1]]))
            }
            Chain::Spatial(chain) => Displacement::Spatial(chain.forward(&q)),
        };
        match &lower.offset {
            None => reached,
            Some(offset) => reached.after(&offset.inverse()),
        }
    }

    /// The τ of one of several coupled legs, where the functional of `b` that couples them is zero.
    fn coupled_tau(&self, leg: usize, functional: &LocalTwist) -> JointDisplacement {
        let held = self.plan.legs[leg].upper.first();
        let driven = held.and_then(|&joint| {
            let chain = &self.legs[leg].upper.chain;
            let moved = flat_joints(chain)?[joint];
            let value = self.displacement(leg, Section::Upper, joint).value();
            Some(-functional.dot(&moved) * value)
        });
        JointDisplacement::Value(driven.unwrap_or(0.0))
    }

    /// The conditions on `v` where it is solved for by all of its own at a time: those of sections that share nothing,
    /// or of coupled legs, whose τ are written to `taus`.
    pub fn write_lower_conditions(
        &self,
        taus: &mut [Option<JointDisplacement>],
        conditions: &mut Vec<Condition>,
    ) {
        conditions.clear();
        let m = self.manipulator;
        for (number, held) in self.plan.legs.iter().enumerate() {
            let own = held.lower.iter().filter_map(|&joint| self.lower_condition(number, joint));
            match &self.plan.anchor {
                Anchor::CoupledLegs { functional, legs } if legs.contains(&number) => {
                    let tau = self.coupled_tau(number, functional);
                    taus[number] = Some(tau);
                    let along = m.task().lower_intersection.displacement(tau);
                    conditions.extend(own.map(|condition| condition.before(&along)));
                }
                Anchor::CoupledLegs { .. } if self.legs[number].split_section == Section::Upper => {
                }
                _ => conditions.extend(own),
            }
        }
    }

    /// The possible values of a leg's τ, with `v` known.
    pub fn taus(&self, number: usize, v: &Displacement) -> Taus {
        let m = self.manipulator;
        let (leg, held) = (&self.legs[number], &self.plan.legs[number]);
        match leg.split_section {
            Section::Upper => {
                for &joint in &held.lower {
                    let Some(condition) = self.lower_condition(number, joint) else { continue };
                    match along(&condition, v, &m.task().lower_intersection, m.closure.size) {
                        along::Solutions::At(taus) => return Taus::At(taus),
                        along::Solutions::None(deficit) => return Taus::None(deficit),
                        // Another actuated joint may fix τ.
                        along::Solutions::Any => {}
                    }
                }
                Taus::Free
            }
            Section::Lower if held.upper.is_empty() => Taus::Free,
            Section::Lower => {
                let mut taus = [None; 2];
                let mut deficit = None;
                for (tau, branch) in taus.iter_mut().zip(Branch::BOTH) {
                    match leg.lower.inverse(v, branch) {
                        Ok(displacements) => {
                            *tau = Some(displacements[leg.lower.chain.freedoms() - 1].inverse());
                        }
                        Err(missed) => deficit = Some(missed),
                    }
                    if !leg.lower.has_choice() {
                        break;
                    }
                }
                match (taus, deficit) {
                    ([None, None], Some(deficit)) => Taus::None(deficit),
                    ([None, tau], _) => Taus::At([tau, None]),
                    (taus, _) => Taus::At(taus),
                }
            }
        }
    }

    /// The conditions on `b`, with `v` and every τ known.
    pub fn write_upper_conditions(
        &self,
        taus: &[Option<JointDisplacement>],
        conditions: &mut Vec<Condition>,
    ) {
        conditions.clear();
        let m = self.manipulator;
        let slider_angle = self.slider_angle(taus);
        for (number, (leg, tau)) in self.legs.iter().zip(taus).enumerate() {
            let chain = &leg.upper.chain;
            let own = self.plan.legs[number].upper.iter().filter_map(|&joint| {
                leg.upper.condition(joint, self.displacement(number, Section::Upper, joint))
            });
            match (leg.split_section, tau) {
                (Section::Upper, Some(tau)) => {
                    let tau = match tau {
                        JointDisplacement::Direction(_) if m.task().upper.kind.commutes() => {
                            let counted = tau.nearest(slider_angle) + self.whole_turns(number);
                            JointDisplacement::Value(if only_slides(chain) {
                                slider_angle
                            } else {
                                counted
                            })
                        }
                        JointDisplacement::Direction(_) | JointDisplacement::Value(_) => *tau,
                    };
                    conditions.extend(leg.upper.condition(0, tau));
                    conditions.extend(own);
                }
                (Section::Upper, None) => conditions.extend(own),
                (Section::Lower, Some(tau)) => {
                    let along = m.task().upper_intersection.displacement(*tau);
                    conditions.extend(own.map(|condition| condition.after(&along)));
                }
                (Section::Lower, None) => {}
            }
        }
    }

    /// The angle of a platform on a cylinder, as a leg whose upper joint only slides fixes it. The angles of
    /// screws are then taken within π of it. Zero if there is no such leg.
    fn slider_angle(&self, taus: &[Option<JointDisplacement>]) -> f64 {
        let legs = self.legs.iter().zip(taus);
        let slider_angle = legs.filter_map(|(leg, tau)| match (leg.split_section, tau) {
            (Section::Upper, Some(tau)) if only_slides(&leg.upper.chain) => Some(tau.value()),
            _ => None,
        });
        slider_angle.take(1).sum()
    }

    /// The full revolutions, as an angle in radians, that the actuated revolute joints of a planar section
    /// pass on to a screw.
    fn whole_turns(&self, leg: usize) -> f64 {
        let Chain::Planar(chain) = &self.legs[leg].lower.chain else { return 0.0 };
        let joints = chain.joints();
        let revolutions = |&joint: &usize| match joints[joint] {
            PlanarJoint::Revolute { reversed, .. } => {
                let count = whole_turns(self.displacement(leg, Section::Lower, joint).value());
                if reversed { -count } else { count }
            }
            PlanarJoint::Prismatic { .. } => 0.0,
        };
        TAU * self.plan.legs[leg].lower.iter().map(revolutions).sum::<f64>()
    }
}

/// Whether a chain of the imaginary joint and one other is a splined shaft: the imaginary joint rotates,
/// and the other only slides.
fn only_slides(chain: &Chain) -> bool {
    match chain {
        Chain::Cylindrical(chain) => {
            chain.joints()[0].rotation != 0.0 && chain.joints()[1].rotation == 0.0
        }
        Chain::Rigid
        | Chain::Part(_)
        | Chain::Planar(_)
        | Chain::Spherical(_)
        | Chain::Ball(_)
        | Chain::Translational(_)
        | Chain::Spatial(_) => false,
    }
}
