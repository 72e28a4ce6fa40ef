//! Reading the parameters of families.

use super::Table;
use crate::mechanism::family::{JointTable, Parameter, ParameterRef};

/// Reads a family's `home`. A coordinate is zero if it is not given and NaN if it cannot be read.
pub(in crate::mechanism) fn read_home(root: &Table<'_>, parameters: Vec<Parameter<'_>>) {
    let keys: Vec<_> = parameters.iter().map(|parameter| parameter.key).collect();
    let table = root.get("home").and_then(|value| value.table(&keys));
    for parameter in parameters {
        if let ParameterRef::Number(quantity, target) = parameter.target
            && let Some(value) = table.and_then(|table| table.get(parameter.key))
        {
            *target = value.quantity(quantity).unwrap_or(f64::NAN);
        }
    }
}

/// Opens the tables of an array of legs with these parameters.
pub(in crate::mechanism) fn tables_of<'a>(
    root: &Table<'a>,
    key: &str,
    parameters: &[Parameter<'_>],
) -> Vec<Table<'a>> {
    root.tables(key, &keys(parameters))
}

/// Opens the table of a leg with these parameters. The table is required; `expected` describes it.
pub(in crate::mechanism) fn table_of<'a>(
    root: &Table<'a>,
    key: &str,
    expected: &str,
    parameters: &[Parameter<'_>],
) -> Option<Table<'a>> {
    root.require(key, expected)?.table(&keys(parameters))
}

/// Reads the parameters of a leg. A required parameter that is missing is reported and becomes NaN,
/// so that the others are checked too. Without a table, all of them are NaN.
pub(in crate::mechanism) fn read_leg(leg: Option<&Table<'_>>, parameters: Vec<Parameter<'_>>) {
    let tables = JointTable::ALL.map(|table| {
        let value = leg.and_then(|leg| leg.get(table.key()));
        (table, value.and_then(|value| value.table(&joint_keys(&parameters, table))))
    });
    for Parameter { key, table, expected, target } in parameters {
        let of_joint = || {
            let (_, entries) = tables.iter().find(|(own, _)| Some(*own) == table)?;
            entries.as_ref()?.get(key)
        };
        let required = || leg.and_then(|leg| leg.require(key, expected));
        match target {
            ParameterRef::Number(quantity, target) => {
                *target = required().and_then(|value| value.quantity(quantity)).unwrap_or(f64::NAN);
            }
            ParameterRef::Optional(quantity, target) => {
                let given = leg.and_then(|leg| leg.get(key));
                *target = given.map(|value| value.quantity(quantity).unwrap_or(f64::NAN));
            }
            ParameterRef::Point(target) => {
                *target = required().and_then(|value| value.point()).unwrap_or([f64::NAN; 2]);
            }
            ParameterRef::Limits(quantity, target) => {
                *target = of_joint().and_then(|value| value.limits(quantity));
            }
            ParameterRef::DriveLimit(limit, quantity, target) => {
                *target = of_joint().and_then(|value| value.drive_limit(limit, quantity));
            }
            ParameterRef::Drive(number, quantity, target) => {
                *target = of_joint().and_then(|value| value.drive_number(number, quantity));
            }
            ParameterRef::Offset(quantity, target) => {
                *target = of_joint().and_then(|value| value.quantity(quantity));
            }
        }
    }
}

/// The keys that the table of a leg may have.
pub(super) fn keys(parameters: &[Parameter<'_>]) -> Vec<&'static str> {
    let own = parameters.iter().filter(|parameter| parameter.table.is_none());
    let tables = JointTable::ALL.map(JointTable::key);
    ["name"].into_iter().chain(own.map(|parameter| parameter.key)).chain(tables).collect()
}

/// The keys of the joints that a table of a leg may have.
pub(super) fn joint_keys(parameters: &[Parameter<'_>], table: JointTable) -> Vec<&'static str> {
    let joints = parameters.iter().filter(|parameter| parameter.table == Some(table));
    joints.map(|parameter| parameter.key).collect()
}
