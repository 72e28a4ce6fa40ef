//! Where a motion cannot be followed, and where bodies are in contact on its way.

use crate::html::digits;
use crate::pickle::pickled;
use opm_core::manipulator as core;
use opm_core::trajectory::{self as core_trajectory, ViolationReport};
use opm_interference::Interference;
use pyo3::prelude::*;

/// A part of a motion that the mechanism cannot follow, or a singularity on its way.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Violation {
    /// ``"reach"``, ``"limit"``, ``"rate"``, ``"acceleration"`` or ``"singularity"``.
    kind: String,
    /// Time at which it starts, seconds.
    start: f64,
    /// Time at which it ends, seconds; equal to `start` for a singularity.
    end: f64,
    /// Time at which it is worst, seconds.
    worst: f64,
    /// How large the violation is at that time, in :attr:`unit`.
    amount: f64,
    /// Unit of the amount: ``"m"``, ``"rad"``; ``"m/s"``, ``"rad/s"``, ``"m/s^2"``, ``"rad/s^2"`` beyond a limit of motion; or ``"1"`` for the remaining measure of a singularity.
    unit: String,
    /// The leg that the violation is about.
    leg: Option<String>,
    /// The joint that is past its limit, or too fast.
    joint: Option<String>,
    /// ``"lower"`` or ``"upper"``: what is out of reach or singular.
    section: Option<String>,
    /// ``"lowest"`` or ``"highest"``: the limit that is passed.
    bound: Option<String>,
    /// ``"serial"`` or ``"parallel"``.
    singularity: Option<String>,
    /// The whole violation in one line.
    message: String,
}

/// A part of a motion in which two bodies are nearer than the clearance.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Contact {
    /// The name of one body.
    one: String,
    /// The name of the other.
    other: String,
    /// Time at which it begins, seconds.
    start: f64,
    /// Time at which it ends, seconds.
    end: f64,
    /// Time at which the two are nearest, seconds.
    worst: f64,
    /// Their distance then, metres; negative where they overlap.
    distance: f64,
}

impl Contact {
    pub(super) fn new(found: &opm_interference::Contact, of: &Interference) -> Self {
        let opm_interference::Contact { pair, start, end, worst, distance } = *found;
        let [one, other] = of.names_of(pair).map(str::to_owned);
        Self { one, other, start, end, worst, distance }
    }
}

pickled!(Contact { one, other, start, end, worst, distance });

#[pymethods]
impl Contact {
    fn __repr__(&self) -> String {
        let Self { one, other, .. } = self;
        let [start, end, distance] = [self.start, self.end, self.distance].map(digits);
        format!("<Contact of {one} and {other} from {start} to {end} s: {distance} m>")
    }
}

impl Violation {
    pub(super) fn new(
        violation: &core_trajectory::Violation,
        manipulator: &core::Manipulator,
    ) -> Self {
        let report = ViolationReport::new(violation, manipulator);
        Self {
            kind: report.kind.to_owned(),
            start: violation.start,
            end: violation.end,
            worst: violation.worst,
            amount: violation.amount,
            unit: report.unit().to_owned(),
            leg: report.leg.map(str::to_owned),
            joint: report.joint.map(str::to_owned),
            section: report.section.map(|section| section.to_string()),
            bound: report.bound.map(|bound| bound.name().to_owned()),
            singularity: report.singularity().map(str::to_owned),
            message: report.si(),
        }
    }
}

pickled!(Violation {
    kind,
    start,
    end,
    worst,
    amount,
    unit,
    leg,
    joint,
    section,
    bound,
    singularity,
    message,
});

#[pymethods]
impl Violation {
    fn __repr__(&self) -> String {
        let [start, end] = [self.start, self.end].map(digits);
        format!("<Violation from {start} to {end} s: {}>", self.message)
    }
}
