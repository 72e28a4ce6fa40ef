//! The closed forms of planar chains over a box of targets.
//!
//! The joints' places at home are constant or, in a leg whose lift leans, functions of the height over the box.

use super::affine::{Affine, Plane, WIDE};
use super::opening;
use super::share::Share;
use super::target::{Enclosed, PlanarTarget};
use crate::chain::planar::PlanarJoint;
use crate::chain::{Branch, DEGENERATE, REACH_TOLERANCE};
use nalgebra::Complex;
use std::ops::{Add, Mul, Sub};

/// The end of a range without an end.
const INFINITE: f64 = f64::INFINITY;

/// A joint of a planar chain at home: a [`PlanarJoint`] whose place may depend on the box.
#[derive(Clone, Copy, Debug)]
pub enum Joint<Z> {
    /// Rotation about the point `at`; positive clockwise where `reversed`.
    Revolute { at: Z, reversed: bool },
    /// Translation in the direction `along`, a unit vector.
    Prismatic { along: Z },
}

impl From<PlanarJoint> for Joint<Complex<f64>> {
    fn from(joint: PlanarJoint) -> Self {
        match joint {
            PlanarJoint::Revolute { at, reversed } => Self::Revolute { at, reversed },
            PlanarJoint::Prismatic { along } => Self::Prismatic { along },
        }
    }
}

/// A length of a chain, or a product of lengths: constant, or a function over the box.
pub trait Length<const N: usize>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// The number, if it is constant.
    fn constant(self) -> Option<f64>;
    /// The number over the box.
    fn over_box(self) -> Affine<N>;
    /// Half of it.
    fn half(self) -> Self;
    /// The root of a number that is not negative.
    fn sqrt(self) -> Self;
    /// The inverse.
    fn recip(self) -> Self;
    /// The product with a number over the box.
    fn times(self, x: Affine<N>) -> Affine<N>;
    /// The sum with a number over the box.
    fn plus(self, x: Affine<N>) -> Affine<N>;
}

impl<const N: usize> Length<N> for f64 {
    fn constant(self) -> Option<f64> {
        Some(self)
    }

    fn over_box(self) -> Affine<N> {
        Affine::constant(self)
    }

    fn half(self) -> Self {
        0.5 * self
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn recip(self) -> Self {
        1.0 / self
    }

    fn times(self, x: Affine<N>) -> Affine<N> {
        x * self
    }

    fn plus(self, x: Affine<N>) -> Affine<N> {
        x + self
    }
}

impl<const N: usize> Length<N> for Affine<N> {
    fn constant(self) -> Option<f64> {
        None
    }

    fn over_box(self) -> Affine<N> {
        self
    }

    fn half(self) -> Self {
        self * 0.5
    }

    fn sqrt(self) -> Self {
        Self::sqrt(&self)
    }

    fn recip(self) -> Self {
        Self::recip(&self)
    }

    fn times(self, x: Affine<N>) -> Affine<N> {
        x * self
    }

    fn plus(self, x: Affine<N>) -> Affine<N> {
        x + self
    }
}

/// A point or a vector of a chain's plane, as a complex number: constant, or a function over the box.
pub trait Vector<const N: usize>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    type Length: Length<N>;
    /// Its components.
    fn parts(self) -> [Self::Length; 2];
    /// The complex conjugate.
    fn conj(self) -> Self;
    /// The vector over the box.
    fn over_box(self) -> Plane<N>;
    /// The product with a number of its kind.
    fn scaled(self, by: Self::Length) -> Self;
    /// The square of its length.
    fn norm_sqr(self) -> Self::Length;
    /// The product with a complex number over the box.
    fn times(self, z: Plane<N>) -> Plane<N>;
    /// The vector from here to a point over the box.
    fn to(self, z: Plane<N>) -> Plane<N>;
}

impl<const N: usize> Vector<N> for Complex<f64> {
    type Length = f64;

    fn parts(self) -> [f64; 2] {
        [self.re, self.im]
    }

