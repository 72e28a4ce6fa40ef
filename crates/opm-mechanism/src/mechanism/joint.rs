//! Joints: a kind, an axis at the assembled home, and the coordinates that measure them.

use super::Cone;
use super::file::FileUnits;
use crate::chain::limits::Limits;
use crate::group::screw::Screw;
pub use crate::numeric::Quantity;
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// The kind of a joint: which relative motions of its two links it allows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum JointKind {
    /// Rotation about the axis.
    Revolute,
    /// Translation along the axis.
    Prismatic,
    /// Rotation about the axis with an advance of `pitch` metres per radian along it.
    Helical {
        /// Advance along the axis in metres per radian; positive for a right-handed screw.
        pitch: f64,
    },
    /// Rotation about the axis, then translation along it (they commute).
    Cylindrical,
    /// Rotation about `axis`, then about `second`, both through the joint's point.
    Universal {
        /// Direction of the axis nearer the platform, at home.
        second: Unit<Vector3<f64>>,
    },
    /// Any rotation about the joint's point.
    Spherical,
}

impl JointKind {
    /// The `type` in mechanism files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Helical { .. } => "helical",
            Self::Cylindrical => "cylindrical",
            Self::Universal { .. } => "universal",
            Self::Spherical => "spherical",
        }
    }
}

/// The limits of how fast one joint coordinate moves. Trajectories are compared with them; reach, workspaces and
/// inverse kinematics do not depend on them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MotionLimits {
    /// Largest absolute rate, radians or metres per second; positive.
    pub max_rate: Option<f64>,
    /// Largest absolute acceleration, radians or metres per second squared; positive.
    pub max_acceleration: Option<f64>,
}

/// One of the [`MotionLimits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionLimit {
    /// The limit of the rate.
    Rate,
    /// The limit of the acceleration.
    Acceleration,
}

impl MotionLimit {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Rate, Self::Acceleration];

    /// The key in mechanism files.
    pub fn key(self) -> &'static str {
        match self {
            Self::Rate => "max_rate",
            Self::Acceleration => "max_acceleration",
        }
    }

    /// The power of time in its unit, to be written after the unit of a length or an angle.
    pub fn per_time(self) -> &'static str {
        match self {
            Self::Rate => "/s",
            Self::Acceleration => "/s^2",
        }
    }

    /// Its unit in SI.
    pub fn unit(self, quantity: Quantity) -> &'static str {
        match (self, quantity) {
            (Self::Rate, Quantity::Angle) => "rad/s",
            (Self::Rate, Quantity::Length) => "m/s",
            (Self::Acceleration, Quantity::Angle) => "rad/s^2",
            (Self::Acceleration, Quantity::Length) => "m/s^2",
        }
    }

    /// Its value.
    pub fn of(self, limits: &MotionLimits) -> Option<f64> {
        match self {
            Self::Rate => limits.max_rate,
            Self::Acceleration => limits.max_acceleration,
        }
    }

    pub(crate) fn of_mut(self, limits: &mut MotionLimits) -> &mut Option<f64> {
        match self {
            Self::Rate => &mut limits.max_rate,
            Self::Acceleration => &mut limits.max_acceleration,
        }
    }
}

/// A largest absolute value of a joint coordinate that a mechanism file may give: of its motion, or of the effort that
/// drives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveLimit {
    /// A limit of its motion.
    Motion(MotionLimit),
    /// The limit of its actuator's effort.
    Effort,
}

impl DriveLimit {
    /// All of them.
    pub const ALL: [Self; 3] =
        [Self::Motion(MotionLimit::Rate), Self::Motion(MotionLimit::Acceleration), Self::Effort];

    /// The key in mechanism files.
    pub fn key(self) -> &'static str {
        match self {
            Self::Motion(limit) => limit.key(),
            Self::Effort => "max_effort",
        }
    }

    /// Its unit in SI.
    pub fn unit(self, quantity: Quantity) -> &'static str {
        match (self, quantity) {
            (Self::Motion(limit), _) => limit.unit(quantity),
            (Self::Effort, Quantity::Angle) => "N m",
            (Self::Effort, Quantity::Length) => "N",
        }
    }

    /// Whether files give it in their own units. Efforts are in newtons and newton metres in every file.
    pub(crate) fn has_units_of_file(self) -> bool {
        matches!(self, Self::Motion(_))
    }

    /// Its value.
    pub fn of(self, coordinate: &JointCoordinate) -> Option<f64> {
        match self {
            Self::Motion(limit) => limit.of(&coordinate.motion_limits),
            Self::Effort => coordinate.max_effort,
        }
    }

    pub(crate) fn of_mut(self, coordinate: &mut JointCoordinate) -> &mut Option<f64> {
        match self {
            Self::Motion(limit) => limit.of_mut(&mut coordinate.motion_limits),
            Self::Effort => &mut coordinate.max_effort,
        }
    }
}

