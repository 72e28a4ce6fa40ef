//! The least change of the actuated joints with which the mechanism can be assembled.

use crate::output::named;
use opm_core::Quantity;
use opm_core::forward::LeastChange;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::joint::JointCoordinate;
use serde::Serialize;
use serde_json::{Map, Value};

/// Changes by joint, metres and radians.
#[derive(Serialize)]
pub struct Json {
    /// Of all joints: the sum of their squares is least, with lengths over `size`.
    together: Map<String, Value>,
    /// Of one joint with the others as given; null where none was found.
    alone: Map<String, Value>,
    size: f64,
}

fn actuated(manipulator: &Manipulator) -> impl Iterator<Item = &JointCoordinate> {
    manipulator.actuated().iter().map(|&number| &manipulator.coordinates()[number])
}

impl Json {
    pub fn new(manipulator: &Manipulator, least: &LeastChange) -> Self {
        let names = || actuated(manipulator).map(|c| c.name.as_str());
        let alone = names().zip(&least.alone);
        Self {
            together: named(names().zip(least.together.iter().copied()).collect::<Vec<_>>()),
            alone: alone.map(|(name, change)| (name.to_owned(), (*change).into())).collect(),
            size: manipulator.characteristic_length(),
        }
    }
}

/// What to change, in the file's units: a line for all joints together, and one for each alone.
pub fn lines(manipulator: &Manipulator, least: &LeastChange, units: FileUnits) -> Vec<String> {
    let shown = |c: &JointCoordinate, change: f64| {
        let sign = if change < 0.0 { "" } else { "+" };
        format!("{} {sign}{}", c.name, units.show(change, c.quantity))
    };
    let changes = actuated(manipulator).zip(&least.together).map(|(c, change)| shown(c, *change));
    let changes = changes.collect::<Vec<_>>().join(", ");
    if least.together.len() == 1 {
        return vec![format!("the least change that closes: {changes}")];
    }
    let has = |quantity| actuated(manipulator).any(|c| c.quantity == quantity);
    let weighed = match has(Quantity::Angle) && has(Quantity::Length) {
        false => String::new(),
        true => {
            let size = units.show(manipulator.characteristic_length(), Quantity::Length);
            format!(" ({size}, the mechanism's size, count as one radian)")
        }
    };
    let mut lines = vec![format!("the least change that closes: {changes}{weighed}")];
    let alone = actuated(manipulator).zip(&least.alone);
    let alone: Vec<String> = alone.filter_map(|(c, change)| Some(shown(c, (*change)?))).collect();
    if !alone.is_empty() {
        lines.push(format!("one joint alone: {}", alone.join(", or ")));
    }
    lines
}
