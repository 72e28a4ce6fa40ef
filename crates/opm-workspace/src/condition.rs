//! A limit on what a pose is like: its condition number, and indices such as the local transmission index. Poses beyond
//! it do not count.

use crate::grid::{Grid, Sections};
use crate::progress::Cancelled;
use crate::sweep::Modes;
use opm_analysis::{Index, IndexBounds, IndexError, Indices, Setup};
use opm_core::manipulator::{AllModes, Manipulator, Solution};
use opm_core::reach::AT_ONCE;
use opm_core::velocity::{ConditionBatch, ConditionQuery, Jacobians};
use std::sync::Arc;

/// Fewer poses than this are decided one by one: it takes longer to begin a block of them.
const FEW: usize = 8;

/// What a pose has to be like to count.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseLimit {
    /// The largest condition number, at least one; infinite if it is not limited.
    pub most: f64,
    /// What condition numbers and indices are computed with; the characteristic length is usually
    /// [`Manipulator::characteristic_length`].
    pub setup: Arc<Setup>,
    /// The worst values of indices. A manipulator that lacks one of these indices has no pose that counts.
    pub indices: IndexBounds,
}

/// Why a sweep has no condition numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// The manipulator does not have a limited index.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The sweep was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl PoseLimit {
    /// A limit that admits every pose, for condition numbers with this characteristic length, metres.
    pub fn none(length: f64) -> Self {
        Self::of(Arc::new(Setup::new(length)))
    }

    /// A limit that admits every pose, for indices in a setup.
    pub fn of(setup: Arc<Setup>) -> Self {
        Self { most: f64::INFINITY, setup, indices: IndexBounds::default() }
    }

    /// The characteristic length, metres.
    pub fn length(&self) -> f64 {
        self.setup.length
    }

    /// Whether it admits every pose.
    pub fn is_none(&self) -> bool {
        self.most == f64::INFINITY && self.indices.is_empty()
    }

    /// The same with a largest condition number.
    #[must_use]
    pub fn with_condition(self, most: f64) -> Self {
        Self { most, ..self }
    }

    /// The same with a worst value of an index.
    #[must_use]
    pub fn with_index(self, index: Index, bound: f64) -> Self {
        Self { indices: self.indices.with(index, bound), ..self }
    }

    /// The largest condition number, if it is limited.
    pub fn max_condition(&self) -> Option<f64> {
        self.most.is_finite().then_some(self.most)
    }

    /// Whether the poses of a grid have condition numbers, and the indices.
    pub(crate) fn check(
        &self,
        manipulator: &Manipulator,
        grid: &Grid,
    ) -> Result<(), ConditionError> {
        if grid.sections() != Sections::Whole {
            return Err(ConditionError::Section);
        }
        let length = self.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(ConditionError::Length(length));
        }
        let mut indices = self.indices.iter();
        Ok(indices.try_for_each(|(index, _)| index.check(manipulator, &self.setup))?)
    }

    /// The condition number of a solution; `None` if it is beyond this limit or any joint limit.
    fn admits(
        &self,
        manipulator: &Manipulator,
        solution: &Solution,
        jacobians: &mut Jacobians,
        indices: &mut Option<Indices<'_>>,
    ) -> Option<f64> {
        if !solution.within_limits() || manipulator.differentiate(solution, jacobians).is_err() {
            return None;
        }
        let condition = manipulator.conditioning(jacobians, self.length()).condition;
        let mut good = || {
            if self.indices.is_empty() {
                return true;
            }
            let Some(indices) = indices else { return false };
            let values = indices.evaluate(solution);
            self.indices.iter().zip(values).all(|((index, bound), &v)| index.admits(v, bound))
        };
        (condition <= self.most && good()).then_some(condition)
    }
}

/// Decides poses by a limit. It holds the working memory for that, so that nothing is allocated
/// for a pose.
///
/// A pose has a value for each of [`Manipulator::task_coordinates`], radians or metres. One with another
/// number of values, or with a value that is not a number, is out of reach.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{PoseLimit, Conditioned, Modes};
///
/// let home: Vec<f64> = manipulator.task_coordinates().iter().map(|c| c.home).collect();
/// let limit = PoseLimit::none(manipulator.characteristic_length()).with_condition(100.0);
/// let mut conditioned = Conditioned::new(&manipulator, limit);
/// let index = conditioned.local_index(&home, Modes::Any).ok_or("home is singular")?;
/// assert!(index >= 0.01 && index <= 1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Conditioned<'a> {
    manipulator: &'a Manipulator,
    limit: PoseLimit,
    all: AllModes,
    solution: Solution,
    jacobians: Jacobians,
    /// The condition number of the last solution that was admitted.
    condition: f64,
    batch: ConditionBatch,
    /// What is held against bounds.
    indices: Option<Indices<'a>>,
}

