//! Task coordinates: how a pose of the platform is written, for every pair of partial subspaces.
//!
//! A pose is `g = v · b`, `v` in the lower subspace `A` and `b` in the upper one, `B`. Since the
//! two share the intersection motion `I`, one of them is taken modulo `I`: `v` where `I` is a
//! rotation, `b` where it is a translation. Two subspaces may share the identity alone. A mechanism whose legs
//! all move in one subgroup is of that kind too: `A` is the subgroup, and `B` is the identity.
//!
//! | subspace | as `A`, `I` a rotation | a translation | none | as `B`, `I` a rotation | a translation | none |
//! |---|---|---|---|---|---|---|
//! | planar | `x y` | `x y theta` | `x y theta` | `x y phi` | `w phi` | `x y phi` |
//! | spherical | `mu nu` | | `zeta xi psi` | `zeta xi psi` | | `zeta xi psi` |
//! | Schoenflies | `x y z` | `x y z theta` | `x y z theta` | `x y z phi` | `w h phi` | |
//! | cylindrical | `z` | `theta z` | `theta z` | `phi z` | `phi` | `phi w` |
//! | translational plane | | `x y` | `x y` | | `w` | `x y` |
//! | translational space | | `x y z` | `x y z` | | `w h` | `x y z` |
//!
//! A Schoenflies section is a planar one at a height along the plane's normal: `z`, or `h` above a cylinder, which has
//! a `z`. The cylinder's axis may be inclined to the normal. Then `I` has a part in the plane and a part in the height.
//!
//! `x y` move the centre of the frame in the plane, `w` moves it perpendicular to `I`, `z` along the axis; in a
//! translational space, `x y z` move it along the frame's directions, and `w h` along the first two, where the third
//! one is that of `I`;
//! `theta phi` are angles about the normal or the axis, `zeta xi psi` are Euler angles
//! `Rz(zeta) Ry(xi) Rz(psi)`; [`OrientationCoordinates`] can make them `azimuth tilt torsion`,
//! `Rz(azimuth) Ry(tilt) Rz(torsion - azimuth)`, or `roll pitch yaw`, `Rz(yaw) Ry(pitch) Rx(roll)`; and `mu nu` tilt the axis of `I` by `Rx(mu) Ry(nu)`. All of them have
//! their home values at home.
//!
//! # Frames
//!
//! Each section has a frame, fixed in the base: three directions, the point that lengths are measured
//! from, and the centre at home: the point that lengths move and rotations are about. They follow from the geometry
//! of the two subspaces and the base's directions alone:
//!
//! * The axis `d` of `I`, where it is a rotation or along a cylinder, is the third direction of both
//!   frames. It *points up*: positive z, of nearly level directions positive y, of those nearly along
//!   x positive x ([`UP`](crate::group::subspace::UP) is what decides).
//! * `x` is the base's x projected into the plane, or its y where x is within 6 degrees of the normal; of
//!   a sphere likewise, projected into the plane perpendicular to `d`. `y` is `x` rotated by a right angle
//!   about the third direction. Where the third direction is given by a rotation `I`, or by a translation `I` in a
//!   translational space, and is level, that would make `y` point down along some of them: there `x` is reversed, so that
//!   `y` points up. In between, the sum of `y` and the third direction points up.
//! * The normal of a plane that holds a translation `I` points up where the plane is level; where it
//!   is upright, `y` points up. In between, the sum of both does.
//! * `w` points up in a plane.
//! * Without `I`, the third direction is a plane's normal, a cylinder's axis, which points up, or the base's z
//!   for a sphere and for a translational space. The latter has the direction of a translation `I` as its third.
//! * The centre is the platform's reference point, moved to the axis of `I` where that is a rotation, to a
//!   cylinder's axis, or to a sphere's centre. Lengths are measured from the base's origin. The reference point itself
//!   is what a pose in SE(3) places, and whose velocity a twist has.
//!
//! For a level plane, `x y` are the base's. No rule is discontinuous near the directions of usual
//! designs: a mechanism that is rotated a little has its frames rotated a little.
//!
//! [`TaskHints`](crate::mechanism::TaskHints), `[task]` in a file, can override these rules: the sense of
//! `d`, of `w` and of a normal, the direction of `x`, and the point that lengths are measured from; the
//! values at home change accordingly. It can give values at home, too: an orientation in Euler angles or in roll, pitch and
//! yaw, from which the angles that the pose is written with follow. Where `I` is a rotation about a plane's normal, that normal cannot be
//! chosen: it is `axis`. Without `I`, `axis` of a section is the third direction of the frame of a sphere or of a
//! translational space, or the sense of a cylinder's axis.

