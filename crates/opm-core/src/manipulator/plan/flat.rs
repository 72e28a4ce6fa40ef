//! Two commutative subspaces (cylindrical, translational plane): the legs' equations are linear in the
//! pose, and are solved once for all values of the actuated joints. For the 2-PPR + PPH manipulator this
//! is the 3×3 system of its three sliders (Eqs. 27-28 of the paper).

use super::super::{CompiledLeg, Section};
use super::HeldLeg;
use crate::chain::condition::{Condition, flat_joints};
use crate::group::{Displacement, JointDisplacement};
use crate::task::Task;
use nalgebra::{DMatrix, DVector};

/// The equations are dependent where a diagonal entry of the triangular factor is smaller than the largest
/// one by this factor.
const DEPENDENT: f64 = 1e-9;

/// `v` and `b` as linear functions of the actuated joints' displacements from home.
#[derive(Clone, Debug)]
pub struct Flat {
    /// The rows are the two numbers of `v` and the two of `b`; the columns are the actuated joints.
    matrix: DMatrix<f64>,
}

/// An equation of the system: on the left the coefficients of `v`, `b` and the legs' τ, on the right those of
/// the actuated joints.
struct Row {
    left: Vec<f64>,
    right: Vec<f64>,
}

impl Flat {
    /// Solves the system; `None` where the legs do not determine the pose.
    pub fn new(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg], size: f64) -> Option<Self> {
        let actuated_count = held.iter().map(|leg| leg.lower.len() + leg.upper.len()).sum();
        let mut rows = vec![Row {
            // b has no component along the intersection motion: v has all of it.
            left: {
                let mut left = vec![0.0; 4 + legs.len()];
                left[2..4].copy_from_slice(&task.upper_intersection.sum());
                left
            },
            right: vec![0.0; actuated_count],
        }];
        for (number, (leg, held)) in legs.iter().zip(held).enumerate() {
            for section in [Section::Lower, Section::Upper] {
                let compiled = leg.section(section);
                let (first, held, motion, sign) = match section {
                    Section::Lower => (0, &held.lower, &task.lower_intersection, 1.0),
                    Section::Upper => (2, &held.upper, &task.upper_intersection, -1.0),
                };
                let joints = flat_joints(&compiled.chain)?;
                let imaginary_joint = (section == leg.split_section).then_some(match section {
                    Section::Lower => 1,
                    Section::Upper => 0,
                });
                for joint in held.iter().copied().chain(imaginary_joint) {
                    let one =
                        Condition::new(&compiled.chain, joint, JointDisplacement::Value(1.0))?;
                    let Condition::Flat { normal: [a, b], .. } = one else { return None };
                    let mut row =
                        Row { left: vec![0.0; 4 + legs.len()], right: vec![0.0; actuated_count] };
                    row.left[first] = a;
                    row.left[first + 1] = b;
                    let [p, q] = motion.sum();
                    // The real joints make v + I τ or b − I τ. In a chain with the imaginary joint, the row
                    // of its other joint is perpendicular to I.
                    row.left[4 + number] = sign * (a * p + b * q);
                    if Some(joint) != imaginary_joint {
                        let number = compiled.coordinates[joint]?.actuated?;
                        let [p, q] = joints[joint];
                        row.right[number] = a * p + b * q;
                    }
                    rows.push(row);
                }
            }
        }
        // Lengths are divided by the size, so that no row or column is small because of its units.
        let mut scale = task.lower.kind.sum_units(size).to_vec();
        scale.extend(task.upper.kind.sum_units(size));
        scale.extend(vec![size; legs.len()]);
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
            matrix: DMatrix::from_fn(4, actuated_count, |i, j| solution[(i, j)] * scale[i]),
        })
    }

    /// The displacements `v` and `b` for the actuated joints' displacements from home.
    pub fn solve(&self, task: &Task, actuated: &[f64]) -> [Displacement; 2] {
        let x = &self.matrix * DVector::from_column_slice(actuated);
        [task.lower.kind.of_sum([x[0], x[1]]), task.upper.kind.of_sum([x[2], x[3]])]
    }
}