impl<'a> Conditioned<'a> {
    /// Decides poses of a manipulator by a limit.
    pub fn new(manipulator: &'a Manipulator, limit: PoseLimit) -> Self {
        let (all, solution) = (manipulator.all_modes(), manipulator.solution());
        let jacobians = manipulator.jacobians();
        let batch = manipulator.condition_batch();
        let bounded = limit.indices.iter().map(|(index, _)| index);
        let indices = Indices::new(manipulator, &limit.setup, bounded).ok();
        let condition = f64::INFINITY;
        Self { manipulator, limit, all, solution, jacobians, condition, batch, indices }
    }

    /// The local conditioning index of a pose: one over its condition number, in the first working mode,
    /// all-plus first, that the limit admits. It is one at best and zero at a singularity; `None` if there
    /// is no such mode.
    pub fn local_index(&mut self, pose: &[f64], modes: Modes) -> Option<f64> {
        self.first(pose, modes)?;
        Some(self.index())
    }

    /// The local conditioning indices of many poses, row after row: what [`Conditioned::local_index`] gives for each, to the
    /// bit, several times as fast. NaN stands for `None`.
    ///
    /// # Panics
    /// If there are fewer poses than indices.
    pub fn local_indices(&mut self, poses: &[f64], modes: Modes, indices: &mut [f64]) {
        self.decide(poses, modes, indices, None);
        for index in indices {
            *index = index.recip();
        }
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

    /// The condition numbers of many poses, row after row, each in the first such mode; NaN where there is none. If `used` is
    /// given, it is called with the number of an imaginary joint and the least and the largest of its values in all such
    /// modes, for some poses at a time.
    pub(crate) fn decide(
        &mut self,
        poses: &[f64],
        modes: Modes,
        conditions: &mut [f64],
        mut used: Option<&mut dyn FnMut(usize, [f64; 2])>,
    ) {
        let (manipulator, every) = (self.manipulator, used.is_some());
        let width = manipulator.task_coordinates().len();
        let PoseLimit { most, ref setup, indices: bounds } = self.limit;
        let length = setup.length;
        let query = ConditionQuery { mode: modes.one(), length, most, every };
        let blocks = poses.chunks(AT_ONCE * width);
        for (poses, conditions) in blocks.zip(conditions.chunks_mut(AT_ONCE)) {
            let mut each = |number: usize, range: [f64; 2]| {
                if let Some(used) = &mut used {
                    used(number, range);
                }
            };
            let open = match conditions.len() {
                ..FEW => u64::MAX,
                // What is decided together has condition numbers alone.
                _ if !bounds.is_empty() => u64::MAX,
                _ => manipulator.condition_many(
                    poses,
                    &query,
                    &mut self.batch,
                    conditions,
                    &mut each,
                ),
            };
            for (i, condition) in conditions.iter_mut().enumerate() {
                if open >> i & 1 == 0 {
                    continue;
                }
                let admitted = self.any(&poses[i * width..][..width], modes, |solution| {
                    let values = solution.imaginary().iter().enumerate();
                    values.for_each(|(number, &value)| each(number, [value; 2]));
                    every
                });
                *condition = if admitted { self.condition } else { f64::NAN };
            }
        }
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
                let Self { solution, jacobians, limit, condition, indices, .. } = self;
                if let Ok(Some(solution)) = manipulator.inverse(pose, mode, solution)
                    && let Some(admitted) = limit.admits(manipulator, solution, jacobians, indices)
                {
                    (found, *condition) = (true, admitted);
                    go_on(solution);
                }
            }
            Modes::Any => {
                let Self { all, solution, jacobians, limit, condition, indices, .. } = self;
                let Ok(Some(all)) = manipulator.inverse_all(pose, all) else {
                    return false;
                };
                for mode in all.modes(manipulator) {
                    if let Some(solution) = manipulator.solution_in_mode(all, mode, solution)
                        && let Some(admitted) =
                            limit.admits(manipulator, solution, jacobians, indices)
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