mod coordinate;
mod displacement;
mod error;
mod factors;
mod frame;
mod height;
mod pose;

pub use coordinate::{CoordinateKind, TaskCoordinate};
pub use displacement::euler;
pub(crate) use displacement::{
    Form, SectionValues, lower_angles, lower_displacement, orientation_of, upper_angles,
    upper_displacement,
};
pub use error::{FrameProblem, OddJoint, TaskError};
pub(crate) use height::Height;
pub(crate) use pose::other_factors;

// The types of `Task`'s fields and results.
pub use crate::group::{Displacement, Subspace, SubspaceKind};

use crate::decomposition::Decomposition;
use crate::group::subspace::{SubspaceClass, TOLERANCE};
use crate::group::{CylindricalDisplacement, IntersectionMotion, MotionType, Path, PlanarPath};
use crate::mechanism::leg::{Leg, Section};
use crate::mechanism::{Mechanism, OrientationCoordinates, TaskKey};
use crate::numeric::angle::sin_cos_of_each;
use displacement::orientation;
use frame::Meeting;
use nalgebra::{Complex, Isometry3, Matrix3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use pose::angles_of;

/// The subspaces' frames and the coordinates of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// The frame of the lower subspace `A`, in which the legs' lower sections move.
    pub lower: Subspace,
    /// The frame of the upper subspace `B`, in which the legs' upper sections move.
    pub upper: Subspace,
    /// The intersection motion in `A`'s frame.
    pub lower_intersection: IntersectionMotion,
    /// The intersection motion in `B`'s frame.
    pub upper_intersection: IntersectionMotion,
    /// The intersection motion at home; `None` where the subspaces share the identity alone.
    pub intersection: Option<IntersectionAxis>,
    /// The coordinates of the pose: those of `v`, then those of `b`.
    pub coordinates: Vec<TaskCoordinate>,
    /// The number of coordinates of `v`.
    pub lower_count: usize,
    /// The height of a Schoenflies section; `None` where there is none.
    pub(crate) height: Option<Height>,
    /// The angles that the orientation of the pose is written with, if it has one.
    pub(crate) angles: OrientationCoordinates,
    /// The inverse of the platform's orientation at home, in the frame of the section that has an orientation; `None` where
    /// the pose has none, and where it is the identity.
    home_orientation_inverse: Option<Matrix3<f64>>,
    /// The coordinates other than a height of both sections.
    in_plane: [InPlane; 2],
}

/// The coordinates of a section other than a height: three at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct InPlane {
    count: usize,
    /// Their numbers in the section; zero beyond the last.
    numbers: [usize; 3],
    /// Their values at home; zero beyond the last.
    home: [f64; 3],
}

impl InPlane {
    /// Their values in a pose that begins with the section's first coordinate; zero beyond the last.
    #[inline(always)]
    fn of(&self, pose: &[f64]) -> [f64; 3] {
        let mut at = [0.0; 3];
        for (place, at) in at.iter_mut().enumerate() {
            if place < self.count {
                *at = pose[self.numbers[place]];
            }
        }
        at
    }
}

/// The intersection motion at home, in base coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct IntersectionAxis {
    /// The unit direction of its axis, or of the translation.
    pub direction: Unit<Vector3<f64>>,
    /// A point of its axis, metres; `None` where the motion is a translation.
    pub point: Option<Point3<f64>>,
}

impl IntersectionAxis {
    /// Whether the motion is a rotation or a translation.
    pub fn motion_type(&self) -> MotionType {
        if self.point.is_some() { MotionType::Rotation } else { MotionType::Translation }
    }
}

