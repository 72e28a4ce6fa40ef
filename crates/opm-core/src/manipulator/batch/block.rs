//! A block of poses, and the steps of inverse kinematics for all of them. A step is a loop over the block, or done once
//! for what all poses have in common.

use super::BatchOutput;
use super::decide::Decided;
use super::lanes::{
    self, Branches, BranchesOfLeg, Column, DisplacementColumns, Displacements, LANES, Lanes, Mask,
};
use super::rows_and_columns::{read_rows, write_rows};
use super::section::{self, Found, Side, Step};
use super::whole::{self, PackPlace};
use crate::chain::whole::PackReach;
use crate::group::Displacement;
use crate::manipulator::Manipulator;
use crate::manipulator::leg::CompiledLeg;
use crate::manipulator::pose::LARGEST;
use crate::manipulator::section::CompiledSection;
use crate::mechanism::leg::Section;
use crate::numbers::pack::Pack;
use crate::numeric::Quantity;
use crate::numeric::angle::MOST_REDUCED;
use crate::task::Task;
use pulp::{Arch, Simd, WithSimd};

/// The most coordinates of a section: three, and a height.
const MOST_OF_SECTION: usize = 4;

/// The poses and results of a block, by columns.
#[derive(Clone, Debug)]
pub struct Block {
    /// One column for every task coordinate.
    pub pose: Vec<Column>,
    pub v: Displacements,
    pub b: Displacements,
    /// The number of lanes for which chains are solved; the results of the others are not valid.
    pub lanes: usize,
    /// The number of lanes for which the upper section is computed: one if all poses have its coordinates in common
    /// ([`Block::displace`] finds out), otherwise [`Block::lanes`].
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
    pub decided: Decided,
    /// Where the platform is, if legs are solved whole.
    pub places: Box<[PackPlace; LANES / Pack::POSES]>,
    /// What is known of a leg that is solved whole.
    pub found: Box<PackReach>,
}

/// What is known of the reachability of each pose of a block.
#[derive(Clone, Debug)]
pub struct Status {
    /// Whether a pose is certainly out of reach of some leg.
    pub beyond: Mask,
    /// Whether the general case of some leg's closed form does not apply to a pose.
    pub open: Mask,
    pub within_limits: Mask,
}

/// Takes the poses of a block with the instructions of the processor at hand. The output is whether they are numbers that
/// are not too large.
struct Take<'a> {
    manipulator: &'a Manipulator,
    poses: &'a [f64],
    block: &'a mut Block,
}

impl WithSimd for Take<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { manipulator, poses, block } = self;
        let width = manipulator.task_coordinates().len();
        let column_of = |number: usize| manipulator.number_among_all(number);
        read_rows(simd, poses, width, &mut block.pose, column_of);
        block.begin(manipulator);
        let mut fit = true;
        for column in (0..width).map(|number| &block.pose[column_of(number)]) {
            for value in column {
                fit &= value.abs() <= LARGEST;
            }
        }
        fit
    }
}

/// Computes the displacements of a block with the instructions of the processor at hand. There is one copy of this work
/// for each set of instructions, which several tasks use.
struct Displace<'a> {
    manipulator: &'a Manipulator,
    /// The only section, or (`None`) both and the lifts.
    section: Option<Section>,
    block: &'a mut Block,
}

impl Displace<'_> {
    // Inlined, it would be compiled once more in every task.
    #[inline(never)]
    fn run(self, arch: Arch) {
        arch.dispatch(self);
    }
}

impl WithSimd for Displace<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, section, block } = self;
        let task = &manipulator.task;
        if section.is_some() {
            block.upper_lanes = block.lanes;
        } else {
            if manipulator.dependent.is_some() {
                // Some of the angles were not known before.
                block.leave_large(manipulator);
            }
            block.compare_upper(task);
            block.lift(manipulator);
        }
        // Each section is a constant for its loop.
        if section != Some(Section::Upper) {
            block.displace_section(task, Section::Lower);
        }
        if section != Some(Section::Lower) {
            if block.one_upper() {
                section::store(&block.common_upper(task), &mut block.b, 0);
                lanes::repeat(&mut block.b);
            } else {
                block.displace_section(task, Section::Upper);
            }
        }
        if manipulator.is_whole() {
            block.place(manipulator);
        }
    }
}

