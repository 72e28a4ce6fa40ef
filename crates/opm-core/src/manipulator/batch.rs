//! Inverse kinematics of many poses at once.
//!
//! Poses are solved a block at a time, step by step for all of the block: displacements, each leg's two
//! chains, angles, limits. Every step is a loop over the block of what [`Manipulator::inverse`] does for
//! one pose, compiled for the processor at hand, and gives the same to the bit. What is not straight
//! arithmetic (a pose on the boundary of reach of a sphere, an angle of a million radians) is rare: such poses are
//! marked, and left to [`Manipulator::inverse`].

mod lanes;
mod section;

use super::inverse::{LARGEST, PoseError, Solution};
use super::leg::CompiledLeg;
use super::{Manipulator, Mode};
use crate::mechanism::leg::Section;
use crate::numeric::Quantity;
use crate::numeric::angle::MOST_REDUCED;
use lanes::{Amounts, Column, Displacements, LANES, Mask};
use pulp::{Arch, Simd, WithSimd};
use section::{Found, Side};

/// Where [`Manipulator::inverse_many`] puts what it finds: a row for every pose.
#[derive(Debug)]
pub struct Answers<'a> {
    /// Every joint coordinate, in the order of [`Manipulator::coordinates`], row after row; radians and
    /// metres, NaN in the rows of poses that are out of reach.
    pub joints: &'a mut [f64],
    /// Every imaginary joint, in the order of [`Manipulator::imaginary`], likewise.
    pub imaginary: &'a mut [f64],
    /// In reach.
    pub reachable: &'a mut [bool],
    /// In reach, and all joint coordinates within their limits.
    pub within_limits: &'a mut [bool],
}

/// One of many poses that cannot be computed with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("pose {row}: {error}")]
pub struct RowError {
    /// Its number, from zero.
    pub row: usize,
    /// Why.
    pub error: PoseError,
}

/// Working memory of [`Manipulator::inverse_many`]; made by [`Manipulator::batch`].
#[derive(Clone, Debug)]
pub struct Batch {
    arch: Arch,
    block: Box<Block>,
    solution: Solution,
}

/// What is known of a block of poses.
#[derive(Clone, Debug)]
struct Block {
    /// A column a task coordinate.
    pose: Vec<Column>,
    v: Displacements,
    b: Displacements,
    lower: Found,
    upper: Found,
    tau: Amounts,
    shifted: Displacements,
    /// A column a joint coordinate.
    joints: Vec<Column>,
    imaginary: Vec<Column>,
    status: Status,
}

