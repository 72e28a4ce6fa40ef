//! Inverse kinematics of many poses at once.
//!
//! Poses are solved in blocks, and every step is done for the whole block: displacements, each leg's two
//! chains, angles, limits. Every step is a loop over the block of what [`Manipulator::inverse`] does for one
//! pose, compiled for the processor at hand, and the results are equal to the bit. Poses that need more than
//! straight-line arithmetic (a pose on a sphere's boundary of reach, an angle of a million radians) are
//! rare: they are marked and left to [`Manipulator::inverse`].

mod block;
pub(crate) mod decide;
pub(crate) mod lanes;
mod rows_and_columns;
pub(crate) mod section;
mod whole;

use super::all_modes::AllModes;
use super::dependent::Complete;
use super::pose::PoseError;
use super::solution::Solution;
use super::{Manipulator, Mode};
pub(crate) use block::Block;
use block::Give;
pub(in crate::manipulator) use block::SolveSection;
pub(crate) use block::{Status, columns_of};
use lanes::{BranchesOfLeg, LANES};
use pulp::{Arch, Simd, WithSimd};

/// The slices to which [`Manipulator::inverse_many`] writes its results: one row for every pose. See the
/// example there.
#[derive(Debug)]
pub struct BatchOutput<'a> {
    /// Every joint coordinate, in the order of [`Manipulator::coordinates`], row after row; radians and
    /// metres, NaN in the rows of poses that are out of reach.
    pub joints: &'a mut [f64],
    /// Every imaginary joint, in the order of [`Manipulator::imaginary`], row after row; radians
    /// and metres, NaN in the rows of poses that are out of reach.
    pub imaginary: &'a mut [f64],
    /// Whether each pose is in reach.
    pub reachable: &'a mut [bool],
    /// Whether each pose is in reach with all joint coordinates within their limits.
    pub within_limits: &'a mut [bool],
}

/// Why a batch of poses cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// One of the poses is not valid.
    #[error("pose {row}: {error}")]
    Pose {
        /// The number of its row, counted from zero.
        row: usize,
        /// The reason why the pose is not valid.
        error: PoseError,
    },
    /// The length of the input is not a multiple of the number of task coordinates.
    #[error("{given} number{}, expected a multiple of {width}, the number of task coordinates", if *given == 1 { "" } else { "s" })]
    Poses {
        /// The length of the input.
        given: usize,
        /// The number of task coordinates.
        width: usize,
    },
    /// The number of working modes is not that of the poses.
    #[error("{given} working mode{}, expected {expected}, one for every pose", if *given == 1 { "" } else { "s" })]
    Modes {
        /// The number of modes.
        given: usize,
        /// The number of poses.
        expected: usize,
    },
    /// A slice of the output does not have one row for every pose.
    #[error("`{slice}` of the output has {given} element{}, expected {expected}", if *given == 1 { "" } else { "s" })]
    Output {
        /// The name of the field of [`BatchOutput`].
        slice: &'static str,
        /// The number of elements it has.
        given: usize,
        /// The number of elements it needs.
        expected: usize,
    },
}

impl BatchOutput<'_> {
    /// Returns an error for a slice that does not have one row for every pose.
    fn check(&self, count: usize, [joints, imaginary]: [usize; 2]) -> Result<(), BatchError> {
        let slices = [
            ("joints", self.joints.len(), count * joints),
            ("imaginary", self.imaginary.len(), count * imaginary),
            ("reachable", self.reachable.len(), count),
            ("within_limits", self.within_limits.len(), count),
        ];
        slices.into_iter().try_for_each(|(slice, given, expected)| {
            if given == expected {
                Ok(())
            } else {
                Err(BatchError::Output { slice, given, expected })
            }
        })
    }
}

/// Fewer poses than this are solved one by one: it takes longer to begin a block.
pub(crate) const FEW: usize = 6;

/// Working memory of [`Manipulator::inverse_many`]; made by [`Manipulator::batch`]. See the example there.
#[derive(Clone, Debug)]
pub struct Batch {
    pub(crate) arch: Arch,
    pub(crate) block: Box<Block>,
    pub(crate) solution: Solution,
    pub(crate) all: AllModes,
}

impl Manipulator {
    /// Working memory for [`Manipulator::inverse_many`].
    pub fn batch(&self) -> Batch {
        Batch {
            arch: Arch::new(),
            block: Box::new(Block::new(self)),
            solution: self.solution(),
            all: self.all_modes(),
        }
    }

