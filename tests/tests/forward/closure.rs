//! A numeric solver for the closure of a mechanism with its actuated joints held. It uses joints
//! and legs, but no sections: the ends of all legs must coincide.

use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Isometry3, Point3, Vector3};
use opm_core::group::screw::Screw;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointKind, Quantity};
use std::f64::consts::TAU;

/// The largest number of steps from one start.
const STEPS: usize = 120;

/// Residual of closed legs: rounding in double precision, with lengths below one.
const CLOSED: f64 = 1e-12;

/// A mechanism with its actuated joints held.
pub struct Closure<'a> {
    mechanism: &'a Mechanism,
    /// The value of each coordinate that is held, `None` for the others.
    held: Vec<Option<f64>>,
}

impl<'a> Closure<'a> {
    pub fn new(mechanism: &'a Mechanism, actuated: &[f64]) -> Self {
        let mut next = actuated.iter().copied();
        let held = mechanism
            .joints()
            .flat_map(|joint| joint.coordinates.iter().map(|_| joint.actuated))
            .map(|actuated| if actuated { next.next() } else { None })
            .collect();
        Self { mechanism, held }
    }

    /// The different solutions found from random starts.
    pub fn solutions(&self, rng: &mut Rng, starts: usize) -> Vec<Vec<f64>> {
        let mut found: Vec<Vec<f64>> = Vec::new();
        for _ in 0..starts {
            let Some(joints) = self.approach(self.start(rng)) else { continue };
            if !found.iter().any(|other| self.same(other, &joints)) {
                found.push(joints);
            }
        }
        found
    }

    /// Whether two vectors of joint values are equal modulo 2π.
    pub fn same(&self, a: &[f64], b: &[f64]) -> bool {
        let mut first = 0;
        self.mechanism.joints().all(|joint| {
            let range = first..first + joint.freedoms();
            first = range.end;
            let [a, b] = [a, b].map(|q| joint.displacement(&q[range.clone()]).unwrap());
            match joint.kind {
                // The revolutions of a screw matter, but the end of its leg shows them.
                JointKind::Helical { .. } => a.rotation.angle_to(&b.rotation) < 1e-5,
                // A slider on the screw's axis moves with the screw.
                JointKind::Prismatic if !joint.actuated && self.has_screws() => true,
                _ => (a.to_homogeneous() - b.to_homogeneous()).amax() < 1e-5,
            }
        })
    }

    fn has_screws(&self) -> bool {
        self.mechanism.joints().any(|joint| matches!(joint.kind, JointKind::Helical { .. }))
    }

    fn start(&self, rng: &mut Rng) -> Vec<f64> {
        let coordinates = self.mechanism.coordinates().zip(&self.held);
        let mut joints: Vec<f64> = coordinates
            .map(|(c, held)| match (held, c.quantity) {
                (Some(value), _) => *value,
                (None, Quantity::Angle) => TAU * (rng.f64() - 0.5) + c.home,
                (None, Quantity::Length) => 0.6 * (rng.f64() - 0.5) + c.home,
            })
            .collect();
        // A rotation vector of π or more is replaced by the equivalent one below π.
        let mut first = 0;
        for joint in self.mechanism.joints() {
            if joint.kind == JointKind::Spherical {
                joints[first..first + 3].iter_mut().for_each(|q| *q *= 0.4);
            }
            first += joint.freedoms();
        }
        joints
    }

    /// Damped least squares from one start.
    fn approach(&self, start: Vec<f64>) -> Option<Vec<f64>> {
        let free: Vec<usize> = (0..start.len()).filter(|&i| self.held[i].is_none()).collect();
        let mut joints = start;
        let mut damping = 1e-2;
        let (mut gap, mut jacobian) = self.evaluate(&joints, &free);
        for _ in 0..STEPS {
            if gap.amax() < CLOSED {
                return Some(joints);
            }
            let mut normal = jacobian.tr_mul(&jacobian);
            for i in 0..free.len() {
                normal[(i, i)] += damping;
            }
            let step = normal.cholesky()?.solve(&jacobian.tr_mul(&gap));
            let mut tried = joints.clone();
            for (&i, step) in free.iter().zip(&step) {
                tried[i] -= step;
            }
            let (after, slope) = self.evaluate(&tried, &free);
            if after.norm() < gap.norm() {
                (joints, gap, jacobian) = (tried, after, slope);
                damping = (damping * 0.2).max(1e-14);
            } else {
                damping *= 4.0;
                if damping > 1e4 {
                    return None;
                }
            }
        }
        None
    }

    /// The difference of each leg's end from the first leg's, and its derivative by the free
    /// joints.
    fn evaluate(&self, joints: &[f64], free: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
        let legs = &self.mechanism.legs;
        let mut ends = Vec::new();
        // The twist of the end for every coordinate, and the leg of the coordinate.
        let mut twists: Vec<(usize, Screw)> = Vec::new();
        let mut first = 0;
        for (number, leg) in legs.iter().enumerate() {
            let mut g = Isometry3::identity();
            for joint in &leg.joints {
                let values = &joints[first..first + joint.freedoms()];
                first += joint.freedoms();
                twists.extend(rates(joint, values).iter().map(|s| (number, s.transformed(&g))));
                g *= joint.displacement(values).unwrap();
            }
            ends.push(g);
        }
        let p = self.mechanism.platform;
        let rows = 6 * (legs.len() - 1);
        let mut gap = DVector::zeros(rows);
        let mut jacobian = DMatrix::zeros(rows, free.len());
        let at = |s: &Screw, p: &Point3<f64>| s.linear + s.angular.cross(&p.coords);
        for k in 1..legs.len() {
            let turn = (ends[k].rotation * ends[0].rotation.inverse()).scaled_axis();
            let way = ends[k] * p - ends[0] * p;
            gap.fixed_rows_mut::<3>(6 * k - 6).copy_from(&turn);
            gap.fixed_rows_mut::<3>(6 * k - 3).copy_from(&way);
            for (column, &i) in free.iter().enumerate() {
                let (leg, twist) = &twists[i];
                let sign = if *leg == k { 1.0 } else { -1.0 };
                if *leg == k || *leg == 0 {
                    let way: Vector3<f64> = at(twist, &(ends[*leg] * p)) * sign;
                    let turn = twist.angular * sign;
                    jacobian.fixed_view_mut::<3, 1>(6 * k - 6, column).copy_from(&turn);
                    jacobian.fixed_view_mut::<3, 1>(6 * k - 3, column).copy_from(&way);
                }
            }
        }
        (gap, jacobian)
    }
}

/// The twist of a joint's outer link for a unit rate of each coordinate, without the joints nearer
/// the base.
fn rates(joint: &Joint, values: &[f64]) -> Vec<Screw> {
    match joint.kind {
        JointKind::Spherical => {
            // By differences, because a rotation vector has no fixed screws.
            const STEP: f64 = 1e-6;
            let here = joint.displacement(values).unwrap();
            (0..3)
                .map(|i| {
                    let mut moved = values.to_vec();
                    moved[i] += STEP;
                    let step = joint.displacement(&moved).unwrap() * here.inverse();
                    let turn = step.rotation.scaled_axis() / STEP;
                    Screw { angular: turn, linear: joint.point.coords.cross(&turn) }
                })
                .collect()
        }
        _ => {
            let screws = joint.screws();
            let mut g = Isometry3::identity();
            let mut moved = Vec::new();
            for (screw, (value, c)) in screws.iter().zip(values.iter().zip(&joint.coordinates)) {
                moved.push(screw.transformed(&g));
                g *= screw.exp(value - c.home);
            }
            moved
        }
    }
}
