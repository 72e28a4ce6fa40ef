//! Cubic splines through a table of values, several columns on common knots.
//!
//! The value and its first two derivatives are continuous. The second derivatives `m[i]` at the knots, which are
//! `h[i]` apart, satisfy
//!
//! ```text
//! h[i-1] m[i-1] + 2 (h[i-1] + h[i]) m[i] + h[i] m[i+1] = 6 (d[i] - d[i-1]),   d[i] = (y[i+1] - y[i]) / h[i]
//! ```
//!
//! At the first and at the last knot, [`Ends`] gives the equation. This is a tridiagonal system with a dominant
//! diagonal, so that elimination needs no pivots (J. Stoer, R. Bulirsch, *Introduction to Numerical Analysis*,
//! section 2.4). A periodic spline has the equation above at its end too, with the first knot as the one that
//! follows: its second derivative there is the unknown that two solutions of the system are combined for. The
//! values and slopes at the knots are stored. They determine the cubic between two knots.

use super::Instant;

/// How a spline starts and ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ends {
    /// At rest: the first derivative is zero at both ends.
    #[default]
    Rest,
    /// The second derivative is zero at both ends.
    Natural,
    /// As it ends, so it starts: both derivatives are the same at both ends.
    Periodic,
}

impl Ends {
    /// All of them, with their names in motion files.
    pub const NAMES: [(&'static str, Self); 3] =
        [("rest", Self::Rest), ("natural", Self::Natural), ("periodic", Self::Periodic)];

    /// The name in motion files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Natural => "natural",
            Self::Periodic => "periodic",
        }
    }

    /// The smallest number of knots.
    fn fewest(self) -> usize {
        match self {
            Self::Rest | Self::Natural => 2,
            Self::Periodic => 3,
        }
    }
}

/// Cubic splines on common knots, one for each coordinate.
///
/// ```
/// use opm_core::motion::{Ends, Instant, Spline};
///
/// // Values on a straight line: the natural cubic spline through them is that line.
/// let times = vec![0.0, 0.5, 2.0];
/// let values = times.iter().map(|t| 1.0 + 3.0 * t).collect();
/// let spline = Spline::new(times, vec![values], Ends::Natural)?;
/// let mut instant = Instant::new(1);
/// spline.at(1.2, &mut instant);
/// assert!((instant.pose[0] - 4.6).abs() < 1e-14);
/// assert!((instant.velocity[0] - 3.0).abs() < 1e-14);
/// assert!(instant.acceleration[0].abs() < 1e-13);
/// # Ok::<(), opm_core::motion::SplineError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// The knots, seconds, ascending.
    times: Vec<f64>,
    columns: Vec<Column>,
    ends: Ends,
}

/// Values and slopes of one coordinate at the knots.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// Why there is no spline through given values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// There are too few knots.
    #[error("{given} {noun} given, expected at least {expected}", noun = if *.given == 1 { "time" } else { "times" })]
    TooFew {
        /// The number of knots.
        given: usize,
        /// The smallest number of knots.
        expected: usize,
    },
    /// The times do not increase.
    #[error("the times do not increase")]
    NotIncreasing,
    /// A column does not have one value for each time.
    #[error("a column does not have one value for each time")]
    Length,
    /// The times are so close together that derivatives overflow.
    #[error("the times are so close together that the derivatives overflow")]
    TooClose,
}

impl Spline {
    /// The splines through the values of each column at increasing times, in seconds. Every column has
    /// one value for each time.
    ///
    /// # Errors
    /// If there are fewer than two times (three for a periodic spline), if the times do not increase or are too
    /// close together, or if a column does not have as many values as there are times.
    pub fn new(times: Vec<f64>, columns: Vec<Vec<f64>>, ends: Ends) -> Result<Self, SplineError> {
        let (given, expected) = (times.len(), ends.fewest());
        if given < expected {
            return Err(SplineError::TooFew { given, expected });
        }
        if !times.is_sorted_by(|a, b| a < b) {
            return Err(SplineError::NotIncreasing);
        }
        let columns = columns.into_iter().map(|values| {
            if values.len() != times.len() {
                return Err(SplineError::Length);
            }
            let second = second_derivatives(&times, &values, ends);
            let slopes = slopes(&times, &values, &second, ends);
            let finite = second.iter().chain(&slopes).all(|number| number.is_finite());
            if finite { Ok(Column { values, slopes }) } else { Err(SplineError::TooClose) }
        });
        Ok(Self { columns: columns.collect::<Result<_, _>>()?, times, ends })
    }

