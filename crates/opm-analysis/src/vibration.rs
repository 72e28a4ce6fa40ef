//! Natural frequencies of a mechanism whose actuators and links give way.
//!
//! A displacement `δt` of the platform bends each leg so that its springs have the least energy: it moves the passive joints by
//! `δq = (Jqᵀ C⁻¹ Jq)⁻¹ Jqᵀ C⁻¹ δt`, and each spring by what it carries of `K δt` (the notation is that of the stiffness). Each body of a
//! leg moves with the joints and springs before it, `δb = B δt`. So the six displacements of the platform have the mass matrix
//! `M = M_platform + Σ Bᵀ M_body B` with rotors at actuators, and the natural frequencies are those of `K φ = ω² M φ` (static
//! condensation; R. Guyan, *Reduction of stiffness and mass matrices*, AIAA Journal 3, 1965). They are slightly above the true
//! ones, the lowest least, since a leg that vibrates by itself is not among them. What weights and loads change of the stiffness
//! is left out.

use crate::stiffness::{Compliant, Stiffness};
use nalgebra::{Isometry3, Matrix6, Point3, Vector3, Vector6};
use opm_core::skeleton::Mass;
use std::f64::consts::TAU;

/// A mass below this share of the largest is rounding.
const MASSLESS: f64 = 1e-13;

/// A natural vibration of the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Its frequency, Hz; infinite where nothing with a mass moves.
    pub frequency: f64,
    /// Its shape: the translation of the reference point and the rotation vector of the platform, base directions; m and rad. With
    /// rotations times the characteristic length it has the norm of that length. Its largest entry is positive.
    pub shape: Vector6<f64>,
}

impl Compliant<'_> {
    /// The natural vibrations of the platform at the pose of a stiffness, which is the last that was computed, by rising frequency.
    /// `None` without masses ([`Compliant::with_gravity`]), and where the platform can move without resistance: its lowest
    /// frequency is zero.
    ///
    /// ```
    /// use opm_analysis::{Compliant, Gravity, Springs};
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("delta")?;
    /// let springs = Springs { actuators: vec![1e3; 3], translation: 1e7, rotation: 1e4 };
    /// let compliant = Compliant::new(&manipulator, springs)?;
    /// let mut compliant = compliant.with_gravity(&Gravity::default());
    /// let stiffness = compliant.stiffness(&manipulator.solution()).expect("home is regular");
    /// let found = compliant.vibrations(&stiffness).expect("a stiff platform");
    /// assert!(found[0].frequency > 1.0 && found[0].frequency <= found[5].frequency);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn vibrations(&self, stiffness: &Stiffness) -> Option<[Vibration; 6]> {
        let unit = self.unit();
        Some(self.modes(stiffness)?.map(|(square, shape)| {
            let frequency =
                if square > 0.0 { (TAU * square.sqrt()).recip() } else { f64::INFINITY };
            let sign = shape[shape.iamax()].signum();
            Vibration { frequency, shape: unit * shape * (sign / shape.norm()) }
        }))
    }

    /// One over the squares of the natural angular frequencies, falling, zero where nothing with a mass moves; and shapes `φ` with
    /// `φᵀ K φ = 1`, in comparable numbers ([`Compliant::unit`] times these are displacements).
    pub(crate) fn modes(&self, stiffness: &Stiffness) -> Option<[(f64, Vector6<f64>); 6]> {
        let unit = self.unit();
        let masses = unit * self.masses(stiffness)? * unit;
        let lower = self.decomposed_stiffness(stiffness)?.l();
        let inverse = lower.try_inverse()?;
        let eigen = (inverse * masses * inverse.transpose()).symmetric_eigen();
        let mut order: [usize; 6] = std::array::from_fn(|i| i);
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let largest = eigen.eigenvalues.max();
        Some(order.map(|i| {
            let square = eigen.eigenvalues[i];
            let square = if square > MASSLESS * largest { square } else { 0.0 };
            (square, inverse.transpose() * eigen.eigenvectors.column(i))
        }))
    }

    /// The mass matrix of the platform's displacements.
    fn masses(&self, stiffness: &Stiffness) -> Option<Matrix6<f64>> {
        let weights = self.weights.as_ref()?;
        let mut masses = body(weights.platform_mass(), &self.displacement, &self.reference);
        for (number, leg) in self.screws.legs.iter().enumerate() {
            let rates = self.leg_rates(number, &stiffness.legs[number])?;
            for (coordinate, rate) in &rates.drives {
                let inertia = self.manipulator.coordinates()[*coordinate].drive.inertia();
                masses += rate * rate.transpose() * inertia;
            }
            let own =
                weights.masses(&self.screws).filter(|(moved_by, ..)| leg.start <= moved_by.start);
            for (moved_by, mass, place) in own.filter(|(moved_by, ..)| moved_by.end <= leg.end) {
                let before = rates.each.iter().filter(|(of, _)| moved_by.contains(of));
                let by_platform: Matrix6<f64> = before.map(|(_, map)| map).sum();
                let own = body(mass, place, &self.reference);
                masses += by_platform.transpose() * own * by_platform;
            }
        }
        Some(masses)
    }
}

/// The mass matrix of a body for translations of a point and rotations about it: its columns are the momenta of unit velocities.
fn body(mass: &Mass, displacement: &Isometry3<f64>, reference: &Point3<f64>) -> Matrix6<f64> {
    let arm = displacement * mass.centre - reference;
    let turned = displacement.rotation.to_rotation_matrix();
    let inertia = turned * mass.inertia * turned.transpose();
    let momentum = |k: usize| {
        let axis = |first: usize| Vector3::from_fn(|i, _| f64::from(u8::from(first + i == k)));
        let (velocity, angular) = (axis(0), axis(3));
        let linear = (velocity + angular.cross(&arm)) * mass.mass;
        let about = inertia * angular + arm.cross(&linear);
        Vector6::new(linear.x, linear.y, linear.z, about.x, about.y, about.z)
    };
    Matrix6::from_columns(&std::array::from_fn::<_, 6, _>(momentum))
}
