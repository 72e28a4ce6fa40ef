//! The closed forms of the chains over a box of targets: the share of the targets for which a chain closes,
//! and the joints' displacements where it does.

use super::affine::{Affine, Plane, WIDE};
use super::planar::{self, Joint};
use super::share::Share;
use super::target::{Enclosed, Rotation, Target, dot};
use crate::chain::cylindrical::CoaxialJoint;
use crate::chain::spherical::{Ball, SphericalChain};
use crate::chain::{Branch, Chain, REACH_TOLERANCE};
use nalgebra::{Complex, Vector3};

/// Nearer to the boundary of reach than this fraction, the second derivative of an angle of a triangle is too
/// large for a useful bound.
const NEAR_BOUNDARY: f64 = 1e-3;

/// The end of a range without an end.
const INFINITE: f64 = f64::INFINITY;

/// The share of a box of targets for which a chain closes, whatever its joints' limits.
pub fn closes<const N: usize>(chain: &Chain, target: &Target<N>) -> Share<N> {
    match chain {
        Chain::Planar(chain) => planar::closes(&chain.joints().map(Joint::from), target.planar()),
        Chain::Spherical(chain) => Arcs::new(chain).closes(target.spherical()),
        // No joints reach the identity, a spherical joint reaches every rotation, and linear chains have one solution
        // everywhere.
        Chain::Rigid
        | Chain::Ball(_)
        | Chain::Cylindrical(_)
        | Chain::Translational(_)
        | Chain::Spatial(_) => Share::ALL,
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
        Chain::Planar(chain) => {
            planar::displacements(&chain.joints().map(Joint::from), target.planar(), branch)
        }
        Chain::Spherical(chain) => spherical(chain, target.spherical(), branch),
        Chain::Ball(ball) => self::ball(ball, target.spherical()),
        Chain::Cylindrical(chain) => {
            let [angle, advance] = target.cylindrical();
            let [p, q] = *chain.joints();
            let determinant = p.rotation * q.advance - q.rotation * p.advance;
            let displacement = |joint: CoaxialJoint, by_angle: f64, by_advance: f64| {
                let value = angle * (by_angle / determinant) + advance * (by_advance / determinant);
                let revolute = joint.rotation != 0.0 && joint.advance == 0.0;
                if revolute { Enclosed::Angle(value) } else { Enclosed::Value(value) }
            };
            [displacement(p, q.advance, -q.rotation), displacement(q, -p.advance, p.rotation), none]
        }
        Chain::Translational(chain) => {
            let [m, n] = along(*chain.slides(), *target.translational());
            [Enclosed::Value(m), Enclosed::Value(n), none]
        }
        Chain::Spatial(chain) => {
            chain.coefficients().map(|row| Enclosed::Value(dot(&row, target.spatial())))
        }
    }
}

/// The coordinates `(m, n)` of `z = m u + n v`.
fn along<const N: usize>([u, v]: [Complex<f64>; 2], z: Plane<N>) -> [Affine<N>; 2] {
    let crossing = u.re * v.im - u.im * v.re;
    [z.cross(Plane::constant(v)) * (1.0 / crossing), Plane::constant(u).cross(z) * (1.0 / crossing)]
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

    /// The angle at `a₁` between the planes of `a₂` and of `w`: `cos ψ = (cos a₂₃ - z cos a₁₂) / (sin a₁₂
    /// √(1 - z²))`. It depends on one number, so that its second derivative can be bounded; `None` where
    /// the bounds are wide, near the boundary of reach and the poles.
    fn opening<const N: usize>(&self, z: Affine<N>) -> Option<Affine<N>> {
        let [c12, c23] = self.cosines;
        let (middle, half) = (c12 * c23, self.sines[0] * self.sines[1]);
        let ends = [z.low(), z.high()];
        // Concave, with their largest values in the middle.
        let square = |z: f64| (1.0 - z) * (1.0 + z);
        let gram = |z: f64| (half - (z - middle)) * (half + (z - middle));
        let range = |f: &dyn Fn(f64) -> f64, top: f64| {
            let [a, b] = ends.map(f);
            [a.min(b), f(top.clamp(ends[0], ends[1]))]
        };
        let (squares, grams) = (range(&square, 0.0), range(&gram, middle));
        if !(squares[0] > NEAR_BOUNDARY && grams[0] > NEAR_BOUNDARY * half * half) {
            return None;
        }
        let times = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
            let all = [a * c, a * d, b * c, b * d];
            [all.into_iter().fold(INFINITE, f64::min), all.into_iter().fold(-INFINITE, f64::max)]
        };
        let over = |[least, most]: [f64; 2]| [1.0 / most, 1.0 / least];
        let numerator = |z: f64| c12 - c23 * z;
        let [p, q] = ends.map(numerator);
        let numerators = [p.min(q), p.max(q)];
        // ψ' = n / (s √g) and ψ'' = (-cos a₂₃ + 2 n z/s + n (z - m)/g) / (s √g).
        let first = times(times(numerators, ends), over(squares)).map(|x| 2.0 * x);
        let second = times(times(numerators, ends.map(|z| z - middle)), over(grams));
        let sum = [0, 1].map(|i| first[i] + second[i] - c23);
        let weight = over([0, 1].map(|i| squares[i] * grams[i].sqrt()));
        let root = gram(z.centre).sqrt();
        let value = root.atan2(c23 - c12 * z.centre);
        let slope = numerator(z.centre) / (square(z.centre) * root);
        Some(z.bent([value, slope], times(sum, weight)))
    }

    /// The first joint's rotation, with `w = R a₃`: `(A + iB)(d - i√(A² + B² - d²)) / (A² + B²)`, as the sum of
    /// two angles where they are known.
    fn first<const N: usize>(&self, w: &[Affine<N>; 3], branch: Branch) -> Enclosed<N> {
        let z = dot(&self.first, w);
        let [x, y] = self.second_on_first;
        let azimuth = Plane { re: dot(&x, w), im: dot(&y, w) };
        if let Some(opening) = self.opening(z) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(50_000))]

        /// The angle at the base of a spherical triangle with two sides given, over a range of the third.
        #[test]
        fn openings_hold(
            arcs in [0.1..3.0_f64, 0.1..3.0_f64],
            share in -0.99..0.99_f64,
            half in prop_oneof![Just(1e-3), Just(1e-2), Just(0.1), Just(0.5)],
            at in prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0_f64],
        ) {
            let [a, b] = arcs;
            let axis = |angle: f64| Vector3::new(angle.sin(), 0.0, angle.cos());
            let arcs = Arcs::of(axis(0.0), axis(a), axis(a + b));
            // Where the triangle closes.
            let middle = a.cos() * b.cos() + share * a.sin() * b.sin();
            let z = Affine::<1>::coordinate(middle, half * (1.0 - share.abs()), 0);
            if let Some(opening) = arcs.opening(z) {
                let to = (z.centre + z.slope[0] * at).acos();
                let angle = ((b.cos() - a.cos() * to.cos()) / (a.sin() * to.sin())).acos();
                let off = (opening.centre + opening.slope[0] * at - angle).abs();
                prop_assert!(off <= opening.total_error() + 1e-12, "{off} {opening:?}");
            }
        }
    }
}
