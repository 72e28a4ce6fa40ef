//! The region of the plane in which a chain closes, for a fixed rotation of its target. The rows of a
//! sweep are clipped against it.
//!
//! A planar chain whose only limits are on its sliders reaches a convex set with a convex hole: a ring,
//! a parallelogram, or the area that half a disc sweeps as it slides along. A row is a line along the
//! plane's first direction. Its chord of a convex set is an interval, which takes at most one square root.
//!
//! The closed form of the chain decides which targets it reaches, and the ends of chords are rounded. So
//! a chord tells whether its ends are certainly right to within a given tolerance ([`Precision`]).

use nalgebra::Complex;

/// A direction's component along the rows that is smaller than this counts as zero.
const LEVEL: f64 = 1e-12;

/// The rounding of a coordinate, as a fraction of the largest number that it is computed from: that of
/// about fifty operations.
const ROUNDING: f64 = 1e-14;

/// Stands for the inverse of zero: its product with any length is beyond any grid, and its product with
/// zero is zero.
const HUGE: f64 = 1e200;

/// The translations at which a chain closes: those of a convex set that are not inside the `hole`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The convex set.
    pub whole: Convex,
    /// The part of it that is out of reach. The hole's boundary belongs to the region.
    pub hole: Option<Convex>,
}

/// A convex set of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convex {
    /// The intersection of two bands.
    Bands([Band; 2]),
    /// A circle and its interior.
    Disc(Disc),
    /// The points within a radius of a ray.
    Capsule(Capsule),
}

/// The points whose coordinate along a direction lies in a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The unit vector perpendicular to the band.
    across: Complex<f64>,
    /// The ends of the range, in the order in which a row crosses them.
    met: [f64; 2],
    /// The inverse of the component of `across` along the row.
    inverse: f64,
}

/// The points whose squared distance from the centre is at most `square`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    centre: Complex<f64>,
    square: f64,
    /// The root of `square`, zero where `square` is negative.
    radius: f64,
}

/// The points within a radius of a ray: half a band, and the disc about the ray's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    band: Band,
    half: Band,
    tip: Disc,
}

/// The intersection of a row with a convex set; empty where `to < from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// The first coordinate of the near end.
    pub from: f64,
    /// The first coordinate of the far end.
    pub to: f64,
    /// Whether the ends are certainly right to within the tolerance.
    pub sure: bool,
}

/// Thresholds beyond which the ends of a chord are right to within a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// The least distance of a row from the edge of a band that runs along the rows.
    level: f64,
    /// The least absolute value of a number whose root is taken.
    square: f64,
    /// The largest inverse of a direction's component along the rows.
    inverse: f64,
}

impl Precision {
    /// The thresholds for ends that are right to within `tolerance`, where no number is larger than `size`.
    pub fn new(size: f64, tolerance: f64) -> Self {
        let rounding = ROUNDING * size;
        // An error d of s makes an error d / (2 √s) of √s.
        let root = rounding * size / tolerance;
        Self {
            level: rounding + LEVEL * size,
            square: (root * root).max(rounding * size),
            inverse: tolerance / rounding,
        }
    }
}

impl Region {
    /// The empty region.
    pub const NOTHING: Self = Self { whole: Convex::NOTHING, hole: None };

