//! `opm generate`: the files that are written, and what is told of wrong input. What the code computes is tested with its
//! crate.

use crate::run::{Folder, opm, opm_reading};
use std::fs;

#[test]
fn six_files_are_written_and_named() {
    let folder = Folder::new();
    let into = folder.arg("deep/controller");
    let run = opm(&["generate", "c", "five-bar", "-o", &into]);
    assert_eq!(run.text(), "");
    let endings = [".c", ".h", "_golden.h", "_linuxcnc.c", "_test.c"];
    let names = [
        ["CMakeLists.txt".to_owned()].to_vec(),
        endings.map(|end| format!("five_bar{end}")).to_vec(),
    ];
    let names = names.concat();
    let mut found: Vec<String> = fs::read_dir(&into)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    assert_eq!(found, names);
    for name in &names {
        assert!(run.stderr.contains(&**name), "{}", run.stderr);
    }
    let header = folder.read("deep/controller/five_bar.h");
    assert!(header.contains("typedef double five_bar_real;"));
    assert!(header.contains("five_bar_COORDINATES = 2,"));
    assert!(header.contains("five_bar_JOINT_S1 = 0, /* S1, rad */"));

    // The same bytes again, and from standard input, over the old ones.
    let source = folder.read("deep/controller/five_bar.c");
    let mechanism = opm(&["examples", "five-bar"]).stdout;
    opm_reading(&mechanism, &["generate", "c", "-", "-q", "-o", &into]).text();
    assert_eq!(folder.read("deep/controller/five_bar.c"), source);
}

/// Every language has its files, in folders of their own.
#[test]
fn packages_are_written_and_named() {
    let folder = Folder::new();
    let expected = [
        (
            "rust",
            vec!["Cargo.toml", "src/kinematics.rs", "src/lib.rs", "src/math.rs", "tests/golden.rs"],
        ),
        ("python", vec!["five_bar.py", "pyproject.toml", "test_five_bar.py"]),
        ("matlab", vec!["+five_bar/inverse.m", "+five_bar/default.m", "five_bar_test.m"]),
        ("st", vec!["five_bar.st", "five_bar_test.st"]),
    ];
    for (language, files) in expected {
        let into = folder.arg(language);
        let run = opm(&["generate", language, "five-bar", "-o", &into]);
        assert_eq!(run.text(), "");
        for file in files {
            assert!(run.stderr.contains(file), "{}", run.stderr);
            assert!(!folder.read(&format!("{language}/{file}")).is_empty());
        }
        opm(&["generate", language, "five-bar"]).fails(2, &["--output"]);
        let refused = ["generate", language, "bennett-plano-spherical-6r", "-o", &into];
        opm(&refused).fails_with_one_line(1, &["leg1"]);
    }
}

/// A parameter changes the geometry and the poses, and no function.
#[test]
fn parameters_are_in_the_geometry_alone() {
    let folder = Folder::new();
    let functions = |name: &str, change: &[&str]| {
        let into = folder.arg(name);
        opm(&[&["generate", "c", "plano-spherical-5dof", "-o", &into], change].concat()).text();
        let source = folder.read(&format!("{name}/plano_spherical_5dof.c"));
        let (geometry, functions) = source.split_once("\n};\n").unwrap();
        (geometry.to_owned(), functions.to_owned())
    };
    let (plain, changed) = (functions("a", &[]), functions("b", &["--set", "h=140mm"]));
    assert_ne!(plain.0, changed.0);
    assert_eq!(plain.1, changed.1);
}

#[test]
fn wrong_input_is_told() {
    let folder = Folder::new();
    let into = folder.arg("out");
    let generate = |args: &[&str]| opm(&[&["generate", "c"], args].concat());
    generate(&["none.toml", "-o", &into]).fails_with_one_line(1, &["none.toml: No such file"]);
    generate(&["bennett-plano-spherical-6r", "-o", &into]).fails_with_one_line(1, &["leg1"]);
    assert!(folder.names().is_empty());
    fs::write(&into, "a file").unwrap();
    generate(&["five-bar", "-o", &into])
        .fails_with_one_line(1, &["out: a file, expected a folder or a new name"]);
    let below = folder.arg("out/deeper");
    generate(&["five-bar", "-o", &below]).fails_with_one_line(1, &["out/deeper"]);
    assert_eq!(folder.read("out"), "a file");
    generate(&["five-bar", "-o", "-"]).fails_with_one_line(2, &["--output: -: expected a folder"]);
    assert!(!std::path::Path::new("-").exists());
}

/// The inverse dynamics are written on request, and refused where efforts are not determined.
#[test]
fn dynamics_are_written_on_request() {
    let folder = Folder::new();
    let into = folder.arg("code");
    for language in ["c", "rust", "python", "matlab", "st"] {
        let run = |rest: &[&str]| {
            opm(&[&["generate", language, "delta", "-q", "-o", &into], rest].concat()).text();
            let mut folders = vec![std::path::PathBuf::from(&into)];
            let mut all = String::new();
            while let Some(folder) = folders.pop() {
                for entry in std::fs::read_dir(folder).unwrap() {
                    let path = entry.unwrap().path();
                    match path.is_dir() {
                        true => folders.push(path),
                        false => all += &std::fs::read_to_string(path).unwrap(),
                    }
                }
            }
            std::fs::remove_dir_all(&into).unwrap();
            all
        };
        assert!(!run(&[]).contains("payload"), "{language}");
        let text = run(&["--dynamics"]);
        assert!(text.contains("inverse_dynamics") && text.contains("payload"), "{language}");
    }
    let refused = opm(&["generate", "c", "ankle", "--dynamics", "-o", &into]);
    refused.fails_with_one_line(1, &["ankle: inverse dynamics: leg leg1 has 7 freedoms"]);
}
