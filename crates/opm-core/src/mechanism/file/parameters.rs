//! The parameters of families in files.

use super::Table;
use crate::mechanism::family::{Parameter, Slot};

/// Reads a family's `home`: zero where a coordinate is not given, NaN where it is not understood.
pub(in crate::mechanism) fn read_home(root: &Table<'_>, parameters: Vec<Parameter<'_>>) {
    let keys: Vec<_> = parameters.iter().map(|parameter| parameter.key).collect();
    let table = root.get("home").and_then(|value| value.table(&keys));
    for parameter in parameters {
        if let Slot::Number(quantity, slot) = parameter.slot
            && let Some(value) = table.and_then(|table| table.get(parameter.key))
        {
            *slot = value.quantity(quantity).unwrap_or(f64::NAN);
        }
    }
}

/// The tables of an array of legs with these parameters.
pub(in crate::mechanism) fn tables_of<'a>(
    root: &Table<'a>,
    key: &str,
    parameters: &[Parameter<'_>],
) -> Vec<Table<'a>> {
    root.tables(key, &keys(parameters))
}

/// The table of a leg with these parameters, which must be there; `expected` says what it stands for.
pub(in crate::mechanism) fn table_of<'a>(
    root: &Table<'a>,
    key: &str,
    expected: &str,
    parameters: &[Parameter<'_>],
) -> Option<Table<'a>> {
    root.require(key, expected)?.table(&keys(parameters))
}

/// Reads the parameters of a leg. What must be there and is not has been reported then, and is NaN for
/// the others to be checked nevertheless; so is all of it where there is no table at all.
pub(in crate::mechanism) fn read_leg(leg: Option<&Table<'_>>, parameters: Vec<Parameter<'_>>) {
    let limits = leg
        .and_then(|leg| leg.get("limits"))
        .and_then(|value| value.table(&limit_keys(&parameters)));
    for Parameter { key, expected, slot } in parameters {
        let required = || leg.and_then(|leg| leg.require(key, expected));
        match slot {
            Slot::Number(quantity, slot) => {
                *slot = required().and_then(|value| value.quantity(quantity)).unwrap_or(f64::NAN);
            }
            Slot::Optional(quantity, slot) => {
                let given = leg.and_then(|leg| leg.get(key));
                *slot = given.map(|value| value.quantity(quantity).unwrap_or(f64::NAN));
            }
            Slot::Point(slot) => {
                *slot = required().and_then(|value| value.point()).unwrap_or([f64::NAN; 2]);
            }
            Slot::Limits(quantity, slot) => {
                *slot = limits.and_then(|limits| limits.get(key)?.limits(quantity));
            }
        }
    }
}

/// What the table of a leg may have.
fn keys(parameters: &[Parameter<'_>]) -> Vec<&'static str> {
    let own = parameters.iter().filter(|parameter| !matches!(parameter.slot, Slot::Limits(..)));
    ["name"].into_iter().chain(own.map(|parameter| parameter.key)).chain(["limits"]).collect()
}

fn limit_keys(parameters: &[Parameter<'_>]) -> Vec<&'static str> {
    let limits = parameters.iter().filter(|parameter| matches!(parameter.slot, Slot::Limits(..)));
    limits.map(|parameter| parameter.key).collect()
}
