//! Forward kinematics of a series: every pose is near the one before it.

use opm_core::forward::{Assembly, NearBuffer, NearError};
use opm_core::manipulator::{Manipulator, Mode};

/// Follows the platform through a series of values of the actuated joints, in one working mode.
///
/// Each step starts Newton's method at the last pose that was found. If it ends without an assembly, because the
/// joints have moved too far, all assemblies are found, where that is possible, and the nearest in this mode is taken.
pub struct Tracker<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    last: Vec<f64>,
    buffer: NearBuffer,
    leap: Option<Assembly>,
}

impl<'a> Tracker<'a> {
    /// A tracker that starts at a pose.
    pub fn new(manipulator: &'a Manipulator, start: &[f64], mode: Mode) -> Self {
        let (last, buffer) = (start.to_vec(), manipulator.near_buffer());
        Self { manipulator, mode, last, buffer, leap: None }
    }

    /// The assembly at these actuated joints, in the order of [`Manipulator::actuated`], radians and metres; `None` if
    /// there is none, or none that can be found. The next step then starts from the same pose as this one.
    ///
    /// # Errors
    /// The joint values or the start cannot be computed with.
    pub fn step(&mut self, actuated: &[f64]) -> Result<Option<&Assembly>, NearError> {
        let Self { manipulator, mode, last, buffer, leap } = self;
        *leap = None;
        // The borrow of an assembly that is returned would outlast the other branch.
        let near = manipulator.forward_near_into(actuated, last, *mode, buffer).map(|_| ());
        let found = match near {
            Ok(()) => buffer.assembly(),
            Err(NearError::NotFound(_)) => {
                let Ok(found) = manipulator.forward(actuated) else { return Ok(None) };
                let mut list = found.list;
                manipulator.keep_assemblies_in(&mut list, *mode);
                let Ok(seed) = manipulator.displacement_in(last, *mode) else { return Ok(None) };
                manipulator.sort_assemblies(&mut list, &manipulator.platform_at(&seed));
                let Some(nearest) = list.into_iter().next() else { return Ok(None) };
                leap.insert(nearest)
            }
            Err(error) => return Err(error),
        };
        last.clone_from(&found.pose);
        Ok(Some(found))
    }
}
