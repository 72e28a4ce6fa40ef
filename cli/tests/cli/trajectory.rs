//! `opm trajectory`: motions are followed, reported and recorded.

use crate::run::{Folder, Run, keys, number, opm};
use crate::{HELICAL, PLANO};
use nalgebra::Complex;
use opm_mcap::trajectory::{
    DEPENDENT_TOPIC, DEPENDENT_VELOCITIES_TOPIC, POSE_TOPIC, POSE_VELOCITIES_TOPIC,
};
use opm_mcap::{ReadError, read};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

const SINUSOIDS: &str = "plano-spherical-sinusoids";
const HEAD: &str = "format = 1\nname = \"m\"\nunits = { length = \"mm\", angle = \"deg\" }\n";

fn trajectory(file: &str, motion: &str, more: &[&str]) -> Run {
    opm(&[&["trajectory", file, "--motion", motion], more].concat())
}

fn json(file: &str, motion: &str, more: &[&str]) -> Value {
    trajectory(file, motion, &[&["--format", "json"], more].concat()).json()
}

/// A motion file of the helical manipulator whose third slider, `S3 = sin(165 deg) 25 mm - x` (Eq. 27
/// of the paper), passes its limit of 400 mm by a tenth of a millimetre, between two samples.
fn short_excursion(folder: &Folder) -> String {
    let amplitude = 400.1 - 25.0 * (165.0_f64.to_radians()).sin();
    let x = format!("x = {{ amplitude = {amplitude}, frequency = 0.5, phase = 171 }}");
    let text = format!("{HEAD}duration = 2\nrate = 10\n[coordinates]\n{x}\n");
    folder.write("excursion.toml", text)
}

#[test]
fn a_shipped_motion_is_followed() {
    for (file, motion) in [(PLANO, SINUSOIDS), (HELICAL, "translational-helical-sinusoids")] {
        let found = json(file, motion, &[]);
        let expected = [
            "name",
            "motion",
            "mode",
            "start",
            "duration",
            "rate",
            "samples",
            "reached",
            "valid",
            "joints",
            "imaginary",
            "condition",
            "violation_count",
            "violations",
            "interference",
        ];
        assert_eq!(keys(&found), expected);
        assert_eq!((&found["samples"], &found["valid"]), (&json!(1001), &json!(1001)));
        assert_eq!(found["violations"], json!([]));
        assert_eq!(found["interference"]["contacts"], json!([]), "{motion}");
        assert!(number(&found["condition"]["worst"]) >= 1.0);
        for ranges in found["joints"].as_object().unwrap().values() {
            assert_eq!(keys(ranges), ["position", "velocity", "acceleration"]);
            assert!(number(&ranges["position"][0]) <= number(&ranges["position"][1]));
        }
    }
    let text = trajectory(PLANO, SINUSOIDS, &[]);
    for part in ["1,001 samples", "S1", "theta11", "condition number at most"] {
        assert!(text.text().contains(part), "{}", text.stdout);
    }
    let strict = trajectory(PLANO, SINUSOIDS, &["--strict", "--quiet"]);
    assert_eq!((strict.code, &*strict.stderr), (Some(0), ""));
}

#[test]
fn what_cannot_be_followed_is_told_between_samples() {
    let folder = Folder::new();
    let motion = short_excursion(&folder);
    let found = json(HELICAL, &motion, &["--quiet"]);
    assert_eq!(
        (&found["samples"], &found["valid"]),
        (&json!(21), &json!(21)),
        "no sample is past it"
    );
    assert_eq!(found["violation_count"], 1);
    let violation = &found["violations"][0];
    let expected = ["kind", "start", "end", "worst", "amount", "unit", "leg", "joint", "bound"];
    assert_eq!(keys(violation), expected);
    assert_eq!(violation["kind"], "limit");
    assert_eq!((&violation["leg"], &violation["joint"]), (&json!("leg3"), &json!("S3")));
    assert_eq!((&violation["unit"], &violation["bound"]), (&json!("m"), &json!("highest")));
    assert!((number(&violation["amount"]) - 1e-4).abs() < 1e-12, "{violation}");
    // x is lowest where 180 deg t + 171 deg is 270 deg.
    assert!((number(&violation["worst"]) - 99.0 / 180.0).abs() < 1e-7, "{violation}");
    let amplitude = 400.1 - 25.0 * (165.0_f64.to_radians()).sin();
    let half = ((amplitude - 0.1) / amplitude).acos() / PI;
    for (end, sign) in [("start", -1.0), ("end", 1.0)] {
        let expected = 99.0 / 180.0 + sign * half;
        assert!((number(&violation[end]) - expected).abs() < 1e-10, "{violation}");
    }
}

