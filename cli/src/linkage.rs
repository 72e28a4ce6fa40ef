//! `opm linkage`: positions of a loop with one input.

pub mod input;
mod report;
mod sweep;

use crate::args::{LinkageArgs, Output};
use crate::failure::Failure;
use crate::linkage::input::InputValue;
use crate::load::{self, Loaded};
use crate::pose::GridAxis;
use crate::runs::{self, Cell};
use opm_core::linkage::{Input, Linkage};
use report::Run;

pub fn run(args: &LinkageArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open_as_it_is(&args.mechanism, output)?;
    if let Some(vary) = &args.vary {
        return table(args, &loaded, vary, output);
    }
    let linkage =
        Linkage::new(&loaded.file.mechanism).map_err(|error| Failure::at(&loaded.label, error))?;
    let (input, value) = resolve(args.input.as_ref(), &linkage)?;
    let coupler = args.coupler.map(|point| point.0);
    let run = Run { loaded: &loaded, linkage: &linkage, input, coupler };
    match value {
        Some(_) if args.sweep => {
            let problem = "a sweep starts at home; give the name of the joint alone";
            Err(Failure::flag("--input", problem))
        }
        _ if args.sweep => sweep::run(args, output, &run),
        value => {
            let value = value.unwrap_or(input.coordinate().home);
            let positions = input.solve(value);
            output.print(&run.json(value, &positions), run.text(value, &positions))
        }
    }
}

/// The positions for each value of a number of the mechanism file: how many, and the joints of that in home's branch.
fn table(
    args: &LinkageArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let units = loaded.file.units;
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let found = Linkage::new(&changed.file.mechanism);
        let linkage = found.map_err(|error| Failure::at(&changed.label, error))?;
        let (input, value) = resolve(args.input.as_ref(), &linkage)?;
        let positions = input.solve(value.unwrap_or(input.coordinate().home));
        let branch = input.home_branch();
        let home = positions.iter().find(|position| position.branch == branch);
        let mut cells = vec![
            Cell::count("positions", positions.len() as u64),
            Cell::answer("full_turn", input.range().is_full_turn()),
        ];
        cells.extend(linkage.coordinates().iter().enumerate().map(|(i, c)| {
            let value = home.map_or(f64::NAN, |position| position.joints[i]);
            Cell::measured(&c.name, value, c.quantity, units)
        }));
        Ok(cells)
    })
}

/// The requested input and its value; by default the first actuated joint.
fn resolve<'a>(
    given: Option<&InputValue>,
    linkage: &'a Linkage,
) -> Result<(Input<'a>, Option<f64>), Failure> {
    let actuated = || {
        let joint = linkage.mechanism().joints().find(|joint| joint.actuated);
        joint.map_or("", |joint| &joint.coordinates[0].name)
    };
    let name = given.map_or_else(actuated, |input| &input.name);
    let input = linkage.input(name).ok_or_else(|| {
        let known = linkage.coordinates().iter().any(|c| c.name == name);
        let what = if known { "cannot move the linkage" } else { "is no joint" };
        let names: Vec<_> = linkage.inputs().collect();
        let problem = format!("{name:?} {what}, expected one of {}", names.join(", "));
        Failure::flag("--input", problem)
    })?;
    let value = given.and_then(|input| input.value);
    let value = value.map(|number| number.value_of(name, input.coordinate().quantity)).transpose();
    Ok((input, value.map_err(|error| Failure::flag("--input", error))?))
}
