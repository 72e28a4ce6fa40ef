//! The dependent coordinates of a pose, step by step from its independent ones.

use super::constraint::{Constraint, follows, target_of};
use super::{Closed, Dependent, OBEYED, Whole};
use crate::chain::ReachDeficit;
use crate::group::JointDisplacement;
use crate::manipulator::inverse::Revolutions;
use crate::manipulator::leg::Section;
use crate::manipulator::{Manipulator, Mode, PoseError, Solution, Unreachable};
use crate::numeric::Quantity;
use crate::task::{CoordinateKind, TaskCoordinate};

impl Dependent {
    /// Writes values of the independent coordinates to their places among all.
    pub fn spread(&self, independent: &[f64], all: &mut [f64]) {
        self.independent.iter().zip(independent).for_each(|(&i, value)| all[i] = *value);
    }

    /// Writes all coordinates of a pose in a mode to `all`, from its independent ones; angles within π of home.
    ///
    /// # Errors
    /// The leg whose constraint no value of the dependent coordinates satisfies.
    pub fn complete_from_home(
        &self,
        manipulator: &Manipulator,
        mode: Mode,
        independent: &[f64],
        all: &mut [f64],
    ) -> Result<(), Unreachable> {
        all.copy_from_slice(&manipulator.home);
        self.spread(independent, all);
        self.complete(manipulator, mode, all)
    }

    /// Computes the dependent coordinates of a pose, whose independent ones are given, in a mode. Angles, and
    /// coordinates that nothing determines, are those nearest to what `pose` holds.
    ///
    /// # Errors
    /// The leg whose constraint no value of the dependent coordinates satisfies.
    pub fn complete(
        &self,
        manipulator: &Manipulator,
        mode: Mode,
        pose: &mut [f64],
    ) -> Result<(), Unreachable> {
        if let Some(whole) = &self.whole {
            let missed = |deficit| Unreachable { leg: whole.leg(), section: None, deficit };
            let found = match whole {
                Whole::Stem(stem) => stem.complete(manipulator.task(), mode, pose),
                Whole::Rows(rows) => rows.complete(manipulator, mode, pose),
                Whole::Mirror(mirror) => mirror.complete(manipulator.task(), pose),
            };
            return found.map_err(missed);
        }
        for step in &self.steps {
            let sign = step.sign(mode);
            let (leg, section) = (step.solution.leg(), step.solution.section());
            let missed = |deficit| Unreachable { leg, section: Some(section), deficit };
            match &step.solution {
                Closed::Constant { coordinates, .. } => {
                    for &coordinate in coordinates {
                        pose[coordinate] = manipulator.task().coordinates[coordinate].home;
                    }
                }
                Closed::Condition { constraint, coordinate, function } => {
                    let tau = manipulator.tau_before(leg, section, pose, mode)?;
                    let task = manipulator.task();
                    let target =
                        |pose: &[f64]| target_of(task, &manipulator.legs[leg], section, tau, pose);
                    let places = function.places();
                    let values = constraint.values(places, *coordinate, pose, target);
                    pose[*coordinate] = function
                        .zero(values, sign, pose[*coordinate])
                        .map_err(|value| missed(constraint.condition.deficit(value)))?;
                }
                Closed::Joint(joint) => {
                    let tau = manipulator.tau_before(leg, section, pose, mode)?;
                    let mut at = [0.0; 3];
                    at.iter_mut().zip(&joint.all).for_each(|(at, &i)| *at = pose[i]);
                    let found = joint.solve(manipulator, tau, sign, at).map_err(missed)?;
                    joint.all.iter().zip(found).for_each(|(&i, value)| pose[i] = value);
                }
            }
        }
        for check in &self.checks {
            let Constraint { leg, section, condition } = *check;
            let tau = manipulator.tau_before(leg, section, pose, mode)?;
            let legs = &manipulator.legs;
            let target = target_of(manipulator.task(), &legs[leg], section, tau, pose);
            let value = condition.value(&target);
            let deficit = condition.deficit(value);
            let unit = if deficit.quantity == Quantity::Length { self.size } else { 1.0 };
            if deficit.excess > OBEYED * unit {
                return Err(Unreachable { leg, section: Some(section), deficit });
            }
        }
        Ok(())
    }