impl Task {
    /// Frames and coordinates for a decomposition.
    ///
    /// # Errors
    /// A subspace or an intersection motion that no chain covers, a positive direction perpendicular to
    /// that motion, a hint on a frame that does not fit the geometry, or a home value for an unknown
    /// coordinate.
    pub fn new(mechanism: &Mechanism, decomposition: &Decomposition) -> Result<Self, TaskError> {
        let intersection = match &decomposition.intersection {
            SubspaceClass::Rotation { axis, point } => {
                Some(IntersectionAxis { direction: *axis, point: Some(*point) })
            }
            SubspaceClass::Translation { axis } => {
                Some(IntersectionAxis { direction: *axis, point: None })
            }
            SubspaceClass::Identity => None,
            _ => return Err(TaskError::Screw),
        };
        let hint = mechanism.task.axis;
        if let (Some(hint), Some(IntersectionAxis { direction, .. })) = (hint, &intersection)
            && hint.normalize().dot(direction).abs() <= TOLERANCE
        {
            return Err(TaskError::Axis { given: hint.into(), along: (**direction).into() });
        }
        if hint.is_some() && intersection.is_none() {
            let problem = FrameProblem::NoIntersection;
            return Err(TaskError::Frame { key: TaskKey::Axis, problem });
        }
        let meeting = Meeting { intersection, platform: mechanism.platform };
        let frame = |class: &SubspaceClass, section: Section| {
            frame::lay(class, section, &meeting, mechanism.task.frame(section)).map_err(|error| {
                match error {
                    TaskError::Subspace { section, name, .. } => {
                        let odd = OddJoint::find(mechanism, decomposition, section);
                        TaskError::Subspace { section, name, odd }
                    }
                    other => other,
                }
            })
        };
        // A leg alone has no other that could hold the height.
        if mechanism.legs.len() > 1
            && let Some(section) = Height::of(decomposition)
            && let Some(odd) = OddJoint::find(mechanism, decomposition, section)
        {
            return Err(TaskError::Height { section, odd });
        }
        let lower = frame(&decomposition.lower, Section::Lower)?;
        let upper = frame(&decomposition.upper, Section::Upper)?;
        let intersection = meeting.intersection;
        let shared = intersection.as_ref().map(IntersectionAxis::motion_type);
        let mut coordinates = coordinate::of_lower(&lower, shared);
        let mut of_upper = coordinate::of_upper(&upper, shared);
        let height = Height::of(decomposition).map(|section| {
            let (frame, own, first) = match section {
                Section::Lower => (&lower, &coordinates, 0),
                Section::Upper => (&upper, &of_upper, coordinates.len()),
            };
            let (place, coordinate) = coordinate::of_height(frame, own, &coordinates);
            match section {
                Section::Lower => coordinates.insert(place, coordinate),
                Section::Upper => of_upper.insert(place, coordinate),
            }
            let up = frame.axes.column(2).into_owned();
            let slope = height::slope(section, &up, intersection.as_ref());
            Height { section, coordinate: first + place, up, slope }
        });
        let lower_count = coordinates.len();
        coordinates.extend(of_upper);
        let zeta = coordinates.iter().position(|c| c.kind() == CoordinateKind::Zeta);
        let given = take_home(&mechanism.task.home, &mut coordinates)?;
        let home_orientation = zeta.map(|first| match given {
            Some(given) => orientation(OrientationCoordinates::RollPitchYaw, given),
            None => {
                let home = |i: usize| coordinates[first + i].home;
                euler(home(0), home(1), home(2))
            }
        });
        let home_orientation_inverse = home_orientation
            .filter(|orientation| *orientation != Matrix3::identity())
            .map(|orientation| orientation.transpose());
        let angles = match (mechanism.task.coordinates, zeta) {
            (Some(given), Some(_)) => given,
            (None, Some(_)) => default_coordinates(decomposition),
            (Some(OrientationCoordinates::EulerAngles) | None, None) => {
                OrientationCoordinates::EulerAngles
            }
            (
                Some(
                    given @ (OrientationCoordinates::TiltTorsion
                    | OrientationCoordinates::RollPitchYaw),
                ),
                None,
            ) => {
                let problem = FrameProblem::NoOrientation(given);
                return Err(TaskError::Frame { key: TaskKey::Coordinates, problem });
            }
        };
        if let (Some(first), Some(orientation)) = (zeta, &home_orientation) {
            let of_section = &mut coordinates[first..first + 3];
            write_orientation(angles, of_section, given, orientation);
        }
        refuse_names_of_joints(mechanism, &coordinates)?;
        let motion = |frame: &Subspace| match &intersection {
            Some(axis) => {
                let direction = frame.direction(&axis.direction);
                IntersectionMotion::new(frame.kind, &direction, axis.motion_type())
            }
            None => IntersectionMotion::None(frame.kind),
        };
        let lower_intersection = motion(&lower);
        let upper_intersection = motion(&upper);
        let mut task = Self {
            lower,
            upper,
            lower_intersection,
            upper_intersection,
            intersection,
            coordinates,
            lower_count,
            height,
            angles,
            home_orientation_inverse,
            in_plane: [InPlane::default(); 2],
        };
        task.in_plane =
            [Section::Lower, Section::Upper].map(|section| task.coordinates_of(section));
        Ok(task)
    }

