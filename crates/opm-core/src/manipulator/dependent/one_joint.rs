//! A section with one joint that moves, so that its motion has one parameter: the joint's displacement `q`. One
//! coordinate of the section tells `q`, and `q` the other coordinates.
//!
//! Of a rotation about an axis `s` the second Euler angle tells `q`: the third direction makes the angle `ξ` with
//! itself before. Where the platform's home orientation is the identity that is
//! `sin(ξ/2) = ρ sin(q/2)`, with `ρ` the sine of the angle between `s` and the third direction. The pitch of roll, pitch and
//! yaw is such an angle, too, less a right one: see [`Task::euler_home`].

use crate::chain::{Closes, REACH_TOLERANCE, ReachDeficit};
use crate::group::{
    Displacement, JointDisplacement, LocalTwist, PlanarDisplacement, Subspace, SubspaceKind,
    linear, quarter,
};
use crate::manipulator::Manipulator;
use crate::manipulator::leg::Section;
use crate::mechanism::OrientationCoordinates;
use crate::numbers::{
    Joint, Over, Plane, PlaneOver, Real, Rotation, RotationOver, Space, Tolerance,
};
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use crate::task::{Task, other_factors};
use nalgebra::{Complex, Matrix3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Sub};

/// An axis whose angle with the third direction has a sine below this is along that direction; a coordinate that changes by less
/// than this along a line does not tell the place on it.
const ALONG: Tolerance = Tolerance { name: "ALONG", share: 1e-9, single: 1e-6 };

/// Stands for a cosine of zero, whose products with the components of an axis have directions.
const LEAST: f64 = 1e-150;

/// How a section's coordinates follow from its one joint.
#[derive(Clone, Debug)]
pub(crate) struct OneJoint {
    pub leg: usize,
    pub section: Section,
    /// The numbers of the dependent coordinates.
    pub coordinates: Vec<usize>,
    /// The numbers of the section's coordinates, but that of a height. Those of an orientation are in the order of its
    /// [factors](OrientationCoordinates::to_factors).
    pub all: Vec<usize>,
    /// What each of these is, if it is dependent.
    pub follows: [Option<Quantity>; 3],
    pub motion: SectionMotion,
}

/// The motion of a section with one joint.
#[derive(Clone, Copy, Debug)]
pub enum SectionMotion {
    /// It does not move.
    None,
    /// A rotation in a plane about this screw; the third coordinate tells the joint.
    Turn(LocalTwist),
    /// A translation along this screw; this coordinate of the section tells the joint.
    Slide(LocalTwist, usize),
    /// A rotation about the third direction, told by the angle of the first factor of the orientation.
    Third,
    /// A rotation about this axis, told by the angle of the second factor.
    Axis(LocalTwist),
    /// Any rotation about the third direction, after a rotation about this axis that is told by the angle of the second
    /// factor. The third angle follows.
    LastAngle(LocalTwist),
}

impl OneJoint {
    /// The motion of a section with the screw `free`, or of one without joints. `None` where its coordinates do
    /// not tell the joint.
    pub fn new(
        task: &Task,
        leg: usize,
        section: Section,
        free: Option<LocalTwist>,
    ) -> Option<Self> {
        let all = numbers(task, section);
        let (motion, given) = match (subspace(task, section).kind, free) {
            (_, None) => (SectionMotion::None, None),
            (SubspaceKind::Planar, Some(s)) if s.x != 0.0 => (SectionMotion::Turn(s), Some(2)),
            (SubspaceKind::Planar, Some(s)) => {
                let longer = usize::from(s.z.abs() > s.y.abs());
                (SectionMotion::Slide(s, longer), Some(longer))
            }
            (SubspaceKind::TranslationalSpace, Some(s)) => {
                let longest = s.rows(0, all.len()).iamax();
                // Along the intersection motion, no coordinate of the section changes.
                if s[longest].abs() < ALONG.share {
                    (SectionMotion::None, None)
                } else {
                    (SectionMotion::Slide(s, longest), Some(longest))
                }
            }
            (SubspaceKind::Spherical, Some(s)) if s.x.hypot(s.y) < ALONG.share => {
                (SectionMotion::Third, Some(0))
            }
            (SubspaceKind::Spherical, Some(s)) => (SectionMotion::Axis(s), Some(1)),
            // With one joint, these have one constraint.
            (
                SubspaceKind::Identity
                | SubspaceKind::Cylindrical
                | SubspaceKind::TranslationalPlane,
                Some(_),
            ) => return None,
        };
        let follows = (0..all.len()).filter(|i| Some(*i) != given);
        Some(Self::of(task, leg, section, all.clone(), follows.collect(), motion))
    }

