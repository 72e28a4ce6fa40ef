//! Velocities of the paper's 5-DoF manipulator, compared with its plain inverse kinematics.

use opm_benches::{Contender, compare, example};
use std::hint::black_box;

fn main() {
    let manipulator = example("plano-spherical-5dof");
    let mode = manipulator.home_mode();
    let length = manipulator.characteristic_length();
    let mut rng = fastrand::Rng::with_seed(1);
    let mut solution = manipulator.solution();
    // Poses that every leg reaches, as in a control loop. There are only so many that their
    // solutions are in the cache, like one that was just found.
    let (mut poses, mut solutions) = (Vec::new(), Vec::new());
    while poses.len() < 100 {
        let pose = [0.1, 0.1, 0.4, 0.4, 0.4].map(|half| half * (2.0 * rng.f64() - 1.0));
        if manipulator.inverse(&pose, mode, &mut solution).is_ok_and(|reached| reached.is_some()) {
            poses.push(pose);
            solutions.push(solution.clone());
        }
    }
    let rates = [0.1, -0.2, 0.5, 0.3, -0.4];
    let n = poses.len() as u64;
    let (mut motion, mut jacobians) = (manipulator.joint_motion(), manipulator.jacobians());
    let (mut same, mut measured) = (manipulator.jacobians(), manipulator.singularities());
    manipulator.differentiate(&solutions[0], &mut same).expect("a pose in reach");
    let timings = compare(vec![
        Contender::new("inverse kinematics, all joints", n, || {
            for pose in &poses {
                black_box(manipulator.inverse(black_box(pose), mode, &mut solution)).unwrap();
            }
        }),
        Contender::new("Jacobians at a solved pose", n, || {
            for at in &solutions {
                black_box(manipulator.differentiate(black_box(at), &mut jacobians)).unwrap();
            }
        }),
        Contender::new("rates and accelerations of all joints", n, || {
            for at in &solutions {
                let moved = manipulator.velocity(black_box(at), &rates, &rates, &mut motion);
                black_box(moved).unwrap();
            }
        }),
        Contender::new("condition number, given the Jacobians", n, || {
            for _ in &solutions {
                black_box(manipulator.conditioning(black_box(&same), length));
            }
        }),
        Contender::new("measures of singularity, given the Jacobians", n, || {
            for _ in &solutions {
                manipulator.measure_singularities(black_box(&same), &mut measured);
            }
        }),
    ]);
    println!("| velocity, 5 DoF, one thread | ns | of inverse kinematics' time |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.0} | {:.2} |", t.name, t.seconds * 1e9, t.ratio);
    }
}
