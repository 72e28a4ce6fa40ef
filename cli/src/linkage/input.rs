//! The joint that moves a linkage, in the syntax of the command line: `a1=30deg`.

use crate::analyze::load::numbers;
use crate::pose::{Misread, Number};
use nalgebra::Point3;
use opm_core::Quantity;
use std::str::FromStr;

/// A joint and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct InputValue {
    /// The name of the joint.
    pub name: String,
    /// Its value, if given.
    pub value: Option<Number>,
}

impl FromStr for InputValue {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let (name, value) = match text.split_once('=') {
            Some((name, value)) => (name, Some(value.parse()?)),
            None => (text, None),
        };
        Ok(Self { name: name.trim().to_owned(), value })
    }
}

/// A point of the platform at home, in base coordinates: `100mm,0,20mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplerPoint(pub Point3<f64>);

impl FromStr for CouplerPoint {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let of = |axis: &str, number: Number| number.value_of(axis, Quantity::Length);
        let at: [f64; 3] = numbers(text, ["X", "Y", "Z"], of)?;
        Ok(Self(at.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn an_input_is_a_name_and_a_value() {
        let value = |text: &str| text.parse::<InputValue>().map_err(|e| e.to_string());
        assert_eq!(value(" a1 ").unwrap(), InputValue { name: "a1".into(), value: None });
        let given = value("a1=180deg").unwrap();
        assert_eq!(given.value.unwrap().value_of("a1", Quantity::Angle), Ok(PI));
        assert!(given.value.unwrap().value_of("a1", Quantity::Length).is_err());
        assert!(value("a1=much").unwrap_err().contains("not a number"));
    }
}
