//! The closed-form kinematics of TITLE.
//!
//! Written by opm VERSION; write it anew rather than change it.
//!
//! Numbers are metres and radians. Bit i of a working mode, the lowest first, is set where sign i of opm's text is a minus.
//! MODE
//!
//! There is no allocation and no panic. `no_std` needs functions that `core` lacks: with the feature `libm` they are those of
//! the crate of that name, which is all that this one depends on; with the feature `std`, which is on by default, it depends
//! on nothing.
//!
//! ```
//! use CRATE::{DEFAULT, HOME, inverse};
//!
//! match inverse(&DEFAULT, &HOME, HOME_MODE) {
//!     Ok(solution) => println!("{:?}", solution.joints),
//!     Err(why) => println!("{why}"),
//! }
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![allow(clippy::unnecessary_cast)]

use core::fmt;

/// All numbers: change this line to `f32` for a controller that has no double.
pub type Real = f64;

mod kinematics;
mod math;

pub use kinematics::*;

/// Every joint at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// The joint coordinates, leg by leg: angles are within half a revolution of home, or within their limits where full
    /// revolutions bring them there. Limits are not tested.
    pub joints: [Real; JOINTS],
    /// The imaginary joints.
    pub imaginary: [Real; IMAGINARY],
}

/// Where the platform is, in base coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Platform {
    /// The position of the reference point.
    pub position: [Real; 3],
    /// A rotation matrix, row by row.
    pub rotation: [[Real; 3]; 3],
}

/// Why there is no answer. Legs, coordinates, rates and joints are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The pose is out of reach of a leg: the first of those, in their order. [`deficits`] says by how much.
    OutOfReach {
        /// The leg.
        leg: usize,
    },
    /// A coordinate of the pose is no number, or far too large.
    NoPose {
        /// The coordinate.
        coordinate: usize,
    },
    /// A rate, or the value of an actuated joint, is no number, or far too large.
    NoNumber {
        /// Its place.
        place: usize,
    },
    /// A leg is singular: its joints have no rates.
    Singular {
        /// The leg.
        leg: usize,
    },
    /// Coordinates that follow from those of the pose have no rates, or the actuated joints do not determine the pose.
    Undetermined,
    /// Newton's method does not converge.
    Diverged,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach { leg } => write!(f, "leg {leg} (from 0) does not reach the pose"),
            Self::NoPose { coordinate } => {
                write!(f, "coordinate {coordinate} (from 0) of the pose is no number or too large")
            }
            Self::NoNumber { place } => {
                write!(f, "value {place} (from 0) is no number or too large")
            }
            Self::Singular { leg } => write!(f, "leg {leg} (from 0) is singular"),
            Self::Undetermined => f.write_str("the pose is singular: not all is determined"),
            Self::Diverged => f.write_str("Newton's method does not converge"),
        }
    }
}

impl core::error::Error for Refusal {}

/// The meaning of a status.
fn checked(status: i32) -> Result<(), Refusal> {
    let (place, legs) = (status.unsigned_abs() as usize, LEGS);
    match status {
        0 => Ok(()),
        ..0 if place > COORDINATES => Err(Refusal::NoNumber { place: place - COORDINATES - 1 }),
        ..0 => Err(Refusal::NoPose { coordinate: place - 1 }),
        _ if place <= legs => Err(Refusal::OutOfReach { leg: place - 1 }),
        _ if place <= 2 * legs => Err(Refusal::Singular { leg: place - legs - 1 }),
        _ if place == 2 * legs + 1 => Err(Refusal::Undetermined),
        _ => Err(Refusal::Diverged),
    }
}

/// Every joint at a pose in a working mode.
pub fn inverse(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
) -> Result<Solution, Refusal> {
    let mut at = Solution { joints: [0.0; JOINTS], imaginary: [0.0; IMAGINARY] };
    checked(kinematics::inverse(geometry, pose, mode, &mut at.joints, &mut at.imaginary))?;
    Ok(at)
}

