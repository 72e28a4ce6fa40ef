//! Helpers of these tests: they run the program and inspect its output.

use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The program with arguments, not yet run.
pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_opm"));
    command.args(args).stdin(Stdio::null());
    command
}

/// Runs the program to its end.
pub fn opm(args: &[&str]) -> Run {
    Run::new(args, &command(args).output().expect("the program starts"))
}

/// Runs the program with something on its standard input.
pub fn opm_reading(input: &str, args: &[&str]) -> Run {
    let mut child = command(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    std::thread::scope(|scope| {
        // Writing runs beside reading, or both would wait for each other. A program that stops reading
        // early closes its end, which is not a failure of the test.
        scope.spawn(move || stdin.write_all(input.as_bytes()));
        Run::new(args, &child.wait_with_output().expect("the program ends"))
    })
}

/// The result of a run.
pub struct Run {
    args: String,
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    pub fn new(args: &[&str], output: &Output) -> Self {
        Self {
            args: args.join(" "),
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout.clone()).expect("UTF-8"),
            stderr: String::from_utf8(output.stderr.clone()).expect("UTF-8"),
        }
    }

    /// The standard output of a run that succeeded.
    #[track_caller]
    pub fn text(&self) -> &str {
        assert_eq!(self.code, Some(0), "opm {}: {}", self.args, self.stderr);
        &self.stdout
    }

    /// The single JSON object that the run printed.
    #[track_caller]
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(self.text()).expect("one JSON value");
        assert!(value.is_object(), "opm {}: {value}", self.args);
        value
    }

    /// Asserts that it failed with this code, that its messages contain all of `parts`, and that it printed
    /// nothing.
    #[track_caller]
    pub fn fails(&self, code: i32, parts: &[&str]) -> &Self {
        let Self { args, stderr, stdout, .. } = self;
        assert_eq!(self.code, Some(code), "opm {args}: {stderr}");
        assert_eq!(stdout, "", "opm {args}");
        for part in parts {
            assert!(stderr.contains(part), "opm {args}: no {part:?} in\n{stderr}");
        }
        for bad in ["panicked", "backtrace", "unwrap", "RUST_"] {
            assert!(!stderr.contains(bad), "opm {args}: {stderr}");
        }
        self
    }

    /// Asserts as [`Run::fails`], and that there is a single line.
    #[track_caller]
    pub fn fails_with_one_line(&self, code: i32, parts: &[&str]) {
        self.fails(code, parts);
        assert_eq!(self.stderr.lines().count(), 1, "opm {}: {}", self.args, self.stderr);
        assert!(self.stderr.starts_with("opm: error: "), "opm {}: {}", self.args, self.stderr);
    }
}

/// A temporary folder for a test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The path as an argument.
    pub fn arg(&self, name: &str) -> String {
        self.path(name).to_str().expect("UTF-8").to_owned()
    }

    /// Writes a file and gives its path as an argument.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        std::fs::write(self.path(name), content).expect("a file");
        self.arg(name)
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect("a file")
    }

    /// The names of the existing files.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a folder");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
            .collect();
        names.sort();
        names
    }
}

/// The keys of a JSON object, in order.
#[track_caller]
pub fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[track_caller]
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}