    /// How the splines start and end.
    pub fn ends(&self) -> Ends {
        self.ends
    }

    /// The knots, seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The number of columns: one for each coordinate.
    pub fn column_count(&self) -> usize {
        self.columns.len()
    }

    /// Writes the values and their derivatives at time `t`, in seconds, into `out`. A time beyond the
    /// ends counts as the nearer end. `out` is resized if it was made for another number of columns.
    pub fn at(&self, t: f64, out: &mut Instant) {
        out.resize(self.columns.len());
        let last = self.times.len() - 1;
        let t = t.clamp(self.times[0], self.times[last]);
        let i = self.times.partition_point(|&knot| knot <= t).clamp(1, last) - 1;
        let width = self.times[i + 1] - self.times[i];
        let s = t - self.times[i];
        for (number, Column { values, slopes }) in self.columns.iter().enumerate() {
            let (value, slope) = (values[i], slopes[i]);
            let mean = (values[i + 1] - value) / width;
            // The cubic value + slope s + half s² + sixth s³ has the value and the slope of the next knot at
            // s = width.
            let half = (3.0 * mean - 2.0 * slope - slopes[i + 1]) / width;
            let sixth = (slope + slopes[i + 1] - 2.0 * mean) / (width * width);
            out.pose[number] = value + s * (slope + s * (half + s * sixth));
            out.velocity[number] = slope + s * (2.0 * half + s * (3.0 * sixth));
            out.acceleration[number] = 2.0 * half + 6.0 * sixth * s;
        }
    }
}

/// The second derivatives of the spline at its knots.
fn second_derivatives(times: &[f64], values: &[f64], ends: Ends) -> Vec<f64> {
    let last = times.len() - 1;
    let width = |i: usize| times[i + 1] - times[i];
    let mean = |i: usize| (values[i + 1] - values[i]) / width(i);
    let bend = |i: usize| 6.0 * (mean(i) - mean(i - 1));
    match ends {
        Ends::Natural => solve(times, [KNOWN, KNOWN], [0.0, 0.0], bend),
        Ends::Rest => {
            let rows = [[2.0 * width(0), width(0)], [2.0 * width(last - 1), width(last - 1)]];
            solve(times, rows, [6.0 * mean(0), -6.0 * mean(last - 1)], bend)
        }
        Ends::Periodic => {
            // With `m` at both ends the solution is `still + m rise`, and `m` satisfies the equation there.
            let still = solve(times, [KNOWN, KNOWN], [0.0, 0.0], bend);
            let rise = solve(times, [KNOWN, KNOWN], [1.0, 1.0], |_| 0.0);
            let (before, after) = (width(last - 1), width(0));
            let beside = |m: &[f64]| before * m[last - 1] + after * m[1];
            let right = 6.0 * (mean(0) - mean(last - 1)) - beside(&still);
            let end = right / (2.0 * (before + after) + beside(&rise));
            still.iter().zip(&rise).map(|(still, rise)| still + end * rise).collect()
        }
    }
}

/// The diagonal and the other number of an equation that gives a second derivative at an end itself.
const KNOWN: [f64; 2] = [1.0, 0.0];

/// Solves the tridiagonal system. `rows` has the diagonal of the first and of the last equation and the number
/// beside it, `right` their right sides, and `bend` those of the equations between them.
fn solve(
    times: &[f64],
    rows: [[f64; 2]; 2],
    right: [f64; 2],
    bend: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let last = times.len() - 1;
    let width = |i: usize| times[i + 1] - times[i];
    let [[first, first_above], [end, end_below]] = rows;
    let mut second = vec![0.0; times.len()];
    // Elimination leaves `second[i] + above[i] second[i + 1]` on the left of every equation.
    let mut above = vec![0.0; times.len()];
    above[0] = first_above / first;
    second[0] = right[0] / first;
    for i in 1..last {
        let diagonal = 2.0 * (width(i - 1) + width(i)) - width(i - 1) * above[i - 1];
        above[i] = width(i) / diagonal;
        second[i] = (bend(i) - width(i - 1) * second[i - 1]) / diagonal;
    }
    second[last] = (right[1] - end_below * second[last - 1]) / (end - end_below * above[last - 1]);
    for i in (0..last).rev() {
        second[i] -= above[i] * second[i + 1];
    }
    second
}

