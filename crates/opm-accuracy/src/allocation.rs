//! Permitted tolerances: how inaccurate each axis may be so that no joint needs more play than its clearance.

use crate::response::Response;
use crate::source::Source;
use crate::tolerance::Both;
use crate::zonotope::farthest;
use nalgebra::{Matrix6xX, Vector3};
use opm_core::Quantity;

/// A play is nothing if it is below this share of the largest one, or of the error itself, if no play is larger: rounding.
const NOTHING: f64 = 1e-9;

/// The tolerances that keep the play of every joint within a clearance, at all poses that were added.
///
/// Errors of axes count, not those of actuators and of a family's parameters: these fit, as far as the mechanism stays
/// in its class. Each error is between minus and plus its tolerance, to first order.
#[derive(Clone, Debug, PartialEq)]
pub struct Allocation {
    clearance: Both,
    length: f64,
    /// For each source; infinite where it needs no play, and for those that do not count.
    permitted: Vec<Permitted>,
    uniform: f64,
}

/// The tolerance that one error may have, radians or metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permitted {
    /// If it is the only error.
    pub alone: f64,
    /// If all errors come together, and each of the `n` errors that need play at a joint may use `1 / n` of the clearance
    /// there.
    pub share: f64,
}

impl Permitted {
    /// Any tolerance.
    pub const UNLIMITED: Self = Self { alone: f64::INFINITY, share: f64::INFINITY };

    /// The smaller of both tolerances.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { alone: self.alone.min(other.alone), share: self.share.min(other.share) }
    }
}

impl Allocation {
    /// For a clearance of joints, metres and radians; `None` where it is not limited. The characteristic length compares
    /// lengths with angles in [`uniform`](Self::uniform).
    pub fn new(clearance: Both, length: f64, sources: usize) -> Self {
        let permitted = vec![Permitted::UNLIMITED; sources];
        Self { clearance, length, permitted, uniform: f64::INFINITY }
    }

    /// Adds a pose.
    ///
    /// # Panics
    /// If the response is not to as many errors.
    pub fn add(&mut self, response: &Response, sources: &[Source]) {
        assert_eq!(response.twists.ncols(), self.permitted.len(), "a response to each error");
        let of_axis: Vec<usize> =
            (0..sources.len()).filter(|&k| sources[k].joint.is_some()).collect();
        for quantity in [Quantity::Length, Quantity::Angle] {
            let Some(clearance) = self.clearance.of(quantity) else { continue };
            let row = if quantity == Quantity::Angle { 0 } else { 3 };
            let length = self.length;
            let part = |plays: &Matrix6xX<f64>, k: usize| -> Vector3<f64> {
                let unit = unit(sources[k].quantity, length);
                plays.fixed_view::<3, 1>(row, k) * unit
            };
            let all = response.plays.iter().flat_map(|p| of_axis.iter().map(move |&k| (p, k)));
            // An error of one length, or of the angle that counts as one, is a play of one such unit in its own axis.
            let itself = unit(quantity, length);
            let largest = all.map(|(plays, k)| part(plays, k).norm()).fold(itself, f64::max);
            for plays in &response.plays {
                let needs = |&k: &usize| part(plays, k).norm() > NOTHING * largest;
                let needing: Vec<usize> = of_axis.iter().copied().filter(needs).collect();
                let parts: Vec<_> = needing.iter().map(|&k| part(plays, k)).collect();
                for (&k, part) in needing.iter().zip(&parts) {
                    let alone = clearance / part.norm() * unit(sources[k].quantity, length);
                    let share = alone / needing.len() as f64;
                    let permitted = &mut self.permitted[k];
                    *permitted = permitted.and(Permitted { alone, share });
                }
                let together = farthest(&parts).norm();
                if together > 0.0 {
                    self.uniform = self.uniform.min(clearance / together);
                }
            }
        }
    }

    /// Adds the poses of another allocation for the same errors.
    pub fn merge(&mut self, other: &Self) {
        for (own, other) in self.permitted.iter_mut().zip(&other.permitted) {
            *own = own.and(*other);
        }
        self.uniform = self.uniform.min(other.uniform);
    }

    /// The clearance of joints.
    pub fn clearance(&self) -> Both {
        self.clearance
    }

    /// The tolerance of each error, in the order of the sources.
    pub fn permitted(&self) -> &[Permitted] {
        &self.permitted
    }

    /// One tolerance for all axes together: for lengths, metres, and for angles, radians, which is that of lengths over the
    /// characteristic length. It is exact: with it, some joint needs its whole clearance at some pose.
    pub fn uniform(&self) -> [f64; 2] {
        let unit = |quantity| self.uniform * unit(quantity, self.length);
        [unit(Quantity::Length), unit(Quantity::Angle)]
    }
}

/// A tolerance of a quantity that counts as one.
fn unit(quantity: Quantity, length: f64) -> f64 {
    match quantity {
        Quantity::Length => 1.0,
        Quantity::Angle => length.recip(),
    }
}
