//! What limits the timing of a motion.

use super::{PathEfforts, TimingError, ToolLimits};
use crate::manipulator::Manipulator;

/// What limits a timing besides the `max_rate` and the `max_acceleration` of joints.
#[derive(Default)]
pub struct PathLimits<'e> {
    /// Caps of the tool's motion.
    pub tool: ToolLimits,
    /// The largest efforts of actuators.
    pub efforts: Option<&'e mut (dyn PathEfforts + 'e)>,
}

/// The limits of one joint coordinate, or of what else moves, infinite where there is none.
#[derive(Clone, Copy)]
pub(super) struct Limit {
    pub rate: f64,
    pub acceleration: f64,
}

/// Refuses actuated joints whose accelerations and efforts have no limit.
pub(super) fn all_limited(
    manipulator: &Manipulator,
    efforts: Option<&dyn PathEfforts>,
) -> Result<(), TimingError> {
    let mut joints = Vec::new();
    for &number in manipulator.actuated() {
        let coordinate = &manipulator.coordinates()[number];
        let mut limited = efforts.iter().flat_map(|efforts| efforts.limits());
        if coordinate.motion_limits.max_acceleration.is_none()
            && !limited.any(|(of, _)| *of == number)
        {
            joints.push(coordinate.name.clone());
        }
    }
    if joints.is_empty() { Ok(()) } else { Err(TimingError::NoLimits { joints }) }
}

/// The numbers and the limits of all joint coordinates that have any.
pub(super) fn limits(manipulator: &Manipulator) -> (Vec<usize>, Vec<Limit>) {
    let each = manipulator.coordinates().iter().map(|c| Limit {
        rate: c.motion_limits.max_rate.unwrap_or(f64::INFINITY),
        acceleration: c.motion_limits.max_acceleration.unwrap_or(f64::INFINITY),
    });
    let limited = |(_, limit): &(usize, Limit)| limit.rate.min(limit.acceleration).is_finite();
    each.enumerate().filter(limited).unzip()
}
