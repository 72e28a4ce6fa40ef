//! What is watched along a motion, and what is told of it.

use crate::manipulator::{Manipulator, Section};
use crate::numeric::Quantity;

/// One end of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bound {
    /// The lowest value allowed.
    Lowest,
    /// The highest.
    Highest,
}

/// A continuous function of time that is positive where the motion can be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gauge {
    /// How far a leg is from the end of its reach: the smaller of its sections' serial singularity
    /// measures; out of reach the gap, over the characteristic length where it is one, negative.
    Reach {
        /// Number of the leg.
        leg: usize,
    },
    /// How far a joint coordinate is from one of its limits, radians or metres.
    Limit {
        /// Number of the coordinate.
        coordinate: usize,
        /// Which limit.
        bound: Bound,
    },
    /// A parallel singularity measure: either sign is good, zero is not.
    Parallel {
        /// Of which part of the mechanism.
        part: Part,
    },
}

/// What has a parallel singularity measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// One section.
    Section(Section),
    /// The whole mechanism: watched where a section alone has no measure.
    Whole,
}

/// A part of a motion that the mechanism cannot follow, or a singularity on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// What is violated: a leg's reach, a joint's limit or a section's regularity. A leg's reach with
    /// `end` equal to `start` and no gap is a serial singularity that the leg touches.
    pub gauge: Gauge,
    /// When it begins, seconds.
    pub start: f64,
    /// When it ends; of a singularity that is passed through, when it begins.
    pub end: f64,
    /// When it is worst.
    pub worst: f64,
    /// By how much, there: how far out of reach or past the limit; of a singularity what is left of the
    /// measure. Never negative.
    pub amount: f64,
    /// What the amount measures; `None` for a measure, which has no unit.
    pub quantity: Option<Quantity>,
    /// Which section of the leg is out of reach, or singular.
    pub section: Option<Section>,
}

impl Violation {
    /// It is a singularity, not a stretch of time.
    pub fn is_singularity(&self) -> bool {
        self.quantity.is_none()
    }
}

/// What there is to be watched of a manipulator.
pub(super) fn gauges(manipulator: &Manipulator) -> Vec<Gauge> {
    let reach = (0..manipulator.mechanism().legs.len()).map(|leg| Gauge::Reach { leg });
    let limits = manipulator.limits().iter().enumerate().filter(|(_, limits)| limits.any());
    let limits = limits.flat_map(|(coordinate, _)| {
        [Bound::Lowest, Bound::Highest].map(|bound| Gauge::Limit { coordinate, bound })
    });
    let parts = [Part::Section(Section::Upper), Part::Section(Section::Lower), Part::Whole];
    let parallel = parts.into_iter().map(|part| Gauge::Parallel { part });
    reach.chain(limits).chain(parallel).collect()
}