#[derive(Clone, Debug)]
struct Status {
    /// Out of reach of some leg.
    beyond: Mask,
    /// Some leg's closed form does not tell.
    open: Mask,
    within_limits: Mask,
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
                lower: Found::new(),
                upper: Found::new(),
                tau: Amounts::new(),
                shifted: [[0.0; LANES]; 9],
                joints: columns(self.coordinates.len()),
                imaginary: columns(self.imaginary.len()),
                status: Status { beyond: none, open: none, within_limits: none },
            }),
            solution: self.solution(),
        }
    }

    /// [`Manipulator::inverse`] of many poses, row after row, to the bit, several times as fast.
    ///
    /// # Errors
    /// The first pose with a coordinate that is not a finite number. What `out` then holds is not to be
    /// read.
    ///
    /// # Panics
    /// If a slice of `out` has not a row for every pose.
    pub fn inverse_many(
        &self,
        poses: &[f64],
        mode: Mode,
        batch: &mut Batch,
        out: &mut Answers<'_>,
    ) -> Result<(), RowError> {
        let width = self.task.coordinates.len();
        let widths = [self.coordinates.len(), self.imaginary.len()];
        let count = poses.len() / width;
        assert_eq!(poses.len(), count * width, "whole poses");
        assert_eq!(out.joints.len(), count * widths[0], "a row of joints for every pose");
        assert_eq!(out.imaginary.len(), count * widths[1], "a row of imaginary joints a pose");
        assert_eq!(out.reachable.len(), count, "an answer for every pose");
        assert_eq!(out.within_limits.len(), count, "an answer for every pose");
        for (number, poses) in poses.chunks(LANES * width).enumerate() {
            let first = number * LANES;
            let rows = poses.len() / width;
            batch.block.take(poses, width);
            let refused = |(row, error): (usize, PoseError)| RowError { row: first + row, error };
            self.check(poses, &batch.block).map_err(refused)?;
            batch.arch.dispatch(Solve { manipulator: self, mode, block: &mut batch.block });
            let mut answers = Answers {
                joints: &mut out.joints[first * widths[0]..][..rows * widths[0]],
                imaginary: &mut out.imaginary[first * widths[1]..][..rows * widths[1]],
                reachable: &mut out.reachable[first..][..rows],
                within_limits: &mut out.within_limits[first..][..rows],
            };
            batch.block.give(widths, &mut answers);
            for row in (0..rows).filter(|&row| batch.block.is_open(row)) {
                let pose = &poses[row * width..][..width];
                self.inverse_row(pose, mode, &mut batch.solution, row, &mut answers)
                    .map_err(|error| refused((row, error)))?;
            }
        }
        Ok(())
    }

    /// Looks for a pose that cannot be computed with.
    fn check(&self, poses: &[f64], block: &Block) -> Result<(), (usize, PoseError)> {
        let fits = |column: &Column| column.iter().all(|value| value.abs() <= LARGEST);
        if block.pose.iter().all(fits) {
            return Ok(());
        }
        let width = self.task.coordinates.len();
        poses.chunks(width).enumerate().try_for_each(|(row, pose)| {
            self.displacements(pose).map(drop).map_err(|error| (row, error))
        })
    }

    /// One row, by itself.
    fn inverse_row(
        &self,
        pose: &[f64],
        mode: Mode,
        solution: &mut Solution,
        row: usize,
        out: &mut Answers<'_>,
    ) -> Result<(), PoseError> {
        let joints = &mut out.joints[row * self.coordinates.len()..][..self.coordinates.len()];
        let imaginary = &mut out.imaginary[row * self.imaginary.len()..][..self.imaginary.len()];
        out.reachable[row] = self.inverse(pose, mode, solution)?;
        if out.reachable[row] {
            joints.copy_from_slice(&solution.joints);
            imaginary.copy_from_slice(&solution.imaginary);
        } else {
            joints.fill(f64::NAN);
            imaginary.fill(f64::NAN);
        }
        out.within_limits[row] = out.reachable[row] && solution.within_limits;
        Ok(())
    }
}

/// Solves a block.
struct Solve<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    block: &'a mut Block,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, mode, block } = self;
        block.displace(manipulator);
        for (number, leg) in manipulator.legs.iter().enumerate() {
            block.solve_leg(manipulator, mode, number);
            block.report(manipulator, leg);
        }
    }
}

impl Block {
    /// Takes poses over, and fills up with the last one.
    fn take(&mut self, poses: &[f64], width: usize) {
        for (number, column) in self.pose.iter_mut().enumerate() {
            let mut last = 0.0;
            for (to, pose) in column.iter_mut().zip(poses.chunks_exact(width)) {
                last = pose[number];
                *to = last;
            }
            column[poses.len() / width..].fill(last);
        }
    }

    /// Gives rows away, open ones too.
    fn give(&self, widths: [usize; 2], out: &mut Answers<'_>) {
        let mut tables = [
            (&mut *out.joints, &self.joints, widths[0]),
            (&mut *out.imaginary, &self.imaginary, widths[1]),
        ];
        for (rows, columns, width) in &mut tables {
            for (number, column) in columns.iter().enumerate() {
                for (row, value) in rows.chunks_exact_mut(*width).zip(column) {
                    row[number] = *value;
                }
            }
        }
        for row in 0..out.reachable.len() {
            let reached = self.status.beyond[row] == 0;
            out.reachable[row] = reached;
            out.within_limits[row] = reached && self.status.within_limits[row] != 0;
            if !reached {
                for (rows, _, width) in &mut tables {
                    rows[row * *width..][..*width].fill(f64::NAN);
                }
            }
        }
    }