    /// Solves many poses, row after row. The results are equal to those of [`Manipulator::inverse`] to the
    /// bit, several times as fast.
    ///
    /// # Errors
    /// The first pose with a coordinate that is not a finite number (the contents of `out` are then
    /// unspecified), an input that is not a whole number of poses, or a slice of `out` that does not have one
    /// row for every pose.
    ///
    /// ```
    /// use opm_core::{BatchOutput, Manipulator};
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let poses = [0.0, 0.0, 0.0, 0.2, 0.0, /* the second one: */ 0.01, 0.0, 0.0, 0.26, 0.0];
    /// let (joints, imaginary) = (manipulator.coordinates().len(), manipulator.imaginary().len());
    /// let (mut values, mut imaginary_values) = (vec![0.0; 2 * joints], vec![0.0; 2 * imaginary]);
    /// let (mut reachable, mut within_limits) = ([false; 2], [false; 2]);
    /// let mut output = BatchOutput {
    ///     joints: &mut values,
    ///     imaginary: &mut imaginary_values,
    ///     reachable: &mut reachable,
    ///     within_limits: &mut within_limits,
    /// };
    /// let mut batch = manipulator.batch();
    /// manipulator.inverse_many(&poses, manipulator.home_mode(), &mut batch, &mut output)?;
    /// assert_eq!(reachable, [true, true]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse_many(
        &self,
        poses: &[f64],
        mode: Mode,
        batch: &mut Batch,
        out: &mut BatchOutput<'_>,
    ) -> Result<(), BatchError> {
        self.solve_many(poses, Modes::One(mode), batch, out)
    }

    /// Does the same as [`Manipulator::inverse_many`] with a working mode for each pose.
    ///
    /// # Errors
    /// As [`Manipulator::inverse_many`], and if there is not one mode for every pose.
    ///
    /// ```
    /// use opm_core::{BatchOutput, Manipulator};
    ///
    /// let manipulator = Manipulator::example("planar-3rrr")?;
    /// let modes = [manipulator.parse_mode("+ + +")?, manipulator.parse_mode("- + -")?];
    /// let poses = [manipulator.home_pose(), manipulator.home_pose()].concat();
    /// let mut joints = vec![0.0; 2 * manipulator.coordinates().len()];
    /// let (mut reachable, mut within_limits) = ([false; 2], [false; 2]);
    /// let mut output = BatchOutput {
    ///     joints: &mut joints,
    ///     imaginary: &mut [],
    ///     reachable: &mut reachable,
    ///     within_limits: &mut within_limits,
    /// };
    /// manipulator.inverse_each(&poses, &modes, &mut manipulator.batch(), &mut output)?;
    /// assert_eq!(reachable, [true, true]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse_each(
        &self,
        poses: &[f64],
        modes: &[Mode],
        batch: &mut Batch,
        out: &mut BatchOutput<'_>,
    ) -> Result<(), BatchError> {
        let expected = poses.len() / self.task_coordinates().len();
        if modes.len() != expected {
            return Err(BatchError::Modes { given: modes.len(), expected });
        }
        self.solve_many(poses, Modes::Each(modes), batch, out)
    }

    fn solve_many(
        &self,
        poses: &[f64],
        modes: Modes<'_>,
        batch: &mut Batch,
        out: &mut BatchOutput<'_>,
    ) -> Result<(), BatchError> {
        let width = self.task_coordinates().len();
        let widths = [self.coordinates.len(), self.imaginary.len()];
        let count = poses.len() / width;
        if !poses.len().is_multiple_of(width) {
            return Err(BatchError::Poses { given: poses.len(), width });
        }
        out.check(count, widths)?;
        let together = match modes {
            Modes::One(_) => self.decides_many(),
            Modes::Each(_) => self.solves_each(count),
        };
        if !together || count < FEW {
            return self.solve_alone(poses, modes, &mut batch.solution, out);
        }
        for (number, poses) in poses.chunks(LANES * width).enumerate() {
            let first = number * LANES;
            let rows = poses.len() / width;
            let refused =
                |(row, error): (usize, PoseError)| BatchError::Pose { row: first + row, error };
            let arch = batch.arch;
            if !batch.block.take(self, poses) {
                self.check(poses).map_err(refused)?;
            }
            let mut block_output = BatchOutput {
                joints: &mut out.joints[first * widths[0]..][..rows * widths[0]],
                imaginary: &mut out.imaginary[first * widths[1]..][..rows * widths[1]],
                reachable: &mut out.reachable[first..][..rows],
                within_limits: &mut out.within_limits[first..][..rows],
            };
            let (block, out) = (&mut *batch.block, &mut block_output);
            if let Modes::One(mode) = modes {
                self.complete_block(mode, arch, block);
            }
            // Angles are computed for two halves at a time.
            block.lanes = rows.next_multiple_of(16);
            block.displace(self, arch);
            let of_rows = modes.from(first);
            arch.dispatch(Solve { manipulator: self, modes: of_rows, arch, block });
            self.arch.dispatch(Give { block, out });
            for row in (0..rows).filter(|&row| batch.block.is_open(row)) {
                let pose = &poses[row * width..][..width];
                let mode = of_rows.of(row);
                self.inverse_one(pose, mode, &mut batch.solution, row, &mut block_output)
                    .map_err(|error| refused((row, error)))?;
            }
        }
        Ok(())
    }

    /// Solves poses one by one.
    fn solve_alone(
        &self,
        poses: &[f64],
        modes: Modes<'_>,
        solution: &mut Solution,
        out: &mut BatchOutput<'_>,
    ) -> Result<(), BatchError> {
        for (row, pose) in poses.chunks(self.task_coordinates().len()).enumerate() {
            self.inverse_one(pose, modes.of(row), solution, row, out)
                .map_err(|error| BatchError::Pose { row, error })?;
        }
        Ok(())
    }

    /// Whether so many poses are solved together that have a working mode each. Coordinates that depend on the others are
    /// found in one mode at a time.
    fn solves_each(&self, count: usize) -> bool {
        count >= FEW && self.dependent.is_none() && self.decides_many()
    }

    /// Does the same as [`Manipulator::inverse_each`]. The memory for poses that are solved together is made when there are
    /// some.
    pub(crate) fn inverse_each_in(
        &self,
        poses: &[f64],
        modes: &[Mode],
        (solution, batch): (&mut Solution, &mut Option<Batch>),
        out: &mut BatchOutput<'_>,
    ) -> Result<(), BatchError> {
        match self.solves_each(modes.len()) {
            true => {
                let batch = batch.get_or_insert_with(|| self.batch());
                self.inverse_each(poses, modes, batch, out)
            }
            false => self.solve_alone(poses, Modes::Each(modes), solution, out),
        }
    }

    /// Finds the dependent coordinates of the poses of a block in a mode.
    pub(crate) fn complete_block(&self, mode: Mode, arch: Arch, block: &mut Block) {
        if let Some(dependent) = &self.dependent {
            Complete { manipulator: self, dependent, mode, arch }.run(block);
        }
    }

    /// Returns an error for the first pose that is not valid.
    fn check(&self, poses: &[f64]) -> Result<(), (usize, PoseError)> {
        let width = self.task_coordinates().len();
        poses
            .chunks(width)
            .enumerate()
            .try_for_each(|(row, pose)| self.check_pose(pose).map_err(|error| (row, error)))
    }

    /// Solves the pose of one row by [`Manipulator::inverse`].
    fn inverse_one(
        &self,
        pose: &[f64],
        mode: Mode,
        solution: &mut Solution,
        row: usize,
        out: &mut BatchOutput<'_>,
    ) -> Result<(), PoseError> {
        let joints = &mut out.joints[row * self.coordinates.len()..][..self.coordinates.len()];
        let imaginary = &mut out.imaginary[row * self.imaginary.len()..][..self.imaginary.len()];
        let solution = self.inverse(pose, mode, solution)?;
        match solution {
            Some(solution) => {
                joints.copy_from_slice(&solution.joints);
                imaginary.copy_from_slice(&solution.imaginary);
            }
            None => {
                joints.fill(f64::NAN);
                imaginary.fill(f64::NAN);
            }
        }
        out.reachable[row] = solution.is_some();
        out.within_limits[row] = solution.is_some_and(Solution::within_limits);
        Ok(())
    }
}

