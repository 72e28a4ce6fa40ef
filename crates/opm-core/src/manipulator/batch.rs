//! Inverse kinematics of many poses at once.
//!
//! Poses are solved in blocks, and every step is done for the whole block: displacements, each leg's two
//! chains, angles, limits. Every step is a loop over the block of what [`Manipulator::inverse`] does for one
//! pose, compiled for the processor at hand, and the results are equal to the bit. Poses that need more than
//! straight-line arithmetic (a pose on a sphere's boundary of reach, an angle of a million radians) are
//! rare: they are marked and left to [`Manipulator::inverse`].

mod decide;
pub(crate) mod lanes;
mod rows;
pub(crate) mod section;

use super::all_modes::AllModes;
use super::dependent::Complete;
use super::leg::{CompiledLeg, LegBranches};
use super::pose::{LARGEST, PoseError};
use super::solution::Solution;
use super::{Manipulator, Mode};
use crate::mechanism::leg::Section;
use crate::numeric::Quantity;
use crate::numeric::angle::MOST_REDUCED;
use crate::task::Task;
use decide::Decided;
use lanes::{Column, DisplacementColumns, Displacements, LANES, Mask};
use pulp::{Arch, Simd, WithSimd};
pub use rows::{RowArcs, RowEnds, SheetRows};
use section::{Found, Side, Step};

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

/// The number of poses for which something is computed that all of a block share: as many as fit into one vector of any
/// processor.
pub(crate) const FEWEST: usize = 8;

/// Working memory of [`Manipulator::inverse_many`]; made by [`Manipulator::batch`]. See the example there.
#[derive(Clone, Debug)]
pub struct Batch {
    pub(crate) arch: Arch,
    pub(crate) block: Box<Block>,
    solution: Solution,
    all: AllModes,
}

/// The poses and results of a block, by columns.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// One column for every task coordinate.
    pub pose: Vec<Column>,
    pub v: Displacements,
    pub b: Displacements,
    /// The number of poses for which the upper section is computed: [`FEWEST`] if they all have its coordinates in common,
    /// otherwise all.
    pub upper_lanes: usize,
    pub lower: Found,
    pub upper: Found,
    /// The displacements along the intersection motion of the leg that was solved last.
    pub tau: DisplacementColumns,
    pub shifted: Displacements,
    /// One column for every joint coordinate.
    joints: Vec<Column>,
    imaginary: Vec<Column>,
    pub status: Status,
    decided: Decided,
}

/// What is known of the reachability of each pose of a block.
#[derive(Clone, Debug)]
pub(crate) struct Status {
    /// Whether a pose is certainly out of reach of some leg.
    pub beyond: Mask,
    /// Whether the general case of some leg's closed form does not apply to a pose.
    pub open: Mask,
    pub within_limits: Mask,
}

