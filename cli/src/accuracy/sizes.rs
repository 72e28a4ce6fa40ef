//! Sizes of errors in the syntax of the command line.

use crate::args::AccuracyArgs;
use crate::failure::Failure;
use crate::load;
use crate::output::Shown;
use crate::pose::{Misread, Number};
use opm_accuracy::{Both, Source, Tolerances};
use opm_core::Quantity;
use opm_mcap::input::Expected;
use std::str::FromStr;

/// A length and an angle, or one of them; metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair(pub Both);

impl FromStr for Pair {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        const FORM: &str = "expected a length, an angle, or both, for example 20um,20urad";
        let mut both = Both::default();
        for part in text.split(',') {
            let number: Number = part.parse()?;
            let Some(quantity) = number.quantity() else {
                return Err(Misread(format!("{:?} has no unit, {FORM}", part.trim())));
            };
            let (place, what) = match quantity {
                Quantity::Length => (&mut both.length, "lengths"),
                Quantity::Angle => (&mut both.angle, "angles"),
            };
            let value = number.value_of("it", quantity)?;
            if value < 0.0 {
                return Err(Misread(format!("{:?} is negative, {FORM}", part.trim())));
            }
            if place.replace(value).is_some() {
                return Err(Misread(format!("two {what} in {text:?}, {FORM}")));
            }
        }
        Ok(Self(both))
    }
}

/// The size of every error that the flags give.
pub fn read(args: &AccuracyArgs, sources: &[Source]) -> Result<Vec<f64>, Failure> {
    let mut tolerances = match &args.tolerances {
        None => Tolerances::default(),
        Some(path) => {
            let label = path.shown();
            let text = load::existing(path, Expected::TOLERANCES)?;
            let read = Tolerances::read(&text, sources);
            read.map_err(|errors| Failure::because(errors.in_file(&label), errors))?
        }
    };
    if let Some(Pair(axes)) = args.axes {
        tolerances.axes = axes;
    }
    if let Some(Pair(given)) = args.actuators {
        let lacks = |s: &&Source| s.is_actuator() && given.of(s.quantity).is_none();
        if let Some(source) = sources.iter().find(lacks) {
            let (what, example) = match source.quantity {
                Quantity::Length => ("a length", "20um"),
                Quantity::Angle => ("an angle", "20urad"),
            };
            let problem = format!(
                "{} is {what}, and no size is given for it: add one, for example {example}",
                source.name
            );
            return Err(Failure::flag("--actuators", problem));
        }
        tolerances.actuators = given;
    }
    Ok(tolerances.of(sources))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        let both = |length, angle| Ok(Pair(Both { length, angle }));
        assert_eq!("20um,20urad".parse(), both(Some(20e-6), Some(20e-6)));
        assert_eq!(" 3\u{b5}m ".parse(), both(Some(3e-6), None));
        assert_eq!("0.02deg".parse(), both(None, Some(0.02_f64.to_radians())));
        for (text, expected) in [
            ("20", "has no unit, expected a length, an angle, or both"),
            ("", "is not a number"),
            ("1um,2mm", "two lengths in"),
            ("-1um", "is negative"),
            ("1um,2urad,3urad", "two angles"),
            ("1furlong", "unknown unit"),
        ] {
            let message = text.parse::<Pair>().expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
