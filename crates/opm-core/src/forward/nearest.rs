//! Forward kinematics near a solution in the order of a plan: of the solutions of each section, the one that is nearest.

use super::held::{Held, Taus};
use super::solve;
use crate::chain::condition::{Condition, length};
use crate::group::{Displacement, JointDisplacement};
use crate::manipulator::Solution;
use crate::manipulator::plan::Anchor;

/// The buffers of [`Held::nearest`].
#[derive(Clone, Debug, Default)]
pub(super) struct NearestBuffer {
    taus: Vec<Option<JointDisplacement>>,
    conditions: Vec<Condition>,
}

impl NearestBuffer {
    /// Buffers for a manipulator with this number of legs.
    pub fn new(legs: usize) -> Self {
        // A leg imposes one condition for each joint of a chain at most.
        Self { taus: Vec::with_capacity(legs), conditions: Vec::with_capacity(4 * legs) }
    }
}

impl Held<'_> {
    /// The displacements `v` and `b` near those of a solution for which the actuated joints have their values; `None` where
    /// there are none, or the plan does not find one without the others. Nothing is allocated.
    pub fn nearest(
        &self,
        seed: &Solution,
        NearestBuffer { taus, conditions }: &mut NearestBuffer,
    ) -> Option<[Displacement; 2]> {
        let m = self.manipulator;
        let size = m.closure.size;
        let (old_v, old_b) = (&seed.solved.v, &seed.solved.b);
        taus.clear();
        taus.resize(self.legs.len(), None);
        let v = match &self.plan.anchor {
            Anchor::Flat(_) => return None,
            Anchor::Sections | Anchor::CoupledLegs { .. } => {
                self.write_lower_conditions(taus, conditions);
                solve::near(old_v, conditions, size)?
            }
            Anchor::Leg(leg) => {
                taus[*leg] = Some(JointDisplacement::Value(0.0));
                self.actuated_lower_section(*leg)
            }
            Anchor::Tracks(tracked) => {
                let found = self.meetings(tracked)?.into_iter().flatten();
                let aligned = found.map(|v| m.task().aligned(&v, old_v).0);
                nearest(aligned, |v| distance(v, old_v, size))?
            }
            Anchor::Level { leg, joint } => self.level(*leg, *joint),
        };
        let (v, removed) = m.task().aligned(&v, old_v);
        if !matches!(self.plan.anchor, Anchor::Sections) {
            for (leg, tau) in taus.iter_mut().enumerate() {
                *tau = match tau {
                    Some(tau) => Some(removed.plus(*tau)),
                    None => match self.taus(leg, &v) {
                        Taus::None(_) => return None,
                        Taus::Free => None,
                        Taus::At(found) => {
                            let old = seed.legs[leg].tau;
                            nearest(found.into_iter().flatten(), |tau| angle_or_length(*tau, old))
                        }
                    },
                };
            }
        }
        self.write_upper_conditions(taus, conditions);
        Some([v, solve::near(old_b, conditions, size)?])
    }
}

/// The candidate with the smallest distance.
fn nearest<T>(candidates: impl Iterator<Item = T>, distance: impl Fn(&T) -> f64) -> Option<T> {
    candidates.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The difference of two displacements of a joint: of angles that of their directions.
fn angle_or_length(a: JointDisplacement, b: JointDisplacement) -> f64 {
    match (a, b) {
        (JointDisplacement::Value(a), JointDisplacement::Value(b)) => (a - b).abs(),
        (JointDisplacement::Direction(_), _) | (_, JointDisplacement::Direction(_)) => {
            length(a.unit_direction() - b.unit_direction())
        }
    }
}

/// How far two displacements of a section are apart, in radians and shares of the size.
pub(super) fn distance(a: &Displacement, b: &Displacement, size: f64) -> f64 {
    match (a, b) {
        (Displacement::Planar(a), Displacement::Planar(b)) => {
            length(a.rotation - b.rotation) + length(a.translation - b.translation) / size
        }
        (Displacement::Spherical(a), Displacement::Spherical(b)) => (a - b).norm(),
        _ => (a.sum() - b.sum()).component_div(&a.kind().sum_units(size)).norm(),
    }
}
