//! A solver that does not use the decomposition: Levenberg and Marquardt's method on the closure of
//! the loop, with the input held, from any start.

use fastrand::Rng;
use nalgebra::{SMatrix, SVector, Vector6};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::Quantity;
use std::f64::consts::PI;

/// Residual of a solution: a few times the rounding.
const SOLVED: f64 = 1e-12;
/// Step of the numeric derivative.
const STEP: f64 = 1e-7;
/// The number of steps. Where two solutions meet, each step only halves the error.
const ITERATIONS: usize = 300;
/// Two solutions that differ by less are the same.
pub const SAME: f64 = 1e-5;
/// Starting values of sliders are within this many metres of zero.
const FAR: f64 = 3.0;

/// The loop with one coordinate held.
pub struct Closure<'a> {
    mechanism: &'a Mechanism,
    input: usize,
    first: usize,
    quantities: Vec<Quantity>,
}

impl<'a> Closure<'a> {
    pub fn new(mechanism: &'a Mechanism, input: usize) -> Self {
        let quantities = mechanism.coordinates().map(|c| c.quantity).collect();
        Self { mechanism, input, first: mechanism.legs[0].coordinates().count(), quantities }
    }

    /// The difference between the platform's displacements by the two legs.
    fn residual(&self, joints: &[f64]) -> Vector6<f64> {
        let [one, two] = [0, 1].map(|i| &self.mechanism.legs[i]);
        let error = one.displacement(&joints[..self.first]).unwrap().inverse()
            * two.displacement(&joints[self.first..]).unwrap();
        let (turn, slide) = (error.rotation.scaled_axis(), error.translation.vector);
        Vector6::from_iterator(turn.iter().chain(slide.iter()).copied())
    }

    /// A solution for the joint values near `start`, or where the steps lead; `None` if they get
    /// stuck.
    pub fn solve(&self, value: f64, start: &[f64]) -> Option<Vec<f64>> {
        let mut joints = start.to_vec();
        joints[self.input] = value;
        let passive: Vec<usize> = (0..joints.len()).filter(|&i| i != self.input).collect();
        let mut damping = 1e-2;
        let mut residual = self.residual(&joints);
        for _ in 0..ITERATIONS {
            if residual.norm() < SOLVED {
                return Some(joints);
            }
            // A column of zeros stays for each joint that is missing from six.
            let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
            for (column, &joint) in passive.iter().enumerate() {
                let before = joints[joint];
                joints[joint] += STEP;
                jacobian.set_column(column, &((self.residual(&joints) - residual) / STEP));
                joints[joint] = before;
            }
            let normal = jacobian.tr_mul(&jacobian) + SMatrix::<f64, 6, 6>::identity() * damping;
            let step: SVector<f64, 6> = normal.lu().solve(&jacobian.tr_mul(&residual))?;
            let mut tried = joints.clone();
            passive.iter().zip(step.iter()).for_each(|(&joint, step)| tried[joint] -= step);
            let after = self.residual(&tried);
            if after.norm() < residual.norm() {
                (joints, residual) = (tried, after);
                damping = (damping * 0.1).max(1e-14);
            } else {
                damping *= 8.0;
            }
        }
        None
    }

    /// All different solutions that this many random starts find.
    pub fn all(&self, value: f64, starts: usize, rng: &mut Rng) -> Vec<Vec<f64>> {
        let mut found: Vec<Vec<f64>> = Vec::new();
        for _ in 0..starts {
            let start: Vec<f64> = (self.quantities.iter())
                .map(|quantity| {
                    let size = if *quantity == Quantity::Angle { PI } else { FAR };
                    (rng.f64() * 2.0 - 1.0) * size
                })
                .collect();
            if let Some(solution) = self.solve(value, &start)
                && found.iter().all(|known| self.distance(known, &solution) > SAME)
            {
                found.push(solution);
            }
        }
        found
    }

    /// The largest difference of two sets of joint values, of angles modulo 2π.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let of = |(i, quantity): (usize, &Quantity)| match quantity {
            Quantity::Angle => distance(&a[i..=i], &b[i..=i]),
            Quantity::Length => (a[i] - b[i]).abs(),
        };
        self.quantities.iter().enumerate().map(of).fold(0.0, f64::max)
    }
}

/// The largest difference of two sets of angles, modulo 2π.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| 2.0 * (0.5 * (a - b)).sin().abs()).fold(0.0, f64::max)
}
