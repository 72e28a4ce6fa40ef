//! Candidates of the search are checked: inverse kinematics give the actuated joints back, and all legs
//! close.

use super::search::Search;
use super::{Assemblies, Assembly, Unmet};
use crate::chain::Branch;
use crate::chain::condition::length;
use crate::group::{Displacement, JointDisplacement};
use crate::manipulator::{
    ChainCoordinate, CompiledSection, Dependent, LegSolution, Manipulator, Mode, Section, Solution,
    Unreachable,
};
use crate::numeric::Quantity;
use nalgebra::{Complex, Isometry3};
use std::f64::consts::TAU;

/// A leg's solution at an assembled pose has the values of the actuated joints to within this, in radians or
/// shares of the size. Near a serial singularity, inverse kinematics are only accurate to about the square
/// root of rounding.
pub(super) const MATCH: f64 = 1e-6;

/// Two solutions of a leg that both match are distinct if a joint differs by more than this, in radians or
/// shares of the size. Otherwise they are one solution near a singularity.
const APART: f64 = 1e-4;

/// Below this residual, the passive joints that inverse kinematics give are not improved any further.
const SETTLED: f64 = 1e-13;

/// Two assemblies in one mode are the same if no joint differs by more than this, in radians or metres.
const SAME: f64 = 1e-9;

