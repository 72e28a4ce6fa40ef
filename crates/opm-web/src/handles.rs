//! What the task coordinates do to the platform at a pose: the handles by which it is dragged.

use crate::explorer::Explorer;
use opm_core::Mode;
use opm_core::nalgebra::Isometry3;
use serde::Serialize;

/// Half the difference between two poses, metres or radians.
const STEP: f64 = 1e-5;

/// The platform at a pose, metres.
#[derive(Serialize)]
pub struct Handles {
    /// Its reference point.
    at: [f64; 3],
    /// How it moves with each task coordinate, by unit of the coordinate in SI; none where there is no pose beside this
    /// one.
    moves: Vec<Option<Move>>,
}

/// The motion with one coordinate.
#[derive(Serialize)]
struct Move {
    /// The velocity of the reference point.
    shift: [f64; 3],
    /// The angular velocity.
    turn: [f64; 3],
}

/// The handles at a pose, if it has a platform.
pub fn handles(explorer: &Explorer, pose: &[f64], mode: Mode) -> Option<Handles> {
    let manipulator = explorer.manipulator();
    let platform = |pose: &[f64]| -> Option<Isometry3<f64>> {
        manipulator.displacement_in(pose, mode).ok().map(|g| manipulator.platform_at(&g))
    };
    let step = |number: usize| {
        let beside = |step: f64| {
            let mut pose = pose.to_vec();
            pose[number] += step;
            platform(&pose)
        };
        let (before, after) = (beside(-STEP)?, beside(STEP)?);
        let shift = (after.translation.vector - before.translation.vector) / (2.0 * STEP);
        let turn = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * STEP);
        Some(Move { shift: shift.into(), turn: turn.into() })
    };
    let at = platform(pose)?.translation.vector.into();
    Some(Handles { at, moves: (0..pose.len()).map(step).collect() })
}
