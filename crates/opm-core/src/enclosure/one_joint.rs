//! The coordinates of a section with one joint that moves, over a box: see [`OneJoint`].

use super::affine::{Affine, Plane};
use super::share::Share;
use super::target::{Coordinate, PlanarTarget, Rotation, Target, dot};
use crate::chain::REACH_TOLERANCE;
use crate::group::{LocalTwist, SubspaceKind, linear, quarter};
use crate::manipulator::dependent::one_joint::{ALONG, OneJoint, SectionMotion};
use crate::mechanism::OrientationCoordinates;
use crate::task::Task;
use nalgebra::{Complex, Matrix3};
use std::f64::consts::{PI, TAU};

/// What a section's coordinates are, other than a height, and the share of the box for which they exist. `shifted` adds the
/// displacement along the intersection motion, if it belongs to the other section.
pub fn coordinates<const N: usize>(
    joint: &OneJoint,
    kind: SubspaceKind,
    task: &Task,
    sign: f64,
    shifted: &dyn Fn(Target<N>) -> Target<N>,
    pose: &[Coordinate<N>],
) -> (Share<N>, [Affine<N>; 3]) {
    // Zero for a displacement along the intersection motion, for which there is no coordinate.
    let home = |i: usize| joint.all.get(i).map_or(0.0, |&i| task.coordinates[i].home);
    let at = |i: usize| pose[joint.all[i]].minus(0.0);
    let still = || shifted(Target::still(kind));
    let of_euler = |angles| of_euler(task, angles);
    match joint.motion {
        SectionMotion::None => (
            Share::ALL,
            match still() {
                // The rotation about the third direction is that of the first Euler angle.
                Target::Spherical(r) => {
                    let [zeta, xi, psi] =
                        task.angles.to_euler([0, 1, 2].map(home)).map(Affine::constant);
                    of_euler([about_third(&r) + zeta, xi, psi])
                }
                other => of_displacement(&other, home),
            },
        ),
        SectionMotion::Turn(s) => {
            let still = still();
            let rotation = (at(2) - home(2)).unit_vector() * still.planar().rotation.conj();
            let point = quarter(linear(&s)) * s.x;
            let turned = shifted(Target::Planar(PlanarTarget::about(point, rotation)));
            (Share::ALL, of_displacement(&turned, home))
        }
        SectionMotion::Slide(s, given) => {
            let ends = [still(), shifted(slid(kind, &s))];
            let [start, end] = ends.map(|g| lengths(&g));
            let rates: [Affine<N>; 3] = std::array::from_fn(|i| end[i] - start[i]);
            let varies = Share::outside(&rates[given], [-ALONG, ALONG]);
            let q = (at(given) - home(given) - start[given]) * rates[given].recip();
            let mut found = of_displacement(&ends[0], home);
            let count = if kind == SubspaceKind::Planar { 2 } else { 3 };
            for (value, rate) in found.iter_mut().zip(rates).take(count) {
                *value = *value + q * rate;
            }
            (varies, found)
        }
        SectionMotion::Third => {
            let [_, xi, psi] = task.angles.to_euler([0, 1, 2].map(home)).map(Affine::constant);
            (Share::ALL, of_euler([at(0), xi, psi]))
        }
        SectionMotion::Axis(s) | SectionMotion::LastAngle(s) => {
            let xi = at(1);
            let (exists, [mut zeta, psi]) = match task.home_orientation_inverse() {
                None => from_identity(&s, xi, sign),
                Some(inverse) => from_orientation(&s, &inverse.transpose(), xi, sign),
            };
            if let SectionMotion::LastAngle(_) = joint.motion {
                zeta = at(0);
            } else if let Target::Spherical(r) = still() {
                zeta = zeta + about_third(&r);
            }
            (exists, of_euler([zeta, xi, psi]))
        }
    }
}

/// Three angles of the task's kind for Euler angles.
fn of_euler<const N: usize>(task: &Task, angles: [Affine<N>; 3]) -> [Affine<N>; 3] {
    let [zeta, xi, psi] = angles;
    match task.angles {
        OrientationCoordinates::EulerAngles => angles,
        OrientationCoordinates::TiltTorsion => [zeta, xi, zeta + psi],
    }
}

/// The angle of a rotation about the third direction.
fn about_third<const N: usize>(r: &Rotation<N>) -> Affine<N> {
    Plane { re: r.0[0][0], im: r.0[1][0] }.argument()
}

/// The displacement by one unit along the screw of a slider: a translation of a plane, or of space.
fn slid<const N: usize>(kind: SubspaceKind, s: &LocalTwist) -> Target<N> {
    match kind {
        SubspaceKind::Planar => Target::Planar(PlanarTarget {
            rotation: Plane::constant(Complex::ONE),
            translation: Plane::constant(linear(s)),
        }),
        _ => Target::Spatial([s.x, s.y, s.z].map(Affine::constant)),
    }
}

