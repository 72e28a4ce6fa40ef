//! The gauges that are computed along a motion, and the violations that are found.

use crate::manipulator::{Manipulator, Section};
use crate::mechanism::joint::MotionLimit;
use crate::numeric::Quantity;

/// One end of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bound {
    /// The lower limit.
    Lowest,
    /// The upper limit.
    Highest,
}

/// A continuous function of time that is positive where the motion can be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gauge {
    /// The distance of a leg from its boundary of reach. In reach this is the smaller of its sections' serial
    /// singularity measures. Out of reach it is minus the deficit: an angle in radians, or a length divided
    /// by the characteristic length.
    Reach {
        /// The number of the leg.
        leg: usize,
    },
    /// The distance of a joint coordinate from one of its limits, radians or metres.
    Limit {
        /// The number of the joint coordinate.
        coordinate: usize,
        /// The limit: the lower or the upper one.
        bound: Bound,
    },
    /// How far a difference of joints is inside its limits, radians or metres.
    Difference {
        /// The number of the difference in [`Manipulator::differences`].
        number: usize,
    },
    /// What the limit of a joint coordinate's rate or acceleration leaves above the absolute value, per second
    /// or per second squared.
    Motion {
        /// The number of the joint coordinate.
        coordinate: usize,
        /// The limit: of the rate or of the acceleration.
        limit: MotionLimit,
    },
    /// A parallel singularity measure. It may have either sign, but it must not be zero.
    Parallel {
        /// The part of the mechanism that is measured.
        part: GaugedPart,
    },
}

/// A part of the mechanism that has a parallel singularity measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GaugedPart {
    /// One section.
    Section(Section),
    /// The whole mechanism. Its measure is used if one of the sections has none.
    Whole,
}

/// A part of a motion that the mechanism cannot follow, or a singularity that the motion passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// What is violated: the reach of a leg, a limit of a joint or of its motion, or the regularity of a section. A violation
    /// of a leg's reach without a quantity, whose `end` equals `start`, is a serial singularity that the leg
    /// touches.
    pub gauge: Gauge,
    /// The time when the violation begins, seconds.
    pub start: f64,
    /// The time when the violation ends, seconds. A singularity that the motion passes through ends when it
    /// begins.
    pub end: f64,
    /// The time when the violation is worst, seconds.
    pub worst: f64,
    /// The amount of the violation at its worst, in the unit of `quantity`: how far out of reach or beyond the
    /// limit; beyond a limit of motion, in this unit per second or per second squared. For a singularity it is the absolute value of the measure. It is never negative.
    pub amount: f64,
    /// Whether the amount is an angle or a length, or the derivative of one; `None` for a singularity measure, which has no unit.
    pub quantity: Option<Quantity>,
    /// The section that is out of reach or singular; `None` for a joint limit.
    pub section: Option<Section>,
}

impl Violation {
    /// Whether the violation is a singularity, which has no duration.
    pub fn is_singularity(&self) -> bool {
        self.quantity.is_none()
    }
}

/// The gauges of a manipulator: the reach of every leg, all limits of joints and of their motion, and parallel
/// singularities.
pub(super) fn gauges(manipulator: &Manipulator) -> Vec<Gauge> {
    let reach = (0..manipulator.mechanism().legs.len()).map(|leg| Gauge::Reach { leg });
    let limits = manipulator.limits().iter().enumerate().filter(|(_, limits)| limits.any());
    let limits = limits.flat_map(|(coordinate, _)| {
        [Bound::Lowest, Bound::Highest].map(|bound| Gauge::Limit { coordinate, bound })
    });
    let motion = manipulator.coordinates().iter().enumerate().flat_map(|(coordinate, c)| {
        let given =
            MotionLimit::ALL.into_iter().filter(|limit| limit.of(&c.motion_limits).is_some());
        given.map(move |limit| Gauge::Motion { coordinate, limit })
    });
    let parts = [
        GaugedPart::Section(Section::Upper),
        GaugedPart::Section(Section::Lower),
        GaugedPart::Whole,
    ];
    let parallel = parts.into_iter().map(|part| Gauge::Parallel { part });
    let differences =
        (0..manipulator.differences().len()).map(|number| Gauge::Difference { number });
    reach.chain(limits).chain(differences).chain(motion).chain(parallel).collect()
}