    /// A rotation about the third direction, and one about the axis `s`.
    pub fn last_angle(task: &Task, leg: usize, section: Section, s: LocalTwist) -> Self {
        let all = numbers(task, section);
        Self::of(task, leg, section, all, vec![2], SectionMotion::LastAngle(s))
    }

    /// The motion of a section with coordinates of which these follow from it.
    fn of(
        task: &Task,
        leg: usize,
        section: Section,
        all: Vec<usize>,
        following: Vec<usize>,
        motion: SectionMotion,
    ) -> Self {
        let mut follows = [None; 3];
        for &i in &following {
            follows[i] = Some(task.coordinates[all[i]].quantity);
        }
        let coordinates = following.into_iter().map(|i| all[i]).collect();
        Self { leg, section, coordinates, all, follows, motion }
    }

    /// Whether two displacements of the joint belong to a value of the coordinate that tells it.
    pub fn has_choice(&self) -> bool {
        matches!(self.motion, SectionMotion::Axis(_) | SectionMotion::LastAngle(_))
    }

    /// Chooses among the angles of an orientation. Where the section only rotates about the third direction,
    /// the first angle gets the whole rotation: at home the angles may be singular, so that the first and the third
    /// share it. Elsewhere there are two triples, and the one is chosen that belongs to the branch `sign`.
    pub fn choose_angles(&self, manipulator: &Manipulator, sign: f64, pose: &mut [f64]) {
        let task = manipulator.task();
        // A section of two coordinates has no other angles than these.
        let &[first, second, third] = &self.all[..] else { return };
        let numbers = [first, second, third];
        let at_home = numbers.map(|i| task.coordinates[i].home);
        let home = to_factors(task, at_home);
        let chosen = match self.motion {
            SectionMotion::Turn(_) | SectionMotion::Slide(..) => return,
            SectionMotion::None | SectionMotion::Third => {
                let (v, b) = task.sections(pose);
                let displacement = if self.section == Section::Lower { v } else { b };
                let Displacement::Spherical(_) = displacement else { return };
                let [zeta, ..]: [f64; 3] = of_displacement(&displacement, |i| home[i]);
                [zeta, home[1], home[2]]
            }
            SectionMotion::Axis(s) | SectionMotion::LastAngle(s) => {
                let [zeta, xi, psi] = to_factors(task, numbers.map(|i| pose[i]));
                let [a, b, c] = other_factors(task.angles, [zeta, xi, psi]);
                let other = [near(a, home[0]), b, near(c, home[2])];
                // The last angle that follows from the second one.
                let follows = |xi: f64| {
                    let (exists, [_, psi]) = about_axis(task, &s, xi, sign);
                    exists.holds(REACH_TOLERANCE).then_some(psi)
                };
                let off = |[_, xi, psi]: [f64; 3]| {
                    follows(xi).map_or(f64::INFINITY, |found| near(found - psi, 0.0).abs())
                };
                let [zeta, xi, psi] =
                    if off(other) < off([zeta, xi, psi]) { other } else { [zeta, xi, psi] };
                // Near their singularity only the sum of the two angles is known, or their difference.
                let follows = follows(xi).map_or(psi, |found| near(found, psi));
                let rest = if tilt(task, xi).cos() > 0.0 { psi - follows } else { follows - psi };
                [zeta + rest, xi, follows]
            }
        };
        let chosen = of_factors(task, chosen);
        for ((number, angle), home) in numbers.into_iter().zip(chosen).zip(at_home) {
            pose[number] = near(angle, home);
        }
    }

