//! `opm workspace`: counts, grids and recordings.

use crate::run::{Folder, Run, command, keys, number, opm, opm_reading};
use crate::{HELICAL, PLANO};
use opm_mcap::{ReadError, read};
use serde_json::Value;
use std::fs;

/// Sums of a few doubles.
const EXACT: f64 = 1e-12;
/// A cloud holds single precision.
const SINGLE: f64 = 1e-6;

fn workspace(args: &[&str]) -> Value {
    opm(&[&["workspace"], args, &["--format", "json", "--quiet"]].concat()).json()
}

/// Flags of a grid on which the plano-spherical manipulator reaches some poses and not others.
const MIXED: [&str; 10] = [
    "--grid",
    "x=-250mm:250mm:21",
    "--grid",
    "y=-200mm:200mm:9",
    "--grid",
    "xi=-100deg:100deg:7",
    "--grid",
    "zeta=0:1:3",
    "--grid",
    "psi=0.1",
];

/// The poses of that grid, as CSV.
fn mixed_poses() -> String {
    let at = |min: f64, max: f64, i: u32, count: u32| {
        min + (max - min) * f64::from(i) / f64::from(count - 1)
    };
    let end = 100.0_f64.to_radians();
    let mut text = "x,y,xi,zeta,psi\n".to_owned();
    for (zeta, xi) in (0..3).flat_map(|i| (0..7).map(move |j| (i, j))) {
        for (x, y) in (0..21).flat_map(|i| (0..9).map(move |j| (i, j))) {
            let (x, y) = (at(-0.25, 0.25, x, 21), at(-0.2, 0.2, y, 9));
            let (zeta, xi) = (at(0.0, 1.0, zeta, 3), at(-end, end, xi, 7));
            text += &format!("{x},{y},{xi},{zeta},0.1\n");
        }
    }
    text
}

#[test]
fn a_count_is_what_inverse_kinematics_counts() {
    for mode in ["home", "-+ +- -- -"] {
        let found = workspace(&[&[PLANO, "--mode", mode], &MIXED[..]].concat());
        let expected = [
            "poses",
            "reachable",
            "fraction",
            "grid",
            "mode",
            "measure",
            "imaginary_range",
            "seconds",
            "poses_per_second",
            "kind",
        ];
        assert_eq!(keys(&found), expected);
        let run = opm_reading(&mixed_poses(), &["ik", PLANO, "--poses", "-", "--mode", mode]);
        let rows: Vec<&str> = run.text().lines().skip(1).collect();
        let within = rows.iter().filter(|row| row.split(',').nth(6) == Some("1")).count();
        assert_eq!(found["poses"], rows.len());
        assert_eq!(found["reachable"], within);
        assert!(within > 50 && within < rows.len() / 2, "{within} of {}: a poor test", rows.len());
        assert!((number(&found["fraction"]) - within as f64 / rows.len() as f64).abs() < EXACT);

        let reached = rows.iter().filter(|row| row.split(',').nth(6) == Some("1"));
        let thetas: Vec<f64> =
            reached.map(|row| row.split(',').nth(9).unwrap().parse().unwrap()).collect();
        let low = thetas.iter().copied().fold(f64::INFINITY, f64::min);
        let high = thetas.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = found["imaginary_range"]["theta12"].as_array().unwrap();
        assert!((number(&range[0]) - low).abs() < EXACT, "{range:?}, {low}");
        assert!((number(&range[1]) - high).abs() < EXACT, "{range:?}, {high}");
    }
}

#[test]
fn any_mode_counts_what_some_mode_reaches() {
    let found = workspace(&[&[PLANO, "--mode", "any"], &MIXED[..]].concat());
    assert_eq!(found["mode"], "any");
    let run = opm_reading(&mixed_poses(), &["ik", PLANO, "--poses", "-", "--all-modes"]);
    let mut poses: Vec<&str> = run
        .text()
        .lines()
        .skip(1)
        .filter(|row| row.split(',').nth(6) == Some("1"))
        .map(|row| row.match_indices(',').nth(4).map_or(row, |(end, _)| &row[..end]))
        .collect();
    poses.dedup();
    assert_eq!(found["reachable"], poses.len());
    let home = workspace(&[&[PLANO], &MIXED[..]].concat());
    assert!(number(&found["reachable"]) > number(&home["reachable"]));
}

