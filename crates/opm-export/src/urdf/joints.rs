//! Joints: opm's kinds as revolute and prismatic joints in series.

use crate::names::unique;
use crate::xml::Element;
use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};
use opm_core::Quantity;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Drive, Joint, JointCoordinate, JointKind};
use std::collections::BTreeSet;

/// What stands where URDF wants a limit and the mechanism has none: of a value, a rate, and a force; radians, metres,
/// seconds and newtons.
const UNLIMITED: f64 = 1000.0;

/// A joint with one degree of freedom.
pub struct UrdfJoint {
    pub name: String,
    quantity: Quantity,
    axis: Unit<Vector3<f64>>,
    /// The value at home.
    home: f64,
    limits: Option<[f64; 2]>,
    max_rate: Option<f64>,
    max_effort: Option<f64>,
    /// What of its drive the format can say: friction.
    drive: Drive,
    /// Whether it counts revolutions, because a slide follows it.
    counts: bool,
    /// The joint that it follows, and by how much: its value is `ratio` times what that joint has moved from `from`.
    follows: Option<Follows>,
}

struct Follows {
    joint: String,
    ratio: f64,
    from: f64,
}

/// The names of all joints of opm, which the model's joints have, too.
pub fn names(mechanism: &Mechanism) -> BTreeSet<String> {
    let of_joint = |joint: &Joint| {
        let coordinates = joint.coordinates.iter().map(|c| c.name.clone());
        coordinates.chain([joint.name.clone()]).collect::<Vec<_>>()
    };
    mechanism.joints().flat_map(of_joint).collect()
}

/// The joints of which a joint consists, the one nearest to the base first. `before` is the joint before it in its leg.
pub fn parts(
    joint: &Joint,
    before: Option<&Joint>,
    names: &mut BTreeSet<String>,
) -> Vec<UrdfJoint> {
    let own = |number: usize, axis| UrdfJoint::own(&joint.coordinates[number], axis);
    if let Some(turned) = before.filter(|_| joint.turns_back) {
        let from = joint.coordinates[0].home + turned.coordinates[0].home;
        let follows = Some(Follows { joint: turned.name.clone(), ratio: -1.0, from });
        return vec![UrdfJoint { follows, ..own(0, joint.axis) }];
    }
    match joint.kind {
        JointKind::Revolute | JointKind::Prismatic => vec![own(0, joint.axis)],
        JointKind::Cylindrical => vec![own(0, joint.axis), own(1, joint.axis)],
        JointKind::Universal { second } => vec![own(0, joint.axis), own(1, second)],
        JointKind::Spherical => {
            let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
            let drive = mean(joint);
            let turn = |(number, axis)| UrdfJoint {
                name: unique(names, format!("{}.{number}", joint.name)),
                quantity: Quantity::Angle,
                axis,
                home: 0.0,
                limits: None,
                max_rate: None,
                max_effort: None,
                drive,
                counts: false,
                follows: None,
            };
            (1..).zip(axes).map(turn).collect()
        }
        JointKind::Helical { pitch } => {
            let hinge = UrdfJoint { counts: true, ..own(0, joint.axis) };
            let (leader, from) = (hinge.name.clone(), hinge.home);
            let slide = UrdfJoint {
                name: unique(names, format!("{}.slide", joint.name)),
                quantity: Quantity::Length,
                axis: joint.axis,
                home: 0.0,
                limits: None,
                max_rate: None,
                max_effort: None,
                drive: Drive::default(),
                counts: false,
                follows: Some(Follows { joint: leader, ratio: pitch, from }),
            };
            vec![hinge, slide]
        }
    }
}

/// The friction of a ball's coordinates, which turn about other axes than its three joints: the mean of all.
fn mean(joint: &Joint) -> Drive {
    let mean = |of: fn(&Drive) -> f64| {
        joint.coordinates.iter().map(|c| of(&c.drive)).sum::<f64>() / joint.coordinates.len() as f64
    };
    Drive {
        viscous_friction: mean(|drive| drive.viscous_friction),
        coulomb_friction: mean(|drive| drive.coulomb_friction),
        ..Drive::default()
    }
}

impl UrdfJoint {
    /// A joint with opm's own value.
    fn own(coordinate: &JointCoordinate, axis: Unit<Vector3<f64>>) -> Self {
        Self {
            name: coordinate.name.clone(),
            quantity: coordinate.quantity,
            axis,
            home: coordinate.home,
            limits: coordinate.limits,
            max_rate: coordinate.motion_limits.max_rate,
            max_effort: coordinate.max_effort,
            drive: coordinate.drive,
            counts: false,
            follows: None,
        }
    }

