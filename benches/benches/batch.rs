//! Inverse kinematics of many poses at once, compared with one pose at a time.

use opm_benches::{Contender, compare, example};
use opm_core::manipulator::BatchOutput;
use std::hint::black_box;

fn main() {
    let manipulator = example("plano-spherical-5dof");
    let mode = manipulator.home_mode();
    let mut rng = fastrand::Rng::with_seed(1);
    let count = 4096;
    let poses: Vec<f64> = (0..count)
        .flat_map(|_| [0.1, 0.1, 0.4, 0.4, 0.4])
        .map(|half| half * (2.0 * rng.f64() - 1.0))
        .collect();
    let (mut solution, mut batch) = (manipulator.solution(), manipulator.batch());
    let mut joints = vec![0.0; count * manipulator.coordinates().len()];
    let mut imaginary = vec![0.0; count * manipulator.imaginary().len()];
    let (mut reachable, mut within_limits) = (vec![false; count], vec![false; count]);
    let timings = compare(vec![
        Contender::new("pose by pose", count as u64, || {
            for pose in poses.chunks_exact(5) {
                black_box(manipulator.inverse(black_box(pose), mode, &mut solution)).unwrap();
            }
        }),
        Contender::new("many at once", count as u64, || {
            let mut out = BatchOutput {
                joints: &mut joints,
                imaginary: &mut imaginary,
                reachable: &mut reachable,
                within_limits: &mut within_limits,
            };
            manipulator.inverse_many(black_box(&poses), mode, &mut batch, &mut out).unwrap();
        }),
    ]);
    println!("| inverse kinematics of all joints, 5 DoF, one thread | ns a pose | of one by one |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.0} | {:.2} |", t.name, t.seconds * 1e9, t.ratio);
    }
}
