//! The coordinates of the pose from the two displacements of `g = v · b`.

use super::{CoordinateKind, Task};
use crate::group::{
    CylindricalMotion, Displacement, IntersectionMotion, JointDisplacement, MotionType,
    PlanarMotion, SpatialMotion, SphericalMotion, SubspaceKind, TranslationalMotion,
};
use crate::mechanism::OrientationCoordinates;
use crate::mechanism::leg::Section;
use crate::numeric::Quantity;
use crate::numeric::angle::{atan2, atan2_of_each, near, sin_cos, unit};
use crate::numeric::four_wide::FourWide;
use nalgebra::{Complex, Matrix3, Vector3};
use pulp::{Simd, WithSimd};
use std::f64::consts::{FRAC_PI_2, PI};

/// The sine of an angle between two axes that counts as zero: the rounding of a rotation.
const POLE: f64 = 1e-13;

/// The number of poses whose angles are computed together.
const TOGETHER: usize = 8;

impl Task {
    /// The coordinates of `v · b`, however the displacement along the intersection motion is distributed
    /// between `v` and `b`. Angles are within π of home, except those of a cylinder, which count revolutions.
    /// Of the two triples of Euler angles of a rotation, or of roll, pitch and yaw, it is the one nearer to home; where they
    /// are singular, the first and the third are changed from home by equal amounts. Of tilt and torsion, the tilt is in [0, π]; where it is 0 or
    /// π, the azimuth is that at home. `rise` is the height above home, metres; zero where there
    /// is no Schoenflies section.
    ///
    /// # Panics
    /// If `v` or `b` is a displacement of another kind of subspace.
    pub fn pose(&self, v: &Displacement, b: &Displacement, rise: f64) -> Vec<f64> {
        let mut pose = Vec::with_capacity(self.coordinates.len());
        self.write_pose(v, b, rise, &mut pose);
        pose
    }

    /// Writes the coordinates to a buffer: see [`Task::pose`].
    pub(crate) fn write_pose(
        &self,
        v: &Displacement,
        b: &Displacement,
        rise: f64,
        pose: &mut Vec<f64>,
    ) {
        pose.clear();
        self.append(&self.described_factors(v, b, rise), |r, home| self.angles(r, home), pose);
    }

    /// Writes the coordinates of `v · b` for each `b`, row after row. Their angles are computed together.
    pub(crate) fn write_poses(
        &self,
        v: &Displacement,
        bs: &[Displacement],
        rise: f64,
        arch: FourWide,
        poses: &mut Vec<f64>,
    ) {
        poses.clear();
        for bs in bs.chunks(TOGETHER) {
            let mut described = [self.described_factors(v, &bs[0], rise); TOGETHER];
            for (described, b) in described.iter_mut().zip(bs).skip(1) {
                *described = self.described_factors(v, b, rise);
            }
            let together = match (self.angles, self.oriented_section()) {
                (OrientationCoordinates::EulerAngles, Some(Section::Upper)) => {
                    let rotations = described.map(|(_, b, _)| self.orientation(b.spherical()));
                    let first = self.coordinates.len() - 3;
                    let home = [0, 1, 2].map(|i| self.coordinates[first + i].home);
                    Some(arch.dispatch(EulerAngles { rotations: &rotations, home }))
                }
                _ => None,
            };
            for (i, described) in described[..bs.len()].iter().enumerate() {
                let angles = |r: &Matrix3<f64>, home| {
                    together.as_ref().map_or_else(|| self.angles(r, home), |angles| angles[i])
                };
                self.append(described, angles, poses);
            }
        }
    }

