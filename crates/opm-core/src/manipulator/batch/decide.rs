//! Which of many poses are in reach within all limits, in one working mode or in any: the steps of
//! [`Manipulator::inverse_many`] without the joints' values.

use super::lanes::{BranchesOfLeg, Column, LANES, Lanes, Mask};
use super::{Batch, Block, Status, section};
use crate::manipulator::{Choices, CompiledLeg, Dependent, LegBranches, Manipulator, Mode};
use crate::mechanism::leg::Section;
use pulp::{Arch, Simd, WithSimd};

/// What is known of the poses of a block.
#[derive(Clone, Debug)]
pub(super) struct Decided {
    /// Whether a pose is certainly out of reach, or beyond limits, in every mode asked for.
    missed: Mask,
    /// Whether a pose has to be decided by itself.
    open: Mask,
    /// The imaginary joints of the branches of every leg.
    imaginary: Vec<OfBranch>,
}

/// The imaginary joint of one branch of a leg.
#[derive(Clone, Debug)]
struct OfBranch {
    /// The number of the imaginary joint.
    number: usize,
    /// Whether the branch reaches a pose within the leg's limits.
    reaches: Mask,
    values: Column,
}

impl Decided {
    pub fn new() -> Self {
        Self { missed: Lanes::all(0), open: Lanes::all(0), imaginary: Vec::new() }
    }
}

impl Manipulator {
    /// Whether many poses are solved together: chains are the same at all poses.
    #[doc(hidden)]
    pub fn decides_many(&self) -> bool {
        self.lifts_straight() && !self.shares_height()
    }

    /// The branches of a leg in the modes with some choices, all-plus first.
    #[inline(always)]
    pub(crate) fn branches_of(
        &self,
        choices: Choices,
        leg: usize,
    ) -> impl Iterator<Item = LegBranches> {
        let modes = self.modes.chosen_leg_modes(choices, leg);
        modes.map(move |(_, mode)| self.modes.branches(mode, leg))
    }

    /// The choices with which poses have one set of dependent coordinates: those of a mode, or (`None`) each combination.
    pub(crate) fn completions(&self, mode: Option<Mode>) -> impl Iterator<Item = Choices> {
        let each = self.dependent.as_ref().filter(|_| mode.is_none());
        let one = match (mode, each) {
            (Some(mode), _) => Some(Choices::of(mode)),
            (None, None) => Some(Choices::default()),
            (None, Some(_)) => None,
        };
        let combinations = each.map_or(0, Dependent::combinations);
        let each = (0..combinations).filter_map(move |i| Some(each?.choices(i)));
        one.into_iter().chain(each)
    }

    /// Finds which of some poses, row after row, are in reach within all limits, in one working mode or (`None`) in any:
    /// `reached` gets one answer for each. `used` is called with the number of an imaginary joint and the least and the
    /// largest of its values in solutions of reached poses.
    ///
    /// # Panics
    /// If there are more answers than [`Manipulator::DECIDED`], or fewer poses than answers.
    #[doc(hidden)]
    pub fn decide_many(
        &self,
        poses: &[f64],
        mode: Option<Mode>,
        batch: &mut Batch,
        reached: &mut [bool],
        used: &mut dyn FnMut(usize, [f64; 2]),
    ) {
        let (width, rows) = (self.task_coordinates().len(), reached.len());
        let Batch { arch, block, solution, all, .. } = batch;
        let together = self.decides_many();
        let mut alone = Lanes::all(u64::from(!together));
        reached.fill(false);
        if together {
            block.take(self, poses);
        }
        for choices in self.completions(mode).take_while(|_| together) {
            self.complete_block(choices.chosen, *arch, block);
            block.displace(self, *arch);
            arch.dispatch(Decide { manipulator: self, choices, arch: *arch, block });
            let Decided { missed, open, imaginary } = &block.decided;
            for (lane, reached) in reached.iter_mut().enumerate() {
                *reached |= missed[lane] | open[lane] == 0;
                alone[lane] |= open[lane] & !missed[lane];
            }
            for OfBranch { number, reaches, values } in imaginary {
                let mut range = [f64::INFINITY, f64::NEG_INFINITY];
                for lane in 0..rows {
                    let counts = reaches[lane] != 0 && missed[lane] | open[lane] == 0;
                    let value = values[lane];
                    range[0] = if counts { range[0].min(value) } else { range[0] };
                    range[1] = if counts { range[1].max(value) } else { range[1] };
                }
                if range[0] <= range[1] {
                    used(*number, range);
                }
            }
        }
        for lane in (0..rows).filter(|&lane| alone[lane] & 1 == 1) {
            let pose = &poses[lane * width..][..width];
            let mut each = |number: usize, value: f64| used(number, [value; 2]);
            reached[lane] = match mode {
                Some(mode) => match self.inverse(pose, mode, solution).expect("a finite pose") {
                    Some(solution) if solution.within_limits() => {
                        let values = solution.imaginary().iter().enumerate();
                        values.for_each(|(number, &value)| each(number, value));
                        true
                    }
                    _ => false,
                },
                None => {
                    let found = self.inverse_all(pose, all).expect("a finite pose");
                    found.is_some_and(|all| self.within_limits_in_any(all, each))
                }
            };
        }
    }

