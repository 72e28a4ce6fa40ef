//! Joints: opm's kinds as MuJoCo's hinges, slides and balls.

use super::list;
use super::servo::Servos;
use crate::names::unique;
use crate::xml::Element;
use nalgebra::{Unit, UnitQuaternion, Vector3};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointCoordinate, JointKind};
use opm_core::skeleton::Body;
use std::collections::BTreeSet;

/// A pitch, in metres per radian, from which on the slide of a helical joint depends on its hinge, and not the hinge on
/// the slide: the larger motion is held to the smaller one's accuracy.
const LARGE_PITCH: f64 = 1.0;

/// The names that are taken. Those of opm's joints and legs come first.
pub struct Names {
    joints: BTreeSet<String>,
    bodies: BTreeSet<String>,
    constraints: BTreeSet<String>,
}

/// A joint of MuJoCo, and what couples it to the one before.
pub struct JointPart {
    pub joint: Element,
    pub coupling: Option<Element>,
}

/// The joint values of a posture, in the order of the model.
pub struct JointValues {
    /// One for each hinge and slide, a quaternion for each ball.
    pub positions: Vec<f64>,
    /// One for each servo.
    pub controls: Vec<f64>,
}

impl Names {
    pub fn of(mechanism: &Mechanism) -> Self {
        let joints = mechanism.joints().flat_map(|joint| {
            let coordinates = joint.coordinates.iter().map(|c| c.name.clone());
            coordinates.chain([joint.name.clone()])
        });
        let bodies = ["base", "platform"].map(str::to_owned);
        let legs = mechanism.legs.iter().map(|leg| leg.name.clone());
        Self {
            joints: joints.collect(),
            bodies: BTreeSet::from(bodies),
            constraints: legs.collect(),
        }
    }

    /// A name for the slide of a helical joint.
    fn slide(&mut self, joint: &Joint) -> String {
        unique(&mut self.joints, format!("{}.slide", joint.name))
    }

    /// A name for a body, as it is wanted or with underscores behind.
    pub fn body(&mut self, wanted: String) -> String {
        unique(&mut self.bodies, wanted)
    }
}

/// The joints between a body and its parent, the one nearest to the parent first.
pub fn joints(joint: &Joint, body: &Body, servos: &Servos, names: &mut Names) -> Vec<JointPart> {
    let seat = body.seats.iter().find(|seat| seat.joint == joint.name);
    let place = seat.map_or(joint.point - body.origin, |seat| seat.centre.coords);
    let one = |kind: &str, name: &str, axis: Option<Unit<Vector3<f64>>>| {
        let element = Element::new("joint")
            .with("name", name)
            .with("type", kind)
            .numbers("pos", place.as_slice());
        axis.map_or(element.clone(), |axis| element.numbers("axis", axis.as_slice()))
    };
    // A joint with opm's own value.
    let own = |kind: &str, number: usize, axis: Unit<Vector3<f64>>| {
        let coordinate = &joint.coordinates[number];
        let element = one(kind, &coordinate.name, Some(axis)).numbers("ref", &[coordinate.home]);
        servos.driven(limited(element, coordinate), joint, number)
    };
    let alone = |joint| JointPart { joint, coupling: None };
    match joint.kind {
        JointKind::Revolute => vec![alone(own("hinge", 0, joint.axis))],
        JointKind::Prismatic => vec![alone(own("slide", 0, joint.axis))],
        JointKind::Cylindrical => {
            vec![alone(own("hinge", 0, joint.axis)), alone(own("slide", 1, joint.axis))]
        }
        JointKind::Universal { second } => {
            vec![alone(own("hinge", 0, joint.axis)), alone(own("hinge", 1, second))]
        }
        JointKind::Spherical => {
            vec![alone(servos.driven(one("ball", &joint.name, None), joint, 0))]
        }
        JointKind::Helical { pitch } => {
            let hinge = &joint.coordinates[0].name;
            let slide = names.slide(joint);
            let (follows, leads, ratio) = if pitch.abs() < LARGE_PITCH {
                (&**hinge, &*slide, 1.0 / pitch)
            } else {
                (&*slide, &**hinge, pitch)
            };
            let coupling = Element::new("joint")
                .with("name", unique(&mut names.constraints, joint.name.clone()))
                .with("joint1", follows)
                .with("joint2", leads)
                .numbers("polycoef", &[0.0, ratio, 0.0, 0.0, 0.0]);
            let advance = one("slide", &slide, Some(joint.axis));
            vec![
                alone(own("hinge", 0, joint.axis)),
                JointPart { joint: advance, coupling: Some(coupling) },
            ]
        }
    }
}

fn limited(element: Element, coordinate: &JointCoordinate) -> Element {
    match coordinate.limits {
        Some(limits) => element.with("limited", "true").with("range", list(&limits)),
        None => element,
    }
}

/// A number of a posture.
pub enum Column {
    /// One of `qpos`.
    Position(String),
    /// One of `ctrl`.
    Control(String),
}

/// The names of the values of a posture: the positions, then the controls, each in the order of the model. A quaternion is
/// `NAME.w`, `NAME.x`, `NAME.y`, `NAME.z`.
pub fn columns(mechanism: &Mechanism) -> impl Iterator<Item = Column> {
    let mut names = Names::of(mechanism);
    let (mut positions, mut controls) = (Vec::new(), Vec::new());
    for joint in mechanism.joints() {
        let own = || joint.coordinates.iter().map(|c| c.name.clone());
        match joint.kind {
            JointKind::Spherical => {
                positions.extend(["w", "x", "y", "z"].map(|part| format!("{}.{part}", joint.name)));
            }
            JointKind::Helical { .. } => {
                positions.extend(own());
                positions.push(names.slide(joint));
            }
            JointKind::Revolute
            | JointKind::Prismatic
            | JointKind::Cylindrical
            | JointKind::Universal { .. } => positions.extend(own()),
        }
        if joint.actuated {
            controls.extend(own());
        }
    }
    let positions = positions.into_iter().map(Column::Position);
    positions.chain(controls.into_iter().map(Column::Control))
}

/// The values of a posture; `joints` has one for each coordinate, leg by leg.
pub fn joint_values(mechanism: &Mechanism, joints: &[f64]) -> JointValues {
    let mut values = JointValues { positions: Vec::new(), controls: Vec::new() };
    let mut rest = joints;
    for joint in mechanism.joints() {
        let (own, after) = rest.split_at(joint.coordinates.len());
        rest = after;
        let from_home = |i: usize| own[i] - joint.coordinates[i].home;
        match joint.kind {
            JointKind::Spherical => {
                let vector = Vector3::from_fn(|i, _| from_home(i));
                let q = UnitQuaternion::from_scaled_axis(vector);
                values.positions.extend([q.w, q.i, q.j, q.k]);
                if joint.actuated {
                    values.controls.extend(vector.iter());
                }
                continue;
            }
            JointKind::Helical { pitch } => values.positions.extend([own[0], pitch * from_home(0)]),
            JointKind::Revolute
            | JointKind::Prismatic
            | JointKind::Cylindrical
            | JointKind::Universal { .. } => values.positions.extend(own),
        }
        if joint.actuated {
            values.controls.extend(own);
        }
    }
    values
}
