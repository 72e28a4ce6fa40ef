//! What bodies look like: rods, pins, balls and blocks.

use super::centre::TOUCH;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{Point3, Unit, Vector3};

/// A simple solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A round rod between the middles of its two ends.
    Cylinder {
        /// One end.
        from: Point3<f64>,
        /// The other.
        to: Point3<f64>,
        /// Metres.
        radius: f64,
    },
    /// A ball.
    Ball {
        /// Middle.
        centre: Point3<f64>,
        /// Metres.
        radius: f64,
    },
    /// A block, longest along `axis`; how it is turned about that does not matter, since it is square.
    Block {
        /// Middle.
        centre: Point3<f64>,
        /// Direction of its length.
        axis: Unit<Vector3<f64>>,
        /// Metres.
        length: f64,
        /// Of its other two sides, metres.
        width: f64,
    },
}

/// What a part is made of: what decides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Material {
    /// Of the base.
    Base,
    /// Of a link.
    Link,
    /// Of a joint with a motor.
    Actuated,
    /// Of a joint without one.
    Passive,
    /// Of the platform.
    Platform,
    /// Of what is not there: imaginary joints and their links. To be drawn translucent.
    Imaginary,
}

/// A solid of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its shape, in the body's frame.
    pub solid: Solid,
    /// What it is made of.
    pub material: Material,
}

impl Solid {
    pub(super) fn rod([from, to]: [Point3<f64>; 2], radius: f64) -> Self {
        Self::Cylinder { from, to, radius }
    }

    pub(super) fn ball(centre: Point3<f64>, radius: f64) -> Self {
        Self::Ball { centre, radius }
    }

    /// The same solid somewhere else.
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

/// Sizes of parts, metres, in proportion to the mechanism.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    /// Shorter rods are not drawn.
    pub touch: f64,
    /// Radius of a rod.
    pub rod: f64,
    /// Radius of a ball.
    pub ball: f64,
    /// Length of the collar around a pin.
    pub collar: f64,
    /// How far a slider without limits is drawn to go, to either side.
    pub travel: f64,
    pin: f64,
}

/// Whose part it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// The joint's outer body's, or its inner one's.
    pub outer: bool,
    /// It has the joint's own colour, or its body's.
    pub own: bool,
}

impl Sizes {
    pub fn of(size: f64) -> Self {
        Self {
            touch: TOUCH * size,
            rod: 0.012 * size,
            ball: 0.03 * size,
            collar: 0.045 * size,
            travel: 0.5 * size,
            pin: 0.09 * size,
        }
    }

    /// The parts of a joint at its centre.
    pub fn joint(&self, joint: &Joint, centre: Point3<f64>) -> Vec<(Side, Solid)> {
        let inner = |own| Side { outer: false, own };
        let outer = |own| Side { outer: true, own };
        let pin = |axis| self.pin(centre, axis);
        match joint.kind {
            JointKind::Revolute => {
                vec![(inner(true), pin(joint.axis)), (outer(false), self.hub(centre, joint.axis))]
            }
            JointKind::Prismatic => vec![
                (inner(false), self.rail(joint, 0, 1.0, centre)),
                (outer(true), self.block(centre, joint.axis)),
            ],
            JointKind::Cylindrical => vec![
                (inner(false), self.rail(joint, 1, 1.0, centre)),
                (outer(true), self.sleeve(centre, joint.axis)),
            ],
            JointKind::Helical { pitch } => vec![
                (inner(false), self.rail(joint, 0, pitch, centre)),
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

    /// A pin.
    pub fn pin(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        self.cylinder(centre, axis, self.pin, 1.2 * self.rod)
    }

    /// A collar around a pin.
    pub fn hub(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        self.cylinder(centre, axis, self.collar, 2.0 * self.rod)
    }

    /// A slider on a rail.
    pub fn block(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        Solid::Block { centre, axis, length: 1.6 * self.collar, width: self.collar }
    }

    fn sleeve(&self, centre: Point3<f64>, axis: Unit<Vector3<f64>>) -> Solid {
        self.cylinder(centre, axis, 1.6 * self.collar, 2.0 * self.rod)
    }

    /// As far as the slider goes: `advance` metres for one of the coordinate.
    fn rail(&self, joint: &Joint, coordinate: usize, advance: f64, centre: Point3<f64>) -> Solid {
        let coordinate = &joint.coordinates[coordinate];
        let [low, high] = match coordinate.limits {
            Some(limits) => limits.map(|limit| (limit - coordinate.home) * advance),
            None => [-self.travel, self.travel],
        };
        let (low, high) = (low.min(high), low.max(high));
        // A little farther, so that the slider at its limit is still on it.
        let at = |s: f64| centre + joint.axis.into_inner() * s;
        Solid::rod([at(low - self.collar), at(high + self.collar)], 0.6 * self.rod)
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
