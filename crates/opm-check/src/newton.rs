//! A solver for one leg that uses no subspaces, splits or chains: damped Gauss-Newton steps
//! (Levenberg and Marquardt) on the leg's product of exponentials, six equations in its joint
//! coordinates, from many random starts.

use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Matrix6xX, Point3, Vector3, Vector6};
use opm_core::mechanism::joint::{JointKind, Quantity};
use opm_core::mechanism::leg::Leg;
use std::f64::consts::PI;

/// Residual of a solution, in radians and lengths over the size: rounding.
const SOLVED: f64 = 1e-11;
/// The largest number of steps from one start.
const STEPS: usize = 60;
/// Starting values of sliders are within this many sizes of home.
const FAR: f64 = 4.0;

/// A leg that shall bring the platform's point and orientation to `target`.
pub struct Closure<'a> {
    /// The leg.
    pub leg: &'a Leg,
    /// The platform's reference point at home.
    pub point: Point3<f64>,
    /// The platform's displacement from home.
    pub target: Isometry3<f64>,
    /// The length that lengths are compared with, metres.
    pub size: f64,
    /// What a leg may miss the target by, because its joints miss their subspaces: radians, and lengths over the size. Its
    /// solutions are then where it misses least.
    pub misfit: f64,
}

impl Closure<'_> {
    /// Every solution found from the starts, as displacements of the joints from home. The same
    /// solution may be listed many times.
    pub fn solutions(&self, starts: usize, rng: &mut Rng) -> Vec<DVector<f64>> {
        let quantities: Vec<Quantity> = self.leg.coordinates().map(|c| c.quantity).collect();
        let mut found = Vec::new();
        for _ in 0..starts {
            let start = quantities.iter().map(|quantity| {
                let size = if *quantity == Quantity::Angle { PI } else { FAR * self.size };
                size * (rng.f64() * 2.0 - 1.0)
            });
            let mut start = DVector::from_iterator(quantities.len(), start);
            self.leg.hold_parallelograms(start.as_mut_slice());
            found.extend(self.solve(start));
        }
        found
    }

    fn solve(&self, q: DVector<f64>) -> Option<DVector<f64>> {
        let (q, miss) = self.approach(q)?;
        (miss < SOLVED.max(self.misfit)).then_some(q)
    }

    /// The values to which steps lead, and by how much they miss the target.
    fn approach(&self, mut q: DVector<f64>) -> Option<(DVector<f64>, f64)> {
        let (mut miss, mut jacobian) = self.linear(&q, rates);
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            if miss.norm() < SOLVED {
                break;
            }
            let normal = jacobian.tr_mul(&jacobian) + DMatrix::identity(q.len(), q.len()) * damping;
            let mut step = normal.cholesky()?.solve(&jacobian.tr_mul(&miss));
            for (step, coordinate) in step.iter_mut().zip(self.leg.coordinates()) {
                if coordinate.quantity == Quantity::Length {
                    *step *= self.size;
                }
            }
            self.leg.hold_parallelograms(step.as_mut_slice());
            let tried = &q + step;
            let (after, derivative) = self.linear(&tried, rates);
            if after.norm() < miss.norm() {
                (q, miss, jacobian) = (tried, after, derivative);
                damping = (damping * 0.1).max(1e-15);
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        Some((q, miss.norm()))
    }

    /// The smallest singular value of the leg's Jacobian: nearly zero where two solutions meet. A
    /// spherical joint contributes its angular velocity.
    pub fn sharpness(&self, q: &DVector<f64>) -> f64 {
        let (_, jacobian) = self.linear(q, |_| Matrix3::identity());
        let back = self.leg.turn_back();
        let led: Vec<usize> = (0..back.len()).filter(|&number| back[number]).collect();
        let jacobian = jacobian.remove_columns_at(&led);
        let squares = jacobian.tr_mul(&jacobian).symmetric_eigenvalues();
        squares.min().max(0.0).sqrt()
    }

    /// The error to the target (a rotation vector and the translation of the point), and the twist
    /// of the platform for a unit rate of each coordinate, with the point's velocity. Lengths are over the size.
    fn linear(
        &self,
        q: &DVector<f64>,
        rates: impl Fn(&Vector3<f64>) -> Matrix3<f64>,
    ) -> (Vector6<f64>, Matrix6xX<f64>) {
        let mut g = Isometry3::identity();
        let mut lines: Vec<(Vector3<f64>, Point3<f64>, f64, bool)> = Vec::new();
        let mut rest = q.as_slice();
        for joint in &self.leg.joints {
            let (own, after) = rest.split_at(joint.freedoms());
            rest = after;
            let (axis, at) = (g * joint.axis.into_inner(), g * joint.point);
            match joint.kind {
                JointKind::Revolute => lines.push((axis, at, 0.0, true)),
                JointKind::Helical { pitch } => lines.push((axis, at, pitch, true)),
                JointKind::Prismatic => lines.push((axis, at, 1.0, false)),
                JointKind::Cylindrical => {
                    lines.extend([(axis, at, 0.0, true), (axis, at, 1.0, false)]);
                }
                JointKind::Universal { second } => {
                    let turn = nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, own[0]);
                    let second = g * (turn * second.into_inner());
                    lines.extend([(axis, at, 0.0, true), (second, at, 0.0, true)]);
                }
                JointKind::Spherical => {
                    let rates = rates(&Vector3::from_column_slice(own));
                    for i in 0..3 {
                        lines.push((g * rates.column(i).into_owned(), at, 0.0, true));
                    }
                }
            }
            g *= displacement(joint, own);
        }
        let end = g * self.point;
        let back = self.leg.turn_back();
        let mut jacobian = Matrix6xX::zeros(lines.len());
        for (i, (axis, at, pitch, turns)) in lines.into_iter().enumerate() {
            let (turn, way) = if turns {
                (axis, (axis.cross(&(end - at)) + axis * pitch) / self.size)
            } else {
                (Vector3::zeros(), axis)
            };
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&turn);
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&way);
        }
        // A rate of the first hinge of a parallelogram is one of both; the second has none of its own.
        for number in (1..jacobian.ncols()).filter(|&number| back[number]) {
            let led = jacobian.column(number).into_owned();
            jacobian.column_mut(number).fill(0.0);
            let mut first = jacobian.column_mut(number - 1);
            first -= led;
        }
        let turn = (self.target.rotation * g.rotation.inverse()).scaled_axis();
        let way = (self.target * self.point - end) / self.size;
        (Vector6::new(turn.x, turn.y, turn.z, way.x, way.y, way.z), jacobian)
    }
}

/// The displacement of a joint by amounts from home.
pub fn displacement(joint: &opm_core::mechanism::joint::Joint, amounts: &[f64]) -> Isometry3<f64> {
    let values: Vec<f64> =
        joint.coordinates.iter().zip(amounts).map(|(c, amount)| c.home + amount).collect();
    joint.displacement(&values).expect("a value for each coordinate")
}

/// The angular velocity for unit rates of a rotation vector, one per column.
fn rates(r: &Vector3<f64>) -> Matrix3<f64> {
    let angle = r.norm();
    let cross = r.cross_matrix();
    let (one, two) = if angle < 1e-4 {
        (0.5, 1.0 / 6.0)
    } else {
        ((1.0 - angle.cos()) / angle.powi(2), (angle - angle.sin()) / angle.powi(3))
    };
    Matrix3::identity() + cross * one + cross * cross * two
}
