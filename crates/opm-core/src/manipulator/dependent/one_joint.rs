//! A section with one joint that moves, so that its motion has one parameter: the joint's displacement `q`. One
//! coordinate of the section tells `q`, and `q` the other coordinates.
//!
//! Of a rotation about an axis `s` the second Euler angle tells `q`: the third direction makes the angle `ξ` with
//! itself before. Where the platform's home orientation is the identity that is
//! `sin(ξ/2) = ρ sin(q/2)`, with `ρ` the sine of the angle between `s` and the third direction.

use crate::chain::{REACH_TOLERANCE, ReachDeficit};
use crate::group::{
    Displacement, JointDisplacement, LocalTwist, PlanarDisplacement, Subspace, SubspaceKind,
    linear, rotation_about,
};
use crate::manipulator::Manipulator;
use crate::manipulator::leg::Section;
use crate::numeric::Quantity;
use crate::numeric::angle::{atan2, near, unit};
use crate::task::{Task, other_triple};
use nalgebra::{Complex, Matrix3};

/// An axis whose angle with the third direction has a sine below this is along that direction.
pub(crate) const ALONG: f64 = 1e-9;

/// Stands for a cosine of zero, whose products with the components of an axis have directions.
const LEAST: f64 = 1e-150;

/// How a section's coordinates follow from its one joint.
#[derive(Clone, Debug)]
pub(crate) struct OneJoint {
    pub leg: usize,
    pub section: Section,
    /// The numbers of the dependent coordinates.
    pub coordinates: Vec<usize>,
    /// The numbers of the section's coordinates, but that of a height.
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
    /// A rotation about the third direction, told by the first Euler angle.
    Third,
    /// A rotation about this axis, told by the second Euler angle.
    Axis(LocalTwist),
    /// Any rotation about the third direction, after a rotation about this axis that is told by the second
    /// Euler angle. The third Euler angle follows.
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
        let all: Vec<usize> = task.in_plane(section, task.range(section)).collect();
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
                if s[longest].abs() < ALONG {
                    (SectionMotion::None, None)
                } else {
                    (SectionMotion::Slide(s, longest), Some(longest))
                }
            }
            (SubspaceKind::Spherical, Some(s)) if s.x.hypot(s.y) < ALONG => {
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
        let all: Vec<usize> = task.range(section).collect();
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

    /// Chooses among the Euler angles of an orientation. Where the section only rotates about the third direction,
    /// the first angle gets the whole rotation: at home the angles may be singular, so that the first and the third
    /// share it. Elsewhere there are two triples, and the one is chosen that belongs to the branch `sign`.
    pub fn choose_angles(&self, manipulator: &Manipulator, sign: f64, pose: &mut [f64]) {
        let task = manipulator.task();
        // A section of two coordinates has no other angles than these.
        let &[first, second, third] = &self.all[..] else { return };
        let numbers = [first, second, third];
        let at_home = numbers.map(|i| task.coordinates[i].home);
        let home = task.angles.to_euler(at_home);
        let chosen = match self.motion {
            SectionMotion::Turn(_) | SectionMotion::Slide(..) => return,
            SectionMotion::None | SectionMotion::Third => {
                let (v, b) = task.sections(pose);
                let displacement = if self.section == Section::Lower { v } else { b };
                let Displacement::Spherical(_) = displacement else { return };
                let [zeta, ..] = of_displacement(&displacement, |i| home[i]);
                [zeta, home[1], home[2]]
            }
            SectionMotion::Axis(s) | SectionMotion::LastAngle(s) => {
                let [zeta, xi, psi] = task.angles.to_euler(numbers.map(|i| pose[i]));
                let [a, b, c] = other_triple([zeta, xi, psi]);
                let other = [near(a, home[0]), b, near(c, home[2])];
                let off = |[_, xi, psi]: [f64; 3]| {
                    let found = angles(task, &s, xi, sign);
                    found.map_or(f64::INFINITY, |found| near(found[2] - psi, 0.0).abs())
                };
                let [zeta, xi, psi] =
                    if off(other) < off([zeta, xi, psi]) { other } else { [zeta, xi, psi] };
                // Near their singularity only the sum of the two angles is known, or their difference.
                let follows = angles(task, &s, xi, sign).map_or(psi, |found| near(found[2], psi));
                let rest = if xi.cos() > 0.0 { psi - follows } else { follows - psi };
                [zeta + rest, xi, follows]
            }
        };
        let chosen = task.angles.of_euler(chosen);
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
        let task = manipulator.task();
        // Zero for a displacement along the intersection motion, for which there is no coordinate.
        let home = |i: usize| self.all.get(i).map_or(0.0, |&i| task.coordinates[i].home);
        let subspace = subspace(task, self.section);
        let shifted = |motion: Displacement| self.shifted(manipulator, motion, tau);
        let still = || shifted(subspace.kind.identity());
        let found: [f64; 3] = match self.motion {
            SectionMotion::None => match still() {
                // The rotation about the third direction is that of the first Euler angle.
                Displacement::Spherical(r) => {
                    let [zeta, xi, psi] = task.angles.to_euler([0, 1, 2].map(home));
                    task.angles.of_euler([zeta + atan2(r[(1, 0)], r[(0, 0)]), xi, psi])
                }
                other => of_displacement(&other, home),
            },
            SectionMotion::Turn(s) => {
                let rotation = unit(at[2] - home(2)) * still().planar().rotation.conj();
                let q = if s.x < 0.0 { rotation.conj() } else { rotation };
                of_displacement(
                    &shifted(
                        PlanarDisplacement::along_screw(&s, JointDisplacement::Direction(q)).into(),
                    ),
                    home,
                )
            }
            SectionMotion::Slide(s, given) => self.line(manipulator, s, given, tau).through(at)?,
            SectionMotion::Third => {
                let [_, xi, psi] = task.angles.to_euler([0, 1, 2].map(home));
                return Ok(task.angles.of_euler([at[0], xi, psi]));
            }
            SectionMotion::Axis(s) | SectionMotion::LastAngle(s) => {
                let mut found = angles(task, &s, at[1], sign)?;
                found[0] += match still() {
                    Displacement::Spherical(r) => atan2(r[(1, 0)], r[(0, 0)]),
                    _ => 0.0,
                };
                if let SectionMotion::LastAngle(_) = self.motion {
                    found[0] = at[0];
                }
                task.angles.of_euler(found)
            }
        };
        Ok(self.taken(subspace.kind, at, found))
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
    fn shifted(
        &self,
        manipulator: &Manipulator,
        motion: Displacement,
        tau: JointDisplacement,
    ) -> Displacement {
        let (task, leg) = (manipulator.task(), &manipulator.legs[self.leg]);
        match self.section {
            _ if leg.bridge().is_none_or(|bridge| bridge == self.section) => motion,
            Section::Lower => task.lower_intersection.after(&motion, tau.inverse()),
            Section::Upper => task.upper_intersection.before(&motion, tau),
        }
    }

    /// The line along which a slider with the screw `s` moves the section; this length tells the place on it.
    pub fn line(
        &self,
        manipulator: &Manipulator,
        s: LocalTwist,
        given: usize,
        tau: JointDisplacement,
    ) -> Line {
        let (task, kind) = (manipulator.task(), subspace(manipulator.task(), self.section).kind);
        let home = |i: usize| self.all.get(i).map_or(0.0, |&i| task.coordinates[i].home);
        let [start, end] =
            [kind.identity(), slid(kind, s)].map(|motion| self.shifted(manipulator, motion, tau));
        let mut rates = [0.0; 3];
        let lengths = if kind == SubspaceKind::Planar { 2 } else { 3 };
        for (i, rate) in rates[..lengths].iter_mut().enumerate() {
            *rate = length_of(&end, i) - length_of(&start, i);
        }
        let (home_of_given, from_home) = (home(given), length_of(&start, given));
        let start = of_displacement(&start, home);
        Line { start, rates, given, home: home_of_given, from_home }
    }
}

/// A straight line of coordinates of a section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// The coordinates at its start.
    start: [f64; 3],
    /// Their changes along it.
    rates: [f64; 3],
    /// The number of the coordinate that tells the place.
    given: usize,
    /// Its value at home, and the difference from that at the start.
    home: f64,
    from_home: f64,
}

