//! Mechanisms: legs between one base and one platform, given at an assembled home pose.

// Without the reader of files, what only it uses is dead.
#![cfg_attr(not(feature = "files"), allow(dead_code, unused_imports))]

mod bodies;
mod cone;
mod difference;
pub mod family;
pub mod file;
mod hints;
pub mod joint;
pub mod leg;
mod screws;
mod shapes;

pub use bodies::{BodyMasses, Payload};
pub use cone::{Cone, JointCone};
pub use difference::{Difference, DifferenceError, JointDifference};
#[doc(hidden)]
pub use hints::HOME_COORDINATES;
pub use hints::{FrameHints, OrientationCoordinates, TaskHints, TaskKey};
pub use screws::{ScrewError, ScrewJoint};
pub use shapes::{Obstacle, ObstacleShape, Shapes};

use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::{Joint, JointCoordinate};
use crate::mechanism::leg::Leg;
use nalgebra::Point3;

// The shipped mechanisms stand in opm-core, beside the motions.
#[cfg(test)]
use opm_core::mechanism::examples;

/// A parallel mechanism at an assembled home pose, in base coordinates: metres and radians.
///
/// A mechanism file gives one (`Manipulator::read`), and so does a
/// [`family`]. Or build one from [`Leg`]s.
///
/// ```
/// let manipulator = opm_core::Manipulator::example("plano-spherical-5dof")?;
/// let mechanism: &opm_core::Mechanism = manipulator.mechanism();
/// let legs: Vec<&str> = mechanism.legs.iter().map(|leg| leg.name.as_str()).collect();
/// assert_eq!(legs, ["leg1", "leg2", "leg3", "leg4"]);
/// # Ok::<(), opm_core::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Mechanism {
    /// The mechanism's name.
    pub name: String,
    /// The legs, at least two.
    pub legs: Vec<Leg>,
    /// The platform's reference point at home, metres.
    pub platform: Point3<f64>,
    /// Limits of the differences of joints.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub differences: Vec<Difference>,
    /// How the platform's pose is measured.
    pub task: TaskHints,
    /// What the bodies weigh.
    pub bodies: BodyMasses,
    /// How thick the bodies are, and what stands around them.
    pub shapes: Shapes,
    /// The units of the file that it was read from, in which messages about it are given; all numbers here are SI.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub units: FileUnits,
}

impl Mechanism {
    /// Every joint, leg by leg, from base to platform.
    pub fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.legs.iter().flat_map(|leg| &leg.joints)
    }

    /// The first hinges of all parallelograms.
    pub fn parallelograms(&self) -> impl Iterator<Item = &Joint> {
        self.legs.iter().flat_map(Leg::parallelograms)
    }

    /// The joint whose first coordinate has this number among all joint coordinates.
    pub fn joint_from(&self, coordinate: usize) -> Option<&Joint> {
        let mut first = 0;
        self.joints().find(|joint| {
            let own = first;
            first += joint.coordinates.len();
            own == coordinate
        })
    }

    /// The names of all bodies that move: the joint that carries a link, for each link, and the platform.
    pub fn body_names(&self) -> impl Iterator<Item = &str> {
        let links =
            self.legs.iter().flat_map(|leg| leg.joints.split_last()).flat_map(|(_, all)| all);
        links.map(|joint| &*joint.name).chain([BodyMasses::PLATFORM])
    }

    /// Every joint coordinate, leg by leg, from base to platform. Joint vectors have this order
    /// everywhere.
    pub fn coordinates(&self) -> impl Iterator<Item = &JointCoordinate> {
        self.legs.iter().flat_map(Leg::coordinates)
    }
}