    /// The region rotated about the origin; `rotation` is a unit vector in the direction of the angle.
    #[must_use]
    pub fn turned(&self, rotation: Complex<f64>) -> Self {
        Self {
            whole: self.whole.turned(rotation),
            hole: self.hole.map(|hole| hole.turned(rotation)),
        }
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

    /// Whether [`Chord::sure`] can be relied on: no edge is so close to the rows' direction that rounding
    /// moves its crossing by more than the tolerance.
    pub fn suits(&self, precision: &Precision) -> bool {
        let suits = |set: &Convex| match set {
            Convex::Bands(bands) => bands.iter().all(|band| band.suits(precision)),
            Convex::Disc(_) => true,
            Convex::Capsule(capsule) => capsule.band.suits(precision),
        };
        suits(&self.whole) && self.hole.as_ref().is_none_or(suits)
    }

    /// The largest finite number of the region, which bounds the rounding of its chords.
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
    /// The range of the second coordinate of those points whose first coordinate is in a range. It is empty
    /// where its second number is less than its first.
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

    fn turned(&self, rotation: Complex<f64>) -> Self {
        match self {
            Self::Bands(bands) => Self::Bands(bands.map(|band| band.turned(rotation))),
            Self::Disc(disc) => Self::Disc(disc.turned(rotation)),
            Self::Capsule(Capsule { band, half, tip }) => Self::Capsule(Capsule {
                band: band.turned(rotation),
                half: half.turned(rotation),
                tip: tip.turned(rotation),
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

    /// The unit vector perpendicular to the band.
    pub fn across(&self) -> Complex<f64> {
        self.across
    }

    /// The ends of the range of the coordinate along that vector, the smaller one first.
    pub fn range(&self) -> [f64; 2] {
        let [near, far] = self.met;
        if self.inverse > 0.0 { [near, far] } else { [far, near] }
    }

    fn turned(&self, rotation: Complex<f64>) -> Self {
        Self::new(rotation * self.across, self.range())
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

    /// The chord of the row at the second coordinate `y`.
    #[inline(always)]
    pub fn chord(&self, y: f64, precision: &Precision) -> Chord {
        // Only `up` differs from row to row.
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
    /// The points whose squared distance from the centre is at most `square`; empty where `square` is
    /// negative.
    pub fn new(centre: Complex<f64>, square: f64) -> Self {
        Self { centre, square, radius: square.max(0.0).sqrt() }
    }

    /// The centre.
    pub fn centre(&self) -> Complex<f64> {
        self.centre
    }

    /// The radius; `None` where the disc is empty.
    pub fn radius(&self) -> Option<f64> {
        (self.square >= 0.0).then_some(self.radius)
    }

    fn turned(&self, rotation: Complex<f64>) -> Self {
        Self { centre: rotation * self.centre, ..*self }
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

    /// The square of half the chord of the row at the second coordinate `y`; negative where the row misses
    /// the disc.
    #[inline(always)]
    fn square(&self, y: f64) -> f64 {
        let up = y - self.centre.im;
        self.square - up * up
    }

    /// The chord of the row at the second coordinate `y`.
    #[inline(always)]
    pub fn chord(&self, y: f64, precision: &Precision) -> Chord {
        let square = self.square(y);
        let half = larger(square, 0.0).sqrt();
        let widening = empty_unless(square >= 0.0);
        Chord {
            from: self.centre.re - half + widening,
            to: self.centre.re + half - widening,
            sure: square.abs() > precision.square,
        }
    }
}

impl Capsule {
    /// The points whose distance from the ray from `tip` in the direction `along` is at most the root of
    /// `square`. The half band about the ray is wider than that by the fraction `margin`.
    pub fn new(tip: Complex<f64>, along: Complex<f64>, square: f64, margin: f64) -> Self {
        let across = along * Complex::i();
        let radius = square.sqrt() * (1.0 + margin);
        let at = |d: Complex<f64>| d.re * tip.re + d.im * tip.im;
        let middle = at(across);
        Self {
            band: Band::new(across, [middle - radius, middle + radius]),
            half: Band::new(along, [at(along), f64::INFINITY]),
            tip: Disc::new(tip, square),
        }
    }

    /// The bands that the half band is in, and the disc about the ray's end.
    pub fn parts(&self) -> ([Band; 2], Disc) {
        ([self.band, self.half], self.tip)
    }

    /// The chord of the row at the second coordinate `y`: the union of the chords of the half band and of
    /// the disc, which covers the half band's straight end. A row along the band is near to the band's edge
    /// only where it nearly touches the disc: the margin is far smaller than the least square whose root is
    /// certain.
    #[inline(always)]
    pub fn chord(&self, y: f64, precision: &Precision) -> Chord {
        let (band, half) = (self.band.chord(y, precision), self.half.chord(y, precision));
        let (from, to) = (larger(band.from, half.from), smaller(band.to, half.to));
        let met = from <= to;
        let from = if met { from } else { f64::INFINITY };
        let to = if met { to } else { f64::NEG_INFINITY };
        // NaN where the row misses the disc: then `smaller` and `larger` take their second argument.
        let square = self.tip.square(y);
        let half_chord = square.sqrt();
        Chord {
            from: smaller(self.tip.centre.re - half_chord, from),
            to: larger(self.tip.centre.re + half_chord, to),
            sure: square.abs() > precision.square,
        }
    }
}

/// The chord of the row at the second coordinate `y` through the intersection of two bands.
#[inline(always)]
pub fn common(bands: &[Band; 2], y: f64, precision: &Precision) -> Chord {
    let [a, b] = [bands[0].chord(y, precision), bands[1].chord(y, precision)];
    Chord { from: larger(a.from, b.from), to: smaller(a.to, b.to), sure: a.sure & b.sure }
}

/// Added to the near end and subtracted from the far end, makes a chord empty unless the row meets the
/// set. A sum is used because the compiler moves the root into the branch of a conditional, and the loop is
/// then no longer vectorised.
#[inline(always)]
fn empty_unless(met: bool) -> f64 {
    if met { 0.0 } else { f64::INFINITY }
}

/// The smaller of two numbers; the second where either is NaN. It is one instruction.
#[inline(always)]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers; the second where either is NaN.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The translations `z` for which `z + offset = m u + n v`, with the displacements `m` and `n` of two
/// sliders in their ranges.
pub(super) fn parallelogram(
    [u, v]: [Complex<f64>; 2],
    offset: Complex<f64>,
    ranges: [[f64; 2]; 2],
) -> Region {
    // The component of m u + n v in the direction i v is m cross(v, u); likewise for n.
    let band = |kept: Complex<f64>, other: Complex<f64>, [low, high]: [f64; 2]| {
        let across = other * Complex::i();
        let scale = kept.re * across.re + kept.im * across.im;
        let (across, scale) = if scale > 0.0 { (across, scale) } else { (-across, -scale) };
        let at = across.re * offset.re + across.im * offset.im;
        Band::new(across, [scale * low - at, scale * high - at])
    };
    Region { whole: Convex::Bands([band(u, v, ranges[0]), band(v, u, ranges[1])]), hole: None }
}
