//! Every assembly of mechanisms whose legs are solved whole, and the proofs of them, compared with inverse kinematics.

use opm_benches::{Contender, compare};
use opm_core::{Manipulator, Quantity};
use std::hint::black_box;

/// Three telescopes about a ball: 3-UPS-S.
fn telescopes_about_a_ball() -> Manipulator {
    let mut text = "format = 1\nname = \"3-UPS-S\"\nunits = { length = \"m\", angle = \"rad\" }\n\
                    [platform]\npoint = [0, 0, 0.5]\n"
        .to_owned();
    let ends = [
        ([0.5, 0.0, 0.0], [0.2, 0.0, 0.45]),
        ([-0.2, 0.4, 0.05], [-0.1, 0.2, 0.5]),
        ([-0.3, -0.4, -0.02], [-0.1, -0.15, 0.55]),
    ];
    for (i, (a, b)) in ends.into_iter().enumerate() {
        let [a, b] = [a, b].map(nalgebra::Vector3::<f64>::from);
        let along = (b - a).normalize();
        let side = along.cross(&nalgebra::Vector3::new(0.3, 0.5, 0.8)).normalize();
        let other = along.cross(&side);
        let list = |v: &nalgebra::Vector3<f64>| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
        let (a, b) = (list(&a), list(&b));
        let [along, side, other] = [&along, &side, &other].map(list);
        text += &format!(
            "[[leg]]\nname = \"leg{i}\"\njoints = [\n\
             {{ name = \"u{i}\", type = \"universal\", axis = {side}, axis2 = {other}, point = {a} }},\n\
             {{ name = \"p{i}\", type = \"prismatic\", axis = {along}, actuated = true }},\n\
             {{ name = \"s{i}\", type = \"spherical\", point = {b} }},\n]\n"
        );
    }
    text += "[[leg]]\nname = \"stem\"\njoints = [{ name = \"s\", type = \"spherical\", point = [0, 0, 0.5] }]\n";
    Manipulator::read(&text).expect("a mechanism")
}

fn main() {
    println!("| every assembly, one thread | µs | of inverse kinematics' time |");
    println!("|---|---:|---:|");
    let example = |name: &str| Manipulator::example(name).expect("a shipped mechanism");
    for m in [example("delta"), telescopes_about_a_ball(), example("tricept"), example("stewart")] {
        measure(&m);
    }
}

fn measure(m: &Manipulator) {
    let mode = m.home_mode();
    let mut rng = fastrand::Rng::with_seed(1);
    let mut solution = m.solution();
    let (mut poses, mut joints) = (Vec::new(), Vec::new());
    while poses.len() < 20 {
        let of = |c: &opm_core::task::TaskCoordinate| {
            let length = c.quantity == Quantity::Length;
            let unit = if length { m.characteristic_length() } else { 1.0 };
            c.home + 0.05 * unit * (2.0 * rng.f64() - 1.0)
        };
        let pose: Vec<f64> = m.task_coordinates().iter().map(of).collect();
        if let Ok(Some(found)) = m.inverse(&pose, mode, &mut solution) {
            joints.push(m.actuated().iter().map(|&i| found.joints()[i]).collect::<Vec<f64>>());
            poses.push(pose);
        }
    }
    let assemblies: Vec<_> = joints.iter().map(|q| m.forward(q).expect("numbers").list).collect();
    let (n, mut every, mut near) = (poses.len() as u64, m.forward_buffer(), m.near_buffer());
    let home = m.home_pose();
    let timings = compare(vec![
        Contender::new("inverse kinematics", n, || {
            for pose in &poses {
                let _ = black_box(m.inverse(black_box(pose), mode, &mut solution));
            }
        }),
        Contender::new("every assembly", n, || {
            for actuated in &joints {
                let _ = black_box(m.forward_into(black_box(actuated), &mut every));
            }
        }),
        Contender::new("the one near home", n, || {
            for actuated in &joints {
                let _ = black_box(m.forward_near_into(black_box(actuated), &home, mode, &mut near));
            }
        }),
        Contender::new("proofs of every assembly", n, || {
            for list in &assemblies {
                black_box(m.certify(black_box(list)));
            }
        }),
    ]);
    for t in timings {
        let name = format!("{}: {}", m.mechanism().name, t.name);
        println!("| {name} | {:.2} | {:.1} |", t.seconds * 1e6, t.ratio);
    }
}
