//! How far a spherical or a universal joint may tilt: rods of real machines leave their sockets beyond that.

use super::joint::{Joint, JointKind};
use super::leg::Leg;
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// The cone that the rod at a spherical or a universal joint stays in, a limit of the joint as a whole.
///
/// The rod is the line to the next joint of the leg that has another place, or else to the one before. What lies on the other side
/// of the joint holds the cone.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use opm_core::mechanism::joint::{Joint, JointKind};
/// use opm_core::mechanism::{Cone, leg::Leg};
///
/// let mut ball = Joint::new("ball", JointKind::Spherical, Vector3::z_axis(), Point3::origin());
/// ball.cone = Some(Cone { half_angle: 0.5, axis: None });
/// let end = Joint::new("end", JointKind::Spherical, Vector3::z_axis(), Point3::new(0.0, 0.0, 1.0));
/// let leg = Leg::new("strut", vec![ball, end]);
/// let cone = &leg.cones()[0];
/// // To spin about the rod is no tilt; to turn about another axis is.
/// assert!(cone.tilt(&[0.0, 0.0, 2.0]) < 1e-12);
/// assert!((cone.tilt(&[0.4, 0.0, 0.0]) - 0.4).abs() < 1e-12 && cone.admits(&[0.4, 0.0, 0.0]));
/// assert!(!cone.admits(&[0.0, 0.6, 0.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Cone {
    /// The largest angle between the rod and the axis of the cone, radians.
    pub half_angle: f64,
    /// The axis of the cone at home, along which the rod points from the joint; `None` for the rod at home.
    pub axis: Option<Unit<Vector3<f64>>>,
}

/// A cone of a joint of a leg.
#[derive(Clone, Debug, PartialEq)]
pub struct JointCone {
    /// The number of the joint in its leg.
    pub joint: usize,
    /// The largest tilt, radians.
    pub half_angle: f64,
    /// The axes of a universal joint; `None` for a spherical one.
    axes: Option<[Unit<Vector3<f64>>; 2]>,
    /// The direction that moves with the link before the joint, at home, and that with the one behind it.
    before: Unit<Vector3<f64>>,
    behind: Unit<Vector3<f64>>,
}

/// What counts as rounding of a tilt at the limit, radians.
const SLACK: f64 = 1e-12;

/// Joints that are closer than this have one place, relative to their distance from the origin and a metre.
const ONE_PLACE: f64 = 1e-9;

impl JointCone {
    /// The angle between the rod and the axis of the cone, radians, where the joint's coordinates are displaced from home by
    /// these values.
    pub fn tilt(&self, displacements: &[f64]) -> f64 {
        let rotation = match (&self.axes, displacements) {
            (None, &[x, y, z, ..]) => UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z)),
            (Some([one, two]), &[first, second, ..]) => {
                UnitQuaternion::from_axis_angle(one, first)
                    * UnitQuaternion::from_axis_angle(two, second)
            }
            _ => UnitQuaternion::identity(),
        };
        let behind = rotation * self.behind.into_inner();
        self.before.cross(&behind).norm().atan2(self.before.dot(&behind))
    }

    /// Whether the joint is within the cone, which counts as inside.
    pub fn admits(&self, displacements: &[f64]) -> bool {
        self.tilt(displacements) <= self.half_angle + SLACK
    }

    /// The direction at home that moves with the link before the joint.
    pub fn before(&self) -> Unit<Vector3<f64>> {
        self.before
    }

    /// The direction at home that moves with the link behind the joint.
    pub fn behind(&self) -> Unit<Vector3<f64>> {
        self.behind
    }

    /// The axes of a universal joint; `None` for a spherical one.
    pub fn axes(&self) -> Option<[Unit<Vector3<f64>>; 2]> {
        self.axes
    }
}

impl Leg {
    /// The cones of its joints. One whose joint has no rod is left out.
    pub fn cones(&self) -> Vec<JointCone> {
        let joints = self.joints.iter().enumerate();
        joints.filter_map(|(number, joint)| cone(&self.joints, number, joint)).collect()
    }
}

/// The rod at a joint, from it, at home; and whether it is behind the joint.
pub(crate) fn rod(joints: &[Joint], number: usize) -> Option<(Unit<Vector3<f64>>, bool)> {
    let from = joints[number].point;
    let to = |joint: &Joint| {
        let along = joint.point - from;
        let far = along.norm() > ONE_PLACE * (1.0 + from.coords.norm());
        (joint.kind != JointKind::Prismatic && far).then(|| Unit::new_normalize(along))
    };
    let behind = joints[number + 1..].iter().find_map(to).map(|rod| (rod, true));
    behind.or_else(|| Some((joints[..number].iter().rev().find_map(to)?, false)))
}

fn cone(joints: &[Joint], number: usize, joint: &Joint) -> Option<JointCone> {
    let Cone { half_angle, axis } = joint.cone?;
    let (rod, is_behind) = rod(joints, number)?;
    let axis = axis.unwrap_or(rod);
    let [before, behind] = if is_behind { [axis, rod] } else { [rod, axis] };
    let axes = match joint.kind {
        JointKind::Universal { second } => Some([joint.axis, second]),
        JointKind::Spherical => None,
        JointKind::Revolute
        | JointKind::Prismatic
        | JointKind::Helical { .. }
        | JointKind::Cylindrical => return None,
    };
    Some(JointCone { joint: number, half_angle, axes, before, behind })
}
