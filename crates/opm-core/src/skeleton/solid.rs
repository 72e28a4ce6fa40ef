//! The shapes of bodies: rods, pins, balls and blocks.

use super::centre::TOUCH;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{Point3, Unit, Vector3};

/// A simple solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A round rod between the centres of its two ends.
    Cylinder {
        /// The centre of one end, metres.
        from: Point3<f64>,
        /// The centre of the other end, metres.
        to: Point3<f64>,
        /// Radius, metres.
        radius: f64,
    },
    /// A ball.
    Ball {
        /// Centre, metres.
        centre: Point3<f64>,
        /// Radius, metres.
        radius: f64,
    },
    /// A block, longest along `axis`. Its cross-section is square; its rotation about the axis is
    /// not specified.
    Block {
        /// Centre, metres.
        centre: Point3<f64>,
        /// Direction of the length.
        axis: Unit<Vector3<f64>>,
        /// Length along the axis, metres.
        length: f64,
        /// Length of the sides perpendicular to the axis, metres.
        width: f64,
    },
}

/// The kind of body or joint that a part belongs to, which decides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Material {
    /// A part of the base.
    Base,
    /// A part of a link.
    Link,
    /// A part of an actuated joint.
    Actuated,
    /// A part of a passive joint.
    Passive,
    /// A part of the platform.
    Platform,
    /// A part of something that does not exist physically: an imaginary joint or its link. Draw it
    /// translucent.
    Imaginary,
}

impl Material {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Link => "link",
            Self::Actuated => "actuated",
            Self::Passive => "passive",
            Self::Platform => "platform",
            Self::Imaginary => "imaginary",
        }
    }
}

/// What a part of a body stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    /// A rod between two joints of the body, or from a joint of the platform to its reference point.
    Rod,
    /// A guide of a slider, as long as the slider's travel. A slider without limits has a guide of any length.
    Guide {
        /// Whether its length follows from limits.
        limited: bool,
    },
    /// A pin, a collar, a block or a ball: a sign for a joint.
    Joint,
    /// A ring of rods from leg to leg: a sign for the base.
    Ring,
}

/// A solid that is a part of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPart {
    /// The shape, in the body's frame.
    pub solid: Solid,
    /// The kind of body or joint, which decides the colour.
    pub material: Material,
    /// What it stands for.
    pub kind: PartKind,
}

impl Solid {
    pub(super) fn rod([from, to]: [Point3<f64>; 2], radius: f64) -> Self {
        Self::Cylinder { from, to, radius }
    }

    pub(super) fn ball(centre: Point3<f64>, radius: f64) -> Self {
        Self::Ball { centre, radius }
    }

    /// The same solid, moved by a vector.
    #[must_use]
    pub(super) fn moved(self, by: Vector3<f64>) -> Self {
        match self {
            Self::Cylinder { from, to, radius } => {
                Self::Cylinder { from: from + by, to: to + by, radius }
            }
            Self::Ball { centre, radius } => Self::Ball { centre: centre + by, radius },
            Self::Block { centre, axis, length, width } => {
                Self::Block { centre: centre + by, axis, length, width }
            }
        }
    }
}

/// Sizes of parts in metres, in proportion to the mechanism.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    /// Rods shorter than this are not drawn.
    pub touch: f64,
    /// Radius of a rod.
    pub rod: f64,
    /// Radius of a slider's guide.
    pub guide: f64,
    /// Radius of a ball.
    pub ball: f64,
    /// Length of the collar around a pin.
    pub collar: f64,
    /// How far a slider without limits is drawn to travel to either side.
    pub travel: f64,
    pub pin: f64,
}

/// Which of a joint's two bodies a part belongs to, and its colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Whether the part belongs to the joint's body on the platform side.
    pub outer: bool,
    /// Whether the part has the joint's own colour rather than its body's.
    pub own: bool,
    pub kind: PartKind,
}

impl Sizes {
    pub fn of(size: f64) -> Self {
        Self {
            touch: TOUCH * size,
            rod: 0.012 * size,
            guide: 0.6 * 0.012 * size,
            ball: 0.03 * size,
            collar: 0.045 * size,
            travel: 0.5 * size,
            pin: 0.09 * size,
        }
    }

    /// The parts of a joint with the given centre.
    pub fn joint(&self, joint: &Joint, centre: Point3<f64>) -> Vec<(Side, Solid)> {
        let inner = |own| Side { outer: false, own, kind: PartKind::Joint };
        let outer = |own| Side { outer: true, own, kind: PartKind::Joint };
        let guide = |coordinate: usize| {
            let limited = joint.coordinates[coordinate].limits.is_some();
            Side { outer: false, own: false, kind: PartKind::Guide { limited } }
        };
        let pin = |axis| self.pin(centre, axis);
        match joint.kind {
            JointKind::Revolute => {
                vec![(inner(true), pin(joint.axis)), (outer(false), self.hub(centre, joint.axis))]
            }
            JointKind::Prismatic => vec![
                (guide(0), self.rail(joint, 0, 1.0, centre)),
                (outer(true), self.block(centre, joint.axis)),
            ],
            JointKind::Cylindrical => vec![
                (guide(1), self.rail(joint, 1, 1.0, centre)),
                (outer(true), self.sleeve(centre, joint.axis)),
            ],
            JointKind::Helical { pitch } => vec![
                (guide(0), self.rail(joint, 0, pitch, centre)),
                (outer(true), self.sleeve(centre, joint.axis)),
            ],
            JointKind::Universal { second } => vec![
                (inner(true), pin(joint.axis)),
                (outer(true), pin(second)),
                (inner(true), Solid::ball(centre, 0.6 * self.ball)),
            ],
            JointKind::Spherical => vec![(inner(true), Solid::ball(centre, self.ball))],
        }
    }

    /// A pin along an axis.
    pub fn pin(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        self.cylinder(centre, axis, self.pin, 1.2 * self.rod)
    }

    /// A collar around a pin.
    pub fn hub(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        self.cylinder(centre, axis, self.collar, 2.0 * self.rod)
    }

    /// The slider of a rail.
    pub fn block(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        Solid::Block { centre, axis, length: 1.6 * self.collar, width: self.collar }
    }

    fn sleeve(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        self.cylinder(centre, axis, 1.6 * self.collar, 2.0 * self.rod)
    }

    /// A rail as long as the slider's travel; the slider moves `advance` metres per unit of the
    /// coordinate.
    fn rail(&self, joint: &Joint, coordinate: usize, advance: f64, centre: Point3<f64>) -> Solid {
        let coordinate = &joint.coordinates[coordinate];
        let [low, high] = match coordinate.limits {
            Some(limits) => limits.map(|limit| (limit - coordinate.home) * advance),
            None => [-self.travel, self.travel],
        };
        let (low, high) = (low.min(high), low.max(high));
        // A little longer, so that the slider is still on it at its limit.
        let at = |s: f64| centre + joint.axis.into_inner() * s;
        Solid::rod([at(low - self.collar), at(high + self.collar)], self.guide)
    }

    fn cylinder(
        &self,
        centre: Point3<f64>,
        axis: Unit<Vector3<f64>>,
        length: f64,
        radius: f64,
    ) -> Solid {
        let half = axis.into_inner() * (0.5 * length);
        Solid::rod([centre - half, centre + half], radius)
    }
}
