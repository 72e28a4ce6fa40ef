//! A limit on the condition number: poses too near to a singularity do not count.

use crate::sweep::Modes;
use opm_core::manipulator::{AllModes, Manipulator, Solution};
use opm_core::velocity::Jacobians;

/// The largest condition number at which a pose counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditionLimit {
    /// That number, at least one.
    pub most: f64,
    /// The characteristic length that it is meant with, metres.
    pub length: f64,
}

impl ConditionLimit {
    /// No limit, for condition numbers with this characteristic length.
    pub fn none(length: f64) -> Self {
        Self { most: f64::INFINITY, length }
    }

    /// The condition number of a solution that is within it, and within all joint limits.
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

/// A limit with the working memory to decide poses by it.
#[derive(Clone, Debug)]
pub struct Conditioned<'a> {
    manipulator: &'a Manipulator,
    limit: ConditionLimit,
    all: AllModes,
    solution: Solution,
    jacobians: Jacobians,
    /// Of the last solution that was admitted.
    condition: f64,
}

impl<'a> Conditioned<'a> {
    /// The limit for poses of a manipulator.
    pub fn new(manipulator: &'a Manipulator, limit: ConditionLimit) -> Self {
        let (all, solution) = (manipulator.all_modes(), manipulator.solution());
        let jacobians = manipulator.jacobians();
        Self { manipulator, limit, all, solution, jacobians, condition: f64::INFINITY }
    }

    /// The local conditioning index of a pose: the inverse of its condition number, in the first working
    /// mode, all-plus first, that the limit admits. One at best, zero at a singularity; `None` where
    /// there is no such mode.
    pub fn local_index(&mut self, pose: &[f64], modes: Modes) -> Option<f64> {
        self.first(pose, modes)?;
        Some(self.index())
    }

    /// The local conditioning index of the solution that was admitted last.
    pub fn index(&self) -> f64 {
        self.condition.recip()
    }

    /// The joints in the first working mode, all-plus first, in which a pose is in reach, within all
    /// joint limits and no worse conditioned than the limit; `None` where there is none.
    pub fn first(&mut self, pose: &[f64], modes: Modes) -> Option<&Solution> {
        self.any(pose, modes, |_| false).then_some(&self.solution)
    }

    /// Gives the joints of every such mode, until `go_on` is false; whether there was any.
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
