//! The coordinates of a pose: the kinds of coordinates, and those of each section.

use crate::group::{MotionType, Subspace, SubspaceKind};
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use std::f64::consts::PI;

/// What a task coordinate measures; the table in the docs of [`task`](crate::task) says which subspaces
/// have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoordinateKind {
    /// `x`: the frame's centre along a plane's first direction.
    X,
    /// `y`: the frame's centre along a plane's second direction.
    Y,
    /// `z`: along a cylinder's axis; the height of a Schoenflies section; along the third direction of a translational
    /// space.
    Z,
    /// `h`: the height of an upper Schoenflies section, where a cylinder below has `z`; with `w`, along the second
    /// direction of an upper translational space.
    H,
    /// `w`: in the upper plane, perpendicular to the intersection motion; along the axis of an upper cylinder
    /// that shares no motion; along the first direction of an upper translational space.
    W,
    /// `theta`: the angle of the lower section about its normal or its axis.
    Theta,
    /// `phi`: the angle of the upper section about its normal or its axis.
    Phi,
    /// `zeta`: the first Euler angle, about the third direction.
    Zeta,
    /// `xi`: the second Euler angle, about the second direction; singular where its sine is zero.
    Xi,
    /// `psi`: the third Euler angle, about the third direction.
    Psi,
    /// `azimuth`: the direction towards which the third direction is tilted, from the first direction towards the second;
    /// it has no meaning at a tilt of zero.
    Azimuth,
    /// `tilt`: the angle of the third direction with that at a tilt of zero; singular where its sine is zero.
    Tilt,
    /// `torsion`: the rotation about the third direction that a tilt alone would not make.
    Torsion,
    /// `roll`: the angle of roll, pitch and yaw about the first direction, which is applied first.
    Roll,
    /// `pitch`: their angle about the second direction; singular where its cosine is zero.
    Pitch,
    /// `yaw`: their angle about the third direction.
    Yaw,
    /// `mu`: the first tilt of the axis of the intersection motion, about the first direction.
    Mu,
    /// `nu`: its second tilt, about the second direction; singular where its cosine is zero.
    Nu,
}

impl CoordinateKind {
    /// Every kind.
    pub const ALL: [Self; 18] = [
        Self::X,
        Self::Y,
        Self::Z,
        Self::H,
        Self::W,
        Self::Theta,
        Self::Phi,
        Self::Zeta,
        Self::Xi,
        Self::Psi,
        Self::Azimuth,
        Self::Tilt,
        Self::Torsion,
        Self::Roll,
        Self::Pitch,
        Self::Yaw,
        Self::Mu,
        Self::Nu,
    ];

    /// The coordinate's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::H => "h",
            Self::W => "w",
            Self::Theta => "theta",
            Self::Phi => "phi",
            Self::Zeta => "zeta",
            Self::Xi => "xi",
            Self::Psi => "psi",
            Self::Azimuth => "azimuth",
            Self::Tilt => "tilt",
            Self::Torsion => "torsion",
            Self::Roll => "roll",
            Self::Pitch => "pitch",
            Self::Yaw => "yaw",
            Self::Mu => "mu",
            Self::Nu => "nu",
        }
    }

    /// The kind of coordinate with a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether the coordinate is an angle or a length.
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::X | Self::Y | Self::Z | Self::H | Self::W => Quantity::Length,
            Self::Theta
            | Self::Phi
            | Self::Zeta
            | Self::Xi
            | Self::Psi
            | Self::Azimuth
            | Self::Tilt
            | Self::Torsion
            | Self::Roll
            | Self::Pitch
            | Self::Yaw
            | Self::Mu
            | Self::Nu => Quantity::Angle,
        }
    }
}

/// One coordinate of the pose.
///
/// ```
/// use opm_core::{Manipulator, Quantity};
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let angle = &manipulator.task_coordinates()[2];
/// assert_eq!((angle.name, angle.quantity, angle.home), ("theta", Quantity::Angle, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TaskCoordinate {
    kind: CoordinateKind,
    /// The name of its [`kind`](Self::kind), unique among the mechanism's task coordinates.
    pub name: &'static str,
    /// Whether it is an angle or a length.
    pub quantity: Quantity,
    /// The value at home, radians or metres.
    pub home: f64,
}

impl TaskCoordinate {
    /// A coordinate with its value at home, radians or metres.
    pub const fn new(kind: CoordinateKind, home: f64) -> Self {
        Self { kind, name: kind.name(), quantity: kind.quantity(), home }
    }

    /// What the coordinate measures.
    pub const fn kind(&self) -> CoordinateKind {
        self.kind
    }
}

/// The coordinates of `v`. The values of lengths at home are the coordinates of the frame's centre.
pub(super) fn of_lower(frame: &Subspace, shared: Option<MotionType>) -> Vec<TaskCoordinate> {
    use CoordinateKind::{Mu, Nu, Psi, Theta, X, Xi, Y, Z, Zeta};
    let at = frame.home();
    match (frame.kind, shared) {
        (SubspaceKind::Identity, _) => vec![],
        (SubspaceKind::Planar, Some(MotionType::Rotation))
        | (SubspaceKind::TranslationalPlane, _) => listed([(X, at.x), (Y, at.y)]),
        (SubspaceKind::Planar, Some(MotionType::Translation) | None) => {
            listed([(X, at.x), (Y, at.y), (Theta, 0.0)])
        }
        (SubspaceKind::Spherical, Some(_)) => listed([(Mu, 0.0), (Nu, 0.0)]),
        (SubspaceKind::Spherical, None) => listed([(Zeta, 0.0), (Xi, 0.0), (Psi, 0.0)]),
        (SubspaceKind::Cylindrical, Some(MotionType::Rotation)) => listed([(Z, at.z)]),
        (SubspaceKind::Cylindrical, Some(MotionType::Translation) | None) => {
            listed([(Theta, 0.0), (Z, at.z)])
        }
        (SubspaceKind::TranslationalSpace, _) => listed([(X, at.x), (Y, at.y), (Z, at.z)]),
    }
}

