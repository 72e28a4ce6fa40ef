//! Where in a plane a chain closes, the rotation of its target fixed: one fixed shape, which the rows
//! of a sweep cut.
//!
//! A chain of the plane whose only limits are on its sliders reaches a convex set less another: a
//! ring, a parallelogram, or what half a disc sweeps as it slides along. A row, a line along the
//! plane's first direction, cuts a convex set in an interval, which takes a square root at most.
//!
//! The chain itself has the last word on which targets it reaches, and ends of intervals are
//! rounded. So a section says whether it is sure, for an end that is right to within a given
//! tolerance ([`Precision`]).

use nalgebra::Complex;

/// A direction's part along the rows that is smaller than this counts as none.
const LEVEL: f64 = 1e-12;

/// Rounding of a coordinate, as a share of the largest number that it is computed from: that of
/// some fifty operations.
const ROUNDING: f64 = 1e-14;

/// In place of the inverse of zero: what it multiplies is beyond any grid, and zero stays zero.
const HUGE: f64 = 1e200;

/// The translations at which a chain closes: those of a convex set that are not inside the `hole`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The convex set.
    pub whole: Convex,
    /// What is missing of it; its rim is not.
    pub hole: Option<Convex>,
}

/// A convex set of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convex {
    /// The points that two bands have in common.
    Bands([Band; 2]),
    /// A circle and its inside.
    Disc(Disc),
    /// The points that are no farther than a radius from a ray.
    Capsule(Capsule),
}

/// The points whose coordinate along a direction lies in a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Unit.
    across: Complex<f64>,
    /// The ends of the range, in the order in which a row meets them.
    met: [f64; 2],
    /// Of the direction's part along the row.
    inverse: f64,
}

/// The points whose squared distance from the centre is at most `square`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    centre: Complex<f64>,
    square: f64,
    /// Its root, zero where there is none.
    radius: f64,
}

/// The points no farther than a radius from a ray: half a band, and the disc about its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    band: Band,
    half: Band,
    tip: Disc,
}

/// What a row cuts from a convex set: nothing where `to < from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// First coordinate of the near end.
    pub from: f64,
    /// First coordinate of the far end.
    pub to: f64,
    /// The ends are right to within the tolerance.
    pub sure: bool,
}

/// From where on the ends of a section are right to within a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// How far from the edge of a band along the rows.
    level: f64,
    /// Least square that a root is taken of.
    square: f64,
    /// Largest inverse of a direction's part along the rows.
    inverse: f64,
}

impl Precision {
    /// For ends that are right to within `tolerance`, where no number is larger than `size`.
    pub fn new(size: f64, tolerance: f64) -> Self {
        let rounding = ROUNDING * size;
        // The root of s, which is off by d, is off by d / (2 root).
        let root = rounding * size / tolerance;
        Self {
            level: rounding + LEVEL * size,
            square: (root * root).max(rounding * size),
            inverse: tolerance / rounding,
        }
    }
}

impl Region {
    /// No translation at all.
    pub const NOTHING: Self = Self { whole: Convex::NOTHING, hole: None };

    /// The region turned about the origin by a unit vector.
    #[must_use]
    pub fn turned(&self, turn: Complex<f64>) -> Self {
        Self { whole: self.whole.turned(turn), hole: self.hole.map(|hole| hole.turned(turn)) }
    }

    /// The region after every one of its points `z` has moved to `scale · (z + shift)`.
    #[inline(always)]
    #[must_use]
    pub fn placed(&self, shift: Complex<f64>, scale: f64) -> Self {
        Self {
            whole: self.whole.placed(shift, scale),
            hole: self.hole.map(|hole| hole.placed(shift, scale)),
        }
    }

    /// Whether every section that says so is right: no edge is so close to the rows' direction that
    /// rounding moves it by more than the tolerance.
    pub fn suits(&self, precision: &Precision) -> bool {
        let suits = |set: &Convex| match set {
            Convex::Bands(bands) => bands.iter().all(|band| band.suits(precision)),
            Convex::Disc(_) => true,
            Convex::Capsule(capsule) => capsule.band.suits(precision),
        };
        suits(&self.whole) && self.hole.as_ref().is_none_or(suits)
    }

    /// The largest finite number in it, which decides how far its sections are rounded.
    pub fn size(&self) -> f64 {
        let size = |set: &Convex| match set {
            Convex::Bands(bands) => bands[0].size().max(bands[1].size()),
            Convex::Disc(disc) => disc.size(),
            Convex::Capsule(capsule) => capsule.tip.size().max(capsule.band.size()),
        };
        size(&self.whole).max(self.hole.as_ref().map_or(0.0, size))
    }
}

