//! `opm calibrate`: a fit from the plan to the file, and what is wrong with measurements.

use crate::PLANO;
use crate::run::{Folder, number, opm, opm_reading};

/// Poses and joints of the shipped manipulator, as `--plan` writes them.
fn measured(folder: &Folder) -> String {
    let path = folder.arg("m.csv");
    let args = ["calibrate", PLANO, "--plan", "12", "--candidates", "40", "-o", &path, "--quiet"];
    opm(&args).text();
    folder.read("m.csv")
}

#[test]
fn what_a_plan_says_is_read_as_measurements() {
    let folder = Folder::new();
    measured(&folder);
    let (csv, out) = (folder.arg("m.csv"), folder.arg("machine.toml"));
    let args = ["calibrate", PLANO, "--measurements", &csv, "--sigma", "20um,20urad"];
    let found = opm(&[&args[..], &["-o", &out, "--format", "json", "--quiet"]].concat()).json();
    for parameter in found["parameters"].as_array().expect("a list") {
        let change = number(&parameter["after"]) - number(&parameter["before"]);
        assert!(change.abs() < 1e-8, "{parameter}");
    }
    // The result is a mechanism file, which the program reads.
    assert_eq!(opm(&["decompose", &out]).code, Some(0));
    // Standard input serves as well.
    let text = folder.read("m.csv");
    let piped = ["calibrate", PLANO, "--measurements", "-", "--sigma", "20um,20urad", "--quiet"];
    assert!(opm_reading(&text, &piped).text().contains("leg1.h"));
}

#[test]
fn what_is_wrong_with_measurements_is_told_with_its_line() {
    let folder = Folder::new();
    let text = measured(&folder);
    let header = text.lines().next().expect("a header").to_owned();
    let first = text.lines().nth(1).expect("a row").to_owned();
    let columns = header.split(',').count();
    let with_header = |from: &str, to: &str| text.replacen(from, to, 1);
    let rows = |count: usize| text.lines().take(count + 1).collect::<Vec<_>>().join("\n") + "\n";
    for (table, parts) in [
        (String::new(), &["m.csv: empty, expected a header"][..]),
        ("\n\n".to_owned(), &["m.csv", "expected a header"]),
        (format!("{header}\n"), &["m.csv: no rows, expected measurements"]),
        (with_header("S1", "S9"), &["m.csv:1: column \"S9\"", "S1"]),
        (with_header("S1", "S2"), &["m.csv:1: column \"S2\": given twice"]),
        (with_header("S1", "S1 [furlong]"), &["m.csv:1: column \"S1 [furlong]\"", "mm"]),
        (with_header("S1", "S1 [deg]"), &["m.csv:1: column \"S1 [deg]\""]),
        (
            with_header("S1", "distance.A"),
            &["m.csv:1: column \"distance.A\": there is no point \"A\""],
        ),
        (
            format!("{header}\n{first}\nnan{}\n", ",0".repeat(columns - 1)),
            &["m.csv:3: x is \"nan\", expected a number"],
        ),
        (
            format!("{header}\n{first}\none{}\n", ",0".repeat(columns - 1)),
            &["m.csv:3: x is \"one\""],
        ),
        (format!("{header}\n{first},7\n"), &["m.csv:2:", "cells, expected at most"]),
        // As many values as the pose has coordinates tell nothing.
        (
            "x,y,zeta,xi,psi\n0,0,0,0,0\n".to_owned(),
            &["m.csv: the measurements say nothing of the parameters"],
        ),
        (
            "x,y\n0.01,0\n0,0.01\n".to_owned(),
            &["m.csv: the measurements say nothing of the parameters"],
        ),
        // Nothing is near.
        (
            format!("{header}\n{}\n", vec!["90"; columns].join(",")),
            &["m.csv: no measurement is near a pose in reach"],
        ),
    ] {
        let file = folder.write("m.csv", table);
        opm(&["calibrate", PLANO, "--measurements", &file, "--quiet"])
            .fails_with_one_line(1, parts);
    }
    // A single row tells something, and what it does not is named.
    let file = folder.write("m.csv", rows(1));
    let few = opm(&[
        "calibrate",
        PLANO,
        "--measurements",
        &file,
        "--sigma",
        "20um,20urad",
        "--format",
        "json",
    ])
    .json();
    assert!(
        few["parameters"].as_array().expect("a list").iter().any(|p| p["identifiable"] == false)
    );
}

#[test]
fn wrong_options_of_a_calibration_are_named() {
    let folder = Folder::new();
    measured(&folder);
    let csv = folder.arg("m.csv");
    let args = ["calibrate", PLANO, "--measurements", &csv];
    let (nowhere, out) = (folder.arg("no/out.toml"), folder.arg("out.toml"));
    for (flags, code, parts) in [
        (&["--sigma", "20um"][..], 2, &["--sigma", "expected 2: LENGTH,ANGLE"][..]),
        (&["--sigma", "0,1"], 2, &["--sigma", "LENGTH is 0, expected a positive number"]),
        (
            &["--sigma", "20,20"],
            1,
            &["too inaccurate", "a standard error of ", "expected at most 0.05"],
        ),
        (&["--sigma", "1deg,1"], 2, &["--sigma", "LENGTH is a length"]),
        (&["--joint-sigma", "1um,1urad"], 2, &["--sigma"]),
        (&["--only", "leg7"], 2, &["--only, --hold", "`leg7` names no parameter", "leg1.h"]),
        (&["--hold", "leg1,leg2,leg3,leg4"], 2, &["--hold", "every parameter is held"]),
        (&["--weakest", "0"], 2, &["--weakest", "expected a positive number"]),
        (&["--mode", "++"], 2, &["--mode", "2 signs for 7"]),
        (&["--point", "A=1,2"], 2, &["--point"]),
        (&["--columns", "x"], 2, &["--plan"]),
        (&["-o", "-"], 2, &["--output", "the report goes to standard output"]),
        (&["-o", &csv], 2, &["--output", "m.csv is also the input"]),
        (&["-o", &nowhere], 1, &["no/out.toml", "No such file"]),
    ] {
        opm(&[&args, flags].concat()).fails(code, parts);
    }
    opm(&["calibrate", PLANO]).fails(2, &["--measurements"]);
    let missing = folder.arg("missing.csv");
    let none = opm(&["calibrate", PLANO, "--measurements", &missing, "-o", &out]);
    none.fails_with_one_line(1, &["missing.csv: No such file"]);
    // A mechanism without these joints.
    let other = opm(&["calibrate", "planar-3rrr", "--measurements", &csv, "-o", &out]);
    other.fails_with_one_line(1, &["m.csv:1: column \"zeta\""]);
    opm(&["calibrate", PLANO, "--plan", "0"]).fails(2, &["--plan"]);
    let plan = ["calibrate", PLANO, "--plan", "4", "--columns", "S9"];
    opm(&plan).fails(2, &["--columns", "S9"]);
    assert_eq!(folder.names(), ["m.csv"]);
}
