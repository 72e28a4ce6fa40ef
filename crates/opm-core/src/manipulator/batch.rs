//! Inverse kinematics of many poses at once.
//!
//! Poses are solved in blocks, and every step is done for the whole block: displacements, each leg's two
//! chains, angles, limits. Every step is a loop over the block of what [`Manipulator::inverse`] does for one
//! pose, compiled for the processor at hand, and the results are equal to the bit. Poses that need more than
//! straight-line arithmetic (a pose on a sphere's boundary of reach, an angle of a million radians) are
//! rare: they are marked and left to [`Manipulator::inverse`].

mod block;
mod decide;
pub(crate) mod lanes;
mod rows;
mod rows_and_columns;
pub(crate) mod section;

use super::all_modes::AllModes;
use super::dependent::Complete;
use super::pose::PoseError;
use super::solution::Solution;
use super::{Manipulator, Mode};
pub(crate) use block::Block;
pub(in crate::manipulator) use block::SolveSection;
use block::{Status, columns_of};
use lanes::LANES;
use pulp::{Arch, Simd, WithSimd};
pub use rows::{RowArcs, RowEnds, SheetRows};

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

/// Working memory of [`Manipulator::inverse_many`]; made by [`Manipulator::batch`]. See the example there.
#[derive(Clone, Debug)]
pub struct Batch {
    pub(crate) arch: Arch,
    pub(crate) block: Box<Block>,
    solution: Solution,
    all: AllModes,
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
        let width = self.task_coordinates().len();
        let widths = [self.coordinates.len(), self.imaginary.len()];
        let count = poses.len() / width;
        if !poses.len().is_multiple_of(width) {
            return Err(BatchError::Poses { given: poses.len(), width });
        }
        out.check(count, widths)?;
        if !self.decides_many() {
            // Each pose has chains or legs' heights of its own.
            for (row, pose) in poses.chunks(width).enumerate() {
                self.inverse_one(pose, mode, &mut batch.solution, row, out)
                    .map_err(|error| BatchError::Pose { row, error })?;
            }
            return Ok(());
        }
        for (number, poses) in poses.chunks(LANES * width).enumerate() {
            let first = number * LANES;
            let rows = poses.len() / width;
            let refused =
                |(row, error): (usize, PoseError)| BatchError::Pose { row: first + row, error };
            let arch = batch.arch;
            if !batch.block.take(self, poses, arch) {
                self.check(poses).map_err(refused)?;
            }
            let mut block_output = BatchOutput {
                joints: &mut out.joints[first * widths[0]..][..rows * widths[0]],
                imaginary: &mut out.imaginary[first * widths[1]..][..rows * widths[1]],
                reachable: &mut out.reachable[first..][..rows],
                within_limits: &mut out.within_limits[first..][..rows],
            };
            let (block, out) = (&mut *batch.block, &mut block_output);
            self.complete_block(mode, arch, block);
            block.displace(self, arch);
            arch.dispatch(Solve { manipulator: self, mode, arch, block, out });
            for row in (0..rows).filter(|&row| batch.block.is_open(row)) {
                let pose = &poses[row * width..][..width];
                self.inverse_one(pose, mode, &mut batch.solution, row, &mut block_output)
                    .map_err(|error| refused((row, error)))?;
            }
        }
        Ok(())
    }

    /// Finds the dependent coordinates of the poses of a block in a mode.
    fn complete_block(&self, mode: Mode, arch: Arch, block: &mut Block) {
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

/// Solves a displaced block with the instructions of the processor at hand.
struct Solve<'a, 'b> {
    manipulator: &'a Manipulator,
    mode: Mode,
    arch: Arch,
    block: &'a mut Block,
    out: &'a mut BatchOutput<'b>,
}

impl WithSimd for Solve<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, mode, arch, block, out } = self;
        for (number, leg) in manipulator.legs.iter().enumerate() {
            block.solve_leg(manipulator, manipulator.modes.branches(mode, number), number, arch);
            block.report(manipulator, leg);
        }
        block.give(out);
    }
}
