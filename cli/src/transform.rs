//! The platform's pose in SE(3), in the syntax of the command line:
//! `0,0,300mm,0.966,0.259,0,0`.

use crate::failure::Failure;
use crate::pose::{Misread, Number};
use nalgebra::{Isometry3, Vector3};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Mode, OutsideMotion, PLACE, Solution, place};
use serde_json::{Value, json};
use std::str::FromStr;

/// Position of the platform's reference point, and the platform's orientation; base coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(Isometry3<f64>);

impl FromStr for Transform {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let parts: Vec<&str> = text.split(',').collect();
        if parts.len() != PLACE.len() {
            return Err(Misread(format!(
                "{} numbers in {text:?}, expected seven: {}",
                if text.trim().is_empty() { 0 } else { parts.len() },
                PLACE.join(",")
            )));
        }
        let mut values = [0.0; 7];
        for ((value, part), (number, name)) in
            values.iter_mut().zip(parts).zip(PLACE.into_iter().enumerate())
        {
            let given: Number = part.parse()?;
            *value = match number {
                0..3 => given.value_of(name, Quantity::Length)?,
                _ => given.bare(name)?,
            };
        }
        Self::new(values)
    }
}

impl Transform {
    /// From the numbers in the order of the flag: X,Y,Z,QW,QX,QY,QZ; metres.
    pub fn new(values: [f64; 7]) -> Result<Self, Misread> {
        place(values).map(Self).map_err(Misread::new)
    }
}

/// The relation of a transform to a manipulator's poses.
pub enum Located {
    /// It is in the motion, to within the rounding of the given numbers.
    Pose(Vec<f64>),
    /// It is outside the motion.
    Outside(OutsideMotion),
}

impl Transform {
    /// The pose at which the platform is there, in a working mode if that is possible.
    pub fn locate(&self, manipulator: &Manipulator, mode: Mode) -> Located {
        match manipulator.locate_written(&self.0, mode) {
            Ok(pose) => Located::Pose(pose),
            Err(outside) => Located::Outside(outside),
        }
    }

    /// The same for a command that needs a pose.
    ///
    /// # Errors
    /// It is outside the motion.
    pub fn pose(&self, manipulator: &Manipulator, mode: Mode) -> Result<Vec<f64>, Failure> {
        match self.locate(manipulator, mode) {
            Located::Pose(pose) => Ok(pose),
            Located::Outside(outside) => Err(Failure::flag(
                "--transform",
                format_args!("{outside}; `opm ik --transform` tells the nearest pose"),
            )),
        }
    }
}

/// The position of the platform at a pose, in metres, and its quaternion, whose scalar comes first and is not
/// negative; null if there is no pose.
pub fn json(manipulator: &Manipulator, pose: &[f64]) -> Value {
    manipulator.platform_pose(pose).map_or(Value::Null, |platform| placement(&platform))
}

/// The same for a solution.
pub fn at(manipulator: &Manipulator, solution: &Solution) -> Value {
    placement(&manipulator.platform_at(&solution.displacement(manipulator)))
}

fn placement(platform: &Isometry3<f64>) -> Value {
    let q = platform.rotation;
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let quaternion = [q.w, q.i, q.j, q.k].map(|part| sign * part + 0.0);
    json!({ "position": triple(&platform.translation.vector), "quaternion": quaternion })
}

/// The distance of a transform from the motion, SI.
pub fn outside_json(outside: &OutsideMotion) -> Value {
    json!({
        "rotation": triple(&outside.rotation),
        "translation": triple(&outside.translation),
    })
}

fn triple(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(|c| c + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_seven_numbers() {
        let read = |text: &str| text.parse::<Transform>();
        let Transform(found) = read("10mm, -0.2,1in, 0.8,0,-0.6,0").unwrap();
        assert_eq!(found.translation.vector, Vector3::new(0.01, -0.2, 0.0254));
        assert!((found * Vector3::x() - Vector3::new(0.28, 0.0, 0.96)).norm() < 1e-12);
        for (text, expected) in [
            ("", "0 numbers in \"\", expected seven: X,Y,Z,QW"),
            ("0,0,0,1,0,0", "6 numbers"),
            ("0,0,0,1,0,0,0,0", "8 numbers"),
            ("0,0,30deg,1,0,0,0", "Z is a length"),
            ("0,0,0,1mm,0,0,0", "QW has a unit, expected a number alone"),
            ("-1e10,0,0,1,0,0,0", "X is -10000000000.0, expected a number of at most 1e9"),
            ("0,0,1e300,1,0,0,0", "Z is 1e300, expected a number of at most 1e9"),
            ("0,0,0,1e300,0,0,0", "QW is 1e300, expected a number of at most 1e9"),
            ("0,0,0,1,0,0,x", "not a number"),
            ("0,0,0,1,0,0,nan", "not a number"),
            ("0,0,0,0,0,0,0", "has length 0.0000, expected 1"),
            ("0,0,0,1,0.1,0,0", "has length 1.0050, expected 1"),
        ] {
            let message = read(text).expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