/// What a family's file says of one joint coordinate: everything that limits it, and where its values start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointLimits {
    /// Lowest and highest value, radians or metres.
    pub range: Option<[f64; 2]>,
    /// How fast the joint moves.
    pub motion: MotionLimits,
    /// Largest absolute effort of the joint's actuator, newtons or newton metres; positive.
    pub max_effort: Option<f64>,
    /// The numbers of its drive that are given, in the order of [`DriveNumber::ALL`], SI.
    pub drive: [Option<f64>; 4],
    /// The joint's value where the family's formulas have its zero, radians or metres: the offset of its encoder. Without it,
    /// zero.
    pub offset: Option<f64>,
}

/// One scalar coordinate of a joint: its name, its home value and its limits.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct JointCoordinate {
    /// The joint's name, with a suffix if the joint has several coordinates (`s1.x`).
    pub name: String,
    /// Whether the coordinate is an angle or a length.
    pub quantity: Quantity,
    /// The value at the assembled home, in radians or metres. A reported value is this one plus the
    /// displacement from home.
    pub home: f64,
    /// Lowest and highest allowed value, both included, in radians or metres; `None` without
    /// limits.
    pub limits: Option<[f64; 2]>,
    /// The limits of its rate and of its acceleration.
    pub motion_limits: MotionLimits,
    /// Largest absolute effort of the coordinate's actuator, newtons for a length and newton metres for an angle; positive.
    /// The capacity of a pose follows from it; kinematics do not depend on it.
    pub max_effort: Option<f64>,
    /// What the coordinate's actuator and its bearings add to what moves; kinematics do not depend on it.
    pub drive: Drive,
}

/// What an actuator and the bearings of a joint add to the inertia of a mechanism, and to what resists its motion.
///
/// ```
/// use opm_core::mechanism::joint::Drive;
///
/// let drive = Drive { rotor_inertia: 2e-5, gear: 50.0, viscous_friction: 0.1, coulomb_friction: 0.3 };
/// assert!((drive.inertia() - 0.05).abs() < 1e-15);
/// // What it needs at 2 rad/s and 10 rad/s²: 0.5 + 0.2 + 0.3 N m.
/// assert!((drive.effort(2.0, 10.0) - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Drive {
    /// The inertia of the rotor, kg m².
    pub rotor_inertia: f64,
    /// How much faster than the joint the rotor turns; of a length, radians per metre.
    pub gear: f64,
    /// The friction for a rate of one, N m s/rad or N s/m.
    pub viscous_friction: f64,
    /// The friction whatever the rate is, against it, N m or N.
    pub coulomb_friction: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self { rotor_inertia: 0.0, gear: 1.0, viscous_friction: 0.0, coulomb_friction: 0.0 }
    }
}

impl Drive {
    /// The numbers, in the order of [`DriveNumber::ALL`].
    pub fn numbers(&self) -> [f64; 4] {
        DriveNumber::ALL.map(|number| number.of(self))
    }

    /// The inertia of the rotor at the joint, kg m² or kg.
    pub fn inertia(&self) -> f64 {
        self.rotor_inertia * self.gear * self.gear
    }

    /// The effort that it takes to move it, N m or N.
    pub fn effort(&self, rate: f64, acceleration: f64) -> f64 {
        let against = if rate == 0.0 { 0.0 } else { rate.signum() };
        self.inertia() * acceleration
            + self.viscous_friction * rate
            + self.coulomb_friction * against
    }
}

/// One of the numbers of a [`Drive`]. None of them is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveNumber {
    /// The inertia of the rotor.
    RotorInertia,
    /// The gear.
    Gear,
    /// The friction in proportion to the rate.
    ViscousFriction,
    /// The friction whatever the rate is.
    CoulombFriction,
}