    /// Whether it follows another joint.
    pub fn is_led(&self) -> bool {
        self.follows.is_some()
    }

    /// The joint between two links, the second of which is at `place` from the first one at home.
    pub fn element(&self, parent: &str, child: &str, place: Vector3<f64>) -> Element {
        let turns = self.quantity == Quantity::Angle;
        let kind = match (turns, self.limits.is_some() || self.counts) {
            (true, false) => "continuous",
            (true, true) => "revolute",
            (false, _) => "prismatic",
        };
        // Where the child is at zero: back from home by the value there.
        let (back, place) = match turns {
            true => (UnitQuaternion::from_axis_angle(&self.axis, -self.home), place),
            false => (UnitQuaternion::identity(), place - self.axis.into_inner() * self.home),
        };
        let mut limit = Element::new("limit");
        if kind != "continuous" {
            let [lower, upper] = self.limits.unwrap_or([-UNLIMITED, UNLIMITED]);
            limit = limit.numbers("lower", &[lower]).numbers("upper", &[upper]);
        }
        let limit = limit
            .numbers("effort", &[self.max_effort.unwrap_or(UNLIMITED)])
            .numbers("velocity", &[self.max_rate.unwrap_or(UNLIMITED)]);
        let mut element = between(&self.name, kind, [parent, child])
            .child(origin(place, &back))
            .child(Element::new("axis").numbers("xyz", self.axis.as_slice()))
            .child(limit);
        let Drive { viscous_friction: damping, coulomb_friction: friction, .. } = self.drive;
        if damping != 0.0 || friction != 0.0 {
            let dynamics = Element::new("dynamics").numbers("damping", &[damping]);
            element.push(dynamics.numbers("friction", &[friction]));
        }
        match &self.follows {
            None => element,
            Some(Follows { joint, ratio, from }) => element.child(
                Element::new("mimic")
                    .with("joint", &**joint)
                    .numbers("multiplier", &[*ratio])
                    .numbers("offset", &[-ratio * from]),
            ),
        }
    }
}

/// A joint that holds one link at a place on another.
pub fn fixed(name: &str, parent: &str, child: &str, place: Vector3<f64>) -> Element {
    between(name, "fixed", [parent, child]).child(origin(place, &UnitQuaternion::identity()))
}

fn between(name: &str, kind: &str, [parent, child]: [&str; 2]) -> Element {
    Element::new("joint")
        .with("name", name)
        .with("type", kind)
        .child(Element::new("parent").with("link", parent))
        .child(Element::new("child").with("link", child))
}

/// A frame in another one.
pub fn origin(place: Vector3<f64>, rotation: &UnitQuaternion<f64>) -> Element {
    Element::new("origin")
        .numbers("xyz", place.as_slice())
        .numbers("rpy", &roll_pitch_yaw(&rotation.to_rotation_matrix()))
}

/// The angles of `R = Rz(yaw) Ry(pitch) Rx(roll)`. Where the pitch is a right angle and only the sum or the difference of
/// the others matters, no digits are lost: the roll follows from the yaw that is taken.
fn roll_pitch_yaw(r: &Rotation3<f64>) -> [f64; 3] {
    let yaw = r[(1, 0)].atan2(r[(0, 0)]);
    let rest = Rotation3::from_axis_angle(&Vector3::z_axis(), -yaw) * r;
    let pitch = (-rest[(2, 0)]).atan2(rest[(0, 0)]);
    let roll = (-rest[(1, 2)]).atan2(rest[(1, 1)]);
    [roll, pitch, yaw]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Also at a pitch of a right angle, where the formulas of textbooks lose half of the digits.
    #[test]
    fn angles_give_the_rotation_again() {
        let angles = [0.0, 1e-9, 0.3, 1.0, FRAC_PI_2 - 1e-9, FRAC_PI_2, 2.0, PI];
        for a in angles {
            for b in angles {
                for c in angles {
                    let r = Rotation3::from_euler_angles(a, b, c);
                    let [roll, pitch, yaw] = roll_pitch_yaw(&r);
                    let again = Rotation3::from_euler_angles(roll, pitch, yaw);
                    assert!((again.matrix() - r.matrix()).amax() < 1e-15 * 4.0, "{a} {b} {c}");
                }
            }
        }
    }
}
