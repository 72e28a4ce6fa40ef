//! Reading `[[difference]]`: limits of the differences of joints.

use super::reader::{Table, all};
use crate::mechanism::{Difference, DifferenceError, Mechanism};

pub(super) const KEYS: &[&str] = &["joints", "limits"];

/// Reads the limits of differences of a mechanism's joints, if there are any.
pub(super) fn read(root: &Table<'_>, mechanism: &mut Mechanism) {
    for table in root.tables("difference", KEYS) {
        mechanism.differences.extend(one(&table, mechanism));
    }
}

fn one(table: &Table<'_>, mechanism: &Mechanism) -> Option<Difference> {
    let joints = table.require("joints", "the names of two joints, [\"a\", \"b\"]");
    let limits = table.require("limits", "[lowest, highest] of the first value less the second");
    let (joints, limits) = (joints?, limits?);
    let items = joints.items("the names of two joints, [\"a\", \"b\"]")?;
    let names = all(items.iter().map(|item| item.string().map(str::to_owned)))?;
    let names: [String; 2] = match names.try_into() {
        Ok(names) => names,
        Err(names) => {
            let names: Vec<String> = names;
            joints.report(format!("has {} names, expected those of two joints", names.len()));
            return None;
        }
    };
    let mut difference = Difference { joints: names, limits: [0.0; 2] };
    let quantity = difference.quantity(mechanism);
    let quantity = quantity.map_err(|error| joints.report(told(&error))).ok()?;
    difference.limits = limits.limits(quantity)?;
    match difference.of(mechanism) {
        Ok(_) => return Some(difference),
        Err(DifferenceError::Home { name, value, limits: [low, high], quantity }) => {
            let show = |number| table.reader.units().show(number, quantity);
            limits.report(format!(
                "exclude home: {name} is {} there, expected it between {} and {}",
                show(value),
                show(low),
                show(high)
            ));
        }
        Err(error) => limits.report(told(&error)),
    }
    None
}

/// A problem as it is told of a key.
fn told(error: &DifferenceError) -> String {
    format!("cannot be used: {error}")
}