    /// Appends the coordinates of factors as these describe them. `angles` gives those of a displacement of a sphere from
    /// home.
    #[inline(always)]
    fn append(
        &self,
        (v, b, rise): &(Displacement, Displacement, f64),
        angles: impl Fn(&Matrix3<f64>, [f64; 3]) -> [f64; 3],
        pose: &mut Vec<f64>,
    ) {
        let start = pose.len();
        // The height is put in its place at last: until then, the coordinates after it are one place before theirs.
        let height = self.height.as_ref().map_or(usize::MAX, |height| height.coordinate);
        let number = |i: usize| i + usize::from(i >= height);
        let lower_count = self.lower_count - usize::from(height < self.lower_count);
        let home = |i: usize| self.coordinates[number(i)].home;
        let rotation = self.shared() == Some(MotionType::Rotation);
        match v {
            Displacement::Identity(_) => {}
            Displacement::Planar(g) => {
                pose.extend([home(0) + g.translation.re, home(1) + g.translation.im]);
                if !rotation {
                    pose.push(home(2) + g.rotation.arg());
                }
            }
            Displacement::Spherical(r) if self.shared().is_none() => {
                pose.extend(angles(r, [home(0), home(1), home(2)]));
            }
            Displacement::Spherical(r) => {
                let [mu, nu] = tilt_angles(&r.column(2).into_owned());
                pose.extend([home(0) + mu, home(1) + nu]);
            }
            Displacement::Cylindrical(g) if rotation => pose.push(home(0) + g.advance),
            Displacement::Cylindrical(g) => pose.extend([home(0) + g.angle, home(1) + g.advance]),
            Displacement::Translational(t) => pose.extend([home(0) + t.re, home(1) + t.im]),
            Displacement::Spatial(t) => {
                pose.extend([home(0) + t.x, home(1) + t.y, home(2) + t.z]);
            }
        }
        let home = |i: usize| self.coordinates[number(lower_count + i)].home;
        let translation = self.shared() == Some(MotionType::Translation);
        match b {
            Displacement::Identity(_) => {}
            Displacement::Planar(g) if translation => {
                pose.extend([home(0) + g.translation.im, home(1) + g.rotation.arg()]);
            }
            Displacement::Planar(g) => pose.extend([
                home(0) + g.translation.re,
                home(1) + g.translation.im,
                home(2) + g.rotation.arg(),
            ]),
            Displacement::Spherical(r) => {
                pose.extend(angles(r, [home(0), home(1), home(2)]));
            }
            Displacement::Cylindrical(g) if translation => pose.push(home(0) + g.angle),
            Displacement::Cylindrical(g) => {
                pose.extend([home(0) + g.angle, home(1) + g.advance]);
            }
            Displacement::Translational(t) if translation => pose.push(home(0) + t.im),
            Displacement::Translational(t) => pose.extend([home(0) + t.re, home(1) + t.im]),
            Displacement::Spatial(t) if translation => {
                pose.extend([home(0) + t.x, home(1) + t.y]);
            }
            Displacement::Spatial(t) => {
                pose.extend([home(0) + t.x, home(1) + t.y, home(2) + t.z]);
            }
        }
        // The angle of a cylinder counts revolutions.
        let counted = |kind: SubspaceKind| match kind {
            SubspaceKind::Cylindrical => true,
            SubspaceKind::Identity
            | SubspaceKind::Planar
            | SubspaceKind::Spherical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace => false,
        };
        for (i, q) in pose[start..].iter_mut().enumerate() {
            let c = &self.coordinates[number(i)];
            let section = if i < lower_count { &self.lower } else { &self.upper };
            if c.quantity == Quantity::Angle && !counted(section.kind) {
                *q = near(*q, c.home);
            }
        }
        if height < self.coordinates.len() {
            pose.insert(start + height, self.coordinates[height].home + rise);
        }
    }

    /// The factors `v` and `b` that coordinates describe, and the height above home, metres, that goes with them: the
    /// displacement along the intersection motion is moved to the factor that is not taken modulo that motion. Of an
    /// inclined one, a part is height.
    pub(crate) fn described_factors(
        &self,
        v: &Displacement,
        b: &Displacement,
        rise: f64,
    ) -> (Displacement, Displacement, f64) {
        let (v, handed, rise) = match self.shared() {
            Some(MotionType::Rotation) => {
                let (v, rotation) = self.without_shared_rotation(v);
                (v, rotation, rise)
            }
            Some(MotionType::Translation) => {
                let translation = self.shared_translation(b);
                let v = self.lower_intersection.after(v, translation);
                (v, translation.inverse(), self.rise_of_leg(rise, translation))
            }
            None => (*v, JointDisplacement::Value(0.0), rise),
        };
        (v, self.upper_intersection.before(b, handed), rise)
    }

    /// The angles of a displacement of a sphere from home, those nearest to the values at home.
    pub(crate) fn angles(&self, r: &Matrix3<f64>, home: [f64; 3]) -> [f64; 3] {
        let orientation = self.orientation(r);
        angles_of(self.angles, &orientation, home)
    }

    /// The orientation after a displacement of a sphere from home.
    fn orientation(&self, r: &Matrix3<f64>) -> Matrix3<f64> {
        match &self.home_orientation_inverse {
            Some(inverse) => r * inverse.transpose(),
            None => *r,
        }
    }

