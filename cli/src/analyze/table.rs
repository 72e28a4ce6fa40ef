//! `opm analyze --vary`: efforts and indices at a pose for each value of a number of the mechanism file.

use super::{Analyser, word};
use crate::args::{AnalyzeArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::GridAxis;
use crate::runs::{self, Cell};
use crate::unitless;
use opm_analysis::Index;
use opm_study::effort_names;

pub fn run(
    args: &AnalyzeArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let options = args.setup.options(args.length)?;
    // The columns are the indices that the mechanism of the file has; they do not change from row to row.
    let shown: Vec<Index> = match loaded.compile() {
        Ok(manipulator) => {
            unitless::note_pose(output, "--pose", &args.pose, loaded, &manipulator);
            let setup = options.clone().check(&manipulator)?;
            Index::known(&manipulator, &setup)
        }
        Err(_) => Index::ALL.to_vec(),
    };
    let units = loaded.file.units;
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let mode = load::mode(&manipulator, &args.mode)?;
        let setup = options.clone().check(&manipulator)?;
        let mut analyser = Analyser::new(&manipulator, &setup)?;
        let (pose, checks) = args.pose.resolve_with_checks(&manipulator)?;
        let mut at = manipulator.solution();
        let found = manipulator.inverse(&pose, mode, &mut at);
        let reached = found.map_err(|error| Failure::flag("--pose", error))?.is_some();
        let mut cells = vec![Cell::answer("reachable", reached)];
        if reached {
            // What follows from the others changes with the mechanism.
            let verified = checks.verify(&manipulator, at.dependent(), units);
            verified.map_err(|error| Failure::work(error.0))?;
            analyser.update(&at)?;
        }
        if analyser.loads.is_some() {
            let found = analyser.acting.as_ref().map(|(_, efforts)| efforts);
            let balance = found.map(|found| word(found.balance));
            cells.push(Cell::new("balance", balance, balance.unwrap_or("-")));
            let count = manipulator.actuated().len();
            cells.extend(effort_names(&manipulator).take(count).enumerate().map(|(i, name)| {
                let effort = found.and_then(|found| found.actuated[i]);
                Cell::number(&name, effort.unwrap_or(f64::NAN))
            }));
        }
        let known = analyser.indices.indices();
        cells.extend(shown.iter().map(|&index| {
            let place = known.iter().position(|&known| known == index).filter(|_| reached);
            let value = place.map_or(f64::NAN, |place| analyser.indices.values()[place]);
            Cell::number(index.name(), value)
        }));
        Ok(cells)
    })
}
