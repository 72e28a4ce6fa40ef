//! Notes on numbers without a unit that look as if they were meant in another one: `x=10` is ten metres.

use crate::args::Output;
use crate::change::Change;
use crate::load::Loaded;
use crate::pose::{Number, Pose};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::table::Plausible;

/// The end of a range so many times as large as the mechanism was probably meant in another unit; it may be wide on
/// purpose.
const WIDE: f64 = 100.0;

/// What a value of a quantity with this home looks like, of a mechanism.
pub fn plausible(
    quantity: Quantity,
    home: f64,
    (loaded, manipulator): (&Loaded, &Manipulator),
) -> Plausible {
    Plausible::new(quantity, home, manipulator.characteristic_length(), loaded.file.units)
}

/// The note on a number of a flag; `None` if it has a unit or looks right. `shown` is the number with its name as the flag
/// has it.
fn suspicion(
    plausible: &Plausible,
    number: Number,
    shown: impl Fn(&str) -> String,
) -> Option<String> {
    let value = number.without_unit()?;
    if plausible.holds(value) {
        return None;
    }
    let (unit, reading) = (plausible.meant(), plausible.reading(value));
    let [given, better] = [shown(&value.to_string()), shown(&format!("{value}{unit}"))];
    Some(format!("{given} has no unit and {reading}; if it is in {unit}, write {better}"))
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
    note(output, flag, (loaded, manipulator), pose.assignments(), Form::Assignment, |name| {
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
    note(output, flag, (loaded, manipulator), joints.assignments(), Form::Assignment, |name| {
        let c = manipulator.coordinates().iter().find(|c| c.name == name)?;
        Some((c.quantity, c.home))
    });
}

/// Notes which ends of ranges look misread; `find` gives a coordinate's quantity and home.
pub fn note_ranges<'a>(
    output: &Output,
    flag: &str,
    (loaded, manipulator): (&Loaded, &Manipulator),
    ends: impl IntoIterator<Item = (&'a str, Number)>,
) {
    let coordinates =
        manipulator.task_coordinates().iter().chain(manipulator.dependent_coordinates());
    let known: Vec<_> = coordinates.map(|c| (c.name, c.quantity, c.home)).collect();
    note(output, flag, (loaded, manipulator), ends, Form::Range, |name| {
        known.iter().find(|c| c.0 == name).map(|c| (c.1, c.2))
    });
}

/// Notes which values of a flag look misread that have no names: sizes, such as distances and standard deviations.
pub fn note_values(
    output: &Output,
    flag: &str,
    of: (&Loaded, &Manipulator),
    values: impl IntoIterator<Item = (Number, Quantity)>,
) {
    for (number, quantity) in values {
        let plausible = plausible(quantity, 0.0, of);
        if let Some(text) = suspicion(&plausible, number, str::to_owned) {
            output.note(format_args!("{flag}: {text}"));
        }
    }
}

/// Notes which numbers of --set look misread, for the mechanism as it is in the file.
pub fn note_changes(output: &Output, changes: &[Change], loaded: &Loaded) {
    let file = &loaded.file;
    let bare = |change: &&Change| change.numbers().any(|number| number.without_unit().is_some());
    let place = |change: &&Change| !file.is_of_drive(change.name());
    let given: Vec<&Change> = changes.iter().filter(place).filter(bare).collect();
    // Without a number that might be misread, nothing has to be compiled.
    let Some(manipulator) =
        (!given.is_empty()).then(|| Manipulator::new(file.mechanism.clone()).ok()).flatten()
    else {
        return;
    };
    for change in given {
        let form = if change.numbers().count() > 1 { Form::Range } else { Form::Assignment };
        let values = change.numbers().map(|number| (change.name(), number));
        note(output, "--set", (loaded, &manipulator), values, form, |name| {
            Some((file.quantity_of(name)?, 0.0))
        });
    }
}

/// How a flag gives numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// `x=10`
    Assignment,
    /// `x=-10:10:5`
    Range,
}

fn note<'a>(
    output: &Output,
    flag: &str,
    of: (&Loaded, &Manipulator),
    values: impl IntoIterator<Item = (&'a str, Number)>,
    form: Form,
    find: impl Fn(&str) -> Option<(Quantity, f64)>,
) {
    let mut noted: Vec<&str> = vec![];
    for (name, number) in values {
        let Some((quantity, home)) = find(name).filter(|_| !noted.contains(&name)) else {
            continue;
        };
        let mut plausible = plausible(quantity, home, of);
        if form == Form::Range {
            plausible = plausible.within(WIDE);
        }
        let shown = |value: &str| match form {
            Form::Assignment => format!("{name}={value}"),
            Form::Range => value.to_owned(),
        };
        if let Some(text) = suspicion(&plausible, number, shown) {
            match form {
                Form::Assignment => output.note(format_args!("{flag}: {text}")),
                Form::Range => output.note(format_args!("{flag}: {name}: {text}")),
            }
            noted.push(name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opm_core::mechanism::file::{AngleUnit, FileUnits, LengthUnit};

    fn said(text: &str, quantity: Quantity) -> Option<String> {
        let units = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
        let number = text.parse().expect("a number");
        let plausible = Plausible::new(quantity, 0.0, 0.3, units);
        suspicion(&plausible, number, |value| format!("q={value}"))
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
