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
/// `y` is eliminated (Fourier and Motzkin): every upper limit of `y`, `y <= k - m x`, must be above every lower one, `y >= m x - k`.
pub(super) fn largest_start(planes: &[HalfPlane], [most_x, most_y]: [f64; 2]) -> f64 {
    let mut most = most_x;
    for one in planes {
        match one.line() {
            None if one.a > 0.0 => most = most.min(one.c / one.a),
            None => {}
            // With the lower limit of `y` itself.
            Some((Side::Above, [k, m])) => {
                if m > 0.0 {
                    most = most.min(k / m);
                }
                for other in planes {
                    if let Some((Side::Below, [below, slope])) = other.line()
                        && m + slope > 0.0
                    {
                        most = most.min((k + below) / (m + slope));
                    }
                }
            }
            // With its upper limit.
            Some((Side::Below, [k, m])) if m > 0.0 => most = most.min((most_y + k) / m),
            Some((Side::Below, _)) => {}
        }
    }
    most
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
