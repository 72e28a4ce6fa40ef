//! A motion of 10⁵ samples, followed and recorded by the program, against inverse kinematics alone.

use opm_benches::{Contender, compare, example, program};
use opm_core::motion::{Instant, examples, file};
use std::hint::black_box;

const MECHANISM: &str = "plano-spherical-5dof";
const MOTION: &str = "plano-spherical-sinusoids";
/// Ten seconds of it.
const RATE: f64 = 10_000.0;

fn main() {
    let manipulator = example(MECHANISM);
    let text = examples::find(MOTION).expect("a shipped motion").text;
    let motion = file::read(text, &manipulator).expect("shipped motions are read");
    let mut solution = manipulator.solution();
    let mut instant = Instant::new(manipulator.task_coordinates().len());
    let samples = (motion.duration * RATE) as u64 + 1;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("motion.mcap");
    let run = |more: &[&str]| {
        let rate = RATE.to_string();
        let status = program()
            .args(["trajectory", MECHANISM, "--motion", MOTION, "--rate", &rate, "--quiet"])
            .args(more)
            .args(["--format", "json"])
            .stdout(std::process::Stdio::null())
            .status();
        assert!(status.expect("the program starts").success());
    };
    let output = path.to_str().expect("UTF-8");
    let timings = compare(vec![
        Contender::new("inverse kinematics alone", 1, || {
            for number in 0..samples {
                motion.at(number as f64 / RATE, &mut instant);
                let mode = manipulator.home_mode();
                black_box(manipulator.inverse_near(&instant.pose, mode, &mut solution)).unwrap();
            }
        }),
        Contender::new("followed: rates, condition, watched between samples", 1, || run(&[])),
        Contender::new("followed and recorded", 1, || run(&["-o", output])),
    ]);
    println!("| motion of {samples} samples, 5 DoF | seconds | times inverse kinematics |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.3} | {:.1} |", t.name, t.seconds, t.ratio);
    }
}