#[test]
fn strict_fails_after_everything_is_written() {
    let folder = Folder::new();
    let motion = short_excursion(&folder);
    let out = folder.arg("out.mcap");
    let run = trajectory(HELICAL, &motion, &["-o", &out, "--strict"]);
    assert_eq!(run.code, Some(1));
    assert!(run.stdout.contains("S3 past its highest value by 0.100 mm"), "{}", run.stdout);
    assert!(run.stderr.contains("--strict"), "{}", run.stderr);
    let lax = trajectory(HELICAL, &motion, &["-o", &out]);
    assert!(lax.stderr.contains("warning: the mechanism cannot follow all of it: 1 violation"));
    assert_eq!(lax.code, Some(0));
    let inside = opm(&["inspect", &out, "--format", "json"]).json();
    assert_eq!(inside["complete"], true);
    assert_eq!(inside["metadata"]["violation.1"]["joint"], "S3");
    assert_eq!(inside["metadata"]["result"]["violations"], "1");
    assert_eq!(inside["metadata"]["roles"]["S3"], "actuated");
    assert_eq!(inside["metadata"]["quantities"]["phi"], "rad");
    let topics = inside["topics"].as_array().unwrap();
    let messages = |name: &str| {
        let topic = topics.iter().find(|topic| topic["name"] == name);
        topic.map_or(0, |topic| topic["messages"].as_u64().unwrap())
    };
    for topic in ["/joints", "/velocities", "/accelerations", "/pose", "/condition", "/tf"] {
        assert_eq!(messages(topic), 21, "{topic}");
    }
    assert_eq!((messages("/violations"), messages("/scene")), (2, 1));
    assert_eq!(folder.names(), ["excursion.toml", "out.mcap"]);
}

/// A table of the same motion as a motion file. The knots are dense enough for an accurate spline.
#[test]
fn a_table_is_followed_like_its_formula() {
    let folder = Folder::new();
    let x = |t: f64| 0.05 * (2.0 * PI * 0.2 * t).sin();
    // The angles wrap at half a revolution; the motion is a full revolution in ten seconds.
    let phi = |t: f64| (0.2 * PI * t + PI).rem_euclid(2.0 * PI) - PI;
    let rows: String = (0..=400)
        .map(|i| f64::from(i) / 40.0)
        .map(|t| format!("{t},{},{}\n", phi(t), x(t)))
        .collect();
    let table = folder.write("poses.csv", format!("t,phi,x\n{rows}"));
    let turn = "phi = [{ amplitude = 0, frequency = 1 }]";
    let text = format!("{HEAD}duration = 10\nrate = 100\n[coordinates]\n{turn}\n");
    let still = folder.write("still.toml", text);
    let by_table = json(HELICAL, &table, &["--quiet", "--ends", "natural"]);
    let at_rest = json(HELICAL, &still, &["--quiet"]);
    assert_eq!(by_table["samples"], 1001);
    // The helical joint counts whole revolutions: its angle is taken as it is, including the jump.
    let slide = &by_table["imaginary"]["S"]["position"];
    assert!(number(&slide[1]) < 0.0201 * PI * 1.2, "{slide}");
    assert_eq!(at_rest["imaginary"]["S"]["position"], json!([0.0, 0.0]));

    let zeta = |t: f64| (0.2 * PI * t + PI).rem_euclid(2.0 * PI) - PI;
    let rows: String =
        (0..=400).map(|i| f64::from(i) / 40.0).map(|t| format!("{t},{}\n", zeta(t))).collect();
    let table = folder.write("poses.csv", format!("t,zeta\n{rows}"));
    let found = json(PLANO, &table, &["--quiet", "--ends", "natural"]);
    let turned = &found["joints"]["s4.z"]["velocity"];
    // Unwrapped, it rotates at a constant speed.
    for end in 0..2 {
        assert!((number(&turned[end]) - 0.2 * PI).abs() < 1e-6, "{turned}");
    }
}

#[test]
fn rate_and_mode_win_over_the_file() {
    let folder = Folder::new();
    let text = format!("{HEAD}duration = 1\nrate = 10\nmode = \"-+ ++ ++ +\"\n[coordinates]\n");
    let motion = folder.write("m.toml", text);
    let found = json(PLANO, &motion, &[]);
    assert_eq!((&found["mode"], &found["samples"]), (&json!("-+ ++ ++ +"), &json!(11)));
    let found = json(PLANO, &motion, &["--mode", "home", "--rate", "2.5"]);
    // The samples are at 0, 0.4, 0.8 and the end.
    assert_eq!((&found["mode"], &found["samples"]), (&json!("++ ++ ++ +"), &json!(4)));
}

