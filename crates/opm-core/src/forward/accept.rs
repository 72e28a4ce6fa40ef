//! Candidates of the search are checked: inverse kinematics give the actuated joints back, and all legs
//! close.

use super::matches::{Match, Matches};
use super::search::Search;
use super::{Assemblies, Assembly, Unmet};
use crate::group::Displacement;
use crate::manipulator::{
    ClosureBuffer, Dependent, Manipulator, Mode, Section, Solution, Unreachable,
};
use crate::numeric::Quantity;
use nalgebra::Isometry3;
use pulp::{Simd, WithSimd};
use std::f64::consts::TAU;

/// A leg's solution at an assembled pose has the values of the actuated joints to within this, in radians or
/// shares of the size. Near a serial singularity, inverse kinematics are only accurate to about the square
/// root of rounding.
pub(super) const MATCH: f64 = 1e-6;

/// Two solutions of a leg that both match are distinct if a joint differs by more than this, in radians or
/// shares of the size. Otherwise they are one solution near a singularity.
pub(super) const APART: f64 = 1e-4;

/// Below this residual, the passive joints that inverse kinematics give are not improved any further.
pub(super) const SETTLED: f64 = 1e-13;

/// Two assemblies in one mode are the same if no joint differs by more than this, in radians or metres.
const SAME: f64 = 1e-9;

/// Where an assembly is looked for.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// The independent task coordinates, metres and radians.
    pub pose: &'a [f64],
    /// The platform's displacement from home at this pose.
    pub target: &'a Isometry3<f64>,
    pub mode: Mode,
}

impl Assembly {
    /// A buffer for the assemblies of a manipulator.
    pub(super) fn buffer(manipulator: &Manipulator) -> Self {
        Self {
            pose: Vec::with_capacity(manipulator.task_coordinates().len()),
            dependent: Vec::with_capacity(manipulator.dependent_coordinates().len()),
            mode: Mode::default(),
            joints: Vec::with_capacity(manipulator.coordinates().len()),
            imaginary: Vec::with_capacity(manipulator.imaginary().len()),
            within_limits: false,
            residual: f64::NAN,
        }
    }
}

impl Manipulator {
    /// Writes the assembly at a pose, where the actuated joints have these displacements from home. The other joints
    /// are those of a solution there, improved where that does not close to rounding.
    pub(super) fn write_assembly(
        &self,
        Place { pose, target, mode }: Place<'_>,
        displacements: &[f64],
        solution: &Solution,
        buffer: &mut ClosureBuffer,
        out: &mut Assembly,
    ) {
        let write = |to: &mut Vec<f64>, from: &[f64]| {
            to.clear();
            to.extend_from_slice(from);
        };
        write(&mut out.pose, pose);
        write(&mut out.dependent, solution.dependent());
        write(&mut out.joints, &solution.joints);
        write(&mut out.imaginary, &solution.imaginary);
        (out.mode, out.within_limits) = (mode, solution.within_limits);
        // The given values, with the full revolutions that inverse kinematics give.
        for (&displacement, &coordinate) in displacements.iter().zip(self.actuated()) {
            let c = &self.coordinates()[coordinate];
            let given = c.home + displacement;
            let joint = &mut out.joints[coordinate];
            let revolutions = match c.quantity {
                Quantity::Angle => ((*joint - given) / TAU).round(),
                Quantity::Length => 0.0,
            };
            *joint = given + TAU * revolutions;
        }
        out.residual = self.closure.residual(&out.joints, target, buffer);
        if out.residual > SETTLED {
            out.residual = self.closure.settle(&mut out.joints, target, out.residual, buffer);
        }
    }
}

