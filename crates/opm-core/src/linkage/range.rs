//! The values of an input at which a linkage closes.

/// The reported values of the input at which the loop closes. Isolated values, with no closing
/// neighbours, are left out.
#[derive(Clone, Debug, PartialEq)]
pub enum InputRange {
    /// The loop closes at every value modulo 2π: the input is a crank.
    FullTurn,
    /// The loop closes in these closed intervals.
    Intervals {
        /// `[lowest, highest]` of each interval, radians or metres, ascending. The interval around home
        /// contains the home value; the middles of the others are within half a period of home. An
        /// infinite end is no end: a slider may be anywhere. At an end where another joint is at
        /// infinity, the loop itself does not close.
        intervals: Vec<[f64; 2]>,
        /// The intervals repeat after this: 2π for an angle, the lead of its screw for a slider that
        /// moves with a screw. `None` if they do not repeat.
        period: Option<f64>,
    },
}

impl InputRange {
    /// Whether the input can make a full revolution.
    pub fn is_full_turn(&self) -> bool {
        *self == Self::FullTurn
    }

    /// Whether the loop closes with the input at this value, radians or metres.
    pub fn contains(&self, value: f64) -> bool {
        match self {
            Self::FullTurn => value.is_finite(),
            Self::Intervals { intervals, period } => intervals.iter().any(|[low, high]| {
                let plainly = value.is_finite() && (*low..=*high).contains(&value);
                let again = |period: &f64| (value - low).rem_euclid(*period) <= high - low;
                plainly || period.as_ref().is_some_and(again)
            }),
        }
    }
}