#[test]
fn a_wrong_motion_is_told_with_its_places() {
    let folder = Folder::new();
    let text = "format = 1\nname = \"m\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
        duration = 0\nspeed = 3\nmode = \"+\"\n[coordinates]\nyaw = 1\n\
        x = { amplitud = 3, frequency = \"fast\" }\ny = [1, { amplitude = nan, frequency = 1 }]\n";
    let motion = folder.write("m.toml", text);
    trajectory(PLANO, &motion, &[]).fails(
        1,
        &[
            "m.toml:4:12: `duration` is 0, expected a number of seconds above 0",
            "m.toml:5:1: unknown key `speed`",
            "m.toml:6:8: `mode` is \"+\"",
            "m.toml:8:1: unknown key `yaw`",
            "m.toml:9:5: `amplitude` is missing",
            "m.toml:9:7: unknown key `amplitud`, did you mean `amplitude`",
            "m.toml:9:33: `frequency` is a string, expected a number",
            "m.toml:10:23: `amplitude` is nan, expected a finite number",
            "`rate` is missing",
        ],
    );
    for (text, parts) in [
        ("", &["the file is empty", "zeta, xi, psi"][..]),
        ("t,x\n", &["0 times given, expected at least 2"]),
        ("t,x\n0,0\n", &["poses.csv:2:1: 1 time given, expected at least 2"]),
        ("x,y\n", &["poses.csv:1:1: no column t"]),
        ("t,x,x\n", &["poses.csv:1:5: two columns are called x"]),
        ("t,yaw\n", &["poses.csv:1:3: no coordinate \"yaw\""]),
        (
            "t,x\n0,0\n1,much\n1,inf\n0.5,0,7\n2\n",
            &[
                "poses.csv:3:3: \"much\", expected a finite number",
                "poses.csv:4:1: t is 1 after 1, expected a later time",
                "poses.csv:4:3: \"inf\"",
                "poses.csv:5:1: 3 cells, expected 2",
                "poses.csv:6:1: 1 cell, expected 2",
            ],
        ),
    ] {
        let table = folder.write("poses.csv", text);
        trajectory(PLANO, &table, &[]).fails(1, parts);
    }
}

#[test]
fn wrong_points_are_told_with_their_places() {
    let folder = Folder::new();
    for (text, parts) in [
        ("[points]\nx = [1, 2]\n", &["`t` is missing, expected an array of times"][..]),
        ("[points]\nt = [0]\n", &["m.toml:6:5: 1 time given, expected at least 2"]),
        (
            "ends = \"periodic\"\n[points]\nt = [0, 1]\n",
            &["m.toml:7:5: 2 times given, expected at least 3"],
        ),
        (
            "ends = \"periodic\"\n[points]\nt = [0, 1, 2]\nx = [0, 5, 10]\n",
            &[
                "x is 0 mm at the first point and 10 mm at the last, expected the same",
                "they differ by 10 mm",
            ],
        ),
        (
            "ends = \"soft\"\n[points]\nt = [0, 1, 1]\nx = [0, 1]\nyaw = 2\n",
            &[
                "m.toml:5:8: `ends` is \"soft\", expected one of `rest`, `natural`, `periodic`",
                "m.toml:7:5: `t` has 1 after 1, expected a later time",
                "m.toml:9:1: unknown key `yaw`",
            ],
        ),
        (
            "[points]\nt = [0, 1, 2]\nx = [0, 1]\n",
            &["m.toml:7:5: `x` has 2 values, expected 3 as `t` has"],
        ),
        (
            "duration = 2\n[points]\nt = [0, 1]\n[coordinates]\n",
            &[
                "m.toml:5:12: `duration` is given beside `points`",
                "`coordinates` is given beside `points`",
            ],
        ),
        (
            "duration = 2\nends = \"rest\"\n[coordinates]\n",
            &["m.toml:6:8: `ends` is given without `points`"],
        ),
    ] {
        let motion = folder.write("m.toml", format!("{HEAD}rate = 100\n{text}"));
        trajectory(PLANO, &motion, &[]).fails(1, parts);
    }
}

/// The columns of a table, by their names; a cell without a number is not a number.
fn columns(text: &str) -> BTreeMap<String, Vec<f64>> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        for (name, cell) in names.iter().zip(cells) {
            let value = if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
            columns.entry((*name).to_owned()).or_default().push(value);
        }
    }
    columns
}

