//! Poses and grids in the syntax of the command line: `x=10mm,xi=15deg`, `x=-0.1:0.1:11`.

mod axis;

pub use axis::{GridAxis, OverAxis, ends};

use crate::failure::Failure;
use crate::text::plural;
use opm_analysis::Index;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::{AngleUnit, FileUnits, LengthUnit};
use opm_core::task::TaskCoordinate;
use opm_workspace::Coordinate;
use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

/// A text that cannot be parsed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misread(pub String);

impl Misread {
    /// The problem, and what was expected.
    pub fn new(problem: String) -> Self {
        Self(problem)
    }
}

impl fmt::Display for Misread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Misread {}

/// A number, with or without a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Metres or radians.
    value: f64,
    /// The quantity of the unit; `None` for a number without a unit.
    quantity: Option<Quantity>,
}

/// Some coordinates of a pose, by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose(Vec<(String, Number)>);

/// The worst value of an index at which a pose counts.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexLimit {
    /// The index's name.
    pub name: String,
    /// Its worst value.
    pub bound: f64,
}

impl FromStr for IndexLimit {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let (name, value) = assignment(text, "NAME=VALUE, for example lti=0.7")?;
        let number = value.parse::<Number>()?;
        let length = Index::from_name(name).is_some_and(|index| index.facts().unit == "m");
        let bound = match length {
            true => number.value_of(name, Quantity::Length)?,
            false => number.bare(name)?,
        };
        Ok(Self { name: name.to_owned(), bound })
    }
}

/// A value of one task coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceValue {
    /// The coordinate's name.
    pub name: String,
    /// Its value.
    pub value: Number,
}

impl FromStr for SliceValue {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let (name, value) = assignment(text, "NAME=VALUE, for example xi=30deg")?;
        Ok(Self { name: name.to_owned(), value: value.parse()? })
    }
}

/// A unit with the letter u for micro, which has two code points.
fn plain(unit: &str) -> String {
    unit.replace(['\u{b5}', '\u{3bc}'], "u")
}

impl FromStr for Number {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let text = text.trim();
        let digits = text.trim_end_matches(char::is_alphabetic);
        let (number, unit) = text.split_at(digits.len());
        let value: f64 = number.trim_end().parse().map_err(|_| {
            Misread(format!("{text:?} is not a number, expected one like 0.01, 10mm or 15deg"))
        })?;
        let (value, quantity) = if unit.is_empty() {
            (value, None)
        } else if let Some(unit) = LengthUnit::from_symbol(&plain(unit)) {
            (unit.metres(value), Some(Quantity::Length))
        } else if let Some(unit) = AngleUnit::from_symbol(&plain(unit)) {
            (unit.radians(value), Some(Quantity::Angle))
        } else {
            let lengths = LengthUnit::ALL.map(LengthUnit::symbol);
            let known = lengths.into_iter().chain(AngleUnit::ALL.map(AngleUnit::symbol));
            return Err(Misread(format!(
                "unknown unit {unit:?} in {text:?}, expected one of {}",
                known.collect::<Vec<_>>().join(", ")
            )));
        };
        if !value.is_finite() {
            return Err(Misread(format!("{text:?} is too large a number")));
        }
        Ok(Self { value, quantity })
    }
}

impl Number {
    /// The value for a coordinate; its unit must suit the coordinate.
    fn of(self, coordinate: &TaskCoordinate) -> Result<f64, Misread> {
        self.value_of(coordinate.name, coordinate.quantity)
    }

    /// The value for `name`, which measures `quantity`; its unit must suit the quantity.
    pub fn value_of(self, name: &str, quantity: Quantity) -> Result<f64, Misread> {
        let what = |quantity| match quantity {
            Quantity::Angle => "an angle",
            Quantity::Length => "a length",
        };
        match self.quantity {
            Some(given) if given != quantity => Err(Misread(format!(
                "{name} is {}, but its value has the unit of {}",
                what(quantity),
                what(given)
            ))),
            _ => Ok(self.value),
        }
    }
}

impl Number {
    /// The value for `name`, whose quantity is that of the coordinate with this name. Unknown names are reported
    /// elsewhere.
    fn value_among(self, name: &str, coordinates: &[Coordinate]) -> Result<f64, Misread> {
        match coordinates.iter().find(|c| c.name == name) {
            Some(c) => self.value_of(name, c.quantity),
            None => Ok(self.value),
        }
    }