/// The actuated joints alone, in the same way.
pub fn actuated(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
) -> Result<[Real; ACTUATED], Refusal> {
    let mut actuated = [0.0; ACTUATED];
    checked(kinematics::actuated(geometry, pose, mode, &mut actuated))?;
    Ok(actuated)
}

/// Every joint at a pose in that mode in which the joints move least from previous ones (the sum of the squares, lengths over
/// the size of the mechanism), angles with the revolutions nearest to the previous ones; and the mode.
pub fn nearest(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    previous: &[Real; JOINTS],
) -> Result<(Solution, u32), Refusal> {
    let mut at = Solution { joints: [0.0; JOINTS], imaginary: [0.0; IMAGINARY] };
    let mut mode = 0;
    let (joints, imaginary) = (&mut at.joints, &mut at.imaginary);
    checked(kinematics::nearest(geometry, pose, previous, &mut mode, joints, imaginary))?;
    Ok((at, mode))
}

/// Every joint in every mode in which the pose is in reach.
pub fn all_modes<'a>(
    geometry: &'a Geometry,
    pose: &'a [Real; COORDINATES],
) -> impl Iterator<Item = (u32, Solution)> + 'a {
    let modes = 0..1u64 << CHOICES;
    modes.filter_map(|mode| Some((mode as u32, inverse(geometry, pose, mode as u32).ok()?)))
}

/// By how much the pose is out of reach of each leg: of its lower and of its upper section, in metres, or radians where the
/// section is spherical; zero where it closes, infinite where it is not known. A section that follows another one out of reach
/// counts as closed. And what [`inverse`] says.
pub fn deficits(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
) -> ([[Real; 2]; LEGS], Result<(), Refusal>) {
    let mut deficits = [[0.0; 2]; LEGS];
    let status = kinematics::deficits(geometry, pose, mode, deficits.as_flattened_mut());
    (deficits, checked(status))
}

/// The first joint that is past its limits, from 0.
pub fn past_limits(geometry: &Geometry, joints: &[Real; JOINTS]) -> Option<usize> {
    (kinematics::limits(geometry, joints) as usize).checked_sub(1)
}

/// Where the platform is. It depends on the mode only where coordinates follow from those of the pose; no leg is tested.
pub fn transform(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
) -> Result<Platform, Refusal> {
    let mut at = Platform { position: [0.0; 3], rotation: [[0.0; 3]; 3] };
    let rotation = at.rotation.as_flattened_mut();
    checked(kinematics::transform(geometry, pose, mode, &mut at.position, rotation))?;
    Ok(at)
}

/// The rates of all joints for unit rates of the coordinates of the pose: a row for each joint, rad/s and m/s.
pub fn jacobian(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
) -> Result<[[Real; COORDINATES]; JOINTS], Refusal> {
    let mut jacobian = [[0.0; COORDINATES]; JOINTS];
    checked(kinematics::jacobian(geometry, pose, mode, jacobian.as_flattened_mut()))?;
    Ok(jacobian)
}

/// The platform's twist for unit rates of the coordinates of the pose: three rows of the angular velocity, and three of the
/// velocity of the reference point, base coordinates.
pub fn twist(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
) -> Result<[[Real; COORDINATES]; 6], Refusal> {
    let mut twist = [[0.0; COORDINATES]; 6];
    checked(kinematics::twist(geometry, pose, mode, twist.as_flattened_mut()))?;
    Ok(twist)
}

/// The rates of all joints for given rates of the coordinates of the pose.
pub fn rates(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
    rates: &[Real; COORDINATES],
) -> Result<[Real; JOINTS], Refusal> {
    let mut joint_rates = [0.0; JOINTS];
    checked(kinematics::rates(geometry, pose, mode, rates, &mut joint_rates))?;
    Ok(joint_rates)
}
