//! Lines and circles that bound regions of the plane, and where one of them passes the others.

use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Whether something holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Truth {
    No,
    Maybe,
    Yes,
}

impl Truth {
    pub fn not(self) -> Self {
        match self {
            Self::No => Self::Yes,
            Self::Maybe => Self::Maybe,
            Self::Yes => Self::No,
        }
    }
}

/// A line or a circle. It runs with its inner side on its left: half a plane or a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// The points `z` with `normal · z = offset`. The inner side has smaller products; `normal` is a unit vector. A place
    /// on the line is the coordinate along `i normal`.
    Line { normal: Complex<f64>, offset: f64 },
    /// A place on the circle is an angle from `-π` to `π`.
    Circle { centre: Complex<f64>, radius: f64 },
}

/// The places on a curve at which it passes another one, in the order in which they follow each other, with whether the
/// inner side is there beyond them.
#[derive(Clone, Copy, Debug)]
pub struct Passages {
    /// Before the first one.
    first: Truth,
    places: [(f64, Truth); 4],
    count: usize,
}

impl Passages {
    /// There are none.
    pub fn constant(first: Truth) -> Self {
        Self { first, places: [(0.0, first); 4], count: 0 }
    }

    fn push(&mut self, place: f64, beyond: Truth) {
        self.places[self.count] = (place, beyond);
        self.count += 1;
    }

    /// Whether the inner side is before a range of places. Calls `passed` at those in the range, its ends included.
    pub fn within(&self, [from, to]: [f64; 2], mut passed: impl FnMut(f64, Truth)) -> Truth {
        let mut at = self.first;
        for &(place, beyond) in &self.places[..self.count] {
            if place < from {
                at = beyond;
            } else if place <= to {
                passed(place, beyond);
            }
        }
        at
    }
}

/// The scalar product of two vectors.
pub fn dot(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.re + a.im * b.im
}

impl Curve {
    /// The largest number of the curve.
    pub fn size(&self) -> f64 {
        match *self {
            Self::Line { offset, .. } => offset.abs(),
            Self::Circle { centre, radius } => centre.norm() + radius,
        }
    }

    /// The point at a place.
    pub fn point(&self, place: f64) -> Complex<f64> {
        match *self {
            Self::Line { normal, offset } => normal * Complex::new(offset, place),
            Self::Circle { centre, radius } => centre + Complex::from_polar(radius, place),
        }
    }

    /// The length of a curve for a unit of its place.
    pub fn rate(&self) -> f64 {
        match *self {
            Self::Line { .. } => 1.0,
            Self::Circle { radius, .. } => radius,
        }
    }

    /// How far the curve is off where the numbers that it is computed from, up to `size`, have a relative error. The radius of
    /// a circle is the root of a difference of squares.
    pub fn uncertainty(&self, size: f64, error: f64) -> f64 {
        match *self {
            Self::Line { .. } => error * size,
            Self::Circle { radius, .. } => {
                2.0 * error * size * size / (radius + radius.hypot(error.sqrt() * size))
            }
        }
    }

    /// All places on the curve that are at most this far from the origin.
    pub fn places(&self, distance: f64) -> [f64; 2] {
        match *self {
            Self::Line { .. } => [-distance, distance],
            Self::Circle { .. } => [-PI, PI],
        }
    }

    /// On which side the rectangle about the origin with these half sides is, if its points are known to within `reach`.
    pub fn side_of_rectangle(&self, [x, y]: [f64; 2], reach: f64) -> Truth {
        match *self {
            Self::Line { normal, offset } => {
                compared(offset, normal.re.abs() * x + normal.im.abs() * y + reach)
            }
            Self::Circle { centre, radius } => {
                let (across, up) = (centre.re.abs(), centre.im.abs());
                let nearest = (across - x).max(0.0).hypot((up - y).max(0.0));
                if (across + x).hypot(up + y) + reach < radius {
                    Truth::Yes
                } else if nearest - reach > radius {
                    Truth::No
                } else {
                    Truth::Maybe
                }
            }
        }
    }

