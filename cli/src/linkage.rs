//! `opm linkage`: positions of a loop with one input.

pub mod input;
mod report;
mod sweep;

use crate::args::{LinkageArgs, Output};
use crate::failure::Failure;
use crate::linkage::input::InputValue;
use crate::load;
use opm_core::linkage::{Input, Linkage};
use report::Run;

pub fn run(args: &LinkageArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    let linkage =
        Linkage::new(&loaded.file.mechanism).map_err(|error| Failure::at(&loaded.label, error))?;
    let (input, value) = resolve(args.input.as_ref(), &linkage)?;
    let run = Run { loaded: &loaded, linkage: &linkage, input };
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
        let names: Vec<_> = linkage.coordinates().iter().map(|c| &*c.name).collect();
        let problem = format!("no joint {name:?}, expected one of {}", names.join(", "));
        Failure::flag("--input", problem)
    })?;
    let value = given.and_then(|input| input.value);
    let value = value.map(|number| number.value_of(name, input.coordinate().quantity)).transpose();
    Ok((input, value.map_err(|error| Failure::flag("--input", error))?))
}