impl Manipulator {
    /// Working memory for [`Manipulator::inverse_many`].
    pub fn batch(&self) -> Batch {
        let columns = |count: usize| vec![[0.0; LANES]; count];
        let none = [0; LANES];
        Batch {
            arch: Arch::new(),
            block: Box::new(Block {
                pose: columns(self.task.coordinates.len()),
                v: [[0.0; LANES]; 9],
                b: [[0.0; LANES]; 9],
                upper_lanes: LANES,
                lower: Found::new(),
                upper: Found::new(),
                tau: DisplacementColumns::new(),
                shifted: [[0.0; LANES]; 9],
                joints: columns(self.coordinates.len()),
                imaginary: columns(self.imaginary.len()),
                status: Status { beyond: none, open: none, within_limits: none },
                decided: Decided::new(),
            }),
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
            batch.block.take(self, poses);
            let refused =
                |(row, error): (usize, PoseError)| BatchError::Pose { row: first + row, error };
            self.check(poses, &batch.block).map_err(refused)?;
            let mut block_output = BatchOutput {
                joints: &mut out.joints[first * widths[0]..][..rows * widths[0]],
                imaginary: &mut out.imaginary[first * widths[1]..][..rows * widths[1]],
                reachable: &mut out.reachable[first..][..rows],
                within_limits: &mut out.within_limits[first..][..rows],
            };
            let (block, out) = (&mut *batch.block, &mut block_output);
            self.complete_block(mode, batch.arch, block);
            batch.arch.dispatch(Solve { manipulator: self, mode, block, out });
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
    fn check(&self, poses: &[f64], block: &Block) -> Result<(), (usize, PoseError)> {
        let fits = |column: &Column| column.iter().all(|value| value.abs() <= LARGEST);
        if block.pose.iter().all(fits) {
            return Ok(());
        }
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

/// Solves a block with the instructions of the processor at hand.
struct Solve<'a, 'b> {
    manipulator: &'a Manipulator,
    mode: Mode,
    block: &'a mut Block,
    out: &'a mut BatchOutput<'b>,
}

impl WithSimd for Solve<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, mode, block, out } = self;
        block.displace(manipulator);
        for (number, leg) in manipulator.legs.iter().enumerate() {
            block.solve_leg(manipulator, manipulator.modes.branches(mode, number), number);
            block.report(manipulator, leg);
        }
        block.lift(manipulator);
        block.give(out);
    }
}

impl Block {
    /// Copies poses into the block, and fills its remaining lanes with the last one.
    pub fn take(&mut self, manipulator: &Manipulator, poses: &[f64]) {
        let width = manipulator.task_coordinates().len();
        for number in 0..width {
            let column = &mut self.pose[manipulator.number_among_all(number)];
            let mut last = 0.0;
            for (to, pose) in column.iter_mut().zip(poses.chunks_exact(width)) {
                last = pose[number];
                *to = last;
            }
            column[poses.len() / width..].fill(last);
        }
        self.begin(manipulator);
    }

    /// Begins with the poses of the block: nothing is known of them, but that angles of many revolutions are not solved
    /// together.
    #[inline(always)]
    pub fn begin(&mut self, manipulator: &Manipulator) {
        self.upper_lanes = LANES;
        self.status = Status { beyond: [0; LANES], open: [0; LANES], within_limits: [1; LANES] };
        self.leave_large(manipulator);
    }

    /// Marks the poses with angles of many revolutions.
    #[inline(always)]
    fn leave_large(&mut self, manipulator: &Manipulator) {
        let Self { pose, status, .. } = self;
        for (coordinate, column) in manipulator.task.coordinates.iter().zip(&*pose) {
            if coordinate.quantity == Quantity::Angle {
                for (open, &value) in status.open.iter_mut().zip(column) {
                    let from_home = value - coordinate.home;
                    // Of tilt and torsion, the difference of two is an angle.
                    let large = value.abs().max(from_home.abs()) > 0.5 * MOST_REDUCED;
                    *open |= u64::from(large);
                }
            }
        }
    }

    /// Finds out whether all poses have the coordinates of the upper section in common.
    #[inline(always)]
    fn compare_upper(&mut self, task: &Task) {
        let mut differ = 0;
        for column in &self.pose[task.range(Section::Upper)] {
            for value in column {
                differ |= value.to_bits() ^ column[0].to_bits();
            }
        }
        self.upper_lanes = if differ == 0 { FEWEST } else { LANES };
    }

    /// Whether all poses have the coordinates of the upper section in common.
    #[inline(always)]
    pub fn one_upper(&self) -> bool {
        self.upper_lanes < LANES
    }