    /// A row that is to be solved by itself.
    fn is_open(&self, row: usize) -> bool {
        self.status.open[row] != 0 && self.status.beyond[row] == 0
    }

    /// `v` and `b` of every pose.
    #[inline(always)]
    fn displace(&mut self, manipulator: &Manipulator) {
        let task = &manipulator.task;
        let Self { pose, status, v, b, .. } = self;
        *status = Status { beyond: [0; LANES], open: [0; LANES], within_limits: [1; LANES] };
        for (coordinate, column) in task.coordinates.iter().zip(&*pose) {
            if coordinate.quantity == Quantity::Angle {
                for (open, &value) in status.open.iter_mut().zip(column) {
                    let from_home = value - coordinate.home;
                    let large = value.abs().max(from_home.abs()) > MOST_REDUCED;
                    *open |= u64::from(large);
                }
            }
        }
        for (section, first, to) in [(Section::Lower, 0, v), (Section::Upper, task.lower_count, b)]
        {
            let mut at = [&[0.0; LANES]; 3];
            let mut home = [0.0; 3];
            let count = if section == Section::Lower { task.lower_count } else { 3 };
            let of_section = pose.iter().zip(&task.coordinates).skip(first).take(count);
            for (number, (column, coordinate)) in of_section.enumerate() {
                (at[number], home[number]) = (column, coordinate.home);
            }
            section::displace(task, section, at, home, to);
        }
    }

    /// Both chains of a leg.
    #[inline(always)]
    fn solve_leg(&mut self, manipulator: &Manipulator, mode: Mode, number: usize) {
        let (task, leg) = (&manipulator.task, &manipulator.legs[number]);
        let branches = manipulator.modes.branches(mode, number);
        for section in leg.order() {
            let Self { v, b, lower, upper, tau, shifted, status, .. } = self;
            let given = section == leg.cut;
            let (of_section, branch, found, target) = match section {
                Section::Lower => (&leg.lower, branches.lower, &mut *lower, &*v),
                Section::Upper => (&leg.upper, branches.upper, &mut *upper, &*b),
            };
            let target = if given { target } else { &*shifted };
            section::solve(&of_section.chain, branch, target, found);
            status.note(found);
            if given {
                let cut = match section {
                    Section::Lower => leg.lower.chain.freedoms() - 1,
                    Section::Upper => 0,
                };
                section::unwind(leg.unwinds, &found.amounts[cut], tau);
                match section {
                    Section::Lower => {
                        let way = (task.upper_intersection, Side::Before);
                        section::shift(way, b, tau, shifted);
                        section::invert(tau);
                    }
                    Section::Upper => {
                        let way = (task.lower_intersection, Side::After);
                        section::shift(way, v, tau, shifted);
                    }
                }
            }
        }
    }

    /// The values of a leg's joints.
    #[inline(always)]
    fn report(&mut self, manipulator: &Manipulator, leg: &CompiledLeg) {
        for (section, found) in [(&leg.lower, &self.lower), (&leg.upper, &self.upper)] {
            for (slot, amounts) in section.slots.iter().zip(&found.amounts) {
                let Some(slot) = slot else { continue };
                let number = slot.coordinate;
                section::report(
                    (&manipulator.limits[number], manipulator.coordinates[number].home),
                    amounts,
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

impl Status {
    /// What a chain found. Of poses that an earlier chain did not hold for it means nothing.
    #[inline(always)]
    fn note(&mut self, found: &Found) {
        for lane in 0..LANES {
            let sure = self.open[lane] ^ 1;
            self.beyond[lane] |= found.beyond[lane] & sure;
            self.open[lane] |= (found.holds[lane] | found.beyond[lane]) ^ 1;
        }
    }
}
