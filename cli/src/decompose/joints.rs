//! The joints of a mechanism as data: what a program needs to build it.

use super::triple_json;
use crate::parameters;
use opm_core::mechanism::Difference;
use opm_core::mechanism::file::{LegPattern, MechanismFile};
use opm_core::mechanism::joint::{Joint, JointCoordinate, JointKind};
use serde_json::{Map, Value, json};

/// Adds the reference point, and every joint with the keys of a mechanism file; the named parameters and the patterns of the
/// file, and the limits of differences. All of it is at home, SI.
pub fn insert(json: &mut Map<String, Value>, file: &MechanismFile) {
    let mechanism = &file.mechanism;
    if !file.parameters.is_empty() {
        json.insert("parameters".to_owned(), json!(parameters::json(file)));
    }
    if !file.patterns.is_empty() {
        let one = |pattern: &LegPattern| json!({ "legs": pattern.legs, "text": pattern.text });
        json.insert("patterns".to_owned(), file.patterns.iter().map(one).collect());
    }
    json.insert("reference_point".to_owned(), json!(triple_json(&mechanism.platform.coords)));
    let of_leg = mechanism
        .legs
        .iter()
        .flat_map(|leg| leg.joints.iter().map(|joint| joint_json(&leg.name, joint)));
    json.insert("joints".to_owned(), of_leg.collect());
    if !mechanism.differences.is_empty() {
        let one = |Difference { joints, limits }: &Difference| json!({ "joints": joints, "limits": limits });
        json.insert("differences".to_owned(), mechanism.differences.iter().map(one).collect());
    }
}

fn joint_json(leg: &str, joint: &Joint) -> Value {
    let axis = (joint.kind != JointKind::Spherical).then(|| triple_json(&joint.axis));
    let (second, pitch) = match joint.kind {
        JointKind::Universal { second } => (Some(triple_json(&second)), None),
        JointKind::Helical { pitch } => (None, Some(pitch)),
        JointKind::Revolute
        | JointKind::Prismatic
        | JointKind::Cylindrical
        | JointKind::Spherical => (None, None),
    };
    // One value, or an array with one for each coordinate, as in a file.
    let each = |value: fn(&JointCoordinate) -> Value| match &*joint.coordinates {
        [one] => value(one),
        several => several.iter().map(value).collect(),
    };
    let mut json = json!({
        "name": joint.name,
        "leg": leg,
        "type": joint.kind.name(),
        "axis": axis,
        "axis2": second,
        "point": triple_json(&joint.point.coords),
        "pitch": pitch,
        "actuated": joint.actuated,
        "coordinates": joint.coordinates.iter().map(|c| &*c.name).collect::<Vec<_>>(),
        "unit": each(|c| c.quantity.unit().into()),
        "home": each(|c| c.home.into()),
        "limits": each(|c| json!(c.limits)),
        "max_rate": each(|c| json!(c.motion_limits.max_rate)),
        "max_acceleration": each(|c| json!(c.motion_limits.max_acceleration)),
        "max_effort": each(|c| json!(c.max_effort)),
    });
    if joint.turns_back {
        json["turns_back"] = json!(true);
    }
    json
}
