//! The joint of a leg that carries the height of a Schoenflies section: a slider along its direction, where no other
//! joint changes the height.

use super::Freedom;
use crate::group::subspace::TOLERANCE;
use crate::mechanism::leg::Leg;
use nalgebra::Vector3;
use std::fmt;

/// Which joints of a leg change the height, where that is not one slider along the direction alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeightMiss {
    /// The name of the leg.
    pub leg: String,
    /// The names of the joints.
    pub joints: Vec<String>,
}

impl std::error::Error for HeightMiss {}

impl fmt::Display for HeightMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "closed forms of Schoenflies motion expect one slider along its direction in each leg, and no other joint \
             that changes the height; ",
        )?;
        let leg = &self.leg;
        match &*self.joints {
            [] => write!(f, "no joint of leg {leg} changes it"),
            [one] => {
                write!(
                    f,
                    "in leg {leg}, joint {one} changes it and moves the platform in another way, too"
                )
            }
            several => write!(f, "in leg {leg}, joints {} change it", several.join(", ")),
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
    let slides = |freedom: &Freedom| screw(freedom).angular == Vector3::zeros();
    // What a unit of a joint adds to the height, in metres or shares of the size.
    let advance = |freedom: &Freedom| {
        let screw = screw(freedom);
        if slides(freedom) {
            up.dot(&screw.linear)
        } else {
            screw.angular.dot(&screw.linear) / size
        }
    };
    let changing: Vec<Freedom> =
        freedoms.iter().copied().filter(|freedom| advance(freedom).abs() > TOLERANCE).collect();
    match *changing {
        [lift] if slides(&lift) && 1.0 - advance(&lift).abs() < TOLERANCE => {
            Ok((lift, advance(&lift).signum()))
        }
        _ => {
            let name = |freedom: &Freedom| leg.joints[freedom.joint].name.clone();
            Err(HeightMiss { leg: leg.name.clone(), joints: changing.iter().map(name).collect() })
        }
    }
}
