//! Names of columns of tables, which joints cannot have.

/// Names that tables and recordings use for other columns than joints: task coordinates, what is said
/// of a row, and the indices of a pose. Imaginary joints are `tau.` and the leg's name. A rare coordinate
/// (`h`, `tilt`) is refused where the mechanism has it.
pub(super) const RESERVED: &[&str] = &[
    "x",
    "y",
    "z",
    "w",
    "theta",
    "phi",
    "zeta",
    "xi",
    "psi",
    "mu",
    "nu",
    "t",
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
    "payload",
    "payload_moment",
    "payload_ball",
    "stiffness",
    "rotational_stiffness",
    "clearance",
];

/// What is before the name of a joint or a coordinate in the column of its rate, acceleration or effort.
pub(super) const PREFIXES: [&str; 3] = ["d.", "dd.", "effort."];

/// Whether a name is that of a column, and not of a joint.
pub(crate) fn is_column(name: &str) -> bool {
    RESERVED.contains(&name) || PREFIXES.iter().any(|prefix| name.starts_with(prefix))
}
