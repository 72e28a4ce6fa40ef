//! The part of the schema that describes lists of joints.

use super::Properties;
use super::values::{
    array, cases, closed, described, direction, exactly, form, name, number, numbers, object, point,
};
use crate::mechanism::file::differences;
use crate::mechanism::file::joints::{
    FRAME_KEYS, KEYS, LEG_KEYS, RESERVED, TASK_KEYS, TYPES, Type,
};
use crate::mechanism::joint::{DriveLimit, DriveNumber, Joint, JointKind, MotionLimit};
use crate::mechanism::{HOME_COORDINATES, OrientationCoordinates};
use crate::numeric::Quantity;
use nalgebra::{Point3, Vector3};
use serde_json::{Value, json};

/// The keys of a file that lists joints.
pub fn joint_list() -> Value {
    // A pattern makes several legs of one.
    let several = json!([
        { "minItems": 2 },
        { "contains": { "type": "object", "required": ["pattern"] } },
    ]);
    let legs = json!({ "anyOf": several, "items": form(LEG_KEYS, &["joints"], &[]) });
    form(KEYS, &["platform", "leg"], &[("leg", legs)])
}

/// What the keys of such a file mean, apart from `leg`.
pub fn properties() -> Properties {
    let platform = "The platform at home.";
    let reference = point("the platform's reference point, which a pose in SE(3) places", 3);
    let reference = [("point".to_owned(), reference)].into_iter().collect();
    let task = "How the pose is measured, where the geometry leaves a choice. `opm decompose` prints the \
                frames that result.";
    let task_keys = TASK_KEYS.iter().map(|&key| (key.to_owned(), task_key(key))).collect();
    [
        ("platform".to_owned(), closed(platform, reference, &["point"])),
        ("task".to_owned(), closed(task, task_keys, &[])),
    ]
    .into_iter()
    .collect()
}

/// What the keys of a leg mean.
pub fn leg_properties() -> Properties {
    let mut joints = array("The leg's joints, from base to platform.", joint());
    joints["minItems"] = json!(1);
    let description = "The leg's name. If it is not given: leg1, leg2, ...";
    let pattern = super::named::pattern();
    [
        ("name".to_owned(), name(description)),
        ("joints".to_owned(), joints),
        ("pattern".to_owned(), pattern),
    ]
    .into_iter()
    .collect()
}

fn task_key(key: &str) -> Value {
    let frame = |what: &str| {
        let keys = FRAME_KEYS.iter().map(|&key| (key.to_owned(), frame_key(key))).collect();
        closed(what, keys, &[])
    };
    match key {
        "axis" => direction("the side to which the intersection motion is positive"),
        "lower" => frame("The frame of the lower section, next to the base."),
        "upper" => frame("The frame of the upper section, next to the platform."),
        "coordinates" => orientation_coordinates(),
        "home" => home(),
        "independent" => json!({
            "description": "The task coordinates from which the others follow, such as [\"x\", \"y\", \"z\"], where several choices are possible.",
            "type": "array",
            "items": { "type": "string" },
            "minItems": 1,
            "uniqueItems": true,
        }),
        _ => Value::Bool(true),
    }
}

/// What `coordinates` means.
fn orientation_coordinates() -> Value {
    let words = OrientationCoordinates::NAMED.map(|(word, _)| word);
    json!({
        "description": "The angles of an orientation: euler-angles (zeta xi psi, the default), tilt-torsion \
                        (azimuth tilt torsion, with R = Rz(azimuth) Ry(tilt) Rz(torsion - azimuth)), or \
                        roll-pitch-yaw (roll pitch yaw, with R = Rz(yaw) Ry(pitch) Rx(roll)).",
        "enum": words,
    })
}

