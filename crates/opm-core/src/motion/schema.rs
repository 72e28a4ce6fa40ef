//! The JSON schema of motion files.

use super::Ends;
use super::file::{KEYS, MOVE_KEYS, OF_COORDINATES, OF_MOVES, OF_POINTS, SINUSOID_KEYS};
use crate::mechanism::file::LARGEST;
use crate::mechanism::file::schema::{
    HEAD, Properties, closed, document, head, plain_number, text,
};
use crate::numeric::Quantity;
use crate::task::CoordinateKind;
use serde_json::{Value, json};

/// The JSON schema (draft 7) of motion files, for editors. Which coordinates and modes there are depends on
/// the mechanism; the schema knows those of all.
pub fn schema() -> String {
    let mut properties = head("motion");
    for &key in KEYS.iter().filter(|key| !HEAD.contains(key)) {
        properties.insert(key.to_owned(), meaning(key));
    }
    let required = [&HEAD[..], &["rate"]].concat();
    let without = |keys: &[&str]| -> Value {
        keys.iter().map(|&key| (key.to_owned(), Value::Bool(false))).collect()
    };
    document(
        "motion",
        json!({
            "properties": properties,
            "required": required,
            "additionalProperties": false,
            "if": { "required": ["moves"] },
            "then": {
                "required": ["acceleration"],
                "properties": without(&[OF_COORDINATES, OF_POINTS].concat()),
            },
            "else": {
                "if": { "required": ["points"] },
                "then": { "properties": without(&[OF_COORDINATES, OF_MOVES].concat()) },
                "else": {
                    "required": OF_COORDINATES,
                    "properties": without(&[OF_POINTS, OF_MOVES].concat()),
                },
            },
        }),
    )
}

fn meaning(key: &str) -> Value {
    let positive = |description: &str| {
        json!({
            "description": description,
            "type": "number",
            "exclusiveMinimum": 0,
            "maximum": LARGEST,
        })
    };
    match key {
        "duration" => positive("The duration in seconds."),
        "rate" => positive("The number of samples per second."),
        "mode" => text(
            "The working mode: home, or one sign for each choice, in a group for each leg. If it is not \
             given: home.",
        ),
        "coordinates" => {
            let coordinates =
                CoordinateKind::ALL.map(|kind| (kind.name().to_owned(), coordinate(kind)));
            let description = "Task coordinates as functions of time: a number, a sinusoid, or an array of \
                               these, which are added. The others stay at home. `opm decompose` names them.";
            closed(description, coordinates.into_iter().collect(), &[])
        }
        "ends" => json!({
            "description": "How the motion through the points starts and ends: rest (no speed), natural (no \
                            acceleration), or periodic (as it ends, so it starts). If it is not given: rest.",
            "enum": Ends::NAMES.map(|(name, _)| name),
        }),
        "points" => {
            let mut columns: Properties = CoordinateKind::ALL
                .map(|kind| (kind.name().to_owned(), column(kind)))
                .into_iter()
                .collect();
            let times = json!({
                "description": "The times in seconds, increasing.",
                "type": "array",
                "items": { "type": "number", "minimum": -LARGEST, "maximum": LARGEST },
                "minItems": 2,
            });
            columns.insert("t".to_owned(), times);
            let description = "Points that cubic splines join, in place of duration and coordinates: t, and for \
                               each coordinate that moves a value for each time. The others stay at home.";
            closed(description, columns, &["t"])
        }
        "feed" => positive(
            "The speed of the position along every move that has none of its own, in units.length per second.",
        ),
        "acceleration" => {
            positive("The acceleration along the moves, in units.length per second squared.")
        }
        "blend" => blend(
            "The distance before and behind every corner within which it is rounded, in units.length; 0 if it is not given: the motion halts at corners.",
        ),
        "start" => {
            pose("The pose at the start; coordinates that are not given are at home.", |_| true)
        }
        "moves" => {
            let keys = MOVE_KEYS.iter().map(|&key| {
                let value = match key {
                    "to" => pose("The pose at the end of the move; coordinates that are not given stay.", |_| true),
                    "via" => pose("A position on the way: the move is the arc through it.", |kind| kind.quantity() == Quantity::Length),
                    "feed" => positive("The speed along this move, in units.length per second."),
                    _ => blend("The distance from the corner at the end of this move within which it is rounded."),
                };
                (key.to_owned(), value)
            });
            json!({
                "description": "Straight lines and circular arcs, one after the other, in place of duration and \
                                coordinates.",
                "type": "array",
                "items": closed("One move.", keys.collect(), &["to"]),
                "minItems": 1,
            })
        }
        _ => Value::Bool(true),
    }
}

fn blend(description: &str) -> Value {
    json!({ "description": description, "type": "number", "minimum": 0 })
}

/// Some coordinates of a pose.
fn pose(description: &str, of: impl Fn(&CoordinateKind) -> bool) -> Value {
    let coordinates = CoordinateKind::ALL.into_iter().filter(of);
    let value = |kind: CoordinateKind| json!({ "description": format!("The task coordinate {}, {}.", kind.name(), unit(kind)), "type": "number" });
    closed(
        description,
        coordinates.map(|kind| (kind.name().to_owned(), value(kind))).collect(),
        &[],
    )
}

/// The values of a coordinate at points: one for each time, or the same at all.
fn column(kind: CoordinateKind) -> Value {
    let unit = unit(kind);
    let description = format!("The task coordinate {}, {unit}, at each time.", kind.name());
    let number = json!({ "type": "number" });
    let each = json!({ "type": "array", "items": number });
    json!({ "description": description, "anyOf": [number, each] })
}

/// The unit of a coordinate's values.
fn unit(kind: CoordinateKind) -> &'static str {
    match kind.quantity() {
        Quantity::Angle => "an angle in units.angle",
        Quantity::Length => "a length in units.length",
    }
}

/// The values of a coordinate: a constant, a sinusoid, or an array of both.
fn coordinate(kind: CoordinateKind) -> Value {
    let keys: Properties = SINUSOID_KEYS
        .iter()
        .map(|&key| (key.to_owned(), sinusoid_key(key, kind.quantity())))
        .collect();
    let formula = "offset + amplitude sin(2 pi frequency t + phase)";
    let sinusoid = closed(formula, keys, &["amplitude", "frequency"]);
    let number = json!({ "type": "number" });
    let sum = json!({ "type": "array", "items": { "anyOf": [number, sinusoid] } });
    let description = format!("The task coordinate {}, {}.", kind.name(), unit(kind));
    json!({ "description": description, "anyOf": [number, sinusoid, sum] })
}

fn sinusoid_key(key: &str, quantity: Quantity) -> Value {
    match key {
        "amplitude" => plain_number("the amplitude", quantity),
        "frequency" => json!({
            "description": "The frequency in hertz.",
            "type": "number",
            "minimum": -LARGEST,
            "maximum": LARGEST,
        }),
        "phase" => plain_number("the phase, 0 if it is not given", Quantity::Angle),
        "offset" => plain_number("the mean value, 0 if it is not given", quantity),
        _ => Value::Bool(true),
    }
}
