//! Limits on random mechanisms of every pair of subspaces: what lies on a limit is inside.

use fastrand::Rng;
use opm_core::manipulator::Manipulator;
use opm_tests::random::{Options, PAIRS, mechanism};

/// Joints that are locked where they are at home, each at zero: home is within the limits.
#[test]
fn home_is_inside_limits_that_leave_nothing_else() {
    let mut rng = Rng::with_seed(4);
    for pair in PAIRS {
        for _ in 0..50 {
            let (mut mechanism, decomposition) =
                mechanism(&mut rng, pair, Options { limited: 0.0, balls: true });
            let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
            for coordinate in joints.flat_map(|joint| &mut joint.coordinates) {
                (coordinate.home, coordinate.limits) = (0.0, Some([0.0, 0.0]));
            }
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            let home = manipulator.task().home();
            assert!(manipulator.inverse(&home, manipulator.home_mode(), &mut solution).unwrap());
            assert!(solution.within_limits, "{pair:?} {:?}", solution.joints);
        }
    }
}
