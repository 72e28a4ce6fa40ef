//! The operations that every subgroup implements.

use super::path::Path;
use super::{MotionType, SubspaceKind};
use nalgebra::{Rotation3, Vector3};

/// A twist in the frame of its subspace: as many components as the subspace has dimensions, padded with
/// zeros to three.
pub type LocalTwist = Vector3<f64>;

/// The algebra of one subgroup, in its own frame. Chains compute with the type [`Subgroup::Displacement`].
pub trait Subgroup {
    /// One displacement of the subgroup.
    type Displacement: Copy;
    /// A one-parameter motion inside the subgroup that two subspaces may share.
    type Intersection: Copy;

    /// The kind of subspace that the subgroup is.
    const KIND: SubspaceKind;
    /// The dimension of the subgroup: its number of degrees of freedom.
    const DIMENSION: usize;
    /// Whether its displacements commute. The logarithm of a product is then the sum of the logarithms.
    const COMMUTES: bool;

    /// The product `first · second`: `second` is applied to points first.
    fn product(first: &Self::Displacement, second: &Self::Displacement) -> Self::Displacement;

    /// The inverse displacement.
    fn inverse(g: &Self::Displacement) -> Self::Displacement;

    /// The exponential: the displacement after moving with a constant twist for unit time.
    fn exponential(twist: &LocalTwist) -> Self::Displacement;

    /// The shortest twist whose exponential is `g`. Its angle is at most π, unless the subgroup counts full
    /// revolutions.
    fn logarithm(g: &Self::Displacement) -> LocalTwist;

    /// A displacement that agrees with the exponential to first order. It is cheaper, and good enough for
    /// a step of Newton's method.
    fn first_order(twist: &LocalTwist) -> Self::Displacement {
        Self::exponential(twist)
    }

    /// The adjoint action `g ξ g⁻¹`: the twist displaced by `g`.
    fn adjoint(g: &Self::Displacement, twist: &LocalTwist) -> LocalTwist;

    /// The adjoint action of the inverse, `g⁻¹ ξ g`.
    fn adjoint_of_inverse(g: &Self::Displacement, twist: &LocalTwist) -> LocalTwist;

    /// The Lie bracket `[a, b]`: the rate of change of `b` when it moves with `a`.
    fn bracket(a: &LocalTwist, b: &LocalTwist) -> LocalTwist;

    /// The image of a point, which is given in the subspace's frame.
    fn act(g: &Self::Displacement, point: &Vector3<f64>) -> Vector3<f64>;

    /// The displacement as a rotation about the frame's origin, followed by a translation.
    fn rotation_and_translation(g: &Self::Displacement) -> (Rotation3<f64>, Vector3<f64>);

    /// A twist as two vectors in the frame: the angular velocity, and the velocity of the point at the
    /// frame's origin.
    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2];

    /// Whether a twist is a translation. The twist must not be zero.
    fn is_translation(twist: &LocalTwist) -> bool;

    /// The largest component of a displacement that can grow without bound: a counted angle in radians or
    /// a length in metres. It is zero for a subgroup of rotations modulo 2π.
    fn size(g: &Self::Displacement) -> f64;

    /// The intersection motion with a given direction in the frame: a rotation about that direction through
    /// the frame's origin, or a translation along it.
    ///
    /// # Panics
    /// If the subgroup does not contain such a motion.
    fn motion(direction: &Vector3<f64>, motion: MotionType) -> Self::Intersection;

    /// The unit twist of an intersection motion.
    fn unit_twist(motion: &Self::Intersection) -> LocalTwist;

    /// Orthonormal twists that complete the unit twist of an intersection motion to a basis of the subgroup's twists.
    fn complement(motion: &Self::Intersection) -> Vec<LocalTwist>;

    /// The products `exp(I τ) · b` for all τ, as a path.
    fn path(motion: &Self::Intersection, b: &Self::Displacement) -> Path;
}
