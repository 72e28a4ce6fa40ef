//! Inverse kinematics of the paper's 5-DoF manipulator, one pose at a time and many at once, compared with the paper's
//! formulas as plain code.

use opm_benches::{Contender, compare, example};
use opm_core::manipulator::BatchOutput;
use opm_tests::paper::{PlanoSpherical, Signs};
use std::hint::black_box;

fn main() {
    let manipulator = example("plano-spherical-5dof");
    let oracle = PlanoSpherical::printed();
    let signs = Signs { legs: [[true; 2]; 3], arm: true };
    let mode = manipulator.home_mode();
    let mut rng = fastrand::Rng::with_seed(1);
    // Poses that every leg reaches, as in a control loop.
    let mut poses = Vec::new();
    while poses.len() < 1_000 {
        let pose = [0.1, 0.1, 0.4, 0.4, 0.4].map(|half| half * (2.0 * rng.f64() - 1.0));
        if oracle.inverse(&pose, &signs).is_some() {
            poses.push(pose);
        }
    }
    let n = poses.len() as u64;
    let (mut drives, mut solution, mut all) =
        (manipulator.actuated_joints(), manipulator.solution(), manipulator.all_modes());
    let mut batch = manipulator.batch();
    let mut joints = vec![0.0; poses.len() * manipulator.coordinates().len()];
    let mut imaginary = vec![0.0; poses.len() * manipulator.imaginary().len()];
    let [mut reachable, mut within_limits] = [(); 2].map(|()| vec![false; poses.len()]);
    let timings = compare(vec![
        Contender::new("the paper's formulas, plain code", n, || {
            for pose in &poses {
                black_box(oracle.inverse(black_box(pose), &signs));
            }
        }),
        Contender::new("actuated and imaginary joints", n, || {
            for pose in &poses {
                black_box(manipulator.inverse_actuated(black_box(pose), mode, &mut drives))
                    .unwrap();
            }
        }),
        Contender::new("all joints", n, || {
            for pose in &poses {
                black_box(manipulator.inverse(black_box(pose), mode, &mut solution)).unwrap();
            }
        }),
        Contender::new("all joints, many poses at once", n, || {
            let mut out = BatchOutput {
                joints: &mut joints,
                imaginary: &mut imaginary,
                reachable: &mut reachable,
                within_limits: &mut within_limits,
            };
            let poses = black_box(poses.as_flattened());
            manipulator.inverse_many(poses, mode, &mut batch, &mut out).unwrap();
        }),
        Contender::new("all 128 working modes", n, || {
            for pose in &poses {
                black_box(manipulator.inverse_all(black_box(pose), &mut all)).unwrap();
            }
        }),
    ]);
    println!("| inverse kinematics, 5 DoF, one thread | ns | of the plain code's time |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.0} | {:.2} |", t.name, t.seconds * 1e9, t.ratio);
    }
}
