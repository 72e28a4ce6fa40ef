//! Points in a plane: dots where they are few, how many there are where they are many.

use crate::MOST_SHAPES;
use crate::color::{Color, DOT, Map};
use crate::drawing::{Image, Path, Rect, Shape};
use crate::frame::Frame;

/// Bins in a row and in a column: points in one bin are one dot.
const BINS: usize = 1024;
/// Bins in a row that share a pixel of the image: the first of these that gives so many points to a
/// pixel that the image is more than noise.
const POOLS: [usize; 3] = [4, 8, 16];
const ENOUGH: u64 = 6;
/// Pixels of the image file in a row.
const FINE: usize = 768;
/// Radius of a dot.
const RADIUS: f64 = 1.6;

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

    /// How many bins in a row share a pixel, where the points are not dots.
    pub(crate) fn pool(&self) -> usize {
        let enough = |pool: &&usize| {
            let filled = self.pools(**pool).iter().filter(|&&count| count > 0).count() as u64;
            self.points >= ENOUGH * filled
        };
        POOLS.iter().find(enough).copied().unwrap_or(POOLS[POOLS.len() - 1])
    }

    /// Points in every place of so many bins in a row and in a column, the lowest row first.
    pub(crate) fn pools(&self, pool: usize) -> Vec<u64> {
        let side = BINS / pool;
        let mut pools = vec![0; side * side];
        for (bin, &count) in self.counts.iter().enumerate() {
            pools[bin / BINS / pool * side + bin % BINS / pool] += u64::from(count);
        }
        pools
    }

    /// The points; where they are many, coloured by the logarithm of their number in a place.
    pub(crate) fn draw(&self, frame: &Frame<'_>, density: Density) -> Vec<Shape> {
        if let Some(dots) = &self.dots {
            let mut path = Path::default();
            for [x, y] in dots {
                path.add_dot(frame.at(*x, *y), RADIUS);
            }
            return vec![Shape::Area(path, DOT)];
        }
        let side = BINS / density.pool;
        let fine = FINE / side;
        let color = |count: u64| {
            let share = (count as f64).ln() / (density.most as f64).ln().max(f64::MIN_POSITIVE);
            (count > 0).then(|| Map::Cividis.color(share))
        };
        let mut pixels: Vec<Option<Color>> = Vec::with_capacity((side * fine).pow(2));
        for row in self.pools(density.pool).chunks(side).rev() {
            let row: Vec<_> =
                row.iter().flat_map(|&n| std::iter::repeat_n(color(n), fine)).collect();
            (0..fine).for_each(|_| pixels.extend_from_slice(&row));
        }
        let side = (side * fine) as u32;
        let [[left, right], [low, high]] = self.range;
        let ([x, bottom], [right, y]) = (frame.at(left, low), frame.at(right, high));
        let place = Rect { x, y, width: right - x, height: bottom - y };
        vec![Shape::Image { place, image: Image { width: side, height: side, pixels } }]
    }
}

/// How dense the clouds of a section are: what their colours are measured by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Density {
    /// Bins in a row that share a pixel.
    pub pool: usize,
    /// Most points in one place.
    pub most: u64,
}