    /// The section's coordinates of a pose, dependent ones too, where the leg's displacement along the intersection motion
    /// is `tau` if that belongs to the other section. Angles are those nearest to what `at` has, the section's coordinates.
    ///
    /// # Errors
    /// By how much the coordinate that tells the joint is out of its range.
    #[inline(always)]
    pub fn solve(
        &self,
        manipulator: &Manipulator,
        tau: JointDisplacement,
        sign: f64,
        at: [f64; 3],
    ) -> Result<[f64; 3], ReachDeficit> {
        let (exists, found) = self.found(manipulator, tau, sign, at);
        if !exists.holds(REACH_TOLERANCE) {
            return Err(match self.motion {
                SectionMotion::Slide(s, given) => {
                    self.line::<f64>(manipulator, s, given, tau).deficit(at)
                }
                _ => self.deficit(exists, manipulator.task(), at),
            });
        }
        Ok(self.taken(subspace(manipulator.task(), self.section).kind, at, found))
    }

    /// By how much the coordinate that tells the joint is out of its range.
    #[cold]
    fn deficit(&self, exists: Closes<f64>, task: &Task, at: [f64; 3]) -> ReachDeficit {
        let tilt = tilt(task, at[1]);
        let xi = near(tilt, 0.0).abs();
        match (self.motion, exists) {
            (SectionMotion::Axis(s) | SectionMotion::LastAngle(s), Closes::Within(_, ends)) => {
                ReachDeficit::angle(match task.euler_home() {
                    None => xi - 2.0 * s.x.hypot(s.y).min(1.0).asin(),
                    // cos ξ - c₀ is beyond one of its ends.
                    Some(home) => {
                        let c0 = s.z * s.dot(&home.column(2));
                        let nearest = (tilt.cos() - c0).clamp(ends[0], ends[1]) + c0;
                        (xi - nearest.clamp(-1.0, 1.0).acos()).abs()
                    }
                })
            }
            _ => ReachDeficit::angle(f64::INFINITY),
        }
    }

    /// The section's coordinates, and what decides whether there are such, over numbers: at one pose, and over boxes.
    #[inline(always)]
    pub fn found<T: Over<f64>>(
        &self,
        manipulator: &Manipulator,
        tau: T::Joint,
        sign: T::Sign,
        at: [T; 3],
    ) -> (Closes<T>, [T; 3]) {
        let task = manipulator.task();
        // Zero for a displacement along the intersection motion, for which there is no coordinate.
        let home = |i: usize| self.all.get(i).map_or(0.0, |&i| task.coordinates[i].home);
        let factors_at_home = || to_factors(task, [0, 1, 2].map(home)).map(T::constant);
        let kind = subspace(task, self.section).kind;
        let shifted = |motion: Displacement<T>| self.shifted(manipulator, motion, tau);
        let still = || shifted(Displacement::still(kind));
        let found = match self.motion {
            SectionMotion::None => match still() {
                // The rotation about the third direction is that of the first factor.
                Displacement::Spherical(r) => {
                    let [zeta, xi, psi] = factors_at_home();
                    of_factors(task, [about_third::<T>(r) + zeta, xi, psi])
                }
                other => of_displacement(&other, home),
            },
            SectionMotion::Turn(s) => {
                let rotation = (at[2] - home(2)).unit() * still().planar().rotation.conj();
                let point = quarter(linear(&s)) * s.x;
                let turned = PlanarDisplacement::about(point, rotation);
                of_displacement(&shifted(Displacement::Planar(turned)), home)
            }
            SectionMotion::Slide(s, given) => {
                return self.line::<T>(manipulator, s, given, tau).found(at);
            }
            SectionMotion::Third => {
                let [_, xi, psi] = factors_at_home();
                return (Closes::Always, of_factors(task, [at[0], xi, psi]));
            }
            SectionMotion::Axis(s) | SectionMotion::LastAngle(s) => {
                let (exists, [mut zeta, psi]) = about_axis(task, &s, at[1], sign);
                if let SectionMotion::LastAngle(_) = self.motion {
                    zeta = at[0];
                } else if let Displacement::Spherical(r) = still() {
                    zeta = zeta + about_third::<T>(r);
                }
                return (exists, of_factors(task, [zeta, at[1], psi]));
            }
        };
        (Closes::Always, found)
    }

    /// The section's coordinates where those that follow are `found`; angles that have no turns are those nearest to what `at`
    /// has.
    #[inline(always)]
    pub fn taken(&self, kind: SubspaceKind, mut at: [f64; 3], found: [f64; 3]) -> [f64; 3] {
        for ((&follows, at), value) in self.follows.iter().zip(&mut at).zip(found) {
            *at = match follows {
                Some(Quantity::Angle) if kind != SubspaceKind::Cylindrical => near(value, *at),
                Some(_) => value,
                None => *at,
            };
        }
        at
    }

