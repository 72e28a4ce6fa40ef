//! Stub.
use super::{Branch, ReachDeficit};
use crate::group::JointDisplacement;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// A joint of a leg, in base coordinates at home. Universal and cylindrical joints are given as two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegJoint {
    /// A revolute joint or a screw.
    Screw {
        /// The axis.
        axis: Unit<Vector3<f64>>,
        /// A point of it.
        point: Point3<f64>,
        /// Metres per radian.
        pitch: f64,
    },
    /// A slider.
    Slide {
        /// The direction.
        axis: Unit<Vector3<f64>>,
    },
    /// A spherical joint.
    Ball {
        /// The centre.
        point: Point3<f64>,
    },
}

/// The most freedoms.
pub const MOST_FREEDOMS: usize = 7;

/// A whole leg.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeLeg {}

/// Why there is no order.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no order")]
pub struct NoOrder {}

/// A step for people.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepName {
    /// joint
    pub joint: usize,
    /// root
    pub root: &'static str,
    /// invariant
    pub invariant: Option<&'static str>,
}

impl WholeLeg {
    /// Finds.
    ///
    /// # Errors
    /// None.
    pub fn new(_: &[LegJoint], _: &[bool], _: &[Isometry3<f64>], _: f64) -> Result<Self, NoOrder> {
        Err(NoOrder {})
    }
    /// Choices.
    pub fn choices(&self) -> usize {
        0
    }
    /// Joints.
    pub fn choosing_joints(&self) -> &[usize] {
        &[]
    }
    /// Steps.
    pub fn steps(&self) -> impl Iterator<Item = StepName> {
        std::iter::empty()
    }
    /// The number of the first freedom of a spherical joint that could spin about a line with everything else held, and
    /// the direction of this line at home: its rotation vector has no component along it. `None` if nothing is idle.
    pub fn idle(&self) -> Option<(usize, Vector3<f64>)> {
        None
    }
    /// Solves.
    ///
    /// # Errors
    /// Out of reach.
    pub fn solve(
        &self,
        _: &Isometry3<f64>,
        _: [Branch; 2],
        _: &mut [JointDisplacement; 7],
    ) -> Result<(), ReachDeficit> {
        Err(ReachDeficit::length(f64::INFINITY))
    }
}
