//! `opm fk --vary`: the assemblies for each value of a number of the mechanism file.

use super::{FoundAssemblies, solve};
use crate::args::{FkArgs, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::{GridAxis, Pose};
use crate::runs::{self, Cell};

pub fn run(
    (args, given): (&FkArgs, &Pose),
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let (units, silent) = (loaded.file.units, output.silent());
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let FoundAssemblies { found, .. } = solve(args, given, &silent, (changed, &manipulator))?;
        let within = found.list.iter().filter(|assembly| assembly.within_limits).count();
        let mut cells = vec![
            Cell::count("assemblies", found.list.len() as u64),
            Cell::count("within_limits", within as u64),
        ];
        let nearest = found.list.first();
        let mode = nearest.map(|assembly| manipulator.format_mode(assembly.mode));
        let shown = mode.clone().unwrap_or_else(|| "-".to_owned());
        cells.push(Cell::new("mode", mode, shown));
        let own = manipulator.task_coordinates().iter().enumerate().map(|(i, c)| {
            let value = nearest.map_or(f64::NAN, |assembly| assembly.pose[i]);
            Cell::measured(c.name, value, c.quantity, units)
        });
        cells.extend(own);
        let dependent = manipulator.dependent_coordinates().iter().enumerate().map(|(i, c)| {
            let value = nearest.map_or(f64::NAN, |assembly| assembly.dependent[i]);
            Cell::measured(c.name, value, c.quantity, units)
        });
        cells.extend(dependent);
        Ok(cells)
    })
}
