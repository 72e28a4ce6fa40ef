//! `opm ik --nearest`: the nearest pose found that is in reach, where one is not.

use super::Answer;
use crate::args::IkArgs;
use crate::batch::Modes;
use crate::failure::Failure;
use crate::output::named;
use crate::pose::Number;
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::reach::NearestPose;
use opm_study::characteristic_length;
use serde_json::{Value, json};
use std::fmt::Write;

/// What a search found near a pose that is out of reach, or beyond limits.
pub(super) enum Nearest<'a> {
    /// The pose is in reach itself.
    Itself,
    /// No pose in reach was found at all.
    Nothing,
    /// A pose, with its distance and the characteristic length, metres.
    Found { answer: Box<Answer<'a>>, distance: f64, length: f64 },
}

/// The characteristic length by which angles are multiplied, metres.
pub fn length(args: &IkArgs, manipulator: &Manipulator) -> Result<f64, Failure> {
    let given = args.length.map(Number::characteristic_length).transpose()?;
    Ok(characteristic_length(given, manipulator)?)
}

/// The nearest pose to one in these modes: itself, if it is in reach.
pub fn pose(
    manipulator: &Manipulator,
    modes: Modes,
    pose: &[f64],
    length: f64,
) -> Result<Option<NearestPose>, Failure> {
    let mode = match modes {
        Modes::All => None,
        Modes::One(mode) => Some(mode),
    };
    let found = manipulator.reach().nearest(pose, mode, length);
    found.map_err(|error| Failure::flag("--nearest", error))
}

impl<'a> Nearest<'a> {
    /// The nearest pose to the one of an answer.
    pub(super) fn of(asked: &Answer<'a>, modes: Modes, length: f64) -> Result<Self, Failure> {
        let within = asked.solutions.iter().any(|(_, solution)| Solution::within_limits(solution));
        if within && asked.outside.is_none() {
            return Ok(Self::Itself);
        }
        let Some(found) = pose(asked.manipulator, modes, &asked.pose, length)? else {
            return Ok(Self::Nothing);
        };
        let answer = Box::new(Answer::new(asked.loaded, asked.manipulator, modes, found.pose)?);
        Ok(Self::Found { answer, distance: found.distance, length })
    }

    pub fn json(&self) -> Value {
        match self {
            Self::Itself | Self::Nothing => Value::Null,
            Self::Found { answer, distance, length } => {
                let found = answer.json();
                json!({
                    "pose": named(answer.pose()),
                    "distance": distance,
                    "length": length,
                    "transform": found.transform,
                    "solutions": found.solutions,
                })
            }
        }
    }

    pub fn text(&self) -> String {
        let mut text = String::new();
        match self {
            Self::Itself => {}
            Self::Nothing => {
                let _ = writeln!(text, "\nno pose in reach was found near it");
            }
            Self::Found { answer, distance, length } => {
                let units = answer.loaded.file.units;
                let [distance, length] =
                    [distance, length].map(|&value| units.show(value, Quantity::Length));
                let angles = answer.manipulator.task_coordinates().iter();
                let angles = angles.filter(|c| c.quantity == Quantity::Angle).count();
                let mixed = match angles {
                    0 => String::new(),
                    _ => format!(" (angles in radians times {length})"),
                };
                let _ = writeln!(
                    text,
                    "\nnearest found in reach, {distance} away{mixed}; a nearer one may exist\n{}",
                    answer.text()
                );
            }
        }
        text
    }
}