    /// Chooses, among the angles with which all coordinates of a pose describe the same displacement, those that belong to a
    /// mode: in the other ones the dependent coordinates may follow on another branch. Without a mode, they are those nearest
    /// to home where a condition decides the branch.
    pub fn choose_angles(&self, manipulator: &Manipulator, mode: Option<Mode>, all: &mut [f64]) {
        if let (Some(_), Some(mode)) = (&self.whole, mode) {
            return self.choose_followed(manipulator, mode, all);
        }
        for step in &self.steps {
            let sign = step.sign(mode.unwrap_or(manipulator.home_mode()));
            match (&step.solution, mode) {
                (Closed::Joint(joint), _) => joint.choose_angles(manipulator, sign, all),
                (Closed::Condition { constraint, coordinate, function }, Some(mode))
                    if step.bit.is_some() =>
                {
                    let Constraint { leg, section, .. } = *constraint;
                    let Ok(tau) = manipulator.tau_before(leg, section, all, mode) else { continue };
                    let task = manipulator.task();
                    let target =
                        |pose: &[f64]| target_of(task, &manipulator.legs[leg], section, tau, pose);
                    let values = constraint.values(function.places(), *coordinate, all, target);
                    // It rises in the one where it falls in the other, if the second angle follows from it.
                    if sign * function.slope_at(values, all[*coordinate]) < 0.0 {
                        task.take_other_angles(*coordinate, all);
                    }
                }
                _ => {}
            }
        }
    }

    /// The same where legs are solved whole: the angles from which the others follow in a mode.
    fn choose_followed(&self, manipulator: &Manipulator, mode: Mode, all: &mut [f64]) {
        let task = manipulator.task();
        let second = |c: &TaskCoordinate| {
            matches!(c.kind(), CoordinateKind::Xi | CoordinateKind::Tilt | CoordinateKind::Pitch)
        };
        let Some(second) = task.coordinates.iter().position(second) else { return };
        let target = task.displacement(all);
        for _ in 0..2 {
            let mut followed = all.to_vec();
            let found = self.complete(manipulator, mode, &mut followed);
            let there = task.displacement(&followed);
            if found.is_ok() && manipulator.apart(&there, &target) < OBEYED {
                return;
            }
            // The second time, these are the first ones again.
            task.take_other_angles(second, all);
        }
    }

    /// Writes the independent coordinates among all of a pose.
    pub fn write_independent(&self, all: &[f64], pose: &mut Vec<f64>) {
        pose.clear();
        pose.extend(self.independent.iter().map(|&i| all[i]));
    }

    /// Writes the independent and the dependent coordinates to their places among all.
    pub fn merge(&self, [independent, others]: [&[f64]; 2], all: &mut [f64]) {
        self.spread(independent, all);
        self.coordinates.iter().zip(others).for_each(|(&i, value)| all[i] = *value);
    }

    /// The dependent coordinates among all of a pose.
    pub fn values(&self, all: &[f64]) -> impl Iterator<Item = f64> {
        self.coordinates.iter().map(|&i| all[i])
    }
}