    /// The area between the origin and the curve from one place to another, with the points there: `½ ∫ z × dz`. Of a circle
    /// it is the area under the chord, and that between the chord and the arc. No term is larger than the distance of the
    /// points from the origin times the length of the curve between them, so the rounding is small where they are near, however
    /// large the circle is.
    pub fn swept(&self, [from, to]: [f64; 2], [p, q]: [Complex<f64>; 2]) -> f64 {
        match *self {
            Self::Line { offset, .. } => 0.5 * offset * (to - from),
            Self::Circle { radius, .. } => {
                let angle = to - from;
                let cross = p.re * q.im - p.im * q.re;
                0.5 * (cross + radius * radius * (angle - angle.sin()))
            }
        }
    }

    /// The curve with its inner side wider by a distance.
    pub fn widened(self, by: f64) -> Self {
        match self {
            Self::Line { normal, offset } => Self::Line { normal, offset: offset + by },
            Self::Circle { centre, radius } => Self::Circle { centre, radius: radius + by },
        }
    }

    /// Where this curve passes another one. It is unknown on which side it is at points that are nearer to the other one
    /// than `reach`.
    pub fn passages(&self, other: &Self, reach: f64) -> Passages {
        match (*self, *other) {
            (Self::Line { normal, offset }, Self::Line { normal: n, offset: e }) => {
                let (ahead, slope) = (e - offset * dot(n, normal), dot(n, normal * Complex::I));
                line_past_line(ahead, slope, reach)
            }
            (Self::Line { normal, offset }, Self::Circle { centre, radius }) => {
                let aside = dot(normal, centre) - offset;
                line_past_circle(dot(normal * Complex::I, centre), aside, [radius, reach])
            }
            (Self::Circle { centre, radius }, Self::Line { normal, offset }) => {
                // The inner side is where n · e^{iφ} is at most this.
                let ahead = offset - dot(normal, centre);
                let away = -normal;
                circle(away.im.atan2(away.re), [-ahead - reach, -ahead + reach].map(|c| c / radius))
            }
            (Self::Circle { centre, radius }, Self::Circle { centre: other, radius: r }) => {
                let to = other - centre;
                let distance = to.norm();
                // The law of cosines.
                let cosine = |r: f64| {
                    let square = (radius - r) * (radius + r) + distance * distance;
                    square / (2.0 * distance * radius)
                };
                if distance == 0.0 {
                    return Passages::constant(compared(r - radius, reach));
                }
                let least = if r > reach { cosine(r - reach) } else { f64::INFINITY };
                circle(to.im.atan2(to.re), [cosine(r + reach), least])
            }
        }
    }
}

/// Whether a number is positive that is known to within `reach`.
fn compared(number: f64, reach: f64) -> Truth {
    if number > reach {
        Truth::Yes
    } else if number < -reach {
        Truth::No
    } else {
        Truth::Maybe
    }
}

/// Where `ahead - slope t` changes its sign, known to within `reach`.
fn line_past_line(ahead: f64, slope: f64, reach: f64) -> Passages {
    let (sure, never) = ((ahead - reach) / slope, (ahead + reach) / slope);
    if !(sure.is_finite() && never.is_finite()) {
        return Passages::constant(compared(ahead, reach));
    }
    let mut found = Passages::constant(if slope > 0.0 { Truth::Yes } else { Truth::No });
    if slope > 0.0 {
        found.push(sure, Truth::Maybe);
        found.push(never, Truth::No);
    } else {
        found.push(never, Truth::Maybe);
        found.push(sure, Truth::Yes);
    }
    found
}

/// The chord of a circle, whose radius is known to within `reach`.
fn line_past_circle(middle: f64, aside: f64, [radius, reach]: [f64; 2]) -> Passages {
    let half = |r: f64| (r > aside.abs()).then(|| ((r - aside) * (r + aside)).sqrt());
    let mut found = Passages::constant(Truth::No);
    let Some(outer) = half(radius + reach) else { return found };
    found.push(middle - outer, Truth::Maybe);
    if let Some(inner) = half(radius - reach) {
        found.push(middle - inner, Truth::Yes);
        found.push(middle + inner, Truth::Maybe);
    }
    found.push(middle + outer, Truth::No);
    found
}

