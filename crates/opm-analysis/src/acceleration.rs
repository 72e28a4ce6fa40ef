//! The accelerations that the actuators give the platform from rest, whatever the direction: the *acceleration radius* (T. Graettinger,
//! B. Krogh, *The acceleration radius: a global performance measure for robotic manipulators*, IEEE J. Robotics and Automation 4
//! (1988)).
//!
//! From rest, an acceleration `z̈` of the independent velocities ([`Statics`]) takes the work `M z̈` for each of them, and weights and
//! loads do the work `w`. The actuators bear `w - M z̈` if it is in their wrench polytope: `|n · (w - M z̈)| ≤ b` for every facet
//! (see `capacity`). So the accelerations are a polytope, too. Translations are looked at where the platform does not turn, and rotations
//! where its reference point stays: `z̈ = V c` with orthonormal columns of `V`, and the largest ball of `c` around rest has the radius
//! `min (b - |n · w|) / |Vᵀ M n|`.

use crate::setup::Loads;
use crate::statics::{MOST, Statics, Velocity};
use crate::weights::{JointMotion, Part};
use nalgebra::{Matrix6, Vector6};
use opm_core::manipulator::Solution;

/// A motion of this share of the whole is rounding, squared.
const ROUNDING: f64 = 1e-12;

/// The largest accelerations from rest in the worst direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerationRadius {
    /// The largest acceleration that the actuators give the platform in every direction in which it translates without turning,
    /// m/s²; infinite if no actuator that has a limit moves with it, negative if they do not even hold the mechanism. `None` if
    /// there is no such direction.
    pub linear: Option<f64>,
    /// The largest angular acceleration about every axis through the reference point about which the platform turns, rad/s²;
    /// likewise.
    pub angular: Option<f64>,
}

/// Motions of the platform without the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pure {
    /// The platform does not turn.
    Translations,
    /// Its reference point stays.
    Rotations,
}

impl Statics<'_> {
    /// The independent velocities that are such motions: the first of these orthonormal columns, and their number.
    pub(crate) fn pure(&self, motions: Pure) -> (Matrix6<f64>, usize) {
        let first = if motions == Pure::Translations { 0 } else { 3 };
        let mut square = Matrix6::identity();
        for i in 0..self.free {
            let still = |k: usize| self.twists.fixed_view::<3, 1>(first, k);
            (0..self.free).for_each(|k| square[(i, k)] = still(i).dot(&still(k)));
        }
        let eigen = square.symmetric_eigen();
        let (mut kept, mut count) = (Matrix6::zeros(), 0);
        for k in (0..MOST).filter(|&k| eigen.eigenvalues[k] < ROUNDING) {
            kept.set_column(count, &eigen.eigenvectors.column(k));
            count += 1;
        }
        (kept, count)
    }
}

impl Loads<'_> {
    /// The largest accelerations from rest in the worst direction, within the `max_effort` of the actuators and on top of all loads,
    /// at a pose of which `statics` has taken the solution. Joints at rest have no friction. `None` at a serial singularity, where no
    /// actuator has a `max_effort`, and where the velocity of a link is not known. The masses are those of a setup with
    /// [`Gravity`](crate::Gravity).
    ///
    /// ```
    /// use opm_analysis::{Gravity, Loads, Setup, Statics};
    /// use opm_core::Manipulator;
    ///
    /// let mut mechanism = Manipulator::example("delta")?.mechanism().clone();
    /// for joint in mechanism.legs.iter_mut().map(|leg| &mut leg.joints[0]) {
    ///     joint.coordinates[0].max_effort = Some(60.0); // N m
    /// }
    /// let manipulator = Manipulator::new(mechanism)?;
    /// let setup = Setup { gravity: Some(Gravity::default()), ..Setup::new(1.0) };
    /// let mut loads = Loads::new(&manipulator, &setup).expect("links are heavy");
    /// let mut statics = Statics::new(&manipulator, 1.0);
    /// let at = manipulator.solution(); // home
    /// statics.update(&at)?;
    /// let found = loads.acceleration_radius(&statics, &at).expect("home is regular");
    /// assert!(found.linear.is_some_and(|radius| radius > 0.0));
    /// assert_eq!(found.angular, None); // its platform does not turn
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn acceleration_radius(
        &mut self,
        statics: &Statics<'_>,
        at: &Solution,
    ) -> Option<AccelerationRadius> {
        if !statics.is_regular() || !statics.has_limits() {
            return None;
        }
        let load = self.work(statics, at)?;
        let free = statics.free;
        let mut masses = Matrix6::zeros();
        for k in 0..free {
            let Self { weights, rest, accelerations, .. } = self;
            for (number, acceleration) in accelerations.iter_mut().enumerate() {
                *acceleration = statics.joint_rate(number, k);
            }
            let motion = JointMotion { rates: rest, accelerations };
            let work = match weights {
                Some(weights) => weights.work_of(statics, at, Some(motion), Part::Inertia)?,
                None => Velocity::default(),
            };
            (0..free).for_each(|row| masses[(row, k)] = -work[row]);
        }
        let radius = |motions: Pure, unit: f64| {
            let (directions, count) = statics.pure(motions);
            if count == 0 {
                return None;
            }
            if statics.loose() > 0 {
                return Some(0.0);
            }
            let resisted = masses * directions;
            let (mut least, work) = (f64::INFINITY, Vector6::from(load));
            statics.each_facet(|facet| {
                let normal = Vector6::from(facet.normal);
                let size = resisted.tr_mul(&normal).norm();
                if size > 0.0 {
                    least = least.min((facet.bound - normal.dot(&work).abs()) / size);
                }
            });
            Some(least * unit)
        };
        Some(AccelerationRadius {
            linear: radius(Pure::Translations, statics.length()),
            angular: radius(Pure::Rotations, 1.0),
        })
    }
}