    /// A displacement by the joint, after or before that along the intersection motion by `tau` if that belongs to the other
    /// section: g = exp(I τ) · exp(s q) for b, and exp(s q) · exp(-I τ) for v.
    #[inline(always)]
    fn shifted<T: Over<f64>>(
        &self,
        manipulator: &Manipulator,
        motion: Displacement<T>,
        tau: T::Joint,
    ) -> Displacement<T> {
        let (task, leg) = (manipulator.task(), &manipulator.legs[self.leg]);
        match self.section {
            _ if leg.bridge().is_none_or(|bridge| bridge == self.section) => motion,
            Section::Lower => task.lower_intersection.after(&motion, tau.inverse()),
            Section::Upper => task.upper_intersection.before(&motion, tau),
        }
    }

    /// The line along which a slider with the screw `s` moves the section; this length tells the place on it.
    #[inline(always)]
    pub fn line<T: Over<f64>>(
        &self,
        manipulator: &Manipulator,
        s: LocalTwist,
        given: usize,
        tau: T::Joint,
    ) -> Line<T> {
        let (task, kind) = (manipulator.task(), subspace(manipulator.task(), self.section).kind);
        let home = |i: usize| self.all.get(i).map_or(0.0, |&i| task.coordinates[i].home);
        let ends = [Displacement::still(kind), slid(kind, &s)]
            .map(|motion| self.shifted(manipulator, motion, tau));
        let [[a, b, c], [x, y, z]] = [lengths(&ends[0]), lengths(&ends[1])];
        let last = if kind == SubspaceKind::Planar { T::constant(0.0) } else { z - c };
        Line {
            start: of_displacement(&ends[0], home),
            rates: [x - a, y - b, last],
            given,
            home: home(given),
            from_home: [a, b, c][given],
        }
    }
}

/// A straight line of coordinates of a section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<T = f64> {
    /// The coordinates at its start.
    start: [T; 3],
    /// Their changes along it.
    rates: [T; 3],
    /// The number of the coordinate that tells the place.
    given: usize,
    /// Its value at home, and the difference from that at the start.
    home: f64,
    from_home: T,
}

impl<T: Over<f64>> Line<T> {
    /// The coordinates where the given one is that of `at`, and what decides whether it changes along the line at all.
    #[inline(always)]
    fn found(&self, at: [T; 3]) -> (Closes<T>, [T; 3]) {
        let rate = self.rates[self.given];
        let q = (at[self.given] - self.home - self.from_home).over(rate);
        let ([a, b, c], [x, y, z]) = (self.start, self.rates);
        (Closes::Exceeds(rate, ALONG), [a + q * x, b + q * y, c + q * z])
    }
}

impl Line {
    /// The coordinates where the given one is that of `at`.
    ///
    /// # Errors
    /// By how much it is missed, where it does not change along the line.
    #[inline(always)]
    pub fn through(&self, at: [f64; 3]) -> Result<[f64; 3], ReachDeficit> {
        let (exists, found) = self.found(at);
        if exists.holds(0.0) { Ok(found) } else { Err(self.deficit(at)) }
    }

    #[cold]
    fn deficit(&self, at: [f64; 3]) -> ReachDeficit {
        ReachDeficit::length((at[self.given] - self.home - self.from_home).abs())
    }
}

fn subspace(task: &Task, section: Section) -> &Subspace {
    match section {
        Section::Lower => &task.lower,
        Section::Upper => &task.upper,
    }
}

/// The numbers of a section's coordinates, but that of a height; of an orientation, in the order of its factors.
fn numbers(task: &Task, section: Section) -> Vec<usize> {
    let mut all: Vec<usize> = task.in_plane(section, task.range(section)).collect();
    if task.oriented_section() == Some(section) {
        match task.angles {
            OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => {}
            OrientationCoordinates::RollPitchYaw => all.reverse(),
        }
    }
    all
}

