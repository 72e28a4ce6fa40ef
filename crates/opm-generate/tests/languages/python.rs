//! Generated Python, run by the interpreter at hand and compared with `opm-core`.

use crate::comparison::{compare_all, forward_leads_from_home, reach_ends_where_it_does_for_opm};
use crate::drawn::{content, covering, shipped};
use crate::program::{Answer, Program, Question, Shape, ask};
use opm_core::Manipulator;
use opm_generate::Package;
use std::process::Command;
use tempfile::TempDir;

/// Several modules in a folder.
struct Modules {
    python: String,
    folder: TempDir,
    names: Vec<String>,
    shapes: Vec<Shape>,
}

/// Reads all questions from the input and answers them at once.
const DRIVER: &str = include_str!("python_driver.py");

/// Calls functions with what they refuse.
const SHAPES: &str = include_str!("python_shapes.py");

impl Program for Modules {
    fn ask(&self, number: usize, questions: &[Question]) -> Vec<Answer> {
        let mut command = Command::new(&self.python);
        command.arg("-B").arg(self.folder.path().join("driver.py")).arg(&self.names[number]);
        ask(&mut command, self.shapes[number], questions)
    }
}

/// An interpreter that has NumPy; `None`, and a word about it, where there is none.
pub fn interpreter() -> Option<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/venv/bin/python");
    let own = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let found = [folder.to_owned(), own].into_iter().find(|python| {
        let run = Command::new(python).args(["-c", "import numpy"]).output();
        run.is_ok_and(|run| run.status.success())
    });
    if found.is_none() {
        println!("skipped: there is no Python with NumPy; set PYTHON");
    }
    found
}

impl Modules {
    fn new(manipulators: &[Manipulator]) -> Option<Self> {
        let python = interpreter()?;
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        let mut names = Vec::new();
        for m in manipulators {
            let Package { name, files } = opm_generate::python(m, content(m)).expect("few choices");
            for (file, text) in files {
                std::fs::write(folder.path().join(file), text).expect("a file in it");
            }
            names.push(name);
        }
        std::fs::write(folder.path().join("driver.py"), DRIVER).expect("a file in it");
        let shapes = manipulators.iter().map(Shape::of).collect();
        Some(Self { python, folder, names, shapes })
    }
}

#[test]
fn python_solves_shipped_mechanisms_as_opm() {
    let all = shipped();
    let Some(program) = Modules::new(&all) else { return };
    compare_all(&program, &all, 400, 31);
    forward_leads_from_home(&program, &all, 300, 32);
    reach_ends_where_it_does_for_opm(&program, &all, 30);
}

#[test]
fn python_solves_random_mechanisms_as_opm() {
    let all = covering(2, 500);
    let Some(program) = Modules::new(&all) else { return };
    compare_all(&program, &all, 200, 33);
    forward_leads_from_home(&program, &all, 100, 34);
}

/// The test beside the code accepts it, and finds a changed joint.
#[test]
fn the_test_beside_python_finds_errors() {
    let all = [Manipulator::example("plano-spherical-5dof").unwrap()];
    let Some(program) = Modules::new(&all) else { return };
    let name = &program.names[0];
    let run = || {
        let test = program.folder.path().join(format!("test_{name}.py"));
        let done = Command::new(&program.python).arg("-B").arg(test).output().expect("it runs");
        (done.status.success(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (right, told) = run();
    assert!(right, "{told}");
    let path = program.folder.path().join(format!("{name}.py"));
    let text = std::fs::read_to_string(&path).expect("the module");
    let wrong = text.replacen(".home + at.q_", ".home + 0.01 + at.q_", 1);
    assert_ne!(text, wrong);
    std::fs::write(&path, wrong).expect("a file in it");
    assert!(!run().0);
}

/// What has too few or too many numbers, and modes that there are not, are refused with a word about it.
#[test]
fn python_refuses_wrong_shapes_and_modes() {
    let all = ["five-bar", "plano-spherical-5dof"].map(|name| Manipulator::example(name).unwrap());
    let Some(program) = Modules::new(&all) else { return };
    for name in &program.names {
        let mut command = Command::new(&program.python);
        command.arg("-B").arg(program.folder.path().join("shapes.py")).arg(name);
        std::fs::write(program.folder.path().join("shapes.py"), SHAPES).expect("a file in it");
        let done = command.output().expect("it runs");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
}
