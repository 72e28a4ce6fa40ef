//! The frame of a section's subspace, from the geometry and from the file's hints.

use super::{FrameProblem, IntersectionAxis, TaskError};
use crate::group::subspace::{SubspaceClass, TOLERANCE, points_up, upward};
use crate::group::{MotionType, Subspace, SubspaceKind};
use crate::mechanism::leg::Section;
use crate::mechanism::{FrameHints, TaskKey};
use nalgebra::{Matrix3, Point3, Unit, Vector3};

/// The intersection motion and the platform, from which both frames are chosen.
pub(super) struct Meeting {
    /// `None` where the two subspaces share the identity alone.
    pub intersection: Option<IntersectionAxis>,
    /// The platform's reference point at home, base coordinates.
    pub platform: Point3<f64>,
}

impl Meeting {
    fn shared(&self) -> Option<MotionType> {
        self.intersection.as_ref().map(IntersectionAxis::motion_type)
    }

    /// The platform's reference point, moved onto the axis of the intersection motion where that is a line.
    fn centre(&self) -> Point3<f64> {
        match &self.intersection {
            Some(IntersectionAxis { direction, point: Some(p) }) => {
                p + direction.into_inner() * direction.dot(&(self.platform - p))
            }
            Some(IntersectionAxis { point: None, .. }) | None => self.platform,
        }
    }

    /// The third direction of a frame: that of the intersection motion, or what the subspace has instead.
    fn third(&self, instead: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
        self.intersection.as_ref().map_or(instead, |intersection| intersection.direction)
    }
}

/// The frame of a subspace, by the rules in the docs of [`task`](crate::task) and the file's hints.
pub(super) fn lay(
    class: &SubspaceClass,
    section: Section,
    meeting: &Meeting,
    hints: &FrameHints,
) -> Result<Subspace, TaskError> {
    let (centre, shared) = (meeting.centre(), meeting.shared());
    let rotation = shared == Some(MotionType::Rotation);
    let (kind, at_home, normal) = match class {
        SubspaceClass::Identity => (SubspaceKind::Identity, centre, Vector3::z_axis()),
        // A Schoenflies section is a planar one at a height.
        SubspaceClass::Planar { normal } | SubspaceClass::Schoenflies { axis: normal } => {
            (SubspaceKind::Planar, centre, if rotation { meeting.third(*normal) } else { *normal })
        }
        SubspaceClass::Spherical { centre: middle } => {
            let pole = hints.axis.map_or(Vector3::z_axis(), Unit::new_normalize);
            (SubspaceKind::Spherical, *middle, meeting.third(pole))
        }
        SubspaceClass::Cylindrical { axis: line, point } => {
            let on_axis = point + line.into_inner() * line.dot(&(centre - point));
            let hinted = match hints.axis {
                Some(hint) if hint.dot(line) < 0.0 => -*line,
                Some(_) => *line,
                None => upward(*line),
            };
            (SubspaceKind::Cylindrical, on_axis, meeting.third(hinted))
        }
        SubspaceClass::TranslationalPlane { normal } => {
            (SubspaceKind::TranslationalPlane, centre, *normal)
        }
        SubspaceClass::TranslationalSpace => {
            let third = hints.axis.map_or(Vector3::z_axis(), Unit::new_normalize);
            (SubspaceKind::TranslationalSpace, centre, meeting.third(third))
        }
        SubspaceClass::Rotation { .. }
        | SubspaceClass::Translation { .. }
        | SubspaceClass::Helical { .. }
        | SubspaceClass::PlanarHelical { .. }
        | SubspaceClass::Full => {
            return Err(TaskError::Subspace { section, name: class.name(), odd: None });
        }
    };
    let hints = Checked { hints, section, kind, name: class.name(), shared };
    hints.refuse_what_is_not_free()?;
    hints.refuse_a_perpendicular_axis(&normal)?;
    let flat = match kind {
        SubspaceKind::Planar | SubspaceKind::TranslationalPlane => true,
        SubspaceKind::Identity
        | SubspaceKind::Spherical
        | SubspaceKind::Cylindrical
        | SubspaceKind::TranslationalSpace => false,
    };
    let given = hints.sense(TaskKey::Normal(section), normal)?;
    let axes =
        if let (true, Some(MotionType::Translation), Section::Upper) = (flat, shared, section) {
            let across = Unit::new_normalize(normal.cross(&meeting.third(normal)));
            let w = hints.sense(TaskKey::W(section), across)?.unwrap_or_else(|| upward(across));
            let third = given.unwrap_or_else(|| standing(normal, beside(&normal)));
            triad(Unit::new_normalize(w.cross(&third)), third)
        } else {
            let free = flat && !rotation;
            let hint = hints.perpendicular(TaskKey::X(section), normal)?;
            // The third direction of a free plane is chosen with the first one; a cylinder has no coordinate along that.
            let fixed = (rotation && kind != SubspaceKind::Cylindrical)
                || kind == SubspaceKind::TranslationalSpace;
            let first = hint.unwrap_or_else(|| match fixed {
                true => beside_upright(&normal),
                false => beside(&normal),
            });
            let third = if free { standing(normal, first) } else { normal };
            triad(first, given.unwrap_or(third))
        };
    let origin = if kind == SubspaceKind::Spherical { at_home } else { Point3::origin() };
    Ok(Subspace {
        kind,
        origin: at_home,
        axes,
        measured_from: hints.hints.origin.unwrap_or(origin),
    })
}

