//! Three conditions on a displacement of a planar or a spherical subspace: the forward kinematics of a
//! planar 3-RRR or 3-PRR and all its relatives, and of a spherical 3-RRR.
//!
//! One circle or cone is satisfied by two angles: `g = D · turn(θ) · K · turn(φ) · E`, about the fixed
//! point or direction and about the carried one. The two other conditions are then linear in
//! `1, cos φ, sin φ`, with coefficients that are linear in `1, cos θ, sin θ`; eliminating φ leaves one
//! trigonometric polynomial of degree four in θ: at most eight solutions, six in a plane, where the
//! highest coefficient vanishes. Three lines in a plane are linear in the translation instead, with the
//! rotation as θ.

use super::trigonometric::{Roots, Trigonometric};
use crate::chain::condition::{Condition, QUARTER, dot, length};
use crate::group::{PlanarDisplacement, Spherical, Subgroup};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Matrix3, Vector3};

/// What three conditions leave.
#[derive(Clone, Debug, PartialEq)]
pub enum Solutions<G> {
    /// Single displacements.
    At(Vec<G>),
    /// A motion, or nothing: the conditions are not independent.
    Dependent,
}

/// A root in θ is off by up to the root of rounding where it is double; the solution for φ that does not
/// belong to it misses by far more, or is within what the polish mends.
const BELONGS: f64 = 1e-5;

/// Two solutions nearer than this, in radians and sizes, are one: a double root is only known to about
/// the root of rounding.
const SAME: f64 = 1e-7;

/// A polishing step longer than this comes from a singular derivative.
const LONGEST_STEP: f64 = 0.1;

/// The steps of a polish: each squares an error that is already small.
const POLISH: usize = 3;

/// An equation in θ (rows: 1, cos, sin) and φ (columns: 1, cos, sin).
#[derive(Clone, Copy, Debug)]
struct Bilinear {
    coefficients: Matrix3<f64>,
    /// Of the terms that they are differences of.
    size: f64,
}

/// A group that three conditions are solved in, with a frame of size one.
trait Group: Copy {
    /// By how much a condition is missed, and the derivative by a small motion from here: rotation, then
    /// translation, or rotation vector.
    fn miss(&self, condition: &Condition) -> (f64, Vector3<f64>);
    /// After a small motion.
    fn moved(&self, step: &Vector3<f64>) -> Self;
    /// Distance from another.
    fn apart(&self, other: &Self) -> f64;
}

impl Group for PlanarDisplacement {
    fn miss(&self, condition: &Condition) -> (f64, Vector3<f64>) {
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

    fn apart(&self, other: &Self) -> f64 {
        length(self.rotation - other.rotation) + length(self.translation - other.translation)
    }
}

impl Group for Matrix3<f64> {
    fn miss(&self, condition: &Condition) -> (f64, Vector3<f64>) {
        let (fixed, carried, cosine) = condition.cone();
        let w = self * carried;
        (fixed.dot(&w) - cosine, w.cross(&fixed))
    }

    fn moved(&self, step: &Vector3<f64>) -> Self {
        Spherical::product(&Spherical::exponential(step), self)
    }

    fn apart(&self, other: &Self) -> f64 {
        (self - other).norm()
    }
}

/// The rotations that satisfy three cones.
pub fn spherical(conditions: &[Condition; 3]) -> Solutions<Matrix3<f64>> {
    let cone = |i: usize| conditions[i].cone();
    // The widest cone is parametrised best.
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| cone(a).2.abs().total_cmp(&cone(b).2.abs()));
    solve(&order, |first, found| on_cone(conditions, first, cone, found))
}

/// Finds solutions with one cone satisfied by two angles.
fn on_cone(
    conditions: &[Condition; 3],
    first: usize,
    cone: impl Fn(usize) -> (Vector3<f64>, Vector3<f64>, f64),
    found: &mut Vec<Matrix3<f64>>,
) -> Found {
    let (fixed, carried, cosine) = cone(first);
    let (from, to) = (triad(&fixed), triad(&carried));
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    // R = from · Rz(θ) · tilt · Rz(φ) · toᵀ, and z · tilt z is the cosine.
    let tilt = Matrix3::new(cosine, 0.0, sine, 0.0, 1.0, 0.0, -sine, 0.0, cosine);
    let rest = [(first + 1) % 3, (first + 2) % 3].map(|i| {
        let (fixed, carried, cosine) = cone(i);
        let (f, c) = (from.tr_mul(&fixed), to.tr_mul(&carried));
        let about = |v: Vector3<f64>, sign: f64| {
            // Rz(±θ) v by 1, cos, sin
            Matrix3::from_columns(&[
                Vector3::new(0.0, 0.0, v.z),
                Vector3::new(v.x, v.y, 0.0),
                Vector3::new(-v.y, v.x, 0.0) * sign,
            ])
        };
        let mut coefficients = about(f, -1.0).tr_mul(&(tilt * about(c, 1.0)));
        coefficients[(0, 0)] -= cosine;
        Bilinear { coefficients, size: 1.0 }
    });
    let place = |theta: Complex<f64>, phi: Complex<f64>| {
        from * turn(theta) * tilt * turn(phi) * to.transpose()
    };
    eliminate_angle(&rest, conditions, place, found)
}

fn turn(e: Complex<f64>) -> Matrix3<f64> {
    Matrix3::new(e.re, -e.im, 0.0, e.im, e.re, 0.0, 0.0, 0.0, 1.0)
}

