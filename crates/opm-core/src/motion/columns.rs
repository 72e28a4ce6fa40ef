//! Columns of tables that opm writes beside the time, the pose and the joints.

/// What is said of a row, and the indices of a pose.
const NAMES: &[&str] = &[
    "row",
    "assembly",
    "reachable",
    "within_limits",
    "valid",
    "mode",
    "branch",
    "balance",
    "condition",
    "inverse_condition",
    "aspect",
    "share",
    "iti",
    "oti",
    "lti",
    "oci",
    "effort_per_force",
    "effort_per_moment",
    "effort",
    "effort_share",
    "holding_torque",
    "holding_force",
    "payload",
    "payload_moment",
    "payload_ball",
    "acceleration",
    "angular_acceleration",
    "stiffness",
    "rotational_stiffness",
    "natural_frequency",
    "clearance",
];

/// What is before the name of a joint or a coordinate in the column of its rate, acceleration, effort or reaction.
const PREFIXES: [&str; 4] = ["d.", "dd.", "effort.", "reaction."];

/// Whether a name is that of such a column.
pub(super) fn is_column(name: &str) -> bool {
    NAMES.contains(&name) || PREFIXES.iter().any(|prefix| name.starts_with(prefix))
}