/// The working modes of poses.
#[derive(Clone, Copy)]
enum Modes<'a> {
    /// One of all poses.
    One(Mode),
    /// One of each pose.
    Each(&'a [Mode]),
}

impl Modes<'_> {
    /// That of pose number `row`.
    fn of(self, row: usize) -> Mode {
        match self {
            Self::One(mode) => mode,
            Self::Each(modes) => modes[row],
        }
    }

    /// Those of the poses from number `row` on.
    fn from(self, row: usize) -> Self {
        match self {
            Self::One(mode) => Self::One(mode),
            Self::Each(modes) => Self::Each(&modes[row..]),
        }
    }

    /// The branches of a leg's chains for the poses of a block.
    #[inline(always)]
    fn branches(self, manipulator: &Manipulator, leg: usize) -> BranchesOfLeg {
        let of_mode = |mode: Mode| manipulator.modes.branches(mode, leg);
        match self {
            Self::One(mode) => BranchesOfLeg::repeated(of_mode(mode)),
            Self::Each(modes) => BranchesOfLeg::of_each(modes.iter().map(|&mode| of_mode(mode))),
        }
    }
}

/// Solves a displaced block with the instructions of the processor at hand.
struct Solve<'a> {
    manipulator: &'a Manipulator,
    modes: Modes<'a>,
    arch: Arch,
    block: &'a mut Block,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, modes, arch, block } = self;
        for (number, leg) in manipulator.legs.iter().enumerate() {
            let branches = modes.branches(manipulator, number);
            block.solve_leg(manipulator, &branches, number, arch);
            block.report(manipulator, leg);
        }
    }
}
