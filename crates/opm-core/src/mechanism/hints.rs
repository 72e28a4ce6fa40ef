//! How the pose of the platform is to be measured, where the geometry alone does not say.

use crate::mechanism::leg::Section;
use nalgebra::{Point3, Vector3};
use std::fmt;

/// How the pose of the platform is to be measured. What is not given follows from the geometry, by
/// the rules in the docs of [`task`](crate::task), which also say what a subspace leaves free.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskHints {
    /// The intersection motion's positive direction: the one on the side of this vector.
    pub axis: Option<Vector3<f64>>,
    /// The lower section's frame.
    pub lower: FrameHints,
    /// The upper section's frame.
    pub upper: FrameHints,
    /// Values of task coordinates at home, by name; the others follow from the geometry.
    pub home: Vec<(String, f64)>,
}

/// The frame of one section, base coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameHints {
    /// Direction of the coordinate `x`; in a spherical subspace, of the frame's first axis.
    pub x: Option<Vector3<f64>>,
    /// Positive direction of the coordinate `w`.
    pub w: Option<Vector3<f64>>,
    /// Normal of a plane, about which its angle counts as positive.
    pub normal: Option<Vector3<f64>>,
    /// The point that lengths are measured from, metres.
    pub origin: Option<Point3<f64>>,
}

impl TaskHints {
    /// Those of one section.
    pub fn frame(&self, section: Section) -> &FrameHints {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }
}

/// One of the hints, as files call it: `axis`, `lower.x`, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskKey {
    /// [`TaskHints::axis`]
    Axis,
    /// [`FrameHints::x`]
    X(Section),
    /// [`FrameHints::w`]
    W(Section),
    /// [`FrameHints::normal`]
    Normal(Section),
    /// [`FrameHints::origin`]
    Origin(Section),
}

impl TaskKey {
    /// Its last part: `x`, `w`, `normal`, `origin`, or `axis`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::X(_) => "x",
            Self::W(_) => "w",
            Self::Normal(_) => "normal",
            Self::Origin(_) => "origin",
        }
    }
}

impl fmt::Display for TaskKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        match self {
            Self::Axis => f.write_str(name),
            Self::X(section) | Self::W(section) | Self::Normal(section) | Self::Origin(section) => {
                write!(f, "{section}.{name}")
            }
        }
    }
}