/// The slopes of the spline at its knots.
fn slopes(times: &[f64], values: &[f64], second: &[f64], ends: Ends) -> Vec<f64> {
    let mut slopes: Vec<f64> = (0..times.len() - 1)
        .map(|i| {
            let width = times[i + 1] - times[i];
            let mean = (values[i + 1] - values[i]) / width;
            mean - width * (2.0 * second[i] + second[i + 1]) / 6.0
        })
        .collect();
    // The last slope is the derivative of the last cubic at its end.
    let i = times.len() - 2;
    let width = times[i + 1] - times[i];
    let sixth = (second[i + 1] - second[i]) / (6.0 * width);
    slopes.push(slopes[i] + width * (second[i] + 3.0 * sixth * width));
    if ends == Ends::Rest {
        // At rest means zero, not rounding.
        (slopes[0], slopes[i + 1]) = (0.0, 0.0);
    }
    slopes
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
    fn a_spline_agrees_with_its_solution_by_hand() {
        let spline =
            Spline::new(vec![0.0, 1.0, 2.0, 3.0], vec![vec![0.0, 1.0, 0.0, 1.0]], Ends::Natural)
                .unwrap();
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

    /// With uneven knots, a spline passes through the values, and two derivatives are continuous.
    #[test]
    fn a_spline_is_smooth_at_its_knots() {
        let times: Vec<f64> = (0..20).map(|i| f64::from(i) + 0.4 * f64::from(i * i % 3)).collect();
        let values: Vec<f64> = times.iter().map(|t| (0.7 * t).sin()).collect();
        let spline = Spline::new(times.clone(), vec![values.clone()], Ends::Natural).unwrap();
        for (&t, &value) in times.iter().zip(&values) {
            assert!((at(&spline, t)[0] - value).abs() < 1e-14);
            let (before, after) = (at(&spline, t - 1e-9), at(&spline, t + 1e-9));
            for order in 0..3 {
                assert!((before[order] - after[order]).abs() < 1e-7, "{t}: order {order}");
            }
        }
        assert!(at(&spline, 0.0)[2].abs() < 1e-12 && at(&spline, 99.0)[2].abs() < 1e-12);
    }

    /// The equations at the top of this file, solved as a dense system by LU with pivots.
    #[test]
    fn second_derivatives_solve_the_dense_system() {
        use nalgebra::{DMatrix, DVector};
        let times = [0.0, 0.3, 1.0, 1.1, 2.5, 4.0, 4.2];
        let values = [1.0, -2.0, 0.5, 0.7, 3.0, -1.0, 0.0];
        let n = times.len();
        let width = |i: usize| times[i + 1] - times[i];
        let mean = |i: usize| (values[i + 1] - values[i]) / width(i);
        let (mut matrix, mut right) = (DMatrix::identity(n, n), DVector::zeros(n));
        for i in 1..n - 1 {
            matrix[(i, i - 1)] = width(i - 1);
            matrix[(i, i)] = 2.0 * (width(i - 1) + width(i));
            matrix[(i, i + 1)] = width(i);
            right[i] = 6.0 * (mean(i) - mean(i - 1));
        }
        let expected = matrix.lu().solve(&right).unwrap();
        let spline = Spline::new(times.into(), vec![values.into()], Ends::Natural).unwrap();
        for (i, &t) in times.iter().enumerate() {
            let second = at(&spline, t)[2];
            assert!((second - expected[i]).abs() < 1e-11 * expected.amax(), "{t}: {second}");
        }
    }

    /// A straight line is its own natural spline, whatever the knots.
    #[test]
    fn a_line_stays_straight() {
        let times = vec![-1.0, 0.0, 0.1, 7.0];
        let values: Vec<f64> = times.iter().map(|t| 3.0 - 2.0 * t).collect();
        let spline = Spline::new(times, vec![values], Ends::Natural).unwrap();
        for t in [-1.0, -0.4, 0.05, 3.3, 7.0] {
            let [value, first, second] = at(&spline, t);
            assert!((value - (3.0 - 2.0 * t)).abs() < 1e-13 && (first + 2.0).abs() < 1e-13);
            assert!(second.abs() < 1e-12);
        }
    }

    /// From rest to rest through two points runs the cubic 3 t² - 2 t³; its speed in the middle is 3/2.
    #[test]
    fn two_points_are_joined_at_rest() {
        let spline = Spline::new(vec![0.0, 1.0], vec![vec![0.0, 1.0]], Ends::Rest).unwrap();
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            let [value, first, second] = at(&spline, t);
            assert!((value - t * t * (3.0 - 2.0 * t)).abs() < 1e-15, "{t}");
            assert!((first - 6.0 * t * (1.0 - t)).abs() < 1e-15, "{t}");
            assert!((second - (6.0 - 12.0 * t)).abs() < 1e-14, "{t}");
        }
        let line = Spline::new(vec![0.0, 2.0], vec![vec![1.0, 5.0]], Ends::Natural).unwrap();
        assert_eq!(at(&line, 0.5), [2.0, 2.0, 0.0]);
    }

    /// A spline whose ends are those of the function is near it everywhere: by at most 5/384 of the fourth power of
    /// the step times the largest fourth derivative (C. A. Hall, W. W. Meyer, *Optimal error bounds for cubic spline
    /// interpolation*, 1976). The functions are a cosine from rest to rest, and a sine over whole periods.
    #[test]
    fn ends_of_the_function_keep_the_fourth_order() {
        use std::f64::consts::PI;
        for (ends, phase) in [(Ends::Rest, PI / 2.0), (Ends::Periodic, 0.4)] {
            for points in [16_i32, 32] {
                let step = 4.0 * PI / f64::from(points);
                // The steps are 1.3 and 0.7 of the mean.
                let time = |i: i32| step * (f64::from(i) + 0.3 * f64::from(i % 2));
                let times: Vec<f64> = (0..=points).map(time).collect();
                let values: Vec<f64> = times.iter().map(|t| (t + phase).sin()).collect();
                let spline = Spline::new(times, vec![values], ends).unwrap();
                let bound = 5.0 / 384.0 * (1.3 * step).powi(4);
                for i in 0..=500 {
                    let t = 4.0 * PI * f64::from(i) / 500.0;
                    let off = at(&spline, t)[0] - (t + phase).sin();
                    assert!(off.abs() <= bound + 1e-14, "{ends:?} {points} {t}: {off:e} {bound:e}");
                }
                let [start, end] = [0.0, 4.0 * PI].map(|t| at(&spline, t));
                if ends == Ends::Rest {
                    assert!(start[1].abs().max(end[1].abs()) < 1e-15, "{} {}", start[1], end[1]);
                    continue;
                }
                for order in 1..3 {
                    assert!((start[order] - end[order]).abs() < 1e-12, "{points}: {order}");
                }
            }
        }
    }

    #[test]
    fn values_without_a_spline_are_refused() {
        let new = |times: &[f64], values: &[f64], ends: Ends| {
            Spline::new(times.into(), vec![values.into()], ends)
        };
        for ends in [Ends::Rest, Ends::Natural] {
            let few = Err(SplineError::TooFew { given: 1, expected: 2 });
            assert_eq!(new(&[0.0], &[0.0], ends), few);
            assert_eq!(new(&[0.0, 1.0, 1.0], &[0.0; 3], ends), Err(SplineError::NotIncreasing));
            assert_eq!(new(&[0.0, 1.0, 2.0], &[0.0; 2], ends), Err(SplineError::Length));
            let close = new(&[0.0, 1e-320, 2e-320], &[0.0, 1.0, 0.0], ends);
            assert_eq!(close, Err(SplineError::TooClose));
        }
        let few = Err(SplineError::TooFew { given: 2, expected: 3 });
        assert_eq!(new(&[0.0, 1.0], &[0.0, 0.0], Ends::Periodic), few);
    }
}