impl DriveNumber {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::RotorInertia, Self::Gear, Self::ViscousFriction, Self::CoulombFriction];

    /// The key in mechanism files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::RotorInertia => "rotor_inertia",
            Self::Gear => "gear",
            Self::ViscousFriction => "viscous_friction",
            Self::CoulombFriction => "coulomb_friction",
        }
    }

    /// Its value.
    pub fn of(self, drive: &Drive) -> f64 {
        match self {
            Self::RotorInertia => drive.rotor_inertia,
            Self::Gear => drive.gear,
            Self::ViscousFriction => drive.viscous_friction,
            Self::CoulombFriction => drive.coulomb_friction,
        }
    }

    pub(crate) fn of_mut(self, drive: &mut Drive) -> &mut f64 {
        match self {
            Self::RotorInertia => &mut drive.rotor_inertia,
            Self::Gear => &mut drive.gear,
            Self::ViscousFriction => &mut drive.viscous_friction,
            Self::CoulombFriction => &mut drive.coulomb_friction,
        }
    }

    /// The number of a joint without a drive.
    pub(crate) fn usual(self) -> f64 {
        self.of(&Drive::default())
    }

    /// What the number of a file is of one in SI: the gear of a slider is per unit of length.
    pub(crate) fn in_file(self, quantity: Quantity, units: FileUnits) -> f64 {
        match (self, quantity) {
            (Self::Gear, Quantity::Length) => units.factor(Quantity::Length),
            _ => 1.0,
        }
    }
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
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use opm_core::mechanism::joint::{Joint, JointKind};
///
/// let point = Point3::new(0.1, 0.0, 0.0);
/// let hinge = Joint::new("hinge", JointKind::Revolute, Vector3::z_axis(), point);
/// assert_eq!((hinge.freedoms(), hinge.actuated), (1, false));
/// // A quarter revolution about its axis takes the origin to (0.1, -0.1, 0).
/// let moved = hinge.displacement(&[std::f64::consts::FRAC_PI_2])? * Point3::origin();
/// assert!((moved - Point3::new(0.1, -0.1, 0.0)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Joint {
    /// The joint's name, unique in its mechanism.
    pub name: String,
    /// Which motions the joint allows.
    pub kind: JointKind,
    /// Direction of the axis at home; the first axis of a universal joint, unused for a spherical
    /// joint.
    pub axis: Unit<Vector3<f64>>,
    /// A point on the axis at home, metres; unused for a prismatic joint except to draw it.
    pub point: Point3<f64>,
    /// Whether a motor drives the joint.
    pub actuated: bool,
    /// The joint's coordinates: one; two (cylindrical: angle and slide; universal: two angles); or
    /// three (spherical: the components of a rotation vector).
    pub coordinates: Vec<JointCoordinate>,
    /// How far a spherical or a universal joint may tilt; `None` where it may as far as it wants.
    pub cone: Option<Cone>,
    /// Whether it turns back what the joint before it turned: the two are the hinges of a
    /// [parallelogram](Joint::parallelogram).
    pub turns_back: bool,
}

/// The number of values differs from the number of coordinates of a joint, a leg or a mechanism.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}: the number of values is {given}, expected {expected}, one for each coordinate")]
#[non_exhaustive]
pub struct ValueCountError {
    /// The name of the joint or the leg; for a mechanism, which of its joints the values are for.
    pub name: String,
    /// The number of values.
    pub given: usize,
    /// The number of coordinates.
    pub expected: usize,
}

impl ValueCountError {
    /// Checks that there are as many values as expected, for what has this name.
    ///
    /// # Errors
    /// [`ValueCountError`] if there are not.
    pub fn check(name: &str, values: &[f64], expected: usize) -> Result<(), Self> {
        match values.len() {
            given if given == expected => Ok(()),
            given => Err(Self { name: name.to_owned(), given, expected }),
        }
    }
}

