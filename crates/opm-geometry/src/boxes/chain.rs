//! The closed forms of the chains over a box of targets: the share of the targets for which a chain closes,
//! and the joints' displacements where it does.

use super::affine::{Affine, Plane, WIDE};
use super::opening;
use super::share::Share;
use super::target::{Enclosed, Rotation, Target, dot};
use crate::chain::spherical::{Ball, SphericalChain};
use crate::chain::{Branch, Chain, ClosedForm, Closes, REACH_TOLERANCE};
use crate::numbers::Tolerance;
use nalgebra::{Complex, Vector3};

/// The end of a range without an end.
const INFINITE: f64 = f64::INFINITY;

/// The share for which there is a solution, by what decides that, to within a tolerance.
pub fn share<const N: usize>(closes: &Closes<Affine<N>>, tolerance: f64) -> Share<N> {
    match closes {
        Closes::Always => Share::ALL,
        Closes::Within(number, range) => Share::within(number, *range, tolerance),
        Closes::Exceeds(number, Tolerance { share, .. }) => {
            Share::outside(number, [-share, *share])
        }
    }
}

/// The share of a box of targets for which a chain closes, whatever its joints' limits.
pub fn closes<const N: usize>(chain: &Chain, target: &Target<N>) -> Share<N> {
    match chain {
        Chain::Planar(chain) => share(&chain.closes(target.planar()), 0.0),
        Chain::Spherical(chain) => Arcs::new(chain).closes(target.spherical()),
        // No joints reach the identity, a spherical joint reaches every rotation, and linear chains have one solution
        // everywhere.
        Chain::Rigid
        | Chain::Ball(_)
        | Chain::Cylindrical(_)
        | Chain::Translational(_)
        | Chain::Spatial(_) => Share::ALL,
        // Nothing is known of a part by itself.
        Chain::Part(_) => Share::ANY,
    }
}

/// The joints' displacements. The bounds hold for those targets of the box for which the chain closes.
pub fn displacements<const N: usize>(
    chain: &Chain,
    target: &Target<N>,
    branch: Branch,
) -> [Enclosed<N>; 3] {
    let none = Enclosed::Value(Affine::constant(0.0));
    match chain {
        Chain::Rigid => [none; 3],
        Chain::Part(_) => [Enclosed::Value(Affine::constant(f64::NAN)); 3],
        Chain::Planar(chain) => solved(chain, target.planar(), branch),
        Chain::Spherical(chain) => spherical(chain, target.spherical(), branch),
        Chain::Ball(ball) => self::ball(ball, target.spherical()),
        Chain::Cylindrical(chain) => {
            let [p, q] = chain.coordinates(target.cylindrical());
            let displacement = |joint, value| match chain.revolute() == Some(joint) {
                true => Enclosed::Angle(value),
                false => Enclosed::Value(value),
            };
            [displacement(0, p), displacement(1, q), none]
        }
        Chain::Translational(chain) => solved(chain, target.translational(), branch),
        Chain::Spatial(chain) => {
            chain.coefficients().map(|row| Enclosed::Value(dot(&row, target.spatial())))
        }
    }
}

/// The displacements that a chain's closed form gives.
pub fn solved<C: ClosedForm<Affine<N>>, const N: usize>(
    chain: &C,
    target: &C::Target,
    branch: Branch,
) -> [Enclosed<N>; 3] {
    chain.attempt(target, branch.sign()).displacements
}

/// The two arcs of a spherical chain, whose first two joints depend on `z = a₁ · R a₃`.
struct Arcs {
    first: Vector3<f64>,
    third: Vector3<f64>,
    /// The component of `a₂` perpendicular to `a₁`, and `a₁ × a₂`.
    second_on_first: [Vector3<f64>; 2],
    /// The cosines of the arcs from `a₁` to `a₂` and from `a₂` to `a₃`.
    cosines: [f64; 2],
    sines: [f64; 2],
}

impl Arcs {
    fn new(chain: &SphericalChain) -> Self {
        let [a1, a2, a3] = *chain.axes();
        Self::of(a1, a2, a3)
    }

    fn of(a1: Vector3<f64>, a2: Vector3<f64>, a3: Vector3<f64>) -> Self {
        Self {
            first: a1,
            third: a3,
            second_on_first: [a2 - a1 * a1.dot(&a2), a1.cross(&a2)],
            cosines: [a1.dot(&a2), a2.dot(&a3)],
            sines: [a1.cross(&a2).norm(), a2.cross(&a3).norm()],
        }
    }

