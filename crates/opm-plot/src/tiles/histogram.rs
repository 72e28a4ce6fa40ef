//! Histograms: how often values occur.

use crate::color::DOT;
use crate::drawing::{Path, Rect, Shape};
use crate::frame::Frame;
use std::collections::BTreeMap;

/// The largest number of different values that get a bar each. If there are more, bars are for equal spans.
const MOST_VALUES: usize = 200;
/// The number of equal spans.
const SPANS: usize = 60;
/// The number of parts of the range; values in one part count as equal.
const FINE: f64 = 65_536.0;
/// The share of the room that a bar of a single value takes.
const BAR: f64 = 0.8;

/// A histogram, in bounded memory.
///
/// ```
/// use opm_plot::Histogram;
///
/// let mut histogram = Histogram::new([0.0, 1.0]);
/// for value in [0.0, 0.5, 0.5, 1.0] {
///     histogram.push(value);
/// }
/// assert!(histogram.is_by_value());
/// assert_eq!(histogram.extent().map(|extent| extent[1]), Some([0.0, 2.0]));
/// ```
#[derive(Clone, Debug)]
pub struct Histogram {
    range: [f64; 2],
    /// The number of values in each part of the range, while these are few.
    values: Option<BTreeMap<u64, u64>>,
    spans: Vec<u64>,
}

/// A bar: its ends, and the number of values in it.
type Bar = ([f64; 2], u64);

impl Histogram {
    /// A histogram without values. Values outside this range will not be counted.
    pub fn new(range: [f64; 2]) -> Self {
        Self { range, values: Some(BTreeMap::new()), spans: vec![0; SPANS] }
    }

    /// Counts a value.
    pub fn push(&mut self, value: f64) {
        let [low, high] = self.range;
        let share = (value - low) / (high - low).max(f64::MIN_POSITIVE);
        if !(0.0..=1.0).contains(&share) {
            return;
        }
        self.spans[((share * SPANS as f64) as usize).min(SPANS - 1)] += 1;
        if let Some(values) = &mut self.values {
            *values.entry((share * FINE).round() as u64).or_default() += 1;
            if values.len() > MOST_VALUES {
                self.values = None;
            }
        }
    }

    /// Whether every value has its own bar.
    pub fn is_by_value(&self) -> bool {
        self.values.is_some()
    }

    fn bars(&self) -> Vec<Bar> {
        let [low, high] = self.range;
        let Some(values) = &self.values else {
            let span = (high - low) / SPANS as f64;
            let bar = |(i, &count): (usize, &u64)| {
                ([low + span * i as f64, low + span * (i + 1) as f64], count)
            };
            return self.spans.iter().enumerate().map(bar).collect();
        };
        let numbers: Vec<u64> = values.keys().copied().collect();
        let gap = numbers.windows(2).map(|pair| pair[1] - pair[0]).min();
        let span = match gap {
            Some(gap) => gap as f64 / FINE * (high - low),
            None => (high - low).max(1.0),
        };
        let span = BAR * span.min((high - low).max(1.0) / 8.0);
        let bar = |(&number, &count): (&u64, &u64)| {
            let middle = low + number as f64 / FINE * (high - low);
            ([middle - 0.5 * span, middle + 0.5 * span], count)
        };
        values.iter().map(bar).collect()
    }

    /// The ranges of the figure: that of the bars, and from zero to the longest bar; `None` without values.
    pub fn extent(&self) -> Option<[[f64; 2]; 2]> {
        let bars = self.bars();
        let most = bars.iter().map(|bar| bar.1).max().filter(|&most| most > 0)?;
        let (first, last) = (bars.first()?.0[0], bars.last()?.0[1]);
        Some([[first, last], [0.0, most as f64]])
    }

    /// The bars, from zero up.
    pub(crate) fn draw(&self, frame: &Frame<'_>) -> Vec<Shape> {
        let mut path = Path::default();
        for ([left, right], count) in self.bars() {
            let ([x, bottom], [right, y]) = (frame.at(left, 0.0), frame.at(right, count as f64));
            if count > 0 {
                path.add_rect(Rect { x, y, width: right - x, height: bottom - y });
            }
        }
        vec![Shape::Area(path, DOT)]
    }
}