/// The angles of the factors of an orientation, for its coordinates in their order.
#[inline(always)]
fn to_factors<T: Copy + Sub<Output = T>>(task: &Task, [a, b, c]: [T; 3]) -> [T; 3] {
    match task.angles {
        OrientationCoordinates::EulerAngles | OrientationCoordinates::RollPitchYaw => [a, b, c],
        OrientationCoordinates::TiltTorsion => [a, b, c - a],
    }
}

/// The coordinates of an orientation, in the order of its factors, for their angles.
#[inline(always)]
fn of_factors<T: Copy + Add<Output = T>>(task: &Task, [a, b, c]: [T; 3]) -> [T; 3] {
    match task.angles {
        OrientationCoordinates::EulerAngles | OrientationCoordinates::RollPitchYaw => [a, b, c],
        OrientationCoordinates::TiltTorsion => [a, b, a + c],
    }
}

/// The second Euler angle for the angle of the second factor of an orientation: see [`Task::euler_home`].
#[inline(always)]
fn tilt<T: Real>(task: &Task, second: T) -> T {
    match task.angles {
        OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => second,
        OrientationCoordinates::RollPitchYaw => second + FRAC_PI_2,
    }
}

/// The angles of the first and the last factor of the platform's orientation after the rotation about `s` from home, for that
/// of the second one, and what decides whether there are any.
#[inline(always)]
fn about_axis<T: Over<f64>>(
    task: &Task,
    s: &LocalTwist,
    second: T,
    sign: T::Sign,
) -> (Closes<T>, [T; 2]) {
    let xi = tilt(task, second);
    match task.euler_home() {
        None => from_identity(s, xi, sign),
        Some(home) => from_orientation(s, &home, xi, sign),
    }
}

/// The displacement by one unit along the screw of a slider: a translation of a plane, or of space.
#[inline(always)]
fn slid<T: Over<f64>>(kind: SubspaceKind, s: &LocalTwist) -> Displacement<T> {
    match kind {
        SubspaceKind::Planar => Displacement::Planar(PlanarDisplacement {
            rotation: T::Plane::from_constant(Complex::ONE),
            translation: T::Plane::from_constant(linear(s)),
        }),
        _ => {
            let [x, y, z] = [s.x, s.y, s.z].map(T::constant);
            Displacement::Spatial(T::Space::new(x, y, z))
        }
    }
}

/// The lengths among the coordinates of a displacement that has a slider, from home.
#[inline(always)]
fn lengths<T: Real>(g: &Displacement<T>) -> [T; 3] {
    match g {
        Displacement::Planar(g) => [g.translation.re(), g.translation.im(), T::constant(0.0)],
        other => other.spatial().parts(),
    }
}

/// The angle of a rotation about the third direction.
#[inline(always)]
fn about_third<T: Real>(r: T::Rotation) -> T {
    let [[x, ..], [y, ..], _] = r.rows();
    T::Plane::new(x, y).argument()
}

/// The coordinates of a displacement of a section that has all coordinates of its subspace. A rotation about a
/// centre is one about the third direction.
#[inline(always)]
fn of_displacement<T: Real>(g: &Displacement<T>, home: impl Fn(usize) -> f64) -> [T; 3] {
    let none = T::constant(0.0);
    let [x, y, z] = match *g {
        Displacement::Planar(g) => [g.translation.re(), g.translation.im(), g.rotation.argument()],
        Displacement::Spherical(r) => [about_third::<T>(r), none, none],
        ref other => other.sums(),
    };
    [x + home(0), y + home(1), z + home(2)]
}

/// The first and the last Euler angle of the rotation about `s` from the identity whose second angle is `xi`, and what
/// decides whether there is one. They are continuous through `xi = 0`, where the half angles keep their directions.
#[inline(always)]
fn from_identity<T: Over<f64>>(s: &LocalTwist, xi: T, sign: T::Sign) -> (Closes<T>, [T; 2]) {
    let reduced = xi.reduced();
    let half = Over::per((reduced * 0.5).unit().im(), s.x.hypot(s.y));
    let exists = Closes::Within(half, [-1.0, 1.0]);
    if (reduced + PI).side().is_none() || (-reduced + PI).side().is_none() {
        // The sine of half the angle changes its sign at half a revolution.
        return (exists, [xi.any_angle(); 2]);
    }
    let sin = half.at_most_one();
    // A rotation by half a turn about a level axis is where the tilt is half a turn, too. The directions are those of
    // its limit.
    let cos = ((-sin + 1.0) * (sin + 1.0)).root().larger(T::constant(LEAST));
    // The rotation is by ±q, with these the sine and the cosine of q/2. Its third column and its third row,
    // over 2 sin(q/2), are regular.
    let sin = sin * sign;
    let (x, y) = (sin * (s.x * s.z), sin * (s.y * s.z));
    let column = [x + cos * s.y, y - cos * s.x];
    let row = [-x + cos * s.y, y + cos * s.x];
    (exists, [column, row].map(|[re, im]| T::Plane::new(re * sign, im * sign).argument()))
}

