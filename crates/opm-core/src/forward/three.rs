//! Three conditions on a displacement of a planar or a spherical subspace: the forward kinematics of a
//! planar 3-RRR or 3-PRR and its relatives, and of a spherical 3-RRR.
//!
//! All displacements that satisfy one circle or cone are given by two angles: `g = D · R(θ) · K · R(φ) · E`,
//! a rotation by θ about the fixed point or direction and one by φ about the carried one. The two other
//! conditions are then linear in `1, cos φ, sin φ`, with coefficients that are linear in `1, cos θ, sin θ`.
//! Eliminating φ leaves one trigonometric polynomial of degree four in θ. It has at most eight roots, or six
//! in a planar subspace, where the highest coefficient vanishes. Three lines in a plane are linear in the
//! translation instead, and θ is the rotation.

use super::trigonometric::{Quadratic, Roots, Trigonometric};
use crate::chain::condition::{Condition, QUARTER, dot, length};
use crate::group::{PlanarDisplacement, Spherical, Subgroup};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Matrix3, Vector3};

/// The displacements that satisfy three conditions.
#[derive(Clone, Debug, PartialEq)]
pub enum Solutions<G> {
    /// Finitely many displacements, or none.
    At(Vec<G>),
    /// The conditions are not independent: a continuous motion satisfies them, or nothing does.
    Dependent,
}

/// A solution for φ belongs to a root in θ if it misses the second equation by no more than this share of
/// its terms. A double root in θ has an error of up to the square root of rounding; a wrong φ misses by far
/// more, or is so near that polishing leads to the right solution.
const BELONGS: f64 = 1e-5;

/// Two solutions nearer to each other than this, in radians and shares of the size, are one. A double root is
/// only known to about the square root of rounding.
const SAME: f64 = 1e-7;

/// The longest polishing step, in radians and shares of the size. A longer one comes from a singular
/// derivative.
const LONGEST_STEP: f64 = 0.1;

/// The largest number of polishing steps. Each squares an error that is already small. At a root of higher order, which is
/// known to a root of rounding, it leaves half of the error or three quarters.
const POLISH: usize = 40;

/// The conditions are met to rounding, in radians and shares of the size: there is nothing to polish.
const POLISHED: f64 = 1e-15;

/// How often a polishing step is halved at most that does not come closer, as long as the conditions are not met: between
/// roots that are near to each other, steps are too long.
const HALVINGS: usize = 6;

/// The largest number of steps from a displacement that is near, but does not satisfy the conditions.
const NEAR_STEPS: usize = 8;

/// What the conditions are missed by at most where such steps have converged, in radians and shares of the size: the
/// rounding of some hundred operations.
const MET: f64 = 1e-13;

/// An equation in θ (rows: 1, cos, sin) and φ (columns: 1, cos, sin).
#[derive(Clone, Copy, Debug)]
struct Bilinear {
    /// The coefficients, row by row.
    coefficients: Matrix3<f64>,
    /// The size of the terms whose differences the coefficients are.
    size: f64,
}

/// A group in which three conditions are solved, with lengths over the mechanism's size.
pub trait Group: Copy {
    /// The error of a condition, and its derivative by a small step: a rotation and a translation in a
    /// plane, a rotation vector in a spherical subspace.
    fn error(&self, condition: &Condition) -> (f64, Vector3<f64>);
    /// The displacement after a small step.
    fn moved(&self, step: &Vector3<f64>) -> Self;
    /// The distance from another displacement.
    fn distance(&self, other: &Self) -> f64;
}

