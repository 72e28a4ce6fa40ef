//! The branches of a leg by its closed form, and by the numeric solver.

use crate::newton::{Closure, displacement};
use crate::poses::DEVIATIONS;
use fastrand::Rng;
use nalgebra::{DVector, Isometry3};
use opm_core::decomposition::{Decomposition, LegSplit};
use opm_core::group::MotionType;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{CompileError, Manipulator, PoseError};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use std::f64::consts::PI;

/// Random starts for a leg. A leg has at most four solutions, and these starts find all of them except for one leg
/// in thousands.
const STARTS: usize = 80;
/// Random starts if fewer solutions are found than there are branches.
const MORE: usize = 5_000;
/// Two solutions are the same if their joints' displacements, as matrices with lengths over the size, differ by less.
const SAME: f64 = 1e-5;
/// Where joints miss their subspaces, solutions differ by so many times that.
const MISFITS: f64 = 1e3;
/// But two that differ by more are different.
const MOST: f64 = 1e-2;
/// If the smallest singular value of the leg's Jacobian is below this, two solutions nearly meet (a fold), and
/// neither solver can be expected to find the right number. Radians, and lengths over the size.
const FOLD: f64 = 2e-2;

/// A single leg.
pub struct Alone {
    manipulator: Manipulator,
    cylindrical: [bool; 2],
    split: LegSplit,
    /// The length that lengths are compared with, metres.
    size: f64,
    /// By how much the joints miss their subspaces, radians and shares of the size.
    misfit: f64,
}

/// What a comparison of branches found.
#[derive(Clone, Debug, PartialEq)]
pub enum Branches {
    /// Two solutions nearly meet, so they were not counted.
    Fold,
    /// Both have found the same solutions, so many.
    Same(usize),
    /// The numbers of solutions of the closed form and of the numeric solver, and of all different ones.
    Different {
        /// Branches of the closed form.
        branches: usize,
        /// Those of them that differ.
        distinct: usize,
        /// Solutions of the numeric solver.
        solutions: usize,
        /// Different solutions of either.
        either: usize,
    },
}

impl Alone {
    /// Leg `number` of a mechanism. Lengths are compared with `size`, metres.
    ///
    /// # Errors
    /// The leg alone cannot be compiled.
    pub fn new(
        mechanism: &Mechanism,
        decomposition: &Decomposition,
        number: usize,
        size: f64,
    ) -> Result<Self, CompileError> {
        let split = decomposition.legs[number].clone();
        let alone = Mechanism { legs: vec![mechanism.legs[number].clone()], ..mechanism.clone() };
        let misfit = decomposition.deviation;
        let legs = vec![split.clone()];
        let decomposition = Decomposition { legs, constrained: None, ..decomposition.clone() };
        let cylinder = |class: &SubspaceClass| matches!(class, SubspaceClass::Cylindrical { .. });
        let cylindrical = [cylinder(&decomposition.lower), cylinder(&decomposition.upper)];
        let manipulator = Manipulator::with_decomposition(alone, decomposition)?;
        Ok(Self { manipulator, cylindrical, split, size, misfit })
    }

    /// The leg, compiled.
    pub fn manipulator(&self) -> &Manipulator {
        &self.manipulator
    }

    fn leg(&self) -> &Leg {
        &self.manipulator.mechanism().legs[0]
    }

    /// Compares the solutions at a pose.
    ///
    /// # Errors
    /// The pose is not valid.
    pub fn compare(&self, pose: &[f64], rng: &mut Rng) -> Result<Branches, PoseError> {
        let closure = Closure {
            leg: self.leg(),
            point: self.manipulator.mechanism().platform,
            target: self.manipulator.task().displacement(pose),
            size: self.size,
            misfit: DEVIATIONS * self.misfit,
        };
        // Where the number of solutions changes, a misfit moves a pose by its square root.
        let fold = FOLD.max(5.0 * self.misfit.sqrt());
        let closed = self.closed_form(pose)?;
        let mut numeric = closure.solutions(STARTS, rng);
        if closed.iter().chain(&numeric).any(|q| closure.sharpness(q) < fold) {
            return Ok(Branches::Fold);
        }
        let (mut branches, mut solutions) = (Vec::new(), Vec::new());
        closed.iter().for_each(|q| self.add(&mut branches, q));
        for starts in [MORE, 0] {
            for q in numeric.iter().filter(|q| self.of_this_turn(q)) {
                self.add(&mut solutions, q);
            }
            if solutions.len() < branches.len() {
                numeric = closure.solutions(starts, rng);
            }
        }
        let mut either = solutions.clone();
        closed.iter().for_each(|q| self.add(&mut either, q));
        let numbers = [closed.len(), branches.len(), solutions.len(), either.len()];
        Ok(match numbers {
            [a, b, c, d] if a == b && b == c && c == d => Branches::Same(a),
            [branches, distinct, solutions, either] => {
                Branches::Different { branches, distinct, solutions, either }
            }
        })
    }

