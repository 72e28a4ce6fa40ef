//! All joints of a pose by generated C, compared with the library's own closed forms, one mechanism after the other.
//!
//! The library takes the widest vectors that the processor has; a compiler of C takes them where it is told the processor. The
//! program of the code waits for each round, so that the two are timed alternately.

use opm_core::mechanism::examples::EXAMPLES;
use opm_core::{Manipulator, Quantity};
use std::fs;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// How the code is compiled.
const FLAGS: [&[&str]; 3] = [&["-O2"], &["-O3"], &["-O3", "-march=native"]];

/// The number of poses, and of rounds, of which the median counts.
const POSES: usize = 1_000;
const ROUNDS: usize = 21;

/// The time of a round.
const ROUND: Duration = Duration::from_millis(10);

/// Reads poses, and then times them once for each line.
const TIMER: &str = r#"
#include "NAME.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void)
{
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

int main(int argc, char **argv)
{
    static double poses[POSES][NAME_COORDINATES];
    NAME_real joints[NAME_JOINTS], imaginary[NAME_IMAGINARY + 1];
    const unsigned mode = argc > 1 ? (unsigned)atoi(argv[1]) : 0;
    char line[8];
    double sum = 0;
    if (fread(poses, sizeof poses, 1, stdin) != 1) {
        return 2;
    }
    while (fgets(line, sizeof line, stdin)) {
        const double start = now();
        double end = start;
        long rounds = 0;
        int i;
        for (; end - start < ROUND; ++rounds, end = now()) {
            for (i = 0; i < POSES; ++i) {
                sum += NAME_inverse(&NAME_default, poses[i], mode, joints, imaginary);
                sum += joints[0];
            }
        }
        printf("%.17g\n", (end - start) / (double)rounds / POSES);
        fflush(stdout);
    }
    return sum == 0.5;
}
"#;

/// A program that times the code.
struct Timer {
    child: Child,
    asked: ChildStdin,
    told: BufReader<ChildStdout>,
}

impl Timer {
    /// Compiles the code in a folder; `None` without a compiler.
    fn new(
        folder: &Path,
        name: &str,
        flags: &[&str],
        mode: u64,
        poses: &[Vec<f64>],
    ) -> Option<Self> {
        let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
        let built = Command::new(compiler)
            .args(["-std=gnu99", "-o", "timer"])
            .args(flags)
            .args([&format!("{name}.c"), "timer.c", "-lm"])
            .current_dir(folder)
            .status();
        if !built.is_ok_and(|built| built.success()) {
            return None;
        }
        let mut child = Command::new(folder.join("timer"))
            .arg(mode.to_string())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program that was compiled");
        let mut asked = child.stdin.take().expect("a pipe");
        let told = BufReader::new(child.stdout.take().expect("a pipe"));
        let bytes: Vec<u8> = poses.iter().flatten().flat_map(|value| value.to_ne_bytes()).collect();
        asked.write_all(&bytes).expect("it reads");
        Some(Self { child, asked, told })
    }

    /// Seconds for a pose.
    fn time(&mut self) -> f64 {
        self.asked.write_all(b"\n").and_then(|()| self.asked.flush()).expect("it reads");
        let mut line = String::new();
        self.told.read_line(&mut line).expect("it answers");
        line.trim().parse().expect("seconds")
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        // It ends by itself at the end of its input; nothing is left to do where it does not.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Poses about home that every leg reaches, as in a control loop.
fn reached(m: &Manipulator) -> Vec<Vec<f64>> {
    let mut rng = fastrand::Rng::with_seed(1);
    let mut at = m.solution();
    let mut poses = Vec::new();
    let (mut share, mut missed) = (0.3, 0);
    while poses.len() < POSES {
        let unit = |quantity| match quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => m.characteristic_length(),
        };
        let coordinates = m.task_coordinates().iter();
        let pose: Vec<f64> = coordinates
            .map(|c| c.home + share * unit(c.quantity) * (2.0 * rng.f64() - 1.0))
            .collect();
        match m.inverse(&pose, m.home_mode(), &mut at) {
            Ok(Some(_)) => poses.push(pose),
            _ => missed += 1,
        }
        if missed > 20 * POSES {
            (share, missed) = (share / 2.0, 0);
        }
    }
    poses
}

fn main() {
    let heads: Vec<String> = FLAGS.iter().map(|flags| format!("`{}`", flags.join(" "))).collect();
    println!(
        "| all joints of a pose, generated C over the library, one thread | library, ns | {} |",
        heads.join(" | ")
    );
    println!("|---|---:|{}", "---:|".repeat(FLAGS.len()));
    for example in EXAMPLES {
        let Ok(m) = Manipulator::read(example.text) else { continue };
        let code = opm_generate::c(&m, opm_generate::Content::Kinematics).expect("few choices");
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        for (name, text) in code.files() {
            fs::write(folder.path().join(name), text).expect("a file in it");
        }
        let timer = TIMER
            .replace("NAME", &code.name)
            .replace("POSES", &POSES.to_string())
            .replace("< ROUND;", &format!("< {};", ROUND.as_secs_f64()));
        fs::write(folder.path().join("timer.c"), timer).expect("a file in it");
        let poses = reached(&m);
        let mode = m.home_mode();
        let mut cells = Vec::new();
        let mut own = f64::INFINITY;
        for flags in FLAGS {
            let timer = Timer::new(folder.path(), &code.name, flags, mode.bits(), &poses);
            let Some(mut timer) = timer else {
                cells.push("no compiler".to_owned());
                continue;
            };
            let mut solution = m.solution();
            let mut ratios = Vec::new();
            for _ in 0..ROUNDS {
                let theirs = timer.time();
                let start = Instant::now();
                let mut rounds = 0_u32;
                while start.elapsed() < ROUND {
                    for pose in &poses {
                        black_box(m.inverse(black_box(pose), mode, &mut solution)).expect("a pose");
                    }
                    rounds += 1;
                }
                let ours = start.elapsed().as_secs_f64() / f64::from(rounds) / POSES as f64;
                own = own.min(ours);
                ratios.push(theirs / ours);
            }
            ratios.sort_by(f64::total_cmp);
            cells.push(format!("{:.2}", ratios[ROUNDS / 2]));
        }
        println!("| {} | {:.0} | {} |", m.mechanism().name, own * 1e9, cells.join(" | "));
    }
}
