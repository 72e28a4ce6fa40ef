//! The joints at a pose, and the bodies.

use crate::explorer::Explorer;
use crate::handles::{Handles, handles};
use crate::interference::{Contacts, contacts};
use crate::problem::Problems;
use crate::request::Coordinates;
use crate::scene;
use crate::session::Reply;
use crate::units::shown;
use opm_core::manipulator::{Manipulator, Solution, Unreachable};
use opm_core::{Mode, Quantity};
use opm_study::text::reason;
use serde::Serialize;

/// Most choices whose modes are tried at every pose: 256 modes take a fraction of a millisecond.
const MOST_CHOICES: u32 = 8;

/// The answer to a pose. The bytes are the transforms of the bodies, if it is reached.
#[derive(Serialize)]
struct Posture<'a> {
    mode: String,
    reached: bool,
    within: bool,
    /// The joint coordinates and the imaginary joints, in the order of the description.
    values: Vec<f64>,
    /// The numbers of the joint coordinates that are beyond their limits.
    beyond: Vec<usize>,
    dependent: Vec<f64>,
    out_of_reach: Vec<OutOfReach<'a>>,
    /// The modes that reach the pose.
    modes: Vec<Reaching>,
    /// The handles of the platform, if the pose is reached.
    handles: Option<Handles>,
    /// The distances of the bodies, if the pose is reached.
    contacts: Option<Contacts>,
}

/// A leg that does not reach the pose.
#[derive(Serialize)]
struct OutOfReach<'a> {
    leg: &'a str,
    section: Option<String>,
    /// The distance or angle that is missing, in the file's unit; none if it is not known.
    deficit: Option<f64>,
    unit: &'static str,
    /// The same as a text.
    text: String,
}

/// A mode that reaches the pose.
#[derive(Serialize)]
struct Reaching {
    mode: String,
    within: bool,
}

/// Solves a pose in one working mode. The clearance is in the file's units.
pub fn solve(
    explorer: &Explorer,
    pose: &Coordinates,
    mode: Option<&str>,
    clearance: Option<f64>,
) -> Result<Reply, Problems> {
    let (manipulator, mode) = (explorer.manipulator(), explorer.mode(mode)?);
    let pose = explorer.pose(pose)?;
    let mut solution = manipulator.solution();
    let found = manipulator.inverse(&pose, mode, &mut solution);
    let reached = found.map_err(|error| Problems::of(&error))?.is_some();
    let mut posture = Posture {
        mode: manipulator.format_mode(mode),
        reached,
        within: reached && solution.within_limits(),
        values: vec![],
        beyond: vec![],
        dependent: vec![],
        out_of_reach: vec![],
        modes: reaching(manipulator, &pose)?,
        handles: if reached { handles(explorer, &pose, mode) } else { None },
        contacts: None,
    };
    if !reached {
        let missed = solution.unreachable().iter();
        posture.out_of_reach = missed.map(|missed| out_of_reach(explorer, missed)).collect();
        return Ok(Reply::new(&posture));
    }
    posture.values = values(explorer, solution.joints(), solution.imaginary());
    posture.beyond = manipulator.beyond_limits(&solution).collect();
    let dependent = manipulator.dependent_coordinates().iter().zip(solution.dependent());
    posture.dependent =
        dependent.map(|(c, &value)| shown(value, c.quantity, explorer.units())).collect();
    posture.contacts = Some(contacts(explorer, &solution, clearance)?);
    let platform = solution.displacement(manipulator);
    let bodies = scene::placed(explorer, solution.joints(), solution.imaginary(), platform);
    Ok(Reply::with_bytes(&posture, bodies))
}

/// The joint coordinates, and then the imaginary joints, in the file's units.
pub fn values(explorer: &Explorer, joints: &[f64], imaginary: &[f64]) -> Vec<f64> {
    let manipulator = explorer.manipulator();
    let quantities = quantities(manipulator);
    let all = joints.iter().chain(imaginary).zip(quantities);
    all.map(|(&value, quantity)| shown(value, quantity, explorer.units())).collect()
}

/// What the values of a pose measure.
pub fn quantities(manipulator: &Manipulator) -> impl Iterator<Item = Quantity> {
    let joints = manipulator.coordinates().iter().map(|c| c.quantity);
    joints.chain(manipulator.imaginary().iter().map(|joint| joint.quantity))
}

fn out_of_reach<'a>(explorer: &'a Explorer, missed: &Unreachable) -> OutOfReach<'a> {
    let (units, deficit) = (explorer.units(), missed.deficit);
    let known = deficit.excess.is_finite();
    OutOfReach {
        leg: &explorer.manipulator().mechanism().legs[missed.leg].name,
        section: missed.section.map(|section| section.to_string()),
        deficit: known.then(|| shown(deficit.excess, deficit.quantity, units)),
        unit: units.symbol(deficit.quantity),
        text: reason(missed, units),
    }
}

/// The modes that reach a pose; none are tried if there are too many.
fn reaching(manipulator: &Manipulator, pose: &[f64]) -> Result<Vec<Reaching>, Problems> {
    if manipulator.choices() > MOST_CHOICES {
        return Ok(vec![]);
    }
    let (mut all, mut solution) = (manipulator.all_modes(), manipulator.solution());
    let found = manipulator.inverse_all(pose, &mut all).map_err(|error| Problems::of(&error))?;
    let Some(all) = found else { return Ok(vec![]) };
    let mut within = |mode: Mode| {
        let solution = manipulator.solution_in_mode(all, mode, &mut solution);
        solution.is_some_and(Solution::within_limits)
    };
    let reaching = all.modes(manipulator);
    Ok(reaching
        .map(|mode| Reaching { mode: manipulator.format_mode(mode), within: within(mode) })
        .collect())
}