impl Search<'_> {
    /// Accepts every assembly at `v · b`. Most mechanisms have one, but a leg may have several branches with
    /// the same actuated joints.
    pub(super) fn assemble(&mut self, v: &Displacement, b: &Displacement) {
        if self.manipulator.shares_height() {
            for rise in self.rises_at(v, b) {
                self.rise = rise;
                self.assemble_at_height(v, b);
            }
        } else {
            self.assemble_at_height(v, b);
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
            self.reject(f64::INFINITY);
        }
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| (*a - *b).abs() < MATCH * m.closure.size);
        found
    }

    /// The same at the height [`Search::rise`].
    fn assemble_at_height(&mut self, v: &Displacement, b: &Displacement) {
        let m = self.manipulator;
        let [mut all, mut pose] = std::mem::take(&mut self.poses);
        m.task().write_pose(v, b, self.rise, &mut all);
        m.write_independent(&mut all, &mut pose);
        if m.check_pose(&pose).is_ok() {
            m.arch.dispatch(AssembleAt { search: self, all: &all, pose: &pose });
        }
        self.poses = [all, pose];
    }

    /// The same at a pose: all of its coordinates, and the independent ones.
    #[inline(always)]
    fn assemble_at(&mut self, all: &[f64], pose: &[f64]) {
        let m = self.manipulator;
        let (v, b) = m.task().sections(all);
        let rise = m.task().rise(all);
        let place = self.lower_isometry(&v) * m.task().upper.isometry(&b);
        let target = m.task().raised(rise, place);
        let mut matches = std::mem::take(&mut self.matches);
        let mut open = None;
        for (leg, found) in matches.iter_mut().enumerate() {
            self.match_leg(leg, [&v, &b], rise, found);
            if found.list.is_empty() {
                open = Some(found.least);
                break;
            }
        }
        match open {
            Some(error) => self.reject(error),
            None => self.accept_matches(&matches, all, pose, &target),
        }
        self.matches = matches;
    }

    /// The lower section's displacement in base coordinates. Several candidates share it.
    #[inline(always)]
    fn lower_isometry(&mut self, v: &Displacement) -> Isometry3<f64> {
        match &self.lower {
            Some((known, isometry)) if known == v => *isometry,
            _ => {
                let isometry = self.manipulator.task().lower.isometry(v);
                self.lower = Some((*v, isometry));
                isometry
            }
        }
    }

    /// Accepts every combination of solutions of the legs at a pose. `all` has all of its coordinates, and `pose` the
    /// independent ones.
    #[inline(always)]
    fn accept_matches(
        &mut self,
        matches: &[Matches],
        all: &[f64],
        pose: &[f64],
        target: &Isometry3<f64>,
    ) {
        let m = self.manipulator;
        let count: usize = matches.iter().map(|of_leg| of_leg.list.len()).product();
        for number in 0..count {
            let mut rest = number;
            let mut mode = Mode::default();
            self.solution.within_limits = true;
            for (leg, Matches { list, .. }) in matches.iter().enumerate() {
                let Match { mode: own, solution, .. } = &list[rest % list.len()];
                rest /= list.len();
                mode = mode.with(*own);
                self.solution.legs[leg] = *solution;
            }
            let mut rest = number;
            let lower = matches.iter().map(|Matches { list, .. }| {
                let values = &list[rest % list.len()].lower;
                rest /= list.len();
                values
            });
            m.write_upper_sections(lower, &mut self.solution);
            if m.task().height.is_some() {
                self.solution.solved.pose.copy_from_slice(all);
                m.write_lifts(&mut self.solution);
            }
            match &m.dependent {
                None => self.accept(pose, mode, target),
                Some(dependent) => self.accept_completed(dependent, pose, mode, target),
            }
        }
    }

    /// Accepts an assembly with the choices of dependent coordinates that give the displacement `target`, if there
    /// are any; `legs` has the choices of the legs.
    fn accept_completed(
        &mut self,
        dependent: &Dependent,
        pose: &[f64],
        legs: Mode,
        target: &Isometry3<f64>,
    ) {
        let m = self.manipulator;
        let modes = dependent.step_modes().map(|steps| legs.with(steps));
        let completed = modes.filter_map(|mode| Some((mode, m.completed(pose, mode).ok()?)));
        let off = |all: &[f64]| m.apart(&m.task().displacement(all), target);
        let errors = completed.map(|(mode, all)| (off(&all), mode, all));
        let Some((error, mode, all)) = errors.min_by(|a, b| a.0.total_cmp(&b.0)) else { return };
        if error > APART {
            self.reject(error);
            return;
        }
        self.solution.take_pose(m, &all);
        self.accept(pose, mode, target);
    }

    /// Notes by how much the joints of a rejected candidate are off.
    pub(super) fn reject(&mut self, error: f64) {
        self.least = Some(self.least.map_or(error, |least| least.min(error)));
    }

    /// Adds the assembly in the buffer to the list, unless it does not close or is listed already.
    fn accept(&mut self, pose: &[f64], mode: Mode, target: &Isometry3<f64>) {
        let m = self.manipulator;
        let place = Place { pose, target, mode };
        let mut assembly = Assembly::buffer(m);
        let (solution, closure) = (&self.solution, &mut self.closure);
        m.write_assembly(place, self.held.displacements, solution, closure, &mut assembly);
        if assembly.residual > SETTLED && assembly.residual < MATCH {
            // Near a singularity of a section, Newton's method on the whole mechanism restores digits that
            // the sections have lost.
            let actuated = m.actuated().iter().zip(self.held.displacements);
            let given: Vec<f64> = actuated.map(|(&c, a)| m.coordinates()[c].home + a).collect();
            if let Ok(better) = m.forward_near(&given, pose, mode) {
                let moved = better.joints.iter().zip(&assembly.joints);
                let near = moved.into_iter().all(|(a, b)| (a - b).abs() < MATCH);
                if near && better.residual < assembly.residual {
                    assembly = better;
                }
            }
        }
        if assembly.residual.is_nan() || assembly.residual > m.largest_residual() {
            self.reject(assembly.residual);
            return;
        }
        let known = |other: &Assembly| {
            let joints = other.joints.iter().zip(&assembly.joints);
            other.mode == mode && joints.into_iter().all(|(a, b)| (a - b).abs() < SAME)
        };
        if !self.out.list.iter().any(known) {
            self.out.list.push(assembly);
        }
    }

    /// The assemblies that were accepted; if there are none, the reasons.
    pub(super) fn finish(mut self) -> Assemblies {
        for (leg, deficit) in self.deficits.iter().enumerate() {
            if let Some(deficit) = *deficit {
                let section = Section::Lower;
                self.out.unmet.push(Unmet::Leg(Unreachable { leg, section, deficit }));
            }
        }
        if self.upper_failed {
            self.out.unmet.push(Unmet::Section(Section::Upper));
        }
        self.out.unmet.extend(self.least.map(Unmet::Contradiction));
        if !self.out.list.is_empty() {
            self.out.unmet.clear();
        }
        // A section that can move closes at some poses, which are not listed.
        let Assemblies { loose, unmet, .. } = &mut self.out;
        unmet.retain(|unmet| !matches!(unmet, Unmet::Section(section) if loose.contains(section)));
        self.out
    }
}

/// [`Search::assemble_at`], with the instructions of the processor at hand.
struct AssembleAt<'s, 'a, 'p> {
    search: &'s mut Search<'a>,
    all: &'p [f64],
    pose: &'p [f64],
}

impl WithSimd for AssembleAt<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.search.assemble_at(self.all, self.pose);
    }
}