    /// The most poses that [`Manipulator::decide_many`] takes.
    #[doc(hidden)]
    pub const DECIDED: usize = LANES;
}

/// Solves a branch of a leg, and finds out whether its joints are within their limits, with the instructions of the
/// processor at hand.
struct Reach<'a> {
    manipulator: &'a Manipulator,
    leg: usize,
    branches: LegBranches,
    arch: Arch,
    block: &'a mut Block,
}

impl WithSimd for Reach<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, leg, branches, arch, block } = self;
        block.status = Status::UNKNOWN;
        block.solve_leg(manipulator, &BranchesOfLeg::repeated(branches), leg, arch);
        for section in [Section::Lower, Section::Upper] {
            block.admit(manipulator, &manipulator.legs[leg], section, LANES);
        }
    }
}

/// Decides a displaced block with the instructions of the processor at hand.
struct Decide<'a> {
    manipulator: &'a Manipulator,
    choices: Choices,
    arch: Arch,
    block: &'a mut Block,
}

impl WithSimd for Decide<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.block.decide(self.manipulator, self.choices, self.arch);
    }
}

impl Block {
    /// Decides a displaced block.
    #[inline(always)]
    fn decide(&mut self, manipulator: &Manipulator, choices: Choices, arch: Arch) {
        let Status { beyond, open, within_limits } = &self.status;
        self.decided.open = *open;
        for (lane, missed) in self.decided.missed.iter_mut().enumerate() {
            *missed = beyond[lane] | (within_limits[lane] ^ 1);
        }
        let mut number = 0;
        for (leg, compiled) in manipulator.legs.iter().enumerate() {
            let mut reached = Lanes::all(0);
            let mut open = Lanes::all(0);
            for branches in manipulator.branches_of(choices, leg) {
                self.reach(manipulator, leg, branches, arch);
                let reaches = self.status.reaches(&mut open);
                for lane in 0..LANES {
                    reached[lane] |= reaches[lane];
                }
                if let Some(imaginary) = compiled.imaginary {
                    self.note_imaginary(manipulator, number, imaginary, reaches);
                    number += 1;
                }
            }
            for lane in 0..LANES {
                self.decided.missed[lane] |= (reached[lane] | open[lane]) ^ 1;
                self.decided.open[lane] |= open[lane];
            }
        }
        self.decided.imaginary.truncate(number);
    }

    /// Solves a branch of a leg. The status begins anew, and tells which poses the branch reaches within the leg's limits.
    // Inlined, it would be compiled once more in every task.
    #[inline(never)]
    pub fn reach(
        &mut self,
        manipulator: &Manipulator,
        leg: usize,
        branches: LegBranches,
        arch: Arch,
    ) {
        arch.dispatch(Reach { manipulator, leg, branches, arch, block: self });
    }

    /// Notes whether a leg's joints of a section are within their limits.
    #[inline(always)]
    pub fn admit(
        &mut self,
        manipulator: &Manipulator,
        leg: &CompiledLeg,
        section: Section,
        lanes: usize,
    ) {
        let found = match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        };
        for (coordinate, displacements) in
            leg.section(section).coordinates.iter().zip(&found.displacements)
        {
            if let Some(coordinate) = coordinate {
                let limits = &manipulator.limits[coordinate.number];
                section::admit(limits, displacements, &mut self.status.within_limits, lanes);
            }
        }
    }

    /// Notes the values of an imaginary joint as number `number` of those that are noted.
    #[inline(always)]
    fn note_imaginary(
        &mut self,
        manipulator: &Manipulator,
        number: usize,
        imaginary: usize,
        reaches: Mask,
    ) {
        let noted = &mut self.decided.imaginary;
        if number == noted.len() {
            noted.push(OfBranch { number: 0, reaches: Lanes::all(0), values: Lanes::all(0.0) });
        }
        let of_branch = &mut noted[number];
        (of_branch.number, of_branch.reaches) = (imaginary, reaches);
        section::imaginary(
            &manipulator.imaginary[imaginary],
            &self.tau,
            &mut of_branch.values,
            LANES,
        );
    }
}