impl Line {
    /// The coordinates where the given one is that of `at`.
    ///
    /// # Errors
    /// By how much it is missed, where it does not change along the line.
    #[inline(always)]
    pub fn through(&self, at: [f64; 3]) -> Result<[f64; 3], ReachDeficit> {
        let from_start = (at[self.given] - self.home) - self.from_home;
        let rate = self.rates[self.given];
        if rate.abs() < ALONG {
            return Err(ReachDeficit::length(from_start.abs()));
        }
        let q = from_start / rate;
        let [a, b, c] = self.start;
        let [x, y, z] = self.rates;
        Ok([a + q * x, b + q * y, c + q * z])
    }
}

fn subspace(task: &Task, section: Section) -> &Subspace {
    match section {
        Section::Lower => &task.lower,
        Section::Upper => &task.upper,
    }
}

/// The displacement by one unit along the screw of a slider: a translation of a plane, or of space.
#[inline(always)]
fn slid(kind: SubspaceKind, s: LocalTwist) -> Displacement {
    match kind {
        SubspaceKind::Planar => {
            let (rotation, translation) = (Complex::new(1.0, 0.0), linear(&s));
            Displacement::Planar(PlanarDisplacement { rotation, translation })
        }
        _ => kind.exponential(&s),
    }
}

/// One of the lengths among the coordinates of a displacement that has a slider, from home.
#[inline(always)]
fn length_of(g: &Displacement, number: usize) -> f64 {
    match g {
        Displacement::Planar(g) if number == 0 => g.translation.re,
        Displacement::Planar(g) => g.translation.im,
        other => other.spatial()[number],
    }
}

