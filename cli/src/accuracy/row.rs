//! The columns of errors in tables of poses.

use opm_accuracy::Budget;
use opm_core::manipulator::Manipulator;

/// The names of the columns of errors.
pub fn header(manipulator: &Manipulator) -> Vec<String> {
    let errors = manipulator.task_coordinates().iter().map(|c| format!("error.{}", c.name));
    let joints = manipulator.mechanism().joints();
    let misfits = joints.flat_map(|joint| {
        [format!("misfit.{}.length", joint.name), format!("misfit.{}.angle", joint.name)]
    });
    let worst = ["worst.length", "worst.angle"].map(str::to_owned);
    errors.chain(worst).chain(misfits).collect()
}

/// The worst cases of a pose, in the order of the header; metres and radians.
pub fn cells(budget: &Budget) -> impl Iterator<Item = Option<f64>> + '_ {
    let errors = budget.coordinates.iter().map(|spread| spread.worst);
    let misfits = budget.misfit.iter().flat_map(|play| [play.length.worst, play.angle.worst]);
    let all = errors.chain([budget.length.worst, budget.angle.worst]).chain(misfits);
    all.map(|value| value.is_finite().then_some(value))
}