/// The lengths among the coordinates of a displacement that has a slider, from home.
fn lengths<const N: usize>(g: &Target<N>) -> [Affine<N>; 3] {
    match g {
        Target::Planar(g) => [g.translation.re, g.translation.im, Affine::constant(0.0)],
        other => *other.spatial(),
    }
}

/// The coordinates of a displacement of a section that has all coordinates of its subspace. A rotation about a centre is one
/// about the third direction.
fn of_displacement<const N: usize>(g: &Target<N>, home: impl Fn(usize) -> f64) -> [Affine<N>; 3] {
    let none = Affine::constant(0.0);
    let from_home = match g {
        Target::Identity(_) => return [none; 3],
        Target::Planar(g) => [g.translation.re, g.translation.im, g.rotation.argument()],
        Target::Spherical(r) => [about_third(r), none, none],
        &Target::Cylindrical(g) => [g.angle, g.advance, none],
        Target::Translational(t) => [t.re, t.im, none],
        Target::Spatial(t) => *t,
    };
    std::array::from_fn(|i| from_home[i] + home(i))
}

/// The first and the last Euler angle of the rotation about `s` from the identity whose second angle is `xi`, and the share
/// for which there is one.
fn from_identity<const N: usize>(
    s: &LocalTwist,
    xi: Affine<N>,
    sign: f64,
) -> (Share<N>, [Affine<N>; 2]) {
    let rho = s.x.hypot(s.y);
    let reduced = xi - TAU * (xi.centre / TAU).round();
    let sine = (reduced * 0.5).unit_vector().im;
    let half = sine * (1.0 / rho);
    let exists = Share::within(&half, [-1.0, 1.0], REACH_TOLERANCE);
    if reduced.low() <= -PI || reduced.high() >= PI {
        // The sine of half the angle changes its sign there.
        return (exists, [Affine::unknown(0.0, PI, &xi.spread()); 2]);
    }
    let cos = (-half.square() + 1.0).sqrt();
    let sin = half * sign;
    let [x, y] = [sin * (s.x * s.z), sin * (s.y * s.z)];
    let column = Plane { re: x + cos * s.y, im: y - cos * s.x };
    let row = Plane { re: cos * s.y - x, im: y + cos * s.x };
    (exists, [column, row].map(|z| (z * Complex::from(sign)).argument()))
}

/// The first and the last Euler angle of the rotation about `s` of the orientation `home` whose second angle is `xi`, and the
/// share for which there is one.
fn from_orientation<const N: usize>(
    s: &LocalTwist,
    home: &Matrix3<f64>,
    xi: Affine<N>,
    sign: f64,
) -> (Share<N>, [Affine<N>; 2]) {
    let third = home.column(2).into_owned();
    // cos ξ = c₀ + c₁ cos q + c₂ sin q
    let c0 = s.z * s.dot(&third);
    let z = Complex::new(third.z - c0, s.x * third.y - s.y * third.x);
    let amplitude = z.norm();
    let part = xi.unit_vector().re - c0;
    let exists = Share::within(&part, [-amplitude, amplitude], REACH_TOLERANCE);
    let turns = (xi.centre / TAU).round();
    let (low, high) = (xi.low() - TAU * turns, xi.high() - TAU * turns);
    let one_side = low > 0.0 && high < PI || high < 0.0 && low > -PI;
    if !one_side {
        // The axis is on both sides of a pole, where these angles jump.
        return (exists, [Affine::unknown(0.0, PI, &xi.spread()); 2]);
    }
    let upper = if low > 0.0 { 1.0 } else { -1.0 };
    let height = (-part.square() + amplitude * amplitude).sqrt() * (sign * upper);
    let turn = Plane { re: part, im: height } * (z / (amplitude * amplitude));
    let r = rotation_about(s, turn).after(home);
    let first = Plane { re: r.0[0][2], im: r.0[1][2] };
    let last = Plane { re: -r.0[2][0], im: r.0[2][1] };
    (exists, [first, last].map(|z| (z * Complex::from(upper)).argument()))
}

/// The rotation about an axis by the angle of a unit vector.
fn rotation_about<const N: usize>(s: &LocalTwist, turn: Plane<N>) -> Rotation<N> {
    let unit = [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()];
    // s sᵀ + cos (1 - s sᵀ) + sin [s]
    Rotation([0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let along = s[i] * s[j];
            let across = f64::from(i == j) - along;
            let turned = s.cross(&unit[j]).dot(&unit[i]);
            dot(&LocalTwist::new(along, across, turned), &[Affine::constant(1.0), turn.re, turn.im])
        })
    }))
}
