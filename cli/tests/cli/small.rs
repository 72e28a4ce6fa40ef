//! `opm examples`, `opm completions`, help and version.

use crate::PLANO;
use crate::run::{Folder, command, keys, opm};

#[test]
fn examples_are_listed_and_printed() {
    let list = opm(&["examples", "--format", "json"]).json();
    let examples = list["examples"].as_array().unwrap();
    let files = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/opm-core/mechanisms");
    assert_eq!(examples.len(), std::fs::read_dir(files).unwrap().count());
    let text = opm(&["examples"]);
    for example in examples {
        assert_eq!(keys(example), ["name", "description"]);
        let name = example["name"].as_str().unwrap();
        assert!(text.text().contains(name));
        let printed = opm(&["examples", name]);
        assert!(printed.text().contains(&format!("name = \"{name}\"")), "{}", printed.stdout);
        let json = opm(&["examples", name, "--format", "json"]).json();
        assert_eq!(json["text"], printed.stdout);
    }
}

#[test]
fn motions_are_listed_and_printed() {
    let list = opm(&["examples", "--format", "json"]).json();
    let motions = list["motions"].as_array().unwrap();
    let files = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/opm-core/motions");
    assert_eq!(motions.len(), std::fs::read_dir(files).unwrap().count());
    for motion in motions {
        assert_eq!(keys(motion), ["name", "mechanism", "description"]);
        let name = motion["name"].as_str().unwrap();
        assert!(opm(&["examples"]).text().contains(name));
        assert!(opm(&["examples", name]).text().contains(&format!("name = \"{name}\"")));
    }
}

#[test]
fn a_printed_example_is_a_mechanism_file() {
    let folder = Folder::new();
    let file = folder.write("mine.toml", opm(&["examples", PLANO]).text());
    let pose = ["--pose", "xi=10deg", "--format", "json"];
    let by_path = opm(&[&["ik", &file], &pose[..]].concat()).json();
    assert_eq!(by_path, opm(&[&["ik", PLANO], &pose[..]].concat()).json());
}

#[test]
fn an_existing_path_wins_over_an_example() {
    let folder = Folder::new();
    folder.write(PLANO, "nonsense");
    let mut command = crate::run::command(&["decompose", PLANO]);
    let output = command.current_dir(folder.path("")).output().unwrap();
    let run = crate::run::Run::new(&["decompose", PLANO], &output);
    run.fails(1, &[PLANO]);
}

#[test]
fn completions_know_the_subcommands() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let run = opm(&["completions", shell]);
        for word in ["decompose", "workspace", "inspect"] {
            assert!(run.text().contains(word), "{shell}: {word}");
        }
    }
}

/// There is a page for every command that the help lists.
#[test]
fn manual_pages_know_the_subcommands() {
    let folder = Folder::new();
    let page = opm(&["completions", "man"]);
    assert!(page.text().contains(".TH opm 1"), "{}", page.stdout);
    let pages = folder.arg("man1");
    opm(&["completions", "man", "--directory", &pages]).text();
    for command in ["decompose", "fk", "workspace", "completions"] {
        let page = folder.read(&format!("man1/opm-{command}.1"));
        assert!(page.contains(&format!(".TH opm-{command} 1")), "{page}");
    }
    opm(&["completions", "zsh", "--directory", &pages]).fails(2, &["--directory"]);
}

#[test]
fn help_and_version_go_to_standard_output() {
    assert_eq!(opm(&["--version"]).text(), concat!("opm ", env!("CARGO_PKG_VERSION"), "\n"));
    for command in [
        "decompose",
        "ik",
        "fk",
        "velocity",
        "linkage",
        "trajectory",
        "workspace",
        "plot",
        "inspect",
        "convert",
        "export",
        "generate",
        "examples",
        "schema",
        "completions",
    ] {
        let help = opm(&[command, "--help"]);
        assert!(help.text().contains("Examples:\n  opm "), "{}", help.stdout);
    }
}

#[test]
fn licences_are_printed() {
    let text = opm(&["licenses"]);
    for part in
        ["the opm authors", "Bitstream Vera", "three.js authors", "nalgebra ", "read-fonts "]
    {
        assert!(text.text().contains(part), "{part}");
    }
    assert_eq!(opm(&["licenses", "--format", "json"]).json()["text"], text.stdout);
}

