//! The part of the schema that describes named parameters, and patterns of legs.

use super::values::{array, closed, direction, in_units, number, numbers, point, text};
use super::{Properties, Value, json};
use crate::mechanism::file::named::{KEYS, ParameterUnit};
use crate::mechanism::file::pattern;
use crate::numeric::Quantity;

/// What `[parameters]` means.
pub fn parameters() -> Value {
    let keys = KEYS.iter().map(|&key| (key.to_owned(), parameter_key(key))).collect();
    let table = closed("A parameter with its unit.", keys, &["value"]);
    json!({
        "description": "Numbers and points with names, for expressions. A plain one has the unit \"number\".",
        "type": "object",
        "propertyNames": { "pattern": "^[A-Za-z_][A-Za-z0-9_]*$" },
        "additionalProperties": { "anyOf": [value(), table] },
    })
}

/// A number, an expression, or a point.
fn value() -> Value {
    json!({ "anyOf": [{ "type": ["number", "string"] }, numbers("A point or a direction.", 3)] })
}

fn parameter_key(key: &str) -> Value {
    let bound = |what: &str| {
        let description = format!("The {what} value that it may have, in its unit.");
        json!({ "description": description, "type": ["number", "string"] })
    };
    match key {
        "value" => value(),
        "unit" => json!({
            "description": "What it measures: a length or an angle in the units of the file, or a number without a unit.",
            "enum": ParameterUnit::NAMED.map(|(word, _)| word),
        }),
        "min" => bound("least"),
        "max" => bound("largest"),
        _ => text("What it is."),
    }
}

/// What `pattern` means.
pub fn pattern() -> Value {
    let keys: Properties =
        pattern::KEYS.iter().map(|&key| (key.to_owned(), pattern_key(key))).collect();
    let description = "Makes several legs of the description: turned about an axis, mirrored, or with points of their own. \
                       {i} in names is the number of the leg, also in those of parameters, and so is i in expressions.";
    let mut pattern = closed(description, keys, &[]);
    let given = ["count", "angles", "repeat", "mirror"].map(|key| json!({ "required": [key] }));
    pattern["anyOf"] = json!(given);
    pattern
}

fn pattern_key(key: &str) -> Value {
    match key {
        "count" => json!({
            "description": "The number of legs, all around the axis.", "type": "integer", "minimum": 1,
        }),
        "repeat" => json!({
            "description": "The number of legs, none of them turned: what differs has {i} or i in its expressions.",
            "type": "integer", "minimum": 1,
        }),
        "first" => json!({
            "description": "The number of the first leg, 1 if it is not given.", "type": "integer", "minimum": 1,
        }),
        "axis" => direction("the axis, that of z if it is not given"),
        "point" => point("a point of the axis, the origin if it is not given", 3),
        "angles" => {
            let description = in_units("by how much each leg is turned", Quantity::Angle);
            array(&description, number("an angle", Quantity::Angle))
        }
        _ => {
            let keys = pattern::MIRROR_KEYS.iter().map(|&key| {
                let value = match key {
                    "normal" => direction("the normal of the plane"),
                    _ => point("a point of the plane, the origin if it is not given", 3),
                };
                (key.to_owned(), value)
            });
            closed("A plane in which each leg is mirrored.", keys.collect(), &["normal"])
        }
    }
}