/// The same for the rotation about `s` of the orientation `home`.
#[inline(always)]
fn from_orientation<T: Over<f64>>(
    s: &LocalTwist,
    home: &Matrix3<f64>,
    xi: T,
    sign: T::Sign,
) -> (Closes<T>, [T; 2]) {
    let third = home.column(2).into_owned();
    // cos ξ = c₀ + c₁ cos q + c₂ sin q
    let c0 = s.z * s.dot(&third);
    let z = Complex::new(third.z - c0, s.x * third.y - s.y * third.x);
    let amplitude = z.norm();
    let part = xi.unit().re() - c0;
    let exists = Closes::Within(part, [-amplitude, amplitude]);
    let reduced = xi.reduced();
    let (Some(upper), Some(_), Some(_)) =
        (reduced.side(), (reduced + PI).side(), (-reduced + PI).side())
    else {
        // The axis is on both sides of a pole, where these angles jump.
        return (exists, [xi.any_angle(); 2]);
    };
    let height = ((-part + amplitude) * (part + amplitude)).root() * sign * upper;
    let turn = T::Plane::new(part, height) * (z / (amplitude * amplitude));
    let [[_, _, x], [_, _, y], [u, v, _]] = rotation_about::<T>(s, turn).after(*home).rows();
    (exists, [[x, y], [-u, v]].map(|[re, im]| T::Plane::new(re * upper, im * upper).argument()))
}

/// The rotation about an axis by the angle of a unit vector: s sᵀ + cos (1 - s sᵀ) + sin [s].
#[inline(always)]
fn rotation_about<T: Over<f64>>(s: &LocalTwist, turn: T::Plane) -> T::Rotation {
    let across = s.cross_matrix();
    let entry = |i: usize, j: usize| {
        let along = s[i] * s[j];
        turn.re() * (f64::from(i == j) - along) + turn.im() * across[(i, j)] + along
    };
    T::Rotation::from_rows([0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::euler;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    /// Rounding of a product of a few rotations.
    const ROUNDING: f64 = 1e-12;

    /// Whether a matrix is a rotation about `s`, and near to the identity where it is given.
    fn keeps(r: &Matrix3<f64>, s: &Vector3<f64>) -> f64 {
        (r * s - s).norm()
    }

    proptest! {
        /// The Euler angles are those of a rotation about the axis.
        #[test]
        fn the_axis_is_kept(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64, share in -0.99..0.99_f64,
            turn in -3.0..3.0_f64, tilt in 0.3..2.5_f64, roll in -3.0..3.0_f64,
        ) {
            let s = Vector3::new(x, y, z);
            prop_assume!(s.norm() > 0.1 && x.hypot(y) > 0.1 * s.norm());
            let s = s.normalize();
            for sign in [-1.0, 1.0] {
                let xi = share * 2.0 * s.x.hypot(s.y).asin();
                let (_, [zeta, psi]) = from_identity(&s, xi, sign);
                prop_assert!(keeps(&euler(zeta, xi, psi), &s) < ROUNDING);

                let home = euler(turn, tilt, roll);
                let r = rotation_about::<f64>(&s, (2.0 * share).unit()) * home;
                let xi = r[(2, 2)].acos();
                prop_assume!(xi.sin() > 1e-3);
                for xi in [xi, -xi] {
                    let (_, [zeta, psi]) = from_orientation(&s, &home, xi, sign);
                    let found = euler(zeta, xi, psi) * home.transpose();
                    prop_assert!(keeps(&found, &s) < 1e3 * ROUNDING, "{}", keeps(&found, &s));
                }
            }
        }
    }
}
