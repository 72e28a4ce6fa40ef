//! `make guard`: whether a change made something slower, by counts of instructions, which do not
//! depend on other work of the machine. valgrind counts them, and they are compared with those in
//! `guard.txt`.
//!
//! ```text
//! guard            compares; exit code 1 if something takes more, 2 if that cannot be decided
//! guard --store    writes the counts to guard.txt
//! guard WORK       does a piece of work that valgrind counts
//! ```

use opm_benches::{example, reached, square_roots, sweep_grid, with_limits_on_passive_angles};
use opm_core::manipulator::Manipulator;
use opm_workspace::{Modes, Progress, Sweep};
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

/// The share of additional instructions that is attributed to chance: another path through libm, or
/// another order of inlining by the compiler.
const TOLERANCE: f64 = 0.05;

/// The pieces of work that are counted.
const WORKS: [&str; 7] = [
    "rows",
    "rows-with-limits-on-angles",
    "inverse",
    "inverse-drives",
    "forward",
    "forward-near",
    "velocity",
];

/// Prints the capabilities of valgrind's processor.
const INSTRUCTIONS: &str = "instructions";

fn main() -> ExitCode {
    let argument = std::env::args().nth(1);
    let done = match argument.as_deref() {
        None => compare(),
        Some("--store") => store(),
        Some(work) => {
            perform(work);
            Ok(ExitCode::SUCCESS)
        }
    };
    done.unwrap_or_else(|problem| {
        eprintln!("guard: not checked: {problem}");
        ExitCode::from(2)
    })
}

/// Does a piece of work inside [`counted`]; its input is prepared before.
fn perform(work: &str) {
    let manipulator = example("plano-spherical-5dof");
    match work {
        INSTRUCTIONS => println!("{}", square_roots::instructions()),
        "rows" => sweep(&manipulator),
        "rows-with-limits-on-angles" => sweep(&with_limits_on_passive_angles(&manipulator)),
        _ => solve(work, &manipulator),
    }
}

fn sweep(manipulator: &Manipulator) {
    let grid = sweep_grid(manipulator, [64, 64, 5]);
    let sweep = Sweep::new(manipulator, &grid, Modes::One(manipulator.home_mode()));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread pool");
    pool.install(|| counted(&mut || drop(black_box(sweep.count(&Progress::default())))));
}

fn solve(work: &str, manipulator: &Manipulator) {
    let mode = manipulator.home_mode();
    let (mut drives, mut solution) = (manipulator.actuated_joints(), manipulator.solution());
    let poses = reached(manipulator, 100);
    let solutions: Vec<_> = poses
        .iter()
        .map(|pose| {
            manipulator.inverse(pose, mode, &mut solution).expect("a finite pose");
            solution.clone()
        })
        .collect();
    let actuated: Vec<Vec<f64>> = solutions
        .iter()
        .map(|solution| manipulator.actuated().iter().map(|&i| solution.joints()[i]).collect())
        .collect();
    // A millimetre and a degree away in every coordinate.
    let near: Vec<Vec<f64>> = poses
        .iter()
        .map(|pose| {
            let aside = [1e-3, 1e-3].into_iter().chain([1_f64.to_radians(); 3]);
            pose.iter().zip(aside).map(|(q, aside)| q + aside).collect()
        })
        .collect();
    let mut buffer = manipulator.near_buffer();
    let mut every = manipulator.forward_buffer();
    let mut motion = manipulator.joint_motion();
    let rates = [0.1, -0.2, 0.5, 0.3, -0.4];
    counted(&mut || {
        for i in 0..poses.len() {
            match work {
                "inverse" => {
                    let _ = black_box(manipulator.inverse(&poses[i], mode, &mut solution));
                }
                "inverse-drives" => {
                    let _ = black_box(manipulator.inverse_actuated(&poses[i], mode, &mut drives));
                }
                "forward" => {
                    let _ = black_box(manipulator.forward_into(&actuated[i], &mut every));
                }
                "forward-near" => {
                    let found =
                        manipulator.forward_near_into(&actuated[i], &near[i], mode, &mut buffer);
                    let _ = black_box(found);
                }
                "velocity" => {
                    let moved = manipulator.velocity(&solutions[i], &rates, &rates, &mut motion);
                    let _ = black_box(moved);
                }
                other => panic!("no work is called {other}: expected one of {WORKS:?}"),
            }
        }
    });
}

