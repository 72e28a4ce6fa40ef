//! The bodies of a mechanism, whose energies come from where they are, and their velocities from differences.

use nalgebra::{DVector, Vector3};
use opm_analysis::Gravity;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::skeleton::{Configuration, Mass, Skeleton};

/// A mechanism with its bodies.
pub struct Bodies<'a> {
    manipulator: &'a Manipulator,
    skeleton: Skeleton,
    masses: Vec<Mass>,
    gravity: Vector3<f64>,
}

impl<'a> Bodies<'a> {
    pub fn new(manipulator: &'a Manipulator, gravity: &Gravity) -> Self {
        let skeleton = Skeleton::new(manipulator.mechanism(), None);
        let masses = skeleton.masses(manipulator.mechanism(), gravity.density);
        Self { manipulator, skeleton, masses, gravity: gravity.acceleration }
    }

    pub fn solved(&self, pose: &[f64]) -> Option<Solution> {
        let mut at = self.manipulator.solution();
        self.manipulator.inverse(pose, self.manipulator.home_mode(), &mut at).ok()??;
        Some(at)
    }

    /// Where all bodies are at a pose.
    pub fn placed(&self, pose: &[f64]) -> Option<Vec<nalgebra::Isometry3<f64>>> {
        let at = self.solved(pose)?;
        let platform = at.displacement(self.manipulator);
        let configuration = Configuration { joints: at.joints(), imaginary: &[], platform };
        self.skeleton.place_in_base(&configuration).ok()
    }

    /// The kinetic energy at a pose for rates of its coordinates.
    pub fn kinetic(&self, pose: &DVector<f64>, rates: &DVector<f64>) -> Option<f64> {
        const STEP: f64 = 1e-5;
        let here = self.placed(pose.as_slice())?;
        let [after, before] =
            [STEP, -STEP].map(|step| self.placed((pose + rates * step).as_slice()));
        let (after, before) = (after?, before?);
        let mut energy = 0.0;
        for (k, mass) in self.masses.iter().enumerate().skip(1) {
            let velocity = (after[k] * mass.centre - before[k] * mass.centre) / (2.0 * STEP);
            let turned = after[k].rotation * before[k].rotation.inverse();
            let angular = turned.scaled_axis() / (2.0 * STEP);
            let own = here[k].rotation.inverse() * angular;
            energy += 0.5 * (mass.mass * velocity.norm_squared() + own.dot(&(mass.inertia * own)));
        }
        Some(energy)
    }

    pub fn potential(&self, pose: &DVector<f64>) -> Option<f64> {
        let here = self.placed(pose.as_slice())?;
        let of = |(at, mass): (&nalgebra::Isometry3<f64>, &Mass)| {
            -mass.mass * self.gravity.dot(&(at * mass.centre).coords)
        };
        Some(here.iter().zip(&self.masses).skip(1).map(of).sum())
    }
}