/// A right-handed frame whose third direction is `axis`.
fn triad(axis: &Vector3<f64>) -> Matrix3<f64> {
    let beside = if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = (beside - axis * axis.dot(&beside)).normalize();
    Matrix3::from_columns(&[first, axis.cross(&first), *axis])
}

/// The displacements of the plane that satisfy three conditions, whose lengths are over the size.
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

/// Finds solutions with one circle satisfied by two angles.
fn from_circle(
    conditions: &[Condition; 3],
    first: usize,
    found: &mut Vec<PlanarDisplacement>,
) -> Found {
    let Condition::Circle { point, centre, radius } = conditions[first] else {
        unreachable!("only circles are asked for")
    };
    // g point = centre + radius e(θ), turned by e(φ).
    let rest = [(first + 1) % 3, (first + 2) % 3]
        .map(|i| on_circle(&conditions[i], point, centre, radius));
    let place = |theta: Complex<f64>, phi: Complex<f64>| PlanarDisplacement {
        rotation: phi,
        translation: centre + theta * radius - phi * point,
    };
    eliminate_angle(&rest, conditions, place, found)
}

/// A condition on a body whose `point` is at `centre + radius e(θ)` and that is turned by `e(φ)`.
fn on_circle(
    condition: &Condition,
    point: Complex<f64>,
    centre: Complex<f64>,
    radius: f64,
) -> Bilinear {
    // Re(z e(θ)) and so on, as coefficients of 1, cos, sin.
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

/// What one way of eliminating has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Found {
    /// Everything.
    All,
    /// Roots that are all but double: there may be more to them.
    Doubtful,
    /// The conditions are not independent.
    Dependent,
}

/// Eliminates with one condition after the other as the first. Two solutions at one θ, or near it, are a
/// double root of one polynomial, and as a rule not of the others.
fn solve<G: Group>(
    order: &[usize],
    eliminate: impl Fn(usize, &mut Vec<G>) -> Found,
) -> Solutions<G> {
    let mut found = Vec::with_capacity(8);
    for &first in order {
        match eliminate(first, &mut found) {
            Found::All => break,
            Found::Doubtful => {}
            Found::Dependent => return Solutions::Dependent,
        }
    }
    Solutions::At(found)
}

/// Two equations in two angles.
fn eliminate_angle<G: Group>(
    rest: &[Bilinear; 2],
    conditions: &[Condition; 3],
    place: impl Fn(Complex<f64>, Complex<f64>) -> G,
    found: &mut Vec<G>,
) -> Found {
    let [[c1, a1, b1], [c2, a2, b2]] = rest.map(|equation| {
        let m = equation.coefficients;
        let column = |j: usize| Trigonometric::linear([m[(0, j)], m[(1, j)], m[(2, j)]]);
        [column(0), column(1), column(2)]
    });
    // Of a cos φ + b sin φ + c = 0, twice: cos φ = x / z, sin φ = y / z.
    let minor = |p: &Trigonometric, q: &Trigonometric, r: &Trigonometric, s: &Trigonometric| {
        p.times(q).minus(&r.times(s))
    };
    let x = minor(&b1, &c2, &b2, &c1);
    let y = minor(&c1, &a2, &c2, &a1);
    let z = minor(&a1, &b2, &a2, &b1);
    let polynomial = x.times(&x).plus(&y.times(&y)).minus(&z.times(&z));
    let product = rest[0].size * rest[1].size;
    let Roots::At { roots, doubtful } = polynomial.roots(product * product) else {
        return Found::Dependent;
    };
    for theta in roots {
        let equations = [[&a1, &b1, &c1], [&a2, &b2, &c2]]
            .map(|equation| equation.map(|coefficient| coefficient.value(theta)));
        for phi in common(&equations, [rest[0].size, rest[1].size]).into_iter().flatten() {
            collect(polish(place(theta, phi), conditions), found);
        }
    }
    if doubtful { Found::Doubtful } else { Found::All }
}

/// The turns that satisfy two equations `a cos φ + b sin φ + c = 0`, of which one is a consequence of the
/// other at the most.
fn common(equations: &[[f64; 3]; 2], sizes: [f64; 2]) -> [Option<Complex<f64>>; 2] {
    let clear =
        |i: usize| (equations[i][0].powi(2) + equations[i][1].powi(2)) / (sizes[i] * sizes[i]);
    let better = usize::from(clear(1) > clear(0));
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

/// Three conditions without a circle: rows `n · t + m = 0` in the translation, whose determinant is zero.
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
            unreachable!("not a line")
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

/// Newton's steps on the conditions themselves: the elimination's rounding does not stay.
fn polish<G: Group>(start: G, conditions: &[Condition; 3]) -> G {
    let evaluate = |g: &G| {
        let parts = conditions.each_ref().map(|condition| g.miss(condition));
        let miss = Vector3::from_fn(|i, _| parts[i].0);
        let derivative = Matrix3::from_rows(&parts.map(|part| part.1.transpose()));
        (miss, derivative)
    };
    let mut here = start;
    let (mut miss, mut derivative) = evaluate(&here);
    for _ in 0..POLISH {
        let Some(inverse) = derivative.try_inverse() else { break };
        let step = -(inverse * miss);
        let length = step.amax();
        if length.is_nan() || length > LONGEST_STEP {
            break;
        }
        let next = here.moved(&step);
        let (after, slope) = evaluate(&next);
        let closer = after.norm() < miss.norm();
        if !closer {
            break;
        }
        (here, miss, derivative) = (next, after, slope);
    }
    here
}

fn collect<G: Group>(g: G, found: &mut Vec<G>) {
    if !found.iter().any(|other| g.apart(other) < SAME) {
        found.push(g);
    }
}