impl Group for PlanarDisplacement {
    fn error(&self, condition: &Condition) -> (f64, Vector3<f64>) {
        let at = |z: Complex<f64>, along: Complex<f64>| {
            // d(rotation z + translation) = i dω (rotation z) + dt
            Vector3::new(dot(along, QUARTER * self.rotation * z), along.re, along.im)
        };
        match *condition {
            Condition::Circle { point, centre, radius } => {
                let z = self.apply(point) - centre;
                (0.5 * (z.norm_sqr() - radius * radius), at(point, z))
            }
            Condition::Line { point, normal, offset } => {
                (dot(normal, self.apply(point)) - offset, at(point, normal))
            }
            Condition::CarriedLine { point, normal, offset } => {
                let normal = self.rotation * normal;
                let z = point - self.translation;
                let slope = Vector3::new(dot(QUARTER * normal, z), -normal.re, -normal.im);
                (dot(normal, z) - offset, slope)
            }
            Condition::Heading { rotation } => (
                (rotation.conj() * self.rotation).im,
                Vector3::new(dot(rotation, self.rotation), 0.0, 0.0),
            ),
            Condition::Cone { .. } | Condition::Flat { .. } => condition.not_planar(),
        }
    }

    fn moved(&self, step: &Vector3<f64>) -> Self {
        let rotation = self.rotation * unit(step.x);
        let translation = self.translation + Complex::new(step.y, step.z);
        Self { rotation: rotation / length(rotation), translation }
    }

    fn distance(&self, other: &Self) -> f64 {
        length(self.rotation - other.rotation) + length(self.translation - other.translation)
    }
}

impl Group for Matrix3<f64> {
    fn error(&self, condition: &Condition) -> (f64, Vector3<f64>) {
        let (fixed, carried, cosine) = condition.cone();
        let [x, y, z] = [carried.x, carried.y, carried.z];
        let along = |i: usize| self[(i, 0)] * x + self[(i, 1)] * y + self[(i, 2)] * z;
        let (a, b, c) = (along(0), along(1), along(2));
        let error = fixed.x * a + fixed.y * b + fixed.z * c - cosine;
        let slope =
            [b * fixed.z - c * fixed.y, c * fixed.x - a * fixed.z, a * fixed.y - b * fixed.x];
        (error, slope.into())
    }

    fn moved(&self, step: &Vector3<f64>) -> Self {
        Spherical::product(&Spherical::exponential(step), self)
    }

    #[inline(always)]
    fn distance(&self, other: &Self) -> f64 {
        let squares = self.as_slice().iter().zip(other.as_slice());
        squares.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }
}

/// The rotations that satisfy three cone conditions.
pub fn spherical(conditions: &[Condition; 3]) -> Solutions<Matrix3<f64>> {
    let cone = |i: usize| conditions[i].cone();
    // The widest cone is the best to parametrise.
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| cone(a).2.abs().total_cmp(&cone(b).2.abs()));
    solve(&order, |first, found| on_cone(conditions, first, cone, found))
}

/// Finds solutions by satisfying the condition number `first`, a cone, with two angles.
fn on_cone(
    conditions: &[Condition; 3],
    first: usize,
    cone: impl Fn(usize) -> (Vector3<f64>, Vector3<f64>, f64),
    found: &mut Vec<Matrix3<f64>>,
) -> Elimination {
    let (fixed, carried, level) = cone(first);
    let (from, to) = (triad(&fixed), triad(&carried));
    let sine = (1.0 - level * level).max(0.0).sqrt();
    // R = from · Rz(θ) · tilt · Rz(φ) · toᵀ, where the tilt is a rotation about y with this cosine and sine.
    let rest = [(first + 1) % 3, (first + 2) % 3].map(|i| {
        let (fixed, carried, cosine) = cone(i);
        let (f, c) = (in_frame(&from, &fixed), in_frame(&to, &carried));
        // Rz(−θ) f · tilt Rz(φ) c
        let coefficients = Matrix3::new(
            f.z * level * c.z - cosine,
            -f.z * sine * c.x,
            f.z * sine * c.y,
            f.x * sine * c.z,
            f.x * level * c.x + f.y * c.y,
            f.y * c.x - f.x * level * c.y,
            f.y * sine * c.z,
            f.y * level * c.x - f.x * c.y,
            -f.y * level * c.y - f.x * c.x,
        );
        Bilinear { coefficients, size: 1.0 }
    });
    let back = to.transpose();
    let place = |theta: Complex<f64>, phi: Complex<f64>| {
        let first = turned(&from, [0, 1], theta);
        let tilted = turned(&first, [2, 0], Complex::new(level, sine));
        turned(&tilted, [0, 1], phi) * back
    };
    eliminate_angle(&rest, conditions, place, found)
}