/// What `home` means.
fn home() -> Value {
    let coordinate = |(name, quantity)| {
        (str::to_owned(name), number("the value of this task coordinate at home", quantity))
    };
    let what = "The values of task coordinates at home, where they are not those that follow from the geometry.";
    closed(what, HOME_COORDINATES.into_iter().map(coordinate).collect(), &[])
}

fn frame_key(key: &str) -> Value {
    match key {
        "x" => direction(
            "the direction of coordinate x, in the plane; for a sphere or a translational space, the first axis \
             of its frame, perpendicular to the intersection motion",
        ),
        "axis" => direction(
            "where the sections have no motion in common: the third axis of the frame of a sphere or \
             of a translational space, or a direction on the positive side of the axis of a cylinder",
        ),
        "w" => direction("the positive direction of coordinate w"),
        "normal" => direction("the normal of the plane, about which its angle is positive"),
        "origin" => point("the point that lengths are measured from", 3),
        _ => Value::Bool(true),
    }
}

fn joint() -> Value {
    let types = TYPES.map(|(word, _)| word);
    let description = "What the joint allows: revolute a rotation, prismatic a translation, helical a screw \
                       motion, cylindrical a rotation and a translation along one axis, universal rotations \
                       about two axes, spherical every rotation, parallelogram a translation on a circle.";
    let mut named = name("The joint's name, unique in the mechanism.");
    named["not"] = json!({ "enum": RESERVED });
    let properties = [
        ("name", named),
        ("type", json!({ "description": description, "enum": types })),
        ("axis", direction("the direction of the axis at home")),
        ("axis2", direction("the direction, at home, of the axis next to the platform")),
        ("point", point("a point on the axis at home; of a prismatic joint, where it is drawn", 3)),
        (
            "point2",
            point(
                "of a parallelogram, a point on the axis at the other end of its bar, at home",
                3,
            ),
        ),
        (Joint::TURNS_BACK, json!({ "description": TURNS_BACK_MEANS, "type": "boolean" })),
        ("pitch", number(PITCH, Quantity::Length)),
        (
            "actuated",
            json!({ "description": "Whether a motor drives the joint.", "type": "boolean" }),
        ),
        ("home", json!({ "description": AT_HOME })),
        ("limits", json!({ "description": LIMITS })),
        ("cone", cone()),
        (DriveLimit::Motion(MotionLimit::Rate).key(), json!({ "description": MAX_RATE })),
        (
            DriveLimit::Motion(MotionLimit::Acceleration).key(),
            json!({ "description": MAX_ACCELERATION }),
        ),
        (DriveLimit::Effort.key(), json!({ "description": MAX_EFFORT })),
        (DriveNumber::RotorInertia.key(), json!({ "description": ROTOR_INERTIA })),
        (DriveNumber::Gear.key(), json!({ "description": GEAR })),
        (DriveNumber::ViscousFriction.key(), json!({ "description": VISCOUS })),
        (DriveNumber::CoulombFriction.key(), json!({ "description": COULOMB })),
    ];
    let properties = properties.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
    let mut joint = described("A joint, at home.", object(properties));
    joint["required"] = json!(["name", "type"]);
    let forms = TYPES.iter().map(|&(word, kind)| (word, joint_form(kind))).collect();
    if let (Value::Object(joint), Value::Object(forms)) = (&mut joint, cases("type", forms)) {
        joint.extend(forms);
    }
    joint
}

/// The cone of a spherical or a universal joint.
fn cone() -> Value {
    let angle =
        number("the largest angle between the rod and the axis of the cone", Quantity::Angle);
    let axis = direction("the axis of the cone at home, away from the joint along the rod");
    let properties = [("angle", angle), ("axis", axis)];
    let properties = properties.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
    let mut table = object(properties);
    table["required"] = json!(["angle"]);
    described(CONE, json!({ "anyOf": [{ "type": ["number", "string"] }, table] }))
}

const CONE: &str = "How far the rod at the joint may tilt: half the angle of a cone about the rod at home, or about a \
                    given axis. In units.angle.";
