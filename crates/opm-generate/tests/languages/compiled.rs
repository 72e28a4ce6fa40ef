//! Generated C, compiled by the C compiler at hand, and called through a small program that reads poses from its input.

use crate::drawn::content;
use crate::program::{Answer, Program, Question, Shape, ask};
use opm_core::Manipulator;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;
use tempfile::TempDir;

/// What every compiler accepts without a word.
pub const STRICT: [&str; 7] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
];

/// The compiler; `None`, and a word about it, where there is none.
pub fn compiler() -> Option<String> {
    let name = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let found = Command::new(&name).arg("--version").output().is_ok_and(|run| run.status.success());
    if !found {
        println!("skipped: there is no C compiler ({name})");
    }
    found.then_some(name)
}

/// The type of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Real {
    Double,
    Float,
}

/// Several mechanisms in one program.
pub struct Compiled {
    folder: TempDir,
    shapes: Vec<Shape>,
}

/// What answers a record of the input: a mode, a pose, and the next one.
const RUN: &str = "
#define WRITE(value) do { double out = (double)(value); fwrite(&out, sizeof out, 1, stdout); } while (0)
#define WRITE_ALL(values, count) do { for (i = 0; i < (count); ++i) WRITE((values)[i]); } while (0)
#define RUN(NAME, FORWARD, DYNAMICS) do { \\
    uint32_t mode; \\
    double given[2 * NAME##_COORDINATES]; \\
    int i, status; \\
    while (fread(&mode, sizeof mode, 1, stdin) == 1) { \\
        const NAME##_geometry *g = &NAME##_default; \\
        NAME##_real pose[2 * NAME##_COORDINATES], joints[NAME##_JOINTS], imaginary[NAME##_IMAGINARY + 1]; \\
        NAME##_real actuated[NAME##_ACTUATED + 1], deficits[2 * NAME##_LEGS], position[3], rotation[9]; \\
        NAME##_real next[NAME##_JOINTS], next_imaginary[NAME##_IMAGINARY + 1]; \\
        NAME##_real jacobian[NAME##_JOINTS * NAME##_COORDINATES], twist[6 * NAME##_COORDINATES]; \\
        NAME##_real residual = -77; \\
        unsigned next_mode = 0; \\
        if (fread(given, sizeof given, 1, stdin) != 1) return 2; \\
        for (i = 0; i < 2 * NAME##_COORDINATES; ++i) pose[i] = (NAME##_real)given[i]; \\
        for (i = 0; i < NAME##_JOINTS; ++i) next[i] = joints[i] = -77; \\
        for (i = 0; i < NAME##_IMAGINARY; ++i) next_imaginary[i] = imaginary[i] = -77; \\
        for (i = 0; i < NAME##_ACTUATED; ++i) actuated[i] = -77; \\
        for (i = 0; i < 2 * NAME##_LEGS; ++i) deficits[i] = -77; \\
        for (i = 0; i < 3; ++i) position[i] = -77; \\
        for (i = 0; i < 9; ++i) rotation[i] = -77; \\
        status = NAME##_inverse(g, pose, mode, joints, imaginary); \\
        WRITE(status); \\
        WRITE_ALL(joints, NAME##_JOINTS); \\
        WRITE_ALL(imaginary, NAME##_IMAGINARY); \\
        WRITE(NAME##_actuated(g, pose, mode, actuated)); \\
        WRITE_ALL(actuated, NAME##_ACTUATED); \\
        WRITE(NAME##_deficits(g, pose, mode, deficits)); \\
        WRITE_ALL(deficits, 2 * NAME##_LEGS); \\
        WRITE(NAME##_limits(g, joints)); \\
        WRITE(NAME##_transform(g, pose, mode, position, rotation)); \\
        WRITE_ALL(position, 3); \\
        WRITE_ALL(rotation, 9); \\
        WRITE(NAME##_nearest(g, pose + NAME##_COORDINATES, joints, &next_mode, next, next_imaginary)); \\
        WRITE(next_mode); \\
        WRITE_ALL(next, NAME##_JOINTS); \\
        WRITE_ALL(next_imaginary, NAME##_IMAGINARY); \\
        for (i = 0; i < NAME##_JOINTS * NAME##_COORDINATES; ++i) jacobian[i] = -77; \\
        WRITE(NAME##_jacobian(g, pose, mode, jacobian)); \\
        WRITE_ALL(jacobian, NAME##_JOINTS * NAME##_COORDINATES); \\
        for (i = 0; i < 6 * NAME##_COORDINATES; ++i) twist[i] = -77; \\
        WRITE(NAME##_twist(g, pose, mode, twist)); \\
        WRITE_ALL(twist, 6 * NAME##_COORDINATES); \\
        WRITE(NAME##_rates(g, pose, mode, pose + NAME##_COORDINATES, next)); \\
        WRITE_ALL(next, NAME##_JOINTS); \\
        DYNAMICS(NAME); \\
        FORWARD(NAME); \\
    } \\
} while (0)
";

/// What answers the question for the forward kinematics.
const FORWARD: &str = "
#define FORWARD(NAME) do { \\
    WRITE(1); \\
    WRITE(NAME##_forward(g, actuated, mode, pose + NAME##_COORDINATES, &residual)); \\
    WRITE(residual); \\
    WRITE_ALL(pose + NAME##_COORDINATES, NAME##_COORDINATES); \\
    actuated[NAME##_ACTUATED - 1] = (NAME##_real)NAN; \\
    WRITE(NAME##_forward(g, actuated, mode, pose, &residual)); \\
} while (0)
#define NO_FORWARD(NAME) do { (void)residual; WRITE(0); } while (0)
#define DYNAMICS(NAME) do { \\
    NAME##_real efforts[NAME##_ACTUATED]; \\
    for (i = 0; i < NAME##_ACTUATED; ++i) efforts[i] = -77; \\
    WRITE(1); \\
    WRITE(NAME##_inverse_dynamics(g, pose, mode, pose + NAME##_COORDINATES, pose, efforts)); \\
    WRITE_ALL(efforts, NAME##_ACTUATED); \\
} while (0)
#define NO_DYNAMICS(NAME) WRITE(0)
";

impl Program for Compiled {
    fn ask(&self, number: usize, questions: &[Question]) -> Vec<Answer> {
        let mut command = Command::new(self.folder.path().join("driver"));
        ask(command.arg(number.to_string()), self.shapes[number], questions)
    }
}

impl Compiled {
    /// Compiles the code of mechanisms with different names. `flags` are further ones of the compiler.
    pub fn new(manipulators: &[Manipulator], real: Real, flags: &[&str]) -> Option<Self> {
        Some(Self::by(&compiler()?, manipulators, real, flags))
    }

    /// The same with a compiler that is there.
    pub fn by(compiler: &str, manipulators: &[Manipulator], real: Real, flags: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        let mut sources: Vec<PathBuf> = Vec::new();
        let mut main = String::from(
            "#include <math.h>\n#include <stdint.h>\n#include <stdio.h>\n#include <stdlib.h>\n",
        );
        let mut calls = String::new();
        for (number, manipulator) in manipulators.iter().enumerate() {
            let code = opm_generate::c(manipulator, content(manipulator)).expect("few choices");
            for (name, text) in code.files() {
                if ["_test.c", "_linuxcnc.c", "CMakeLists.txt"]
                    .iter()
                    .any(|end| name.ends_with(end))
                {
                    continue;
                }
                let text = match real {
                    Real::Double => text.to_owned(),
                    Real::Float => {
                        let double = format!("typedef double {}_real;", code.name);
                        assert_eq!(
                            text.matches(&double).count(),
                            usize::from(name == format!("{}.h", code.name))
                        );
                        text.replace(&double, &format!("typedef float {}_real;", code.name))
                    }
                };
                let path = folder.path().join(&name);
                std::fs::write(&path, text).expect("a file in it");
                if name.ends_with(".c") {
                    sources.push(path);
                }
            }
            let name = &code.name;
            let has_forward = code.header.contains("_forward(");
            let forward = if has_forward { "FORWARD" } else { "NO_FORWARD" };
            let _ = writeln!(main, "#include \"{name}.h\"");
            let has_dynamics = code.header.contains("_inverse_dynamics(");
            let dynamics = if has_dynamics { "DYNAMICS" } else { "NO_DYNAMICS" };
            let _ =
                writeln!(calls, "    case {number}: RUN({name}, {forward}, {dynamics}); break;");
        }
        let _ = write!(
            main,
            "{FORWARD}{RUN}int main(int argc, char **argv)\n{{\n    if (argc != 2) return 2;\n    switch (atoi(argv[1])) {{\n{calls}    \
             default: return 2;\n    }}\n    return 0;\n}}\n"
        );
        let driver = folder.path().join("driver.c");
        std::fs::write(&driver, main).expect("a file in it");
        let run = |arguments: &mut Command| {
            let done = arguments.current_dir(folder.path()).output().expect("a compiler that runs");
            let told = String::from_utf8_lossy(&done.stderr).into_owned();
            assert!(done.status.success(), "{told}");
            assert_eq!(told, "", "the compiler has something to say");
        };
        run(Command::new(compiler)
            .args(STRICT)
            .arg("-Werror")
            .args(flags)
            .arg("-c")
            .args(&sources));
        let objects = sources.iter().map(|source| source.with_extension("o"));
        run(Command::new(compiler)
            .args(flags)
            .args(["-o", "driver", "driver.c"])
            .args(objects)
            .arg("-lm"));
        Self { folder, shapes: manipulators.iter().map(Shape::of).collect() }
    }
}

/// The compilers that can make a program with these flags; a word about each that cannot.
pub fn compilers_with(flags: &[&str]) -> Vec<String> {
    let mut all: Vec<String> = compiler().into_iter().collect();
    all.push("clang".to_owned());
    all.dedup();
    all.retain(|compiler| {
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        std::fs::write(folder.path().join("a.c"), "int main(void) { return 0; }\n")
            .expect("a file");
        let mut command = Command::new(compiler);
        command.args(flags).args(["a.c", "-o", "a"]).current_dir(folder.path());
        let works = command.output().is_ok_and(|done| done.status.success());
        if !works {
            println!("skipped: {compiler} cannot make a program with {}", flags.join(" "));
        }
        works
    });
    all
}

/// Compiles the test program that is written beside the code, with each of these source files in turn, and runs it: whether
/// it succeeds, and what it says.
pub fn programs_of(code: &opm_generate::CCode, sources: &[&str]) -> Option<Vec<(bool, String)>> {
    let compiler = compiler()?;
    let folder = tempfile::tempdir().expect("a directory for temporary files");
    let [source, test] = [".c", "_test.c"].map(|ending| format!("{}{ending}", code.name));
    let run = |text: &&str| {
        for (name, whole) in code.files() {
            let text = if name == source { text } else { whole };
            std::fs::write(folder.path().join(&name), text).expect("a file in it");
        }
        let built = Command::new(&compiler)
            .args(STRICT)
            .args(["-Werror", "-O1", "-o", "test", &source, &test, "-lm"])
            .current_dir(folder.path())
            .output()
            .expect("a compiler that runs");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let done = Command::new(folder.path().join("test")).output().expect("it runs");
        (done.status.success(), String::from_utf8_lossy(&done.stdout).into_owned())
    };
    Some(sources.iter().map(run).collect())
}

/// Compiles the source files of several mechanisms with a compiler, the strict warnings, and the flags of a standard, without
/// making a program: what the compiler says. `None` where there is no such compiler.
pub fn compiled_by(
    compiler: &str,
    flags: &[&str],
    codes: &[opm_generate::CCode],
) -> Option<String> {
    if !Command::new(compiler).arg("--version").output().is_ok_and(|run| run.status.success()) {
        println!("skipped: there is no {compiler}");
        return None;
    }
    let folder = tempfile::tempdir().expect("a directory for temporary files");
    let mut sources = Vec::new();
    for code in codes {
        for (name, text) in code.files() {
            std::fs::write(folder.path().join(&name), text).expect("a file in it");
        }
        sources.extend([".c", "_test.c"].map(|ending| format!("{}{ending}", code.name)));
    }
    let done = Command::new(compiler)
        .args(&STRICT[1..])
        .args(["-Werror", "-O1", "-fsyntax-only"])
        .args(flags)
        .args(&sources)
        .current_dir(folder.path())
        .output()
        .expect("a compiler that runs");
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.success(), told.is_empty(), "{told}");
    Some(told)
}
