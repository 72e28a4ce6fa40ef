//! What rejects one pose.

use super::Cause;
use crate::sweep::Modes;
use opm_core::group::JointDisplacement;
use opm_core::manipulator::{AllModes, Manipulator, Mode, Section, Solution};

/// How a cause takes part in rejecting a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CauseRole {
    /// Without it, the pose would be reached.
    Alone,
    /// Other causes reject the pose too.
    WithOthers,
}

/// Every cause that there may be, and the modes in which poses are solved.
pub struct Causes<'a> {
    manipulator: &'a Manipulator,
    /// Each cause with its leg.
    all: Vec<(usize, Cause)>,
    /// The leg of each joint coordinate.
    legs: Vec<usize>,
    families: Vec<Family>,
    /// Whether any working mode counts.
    any_mode: bool,
}

/// Modes that give a pose the same dependent coordinates. There the joints of a leg depend on the choices of that leg
/// alone, so that one mode for each combination of them shows what every mode of the family does.
struct Family {
    /// The modes to solve.
    modes: Vec<Mode>,
    /// The part of each leg in each of them.
    parts: Vec<Vec<Mode>>,
}

impl Family {
    /// Every family of a manipulator.
    fn all(manipulator: &Manipulator) -> Vec<Self> {
        let mask = manipulator.pose_modes().fold(0, |mask, mode| mask | mode.bits());
        let of_legs: Vec<Vec<Mode>> = (0..manipulator.mechanism().legs.len())
            .map(|leg| manipulator.leg_modes(leg).filter(|mode| mode.bits() & mask == 0).collect())
            .collect();
        let most = of_legs.iter().map(Vec::len).max().unwrap_or(1);
        let parts = |number: usize| of_legs.iter().map(move |modes| modes[number % modes.len()]);
        let family = |common: Mode| Self {
            modes: (0..most).map(|number| parts(number).fold(common, Mode::with)).collect(),
            parts: (0..most)
                .map(|number| parts(number).map(|part| part.with(common)).collect())
                .collect(),
        };
        manipulator.pose_modes().map(family).collect()
    }

    fn of_one(manipulator: &Manipulator, mode: Mode) -> Self {
        Self { modes: vec![mode], parts: vec![vec![mode; manipulator.mechanism().legs.len()]] }
    }
}

/// What rejects a pose, and buffers to find it.
pub struct PoseCauses {
    solution: Solution,
    /// All modes of a pose, if any counts and differences of joints have limits.
    all: Option<AllModes>,
    /// The causes in each mode of a family.
    in_modes: Vec<Vec<usize>>,
    /// For each leg, the number of a mode of the family in which nothing of that leg rejects the pose.
    open: Vec<Option<usize>>,
    /// The part of each cause.
    parts: Vec<Option<CauseRole>>,
}

impl PoseCauses {
    /// The numbers of the causes, ascending, with their parts; none where the pose is reached.
    pub fn causes(&self) -> impl Iterator<Item = (usize, CauseRole)> + '_ {
        let parts = self.parts.iter().enumerate();
        parts.filter_map(|(number, part)| part.map(|part| (number, part)))
    }

    fn add(&mut self, cause: usize, part: CauseRole) {
        let known = &mut self.parts[cause];
        if *known != Some(CauseRole::Alone) {
            *known = Some(part);
        }
    }
}

impl<'a> Causes<'a> {
    pub fn new(manipulator: &'a Manipulator, modes: Modes) -> Self {
        let legs = manipulator.mechanism().legs.iter().enumerate();
        let legs: Vec<usize> = legs
            .flat_map(|(number, leg)| {
                let coordinates = leg.joints.iter().map(|joint| joint.coordinates.len()).sum();
                std::iter::repeat_n(number, coordinates)
            })
            .collect();
        let mut all = Vec::new();
        for leg in 0..manipulator.mechanism().legs.len() {
            let sections: &[Option<Section>] = match manipulator.is_whole() {
                true => &[None],
                false => &[Some(Section::Lower), Some(Section::Upper)],
            };
            all.extend(sections.iter().map(|&section| (leg, Cause::Reach(section))));
            for joint in (0..legs.len()).filter(|&joint| legs[joint] == leg) {
                let ends = [Cause::Lowest(joint), Cause::Highest(joint), Cause::Cone(joint)];
                all.extend(ends.map(|cause| (leg, cause)));
            }
            let differences = manipulator.differences().iter().enumerate();
            let own = differences.filter(|(_, difference)| difference.legs[0] == leg);
            all.extend(own.map(|(number, _)| (leg, Cause::Difference(number))));
        }
        let families = match modes {
            Modes::One(mode) => vec![Family::of_one(manipulator, mode)],
            Modes::Any => Family::all(manipulator),
        };
        Self { manipulator, all, legs, families, any_mode: modes.one().is_none() }
    }

    /// Each cause with its leg.
    pub fn all(&self) -> &[(usize, Cause)] {
        &self.all
    }

    /// Empty buffers.
    pub fn none(&self) -> PoseCauses {
        let most = self.families.iter().map(|family| family.modes.len()).max().unwrap_or(0);
        let tied = self.any_mode && !self.manipulator.differences().is_empty();
        PoseCauses {
            solution: self.manipulator.solution(),
            all: tied.then(|| self.manipulator.all_modes()),
            in_modes: vec![Vec::new(); most],
            open: vec![None; self.manipulator.mechanism().legs.len()],
            parts: vec![None; self.all.len()],
        }
    }