impl Manipulator {
    /// The dependent coordinates of a pose in a mode, in the order of [`Manipulator::dependent_coordinates`], radians
    /// and metres, angles within π of home; `None` where they have no solution. Other legs may be out of reach.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// // The place of the hand tells the angle of the right forearm.
    /// let manipulator = Manipulator::example("five-bar")?;
    /// let mode = manipulator.home_mode();
    /// let theta = manipulator.dependent_values(&manipulator.home_pose(), mode)?.expect("in reach");
    /// assert!(theta[0].abs() < 1e-12, "angles are zero at home");
    /// // The right arm is 445 mm long.
    /// assert_eq!(manipulator.dependent_values(&[0.0, 0.5], mode)?, None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn dependent_values(
        &self,
        pose: &[f64],
        mode: Mode,
    ) -> Result<Option<Vec<f64>>, PoseError> {
        self.check_pose(pose)?;
        let Some(dependent) = &self.dependent else { return Ok(Some(Vec::new())) };
        let found = self.completed(pose, mode).ok();
        Ok(found.map(|all| dependent.coordinates.iter().map(|&i| all[i]).collect()))
    }

    /// All coordinates of a pose in a mode, dependent ones too; angles within π of home.
    ///
    /// # Errors
    /// The leg whose constraint has no solution.
    pub(crate) fn completed(&self, pose: &[f64], mode: Mode) -> Result<Vec<f64>, Unreachable> {
        let Some(dependent) = &self.dependent else { return Ok(pose.to_vec()) };
        let mut all = self.home.clone();
        dependent.complete_from_home(self, mode, pose, &mut all)?;
        Ok(all)
    }

    /// The independent coordinates among all of a pose, with the angles of a mode.
    pub(crate) fn independent_in(&self, all: &[f64], mode: Mode) -> Vec<f64> {
        let (mut all, mut pose) = (all.to_vec(), Vec::with_capacity(self.independent.len()));
        self.write_independent(Some(mode), &mut all, &mut pose);
        pose
    }

    /// Writes them to a buffer, with the angles of a mode: see [`Dependent::choose_angles`]. In `all`, these replace others of
    /// the same displacement.
    pub(crate) fn write_independent(
        &self,
        mode: Option<Mode>,
        all: &mut [f64],
        pose: &mut Vec<f64>,
    ) {
        match &self.dependent {
            None => {
                pose.clear();
                pose.extend_from_slice(all);
            }
            Some(dependent) => {
                dependent.choose_angles(self, mode, all);
                dependent.write_independent(all, pose);
            }
        }
    }

    /// The same for a mechanism with dependent coordinates.
    #[cold]
    pub(in crate::manipulator) fn displace_dependent(
        &self,
        pose: &[f64],
        mode: Mode,
        out: &mut Solution,
        revolutions: Revolutions,
    ) -> bool {
        let Some(dependent) = &self.dependent else { return true };
        let all = &mut out.solved.pose;
        if revolutions == Revolutions::NearHome {
            all.copy_from_slice(&self.home);
        }
        dependent.spread(pose, all);
        out.unreachable.clear();
        out.unreachable.extend(dependent.complete(self, mode, all).err());
        (out.solved.v, out.solved.b) = self.task.sections(all);
        self.divide(out);
        out.unreachable.is_empty()
    }

    /// Copies the independent and the dependent coordinates of the solved pose.
    pub(in crate::manipulator) fn divide(&self, out: &mut Solution) {
        let Some(dependent) = &self.dependent else { return };
        let [independent, others] = &mut out.parts;
        let all = &out.solved.pose;
        independent.iter_mut().zip(&dependent.independent).for_each(|(q, &i)| *q = all[i]);
        others.iter_mut().zip(&dependent.coordinates).for_each(|(q, &i)| *q = all[i]);
    }
}

impl Manipulator {
    /// The displacement τ of a leg along the intersection motion, where that follows from the section other than
    /// this one; zero otherwise.
    ///
    /// # Errors
    /// The other section is out of reach.
    fn tau_before(
        &self,
        number: usize,
        section: Section,
        pose: &[f64],
        mode: Mode,
    ) -> Result<JointDisplacement, Unreachable> {
        let leg = &self.legs[number];
        if !follows(self.task(), leg, section) {
            return Ok(JointDisplacement::Value(0.0));
        }
        let bridge = leg.split_section;
        let missed =
            |deficit: ReachDeficit| Unreachable { leg: number, section: Some(bridge), deficit };
        let (task, branches) = (self.task(), self.branches(mode, number));
        let leg = leg.at(task.rise(pose)).map_err(|(_, deficit)| missed(deficit))?;
        match bridge {
            Section::Lower => {
                let v = task.lower(pose);
                let displacements = leg.lower.inverse(&v, branches.lower).map_err(missed)?;
                Ok(leg.unwound(leg.step(&displacements), 0.0).inverse())
            }
            Section::Upper => {
                let b = task.upper(&pose[task.lower_count..]);
                let displacements = leg.upper.inverse(&b, branches.upper).map_err(missed)?;
                Ok(leg.unwound(leg.step(&displacements), 0.0))
            }
        }
    }
}