/// The linear formula of the helical manipulator's sliders, at every point of a grid.
#[test]
fn the_helical_workspace_is_three_strips() {
    let (count, phi, pitch) = (101_u32, 3.0_f64, 0.02);
    let found = workspace(&[
        HELICAL,
        "--grid",
        "x=-500mm:500mm:101",
        "--grid",
        "y=-50cm:50cm:101",
        "--grid",
        "phi=3",
    ]);
    let legs = [(210.0_f64, 45.0_f64, 0.010), (330.0, 285.0, 0.015), (90.0, 165.0, 0.025)];
    let at = |i: u32| -0.5 + f64::from(i) / f64::from(count - 1);
    let reached = |x: f64, y: f64| {
        legs.iter().enumerate().all(|(number, (alpha, beta, k))| {
            let (sin, cos) = alpha.to_radians().sin_cos();
            let along = k + if number == 0 { pitch * phi } else { 0.0 };
            (-sin * x + cos * y + beta.to_radians().sin() * along).abs() <= 0.4
        })
    };
    let expected = (0..count)
        .flat_map(|i| (0..count).map(move |j| (i, j)))
        .filter(|&(i, j)| reached(at(i), at(j)));
    let expected = expected.count();
    assert!(expected > 1000);
    assert_eq!(found["reachable"], expected);
    // The box is 1 m by 1 m, so the measure equals the share.
    assert_eq!(keys(&found["measure"]), ["value", "units", "method"]);
    let share = expected as f64 / f64::from(count * count);
    assert!((number(&found["measure"]["value"]) - share).abs() < EXACT);
    assert_eq!(found["measure"]["units"], "m^2");
    assert_eq!(found["measure"]["method"], "grid");
    assert_eq!(found["mode"], "");
    let phi_axis = &found["grid"]["phi"];
    assert_eq!(keys(phi_axis), ["min", "max", "count"]);
    assert_eq!(["min", "max", "count"].map(|key| number(&phi_axis[key])), [3.0, 3.0, 1.0]);
    assert_eq!(found["imaginary_range"]["S"], serde_json::json!([0.06, 0.06]));
}

#[test]
fn without_a_grid_one_is_fitted_and_told() {
    let run = opm(&["workspace", PLANO, "--format", "json"]);
    let found = run.json();
    assert!(number(&found["reachable"]) > 1e5, "a workspace worth looking at: {found}");
    assert!(number(&found["measure"]["value"]) > 0.0);
    assert_eq!(found["measure"]["units"], "m^2 rad^3");
    // The flags that it prints give the same run.
    let flags = run.stderr.lines().find(|line| line.contains("--grid")).expect("a note");
    let flags: Vec<&str> = flags.split_whitespace().skip_while(|word| *word != "--grid").collect();
    let again = workspace(&[&[PLANO], &flags[..]].concat());
    for key in ["poses", "reachable", "grid", "imaginary_range"] {
        assert_eq!(again[key], found[key], "{key}");
    }
    let quiet = opm(&["workspace", PLANO, "--quiet"]);
    assert_eq!((quiet.code, &*quiet.stderr), (Some(0), ""));
    assert!(quiet.stdout.contains("poses/s"));
}

#[test]
fn nothing_in_reach_is_no_failure() {
    let folder = Folder::new();
    let output = folder.arg("empty.mcap");
    let args = ["workspace", PLANO, "--grid", "x=5:6:3", "-o", &output, "--format", "json"];
    let run = opm(&args);
    let found = run.json();
    assert_eq!([&found["reachable"], &found["fraction"]].map(number), [0.0, 0.0]);
    assert_eq!(found["imaginary_range"]["theta11"], Value::Null);
    assert!(run.stderr.contains("no pose of the grid"), "{}", run.stderr);
    let limited = opm(&["workspace", PLANO, "--grid", "x=0:0.1:3", "--limit", "lti=2"]);
    let expected = "no pose of the grid is in reach and within the limits of joints and lti\n";
    assert!(limited.stderr.ends_with(expected), "{}", limited.stderr);
    assert!(read::<ReadError>(&folder.path("empty.mcap"), |_| Ok(())).unwrap().complete);
}

/// Every point of every slice of a recording, as its named fields.
fn points(folder: &Folder, name: &str, topic: &str, fields: &[&str]) -> Vec<Vec<f64>> {
    let mut points = Vec::new();
    read::<ReadError>(&folder.path(name), |message| {
        if message.topic == topic {
            let cloud = message.cloud()?.expect("a cloud");
            let columns: Vec<Vec<f64>> =
                fields.iter().map(|f| cloud.column(f).expect(f).collect()).collect();
            points
                .extend((0..cloud.len()).map(|i| columns.iter().map(|c| c[i]).collect::<Vec<_>>()));
        }
        Ok(())
    })
    .expect("a recording");
    points
}