    fn conj(self) -> Self {
        Self { im: -self.im, ..self }
    }

    fn over_box(self) -> Plane<N> {
        Plane::constant(self)
    }

    fn scaled(self, by: f64) -> Self {
        self * by
    }

    fn norm_sqr(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    fn times(self, z: Plane<N>) -> Plane<N> {
        z * self
    }

    fn to(self, z: Plane<N>) -> Plane<N> {
        z - self
    }
}

impl<const N: usize> Vector<N> for Plane<N> {
    type Length = Affine<N>;

    fn parts(self) -> [Affine<N>; 2] {
        [self.re, self.im]
    }

    fn conj(self) -> Self {
        self.conj()
    }

    fn over_box(self) -> Plane<N> {
        self
    }

    fn scaled(self, by: Affine<N>) -> Self {
        self.scaled(by)
    }

    fn norm_sqr(self) -> Affine<N> {
        self.norm_sqr()
    }

    fn times(self, z: Plane<N>) -> Plane<N> {
        z * self
    }

    fn to(self, z: Plane<N>) -> Plane<N> {
        z - self
    }
}

/// The share of a box of targets for which a chain closes, whatever its joints' limits.
pub fn closes<Z: Vector<N>, const N: usize>(
    joints: &[Joint<Z>; 3],
    g: &PlanarTarget<N>,
) -> Share<N> {
    use Joint::{Prismatic, Revolute};
    match *joints {
        [Revolute { at: p1, .. }, Revolute { at: p2, .. }, Revolute { at: p3, .. }] => {
            let arm = Arm::new(p1, p2, p3);
            let nearest = if arm.folds() { -INFINITE } else { -1.0 };
            Share::within(&arm.cosine(&reach(g, p3, p1)), [nearest, 1.0], 0.0)
        }
        [Prismatic { along }, Revolute { at: p2, .. }, Revolute { at: p3, .. }] => {
            let link = (p3 - p2).norm_sqr().sqrt();
            let aside = along.conj().times(reach(g, p3, p2)).im;
            match link.constant() {
                Some(link) => Share::within(&aside, [-link, link], 0.0),
                None => Share::within(&link.recip().times(aside), [-1.0, 1.0], 0.0),
            }
        }
        [Revolute { .. }, Revolute { .. }, Prismatic { .. }] => {
            closes(&backwards(joints), &g.inverse())
        }
        [Revolute { at: p1, .. }, Prismatic { along }, Revolute { at: p3, .. }] => {
            let [_, aside] = ((p3 - p1) * along.conj()).parts();
            let square = reach(g, p3, p1).norm_sqr();
            // The rounding is in proportion to the square on the left.
            match aside.constant() {
                Some(aside) => Share::within(&square, [aside * aside, INFINITE], 0.0),
                None => {
                    let ahead = square - aside.over_box().square();
                    Share::within(&ahead, [0.0, INFINITE], 0.0)
                }
            }
        }
        [Prismatic { along: d1 }, Revolute { .. }, Prismatic { along: d3 }] => {
            // The chain closes everywhere except where the sliders become parallel.
            let crossing = d1.over_box().cross(d3.times(g.rotation));
            Share::outside(&crossing, [-REACH_TOLERANCE, REACH_TOLERANCE])
        }
        // Two sliders that are not parallel reach every place.
        [Revolute { .. }, Prismatic { .. }, Prismatic { .. }]
        | [Prismatic { .. }, Prismatic { .. }, Revolute { .. }] => Share::ALL,
        [Prismatic { .. }, Prismatic { .. }, Prismatic { .. }] => {
            unreachable!("three sliders make no chain")
        }
    }
}

/// The share of a box for which three joints make a chain: no link vanishes, and no sliders become parallel.
pub fn makes_a_chain<const N: usize>(joints: &[Joint<Plane<N>>; 3]) -> Share<N> {
    use Joint::{Prismatic, Revolute};
    // Whether one length is more than a small part of another, by their squares.
    let exceeds = |one: Affine<N>, other: Affine<N>| {
        Share::within(&(one - other * (DEGENERATE * DEGENERATE)), [0.0, INFINITE], 0.0)
    };
    match *joints {
        [Revolute { at: p1, .. }, Revolute { at: p2, .. }, Revolute { at: p3, .. }] => {
            let [a, b] = [p2 - p1, p3 - p2].map(Plane::norm_sqr);
            exceeds(a, b).and(exceeds(b, a))
        }
        [Prismatic { .. }, Revolute { at: p, .. }, Revolute { at: q, .. }]
        | [Revolute { at: p, .. }, Revolute { at: q, .. }, Prismatic { .. }] => {
            Share::within(&(q - p).norm_sqr(), [0.0, INFINITE], 0.0)
        }
        [Revolute { .. }, Prismatic { along: u }, Prismatic { along: v }]
        | [Prismatic { along: u }, Prismatic { along: v }, Revolute { .. }] => {
            Share::outside(&u.cross(v), [-DEGENERATE, DEGENERATE])
        }
        _ => Share::ALL,
    }
}

/// The joints' displacements: see the closed forms of [`crate::chain::planar`]. The bounds hold for those targets of the
/// box for which the chain closes.
pub fn displacements<Z: Vector<N>, const N: usize>(
    joints: &[Joint<Z>; 3],
    g: &PlanarTarget<N>,
    branch: Branch,
) -> [Enclosed<N>; 3] {
    use Joint::{Prismatic, Revolute};
    match *joints {
        [
            Revolute { at: p1, reversed: r1 },
            Revolute { at: p2, reversed: r2 },
            Revolute { at: p3, reversed: r3 },
        ] => {
            let arm = Arm::new(p1, p2, p3);
            let wrist = reach(g, p3, p1);
            let cosine = arm.cosine(&wrist);
            let sine = (-cosine.square() + 1.0).sqrt() * branch.sign();
            let second = arm.straighten.times(Plane { re: cosine, im: sine });
            let (first, turn) = match arm.swing(&wrist, branch) {
                Some(angle) => (angle.unit_vector(), Enclosed::Angle(angle)),
                None => {
                    let straight = arm.first.over_box() + arm.second.times(second);
                    let first = wrist * straight.conj();
                    (first, Enclosed::Direction(first))
                }
            };
            let third = g.rotation * (first * second).conj();
            let turn = if r1 { turn.inverse() } else { turn };
            [turn, turned(r2, second), turned(r3, third)]
        }
        [
            Prismatic { along },
            Revolute { at: p2, reversed: r2 },
            Revolute { at: p3, reversed: r3 },
        ] => {
            let link = p3 - p2;
            let local = along.conj().times(reach(g, p3, p2));
            let square = link.norm_sqr().plus(-local.im.square());
            let root = square.sqrt() * branch.sign();
            let slider = local.re + root;
            let second = (along * link.conj()).times(Plane { re: -root, im: local.im });
            let third = g.rotation * second.conj();
            [Enclosed::Value(slider), turned(r2, second), turned(r3, third)]
        }
        [Revolute { .. }, Revolute { .. }, Prismatic { .. }]
        | [Prismatic { .. }, Prismatic { .. }, Revolute { .. }] => {
            let [a3, a2, a1] = displacements(&backwards(joints), &g.inverse(), branch);
            [a1.inverse(), a2.inverse(), a3.inverse()]
        }
        [
            Revolute { at: p1, reversed: r1 },
            Prismatic { along },
            Revolute { at: p3, reversed: r3 },
        ] => {
            let [ahead_at_home, aside] = ((p3 - p1) * along.conj()).parts();
            let [ahead_at_home, aside] = [ahead_at_home, aside].map(Length::over_box);
            let reach = reach(g, p3, p1);
            let ahead = (reach.norm_sqr() - aside.square()).sqrt() * branch.sign();
            let telescope = along.times(Plane { re: ahead, im: aside });
            let first = reach * telescope.conj();
            let third = g.rotation * first.conj();
            [turned(r1, first), Enclosed::Value(ahead - ahead_at_home), turned(r3, third)]
        }
        [Revolute { at, reversed }, Prismatic { along: u }, Prismatic { along: v }] => {
            // The coordinates `(m, n)` of `z = m u + n v`.
            let z = reach(g, at, at) * g.rotation.conj();
            let [[ur, ui], [vr, vi]] = [u.parts(), v.parts()];
            let over = (ur * vi - ui * vr).recip();
            let m = over.times(z.cross(v.over_box()));
            let n = over.times(u.over_box().cross(z));
            [turned(reversed, g.rotation), Enclosed::Value(m), Enclosed::Value(n)]
        }
        [Prismatic { along: d1 }, Revolute { at, reversed }, Prismatic { along: d3 }] => {
            let moved = reach(g, at, at);
            let (first, second) = (d1.over_box(), d3.times(g.rotation));
            let inverse = first.cross(second).recip();
            [
                Enclosed::Value(moved.cross(second) * inverse),
                turned(reversed, g.rotation),
                Enclosed::Value(first.cross(moved) * inverse),
            ]
        }
        [Prismatic { .. }, Prismatic { .. }, Prismatic { .. }] => {
            unreachable!("three sliders make no chain")
        }
    }
}

/// The displacement of a revolute for a rotation to the direction of `r`.
fn turned<const N: usize>(reversed: bool, r: Plane<N>) -> Enclosed<N> {
    Enclosed::Direction(if reversed { r.conj() } else { r })
}

/// The vector from `from` to the place of the pivot that is at `at` at home.
fn reach<Z: Vector<N>, const N: usize>(g: &PlanarTarget<N>, at: Z, from: Z) -> Plane<N> {
    from.to(at.times(g.rotation) + g.translation)
}

/// The joints of the reversed chain.
fn backwards<Z: Copy>(&[first, second, third]: &[Joint<Z>; 3]) -> [Joint<Z>; 3] {
    [third, second, first]
}

/// The two links of an arm.
struct Arm<Z: Vector<N>, const N: usize> {
    first: Z,
    second: Z,
    straighten: Z,
    mean_square: Z::Length,
    product: Z::Length,
}

impl<Z: Vector<N>, const N: usize> Arm<Z, N> {
    fn new(p1: Z, p2: Z, p3: Z) -> Self {
        let (first, second) = (p2 - p1, p3 - p2);
        let (a, b) = (first.norm_sqr(), second.norm_sqr());
        let product = (a * b).sqrt();
        Self {
            first,
            second,
            straighten: (first * second.conj()).scaled(product.recip()),
            mean_square: (a + b).half(),
            product,
        }
    }

    /// Whether the links are always equally long, so that no target is too near.
    fn folds(&self) -> bool {
        match (self.mean_square.constant(), self.product.constant()) {
            (Some(mean_square), Some(product)) => {
                mean_square / product <= 1.0 + 0.5 * REACH_TOLERANCE
            }
            _ => false,
        }
    }

    /// The angle by which the first link turns, from the directions of the wrist and of the link and the angle between
    /// them; `None` where that is not known well.
    fn swing(&self, wrist: &Plane<N>, branch: Branch) -> Option<Affine<N>> {
        let [re, im] = self.first.parts().map(Length::constant);
        let home = Complex::new(re?, im?).arg();
        let squares = [self.first, self.second].map(|link| link.norm_sqr().constant());
        let opening = opening::planar(wrist.norm_sqr(), [squares[0]?, squares[1]?])?;
        let angle = wrist.argument() - opening * branch.sign() - home;
        (angle.radius() <= WIDE).then_some(angle)
    }

    fn cosine(&self, wrist: &Plane<N>) -> Affine<N> {
        let square = wrist.norm_sqr() * 0.5 - self.mean_square.over_box();
        self.product.recip().times(square)
    }
}
