//! Reading `[bodies]`: what the bodies of a mechanism weigh, and how thick they are.

use super::hint::expected_one_of;
use super::reader::{Table, Value};
use crate::mechanism::{BodyMasses, Mechanism, Shapes};

pub(super) const KEYS: &[&str] = &["density", "masses", "radius", "radii"];

/// The densities that bodies may have, kilograms per cubic metre: from less than air to more than any metal.
pub(super) const DENSITIES: [f64; 2] = [1e-3, 1e6];
/// The masses that bodies may have, kilograms: from a microgram to a thousand tons.
pub(super) const MASSES: [f64; 2] = [1e-9, 1e6];

/// Reads the table, if there is one, into a mechanism.
pub(super) fn read(root: &Table<'_>, mechanism: &mut Mechanism) {
    let Some(table) = root.get("bodies").and_then(|value| value.table(KEYS)) else { return };
    let density = table.get("density").and_then(|value| within(&value, DENSITIES, "kg/m^3"));
    let moving: Vec<&str> = mechanism.body_names().collect();
    let masses = table.get("masses").and_then(|value| value.open_table());
    let masses = masses
        .map(|masses| by_name(&masses, mechanism, &moving, |mass| within(mass, MASSES, "kg")));
    let radius = table.get("radius").and_then(|value| value.positive_length());
    let all = [&moving[..], &[Shapes::BASE]].concat();
    let radii = table.get("radii").and_then(|value| value.open_table());
    let radii = radii.map(|radii| by_name(&radii, mechanism, &all, length));
    mechanism.bodies = BodyMasses { density, masses: masses.unwrap_or_default() };
    (mechanism.shapes.radius, mechanism.shapes.radii) = (radius, radii.unwrap_or_default());
}

fn length(value: &Value<'_>) -> Option<f64> {
    value.positive_length()
}

/// Reads a number for some of the bodies with these names.
fn by_name(
    given: &Table<'_>,
    mechanism: &Mechanism,
    names: &[&str],
    read: impl Fn(&Value<'_>) -> Option<f64>,
) -> Vec<(String, f64)> {
    let known = names.iter().filter_map(|&name| Some((name.to_owned(), read(&given.get(name)?)?)));
    let known = known.collect();
    for name in given.keys().filter(|name| !names.contains(name)) {
        let at = given.location_of(name);
        let carries = mechanism.joints().any(|joint| joint.name == name);
        let problem = match carries {
            true => format!("the joint {name} carries the platform, expected `platform`"),
            false => format!("no body is called {name:?}, {}", expected_one_of(name, names)),
        };
        given.reader.report(at, problem);
    }
    known
}

/// Reads a number in a range.
fn within(value: &Value<'_>, [least, most]: [f64; 2], unit: &str) -> Option<f64> {
    let number = value.number()?;
    if (least..=most).contains(&number) {
        return Some(number);
    }
    value.report(format!("is {number} {unit}, expected {least:?} to {most:?} {unit}"));
    None
}