    /// Replaces the angles of which this coordinate is the second one by the others with which the pose is the same:
    /// `zeta + π`, `-xi`, `psi + π`; `roll + π`, `π - pitch`, `yaw + π`; or `mu + π`, `π - nu`. There are no others of a coordinate of another kind.
    pub(crate) fn take_other_angles(&self, second: usize, pose: &mut [f64]) {
        let home = |i: usize| self.coordinates[i].home;
        match self.coordinates[second].kind() {
            CoordinateKind::Xi | CoordinateKind::Tilt | CoordinateKind::Pitch => {
                let numbers = [second - 1, second, second + 1];
                let factors = self.angles.to_factors(numbers.map(|i| pose[i]));
                let other = other_factors(self.angles, factors);
                for (i, angle) in numbers.into_iter().zip(self.angles.of_factors(other)) {
                    pose[i] = near(angle, home(i));
                }
            }
            CoordinateKind::Nu => {
                let [mu, nu] = [second - 1, second];
                let angles = [pose[mu] + PI, home(nu) + PI - (pose[nu] - home(nu))];
                // Rx(mu + π) Ry(π - nu) = Rx(mu) Ry(nu) Rz(π): the upper section takes the half turn back.
                let (v, b) = self.sections(pose);
                let b = self.upper_intersection.before(&b, JointDisplacement::Value(-PI));
                let mut other = Vec::with_capacity(pose.len());
                self.append(&(v, b, self.rise(pose)), |r, home| self.angles(r, home), &mut other);
                pose.copy_from_slice(&other);
                [pose[mu], pose[nu]] = [near(angles[0], home(mu)), near(angles[1], home(nu))];
            }
            _ => {}
        }
    }

    /// Replaces a negative tilt by the opposite azimuth.
    pub(crate) fn make_tilt_positive(&self, pose: &mut [f64]) {
        let tilt = self.coordinates.iter().position(|c| c.kind() == CoordinateKind::Tilt);
        let Some(tilt) = tilt else { return };
        let reduced = near(pose[tilt], 0.0);
        pose[tilt] = reduced.abs();
        if reduced < 0.0 {
            pose[tilt - 1] = near(pose[tilt - 1] + PI, self.coordinates[tilt - 1].home);
        }
    }

    /// The factors of `v`: the displacement that its coordinates describe, and the rotation about the shared
    /// axis that is applied before it. Without a shared rotation, they are `v` itself and zero.
    pub(crate) fn without_shared_rotation(
        &self,
        v: &Displacement,
    ) -> (Displacement, JointDisplacement) {
        if self.shared() != Some(MotionType::Rotation) {
            return (*v, JointDisplacement::Value(0.0));
        }
        let rotation = self.shared_rotation(v);
        (self.lower_intersection.after(v, rotation.inverse()), rotation)
    }

    /// The rotation about the shared axis in `v`, which its coordinates do not describe.
    fn shared_rotation(&self, v: &Displacement) -> JointDisplacement {
        match v {
            Displacement::Planar(g) => JointDisplacement::Direction(g.rotation),
            Displacement::Spherical(r) => {
                // R = Rx(mu) Ry(nu) Rz: the last factor.
                let [mu, nu] = tilt_angles(&r.column(2).into_owned());
                let rest = super::displacement::tilt::<f64>([mu, nu].map(unit)).tr_mul(r);
                JointDisplacement::Direction(Complex::new(rest[(0, 0)], rest[(1, 0)]))
            }
            Displacement::Cylindrical(g) => JointDisplacement::Value(g.angle),
            Displacement::Identity(_)
            | Displacement::Translational(_)
            | Displacement::Spatial(_) => JointDisplacement::Value(0.0),
        }
    }

    /// The factors of `v` with the least displacement from another one, `reference`, along the intersection motion: what is
    /// left of it, and the displacement along that motion that is applied before it. A shared rotation is left to nothing:
    /// see [`Task::without_shared_rotation`].
    pub(crate) fn aligned(
        &self,
        v: &Displacement,
        reference: &Displacement,
    ) -> (Displacement, JointDisplacement) {
        match self.shared() {
            Some(MotionType::Translation) => {
                let moved = reference.inverse().after(v);
                let translation = translation_along(&self.lower_intersection, &moved);
                (self.lower_intersection.after(v, translation.inverse()), translation)
            }
            Some(MotionType::Rotation) | None => self.without_shared_rotation(v),
        }
    }