/// The angles whose cosine from a direction is at least a number that lies between two.
fn circle(direction: f64, [never, sure]: [f64; 2]) -> Passages {
    let mut found = Passages::constant(Truth::Maybe);
    if never.is_nan() || never > 1.0 {
        found.first = if never > 1.0 { Truth::No } else { Truth::Maybe };
        return found;
    }
    if sure < -1.0 {
        found.first = Truth::Yes;
        return found;
    }
    let angle = |cosine: f64| (-1.0..=1.0).contains(&cosine).then(|| cosine.acos());
    let (outer, inner) = (angle(never), angle(sure));
    // How many of them come before the angle π, whatever their number of turns.
    let (mut before, mut first) = (0, None);
    let mut push = |place: f64, beyond| {
        let turns = ((place + PI) / TAU).floor();
        before += usize::from(*first.get_or_insert(turns) == turns);
        found.push(place - TAU * turns, beyond);
    };
    if let Some(outer) = outer {
        push(direction - outer, Truth::Maybe);
    }
    if let Some(inner) = inner {
        push(direction - inner, Truth::Yes);
        push(direction + inner, Truth::Maybe);
    }
    if let Some(outer) = outer {
        push(direction + outer, Truth::No);
    }
    if found.count > 0 {
        // They follow each other around the circle; the last one before π decides what is at -π.
        let places = &mut found.places[..found.count];
        places.rotate_left(before);
        found.first = places[places.len() - 1].1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve() -> impl Strategy<Value = Curve> {
        let number = || prop_oneof![Just(0.0), Just(1.0), -2.0..2.0_f64];
        let angle = prop_oneof![(0..8_i32).prop_map(|n| f64::from(n) * PI / 4.0), -PI..PI];
        let radius = prop_oneof![Just(1.0), 0.01..3.0_f64];
        prop_oneof![
            (angle, number()).prop_map(|(angle, offset)| {
                Curve::Line { normal: Complex::from_polar(1.0, angle), offset }
            }),
            (number(), number(), radius)
                .prop_map(|(x, y, radius)| Curve::Circle { centre: Complex::new(x, y), radius }),
        ]
    }

    /// How far a point is on the inner side of a curve.
    fn depth(curve: &Curve, z: Complex<f64>) -> f64 {
        match *curve {
            Curve::Line { normal, offset } => offset - dot(normal, z),
            Curve::Circle { centre, radius } => radius - (z - centre).norm(),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(50_000))]

        /// Between two passages, the side is the one that the distance tells.
        #[test]
        fn sides_are_those_of_points(
            one in curve(),
            other in curve(),
            reach in prop_oneof![Just(1e-13), Just(1e-6), 0.0..1.0_f64],
            shares in prop::array::uniform8(0.0..1.0_f64),
        ) {
            let [from, to] = one.places(5.0);
            let mut passed = Vec::new();
            let first = one.passages(&other, reach)
                .within([from, to], |place, side| passed.push((place, side)));
            prop_assert!(passed.is_sorted_by(|a, b| a.0 <= b.0), "{passed:?}");
            for share in shares {
                let place = from + share * (to - from);
                let side = passed.iter().rev().find(|(at, _)| *at <= place).map_or(first, |of| of.1);
                let depth = depth(&other, one.point(place));
                // A tangent is known to the root of the rounding.
                let expected = match side {
                    Truth::Yes => depth > reach - 1e-7,
                    Truth::No => depth < 1e-7 - reach,
                    Truth::Maybe => depth.abs() < reach + 1e-7,
                };
                prop_assert!(expected, "{side:?} {depth} {reach} at {place}: {passed:?}");
            }
        }

        /// The area under a piece is that of its chords.
        #[test]
        fn swept_areas_are_those_of_polygons(one in curve(), ends in [-3.0..3.0_f64, -3.0..3.0]) {
            let [from, to] = ends;
            let steps = 4000;
            let at = |k: i32| one.point(from + (to - from) * f64::from(k) / f64::from(steps));
            let sum: f64 = (0..steps)
                .map(|k| {
                    let (p, q) = (at(k), at(k + 1));
                    0.5 * (p.re * q.im - p.im * q.re)
                })
                .sum();
            let swept = one.swept(ends, ends.map(|place| one.point(place)));
            prop_assert!((sum - swept).abs() < 1e-4, "{sum} {swept}");
        }
    }
}
