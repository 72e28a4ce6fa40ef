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
    /// Whether a solution is within it, and within all joint limits.
    fn admits(
        &self,
        manipulator: &Manipulator,
        solution: &Solution,
        jacobians: &mut Jacobians,
    ) -> bool {
        solution.within_limits
            && manipulator.differentiate(solution, jacobians).is_ok()
            && manipulator.conditioning(jacobians, self.length).condition <= self.most
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
}

impl<'a> Conditioned<'a> {
    /// The limit for poses of a manipulator.
    pub fn new(manipulator: &'a Manipulator, limit: ConditionLimit) -> Self {
        let (all, solution) = (manipulator.all_modes(), manipulator.solution());
        Self { manipulator, limit, all, solution, jacobians: manipulator.jacobians() }
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
                let Self { solution, jacobians, limit, .. } = self;
                found = manipulator.inverse(pose, mode, solution) == Ok(true)
                    && limit.admits(manipulator, solution, jacobians);
                if found {
                    go_on(solution);
                }
            }
            Modes::Any => {
                if manipulator.inverse_all(pose, &mut self.all) != Ok(true) {
                    return false;
                }
                let Self { all, solution, jacobians, limit, .. } = self;
                for mode in all.modes(manipulator) {
                    manipulator.pick(all, mode, solution);
                    if limit.admits(manipulator, solution, jacobians) {
                        found = true;
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
