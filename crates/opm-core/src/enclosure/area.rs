//! The area that moving regions of the plane have in common, over a box of motions.
//!
//! The boundary of what they have in common consists of pieces of lines and circles. In the middle of the box, its area
//! is a sum over these pieces (Green's theorem), so it is exact. Where the boundaries move, a piece from `p` to `q` changes
//! the area by `u · n |q - p|` for a translation `u` of its curve, `n` the outer normal of the chord, whatever the piece's
//! form; and by `α (|p|² - |q|²) / 2` for a rotation `α` about the origin. The ends of a piece are known up to
//! the motion of the curves that meet there. So the area is a linear function of the motions, with an error that is
//! quadratic in their size. The linear part of a motion has the mean zero over a box.

mod known;
mod sum;
mod tracer;

use super::boundary::{Curve, Truth};
use crate::boxes::{Affine, Plane};
use nalgebra::Complex;
use sum::Sum;
use tracer::Tracer;

/// The rounding of a distance from a curve, as a fraction of the largest number in it.
const ROUNDING: f64 = 4e-15;

/// The number of sides of the rectangle.
const SIDES: usize = 4;

/// A displacement from the middle of a box: a rotation about the origin, and then a translation.
#[derive(Clone, Copy, Debug)]
pub struct Motion<const N: usize> {
    pub turn: Affine<N>,
    pub shift: Plane<N>,
}

impl<const N: usize> Motion<N> {
    /// A translation.
    pub fn shift(shift: Plane<N>) -> Self {
        Self { turn: Affine::constant(0.0), shift }
    }

    /// The largest translation.
    fn reach(&self) -> f64 {
        length(self.shift.re.furthest(), self.shift.im.furthest())
    }

    /// How far points at this distance from the origin move by each coordinate.
    fn spread(&self, far: f64) -> [f64; N] {
        let [re, im, turn] = [&self.shift.re, &self.shift.im, &self.turn].map(Affine::spread);
        std::array::from_fn(|i| length(re[i], im[i]) + far * turn[i])
    }

    /// How far a curve moves relative to points with another motion, at most `far` from the origin. A line moves across
    /// itself only.
    fn drift(&self, other: &Self, curve: &Curve, far: f64) -> Drift {
        let parts = |of: fn(&Self) -> &Affine<N>| {
            let (a, b) = (of(self), of(other));
            let slope: [f64; N] = std::array::from_fn(|i| a.slope[i] - b.slope[i]);
            (slope, a.total_error() + b.total_error() + (a.centre - b.centre).abs())
        };
        let (turn, turn_off) = parts(|motion| &motion.turn);
        let (x, x_off) = parts(|motion| &motion.shift.re);
        let (y, y_off) = parts(|motion| &motion.shift.im);
        let most = |slope: &[f64; N]| slope.iter().map(|s| s.abs()).sum::<f64>();
        // The mean square of a number that is even between -1 and 1 is a third.
        let mean = |square: f64| (square / 3.0).sqrt();
        let turned = far * (most(&turn) + turn_off);
        if let (Curve::Line { normal, .. }, true) = (curve, turned == 0.0) {
            let across: [f64; N] = std::array::from_fn(|i| normal.re * x[i] + normal.im * y[i]);
            let off = normal.re.abs() * x_off + normal.im.abs() * y_off;
            let square = across.iter().map(|s| s * s).sum();
            return Drift::new(mean(square), most(&across), off);
        }
        let square = (0..N).map(|i| x[i] * x[i] + y[i] * y[i]).sum();
        let turned_off = far * turn_off;
        let off = length(x_off, y_off) + turned_off;
        let turned = turned - turned_off;
        Drift::new(mean(square) + turned, length(most(&x), most(&y)) + turned, off)
    }
}

/// Bounds of a distance over a box.
#[derive(Clone, Copy, Debug, Default)]
struct Drift {
    /// Of its root mean square.
    mean: f64,
    /// Of all its values.
    most: f64,
    /// Of what is not linear.
    off: f64,
}

impl Drift {
    /// Of a linear function with this root mean square and this largest value, to within `off`.
    fn new(mean: f64, most: f64, off: f64) -> Self {
        Self { mean: mean.min(most) + off, most: most + off, off }
    }
}

/// The length of a vector; lengths here are far from overflow.
fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// One side of a boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    boundary: usize,
    inner: bool,
}

/// The points that are on all of some sides, or on another one.
#[derive(Clone, Debug, Default)]
pub struct Set {
    pub all: Vec<Side>,
    pub or: Option<Side>,
}

/// A region that a leg may reach: the points of a set that are not in its hole.
#[derive(Clone, Debug)]
pub struct Reach {
    pub whole: Set,
    pub hole: Option<Set>,
    /// Whether it is reached all over the box.
    pub sure: bool,
}

