//! What there is to say of a violation: names instead of numbers.

use super::gauge::{Bound, Gauge, Part, Violation};
use crate::manipulator::{Manipulator, Section};
use crate::numeric::Quantity;

/// A violation in names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told<'a> {
    /// What is told.
    pub violation: &'a Violation,
    /// `reach`, `limit` or `singularity`.
    pub kind: &'static str,
    /// The leg that is out of reach or singular, or has the joint that is past a limit.
    pub leg: Option<&'a str>,
    /// The joint that is past a limit.
    pub joint: Option<&'a str>,
    /// Which section is out of reach or singular.
    pub section: Option<Section>,
    /// Which limit.
    pub bound: Option<Bound>,
}

impl Bound {
    /// `lowest` or `highest`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lowest => "lowest",
            Self::Highest => "highest",
        }
    }
}

impl<'a> Told<'a> {
    /// Of a violation on a trajectory of `manipulator`.
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
            Gauge::Parallel { .. } => ("singularity", None, None, None),
        };
        Self { violation, kind, leg, joint, section: violation.section, bound }
    }

    /// Of its amount: `rad`, `m` or `1`.
    pub fn unit(&self) -> &'static str {
        self.violation.quantity.map_or("1", Quantity::unit)
    }

    /// `serial` or `parallel`, of a singularity.
    pub fn singularity(&self) -> Option<&'static str> {
        let serial = matches!(self.violation.gauge, Gauge::Reach { .. });
        (self.kind == "singularity").then_some(if serial { "serial" } else { "parallel" })
    }

    /// What is wrong, without when and how much.
    pub fn what(&self) -> String {
        let section = self.section.map_or_else(String::new, |section| format!("{section} "));
        let leg = self.leg.unwrap_or_default();
        match self.violation.gauge {
            Gauge::Reach { .. } if self.violation.is_singularity() => {
                format!("{leg}: serial singularity of its {section}section")
            }
            Gauge::Reach { .. } => format!("{leg}: out of reach in its {section}section"),
            Gauge::Limit { .. } => {
                let joint = self.joint.unwrap_or_default();
                format!("{leg}: {joint} past its {} value", self.bound.map_or("", Bound::name))
            }
            Gauge::Parallel { part: Part::Whole } => "parallel singularity".to_owned(),
            Gauge::Parallel { .. } => format!("parallel singularity of the {section}section"),
        }
    }

    /// One line, in SI.
    pub fn si(&self) -> String {
        let Violation { worst, amount, .. } = *self.violation;
        format!("{} by {amount} {} at t = {worst} s", self.what(), self.unit())
    }
}
