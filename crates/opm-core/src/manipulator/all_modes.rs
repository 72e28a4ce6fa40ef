//! Inverse kinematics in every working mode: each choice of each leg is solved once, and the modes combine them.

use super::angles::Angles;
use super::inverse::{AngleOf, Revolutions};
use super::leg::{CompiledLeg, LegSolution};
use super::mode::Choices;
use super::pose::PoseError;
use super::solution::{Solution, SolvedPose, Unreachable};
use super::{Dependent, Manipulator, Mode};
use pulp::{Simd, WithSimd};

/// Every leg's solutions at one pose. [`Manipulator::all_modes`] makes a buffer of this type.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let (mut every, mut buffer) = (manipulator.all_modes(), manipulator.solution());
/// let pose = manipulator.pose([("theta", 0.1)])?;
/// let found = manipulator.inverse_all(&pose, &mut every)?.expect("a pose in reach");
/// for mode in found.modes(&manipulator) {
///     let joints = manipulator.solution_in_mode(found, mode, &mut buffer).expect("it is listed");
///     println!("{}: {:?}", manipulator.format_mode(mode), joints.joints());
/// }
/// assert_eq!(found.modes(&manipulator).count(), 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct AllModes {
    /// One for each combination of the choices of dependent coordinates: one where all are independent.
    completions: Vec<Completion>,
}

/// The solutions of the legs at a pose with its dependent coordinates.
#[derive(Clone, Debug)]
struct Completion {
    solved: SolvedPose,
    /// The leg whose constraint has no solution, if there is one.
    missed: Option<Unreachable>,
    legs: Vec<LegModes>,
}

/// A leg's solutions in the order of [`super::mode::ModeLayout::of_leg`].
#[derive(Clone, Debug)]
struct LegModes {
    /// They have a meaning where the outcome is `Ok`.
    solutions: [LegSolution; 4],
    /// `None` for combinations that the leg does not have, and before the first pose.
    outcomes: [Option<Result<(), Unreachable>>; 4],
}

impl Manipulator {
    /// A buffer for [`Manipulator::inverse_all`].
    pub fn all_modes(&self) -> AllModes {
        let count = self.dependent.as_ref().map_or(1, Dependent::combinations);
        let leg = LegModes { solutions: [LegSolution::HOME; 4], outcomes: [None; 4] };
        let legs = vec![leg; self.legs.len()];
        let completion = Completion { solved: self.solved_at_home(), missed: None, legs };
        AllModes { completions: vec![completion; count] }
    }

    /// Every working mode at a pose; `None` where it is out of reach in all of them. Then
    /// [`AllModes::modes`] lists those that reach it, and [`Manipulator::solution_in_mode`] gives the
    /// joints in one.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    pub fn inverse_all<'a>(
        &self,
        pose: &[f64],
        buffer: &'a mut AllModes,
    ) -> Result<Option<&'a AllModes>, PoseError> {
        self.check_pose(pose)?;
        for (number, completion) in buffer.completions.iter_mut().enumerate() {
            let Completion { solved, missed, legs } = completion;
            legs.iter_mut().for_each(|leg| leg.outcomes = [None; 4]);
            let wanted =
                self.dependent.as_ref().map_or_else(Choices::default, |d| d.choices(number));
            *missed = None;
            match &self.dependent {
                None => solved.pose.copy_from_slice(pose),
                Some(dependent) => {
                    let all = &mut solved.pose;
                    *missed = dependent.complete_from_home(self, wanted.chosen, pose, all).err();
                }
            }
            if missed.is_some() {
                continue;
            }
            self.arch.dispatch(SolveChoices { manipulator: self, completion, wanted });
        }
        Ok(buffer.reached().then_some(buffer))
    }

    /// The joints in one working mode at the pose of `all`, angles within half a revolution of home;
    /// `None` where the pose is out of reach in that mode ([`Solution::unreachable`] of the buffer lists
    /// the legs), or where `all` does not hold a pose yet.
    pub fn solution_in_mode<'a>(
        &self,
        all: &AllModes,
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Option<&'a Solution> {
        buffer.unreachable.clear();
        buffer.within_limits = true;
        let completion = &all.completions[self.completion(mode)];
        if let Some(missed) = completion.missed {
            buffer.unreachable.push(missed);
            return None;
        }
        let near = Revolutions::NearHome;
        let mut angles = Angles::new(AngleOf::Leg(0));
        for (number, modes) in completion.legs.iter().enumerate() {
            match modes.get(self.modes.of_leg(mode, number)) {
                Some(Ok(solution)) => {
                    buffer.legs[number] = *solution;
                    self.write(number, buffer, near, &mut angles);
                }
                Some(Err(unreachable)) => buffer.unreachable.push(unreachable),
                None => return None,
            }
        }
        angles.answer(|of, angle| self.take(of, angle, buffer, near));
        let SolvedPose { pose, v, b } = &completion.solved;
        buffer.solved.pose.copy_from_slice(pose);
        (buffer.solved.v, buffer.solved.b) = (*v, *b);
        self.divide(buffer);
        self.write_lifts(buffer);
        self.test_shared_limits(buffer);
        buffer.reached()
    }

    /// The number of the combination of choices of dependent coordinates in a mode.
    fn completion(&self, mode: Mode) -> usize {
        self.dependent.as_ref().map_or(0, |dependent| dependent.combination(mode))
    }

    /// The first working mode, all-plus first, that reaches the pose of `all` within the limits, and
    /// the joints in it; `None` where there is none.
    pub fn solution_within_limits<'a>(
        &self,
        all: &AllModes,
        buffer: &'a mut Solution,
    ) -> Option<(Mode, &'a Solution)> {
        let first = (all.completions.iter().enumerate())
            .filter(|(_, completion)| completion.missed.is_none())
            .find_map(|(number, completion)| match self.differences.is_empty() {
                true => self.first_within_limits(number, completion),
                false => self.combinations_within_limits(all, number, buffer).first().copied(),
            })?;
        self.solution_in_mode(all, first, buffer).map(|solution| (first, solution))
    }

    /// The first mode with the legs within their limits, and with one combination of choices of dependent
    /// coordinates.
    fn first_within_limits(&self, number: usize, completion: &Completion) -> Option<Mode> {
        let mut first = self.dependent.as_ref().map_or(Mode::default(), |d| d.mode(number));
        let rise = self.task.rise(&completion.solved.pose);
        for (number, (leg, modes)) in self.legs.iter().zip(&completion.legs).enumerate() {
            let within = |solution: &LegSolution| self.admits(leg, solution, rise);
            // Legs share no choices, so that the first mode consists of the first choices of each leg.
            let mode = (self.modes.leg_modes(number).enumerate())
                .find(|&(part, _)| modes.solution(part).is_some_and(within))?
                .1;
            first.0 |= mode.0;
        }
        Some(first)
    }
}

