//! Joints: a kind, an axis at the assembled home, and the coordinates that measure them.

use crate::chain::limits::Limits;
use crate::group::screw::Screw;
pub use crate::numeric::Quantity;
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// What a joint lets its two links do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Rotation about the axis.
    Revolute,
    /// Translation along the axis.
    Prismatic,
    /// Rotation about the axis with `pitch` metres of advance a radian.
    Helical {
        /// Advance, metres a radian; right-handed where positive.
        pitch: f64,
    },
    /// Rotation about the axis, then translation along it (they commute).
    Cylindrical,
    /// Rotation about `axis`, then about `second`, both through the joint's point.
    Universal {
        /// The axis nearer the platform, at home.
        second: Unit<Vector3<f64>>,
    },
    /// Any rotation about the joint's point.
    Spherical,
}

/// One coordinate of a joint: what is reported, and within which limits.
#[derive(Clone, Debug, PartialEq)]
pub struct JointCoordinate {
    /// The joint's name; with a suffix where it has several coordinates (`s1.x`).
    pub name: String,
    /// Angle or length.
    pub quantity: Quantity,
    /// The value at the assembled home; a reported value is this plus the displacement.
    pub home: f64,
    /// Lowest and highest value allowed, both included.
    pub limits: Option<[f64; 2]>,
}

impl JointCoordinate {
    /// The displacements from home that its limits allow; `size` is the mechanism's, in metres: the
    /// rounding of a length is in proportion to it, however short the length.
    pub fn displacement_limits(&self, size: f64) -> Limits {
        let size = match self.quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => size,
        };
        Limits::new(self.limits, self.home, size)
    }
}

/// A joint at the assembled home pose, in base coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name, unique in its mechanism.
    pub name: String,
    /// What it lets its links do.
    pub kind: JointKind,
    /// Direction of the axis (of the first, for a universal joint; unused for a spherical one).
    pub axis: Unit<Vector3<f64>>,
    /// A point of the axis (unused for a prismatic joint).
    pub point: Point3<f64>,
    /// Driven by a motor.
    pub actuated: bool,
    /// One, two (cylindrical: angle, slide; universal) or three (spherical) coordinates.
    pub coordinates: Vec<JointCoordinate>,
}

impl Joint {
    /// A passive joint without limits whose coordinates are zero at home.
    pub fn new(
        name: impl Into<String>,
        kind: JointKind,
        axis: Unit<Vector3<f64>>,
        point: Point3<f64>,
    ) -> Self {
        use Quantity::{Angle, Length};
        let name = name.into();
        let parts: &[(&str, Quantity)] = match kind {
            JointKind::Revolute | JointKind::Helical { .. } => &[("", Angle)],
            JointKind::Prismatic => &[("", Length)],
            JointKind::Cylindrical => &[(".angle", Angle), (".slide", Length)],
            JointKind::Universal { .. } => &[(".1", Angle), (".2", Angle)],
            JointKind::Spherical => &[(".x", Angle), (".y", Angle), (".z", Angle)],
        };
        let coordinates = parts
            .iter()
            .map(|&(suffix, quantity)| JointCoordinate {
                name: format!("{name}{suffix}"),
                quantity,
                home: 0.0,
                limits: None,
            })
            .collect();
        Self { name, kind, axis, point, actuated: false, coordinates }
    }

    /// The same joint, driven by a motor.
    #[must_use]
    pub fn actuated(mut self) -> Self {
        self.actuated = true;
        self
    }

    /// The same joint with `home` as the value of its first coordinate at home.
    #[must_use]
    pub fn at(mut self, home: f64) -> Self {
        self.coordinates[0].home = home;
        self
    }

    /// The same joint with limits on its first coordinate.
    #[must_use]
    pub fn within(mut self, limits: Option<[f64; 2]>) -> Self {
        self.coordinates[0].limits = limits;
        self
    }

    /// Number of freedoms: 1, 2 or 3.
    pub fn freedoms(&self) -> usize {
        self.coordinates.len()
    }

    /// One unit screw a freedom, base to platform, at home. A cylindrical joint is a rotation, then
    /// a translation; a spherical one is rotations about the base's x, y and z.
    pub fn screws(&self) -> Vec<Screw> {
        let about = |axis| Screw::rotation(axis, self.point);
        match self.kind {
            JointKind::Revolute => vec![about(self.axis)],
            JointKind::Prismatic => vec![Screw::translation(self.axis)],
            JointKind::Helical { pitch } => vec![Screw::helical(self.axis, self.point, pitch)],
            JointKind::Cylindrical => vec![about(self.axis), Screw::translation(self.axis)],
            JointKind::Universal { second } => vec![about(self.axis), about(second)],
            JointKind::Spherical => {
                vec![about(Vector3::x_axis()), about(Vector3::y_axis()), about(Vector3::z_axis())]
            }
        }
    }

    /// Displacement of the outer link from home for the given coordinates, measured as they are
    /// reported (home values included). A spherical joint's three are one rotation vector.
    ///
    /// # Panics
    /// If `values` has another length than [`Joint::coordinates`].
    pub fn displacement(&self, values: &[f64]) -> Isometry3<f64> {
        assert_eq!(values.len(), self.coordinates.len(), "joint {}: coordinates", self.name);
        let from_home = |i: usize| values[i] - self.coordinates[i].home;
        if self.kind == JointKind::Spherical {
            let rotation = UnitQuaternion::from_scaled_axis(Vector3::from_fn(|i, _| from_home(i)));
            let p = self.point.coords;
            return Isometry3::from_parts(Translation3::from(p - rotation * p), rotation);
        }
        self.screws()
            .iter()
            .enumerate()
            .fold(Isometry3::identity(), |g, (i, screw)| g * screw.exp(from_home(i)))
    }
}
