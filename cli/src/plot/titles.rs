//! What the panels of a motion are called.

use super::source::Rate;
use super::traces::{Group, Trace};
use opm_analysis::Index;
use opm_core::Quantity;

/// The label of an axis.
pub fn axis(group: Group, quantity: Option<Quantity>, rate: Rate) -> &'static str {
    match (rate, quantity) {
        (Rate::Position, Some(Quantity::Angle)) => "angle",
        (Rate::Position, Some(Quantity::Length)) => "length",
        (Rate::Position, None) if group == Group::Condition => "condition",
        (Rate::Position, None) if group == Group::Efforts => "effort",
        (Rate::Position, None) => "value",
        (Rate::Velocity, _) => "velocity",
        (Rate::Acceleration, _) => "acceleration",
    }
}

/// What an index shows: those that show the same are in one panel. Empty for all other values.
pub fn shown(trace: &Trace) -> &'static str {
    if trace.group != Group::Indices {
        return "";
    }
    match Index::from_name(&trace.name) {
        Some(Index::Iti | Index::Oti | Index::Lti) => "Transmission indices",
        Some(Index::Oci) => "Constraint index",
        Some(Index::EffortPerForce | Index::EffortPerMoment) => "Largest effort for a unit load",
        Some(Index::Effort) => "Largest effort",
        Some(Index::EffortShare) => "Largest share of a max_effort",
        Some(Index::HoldingTorque) => "Largest torque that holds it",
        Some(Index::HoldingForce) => "Largest force that holds it",
        Some(Index::Payload | Index::PayloadMoment | Index::PayloadBall) => "Payload",
        Some(Index::Stiffness | Index::RotationalStiffness) => "Least stiffness",
        Some(Index::NaturalFrequency) => "Lowest natural frequency",
        Some(Index::Acceleration | Index::AngularAcceleration) => "Acceleration in every direction",
        Some(Index::Clearance) => "Distance of the nearest bodies",
        None => "Indices",
    }
}

/// The title of a panel.
pub fn title(traces: &[Trace]) -> String {
    let Some(Trace { group, quantity, rate, .. }) = traces.first() else { return String::new() };
    let what = match (group, quantity) {
        (Group::Pose, Some(Quantity::Length)) if *rate == Rate::Position => "Platform position",
        (Group::Pose, Some(Quantity::Length)) => "Platform",
        (Group::Pose, _) => "Platform orientation",
        (Group::Imaginary, _) => "Imaginary joints",
        (Group::Actuated, _) => "Actuated joints",
        (Group::Passive, _) => "Passive joints",
        (Group::Joints, _) => "Joints",
        (Group::Condition, _) => "Condition number",
        (Group::Singularity, _) => "Singularity measures",
        (Group::Indices, _) => shown(&traces[0]),
        (Group::Efforts, _) => "Efforts of joints",
    };
    match rate {
        Rate::Position => what.to_owned(),
        Rate::Velocity => format!("{what}, velocity"),
        Rate::Acceleration => format!("{what}, acceleration"),
    }
}
