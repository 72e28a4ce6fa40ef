//! Products of exponentials inside one subspace, differentiated: `g = exp(ξ₁q₁) … exp(ξₙqₙ)`.
//!
//! The twist is `V = ġ g⁻¹ = Σ sₖ q̇ₖ`, with the screws as they have moved,
//! `sₖ = Ad(exp(ξ₁q₁) … exp(ξₖ₋₁qₖ₋₁)) ξₖ` (Eq. 5 of the paper in a sphere), and its derivative
//! `V̇ = Σ sₖ q̈ₖ + Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`, since a screw moves with the joints before it.

use crate::group::{
    JointDisplacement, LocalTwist, Planar, PlanarDisplacement, Subgroup, SubspaceKind, rotated,
};

/// Three screws of one subspace, as they have moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screws {
    pub kind: SubspaceKind,
    pub moved: [LocalTwist; 3],
}

impl Screws {
    /// The screws of joints that are at `amounts`, from their screws at home.
    #[inline]
    pub fn new(
        kind: SubspaceKind,
        home: &[LocalTwist; 3],
        amounts: &[JointDisplacement; 3],
    ) -> Self {
        let [s1, s2, s3] = *home;
        let moved = match kind {
            SubspaceKind::Planar => {
                let first = PlanarDisplacement::along_screw(&s1, amounts[0]);
                let second = first.after(&PlanarDisplacement::along_screw(&s2, amounts[1]));
                [s1, Planar::adjoint(&first, &s2), Planar::adjoint(&second, &s3)]
            }
            SubspaceKind::Spherical => {
                let (q1, q2) = (amounts[0].unit_direction(), amounts[1].unit_direction());
                [s1, rotated(&s1, q1, &s2), rotated(&s1, q1, &rotated(&s2, q2, &s3))]
            }
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => *home,
        };
        Self { kind, moved }
    }

    /// `Σ sₖ q̇ₖ`.
    #[inline]
    pub fn twist(&self, rates: &LocalTwist) -> LocalTwist {
        let [s1, s2, s3] = &self.moved;
        s1 * rates.x + s2 * rates.y + s3 * rates.z
    }

    /// `Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`: the twist's derivative at constant rates.
    #[inline]
    pub fn bias(&self, rates: &LocalTwist) -> LocalTwist {
        let [s1, s2, s3] = &self.moved;
        let (t1, t2, t3) = (s1 * rates.x, s2 * rates.y, s3 * rates.z);
        self.kind.bracket(&t1, &(t2 + t3)) + self.kind.bracket(&t2, &t3)
    }

    /// The reciprocal screws, each perpendicular to the other two, not yet divided by the determinant, which
    /// is the second: `sᵢ · rⱼ = δᵢⱼ det`.
    #[inline]
    pub fn reciprocal(&self) -> ([LocalTwist; 3], f64) {
        let [s1, s2, s3] = &self.moved;
        let rows = [s2.cross(s3), s3.cross(s1), s1.cross(s2)];
        (rows, s1.dot(&rows[0]))
    }
}
