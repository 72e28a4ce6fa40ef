//! The products of exponentials of four legs side by side: each leg has a lane of every vector. Products are kept, and the
//! next ones begin at the first joint with another value.

use super::LegJoint;
use crate::group::screw::Screw;
use crate::numeric::angle::sin_cos_of_all;
use nalgebra::{Isometry3, Point3, Vector3};

/// The number of legs that are computed together.
const LANES: usize = 4;

/// A number for each leg.
type Lanes = [f64; LANES];

const ZEROS: Lanes = [0.0; LANES];

/// Up to four legs.
#[derive(Clone, Debug)]
pub(super) struct Abreast {
    /// The joints of all legs, those at the platform in the last stage: of legs with spherical joints there, which are fewer,
    /// the others are in one stage with joints that are as near to the base.
    stages: Vec<Stage>,
    /// The number of legs.
    legs: usize,
}

/// One joint of each leg. A leg with fewer joints has some at the base that do not move.
#[derive(Clone, Debug)]
struct Stage {
    /// For each leg, the number of the joint's first value.
    values: [usize; LANES],
    /// The values at home, which are zero for a spherical joint.
    home: Lanes,
    exponents: Exponents,
    /// The spherical joints, each with its lane and its rotation vector at home.
    balls: Vec<(usize, Vector3<f64>)>,
    /// The points of the spherical joints; zero in the other lanes.
    points: [Lanes; 3],
}

/// What the exponential of a screw consists of, for each leg: with the angle `θ = 2 h q`, its rotation is
/// `cos(θ/2) + a sin(θ/2)`, and its translation `s sin θ + c (1 − cos θ) + d (q − sin θ)`.
#[derive(Clone, Debug)]
struct Exponents {
    /// Half of the angle for a unit of the value, `h`: zero where the joint only slides.
    half: Lanes,
    /// The axis `a`; zero where the joint only slides.
    axis: [Lanes; 3],
    /// The velocity `s` of the origin; zero where the joint only slides.
    by_sine: [Lanes; 3],
    /// `c = a × s`.
    by_versine: [Lanes; 3],
    /// The advance `d` for a unit of the value.
    by_rest: [Lanes; 3],
}

/// A displacement for each leg: a unit quaternion, its real part first, and a translation.
#[derive(Clone, Copy, Debug)]
struct Displacements {
    rotation: [Lanes; 4],
    translation: [Lanes; 3],
}

impl Exponents {
    /// No motion.
    const REST: Self = Self {
        half: ZEROS,
        axis: [ZEROS; 3],
        by_sine: [ZEROS; 3],
        by_versine: [ZEROS; 3],
        by_rest: [ZEROS; 3],
    };

    /// Sets the exponential of one leg.
    fn set(&mut self, lane: usize, screw: &Screw) {
        let Screw { angular: axis, linear } = *screw;
        let rotates = axis != Vector3::zeros();
        let (half, origin, advance) = match rotates {
            true => (0.5, linear, axis * axis.dot(&linear)),
            false => (0.0, Vector3::zeros(), linear),
        };
        self.half[lane] = half;
        let parts = [
            (&mut self.axis, axis),
            (&mut self.by_sine, origin),
            (&mut self.by_versine, axis.cross(&origin)),
            (&mut self.by_rest, advance),
        ];
        for (part, vector) in parts {
            for (lanes, component) in part.iter_mut().zip(&vector) {
                lanes[lane] = *component;
            }
        }
    }
}

impl Stage {
    const REST: Self = Self {
        values: [0; LANES],
        home: ZEROS,
        exponents: Exponents::REST,
        balls: Vec::new(),
        points: [ZEROS; 3],
    };

    /// The displacements of these joints from home; of a spherical joint, the first component.
    #[inline(always)]
    fn by(&self, joints: &[f64]) -> Lanes {
        let mut by = ZEROS;
        for i in 0..LANES {
            by[i] = joints[self.values[i]] - self.home[i];
        }
        by
    }

    /// The displacements `g`, followed towards the platform by those of these joints.
    #[inline(always)]
    fn after(&self, g: &Displacements, mut by: Lanes, joints: &[f64]) -> Displacements {
        if self.balls.is_empty() {
            return g.followed(&self.exponents, &by);
        }
        // A spherical joint rotates about the axis `a` of its rotation vector: it moves the origin by `s = p × a`, where
        // `p` is its point.
        let Exponents { half, mut axis, mut by_sine, mut by_versine, by_rest } = self.exponents;
        for (lane, home) in &self.balls {
            let first = self.values[*lane];
            let vector = Vector3::new(joints[first], joints[first + 1], joints[first + 2]) - home;
            let angle = vector.norm();
            let unit = if angle > 0.0 { vector / angle } else { vector };
            for k in 0..3 {
                axis[k][*lane] = unit[k];
            }
            by[*lane] = angle;
        }
        for i in 0..LANES {
            let a = [axis[0][i], axis[1][i], axis[2][i]];
            let s = cross([self.points[0][i], self.points[1][i], self.points[2][i]], a);
            let c = cross(a, s);
            for k in 0..3 {
                by_sine[k][i] += s[k];
                by_versine[k][i] += c[k];
            }
        }
        g.followed(&Exponents { half, axis, by_sine, by_versine, by_rest }, &by)
    }
}

