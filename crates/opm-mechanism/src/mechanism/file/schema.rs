//! JSON schemas (draft 7) of mechanism files, with which editors complete, explain and check them.
//!
//! A schema is made from the tables by which files are read. Each table of a file has two parts in it: what
//! every key means and which values it has, whatever the form of the file; and which keys there are in each
//! form. Editors complete by the first part, and the second one checks. What a schema cannot say is left to
//! the reader: the geometry, equal names, the order of limits, the size of numbers.

mod families;
mod joints;
mod named;
mod surroundings;
mod values;

pub use values::{closed, plain_number, text};

use super::read::FORMAT;
use super::units::{AngleUnit, LengthUnit};
use serde_json::{Map, Value, json};
use values::{array, cases};

/// What the keys of a table mean, and which values they have.
pub type Properties = Map<String, Value>;

/// The JSON schema of mechanism files.
pub fn schema() -> String {
    let mut properties = head("mechanism");
    properties.extend(families::properties());
    properties.extend(joints::properties());
    properties.insert("bodies".to_owned(), surroundings::bodies());
    properties.insert("parameters".to_owned(), named::parameters());
    properties.insert("obstacle".to_owned(), surroundings::obstacles());
    properties.insert("difference".to_owned(), joints::differences());
    // Both kinds of files have legs in `leg`.
    properties.insert("leg".to_owned(), legs());
    document(
        "mechanism",
        json!({
            "properties": properties,
            "required": HEAD,
            "if": { "required": ["family"] },
            "then": cases("family", families::forms()),
            "else": joints::joint_list(),
        }),
    )
}

/// The keys that every file has.
pub const HEAD: [&str; 3] = ["format", "name", "units"];

/// The schema of a whole file of the kind `kind`.
pub fn document(kind: &str, root: Value) -> String {
    let mut schema = Map::new();
    schema.insert("$schema".to_owned(), json!("http://json-schema.org/draft-07/schema#"));
    schema.insert("title".to_owned(), json!(format!("{kind} file of opm")));
    let description = "`opm help format` explains the format.";
    schema.insert("description".to_owned(), json!(description));
    schema.insert("type".to_owned(), json!("object"));
    if let Value::Object(root) = root {
        schema.extend(root);
    }
    let mut text = format!("{:#}", Value::Object(schema));
    text.push('\n');
    text
}

/// The properties of [`HEAD`].
pub fn head(kind: &str) -> Properties {
    let unit = |what: &str, symbols: &[&str]| json!({ "description": what, "enum": symbols });
    let mut units = Map::new();
    let length = "The unit of every length in the file. A pitch is in this unit per radian.";
    units.insert("length".to_owned(), unit(length, &LengthUnit::ALL.map(LengthUnit::symbol)));
    let angle = "The unit of every angle in the file.";
    units.insert("angle".to_owned(), unit(angle, &AngleUnit::ALL.map(AngleUnit::symbol)));
    let mut properties = Map::new();
    let mut add = |key: &str, value| properties.insert(key.to_owned(), value);
    let version = format!("The version of the format: {FORMAT}.");
    add("format", json!({ "description": version, "type": "integer", "const": FORMAT }));
    add("name", values::name(&format!("The {kind}'s name.")));
    let description =
        "The units of the numbers in this file, such as { length = \"mm\", angle = \"deg\" }.";
    add("units", closed(description, units, &["length", "angle"]));
    properties
}

/// The legs of a list of joints, and those of families whose legs are all alike.
fn legs() -> Value {
    let mut keys = families::legs_called("leg");
    keys.extend(joints::leg_properties());
    let description = "A leg of the mechanism, with its joints from base to platform or with the \
                       parameters of its family.";
    array(description, values::object(keys))
}
