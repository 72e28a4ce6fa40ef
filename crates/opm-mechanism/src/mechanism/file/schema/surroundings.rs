//! The part of the schema that describes bodies, and what stands around a mechanism.

use super::values::{
    array, cases, closed, described, direction, form, in_units, name, numbers, object, point,
};
use crate::mechanism::file::bodies::INERTIA;
use crate::mechanism::file::checks::{DENSITIES, MASSES};
use crate::mechanism::file::obstacles::TYPES;
use crate::numeric::Quantity;
use serde_json::{Value, json};

fn within(what: &str, [least, most]: [f64; 2]) -> Value {
    json!({ "description": what, "type": ["number", "string"], "minimum": least, "maximum": most })
}

fn length(what: &str) -> Value {
    let description = in_units(what, Quantity::Length);
    json!({ "description": description, "type": ["number", "string"], "exclusiveMinimum": 0 })
}

/// A tensor of inertia.
fn inertia(what: &str) -> Value {
    let item = json!({ "type": ["number", "string"], "minimum": -INERTIA, "maximum": INERTIA });
    let what = format!("{what} [xx, yy, zz] or [xx, yy, zz, xy, xz, yz], kg m^2.");
    let mut tensor = array(&what, item);
    tensor["oneOf"] = json!([{ "minItems": 3, "maxItems": 3 }, { "minItems": 6, "maxItems": 6 }]);
    tensor
}

/// What the bodies weigh, and how thick they are.
pub fn bodies() -> Value {
    let by_name = |what: &str, of: Value| json!({ "description": what, "type": "object", "additionalProperties": of });
    let density =
        "The density of all bodies whose masses are not given, kilograms per cubic metre.";
    let masses =
        "Masses in kilograms, by the names of bodies: platform, or the joint that carries a link.";
    let radius = "the radius of the rods of all bodies whose radius is not given";
    let radii =
        "Radii of rods, by the names of bodies: base, platform, or the joint that carries a link.";
    let centres = "Centres of mass, where they are at home, by the names of bodies.";
    let inertias = "Tensors of inertia about the centres of mass, at home, base directions, kg m^2, by the names of bodies.";
    let payload = "What the platform carries, besides its own mass.";
    let of_payload = [
        ("mass", within("The payload's mass, kilograms.", MASSES)),
        (
            "centre",
            point(
                "the payload's centre of mass, where it is at home; the platform's point if it is not given",
                3,
            ),
        ),
        (
            "inertia",
            inertia(
                "The payload's inertia about its centre of mass; that of a point if it is not given.",
            ),
        ),
    ];
    let of_payload = of_payload.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
    let properties = [
        ("density", within(density, DENSITIES)),
        ("masses", by_name(masses, within("The mass of this body, kilograms.", MASSES))),
        ("centres", by_name(centres, point("the centre of mass of this body, at home", 3))),
        ("inertias", by_name(inertias, inertia("The inertia of this body."))),
        ("payload", closed(payload, of_payload, &["mass"])),
        ("radius", length(radius)),
        ("radii", by_name(radii, length("the radius of this body's rods"))),
    ];
    let description = "What the bodies weigh, for models of simulators, and how thick they are, for interference; \
                       kinematics do not depend on it.";
    closed(
        description,
        properties.map(|(key, value)| (key.to_owned(), value)).into_iter().collect(),
        &[],
    )
}

/// What stands around the mechanism.
pub fn obstacles() -> Value {
    let types = TYPES.map(|(word, _)| word);
    let description = "What it is: a box, a capsule (a cylinder with hemispheres at its ends), or all points on one \
                       side of a plane.";
    let size = in_units("the lengths of the edges, above 0", Quantity::Length);
    let properties = [
        ("name", name("The obstacle's name. If it is not given: obstacle1, obstacle2, ...")),
        ("type", json!({ "description": description, "enum": types })),
        ("centre", point("the centre of a box", 3)),
        ("size", numbers(&size, 3)),
        ("x", direction("the direction of a box's first edge; [1, 0, 0] if it is not given")),
        ("y", direction("the direction of a box's second edge; [0, 1, 0] if it is not given")),
        ("from", point("one end of a capsule's axis", 3)),
        ("to", point("the other end of a capsule's axis", 3)),
        ("radius", length("the radius of a capsule")),
        ("point", point("a point of the plane", 3)),
        ("normal", direction("the direction out of the obstacle")),
    ];
    let properties = properties.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
    let mut obstacle = described("An obstacle, in base coordinates.", object(properties));
    obstacle["required"] = json!(["type"]);
    let forms = TYPES.iter().map(|&(word, kind)| (word, form(&kind.keys(), kind.needs(), &[])));
    if let (Value::Object(obstacle), Value::Object(forms)) =
        (&mut obstacle, cases("type", forms.collect()))
    {
        obstacle.extend(forms);
    }
    array("What stands around the mechanism, at rest in the base.", obstacle)
}
