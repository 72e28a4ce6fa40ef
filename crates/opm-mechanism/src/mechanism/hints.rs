//! How the platform's pose is measured, where the geometry alone leaves it open.

use crate::mechanism::leg::Section;
use crate::numeric::Quantity;
use nalgebra::{Point3, Vector3};
use std::fmt;
use std::ops::{Add, Sub};

/// How the platform's pose is measured: `[task]` in a mechanism file.
///
/// What is not given follows from the geometry, by the rules in the docs of `opm_core::task`.
/// These docs also list what each subspace leaves free.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TaskHints {
    /// The intersection motion's positive direction is the one on the side of this vector.
    pub axis: Option<Vector3<f64>>,
    /// The lower section's frame.
    pub lower: FrameHints,
    /// The upper section's frame.
    pub upper: FrameHints,
    /// The angles that an orientation is written with; `None` for those that suit the mechanism.
    pub coordinates: Option<OrientationCoordinates>,
    /// Home values of task coordinates by name, metres or radians; the others follow from the
    /// geometry.
    pub home: Vec<(String, f64)>,
    /// The names of the task coordinates from which the others follow, where they are not those that opm chooses; empty where
    /// it does.
    pub independent: Vec<String>,
}

/// The task coordinates whose values at home a file can give. An orientation at home is given in Euler angles or in roll,
/// pitch and yaw, whichever angles poses are written with. Tilt and torsion follow from it.
pub const HOME_COORDINATES: [(&str, Quantity); 15] = {
    use Quantity::{Angle, Length};
    [
        ("x", Length),
        ("y", Length),
        ("z", Length),
        ("h", Length),
        ("w", Length),
        ("theta", Angle),
        ("phi", Angle),
        ("zeta", Angle),
        ("xi", Angle),
        ("psi", Angle),
        ("roll", Angle),
        ("pitch", Angle),
        ("yaw", Angle),
        ("mu", Angle),
        ("nu", Angle),
    ]
};

/// The angles with which the orientation of a spherical section is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "kebab-case"))]
pub enum OrientationCoordinates {
    /// Euler angles: `zeta xi psi` with `R = Rz(zeta) Ry(xi) Rz(psi)`.
    EulerAngles,
    /// Tilt and torsion: `azimuth tilt torsion` with `R = Rz(azimuth) Ry(tilt) Rz(torsion - azimuth)` (I. A. Bonev,
    /// *Geometric analysis of parallel mechanisms*, 2002). The third direction is tilted towards the azimuth, and a
    /// torsion of zero is a tilt alone, whichever way.
    TiltTorsion,
    /// Roll, pitch and yaw: `roll pitch yaw` with `R = Rz(yaw) Ry(pitch) Rx(roll)`. They are regular where the others are
    /// singular, at the identity.
    RollPitchYaw,
}

impl OrientationCoordinates {
    /// All of them, with their names in files and options.
    pub const NAMED: [(&'static str, Self); 3] = [
        ("euler-angles", Self::EulerAngles),
        ("tilt-torsion", Self::TiltTorsion),
        ("roll-pitch-yaw", Self::RollPitchYaw),
    ];

    /// The name in files and options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::EulerAngles => "euler-angles",
            Self::TiltTorsion => "tilt-torsion",
            Self::RollPitchYaw => "roll-pitch-yaw",
        }
    }

    /// The choice with a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMED.into_iter().find(|(known, _)| *known == name).map(|(_, choice)| choice)
    }

    /// The angles of the three rotations whose product is the orientation, from left to right, for three angles of this
    /// kind. The first is about the third direction, the second about the second, and the last about the third or, of roll,
    /// pitch and yaw, the first. It is linear.
    #[inline(always)]
    pub fn to_factors<T: Copy + Sub<Output = T>>(self, [first, second, third]: [T; 3]) -> [T; 3] {
        match self {
            Self::EulerAngles => [first, second, third],
            Self::TiltTorsion => [first, second, third - first],
            Self::RollPitchYaw => [third, second, first],
        }
    }

    /// Three angles of this kind for those of the three rotations.
    #[inline(always)]
    pub fn of_factors<T: Copy + Add<Output = T>>(self, [first, second, last]: [T; 3]) -> [T; 3] {
        match self {
            Self::EulerAngles => [first, second, last],
            Self::TiltTorsion => [first, second, first + last],
            Self::RollPitchYaw => [last, second, first],
        }
    }
}

/// Hints for the frame of one section, in base coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FrameHints {
    /// Direction of the coordinate `x`; in a spherical subspace and in a translational space, direction of the
    /// frame's first axis.
    pub x: Option<Vector3<f64>>,
    /// The third direction of the frame of a sphere or of a translational space, or a vector on the positive side of a
    /// cylinder's axis, where the two subspaces share no motion.
    pub axis: Option<Vector3<f64>>,
    /// Positive direction of the coordinate `w`.
    pub w: Option<Vector3<f64>>,
    /// Normal of the plane; the plane's angle is positive about it.
    pub normal: Option<Vector3<f64>>,
    /// The point that lengths are measured from, metres.
    pub origin: Option<Point3<f64>>,
}

impl TaskHints {
    /// The hints for the frame of one section.
    pub fn frame(&self, section: Section) -> &FrameHints {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }
}

/// The key of one hint in a mechanism file: `axis`, `lower.x`, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskKey {
    /// `axis`: [`TaskHints::axis`].
    Axis,
    /// `coordinates`: [`TaskHints::coordinates`].
    Coordinates,
    /// `home`: [`TaskHints::home`].
    Home,
    /// `independent`: [`TaskHints::independent`].
    Independent,
    /// `axis` of a section: [`FrameHints::axis`].
    AxisOf(Section),
    /// `x` of a section: [`FrameHints::x`].
    X(Section),
    /// `w` of a section: [`FrameHints::w`].
    W(Section),
    /// `normal` of a section: [`FrameHints::normal`].
    Normal(Section),
    /// `origin` of a section: [`FrameHints::origin`].
    Origin(Section),
}

impl TaskKey {
    /// The last part of the key: `x`, `w`, `normal`, `origin`, `axis`, `coordinates`, `home`, or `independent`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axis | Self::AxisOf(_) => "axis",
            Self::Coordinates => "coordinates",
            Self::Home => "home",
            Self::Independent => "independent",
            Self::X(_) => "x",
            Self::W(_) => "w",
            Self::Normal(_) => "normal",
            Self::Origin(_) => "origin",
        }
    }
}

impl fmt::Display for TaskKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        match self {
            Self::Axis | Self::Coordinates | Self::Home | Self::Independent => f.write_str(name),
            Self::AxisOf(section)
            | Self::X(section)
            | Self::W(section)
            | Self::Normal(section)
            | Self::Origin(section) => write!(f, "{section}.{name}"),
        }
    }
}
