//! Inverse kinematics does not allocate: it may run in a control loop.

use allocation_counter::measure;
use fastrand::Rng;
use opm_core::manipulator::Manipulator;
use opm_tests::random::{Options, PAIRS, mechanism};

#[test]
fn inverse_kinematics_does_not_allocate() {
    let mut rng = Rng::with_seed(30);
    let seen = measure(|| drop(std::hint::black_box(vec![0_u8; 16])));
    assert_eq!(seen.count_total, 1, "the counter counts");
    let mut reached = 0;
    for pair in PAIRS {
        for limited in [0.0, 0.5] {
            let options = Options { limited, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            let mut drives = manipulator.drives();
            let mut all = manipulator.all_modes();
            let mode = manipulator.home_mode();
            for _ in 0..50 {
                let mut pose = manipulator.task().home();
                pose.iter_mut().for_each(|q| *q += 0.5 * (rng.f64() - 0.5));
                let info = measure(|| {
                    reached += u32::from(manipulator.inverse(&pose, mode, &mut solution).unwrap());
                    manipulator.inverse_near(&pose, mode, &mut solution).unwrap();
                    manipulator.inverse_drives(&pose, mode, &mut drives).unwrap();
                    manipulator.inverse_all(&pose, &mut all).unwrap();
                    for mode in all.modes(&manipulator) {
                        manipulator.pick(&all, mode, &mut solution);
                    }
                });
                assert_eq!(info.count_total, 0, "{pair:?}");
            }
        }
    }
    assert!(reached > 500, "{reached} poses in reach");
}
