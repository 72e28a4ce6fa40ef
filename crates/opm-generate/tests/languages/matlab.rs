//! Generated MATLAB, run by Octave and compared with `opm-core`.

use crate::comparison::{compare_all, forward_leads_from_home, reach_ends_where_it_does_for_opm};
use crate::drawn::{content, random_mechanisms, shipped};
use crate::program::{Answer, Program, Question, Shape, ask};
use opm_core::Manipulator;
use opm_generate::Package;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Several packages in a folder.
struct Packages {
    octave: &'static str,
    folder: TempDir,
    names: Vec<String>,
    shapes: Vec<Shape>,
}

/// Reads all questions from the input and answers one after the other.
const DRIVER: &str = include_str!("matlab_driver.m");

/// Runs a program that reads its input from a file. Octave 7 may have a complaint about its own end, which is left out.
const RUN: &str = "cat > \"$CODE/input\"; \"$@\" < /dev/null 2> \"$CODE/told\"; status=$?; \
                   grep -v 'while preparing to exit' \"$CODE/told\" >&2; exit $status";

impl Packages {
    fn new(manipulators: &[Manipulator]) -> Option<Self> {
        let octave = ["octave-cli", "octave"].into_iter().find(|octave| {
            Command::new(octave).arg("--version").output().is_ok_and(|run| run.status.success())
        });
        let Some(octave) = octave else {
            println!("skipped: there is no Octave");
            return None;
        };
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        let mut names = Vec::new();
        for m in manipulators {
            let Package { name, files } = opm_generate::matlab(m, content(m)).expect("few choices");
            for (file, text) in files {
                let path = folder.path().join(file);
                std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder in it");
                std::fs::write(path, text).expect("a file in it");
            }
            names.push(name);
        }
        std::fs::write(folder.path().join("driver.m"), DRIVER).expect("a file in it");
        let shapes = manipulators.iter().map(Shape::of).collect();
        Some(Self { octave, folder, names, shapes })
    }

    fn run(&self, text: &str) -> Command {
        // Octave has a function of the name of one in the package, and says so, though none hides the other.
        let quiet = "warning('off', 'Octave:shadowed-function'); addpath(getenv('CODE'));";
        let mut command = Command::new("sh");
        command.args(["-c", RUN, "sh", self.octave]);
        command.args(["--norc", "--no-gui", "--eval", &format!("{quiet} {text}")]);
        command.env("CODE", self.folder.path());
        command
    }
}

impl Program for Packages {
    fn ask(&self, number: usize, questions: &[Question]) -> Vec<Answer> {
        let (name, shape) = (&self.names[number], self.shapes[number]);
        let Shape { coordinates, joints, imaginary, actuated, legs } = shape;
        let text =
            format!("driver('{name}', [{coordinates} {joints} {imaginary} {actuated} {legs}])");
        ask(&mut self.run(&text), shape, questions)
    }
}

/// One of each kind: Octave takes some 50 ms for all functions at one pose.
#[test]
fn matlab_solves_shipped_mechanisms_as_opm() {
    let names = [
        "plano-spherical-5dof",
        "double-spherical-5dof",
        "five-bar",
        "sarrus",
        "schoenflies-lift-4dof",
    ];
    let all: Vec<Manipulator> =
        shipped().into_iter().filter(|m| names.contains(&&*m.mechanism().name)).collect();
    let Some(program) = Packages::new(&all) else { return };
    compare_all(&program, &all, 40, 41);
    forward_leads_from_home(&program, &all, 20, 42);
    reach_ends_where_it_does_for_opm(&program, &all, 30);
}

#[test]
fn matlab_solves_random_mechanisms_as_opm() {
    let all: Vec<Manipulator> = random_mechanisms(2).into_iter().step_by(25).collect();
    let Some(program) = Packages::new(&all) else { return };
    compare_all(&program, &all, 20, 43);
}

/// The test beside the code accepts it, and finds a changed joint.
#[test]
fn the_test_beside_matlab_finds_errors() {
    let all = [Manipulator::example("plano-spherical-5dof").unwrap()];
    let Some(program) = Packages::new(&all) else { return };
    let name = &program.names[0];
    let run = || {
        let done = program.run(&format!("{name}_test()")).stdin(Stdio::null()).output();
        let done = done.expect("it runs");
        (done.status.success(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (right, told) = run();
    assert!(right, "{told}");
    let path = program.folder.path().join(format!("+{name}/inverse.m"));
    let text = std::fs::read_to_string(&path).expect("the function");
    let wrong = text.replacen(".home + at.q_", ".home + 0.01 + at.q_", 1);
    assert_ne!(text, wrong);
    std::fs::write(&path, wrong).expect("a file in it");
    assert!(!run().0);
}