impl Joint {
    /// Builds a passive joint without limits. Its coordinates are zero at home.
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
                motion_limits: MotionLimits::default(),
                max_effort: None,
                drive: Drive::default(),
            })
            .collect();
        Self {
            name,
            kind,
            axis,
            point,
            actuated: false,
            coordinates,
            cone: None,
            turns_back: false,
        }
    }

    /// A parallelogram: its outer link moves on a circle and does not turn. It is two hinges in series about parallel axes,
    /// at either end of a bar, of which the second one, `NAME.end`, turns back what the first one turns.
    ///
    /// ```
    /// use nalgebra::{Point3, Vector3};
    /// use opm_core::mechanism::joint::Joint;
    /// use opm_core::Leg;
    ///
    /// // A bar from the origin to (0.2, 0, 0), in the plane across z.
    /// let ends = [Point3::origin(), Point3::new(0.2, 0.0, 0.0)];
    /// let leg = Leg::new("leg1", Joint::parallelogram("p1", Vector3::z_axis(), ends).to_vec());
    /// let quarter = std::f64::consts::FRAC_PI_2;
    /// let moved = leg.displacement(&[quarter, -quarter])?;
    /// assert!(moved.rotation.angle() < 1e-12);
    /// assert!((moved.translation.vector - Vector3::new(-0.2, 0.2, 0.0)).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parallelogram(
        name: &str,
        axis: Unit<Vector3<f64>>,
        [point, end]: [Point3<f64>; 2],
    ) -> [Self; 2] {
        let back = Self::new(Self::end_name(name), JointKind::Revolute, axis, end);
        [Self::new(name, JointKind::Revolute, axis, point), Self { turns_back: true, ..back }]
    }

    /// The key in mechanism files of a hinge that turns back what the one before it turned.
    pub(crate) const TURNS_BACK: &str = "turns_back";

    /// The name of the second hinge of a parallelogram.
    pub fn end_name(name: &str) -> String {
        format!("{name}.end")
    }

    /// Marks the joint as driven by a motor.
    #[must_use]
    pub fn actuated(mut self) -> Self {
        self.actuated = true;
        self
    }

    /// Sets the home value of the joint's first coordinate, radians or metres.
    #[must_use]
    pub fn at(mut self, home: f64) -> Self {
        self.coordinates[0].home = home;
        self
    }

    /// Sets the limits of the joint's first coordinate, radians or metres.
    #[must_use]
    pub fn within(mut self, limits: Option<[f64; 2]>) -> Self {
        self.coordinates[0].limits = limits;
        self
    }

    /// Sets the limits of the joint's first coordinate and of its motion, and its home value to the offset.
    #[must_use]
    pub fn limited(mut self, limits: JointLimits) -> Self {
        self.coordinates[0].home = limits.offset.unwrap_or(0.0);
        self.coordinates[0].motion_limits = limits.motion;
        self.coordinates[0].max_effort = limits.max_effort;
        for (number, value) in DriveNumber::ALL.into_iter().zip(limits.drive) {
            if let Some(value) = value {
                *number.of_mut(&mut self.coordinates[0].drive) = value;
            }
        }
        self.within(limits.range)
    }

    /// The number of freedoms: 1, 2 or 3.
    pub fn freedoms(&self) -> usize {
        self.coordinates.len()
    }

    /// The unit screws of the joint at home, one per freedom, from base to platform. A cylindrical
    /// joint is a rotation followed by a translation; a spherical joint is three rotations, about
    /// the base's x, y and z.
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

    /// The displacement of the outer link from home for the given coordinate values. The values are
    /// as reported, so they include the home values. The three values of a spherical joint are one
    /// rotation vector.
    ///
    /// # Errors
    /// `values` is not as long as [`Joint::coordinates`].
    pub fn displacement(&self, values: &[f64]) -> Result<Isometry3<f64>, ValueCountError> {
        ValueCountError::check(&self.name, values, self.coordinates.len())?;
        Ok(self.moved_to(values))
    }

    /// The displacement for as many values as there are coordinates.
    pub(super) fn moved_to(&self, values: &[f64]) -> Isometry3<f64> {
        let from_home = |i: usize| values[i] - self.coordinates[i].home;
        if self.kind == JointKind::Spherical {
            let rotation = UnitQuaternion::from_scaled_axis(Vector3::from_fn(|i, _| from_home(i)));
            let p = self.point.coords;
            return Isometry3::from_parts(Translation3::from(p - rotation * p), rotation);
        }
        let screws = self.screws();
        let motions = screws.iter().enumerate().map(|(i, screw)| screw.exp(from_home(i)));
        motions.fold(Isometry3::identity(), |g, motion| g * motion)
    }
}
