//! Names that values of points have besides those of coordinates and joints.

/// The name of the platform's point among the axes of a cloud.
pub const TIP: &str = "tip";
/// The name of one over the condition number, the local conditioning index.
pub const INVERSE_CONDITION: &str = "inverse_condition";
/// The name of the share of the orientations that reach a place.
pub const SHARE: &str = "share";
/// The name of an axis of a cloud along which all points have zero: the set has fewer than three.
pub const NO_AXIS: &str = "0";