/// The components of a vector along the directions of a frame.
#[inline(always)]
fn in_frame(frame: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let along = |i: usize| frame[(0, i)] * v.x + frame[(1, i)] * v.y + frame[(2, i)] * v.z;
    Vector3::new(along(0), along(1), along(2))
}

/// A frame after a rotation about one of its own directions, the one that is not named, by the angle of a unit complex
/// number.
#[inline(always)]
fn turned(frame: &Matrix3<f64>, [from, to]: [usize; 2], e: Complex<f64>) -> Matrix3<f64> {
    let (a, b) = (frame.column(from), frame.column(to));
    let mut turned = *frame;
    turned.set_column(from, &(a * e.re + b * e.im));
    turned.set_column(to, &(b * e.re - a * e.im));
    turned
}

/// A right-handed frame whose third direction is `axis`.
fn triad(axis: &Vector3<f64>) -> Matrix3<f64> {
    let other = if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = (other - axis * axis.dot(&other)).normalize();
    Matrix3::from_columns(&[first, axis.cross(&first), *axis])
}

/// The displacements of the plane that satisfy three conditions. Lengths are over the mechanism's size.
pub fn planar(conditions: &[Condition; 3]) -> Solutions<PlanarDisplacement> {
    let radius = |i: usize| match conditions[i] {
        Condition::Circle { radius, .. } => radius,
        Condition::Line { .. }
        | Condition::CarriedLine { .. }
        | Condition::Heading { .. }
        | Condition::Cone { .. }
        | Condition::Flat { .. } => f64::NEG_INFINITY,
    };
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| radius(b).total_cmp(&radius(a)));
    let circles = order.iter().filter(|&&i| radius(i) >= 0.0).count();
    match circles {
        0 => lines(conditions),
        _ => solve(&order[..circles], |first, found| from_circle(conditions, first, found)),
    }
}

/// Finds solutions by satisfying the condition number `first`, a circle, with two angles.
fn from_circle(
    conditions: &[Condition; 3],
    first: usize,
    found: &mut Vec<PlanarDisplacement>,
) -> Elimination {
    let Condition::Circle { point, centre, radius } = conditions[first] else {
        unreachable!("`planar` eliminates with circles only")
    };
    // g point = centre + radius e(θ), where g rotates by e(φ).
    let rest = [(first + 1) % 3, (first + 2) % 3]
        .map(|i| on_circle(&conditions[i], point, centre, radius));
    let place = |theta: Complex<f64>, phi: Complex<f64>| PlanarDisplacement {
        rotation: phi,
        translation: centre + theta * radius - phi * point,
    };
    eliminate_angle(&rest, conditions, place, found)
}

