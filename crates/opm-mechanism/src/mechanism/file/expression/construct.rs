//! Points by construction, as on a drawing: link lengths are given, and elbows follow.
//!
//! What does not close says by how much, in the units of the file.

use crate::mechanism::file::FileUnits;
use crate::numeric::Quantity;
use nalgebra::{Unit, Vector3};

/// A share of a size by which rounding may miss.
const ROUNDING: f64 = 1e-12;

/// A circle or a sphere: its centre and its radius.
type Round = (Vector3<f64>, f64);

/// The unit vector along a vector, if there is one.
pub(in crate::mechanism::file) fn direction(vector: &Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    // Scaled first: the squares of very large and very small doubles are out of range.
    let largest = vector.amax();
    (largest > 0.0).then(|| Unit::new_normalize(vector / largest))
}

/// Constructions, with messages in some units.
pub(super) struct Place {
    pub units: FileUnits,
}

impl Place {
    /// A length in the unit of the file, shown.
    fn length(&self, value: f64) -> impl std::fmt::Display {
        self.units.show(self.units.si(value, Quantity::Length), Quantity::Length)
    }

    /// The root of a square that may be below zero by rounding; `None` if it is below by more.
    fn root(square: f64, size: f64) -> Option<f64> {
        (square >= -ROUNDING * size * size).then(|| square.max(0.0).sqrt())
    }

    /// The point of the plane through `a` that is `r` from `a` and `s` from `b`, to the left of the way from `a` to `b`.
    pub fn meet(
        &self,
        [(a, r), (b, s)]: [Round; 2],
        normal: Unit<Vector3<f64>>,
        side: f64,
    ) -> Result<Vector3<f64>, String> {
        let height = normal.dot(&(b - a));
        let Some(s_in_plane) = Self::root(s * s - height * height, s) else {
            let (off, s) = (self.length(height.abs()), self.length(s));
            return Err(format!("B is {off} from the plane through A, expected at most S = {s}"));
        };
        let way = b - a - *normal * height;
        let apart = way.norm();
        let Some(forward) = direction(&way) else {
            return Err("A and B are in line with the normal, expected two centres".into());
        };
        let x = (apart * apart + r * r - s_in_plane * s_in_plane) / (2.0 * apart);
        let Some(y) = Self::root(r * r - x * x, r.abs().max(apart)) else {
            return Err(self.gap(apart, r.abs(), s_in_plane));
        };
        Ok(a + *forward * x + normal.cross(&forward) * (side * y))
    }

    /// Why two circles with centres `apart` do not meet.
    fn gap(&self, apart: f64, r: f64, s: f64) -> String {
        let show = |value| self.length(value);
        let (most, least) = (r + s, (r - s).abs());
        let (bound, expected, off) = if apart > most {
            (most, "at most", apart - most)
        } else {
            (least, "at least", least - apart)
        };
        format!(
            "R = {} and S = {} do not meet: the centres are {} apart in the plane, expected {expected} {}: {} off",
            show(r),
            show(s),
            show(apart),
            show(bound),
            show(off)
        )
    }

    /// The point at given distances from three others, from which they are counter-clockwise.
    pub fn spheres(&self, rounds: [Round; 3], side: f64) -> Result<Vector3<f64>, String> {
        let [(a, r), (b, s), (c, t)] = rounds;
        let third = c - a;
        let (Some(ex), apart) = (direction(&(b - a)), (b - a).norm()) else {
            return Err("A and B are the same point".into());
        };
        let i = ex.dot(&third);
        let Some(ey) = direction(&(third - *ex * i)) else {
            return Err("A, B and C are in line".into());
        };
        let j = ey.dot(&third);
        let x = (r * r - s * s + apart * apart) / (2.0 * apart);
        let y = (r * r - t * t + i * i + j * j) / (2.0 * j) - i / j * x;
        let square = r * r - x * x - y * y;
        let Some(z) = Self::root(square, r.abs().max(apart)) else {
            let off = x.hypot(y) - r.abs();
            return Err(format!(
                "the spheres do not meet: where those about B and C cut the plane of the centres, A is {} away, \
                 expected at most R = {}: {} off",
                self.length(x.hypot(y)),
                self.length(r.abs()),
                self.length(off)
            ));
        };
        Ok(a + *ex * x + *ey * y + ex.cross(&ey) * (side * z))
    }

    /// The point of a line that is `r` from `b`.
    pub fn along(
        &self,
        p: Vector3<f64>,
        direction: Unit<Vector3<f64>>,
        (b, r): Round,
        side: f64,
    ) -> Result<Vector3<f64>, String> {
        let foot = direction.dot(&(b - p));
        let off = (p + *direction * foot - b).norm();
        let Some(root) = Self::root(r * r - off * off, r.abs().max(off)) else {
            return Err(format!(
                "B is {} from the line, expected at most R = {}: {} off",
                self.length(off),
                self.length(r.abs()),
                self.length(off - r.abs())
            ));
        };
        Ok(p + *direction * (foot + side * root))
    }

    /// The direction at given angles from two others.
    pub fn arcs(
        &self,
        [a, b]: [Unit<Vector3<f64>>; 2],
        angles: [f64; 2],
        side: f64,
    ) -> Result<Vector3<f64>, String> {
        let (cross, c) = (a.cross(&b), a.dot(&b));
        let sine = cross.norm_squared();
        if sine < ROUNDING {
            return Err("A and B are in line, expected two directions".into());
        }
        let [p, q] = angles.map(f64::cos);
        let (x, y) = ((p - c * q) / sine, (q - c * p) / sine);
        let Some(z) = Self::root((1.0 - x * p - y * q) / sine, 1.0) else {
            let show = |angle| self.units.show(angle, Quantity::Angle);
            let [alpha, beta] = angles;
            return Err(format!(
                "arcs of {} and {} do not meet: their ends are {} apart, expected {} to {}",
                show(alpha),
                show(beta),
                show(sine.sqrt().atan2(c)),
                show((alpha - beta).abs()),
                show(alpha + beta)
            ));
        };
        Ok(*a * x + *b * y + cross * (side * z))
    }
}
