//! The unit of mass of a model.
//!
//! MuJoCo compares masses and moments of inertia with absolute numbers: below 1e-15 they are refused, and with more than the
//! inverse of that, constraints get soft. The moments of inertia of a mechanism grow with the fifth power of its size: those of
//! one of a tenth of a millimetre are below, those of one of a kilometre are beyond. All forces are in proportion to the
//! masses, so that another unit of mass changes no motion.

use opm_core::skeleton::{Body, Mass};

/// Moments of inertia of all that moves between which the unit is a kilogram, kilograms times square metres. Those of
/// thin rods about their own axes are less by five orders of magnitude.
const KILOGRAMS: [f64; 2] = [1e-8, 1e9];

/// What that moment of inertia is brought to otherwise: that of a mechanism of some decimetres.
const USUAL: f64 = 1e-3;

/// A power of ten of a kilogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MassUnit {
    exponent: i32,
}

impl MassUnit {
    /// The unit for a mechanism of a size, metres. The first of the bodies is the base.
    pub fn of(bodies: &[Body], masses: &[Mass], size: f64) -> Self {
        let moving: f64 = bodies.iter().zip(masses).skip(1).map(|(_, mass)| mass.mass).sum();
        let inertia = moving * size * size;
        let known = inertia > 0.0 && inertia.is_finite();
        let usual = (KILOGRAMS[0]..=KILOGRAMS[1]).contains(&inertia);
        let exponent = if known && !usual { (inertia / USUAL).log10().round() as i32 } else { 0 };
        Self { exponent }
    }

    /// How many of it are a kilogram.
    pub fn per_kilogram(self) -> f64 {
        10_f64.powi(-self.exponent)
    }

    /// What a model has to say about it; `None` for a kilogram.
    pub fn told(self) -> Option<String> {
        let exponent = self.exponent;
        (exponent != 0).then(|| {
            format!(
                "masses are in units of 1e{exponent} kg, so forces in 1e{exponent} N and torques in 1e{exponent} N m: \
                 MuJoCo takes no moments of inertia that are much smaller or larger"
            )
        })
    }
}