/// A condition on a body that is rotated by `e(φ)` and whose `point` is at `centre + radius e(θ)`.
fn on_circle(
    condition: &Condition,
    point: Complex<f64>,
    centre: Complex<f64>,
    radius: f64,
) -> Bilinear {
    // Terms like Re(z e(θ)) are written as coefficients of 1, cos and sin.
    let mut bilinear = Matrix3::zeros();
    let mut theta = |z: Complex<f64>| {
        bilinear[(1, 0)] += z.re;
        bilinear[(2, 0)] -= z.im;
    };
    let size = match *condition {
        Condition::Circle { point: other, centre: aim, radius: reach } => {
            // |C + a e(θ) + d e(φ)|² = reach²
            let (c, d) = (centre - aim, other - point);
            theta(2.0 * radius * c.conj());
            let z = 2.0 * c.conj() * d;
            let mixed = 2.0 * radius * d;
            bilinear[(0, 0)] = c.norm_sqr() + radius * radius + d.norm_sqr() - reach * reach;
            bilinear[(0, 1)] = z.re;
            bilinear[(0, 2)] = -z.im;
            // Re(d e(φ − θ))
            bilinear[(1, 1)] = mixed.re;
            bilinear[(2, 2)] = mixed.re;
            bilinear[(1, 2)] = -mixed.im;
            bilinear[(2, 1)] = mixed.im;
            (length(c) + radius + length(d) + reach).powi(2)
        }
        Condition::Line { point: other, normal, offset } => {
            theta(radius * normal.conj());
            let z = normal.conj() * (other - point);
            bilinear[(0, 0)] = dot(normal, centre) - offset;
            bilinear[(0, 1)] = z.re;
            bilinear[(0, 2)] = -z.im;
            centre.norm() + offset.abs() + radius + z.norm()
        }
        Condition::CarriedLine { point: aim, normal, offset } => {
            // normal · (e(−φ) (aim − centre − a e(θ)) + point) = offset
            let z = normal * (aim - centre).conj();
            let mixed = -radius * normal;
            bilinear[(0, 0)] = dot(normal, point) - offset;
            bilinear[(0, 1)] = z.re;
            bilinear[(0, 2)] = -z.im;
            // Re(normal e(φ − θ))
            bilinear[(1, 1)] = mixed.re;
            bilinear[(2, 2)] = mixed.re;
            bilinear[(1, 2)] = -mixed.im;
            bilinear[(2, 1)] = mixed.im;
            point.norm() + offset.abs() + radius + z.norm()
        }
        Condition::Heading { rotation } => {
            bilinear[(0, 1)] = -rotation.im;
            bilinear[(0, 2)] = rotation.re;
            1.0
        }
        Condition::Cone { .. } | Condition::Flat { .. } => condition.not_planar(),
    };
    Bilinear { coefficients: bilinear, size }
}

/// What one elimination has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Elimination {
    /// All solutions.
    All,
    /// Some roots are nearly double, so that solutions may be missing.
    Doubtful,
    /// The conditions are not independent.
    Dependent,
}

/// Eliminates with one condition after the other as the first one, until no solutions can be missing. Two
/// solutions with equal or nearly equal θ are a double root of one polynomial, but as a rule not of the
/// others.
fn solve<G: Group>(
    order: &[usize],
    eliminate: impl Fn(usize, &mut Vec<G>) -> Elimination,
) -> Solutions<G> {
    let mut found = Vec::with_capacity(8);
    for &first in order {
        match eliminate(first, &mut found) {
            Elimination::All => break,
            Elimination::Doubtful => {}
            Elimination::Dependent => return Solutions::Dependent,
        }
    }
    Solutions::At(found)
}

/// Solves two equations in two angles, and adds the solutions to `found`.
fn eliminate_angle<G: Group>(
    rest: &[Bilinear; 2],
    conditions: &[Condition; 3],
    place: impl Fn(Complex<f64>, Complex<f64>) -> G,
    found: &mut Vec<G>,
) -> Elimination {
    let [[c1, a1, b1], [c2, a2, b2]]: [[[f64; 3]; 3]; 2] =
        rest.each_ref().map(|equation| equation.coefficients.into());
    // Two equations a cos φ + b sin φ + c = 0 give cos φ = x / z and sin φ = y / z.
    let minor = |p, q, r, s| Quadratic::product(p, q).minus(&Quadratic::product(r, s));
    let x = minor(&b1, &c2, &b2, &c1);
    let y = minor(&c1, &a2, &c2, &a1);
    let z = minor(&a1, &b2, &a2, &b1);
    let polynomial = x.square().plus(&y.square()).minus(&z.square());
    let product = rest[0].size * rest[1].size;
    let Roots::At { roots, doubtful } = polynomial.roots(product * product) else {
        return Elimination::Dependent;
    };
    for theta in roots {
        let at = |[constant, cos, sin]: [f64; 3]| constant + cos * theta.re + sin * theta.im;
        let equations = [[at(a1), at(b1), at(c1)], [at(a2), at(b2), at(c2)]];
        for phi in common(&equations, [rest[0].size, rest[1].size]).into_iter().flatten() {
            collect(polish(place(theta, phi), conditions), found);
        }
    }
    if doubtful { Elimination::Doubtful } else { Elimination::All }
}