/// A curve, with the number of its motion.
#[derive(Clone, Copy, Debug)]
struct Boundary {
    curve: Curve,
    motion: usize,
    /// The number of its leg; `None` for a side of the rectangle.
    leg: Option<usize>,
}

/// Bounds of the area over a box.
#[derive(Clone, Copy, Debug)]
pub struct Area<const N: usize> {
    /// Of its mean.
    pub mean: [f64; 2],
    /// Of all its values.
    pub range: [f64; 2],
    /// What each coordinate contributes to the difference of the bounds of the mean.
    pub errors: [f64; N],
    /// The same, of all values.
    pub spread: [f64; N],
}

impl<const N: usize> Area<N> {
    /// The same area all over the box.
    pub fn constant(area: f64) -> Self {
        Self { mean: [area; 2], range: [area; 2], errors: [0.0; N], spread: [0.0; N] }
    }
}

/// The regions of all legs in a rectangle about the origin.
#[derive(Clone, Debug)]
pub struct Regions<const N: usize> {
    half: [f64; 2],
    /// The largest number that a curve was computed from.
    pub size: f64,
    /// The first ones are the sides of the rectangle.
    boundaries: Vec<Boundary>,
    /// The first one is none.
    motions: Vec<Motion<N>>,
    /// The regions that each leg reaches: it is anywhere in them.
    pub legs: Vec<Vec<Reach>>,
}

impl<const N: usize> Regions<N> {
    /// A rectangle with these half sides.
    pub fn new(half: [f64; 2]) -> Self {
        let still = Affine::constant(0.0);
        let mut regions = Self {
            half,
            size: 0.0,
            boundaries: Vec::with_capacity(32),
            motions: vec![Motion::shift(Plane { re: still, im: still })],
            legs: Vec::new(),
        };
        for (normal, offset) in [(1.0, half[0]), (-1.0, half[0])] {
            regions.side(Curve::Line { normal: normal.into(), offset }, 0);
            let offset = half[1];
            regions.side(Curve::Line { normal: Complex::I * normal, offset }, 0);
        }
        regions
    }

    /// The number of a new motion.
    pub fn motion(&mut self, motion: Motion<N>) -> usize {
        self.motions.push(motion);
        self.motions.len() - 1
    }

    /// The inner side of a curve that is placed as in the middle of the box. Curves with the same motion that coincide are
    /// one.
    pub fn side(&mut self, curve: Curve, motion: usize) -> Side {
        let equal = |a: f64, b: f64| (a - b).abs() <= ROUNDING * (self.far() + a.abs());
        let same = |z: Complex<f64>, w: Complex<f64>| equal(z.re, w.re) && equal(z.im, w.im);
        let known = self.boundaries.iter().enumerate().find_map(|(number, boundary)| {
            if boundary.motion != motion {
                return None;
            }
            match (boundary.curve, curve) {
                (Curve::Line { normal, offset }, Curve::Line { normal: n, offset: e }) => {
                    let along = (normal - n).norm() <= ROUNDING && equal(offset, e);
                    let against = (normal + n).norm() <= ROUNDING && equal(offset, -e);
                    (along || against).then_some((number, along))
                }
                (Curve::Circle { centre, radius }, Curve::Circle { centre: other, radius: r }) => {
                    (same(centre, other) && equal(radius, r)).then_some((number, true))
                }
                _ => None,
            }
        });
        if let Some((boundary, inner)) = known {
            return Side { boundary, inner };
        }
        let leg = (self.boundaries.len() >= SIDES).then_some(self.legs.len());
        self.boundaries.push(Boundary { curve, motion, leg });
        Side { boundary: self.boundaries.len() - 1, inner: true }
    }

    /// The area of the rectangle.
    fn whole(&self) -> f64 {
        4.0 * self.half[0] * self.half[1]
    }

    /// The distance of the rectangle's corners from the origin.
    fn far(&self) -> f64 {
        self.half[0].hypot(self.half[1])
    }

    /// Bounds of the area that the legs have in common. Regions that are not sure are left out, if `sure`.
    pub fn area(&self, sure: bool) -> Area<N> {
        let mut tracer = Tracer::new(self, sure);
        match tracer.reached {
            Truth::Yes => return Area::constant(self.whole()),
            Truth::No => return Area::constant(0.0),
            Truth::Maybe => {}
        }
        let mut sum = Sum::new(self.motions.len());
        for at in 0..tracer.crossing.len() {
            sum.add(&mut tracer, at);
        }
        sum.finish(&self.motions, self.whole())
    }
}

#[cfg(test)]
mod tests;
