//! The trivial subgroup: the identity alone. It is the upper subspace of a mechanism whose legs all move in
//! one subgroup. Its twists are zero.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{JointDisplacement, MotionType, SubspaceKind};
use nalgebra::{Rotation3, Vector3};
use std::convert::Infallible;

/// The trivial subgroup.
pub(crate) struct Identity;

impl Subgroup for Identity {
    type Displacement = ();
    /// It contains no motion.
    type Intersection = Infallible;

    const KIND: SubspaceKind = SubspaceKind::Identity;
    const DIMENSION: usize = 0;
    const COMMUTES: bool = true;
    const IDENTITY: () = ();

    fn product((): &(), (): &()) {}

    fn inverse((): &()) {}

    fn exponential(_: &LocalTwist) {}

    fn logarithm((): &()) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn adjoint((): &(), twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn adjoint_of_inverse((): &(), twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn bracket(_: &LocalTwist, _: &LocalTwist) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn act((): &(), point: &Vector3<f64>) -> Vector3<f64> {
        *point
    }

    fn rotation_and_translation((): &()) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::identity(), Vector3::zeros())
    }

    fn embed(_: &LocalTwist) -> [Vector3<f64>; 2] {
        [Vector3::zeros(); 2]
    }

    fn is_translation(_: &LocalTwist) -> bool {
        false
    }

    fn size((): &()) -> f64 {
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

    fn after(motion: &Infallible, (): &(), _: JointDisplacement) {
        match *motion {}
    }

    fn before(motion: &Infallible, (): &(), _: JointDisplacement) {
        match *motion {}
    }

    fn path(motion: &Infallible, (): &()) -> Path {
        match *motion {}
    }
}
