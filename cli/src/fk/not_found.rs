//! Why no assembly was found near a pose, and what to do.

use super::{least, shown};
use crate::text::reason;
use opm_core::Quantity;
use opm_core::forward::{NearStop, NotFound};
use opm_core::manipulator::{Manipulator, Mode, Unreachable};
use opm_core::mechanism::file::FileUnits;
use std::f64::consts::TAU;

/// Where the search from a pose ended: the leg or the singularity that stopped it, and the joint that is farthest from its
/// given value.
pub fn explain(
    manipulator: &Manipulator,
    (actuated, mode): (&[f64], Mode),
    not_found: &NotFound,
    units: FileUnits,
) -> String {
    let signs = shown(manipulator, mode);
    let leg = |unreachable: &Unreachable| {
        let leg = &manipulator.mechanism().legs[unreachable.leg].name;
        format!("{leg}: {}", reason(unreachable, units))
    };
    if let (NearStop::OutOfReach(unreachable), 0) = (&not_found.why, not_found.steps) {
        return format!(
            "the start is out of reach in mode {signs}: {}; start elsewhere (--near), or in another mode \
             (--mode)",
            leg(unreachable)
        );
    }
    if let Ok(Some(change)) = manipulator.least_change(actuated) {
        let lines = least::lines(manipulator, &change, units);
        return format!("no assembly from any start: {}", lines.join("; "));
    }
    let why = match &not_found.why {
        NearStop::OutOfReach(unreachable) => {
            format!("the next step leads out of reach, {}", leg(unreachable))
        }
        NearStop::Singular => "the pose there is singular".to_owned(),
        NearStop::Stalled => "no step from there comes closer".to_owned(),
        NearStop::Steps => format!("{} steps did not arrive", not_found.steps),
    };
    let left =
        farthest(manipulator, actuated, mode, &not_found.pose).map(|(name, by, quantity)| {
            format!(", where {name} is {} from its value", units.show(by, quantity))
        });
    format!(
        "no assembly found from this start in mode {signs}: {why}{}; start nearer to it (--near), or in \
         another mode (--mode)",
        left.unwrap_or_default()
    )
}

/// The actuated joint that is farthest from its value at a pose, and by how much; `None` if the pose is out of reach.
fn farthest<'a>(
    manipulator: &'a Manipulator,
    actuated: &[f64],
    mode: Mode,
    pose: &[f64],
) -> Option<(&'a str, f64, Quantity)> {
    let mut buffer = manipulator.solution();
    let solution = manipulator.inverse(pose, mode, &mut buffer).ok()??;
    let joints = manipulator.actuated().iter().zip(actuated).map(|(&number, wanted)| {
        let c = &manipulator.coordinates()[number];
        let apart = solution.joints()[number] - wanted;
        let apart = match c.quantity {
            Quantity::Angle => apart - TAU * (apart / TAU).round(),
            Quantity::Length => apart,
        };
        (&*c.name, apart.abs(), c.quantity)
    });
    joints.max_by(|a, b| a.1.total_cmp(&b.1))
}
