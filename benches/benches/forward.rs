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
    let n = poses.len() as u64;
    let home = manipulator.home_pose();
    let timings = compare(vec![
        Contender::new("inverse kinematics, all joints", n, || {
            for pose in &poses {
                black_box(manipulator.inverse(black_box(pose), mode, &mut solution)).unwrap();
            }
        }),
        Contender::new("forward kinematics, every assembly", n, || {
            for actuated in &joints {
                let _ = black_box(manipulator.forward(black_box(actuated)));
            }
        }),
        Contender::new("forward kinematics, Newton from home", n, || {
            for actuated in &joints {
                let _ = black_box(manipulator.forward_near(black_box(actuated), &home, mode));
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