/// Solves a section for a block with the instructions of the processor at hand. There is one copy of this work, too.
pub struct SolveSection<'a> {
    pub section: &'a CompiledSection,
    pub branches: &'a Branches,
    /// The displacements of its outer link.
    pub target: &'a Displacements,
    pub found: &'a mut Found,
    /// The number of poses: one if they all have the target in common.
    pub lanes: usize,
}

impl SolveSection<'_> {
    // Inlined, it would be compiled once more in every task.
    #[inline(never)]
    pub fn run(self, arch: Arch) {
        arch.dispatch(self);
    }
}

impl WithSimd for SolveSection<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { section, branches, target, found, lanes } = self;
        section::solve(section, branches, target, found, lanes);
        if lanes == 1 {
            found.repeat();
        }
    }
}

/// Writes the results of a block to rows, including the rows that are still open.
pub(super) struct Give<'a, 'b> {
    pub block: &'a Block,
    pub out: &'a mut BatchOutput<'b>,
}

impl WithSimd for Give<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { block: Block { joints, imaginary, status, .. }, out } = self;
        write_rows(simd, joints, out.joints);
        write_rows(simd, imaginary, out.imaginary);
        for (to, &beyond) in out.reachable.iter_mut().zip(&status.beyond) {
            *to = beyond == 0;
        }
        let flags = status.within_limits.iter().zip(&status.beyond);
        for (to, (&within, &beyond)) in out.within_limits.iter_mut().zip(flags) {
            *to = (within != 0) & (beyond == 0);
        }
        let (joints, imaginary) = (joints.len(), imaginary.len());
        for (row, _) in out.reachable.iter().enumerate().filter(|(_, reached)| !**reached) {
            out.joints[row * joints..][..joints].fill(f64::NAN);
            out.imaginary[row * imaginary..][..imaginary].fill(f64::NAN);
        }
    }
}

impl Block {
    pub(super) fn new(manipulator: &Manipulator) -> Self {
        let columns = |count: usize| vec![Lanes::all(0.0); count];
        Self {
            pose: columns(manipulator.task.coordinates.len()),
            v: [Lanes::all(0.0); 9],
            b: [Lanes::all(0.0); 9],
            lanes: LANES,
            upper_lanes: LANES,
            lower: Found::new(),
            upper: Found::new(),
            tau: DisplacementColumns::new(),
            shifted: [Lanes::all(0.0); 9],
            joints: columns(manipulator.coordinates.len()),
            imaginary: columns(manipulator.imaginary.len()),
            status: Status::UNKNOWN,
            decided: Decided::new(),
            places: Box::new(whole::at_home()),
            found: Box::default(),
        }
    }

    /// Copies poses into the block, and fills its remaining lanes with the last one, so that all can be computed. Returns
    /// whether all coordinates are numbers that are not too large.
    pub fn take(&mut self, manipulator: &Manipulator, poses: &[f64]) -> bool {
        self.lanes = LANES;
        manipulator.arch.dispatch(Take { manipulator, poses, block: self })
    }

    /// Begins with the poses of the block: nothing is known of them, but that angles of many revolutions are not solved
    /// together.
    #[inline(always)]
    pub fn begin(&mut self, manipulator: &Manipulator) {
        self.status = Status::UNKNOWN;
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
        self.upper_lanes = if differ == 0 { 1 } else { self.lanes };
    }

    /// Whether all poses have the coordinates of the upper section in common.
    #[inline(always)]
    pub fn one_upper(&self) -> bool {
        self.upper_lanes == 1
    }

    /// Whether a row has to be solved by [`Manipulator::inverse`].
    pub(super) fn is_open(&self, row: usize) -> bool {
        self.status.open[row] != 0 && self.status.beyond[row] == 0
    }

    /// Computes `v` and `b` of every pose, and the values of the lifts.
    pub fn displace(&mut self, manipulator: &Manipulator, arch: Arch) {
        Displace { manipulator, section: None, block: self }.run(arch);
    }

    /// Computes the displacements of one section; those of the other one stay as they are.
    pub fn displace_only(&mut self, manipulator: &Manipulator, section: Section, arch: Arch) {
        Displace { manipulator, section: Some(section), block: self }.run(arch);
    }