    /// The share for which the chain closes: `|z - cos a₁₂ cos a₂₃| <= sin a₁₂ sin a₂₃`. Arcs that are equal, or
    /// sum up to π, have no limit at that pole.
    fn closes<const N: usize>(&self, r: &Rotation<N>) -> Share<N> {
        let [c12, c23] = self.cosines;
        let (middle, half) = (c12 * c23, self.sines[0] * self.sines[1]);
        let pole = 0.5 * REACH_TOLERANCE;
        let far = if (c23 + c12).abs() <= pole { -INFINITE } else { middle - half };
        let near = if (c23 - c12).abs() <= pole { INFINITE } else { middle + half };
        // The chain's tolerance is REACH_TOLERANCE in the cosine that it solves for, which is more in z where the
        // second arc is short.
        let slack = 4.0 * REACH_TOLERANCE / self.sines[1];
        let z = dot(&self.first, &r.apply(&self.third));
        Share::within(&z, [far, near], slack)
    }

    /// The cosine of the dihedral angle at `a₂`, over the sines of its arcs, and the sine.
    fn dihedral<const N: usize>(&self, z: Affine<N>) -> [Affine<N>; 2] {
        let over = 1.0 / (self.sines[0] * self.sines[1]);
        let cosine = (z - self.cosines[0] * self.cosines[1]) * over;
        [cosine, (-cosine.square() + 1.0).sqrt()]
    }

    /// The first joint's rotation, with `w = R a₃`: `(A + iB)(d - i√(A² + B² - d²)) / (A² + B²)`, as the sum of
    /// two angles where they are known.
    fn first<const N: usize>(&self, w: &[Affine<N>; 3], branch: Branch) -> Enclosed<N> {
        let z = dot(&self.first, w);
        let [x, y] = self.second_on_first;
        let azimuth = Plane { re: dot(&x, w), im: dot(&y, w) };
        if let Some(opening) = opening::spherical(z, self.cosines, self.sines) {
            let angle = azimuth.argument() - opening * branch.sign();
            if angle.radius() <= WIDE {
                return Enclosed::Angle(angle);
            }
        }
        let d = -z * self.cosines[0] + self.cosines[1];
        let root = self.dihedral(z)[1] * (self.sines[0] * self.sines[1] * -branch.sign());
        let square = (-z.square() + 1.0) * (self.sines[0] * self.sines[0]);
        Enclosed::UnitDirection((azimuth * Plane { re: d, im: root }).divided(square.recip()))
    }
}

/// The joints' displacements of a spherical chain: the first from `R a₃`, the third likewise from `Rᵀ a₁` and
/// the reversed chain, the second from the dihedral angle between the arcs.
fn spherical<const N: usize>(
    chain: &SphericalChain,
    r: &Rotation<N>,
    branch: Branch,
) -> [Enclosed<N>; 3] {
    let [a1, a2, a3] = *chain.axes();
    let arcs = Arcs::of(a1, a2, a3);
    let w = r.apply(&a3);
    let first = arcs.first(&w, branch);
    let [cosine, sine] = arcs.dihedral(dot(&a1, &w));
    let third_off_second = a3 - a2 * a2.dot(&a3);
    let aim = Complex::new(a1.dot(&third_off_second), a1.dot(&a2.cross(&a3)));
    let second = Plane { re: cosine, im: sine * -branch.sign() } * aim;
    let other = match branch {
        Branch::Plus => Branch::Minus,
        Branch::Minus => Branch::Plus,
    };
    let third = Arcs::of(a3, a2, a1).first(&r.apply_back(&a1), other).inverse();
    [first, Enclosed::Direction(second), third]
}

/// The rotation vector: its sine, `a` of `R - Rᵀ = 2 [a]`, times `θ / sin θ`.
fn ball<const N: usize>(ball: &Ball, r: &Rotation<N>) -> [Enclosed<N>; 3] {
    let m = &r.0;
    let cosine = (m[0][0] + m[1][1] + m[2][2] - 1.0) * 0.5;
    let ratio = cosine.angle_over_sine();
    let sine = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    [0, 1, 2].map(|i| {
        let row = ball.axes.row(i).transpose();
        Enclosed::Value(dot(&row, &sine) * 0.5 * ratio)
    })
}