#[test]
fn a_recording_holds_every_point_with_its_joints() {
    for mode in ["-+ +- -- -", "any"] {
        let folder = Folder::new();
        let output = folder.arg("cloud.mcap");
        let flags = ["-o", &output, "--axes", "x,y,xi", "--color", "S1", "--scale", "none"];
        let scalars = ["--scalars", "zeta,theta12,S1,phi24", "--mode", mode];
        let found = workspace(&[&[PLANO], &MIXED[..], &flags, &scalars].concat());
        assert_eq!(folder.names(), ["cloud.mcap"]);
        let fields = ["x", "y", "z", "zeta", "theta12", "S1", "phi24"];
        let slices = points(&folder, "cloud.mcap", "/workspace/slices", &fields);
        assert_eq!(found["reachable"], slices.len());
        // There are few enough points for the overview to hold all of them.
        assert_eq!(points(&folder, "cloud.mcap", "/workspace/cloud", &fields), slices);

        // The joints of each point equal inverse kinematics at its pose, in one of the modes for `any`.
        let mut input = "x,y,xi,zeta,psi\n".to_owned();
        for point in &slices {
            input += &format!("{},{},{},{},0.1\n", point[0], point[1], point[2], point[3]);
        }
        let modes = if mode == "any" { vec!["--all-modes"] } else { vec!["--mode", mode] };
        let run = opm_reading(&input, &[&["ik", PLANO, "--poses", "-"], &modes[..]].concat());
        let mut rows = run.text().lines().skip(1).peekable();
        let pose = |row: &str| row.split(',').take(5).collect::<Vec<_>>().join(",");
        // Rounded to single precision, a pose on a limit may fall beyond it.
        let mut matched = 0;
        for point in &slices {
            let first = rows.peek().map(|row| pose(row)).expect("a row for every point");
            let mut any = false;
            while rows.peek().is_some_and(|row| pose(row) == first) {
                let row: Vec<&str> = rows.next().unwrap().split(',').collect();
                let near = |column: usize, value: f64| {
                    row[column].parse::<f64>().is_ok_and(|v| (v - value).abs() < 1e-3)
                };
                any |= near(9, point[4]) && near(11, point[5]) && near(15, point[6]);
            }
            matched += usize::from(any);
        }
        assert!(matched * 100 >= slices.len() * 99, "{matched} of {}", slices.len());
    }
}

#[test]
fn the_tip_is_where_the_platform_is() {
    let folder = Folder::new();
    let output = folder.arg("tip.mcap");
    let args = [HELICAL, "--grid", "x=-100mm:100mm:5", "--grid", "phi=-1:1:3"];
    workspace(&[&args[..], &["-o", &output, "--axes", "tip", "--scalars", "phi"]].concat());
    let tips = points(&folder, "tip.mcap", "/workspace/slices", &["x", "y", "z"]);
    assert_eq!(tips.len(), 15);
    // The reference point is on the axis of phi: it moves with x alone.
    for (number, tip) in tips.iter().enumerate() {
        let x = -0.1 + 0.05 * (number % 5) as f64;
        assert!((tip[0] - x).abs() < SINGLE && tip[1].abs() < SINGLE && tip[2].abs() < SINGLE);
    }
}

#[test]
fn the_same_run_writes_the_same_bytes() {
    let folder = Folder::new();
    let record = |name: &str, threads: &str| {
        let output = folder.arg(name);
        workspace(&[&[PLANO, "-o", &output, "--threads", threads], &MIXED[..]].concat());
        fs::read(folder.path(name)).unwrap()
    };
    assert!(record("one.mcap", "1") == record("two.mcap", "3"));
}

/// Ctrl-C ends a run that would take hours.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_no_file_under_its_name() {
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::Duration;

    let folder = Folder::new();
    let output = folder.arg("long.mcap");
    let mut args = vec!["workspace", PLANO, "-o", &output];
    for axis in ["x=-1:1:100000", "y=-1:1:100000", "zeta=-1:1:100"] {
        args.extend(["--grid", axis]);
    }
    let child = command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !folder.path("long.mcap.partial").exists() {
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(300));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let run = Run::new(&args, &child.wait_with_output().unwrap());
    run.fails_with_one_line(130, &["interrupted; ", " of 1,000,000,000,000 poses"]);
    assert_eq!(folder.names(), [""; 0], "nothing was recorded yet");
}

