//! Which of many poses are in reach within all limits, in one working mode or in any: the steps of
//! [`Manipulator::inverse_many`] without the joints' values.

use super::lanes::{BranchesOfLeg, Column, LANES, Lanes, Mask};
use super::{Block, Status, section};
use crate::manipulator::{Choices, CompiledLeg, Dependent, LegBranches, Manipulator, Mode};
use crate::mechanism::leg::Section;
use pulp::{Arch, Simd, WithSimd};

/// What is known of the poses of a block.
#[derive(Clone, Debug)]
pub struct Decided {
    /// Whether a pose is certainly out of reach, or beyond limits, in every mode asked for.
    pub missed: Mask,
    /// Whether a pose has to be decided by itself.
    pub open: Mask,
    /// The imaginary joints of the branches of every leg.
    pub imaginary: Vec<OfBranch>,
}

/// The imaginary joint of one branch of a leg.
#[derive(Clone, Debug)]
pub struct OfBranch {
    /// The number of the imaginary joint.
    pub number: usize,
    /// Whether the branch reaches a pose within the leg's limits.
    pub reaches: Mask,
    pub values: Column,
}

impl Decided {
    pub fn new() -> Self {
        Self { missed: Lanes::all(0), open: Lanes::all(0), imaginary: Vec::new() }
    }
}

impl Manipulator {
    /// Whether many poses are solved together: legs are split, and their chains are the same at all poses.
    pub(crate) fn decides_many(&self) -> bool {
        let plain = self.lifts_straight() && !self.task.shares_height() && !self.is_whole();
        plain && !self.shares_limits()
    }

    /// Whether many poses are decided together: also where legs are solved whole, and decide without joints that are not
    /// limited.
    pub(crate) fn decides_reach(&self) -> bool {
        self.decides_many() || self.reaches_whole()
    }

    /// Whether legs are solved whole, and decide without joints that are not limited, at coordinates that are all given.
    pub(crate) fn reaches_whole(&self) -> bool {
        let reaches = |leg: &CompiledLeg| leg.whole.as_ref().is_some_and(|leg| leg.reach.is_some());
        self.is_whole() && self.dependent.is_none() && self.legs.iter().all(reaches)
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
}

/// Solves a branch of a leg, and finds out whether its joints are within their limits, with the instructions of the
/// processor at hand.
struct ReachLeg<'a> {
    manipulator: &'a Manipulator,
    leg: usize,
    branches: LegBranches,
    arch: Arch,
    block: &'a mut Block,
}

impl WithSimd for ReachLeg<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, leg, branches, arch, block } = self;
        block.status = Status::UNKNOWN;
        if let Some(whole) = &manipulator.legs[leg].whole {
            block.reach_whole(manipulator, whole, branches);
            return;
        }
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
        self.block.decide_with(self.manipulator, self.choices, self.arch);
    }
}

impl Block {
    /// Decides a displaced block.
    pub fn decide(&mut self, manipulator: &Manipulator, choices: Choices, arch: Arch) {
        arch.dispatch(Decide { manipulator, choices, arch, block: self });
    }

    #[inline(always)]
    fn decide_with(&mut self, manipulator: &Manipulator, choices: Choices, arch: Arch) {
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
            // A leg that is solved whole takes long.
            if compiled.whole.is_some() && self.decided.missed.iter().all(|&missed| missed == 1) {
                break;
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
        arch.dispatch(ReachLeg { manipulator, leg, branches, arch, block: self });
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
