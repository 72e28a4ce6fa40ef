//! The JSON schema of motion files.

use super::file::{KEYS, SINUSOID_KEYS};
use crate::mechanism::file::LARGEST;
use crate::mechanism::file::schema::{HEAD, Properties, closed, document, head, number, text};
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
    let required = [&HEAD[..], &["duration", "rate", "coordinates"]].concat();
    document(
        "motion",
        json!({
            "properties": properties,
            "required": required,
            "additionalProperties": false,
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
        _ => Value::Bool(true),
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
    let unit = match kind.quantity() {
        Quantity::Angle => "an angle in units.angle",
        Quantity::Length => "a length in units.length",
    };
    let description = format!("The task coordinate {}, {unit}.", kind.name());
    json!({ "description": description, "anyOf": [number, sinusoid, sum] })
}

fn sinusoid_key(key: &str, quantity: Quantity) -> Value {
    match key {
        "amplitude" => number("the amplitude", quantity),
        "frequency" => json!({
            "description": "The frequency in hertz.",
            "type": "number",
            "minimum": -LARGEST,
            "maximum": LARGEST,
        }),
        "phase" => number("the phase, 0 if it is not given", Quantity::Angle),
        "offset" => number("the mean value, 0 if it is not given", quantity),
        _ => Value::Bool(true),
    }
}