impl Convex {
    /// Second coordinates between which all of its points lie whose first ones are in a range: none where
    /// the second number is less than the first.
    pub fn rows(&self, first: [f64; 2]) -> [f64; 2] {
        let common = |a: [f64; 2], b: [f64; 2]| [larger(a[0], b[0]), smaller(a[1], b[1])];
        match self {
            Self::Bands([a, b]) => common(a.rows(first), b.rows(first)),
            Self::Disc(disc) => disc.rows(first),
            Self::Capsule(Capsule { band, half, tip }) => {
                let (straight, round) =
                    (common(band.rows(first), half.rows(first)), tip.rows(first));
                if straight[1] < straight[0] {
                    round
                } else if round[1] < round[0] {
                    straight
                } else {
                    [smaller(straight[0], round[0]), larger(straight[1], round[1])]
                }
            }
        }
    }

    /// The empty set.
    const NOTHING: Self = {
        let band = Band {
            across: Complex::new(1.0, 0.0),
            met: [f64::INFINITY, f64::NEG_INFINITY],
            inverse: 1.0,
        };
        Self::Bands([band; 2])
    };

    fn turned(&self, turn: Complex<f64>) -> Self {
        match self {
            Self::Bands(bands) => Self::Bands(bands.map(|band| band.turned(turn))),
            Self::Disc(disc) => Self::Disc(disc.turned(turn)),
            Self::Capsule(Capsule { band, half, tip }) => Self::Capsule(Capsule {
                band: band.turned(turn),
                half: half.turned(turn),
                tip: tip.turned(turn),
            }),
        }
    }

    #[inline(always)]
    fn placed(&self, shift: Complex<f64>, scale: f64) -> Self {
        match self {
            Self::Bands(bands) => Self::Bands(bands.map(|band| band.placed(shift, scale))),
            Self::Disc(disc) => Self::Disc(disc.placed(shift, scale)),
            Self::Capsule(Capsule { band, half, tip }) => Self::Capsule(Capsule {
                band: band.placed(shift, scale),
                half: half.placed(shift, scale),
                tip: tip.placed(shift, scale),
            }),
        }
    }
}

impl Band {
    /// The points `z` with `range[0] <= Re(conj(across) z) <= range[1]`.
    pub fn new(across: Complex<f64>, range: [f64; 2]) -> Self {
        let along = across.re;
        let inverse = if along.abs() > LEVEL { 1.0 / along } else { HUGE.copysign(along) };
        let met = if inverse > 0.0 { range } else { [range[1], range[0]] };
        Self { across, met, inverse }
    }

    fn turned(&self, turn: Complex<f64>) -> Self {
        let [near, far] = self.met;
        Self::new(turn * self.across, if self.inverse > 0.0 { [near, far] } else { [far, near] })
    }

    #[inline(always)]
    fn placed(&self, shift: Complex<f64>, scale: f64) -> Self {
        let offset = self.across.re * shift.re + self.across.im * shift.im;
        Self { met: self.met.map(|end| scale * (end + offset)), ..*self }
    }

    fn is_level(&self) -> bool {
        self.inverse.abs() == HUGE
    }

    fn suits(&self, precision: &Precision) -> bool {
        self.is_level() || self.inverse.abs() <= precision.inverse || self.is_everything()
    }

    fn is_everything(&self) -> bool {
        self.met.iter().all(|end| end.is_infinite())
    }

    fn rows(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let Complex { re, im } = self.across;
        if im.abs() <= LEVEL {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        let (near, far) = if self.inverse > 0.0 { (0, 1) } else { (1, 0) };
        let low = (self.met[near] - larger(re * from, re * to)) / im;
        let high = (self.met[far] - smaller(re * from, re * to)) / im;
        if im > 0.0 { [low, high] } else { [high, low] }
    }

    fn size(&self) -> f64 {
        let finite = |end: f64| if end.is_finite() { end.abs() } else { 0.0 };
        finite(self.met[0]).max(finite(self.met[1]))
    }

    /// What the row at the second coordinate `y` cuts from it.
    #[inline(always)]
    pub fn chord(&self, y: f64, precision: &Precision) -> Chord {
        // Nothing but `up` differs from row to row.
        let [from, to] = self.met.map(|end| end * self.inverse);
        let up = self.across.im * self.inverse * y;
        let (from, to) = (from - up, to - up);
        let sure = if self.is_level() {
            smaller(from.abs(), to.abs()) > precision.level * HUGE
        } else {
            true
        };
        Chord { from, to, sure }
    }
}

impl Disc {
    /// The points whose squared distance from the centre is at most `square`; none where it is
    /// negative.
    pub fn new(centre: Complex<f64>, square: f64) -> Self {
        Self { centre, square, radius: square.max(0.0).sqrt() }
    }

    fn turned(&self, turn: Complex<f64>) -> Self {
        Self { centre: turn * self.centre, ..*self }
    }

