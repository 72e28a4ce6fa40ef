//! Displacements of the platform as assemblies.

use super::accept::{APART, MATCH};
use super::{Assemblies, Assembly, Completeness, Unmet};
use crate::group::JointDisplacement;
use crate::manipulator::{
    AllModes, Choices, ClosureBuffer, Continued, FoundDisplacements, Manipulator, Mode, Solution,
};
use nalgebra::Isometry3;
use std::ops::Range;

/// The most combinations of choices of a leg.
const CHOICES: usize = 4;

/// What is needed for one assembly after the other.
struct Assembler<'a> {
    manipulator: &'a Manipulator,
    /// The displacements of the actuated joints from home, radians and metres.
    wanted: &'a [f64],
    modulo: Vec<bool>,
    /// The joint coordinates of each leg.
    legs: Vec<Range<usize>>,
    all: AllModes,
    solution: Solution,
    closure: ClosureBuffer,
}

impl Manipulator {
    /// Every assembly that continuation finds with these displacements of the actuated joints from home, radians and metres.
    pub(super) fn assemblies_by(&self, continued: &Continued, wanted: &[f64]) -> Assemblies {
        let FoundDisplacements { real, near, found, of, closed } = continued.solve(wanted);
        let mut assembler = Assembler {
            manipulator: self,
            wanted,
            modulo: self.modulo_revolutions(),
            legs: self.coordinates_of_legs(),
            all: self.all_modes(),
            solution: self.solution(),
            closure: self.closure.buffer(),
        };
        let mut list: Vec<Assembly> = Vec::new();
        let is_new = |list: &[Assembly], other: &Assembly| {
            let place = self.displacement_of(other);
            list.iter().all(|one| self.apart(&self.displacement_of(one), &place) > MATCH)
        };
        for g in &real {
            list.extend(assembler.at(g).filter(|one| is_new(&list, one)));
        }
        let mut found = found;
        for g in &near {
            if let Some(other) = assembler.near(g).filter(|other| is_new(&list, other)) {
                list.push(other);
                found += 1;
            }
        }
        let unmet = match (list.is_empty(), self.is_redundant()) {
            (false, _) => vec![],
            (true, true) => vec![Unmet::Contradiction],
            (true, false) => vec![Unmet::Together],
        };
        let completeness = match closed {
            true => Completeness::ClosedForm,
            false => Completeness::Continuation { found, of: of.max(found) },
        };
        Assemblies { list, unmet, loose: Vec::new(), completeness }
    }
}

impl Manipulator {
    /// The independent coordinates of a displacement.
    pub(super) fn pose_at(&self, g: &Isometry3<f64>) -> Vec<f64> {
        self.independent_at(g, None)
    }

    fn independent_at(&self, g: &Isometry3<f64>, mode: Option<Mode>) -> Vec<f64> {
        let ([v, b], rise) = self.task().factors(g);
        let (mut all, mut pose) = (self.task().pose(&v, &b, rise), Vec::new());
        self.write_independent(mode, &mut all, &mut pose);
        pose
    }
}

