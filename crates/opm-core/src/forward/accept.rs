//! What the search finds, put to the test: inverse kinematics give the actuated joints back, and the legs
//! close.

use super::search::Search;
use super::{Assemblies, Assembly, RESIDUAL, Unmet};
use crate::chain::Branch;
use crate::chain::condition::length;
use crate::group::{Displacement, JointDisplacement};
use crate::manipulator::{
    ChainCoordinate, CompiledSection, LegSolution, Manipulator, Mode, Section, Solution,
    Unreachable,
};
use crate::numeric::Quantity;
use nalgebra::{Complex, Isometry3};
use std::f64::consts::TAU;

/// A leg's solution at an assembled pose has the actuated joints' values to within this, radians or sizes:
/// inverse kinematics near a serial singularity give the root of the rounding.
const MATCH: f64 = 1e-6;

/// Two solutions of a leg that both match are two only if a joint of them differs by more than this; nearer
/// to each other they are one on its way through a singularity.
const APART: f64 = 1e-4;

/// A leg closes so well that what inverse kinematics say of its passive joints needs no mending.
const SETTLED: f64 = 1e-13;

/// Assemblies of one mode are one if no joint of them differs by more, radians or metres.
const SAME: f64 = 1e-9;

impl Manipulator {
    /// The assembly at a pose with the actuated joints `amounts` from home: the joints of a solution
    /// there, mended where the actuated ones are not exactly what they should be.
    pub(super) fn assembly(
        &self,
        pose: &[f64],
        mode: Mode,
        amounts: &[f64],
        (solution, target): (&mut Solution, &Isometry3<f64>),
    ) -> Assembly {
        // The values that were given, at the turn at which inverse kinematics give them.
        for (&amount, &coordinate) in amounts.iter().zip(self.actuated()) {
            let c = &self.coordinates()[coordinate];
            let given = c.home + amount;
            let joint = &mut solution.joints[coordinate];
            let turns = match c.quantity {
                Quantity::Angle => ((*joint - given) / TAU).round(),
                Quantity::Length => 0.0,
            };
            *joint = given + TAU * turns;
        }
        let mut residual = self.closure.residual(&solution.joints, target);
        if residual > SETTLED {
            residual = self.closure.settle(&mut solution.joints, target, residual);
        }
        Assembly {
            pose: pose.to_vec(),
            mode,
            joints: solution.joints.clone(),
            imaginary: solution.imaginary.clone(),
            within_limits: solution.within_limits,
            residual,
        }
    }
}

