//! Candidates of the search: poses and working modes. They are checked together, by inverse kinematics of many poses at
//! once, which give the actuated joints back.

use super::accept::{APART, AssemblyPlace, MATCH, Solved};
use super::matches::Matches;
use super::search::{Memory, Search};
use crate::group::Displacement;
use crate::manipulator::{Batch, BatchOutput, Dependent, Manipulator, Mode, Solution};
use crate::numeric::Quantity;
use nalgebra::Isometry3;
use std::f64::consts::TAU;

/// The candidates that the search has found, one row for each working mode of a pose.
#[derive(Clone, Debug)]
pub(super) struct Candidates {
    /// The independent task coordinates, row after row, metres and radians.
    poses: Vec<f64>,
    /// All task coordinates where some are dependent, row after row, metres and radians.
    all: Vec<f64>,
    /// The working mode of each row.
    modes: Vec<Mode>,
    /// The number of poses that were begun.
    begun: usize,
    /// The number of each row's pose.
    numbers: Vec<usize>,
    /// The platform's displacement from home in each row.
    targets: Vec<Isometry3<f64>>,
    /// The results of inverse kinematics, row after row: see [`BatchOutput`].
    joints: Vec<f64>,
    imaginary: Vec<f64>,
    reachable: Vec<bool>,
    within_limits: Vec<bool>,
    /// The largest error of an actuated joint of each row, in radians or shares of the size.
    errors: Vec<f64>,
    /// The closure error of each row.
    residuals: Vec<f64>,
    /// The memory of inverse kinematics.
    solution: Solution,
    batch: Option<Batch>,
    /// For every actuated coordinate, whether it is an angle modulo 2π.
    modulo: Vec<bool>,
}

impl Candidates {
    /// A buffer.
    pub fn new(manipulator: &Manipulator) -> Self {
        /// As many as most mechanisms have.
        const ROWS: usize = 16;
        Self {
            poses: Vec::with_capacity(ROWS * manipulator.task_coordinates().len()),
            all: Vec::new(),
            modes: Vec::with_capacity(ROWS),
            begun: 0,
            numbers: Vec::with_capacity(ROWS),
            targets: Vec::with_capacity(ROWS),
            joints: Vec::new(),
            imaginary: Vec::new(),
            reachable: Vec::new(),
            within_limits: Vec::new(),
            errors: Vec::new(),
            residuals: Vec::new(),
            solution: manipulator.solution(),
            batch: None,
            modulo: manipulator.modulo_revolutions(),
        }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.poses.clear();
        self.all.clear();
        self.modes.clear();
        self.begun = 0;
        self.numbers.clear();
        self.targets.clear();
    }

    /// Notes a working mode of the pose that was begun last.
    fn note(&mut self, place: AssemblyPlace<'_>) {
        let AssemblyPlace { pose, all, target, mode } = place;
        self.poses.extend_from_slice(pose);
        if all.len() > pose.len() {
            self.all.extend_from_slice(all);
        }
        self.modes.push(mode);
        self.numbers.push(self.begun);
        self.targets.push(*target);
    }

    /// Solves inverse kinematics for all rows.
    fn solve(&mut self, manipulator: &Manipulator) {
        let rows = self.modes.len();
        self.joints.resize(rows * manipulator.coordinates().len(), f64::NAN);
        self.imaginary.resize(rows * manipulator.imaginary().len(), f64::NAN);
        self.reachable.resize(rows, false);
        self.within_limits.resize(rows, false);
        let mut out = BatchOutput {
            joints: &mut self.joints,
            imaginary: &mut self.imaginary,
            reachable: &mut self.reachable,
            within_limits: &mut self.within_limits,
        };
        let memory = (&mut self.solution, &mut self.batch);
        manipulator
            .inverse_each_in(&self.poses, &self.modes, memory, &mut out)
            .expect("poses that were checked");
    }

    /// Computes the largest error of an actuated joint of every row, which is infinite for a pose that is out of reach.
    /// `wanted` has the displacements from home that the actuated joints should have, radians and metres.
    fn measure(&mut self, manipulator: &Manipulator, wanted: &[f64]) {
        let error = |joints: &[f64]| {
            let mut largest = 0.0;
            let values = manipulator.actuated().iter().zip(wanted).zip(&self.modulo);
            for ((&coordinate, wanted), &modulo) in values {
                let value = joints[coordinate];
                let error = manipulator.actuated_error(coordinate, value, *wanted, modulo);
                largest = f64::max(largest, error);
            }
            largest
        };
        let rows = self.joints.chunks(manipulator.coordinates().len()).zip(&self.reachable);
        self.errors.clear();
        self.errors.extend(rows.map(|(joints, reachable)| match reachable {
            true => error(joints),
            false => f64::INFINITY,
        }));
    }