    /// The displacement `v` for the first [`Task::lower_count`] coordinates of a pose, radians and metres.
    ///
    /// # Panics
    /// If there are fewer coordinates.
    #[inline]
    pub fn lower(&self, pose: &[f64]) -> Displacement {
        self.section(pose, Section::Lower)
    }

    /// The displacements `v` and `b` for all coordinates of a pose.
    ///
    /// # Panics
    /// If there are fewer than [`Task::lower_count`] coordinates.
    #[inline(always)]
    pub(crate) fn sections(&self, pose: &[f64]) -> (Displacement, Displacement) {
        let of_upper = &pose[self.lower_count..];
        (self.section(pose, Section::Lower), self.section(of_upper, Section::Upper))
    }

    /// The displacement of a section. `pose` begins with the section's first coordinate.
    #[inline(always)]
    fn section(&self, pose: &[f64], section: Section) -> Displacement {
        let (form, in_plane) = (self.form(section), &self.in_plane[section as usize]);
        let values = SectionValues { at: in_plane.of(pose), home: in_plane.home };
        let angles = match section {
            Section::Lower => lower_angles(form, values),
            Section::Upper => upper_angles(form, values),
        };
        let mut units = [Complex::ONE; 3];
        if let Some(angles) = angles {
            units = sin_cos_of_each(angles).map(|(sin, cos)| Complex::new(cos, sin));
        }
        let displacement = match section {
            Section::Lower => lower_displacement(form, values.less_home(), units),
            Section::Upper => upper_displacement(form, values.less_home(), units),
        };
        self.displaced_from_home(section, displacement)
    }

    /// What the two subspaces share; `None` for the identity alone.
    #[inline]
    pub fn shared(&self) -> Option<MotionType> {
        self.intersection.as_ref().map(IntersectionAxis::motion_type)
    }

    /// The section that has the orientation of the pose, as three angles; `None` where the pose has none.
    pub(crate) fn oriented_section(&self) -> Option<Section> {
        match (self.lower.kind, self.shared(), self.upper.kind) {
            (_, _, SubspaceKind::Spherical) => Some(Section::Upper),
            (SubspaceKind::Spherical, None, _) => Some(Section::Lower),
            _ => None,
        }
    }

    /// The displacement from home of a section that its coordinates describe: the angles of an orientation are absolute.
    #[inline(always)]
    fn displaced_from_home(&self, section: Section, displacement: Displacement) -> Displacement {
        match (displacement, &self.home_orientation_inverse) {
            (Displacement::Spherical(absolute), Some(inverse))
                if self.oriented_section() == Some(section) =>
            {
                Displacement::Spherical(absolute * inverse)
            }
            (displacement, _) => displacement,
        }
    }

    /// Whether [`Task::row`] is the path of a row: the azimuth moves the lower section along no path of one screw, and the
    /// axis of a roll is another one in each row.
    pub(crate) fn rows_are_paths(&self) -> bool {
        match self.angles {
            OrientationCoordinates::EulerAngles => true,
            OrientationCoordinates::TiltTorsion | OrientationCoordinates::RollPitchYaw => {
                self.oriented_section() == Some(Section::Upper)
            }
        }
    }

