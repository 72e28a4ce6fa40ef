//! The joint of a leg that carries the height of a Schoenflies section: a slider that is not level or a screw, where no
//! other joint changes the height.

use super::Freedom;
use crate::group::screw::Screw;
use crate::group::subspace::TOLERANCE;
use crate::mechanism::leg::Leg;
use nalgebra::Vector3;
use std::fmt;

/// What closed forms expect of every leg.
const EXPECTED: &str = "closed forms of Schoenflies motion expect that one joint of each leg, a slider or a screw, \
                        changes the height";

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
    /// Several joints do; these are their names, without that of a slider along the direction.
    Several(Vec<String>),
    /// One joint does that also moves the leg in the plane, and the leg has too few other joints in the section.
    Constraining(String),
    /// One joint does that also moves the leg in the plane, and so does the imaginary joint, which is in the same
    /// section.
    Inclined(String),
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
            Self::Constraining(joint) => write!(
                f,
                "joint {joint} changes it, which is no slider along the direction, and the section has too few other \
                 joints"
            ),
            Self::Inclined(joint) => write!(
                f,
                "joint {joint} changes it, which is no slider along the direction, and so does the imaginary joint, \
                 which has to be in the other section then"
            ),
            Self::Several(joints) => match &**joints {
                [one] => write!(f, "joint {one} changes it, too"),
                several => write!(f, "joints {} change it", several.join(", ")),
            },
        }
    }
}

/// The joint among `freedoms` that carries the height along the unit direction `up`, base coordinates, and what a unit of
/// its displacement adds to the height: metres, by metres or radians. Pitches are compared with `size`, metres.
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
    let advance = |screw: &Screw| match slides(screw) {
        true => up.dot(&screw.linear),
        // The pitch, since the axis is along the direction.
        false => screw.angular.dot(&screw.linear) * up.dot(&screw.angular).signum(),
    };
    let is_lift = |freedom: &Freedom| {
        let screw = screw(freedom);
        slides(&screw) && up.cross(&screw.linear).norm() <= TOLERANCE
    };
    let unit = |screw: &Screw| if slides(screw) { 1.0 } else { size };
    let changes = |screw: Screw| advance(&screw).abs() > TOLERANCE * unit(&screw);
    let changing: Vec<Freedom> =
        freedoms.iter().copied().filter(|freedom| changes(screw(freedom))).collect();
    let name = |freedom: &Freedom| leg.joints[freedom.joint].name.clone();
    let reason = match *changing {
        // The direction is exact to within the tolerance.
        [lift] if is_lift(&lift) => return Ok((lift, advance(&screw(&lift)).signum())),
        [lift] => return Ok((lift, advance(&screw(&lift)))),
        [] => HeightReason::Nothing,
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
    use crate::decomposition::mobility::mobility;
    use crate::decomposition::{decompose, passive};
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
        let report = mobility(&mechanism).expect("it is complete");
        passive(&mechanism, &report).expect_err("it has no closed forms by sections").to_string()
    }

    #[test]
    fn what_does_not_carry_the_height_alone_is_named() {
        assert!(decompose(&shipped()).is_ok());
        let up = Vector3::z_axis();
        let joint = |kind| Joint::new("extra", kind, up, Point3::new(0.1, 0.3, 0.0));
        let inclined = Unit::new_normalize(Vector3::new(1.0, 0.0, 0.2));
        let inclined = Joint { axis: inclined, ..joint(JointKind::Prismatic) };
        let found = told(|m| m.legs[0].joints[3] = inclined.clone());
        assert!(found.ends_with("leg leg1: joint extra changes it, too"), "{found}");
        let found = told(|m| m.legs[1].joints[2] = joint(JointKind::Revolute));
        assert!(found.ends_with("leg leg2: no joint changes it"), "{found}");
        let screw = joint(JointKind::Helical { pitch: 0.01 });
        let found = told(|m| {
            m.legs[0].joints[0] = Joint { axis: inclined.axis, ..m.legs[0].joints[0].clone() };
            m.legs[0].joints[3] = screw.clone();
        });
        assert!(found.ends_with("leg leg1: joints S1, extra change it"), "{found}");
    }
}