/// Two points, from rest to rest: x = 40 mm (3 s² - 2 s³) - 20 mm with s = t / 2 s. The third slider of the helical
/// manipulator is `S3 = sin(165 deg) 25 mm - x` (Eq. 27 of the paper).
#[test]
fn the_table_of_a_two_point_move_is_that_of_its_formula() {
    let folder = Folder::new();
    let text = format!("{HEAD}rate = 50\n[points]\nt = [0, 2]\nx = [-20, 20]\nphi = 0\n");
    let motion = folder.write("move.toml", text);
    let out = folder.arg("joints.csv");
    let more = ["-o", &out, "--rates", "--accelerations"];
    assert!(trajectory(HELICAL, &motion, &more).stderr.contains("101 samples"));
    let text = folder.read("joints.csv");
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    assert_eq!(header[..6], ["t", "x", "y", "phi", "S1", "r1"], "{header:?}");
    let table = columns(&text);
    let (of, length) =
        (|name: &str, row: usize| table[name][row], 25e-3 * (165.0_f64.to_radians()).sin());
    for row in 0..=100 {
        let t = of("t", row);
        assert!((t - 0.02 * row as f64).abs() < 1e-15);
        let s = t / 2.0;
        let x = 0.04 * s * s * (3.0 - 2.0 * s) - 0.02;
        let rate = 0.04 * 6.0 * s * (1.0 - s) / 2.0;
        let acceleration = 0.04 * (6.0 - 12.0 * s) / 4.0;
        for (name, expected, slider) in
            [("", x, length - x), ("d.", rate, -rate), ("dd.", acceleration, -acceleration)]
        {
            assert!((of(&format!("{name}x"), row) - expected).abs() < 1e-15, "{t}: {name}x");
            assert!((of(&format!("{name}S3"), row) - slider).abs() < 1e-13, "{t}: {name}S3");
        }
    }

    // In the units of the file, the same numbers, on standard output.
    for stdout in ["-", "/dev/stdout"] {
        let run = trajectory(HELICAL, &motion, &["-o", stdout, "--rates", "--units", "file"]);
        let shown = columns(run.text());
        for row in 0..=100 {
            for (name, si, factor) in [
                ("t [s]", "t", 1.0),
                ("x [mm]", "x", 1e3),
                ("d.S3 [mm/s]", "d.S3", 1e3),
                ("phi [deg]", "phi", 180.0 / PI),
            ] {
                let (shown, si) = (shown[name][row], of(si, row) * factor);
                assert!((shown - si).abs() < 1e-12 * (1.0 + si.abs()), "{name}: {shown} {si}");
            }
        }
        assert!(!shown.contains_key("dd.x [mm/s2]"));
    }

    // What is read back is the table's pose and joints.
    let poses: String = text
        .lines()
        .map(|line| line.split(',').take(4).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    let poses = folder.write("poses.csv", poses);
    let solved = columns(opm(&["ik", HELICAL, "--poses", &poses]).text());
    assert_eq!(solved["t"], table["t"]);
    assert_eq!(solved["S3"].len(), 101);
    for (row, slider) in solved["S3"].iter().enumerate() {
        assert!((slider - of("S3", row)).abs() < 1e-15);
    }
    // And the table of poses is a motion itself.
    let found = json(HELICAL, &poses, &["--rate", "50", "--quiet"]);
    assert_eq!(found["samples"], 101);
}

/// The arm of two links of 100 mm, which starts at (0, 75) mm, ends at y = -125 mm.
#[test]
fn cells_out_of_reach_are_empty() {
    let folder = Folder::new();
    let text = format!("{HEAD}rate = 100\n[points]\nt = [0, 1]\ny = [0, -150]\n");
    let motion = folder.write("down.toml", text);
    let table = columns(trajectory(PLANO, &motion, &["-o", "-", "-q", "--rates"]).text());
    let mut out = 0;
    for (row, y) in table["y"].iter().enumerate() {
        let reached = *y > -0.125;
        out += usize::from(!reached);
        for name in ["phi14", "d.phi14", "theta11", "d.theta11"] {
            assert_eq!(table[name][row].is_nan(), !reached, "{y}: {name}");
        }
        assert!(table["d.y"][row].is_finite());
    }
    assert!(out > 10 && out < 90, "{out}");
}

#[test]
fn wrong_usage_names_the_flag() {
    let folder = Folder::new();
    trajectory(PLANO, "no-such-motion", &[])
        .fails_with_one_line(1, &["no-such-motion", "no such motion; expected one of", SINUSOIDS]);
    trajectory(PLANO, "plano-sperical-sinusoids", &[])
        .fails_with_one_line(1, &["no such motion; did you mean `plano-spherical-sinusoids`"]);
    trajectory(PLANO, "none.toml", &[]).fails_with_one_line(1, &["none.toml: no such file"]);
    for rate in ["0", "-1", "nan", "fast", "1e10"] {
        trajectory(PLANO, SINUSOIDS, &["--rate", rate]).fails(2, &["--rate"]);
    }
    trajectory(PLANO, SINUSOIDS, &["--mode", "+"]).fails_with_one_line(2, &["--mode"]);
    trajectory(PLANO, SINUSOIDS, &["-o", "out.txt"])
        .fails_with_one_line(2, &["--output: out.txt", ".mcap", ".csv or .npy"]);
    for flag in [&["--rates"][..], &["--accelerations"], &["--units", "file"]] {
        trajectory(PLANO, SINUSOIDS, flag).fails(2, &["--output"]);
        let more = [flag, &["-o", "out.mcap"]].concat();
        trajectory(PLANO, SINUSOIDS, &more).fails_with_one_line(2, &[flag[0], "for tables"]);
    }
    trajectory(PLANO, SINUSOIDS, &["-o", "-", "--format", "json"])
        .fails_with_one_line(2, &["--format json", "--output"]);
    trajectory(PLANO, SINUSOIDS, &["--ends", "rest"])
        .fails_with_one_line(2, &["--ends", "ends = \"rest\""]);
    opm(&["trajectory", PLANO]).fails(2, &["--motion"]);
    let motion = folder.write("m.csv", "t,x\n0,0\n1,0.01\n");
    trajectory(PLANO, &motion, &["-o", &motion]).fails_with_one_line(2, &["--output", "input"]);
    let nowhere = folder.arg("no/such/folder.mcap");
    trajectory(PLANO, SINUSOIDS, &["-o", &nowhere]).fails_with_one_line(1, &["folder.mcap"]);
    // The helical manipulator has no such coordinates.
    trajectory(HELICAL, SINUSOIDS, &[]).fails(1, &["unknown key `zeta`", "`x`, `y`, `phi`"]);
    assert_eq!(folder.names(), ["m.csv"]);
}

/// The angle of the five-bar's platform is that of its right forearm: by the law of cosines, from the hand's place.
#[test]
fn dependent_coordinates_are_recorded() {
    let (upper, fore, half): (f64, f64, f64) = (0.138, 0.307, 0.160);
    let [from, to] = [upper + fore, fore - upper];
    // The forearm's direction where the elbow is on the outer side.
    let forearm = |x: f64, y: f64| {
        let way = Complex::new(x - half, y);
        let d = way.norm();
        let cosine = (upper * upper + d * d - fore * fore) / (2.0 * upper * d);
        way - Complex::from_polar(upper, way.arg() - cosine.acos())
    };
    let home = forearm(0.0, 0.323_981_552_428_365);
    let turned = |x: f64, y: f64| (forearm(x, y) / home).arg();

    let folder = Folder::new();
    let out = folder.arg("five-bar.mcap");
    let swing = "duration = 2\nrate = 500\n[coordinates]\n\
                 x = { amplitude = 250, frequency = 0.5 }\n\
                 y = { amplitude = 40, frequency = 1, offset = 300 }\n";
    let motion = folder.write("swing.toml", format!("{HEAD}{swing}"));
    let found = json("five-bar", &motion, &["-o", &out, "-q"]);
    let mut tables: [BTreeMap<u64, Vec<f64>>; 4] = Default::default();
    let topics = [POSE_TOPIC, POSE_VELOCITIES_TOPIC, DEPENDENT_TOPIC, DEPENDENT_VELOCITIES_TOPIC];
    read::<ReadError>(out.as_ref(), |message| {
        if let Some(i) = topics.iter().position(|topic| *topic == message.topic) {
            let mut values = vec![];
            assert!(message.values(&mut values)?);
            tables[i].insert(message.time, values);
        }
        Ok(())
    })
    .unwrap();
    let [pose, rates, angle, angle_rate] = &tables;
    let (mut highest, mut unknown) = (f64::MIN, 0);
    for (time, place) in pose {
        let reached = |sign: f64| {
            let d = (place[0] + sign * half).hypot(place[1]);
            (to..from).contains(&d)
        };
        let angle = &angle[time];
        assert_eq!(!angle[0].is_nan(), reached(1.0) && reached(-1.0), "{place:?}");
        if angle[0].is_nan() {
            unknown += 1;
            continue;
        }
        let expected = turned(place[0], place[1]);
        assert!((angle[0] - expected).abs() < 1e-9, "{place:?}: {angle:?} {expected}");
        highest = highest.max(angle[0]);
        // A step of a microsecond along the motion; the third derivative times its square is nothing.
        let step = 1e-6;
        let at = |sign: f64| {
            let moved = |i: usize| place[i] + sign * step * rates[time][i];
            turned(moved(0), moved(1))
        };
        let expected = (at(1.0) - at(-1.0)) / (2.0 * step);
        let off = (angle_rate[time][0] - expected).abs();
        assert!(off < 1e-6 * (1.0 + expected.abs()), "{place:?}: {angle_rate:?} {expected}");
    }
    assert!(unknown > 100 && angle.len() - unknown > 400, "{unknown} of {}", angle.len());
    assert_eq!(number(&found["dependent"]["theta"]["position"][1]), highest);
    let inside = opm(&["inspect", &out, "--format", "json"]).json();
    assert_eq!(inside["metadata"]["roles"]["theta"], "dependent");
    assert_eq!(inside["metadata"]["quantities"]["theta"], "rad");
    let text = trajectory("five-bar", &motion, &["-q"]);
    assert!(text.text().contains("dependent"), "{}", text.stdout);
    let picture = folder.arg("five-bar.svg");
    opm(&["plot", &out, "-o", &picture, "-q"]).text();
    assert!(folder.read("five-bar.svg").contains("theta"));
}

/// A slider of the helical manipulator that moves as x does, `S3 = ... - x`: x = 50 mm sin(2 pi 0.5 t) has a speed
/// of 50 pi mm/s at most.
#[test]
fn a_joint_above_its_rate_is_told_in_the_units_of_the_file() {
    let folder = Folder::new();
    let text = opm(&["examples", HELICAL]).text().to_owned();
    let (before, last) = text.rsplit_once("limits = { S = [-400, 400] }").unwrap();
    let slow = "limits = { S = [-400, 400] }\nmax_rate = { S = 150 }";
    let file = folder.write("slow.toml", format!("{before}{slow}{last}"));
    let x = "x = { amplitude = 50, frequency = 0.5 }";
    let motion = format!("{HEAD}duration = 1.5\nrate = 20\n[coordinates]\n{x}\n");
    let motion = folder.write("fast.toml", motion);
    let excess = 0.05 * PI - 0.15;
    let found = json(&file, &motion, &["--quiet"]);
    assert_eq!((&found["violation_count"], &found["valid"]), (&json!(2), &json!(31)));
    let violation = &found["violations"][1];
    assert_eq!(
        keys(violation),
        ["kind", "start", "end", "worst", "amount", "unit", "leg", "joint"]
    );
    assert_eq!((&violation["kind"], &violation["unit"]), (&json!("rate"), &json!("m/s")));
    assert_eq!((&violation["leg"], &violation["joint"]), (&json!("leg3"), &json!("S3")));
    assert!((number(&violation["amount"]) - excess).abs() < 1e-9, "{violation}");
    assert!((number(&violation["worst"]) - 1.0).abs() < 1e-6, "{violation}");
    let half = (0.15 / (0.05 * PI)).acos() / PI;
    // A rate counts as within its limit up to 1e-9 of it, which is 1.02e-9 s here.
    assert!((number(&violation["start"]) - (1.0 - half)).abs() < 2e-9, "{violation}");
    assert!((number(&violation["end"]) - (1.0 + half)).abs() < 2e-9, "{violation}");

    let out = folder.arg("fast.mcap");
    let run = trajectory(&file, &motion, &["-o", &out]);
    let line = format!("leg3: S3 above its max_rate by {:.3} mm/s at 1.000000 s", 1000.0 * excess);
    assert!(run.text().contains(&line), "{line}: {}", run.stdout);
    let recorded = opm(&["inspect", &out, "--format", "json"]).json();
    assert_eq!(recorded["metadata"]["violation.2"]["kind"], "rate");
    assert_eq!(recorded["metadata"]["violation.2"]["unit"], "m/s");
    let topics = recorded["topics"].as_array().unwrap();
    let logged = topics.iter().find(|topic| topic["name"] == "/violations").unwrap();
    assert_eq!(logged["messages"], 4, "two begin and end");
    let strict = trajectory(&file, &motion, &["--strict", "--quiet"]);
    assert_eq!(strict.code, Some(1));
    assert!(strict.stderr.contains("S3 above its max_rate"), "{}", strict.stderr);
    let changed = trajectory(&file, &motion, &["--set", "max_rate.S=200mm", "--strict", "--quiet"]);
    assert_eq!(changed.code, Some(0), "{}", changed.stderr);
}

/// The line x = -0.1 .. 0.1 moves each slider of the helical manipulator by |cos| of its direction: the third one by
/// the whole way, which takes the time of the trapezoid.
#[test]
fn a_time_optimal_motion_is_a_motion() {
    let folder = Folder::new();
    let text = format!("{HEAD}rate = 100\n[points]\nt = [0, 5]\nx = [-100, 100]\n");
    let motion = folder.write("line.toml", text);
    let limits = ["--set", "max_rate.S=400mm", "--set", "max_acceleration.S=2000mm"];
    let optimal = [&limits[..], &["--time-optimal", "--strict", "--quiet"]].concat();
    let expected = 0.2 / 0.4 + 0.4 / 2.0;
    let found = json(HELICAL, &motion, &optimal);
    assert!((number(&found["duration"]) - expected).abs() < 3e-4, "{}", found["duration"]);
    assert_eq!((&found["given_duration"], &found["violations"]), (&json!(5.0), &json!([])));
    let speed = &found["joints"]["S3"]["velocity"];
    assert!((number(&speed[0]) + 0.4).abs() < 1e-5, "{speed}");
    let text = trajectory(HELICAL, &motion, &optimal);
    assert!(
        text.text().contains("0.7000 s (5.000 s as given) at 100.0 Hz: 72 samples"),
        "{}",
        text.stdout
    );

    let out = folder.arg("fast.mcap");
    trajectory(HELICAL, &motion, &[&optimal[..], &["-o", &out]].concat()).text();
    let recorded = opm(&["inspect", &out, "--format", "json"]).json();
    assert_eq!(recorded["metadata"]["run"]["timing"], "time-optimal");
    let table = folder.arg("fast.csv");
    trajectory(HELICAL, &motion, &[&optimal[..], &["-o", &table, "--rates"]].concat()).text();
    assert_eq!(folder.read("fast.csv").lines().count(), 1 + 72);

    // However the line is given.
    let moves = "rate = 100\nfeed = 50\nacceleration = 900\nstart = { x = -100 }\n[[moves]]\nto = { x = 100 }\n";
    let given = folder.write("given.toml", format!("{HEAD}{moves}"));
    let found = json(HELICAL, &given, &optimal);
    assert!((number(&found["duration"]) - expected).abs() < 3e-4, "{}", found["duration"]);

    let without = trajectory(HELICAL, &motion, &["--time-optimal"]);
    assert_eq!(without.code, Some(1));
    assert!(without.stderr.contains("no max_acceleration of S1, S2, S3"), "{}", without.stderr);
}

/// The rows of the CSV of a motion: numbers by column.
fn table(motion: &str, more: &[&str]) -> BTreeMap<String, Vec<f64>> {
    let run = trajectory(PLANO, motion, &[&["-o", "-", "--rates"], more].concat());
    let mut lines = run.text().lines().map(|line| line.split(','));
    let names = lines.next().unwrap().map(str::to_owned);
    let mut columns: Vec<(String, Vec<f64>)> = names.map(|name| (name, vec![])).collect();
    for line in lines {
        for ((_, column), cell) in columns.iter_mut().zip(line) {
            column.push(cell.parse().unwrap());
        }
    }
    columns.into_iter().collect()
}

const SQUARE: &str = "rate = 1000\nfeed = 100\nacceleration = 2000\nstart = { x = -20, y = -20 }\n\
    [[moves]]\nto = { x = 20, xi = 5 }\n[[moves]]\nto = { x = 20, y = 20 }\nvia = { x = 40, y = 0 }\n\
    [[moves]]\nto = { x = -20 }\n";

/// A line, a half circle that it touches, and another line: it halts where `xi` stops to turn, and takes the lengths over
/// the feed rate and what starts and halts cost; with blends it never halts, and the feed rate holds between them.
#[test]
fn lines_and_arcs_have_a_feed_rate() {
    let folder = Folder::new();
    let halting = folder.write("halting.toml", format!("{HEAD}{SQUARE}"));
    let found = json(PLANO, &halting, &[]);
    // 40 mm, half a circle of 20 mm, 40 mm at 100 mm/s; 100 mm/s over 2000 mm/s², for the start and one halt.
    let radius = 20.0;
    let duration = (80.0 + PI * radius) / 100.0 + 2.0 * 0.05;
    assert!((number(&found["duration"]) - duration).abs() < 1e-12, "{found}");
    let columns = table(&halting, &[]);
    let speed = |i: usize| columns["d.x"][i].hypot(columns["d.y"][i]);
    let count = columns["t"].len();
    assert!((0..count).all(|i| speed(i) < 0.1 + 1e-12));
    assert!((0..count).filter(|&i| speed(i) > 0.1 - 1e-12).count() > count / 2);
    for (x, y) in columns["x"].iter().zip(&columns["y"]) {
        if *x > 0.02 + 1e-12 {
            assert!(((x - 0.02).hypot(*y) - 0.02).abs() < 1e-12, "{x} {y}");
        }
    }
    let round = folder.write("round.toml", format!("{HEAD}blend = 5\n{SQUARE}"));
    let columns = table(&round, &[]);
    let speed = |i: usize| columns["d.x"][i].hypot(columns["d.y"][i]);
    let count = columns["t"].len();
    let slowest = (60..count - 60).map(speed).fold(f64::MAX, f64::min);
    assert!(slowest > 0.03, "{slowest}");
    let jump =
        (1..count).map(|i| (columns["d.y"][i] - columns["d.y"][i - 1]).abs()).fold(0.0, f64::max);
    assert!(jump < 0.01, "{jump}");
}

#[test]
fn wrong_moves_are_named_by_line_and_column() {
    let folder = Folder::new();
    for (from, to, words) in [
        (
            "via = { x = 40, y = 0 }",
            "via = { x = 20, y = 0 }",
            "10:1: move 2: start, `via` and `to` are on one line",
        ),
        ("feed = 100\n", "", "`feed` is missing"),
        ("feed = 100", "feed = 0", "5:8: `feed` is 0, expected a speed along the path above 0"),
        ("acceleration = 2000\n", "", "`acceleration` is missing"),
        ("to = { x = -20 }", "to = { xi = 3 }", "move 3: the position does not change"),
        ("to = { x = -20 }", "to = { x = -20 }\nblend = 1", "`blend` is given for the last move"),
        (
            "to = { x = 20, xi = 5 }",
            "to = { x = 20, xi = 5 }\nblend = 45",
            "move 1: it is 40 mm long, and the blends at its ends need 45 mm",
        ),
        (
            "via = { x = 40, y = 0 }",
            "via = { x = 40, xi = 0 }",
            "`xi` is an angle, expected positions only",
        ),
        ("rate = 1000", "rate = 1000\nduration = 3", "`duration` is given beside `moves`"),
    ] {
        let text = format!("{HEAD}{SQUARE}").replacen(from, to, 1);
        let file = folder.write("wrong.toml", text);
        trajectory(PLANO, &file, &[]).fails(1, &["wrong.toml:", words]);
    }
}

/// What a motion's table has beside the poses follows from these: read as a motion, it gives the same table.
#[test]
fn a_table_of_a_motion_is_a_motion() {
    let folder = Folder::new();
    let turn = "t,x,y\n0,0,0.3\n0.25,0.01,0.31\n0.5,0.02,0.3\n";
    for (mechanism, poses) in [("five-bar", turn), (PLANO, "t,x,xi\n0,0,0\n0.5,0.01,0.1\n")] {
        let poses = folder.write("poses.csv", poses);
        let tables = ["one.csv", "two.csv"].map(|name| folder.arg(name));
        for (from, to) in [(&poses, &tables[0]), (&tables[0], &tables[1])] {
            let more = ["--rates", "--accelerations", "--indices", "--rate", "100"];
            let args = ["trajectory", mechanism, "--motion", from, "-o", to];
            opm(&[&args[..], &more].concat()).text();
        }
        let [one, two] = ["one.csv", "two.csv"].map(|name| folder.read(name));
        let numbers = |text: &str, columns: usize| -> Vec<Vec<f64>> {
            let cells =
                |line: &str| line.split(',').take(columns).map(|c| c.parse().unwrap()).collect();
            text.lines().skip(1).map(cells).collect()
        };
        assert_eq!(one.lines().next(), two.lines().next());
        assert_eq!(one.lines().count(), 52);
        // So `opm ik` reads it.
        let run = opm(&["ik", mechanism, "--poses", &tables[0]]);
        assert_eq!(run.text().lines().count(), 52);
        // The times and the poses.
        let columns = if mechanism == PLANO { 6 } else { 3 };
        for (one, two) in
            numbers(&one, columns).concat().iter().zip(numbers(&two, columns).concat())
        {
            assert!((one - two).abs() < 1e-12, "{one} {two}");
        }
    }
    // Without a joint it is a table of poses, and theta may be meant as a coordinate.
    let wrong = folder.write("wrong.csv", "t,x,theta\n0,0,0\n1,0,0\n");
    let run = opm(&["trajectory", "five-bar", "--motion", &wrong]);
    run.fails_with_one_line(1, &["wrong.csv:1:5: theta follows from x, y"]);
}

/// A joint that is called like another column would make a table that nobody can read: it is not written.
#[test]
fn columns_of_one_name_are_refused() {
    let folder = Folder::new();
    let run = opm(&["convert", PLANO, "--joints"]);
    let list = run.text();
    assert!(list.contains("\"S1\""), "{list}");
    for (name, column, more) in [("t", "t", None), ("d.x", "d.x", Some("--rates"))] {
        let file = folder.write("named.toml", list.replace("\"S1\"", &format!("\"{name}\"")));
        let motion = folder.write("motion.csv", "t,x\n0,0\n1,0.01\n");
        for table in ["out.csv", "out.npy"] {
            let table = folder.arg(table);
            let mut args = vec!["trajectory", &file, "--motion", &motion, "-o", &table];
            args.extend(more);
            let problem = format!("two columns would be called {column:?}");
            opm(&args).fails_with_one_line(1, &[&table, &problem]);
            assert!(!Path::new(&table).exists(), "{table}");
        }
        // Other tables and answers have no such column.
        opm(&["ik", &file, "--pose", "x=0.01"]).text();
    }
}

/// Points that turn sharply: the platform goes lower than any of them, and that is told. Between gentle points it is not.
#[test]
fn a_spline_beyond_its_points_is_told() {
    let folder = Folder::new();
    let told = |values: &str| {
        let text = format!("t,z [mm]\n{values}");
        let file = folder.write("pick.csv", &text);
        let run = opm(&["trajectory", "delta", "--motion", &file]);
        run.text();
        run.stderr.clone()
    };
    let sharp = told("0,-1000\n0.2,-1000\n0.4,-1100\n0.6,-1100\n0.8,-1000\n1,-1000\n");
    assert!(
        sharp.contains("z goes to -11") && sharp.contains("mm below its lowest point"),
        "{sharp}"
    );
    let gentle = told("0,-1000\n0.5,-1050\n1,-1100\n");
    assert!(!gentle.contains("goes to"), "{gentle}");
}
