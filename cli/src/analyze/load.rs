//! Loads in the syntax of the command line.

use crate::pose::{Misread, Number};
use crate::text::plural;
use opm_analysis::{LoadPoint, Wrench};
use opm_core::Quantity;
use opm_core::nalgebra::Vector3;
use std::str::FromStr;

/// Largest component, newtons and newton metres.
const LARGEST: f64 = 1e15;

const NAMES: [&str; 6] = ["FX", "FY", "FZ", "MX", "MY", "MZ"];

/// The six components of a wrench, newtons and newton metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchComponents(pub Wrench);

/// Where a force acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At(pub LoadPoint);

/// The stiffness of links against translations, N/m, and against rotations, N m/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkStiffness(pub [f64; 2]);

impl FromStr for LinkStiffness {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let read = |name: &str, number: Number| match number.bare(name)? {
            value if value > 0.0 => Ok(value),
            value => Err(Misread(format!("{name} is {value:?}, expected a number above 0"))),
        };
        numbers(text, ["KT", "KR"], read).map(Self)
    }
}

/// How a body falls, m/s², base directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityVector(pub Vector3<f64>);

impl FromStr for GravityVector {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let components = numbers(text, ["X", "Y", "Z"], |name, number| number.bare(name))?;
        Ok(Self(components.into()))
    }
}

/// The numbers of a list, each with its name.
pub fn numbers<const N: usize>(
    text: &str,
    names: [&str; N],
    read: impl Fn(&str, Number) -> Result<f64, Misread>,
) -> Result<[f64; N], Misread> {
    let parts: Vec<&str> = text.split(',').collect();
    if parts.len() != N {
        let count = if text.trim().is_empty() { 0 } else { parts.len() };
        let expected = names.join(",");
        let count = plural(count as u64, "number");
        return Err(Misread(format!("{count} in {text:?}, expected {N}: {expected}")));
    }
    let mut values = [0.0; N];
    for ((value, part), name) in values.iter_mut().zip(parts).zip(names) {
        *value = read(name, part.parse()?)?;
        if value.abs() > LARGEST {
            return Err(Misread(format!(
                "{name} is {value:?}, expected a number of at most {LARGEST:e}"
            )));
        }
    }
    Ok(values)
}

impl FromStr for WrenchComponents {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let components = numbers(text, NAMES, |name, number| number.bare(name))?;
        Ok(Self(Wrench::from_components(components)))
    }
}

impl FromStr for At {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        match text.trim() {
            "platform" => Ok(Self(LoadPoint::Platform)),
            "base" => Ok(Self(LoadPoint::Base)),
            point if point.contains(',') => {
                let of = |name: &str, number: Number| number.value_of(name, Quantity::Length);
                numbers(point, ["X", "Y", "Z"], of).map(|p| Self(LoadPoint::From(p.into())))
            }
            other => Err(Misread(format!(
                "{other:?}, expected platform, base, or a point X,Y,Z of the platform"
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_is_six_numbers_and_a_point() {
        for (text, expected) in [
            ("", "0 numbers in \"\", expected 6: FX,FY,FZ,MX,MY,MZ"),
            ("1,2,3", "3 numbers"),
            ("1,2,3,4,5,6mm", "MZ has a unit, expected a number alone"),
            ("1,2,3,4,5,x", "is not a number"),
            ("1e16,2,3,4,5,6", "FX is 1e16, expected a number of at most 1e15"),
        ] {
            let message = text.parse::<WrenchComponents>().expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
        let arm = LoadPoint::From(Vector3::new(0.01, 0.0, 1.0));
        assert_eq!("10mm,0,1".parse(), Ok(At(arm)));
        for (text, expected) in [("tool", "expected platform, base"), ("1,2deg,3", "Y is a length")]
        {
            let message = text.parse::<At>().expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