/// Whole axes go together until a person can play the slices; every point is still there.
#[test]
fn a_grid_of_very_many_orientations_is_recorded_by_its_slowest_axes() {
    let folder = Folder::new();
    let output = folder.arg("out.mcap");
    let axes = ["x=0:0.1:2", "y=0:0.1:2", "zeta=0:1:60", "xi=0:1:50", "psi=0:1:40"];
    let grid = axes.iter().flat_map(|axis| ["--grid", axis]);
    let args: Vec<&str> = [PLANO, "-o", &output].into_iter().chain(grid).collect();
    let counted = workspace(&args);
    let inspected = opm(&["inspect", &output, "--format", "json"]).json();
    let topics = inspected["topics"].as_array().unwrap();
    let slices = topics.iter().find(|topic| topic["name"] == "/workspace/slices").unwrap();
    assert_eq!(slices["messages"], 50 * 40);
    assert_eq!(slices["points"], counted["reachable"]);
}

/// Poses count if their condition number, as in `opm velocity`, is within the limit. The recording
/// holds them in a mode that is within the limit.
#[test]
fn a_limit_on_the_condition_number_is_that_of_velocity() {
    let folder = Folder::new();
    let output = folder.arg("out.mcap");
    let grid = ["--grid", "x=-80mm:80mm:5", "--grid", "xi=-20deg:20deg:5"];
    let limit = ["--max-condition", "9.5", "--length", "80mm"];
    let mut expected = 0;
    for x in [-80, -40, 0, 40, 80] {
        for xi in [-20, -10, 0, 10, 20] {
            let pose = format!("x={x}mm,xi={xi}deg");
            let at = ["velocity", PLANO, "--pose", &pose, "--length", "80mm", "--format", "json"];
            let condition = &opm(&at).json()["singularity"]["condition"];
            let solved = opm(&["ik", PLANO, "--pose", &pose, "--format", "json"]).json();
            let within = solved["solutions"][0]["within_limits"] == true;
            expected += u64::from(within && condition.as_f64().is_some_and(|c| c <= 9.5));
        }
    }
    assert!((5..20).contains(&expected), "{expected}");
    let found = workspace(&[&[PLANO], &grid[..], &limit].concat());
    assert_eq!(found["reachable"], expected);
    assert_eq!(number(&found["max_condition"]), 9.5);
    assert_eq!(number(&found["characteristic_length"]), 0.08);
    assert!(workspace(&[&[PLANO], &grid[..]].concat()).get("max_condition").is_none());

    for mode in ["home", "any"] {
        let flags = ["--mode", mode, "-o", &output, "--color", "S1"];
        let found = workspace(&[&[PLANO], &grid[..], &limit, &flags].concat());
        assert!(found["reachable"].as_u64().unwrap() >= expected);
        let inspected = opm(&["inspect", &output, "--format", "json"]).json();
        let topics = inspected["topics"].as_array().unwrap().iter();
        let clouds: Vec<_> = topics.filter(|topic| !topic["points"].is_null()).collect();
        assert_eq!(clouds.len(), 2);
        assert!(clouds.iter().all(|topic| topic["points"] == found["reachable"]), "{inspected}");
    }
}

/// The grid has fewer rows than the parts have blocks, so that some parts have none.
#[test]
fn a_shard_without_poses_says_so() {
    let folder = Folder::new();
    let flags = ["--grid=x=-0.2:0.2:9", "--grid=xi=0:1:3", "--shard", "1/3", "-o"];
    let part = folder.arg("part.mcap");
    let run = opm(&[&["workspace", PLANO], &flags[..], &[&part]].concat());
    let text = run.text();
    assert!(text.contains("no poses of its own") && !text.contains("NaN"), "{text}");
}

/// A table has no slices, and no record of the coordinates that are held.
#[test]
fn a_table_has_every_coordinate() {
    let folder = Folder::new();
    let names = ["x", "y", "zeta", "xi", "psi"];
    for grid in [
        &["--grid=x=5mm"][..],
        &["--grid=x=-0.01:0.01:5", "--grid=zeta=-0.1:0.1:3", "--grid=psi=0:0.1:2"],
        &["--grid=zeta=-0.1:0.1:3", "--grid=xi=0:0.1:2", "--grid=psi=0:0.1:2"],
    ] {
        for (ending, own) in [("npy", &[][..]), ("ply", &["x", "y"])] {
            let table = folder.arg(&format!("points.{ending}"));
            let run = [&["workspace", PLANO, "-q", "-o", &table], grid].concat();
            opm(&run).text();
            let bytes = std::fs::read(&table).unwrap();
            let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1000)]).into_owned();
            for name in names.iter().filter(|name| !own.contains(name)) {
                let axis = head.lines().any(|line| {
                    line.starts_with("comment x, y, z: ")
                        && line.split([' ', ',', ';']).any(|word| word == *name)
                });
                let column = [format!("('{name}', '<f8')"), format!("property float {name}\n")];
                let stored = column.iter().any(|column| head.contains(column));
                assert!(axis || stored, "{grid:?}, {ending}: no {name} in {head}");
            }
        }
    }
}
