//! A value over time, of any length, in bounded memory.

/// The number of points of a curve before it is thinned out.
const MOST: usize = 32_768;
/// The most points of a curve that has just been thinned out, so that this is seldom done.
const THINNED: usize = MOST / 4 * 3;
/// The number of spans of time of a thinned curve: several for each pixel.
const SPANS: f64 = 4096.0;

/// A value over time, in bounded memory.
///
/// Of a long curve only those points are kept that can be seen: in each of some thousand spans of time the
/// first, the last, the lowest and the highest point. A value that is not finite is a gap.
///
/// ```
/// use opm_plot::Curve;
///
/// let mut curve = Curve::default();
/// for i in 0..100_000 {
///     curve.push(f64::from(i), f64::from(i).sin());
/// }
/// assert_eq!(curve.samples(), 100_000);
/// assert!(curve.is_thinned() && curve.points().len() < 50_000);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    points: Vec<[f64; 2]>,
    range: Option<[f64; 2]>,
    smallest_positive: Option<f64>,
    samples: u64,
    /// The length of a span, once the curve has been thinned out.
    span: Option<f64>,
}

impl Curve {
    /// Adds a value at a time, or over another value that may also go back.
    pub fn push(&mut self, time: f64, value: f64) {
        self.samples += 1;
        let value = if value.is_finite() {
            let [low, high] = self.range.unwrap_or([value; 2]);
            self.range = Some([low.min(value), high.max(value)]);
            if value > 0.0 {
                let least = self.smallest_positive.unwrap_or(value);
                self.smallest_positive = Some(least.min(value));
            }
            value
        } else {
            f64::NAN
        };
        self.points.push([time, value]);
        if self.points.len() >= MOST {
            self.thin_out();
        }
    }

    /// The points to draw: time and value, which is NaN for a gap.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The lowest and the highest value; `None` if no value is finite.
    pub fn range(&self) -> Option<[f64; 2]> {
        self.range
    }

    /// The lowest value above zero; `None` if there is no such value.
    pub fn smallest_positive(&self) -> Option<f64> {
        self.smallest_positive
    }

    /// The number of values that were added.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Whether points have been left out.
    pub fn is_thinned(&self) -> bool {
        self.span.is_some()
    }

    fn thin_out(&mut self) {
        let times = self.points.iter().map(|point| point[0]);
        let (start, end) = (times.clone().fold(f64::MAX, f64::min), times.fold(f64::MIN, f64::max));
        let span = ((end - start) / SPANS).max(self.span.unwrap_or(0.0));
        if span <= 0.0 || !span.is_finite() {
            // All points are at one time: of a vertical line the ends are kept.
            self.points = extremes(&self.points);
            self.span = Some(0.0);
            return;
        }
        let mut span = span;
        loop {
            let number = |point: &[f64; 2]| ((point[0] - start) / span) as u64;
            let spans = self.points.chunk_by(|a, b| number(a) == number(b));
            self.points = spans.flat_map(extremes).collect();
            if self.points.len() <= THINNED {
                break;
            }
            // A curve that goes back and forth passes every span several times.
            span *= 2.0;
        }
        self.span = Some(span);
    }
}

/// The first, lowest, highest and last point, and a gap if there is one, in their order.
fn extremes(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let value = |&i: &usize| points[i][1];
    let finite = || (0..points.len()).filter(|i| value(i).is_finite());
    let lowest = finite().min_by(|a, b| value(a).total_cmp(&value(b)));
    let highest = finite().max_by(|a, b| value(a).total_cmp(&value(b)));
    let gap = (0..points.len()).find(|i| value(i).is_nan());
    let ends = [Some(0), points.len().checked_sub(1)];
    let mut kept: Vec<usize> = ends.into_iter().chain([lowest, highest, gap]).flatten().collect();
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|i| points[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_curve_is_kept_whole() {
        let mut curve = Curve::default();
        for i in 0..1000 {
            curve.push(f64::from(i), f64::from(i * i));
        }
        assert_eq!(curve.points().len(), 1000);
        assert!(!curve.is_thinned());
        assert_eq!(curve.range(), Some([0.0, 998_001.0]));
        assert_eq!(curve.smallest_positive(), Some(1.0));
    }

    /// In every span of a picture's width the lowest and highest value drawn are those of all values.
    #[test]
    fn a_long_curve_looks_like_itself() {
        let at = |i: u32| {
            let t = f64::from(i);
            let spike = if i == 123_457 { 5.0 } else { 0.0 };
            [t, (t * 0.37).sin() + (t * 1e-4).cos() + spike]
        };
        let mut curve = Curve::default();
        let all: Vec<[f64; 2]> = (0..300_000).map(at).collect();
        for [t, v] in &all {
            curve.push(*t, *v);
        }
        assert!(curve.is_thinned() && curve.points().len() < MOST);
        assert_eq!(curve.samples(), 300_000);
        assert!(curve.points().iter().all(|point| all.contains(point) || point[1].is_nan()));
        assert!(curve.points().is_sorted_by(|a, b| a[0] <= b[0]));
        let extent = |points: &[[f64; 2]], pixel: f64| {
            let inside = points.iter().filter(|p| (p[0] / 300.0).floor() == pixel);
            inside.fold([f64::MAX, f64::MIN], |[l, h], p| [l.min(p[1]), h.max(p[1])])
        };
        for pixel in 0..1000 {
            let [a, b] = [&all[..], curve.points()].map(|points| extent(points, f64::from(pixel)));
            // A span that two pixels share shows its extremes in one of them.
            assert!((a[0] - b[0]).abs() < 0.3 && (a[1] - b[1]).abs() < 0.3, "{pixel} {a:?} {b:?}");
        }
        assert!(curve.points().iter().any(|p| p[0] == 123_457.0), "the spike");
    }

    /// A curve over a value that goes back and forth: each way is drawn with its own extremes.
    #[test]
    fn a_curve_that_goes_back_and_forth_stays_bounded() {
        let mut curve = Curve::default();
        let ways = 12;
        for i in 0..1_200_000 {
            let (way, along) = (i / 100_000, f64::from(i % 100_000));
            let place = if way % 2 == 0 { along } else { 99_999.0 - along };
            curve.push(place, f64::from(way) + 1e-6 * place);
        }
        assert!(curve.points().len() < MOST && curve.is_thinned());
        for way in 0..ways {
            let on = |p: &&[f64; 2]| p[1].floor() == f64::from(way);
            let places = curve.points().iter().filter(on).map(|p| p[0]);
            let ends = places.fold([f64::MAX, f64::MIN], |[a, b], p| [a.min(p), b.max(p)]);
            assert!(ends[0] < 500.0 && ends[1] > 99_500.0, "way {way}: {ends:?}");
        }
    }

    #[test]
    fn gaps_stay_gaps() {
        let mut curve = Curve::default();
        for i in 0..200_000 {
            let gap = (50_000..60_000).contains(&i);
            curve.push(f64::from(i), if gap { f64::INFINITY } else { 1.0 });
        }
        let gap = |p: &&[f64; 2]| p[1].is_nan();
        let times: Vec<f64> = curve.points().iter().filter(gap).map(|p| p[0]).collect();
        assert!(times.first() == Some(&50_000.0) && times.last() > Some(&59_900.0), "{times:?}");
        let mut same = Curve::default();
        (0..100_000).for_each(|i| same.push(1.0, f64::from(i)));
        assert!(same.points().len() < MOST && same.range() == Some([0.0, 99_999.0]));
    }
}
