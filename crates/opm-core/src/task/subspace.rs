//! A subspace with the frame that its chains and its task coordinates use.

use super::displacement::{Cut, Displacement};
use super::{FrameProblem, TaskError};
use crate::chain::cylindrical::CylindricalDisplacement;
use crate::group::subspace::{SubspaceClass, TOLERANCE, points_up, upward};
use crate::mechanism::leg::Section;
use crate::mechanism::{FrameHints, TaskKey};
use nalgebra::{
    Complex, Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3,
};
use std::fmt;

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
    /// The kind of a subspace, if it has closed-form chains.
    pub fn of(class: &SubspaceClass) -> Option<Self> {
        match class {
            SubspaceClass::Planar { .. } => Some(Self::Planar),
            SubspaceClass::Spherical { .. } => Some(Self::Spherical),
            SubspaceClass::Cylindrical { .. } => Some(Self::Cylindrical),
            SubspaceClass::TranslationalPlane { .. } => Some(Self::TranslationalPlane),
            _ => None,
        }
    }

    /// The displacement with these two numbers, of a kind whose displacements add up: angle and advance,
    /// or a translation.
    pub(crate) fn flat(self, first: f64, second: f64) -> Displacement {
        match self {
            Self::Cylindrical => {
                Displacement::Cylindrical(CylindricalDisplacement { angle: first, advance: second })
            }
            _ => Displacement::Translational(Complex::new(first, second)),
        }
    }
}

impl fmt::Display for SubspaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Planar => "planar",
            Self::Spherical => "spherical",
            Self::Cylindrical => "cylindrical",
            Self::TranslationalPlane => "translational plane",
        })
    }
}

/// A subspace with the frame that its chains and its task coordinates use.
#[derive(Clone, Debug, PartialEq)]
pub struct Subspace {
    /// Which.
    pub kind: SubspaceKind,
    /// Its reference point at home, base coordinates: the frame's origin for displacements, about
    /// which angles turn.
    pub origin: Point3<f64>,
    /// Columns: the frame's directions in base coordinates. The third is the normal of a plane, the
    /// axis of a cylinder, and the intersection motion's axis in a sphere.
    pub axes: Matrix3<f64>,
    /// The point that lengths are measured from, along the frame's directions, base coordinates: the
    /// base's origin unless the file says otherwise; of a sphere the centre.
    pub measured_from: Point3<f64>,
}

/// The intersection motion and the platform: what both frames are laid by.
pub(super) struct Meeting {
    /// Direction of the intersection motion.
    pub axis: Unit<Vector3<f64>>,
    /// A point of its axis at home, where it is a rotation.
    pub point: Option<Point3<f64>>,
    /// The platform's reference point at home.
    pub platform: Point3<f64>,
}

impl Subspace {
    /// The frame of a subspace, by the rules in the docs of the module above and by what the file
    /// says.
    pub(super) fn new(
        class: &SubspaceClass,
        section: Section,
        meeting: &Meeting,
        hints: &FrameHints,
    ) -> Result<Self, TaskError> {
        let Meeting { axis, point, platform } = meeting;
        // The reference point: on the axis of I where that is a line, else the platform's own.
        let reference =
            point.map_or(*platform, |p| p + axis.into_inner() * axis.dot(&(platform - p)));
        let rotation = point.is_some();
        let (kind, at_home, normal) = match class {
            SubspaceClass::Planar { normal } => {
                (SubspaceKind::Planar, reference, if rotation { *axis } else { *normal })
            }
            SubspaceClass::Spherical { centre } => (SubspaceKind::Spherical, *centre, *axis),
            SubspaceClass::Cylindrical { axis: line, point } => {
                let on_axis = point + line.into_inner() * line.dot(&(reference - point));
                (SubspaceKind::Cylindrical, on_axis, *axis)
            }
            SubspaceClass::TranslationalPlane { normal } => {
                (SubspaceKind::TranslationalPlane, reference, *normal)
            }
            other => return Err(TaskError::Subspace { section, name: other.name(), odd: None }),
        };
        let hints = Checked { hints, section, kind, rotation };
        hints.refuse_what_is_not_free()?;
        let flat = matches!(kind, SubspaceKind::Planar | SubspaceKind::TranslationalPlane);
        let given = hints.sense(TaskKey::Normal(section), normal)?;
        let axes = if flat && !rotation && section == Section::Upper {
            let across = Unit::new_normalize(normal.cross(axis));
            let w = hints.sense(TaskKey::W(section), across)?.unwrap_or_else(|| upward(across));
            let third = given.unwrap_or_else(|| standing(normal, beside(&normal)));
            triad(Unit::new_normalize(w.cross(&third)), third)
        } else {
            let first = hints.square(TaskKey::X(section), normal)?;
            let first = first.unwrap_or_else(|| beside(&normal));
            let free = flat && !rotation;
            let third = if free { standing(normal, first) } else { normal };
            triad(first, given.unwrap_or(third))
        };
        let origin = if kind == SubspaceKind::Spherical { at_home } else { Point3::origin() };
        Ok(Self {
            kind,
            origin: at_home,
            axes,
            measured_from: hints.hints.origin.unwrap_or(origin),
        })
    }