/// A unit direction perpendicular to `third`: the base's x projected into the plane, or its y where x is
/// nearly normal to the plane.
fn beside(third: &Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    /// Beyond this cosine (84 degrees out of the plane), the base's x is not used.
    const STEEP: f64 = 0.995;
    let base = if third.x.abs() > STEEP { Vector3::y() } else { Vector3::x() };
    Unit::new_normalize(base - third.into_inner() * third.dot(&base))
}

/// The same, in that of its two senses for which the sum of the third and the second direction points up: where the plane is
/// upright, the second direction does. The third direction has its sense already.
fn beside_upright(third: &Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    let first = beside(third);
    if points_up(&(third.into_inner() + third.cross(&first))) { first } else { -first }
}

/// The right-handed frame with this first and third direction, which must be perpendicular.
fn triad(first: Unit<Vector3<f64>>, third: Unit<Vector3<f64>>) -> Matrix3<f64> {
    let second = third.cross(&first);
    Matrix3::from_columns(&[first.into_inner(), second, third.into_inner()])
}

/// The sense of a plane's normal, for a first direction in it: the one for which the sum of the normal and
/// the second direction points up. In a horizontal plane the normal then points up; in a vertical plane the
/// second direction does.
fn standing(normal: Unit<Vector3<f64>>, first: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if points_up(&(normal.into_inner() + normal.cross(&first))) { normal } else { -normal }
}

/// The file's hints on a frame, which are checked against the geometry.
struct Checked<'a> {
    hints: &'a FrameHints,
    section: Section,
    kind: SubspaceKind,
    /// The name of the subspace.
    name: &'static str,
    shared: Option<MotionType>,
}

