//! Names of values of points that are neither coordinates nor joints.

/// The name of the platform's reference point among the axes of a cloud.
pub const TIP: &str = "tip";
/// The name of one over the condition number, the local conditioning index.
pub const INVERSE_CONDITION: &str = "inverse_condition";
/// The name of the share of the orientations that reach a place.
pub const SHARE: &str = "share";
/// The name of the number of the aspect that a pose is in.
pub const ASPECT: &str = "aspect";
/// The name of an unused axis of a cloud, zero at all points: the set has fewer than three axes.
pub const NO_AXIS: &str = "0";
