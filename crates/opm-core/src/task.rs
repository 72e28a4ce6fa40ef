//! Task coordinates: how a pose of the platform is written, for every pair of partial subspaces.
//!
//! A pose is `g = v · b`, `v` in the lower subspace `A` and `b` in the upper one, `B`. Since the
//! two share the intersection motion `I`, one of them is taken modulo `I`: `v` where `I` is a
//! rotation, `b` where it is a translation.
//!
//! | subspace | as `A`, `I` a rotation | as `A`, `I` a translation | as `B`, `I` a rotation | as `B`, `I` a translation |
//! |---|---|---|---|---|
//! | planar | `x y` | `x y theta` | `x y phi` | `w phi` |
//! | spherical | `mu nu` | | `zeta xi psi` | |
//! | cylindrical | `z` | `theta z` | `phi z` | `phi` |
//! | translational plane | | `x y` | | `w` |
//!
//! `x y` move the reference point in the plane, `w` moves it square to `I`, `z` along the axis;
//! `theta phi` turn about the normal or the axis, `zeta xi psi` are Euler angles
//! `Rz(zeta) Ry(xi) Rz(psi)` and `mu nu` tilt the axis of `I` by `Rx(mu) Ry(nu)`. All of them have
//! their home values at home.

use crate::chain::cylindrical::CylindricalDisplacement;
use crate::chain::planar::PlanarDisplacement;
use crate::chain::{Amount, unit};
use crate::decomposition::Decomposition;
use crate::joint::Quantity;
use crate::mechanism::Mechanism;
use crate::subspace::SubspaceClass;
use nalgebra::{
    Complex, Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3,
};

/// One coordinate of the pose.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskCoordinate {
    /// Name, unique among the mechanism's task coordinates.
    pub name: &'static str,
    /// Angle or length.
    pub quantity: Quantity,
    /// The value at home, radians or metres.
    pub home: f64,
}

/// A displacement inside one subspace, in that subspace's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displacement {
    /// Of the plane.
    Planar(PlanarDisplacement),
    /// About the centre.
    Spherical(Matrix3<f64>),
    /// About and along the axis.
    Cylindrical(CylindricalDisplacement),
    /// In the plane, without rotation.
    Translational(Complex<f64>),
}

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

/// The intersection motion as seen in one subspace's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// Rotation about the frame's origin and third direction.
    Turn,
    /// Translation in this direction of a plane.
    Slide(Complex<f64>),
    /// Translation along a cylinder's axis.
    Advance,
}

/// Why a decomposition has no task coordinates.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TaskError {
    /// A subspace without closed-form chains.
    #[error("no closed-form chains inside a {0} subspace")]
    Subspace(&'static str),
    /// The two subspaces meet in a screw motion.
    #[error(
        "the partial subspaces meet in a screw motion, for which there are no closed-form chains"
    )]
    Screw,
    /// The mechanism names a coordinate that its subspaces do not have.
    #[error("home gives `{name}`, but the task coordinates are {expected}")]
    Unknown {
        /// The name given.
        name: String,
        /// The names there are.
        expected: String,
    },
}

/// The subspaces' frames and the coordinates of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// `A`, which the legs' lower parts move in.
    pub lower: Subspace,
    /// `B`, which their upper parts move in.
    pub upper: Subspace,
    /// The intersection motion in `A`'s frame.
    pub lower_cut: Cut,
    /// The intersection motion in `B`'s frame.
    pub upper_cut: Cut,
    /// Unit direction of the intersection motion, base coordinates.
    pub direction: Unit<Vector3<f64>>,
    /// A point of the intersection motion's axis at home, where it is a rotation.
    pub cut_point: Option<Point3<f64>>,
    /// `v`'s coordinates, then `b`'s.
    pub coordinates: Vec<TaskCoordinate>,
    /// How many of them are `v`'s.
    pub lower_count: usize,
    /// Inverse of the platform's orientation at home, where Euler angles measure it and it is not
    /// the identity.
    home_orientation_inverse: Option<Matrix3<f64>>,
}

