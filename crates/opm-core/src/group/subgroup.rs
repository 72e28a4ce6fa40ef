//! What every subgroup has to say of itself.

use super::path::Path;
use super::{JointDisplacement, SubspaceKind};
use nalgebra::{Rotation3, Vector3};

/// A twist in the frame of its subspace: as many numbers as the subspace has dimensions, the rest zeros.
pub(crate) type LocalTwist = Vector3<f64>;

/// The algebra of one subgroup, in its own frame. The displacements are those that chains compute with.
pub(crate) trait Subgroup {
    /// One displacement of the subgroup.
    type Displacement: Copy;
    /// A one-parameter motion inside the subgroup that two subspaces may share.
    type Intersection: Copy;

    /// Which subgroup it is.
    const KIND: SubspaceKind;
    /// Number of freedoms.
    const DIMENSION: usize;
    /// Whether its displacements commute. Then they add up: the logarithm of a product is the sum of the
    /// logarithms.
    const COMMUTES: bool;
    /// The displacement that leaves everything where it is.
    const IDENTITY: Self::Displacement;

    /// First `second`, then `first`: `first · second`.
    fn product(first: &Self::Displacement, second: &Self::Displacement) -> Self::Displacement;

    /// The displacement back.
    fn inverse(g: &Self::Displacement) -> Self::Displacement;

    /// The displacement that a constant twist makes in unit time.
    fn exponential(twist: &LocalTwist) -> Self::Displacement;

    /// The shortest twist whose exponential is `g`: rotations by at most half a turn, unless the subgroup
    /// counts whole turns.
    fn logarithm(g: &Self::Displacement) -> LocalTwist;

    /// A displacement that agrees with the exponential to first order: what a step of Newton's method
    /// needs.
    fn first_order(twist: &LocalTwist) -> Self::Displacement {
        Self::exponential(twist)
    }

    /// Adjoint action: the twist as it is after the displacement, `g ξ g⁻¹`.
    fn adjoint(g: &Self::Displacement, twist: &LocalTwist) -> LocalTwist;

    /// The adjoint action of the inverse, `g⁻¹ ξ g`.
    fn adjoint_of_inverse(g: &Self::Displacement, twist: &LocalTwist) -> LocalTwist;

    /// Lie bracket: how the second twist changes when it is carried along by the first.
    fn bracket(a: &LocalTwist, b: &LocalTwist) -> LocalTwist;

    /// Action: where a point of the frame goes.
    fn act(g: &Self::Displacement, point: &Vector3<f64>) -> Vector3<f64>;

    /// The displacement as a rotation about the frame's origin, then a translation.
    fn rotation_and_translation(g: &Self::Displacement) -> (Rotation3<f64>, Vector3<f64>);

    /// A twist as an angular velocity and the velocity of the point at the frame's origin.
    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2];

    /// Whether a twist, which is not zero, is a translation.
    fn is_translation(twist: &LocalTwist) -> bool;

    /// The largest number of a displacement, radians or metres; zero where rotations are all it is.
    fn size(g: &Self::Displacement) -> f64;

    /// The intersection motion with this direction in the frame: a rotation about it through the frame's
    /// origin, or a translation along it.
    ///
    /// # Panics
    /// If the subgroup does not hold such a motion.
    fn motion(direction: &Vector3<f64>, rotation: bool) -> Self::Intersection;

    /// The unit twist of a motion.
    fn unit_twist(motion: &Self::Intersection) -> LocalTwist;

    /// The subgroup's directions beside a motion: with its unit twist they are a basis of the twists.
    fn complement(motion: &Self::Intersection) -> Vec<LocalTwist>;

    /// `v · exp(I τ)`.
    fn after(
        motion: &Self::Intersection,
        v: &Self::Displacement,
        tau: JointDisplacement,
    ) -> Self::Displacement;

    /// `exp(I τ) · b`.
    fn before(
        motion: &Self::Intersection,
        b: &Self::Displacement,
        tau: JointDisplacement,
    ) -> Self::Displacement;

    /// `exp(I τ) · b` for every τ.
    fn path(motion: &Self::Intersection, b: &Self::Displacement) -> Path;
}