/// The unit complex numbers `e(φ)` that satisfy two equations `a cos φ + b sin φ + c = 0`, not both of which
/// are trivial.
fn common(equations: &[[f64; 3]; 2], sizes: [f64; 2]) -> [Option<Complex<f64>>; 2] {
    let weight =
        |i: usize| (equations[i][0].powi(2) + equations[i][1].powi(2)) / (sizes[i] * sizes[i]);
    let better = usize::from(weight(1) > weight(0));
    let [a, b, c] = equations[better];
    let square = a * a + b * b;
    if square == 0.0 || !square.is_finite() {
        return [None; 2];
    }
    let square_of_root = square - c * c;
    if square_of_root < -BELONGS * sizes[better] * sizes[better] {
        return [None; 2];
    }
    let root = square_of_root.max(0.0).sqrt();
    let [p, q, r] = equations[1 - better];
    [1.0, -1.0].map(|sign| {
        let phi = Complex::new(a, b) * Complex::new(-c, sign * root) / square;
        let phi = phi / length(phi);
        let miss = (p * phi.re + q * phi.im + r).abs();
        (miss <= BELONGS * sizes[1 - better]).then_some(phi)
    })
}

/// Solves three conditions without a circle. They are equations `n · t + m = 0` in the translation `t`, which
/// have a solution if their determinant vanishes. That is a trigonometric polynomial in the rotation.
fn lines(conditions: &[Condition; 3]) -> Solutions<PlanarDisplacement> {
    let rows = conditions.map(|condition| match condition {
        Condition::Line { point, normal, offset } => {
            let z = normal.conj() * point;
            [[normal.re, 0.0, 0.0], [normal.im, 0.0, 0.0], [-offset, z.re, -z.im]]
        }
        Condition::CarriedLine { point, normal, offset } => {
            // (e normal) · (point − t) = offset
            let z = normal * point.conj();
            [[0.0, -normal.re, normal.im], [0.0, -normal.im, -normal.re], [-offset, z.re, -z.im]]
        }
        Condition::Heading { rotation } => [[0.0; 3], [0.0; 3], [0.0, -rotation.im, rotation.re]],
        Condition::Circle { .. } | Condition::Cone { .. } | Condition::Flat { .. } => {
            unreachable!("`planar` solves conditions without a circle here")
        }
    });
    let rows = rows.map(|row| row.map(Trigonometric::linear));
    let cofactor = |i: usize| {
        let [p, q] = [&rows[(i + 1) % 3], &rows[(i + 2) % 3]];
        p[0].times(&q[1]).minus(&q[0].times(&p[1]))
    };
    let terms = [0, 1, 2].map(|i| rows[i][2].times(&cofactor(i)));
    let determinant = terms[0].plus(&terms[1]).plus(&terms[2]);
    let scale = rows.iter().map(|row| row.iter().map(Trigonometric::size).sum::<f64>()).product();
    let Roots::At { roots, .. } = determinant.roots(scale) else { return Solutions::Dependent };
    let mut found = Vec::with_capacity(8);
    for rotation in roots {
        let at = rows.each_ref().map(|row| row.each_ref().map(|x| x.value(rotation)));
        let minor = |i: usize| {
            let [p, q] = [at[(i + 1) % 3], at[(i + 2) % 3]];
            (p[0] * q[1] - q[0] * p[1], [p, q])
        };
        let best = (0..3).map(minor).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let Some((determinant, [p, q])) = best.filter(|(d, _)| d.abs() > BELONGS) else { continue };
        let x = (p[1] * q[2] - q[1] * p[2]) / determinant;
        let y = (q[0] * p[2] - p[0] * q[2]) / determinant;
        let g = PlanarDisplacement { rotation, translation: Complex::new(x, y) };
        collect(polish(g, conditions), &mut found);
    }
    Solutions::At(found)
}

