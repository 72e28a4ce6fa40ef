//! How the platform answers to a wrench that swings.
//!
//! With the stiffness `K` and the mass matrix `M` of the natural frequencies, and the shapes `φ` with `φᵀ K φ = 1`, a wrench `W` that
//! swings with the angular frequency `ω` moves the platform by `X W`, with
//!
//! ```text
//! X = Σ φ φᵀ / (1 + i η - r² + 2 i ζ r),    r = ω / ω_k
//! ```
//!
//! `η` is the loss factor of all springs (structural damping: the stiffness is `K (1 + i η)`), and `ζ` the share of critical damping of each
//! natural vibration (viscous damping; D. Ewins, *Modal Testing*, 2000, sections 2.4 and 2.5).

use crate::stiffness::{Compliant, Stiffness};
use nalgebra::{Complex, Matrix6, Vector6};
use std::f64::consts::TAU;

/// What takes energy from vibrations. None of them is negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// The loss factor of all springs.
    pub loss_factor: f64,
    /// The share of critical damping, the same for each natural vibration.
    pub ratio: f64,
}

/// The frequency response of the platform at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// One over the square of each natural angular frequency, and its shape: a translation and a rotation vector for a unit of energy.
    modes: [(f64, Vector6<f64>); 6],
}

impl Compliant<'_> {
    /// The frequency response at the pose of a stiffness, which is the last that was computed; `None` where there are no
    /// [natural vibrations](Compliant::vibrations).
    ///
    /// ```
    /// use opm_analysis::{Compliant, Damping, Gravity, Springs};
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("delta")?;
    /// let springs = Springs { actuators: vec![1e3; 3], translation: 1e7, rotation: 1e4 };
    /// let compliant = Compliant::new(&manipulator, springs)?;
    /// let mut compliant = compliant.with_gravity(&Gravity::default());
    /// let stiffness = compliant.stiffness(&manipulator.solution()).expect("home is regular");
    /// let lowest = compliant.vibrations(&stiffness).expect("a stiff platform")[0].frequency;
    /// let response = compliant.response(&stiffness).expect("a stiff platform");
    /// let damping = Damping { loss_factor: 0.02, ratio: 0.0 };
    /// // At its lowest natural frequency the platform moves far more than under a force that rests.
    /// let moved = |frequency| response.compliance(frequency, damping).map(|x| x.norm()).max();
    /// assert!(moved(lowest) > 5.0 * moved(0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn response(&self, stiffness: &Stiffness) -> Option<Response> {
        let unit = self.unit();
        let modes = self.modes(stiffness)?;
        Some(Response { modes: modes.map(|(square, shape)| (square, unit * shape)) })
    }
}

impl Response {
    /// The translation of the reference point and the rotation vector of the platform, base directions, for a unit of each component
    /// `FX FY FZ MX MY MZ` of a wrench at the reference point that swings with a frequency, Hz: amplitudes and phases as complex
    /// numbers, m/N, rad/N, m/(N m) and rad/(N m). Symmetric. Without damping it is infinite at a natural frequency.
    pub fn compliance(&self, frequency: f64, damping: Damping) -> Matrix6<Complex<f64>> {
        let angular = TAU * frequency;
        let mut sum = Matrix6::zeros();
        for (square, shape) in &self.modes {
            let quotient = angular * square.sqrt();
            let lag = damping.loss_factor + 2.0 * damping.ratio * quotient;
            let factor = Complex::new(1.0 - quotient * quotient, lag).inv();
            sum += (shape * shape.transpose()).map(|part| factor * part);
        }
        sum
    }
}