    /// Gives the actuated joints their values, and computes the closure errors.
    fn close(&mut self, manipulator: &Manipulator, wanted: &[f64]) {
        for joints in self.joints.chunks_mut(manipulator.coordinates().len()) {
            manipulator.set_actuated(wanted, joints);
        }
        manipulator.closure.write_residuals(&self.joints, &self.targets, &mut self.residuals);
    }

    /// A row as an assembly.
    fn row(&self, manipulator: &Manipulator, row: usize) -> (AssemblyPlace<'_>, Solved<'_>) {
        let of = |values, width| row_of(values, width, row);
        let pose = of(&self.poses, manipulator.task_coordinates().len());
        let place = AssemblyPlace {
            pose,
            all: match manipulator.dependent {
                None => pose,
                Some(_) => of(&self.all, manipulator.task().coordinates.len()),
            },
            target: &self.targets[row],
            mode: self.modes[row],
        };
        let solved = Solved {
            joints: of(&self.joints, manipulator.coordinates().len()),
            imaginary: of(&self.imaginary, manipulator.imaginary().len()),
            within_limits: self.within_limits[row],
        };
        (place, solved)
    }

    /// Whether another row is the same solution as one, near a singularity, and is preferred: its error is smaller, or it
    /// was found before.
    fn has_better(&self, manipulator: &Manipulator, row: usize) -> bool {
        let of_pose = |other: &usize| self.numbers[*other] == self.numbers[row];
        let better = |&other: &usize| (self.errors[other], other) < (self.errors[row], row);
        let before = (0..row).rev().take_while(of_pose);
        let after = (row + 1..self.modes.len()).take_while(of_pose);
        let coordinates = manipulator.coordinates();
        let joints = |row| row_of(&self.joints, coordinates.len(), row);
        let same = |other: usize| {
            let values = joints(row).iter().zip(joints(other)).enumerate();
            values.into_iter().all(|(coordinate, (one, other))| {
                let mut off = (one - other).abs();
                if coordinates[coordinate].quantity == Quantity::Angle {
                    off = (off - TAU * (off / TAU).round()).abs();
                }
                off * manipulator.weight(coordinate) < APART
            })
        };
        before.chain(after).filter(better).any(same)
    }
}

/// Row number `row` of some rows of so many numbers.
fn row_of(rows: &[f64], width: usize, row: usize) -> &[f64] {
    &rows[row * width..][..width]
}