    /// The displacement of each joint, modulo 2π, lengths over the size. Joints on one axis, such as a screw and a
    /// slider, can give the same displacement a revolution apart, so they are compared together.
    fn parts(&self, q: &DVector<f64>) -> Vec<Isometry3<f64>> {
        let mut rest = q.as_slice();
        let each: Vec<_> = self.leg().joints.iter().map(|joint| take(joint, &mut rest)).collect();
        let border = self.split.lower.last().map_or(0, |freedom| freedom.joint + 1);
        let (lower, upper) = each.split_at(border);
        let section = |(part, together): (&[Isometry3<f64>], bool)| {
            let product = || part.iter().fold(Isometry3::identity(), |g, joint| g * joint);
            if together { vec![product()] } else { part.to_vec() }
        };
        [(lower, self.cylindrical[0]), (upper, self.cylindrical[1])]
            .into_iter()
            .flat_map(section)
            .map(|mut g| {
                g.translation.vector /= self.size;
                g
            })
            .collect()
    }

    /// A screw that is alone on a cylinder's axis follows the pose's angle, including full revolutions. The platform's
    /// displacement does not contain these, so a solution with another revolution belongs to another pose.
    fn of_this_turn(&self, q: &DVector<f64>) -> bool {
        let mut rest = q.as_slice();
        let sections = [&self.split.lower, &self.split.upper];
        self.leg().joints.iter().enumerate().all(|(number, joint)| {
            let (own, after) = rest.split_at(joint.freedoms());
            rest = after;
            let alone = sections.iter().zip(self.cylindrical).any(|(section, cylindrical)| {
                cylindrical && section.len() == 1 && section[0].joint == number
            });
            let translation = self.manipulator.task().shared() == Some(MotionType::Translation);
            let screw = matches!(joint.kind, JointKind::Helical { .. });
            !(alone && translation && screw) || own[0].abs() < PI
        })
    }

    fn add(&self, different: &mut Vec<Vec<Isometry3<f64>>>, q: &DVector<f64>) {
        let parts = self.parts(q);
        let off = |known: &Vec<Isometry3<f64>>| {
            known
                .iter()
                .zip(&parts)
                .map(|(a, b)| (a.to_homogeneous() - b.to_homogeneous()).amax())
                .fold(0.0, f64::max)
        };
        let same = SAME.max((MISFITS * self.misfit).min(MOST));
        if different.iter().all(|known| off(known) > same) {
            different.push(parts);
        }
    }

    /// The solutions of every branch, as displacements from home.
    fn closed_form(&self, pose: &[f64]) -> Result<Vec<DVector<f64>>, PoseError> {
        let mut all = self.manipulator.all_modes();
        let mut solution = self.manipulator.solution();
        self.manipulator.inverse_all(pose, &mut all)?;
        let modes: Vec<_> = all.modes(&self.manipulator).collect();
        let mut found = Vec::new();
        for mode in modes {
            if self.manipulator.solution_in_mode(&all, mode, &mut solution).is_some() {
                let coordinates = self.manipulator.coordinates();
                let q = solution.joints().iter().zip(coordinates).map(|(q, c)| q - c.home);
                found.push(DVector::from_iterator(coordinates.len(), q));
            }
        }
        Ok(found)
    }
}

fn take(joint: &Joint, rest: &mut &[f64]) -> Isometry3<f64> {
    let (own, after) = rest.split_at(joint.freedoms());
    *rest = after;
    displacement(joint, own)
}
