//! A leg: joints in series from the base to the platform.

use crate::group::screw::Screw;
use crate::mechanism::joint::{Joint, JointCoordinate};
use nalgebra::{Isometry3, Vector3};
use std::fmt;

/// How a leg's imaginary joint is reported, where the mechanism has a convention for it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImaginaryLabel {
    /// Name, `theta11` for instance.
    pub name: String,
    /// Value at home, radians or metres.
    pub home: f64,
    /// The intersection motion along (or right-handed about) this direction counts as positive.
    pub positive: Vector3<f64>,
}

/// Joints in series from the base to the platform, at the assembled home pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// Name, unique in its mechanism.
    pub name: String,
    /// Joints, base first.
    pub joints: Vec<Joint>,
    /// Name and origin of the imaginary joint; without it: `tau.NAME`, zero at home.
    pub imaginary: Option<ImaginaryLabel>,
}

impl Leg {
    /// A leg whose imaginary joint, should it get one, has the default name.
    pub fn new(name: impl Into<String>, joints: Vec<Joint>) -> Self {
        Self { name: name.into(), joints, imaginary: None }
    }

    /// What the leg's imaginary joint is called, should it get one.
    pub fn imaginary_name(&self) -> String {
        match &self.imaginary {
            Some(label) => label.name.clone(),
            None => format!("tau.{}", self.name),
        }
    }

    /// One unit screw a freedom, base first, at home.
    pub fn screws(&self) -> Vec<Screw> {
        self.joints.iter().flat_map(Joint::screws).collect()
    }

    /// Every coordinate of every joint, base first: the order of [`Leg::displacement`]'s values.
    pub fn coordinates(&self) -> impl Iterator<Item = &JointCoordinate> {
        self.joints.iter().flat_map(|joint| &joint.coordinates)
    }

    /// The platform's displacement from home for the joint coordinates of this leg: the product of
    /// exponentials of its joints, read from the leg as it is, without any decomposition.
    ///
    /// # Panics
    /// If there are fewer values than [`Leg::coordinates`].
    pub fn displacement(&self, values: &[f64]) -> Isometry3<f64> {
        let mut rest = values;
        self.joints.iter().fold(Isometry3::identity(), |g, joint| {
            let (own, after) = rest.split_at(joint.freedoms());
            rest = after;
            g * joint.displacement(own)
        })
    }
}

/// One of the two sections of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Section {
    /// Base side, inside `A`.
    Lower,
    /// Platform side, inside `B`.
    Upper,
}

impl fmt::Display for Section {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        })
    }
}