/// The coordinates of `b`. The values of lengths at home are the coordinates of the frame's centre.
pub(super) fn of_upper(frame: &Subspace, shared: Option<MotionType>) -> Vec<TaskCoordinate> {
    use CoordinateKind::{H, Phi, Psi, W, X, Xi, Y, Z, Zeta};
    let at = frame.home();
    match (frame.kind, shared) {
        (SubspaceKind::Identity, _) => vec![],
        (SubspaceKind::Spherical, _) => listed([(Zeta, 0.0), (Xi, 0.0), (Psi, 0.0)]),
        (SubspaceKind::Planar, Some(MotionType::Rotation) | None) => {
            listed([(X, at.x), (Y, at.y), (Phi, 0.0)])
        }
        (SubspaceKind::Planar, Some(MotionType::Translation)) => listed([(W, at.y), (Phi, 0.0)]),
        (SubspaceKind::Cylindrical, Some(MotionType::Rotation)) => listed([(Phi, 0.0), (Z, at.z)]),
        (SubspaceKind::Cylindrical, Some(MotionType::Translation)) => listed([(Phi, 0.0)]),
        (SubspaceKind::Cylindrical, None) => listed([(Phi, 0.0), (W, at.z)]),
        (SubspaceKind::TranslationalPlane, Some(_)) => listed([(W, at.y)]),
        (SubspaceKind::TranslationalPlane, None) => listed([(X, at.x), (Y, at.y)]),
        (SubspaceKind::TranslationalSpace, Some(_)) => listed([(W, at.x), (H, at.y)]),
        (SubspaceKind::TranslationalSpace, None) => listed([(X, at.x), (Y, at.y), (Z, at.z)]),
    }
}

/// The coordinate that tells the height of a section, and its place: after those that move the centre in the
/// plane. `lower` has the coordinates of the lower section.
pub(super) fn of_height(
    frame: &Subspace,
    coordinates: &[TaskCoordinate],
    lower: &[TaskCoordinate],
) -> (usize, TaskCoordinate) {
    let taken = lower.iter().any(|c| c.kind() == CoordinateKind::Z);
    let kind = if taken { CoordinateKind::H } else { CoordinateKind::Z };
    let in_plane = coordinates.iter().filter(|c| c.quantity == Quantity::Length).count();
    (in_plane, TaskCoordinate::new(kind, frame.home().z))
}

/// Replaces Euler angles, with their values at home, by tilt and torsion; the tilt at home is in [0, π].
pub(super) fn write_tilt_and_torsion(of_section: &mut [TaskCoordinate]) {
    let [zeta, xi, psi] = [0, 1, 2].map(|i: usize| of_section[i].home);
    let reduced = near(xi, 0.0);
    let (azimuth, tilt) =
        if reduced < 0.0 { (near(zeta + PI, 0.0), -reduced) } else { (zeta, reduced) };
    // Rz(π) Ry(-tilt) Rz(-π) = Ry(tilt): the torsion is the same.
    let home = [
        (CoordinateKind::Azimuth, azimuth),
        (CoordinateKind::Tilt, tilt),
        (CoordinateKind::Torsion, zeta + psi),
    ];
    of_section.clone_from_slice(&listed(home));
}

/// Replaces Euler angles by roll, pitch and yaw with these values at home.
pub(super) fn write_roll_pitch_yaw(of_section: &mut [TaskCoordinate], home: [f64; 3]) {
    let kinds = [CoordinateKind::Roll, CoordinateKind::Pitch, CoordinateKind::Yaw];
    for ((coordinate, kind), home) in of_section.iter_mut().zip(kinds).zip(home) {
        *coordinate = TaskCoordinate::new(kind, home);
    }
}

fn listed<const N: usize>(coordinates: [(CoordinateKind, f64); N]) -> Vec<TaskCoordinate> {
    coordinates.into_iter().map(|(kind, home)| TaskCoordinate::new(kind, home)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::HOME_COORDINATES;

    #[test]
    fn a_name_is_that_of_one_kind() {
        for kind in CoordinateKind::ALL {
            assert_eq!(CoordinateKind::from_name(kind.name()), Some(kind));
            assert_eq!(TaskCoordinate::new(kind, 0.5).kind(), kind);
        }
        assert_eq!(CoordinateKind::from_name("xI"), None);
    }

    #[test]
    fn a_file_can_give_the_home_of_every_kind() {
        use CoordinateKind::{Azimuth, Tilt, Torsion};
        let kinds = CoordinateKind::ALL.into_iter();
        let given = kinds.filter(|kind| !matches!(kind, Azimuth | Tilt | Torsion));
        let mut given: Vec<_> = given.map(|kind| (kind.name(), kind.quantity())).collect();
        let mut known = HOME_COORDINATES.to_vec();
        given.sort_by_key(|(name, _)| *name);
        known.sort_by_key(|(name, _)| *name);
        assert_eq!(known, given);
    }
}
