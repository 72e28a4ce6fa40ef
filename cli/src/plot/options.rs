//! The panels and the size of a picture, in the syntax of the command line.

use crate::pose::Misread;
use clap::ValueEnum;
use opm_plot::Size;
use std::str::FromStr;

/// A name that `--panels` takes: values to draw, or for a motion also their derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PanelName {
    /// Task coordinates over time
    Pose,
    /// Imaginary joints: over time, or the values that they take in a workspace
    Imaginary,
    /// Actuated joints over time
    Actuated,
    /// Passive joints over time
    Passive,
    /// Condition number and singularity measures over time
    Condition,
    /// Indices over time (`opm trajectory --indices`)
    Indices,
    /// Efforts of the actuators over time (`opm trajectory --efforts`), with their limits dashed
    Efforts,
    /// For a motion: positions
    Positions,
    /// For a motion: velocities, in a second column
    Velocities,
    /// For a motion: accelerations, in a further column
    Accelerations,
    /// Slices of a workspace
    Slices,
    /// Slices of what is not in a workspace, coloured by what rejects it (`opm workspace --explain`)
    Rejected,
}

impl PanelName {
    /// The name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// The value of `--size`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureSize(pub Size);

impl FromStr for PictureSize {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        const MOST: u32 = opm_plot::MOST as u32;
        let sides = text.split_once(['x', 'X', '×']);
        let side = |side: &str| side.trim().parse().ok().filter(|side| (1..=MOST).contains(side));
        match sides.map(|(width, height)| (side(width), side(height))) {
            Some((Some(width), Some(height))) => {
                Ok(Self(Size { width: width.into(), height: height.into() }))
            }
            _ => Err(Misread::new(format!(
                "{text:?}, expected width and height up to {MOST} pixels, for example 900x600"
            ))),
        }
    }
}
