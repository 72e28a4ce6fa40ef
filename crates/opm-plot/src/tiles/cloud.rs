//! Points in a plane: dots where they are few, how many there are where they are many.

use crate::MOST_SHAPES;
use crate::color::{Color, DOT, Map};
use crate::drawing::{Image, Path, Rect, Shape};
use crate::frame::Frame;

/// Bins in a row and in a column: points in one bin are one dot.
const BINS: usize = 1024;
/// Bins in a row of one pixel of the image.
const POOL: usize = 4;
/// Pixels of the image for one pool, each way.
const FINE: usize = 3;

/// Points in a plane, in bounded memory.
#[derive(Clone, Debug)]
pub struct Cloud {
    range: [[f64; 2]; 2],
    counts: Vec<u32>,
    /// One point of every bin, while they are few enough.
    dots: Option<Vec<[f64; 2]>>,
    points: u64,
}

impl Cloud {
    /// No points so far; all will be in these ranges.
    pub fn new(x: [f64; 2], y: [f64; 2]) -> Self {
        Self { range: [x, y], counts: vec![0; BINS * BINS], dots: Some(vec![]), points: 0 }
    }

    /// Adds a point.
    pub fn push(&mut self, x: f64, y: f64) {
        let bin = |value: f64, [low, high]: [f64; 2]| {
            let share = (value - low) / (high - low).max(f64::MIN_POSITIVE);
            ((share * BINS as f64) as usize).min(BINS - 1)
        };
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        self.points += 1;
        let count = &mut self.counts[bin(y, self.range[1]) * BINS + bin(x, self.range[0])];
        if *count == 0
            && let Some(dots) = &mut self.dots
        {
            dots.push([x, y]);
            if dots.len() > MOST_SHAPES {
                self.dots = None;
            }
        }
        *count = count.saturating_add(1);
    }

    /// Points that were added.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Whether the points are drawn as dots, each for all points that would cover it.
    pub fn has_dots(&self) -> bool {
        self.dots.is_some()
    }

    /// Ranges of the points.
    pub fn extent(&self) -> Option<[[f64; 2]; 2]> {
        (self.points > 0).then_some(self.range)
    }

    /// Most points in one place, where they are not dots.
    pub fn densest(&self) -> u64 {
        self.pools().into_iter().max().unwrap_or(0)
    }

    /// Points in every pool, the lowest row first.
    fn pools(&self) -> Vec<u64> {
        const SIDE: usize = BINS / POOL;
        let mut pools = vec![0; SIDE * SIDE];
        for (bin, &count) in self.counts.iter().enumerate() {
            pools[bin / BINS / POOL * SIDE + bin % BINS / POOL] += u64::from(count);
        }
        pools
    }

    /// The points; where they are many, coloured between one and `densest` by the logarithm.
    pub(crate) fn draw(&self, frame: &Frame<'_>, densest: u64) -> Vec<Shape> {
        if let Some(dots) = &self.dots {
            let radius = if dots.len() > 400 { 1.4 } else { 2.2 };
            let mut path = Path::default();
            for [x, y] in dots {
                path.add_dot(frame.at(*x, *y), radius);
            }
            return vec![Shape::Area(path, DOT)];
        }
        const SIDE: usize = BINS / POOL;
        let color = |count: u64| {
            let share = (count as f64).ln() / (densest as f64).ln().max(f64::MIN_POSITIVE);
            (count > 0).then(|| Map::Cividis.color(share))
        };
        let mut pixels: Vec<Option<Color>> = Vec::with_capacity((SIDE * FINE).pow(2));
        for row in self.pools().chunks(SIDE).rev() {
            let row: Vec<_> =
                row.iter().flat_map(|&n| std::iter::repeat_n(color(n), FINE)).collect();
            (0..FINE).for_each(|_| pixels.extend_from_slice(&row));
        }
        let side = (SIDE * FINE) as u32;
        let [[left, right], [low, high]] = self.range;
        let ([x, bottom], [right, y]) = (frame.at(left, low), frame.at(right, high));
        let place = Rect { x, y, width: right - x, height: bottom - y };
        vec![Shape::Image { place, image: Image { width: side, height: side, pixels } }]
    }
}