impl Displacements {
    const IDENTITY: Self =
        Self { rotation: [[1.0; LANES], ZEROS, ZEROS, ZEROS], translation: [ZEROS; 3] };

    /// These displacements, followed towards the platform by exponentials.
    #[inline(always)]
    fn followed(&self, exponents: &Exponents, by: &Lanes) -> Self {
        let Exponents { half, axis, by_sine, by_versine, by_rest } = exponents;
        let mut angles = ZEROS;
        for i in 0..LANES {
            angles[i] = half[i] * by[i];
        }
        let [sin, cos] = sin_cos_of_all(&angles);
        let mut moved = *self;
        for i in 0..LANES {
            let (sine, versine) = (2.0 * sin[i] * cos[i], 2.0 * sin[i] * sin[i]);
            let rest = by[i] - sine;
            let along =
                |k: usize| by_sine[k][i] * sine + by_versine[k][i] * versine + by_rest[k][i] * rest;
            let t = [along(0), along(1), along(2)];
            let (w, q) = (self.rotation[0][i], [1, 2, 3].map(|k| self.rotation[k][i]));
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

    /// For each leg, the distance from a displacement: the angle in radians, plus the distance of a point over `size`.
    #[inline(always)]
    fn apart(&self, target: &Isometry3<f64>, platform: &Point3<f64>, size: f64) -> Lanes {
        let aim = <[f64; 3]>::from((target * platform).coords);
        let [a, b, c, d] = <[f64; 4]>::from(target.rotation.into_inner().coords);
        let (point, wanted, real) = (<[f64; 3]>::from(platform.coords), [a, b, c], d);
        let mut distances = ZEROS;
        for (i, distance) in distances.iter_mut().enumerate() {
            let (w, q) = (self.rotation[0][i], [1, 2, 3].map(|k| self.rotation[k][i]));
            // The sine of half the angle, twice: acos would lose half of the digits.
            let [x, y, z] = cross(wanted, q);
            let x = w * wanted[0] - real * q[0] + x;
            let y = w * wanted[1] - real * q[1] + y;
            let z = w * wanted[2] - real * q[2] + z;
            let angle = 2.0 * (x * x + y * y + z * z).sqrt();
            let [x, y, z] = rotated(w, q, point);
            let x = x + self.translation[0][i] - aim[0];
            let y = y + self.translation[1][i] - aim[1];
            let z = z + self.translation[2][i] - aim[2];
            *distance = angle + (x * x + y * y + z * z).sqrt() / size;
        }
        distances
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

impl Abreast {
    /// All legs of a mechanism, in groups.
    pub fn of_legs(legs: &[Vec<LegJoint>]) -> Vec<Self> {
        let mut first = 0;
        let groups = legs.chunks(LANES);
        groups.map(|legs| Self::new(legs, &mut first)).collect()
    }

    /// A group of legs. `first` is the number of its first joint value, and after it that of the next group's.
    fn new(legs: &[Vec<LegJoint>], first: &mut usize) -> Self {
        let most = legs.iter().map(Vec::len).max().unwrap_or(0);
        let mut stages = vec![Stage::REST; most];
        for (lane, leg) in legs.iter().enumerate() {
            for (joint, stage) in leg.iter().zip(&mut stages[most - leg.len()..]) {
                stage.values[lane] = *first;
                *first += joint.values();
                match joint {
                    LegJoint::Screw { screw, home, .. } => {
                        stage.home[lane] = *home;
                        stage.exponents.set(lane, screw);
                    }
                    LegJoint::Ball { point, home, .. } => {
                        stage.exponents.half[lane] = 0.5;
                        stage.balls.push((lane, *home));
                        for (lanes, component) in stage.points.iter_mut().zip(point) {
                            lanes[lane] = *component;
                        }
                    }
                }
            }
        }
        Self { stages, legs: legs.len() }
    }

    /// A buffer for products.
    pub fn products(&self) -> Products {
        Products(vec![([f64::NAN; LANES], Displacements::IDENTITY); self.stages.len()])
    }

    /// The largest distance of a leg's end from the displacement `target`: see [`Displacements::apart`].
    #[inline(always)]
    pub fn residual(
        &self,
        joints: &[f64],
        target: &Isometry3<f64>,
        platform: &Point3<f64>,
        size: f64,
        Products(kept): &mut Products,
    ) -> f64 {
        let (mut ends, mut same) = (Displacements::IDENTITY, true);
        for (stage, (kept_by, kept_ends)) in self.stages.iter().zip(kept) {
            let by = stage.by(joints);
            same &= by == *kept_by && stage.balls.is_empty();
            if !same {
                (*kept_by, *kept_ends) = (by, stage.after(&ends, by, joints));
            }
            ends = *kept_ends;
        }
        let distances = ends.apart(target, platform, size);
        distances[..self.legs].iter().fold(0.0, |most, &distance| f64::max(most, distance))
    }
}

/// After each stage, the joints' displacements and the product of the exponentials up to there, as they were computed
/// last.
#[derive(Clone, Debug)]
pub(super) struct Products(Vec<(Lanes, Displacements)>);