impl Task {
    /// Frames and coordinates for a decomposition.
    ///
    /// # Errors
    /// A subspace or an intersection motion that no chain covers, or a home value for a coordinate
    /// that there is not.
    pub fn new(mechanism: &Mechanism, decomposition: &Decomposition) -> Result<Self, TaskError> {
        let (axis, point) = match &decomposition.intersection {
            SubspaceClass::Rotation { axis, point } => (*axis, Some(*point)),
            SubspaceClass::Translation { axis } => (*axis, None),
            _ => return Err(TaskError::Screw),
        };
        let axis = positive(axis, mechanism.task.axis);
        let frame = |class: &SubspaceClass, along_axis: bool| {
            Subspace::new(class, axis, point, &mechanism.platform, along_axis)
        };
        let lower = frame(&decomposition.lower, false)?;
        let upper = frame(&decomposition.upper, true)?;
        let rotation = point.is_some();
        let mut coordinates = lower_coordinates(lower.kind, rotation, &lower);
        let lower_count = coordinates.len();
        coordinates.extend(upper_coordinates(upper.kind, rotation, &upper));
        for (name, value) in &mechanism.task.home {
            match coordinates.iter_mut().find(|c| c.name == name) {
                Some(coordinate) => coordinate.home = *value,
                None => {
                    let names: Vec<_> = coordinates.iter().map(|c| c.name).collect();
                    let expected = names.join(", ");
                    return Err(TaskError::Unknown { name: name.clone(), expected });
                }
            }
        }
        let home_orientation_inverse = if upper.kind == SubspaceKind::Spherical {
            let home = |i: usize| coordinates[lower_count + i].home;
            let orientation = euler(home(0), home(1), home(2));
            (orientation != Matrix3::identity()).then(|| orientation.transpose())
        } else {
            None
        };
        let lower_cut = lower.cut(&axis, rotation);
        let upper_cut = upper.cut(&axis, rotation);
        Ok(Self {
            lower,
            upper,
            lower_cut,
            upper_cut,
            direction: axis,
            cut_point: point,
            coordinates,
            lower_count,
            home_orientation_inverse,
        })
    }

    /// `v` for the first [`Task::lower_count`] coordinates of a pose.
    #[inline]
    pub fn lower(&self, pose: &[f64]) -> Displacement {
        let q = |i: usize| pose[i] - self.coordinates[i].home;
        match (self.lower.kind, self.lower_cut) {
            (SubspaceKind::Planar, Cut::Turn) => planar(Complex::new(1.0, 0.0), q(0), q(1)),
            (SubspaceKind::Planar, _) => planar(unit(q(2)), q(0), q(1)),
            (SubspaceKind::Spherical, _) => {
                let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), q(0))
                    * Rotation3::from_axis_angle(&Vector3::y_axis(), q(1));
                Displacement::Spherical(tilt.into_inner())
            }
            (SubspaceKind::Cylindrical, Cut::Turn) => cylindrical(0.0, q(0)),
            (SubspaceKind::Cylindrical, _) => cylindrical(q(0), q(1)),
            (SubspaceKind::TranslationalPlane, _) => {
                Displacement::Translational(Complex::new(q(0), q(1)))
            }
        }
    }

    /// `b` for the remaining coordinates of a pose (the slice starts with `b`'s first).
    #[inline]
    pub fn upper(&self, pose: &[f64]) -> Displacement {
        let q = |i: usize| pose[i] - self.coordinates[self.lower_count + i].home;
        match (self.upper.kind, self.upper_cut) {
            (SubspaceKind::Spherical, _) => {
                let absolute = euler(pose[0], pose[1], pose[2]);
                Displacement::Spherical(match &self.home_orientation_inverse {
                    Some(inverse) => absolute * inverse,
                    None => absolute,
                })
            }
            (SubspaceKind::Planar, Cut::Turn) => planar(unit(q(2)), q(0), q(1)),
            (SubspaceKind::Planar, _) => planar(unit(q(1)), 0.0, q(0)),
            (SubspaceKind::Cylindrical, Cut::Turn) => cylindrical(q(0), q(1)),
            (SubspaceKind::Cylindrical, _) => cylindrical(q(0), 0.0),
            (SubspaceKind::TranslationalPlane, _) => {
                Displacement::Translational(Complex::new(0.0, q(0)))
            }
        }
    }

    /// The platform's displacement from home at a pose, `g = v · b`, base coordinates.
    pub fn displacement(&self, pose: &[f64]) -> Isometry3<f64> {
        self.lower.isometry(&self.lower(pose))
            * self.upper.isometry(&self.upper(&pose[self.lower_count..]))
    }

    /// Whether a coordinate is an angle that counts whole turns, since a helical joint may.
    pub fn counts_turns(&self, name: &str) -> bool {
        let cylindrical = |subspace: &Subspace| subspace.kind == SubspaceKind::Cylindrical;
        match name {
            "theta" => cylindrical(&self.lower),
            "phi" => cylindrical(&self.upper),
            _ => false,
        }
    }

    /// The pose at home.
    pub fn home(&self) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.home).collect()
    }
}