    #[inline(always)]
    fn placed(&self, shift: Complex<f64>, scale: f64) -> Self {
        Self {
            centre: (self.centre + shift) * scale,
            square: self.square * scale * scale,
            radius: self.radius * scale,
        }
    }

    fn rows(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let off = larger(larger(from - self.centre.re, self.centre.re - to), 0.0);
        let square = self.square - off * off;
        if square < 0.0 {
            return [f64::INFINITY, f64::NEG_INFINITY];
        }
        let half = square.sqrt();
        [self.centre.im - half, self.centre.im + half]
    }

    fn size(&self) -> f64 {
        self.centre.l1_norm() + if self.radius.is_finite() { self.radius } else { 0.0 }
    }

    /// The square of half the chord that the row at the second coordinate `y` cuts from it.
    #[inline(always)]
    fn square(&self, y: f64) -> f64 {
        let up = y - self.centre.im;
        self.square - up * up
    }

    /// What the row at the second coordinate `y` cuts from it.
    #[inline(always)]
    pub fn chord(&self, y: f64, precision: &Precision) -> Chord {
        let square = self.square(y);
        let half = larger(square, 0.0).sqrt();
        let gap = missed(square >= 0.0);
        Chord {
            from: self.centre.re - half + gap,
            to: self.centre.re + half - gap,
            sure: square.abs() > precision.square,
        }
    }
}

impl Capsule {
    /// The points no farther than the root of `square` from the ray from `tip` in the direction
    /// `along`; the band on both sides of the ray is `rim` wider, as a share.
    pub fn new(tip: Complex<f64>, along: Complex<f64>, square: f64, rim: f64) -> Self {
        let across = along * Complex::i();
        let radius = square.sqrt() * (1.0 + rim);
        let at = |d: Complex<f64>| d.re * tip.re + d.im * tip.im;
        let middle = at(across);
        Self {
            band: Band::new(across, [middle - radius, middle + radius]),
            half: Band::new(along, [at(along), f64::INFINITY]),
            tip: Disc::new(tip, square),
        }
    }

    /// What the row at the second coordinate `y` cuts from it: the ends that half a band and the disc
    /// have together, since the disc covers the band's blunt end. Where the row runs along the band,
    /// it is near to the band's edge when it is near to touching the disc: the rim, which the band has
    /// more, is far less than what a square has to be for its root to be sure.
    #[inline(always)]
    pub fn chord(&self, y: f64, precision: &Precision) -> Chord {
        let (band, half) = (self.band.chord(y, precision), self.half.chord(y, precision));
        let (from, to) = (larger(band.from, half.from), smaller(band.to, half.to));
        let met = from <= to;
        let from = if met { from } else { f64::INFINITY };
        let to = if met { to } else { f64::NEG_INFINITY };
        // Not a number where the row misses the disc: then the second of two is taken.
        let square = self.tip.square(y);
        let half_chord = square.sqrt();
        Chord {
            from: smaller(self.tip.centre.re - half_chord, from),
            to: larger(self.tip.centre.re + half_chord, to),
            sure: square.abs() > precision.square,
        }
    }
}

/// What the row at the second coordinate `y` cuts from two bands.
#[inline(always)]
pub fn common(bands: &[Band; 2], y: f64, precision: &Precision) -> Chord {
    let [a, b] = [bands[0].chord(y, precision), bands[1].chord(y, precision)];
    Chord { from: larger(a.from, b.from), to: smaller(a.to, b.to), sure: a.sure & b.sure }
}

/// What moves the ends of a section apart the wrong way, where the row misses the set: a sum, since the
/// compiler takes a root out of a choice, and then no longer takes several at once.
#[inline(always)]
fn missed(met: bool) -> f64 {
    if met { 0.0 } else { f64::INFINITY }
}

/// The smaller of two numbers, the second where either is none: one instruction.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The targets `z` for which two sliders along `u` and `v`, whose displacements are in the ranges,
/// make up `z + offset`.
pub(super) fn parallelogram(
    [u, v]: [Complex<f64>; 2],
    offset: Complex<f64>,
    ranges: [[f64; 2]; 2],
) -> Region {
    // m u + n v, taken across v, is m cross(v, u) in the direction i v; and the like for n.
    let band = |kept: Complex<f64>, other: Complex<f64>, [low, high]: [f64; 2]| {
        let across = other * Complex::i();
        let scale = kept.re * across.re + kept.im * across.im;
        let (across, scale) = if scale > 0.0 { (across, scale) } else { (-across, -scale) };
        let at = across.re * offset.re + across.im * offset.im;
        Band::new(across, [scale * low - at, scale * high - at])
    };
    Region { whole: Convex::Bands([band(u, v, ranges[0]), band(v, u, ranges[1])]), hole: None }
}
