//! Efforts: what the actuators, and the imaginary joints, carry under a load.
//!
//! The effort of an actuated joint is the force (of a slider, newtons) or the torque (of an angle, newton metres) that
//! its actuator exerts along its coordinate, so that the mechanism stays at rest under the load:
//! `Σ τᵢ dqᵢ + F · dx + M · dφ = 0` for every small motion of the platform. A slider that points up and carries a weight
//! has a positive effort.
//!
//! An *imaginary joint* stands for what one section does to the other. Its effort is the one that an actuator in its
//! place would exert on the upper section. A leg's imaginary joint has the rate `θ̇`, its actuated joint in the lower
//! section `q̇ = (∂q/∂θ) θ̇ + …`, of which `J_p` has the coefficients. So with equal work, `μ = Σ (∂q/∂θ) τ` over the
//! actuated joints of the leg's lower section.

use crate::statics::{Statics, Velocity};
use crate::wrench::Wrench;
use nalgebra::{Vector3, Vector6};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::leg::Section;

/// Less than this share of a load's work for a motion that nothing holds is rounding.
const BALANCED: f64 = 1e-6;

/// An effort is determined if the internal efforts have less than this share of their work in it.
const DETERMINED: f64 = 1e-9;

/// A part of an effort below this share of the others is rounding.
const ROUNDING: f64 = 1e-13;

/// What the actuators do against a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Balance {
    /// They balance it.
    Balanced,
    /// They do not: the load drives a motion of the platform that they do not hold.
    Driven,
    /// Nothing is known, because the pose is at a serial singularity.
    Singular,
}

/// The efforts for one load.
#[derive(Clone, Debug, PartialEq)]
pub struct Efforts {
    /// Whether the actuators balance the load. If not, no effort is known.
    pub balance: Balance,
    /// The effort of every actuated coordinate, in the order of
    /// [`Manipulator::actuated`](opm_core::Manipulator::actuated); N and N m. `None` for one that the load does not
    /// determine, because redundant actuators can work against each other.
    pub actuated: Vec<Option<f64>>,
    /// The effort of every imaginary joint, in the order of
    /// [`Manipulator::imaginary`](opm_core::Manipulator::imaginary); N and N m. `None` where an effort that it follows
    /// from is not known, and in a leg whose lower section constrains the platform.
    pub imaginary: Vec<Option<f64>>,
}

impl Efforts {
    /// Those at a serial singularity: none is known.
    pub(crate) fn singular(manipulator: &Manipulator) -> Self {
        Self {
            balance: Balance::Singular,
            actuated: vec![None; manipulator.actuated().len()],
            imaginary: vec![None; manipulator.imaginary().len()],
        }
    }
}

/// The efforts of one actuated coordinate for unit loads, and where they are largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// The largest effort for a force of one newton without a moment; N or N m.
    pub per_force: f64,
    /// The direction of that force, a unit vector in base directions; zero where no force needs an effort.
    pub force: Vector3<f64>,
    /// The largest effort for a moment of one newton metre without a force; N or N m.
    pub per_moment: f64,
    /// The direction of that moment, a unit vector in base directions; zero where no moment needs an effort.
    pub moment: Vector3<f64>,
}

