//! Loads on the platform.

use nalgebra::{Point3, Vector3};

/// A force and a moment on the platform: newtons and newton metres, in base directions, at the platform's reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// The force, newtons.
    pub force: Vector3<f64>,
    /// The moment about the platform's reference point, newton metres.
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// A wrench from its components `FX FY FZ MX MY MZ`.
    pub fn from_components([fx, fy, fz, mx, my, mz]: [f64; 6]) -> Self {
        Self { force: Vector3::new(fx, fy, fz), moment: Vector3::new(mx, my, mz) }
    }

    /// The components `FX FY FZ MX MY MZ`.
    pub fn components(&self) -> [f64; 6] {
        let (f, m) = (self.force, self.moment);
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }

    /// The same load as a wrench at the reference point, if this one is at a point; both points in base coordinates, metres.
    #[must_use]
    pub fn moved(self, from: &Point3<f64>, reference: &Point3<f64>) -> Self {
        Self { moment: self.moment + (from - reference).cross(&self.force), ..self }
    }
}

impl std::ops::Add for Wrench {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }
}
