//! Products of exponentials inside one subspace, differentiated: `g = exp(ξ₁q₁) … exp(ξₙqₙ)`.
//!
//! The twist is `V = ġ g⁻¹ = Σ sₖ q̇ₖ`, with the screws as they have moved,
//! `sₖ = Ad(exp(ξ₁q₁) … exp(ξₖ₋₁qₖ₋₁)) ξₖ` (Eq. 5 of the paper in a sphere), and its derivative
//! `V̇ = Σ sₖ q̈ₖ + Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`, since a screw moves with the joints before it.

use super::local::{Local, linear, planar_carried, quarter};
use crate::chain::Amount;
use crate::chain::planar::PlanarDisplacement;
use crate::task::SubspaceKind;
use nalgebra::Complex;

/// Three screws of one subspace, as they have moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screws {
    pub kind: SubspaceKind,
    pub moved: [Local; 3],
}

impl Screws {
    /// The screws of joints that are at `amounts`, from their screws at home.
    #[inline]
    pub fn new(kind: SubspaceKind, home: &[Local; 3], amounts: &[Amount; 3]) -> Self {
        let [s1, s2, s3] = *home;
        let moved = match kind {
            SubspaceKind::Planar => {
                let first = displacement(&s1, amounts[0]);
                let second = first.after(&displacement(&s2, amounts[1]));
                [s1, planar_carried(&first, &s2), planar_carried(&second, &s3)]
            }
            SubspaceKind::Spherical => {
                let (q1, q2) = (amounts[0].turn(), amounts[1].turn());
                [s1, rotate(&s1, q1, &s2), rotate(&s1, q1, &rotate(&s2, q2, &s3))]
            }
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => *home,
        };
        Self { kind, moved }
    }

    /// `Σ sₖ q̇ₖ`.
    #[inline]
    pub fn twist(&self, rates: &Local) -> Local {
        let [s1, s2, s3] = &self.moved;
        s1 * rates.x + s2 * rates.y + s3 * rates.z
    }

    /// `Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`: the twist's derivative at constant rates.
    #[inline]
    pub fn bias(&self, rates: &Local) -> Local {
        let [s1, s2, s3] = &self.moved;
        let (t1, t2, t3) = (s1 * rates.x, s2 * rates.y, s3 * rates.z);
        self.kind.bracket(&t1, &(t2 + t3)) + self.kind.bracket(&t2, &t3)
    }

    /// The reciprocal screws, each square to the other two, not yet divided by the determinant, which
    /// is the second: `sᵢ · rⱼ = δᵢⱼ det`.
    #[inline]
    pub fn reciprocal(&self) -> ([Local; 3], f64) {
        let [s1, s2, s3] = &self.moved;
        let rows = [s2.cross(s3), s3.cross(s1), s1.cross(s2)];
        (rows, s1.dot(&rows[0]))
    }
}

/// The displacement along a planar screw.
#[inline]
fn displacement(screw: &Local, amount: Amount) -> PlanarDisplacement {
    if screw.x == 0.0 {
        return PlanarDisplacement {
            rotation: Complex::new(1.0, 0.0),
            translation: linear(screw) * amount.value(),
        };
    }
    let turn = amount.turn();
    let rotation = if screw.x < 0.0 { turn.conj() } else { turn };
    // v = -i ω p, with ω = ±1.
    let at = quarter(linear(screw)) * screw.x;
    PlanarDisplacement { rotation, translation: at - rotation * at }
}

/// `exp(axis q) v`, with `q` as a unit vector.
#[inline]
fn rotate(axis: &Local, q: Complex<f64>, v: &Local) -> Local {
    v * q.re + axis.cross(v) * q.im + axis * (axis.dot(v) * (1.0 - q.re))
}
