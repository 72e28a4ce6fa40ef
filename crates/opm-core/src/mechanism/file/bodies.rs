//! Reading `[bodies]`: what the bodies of a mechanism weigh.

use super::checks::LARGEST;
use super::hint::expected_one_of;
use super::reader::{Table, Value};
use crate::mechanism::{BodyMasses, Mechanism};

pub(super) const KEYS: &[&str] = &["density", "masses"];

/// Reads the table, if there is one.
pub(super) fn read(root: &Table<'_>, mechanism: &Mechanism) -> BodyMasses {
    let Some(table) = root.get("bodies").and_then(|value| value.table(KEYS)) else {
        return BodyMasses::default();
    };
    let density = table.get("density").and_then(|value| positive(&value, "kg/m^3"));
    let names: Vec<&str> = mechanism.body_names().collect();
    let masses = table.get("masses").and_then(|value| value.open_table());
    let read = |masses: Table<'_>| {
        let known = names
            .iter()
            .filter_map(|&name| Some((name.to_owned(), positive(&masses.get(name)?, "kg")?)));
        let known = known.collect();
        for name in masses.keys().filter(|name| !names.contains(name)) {
            let at = masses.location_of(name);
            let carries = mechanism.joints().any(|joint| joint.name == name);
            let problem = match carries {
                true => format!("the joint {name} carries the platform, expected `platform`"),
                false => format!("no body is called {name:?}, {}", expected_one_of(name, &names)),
            };
            masses.reader.report(at, problem);
        }
        known
    };
    BodyMasses { density, masses: masses.map(read).unwrap_or_default() }
}

/// Reads a number that is above zero.
fn positive(value: &Value<'_>, unit: &str) -> Option<f64> {
    let number = value.number()?;
    if number > 0.0 && number <= LARGEST {
        return Some(number);
    }
    value.report(format!("is {number} {unit}, expected a value above 0 and at most {LARGEST:e}"));
    None
}