    /// The path of `v · exp(I τ)` as the first coordinate grows from its value at home, where that is `start`;
    /// of Euler angles, not of other angles: see [`Task::rows_are_paths`].
    #[inline(always)]
    pub(crate) fn row(&self, start: &Displacement) -> Path {
        let rate = Complex::new(1.0, 0.0);
        match *start {
            Displacement::Identity(_) => Path::Identity,
            Displacement::Planar(start) => Path::Planar(PlanarPath::Translation { start, rate }),
            // `mu` rotates about the first direction, `zeta` about the third.
            Displacement::Spherical(start) => match self.shared() {
                Some(_) => Path::Spherical { start, axis: Vector3::x() },
                None => Path::Spherical { start, axis: Vector3::z() },
            },
            Displacement::Cylindrical(start) => {
                let rotation = self.lower_intersection.is_rotation();
                let [angle, advance] = if rotation { [0.0, 1.0] } else { [1.0, 0.0] };
                Path::Cylindrical { start, rate: CylindricalDisplacement { angle, advance } }
            }
            Displacement::Translational(start) => Path::Translational { start, rate },
            Displacement::Spatial(start) => Path::Spatial { start, rate: Vector3::x() },
        }
    }

    /// The displacement `b` for the coordinates of a pose after the first [`Task::lower_count`], with which
    /// the slice starts.
    #[inline]
    pub fn upper(&self, pose: &[f64]) -> Displacement {
        self.section(pose, Section::Upper)
    }

    /// The form of a section, which determines its coordinates.
    #[inline]
    pub(crate) fn form(&self, section: Section) -> Form {
        let shared = self.shared();
        match section {
            Section::Lower => Form { kind: self.lower.kind, shared, angles: self.angles },
            Section::Upper => Form { kind: self.upper.kind, shared, angles: self.angles },
        }
    }

    /// The coordinates of a section other than a height.
    fn coordinates_of(&self, section: Section) -> InPlane {
        let mut found = InPlane::default();
        let of_section = self.coordinates[self.range(section)].iter().enumerate();
        for (number, coordinate) in self.in_plane(section, of_section) {
            found.numbers[found.count] = number;
            found.home[found.count] = coordinate.home;
            found.count += 1;
        }
        found
    }

    /// The platform's displacement from home at a pose, `g = v · b`, base coordinates.
    /// [`Manipulator::displacement`](crate::Manipulator::displacement) checks the pose first.
    ///
    /// # Panics
    /// If there are fewer than [`Task::lower_count`] coordinates.
    pub fn displacement(&self, pose: &[f64]) -> Isometry3<f64> {
        self.raised(
            self.rise(pose),
            self.isometry(&self.lower(pose), &self.upper(&pose[self.lower_count..])),
        )
    }

    /// The displacement `v · b` in base coordinates, without a height.
    pub(crate) fn isometry(&self, v: &Displacement, b: &Displacement) -> Isometry3<f64> {
        self.lower.isometry(v) * self.upper.isometry(b)
    }

    /// The angles that the orientation of the pose is written with; Euler angles where it has none.
    pub fn orientation_coordinates(&self) -> OrientationCoordinates {
        self.angles
    }

    /// The platform's orientation at home, base coordinates: that of the angles at home about the axes of
    /// their section's frame, or the identity where the pose has no orientation.
    pub fn home_orientation(&self) -> UnitQuaternion<f64> {
        let Some(inverse) = self.home_orientation_inverse else {
            return UnitQuaternion::identity();
        };
        let axes = match self.oriented_section() {
            Some(Section::Lower) => self.lower.axes,
            Some(Section::Upper) | None => self.upper.axes,
        };
        let rotation = axes * inverse.transpose() * axes.transpose();
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation))
    }

    /// The inverse of the platform's orientation at home, which turns an orientation into a displacement from
    /// home; `None` for the identity.
    pub(crate) fn home_orientation_inverse(&self) -> Option<&Matrix3<f64>> {
        self.home_orientation_inverse.as_ref()
    }

    /// The orientation at home for which Euler angles are those of the pose; `None` for the identity. With
    /// `Rx(roll) Ry(π/2) = Ry(π/2) Rz(roll)`, the Euler angles `yaw`, `pitch + π/2` and `roll` are of the orientation after a
    /// right angle about the second direction.
    #[inline(always)]
    pub(crate) fn euler_home(&self) -> Option<Matrix3<f64>> {
        let home = self.home_orientation_inverse.as_ref().map(Matrix3::transpose);
        match self.angles {
            OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => home,
            OrientationCoordinates::RollPitchYaw => {
                let home = home.unwrap_or_else(Matrix3::identity);
                let [x, y, z] = [0, 1, 2].map(|i| home.column(i));
                Some(Matrix3::from_columns(&[-z, y.into_owned(), x.into_owned()]))
            }
        }
    }

    /// The pose at home, radians and metres.
    pub fn home(&self) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.home).collect()
    }
}

