//! A reference implementation of sweeps: one inverse-kinematics call per pose.

use opm_core::manipulator::{Manipulator, Solution};
use opm_workspace::{Count, Grid, Modes};

/// The reachable poses and the ranges of the imaginary joints, by one call per pose and mode.
pub fn by_inverse(manipulator: &Manipulator, grid: &Grid, modes: Modes) -> (Vec<Vec<f64>>, Count) {
    by_predicate(manipulator, grid, modes, |_| true)
}

/// The same for those solutions that satisfy a predicate.
pub fn by_predicate(
    manipulator: &Manipulator,
    grid: &Grid,
    modes: Modes,
    mut admits: impl FnMut(&Solution) -> bool,
) -> (Vec<Vec<f64>>, Count) {
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    let mut reached = Vec::new();
    let mut imaginary: Vec<Option<[f64; 2]>> = vec![None; manipulator.imaginary().len()];
    for index in 0..grid.poses() {
        let pose = grid.pose(index);
        let mut inside = false;
        manipulator.inverse_all(&pose, &mut all).unwrap();
        for mode in all.modes(manipulator) {
            if modes != Modes::Any && modes != Modes::One(mode) {
                continue;
            }
            let solution = manipulator.solution_in_mode(&all, mode, &mut solution);
            let solution = solution.expect("a mode of the list reaches the pose");
            if solution.within_limits() && admits(solution) {
                inside = true;
                for (range, &value) in imaginary.iter_mut().zip(solution.imaginary()) {
                    let [low, high] = range.unwrap_or([value; 2]);
                    *range = Some([low.min(value), high.max(value)]);
                }
            }
        }
        if inside {
            reached.push(pose);
        }
    }
    let count = Count { poses: grid.poses(), reachable: reached.len() as u64, imaginary };
    (reached, count)
}