    /// The characteristic length given by `--length`.
    pub fn characteristic_length(self) -> Result<f64, Failure> {
        let length = self.value_of("the characteristic length", Quantity::Length);
        length.map_err(|error| Failure::flag("--length", error))
    }

    /// The quantity of its unit; `None` without one.
    pub fn quantity(self) -> Option<Quantity> {
        self.quantity
    }

    /// The value, in metres or radians, if it was given without a unit.
    pub fn without_unit(self) -> Option<f64> {
        self.quantity.is_none().then_some(self.value)
    }

    /// The value of `name`, which has no unit.
    pub fn bare(self, name: &str) -> Result<f64, Misread> {
        match self.quantity {
            Some(_) => Err(Misread(format!("{name} has a unit, expected a number alone"))),
            None => Ok(self.value),
        }
    }
}

impl FromStr for Pose {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let mut pose: Vec<(String, Number)> = Vec::new();
        for part in text.split(',').filter(|_| !text.trim().is_empty()) {
            let (name, value) = assignment(part, "NAME=VALUE, for example x=10mm")?;
            if pose.iter().any(|(known, _)| known == name) {
                return Err(Misread(format!("{name} is given twice")));
            }
            pose.push((name.to_owned(), value.parse()?));
        }
        Ok(Self(pose))
    }
}

impl Pose {
    /// Every coordinate of the pose. Coordinates that are not given have their home values.
    pub fn resolve(&self, manipulator: &Manipulator) -> Result<Vec<f64>, Failure> {
        self.resolve_for("--pose", manipulator)
    }

    /// The pose of a manipulator, and the values of dependent coordinates that were given.
    pub fn resolve_with_checks(
        &self,
        manipulator: &Manipulator,
    ) -> Result<(Vec<f64>, Checks), Failure> {
        let dependent = manipulator.dependent_coordinates();
        let follows = |name: &str| dependent.iter().position(|c| c.name == name);
        let (mut own, mut checks) = (Vec::new(), Vec::new());
        for (name, number) in &self.0 {
            match follows(name) {
                Some(i) => {
                    let value = number.of(&dependent[i]).map_err(|e| Failure::flag("--pose", e))?;
                    checks.push((i, value));
                }
                None => own.push((name.clone(), *number)),
            }
        }
        Ok((Self(own).resolve(manipulator)?, Checks(checks)))
    }

    /// As [`Pose::resolve`], for another flag.
    pub fn resolve_for(&self, flag: &str, manipulator: &Manipulator) -> Result<Vec<f64>, Failure> {
        self.given(flag, manipulator.home_pose(), manipulator)
    }

    /// The rates of all coordinates, per second. Rates that are not given are zero.
    pub fn resolve_rates(&self, manipulator: &Manipulator) -> Result<Vec<f64>, Failure> {
        let still = vec![0.0; manipulator.task_coordinates().len()];
        self.given("--rates", still, manipulator)
    }

    /// The values that a flag gives, in place of some of these.
    fn given(
        &self,
        flag: &str,
        values: Vec<f64>,
        manipulator: &Manipulator,
    ) -> Result<Vec<f64>, Failure> {
        for (name, _) in &self.0 {
            manipulator.refuse_following(name).map_err(|error| Failure::flag(flag, error))?;
        }
        self.fill(values, manipulator.task_coordinates()).map_err(|e| Failure::flag(flag, e))
    }

    /// The given names and values, in order.
    pub fn assignments(&self) -> impl Iterator<Item = (&str, Number)> {
        self.0.iter().map(|(name, number)| (&**name, *number))
    }

    /// The value of each of these coordinates, all of which must be given and no others.
    pub fn each_of(&self, coordinates: &[(String, Quantity)]) -> Result<Vec<f64>, Misread> {
        let names = || coordinates.iter().map(|(name, _)| &**name).collect::<Vec<_>>().join(", ");
        if let Some((name, _)) = self.0.iter().find(|(n, _)| coordinates.iter().all(|c| c.0 != *n))
        {
            return Err(Misread(format!("no varying coordinate {name:?}, expected {}", names())));
        }
        let value =
            |(name, quantity): &(String, Quantity)| match self.0.iter().find(|g| g.0 == *name) {
                Some((_, number)) => number.value_of(name, *quantity),
                None => Err(Misread(format!("{name} is not given, expected {}", names()))),
            };
        coordinates.iter().map(value).collect()
    }

