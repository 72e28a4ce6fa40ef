//! Tables of poses that are read row by row: task coordinates, and coordinates that follow from them.

use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::{Checks, find};
use crate::stream::{Columns, Stream, Wanted, other_columns};
use crate::unitless::Plausible;
use opm_core::manipulator::Manipulator;
use opm_core::task::TaskCoordinate;

/// The columns of a table of poses. Their values are the task coordinates, and then the coordinates that follow from them.
pub fn columns<'m>(
    stream: &mut Stream<'_>,
    (loaded, manipulator): (&Loaded, &'m Manipulator),
) -> Result<Columns<'m>, Failure> {
    let (own, following) = (manipulator.task_coordinates(), manipulator.dependent_coordinates());
    let wanted = |optional: bool| {
        move |c: &'m TaskCoordinate| Wanted {
            name: c.name,
            quantity: c.quantity,
            plausible: Plausible::new(c.quantity, c.home, (loaded, manipulator)),
            optional,
        }
    };
    let values = own.iter().map(wanted(false)).chain(following.iter().map(wanted(true)));
    // The other columns of a table that this program wrote.
    let others = other_columns(manipulator);
    stream.columns(values.collect(), |name| {
        if others.iter().any(|other| other == name) {
            return Ok(None);
        }
        if let Some(number) = following.iter().position(|c| c.name == name) {
            return Ok(Some(own.len() + number));
        }
        find(name, own).map(Some).map_err(|error| error.to_string())
    })
}

/// The values of a row in which nothing is given: the pose at home, and no value of what follows from it.
pub fn blank(manipulator: &Manipulator) -> Vec<f64> {
    let following = manipulator.dependent_coordinates().len();
    manipulator.home_pose().into_iter().chain(std::iter::repeat_n(f64::NAN, following)).collect()
}

/// The pose of a row, and the given values of what follows from it.
pub fn split<'r>(manipulator: &Manipulator, row: &'r [f64]) -> (&'r [f64], Checks) {
    let (pose, following) = row.split_at(manipulator.task_coordinates().len());
    (pose, Checks::of_row(following))
}
