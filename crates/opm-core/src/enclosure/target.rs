//! The coordinates of a box of poses, and the displacements that they make.

use crate::boxes::{Affine, Plane, Target};

/// One coordinate of a box of poses.
#[derive(Clone, Copy, Debug)]
pub enum Coordinate<const N: usize> {
    /// A coordinate that is linear in the box.
    Linear(Affine<N>),
    /// An angle that the box replaces by its cosine or sine, as a unit vector at `xi` or `pitch`, or at `nu`
    /// minus its value at home.
    Polar(Plane<N>),
}

impl<const N: usize> Coordinate<N> {
    /// The coordinate minus `home`, for a length or a linear angle.
    pub fn minus(self, home: f64) -> Affine<N> {
        match self {
            Self::Linear(value) => value - home,
            Self::Polar(_) => {
                unreachable!("a coordinate that tilts an axis is an angle, not a length")
            }
        }
    }

    /// Whether it is at most this far from its value in the middle of the box, radians or metres.
    pub fn is_within(&self, most: f64) -> bool {
        match self {
            Self::Linear(value) => value.radius() <= most,
            Self::Polar(_) => true,
        }
    }

    /// Its largest change by each coordinate of the box.
    pub fn spread(&self) -> [f64; N] {
        match self {
            Self::Linear(value) => value.spread(),
            Self::Polar(e) => e.spread(),
        }
    }

    /// The unit vector at the angle minus `home`.
    fn unit_vector(self, home: f64) -> Plane<N> {
        match self {
            Self::Linear(value) => (value - home).unit_vector(),
            Self::Polar(e) => e,
        }
    }
}

/// The displacements that [`Task`](crate::task::Task) computes from coordinates, over a box of them.
pub mod task {
    use super::{Affine, Coordinate, Plane, Target};
    use crate::group::{IntersectionMotion, MotionType, SphericalMotion, SubspaceKind};
    use crate::mechanism::OrientationCoordinates;
    use crate::mechanism::leg::Section;
    use crate::task::{Task, lower_displacement, orientation_of, upper_displacement};
    use nalgebra::Complex;

    /// The coordinates of a section other than a height, and their values at home; zeros beyond the last. `pose` begins
    /// with the section's first coordinate.
    fn in_plane<const N: usize>(
        task: &Task,
        section: Section,
        pose: &[Coordinate<N>],
    ) -> ([Coordinate<N>; 3], [f64; 3]) {
        let mut at = [Coordinate::Linear(Affine::constant(0.0)); 3];
        let mut home = [0.0; 3];
        let of_section = pose.iter().zip(&task.coordinates[task.range(section)]);
        for (place, (value, c)) in task.in_plane(section, of_section).enumerate() {
            (at[place], home[place]) = (*value, c.home);
        }
        (at, home)
    }

    /// The displacement `v` for the first coordinates of a box: see [`Task::lower`].
    pub fn lower<const N: usize>(task: &Task, pose: &[Coordinate<N>]) -> Target<N> {
        let (pose, home) = in_plane(task, Section::Lower, pose);
        let form = task.form(Section::Lower);
        let turn = |i: usize| pose[i].unit_vector(home[i]);
        let none = Plane::constant(Complex::ONE);
        let units = match (form.kind, form.shared) {
            (SubspaceKind::Planar, Some(MotionType::Translation) | None) => [turn(2), none, none],
            (SubspaceKind::Spherical, Some(_)) => [turn(0), turn(1), none],
            (SubspaceKind::Spherical, None) => orientation(task, &pose),
            _ => [none; 3],
        };
        from_home(task, Section::Lower, lower_displacement(form, less(&pose, &home), units))
    }

    /// The displacement `b` for the remaining coordinates of a box: see [`Task::upper`].
    pub fn upper<const N: usize>(task: &Task, pose: &[Coordinate<N>]) -> Target<N> {
        let (pose, home) = in_plane(task, Section::Upper, pose);
        let form = task.form(Section::Upper);
        let turn = |i: usize| pose[i].unit_vector(home[i]);
        let none = Plane::constant(Complex::ONE);
        let units = match (form.kind, form.shared) {
            (SubspaceKind::Planar, Some(MotionType::Rotation) | None) => [turn(2), none, none],
            (SubspaceKind::Planar, Some(MotionType::Translation)) => [turn(1), none, none],
            (SubspaceKind::Spherical, _) => orientation(task, &pose),
            _ => [none; 3],
        };
        from_home(task, Section::Upper, upper_displacement(form, less(&pose, &home), units))
    }

    /// The coordinates less those at home; zero for those that a unit vector stands for.
    fn less<const N: usize>(pose: &[Coordinate<N>; 3], home: &[f64; 3]) -> [Affine<N>; 3] {
        std::array::from_fn(|i| match pose[i] {
            Coordinate::Linear(value) => value - home[i],
            Coordinate::Polar(_) => Affine::constant(0.0),
        })
    }

    /// An orientation as a displacement from home; other displacements are that already.
    fn from_home<const N: usize>(task: &Task, section: Section, g: Target<N>) -> Target<N> {
        match (g, task.home_orientation_inverse()) {
            (Target::Spherical(r), Some(inverse)) if task.oriented_section() == Some(section) => {
                Target::Spherical(r.after(inverse))
            }
            _ => g,
        }
    }

    /// The displacement `b` as a rotation along the intersection motion, radians, and then another displacement. A leg's
    /// displacement along that motion is the rotation plus what the other displacement makes, so it is exactly linear in the
    /// coordinate that rotates. `None` where there is no such coordinate.
    pub fn upper_turned<const N: usize>(
        task: &Task,
        pose: &[Coordinate<N>],
    ) -> Option<(Affine<N>, Target<N>)> {
        let (pose, _) = in_plane(task, Section::Upper, pose);
        let mut factors = factors(task, &pose);
        match (task.upper_intersection, factors[0]) {
            (
                IntersectionMotion::Spherical(SphericalMotion::Rotation),
                Coordinate::Linear(turn),
            ) => {
                factors[0] = Coordinate::Linear(Affine::constant(0.0));
                let units = factors.map(|angle| angle.unit_vector(0.0));
                let rest = orientation_of::<Affine<N>>(task.angles, units);
                Some((turn, from_home(task, Section::Upper, Target::Spherical(rest))))
            }
            _ => None,
        }
    }

    /// The angles of the rotations whose product is an orientation, for its coordinates, of which the second alone may be
    /// polar.
    fn factors<const N: usize>(task: &Task, pose: &[Coordinate<N>; 3]) -> [Coordinate<N>; 3] {
        let [first, second, third] = *pose;
        match (task.angles, first, third) {
            (
                OrientationCoordinates::TiltTorsion,
                Coordinate::Linear(azimuth),
                Coordinate::Linear(torsion),
            ) => [first, second, Coordinate::Linear(torsion - azimuth)],
            (OrientationCoordinates::RollPitchYaw, roll, yaw) => [yaw, second, roll],
            (OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion, ..) => {
                *pose
            }
        }
    }

    /// The unit vectors of these angles.
    fn orientation<const N: usize>(task: &Task, pose: &[Coordinate<N>; 3]) -> [Plane<N>; 3] {
        factors(task, pose).map(|angle| angle.unit_vector(0.0))
    }
}
