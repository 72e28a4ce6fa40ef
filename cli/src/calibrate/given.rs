//! Standard deviations and points in the syntax of the command line.

use crate::analyze::load::numbers;
use crate::pose::{Misread, Number, assignment};
use opm_calibrate::{BasePoint, SIGMAS, Sigma};
use opm_core::Quantity;
use std::str::FromStr;

/// Standard deviations: `20um,20urad`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmas {
    /// In SI.
    pub sigma: Sigma,
    /// As they were given: of lengths, and of angles.
    pub given: [Number; 2],
}

impl FromStr for Sigmas {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let of = |name: &str, number: Number| {
            let quantity = if name == "LENGTH" { Quantity::Length } else { Quantity::Angle };
            let value = number.value_of(name, quantity)?;
            if SIGMAS.contains(&value) {
                return Ok(value);
            }
            let shown = format!("{value:?}");
            let shown = shown.trim_end_matches(".0");
            Err(Misread::new(format!(
                "{name} is {shown}, expected a positive number, 1e-75 to 1e75"
            )))
        };
        let [length, angle] = numbers(text, ["LENGTH", "ANGLE"], of)?;
        let (first, second) = text.split_once(',').expect("two numbers were read");
        let given = [first.parse()?, second.parse()?];
        Ok(Self { sigma: Sigma { length, angle }, given })
    }
}

/// A point of the base by name: `A=0.5,0,20mm`.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPoint(pub BasePoint);

impl FromStr for NamedPoint {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let (name, at) = assignment(text, "NAME=X,Y,Z, for example A=0.5,0,20mm")?;
        let of = |axis: &str, number: Number| number.value_of(axis, Quantity::Length);
        let at: [f64; 3] = numbers(at, ["X", "Y", "Z"], of)?;
        Ok(Self(BasePoint { name: name.to_owned(), at: at.into() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_and_points_are_read_with_units() {
        assert_eq!("0.02mm,0.001deg".parse::<Sigmas>().unwrap().sigma.length, 2e-5);
        for (text, expected) in [
            ("20e-6", "1 number in \"20e-6\", expected 2: LENGTH,ANGLE"),
            ("0,1", "LENGTH is 0, expected a positive number, 1e-75 to 1e75"),
            ("5e-324,1", "LENGTH is 5e-324, expected"),
            ("1,1e300", "ANGLE is 1e300, expected"),
            ("1deg,1", "LENGTH is a length"),
        ] {
            let message = text.parse::<Sigmas>().expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
        let point = "A=1,20mm,-3".parse::<NamedPoint>().unwrap().0;
        assert_eq!((&*point.name, point.at), ("A", [1.0, 0.02, -3.0].into()));
        assert!("A=1,2".parse::<NamedPoint>().is_err());
    }
}