impl Cut {
    /// `v · exp(I τ)`.
    #[inline]
    pub fn after(&self, v: &Displacement, tau: Amount) -> Displacement {
        match (self, v) {
            (Self::Turn, Displacement::Planar(v)) => Displacement::Planar(PlanarDisplacement {
                rotation: v.rotation * tau.turn(),
                translation: v.translation,
            }),
            (Self::Turn, Displacement::Spherical(r)) => {
                // Columns one and two of R turn; the third, the axis of I, stays.
                let e = tau.turn();
                let (x, y, z) = (r.column(0), r.column(1), r.column(2));
                Displacement::Spherical(Matrix3::from_columns(&[
                    x * e.re + y * e.im,
                    y * e.re - x * e.im,
                    z.into_owned(),
                ]))
            }
            _ => self.commuting(v, tau),
        }
    }

    /// `exp(I τ) · b`.
    #[inline]
    pub fn before(&self, b: &Displacement, tau: Amount) -> Displacement {
        match (self, b) {
            (Self::Turn, Displacement::Planar(b)) => {
                let e = tau.turn();
                Displacement::Planar(PlanarDisplacement {
                    rotation: e * b.rotation,
                    translation: e * b.translation,
                })
            }
            (Self::Turn, Displacement::Spherical(r)) => {
                let e = tau.turn();
                let (x, y, z) = (r.row(0), r.row(1), r.row(2));
                Displacement::Spherical(Matrix3::from_rows(&[
                    x * e.re - y * e.im,
                    x * e.im + y * e.re,
                    z.into_owned(),
                ]))
            }
            (Self::Slide(along), Displacement::Planar(b)) => {
                Displacement::Planar(PlanarDisplacement {
                    rotation: b.rotation,
                    translation: b.translation + along * tau.value(),
                })
            }
            _ => self.commuting(b, tau),
        }
    }

    /// The pairs for which the order does not matter, and `v · exp(I τ)` in a plane.
    #[inline]
    fn commuting(&self, g: &Displacement, tau: Amount) -> Displacement {
        match (self, g) {
            (Self::Turn, Displacement::Cylindrical(g)) => {
                cylindrical(g.angle + tau.value(), g.advance)
            }
            (Self::Advance, Displacement::Cylindrical(g)) => {
                cylindrical(g.angle, g.advance + tau.value())
            }
            (Self::Slide(along), Displacement::Planar(g)) => {
                Displacement::Planar(PlanarDisplacement {
                    rotation: g.rotation,
                    translation: g.translation + g.rotation * along * tau.value(),
                })
            }
            (Self::Slide(along), Displacement::Translational(t)) => {
                Displacement::Translational(t + along * tau.value())
            }
            // A subspace that does not hold the motion: Subspace::cut never pairs them.
            _ => *g,
        }
    }
}

