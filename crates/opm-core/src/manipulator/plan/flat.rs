//! Two commutative subspaces (cylindrical, translational plane, translational space): the legs' equations are linear in the
//! pose, and are solved once for all values of the actuated joints. For the 2-PPR + PPH manipulator this
//! is the 3×3 system of its three sliders (Eqs. 27-28 of the paper).

use super::super::{CompiledLeg, Section};
use super::HeldLeg;
use crate::chain::condition::{Condition, flat_joints};
use crate::group::{Displacement, JointDisplacement, LocalTwist, SubspaceKind};
use crate::task::Task;
use nalgebra::{DMatrix, DVector};

/// The equations are dependent where a diagonal entry of the triangular factor is smaller than the largest
/// one by this factor.
const DEPENDENT: f64 = 1e-9;

/// `v` and `b` as linear functions of the actuated joints' displacements from home.
#[derive(Clone, Debug)]
pub struct Flat {
    /// The rows are the numbers of `v` and those of `b`, as many as the subspaces have dimensions; the columns are
    /// the actuated joints.
    matrix: DMatrix<f64>,
}

/// An equation of the system: on the left the coefficients of `v`, `b` and the legs' τ, on the right those of
/// the actuated joints.
struct LinearEquation {
    left: Vec<f64>,
    right: Vec<f64>,
}

impl Flat {
    /// Solves the system; `None` where the legs do not determine the pose.
    pub fn new(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg], size: f64) -> Option<Self> {
        let actuated_count = held.iter().map(|leg| leg.lower.len() + leg.upper.len()).sum();
        let (lower, upper) = (task.lower.kind, task.upper.kind);
        let pose_count = lower.dimension() + upper.dimension();
        let row = |section: Section, coefficients: &LocalTwist| {
            let mut left = vec![0.0; pose_count + legs.len()];
            let (first, kind) = match section {
                Section::Lower => (0, lower),
                Section::Upper => (lower.dimension(), upper),
            };
            let coefficients = &coefficients.as_slice()[..kind.dimension()];
            left[first..first + kind.dimension()].copy_from_slice(coefficients);
            LinearEquation { left, right: vec![0.0; actuated_count] }
        };
        // b has no component along the intersection motion: v has all of it.
        let mut rows = vec![row(Section::Upper, &task.upper_intersection.sum())];
        for (number, (leg, held)) in legs.iter().zip(held).enumerate() {
            for section in [Section::Lower, Section::Upper] {
                let compiled = leg.section(section);
                let (held, motion, sign) = match section {
                    Section::Lower => (&held.lower, &task.lower_intersection, 1.0),
                    Section::Upper => (&held.upper, &task.upper_intersection, -1.0),
                };
                let joints = flat_joints(&compiled.chain)?;
                let imaginary_joint =
                    leg.imaginary_joint().filter(|_| section == leg.split_section);
                for joint in held.iter().copied().chain(imaginary_joint) {
                    let one =
                        Condition::new(&compiled.chain, joint, JointDisplacement::Value(1.0))?;
                    let Condition::Flat { normal, .. } = one else { return None };
                    let mut row = row(section, &normal);
                    // The real joints make v + I τ or b − I τ. In a chain with the imaginary joint, the rows
                    // of its other joints are perpendicular to I.
                    row.left[pose_count + number] = sign * normal.dot(&motion.sum());
                    if Some(joint) != imaginary_joint {
                        let number = compiled.coordinates[joint]?.actuated?;
                        row.right[number] = normal.dot(&joints[joint]);
                    }
                    rows.push(row);
                }
            }
        }
        // Lengths are divided by the size, so that no row or column is small because of its units.
        let units =
            |kind: SubspaceKind| kind.sum_units(size).as_slice()[..kind.dimension()].to_vec();
        let scale = [units(lower), units(upper), vec![size; legs.len()]].concat();
        let columns = scale.len();
        let mut left = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i].left[j] * scale[j]);
        let mut right = DMatrix::from_fn(rows.len(), actuated_count, |i, j| rows[i].right[j]);
        for i in 0..rows.len() {
            let largest = left.row(i).amax();
            if largest > 0.0 {
                left.row_mut(i).unscale_mut(largest);
                right.row_mut(i).unscale_mut(largest);
            }
        }
        if rows.len() < columns {
            return None;
        }
        let qr = left.qr();
        let triangle = qr.r();
        let diagonal = triangle.diagonal().abs();
        if diagonal.min() <= DEPENDENT * diagonal.max() {
            return None;
        }
        let solution = triangle.solve_upper_triangular(&qr.q().tr_mul(&right))?;
        Some(Self {
            matrix: DMatrix::from_fn(pose_count, actuated_count, |i, j| {
                solution[(i, j)] * scale[i]
            }),
        })
    }

    /// The displacements `v` and `b` for the actuated joints' displacements from home.
    pub fn solve(&self, task: &Task, actuated: &[f64]) -> [Displacement; 2] {
        let x = &self.matrix * DVector::from_column_slice(actuated);
        let (of_lower, of_upper) = x.as_slice().split_at(task.lower.dimension());
        let displacement = |kind: SubspaceKind, numbers: &[f64]| {
            kind.of_sum(&LocalTwist::from_fn(|i, _| numbers.get(i).copied().unwrap_or(0.0)))
        };
        [displacement(task.lower.kind, of_lower), displacement(task.upper.kind, of_upper)]
    }
}
