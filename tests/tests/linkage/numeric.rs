//! A solver that does not use the decomposition: Levenberg and Marquardt's method on the closure of
//! the loop, with the input held, from any start.

use fastrand::Rng;
use nalgebra::{SMatrix, SVector};
use opm_core::mechanism::Mechanism;
use std::f64::consts::PI;

/// Residual of a solution: a few times the rounding.
const SOLVED: f64 = 1e-12;
/// Step of the numeric derivative.
const STEP: f64 = 1e-7;
/// The number of steps. Where two solutions meet, each step only halves the error.
const ITERATIONS: usize = 300;
/// Two solutions that differ by less are the same.
pub const SAME: f64 = 1e-5;

type Residual = SVector<f64, 6>;
type Passive = SVector<f64, 5>;

/// The loop with one coordinate held.
pub struct Closure<'a> {
    mechanism: &'a Mechanism,
    input: usize,
    first: usize,
}

impl<'a> Closure<'a> {
    pub fn new(mechanism: &'a Mechanism, input: usize) -> Self {
        Self { mechanism, input, first: mechanism.legs[0].coordinates().count() }
    }

    fn joints(&self, value: f64, passive: &Passive) -> [f64; 6] {
        let mut rest = passive.iter();
        std::array::from_fn(|i| {
            if i == self.input { value } else { *rest.next().expect("five passive joints") }
        })
    }

    /// The difference between the platform's displacements by the two legs.
    fn residual(&self, joints: &[f64; 6]) -> Residual {
        let [one, two] = [0, 1].map(|i| &self.mechanism.legs[i]);
        let error = one.displacement(&joints[..self.first]).unwrap().inverse()
            * two.displacement(&joints[self.first..]).unwrap();
        let (turn, slide) = (error.rotation.scaled_axis(), error.translation.vector);
        Residual::from_iterator(turn.iter().chain(slide.iter()).copied())
    }

    /// A solution for the six joint values near `start`, or where the steps lead; `None` if they
    /// get stuck.
    pub fn solve(&self, value: f64, start: [f64; 6]) -> Option<[f64; 6]> {
        let mut rest = start.iter().enumerate().filter(|(i, _)| *i != self.input);
        let mut passive = Passive::from_fn(|_, _| *rest.next().expect("five of six").1);
        let mut damping = 1e-2;
        let mut residual = self.residual(&self.joints(value, &passive));
        for _ in 0..ITERATIONS {
            if residual.norm() < SOLVED {
                return Some(self.joints(value, &passive));
            }
            let mut jacobian = SMatrix::<f64, 6, 5>::zeros();
            for i in 0..5 {
                let mut moved = passive;
                moved[i] += STEP;
                let difference = self.residual(&self.joints(value, &moved)) - residual;
                jacobian.set_column(i, &(difference / STEP));
            }
            let normal = jacobian.tr_mul(&jacobian) + SMatrix::<f64, 5, 5>::identity() * damping;
            let step = normal.lu().solve(&jacobian.tr_mul(&residual))?;
            let tried = passive - step;
            let after = self.residual(&self.joints(value, &tried));
            if after.norm() < residual.norm() {
                (passive, residual) = (tried, after);
                damping = (damping * 0.1).max(1e-14);
            } else {
                damping *= 8.0;
            }
        }
        None
    }

    /// All different solutions that this many random starts find.
    pub fn all(&self, value: f64, starts: usize, rng: &mut Rng) -> Vec<[f64; 6]> {
        let mut found: Vec<[f64; 6]> = Vec::new();
        for _ in 0..starts {
            let start = std::array::from_fn(|_| (rng.f64() * 2.0 - 1.0) * PI);
            if let Some(solution) = self.solve(value, start)
                && found.iter().all(|known| distance(known, &solution) > SAME)
            {
                found.push(solution);
            }
        }
        found
    }
}

/// The largest difference of two sets of angles, modulo 2π.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| 2.0 * (0.5 * (a - b)).sin().abs()).fold(0.0, f64::max)
}