    /// Finds what rejects a pose of the grid.
    pub fn find(&self, pose: &[f64], found: &mut PoseCauses) {
        found.parts.fill(None);
        if self.combines(pose, found) {
            return;
        }
        for family in &self.families {
            if self.reached(family, pose, found) {
                found.parts.fill(None);
                return;
            }
        }
    }

    /// Whether a combination of the legs' choices, which differences of joints tie, reaches a pose.
    fn combines(&self, pose: &[f64], found: &mut PoseCauses) -> bool {
        let manipulator = self.manipulator;
        let Some(all) = &mut found.all else { return false };
        let reached = manipulator.inverse_all(pose, all).expect("a pose of the grid");
        let within = |all| manipulator.solution_within_limits(all, &mut found.solution).is_some();
        reached.is_some_and(within)
    }

    /// Whether a mode of a family reaches a pose. If none does, adds what rejects it.
    fn reached(&self, family: &Family, pose: &[f64], found: &mut PoseCauses) -> bool {
        found.open.fill(None);
        for (number, &mode) in family.modes.iter().enumerate() {
            let mut causes = std::mem::take(&mut found.in_modes[number]);
            self.in_mode(pose, mode, &mut found.solution, &mut causes);
            for (leg, open) in found.open.iter_mut().enumerate() {
                if causes.iter().all(|&cause| self.all[cause].0 != leg) {
                    *open = Some(number);
                }
            }
            let none = causes.is_empty();
            found.in_modes[number] = causes;
            if none {
                return true;
            }
        }
        let closed = found.open.iter().filter(|open| open.is_none()).count();
        if closed == 0 {
            // Each leg has its own mode in which it reaches the pose: put together, they are one more.
            let parts = found
                .open
                .iter()
                .enumerate()
                .filter_map(|(leg, open)| Some(family.parts[(*open)?][leg]));
            let mode = parts.fold(Mode::default(), Mode::with);
            let mut causes = Vec::new();
            self.in_mode(pose, mode, &mut found.solution, &mut causes);
            let part = if causes.len() == 1 { CauseRole::Alone } else { CauseRole::WithOthers };
            causes.iter().for_each(|&cause| found.add(cause, part));
            return causes.is_empty();
        }
        for number in 0..family.modes.len() {
            let causes = std::mem::take(&mut found.in_modes[number]);
            for &cause in &causes {
                let leg = self.all[cause].0;
                let same = |&&other: &&usize| self.all[other].0 == leg;
                let part = match (closed, causes.iter().filter(same).count()) {
                    (1, 1) => CauseRole::Alone,
                    _ => CauseRole::WithOthers,
                };
                if found.open[leg].is_none() {
                    found.add(cause, part);
                }
            }
            found.in_modes[number] = causes;
        }
        false
    }

    /// The numbers of the causes that reject a pose in one mode.
    fn in_mode(&self, pose: &[f64], mode: Mode, solution: &mut Solution, causes: &mut Vec<usize>) {
        causes.clear();
        let manipulator = self.manipulator;
        let number = |leg: usize, cause: Cause| {
            self.all.iter().position(|known| *known == (leg, cause)).unwrap_or_default()
        };
        let reached = manipulator.inverse(pose, mode, solution).expect("a pose of the grid");
        if reached.is_some_and(Solution::within_limits) {
            return;
        }
        for missed in solution.unreachable() {
            causes.push(number(missed.leg, Cause::Reach(missed.section)));
        }
        let tied = !manipulator.dependent_coordinates().is_empty() && !causes.is_empty();
        if tied && !matches!(manipulator.dependent_values(pose, mode), Ok(Some(_))) {
            // Without its dependent coordinates, the pose says nothing of the joints.
            return;
        }
        let closed = |leg: usize| solution.unreachable().iter().all(|missed| missed.leg != leg);
        let mut nearest = (f64::INFINITY, None);
        for (joint, limits) in manipulator.limits().iter().enumerate() {
            let leg = self.legs[joint];
            let value = solution.joints()[joint] - manipulator.coordinates()[joint].home;
            let (low, high) = limits.range();
            if !closed(leg) {
                continue;
            }
            let past = [(low - value, Cause::Lowest(joint)), (value - high, Cause::Highest(joint))];
            let (by, cause) = if past[0].0 > past[1].0 { past[0] } else { past[1] };
            if !limits.admits(JointDisplacement::Value(value)) {
                causes.push(number(leg, cause));
            } else if by.abs() < nearest.0 {
                nearest = (by.abs(), Some(number(leg, cause)));
            }
        }
        for (leg, joint) in manipulator.beyond_cones(solution.joints()) {
            if closed(leg) {
                causes.push(number(leg, Cause::Cone(joint)));
            }
        }
        for number_of in manipulator.beyond_differences(solution.joints()) {
            let [leg, other] = manipulator.differences()[number_of].legs;
            if closed(leg) && closed(other) {
                causes.push(number(leg, Cause::Difference(number_of)));
            }
        }
        if causes.is_empty() {
            // It is past a limit by rounding of an angle alone.
            causes.extend(nearest.1);
        }
    }
}