/// The coordinates of a displacement of a section that has all coordinates of its subspace. A rotation about a
/// centre is one about the third direction.
#[inline(always)]
fn of_displacement(g: &Displacement, home: impl Fn(usize) -> f64) -> [f64; 3] {
    match g {
        Displacement::Identity(_) => [0.0; 3],
        Displacement::Planar(g) => {
            let angle = atan2(g.rotation.im, g.rotation.re);
            [home(0) + g.translation.re, home(1) + g.translation.im, home(2) + angle]
        }
        Displacement::Spherical(r) => [home(0) + atan2(r[(1, 0)], r[(0, 0)]), home(1), home(2)],
        Displacement::Cylindrical(g) => [home(0) + g.angle, home(1) + g.advance, 0.0],
        Displacement::Translational(t) => [home(0) + t.re, home(1) + t.im, 0.0],
        Displacement::Spatial(t) => [home(0) + t.x, home(1) + t.y, home(2) + t.z],
    }
}

/// The Euler angles of the platform after the rotation about `s` from home whose second angle is `xi`.
fn angles(task: &Task, s: &LocalTwist, xi: f64, sign: f64) -> Result<[f64; 3], ReachDeficit> {
    match task.home_orientation_inverse() {
        None => from_identity(s, xi, sign),
        Some(inverse) => from_orientation(s, &inverse.transpose(), xi, sign),
    }
}

/// The Euler angles of the rotation about `s` from the identity whose second angle is `xi`. They are continuous
/// through `xi = 0`, where the half angles keep their directions.
fn from_identity(s: &LocalTwist, xi: f64, sign: f64) -> Result<[f64; 3], ReachDeficit> {
    let rho = s.x.hypot(s.y);
    let reduced = near(xi, 0.0);
    let half = (0.5 * reduced).sin() / rho;
    if half.abs() > 1.0 + REACH_TOLERANCE {
        return Err(ReachDeficit::angle(reduced.abs() - 2.0 * rho.min(1.0).asin()));
    }
    let sin = half.clamp(-1.0, 1.0);
    // A rotation by half a turn about a level axis is where the tilt is half a turn, too. The directions are those of
    // its limit.
    let cos = ((1.0 - sin) * (1.0 + sin)).sqrt().max(LEAST);
    // The rotation is by ±q, with these the sine and the cosine of q/2. Its third column and its third row,
    // over 2 sin(q/2), are regular.
    let sin = sign * sin;
    let column = [s.x * s.z * sin + s.y * cos, s.y * s.z * sin - s.x * cos];
    let row = [s.x * s.z * sin - s.y * cos, s.y * s.z * sin + s.x * cos];
    Ok([atan2(sign * column[1], sign * column[0]), xi, atan2(sign * row[1], -sign * row[0])])
}

/// The Euler angles of the rotation about `s` of the orientation `home` whose second angle is `xi`.
fn from_orientation(
    s: &LocalTwist,
    home: &Matrix3<f64>,
    xi: f64,
    sign: f64,
) -> Result<[f64; 3], ReachDeficit> {
    let third = home.column(2).into_owned();
    // cos ξ = c₀ + c₁ cos q + c₂ sin q
    let c0 = s.z * s.dot(&third);
    let z = Complex::new(third.z - c0, s.x * third.y - s.y * third.x);
    let amplitude = z.norm();
    let part = xi.cos() - c0;
    if part.abs() > amplitude + REACH_TOLERANCE {
        let nearest = (c0 + amplitude.copysign(part)).clamp(-1.0, 1.0).acos();
        return Err(ReachDeficit::angle((near(xi, 0.0).abs() - nearest).abs()));
    }
    let upper = if near(xi, 0.0) < 0.0 { -1.0 } else { 1.0 };
    let height = ((amplitude - part) * (amplitude + part)).max(0.0).sqrt();
    let turn = z * Complex::new(part, sign * upper * height);
    let r = rotation_about(s, turn / turn.norm()) * home;
    Ok([
        atan2(upper * r[(1, 2)], upper * r[(0, 2)]),
        xi,
        atan2(upper * r[(2, 1)], -upper * r[(2, 0)]),
    ])
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
                let [zeta, xi, psi] = from_identity(&s, xi, sign).unwrap();
                prop_assert!(keeps(&euler(zeta, xi, psi), &s) < ROUNDING);

                let home = euler(turn, tilt, roll);
                let r = rotation_about(&s, unit(2.0 * share)) * home;
                let xi = r[(2, 2)].acos();
                prop_assume!(xi.sin() > 1e-3);
                for xi in [xi, -xi] {
                    let [zeta, xi, psi] = from_orientation(&s, &home, xi, sign).unwrap();
                    let found = euler(zeta, xi, psi) * home.transpose();
                    prop_assert!(keeps(&found, &s) < 1e3 * ROUNDING, "{}", keeps(&found, &s));
                }
            }
        }
    }
}
