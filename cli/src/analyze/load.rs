//! Loads in the syntax of the command line.

use crate::pose::{Misread, Number};
use clap::ValueEnum;
use nalgebra::{Isometry3, Point3, Vector3};
use opm_analysis::Wrench;
use opm_core::Quantity;
use std::str::FromStr;

/// Largest component, newtons and newton metres.
const LARGEST: f64 = 1e15;

const NAMES: [&str; 6] = ["FX", "FY", "FZ", "MX", "MY", "MZ"];

/// The six components of a wrench, newtons and newton metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchComponents([f64; 6]);

/// Where a force acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadPoint {
    /// At the platform's reference point.
    Platform,
    /// At the base's origin.
    Base,
    /// At a point of the platform, from the reference point, metres.
    From(Vector3<f64>),
}

/// The axes of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Directions {
    /// Those of the base
    Base,
    /// Those that the platform carries, which are the base's where its orientation is the identity
    Platform,
}

/// The numbers of a list, each with its name.
fn numbers<const N: usize>(
    text: &str,
    names: [&str; N],
    read: impl Fn(&str, Number) -> Result<f64, Misread>,
) -> Result<[f64; N], Misread> {
    let parts: Vec<&str> = text.split(',').collect();
    if parts.len() != N {
        let count = if text.trim().is_empty() { 0 } else { parts.len() };
        let expected = names.join(",");
        return Err(Misread(format!("{count} numbers in {text:?}, expected {N}: {expected}")));
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
        numbers(text, NAMES, |name, number| number.bare(name)).map(Self)
    }
}

impl FromStr for LoadPoint {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        match text.trim() {
            "platform" => Ok(Self::Platform),
            "base" => Ok(Self::Base),
            point if point.contains(',') => {
                let of = |name: &str, number: Number| number.value_of(name, Quantity::Length);
                numbers(point, ["X", "Y", "Z"], of).map(|p| Self::From(p.into()))
            }
            other => Err(Misread(format!(
                "{other:?}, expected platform, base, or a point X,Y,Z of the platform"
            ))),
        }
    }
}

/// A load as it is given.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    pub components: WrenchComponents,
    pub at: LoadPoint,
    pub directions: Directions,
}

impl Load {
    /// The wrench at the reference point of a platform, in base directions.
    pub fn on(&self, platform: &Isometry3<f64>) -> Wrench {
        let turned = |v: Vector3<f64>| match self.directions {
            Directions::Base => v,
            Directions::Platform => platform.rotation * v,
        };
        let Wrench { force, moment } = Wrench::from_components(self.components.0);
        let wrench = Wrench { force: turned(force), moment: turned(moment) };
        let reference = Point3::from(platform.translation.vector);
        let from = match self.at {
            LoadPoint::Platform => reference,
            LoadPoint::Base => Point3::origin(),
            LoadPoint::From(arm) => reference + turned(arm),
        };
        wrench.moved(&from, &reference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use std::f64::consts::FRAC_PI_2;

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
        assert_eq!("10mm,0,1".parse(), Ok(LoadPoint::From(Vector3::new(0.01, 0.0, 1.0))));
        for (text, expected) in [("tool", "expected platform, base"), ("1,2deg,3", "Y is a length")]
        {
            let message = text.parse::<LoadPoint>().expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    /// A force along the platform's x, at a point on its y, on a platform that is turned by a right angle about z.
    #[test]
    fn a_load_acts_where_it_is_said_to() {
        let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * FRAC_PI_2);
        let platform = Isometry3::from_parts([3.0, 0.0, 0.0].into(), turned);
        let load = |at, directions| Load {
            components: WrenchComponents([2.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            at,
            directions,
        };
        let close = |wrench: Wrench, expected: [f64; 6]| {
            let found = wrench.components();
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        let arm = LoadPoint::From(Vector3::new(0.0, 0.5, 0.0));
        let found = load(arm, Directions::Platform).on(&platform);
        assert!(close(found, [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]), "{found:?}");
        let found = load(LoadPoint::Platform, Directions::Base).on(&platform);
        assert!(close(found, [2.0, 0.0, 0.0, 0.0, 0.0, 1.0]), "{found:?}");
        // At the base's origin, 3 m from the reference point: a force along the platform's x, the base's y.
        let found = load(LoadPoint::Base, Directions::Platform).on(&platform);
        assert!(close(found, [0.0, 2.0, 0.0, 0.0, 0.0, -5.0]), "{found:?}");
    }
}