const TURNS_BACK_MEANS: &str = "Whether it turns back what the joint before it turns: the two are the hinges of a parallelogram.";
const PITCH: &str = "the advance along the axis per radian; negative if it is left-handed";
const AT_HOME: &str = "The value at home, 0 if it is not given; a reported value is this one plus the \
                       displacement. A number, or for a joint of several coordinates an array with one for \
                       each. In units.angle or units.length.";
const LIMITS: &str = "The lowest and the highest value, [lowest, highest], both included. For a joint of \
                      several coordinates an array with one pair for each. In units.angle or units.length.";

const MAX_RATE: &str = "The largest absolute rate, above 0, with which trajectories are compared. A number, or for \
                        a joint of several coordinates an array with one for each. In units.angle/s or \
                        units.length/s.";
const MAX_ACCELERATION: &str = "The largest absolute acceleration, above 0, with which trajectories are compared. A \
                                number, or for a joint of several coordinates an array with one for each. In \
                                units.angle/s^2 or units.length/s^2.";
const MAX_EFFORT: &str = "The largest absolute effort of the actuator, above 0, from which the capacity of a pose \
                          follows. A number, or for a joint of several coordinates an array with one for each. In N m \
                          for an angle, in N for a length, whatever the units.";

const ROTOR_INERTIA: &str =
    "The inertia of the actuator's rotor, kg m^2. For a joint of several coordinates an array.";
const GEAR: &str = "How much faster than the joint the rotor turns, 1 if it is not given; of a slider, radians per units.length.";
const VISCOUS: &str = "The joint's friction for a rate of one, N m s/rad, of a slider N s/m. For a joint of several coordinates an array.";
const COULOMB: &str = "The joint's friction against its rate, N m, of a slider N. For a joint of several coordinates an array.";

/// The keys of a joint of one type.
fn joint_form(kind: Type) -> Value {
    // Only the number of its coordinates counts.
    let like = match kind {
        Type::Revolute | Type::Parallelogram => JointKind::Revolute,
        Type::Prismatic => JointKind::Prismatic,
        Type::Helical => JointKind::Helical { pitch: 1.0 },
        Type::Cylindrical => JointKind::Cylindrical,
        Type::Universal => JointKind::Universal { second: Vector3::x_axis() },
        Type::Spherical => JointKind::Spherical,
    };
    let joint = Joint::new("", like, Vector3::z_axis(), Point3::origin());
    let number = json!({ "type": ["number", "string"] });
    let pair = exactly(2, json!({ "type": "array", "items": number }));
    let several = |item: &Value, count| exactly(count, json!({ "type": "array", "items": item }));
    let positive = json!({ "type": ["number", "string"], "exclusiveMinimum": 0 });
    let not_negative = json!({ "type": ["number", "string"], "minimum": 0 });
    let [home, limits, largest, drive] =
        [number.clone(), pair, positive, not_negative].map(|item| match joint.freedoms() {
            1 => item,
            count => several(&item, count),
        });
    let [rate, acceleration, effort] = DriveLimit::ALL.map(|limit| (limit.key(), largest.clone()));
    let mut narrower = vec![("home", home), ("limits", limits), rate, acceleration, effort];
    narrower.extend(DriveNumber::ALL.map(|number| (number.key(), drive.clone())));
    form(&kind.keys(), &kind.needs(), &narrower)
}

/// The limits of differences of joints.
pub fn differences() -> Value {
    let item = json!({ "type": "string" });
    let joints = exactly(2, array("The names of two joints, angles or lengths both.", item));
    let limits = "The lowest and the highest value of the first joint less the second. In units.angle or units.length.";
    let properties = [("joints", joints), ("limits", numbers(limits, 2))];
    let properties = properties.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
    let what = "Limits of the difference of two joints.";
    array("Limits of the differences of joints.", closed(what, properties, differences::KEYS))
}
