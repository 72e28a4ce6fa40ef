//! The parts that schemas consist of.

use super::Properties;
use crate::mechanism::joint::DriveLimit;
use crate::numeric::Quantity;
use serde_json::{Value, json};

/// Names are not empty, have no spaces around them, and none of the characters that would break them on
/// command lines and in headers of tables.
const NAME: &str = concat!(
    r#"^[^\s,="\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufdd0-\ufdef\ufeff\ufff9-\ufffb\ufffe\uffff]"#,
    r#"([^,="\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufdd0-\ufdef\ufeff\ufff9-\ufffb\ufffe\uffff]*"#,
    r#"[^\s,="\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufdd0-\ufdef\ufeff\ufff9-\ufffb\ufffe\uffff])?$"#
);

/// A name.
pub fn name(description: &str) -> Value {
    json!({ "description": description, "type": "string", "pattern": NAME })
}

/// Any text.
pub fn text(description: &str) -> Value {
    json!({ "description": description, "type": "string" })
}

/// A number, or an expression: a length or an angle in the units of the file.
pub fn number(description: &str, quantity: Quantity) -> Value {
    json!({ "description": in_units(description, quantity), "type": ["number", "string"] })
}

/// A number that is no expression, as in other files than those of mechanisms.
pub fn plain_number(description: &str, quantity: Quantity) -> Value {
    json!({ "description": in_units(description, quantity), "type": "number" })
}

/// The description of a length or an angle, with its unit.
pub fn in_units(description: &str, quantity: Quantity) -> String {
    let unit = match quantity {
        Quantity::Angle => "units.angle",
        Quantity::Length => "units.length",
    };
    format!("{} In {unit}.", sentence(description))
}

/// A direction in space.
pub fn direction(description: &str) -> Value {
    let description = format!("{} Its length does not matter.", sentence(description));
    numbers(&description, 3)
}

/// A point in the plane or in space.
pub fn point(description: &str, dimension: usize) -> Value {
    numbers(&in_units(description, Quantity::Length), dimension)
}

/// The lowest and the highest value of a coordinate.
pub fn limits(description: &str, quantity: Quantity) -> Value {
    numbers(&in_units(description, quantity), 2)
}

/// The largest rate, acceleration or effort of a joint.
pub fn drive_limit(description: &str, limit: DriveLimit, quantity: Quantity) -> Value {
    let unit = match (limit, quantity) {
        (DriveLimit::Motion(limit), Quantity::Angle) => format!("units.angle{}", limit.per_time()),
        (DriveLimit::Motion(limit), Quantity::Length) => {
            format!("units.length{}", limit.per_time())
        }
        (DriveLimit::Effort, _) => limit.unit(quantity).to_owned(),
    };
    let description = format!("{description} In {unit}, above 0.");
    json!({ "description": description, "type": ["number", "string"], "exclusiveMinimum": 0 })
}

/// An array of `count` numbers. Three of them may be one expression.
pub fn numbers(description: &str, count: usize) -> Value {
    let item = json!({ "type": ["number", "string"] });
    let mut numbers = exactly(count, array(description, item));
    if count == 3 {
        numbers["type"] = json!(["array", "string"]);
    }
    numbers
}

/// An array with items of one kind.
pub fn array(description: &str, item: Value) -> Value {
    let mut array = json!({ "description": description, "type": "array" });
    array["items"] = item;
    array
}

/// The array `array` with exactly `count` items.
pub fn exactly(count: usize, mut array: Value) -> Value {
    array["minItems"] = json!(count);
    array["maxItems"] = json!(count);
    array
}

/// A table whose keys depend on its form.
pub fn object(properties: Properties) -> Value {
    let mut table = json!({ "type": "object" });
    table["properties"] = Value::Object(properties);
    table
}

/// A value with a description.
pub fn described(description: &str, mut value: Value) -> Value {
    value["description"] = json!(description);
    value
}

/// A table with these keys only.
pub fn closed(description: &str, properties: Properties, required: &[&str]) -> Value {
    let mut table = described(description, object(properties));
    table["required"] = json!(required);
    table["additionalProperties"] = json!(false);
    table
}

/// The keys of a table in one of its forms, beyond what is said of them in all forms; `narrower` has what
/// this form says of the values of some keys.
pub fn form(keys: &[&str], required: &[&str], narrower: &[(&str, Value)]) -> Value {
    let mut properties: Properties =
        keys.iter().map(|&key| (key.to_owned(), Value::Bool(true))).collect();
    for (key, value) in narrower {
        properties.insert((*key).to_owned(), value.clone());
    }
    json!({ "properties": properties, "required": required, "additionalProperties": false })
}

/// The forms of a table, one for each value of its key `key`. Conditions are nested, because editors show
/// the error of the one that applies.
pub fn cases(key: &str, forms: Vec<(&str, Value)>) -> Value {
    forms.into_iter().rev().fold(Value::Bool(true), |rest, (word, form)| {
        let is = json!({ "properties": { key: { "const": word } }, "required": [key] });
        json!({ "if": is, "then": form, "else": rest })
    })
}

/// Joins what several forms of a table say of a key: the values are of one kind, but mean different
/// things. The description then says which is which.
pub fn joined(meanings: &[(&str, &Value)]) -> Value {
    let Some((_, first)) = meanings.first() else { return Value::Bool(true) };
    let mut joined = (*first).clone();
    if meanings.iter().any(|(_, meaning)| meaning["description"] != first["description"]) {
        let lines = meanings.iter().filter_map(|(form, meaning)| {
            Some(format!("{form}: {}", meaning["description"].as_str()?))
        });
        joined["description"] = json!(lines.collect::<Vec<_>>().join("\n\n"));
    }
    if first["items"].is_object() {
        let items: Vec<_> =
            meanings.iter().map(|(form, meaning)| (*form, &meaning["items"])).collect();
        joined["items"] = self::joined(&items);
    }
    let tables: Vec<_> = meanings
        .iter()
        .filter_map(|(form, meaning)| Some((*form, meaning["properties"].as_object()?)))
        .collect();
    if !tables.is_empty() {
        joined["properties"] = Value::Object(joined_tables(&tables));
    }
    joined
}

/// Joins the keys of several forms of a table.
pub fn joined_tables<'a>(tables: &[(&'a str, &'a Properties)]) -> Properties {
    let mut joined = Properties::new();
    for key in tables.iter().flat_map(|(_, keys)| keys.keys()) {
        let of = |(form, keys): &(&'a str, &'a Properties)| Some((*form, keys.get(key)?));
        let meanings: Vec<_> = tables.iter().filter_map(of).collect();
        joined.entry(key).or_insert_with(|| self::joined(&meanings));
    }
    joined
}

/// The text with a capital letter and a full stop.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    let stop = if text.ends_with('.') { "" } else { "." };
    first.chain(letters).chain(stop.chars()).collect()
}
