//! Limits of two neighbouring points of the grid, as half-planes.

/// `a x + b y <= c`, for `x` at the start of an interval and `y` at its end; `c` is positive.
#[derive(Clone, Copy)]
pub(super) struct HalfPlane {
    pub a: f64,
    pub b: f64,
    pub c: f64,
}

/// The largest `x` for which some `y` is within all half-planes, with both between zero and their own largest values.
///
/// At each `x`, `y` is below every upper limit `k - m x` and above every lower one `m x - k`. The gap between the lowest and the
/// highest is concave in `x`, and not negative at 0. From the largest `x` on, the place where the two that cross there meet is
/// taken, until there is a gap: Newton's method, which ends because each step leaves a pair of limits for good.
pub(super) fn largest_start(planes: &[HalfPlane], [most_x, most_y]: [f64; 2]) -> f64 {
    let mut x = most_x;
    for plane in planes.iter().filter(|plane| plane.line().is_none() && plane.a > 0.0) {
        x = x.min(plane.c / plane.a);
    }
    loop {
        // The limits of `y` itself, then those of the half-planes; each with its value there.
        let (mut above, mut below) = ((most_y, [most_y, 0.0]), (0.0, [0.0, 0.0]));
        for plane in planes {
            match plane.line() {
                Some((Side::Above, line @ [k, m])) if k - m * x < above.0 => {
                    above = (k - m * x, line);
                }
                Some((Side::Below, line @ [k, m])) if m * x - k > below.0 => {
                    below = (m * x - k, line);
                }
                _ => {}
            }
        }
        let [[k, m], [other_k, other_m]] = [above.1, below.1];
        let meet = (k + other_k) / (m + other_m);
        if above.0 >= below.0 || meet.is_nan() || meet >= x {
            return x;
        }
        x = meet.max(0.0);
    }
}

/// The largest `y` within all half-planes for this `x`.
pub(super) fn largest_end(planes: &[HalfPlane], x: f64, most_y: f64) -> f64 {
    let above = planes.iter().filter_map(|plane| match plane.line() {
        Some((Side::Above, line)) => Some(line),
        _ => None,
    });
    above.fold(most_y, |most, [k, m]| most.min(k - m * x)).max(0.0)
}

/// On which side of `y` a limit is.
enum Side {
    Above,
    Below,
}

impl HalfPlane {
    /// `by_u u + by_x x <= c` at the start of an interval, where `u = (y - x) / twice`.
    pub fn at_start(by_u: f64, by_x: f64, c: f64, twice: f64) -> Self {
        Self { a: by_x - by_u / twice, b: by_u / twice, c }
    }

    /// The same at its end.
    pub fn at_end(by_u: f64, by_x: f64, c: f64, twice: f64) -> Self {
        Self { a: -by_u / twice, b: by_u / twice + by_x, c }
    }

    /// `k` and `m` for which it is `y <= k - m x` or `y >= m x - k`; `None` if `y` does not matter.
    fn line(self) -> Option<(Side, [f64; 2])> {
        let Self { a, b, c } = self;
        let side = if b > 0.0 { Side::Above } else { Side::Below };
        let size = b.abs();
        (size > f64::EPSILON * a.abs()).then(|| (side, [c / size, a / size]))
    }
}