/// Removes the rounding of the elimination by steps of Newton's method on the conditions themselves.
fn polish<G: Group>(start: G, conditions: &[Condition; 3]) -> G {
    newton(start, conditions, POLISH, HALVINGS).0
}

/// The displacement to which Newton's method leads from another one; `None` if no displacement near it satisfies the
/// conditions, or if they are not independent there.
pub fn near<G: Group>(start: G, conditions: &[Condition; 3]) -> Option<G> {
    let (found, miss) = newton(start, conditions, NEAR_STEPS, 0);
    (miss <= MET).then_some(found)
}

/// Takes steps of Newton's method as long as each comes closer, where need be after some halvings. Returns by how much the
/// conditions are missed, too.
fn newton<G: Group>(
    start: G,
    conditions: &[Condition; 3],
    steps: usize,
    halvings: usize,
) -> (G, f64) {
    let evaluate = |g: &G| {
        let [one, two, three] = conditions;
        let ((x, a), (y, b), (z, c)) = (g.error(one), g.error(two), g.error(three));
        (Vector3::new(x, y, z), [a, b, c])
    };
    let mut here = start;
    let (mut miss, mut derivative) = evaluate(&here);
    for _ in 0..steps {
        if miss.amax() <= POLISHED {
            break;
        }
        // By Cramer's rule, with the derivatives of the three conditions as rows.
        let [a, b, c] = derivative;
        let minors = [b.cross(&c), c.cross(&a), a.cross(&b)];
        let weighed = minors[0] * miss.x + minors[1] * miss.y + minors[2] * miss.z;
        let mut step = weighed / -a.dot(&minors[0]);
        let length = step.amax();
        if length.is_nan() || length > LONGEST_STEP {
            break;
        }
        let mut left = halvings;
        let (next, after, slope) = loop {
            let next = here.moved(&step);
            let (after, slope) = evaluate(&next);
            if after.norm() < miss.norm() {
                break (next, after, slope);
            }
            if left == 0 || miss.amax() <= MET {
                return (here, miss.amax());
            }
            step *= 0.5;
            left -= 1;
        };
        (here, miss, derivative) = (next, after, slope);
    }
    (here, miss.amax())
}

/// Adds a displacement to the solutions, unless it is there already.
fn collect<G: Group>(g: G, found: &mut Vec<G>) {
    if !found.iter().any(|other| g.distance(other) < SAME) {
        found.push(g);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::samples::Numbers;

    /// Three cones with the axes of the Agile Eye have eight solutions: four at which all axes of a leg coincide,
    /// and four others. Each of the first four shares its angles with another one, whichever cone is first.
    #[test]
    fn cones_with_orthogonal_axes_have_eight_solutions() {
        let mut numbers = Numbers::new(5);
        for _ in 0..2_000 {
            // At multiples of a right angle, solutions coincide.
            let motor = |quarter: i32, at: f64| {
                (f64::from(quarter) + 0.5 + 0.48 * at) * std::f64::consts::FRAC_PI_2
            };
            let [a, b, c] = [0, 1, 3].map(|quarter| motor(quarter, numbers.next()).sin_cos());
            let fixed = [
                Vector3::new(0.0, -a.0, a.1),
                Vector3::new(b.1, 0.0, -b.0),
                Vector3::new(-c.0, c.1, 0.0),
            ];
            let carried = [-Vector3::y(), -Vector3::z(), -Vector3::x()];
            let cone =
                |i: usize| Condition::Cone { fixed: fixed[i], carried: carried[i], cosine: 0.0 };
            let conditions = [0, 1, 2].map(cone);
            let Solutions::At(found) = spherical(&conditions) else { panic!("dependent") };
            // A candidate that does not satisfy the conditions is rejected where assemblies are accepted.
            let met = |r: &&Matrix3<f64>| conditions.iter().all(|c| r.error(c).0.abs() < 1e-12);
            assert_eq!(found.iter().filter(met).count(), 8, "{fixed:?}");
        }
    }
}