/// The angles that an orientation is written with where a file does not say: Euler angles where legs are split; roll, pitch and
/// yaw, which are regular at home, where they are solved whole.
fn default_coordinates(decomposition: &Decomposition) -> OrientationCoordinates {
    match decomposition.is_whole() {
        true => OrientationCoordinates::RollPitchYaw,
        false => OrientationCoordinates::EulerAngles,
    }
}

/// Takes the values at home of a file. Roll, pitch and yaw, if one of them is given, are returned.
fn take_home(
    given: &[(String, f64)],
    coordinates: &mut [TaskCoordinate],
) -> Result<Option<[f64; 3]>, TaskError> {
    use CoordinateKind::{Pitch, Psi, Roll, Xi, Yaw, Zeta};
    let oriented = coordinates.iter().any(|c| c.kind() == Zeta);
    let mut angles = None;
    for (name, value) in given {
        let place = [Roll, Pitch, Yaw].iter().position(|kind| kind.name() == name);
        match (coordinates.iter_mut().find(|c| c.name == name), place.filter(|_| oriented)) {
            (Some(coordinate), _) => coordinate.home = *value,
            (None, Some(place)) => angles.get_or_insert([0.0; 3])[place] = *value,
            (None, None) => {
                let names: Vec<_> = coordinates.iter().map(|c| c.name).collect();
                let expected = names.join(", ");
                return Err(TaskError::Unknown { name: name.clone(), expected });
            }
        }
    }
    let first = |kinds: [CoordinateKind; 3]| {
        let mut names = given.iter().map(|(name, _)| name);
        names.find(|name| kinds.iter().any(|kind| kind.name() == *name)).cloned()
    };
    match (first([Zeta, Xi, Psi]), first([Roll, Pitch, Yaw])) {
        (Some(euler), Some(other)) => Err(TaskError::HomeTwice { euler, other }),
        (Some(_), None) | (None, Some(_)) | (None, None) => Ok(angles),
    }
}

/// Replaces Euler angles, with their values at home, by the angles of a kind. `given` are the roll, the pitch and the yaw at
/// home if these are given, and the orientation is that at home.
fn write_orientation(
    angles: OrientationCoordinates,
    of_section: &mut [TaskCoordinate],
    given: Option<[f64; 3]>,
    orientation: &Matrix3<f64>,
) {
    if given.is_some() {
        let euler = angles_of(OrientationCoordinates::EulerAngles, orientation, [0.0; 3]);
        of_section.iter_mut().zip(euler).for_each(|(coordinate, home)| coordinate.home = home);
    }
    match angles {
        OrientationCoordinates::EulerAngles => {}
        OrientationCoordinates::TiltTorsion => coordinate::write_tilt_and_torsion(of_section),
        OrientationCoordinates::RollPitchYaw => {
            let home = given.unwrap_or_else(|| angles_of(angles, orientation, [0.0; 3]));
            coordinate::write_roll_pitch_yaw(of_section, home);
        }
    }
}

/// Refuses joints with the name of one of these coordinates. Files keep the names of all coordinates from joints but
/// those that few mechanisms have.
fn refuse_names_of_joints(
    mechanism: &Mechanism,
    coordinates: &[TaskCoordinate],
) -> Result<(), TaskError> {
    use CoordinateKind::{Azimuth, H, Pitch, Roll, Tilt, Torsion, Yaw};
    let is_rare = |kind| matches!(kind, H | Azimuth | Tilt | Torsion | Roll | Pitch | Yaw);
    let rare = coordinates.iter().filter(|c| is_rare(c.kind()));
    for TaskCoordinate { name, .. } in rare {
        let has = |leg: &&Leg| leg.joints.iter().any(|joint| joint.name == *name);
        if let Some(leg) = mechanism.legs.iter().find(has) {
            return Err(TaskError::JointName { leg: leg.name.clone(), joint: name });
        }
    }
    Ok(())
}
