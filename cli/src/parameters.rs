//! The numbers of a mechanism file that have names, as text and as JSON.

use crate::text::Table;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file::{FileUnits, LegPattern, MechanismFile, NamedParameter, NamedValue};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The named parameters as a table; for a family without any, the names of its dimensions.
pub fn lines(file: &MechanismFile) -> Vec<String> {
    if file.parameters.is_empty() {
        return of_family(file);
    }
    table(file).lines().skip(1).map(str::to_owned).collect()
}

/// The table of the named parameters that can be given: numbers that follow from no others.
fn table(file: &MechanismFile) -> String {
    let mut table = Table::new(["parameter", ">value", "what it is"]);
    for parameter in file.parameters.iter().filter(|parameter| parameter.formula.is_none()) {
        let NamedValue::Number(value) = parameter.value else { continue };
        let text = parameter.text.clone().unwrap_or_default();
        table.row([parameter.name.clone(), parameter.unit.show(value, file.units), text]);
    }
    table.to_string()
}

/// What `opm decompose` says of the names and the patterns of a file; nothing if there are none.
pub fn section(file: &MechanismFile) -> String {
    let mut text = String::new();
    for LegPattern { legs, text: what } in &file.patterns {
        let _ = writeln!(text, "\n{} are alike: {what}", legs.join(", "));
    }
    if !file.parameters.is_empty() {
        let _ = write!(text, "\n{}", table(file));
    }
    text
}

/// The names of the dimensions of a family's legs.
fn of_family(file: &MechanismFile) -> Vec<String> {
    let Some(family) = &file.family else { return Vec::new() };
    let names = family.parameters().into_iter().filter(|(_, value)| *value != ParameterValue::None);
    let names = names.filter_map(|(name, _)| Some(name.split_once('.')?.1.to_owned()));
    let names: BTreeSet<String> = names.collect();
    let names: Vec<String> = names.into_iter().collect();
    let mut lines = vec![format!("dimensions of the family {}:", family.word())];
    lines.extend(names.chunks(6).map(|names| format!("  {}", names.join(", "))));
    lines
}

/// The named parameters for programs, SI.
pub fn json(file: &MechanismFile) -> Vec<Value> {
    let one = |parameter: &NamedParameter| {
        let value = match parameter.value {
            NamedValue::Number(value) => json!(value),
            NamedValue::Point(point) => json!(point),
        };
        let unit = parameter.unit.quantity().map_or("", |quantity| FileUnits::SI.symbol(quantity));
        let [min, max] = parameter.range;
        json!({
            "name": parameter.name,
            "value": value,
            "unit": unit,
            "formula": parameter.formula,
            "min": min,
            "max": max,
            "text": parameter.text,
        })
    };
    file.parameters.iter().map(one).collect()
}