impl Manipulator {
    /// The modes of each leg in which it is within its own limits at a completion.
    fn legs_within_limits(&self, completion: &Completion) -> Vec<Vec<Mode>> {
        let rise = self.task.rise(&completion.solved.pose);
        let legs = self.legs.iter().zip(&completion.legs).enumerate();
        legs.map(|(number, (leg, modes))| {
            let within = |solution: &LegSolution| self.admits(leg, solution, rise);
            let own = self.modes.leg_modes(number).enumerate();
            let own = own.filter(|&(part, _)| modes.solution(part).is_some_and(within));
            own.map(|(_, mode)| mode).collect()
        })
        .collect()
    }

    /// The modes, with one combination of choices of dependent coordinates, in which a pose is within all limits, those of
    /// differences too ([`Manipulator::combined`]).
    fn combinations_within_limits(
        &self,
        all: &AllModes,
        number: usize,
        buffer: &mut Solution,
    ) -> Vec<Mode> {
        let common = self.dependent.as_ref().map_or(Mode::default(), |d| d.mode(number));
        let of_legs = self.legs_within_limits(&all.completions[number]);
        self.combined(&of_legs, common, |mode| {
            let found = self.solution_in_mode(all, mode, buffer);
            found.is_some_and(|at| self.beyond_differences(at.joints()).next().is_none())
        })
    }
}

impl Completion {
    /// The legs that no choice closes, with the deficit of the first one.
    fn open_legs(&self) -> impl Iterator<Item = Unreachable> + '_ {
        let open = self.legs.iter().filter(|leg| !leg.outcomes.contains(&Some(Ok(()))));
        open.filter_map(|leg| leg.outcomes.iter().flatten().find_map(|outcome| outcome.err()))
    }
}

impl LegModes {
    /// The outcome of a combination.
    fn get(&self, part: usize) -> Option<Result<&LegSolution, Unreachable>> {
        self.outcomes[part].map(|outcome| outcome.map(|()| &self.solutions[part]))
    }

    /// The solution of a combination that closes the leg.
    fn solution(&self, part: usize) -> Option<&LegSolution> {
        self.get(part).and_then(Result::ok)
    }
}

/// Solves every leg at the pose of a completion, for all of its choices that are wanted, with the instructions of the
/// processor at hand.
struct SolveChoices<'a> {
    manipulator: &'a Manipulator,
    completion: &'a mut Completion,
    wanted: Choices,
}

