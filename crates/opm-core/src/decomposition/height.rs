//! The joint of a leg that carries the height of a Schoenflies section: a slider along its direction, where no other
//! joint changes the height.

use super::Freedom;
use crate::group::screw::Screw;
use crate::group::subspace::TOLERANCE;
use crate::mechanism::leg::Leg;
use nalgebra::Vector3;
use std::fmt;

/// What closed forms expect of every leg.
const EXPECTED: &str = "closed forms of Schoenflies motion expect one slider along its direction in each leg, and no \
                        other joint that changes the height";

/// Why no joint of a leg carries the height.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMiss {
    /// The name of the leg.
    pub leg: String,
    /// The reason.
    pub reason: HeightReason,
}

/// Why no joint of a leg carries the height.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum HeightReason {
    /// No joint changes the height.
    Nothing,
    /// A slider does, which is not along the direction.
    Inclined {
        /// The name of the joint.
        joint: String,
        /// Its angle with the direction, radians.
        angle: f64,
    },
    /// A screw does, which rotates as well.
    Screw(String),
    /// Several joints do; these are their names, without that of a slider along the direction.
    Several(Vec<String>),
}

impl std::error::Error for HeightMiss {}

impl fmt::Display for HeightMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{EXPECTED}; leg {}: {}", self.leg, self.reason)
    }
}

impl HeightMiss {
    /// The message for a reader who knows the leg.
    pub(crate) fn of_leg(&self) -> String {
        format!("{EXPECTED}: {}", self.reason)
    }
}

impl fmt::Display for HeightReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("no joint changes it"),
            Self::Inclined { joint, angle } => {
                write!(f, "slider {joint} is {:.2} deg off the direction", angle.to_degrees())
            }
            Self::Screw(joint) => write!(f, "screw {joint} changes it"),
            Self::Several(joints) => match &**joints {
                [one] => write!(f, "joint {one} changes it, too"),
                several => write!(f, "joints {} change it", several.join(", ")),
            },
        }
    }
}

/// The joint among `freedoms` that carries the height along the unit direction `up`, base coordinates, and its sense: 1,
/// or -1 where it moves down. Pitches are compared with `size`, metres.
///
/// # Errors
/// There is no such joint, or several joints change the height.
pub(crate) fn lift(
    leg: &Leg,
    freedoms: &[Freedom],
    up: &Vector3<f64>,
    size: f64,
) -> Result<(Freedom, f64), HeightMiss> {
    let screw = |freedom: &Freedom| leg.joints[freedom.joint].screws()[freedom.index];
    let slides = |screw: &Screw| screw.angular == Vector3::zeros();
    // What a unit of a joint adds to the height, in metres or shares of the size.
    let advance = |screw: &Screw| match slides(screw) {
        true => up.dot(&screw.linear),
        false => screw.angular.dot(&screw.linear) / size,
    };
    // The sine of the angle between a slider and the direction.
    let off = |screw: &Screw| up.cross(&screw.linear).norm();
    let is_lift = |freedom: &Freedom| {
        let screw = screw(freedom);
        slides(&screw) && off(&screw) <= TOLERANCE
    };
    let changing: Vec<Freedom> = (freedoms.iter().copied())
        .filter(|freedom| advance(&screw(freedom)).abs() > TOLERANCE)
        .collect();
    let name = |freedom: &Freedom| leg.joints[freedom.joint].name.clone();
    let reason = match *changing {
        [lift] if is_lift(&lift) => return Ok((lift, advance(&screw(&lift)).signum())),
        [] => HeightReason::Nothing,
        [one] if slides(&screw(&one)) => {
            let angle = off(&screw(&one)).atan2(advance(&screw(&one)).abs());
            HeightReason::Inclined { joint: name(&one), angle }
        }
        [one] => HeightReason::Screw(name(&one)),
        _ => {
            let lifts = changing.iter().filter(|freedom| is_lift(freedom)).count();
            let odd = changing.iter().filter(|freedom| lifts != 1 || !is_lift(freedom));
            HeightReason::Several(odd.map(name).collect())
        }
    };
    Err(HeightMiss { leg: leg.name.clone(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::decompose;
    use crate::mechanism::Mechanism;
    use crate::mechanism::joint::{Joint, JointKind};
    use crate::mechanism::{examples, file};
    use nalgebra::{Point3, Unit};

    fn shipped() -> Mechanism {
        let text = examples::find("schoenflies-column-4dof").expect("it is shipped").text;
        file::read(text).expect("it is valid").mechanism
    }

    /// What a changed mechanism is told.
    fn told(change: impl Fn(&mut Mechanism)) -> String {
        let mut mechanism = shipped();
        change(&mut mechanism);
        decompose(&mechanism).expect_err("it has no closed forms").to_string()
    }

    #[test]
    fn what_carries_the_height_in_another_way_is_named() {
        assert!(decompose(&shipped()).is_ok());
        let tilted = |sine: f64| {
            let axis = Unit::new_normalize(Vector3::new(sine, 0.0, 1.0));
            told(|m| m.legs[0].joints[0] = Joint { axis, ..m.legs[0].joints[0].clone() })
        };
        for (sine, degrees) in [(1e-3, "0.06"), (1e-2, "0.57"), (1.0, "45.00")] {
            let found = tilted(sine);
            let part = format!("leg leg1: slider S1 is {degrees} deg off the direction");
            assert!(found.ends_with(&part), "{found}");
        }
        let up = Vector3::z_axis();
        let joint = |kind| Joint::new("extra", kind, up, Point3::new(0.1, 0.3, 0.0));
        let screw = joint(JointKind::Helical { pitch: 0.01 });
        let found = told(|m| m.legs[0].joints[0] = Joint { actuated: true, ..screw.clone() });
        assert!(found.ends_with("leg leg1: screw extra changes it"), "{found}");
        let inclined = Unit::new_normalize(Vector3::new(1.0, 0.0, 0.2));
        let inclined = Joint { axis: inclined, ..joint(JointKind::Prismatic) };
        let found = told(|m| m.legs[0].joints[3] = inclined.clone());
        assert!(found.ends_with("leg leg1: joint extra changes it, too"), "{found}");
    }
}