    /// The translation along the shared direction in `b`, which its coordinates do not describe.
    fn shared_translation(&self, b: &Displacement) -> JointDisplacement {
        translation_along(&self.upper_intersection, b)
    }
}

/// The part of a displacement that is a translation along an intersection motion; zero where that is none.
fn translation_along(motion: &IntersectionMotion, g: &Displacement) -> JointDisplacement {
    let component = |t: Complex<f64>, along: Complex<f64>| t.re * along.re + t.im * along.im;
    JointDisplacement::Value(match *motion {
        // `along` is shorter than one where the motion is inclined.
        IntersectionMotion::Planar(PlanarMotion::Translation(along)) => {
            component(g.planar().translation, along) / along.norm_sqr()
        }
        IntersectionMotion::Translational(TranslationalMotion::Translation(along)) => {
            component(*g.translational(), along)
        }
        IntersectionMotion::Spatial(SpatialMotion::Translation) => g.spatial().z,
        IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => g.cylindrical().advance,
        IntersectionMotion::None(_)
        | IntersectionMotion::Planar(PlanarMotion::Rotation)
        | IntersectionMotion::Spherical(SphericalMotion::Rotation)
        | IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => 0.0,
    })
}

/// The angles of a kind of an orientation, those nearest to the values at home; where they are singular, a choice that depends
/// on these.
pub(super) fn angles_of(
    angles: OrientationCoordinates,
    r: &Matrix3<f64>,
    home: [f64; 3],
) -> [f64; 3] {
    match angles {
        OrientationCoordinates::EulerAngles => euler_angles(r, home),
        OrientationCoordinates::TiltTorsion => tilt_and_torsion(r, home),
        OrientationCoordinates::RollPitchYaw => roll_pitch_yaw(r, home),
    }
}

/// The angles `mu nu` of the rotation that takes the third direction to `axis`.
pub(super) fn tilt_angles(axis: &Vector3<f64>) -> [f64; 2] {
    [(-axis.y).atan2(axis.z), axis.x.atan2(axis.y.hypot(axis.z))]
}

/// The angles `zeta xi psi` of a rotation, where this is the sine of `xi`, which is not zero.
fn with_sine(r: &Matrix3<f64>, sine: f64) -> [f64; 3] {
    let (y, x) = directions(r, sine);
    atan2_of_each(&y, &x)
}

/// The directions of these angles: their sines and their cosines, times some factor.
#[inline(always)]
fn directions(r: &Matrix3<f64>, sine: f64) -> ([f64; 3], [f64; 3]) {
    // Near the singularity the error of zeta is the rounding over the sine, but zeta ± psi is accurate: psi
    // is computed from what this zeta leaves of the rotation.
    let (cos, sin) = (r[(0, 2)] / sine, r[(1, 2)] / sine);
    let y = [r[(1, 2)], sine, cos * r[(1, 0)] - sin * r[(0, 0)]];
    let x = [r[(0, 2)], r[(2, 2)], cos * r[(1, 1)] - sin * r[(0, 1)]];
    (y, x)
}

/// The angles `azimuth tilt torsion` with `Rz(azimuth) Ry(tilt) Rz(torsion - azimuth) = r`, the tilt in [0, π]. Where
/// that is 0 or π, the azimuth is that at home.
fn tilt_and_torsion(r: &Matrix3<f64>, home: [f64; 3]) -> [f64; 3] {
    let sine = (r[(0, 2)] * r[(0, 2)] + r[(1, 2)] * r[(1, 2)]).sqrt();
    let angles = if sine >= POLE {
        with_sine(r, sine)
    } else {
        let (tilt, azimuth) = (if r[(2, 2)] > 0.0 { 0.0 } else { PI }, home[0]);
        // What this azimuth leaves of the rotation: Ry(tilt) Rz(psi), of which the second column is (-sin psi, cos psi, 0)
        // but for the sign of the first component.
        let (sin, cos) = sin_cos(azimuth);
        let psi = atan2(cos * r[(1, 0)] - sin * r[(0, 0)], cos * r[(1, 1)] - sin * r[(0, 1)]);
        [azimuth, tilt, psi]
    };
    let [azimuth, tilt, torsion] = OrientationCoordinates::TiltTorsion.of_factors(angles);
    [near(azimuth, home[0]), tilt, near(torsion, home[2])]
}

