//! The trivial subgroup: the identity alone. It is the upper subspace of a mechanism whose legs all move in
//! one subgroup. Its twists are zero.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{MotionType, SubspaceKind};
use nalgebra::{Rotation3, Vector3};
use std::convert::Infallible;

/// The trivial subgroup.
pub(crate) struct Identity;

/// The only displacement of the trivial subgroup: none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentityDisplacement;

impl Subgroup for Identity {
    type Displacement = IdentityDisplacement;
    /// It contains no motion.
    type Intersection = Infallible;

    const KIND: SubspaceKind = SubspaceKind::Identity;
    const DIMENSION: usize = 0;
    const COMMUTES: bool = true;

    fn product(_: &IdentityDisplacement, _: &IdentityDisplacement) -> IdentityDisplacement {
        IdentityDisplacement
    }

    fn inverse(_: &IdentityDisplacement) -> IdentityDisplacement {
        IdentityDisplacement
    }

    fn exponential(_: &LocalTwist) -> IdentityDisplacement {
        IdentityDisplacement
    }

    fn logarithm(_: &IdentityDisplacement) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn adjoint(_: &IdentityDisplacement, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn adjoint_of_inverse(_: &IdentityDisplacement, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn bracket(_: &LocalTwist, _: &LocalTwist) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn act(_: &IdentityDisplacement, point: &Vector3<f64>) -> Vector3<f64> {
        *point
    }

    fn rotation_and_translation(_: &IdentityDisplacement) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::identity(), Vector3::zeros())
    }

    fn embed(_: &LocalTwist) -> [Vector3<f64>; 2] {
        [Vector3::zeros(); 2]
    }

    fn is_translation(_: &LocalTwist) -> bool {
        false
    }

    fn size(_: &IdentityDisplacement) -> f64 {
        0.0
    }

    fn motion(_: &Vector3<f64>, _: MotionType) -> Infallible {
        panic!("the identity contains no motion")
    }

    fn unit_twist(motion: &Infallible) -> LocalTwist {
        match *motion {}
    }

    fn complement(motion: &Infallible) -> Vec<LocalTwist> {
        match *motion {}
    }

    fn path(motion: &Infallible, _: &IdentityDisplacement) -> Path {
        match *motion {}
    }
}
