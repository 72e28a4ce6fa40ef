//! A subspace with the frame that its chains and its task coordinates use.

use super::TaskError;
use super::displacement::{Cut, Displacement};
use crate::chain::cylindrical::CylindricalDisplacement;
use crate::chain::planar::PlanarDisplacement;
use crate::subspace::SubspaceClass;
use nalgebra::{
    Complex, Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3,
};

/// The four subspaces that have closed-form chains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubspaceKind {
    /// `SE(2)`: two translations and the rotation about their normal.
    Planar,
    /// `SO(3)`: rotations about a centre.
    Spherical,
    /// Rotation about and translation along an axis.
    Cylindrical,
    /// Two translations.
    TranslationalPlane,
}

impl SubspaceKind {
    /// The displacement of this kind that displaces nothing.
    pub(crate) fn identity(self) -> Displacement {
        match self {
            Self::Planar => Displacement::Planar(PlanarDisplacement::IDENTITY),
            Self::Spherical => Displacement::Spherical(Matrix3::identity()),
            Self::Cylindrical | Self::TranslationalPlane => self.flat(0.0, 0.0),
        }
    }

    /// The displacement with these two numbers, of a kind whose displacements add up: angle and advance,
    /// or a translation.
    pub(crate) fn flat(self, first: f64, second: f64) -> Displacement {
        match self {
            Self::Cylindrical => Displacement::Cylindrical(CylindricalDisplacement {
                angle: first,
                advance: second,
            }),
            _ => Displacement::Translational(Complex::new(first, second)),
        }
    }
}

/// A subspace with the frame that its chains and its task coordinates use.
#[derive(Clone, Debug, PartialEq)]
pub struct Subspace {
    /// Which.
    pub kind: SubspaceKind,
    /// Where the frame's origin is at home, base coordinates.
    pub origin: Point3<f64>,
    /// Columns: the frame's directions in base coordinates. The third is the normal of a plane, the
    /// axis of a cylinder, and the intersection motion's axis in a sphere.
    pub axes: Matrix3<f64>,
}

impl Subspace {
    pub(super) fn new(
        class: &SubspaceClass,
        cut_axis: Unit<Vector3<f64>>,
        cut_point: Option<Point3<f64>>,
        platform: &Point3<f64>,
        along_cut: bool,
    ) -> Result<Self, TaskError> {
        // The reference point: on the axis of I where that is a line, else the platform's own.
        let reference = cut_point
            .map_or(*platform, |p| p + cut_axis.into_inner() * cut_axis.dot(&(platform - p)));
        let rotation = cut_point.is_some();
        let (kind, origin, third) = match class {
            SubspaceClass::Planar { normal } => {
                (SubspaceKind::Planar, reference, if rotation { cut_axis } else { *normal })
            }
            SubspaceClass::Spherical { centre } => (SubspaceKind::Spherical, *centre, cut_axis),
            SubspaceClass::Cylindrical { axis, point } => {
                let on_axis = point + axis.into_inner() * axis.dot(&(reference - point));
                (SubspaceKind::Cylindrical, on_axis, cut_axis)
            }
            SubspaceClass::TranslationalPlane { normal } => {
                (SubspaceKind::TranslationalPlane, reference, *normal)
            }
            other => return Err(TaskError::Subspace(other.name())),
        };
        // An upper plane that is taken modulo I lays its first direction along I.
        let flat = matches!(kind, SubspaceKind::Planar | SubspaceKind::TranslationalPlane);
        let first = if flat && !rotation && along_cut { cut_axis } else { beside(&third) };
        let first =
            Unit::new_normalize(first.into_inner() - third.into_inner() * third.dot(&first));
        let second = third.cross(&first);
        let axes = Matrix3::from_columns(&[first.into_inner(), second, third.into_inner()]);
        Ok(Self { kind, origin, axes })
    }

    /// Number of freedoms of the motion inside it.
    pub fn dimension(&self) -> usize {
        match self.kind {
            SubspaceKind::Planar | SubspaceKind::Spherical => 3,
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => 2,
        }
    }

    /// A direction of the base in this frame.
    pub fn direction(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(direction)
    }

    /// A point of the base in this frame.
    pub fn point(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(&(point - self.origin))
    }

    /// A displacement of this subspace in base coordinates.
    pub fn isometry(&self, displacement: &Displacement) -> Isometry3<f64> {
        let (rotation, translation) = match displacement {
            Displacement::Planar(g) => (
                Rotation3::from_axis_angle(&Vector3::z_axis(), g.rotation.arg()),
                Vector3::new(g.translation.re, g.translation.im, 0.0),
            ),
            Displacement::Spherical(r) => (Rotation3::from_matrix_unchecked(*r), Vector3::zeros()),
            Displacement::Cylindrical(g) => {
                (Rotation3::from_axis_angle(&Vector3::z_axis(), g.angle), Vector3::z() * g.advance)
            }
            Displacement::Translational(t) => {
                (Rotation3::identity(), Vector3::new(t.re, t.im, 0.0))
            }
        };
        let axes =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.axes));
        let frame = Isometry3::from_parts(Translation3::from(self.origin), axes);
        let local = Isometry3::from_parts(
            Translation3::from(translation),
            UnitQuaternion::from_rotation_matrix(&rotation),
        );
        frame * local * frame.inverse()
    }

    pub(super) fn cut(&self, axis: &Unit<Vector3<f64>>, rotation: bool) -> Cut {
        if rotation {
            return Cut::Turn;
        }
        match self.kind {
            SubspaceKind::Cylindrical => Cut::Advance,
            _ => {
                let d = self.direction(axis);
                Cut::Slide(Complex::new(d.x, d.y))
            }
        }
    }
}

/// A direction square to `third`: base x laid into the plane, or base y where x is nearly normal.
fn beside(third: &Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    /// Base x leans out of the plane by more than about 84 degrees: too far to lay it down.
    const STEEP: f64 = 0.995;
    let base = if third.x.abs() > STEEP { Vector3::y() } else { Vector3::x() };
    Unit::new_normalize(base - third.into_inner() * third.dot(&base))
}
