//! Newton's method for the pose at which the actuated joints are nearest to given values. Derivatives are differences of
//! inverse kinematics: the least sum depends on the pose by its square, so that their errors do not matter.

use crate::manipulator::{ActuatedJoints, Manipulator, Mode};
use crate::numeric::Quantity;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Half the differences between poses, radians and shares of the size. The first one tells curvatures best, the last one
/// slopes, also where coordinates are nearly singular.
const DIFFERENCES: [f64; 3] = [1e-4, 1e-5, 1e-6];
/// The longest step, in the same units, and the one that ends the search.
const LONGEST: f64 = 0.5;
const SHORTEST: f64 = 1e-11;
/// The largest number of steps.
const STEPS: usize = 60;
/// Curvatures below this share of the largest count as this.
const FLAT: f64 = 1e-10;

/// The search for the nearest joints.
pub(super) struct Descent<'a> {
    manipulator: &'a Manipulator,
    given: &'a [f64],
    /// The unit of each joint: the size where it is a length, otherwise one.
    units: Vec<f64>,
    /// What each joint weighs.
    weights: Vec<f64>,
    modulo: Vec<bool>,
    /// The unit of each coordinate.
    scales: Vec<f64>,
    buffer: ActuatedJoints,
}

impl<'a> Descent<'a> {
    pub fn new(manipulator: &'a Manipulator, given: &'a [f64]) -> Self {
        let size = manipulator.characteristic_length();
        let unit = |quantity| if quantity == Quantity::Length { size } else { 1.0 };
        let joints = manipulator.actuated().iter().map(|&i| &manipulator.coordinates()[i]);
        let coordinates = manipulator.task_coordinates().iter();
        Self {
            manipulator,
            given,
            units: joints.map(|c| unit(c.quantity)).collect(),
            weights: vec![1.0; given.len()],
            modulo: manipulator.modulo_revolutions(),
            scales: coordinates.map(|c| unit(c.quantity)).collect(),
            buffer: manipulator.actuated_joints(),
        }
    }

    /// Sets what each joint weighs.
    pub fn weigh(&mut self, weight: impl Fn(usize) -> f64) {
        self.weights = (0..self.given.len()).map(weight).collect();
    }

    /// The unit of a joint, metres or radians.
    pub fn unit(&self, joint: usize) -> f64 {
        self.units[joint]
    }

    /// Whether a joint is an angle whose revolutions do not count.
    pub fn counts_modulo(&self, joint: usize) -> bool {
        self.modulo[joint]
    }

    /// The changes with which the joints have their values at a pose; `None` if that is out of reach.
    pub fn changes(&mut self, pose: &[f64], mode: Mode) -> Option<Vec<f64>> {
        let found = self.manipulator.inverse_actuated(pose, mode, &mut self.buffer).ok()??;
        let changes = found.actuated().iter().zip(self.given).zip(&self.modulo);
        let wrapped = changes.map(|((there, given), modulo)| {
            let change = there - given;
            if *modulo && change.abs() > PI {
                change - TAU * (change / TAU).round()
            } else {
                change
            }
        });
        Some(wrapped.collect())
    }

    /// The changes in their units, times their weights.
    fn weighed(&mut self, pose: &[f64], mode: Mode) -> Option<DVector<f64>> {
        let changes = self.changes(pose, mode)?;
        let units = self.units.iter().zip(&self.weights);
        let each = changes.iter().zip(units).map(|(change, (unit, weight))| change / unit * weight);
        let all: Vec<f64> = each.collect();
        all.iter().all(|x| x.is_finite()).then(|| DVector::from_vec(all))
    }

    /// The sum of the squared changes.
    pub fn sum(&mut self, pose: &[f64], mode: Mode) -> Option<f64> {
        Some(self.weighed(pose, mode)?.norm_squared())
    }

    /// The pose to which steps lead, and the sum there; `None` if the start is out of reach.
    pub fn minimise(&mut self, mut pose: Vec<f64>, mode: Mode) -> Option<(f64, Vec<f64>)> {
        let mut sum = self.sum(&pose, mode)?;
        for difference in DIFFERENCES {
            let mut radius = LONGEST;
            for _ in 0..STEPS {
                let Some(step) = self.newton(&pose, mode, difference) else { break };
                let length = step.norm();
                let mut share = (radius / length).min(1.0);
                let taken = loop {
                    if share * length < SHORTEST || !length.is_finite() {
                        break None;
                    }
                    let moved = self.moved(&pose, |i| share * step[i]);
                    match self.sum(&moved, mode) {
                        Some(after) if after < sum => break Some((after, moved)),
                        _ => share *= 0.25,
                    }
                };
                let Some((after, moved)) = taken else { break };
                radius = (2.0 * share * length).min(LONGEST);
                (sum, pose) = (after, moved);
            }
        }
        Some((sum, pose))
    }

    fn moved(&self, pose: &[f64], by: impl Fn(usize) -> f64) -> Vec<f64> {
        let coordinates = pose.iter().zip(&self.scales).enumerate();
        coordinates.map(|(i, (q, scale))| q + scale * by(i)).collect()
    }

    /// The step of Newton's method, in units of the coordinates, downhill in every direction; `None` at the boundary of
    /// reach.
    fn newton(&mut self, pose: &[f64], mode: Mode, difference: f64) -> Option<DVector<f64>> {
        let n = pose.len();
        let at = self.weighed(pose, mode)?;
        let mut beside = Vec::with_capacity(n);
        for i in 0..n {
            let mut side = |sign: f64| {
                let there = self.moved(pose, |k| if k == i { sign * difference } else { 0.0 });
                self.weighed(&there, mode)
            };
            beside.push([side(1.0)?, side(-1.0)?]);
        }
        let jacobian = DMatrix::from_fn(at.len(), n, |k, i| {
            (beside[i][0][k] - beside[i][1][k]) / (2.0 * difference)
        });
        let gradient = jacobian.tr_mul(&at);
        // Of the second derivatives of the half sum, J' J is known; the rest are those of the joints, times the changes.
        let mut curvature = jacobian.tr_mul(&jacobian);
        for i in 0..n {
            let [plus, minus] = &beside[i];
            let second = (plus + minus - &at * 2.0) / (difference * difference);
            curvature[(i, i)] += second.dot(&at);
            for k in 0..i {
                let corner = |me: &mut Self, [a, b]: [f64; 2]| {
                    let by = |number: usize| match number {
                        number if number == i => a * difference,
                        number if number == k => b * difference,
                        _ => 0.0,
                    };
                    let there = me.moved(pose, by);
                    me.weighed(&there, mode)
                };
                let same = corner(self, [1.0, 1.0])? + corner(self, [-1.0, -1.0])?;
                let opposite = corner(self, [1.0, -1.0])? + corner(self, [-1.0, 1.0])?;
                let mixed = (same - opposite).dot(&at) / (4.0 * difference * difference);
                curvature[(i, k)] += mixed;
                curvature[(k, i)] += mixed;
            }
        }
        let eigen = curvature.symmetric_eigen();
        let largest = eigen.eigenvalues.amax();
        if largest == 0.0 || !largest.is_finite() {
            return None;
        }
        let mut along = eigen.eigenvectors.tr_mul(&gradient);
        for (component, value) in along.iter_mut().zip(&eigen.eigenvalues) {
            *component /= -value.abs().max(FLAT * largest);
        }
        Some(eigen.eigenvectors * along)
    }
}
