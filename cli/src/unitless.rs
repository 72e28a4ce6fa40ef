//! Notes on numbers without a unit that look as if they were meant in another one: `x=10` is ten metres.

use crate::args::Output;
use crate::load::Loaded;
use crate::pose::{Number, Pose};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use std::f64::consts::TAU;

/// A length so many times as large as the mechanism was probably meant in another unit.
const FAR: f64 = 10.0;
/// Numbers from here on are refused by name.
const ABSURD: f64 = 1e15;

/// A coordinate that a flag gives a value.
struct Given<'a> {
    name: &'a str,
    quantity: Quantity,
    home: f64,
    number: Number,
}

/// Notes which task coordinates of a pose look misread.
pub fn note_pose(
    output: &Output,
    flag: &str,
    pose: &Pose,
    loaded: &Loaded,
    manipulator: &Manipulator,
) {
    let coordinates = manipulator.task_coordinates();
    note(output, flag, loaded, manipulator, pose, |name| {
        let c = coordinates.iter().find(|c| c.name == name)?;
        Some((c.quantity, c.home))
    });
}

/// Notes which joint values look misread.
pub fn note_joints(
    output: &Output,
    flag: &str,
    joints: &Pose,
    loaded: &Loaded,
    manipulator: &Manipulator,
) {
    note(output, flag, loaded, manipulator, joints, |name| {
        let c = manipulator.coordinates().iter().find(|c| c.name == name)?;
        Some((c.quantity, c.home))
    });
}

fn note(
    output: &Output,
    flag: &str,
    loaded: &Loaded,
    manipulator: &Manipulator,
    values: &Pose,
    find: impl Fn(&str) -> Option<(Quantity, f64)>,
) {
    let size = manipulator.characteristic_length();
    for (name, number) in values.assignments() {
        let given = find(name).map(|(quantity, home)| Given { name, quantity, home, number });
        if let Some(text) = given.and_then(|given| suspicion(&given, size, loaded.file.units)) {
            output.note(format_args!("{flag}: {text}"));
        }
    }
}

/// What is odd about a number without a unit, and what to write.
fn suspicion(given: &Given<'_>, size: f64, units: FileUnits) -> Option<String> {
    let &Given { name, quantity, home, number } = given;
    let value = number.without_unit().filter(|value| value.abs() < ABSURD)?;
    let (other, large) = match quantity {
        Quantity::Length => {
            let times = (value - home).abs() / size;
            let large = format!("{times:.0} times the size of the mechanism");
            ("mm", (times > FAR).then_some(large)?)
        }
        Quantity::Angle => {
            let large = format!("{:.0} degrees", value.to_degrees());
            ("deg", (value.abs() > TAU).then_some(large)?)
        }
    };
    // The unit of the file, if it is not the one that was assumed.
    let own = units.symbol(quantity);
    let unit = if own == quantity.unit() { other } else { own };
    let read = quantity.unit();
    Some(format!(
        "{name}={value} has no unit and was read as {value} {read}, {large}; if it is in {unit}, write \
         {name}={value}{unit}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use opm_core::mechanism::file::{AngleUnit, LengthUnit};

    fn said(text: &str, quantity: Quantity) -> Option<String> {
        let units = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
        let number = text.parse().expect("a number");
        suspicion(&Given { name: "q", quantity, home: 0.0, number }, 0.3, units)
    }

    #[test]
    fn only_numbers_without_a_unit_that_are_far_off_are_noted() {
        for (text, quantity) in [
            ("10mm", Quantity::Length),
            ("4000mm", Quantity::Length),
            ("2.9", Quantity::Length),
            ("0", Quantity::Angle),
            ("6.28", Quantity::Angle),
            ("859deg", Quantity::Angle),
        ] {
            assert_eq!(said(text, quantity), None, "{text}");
        }
        let length = said("10", Quantity::Length).expect("a note");
        assert!(
            length.contains("33 times the size") && length.contains("write q=10mm"),
            "{length}"
        );
        let angle = said("-15", Quantity::Angle).expect("a note");
        assert!(angle.contains("-859 degrees") && angle.contains("write q=-15deg"), "{angle}");
    }
}
