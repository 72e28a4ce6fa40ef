//! Loads on the platform.

use nalgebra::{Isometry3, Point3, Vector3};

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

/// Where a force acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LoadPoint {
    /// At the platform's reference point.
    #[default]
    Platform,
    /// At the base's origin.
    Base,
    /// At a point of the platform, from its reference point along the axes of the load, metres.
    From(Vector3<f64>),
}

/// The axes of a load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadAxes {
    /// Those of the base.
    #[default]
    Base,
    /// Those that the platform carries, which are the base's where its orientation is the identity.
    Platform,
}

impl LoadAxes {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Base, Self::Platform];

    /// Their name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Platform => "platform",
        }
    }

    /// The axes of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|axes| axes.name() == name)
    }
}

/// A load as it is given: at a point, along some axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// The force and the moment at the point, along the axes.
    pub wrench: Wrench,
    /// The point.
    pub at: LoadPoint,
    /// The axes.
    pub axes: LoadAxes,
}

impl Load {
    /// The load as a wrench at the reference point of a platform, in base directions.
    ///
    /// ```
    /// use nalgebra::{Isometry3, Vector3};
    /// use opm_analysis::{Load, LoadAxes, LoadPoint, Wrench};
    ///
    /// // A force along x at half a metre along y has a moment about z.
    /// let wrench = Wrench { force: Vector3::x() * 2.0, moment: Vector3::zeros() };
    /// let at = LoadPoint::From(Vector3::y() * 0.5);
    /// let load = Load { wrench, at, axes: LoadAxes::Base };
    /// let found = load.on(&Isometry3::identity());
    /// assert_eq!(found.components(), [2.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
    /// ```
    pub fn on(&self, platform: &Isometry3<f64>) -> Wrench {
        let turned = |v: Vector3<f64>| match self.axes {
            LoadAxes::Base => v,
            LoadAxes::Platform => platform.rotation * v,
        };
        let Wrench { force, moment } = self.wrench;
        let wrench = Wrench { force: turned(force), moment: turned(moment) };
        let reference = Point3::from(platform.translation.vector);
        let from = match self.at {
            LoadPoint::Platform => reference,
            LoadPoint::Base => Point3::origin(),
            LoadPoint::From(arm) => reference + turned(arm),
        };
        wrench.moved(&from, &reference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use std::f64::consts::FRAC_PI_2;

    /// A force along the platform's x, at a point on its y, on a platform that is turned by a right angle about z.
    #[test]
    fn a_load_acts_where_it_is_said_to() {
        let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * FRAC_PI_2);
        let platform = Isometry3::from_parts([3.0, 0.0, 0.0].into(), turned);
        let wrench = Wrench::from_components([2.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let arm = LoadPoint::From(Vector3::new(0.0, 0.5, 0.0));
        for (at, axes, expected) in [
            (arm, LoadAxes::Platform, [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]),
            (LoadPoint::Platform, LoadAxes::Base, [2.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            // At the base's origin, 3 m from the reference point, a force along the base's y.
            (LoadPoint::Base, LoadAxes::Platform, [0.0, 2.0, 0.0, 0.0, 0.0, -5.0]),
        ] {
            let found = Load { wrench, at, axes }.on(&platform).components();
            let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-12, "{found:?}");
        }
    }
}