    /// Writes the block's results to rows, including the rows that are still open.
    #[inline(always)]
    fn give(&self, out: &mut BatchOutput<'_>) {
        transpose(&self.joints, out.joints);
        transpose(&self.imaginary, out.imaginary);
        let (joints, imaginary) = (self.joints.len(), self.imaginary.len());
        for row in 0..out.reachable.len() {
            let reached = self.status.beyond[row] == 0;
            out.reachable[row] = reached;
            out.within_limits[row] = reached && self.status.within_limits[row] != 0;
            if !reached {
                out.joints[row * joints..][..joints].fill(f64::NAN);
                out.imaginary[row * imaginary..][..imaginary].fill(f64::NAN);
            }
        }
    }

    /// Whether a row has to be solved by [`Manipulator::inverse`].
    fn is_open(&self, row: usize) -> bool {
        self.status.open[row] != 0 && self.status.beyond[row] == 0
    }

    /// Computes `v` and `b` of every pose.
    #[inline(always)]
    pub fn displace(&mut self, manipulator: &Manipulator) {
        if manipulator.dependent.is_some() {
            // Some of the angles were not known before.
            self.leave_large(manipulator);
        }
        self.compare_upper(&manipulator.task);
        self.displace_section(manipulator, Section::Lower, LANES);
        self.displace_section(manipulator, Section::Upper, self.upper_lanes);
        if self.one_upper() {
            lanes::repeat(&mut self.b);
        }
    }

    /// Computes the displacements of a section, of so many poses.
    #[inline(always)]
    pub fn displace_section(&mut self, manipulator: &Manipulator, section: Section, lanes: usize) {
        let task = &manipulator.task;
        let Self { pose, v, b, .. } = self;
        let (at, home) = columns_of(task, section, pose);
        let to = match section {
            Section::Lower => v,
            Section::Upper => b,
        };
        section::displace(task, section, &at, home, to, lanes);
    }

    /// Solves both chains of a leg.
    #[inline(always)]
    pub fn solve_leg(&mut self, manipulator: &Manipulator, branches: LegBranches, number: usize) {
        let (task, leg) = (&manipulator.task, &manipulator.legs[number]);
        for section in leg.order() {
            let is_first = section == leg.split_section;
            let first_upper = is_first && section == Section::Upper;
            let lanes = if first_upper { self.upper_lanes } else { LANES };
            let Self { v, b, lower, upper, tau, shifted, status, .. } = self;
            let (of_section, branch, found, target) = match section {
                Section::Lower => (&leg.lower, branches.lower, &mut *lower, &*v),
                Section::Upper => (&leg.upper, branches.upper, &mut *upper, &*b),
            };
            // Without an intersection motion, neither section moves the other one's target.
            let target = if is_first || task.shared().is_none() { target } else { &*shifted };
            section::solve(of_section, branch, target, found, lanes);
            if lanes < LANES {
                found.repeat();
            }
            status.note(found);
            if is_first {
                match leg.imaginary_joint() {
                    Some(joint) => section::unwind(leg.unwinds, &found.displacements[joint], tau),
                    None => tau.clear(),
                }
                match section {
                    _ if task.shared().is_none() => {}
                    Section::Lower => {
                        let step = Step { motion: task.upper_intersection, side: Side::Before };
                        section::shift(step, b, tau, shifted, LANES);
                        section::invert(tau);
                    }
                    Section::Upper => {
                        let step = Step { motion: task.lower_intersection, side: Side::After };
                        section::shift(step, v, tau, shifted, LANES);
                    }
                }
            }
        }
    }

    /// Computes the values of the lifts.
    #[inline(always)]
    pub fn lift(&mut self, manipulator: &Manipulator) {
        let Some(height) = &manipulator.task.height else { return };
        let home = manipulator.task.coordinates[height.coordinate].home;
        for lift in manipulator.lifts() {
            for lane in 0..LANES {
                let rise = self.pose[height.coordinate][lane] - home;
                let (value, within) = manipulator.lifted(lift, rise);
                self.joints[lift.coordinate.number][lane] = value;
                self.status.within_limits[lane] &= u64::from(within);
            }
        }
    }

