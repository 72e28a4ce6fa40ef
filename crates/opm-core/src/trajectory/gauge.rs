//! What is watched along a motion, and the violations that are found.

use crate::manipulator::{Manipulator, Section};
use crate::numeric::Quantity;

/// One end of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bound {
    /// The lowest value allowed.
    Lowest,
    /// The highest value allowed.
    Highest,
}

/// A continuous function of time that is positive where the motion can be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gauge {
    /// How far a leg is from the end of its reach. In reach this is the smaller of its sections' serial
    /// singularity measures. Out of reach it is minus the gap: an angle in radians, or a length divided
    /// by the characteristic length.
    Reach {
        /// The number of the leg.
        leg: usize,
    },
    /// How far a joint coordinate is from one of its limits, radians or metres.
    Limit {
        /// The number of the joint coordinate.
        coordinate: usize,
        /// Which of the two limits.
        bound: Bound,
    },
    /// A parallel singularity measure: either sign is good, zero is not.
    Parallel {
        /// The part of the mechanism that is measured.
        part: Part,
    },
}

/// What has a parallel singularity measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// One section.
    Section(Section),
    /// The whole mechanism, which is watched where one of the sections has no measure.
    Whole,
}

/// A part of a motion that the mechanism cannot follow, or a singularity on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// What is violated: a leg's reach, a joint's limit or a section's regularity. A leg's reach with
    /// `end` equal to `start` and no gap is a serial singularity that the leg touches.
    pub gauge: Gauge,
    /// The time when it begins, seconds.
    pub start: f64,
    /// The time when it ends, seconds. A singularity that is passed through ends when it begins.
    pub end: f64,
    /// The time when it is worst, seconds.
    pub worst: f64,
    /// How bad it is at worst, in the unit of `quantity`: how far out of reach or past the limit; for a
    /// singularity what is left of its measure. It is never negative.
    pub amount: f64,
    /// What the amount is, an angle or a length; `None` for a singularity measure, which has no unit.
    pub quantity: Option<Quantity>,
    /// The section that is out of reach or singular; `None` for a joint limit.
    pub section: Option<Section>,
}

impl Violation {
    /// Whether it is a singularity, and not a stretch of time.
    pub fn is_singularity(&self) -> bool {
        self.quantity.is_none()
    }
}

/// The gauges of a manipulator: the reach of every leg, all joint limits, and parallel singularities.
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