/// The part that valgrind counts.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}

fn compare() -> Result<ExitCode, String> {
    let stored = std::fs::read_to_string(path()).map_err(|e| format!("guard.txt: {e}"))?;
    let (of, counts) = stored.split_once('\n').ok_or("guard.txt is empty")?;
    let here = compiled_for()?;
    if of != here {
        return Err(format!(
            "guard.txt holds counts of {of}, here it is {here}; `make guard-store` at a commit to \
             compare with stores counts of this machine and compiler"
        ));
    }
    let mut slower = Vec::new();
    for line in counts.lines() {
        let (work, before) = line.split_once(' ').ok_or("guard.txt: expected `WORK COUNT`")?;
        let before: f64 = before.parse().map_err(|_| format!("guard.txt: {work}: no count"))?;
        let now = count(work)? as f64;
        let change = now / before - 1.0;
        println!(
            "{work:28}{before:>12} instructions before, {now:>12} now, {:+.1} %",
            100.0 * change
        );
        if change > TOLERANCE {
            slower.push(work.to_owned());
        } else if change < -TOLERANCE {
            println!("{work} takes fewer: `make guard-store` keeps it so");
        }
    }
    if slower.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!(
        "guard: slower by more than {:.0} %: {}. If that is the price of something better, `make guard-store` \
         stores the new counts, and the commit says why.",
        100.0 * TOLERANCE,
        slower.join(", ")
    );
    Ok(ExitCode::FAILURE)
}

fn store() -> Result<ExitCode, String> {
    let mut text = compiled_for()? + "\n";
    for work in WORKS {
        let count = count(work)?;
        println!("{work:28}{count:>12} instructions");
        let _ = writeln!(text, "{work} {count}");
    }
    std::fs::write(path(), text).map_err(|e| format!("guard.txt: {e}"))?;
    Ok(ExitCode::SUCCESS)
}

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("guard.txt")
}

/// What counts depend on besides the code: the compiler, the kind of machine, and the vectors that
/// a sweep uses, as far as valgrind knows them.
fn compiled_for() -> Result<String, String> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(&rustc).arg("--version").output();
    let version = output.map_err(|e| format!("{} --version: {e}", rustc.display()))?.stdout;
    let version = String::from_utf8_lossy(&version).trim().to_owned();
    let kind = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let (vectors, _) = under_valgrind(INSTRUCTIONS)?;
    Ok(format!("{version}, {kind}, {}", vectors.trim()))
}

fn count(work: &str) -> Result<u64, String> {
    let (_, log) = under_valgrind(work)?;
    let collected = log.lines().find_map(|line| line.split_once("Collected : "));
    let count = collected.and_then(|(_, count)| count.trim().parse().ok());
    count
        .filter(|&count| count > 0)
        .ok_or_else(|| format!("{work}: valgrind counted nothing:\n{log}"))
}

/// Runs this program for a piece of work; returns its output, and that of valgrind.
fn under_valgrind(work: &str) -> Result<(String, String), String> {
    let program = std::env::current_exe().map_err(|e| format!("this program: {e}"))?;
    let output = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--callgrind-out-file=/dev/null",
            "--toggle-collect=*guard*counted*",
        ])
        .arg(program)
        .arg(work)
        .output()
        .map_err(|e| format!("valgrind, which counts instructions, does not run: {e}"))?;
    let [printed, log] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    if output.status.success() { Ok((printed, log)) } else { Err(format!("{work}: {log}")) }
}
