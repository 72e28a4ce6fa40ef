//! The report of a violation, with names instead of numbers.

use super::gauge::{Bound, Gauge, GaugedPart, Violation};
use crate::manipulator::{Manipulator, Section};
use crate::mechanism::joint::MotionLimit;

/// The report of a violation: the names of what is violated, and its description in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViolationReport<'a> {
    /// The violation, in numbers.
    pub violation: &'a Violation,
    /// The kind of violation: `reach`, `limit`, `difference`, `rate`, `acceleration` or `singularity`.
    pub kind: &'static str,
    /// The name of the leg that is out of reach or singular, or whose joint is beyond a limit or too fast.
    pub leg: Option<&'a str>,
    /// The name of the joint coordinate that is beyond a limit, or too fast; of a difference, `a - b`.
    pub joint: Option<&'a str>,
    /// The section that is out of reach or singular.
    pub section: Option<Section>,
    /// The limit that a joint is beyond.
    pub bound: Option<Bound>,
}

impl Bound {
    /// The word for the bound: `lowest` or `highest`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lowest => "lowest",
            Self::Highest => "highest",
        }
    }
}

impl<'a> ViolationReport<'a> {
    /// The report of a violation on a trajectory of `manipulator`.
    pub fn new(violation: &'a Violation, manipulator: &'a Manipulator) -> Self {
        let legs = &manipulator.mechanism().legs;
        let leg_of = |coordinate: usize| {
            let mut last = 0;
            legs.iter().find(|leg| {
                last += leg.coordinates().count();
                coordinate < last
            })
        };
        let (kind, leg, joint, bound) = match violation.gauge {
            Gauge::Reach { leg } => {
                let kind = if violation.is_singularity() { "singularity" } else { "reach" };
                (kind, Some(&*legs[leg].name), None, None)
            }
            Gauge::Limit { coordinate, bound } => {
                let joint = &*manipulator.coordinates()[coordinate].name;
                ("limit", leg_of(coordinate).map(|leg| &*leg.name), Some(joint), Some(bound))
            }
            Gauge::Motion { coordinate, limit } => {
                let kind = match limit {
                    MotionLimit::Rate => "rate",
                    MotionLimit::Acceleration => "acceleration",
                };
                let joint = &*manipulator.coordinates()[coordinate].name;
                (kind, leg_of(coordinate).map(|leg| &*leg.name), Some(joint), None)
            }
            Gauge::Difference { number } => {
                let difference = &manipulator.differences()[number];
                let leg = &*legs[difference.legs[0]].name;
                ("difference", Some(leg), Some(&*difference.name), None)
            }
            Gauge::Parallel { .. } => ("singularity", None, None, None),
        };
        Self { violation, kind, leg, joint, section: violation.section, bound }
    }

    /// The unit of the violation's amount: `rad`, `m`, `rad/s`, `m/s`, `rad/s^2`, `m/s^2`, or `1` for a
    /// singularity measure.
    pub fn unit(&self) -> &'static str {
        match (self.violation.quantity, self.violation.gauge) {
            (None, _) => "1",
            (Some(quantity), Gauge::Motion { limit, .. }) => limit.unit(quantity),
            (Some(quantity), _) => quantity.unit(),
        }
    }

    /// The power of time in the unit, to be written after the unit of a length or an angle.
    pub fn per_time(&self) -> &'static str {
        match self.violation.gauge {
            Gauge::Motion { limit, .. } => limit.per_time(),
            _ => "",
        }
    }

    /// The kind of singularity, `serial` or `parallel`; `None` for other violations.
    pub fn singularity(&self) -> Option<&'static str> {
        let serial = matches!(self.violation.gauge, Gauge::Reach { .. });
        (self.kind == "singularity").then_some(if serial { "serial" } else { "parallel" })
    }

    /// A description in words, for instance `leg1: out of reach in its lower section`.
    pub fn what(&self) -> String {
        let section = self.section.map_or_else(String::new, |section| format!("{section} "));
        let of_leg = self.section.map(|section| format!(" its {section} section"));
        let leg = self.leg.unwrap_or_default();
        match self.violation.gauge {
            Gauge::Reach { .. } if self.violation.is_singularity() => {
                let of = of_leg.map_or_else(String::new, |part| format!(" of{part}"));
                format!("{leg}: serial singularity{of}")
            }
            Gauge::Reach { .. } => {
                let inside = of_leg.map_or_else(String::new, |part| format!(" in{part}"));
                format!("{leg}: out of reach{inside}")
            }
            Gauge::Limit { .. } => {
                let joint = self.joint.unwrap_or_default();
                format!("{leg}: {joint} past its {} value", self.bound.map_or("", Bound::name))
            }
            Gauge::Difference { .. } => {
                format!("{leg}: {} beyond its limits", self.joint.unwrap_or_default())
            }
            Gauge::Motion { limit, .. } => {
                format!("{leg}: {} above its {}", self.joint.unwrap_or_default(), limit.key())
            }
            Gauge::Parallel { part: GaugedPart::Whole } => "parallel singularity".to_owned(),
            Gauge::Parallel { .. } => format!("parallel singularity of the {section}section"),
        }
    }

    /// One line with the amount and the time of the worst point, in SI units.
    pub fn si(&self) -> String {
        let Violation { worst, amount, .. } = *self.violation;
        format!("{} by {amount} {} at t = {worst} s", self.what(), self.unit())
    }
}
