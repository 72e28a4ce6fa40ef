//! Displacements at random, with their actuated joints, from which equations are fitted.

use super::quadrics::{Coordinates, study};
use crate::decomposition::whole::end;
use crate::manipulator::{Manipulator, Mode};
use crate::mechanism::joint::JointCoordinate;
use crate::numeric::Quantity;
use fastrand::Rng;
use nalgebra::Isometry3;

/// So many poses are tried for each sample.
const TRIES: usize = 40;
/// Samples are up to so far from home, radians and sizes; where such poses are out of reach, nearer, but not much nearer.
const FARTHEST: f64 = 1.2;
const NEAREST: f64 = 0.15;

/// A displacement of the platform, with the displacements of all actuated joints.
pub struct Sample {
    pub x: Coordinates,
    pub actuated: Vec<f64>,
}

/// Displacements of the platform in any mode. `None` where too few are found.
pub fn of_platform(m: &Manipulator, rng: &mut Rng, count: usize) -> Option<Vec<Sample>> {
    let modes: Vec<Mode> = m.modes().take(1 << 12).collect();
    let (home, mut solution) = (m.home_pose(), m.solution());
    let mut found = Vec::with_capacity(count);
    let (mut reach, mut pose) = (1.0_f64, home.clone());
    for _ in 0..TRIES * (count + TRIES) {
        if found.len() == count {
            return Some(found);
        }
        for ((value, home), c) in pose.iter_mut().zip(&home).zip(m.task_coordinates()) {
            *value = home + reach * unit(c.quantity, m.closure.size) * (2.0 * rng.f64() - 1.0);
        }
        let mode = modes[rng.usize(..modes.len())];
        match m.inverse(&pose, mode, &mut solution) {
            Ok(Some(solution)) => {
                let displaced = |&c: &usize| solution.joints()[c] - m.coordinates()[c].home;
                let actuated = m.actuated().iter().map(displaced).collect();
                found.push(Sample::new(&solution.displacement(m), actuated, m.closure.size));
                reach = f64::min(1.02 * reach, FARTHEST);
            }
            _ => reach = f64::max(0.98 * reach, NEAREST),
        }
    }
    None
}

/// Displacements of the end of a leg.
pub fn of_leg(m: &Manipulator, leg: usize, rng: &mut Rng, count: usize) -> Vec<Sample> {
    let own = m.coordinates_of_legs()[leg].clone();
    let sample = |_| {
        let mut value = |c: &JointCoordinate| {
            FARTHEST * unit(c.quantity, m.closure.size) * (2.0 * rng.f64() - 1.0)
        };
        let mut values: Vec<f64> = m.coordinates()[own.clone()].iter().map(&mut value).collect();
        m.mechanism().legs[leg].hold_parallelograms(&mut values);
        let of = |c: &usize| if own.contains(c) { values[c - own.start] } else { 0.0 };
        let actuated = m.actuated().iter().map(of).collect();
        Sample::new(&end(&m.mechanism().legs[leg], &values), actuated, m.closure.size)
    };
    (0..count).map(sample).collect()
}

fn unit(quantity: Quantity, size: f64) -> f64 {
    match quantity {
        Quantity::Angle => 1.0,
        Quantity::Length => size,
    }
}

impl Sample {
    fn new(g: &Isometry3<f64>, actuated: Vec<f64>, size: f64) -> Self {
        let moved = g.translation.vector / size;
        Self { x: study(g.rotation.quaternion(), moved.into()), actuated }
    }
}