/// The angles `zeta xi psi` with `Rz(zeta) Ry(xi) Rz(psi) = r`: of all triples, the one nearest to `home`.
fn euler_angles(r: &Matrix3<f64>, home: [f64; 3]) -> [f64; 3] {
    let sine = (r[(0, 2)] * r[(0, 2)] + r[(1, 2)] * r[(1, 2)]).sqrt();
    if sine < POLE {
        // Only zeta ± psi is known.
        let (up, xi) = if r[(2, 2)] > 0.0 { (1.0, 0.0) } else { (-1.0, PI) };
        let sum = near(atan2(up * r[(1, 0)], up * r[(0, 0)]), home[0] + up * home[2]);
        let extra = 0.5 * (sum - home[0] - up * home[2]);
        return [home[0] + extra, xi, home[2] + up * extra];
    }
    nearer_factors(OrientationCoordinates::EulerAngles, with_sine(r, sine), home)
}

/// The angles `roll pitch yaw` with `Rz(yaw) Ry(pitch) Rx(roll) = r`: of all triples, the one nearest to `home`.
fn roll_pitch_yaw(r: &Matrix3<f64>, home: [f64; 3]) -> [f64; 3] {
    let kind = OrientationCoordinates::RollPitchYaw;
    let cosine = (r[(0, 0)] * r[(0, 0)] + r[(1, 0)] * r[(1, 0)]).sqrt();
    if cosine < POLE {
        // Only roll ∓ yaw is known.
        let up = if r[(2, 0)] < 0.0 { 1.0 } else { -1.0 };
        let difference = near(atan2(up * r[(0, 1)], r[(1, 1)]), home[0] - up * home[2]);
        let extra = 0.5 * (difference - home[0] + up * home[2]);
        return [home[0] + extra, up * FRAC_PI_2, home[2] - up * extra];
    }
    // Near the singularity roll ∓ yaw is accurate: roll is computed from what this yaw leaves of the rotation.
    let (cos, sin) = (r[(0, 0)] / cosine, r[(1, 0)] / cosine);
    let y = [r[(1, 0)], 0.0 - r[(2, 0)], sin * r[(0, 2)] - cos * r[(1, 2)]];
    let x = [r[(0, 0)], cosine, cos * r[(1, 1)] - sin * r[(0, 1)]];
    let factors = nearer_factors(kind, atan2_of_each(&y, &x), kind.to_factors(home));
    kind.of_factors(factors)
}

/// The angles of the three other rotations, about the same directions, whose product is the same orientation.
#[inline(always)]
pub(crate) fn other_factors(
    angles: OrientationCoordinates,
    [first, second, last]: [f64; 3],
) -> [f64; 3] {
    let second = match angles {
        OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => -second,
        OrientationCoordinates::RollPitchYaw => PI - second,
    };
    [first + PI, second, last + PI]
}

/// Of the two triples of angles whose rotations have the same product, of which one is given, the one nearest to `home`.
#[inline(always)]
fn nearer_factors(angles: OrientationCoordinates, given: [f64; 3], home: [f64; 3]) -> [f64; 3] {
    let placed = |[a, b, c]: [f64; 3]| [near(a, home[0]), near(b, home[1]), near(c, home[2])];
    let distance = |angles: &[f64; 3]| {
        let [a, b, c] = [angles[0] - home[0], angles[1] - home[1], angles[2] - home[2]];
        a * a + b * b + c * c
    };
    let (plain, other) = (placed(given), placed(other_factors(angles, given)));
    let nearer = distance(&other) < distance(&plain);
    let chosen = |i: usize| if nearer { other[i] } else { plain[i] };
    [chosen(0), chosen(1), chosen(2)]
}

/// [`euler_angles`] of several rotations, with the instructions of the processor at hand.
struct EulerAngles<'a> {
    rotations: &'a [Matrix3<f64>; TOGETHER],
    home: [f64; 3],
}

