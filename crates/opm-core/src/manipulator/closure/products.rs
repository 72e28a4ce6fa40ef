//! Products of exponentials for several sets of joint values side by side: each set has a lane of every vector.

use crate::group::screw::Screw;
use crate::numeric::angle::sin_cos_of_all;
use nalgebra::{Isometry3, Point3, Vector3};

/// A vector for each set.
type Vectors<const N: usize> = [[f64; N]; 3];

/// What the exponential of a screw consists of, for each set: with the angle `θ = 2 h q`, its rotation is
/// `cos(θ/2) + a sin(θ/2)`, and its translation `s sin θ + c (1 − cos θ) + d (q − sin θ)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exponents<const N: usize> {
    /// Half of the angle for a unit of the value, `h`: zero where the joint only slides.
    half: [f64; N],
    /// The axis `a`; zero where the joint only slides.
    axis: Vectors<N>,
    /// The velocity `s` of the origin; zero where the joint only slides.
    by_sine: Vectors<N>,
    /// `c = a × s`.
    by_versine: Vectors<N>,
    /// The advance `d` for a unit of the value.
    by_rest: Vectors<N>,
}

impl Exponents<1> {
    /// That of a screw.
    pub fn of_screw(Screw { angular, linear }: &Screw) -> Self {
        let axis = *angular;
        let (half, origin, advance) = match axis != Vector3::zeros() {
            true => (0.5, *linear, axis * axis.dot(linear)),
            false => (0.0, Vector3::zeros(), *linear),
        };
        let vector = |v: Vector3<f64>| <[f64; 3]>::from(v).map(|component| [component]);
        Self {
            half: [half],
            axis: vector(axis),
            by_sine: vector(origin),
            by_versine: vector(axis.cross(&origin)),
            by_rest: vector(advance),
        }
    }

    /// The same one for each set.
    #[inline(always)]
    pub fn repeated<const N: usize>(&self) -> Exponents<N> {
        let repeated = |vector: &Vectors<1>| vector.map(|[component]| [component; N]);
        Exponents {
            half: [self.half[0]; N],
            axis: repeated(&self.axis),
            by_sine: repeated(&self.by_sine),
            by_versine: repeated(&self.by_versine),
            by_rest: repeated(&self.by_rest),
        }
    }
}

impl<const N: usize> Exponents<N> {
    /// Those of a spherical joint at a point, for rotation vectors, and the angles of these. It rotates about the axis `a`
    /// of the vector: it moves the origin by `s = p × a`, where `p` is its point.
    #[inline(always)]
    pub fn of_ball(point: &Vector3<f64>, vectors: &Vectors<N>) -> (Self, [f64; N]) {
        let point = <[f64; 3]>::from(*point);
        let none = [[0.0; N]; 3];
        let (mut axis, mut by_sine, mut by_versine, mut angles) = (none, none, none, [0.0; N]);
        for i in 0..N {
            let [x, y, z] = [vectors[0][i], vectors[1][i], vectors[2][i]];
            let angle = (x * x + y * y + z * z).sqrt();
            let over = if angle > 0.0 { 1.0 / angle } else { 1.0 };
            let a = [x * over, y * over, z * over];
            let s = cross(point, a);
            let c = cross(a, s);
            for k in 0..3 {
                (axis[k][i], by_sine[k][i], by_versine[k][i]) = (a[k], s[k], c[k]);
            }
            angles[i] = angle;
        }
        (Self { half: [0.5; N], axis, by_sine, by_versine, by_rest: none }, angles)
    }
}

/// A displacement for each set: a unit quaternion, its real part first, and a translation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Displacements<const N: usize> {
    rotation: [[f64; N]; 4],
    translation: Vectors<N>,
}

impl<const N: usize> Displacements<N> {
    pub const IDENTITY: Self =
        Self { rotation: [[1.0; N], [0.0; N], [0.0; N], [0.0; N]], translation: [[0.0; N]; 3] };

