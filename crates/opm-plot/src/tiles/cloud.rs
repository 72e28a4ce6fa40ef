//! Points in a plane: few points are drawn as dots, many points as an image of their density.

use crate::MOST_SHAPES;
use crate::color::{Color, DOT, Map};
use crate::drawing::{Image, Path, Rect, Shape};
use crate::frame::Frame;

/// The number of bins in a row and in a column. Points in one bin are one dot.
const BINS: usize = 1024;
/// The numbers of bins in a row that may share a pixel of the image. The first of them is taken that gives a
/// pixel enough points for the image to be more than noise.
const POOLS: [usize; 3] = [4, 8, 16];
const ENOUGH: u64 = 6;
/// The number of pixels in a row of the image file.
const FINE: usize = 768;
/// The radius of a dot.
const RADIUS: f64 = 1.6;

/// Points in a plane, in bounded memory.
///
/// ```
/// use opm_plot::Cloud;
///
/// let mut cloud = Cloud::new([0.0, 1.0], [0.0, 1.0]);
/// cloud.push(0.2, 0.3);
/// assert!(cloud.has_dots());
/// assert_eq!(cloud.points(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct Cloud {
    range: [[f64; 2]; 2],
    counts: Vec<u32>,
    /// One point of every bin, while these are few enough.
    dots: Option<Vec<[f64; 2]>>,
    points: u64,
}

impl Cloud {
    /// A cloud without points. Points outside these ranges are counted at their edge.
    pub fn new(x: [f64; 2], y: [f64; 2]) -> Self {
        Self { range: [x, y], counts: vec![0; BINS * BINS], dots: Some(vec![]), points: 0 }
    }

    /// Adds a point. One that is not finite is left out.
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

    /// The number of points that were added.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Whether the points are drawn as dots. Points that would cover each other are one dot.
    pub fn has_dots(&self) -> bool {
        self.dots.is_some()
    }

    /// The ranges of both axes; `None` without points.
    pub fn extent(&self) -> Option<[[f64; 2]; 2]> {
        (self.points > 0).then_some(self.range)
    }

    /// The number of bins in a row that share a pixel, if the points are not drawn as dots.
    pub(crate) fn pool(&self) -> usize {
        let enough = |pool: &&usize| {
            let filled = self.pools(**pool).iter().filter(|&&count| count > 0).count() as u64;
            self.points >= ENOUGH * filled
        };
        POOLS.iter().find(enough).copied().unwrap_or(POOLS[POOLS.len() - 1])
    }

    /// The number of points in every square of `pool` bins in a row and in a column, the lowest row first.
    pub(crate) fn pools(&self, pool: usize) -> Vec<u64> {
        let side = BINS / pool;
        let mut pools = vec![0; side * side];
        for (bin, &count) in self.counts.iter().enumerate() {
            pools[bin / BINS / pool * side + bin % BINS / pool] += u64::from(count);
        }
        pools
    }

    /// The points. If they are many, they are an image, coloured by the logarithm of their number in a place.
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

/// The density of the clouds of a section, which gives the scale of their colours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Density {
    /// The number of bins in a row that share a pixel.
    pub pool: usize,
    /// The largest number of points in one place.
    pub most: u64,
}
