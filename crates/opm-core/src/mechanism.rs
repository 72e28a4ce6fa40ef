//! Mechanisms: legs between one base and one platform, at an assembled home pose.

pub mod examples;
pub mod family;
pub mod file;

use crate::joint::{Joint, JointCoordinate};
use crate::leg::Leg;
use nalgebra::{Point3, Vector3};

/// How the pose of the platform is to be measured, where the geometry alone does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskHints {
    /// The intersection motion's positive direction; without it, the one that points up (z, then
    /// y, then x).
    pub axis: Option<Vector3<f64>>,
    /// Values of task coordinates at home, by name; the others follow from the geometry.
    pub home: Vec<(String, f64)>,
}

/// A parallel mechanism at an assembled home pose, in base coordinates: metres and radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// Name.
    pub name: String,
    /// The legs, at least two.
    pub legs: Vec<Leg>,
    /// Reference point of the platform at home.
    pub platform: Point3<f64>,
    /// How its pose is measured.
    pub task: TaskHints,
}

impl Mechanism {
    /// Every joint, leg by leg.
    pub fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.legs.iter().flat_map(|leg| &leg.joints)
    }

    /// Every joint coordinate, leg by leg: the order of joint vectors everywhere.
    pub fn coordinates(&self) -> impl Iterator<Item = &JointCoordinate> {
        self.legs.iter().flat_map(Leg::coordinates)
    }
}