    fn fill(
        &self,
        mut values: Vec<f64>,
        coordinates: &[TaskCoordinate],
    ) -> Result<Vec<f64>, Misread> {
        for (name, number) in &self.0 {
            let index = find(name, coordinates)?;
            values[index] = number.of(&coordinates[index])?;
        }
        Ok(values)
    }
}

/// Values of dependent coordinates that were given as a check: their numbers, and radians or metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Checks(Vec<(usize, f64)>);

/// A dependent coordinate counts as the one that was given if they differ by less than this, in radians or shares
/// of the mechanism's size: digits that were left out when it was written down.
const AS_GIVEN: f64 = 1e-4;

impl Checks {
    /// No checks.
    pub fn none() -> Self {
        Self(Vec::new())
    }

    /// The checks of a table's row: a value for every dependent coordinate, not a number where none is given.
    pub fn of_row(values: &[f64]) -> Self {
        Self(values.iter().copied().enumerate().filter(|(_, value)| !value.is_nan()).collect())
    }

    /// Whether dependent coordinates have the values that were given.
    pub fn hold(&self, manipulator: &Manipulator, dependent: &[f64]) -> bool {
        self.broken(manipulator, dependent).is_none()
    }

    /// The number and the given value of the first coordinate that has another value.
    fn broken(&self, manipulator: &Manipulator, dependent: &[f64]) -> Option<(usize, f64)> {
        let off = |i: usize, value: f64| {
            let off = dependent[i] - value;
            match manipulator.dependent_coordinates()[i].quantity {
                Quantity::Length => off.abs() / manipulator.characteristic_length(),
                Quantity::Angle => (off - TAU * (off / TAU).round()).abs(),
            }
        };
        self.0.iter().copied().find(|&(i, value)| off(i, value) > AS_GIVEN)
    }

    /// Refuses the dependent coordinates of a solution that are not those that were given.
    pub fn verify(
        &self,
        manipulator: &Manipulator,
        dependent: &[f64],
        units: FileUnits,
    ) -> Result<(), Misread> {
        let Some((i, value)) = self.broken(manipulator, dependent) else { return Ok(()) };
        let c = &manipulator.dependent_coordinates()[i];
        let [given, found] = [value, dependent[i]].map(|value| units.show(value, c.quantity));
        Err(Misread(format!(
            "{} is given as {given}, but follows from the other coordinates as {found} in this mode",
            c.name
        )))
    }

    /// What to say where no solution of all working modes has the values that were given.
    pub fn refusal(modes: usize) -> Misread {
        let modes = plural(modes as u64, "working mode");
        Misread(format!("the dependent coordinates have other values in all {modes}"))
    }
}

pub fn assignment<'a>(text: &'a str, form: &str) -> Result<(&'a str, &'a str), Misread> {
    match text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
        Some((name, value)) if !name.is_empty() && !value.is_empty() => Ok((name, value)),
        _ => Err(Misread(format!("{:?}, expected {form}", text.trim()))),
    }
}

/// The number of the task coordinate of this name.
pub fn find(name: &str, coordinates: &[TaskCoordinate]) -> Result<usize, Misread> {
    coordinates.iter().position(|c| c.name == name).ok_or_else(|| {
        let names: Vec<_> = coordinates.iter().map(|c| c.name).collect();
        Misread(format!("no task coordinate {name:?}, expected one of {}", names.join(", ")))
    })
}