impl WithSimd for SolveChoices<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, completion, wanted } = self;
        let Manipulator { task, modes, .. } = manipulator;
        let Completion { solved, legs, .. } = completion;
        (solved.v, solved.b) = task.sections(&solved.pose);
        let rise = task.rise(&solved.pose);
        for (number, (leg, found)) in manipulator.legs.iter().zip(legs).enumerate() {
            let pose = [&solved.v, &solved.b];
            let missed = |(section, deficit)| {
                let section = leg.named(section);
                Unreachable { leg: number, section, deficit }
            };
            // On both branches of the section that is solved second, the other one is the same.
            let mut of_first = [None; 2];
            for (part, mode) in modes.chosen_leg_modes(wanted, number) {
                let branches = modes.branches(mode, number);
                let first = &mut of_first[branches.of(leg.split_section) as usize];
                // Closures would not be inlined, and would not have the processor's instructions.
                let mut outcome = match *first {
                    Some((earlier, outcome)) => {
                        found.solutions[part] = found.solutions[earlier];
                        outcome
                    }
                    None => leg.solve_first(pose, branches, 0.0, &mut found.solutions[part]),
                };
                *first = Some((part, outcome));
                if outcome.is_ok() {
                    let solution = &mut found.solutions[part];
                    outcome = leg.solve_second(task, pose, rise, branches, 0.0, solution);
                }
                found.outcomes[part] = Some(outcome.map_err(missed));
            }
        }
    }
}

impl AllModes {
    /// Whether any mode reaches the pose.
    fn reached(&self) -> bool {
        self.completions.iter().any(|c| c.missed.is_none() && c.open_legs().next().is_none())
    }

    /// The legs that are out of reach in every mode; empty where the pose is in reach.
    pub fn unreachable(&self) -> impl Iterator<Item = Unreachable> + '_ {
        let missing = !self.reached();
        let completed = self.completions.iter().find(|c| c.missed.is_none());
        let missed = self.completions[0].missed.filter(|_| missing && completed.is_none());
        let open = completed.filter(|_| missing).into_iter().flat_map(Completion::open_legs);
        missed.into_iter().chain(open)
    }

    /// The modes in which the pose is in reach, all-plus first.
    pub fn modes<'a>(&'a self, manipulator: &'a Manipulator) -> impl Iterator<Item = Mode> + 'a {
        manipulator.modes().filter(move |&mode| self.reached_in(manipulator, mode))
    }

    /// Whether any mode reaches the pose within the limits. `used` is called with the number and the value
    /// of the imaginary joints in all these modes.
    pub fn within_limits_in_any(
        &self,
        manipulator: &Manipulator,
        mut used: impl FnMut(usize, f64),
    ) -> bool {
        if !manipulator.differences.is_empty() {
            return self.within_differences_in_any(manipulator, used);
        }
        let mut reached = false;
        for completion in self.completions.iter().filter(|c| c.missed.is_none()) {
            let rise = manipulator.task.rise(&completion.solved.pose);
            let within = |(leg, modes): (&CompiledLeg, &LegModes)| {
                [0, 1, 2, 3].map(|part| {
                    let solution = modes.solution(part);
                    solution.filter(|solution| manipulator.admits(leg, solution, rise)).copied()
                })
            };
            let legs = || manipulator.legs.iter().zip(&completion.legs);
            if !legs().all(|leg| within(leg).iter().any(Option::is_some)) {
                continue;
            }
            reached = true;
            for leg in legs() {
                let Some(imaginary) = leg.0.imaginary else { continue };
                let joint = &manipulator.imaginary[imaginary];
                for solution in within(leg).iter().flatten() {
                    used(imaginary, joint.value(solution.tau, joint.home));
                }
            }
        }
        reached
    }

    /// The same where differences of joints tie the legs.
    fn within_differences_in_any(
        &self,
        manipulator: &Manipulator,
        mut used: impl FnMut(usize, f64),
    ) -> bool {
        let (mut reached, mut buffer) = (false, manipulator.solution());
        for (number, completion) in self.completions.iter().enumerate() {
            if completion.missed.is_some() {
                continue;
            }
            let modes = manipulator.combinations_within_limits(self, number, &mut buffer);
            reached |= !modes.is_empty();
            let of_legs = manipulator.legs_within_limits(completion);
            // A leg that has no part in a difference has each of its own modes.
            let tied = |leg: usize| manipulator.differences.iter().any(|d| d.legs.contains(&leg));
            let untied = (0..of_legs.len()).filter(|leg| !modes.is_empty() && !tied(*leg));
            let own = untied.flat_map(|leg| of_legs[leg].iter().map(move |mode| (leg, *mode)));
            let combined =
                modes.iter().flat_map(|mode| (0..of_legs.len()).map(move |leg| (leg, *mode)));
            for (leg, mode) in own.chain(combined) {
                let Some(imaginary) = manipulator.legs[leg].imaginary else { continue };
                let part = manipulator.modes.of_leg(mode, leg);
                if let Some(solution) = completion.legs[leg].solution(part) {
                    let joint = &manipulator.imaginary[imaginary];
                    used(imaginary, joint.value(solution.tau, joint.home));
                }
            }
        }
        reached
    }

    /// Whether the pose is in reach in a mode.
    fn reached_in(&self, manipulator: &Manipulator, mode: Mode) -> bool {
        let layout = &manipulator.modes;
        let completion = &self.completions[manipulator.completion(mode)];
        let mut legs = completion.legs.iter().enumerate();
        completion.missed.is_none()
            && legs.all(|(number, leg)| leg.solution(layout.of_leg(mode, number)).is_some())
    }
}
