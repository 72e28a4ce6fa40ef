//! `opm velocity --vary`: how near a pose is to singular for each value of a number of the mechanism file.

use super::{Answer, Query};
use crate::args::{Output, VelocityArgs};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::{GridAxis, Number};
use crate::runs::{self, Cell};
use crate::unitless;
use opm_study::characteristic_length;

pub fn run(
    args: &VelocityArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    if let Ok(manipulator) = loaded.compile() {
        unitless::note_pose(output, "--pose", &args.pose, loaded, &manipulator);
    }
    let units = loaded.file.units;
    let given = args.length.map(Number::characteristic_length).transpose()?;
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let mode = load::mode(&manipulator, &args.mode)?;
        let (pose, checks) = args.pose.resolve_with_checks(&manipulator)?;
        let rates = args.rates.resolve_rates(&manipulator)?;
        let moves = rates.iter().any(|&rate| rate != 0.0);
        let length = characteristic_length(given, &manipulator)?;
        let mut at = manipulator.solution();
        let found = manipulator.inverse(&pose, mode, &mut at);
        let reached = found.map_err(|error| Failure::flag("--pose", error))?.is_some();
        let query = Query { loaded: changed, manipulator: &manipulator, pose, rates, mode };
        let answer = match reached {
            true => {
                // What follows from the others changes with the mechanism.
                let verified = checks.verify(&manipulator, at.dependent(), units);
                verified.map_err(|error| Failure::work(error.0))?;
                Some(Answer::new(&query, &at, length)?)
            }
            false => None,
        };
        let number = |of: &dyn Fn(&Answer<'_>) -> Option<f64>| {
            answer.as_ref().and_then(of).unwrap_or(f64::NAN)
        };
        let mut cells = vec![
            Cell::answer("reachable", reached),
            Cell::number("condition", number(&|answer| Some(answer.conditioning.condition))),
            Cell::number("serial", number(&|answer| Some(answer.measured.whole.serial))),
            Cell::number("parallel", number(&|answer| answer.measured.whole.parallel)),
        ];
        // Without rates of the platform, joints have none.
        let joints = manipulator.actuated().iter().filter(|_| moves);
        cells.extend(joints.map(|&i| {
            let c = &manipulator.coordinates()[i];
            let rate = number(&|answer| answer.joint_rate(i));
            let header = format!("d.{} [{}/s]", c.name, units.symbol(c.quantity));
            Cell { header, ..Cell::measured(&format!("d.{}", c.name), rate, c.quantity, units) }
        }));
        Ok(cells)
    })
}