/// A value in SI as a flag takes it: in these units if few digits are exactly this value, otherwise in SI.
pub fn flag_value(value: f64, quantity: Quantity, units: FileUnits) -> String {
    /// Nanometres, and millionths of degrees.
    const DIGITS: f64 = 1e6;
    let rounded = (value / units.factor(quantity) * DIGITS).round() / DIGITS + 0.0;
    let text = format!("{rounded}{}", units.symbol(quantity));
    let read = text.parse().ok().and_then(|number: Number| number.value_of("", quantity).ok());
    if read == Some(value) { text } else { format!("{value}{}", quantity.unit()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opm_core::task::CoordinateKind;
    use opm_workspace::Axis;
    use std::f64::consts::PI;

    fn coordinates() -> [TaskCoordinate; 2] {
        [TaskCoordinate::new(CoordinateKind::X, 0.5), TaskCoordinate::new(CoordinateKind::Xi, 0.25)]
    }

    fn pose(text: &str) -> Result<Vec<f64>, String> {
        let pose: Pose = text.parse().map_err(|error: Misread| error.to_string())?;
        pose.fill(vec![0.5, 0.25], &coordinates()).map_err(|error| error.to_string())
    }

    #[test]
    fn values_of_flags_are_read_back_exactly() {
        let file = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
        for (value, shown) in [
            (0.0, "0deg"),
            (-std::f64::consts::PI, "-180deg"),
            (-1.7, "-1.7rad"),
            (0.1 + 0.2, "0.30000000000000004rad"),
        ] {
            let text = flag_value(value, Quantity::Angle, file);
            assert_eq!(text, shown);
            let read = text.parse::<Number>().unwrap().value_of("", Quantity::Angle);
            assert_eq!(read, Ok(value));
        }
        assert_eq!(flag_value(0.23, Quantity::Length, file), "230mm");
    }

    #[test]
    fn units_are_converted_and_the_rest_stays_home() {
        assert_eq!(pose(""), Ok(vec![0.5, 0.25]));
        assert_eq!(pose("x=9mm"), Ok(vec![0.009, 0.25]));
        assert_eq!(pose(" xi = 180 deg , x=-1e-2 "), Ok(vec![-0.01, PI]));
        assert_eq!(pose("x=1in,xi=0.2rad"), Ok(vec![0.0254, 0.2]));
        assert_eq!(pose("x=2.5cm"), Ok(vec![0.025, 0.25]));
        assert_eq!(pose("x=20um,xi=3mrad"), Ok(vec![20e-6, 0.003]));
        assert_eq!(pose("x=7\u{b5}m,xi=30\u{3bc}rad"), Ok(vec![7e-6, 30e-6]));
    }

    #[test]
    fn a_bad_pose_says_what_is_wrong() {
        for (text, expected) in [
            ("x", "expected NAME=VALUE"),
            ("x=", "expected NAME=VALUE"),
            ("=1", "expected NAME=VALUE"),
            ("x=1,,xi=2", "expected NAME=VALUE"),
            ("x=10furlong", "unknown unit \"furlong\""),
            ("x=10MM", "unknown unit \"MM\""),
            ("x=ten", "not a number"),
            ("x=nan", "not a number"),
            ("x=inf", "not a number"),
            ("x=1e999", "too large"),
            ("x=1,x=2", "x is given twice"),
            ("yaw=1", "no task coordinate \"yaw\", expected one of x, xi"),
            ("x=10deg", "x is a length, but its value has the unit of an angle"),
            ("xi=10mm", "xi is an angle, but its value has the unit of a length"),
        ] {
            let message = pose(text).expect_err(text);
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn a_grid_axis_is_a_range_or_a_value() {
        let axis = |text: &str| {
            let coordinates: Vec<Coordinate> = (coordinates().iter())
                .map(|c| Coordinate {
                    name: c.name.to_owned(),
                    kind: Some(c.kind()),
                    quantity: c.quantity,
                    home: c.home,
                    counts_turns: false,
                })
                .collect();
            text.parse::<GridAxis>().unwrap().resolve(&coordinates)
        };
        assert_eq!(axis("x=-10mm:10mm:21").unwrap(), Axis::new("x", -0.01, 0.01, 21));
        assert_eq!(axis("x=0:10mm:3").unwrap(), Axis::new("x", 0.0, 0.01, 3));
        assert_eq!(axis("xi=0.5").unwrap(), Axis::fixed("xi", 0.5));
        assert!(
            matches!(axis("x=0:1deg:3"), Err(Failure::Usage(text)) if text.to_string().starts_with("--grid: "))
        );
    }

    #[test]
    fn a_bad_grid_axis_says_what_is_wrong() {
        for (text, expected) in [
            ("x=1:2", "expected AXIS=MIN:MAX:COUNT"),
            ("x=1:2:3:4", "expected AXIS=MIN:MAX:COUNT"),
            ("x=1:2:-3", "\"-3\" is not a number of values"),
            ("x=1:2:2.5", "\"2.5\" is not a number of values"),
            ("x=1:2:99999999999999999999", "is not a number of values"),
            ("x=-10:10mm:3", "a unit at one end only"),
            ("x=10mm:20:3", "a unit at one end only"),
            ("x=a:b:3", "not a number"),
        ] {
            let message = text.parse::<GridAxis>().expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
