//! Forward kinematics of the paper's 5-DoF manipulator, every assembly, compared with inverse
//! kinematics.

use opm_benches::{Contender, compare, example};
use std::hint::black_box;

fn main() {
    let manipulator = example("plano-spherical-5dof");
    let mode = manipulator.home_mode();
    let mut rng = fastrand::Rng::with_seed(1);
    let mut solution = manipulator.solution();
    // Poses that are reached in the home mode, as in the benchmark of inverse kinematics.
    let (mut poses, mut joints, mut assemblies) = (Vec::new(), Vec::new(), 0);
    while poses.len() < 200 {
        let pose = [0.1, 0.1, 0.4, 0.4, 0.4].map(|half| half * (2.0 * rng.f64() - 1.0));
        if manipulator.inverse(&pose, mode, &mut solution).unwrap().is_some() {
            poses.push(pose);
            let actuated = manipulator.actuated().iter().map(|&i| solution.joints()[i]);
            joints.push(actuated.collect::<Vec<f64>>());
            assemblies += manipulator.forward(joints.last().unwrap()).unwrap().list.len();
        }
    }
    // A millimetre and a degree away in every coordinate, as a pose that was measured before.
    let near: Vec<[f64; 5]> = (poses.iter())
        .map(|pose| {
            let aside = [1e-3, 1e-3].into_iter().chain([1_f64.to_radians(); 3]);
            let mut start = *pose;
            for (q, aside) in start.iter_mut().zip(aside) {
                *q += if rng.bool() { aside } else { -aside };
            }
            start
        })
        .collect();
    let n = poses.len() as u64;
    let (home, mut buffer) = (manipulator.home_pose(), manipulator.near_buffer());
    let mut every = manipulator.forward_buffer();
    let timings = compare(vec![
        Contender::new("inverse kinematics, all joints", n, || {
            for pose in &poses {
                black_box(manipulator.inverse(black_box(pose), mode, &mut solution)).unwrap();
            }
        }),
        Contender::new("forward kinematics, every assembly", n, || {
            for actuated in &joints {
                let _ = black_box(manipulator.forward_into(black_box(actuated), &mut every));
            }
        }),
        Contender::new("forward kinematics, every assembly, in new memory", n, || {
            for actuated in &joints {
                let _ = black_box(manipulator.forward(black_box(actuated)));
            }
        }),
        Contender::new("forward kinematics, from 1 mm and 1 degree away", n, || {
            for (actuated, start) in joints.iter().zip(&near) {
                let found =
                    manipulator.forward_near_into(black_box(actuated), start, mode, &mut buffer);
                let _ = black_box(found);
            }
        }),
        Contender::new("forward kinematics, from home", n, || {
            for actuated in &joints {
                let found = manipulator.forward_near(black_box(actuated), &home, mode);
                let _ = black_box(found);
            }
        }),
    ]);
    println!("{} assemblies for each set of joints, on average", assemblies / poses.len());
    println!();
    println!("| forward kinematics, 5 DoF, one thread | ns | of inverse kinematics' time |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.0} | {:.1} |", t.name, t.seconds * 1e9, t.ratio);
    }
}