impl Checked<'_> {
    /// The keys that the geometry leaves free to choose.
    fn free(&self) -> Vec<TaskKey> {
        use MotionType::{Rotation, Translation};
        let keys: &[fn(Section) -> TaskKey] = match (self.kind, self.section, self.shared) {
            (SubspaceKind::Identity, ..) => &[],
            (SubspaceKind::Planar, _, Some(Rotation)) => &[TaskKey::X, TaskKey::Origin],
            (SubspaceKind::Planar | SubspaceKind::TranslationalPlane, Section::Lower, _)
            | (SubspaceKind::Planar | SubspaceKind::TranslationalPlane, Section::Upper, None) => {
                &[TaskKey::X, TaskKey::Normal, TaskKey::Origin]
            }
            (SubspaceKind::Planar, Section::Upper, Some(Translation)) => {
                &[TaskKey::W, TaskKey::Normal, TaskKey::Origin]
            }
            (SubspaceKind::TranslationalPlane, Section::Upper, Some(_)) => {
                &[TaskKey::W, TaskKey::Origin]
            }
            (SubspaceKind::Spherical, _, Some(_)) => &[TaskKey::X],
            (SubspaceKind::Spherical, _, None) => &[TaskKey::X, TaskKey::AxisOf],
            (SubspaceKind::Cylindrical, Section::Upper, Some(Translation)) => &[],
            (SubspaceKind::Cylindrical, _, Some(_)) => &[TaskKey::Origin],
            (SubspaceKind::Cylindrical, _, None) => &[TaskKey::AxisOf, TaskKey::Origin],
            (SubspaceKind::TranslationalSpace, _, Some(_)) => &[TaskKey::X, TaskKey::Origin],
            (SubspaceKind::TranslationalSpace, _, None) => {
                &[TaskKey::X, TaskKey::AxisOf, TaskKey::Origin]
            }
        };
        keys.iter().map(|key| key(self.section)).collect()
    }

    /// Returns an error for a hint on a key that is not free.
    fn refuse_what_is_not_free(&self) -> Result<(), TaskError> {
        let (h, s) = (self.hints, self.section);
        let given = [
            (TaskKey::X(s), h.x.is_some()),
            (TaskKey::AxisOf(s), h.axis.is_some()),
            (TaskKey::W(s), h.w.is_some()),
            (TaskKey::Normal(s), h.normal.is_some()),
            (TaskKey::Origin(s), h.origin.is_some()),
        ];
        let free = self.free();
        match given.iter().find(|(key, given)| *given && !free.contains(key)) {
            Some((key, _)) => {
                let free = free.iter().map(|key| key.name()).collect();
                let problem = FrameProblem::NotFree { subspace: self.name, free };
                Err(TaskError::Frame { key: *key, problem })
            }
            None => Ok(()),
        }
    }

    /// Returns an error for a hint on the sense of `line` that chooses neither of its two directions.
    fn refuse_a_perpendicular_axis(&self, line: &Unit<Vector3<f64>>) -> Result<(), TaskError> {
        let key = TaskKey::AxisOf(self.section);
        match self.given(key) {
            Some(given) if given.dot(line).abs() <= TOLERANCE => {
                let (given, line) = (given.into_inner().into(), line.into_inner().into());
                let problem = FrameProblem::Perpendicular { given, line };
                Err(TaskError::Frame { key, problem })
            }
            Some(_) | None => Ok(()),
        }
    }

    /// The unit direction of a hint, if it is given.
    fn given(&self, key: TaskKey) -> Option<Unit<Vector3<f64>>> {
        let given = match key {
            TaskKey::X(_) => self.hints.x,
            TaskKey::W(_) => self.hints.w,
            TaskKey::Normal(_) => self.hints.normal,
            TaskKey::AxisOf(_) => self.hints.axis,
            TaskKey::Axis
            | TaskKey::Coordinates
            | TaskKey::Home
            | TaskKey::Independent
            | TaskKey::Origin(_) => None,
        };
        given.map(Unit::new_normalize)
    }

    /// The direction of `line` in the sense of the file's hint, if there is one. The hint must be along the
    /// line.
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

    /// The direction of the file's hint, if there is one. The hint must be perpendicular to `to`.
    fn perpendicular(
        &self,
        key: TaskKey,
        to: Unit<Vector3<f64>>,
    ) -> Result<Option<Unit<Vector3<f64>>>, TaskError> {
        let Some(given) = self.given(key) else { return Ok(None) };
        if given.dot(&to).abs() > TOLERANCE {
            let (given, to) = (given.into_inner().into(), to.into_inner().into());
            return Err(TaskError::Frame {
                key,
                problem: FrameProblem::NotPerpendicular { given, to },
            });
        }
        Ok(Some(Unit::new_normalize(given.into_inner() - to.into_inner() * to.dot(&given))))
    }
}
