//! Cubic splines through a table of values, on common knots.
//!
//! `numeris` finds the natural cubic spline: value, first and second derivative are continuous, and
//! the second derivative is zero at both ends. It answers with values and slopes; the second
//! derivative, too, follows from those at the knots, since between two knots there is only one cubic
//! with these values and slopes.

use super::Instant;
use numeris::interp::{DynCubicSpline, InterpError};

/// Fewest knots of a natural cubic spline.
pub const FEWEST: usize = 3;

/// Natural cubic splines, one a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    times: Vec<f64>,
    columns: Vec<Column>,
}

/// Values and slopes at the knots.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// Why there is no spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SplineError {
    /// Too few knots.
    #[error("{0} times, expected at least {FEWEST}")]
    TooFew(usize),
    /// Times that do not increase.
    #[error("the times do not increase")]
    NotIncreasing,
    /// A column with another number of values than there are times.
    #[error("not as many values as times")]
    Length,
    /// Times so close together that the slopes overflow.
    #[error("times are too close together")]
    TooClose,
}

impl From<InterpError> for SplineError {
    fn from(error: InterpError) -> Self {
        match error {
            InterpError::TooFewPoints => Self::TooFew(0),
            InterpError::NotSorted => Self::NotIncreasing,
            InterpError::LengthMismatch => Self::Length,
            InterpError::IllConditioned => Self::TooClose,
        }
    }
}

impl Spline {
    /// Through the values of each column at these times, seconds, which increase.
    ///
    /// # Errors
    /// Fewer than three times, times that do not increase or are too close together, or a column of
    /// another length.
    pub fn new(times: Vec<f64>, columns: Vec<Vec<f64>>) -> Result<Self, SplineError> {
        if times.len() < FEWEST {
            return Err(SplineError::TooFew(times.len()));
        }
        let columns = columns.into_iter().map(|values| {
            let spline = DynCubicSpline::new(times.clone(), values.clone())?;
            let slopes: Vec<f64> = times.iter().map(|&t| spline.eval_derivative(t).1).collect();
            let finite = slopes.iter().all(|slope| slope.is_finite());
            if finite { Ok(Column { values, slopes }) } else { Err(SplineError::TooClose) }
        });
        Ok(Self { columns: columns.collect::<Result<_, _>>()?, times })
    }

    /// The knots, seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Values and derivatives at time `t`, which is brought back between the ends.
    ///
    /// # Panics
    /// If `out` is for another number of columns.
    pub fn at(&self, t: f64, out: &mut Instant) {
        assert_eq!(self.columns.len(), out.pose.len(), "columns of the spline");
        let last = self.times.len() - 1;
        let t = t.clamp(self.times[0], self.times[last]);
        let i = self.times.partition_point(|&knot| knot <= t).clamp(1, last) - 1;
        let width = self.times[i + 1] - self.times[i];
        let s = t - self.times[i];
        for (number, Column { values, slopes }) in self.columns.iter().enumerate() {
            let (value, slope) = (values[i], slopes[i]);
            let mean = (values[i + 1] - value) / width;
            // value + slope s + half s² + sixth s³ has the value and slope of the next knot there.
            let half = (3.0 * mean - 2.0 * slope - slopes[i + 1]) / width;
            let sixth = (slope + slopes[i + 1] - 2.0 * mean) / (width * width);
            out.pose[number] = value + s * (slope + s * (half + s * sixth));
            out.velocity[number] = slope + s * (2.0 * half + s * (3.0 * sixth));
            out.acceleration[number] = 2.0 * half + 6.0 * sixth * s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(spline: &Spline, t: f64) -> [f64; 3] {
        let mut out = Instant::new(1);
        spline.at(t, &mut out);
        [out.pose[0], out.velocity[0], out.acceleration[0]]
    }

    /// The natural spline through four points at 0, 1, 2, 3 with values 0, 1, 0, 1, by hand: the
    /// second derivatives at the inner knots obey `4 m₁ + m₂ = -12`, `m₁ + 4 m₂ = 12`.
    #[test]
    fn a_spline_that_was_solved_by_hand() {
        let spline = Spline::new(vec![0.0, 1.0, 2.0, 3.0], vec![vec![0.0, 1.0, 0.0, 1.0]]).unwrap();
        for (t, second) in [(0.0, 0.0), (1.0, -4.0), (2.0, 4.0), (3.0, 0.0), (1.5, 0.0)] {
            assert!((at(&spline, t)[2] - second).abs() < 1e-13, "{t}");
        }
        // On [0, 1]: t + (2/3) (t - t³).
        let [value, first, _] = at(&spline, 0.5);
        assert!((value - (0.5 + 2.0 / 3.0 * 0.375)).abs() < 1e-14);
        assert!((first - (1.0 + 2.0 / 3.0 * 0.25)).abs() < 1e-14);
        assert_eq!(at(&spline, -1.0), at(&spline, 0.0));
        assert_eq!(at(&spline, 9.0), at(&spline, 3.0));
    }

    /// Uneven knots: it passes through the values, and two derivatives are continuous.
    #[test]
    fn a_spline_is_smooth_at_its_knots() {
        let times: Vec<f64> = (0..20).map(|i| f64::from(i) + 0.4 * f64::from(i * i % 3)).collect();
        let values: Vec<f64> = times.iter().map(|t| (0.7 * t).sin()).collect();
        let spline = Spline::new(times.clone(), vec![values.clone()]).unwrap();
        for (&t, &value) in times.iter().zip(&values) {
            assert!((at(&spline, t)[0] - value).abs() < 1e-14);
            let (before, after) = (at(&spline, t - 1e-9), at(&spline, t + 1e-9));
            for order in 0..3 {
                assert!((before[order] - after[order]).abs() < 1e-7, "{t}: order {order}");
            }
        }
        assert!(at(&spline, 0.0)[2].abs() < 1e-12 && at(&spline, 99.0)[2].abs() < 1e-12);
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let new = |times: &[f64], values: &[f64]| Spline::new(times.into(), vec![values.into()]);
        assert_eq!(new(&[0.0, 1.0], &[0.0, 1.0]), Err(SplineError::TooFew(2)));
        assert_eq!(new(&[0.0, 1.0, 1.0], &[0.0; 3]), Err(SplineError::NotIncreasing));
        assert_eq!(new(&[0.0, 1.0, 2.0], &[0.0; 2]), Err(SplineError::Length));
        let close = new(&[0.0, 1e-320, 2e-320], &[0.0, 1.0, 0.0]);
        assert_eq!(close, Err(SplineError::TooClose));
    }
}
