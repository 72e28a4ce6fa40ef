//! What is fuzzed of the command line: numbers with units, flags, and recordings of strangers. The targets in `fuzz/` include
//! this file.

use opm_cli::fuzzed;
use opm_core::mechanism::examples::EXAMPLES;
use opm_tests::fuzzed::Bytes;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// The quick commands with their options, and whether an option takes a value.
static COMMANDS: LazyLock<Vec<fuzzed::QuickCommand>> = LazyLock::new(fuzzed::quick_commands);

/// A text as every kind of value of an option that holds numbers.
pub fn number(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        fuzzed::number(text);
    }
}

/// A command line, made from bytes so that it is often accepted: it is run, and prints nothing.
pub fn flags(data: &[u8]) {
    let bytes = &mut Bytes(data);
    let (command, options) = &COMMANDS[usize::from(bytes.byte()) % COMMANDS.len()];
    let example = EXAMPLES[usize::from(bytes.byte()) % EXAMPLES.len()].name;
    let mut arguments: Vec<OsString> =
        ["opm", command, example].into_iter().map(OsString::from).collect();
    for _ in 0..bytes.byte() % 5 {
        let (option, takes_value) = &options[usize::from(bytes.byte()) % options.len()];
        arguments.push(format!("--{option}").into());
        if *takes_value {
            arguments.push(value(bytes).into());
        }
    }
    if let Err(message) = fuzzed::silently(arguments.clone()) {
        assert!(!message.trim().is_empty(), "{arguments:?}");
    }
}

/// A value of an option: a number, a word, assignments of either, a list, or any text.
fn value(bytes: &mut Bytes<'_>) -> String {
    match bytes.byte() % 6 {
        0 => number_text(bytes),
        1 => word(bytes).to_owned(),
        2 => {
            let mut list = number_text(bytes);
            for _ in 0..bytes.byte() % 8 {
                let _ = write!(list, ",{}", number_text(bytes));
            }
            list
        }
        3 => {
            let count = bytes.byte() % 4;
            format!("{}={}:{}:{count}", word(bytes), number_text(bytes), number_text(bytes))
        }
        4 => {
            let length = usize::from(bytes.byte() % 12);
            String::from_utf8_lossy(&(0..length).map(|_| bytes.byte()).collect::<Vec<_>>()).into()
        }
        _ => {
            let mut list = format!("{}={}", word(bytes), number_text(bytes));
            for _ in 0..bytes.byte() % 4 {
                let _ = write!(list, ",{}={}", word(bytes), number_text(bytes));
            }
            list
        }
    }
}

/// A number as people write them; some are extreme, some are none.
fn number_text(bytes: &mut Bytes<'_>) -> String {
    const NUMBERS: [&str; 16] = [
        "0", "1", "-1", "0.1", "-0.1", "0.5", "10", "-10", "1e-3", "1e3", "1e-9", "1e9", "-0",
        "1e300", "nan", "",
    ];
    const UNITS: [&str; 12] = ["", "", "", "", "mm", "deg", "m", "rad", "in", "cm", "um", "N"];
    let number = match bytes.byte() {
        byte if byte < 96 => bytes.choose(&NUMBERS).to_owned(),
        _ => format!("{}", bytes.number() / 4.0),
    };
    number + bytes.choose(&UNITS)
}

/// A name that some option knows.
fn word(bytes: &mut Bytes<'_>) -> &'static str {
    const WORDS: [&str; 41] = [
        "x",
        "y",
        "z",
        "zeta",
        "xi",
        "psi",
        "phi",
        "alpha",
        "rho",
        "azimuth",
        "tilt",
        "torsion",
        "S1",
        "S2",
        "S3",
        "A1",
        "A2",
        "A3",
        "a1",
        "a2",
        "theta11",
        "theta12",
        "h",
        "leg1.h",
        "r",
        "limits.S",
        "S1.limits",
        "home",
        "none",
        "++ ++ ++ +",
        "-+ ++ ++ +",
        "text",
        "json",
        "euler-angles",
        "tilt-torsion",
        "roll-pitch-yaw",
        "axes",
        "links",
        "axis",
        "lti",
        "1",
    ];
    bytes.choose(&WORDS)
}

/// A recording that somebody else wrote, or damaged, through every command that reads one.
pub fn foreign(data: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let recording = place("foreign.mcap");
    fs::write(&recording, data).unwrap();
    let run = |command: &[&str], output: Option<&str>| {
        let mut arguments: Vec<OsString> =
            [&["opm"], command].concat().into_iter().map(OsString::from).collect();
        arguments.push(recording.clone().into());
        if let Some(output) = output {
            arguments.extend(["-o".into(), place(output).into_os_string()]);
        }
        let done = fuzzed::silently(arguments);
        if let Some(output) = output {
            written(done.is_ok(), &place(output), command);
        }
        done
    };
    let read = run(&["inspect"], None);
    let again = run(&["inspect", "--format", "json"], None);
    assert_eq!(read.is_ok(), again.is_ok());
    let _ = run(&["layout"], Some("layout.json"));
    let _ = run(&["layout"], Some("show.py"));
    let drawn = run(&["plot"], Some("picture.svg"));
    assert!(drawn.is_err() || read.is_ok(), "drawn, and not read: {read:?}");
    let _ = run(&["merge"], Some("whole.mcap"));
    let _ = run(&["recover"], Some("recovered.mcap"));
}

/// What a command has written: a file if it is done, and none if it has failed.
fn written(done: bool, file: &Path, command: &[&str]) {
    assert_eq!(file.exists(), done, "{command:?}");
}