    /// Computes the values of a leg's joints.
    #[inline(always)]
    fn report(&mut self, manipulator: &Manipulator, leg: &CompiledLeg) {
        for (section, found) in [(&leg.lower, &self.lower), (&leg.upper, &self.upper)] {
            for (coordinate, displacements) in section.coordinates.iter().zip(&found.displacements)
            {
                let Some(coordinate) = coordinate else { continue };
                let number = coordinate.number;
                section::report(
                    &manipulator.limits[number],
                    manipulator.coordinates[number].home,
                    displacements,
                    &mut self.joints[number],
                    &mut self.status.within_limits,
                );
            }
        }
        if let Some(number) = leg.imaginary {
            let joint = &manipulator.imaginary[number];
            section::imaginary(joint, &self.tau, &mut self.imaginary[number]);
        }
    }
}

/// The columns of a section's coordinates without its height, of zeros beyond the last, and their values at home.
#[inline(always)]
fn columns_of<'p>(
    task: &Task,
    section: Section,
    pose: &'p [Column],
) -> ([&'p Column; 3], [f64; 3]) {
    let (mut at, mut home) = ([&[0.0; LANES]; 3], [0.0; 3]);
    for (place, number) in task.in_plane(section, task.range(section)).enumerate() {
        (at[place], home[place]) = (&pose[number], task.coordinates[number].home);
    }
    (at, home)
}

/// Writes columns to rows of as many numbers. Squares of four rows and four columns are transposed in the processor's
/// vectors.
#[inline(always)]
fn transpose(columns: &[Column], rows: &mut [f64]) {
    let width = columns.len();
    if width == 0 {
        return;
    }
    let (fours, others) = columns.as_chunks::<4>();
    let mut four_rows = rows.chunks_exact_mut(4 * width);
    let mut lane = 0;
    for rows in &mut four_rows {
        for (number, [a, b, c, d]) in fours.iter().enumerate() {
            let (a, b, c, d) =
                (&a[lane..lane + 4], &b[lane..lane + 4], &c[lane..lane + 4], &d[lane..lane + 4]);
            for i in 0..4 {
                let to = &mut rows[i * width + 4 * number..][..4];
                to.copy_from_slice(&[a[i], b[i], c[i], d[i]]);
            }
        }
        for (number, column) in others.iter().enumerate() {
            let first = 4 * fours.len() + number;
            for (i, value) in column[lane..lane + 4].iter().enumerate() {
                rows[i * width + first] = *value;
            }
        }
        lane += 4;
    }
    for (row, lane) in four_rows.into_remainder().chunks_exact_mut(width).zip(lane..) {
        for (to, column) in row.iter_mut().zip(columns) {
            *to = column[lane];
        }
    }
}

impl Status {
    /// Records a chain's result. It is ignored for poses to which an earlier chain's general case did not
    /// apply.
    #[inline(always)]
    pub fn note(&mut self, found: &Found) {
        for lane in 0..LANES {
            self.note_lane(lane, found.holds[lane], found.beyond[lane]);
        }
    }

    /// Records a closed form's result for one pose.
    #[inline(always)]
    pub fn note_lane(&mut self, lane: usize, holds: u64, beyond: u64) {
        let valid = self.open[lane] ^ 1;
        self.beyond[lane] |= beyond & valid;
        self.open[lane] |= (holds | beyond) ^ 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number of rows of a block, and rows with and without a square of four numbers.
    #[test]
    fn columns_become_rows() {
        for width in 0..10 {
            let value = |row: usize, number: usize| (100 * number + row) as f64;
            let columns: Vec<Column> =
                (0..width).map(|number| std::array::from_fn(|row| value(row, number))).collect();
            for count in 0..=LANES {
                let mut rows = vec![f64::NAN; count * width];
                transpose(&columns, &mut rows);
                for (place, found) in rows.into_iter().enumerate() {
                    assert_eq!(found, value(place / width, place % width), "{count} x {width}");
                }
            }
        }
    }
}
