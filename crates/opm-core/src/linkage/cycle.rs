//! The full cycle of a linkage: everything that it can do from home without being taken apart.

use super::LinkageBranch;
use crate::mechanism::joint::Quantity;
use std::f64::consts::PI;

/// The closed motion of a linkage that starts at home with its input growing.
///
/// An input that can make a full revolution does so, in the home branch; so does a slider that is
/// moved by the revolutions of a screw. A traced loop may be home only after several revolutions. Any other input comes to an end
/// of its range, where the loop folds. The linkage then moves back in the other branch that meets there, and so on until it is
/// home again.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    pub(super) home: f64,
    pub(super) shape: CycleShape,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum CycleShape {
    /// Full revolutions of the input, or another period of it, each in its branch.
    Revolution(Vec<LinkageBranch>, f64),
    /// Arcs from fold to fold. The last one ends where the first one starts. The number says at
    /// which part of the first arc home is, 0 to 1. (The input makes no revolution by going back
    /// and forth: if its loop has no full revolution, its range lies between two folds.)
    Arcs(Vec<CycleArc>, f64),
}

/// A branch between two folds; its ends are displacements of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CycleArc {
    pub from: f64,
    pub to: f64,
    pub branch: LinkageBranch,
}

impl CycleArc {
    /// The input's displacement at a part of the arc, 0 to 1. The input stands still at a fold,
    /// where the velocities of all other joints would otherwise be infinite.
    fn at(&self, part: f64) -> f64 {
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * (self.to - self.from));
        (middle - half * (PI * part).cos()).clamp(self.from.min(self.to), self.from.max(self.to))
    }
}

impl Cycle {
    /// The input's reported value, and the branch, at a phase of 0 to 1 of the cycle. Both ends are
    /// home; for an input with a full revolution, the end is one revolution later. (Screws whose
    /// axis has made revolutions have then moved on.)
    pub fn at(&self, phase: f64) -> (f64, LinkageBranch) {
        let phase = phase.clamp(0.0, 1.0);
        match &self.shape {
            CycleShape::Revolution(branches, period) => {
                let along = phase * branches.len() as f64;
                let branch = branches[(along as usize).min(branches.len() - 1)];
                (self.home + period * along, branch)
            }
            CycleShape::Arcs(arcs, start) => {
                let along = phase * arcs.len() as f64 + start;
                let arc = arcs[along as usize % arcs.len()];
                // Both ends are exactly home, without rounding.
                let ends = phase == 0.0 || phase == 1.0;
                let displacement = if ends { 0.0 } else { arc.at(along.fract()) };
                (self.home + displacement, arc.branch)
            }
        }
    }

    /// A cycle from fold to fold and back, with home in the first arc.
    pub(super) fn arcs(home: f64, arcs: Vec<CycleArc>) -> Self {
        let CycleArc { from, to, .. } = arcs[0];
        let half = 0.5 * (to - from);
        let part =
            if half == 0.0 { 0.0 } else { ((from + half) / half).clamp(-1.0, 1.0).acos() / PI };
        Self { home, shape: CycleShape::Arcs(arcs, part) }
    }

    /// Whether the input makes a full revolution.
    pub fn is_revolution(&self) -> bool {
        matches!(self.shape, CycleShape::Revolution(..))
    }
}

/// Why a linkage has no cycle: it moves on to infinity, and does not come home.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "moved by {input}, the linkage does not come home: a joint goes to infinity as {input} nears {}",
    if end.is_finite() { format!("{end} {}", quantity.unit()) } else { "infinity".to_owned() }
)]
pub struct NoCycle {
    /// The name of the input.
    pub input: String,
    /// The value of the input where that happens, radians or metres; it may be infinite.
    pub end: f64,
    /// Whether the input is an angle or a length.
    pub quantity: Quantity,
}
