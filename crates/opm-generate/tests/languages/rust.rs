//! Generated Rust, compiled by the compiler at hand and compared with `opm-core`.

use crate::comparison::{
    compare_all, float_closes_every_leg, forward_leads_from_home, reach_ends_where_it_does_for_opm,
};
use crate::drawn::{content, covering, shipped};
use crate::program::{Answer, Program, Question, Shape, ask};
use opm_core::Manipulator;
use opm_generate::Package;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// Several packages as modules of one program.
struct Compiled {
    folder: TempDir,
    shapes: Vec<Shape>,
}

/// Reads questions from the input and answers them.
const DRIVER: &str = include_str!("rust_driver.txt");

impl Program for Compiled {
    fn ask(&self, number: usize, questions: &[Question]) -> Vec<Answer> {
        let mut command = Command::new(self.folder.path().join("driver"));
        ask(command.arg(number.to_string()), self.shapes[number], questions)
    }
}

fn compiler() -> String {
    std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into())
}

/// Writes the files of a package into a folder.
fn write(folder: &Path, package: &Package, change: impl Fn(&str) -> String) {
    for (name, text) in &package.files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder in it");
        std::fs::write(path, change(text)).expect("a file in it");
    }
}

impl Compiled {
    /// Compiles the code of mechanisms, with `f64` or `f32`; `None`, and a word about it, without a compiler.
    fn new(manipulators: &[Manipulator], real: &str) -> Option<Self> {
        let compiler = compiler();
        if Command::new(&compiler).arg("--version").output().is_err() {
            println!("skipped: there is no Rust compiler ({compiler})");
            return None;
        }
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        let mut main = DRIVER.to_owned();
        let mut calls = String::new();
        for (number, m) in manipulators.iter().enumerate() {
            let package = opm_generate::rust(m, content(m)).expect("few choices");
            let line = "pub type Real = f64;";
            let lib = &package.files[1].1;
            assert_eq!((&*package.files[1].0, lib.matches(line).count()), ("src/lib.rs", 1));
            // It is a module here, and the tests of the documentation are not run.
            write(&folder.path().join(format!("m{number}")), &package, |text| {
                text.replace(line, &format!("pub type Real = {real};"))
                    .replace("#![no_std]\n", "")
                    .replace("#![forbid(unsafe_code)]\n", "")
            });
            let _ = writeln!(
                main,
                "#[path = \"m{number}/src/lib.rs\"]\n#[allow(dead_code, unused_imports)]\nmod m{number};"
            );
            let forward = lib.contains("pub fn forward(");
            let dynamics = lib.contains("pub fn inverse_dynamics(");
            let _ = writeln!(calls, "        {number} => run!(m{number}, {forward}, {dynamics}),");
        }
        main = main.replace("        CALLS\n", &calls);
        std::fs::write(folder.path().join("driver.rs"), main).expect("a file in it");
        let done = Command::new(compiler)
            .args(["--edition", "2024", "--crate-type", "bin", "-C", "opt-level=0"])
            .args(["-C", "overflow-checks=on", "--cfg", "feature=\"std\""])
            .args(["--check-cfg", "cfg(feature, values(\"std\"))", "driver.rs", "-o", "driver"])
            .current_dir(folder.path())
            .output()
            .expect("a compiler that runs");
        let told = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(done.status.success(), "{}", told.chars().take(4000).collect::<String>());
        let own: Vec<&str> =
            told.split("\n\n").filter(|part| part.contains("kinematics.rs")).collect();
        assert!(own.is_empty(), "the compiler has something to say: {}", own[0]);
        Some(Self { folder, shapes: manipulators.iter().map(Shape::of).collect() })
    }
}

#[test]
fn rust_solves_shipped_mechanisms_as_opm() {
    let all = shipped();
    let Some(program) = Compiled::new(&all, "f64") else { return };
    compare_all(&program, &all, 1_000, 21);
    forward_leads_from_home(&program, &all, 300, 22);
    reach_ends_where_it_does_for_opm(&program, &all, 30);
}

#[test]
fn rust_solves_random_mechanisms_as_opm() {
    let all = covering(2, 500);
    let Some(program) = Compiled::new(&all, "f64") else { return };
    compare_all(&program, &all, 300, 23);
    forward_leads_from_home(&program, &all, 100, 24);
}

#[test]
fn rust_in_f32_closes_every_leg() {
    let names = ["plano-spherical-5dof", "double-spherical-5dof", "planar-3rrr", "sarrus"];
    let all = names.map(|name| Manipulator::example(name).unwrap());
    let Some(program) = Compiled::new(&all, "f32") else { return };
    float_closes_every_leg(&program, &all, 2_000);
}

/// Without the standard library, its functions of numbers are those of `libm`; the test beside it accepts it with either.
#[test]
fn rust_needs_no_standard_library() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    let package = opm_generate::rust(&m, content(&m)).expect("few choices");
    let folder = tempfile::tempdir().expect("a directory for temporary files");
    write(folder.path(), &package, str::to_owned);
    // The lock file of opm names a version of libm that is there.
    let lock = concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.lock");
    std::fs::copy(lock, folder.path().join("Cargo.lock")).expect("the lock file");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let run = |arguments: &[&str]| {
        let mut command = Command::new(&cargo);
        command.args(["test", "--offline", "--quiet"]).args(arguments).current_dir(folder.path());
        let done =
            command.env_remove("RUSTFLAGS").env("CARGO_TARGET_DIR", folder.path().join("target"));
        let done = done.output().expect("cargo runs");
        (done.status.success(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (right, told) = run(&["--no-default-features", "--features", "libm"]);
    if told.contains("--offline") {
        println!("skipped: libm is not there, and cargo is offline");
    } else {
        assert!(right && told.is_empty(), "{told}");
    }
    // A changed joint is found.
    let path = folder.path().join("src/kinematics.rs");
    let text = std::fs::read_to_string(&path).expect("the closed forms");
    let wrong = text.replacen(".home + at.q_", ".home + 0.01 + at.q_", 1);
    assert_ne!(text, wrong);
    std::fs::write(&path, wrong).expect("a file in it");
    assert!(!run(&["--test", "golden"]).0);
}