impl Search<'_> {
    /// Notes the working modes in which the mechanism may be assembled at `v · b`, for each `b`. Most mechanisms have one
    /// mode, but a leg may have several branches with the same actuated joints.
    pub(super) fn assemble(&mut self, v: &Displacement, bs: &[Displacement]) {
        if bs.is_empty() {
            return;
        }
        self.know_legs(v);
        if !self.manipulator.task().shares_height() {
            return self.assemble_at_height(v, bs);
        }
        for b in bs {
            for rise in self.rises_at(v, b) {
                self.rise = rise;
                self.assemble_at_height(v, std::slice::from_ref(b));
            }
        }
    }

    /// The heights above home, metres, where each leg has one of its own: a leg with an actuated lift has that of its
    /// lift, of which a part is that of its imaginary joint.
    fn rises_at(&mut self, v: &Displacement, b: &Displacement) -> Vec<f64> {
        let m = self.manipulator;
        // The lifts of other legs are compared with this one.
        let mut driven = m
            .lifts_of_legs()
            .filter_map(|(leg, lift)| Some((leg, lift, lift.coordinate.actuated?)));
        let Some((leg, lift, actuated)) = driven.next() else { return Vec::new() };
        let own = lift.rise(self.held.displacements[actuated]);
        let branches = m.leg_modes(leg).map(|mode| m.branches(mode, leg));
        // The chains do not depend on the height: it is zero here.
        let solved = branches.filter_map(|branches| {
            self.held.legs[leg].solve_seldom(m.task(), [v, b], 0.0, branches, 0.0).ok()
        });
        let mut found: Vec<f64> =
            solved.map(|solution| own - m.task().rise_of_leg(0.0, solution.tau)).collect();
        if found.is_empty() {
            self.memory.outcome.reject();
        }
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| (*a - *b).abs() < MATCH * m.closure.size);
        found
    }

    /// The same at the height [`Search::rise`].
    fn assemble_at_height(&mut self, v: &Displacement, bs: &[Displacement]) {
        let m = self.manipulator;
        let lower = m.task().lower.isometry(v);
        let [mut all, mut pose] = std::mem::take(&mut self.memory.poses);
        let mut matches = std::mem::take(&mut self.memory.matches);
        m.task().write_poses(v, bs, self.rise, m.arch, &mut all);
        for (b, all) in bs.iter().zip(all.chunks_mut(m.task().coordinates.len())) {
            if !self.match_legs([v, b], &mut matches) {
                self.memory.outcome.reject();
                continue;
            }
            m.write_independent(None, all, &mut pose);
            if m.check_pose(&pose).is_ok() {
                let place = lower * m.task().upper.isometry(b);
                let target = m.task().raised(self.rise, place);
                let place =
                    AssemblyPlace { pose: &pose, all, target: &target, mode: Mode::default() };
                self.note_modes(&matches, place);
            }
        }
        (self.memory.poses, self.memory.matches) = ([all, pose], matches);
    }

    /// Finds the choices with which each leg closes at a candidate. Returns `false` if one does not.
    fn match_legs(&mut self, candidate: [&Displacement; 2], matches: &mut [Matches]) -> bool {
        for (leg, found) in matches.iter_mut().enumerate() {
            self.match_leg(leg, candidate, self.rise, found);
            if found.list.is_empty() {
                return false;
            }
        }
        true
    }

    /// Notes every combination of the legs' choices at a place.
    fn note_modes(&mut self, matches: &[Matches], place: AssemblyPlace<'_>) {
        self.memory.candidates.begun += 1;
        let count: usize = matches.iter().map(|of_leg| of_leg.list.len()).product();
        for combination in 0..count {
            let mut rest = combination;
            let mode = matches.iter().fold(Mode::default(), |mode, Matches { list, .. }| {
                let own = list[rest % list.len()];
                rest /= list.len();
                mode.with(own)
            });
            let place = AssemblyPlace { mode, ..place };
            match &self.manipulator.dependent {
                None => self.memory.candidates.note(place),
                Some(dependent) => self.note_completed(dependent, place),
            }
        }
    }

    /// Notes a working mode with the choices of dependent coordinates that give the pose's displacement, if there are any;
    /// that of the place has the choices of the legs.
    fn note_completed(&mut self, dependent: &Dependent, place: AssemblyPlace<'_>) {
        let (m, AssemblyPlace { pose, all, mode: legs, .. }) = (self.manipulator, place);
        // The displacement of what is given as the pose: the legs are held against that.
        let target = &m.task().displacement(all);
        let modes = dependent.step_modes().map(|steps| legs.with(steps));
        let completed = modes.filter_map(|mode| Some((mode, m.completed(pose, mode).ok()?)));
        let off = |all: &[f64]| m.apart(&m.task().displacement(all), target);
        let errors = completed.map(|(mode, all)| (off(&all), mode));
        let Some((error, mode)) = errors.min_by(|a, b| a.0.total_cmp(&b.0)) else { return };
        if error > APART {
            self.memory.outcome.reject();
            return;
        }
        self.memory.candidates.note(AssemblyPlace { mode, target, ..place });
    }

    /// Checks all candidates, and accepts those that are assemblies.
    pub(super) fn check_candidates(&mut self) {
        let Self { manipulator: m, held, memory, .. } = self;
        let Memory { candidates, outcome, .. } = &mut **memory;
        candidates.solve(m);
        candidates.measure(m, held.displacements);
        candidates.close(m, held.displacements);
        outcome.assemblies.list.reserve(candidates.modes.len());
        // Dependent coordinates are found again from the others, which loses digits near a singularity.
        let most = if m.dependent.is_some() { APART } else { MATCH };
        for row in 0..candidates.modes.len() {
            let error = candidates.errors[row];
            if error > most {
                outcome.reject();
            } else if !candidates.has_better(m, row) {
                let (place, solved) = candidates.row(m, row);
                outcome.accept(held, place, solved, candidates.residuals[row]);
            }
        }
    }
}