/// A width of 0 is not known.
#[test]
fn help_has_its_usual_width_without_a_known_one() {
    let help = |columns: &str| {
        let output = command(&["check", "--help"]).env("COLUMNS", columns).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    assert_eq!(help("0"), help("100"));
    for width in ["60", "100"] {
        let items = help(width).lines().filter(|line| line.starts_with("* ")).count();
        assert_eq!(items, 5, "{}", help(width));
    }
}

/// Makes recordings with the names in the examples of `opm plot`.
fn record_for_plots(folder: &Folder) {
    let grid = ["--grid", "x=-0.1:0.1:5", "--grid", "y=0:0.1:3", "--grid", "xi=0:1:5"];
    let scalars = ["--scalars", "theta11,theta12,theta13", "-o", &folder.arg("cloud.mcap")];
    opm(&[&["workspace", PLANO], &grid[..], &scalars].concat()).text();
}

/// The examples in the help work as they are.
#[test]
fn the_examples_in_the_help_parse() {
    let folder = Folder::new();
    let csv = folder.write("poses.csv", "x\n0\n");
    let commands = [
        "decompose",
        "ik",
        "fk",
        "velocity",
        "linkage",
        "trajectory",
        "path",
        "workspace",
        "plot",
        "convert",
        "export mjcf",
        "export urdf",
        "generate c",
        "examples",
        "schema",
    ];
    for command in commands {
        if command == "plot" {
            record_for_plots(&folder);
        }
        let words: Vec<&str> = command.split(' ').chain(["--help"]).collect();
        let help = opm(&words);
        let (_, examples) = help.text().split_once("Examples:\n").expect("examples");
        // A backslash continues a line.
        let examples = examples.replace("\\\n", " ");
        let lines = examples.lines().map(str::trim).take_while(|line| !line.is_empty());
        for line in lines.filter(|line| line.starts_with("opm ")) {
            let line = line.split([';', '|', '>']).next().unwrap();
            let words = line.replace("poses.csv", &csv);
            let mut args: Vec<String> = Vec::new();
            for (number, part) in words.split('"').enumerate() {
                if number % 2 == 1 {
                    args.push(part.to_owned());
                } else {
                    args.extend(part.split_whitespace().map(str::to_owned));
                }
            }
            for arg in &mut args {
                let written = [
                    ".mcap",
                    ".svg",
                    ".png",
                    ".xml",
                    ".urdf",
                    "joints.toml",
                    "longer.toml",
                    "exact.toml",
                ]
                .iter()
                .any(|e| arg.ends_with(e));
                let others = ["joints.csv", "path.csv", "controller", "src/kinematics"];
                if written || others.contains(&arg.as_str()) {
                    *arg = folder.arg(arg);
                }
                if *arg == "my-mechanism.toml" {
                    *arg = PLANO.to_owned();
                }
            }
            let args: Vec<&str> = args.iter().skip(1).map(String::as_str).collect();
            let run = opm(&args);
            assert_eq!(run.code, Some(0), "{line}: {}", run.stderr);
        }
    }
}

/// The short help of a command with many options has those that matter, the long one all of them under headings.
#[test]
fn the_short_help_is_short() {
    for command in ["workspace", "trajectory", "accuracy", "calibrate", "analyze", "ik", "fk"] {
        let short = opm(&[command, "-h"]);
        let lines = short.text().lines().count();
        assert!(lines <= 45, "{command}: {lines} lines");
        assert!(short.text().ends_with("--help has all options.\n"), "{}", short.stdout);
        let long = opm(&[command, "--help"]);
        assert!(long.text().contains("\nThe mechanism:\n"), "{}", long.stdout);
        let options =
            |text: &str| text.lines().filter(|line| line.trim_start().starts_with("--")).count();
        assert!(options(&short.stdout) <= 10, "{}", short.stdout);
        assert!(options(&long.stdout) > options(&short.stdout) + 3, "{}", long.stdout);
    }
    // A command with few options has all of them in both.
    assert!(opm(&["decompose", "-h"]).text().contains("--vary"));
}