impl Search<'_> {
    /// Every assembly at `v · b`: in most mechanisms one, but a leg may close in several ways with the
    /// same actuated joints.
    pub(super) fn assemble(&mut self, v: &Displacement, b: &Displacement) {
        let m = self.manipulator;
        let pose = m.task().pose(v, b);
        let Ok((v, b)) = m.displacements(&pose) else { return };
        let target = m.task().isometry(&v, &b);
        let mut ways: Vec<Vec<(Mode, LegSolution)>> = Vec::with_capacity(m.legs.len());
        for leg in 0..m.legs.len() {
            let (ways_of_leg, off) = self.ways(leg, [&v, &b]);
            if ways_of_leg.is_empty() {
                self.dismiss(off);
                return;
            }
            ways.push(ways_of_leg);
        }
        let count: usize = ways.iter().map(Vec::len).product();
        for number in 0..count {
            let mut rest = number;
            let mut mode = Mode::default();
            self.solution.within_limits = true;
            for (leg, ways) in ways.iter().enumerate() {
                let (own, solution) = &ways[rest % ways.len()];
                rest /= ways.len();
                mode = mode.with(*own);
                m.write_leg(leg, solution, &mut self.solution);
            }
            self.accept(&pose, mode, &target);
        }
    }

    fn dismiss(&mut self, off: f64) {
        self.least = Some(self.least.map_or(off, |least| least.min(off)));
    }

    /// A leg's solutions at a pose that have the actuated joints where they are; and by how much the one is
    /// off that comes nearest to that.
    fn ways(&self, leg: usize, pose: [&Displacement; 2]) -> (Vec<(Mode, LegSolution)>, f64) {
        let m = self.manipulator;
        let mut least = f64::INFINITY;
        let compiled = &m.legs[leg];
        let mut found: Vec<(Mode, LegSolution, f64)> = Vec::with_capacity(4);
        // Most ways already have the lower joints elsewhere: they are dismissed before the rest is solved.
        let quick =
            compiled.split_section == Section::Upper && !self.plan.legs[leg].lower.is_empty();
        let [v, b] = pose;
        let cuts = Branch::BOTH.map(|branch| match quick {
            true => {
                compiled.upper.chain.first(b, branch).ok().map(|tau| compiled.unwound(tau, 0.0))
            }
            false => None,
        });
        for mode in m.leg_modes(leg) {
            let branches = m.branches(mode, leg);
            if quick {
                let Some(tau) = cuts[usize::from(branches.upper == Branch::Minus)] else {
                    continue;
                };
                let lower = compiled.solve_lower(m.task(), v, tau, branches.lower);
                let off = lower.map_or(f64::INFINITY, |l| self.section_off(&compiled.lower, &l));
                if off.is_nan() || off > MATCH {
                    least = least.min(off);
                    continue;
                }
            }
            let Ok(solution) = compiled.solve(m.task(), pose, branches, 0.0) else { continue };
            let off = self.off(leg, &solution);
            least = least.min(off);
            if off <= MATCH {
                found.push((mode, solution, off));
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

    /// By how much a leg's solution has its actuated joints elsewhere.
    fn off(&self, leg: usize, solution: &LegSolution) -> f64 {
        let leg = &self.manipulator.legs[leg];
        let lower = self.section_off(&leg.lower, &solution.lower);
        lower.max(self.section_off(&leg.upper, &solution.upper))
    }

    fn section_off(&self, section: &CompiledSection, amounts: &[JointDisplacement; 3]) -> f64 {
        let mut off = 0.0_f64;
        for (slot, &amount) in section.coordinates.iter().zip(amounts) {
            if let Some(ChainCoordinate { number: coordinate, actuated: Some(drive) }) = *slot {
                let (value, turn) = (self.amounts[drive], self.turns[drive]);
                off = off.max(self.apart(coordinate, amount, value, turn));
            }
        }
        off
    }

    fn same(&self, leg: usize, one: &LegSolution, other: &LegSolution) -> bool {
        let m = self.manipulator;
        let compiled = &m.legs[leg];
        let sections = [
            (&compiled.lower, &one.lower, &other.lower),
            (&compiled.upper, &one.upper, &other.upper),
        ];
        sections.iter().all(|(section, one, other)| {
            section.coordinates.iter().zip(one.iter().zip(*other)).all(|(slot, (one, other))| {
                let Some(slot) = slot else { return true };
                self.apart(slot.number, *one, other.value(), other.unit_direction()) < APART
            })
        })
    }

    /// Distance of an amount from a value, and from its turn: radians or sizes.
    fn apart(
        &self,
        coordinate: usize,
        amount: JointDisplacement,
        value: f64,
        turn: Complex<f64>,
    ) -> f64 {
        match amount {
            JointDisplacement::Direction(_) => length(amount.unit_direction() - turn),
            JointDisplacement::Value(given) => {
                match self.manipulator.coordinates()[coordinate].quantity {
                    Quantity::Angle => (given - value).abs(),
                    Quantity::Length => (given - value).abs() / self.manipulator.closure.size,
                }
            }
        }
    }

    /// Adds the assembly in the buffer, unless it does not close or is there already.
    fn accept(&mut self, pose: &[f64], mode: Mode, target: &Isometry3<f64>) {
        let m = self.manipulator;
        let mut assembly = m.assembly(pose, mode, self.amounts, (&mut self.solution, target));
        if assembly.residual > SETTLED && assembly.residual < MATCH {
            // What the sections have lost on the way, near singularities of theirs, the whole may give back.
            let actuated = m.actuated().iter().zip(self.amounts);
            let given: Vec<f64> = actuated.map(|(&c, a)| m.coordinates()[c].home + a).collect();
            if let Ok(better) = m.forward_near(&given, pose, mode) {
                let moved = better.joints.iter().zip(&assembly.joints);
                let near = moved.into_iter().all(|(a, b)| (a - b).abs() < MATCH);
                if near && better.residual < assembly.residual {
                    assembly = better;
                }
            }
        }
        if assembly.residual.is_nan() || assembly.residual > RESIDUAL {
            self.dismiss(assembly.residual);
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
        // A loose section closes in some way, which is not listed.
        let Assemblies { loose, unmet, .. } = &mut self.out;
        unmet.retain(|unmet| !matches!(unmet, Unmet::Section(section) if loose.contains(section)));
        self.out
    }
}
