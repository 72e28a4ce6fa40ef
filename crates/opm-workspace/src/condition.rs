//! A limit on the condition number: poses too near to a singularity do not count.

use crate::grid::{Grid, Sections};
use crate::progress::Cancelled;
use crate::sweep::Modes;
use opm_core::manipulator::{AllModes, Manipulator, Solution};
use opm_core::velocity::Jacobians;

/// The largest condition number at which a pose counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditionLimit {
    /// The largest condition number, at least one.
    pub most: f64,
    /// The characteristic length that condition numbers are computed with, metres; usually
    /// [`Manipulator::characteristic_length`].
    pub length: f64,
}

/// Why a sweep has no condition numbers.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConditionError {
    /// The grid is of one section alone: only the whole mechanism has a condition number.
    #[error("a section alone has no condition number")]
    Section,
    /// The characteristic length is not a positive number.
    #[error("characteristic length {0} m, expected a positive number")]
    Length(f64),
    /// The limit of the sweep was given with another characteristic length.
    #[error("characteristic lengths {index} m and, of the limit, {limit} m; expected the same")]
    Lengths {
        /// The length for the index, metres.
        index: f64,
        /// The length of the limit, metres.
        limit: f64,
    },
    /// The sweep was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ConditionLimit {
    /// A limit that admits every pose, for condition numbers with this characteristic length, metres.
    pub fn none(length: f64) -> Self {
        Self { most: f64::INFINITY, length }
    }

    /// Whether the poses of a grid have condition numbers.
    pub(crate) fn check(&self, grid: &Grid) -> Result<(), ConditionError> {
        if grid.sections() != Sections::Whole {
            return Err(ConditionError::Section);
        }
        if self.length > 0.0 && self.length.is_finite() {
            Ok(())
        } else {
            Err(ConditionError::Length(self.length))
        }
    }

    /// The condition number of a solution; `None` if it is beyond this limit or any joint limit.
    fn admits(
        &self,
        manipulator: &Manipulator,
        solution: &Solution,
        jacobians: &mut Jacobians,
    ) -> Option<f64> {
        if !solution.within_limits() || manipulator.differentiate(solution, jacobians).is_err() {
            return None;
        }
        let condition = manipulator.conditioning(jacobians, self.length).condition;
        (condition <= self.most).then_some(condition)
    }
}

/// Decides poses one by one by a limit on the condition number. It holds the working memory for that, so
/// that nothing is allocated for a pose.
///
/// A pose has a value for each of [`Manipulator::task_coordinates`], radians or metres. One with another
/// number of values, or with a value that is not a number, is out of reach.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{ConditionLimit, Conditioned, Modes};
///
/// let home: Vec<f64> = manipulator.task_coordinates().iter().map(|c| c.home).collect();
/// let limit = ConditionLimit { most: 100.0, length: manipulator.characteristic_length() };
/// let mut conditioned = Conditioned::new(&manipulator, limit);
/// let index = conditioned.local_index(&home, Modes::Any).ok_or("home is singular")?;
/// assert!(index >= 0.01 && index <= 1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Conditioned<'a> {
    manipulator: &'a Manipulator,
    limit: ConditionLimit,
    all: AllModes,
    solution: Solution,
    jacobians: Jacobians,
    /// The condition number of the last solution that was admitted.
    condition: f64,
}

impl<'a> Conditioned<'a> {
    /// Decides poses of a manipulator by a limit.
    pub fn new(manipulator: &'a Manipulator, limit: ConditionLimit) -> Self {
        let (all, solution) = (manipulator.all_modes(), manipulator.solution());
        let jacobians = manipulator.jacobians();
        Self { manipulator, limit, all, solution, jacobians, condition: f64::INFINITY }
    }

    /// The local conditioning index of a pose: one over its condition number, in the first working mode,
    /// all-plus first, that the limit admits. It is one at best and zero at a singularity; `None` if there
    /// is no such mode.
    pub fn local_index(&mut self, pose: &[f64], modes: Modes) -> Option<f64> {
        self.first(pose, modes)?;
        Some(self.index())
    }

    /// The local conditioning index of the solution that was admitted last.
    pub fn index(&self) -> f64 {
        self.condition.recip()
    }

    /// The joint values in the first working mode, all-plus first, in which a pose is in reach, within all
    /// joint limits and no worse conditioned than the limit; `None` if there is no such mode.
    pub fn first(&mut self, pose: &[f64], modes: Modes) -> Option<&Solution> {
        self.any(pose, modes, |_| false).then_some(&self.solution)
    }

    /// Gives the joint values in every such mode, until `go_on` returns false. Returns whether there was
    /// any such mode.
    pub fn any(
        &mut self,
        pose: &[f64],
        modes: Modes,
        mut go_on: impl FnMut(&Solution) -> bool,
    ) -> bool {
        let manipulator = self.manipulator;
        let mut found = false;
        match modes {
            Modes::One(mode) => {
                let Self { solution, jacobians, limit, condition, .. } = self;
                if let Ok(Some(solution)) = manipulator.inverse(pose, mode, solution)
                    && let Some(admitted) = limit.admits(manipulator, solution, jacobians)
                {
                    (found, *condition) = (true, admitted);
                    go_on(solution);
                }
            }
            Modes::Any => {
                let Self { all, solution, jacobians, limit, condition, .. } = self;
                let Ok(Some(all)) = manipulator.inverse_all(pose, all) else {
                    return false;
                };
                for mode in all.modes(manipulator) {
                    if let Some(solution) = manipulator.solution_in_mode(all, mode, solution)
                        && let Some(admitted) = limit.admits(manipulator, solution, jacobians)
                    {
                        (found, *condition) = (true, admitted);
                        if !go_on(solution) {
                            break;
                        }
                    }
                }
            }
        }
        found
    }
}