    /// Where its reference point is at home, in its frame and from where lengths are measured.
    pub(super) fn home(&self) -> Vector3<f64> {
        self.axes.tr_mul(&(self.origin - self.measured_from))
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

/// A right-handed frame with this first and third direction, square to each other.
fn triad(first: Unit<Vector3<f64>>, third: Unit<Vector3<f64>>) -> Matrix3<f64> {
    let second = third.cross(&first);
    Matrix3::from_columns(&[first.into_inner(), second, third.into_inner()])
}

/// The normal of a plane with this first direction: where the plane is level the one that points
/// up, where it is upright the one that lets the second direction point up, and between these the
/// one that lets both do so most.
fn standing(normal: Unit<Vector3<f64>>, first: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if points_up(&(normal.into_inner() + normal.cross(&first))) { normal } else { -normal }
}

/// What a file says of a frame, to be held against the geometry.
struct Checked<'a> {
    hints: &'a FrameHints,
    section: Section,
    kind: SubspaceKind,
    rotation: bool,
}

impl Checked<'_> {
    /// What the geometry leaves free.
    fn free(&self) -> Vec<TaskKey> {
        let keys: &[fn(Section) -> TaskKey] = match (self.kind, self.section, self.rotation) {
            (SubspaceKind::Planar, _, true) => &[TaskKey::X, TaskKey::Origin],
            (SubspaceKind::Planar | SubspaceKind::TranslationalPlane, Section::Lower, _) => {
                &[TaskKey::X, TaskKey::Normal, TaskKey::Origin]
            }
            (SubspaceKind::Planar, Section::Upper, false) => {
                &[TaskKey::W, TaskKey::Normal, TaskKey::Origin]
            }
            (SubspaceKind::TranslationalPlane, Section::Upper, _) => &[TaskKey::W, TaskKey::Origin],
            (SubspaceKind::Spherical, ..) => &[TaskKey::X],
            (SubspaceKind::Cylindrical, Section::Upper, false) => &[],
            (SubspaceKind::Cylindrical, ..) => &[TaskKey::Origin],
        };
        keys.iter().map(|key| key(self.section)).collect()
    }

    fn refuse_what_is_not_free(&self) -> Result<(), TaskError> {
        let (h, s) = (self.hints, self.section);
        let given = [
            (TaskKey::X(s), h.x.is_some()),
            (TaskKey::W(s), h.w.is_some()),
            (TaskKey::Normal(s), h.normal.is_some()),
            (TaskKey::Origin(s), h.origin.is_some()),
        ];
        let free = self.free();
        match given.iter().find(|(key, given)| *given && !free.contains(key)) {
            Some((key, _)) => {
                let free = free.iter().map(|key| key.name()).collect();
                let problem = FrameProblem::NotFree { kind: self.kind, free };
                Err(TaskError::Frame { key: *key, problem })
            }
            None => Ok(()),
        }
    }

    fn given(&self, key: TaskKey) -> Option<Unit<Vector3<f64>>> {
        let given = match key {
            TaskKey::X(_) => self.hints.x,
            TaskKey::W(_) => self.hints.w,
            TaskKey::Normal(_) => self.hints.normal,
            TaskKey::Axis | TaskKey::Origin(_) => None,
        };
        given.map(Unit::new_normalize)
    }

    /// The direction of this line that the file asks for; what it says must be along it.
    fn sense(
        &self,
        key: TaskKey,
        line: Unit<Vector3<f64>>,
    ) -> Result<Option<Unit<Vector3<f64>>>, TaskError> {
        let Some(given) = self.given(key) else { return Ok(None) };
        if given.cross(&line).norm() > TOLERANCE {
            let (given, line) = (given.into_inner().into(), line.into_inner().into());
            return Err(TaskError::Frame { key, problem: FrameProblem::NotAlong { given, line } });
        }
        Ok(Some(if given.dot(&line) < 0.0 { -line } else { line }))
    }

    /// The direction square to another that the file asks for; what it says must be so.
    fn square(
        &self,
        key: TaskKey,
        to: Unit<Vector3<f64>>,
    ) -> Result<Option<Unit<Vector3<f64>>>, TaskError> {
        let Some(given) = self.given(key) else { return Ok(None) };
        if given.dot(&to).abs() > TOLERANCE {
            let (given, to) = (given.into_inner().into(), to.into_inner().into());
            return Err(TaskError::Frame { key, problem: FrameProblem::NotSquare { given, to } });
        }
        Ok(Some(Unit::new_normalize(given.into_inner() - to.into_inner() * to.dot(&given))))
    }
}