impl Subspace {
    fn new(
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
            SubspaceClass::Planar { normal } => (
                SubspaceKind::Planar,
                reference,
                if rotation { cut_axis } else { positive(*normal, None) },
            ),
            SubspaceClass::Spherical { centre } => (SubspaceKind::Spherical, *centre, cut_axis),
            SubspaceClass::Cylindrical { axis, point } => {
                let on_axis = point + axis.into_inner() * axis.dot(&(reference - point));
                (SubspaceKind::Cylindrical, on_axis, cut_axis)
            }
            SubspaceClass::TranslationalPlane { normal } => {
                (SubspaceKind::TranslationalPlane, reference, positive(*normal, None))
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

    fn cut(&self, axis: &Unit<Vector3<f64>>, rotation: bool) -> Cut {
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

/// `Rz(zeta) Ry(xi) Rz(psi)`.
#[inline]
pub fn euler(zeta: f64, xi: f64, psi: f64) -> Matrix3<f64> {
    let ((sz, cz), (sx, cx), (sp, cp)) = (zeta.sin_cos(), xi.sin_cos(), psi.sin_cos());
    Matrix3::new(
        cz * cx * cp - sz * sp,
        -cz * cx * sp - sz * cp,
        cz * sx,
        sz * cx * cp + cz * sp,
        -sz * cx * sp + cz * cp,
        sz * sx,
        -sx * cp,
        sx * sp,
        cx,
    )
}

#[inline]
fn planar(rotation: Complex<f64>, x: f64, y: f64) -> Displacement {
    Displacement::Planar(PlanarDisplacement { rotation, translation: Complex::new(x, y) })
}

#[inline]
fn cylindrical(angle: f64, advance: f64) -> Displacement {
    Displacement::Cylindrical(CylindricalDisplacement { angle, advance })
}

/// The direction or its opposite: the one on `hint`'s side, else the one that points up, where it
/// is level the one towards base y, and so on.
fn positive(axis: Unit<Vector3<f64>>, hint: Option<Vector3<f64>>) -> Unit<Vector3<f64>> {
    /// A component shorter than this is rounding in a file's digits, not a direction.
    const LEVEL: f64 = 1e-6;
    let side = match hint {
        Some(hint) => hint.dot(&axis),
        None => [axis.z, axis.y, axis.x].into_iter().find(|c| c.abs() > LEVEL).unwrap_or(1.0),
    };
    if side < 0.0 { -axis } else { axis }
}

/// A direction square to `third`: base x laid into the plane, or base y where x is nearly normal.
fn beside(third: &Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    /// Base x leans out of the plane by more than about 84 degrees: too far to lay it down.
    const STEEP: f64 = 0.995;
    let base = if third.x.abs() > STEEP { Vector3::y() } else { Vector3::x() };
    Unit::new_normalize(base - third.into_inner() * third.dot(&base))
}

const fn length(name: &'static str, home: f64) -> TaskCoordinate {
    TaskCoordinate { name, quantity: Quantity::Length, home }
}

const fn angle(name: &'static str) -> TaskCoordinate {
    TaskCoordinate { name, quantity: Quantity::Angle, home: 0.0 }
}

/// Home values of lengths are those of the reference point, measured from the base's origin.
fn lower_coordinates(kind: SubspaceKind, rotation: bool, frame: &Subspace) -> Vec<TaskCoordinate> {
    let at = frame.axes.tr_mul(&frame.origin.coords);
    match (kind, rotation) {
        (SubspaceKind::Planar, true) | (SubspaceKind::TranslationalPlane, _) => {
            vec![length("x", at.x), length("y", at.y)]
        }
        (SubspaceKind::Planar, false) => {
            vec![length("x", at.x), length("y", at.y), angle("theta")]
        }
        (SubspaceKind::Spherical, _) => vec![angle("mu"), angle("nu")],
        (SubspaceKind::Cylindrical, true) => vec![length("z", at.z)],
        (SubspaceKind::Cylindrical, false) => vec![angle("theta"), length("z", at.z)],
    }
}

fn upper_coordinates(kind: SubspaceKind, rotation: bool, frame: &Subspace) -> Vec<TaskCoordinate> {
    let at = frame.axes.tr_mul(&frame.origin.coords);
    match (kind, rotation) {
        (SubspaceKind::Spherical, _) => vec![angle("zeta"), angle("xi"), angle("psi")],
        (SubspaceKind::Planar, true) => vec![length("x", at.x), length("y", at.y), angle("phi")],
        (SubspaceKind::Planar, false) => vec![length("w", at.y), angle("phi")],
        (SubspaceKind::Cylindrical, true) => vec![angle("phi"), length("z", at.z)],
        (SubspaceKind::Cylindrical, false) => vec![angle("phi")],
        (SubspaceKind::TranslationalPlane, _) => vec![length("w", at.y)],
    }
}
