//! `opm ik --vary`: the joints at a pose for each value of a number of the mechanism file.

use crate::args::{IkArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::{GridAxis, Pose};
use crate::runs::{self, Cell};
use crate::unitless;
use opm_core::Quantity;
use opm_core::manipulator::Solution;
use opm_interference::{Distances, Interference};

pub fn run(
    (args, given): (&IkArgs, &Pose),
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    if let Ok(manipulator) = loaded.compile() {
        unitless::note_pose(output, "--pose", given, loaded, &manipulator);
    }
    let units = loaded.file.units;
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let mode = load::mode(&manipulator, &args.mode)?;
        let (pose, checks) = given.resolve_with_checks(&manipulator)?;
        let mut solution = manipulator.solution();
        let found = manipulator.inverse(&pose, mode, &mut solution);
        let found = found.map_err(|error| Failure::flag("--pose", error))?;
        if let Some(found) = found {
            // What follows from the others changes with the mechanism.
            let verified = checks.verify(&manipulator, found.dependent(), units);
            verified.map_err(|error| Failure::work(error.0))?;
        }
        let value = |values: fn(&Solution) -> &[f64], number: usize| {
            found.map_or(f64::NAN, |found| values(found)[number])
        };
        let mut cells = vec![
            Cell::answer("reachable", found.is_some()),
            Cell::answer("within_limits", found.is_some_and(Solution::within_limits)),
        ];
        let dependent = manipulator.dependent_coordinates().iter().enumerate();
        cells.extend(dependent.map(|(i, c)| {
            Cell::measured(c.name, value(Solution::dependent, i), c.quantity, units)
        }));
        let imaginary = manipulator.imaginary().iter().enumerate();
        cells.extend(imaginary.map(|(i, joint)| {
            Cell::measured(&joint.name, value(Solution::imaginary, i), joint.quantity, units)
        }));
        let actuated = manipulator.actuated().iter().map(|&i| (i, &manipulator.coordinates()[i]));
        cells.extend(
            actuated.map(|(i, c)| {
                Cell::measured(&c.name, value(Solution::joints, i), c.quantity, units)
            }),
        );
        let nearest = found.and_then(|found| {
            let interference = Interference::new(manipulator.mechanism());
            let mut distances = Distances::new(&interference);
            distances.place(&manipulator, found);
            distances.nearest()
        });
        let nearest = nearest.map_or(f64::NAN, |nearest| nearest.distance);
        cells.push(Cell::measured("nearest", nearest, Quantity::Length, units));
        Ok(cells)
    })
}