    /// These displacements, followed towards the platform by exponentials for values `by`.
    #[inline(always)]
    pub fn followed(&self, exponents: &Exponents<N>, by: &[f64; N]) -> Self {
        let Exponents { half, axis, by_sine, by_versine, by_rest } = exponents;
        let mut angles = [0.0; N];
        for i in 0..N {
            angles[i] = half[i] * by[i];
        }
        let [sin, cos] = sin_cos_of_all(&angles);
        let mut moved = *self;
        for i in 0..N {
            let (sine, versine) = (2.0 * sin[i] * cos[i], 2.0 * sin[i] * sin[i]);
            let rest = by[i] - sine;
            let along =
                |k: usize| by_sine[k][i] * sine + by_versine[k][i] * versine + by_rest[k][i] * rest;
            let t = [along(0), along(1), along(2)];
            let (w, q) = self.quaternion(i);
            for (k, t) in rotated(w, q, t).into_iter().enumerate() {
                moved.translation[k][i] = self.translation[k][i] + t;
            }
            let (c, e) = (cos[i], [axis[0][i] * sin[i], axis[1][i] * sin[i], axis[2][i] * sin[i]]);
            // In the order of nalgebra's product.
            moved.rotation[0][i] = w * c - q[0] * e[0] - q[1] * e[1] - q[2] * e[2];
            moved.rotation[1][i] = w * e[0] + q[0] * c + q[1] * e[2] - q[2] * e[1];
            moved.rotation[2][i] = w * e[1] - q[0] * e[2] + q[1] * c + q[2] * e[0];
            moved.rotation[3][i] = w * e[2] + q[0] * e[1] - q[1] * e[0] + q[2] * c;
        }
        moved
    }

    /// The rotation of one set: its real part, and its vector.
    #[inline(always)]
    fn quaternion(&self, i: usize) -> (f64, [f64; 3]) {
        let [w, x, y, z] = &self.rotation;
        (w[i], [x[i], y[i], z[i]])
    }

    /// For each set, the distance from its target: the angle in radians, plus the distance of the platform's point over
    /// `size`.
    #[inline(always)]
    pub fn apart(&self, targets: &Targets<N>, platform: &Point3<f64>, size: f64) -> [f64; N] {
        let point = <[f64; 3]>::from(platform.coords);
        let mut distances = [0.0; N];
        for (i, distance) in distances.iter_mut().enumerate() {
            let ((w, q), (real, wanted)) = (self.quaternion(i), targets.place.quaternion(i));
            // The sine of half the angle, twice: acos would lose half of the digits.
            let [x, y, z] = cross(wanted, q);
            let x = w * wanted[0] - real * q[0] + x;
            let y = w * wanted[1] - real * q[1] + y;
            let z = w * wanted[2] - real * q[2] + z;
            let angle = 2.0 * (x * x + y * y + z * z).sqrt();
            let [x, y, z] = rotated(w, q, point);
            let x = x + self.translation[0][i] - targets.aim[0][i];
            let y = y + self.translation[1][i] - targets.aim[1][i];
            let z = z + self.translation[2][i] - targets.aim[2][i];
            *distance = angle + (x * x + y * y + z * z).sqrt() / size;
        }
        distances
    }
}

/// Where the legs should end, for each set.
pub(super) struct Targets<const N: usize> {
    place: Displacements<N>,
    /// The platform's point there.
    aim: Vectors<N>,
}

impl<const N: usize> Targets<N> {
    #[inline(always)]
    pub fn new(targets: [&Isometry3<f64>; N], platform: &Point3<f64>) -> Self {
        let (mut place, mut aim) = (Displacements::IDENTITY, [[0.0; N]; 3]);
        for (i, target) in targets.into_iter().enumerate() {
            let [x, y, z, w] = <[f64; 4]>::from(target.rotation.into_inner().coords);
            for (lanes, component) in place.rotation.iter_mut().zip([w, x, y, z]) {
                lanes[i] = component;
            }
            for (lanes, component) in aim.iter_mut().zip(&(target * platform).coords) {
                lanes[i] = *component;
            }
        }
        Self { place, aim }
    }
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A vector, rotated by the unit quaternion `w + q`.
#[inline(always)]
fn rotated(w: f64, q: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let t = cross(q, v);
    let t = [2.0 * t[0], 2.0 * t[1], 2.0 * t[2]];
    let u = cross(q, t);
    [v[0] + (w * t[0] + u[0]), v[1] + (w * t[1] + u[1]), v[2] + (w * t[2] + u[2])]
}