impl WithSimd for EulerAngles<'_> {
    type Output = [[f64; 3]; TOGETHER];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { rotations, home } = self;
        let (mut y, mut x) = ([[0.0; TOGETHER]; 3], [[0.0; TOGETHER]; 3]);
        let mut sines = [0.0; TOGETHER];
        for (i, r) in rotations.iter().enumerate() {
            sines[i] = (r[(0, 2)] * r[(0, 2)] + r[(1, 2)] * r[(1, 2)]).sqrt();
            let of_one = directions(r, sines[i]);
            for k in 0..3 {
                (y[k][i], x[k][i]) = (of_one.0[k], of_one.1[k]);
            }
        }
        let [zeta, xi, psi] = [0, 1, 2].map(|k| atan2_of_each(&y[k], &x[k]));
        let mut angles = [[0.0; 3]; TOGETHER];
        for i in 0..TOGETHER {
            let given = [zeta[i], xi[i], psi[i]];
            angles[i] = nearer_factors(OrientationCoordinates::EulerAngles, given, home);
        }
        for i in (0..TOGETHER).filter(|&i| sines[i] < POLE) {
            angles[i] = euler_angles(&rotations[i], home);
        }
        angles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Manipulator;
    use crate::group::{Spherical, Subgroup};

    /// Poses are written together as each alone: random rotations, half turns, quarter turns, and the poles of Euler angles.
    #[test]
    fn many_poses_are_written_as_one_is() {
        let mut rng = fastrand::Rng::with_seed(1);
        for name in ["plano-spherical-5dof", "agile-eye", "planar-3rrr", "cartesian-wrist-6dof"] {
            let m = Manipulator::example(name).unwrap();
            let mut written = Vec::new();
            for count in (0..30).chain(1..4) {
                let mut some = |lower: bool| {
                    let home = m.home_pose();
                    let pose: Vec<f64> = home
                        .iter()
                        .map(|home| match rng.u32(..4) {
                            0 => *home,
                            1 => FRAC_PI_2 * f64::from(rng.i32(-2..=2)),
                            _ => home + 3.0 * (rng.f64() - 0.5),
                        })
                        .collect();
                    let (v, b) = m.task().sections(&pose);
                    if lower { v } else { b }
                };
                let v = some(true);
                let mut bs: Vec<Displacement> = (0..count).map(|_| some(false)).collect();
                if let Some(Displacement::Spherical(b)) = bs.first_mut() {
                    *b = Spherical::exponential(&Vector3::new(0.0, 0.0, 0.3));
                }
                m.task().write_poses(&v, &bs, 0.01, m.arch, &mut written);
                let each = bs.iter().flat_map(|b| m.task().pose(&v, b, 0.01));
                assert_eq!(written, each.collect::<Vec<f64>>(), "{name}");
            }
        }
    }

    /// Roll, pitch and yaw are those of nalgebra's rotations, and a rotation has the triple that is nearest to home. Angles
    /// are random, zero, quarter and half turns, and near these, so that the pitch is at its poles and next to them.
    #[test]
    fn roll_pitch_and_yaw_are_found_again() {
        let mut rng = fastrand::Rng::with_seed(2);
        let kind = OrientationCoordinates::RollPitchYaw;
        let mut angle = || match rng.u32(..3) {
            0 => PI * (2.0 * rng.f64() - 1.0),
            1 => FRAC_PI_2 * f64::from(rng.i32(-2..=2)),
            _ => FRAC_PI_2 * f64::from(rng.i32(-2..=2)) + 1e-9 * f64::from(rng.i32(-1..=1)),
        };
        for _ in 0..2000 {
            let [roll, pitch, yaw] = [angle(), angle(), angle()];
            let r = nalgebra::Rotation3::from_euler_angles(roll, pitch, yaw);
            let made = super::super::displacement::orientation(kind, [roll, pitch, yaw]);
            assert!((made - r.matrix()).norm() < 1e-14, "{roll} {pitch} {yaw}");
            let home = [angle(), angle(), angle()];
            let found = roll_pitch_yaw(r.matrix(), home);
            let again = nalgebra::Rotation3::from_euler_angles(found[0], found[1], found[2]);
            assert!((again.matrix() - r.matrix()).norm() < 1e-13, "{roll} {pitch} {yaw}");
            let far = |of: [f64; 3]| {
                let each = of.into_iter().zip(home);
                each.map(|(angle, home)| near(angle - home, 0.0).powi(2)).sum::<f64>()
            };
            // At a pole, there are nearer ones than those that were given.
            let others = [[roll, pitch, yaw], [roll + PI, PI - pitch, yaw + PI]];
            let nearest = others.into_iter().map(far).fold(f64::INFINITY, f64::min);
            assert!(far(found) < nearest + 1e-6, "{found:?} {roll} {pitch} {yaw} {home:?}");
        }
    }
}