impl Manipulator {
    /// The assembly at a pose, where the actuated joints have these displacements from home. The other joints
    /// are those of a solution there, improved where that does not close to rounding.
    pub(super) fn assembly(
        &self,
        pose: &[f64],
        mode: Mode,
        displacements: &[f64],
        solution: &mut Solution,
        target: &Isometry3<f64>,
    ) -> Assembly {
        // The given values, with the full revolutions that inverse kinematics give.
        for (&displacement, &coordinate) in displacements.iter().zip(self.actuated()) {
            let c = &self.coordinates()[coordinate];
            let given = c.home + displacement;
            let joint = &mut solution.joints[coordinate];
            let revolutions = match c.quantity {
                Quantity::Angle => ((*joint - given) / TAU).round(),
                Quantity::Length => 0.0,
            };
            *joint = given + TAU * revolutions;
        }
        let mut residual = self.closure.residual(&solution.joints, target);
        if residual > SETTLED {
            residual = self.closure.settle(&mut solution.joints, target, residual);
        }
        Assembly {
            pose: pose.to_vec(),
            dependent: solution.dependent().to_vec(),
            mode,
            joints: solution.joints.clone(),
            imaginary: solution.imaginary.clone(),
            within_limits: solution.within_limits,
            residual,
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
        let own = lift.rise(self.displacements[actuated]);
        let branches = m.leg_modes(leg).map(|mode| m.branches(mode, leg));
        // The chains do not depend on the height: it is zero here.
        let solved = branches
            .filter_map(|branches| self.legs[leg].solve(m.task(), [v, b], 0.0, branches, 0.0).ok());
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
        let all = m.task().pose(v, b, self.rise);
        let independent = m.dependent.as_ref().map(|d| d.independent_of(m, &all));
        let pose = independent.as_deref().unwrap_or(&all);
        if m.check_pose(pose).is_err() {
            return;
        }
        let (v, b) = m.task().sections(&all);
        let rise = m.task().rise(&all);
        let target = m.task().raised(rise, m.task().isometry(&v, &b));
        let mut solutions: Vec<Vec<(Mode, LegSolution)>> = Vec::with_capacity(m.legs.len());
        for leg in 0..m.legs.len() {
            let (matching, error) = self.matching_solutions(leg, [&v, &b], rise);
            if matching.is_empty() {
                self.reject(error);
                return;
            }
            solutions.push(matching);
        }
        let count: usize = solutions.iter().map(Vec::len).product();
        for number in 0..count {
            let mut rest = number;
            let mut mode = Mode::default();
            self.solution.within_limits = true;
            for (leg, solutions) in solutions.iter().enumerate() {
                let (own, solution) = &solutions[rest % solutions.len()];
                rest /= solutions.len();
                mode = mode.with(*own);
                m.write_leg(leg, solution, &mut self.solution);
            }
            if m.task().height.is_some() {
                self.solution.solved.pose.copy_from_slice(&all);
                m.write_lifts(&mut self.solution);
            }
            match &m.dependent {
                None => self.accept(pose, mode, &target),
                Some(dependent) => self.accept_completed(dependent, pose, mode, &target),
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

    /// The solutions of a leg at a pose that have the given values of its actuated joints, and the smallest
    /// error of any of its solutions, in radians or shares of the size.
    fn matching_solutions(
        &self,
        leg: usize,
        pose: [&Displacement; 2],
        rise: f64,
    ) -> (Vec<(Mode, LegSolution)>, f64) {
        let m = self.manipulator;
        let mut least = f64::INFINITY;
        let compiled = &self.legs[leg];
        let mut found: Vec<(Mode, LegSolution, f64)> = Vec::with_capacity(4);
        // Most solutions already have other lower joints. They are rejected before the rest is solved.
        let lower_first =
            compiled.split_section == Section::Upper && !self.plan.legs[leg].lower.is_empty();
        let [v, b] = pose;
        let cuts = Branch::BOTH.map(|branch| match lower_first {
            true => compiled.first_step(b, branch).ok().map(|tau| compiled.unwound(tau, 0.0)),
            false => None,
        });
        for mode in m.leg_modes(leg) {
            let branches = m.branches(mode, leg);
            if lower_first {
                let Some(tau) = cuts[usize::from(branches.upper == Branch::Minus)] else {
                    continue;
                };
                let lower = compiled.solve_lower(m.task(), v, tau, branches.lower);
                let error =
                    lower.map_or(f64::INFINITY, |l| self.section_error(&compiled.lower, &l));
                if error.is_nan() || error > MATCH {
                    least = least.min(error);
                    continue;
                }
            }
            let Ok(solution) = compiled.solve(m.task(), pose, rise, branches, 0.0) else {
                continue;
            };
            let error = self.leg_error(leg, &solution, rise);
            least = least.min(error);
            if error <= MATCH {
                found.push((mode, solution, error));
            }
        }
        found.sort_by(|a, b| a.2.total_cmp(&b.2));
        let mut kept: Vec<(Mode, LegSolution)> = Vec::with_capacity(found.len());
        for (mode, solution, _) in found {
            let same = |(_, other): &(Mode, LegSolution)| self.same(leg, other, &solution);
            if !kept.iter().any(same) {
                kept.push((mode, solution));
            }
        }
        (kept, least)
    }

    /// The largest error of an actuated joint in a leg's solution, in radians or shares of the size.
    fn leg_error(&self, leg: usize, solution: &LegSolution, rise: f64) -> f64 {
        let m = self.manipulator;
        let leg = &m.legs[leg];
        let lower = self.section_error(&leg.lower, &solution.lower);
        let error = lower.max(self.section_error(&leg.upper, &solution.upper));
        // All lifts have one height, unless each leg has its own.
        let lift = leg.lift.filter(|lift| lift.slope != 0.0);
        let actuated = lift.and_then(|lift| Some((lift, lift.coordinate.actuated?)));
        actuated.map_or(error, |(lift, actuated)| {
            let own = lift.rise(self.displacements[actuated]);
            error.max((own - m.task().rise_of_leg(rise, solution.tau)).abs() / m.closure.size)
        })
    }

    /// The largest error of an actuated joint in one section, in radians or shares of the size.
    fn section_error(
        &self,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
    ) -> f64 {
        let mut error = 0.0_f64;
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            if let Some(ChainCoordinate { number, actuated: Some(actuated), .. }) = *coordinate {
                let (value, direction) = (self.displacements[actuated], self.directions[actuated]);
                error = error.max(self.distance(number, displacement, value, direction));
            }
        }
        error
    }

    /// Whether two solutions of a leg are the same, up to rounding near a singularity.
    fn same(&self, leg: usize, one: &LegSolution, other: &LegSolution) -> bool {
        let m = self.manipulator;
        let compiled = &m.legs[leg];
        let sections = [
            (&compiled.lower, &one.lower, &other.lower),
            (&compiled.upper, &one.upper, &other.upper),
        ];
        sections.iter().all(|(section, one, other)| {
            section.coordinates.iter().zip(one.iter().zip(*other)).all(
                |(coordinate, (one, other))| {
                    let Some(coordinate) = coordinate else { return true };
                    self.distance(coordinate.number, *one, other.value(), other.unit_direction())
                        < APART
                },
            )
        })
    }

    /// The distance of a joint's displacement from a value, or from the direction of that angle: in radians
    /// or shares of the size.
    fn distance(
        &self,
        coordinate: usize,
        displacement: JointDisplacement,
        value: f64,
        direction: Complex<f64>,
    ) -> f64 {
        match displacement {
            JointDisplacement::Direction(_) => length(displacement.unit_direction() - direction),
            JointDisplacement::Value(given) => {
                match self.manipulator.coordinates()[coordinate].quantity {
                    Quantity::Angle => (given - value).abs(),
                    Quantity::Length => (given - value).abs() / self.manipulator.closure.size,
                }
            }
        }
    }

    /// Adds the assembly in the buffer to the list, unless it does not close or is listed already.
    fn accept(&mut self, pose: &[f64], mode: Mode, target: &Isometry3<f64>) {
        let m = self.manipulator;
        let mut assembly = m.assembly(pose, mode, self.displacements, &mut self.solution, target);
        if assembly.residual > SETTLED && assembly.residual < MATCH {
            // Near a singularity of a section, Newton's method on the whole mechanism restores digits that
            // the sections have lost.
            let actuated = m.actuated().iter().zip(self.displacements);
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
