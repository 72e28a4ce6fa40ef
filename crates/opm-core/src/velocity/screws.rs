//! Derivatives of a product of exponentials inside one subspace, `g = exp(ξ₁q₁) … exp(ξₙqₙ)`.
//!
//! The twist is `V = ġ g⁻¹ = Σ sₖ q̇ₖ`, with the displaced screws
//! `sₖ = Ad(exp(ξ₁q₁) … exp(ξₖ₋₁qₖ₋₁)) ξₖ` (Eq. 5 of the paper, for a spherical subspace). Its derivative is
//! `V̇ = Σ sₖ q̈ₖ + Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`, because a screw moves with the joints before it.

use crate::group::{
    JointDisplacement, LocalTwist, Planar, PlanarDisplacement, Subgroup, SubspaceKind, rotated,
};

/// The displaced screws of up to three joints of one subspace.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screws {
    /// The kind of subspace.
    pub kind: SubspaceKind,
    /// The displaced screws, in the subspace's frame.
    pub moved: [LocalTwist; 3],
}

impl Screws {
    /// The displaced screws of joints, from their screws at home and their displacements.
    #[inline(always)]
    pub fn new(
        kind: SubspaceKind,
        home: &[LocalTwist; 3],
        displacements: &[JointDisplacement; 3],
    ) -> Self {
        let [s1, s2, s3] = *home;
        let moved = match kind {
            SubspaceKind::Planar => {
                let first = PlanarDisplacement::along_screw(&s1, displacements[0]);
                let second = first.after(&PlanarDisplacement::along_screw(&s2, displacements[1]));
                [s1, Planar::adjoint(&first, &s2), Planar::adjoint(&second, &s3)]
            }
            SubspaceKind::Spherical => {
                let (q1, q2) =
                    (displacements[0].unit_direction(), displacements[1].unit_direction());
                [s1, rotated(&s1, q1, &s2), rotated(&s1, q1, &rotated(&s2, q2, &s3))]
            }
            SubspaceKind::Identity
            | SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace => *home,
        };
        Self { kind, moved }
    }

    /// The twist `Σ sₖ q̇ₖ` for joint rates.
    #[inline]
    pub fn twist(&self, rates: &LocalTwist) -> LocalTwist {
        let [s1, s2, s3] = &self.moved;
        s1 * rates.x + s2 * rates.y + s3 * rates.z
    }

    /// The derivative of the twist at constant rates, `Σ_{j<k} [sⱼ, sₖ] q̇ⱼ q̇ₖ`.
    #[inline]
    pub fn bias(&self, rates: &LocalTwist) -> LocalTwist {
        let [s1, s2, s3] = &self.moved;
        let (t1, t2, t3) = (s1 * rates.x, s2 * rates.y, s3 * rates.z);
        self.kind.bracket(&t1, &(t2 + t3)) + self.kind.bracket(&t2, &t3)
    }

    /// The reciprocal screws `rⱼ` times the determinant of the screws, and that determinant:
    /// `sᵢ · rⱼ = δᵢⱼ det`.
    #[inline(always)]
    pub fn reciprocal(&self) -> ([LocalTwist; 3], f64) {
        let [s1, s2, s3] = &self.moved;
        let rows = [s2.cross(s3), s3.cross(s1), s1.cross(s2)];
        (rows, s1.dot(&rows[0]))
    }
}