impl Assembler<'_> {
    /// An assembly in home's mode near a place where solutions meet, which Newton's method finds.
    fn near(&self, g: &Isometry3<f64>) -> Option<Assembly> {
        let m = self.manipulator;
        let pose = self.pose(g, Some(m.home_mode()));
        m.forward_near(&self.given(), &pose, m.home_mode()).ok()
    }

    /// The independent coordinates of a displacement, with the angles of a mode if one is given.
    fn pose(&self, g: &Isometry3<f64>, mode: Option<Mode>) -> Vec<f64> {
        self.manipulator.independent_at(g, mode)
    }

    /// The values of the actuated joints.
    fn given(&self) -> Vec<f64> {
        let m = self.manipulator;
        self.wanted.iter().zip(m.actuated()).map(|(q, &c)| m.coordinates()[c].home + q).collect()
    }

    /// The assembly at a displacement of the platform; `None` if a leg does not close there with its actuated joints.
    fn at(&mut self, g: &Isometry3<f64>) -> Option<Assembly> {
        let m = self.manipulator;
        let pose = self.pose(g, None);
        let steps = self.steps(&pose, g);
        m.inverse_all(&pose, &mut self.all).ok()??;
        let mode = steps.into_iter().find_map(|choices| self.legs_mode(choices))?;
        let solution = m.solution_in_mode(&self.all, mode, &mut self.solution)?;
        let mut assembly =
            m.assembly_of((&pose, mode), solution, self.wanted, &mut self.closure)?;
        if assembly.residual > m.largest_residual() {
            let better = m.forward_near(&self.given(), &assembly.pose, mode).ok()?;
            let moved = m.apart(&m.displacement_of(&better), g);
            assembly = (moved < APART).then_some(better)?;
        }
        (assembly.residual <= m.largest_residual()).then_some(assembly)
    }

    /// The choices with which the dependent coordinates of a pose follow so that the platform is displaced by `g`, best first.
    fn steps(&self, pose: &[f64], g: &Isometry3<f64>) -> Vec<Choices> {
        let m = self.manipulator;
        let completed = m.completions(None).filter_map(|choices| {
            let all = m.completed(pose, choices.chosen).ok()?;
            Some((m.apart(&m.task().displacement(&all), g), choices))
        });
        let mut found: Vec<_> = completed.filter(|(error, _)| *error < APART).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, choices)| choices).collect()
    }

    /// The working mode with these choices of dependent coordinates in which the actuated joints have their values. Where a
    /// leg has them with several choices, in one that is within its limits, and else in that of home, if there are such.
    fn legs_mode(&mut self, choices: Choices) -> Option<Mode> {
        let m = self.manipulator;
        let most = if m.dependent.is_some() { APART } else { MATCH };
        let mut best: Vec<Option<(u8, Mode)>> = vec![None; m.legs()];
        for choice in 0..CHOICES {
            let own = |leg: usize| m.chosen_leg_modes(choices, leg).nth(choice);
            let mode = (0..m.legs()).filter_map(own).fold(choices.chosen, Mode::with);
            // The joints of a leg that closes are written, whether others close or not.
            let _ = m.solution_in_mode(&self.all, mode, &mut self.solution);
            for (leg, best) in best.iter_mut().enumerate() {
                let range = self.legs[leg].clone();
                let closes = self.solution.unreachable().iter().all(|open| open.leg != leg);
                let Some(own) = own(leg).filter(|_| closes) else { continue };
                let error = self.error(range.clone());
                let is_home = m.branches(own, leg) == m.branches(m.home_mode(), leg);
                let rank = 2 * u8::from(!self.within_limits(range)) + u8::from(!is_home);
                let better = best.is_none_or(|(known, _)| rank < known);
                if error <= most && better {
                    *best = Some((rank, own));
                }
            }
        }
        best.into_iter().try_fold(choices.chosen, |mode, best| Some(mode.with(best?.1)))
    }

    /// The largest error of an actuated joint among these coordinates, in radians or shares of the size.
    fn error(&self, coordinates: Range<usize>) -> f64 {
        let m = self.manipulator;
        let values = m.actuated().iter().zip(self.wanted).zip(&self.modulo);
        let of = |((&coordinate, wanted), &modulo): ((&usize, &f64), &bool)| {
            m.actuated_error(coordinate, self.solution.joints()[coordinate], *wanted, modulo)
        };
        let own = values.filter(|((coordinate, _), _)| coordinates.contains(coordinate));
        own.map(of).fold(0.0, f64::max)
    }

    fn within_limits(&self, mut coordinates: Range<usize>) -> bool {
        let m = self.manipulator;
        coordinates.all(|coordinate| {
            let displaced = self.solution.joints()[coordinate] - m.coordinates()[coordinate].home;
            m.limits()[coordinate].admits(JointDisplacement::Value(displaced))
        })
    }
}