    #[inline(always)]
    fn displace_section(&mut self, task: &Task, section: Section) {
        let Self { pose, v, b, .. } = self;
        let (at, home) = columns_of(task, section, pose);
        let to = match section {
            Section::Lower => v,
            Section::Upper => b,
        };
        section::displace(task, section, &at, home, to, self.lanes);
    }

    /// The displacement of the upper section where all poses have its coordinates in common.
    // Inlined, it would be compiled for every set of instructions.
    #[inline(never)]
    fn common_upper(&self, task: &Task) -> Displacement {
        let mut common = [0.0; MOST_OF_SECTION];
        for (value, column) in common.iter_mut().zip(&self.pose[task.range(Section::Upper)]) {
            *value = column[0];
        }
        task.upper(&common)
    }

    /// Solves both chains of a leg.
    #[inline(always)]
    pub fn solve_leg(
        &mut self,
        manipulator: &Manipulator,
        branches: &BranchesOfLeg,
        number: usize,
        arch: Arch,
    ) {
        let (task, leg) = (&manipulator.task, &manipulator.legs[number]);
        for section in leg.order() {
            let is_first = section == leg.split_section;
            let of_all = self.lanes;
            let alike = is_first && section == Section::Upper && branches.one_upper(of_all);
            let lanes = if alike { self.upper_lanes } else { of_all };
            let Self { v, b, lower, upper, tau, shifted, status, .. } = self;
            let (of_section, found, target) = match section {
                Section::Lower => (&leg.lower, &mut *lower, &*v),
                Section::Upper => (&leg.upper, &mut *upper, &*b),
            };
            // Without an intersection motion, neither section moves the other one's target.
            let target = if is_first || task.shared().is_none() { target } else { &*shifted };
            let branches = branches.of(section);
            SolveSection { section: of_section, branches, target, found, lanes }.run(arch);
            status.note(found);
            if is_first {
                match leg.imaginary_joint() {
                    Some(joint) => {
                        section::unwind(leg.unwinds, &found.displacements[joint], tau, of_all);
                    }
                    None => tau.clear(),
                }
                match section {
                    _ if task.shared().is_none() => {}
                    Section::Lower => {
                        let step = Step { motion: task.upper_intersection, side: Side::Before };
                        section::shift(step, b, tau, shifted, of_all);
                        section::invert(tau, of_all);
                    }
                    Section::Upper => {
                        let step = Step { motion: task.lower_intersection, side: Side::After };
                        section::shift(step, v, tau, shifted, of_all);
                    }
                }
            }
        }
    }

    /// Computes the values of the lifts.
    #[inline(always)]
    fn lift(&mut self, manipulator: &Manipulator) {
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
    pub(super) fn report(&mut self, manipulator: &Manipulator, leg: &CompiledLeg) {
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
                    self.lanes,
                );
            }
        }
        if let Some(number) = leg.imaginary {
            let joint = &manipulator.imaginary[number];
            section::imaginary(joint, &self.tau, &mut self.imaginary[number], self.lanes);
        }
    }
}

/// The columns of a section's coordinates without its height, of zeros beyond the last, and their values at home.
#[inline(always)]
pub fn columns_of<'p>(
    task: &Task,
    section: Section,
    pose: &'p [Column],
) -> ([&'p Column; 3], [f64; 3]) {
    static ZEROS: Column = Lanes::all(0.0);
    let (mut at, mut home) = ([&ZEROS; 3], [0.0; 3]);
    for (place, number) in task.in_plane(section, task.range(section)).enumerate() {
        (at[place], home[place]) = (&pose[number], task.coordinates[number].home);
    }
    (at, home)
}

impl Status {
    /// Nothing is known of any pose.
    pub const UNKNOWN: Self =
        Self { beyond: Lanes::all(0), open: Lanes::all(0), within_limits: Lanes::all(1) };

    /// Whether a branch reaches each pose within the leg's limits. Marks in `open` where that is not known.
    #[inline(always)]
    pub fn reaches(&self, open: &mut Mask) -> Mask {
        let mut reaches = Lanes::all(0);
        for lane in 0..LANES {
            let closes = self.beyond[lane] ^ 1;
            reaches[lane] = closes & (self.open[lane] ^ 1) & self.within_limits[lane];
            open[lane] |= closes & self.open[lane];
        }
        reaches
    }

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