impl Statics<'_> {
    /// The efforts that balance a wrench on the platform.
    pub fn efforts(&self, wrench: &Wrench) -> Efforts {
        self.efforts_for(&self.work(wrench))
    }

    /// The work of a wrench for each independent velocity.
    pub fn work(&self, wrench: &Wrench) -> Velocity {
        let (m, f) = (wrench.moment, wrench.force * self.length());
        let load = Vector6::new(m.x, m.y, m.z, f.x, f.y, f.z);
        std::array::from_fn(|k| if k < self.free { self.twists.column(k).dot(&load) } else { 0.0 })
    }

    /// The efforts that balance a load, which does this work for each independent velocity.
    pub fn efforts_for(&self, work: &Velocity) -> Efforts {
        let manipulator = self.manipulator();
        let balance = self.balance(work);
        let actuated: Vec<Option<f64>> = (0..manipulator.actuated().len())
            .map(|i| {
                let known = balance == Balance::Balanced && self.is_determined(i);
                known.then(|| self.effort(i, work))
            })
            .collect();
        let imaginary = (0..manipulator.imaginary().len()).map(|i| {
            let known = balance == Balance::Balanced;
            known.then(|| self.imaginary_effort(i, &actuated)).flatten()
        });
        Efforts { balance, imaginary: imaginary.collect(), actuated }
    }

    /// The effort of an actuated coordinate for a load, N or N m; `None` where the load is not balanced, or does not
    /// determine it.
    pub fn effort_under(&self, actuated: usize, work: &Velocity) -> Option<f64> {
        let known = self.balance(work) == Balance::Balanced && self.is_determined(actuated);
        known.then(|| self.effort(actuated, work))
    }

    /// Whether the actuators balance a load.
    fn balance(&self, work: &Velocity) -> Balance {
        if !self.is_regular() {
            return Balance::Singular;
        }
        let whole = work.iter().map(|part| part * part).sum::<f64>().sqrt();
        let drives = |k: usize| self.along(k, work).abs() > BALANCED * whole;
        match (0..self.free).any(|k| !self.holds(k) && drives(k)) {
            true => Balance::Driven,
            false => Balance::Balanced,
        }
    }

    /// The work of a load for the velocity with a singular value.
    fn along(&self, k: usize, work: &Velocity) -> f64 {
        (0..self.free).map(|i| self.right[(i, k)] * work[i]).sum()
    }

    /// Whether loads determine the effort of an actuated coordinate: no internal effort has a part in it.
    pub(crate) fn is_determined(&self, actuated: usize) -> bool {
        let share: f64 =
            self.held().map(|(k, square)| self.image[(actuated, k)].powi(2) / square).sum();
        self.is_regular() && (1.0 - share).abs() <= DETERMINED
    }

    /// The effort of an actuated coordinate, `−G⁺ᵀ` times the work, in newtons or newton metres.
    fn effort(&self, actuated: usize, work: &Velocity) -> f64 {
        let parts =
            self.held().map(|(k, square)| self.image[(actuated, k)] * self.along(k, work) / square);
        // Not −0.
        0.0 - parts.sum::<f64>() * self.effort_unit(actuated)
    }

    /// The efforts of an actuated coordinate for unit components `FX FY FZ MX MY MZ` of a wrench; N or N m for each N or
    /// N m. `None` where it is not determined, and where the actuators leave the platform a motion.
    pub fn per_wrench(&self, actuated: usize) -> Option<[f64; 6]> {
        if !self.is_determined(actuated) || self.loose() > 0 {
            return None;
        }
        let mut row = [0.0; 6];
        for (component, entry) in row.iter_mut().enumerate() {
            // Twists have the angular velocity first, and velocities over the length.
            let (place, unit) =
                if component < 3 { (component + 3, self.length()) } else { (component - 3, 1.0) };
            let work = std::array::from_fn(|k| {
                if k < self.free { self.twists[(place, k)] * unit } else { 0.0 }
            });
            *entry = self.effort(actuated, &work);
        }
        Some(row)
    }

    /// The largest efforts of an actuated coordinate for unit forces and for unit moments. `None` as for
    /// [`Statics::per_wrench`].
    pub fn worst(&self, actuated: usize) -> Option<Worst> {
        let [fx, fy, fz, mx, my, mz] = self.per_wrench(actuated)?;
        let (force, moment) = (Vector3::new(fx, fy, fz), Vector3::new(mx, my, mz));
        let whole = force.norm().max(moment.norm() / self.length());
        let of = |vector: Vector3<f64>, unit: f64| match vector.norm() {
            norm if norm / unit > ROUNDING * whole => (norm, vector / norm),
            _ => (0.0, Vector3::zeros()),
        };
        let ((per_force, force), (per_moment, moment)) =
            (of(force, 1.0), of(moment, self.length()));
        Some(Worst { per_force, force, per_moment, moment })
    }

    /// The effort of an imaginary joint for efforts of the actuated coordinates.
    fn imaginary_effort(&self, imaginary: usize, actuated: &[Option<f64>]) -> Option<f64> {
        let manipulator = self.manipulator();
        let leg = manipulator.imaginary()[imaginary].leg;
        if manipulator.constraining_legs().any(|section| section == (leg, Some(Section::Lower))) {
            return None;
        }
        let row = self.jacobians.bridged.iter().position(|&bridged| bridged == leg)?;
        let lower = lower_coordinates(manipulator, leg);
        let mut sum = 0.0;
        for (&coordinate, effort) in manipulator.actuated().iter().zip(actuated) {
            if lower.contains(&coordinate) {
                let slope = self.by_imaginary(coordinate, row)?;
                if slope != 0.0 {
                    sum += slope * (*effort)?;
                }
            }
        }
        Some(sum)
    }

    /// The rate of an actuated coordinate of a lower section for a unit rate of the leg's imaginary joint, which has a row
    /// of `J_s`.
    fn by_imaginary(&self, coordinate: usize, row: usize) -> Option<f64> {
        let jacobians = &self.jacobians;
        if let Some(own) = jacobians.lower_rows.iter().position(|&known| known == coordinate) {
            return Some(jacobians.lower[(own, row)]);
        }
        // A joint that carries a height has no row of `J_p`. It follows the upper section through the imaginary joint alone,
        // so that all columns have the same quotient.
        let upper = jacobians.upper.row(row);
        let column = upper.transpose().iamax();
        (upper[column] != 0.0).then(|| jacobians.joints[(coordinate, column)] / upper[column])
    }
}

/// The numbers of the joint coordinates of a leg's lower section.
fn lower_coordinates(manipulator: &opm_core::Manipulator, leg: usize) -> std::ops::Range<usize> {
    let legs = &manipulator.mechanism().legs;
    let first = legs[..leg].iter().map(|leg| leg.coordinates().count()).sum();
    first..first + manipulator.decomposition().legs[leg].lower.len()
}
