//! `opm measure`: bounds, domains, and how a measure ends.

use crate::run::{Run, command, keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::Value;
use std::f64::consts::PI;
use std::process::{Command, Stdio};

fn measure(args: &[&str]) -> Value {
    opm(&[&["measure"], args, &["--format", "json", "--quiet"]].concat()).json()
}

/// Value and bounds.
fn ends(found: &Value) -> [f64; 3] {
    ["value", "lower", "upper"].map(|key| number(&found[key]))
}

#[test]
fn the_upper_section_is_measured_over_every_orientation() {
    let found = measure(&[PLANO, "--section", "upper", "--tolerance", "1e-4"]);
    let expected = [
        "value",
        "lower",
        "upper",
        "units",
        "fraction",
        "boxes",
        "seconds",
        "whole",
        "section",
        "mode",
        "over",
        "weights",
        "tolerance",
        "reached",
    ];
    assert_eq!(keys(&found), expected);
    let [value, lower, upper] = ends(&found);
    // Three disjoint caps of 30 degrees are missing.
    let share = 1.0 - 1.5 * (1.0 - (PI / 6.0).cos());
    let all = 8.0 * PI * PI;
    assert!(lower < share * all && share * all < upper && lower <= value && value <= upper);
    assert!((upper - lower) / 2.0 <= 1e-4 * value);
    assert!((number(&found["fraction"]) - share).abs() < 1e-4);
    assert!((number(&found["whole"]) - all).abs() < 1e-9);
    assert_eq!((&found["units"], &found["reached"]), (&"rad^3".into(), &true.into()));
    assert_eq!(keys(&found["over"]), ["zeta", "xi", "psi"]);
    assert_eq!(found["weights"], serde_json::json!(["sin xi"]));
    // A cap of the platform's own tilt: 2 pi (1 - cos 40 deg) of axes, each with a full revolution.
    let cap = measure(&[PLANO, "--section", "upper", "--over", "xi=0:40deg"]);
    let expected = 4.0 * PI * PI * (1.0 - (40_f64).to_radians().cos());
    assert!((number(&cap["whole"]) - expected).abs() < 1e-9);
}

#[test]
fn a_square_in_the_workspace_is_its_area() {
    let over = ["--over", "x=-10mm:10mm", "--over", "y=-10mm:20mm"];
    let found = measure(&[&[HELICAL], &over[..]].concat());
    let [_, lower, upper] = ends(&found);
    assert!((lower - 6e-4).abs() < 1e-12 && (upper - 6e-4).abs() < 1e-12);
    assert_eq!(found["units"], "m^2");
    assert!((number(&found["fraction"]) - 1.0).abs() < 1e-12);
    assert_eq!(found["over"]["phi"], serde_json::json!({ "min": 0.0, "max": 0.0 }));
    let text = opm(&[&["measure", HELICAL], &over[..]].concat()).text().to_owned();
    assert!(text.contains("mm^2") && text.contains("600.0"), "{text}");
}

/// Text is in the units of the file. The rectangles of lengths, angles and both are completely in reach.
#[test]
fn text_is_in_the_units_of_the_file() {
    // For all orientations, the sphere's area in square degrees is weighed by the sine, and a revolution is
    // 360 degrees.
    let sphere = 4.0 * PI * (180.0 / PI).powi(2);
    for (args, unit, area) in [
        (&[HELICAL, "--over", "x=-10mm:10mm", "--over", "phi=0:30deg"][..], "mm deg", 600.0),
        (&[HELICAL, "--over", "phi=-1deg:1deg"], "deg", 2.0),
        (&[PLANO, "--over", "zeta=-5deg:5deg", "--over", "psi=0:4deg"], "deg^2", 40.0),
        (
            &[PLANO, "--section", "upper", "--tolerance", "1e-3"],
            "deg^3",
            0.799_038 * sphere * 360.0,
        ),
    ] {
        let run = opm(&[&["measure"], args].concat());
        let line = run.text().lines().find(|line| line.starts_with("measure")).expect("a measure");
        let cells: Vec<&str> = line.split("  ").filter(|cell| !cell.is_empty()).collect();
        let [_, _, lower, upper, found] = cells[..] else { panic!("{line}") };
        let [lower, upper]: [f64; 2] =
            [lower, upper].map(|cell| cell.trim().parse().expect("a number"));
        assert!(found.trim() == unit && lower <= area && area <= upper, "{line}");
        assert!(upper - lower < 3e-3 * area, "{line}");
    }
}

/// The count of a grid lies within the bounds, to the accuracy of the grid.
#[test]
fn it_measures_what_is_swept() {
    for mode in ["home", "any"] {
        let over = ["--over", "x=-200mm:200mm", "--over", "y=-100mm:250mm", "--over", "xi=20deg"];
        let found = measure(&[&[PLANO, "--mode", mode], &over[..]].concat());
        // The centres of cells.
        let grid =
            ["--grid", "x=-199mm:199mm:200", "--grid", "y=-99mm:249mm:175", "--grid", "xi=20deg"];
        let args = [&["workspace", PLANO, "--mode", mode, "--format", "json"], &grid[..]].concat();
        let fraction = number(&opm(&args).json()["fraction"]);
        let [lower, upper] = ["lower", "upper"].map(|key| number(&found[key]) / (0.4 * 0.35));
        assert!(0.1 < fraction && fraction < 0.9);
        assert!(lower - 0.005 < fraction && fraction < upper + 0.005, "{lower} {fraction} {upper}");
    }
}

#[test]
fn without_ranges_they_are_fitted() {
    let run = opm(&["measure", HELICAL, "--tolerance", "0.1"]);
    assert!(run.text().contains("phi"));
    assert!(run.stderr.contains("measured over --over x="), "{}", run.stderr);
    let flags: Vec<&str> = run.stderr.lines().next().unwrap().split_whitespace().skip(4).collect();
    let again = opm(&[&["measure", HELICAL, "--tolerance", "0.1"], &flags[..]].concat());
    let results =
        |text: &str| text.lines().filter(|line| !line.contains("boxes in")).collect::<String>();
    assert_eq!(results(again.text()), results(run.text()));
}

/// The lower section alone has its imaginary joints to choose.
#[test]
fn the_lower_section_alone() {
    let over = ["--over", "x=-200mm:200mm", "--over", "theta11=0:1"];
    let found = measure(&[&[PLANO, "--section", "lower"], &over[..]].concat());
    assert_eq!(keys(&found["over"]), ["x", "y", "theta11", "theta12", "theta13"]);
    assert_eq!(found["units"], "m rad");
    opm(&["measure", PLANO, "--section", "lower", "--over", "xi=0:1"])
        .fails_with_one_line(2, &["--over", "xi", "imaginary joint", "theta11"]);
}

#[test]
fn a_budget_that_does_not_do_is_told_and_threads_change_nothing() {
    let args = ["measure", PLANO, "--over", "x=-200mm:200mm", "--over", "xi=0:30deg", "--over"];
    let args = [&args[..], &["psi=-1:1", "--tolerance", "1e-6", "--budget", "2000"]].concat();
    let run = opm(&[&args[..], &["--threads", "1"]].concat());
    assert!(run.text().contains("measure"));
    let found = measure(&args[1..]);
    let [value, lower, upper] = ends(&found);
    assert!(number(&found["boxes"]) <= 2000.0 && found["reached"] == false);
    // The first digits, rounded up.
    let percent = 100.0 * (upper - lower) / 2.0 / value;
    let (least, most) = (percent, percent * 1.1);
    let told = |text: &str| {
        let (_, rest) =
            text.split_once("the value is certain to within ").expect("how far it came");
        let percent: f64 = rest.split(' ').next().unwrap().parse().unwrap();
        assert!(least <= percent && percent <= most, "{least} {text}");
    };
    told(run.text());
    told(&run.stderr);
    for part in
        ["--budget of 2,000 boxes ended before", "0.0001 % was asked for", "--section upper"]
    {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    let results =
        |text: &str| text.lines().filter(|line| !line.contains("boxes in")).collect::<String>();
    let two = opm(&[&args[..], &["--threads", "2"]].concat());
    assert_eq!(results(run.text()), results(two.text()));
}

#[test]
fn wrong_flags_are_named() {
    let measure = ["measure", PLANO];
    for (flags, parts) in [
        (&["--over", "x=0:1:3"][..], &["--over", "AXIS=MIN:MAX"][..]),
        (&["--over", "x=1:0"], &["--over", "x: 1 to 0", "smaller one first"]),
        (&["--over", "x=1:1"], &["--over", "x: 1 to 1, expected MIN below MAX, or x=VALUE"]),
        (&["--over", "x=10mm:1cm"], &["--over", "x: 0.01 to 0.01, expected MIN below MAX"]),
        (&["--over", "x=0:1", "--over", "x=0"], &["--over", "x is given twice"]),
        (&["--over", "yaw=0:1"], &["--over", "no task coordinate yaw", "zeta, xi, psi"]),
        (&["--over", "x=0:1deg"], &["--over", "x is a length"]),
        (&["--over", "x=1mm:2"], &["--over", "a unit at one end only"]),
        (&["--section", "upper", "--over", "x=0:1"], &["--over", "upper section x", "zeta"]),
        (&["--over", "xi=0:1e9"], &["--over", "xi", "half turns"]),
        (&["--tolerance", "1"], &["--tolerance", "less than 1"]),
        (&["--tolerance", "nan"], &["--tolerance", "\"nan\""]),
        (
            &["--budget", "0"],
            &["--budget", "\"0\", expected a whole number of boxes from 1 to 1e12"],
        ),
        (&["--budget", "-1"], &["--budget", "a whole number of boxes"]),
        (&["--budget", "2.5"], &["--budget", "a whole number of boxes"]),
        (&["--budget", "18446744073709551616"], &["--budget", "from 1 to 1e12"]),
        (
            &["--over", "x=-1e308:1e308"],
            &["--over", "x: -1e308 to 1e308, expected numbers up to 1e75"],
        ),
        (&["--over", "zeta=0:1e300"], &["--over", "zeta: 0 to 1e300, expected"]),
        (&["--over", "xi=0:1e30"], &["--over", "xi: 0 to 1e30, expected at most 4096 half turns"]),
        (&["--section", "middle"], &["--section", "whole, upper, lower"]),
        (&["--mode", "++"], &["--mode", "2 signs for 7 choices"]),
    ] {
        opm(&[&measure[..], flags].concat()).fails(2, parts);
    }
}

/// The bounds hold after an early stop.
#[test]
#[cfg(unix)]
fn what_was_found_before_ctrl_c_is_printed() {
    let mut args =
        vec!["measure", PLANO, "--tolerance", "0", "--budget", "1000000000", "--format", "json"];
    for over in ["x=-200mm:200mm", "y=-200mm:300mm", "zeta=-1:1", "xi=0:1", "psi=-1:1"] {
        args.extend(["--over", over]);
    }
    let child = command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let run = Run::new(&args, &child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{}", run.stderr);
    assert!(run.stderr.contains("interrupted; the bounds hold"), "{}", run.stderr);
    let found: Value = serde_json::from_str(&run.stdout).unwrap();
    let [value, lower, upper] = ends(&found);
    assert!(0.0 < lower && lower < value && value < upper && found["reached"] == false);
}
