//! `opm ik --poses`: CSV in, CSV out.

use crate::run::{Folder, command, keys, number, opm, opm_reading};
use crate::{HELICAL, PLANO};
use std::f64::consts::TAU;
use std::process::Stdio;

/// The reference vectors have 16 digits; closed forms lose a few near the boundary of reach.
const REFERENCE: f64 = 1e-9;

/// The reader of JSON rounds the last digit of an angle.
const LAST_DIGIT: f64 = 1e-14;

/// A table with a header, by name.
struct Csv {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Csv {
    fn parse(text: &str) -> Self {
        let mut lines =
            text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        Self { header: lines.next().expect("a header"), rows: lines.collect() }
    }

    #[track_caller]
    fn column(&self, name: &str) -> usize {
        self.header.iter().position(|known| known == name).expect(name)
    }

    fn cell(&self, row: usize, name: &str) -> &str {
        &self.rows[row][self.column(name)]
    }

    fn number(&self, row: usize, name: &str) -> f64 {
        self.cell(row, name).parse().unwrap_or(f64::NAN)
    }

    /// The selected columns, as text.
    fn select(&self, names: &[&str], rows: &[usize]) -> String {
        let mut text = names.join(",") + "\n";
        for &row in rows {
            let cells: Vec<&str> = names.iter().map(|name| self.cell(row, name)).collect();
            text += &(cells.join(",") + "\n");
        }
        text
    }
}

/// Every pose of the vectors from an independent implementation agrees.
#[test]
fn reference_vectors_of_the_plano_spherical_manipulator() {
    let golden =
        Csv::parse(include_str!("../../../data/reference/independent/plano_spherical_ik.csv"));
    let task = ["x", "y", "zeta", "xi", "psi"];
    let mut modes: Vec<&str> = (0..golden.rows.len()).map(|row| golden.cell(row, "mode")).collect();
    modes.sort_unstable();
    modes.dedup();
    let mut closed = 0;
    for mode in modes {
        let rows: Vec<usize> =
            (0..golden.rows.len()).filter(|&row| golden.cell(row, "mode") == mode).collect();
        let input = golden.select(&task, &rows);
        let run = opm_reading(&input, &["ik", PLANO, "--poses", "-", "--mode", mode]);
        let found = Csv::parse(run.text());
        assert_eq!(found.rows.len(), rows.len());
        for (row, &expected) in rows.iter().enumerate() {
            assert_eq!(found.cell(row, "mode"), mode);
            assert_eq!(found.cell(row, "reachable"), golden.cell(expected, "closes"), "{row}");
            let within = golden.cell(expected, "within_limits");
            assert_eq!(found.cell(row, "within_limits"), within, "{row}");
            let joints = ["theta11", "theta12", "theta13", "S1", "S2", "S3", "phi14", "phi24"];
            for joint in joints {
                if found.cell(row, "reachable") == "0" {
                    assert_eq!(found.cell(row, joint), "");
                    continue;
                }
                let mut off = found.number(row, joint) - golden.number(expected, joint);
                if !joint.starts_with('S') {
                    off = (off + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
                }
                assert!(off.abs() < REFERENCE, "{mode}, row {row}, {joint}: off by {off}");
            }
            closed += usize::from(found.cell(row, "reachable") == "1");
        }
    }
    assert!(closed > 100, "only {closed} reference poses close");
}

#[test]
fn reference_vectors_of_the_helical_manipulator() {
    let golden = Csv::parse(include_str!(
        "../../../data/reference/independent/translational_helical_ik.csv"
    ));
    let rows: Vec<usize> = (0..golden.rows.len()).collect();
    assert!(rows.len() > 10);
    let input = golden.select(&["phi", "y", "x"], &rows);
    let found = Csv::parse(opm_reading(&input, &["ik", HELICAL, "--poses", "-"]).text());
    let header = ["x", "y", "phi", "reachable", "within_limits", "mode", "S", "S1", "S2", "S3"];
    assert_eq!(found.header, header);
    for row in rows {
        assert_eq!(found.cell(row, "within_limits"), golden.cell(row, "within_limits"));
        for name in ["x", "y", "phi", "S", "S1", "S2", "S3"] {
            let off = found.number(row, name) - golden.number(row, name);
            assert!(off.abs() < REFERENCE, "row {row}, {name}: off by {off}");
        }
    }
}

#[test]
fn columns_may_come_in_any_order_and_number() {
    let run = opm_reading("xi,x\n0.1,0.02\n\"0.2\", -1e-2 \n", &["ik", PLANO, "--poses", "-"]);
    let found = Csv::parse(run.text());
    let expected = [
        "x",
        "y",
        "zeta",
        "xi",
        "psi",
        "reachable",
        "within_limits",
        "mode",
        "theta11",
        "theta12",
        "theta13",
        "S1",
        "S2",
        "S3",
        "phi14",
        "phi24",
    ];
    assert_eq!(found.header, expected);
    let poses: Vec<_> = found.rows.iter().map(|row| row[..5].join(" ")).collect();
    assert_eq!(poses, ["0.02 0.0 0.0 0.1 0.0", "-0.01 0.0 0.0 0.2 0.0"]);
    // Each row equals the result for its pose alone.
    let alone = opm(&["ik", PLANO, "--pose", "x=0.02,xi=0.1", "--format", "json"]).json();
    let solution = &alone["solutions"][0];
    for (name, alone) in [("S2", &solution["joints"]), ("theta13", &solution["imaginary"])] {
        assert!((found.number(0, name) - number(&alone[name])).abs() < REFERENCE, "{name}");
    }
}

#[test]
fn no_rows_and_odd_line_ends_are_fine() {
    let header_only = opm_reading("x,y\n", &["ik", HELICAL, "--poses", "-"]);
    assert_eq!(Csv::parse(header_only.text()).rows.len(), 0);
    let windows = opm_reading("\u{feff}x,y\r\n0,0\r\n\r\n1,1", &["ik", HELICAL, "--poses", "-"]);
    assert_eq!(Csv::parse(windows.text()).rows.len(), 2);
}

#[test]
fn all_modes_give_a_row_each() {
    let input = "xi\n0.1\n2.0943951023931953\n";
    let run = opm_reading(input, &["ik", PLANO, "--poses", "-", "--all-modes"]);
    let found = Csv::parse(run.text());
    assert_eq!(found.rows.len(), 128 + 1, "every mode of the first pose, one row for the second");
    assert_eq!((found.cell(128, "reachable"), found.cell(128, "mode")), ("0", ""));
    assert_eq!(found.cell(0, "mode"), "++ ++ ++ +");
}

/// Every cell is that of the answer for one pose, of which `opm ik` prints every joint.
#[test]
fn passive_joints_are_columns_too() {
    let input = "x,xi\n0.01,0.1\n0,2.0943951023931953\n";
    for modes in ["--mode=-+ ++ +- -", "--all-modes"] {
        let run = opm_reading(input, &["ik", PLANO, "--poses", "-", "--all-joints", modes]);
        let found = Csv::parse(run.text());
        let one = opm(&["ik", PLANO, "--pose", "x=0.01,xi=0.1", modes, "--format", "json"]).json();
        let solutions = one["solutions"].as_array().unwrap();
        assert_eq!(found.rows.len(), solutions.len() + 1);
        for (row, solution) in solutions.iter().enumerate() {
            assert_eq!(found.cell(row, "mode"), solution["mode"].as_str().unwrap());
            for kind in ["joints", "imaginary"] {
                for name in keys(&solution[kind]) {
                    let known = number(&solution[kind][name]);
                    assert!((found.number(row, name) - known).abs() < LAST_DIGIT, "{name}");
                }
            }
        }
        let last = found.rows.len() - 1;
        assert!(keys(&solutions[0]["joints"]).iter().all(|name| found.cell(last, name).is_empty()));
        let before = found.column("theta13");
        assert_eq!(found.header[before + 1..], *keys(&solutions[0]["joints"]));
    }
}

#[test]
fn a_file_appears_when_it_is_whole() {
    let folder = Folder::new();
    let (input, output) = (folder.write("in.csv", "x\n0\n0.01\n5\n"), folder.arg("out.csv"));
    let args = ["ik", PLANO, "--poses", &input, "-o", &output];
    let run = opm(&args);
    assert_eq!(run.text(), "", "the CSV is in the file, the rest is talk");
    assert!(run.stderr.contains("3 poses, 2 in reach, 2 within limits"), "{}", run.stderr);
    let to_stdout = opm(&args[..4]);
    assert_eq!(folder.read("out.csv"), to_stdout.text());
    assert_eq!(to_stdout.stdout, opm(&[&args[..4], &["-o", "-"]].concat()).stdout);

    let summary = opm(&[&args[..], &["--format", "json"]].concat()).json();
    let expected = ["poses", "reachable", "within_limits", "seconds", "poses_per_second"];
    assert_eq!(keys(&summary), expected);
    assert_eq!([&summary["poses"], &summary["reachable"]].map(number), [3.0, 2.0]);

    // A bad row may come before or after enough rows to be on their way to the disk. An existing file stays
    // as it was, and no other file is left.
    let before = folder.read("out.csv");
    for rows in [1, 20_000] {
        let bad = folder.write("bad.csv", "x\n".to_owned() + &"0\n".repeat(rows) + "zero\n");
        let run = opm(&["ik", PLANO, "--poses", &bad, "-o", &output]);
        run.fails_with_one_line(1, &[&format!("bad.csv:{}: ", rows + 2)]);
        assert_eq!(folder.read("out.csv"), before);
        assert!(!folder.path("out.csv.partial").exists(), "{rows} rows");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = Folder::new();
    let input = folder.write("in.csv", "x\n".to_owned() + &"0.01\n".repeat(20_000));
    let mut child = command(&["ik", PLANO, "--poses", &input])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[test]
fn bad_rows_are_named_by_file_line_and_column() {
    let folder = Folder::new();
    for (content, parts) in [
        ("", &["in.csv:1: no header", "x,y,zeta,xi,psi"][..]),
        ("0.1,0.2\n0,0\n", &["in.csv:1: no header"]),
        ("x,yaw\n0,0\n", &["in.csv:1: column \"yaw\"", "expected one of x, y, zeta, xi, psi"]),
        ("x,,y\n0,0,0\n", &["in.csv:1: column \"\""]),
        ("x,y,x\n0,0,0\n", &["in.csv:1: column \"x\": given twice"]),
        ("x,y\n0,0\n1\n", &["in.csv:3: 1 column, expected 2: x,y"]),
        ("x,y\n0,0\n1,2,3\n", &["in.csv:3: 3 columns, expected 2: x,y"]),
        ("x,y\r\n0,0\r\n1,2,3\r\n", &["in.csv:3: 3 columns"]),
        ("x,y\n\n\n0,zero\n", &["in.csv:4: column y: \"zero\" is not a number"]),
        ("x,y\n0,\n", &["in.csv:2: column y: \"\" is not a number"]),
        ("x,y\n0,NaN\n", &["in.csv:2: column y: \"NaN\" is not a finite number"]),
        ("y,x\n0,0\n0,-inf\n", &["in.csv:3: column x: \"-inf\" is not a finite number"]),
        ("x\n1e999\n", &["in.csv:2: column x: \"1e999\" is not a finite number"]),
        ("x\n1e200\n", &["in.csv:2: x is 1e200"]),
        ("x\n10mm\n", &["in.csv:2: column x: \"10mm\" is not a number"]),
    ] {
        let input = folder.write("in.csv", content);
        let output = folder.arg("out.csv");
        let run = opm(&["ik", PLANO, "--poses", &input, "-o", &output]);
        run.fails_with_one_line(1, parts);
        assert!(!folder.path("out.csv").exists(), "{content:?}");
    }
    let input = folder.write("binary.csv", [b'x', b'\n', 0xff, 0xfe, b'\n']);
    opm(&["ik", PLANO, "--poses", &input, "-o", &folder.arg("out.csv")])
        .fails_with_one_line(1, &["binary.csv:2: column x"]);
}

/// The times of a motion's table stay with their poses, wherever the column is.
#[test]
fn times_are_carried_through() {
    let folder = Folder::new();
    let poses = folder.write("poses.csv", "x,t\n0.001,0.25\n9,0.5\n");
    let run = opm(&["ik", PLANO, "--poses", &poses]);
    let lines: Vec<&str> = run.text().lines().collect();
    assert!(lines[0].starts_with("t,x,y,"), "{}", lines[0]);
    assert!(lines[1].starts_with("0.25,0.001,"), "{}", lines[1]);
    assert!(lines[2].starts_with("0.5,9.0,"), "{}", lines[2]);
    let poses = folder.write("poses.csv", "x,t\n0.001,soon\n");
    opm(&["ik", PLANO, "--poses", &poses, "-o", &folder.arg("out.csv")])
        .fails_with_one_line(1, &["poses.csv:2: column t: \"soon\" is not a number"]);
}

/// A table that opm wrote says in which mode it was solved. It is solved again in that of --mode, and a note says so.
#[test]
fn the_mode_of_a_table_is_not_read_and_a_note_says_so() {
    let folder = Folder::new();
    let poses = folder.write("poses.csv", "x,xi [deg]\n0.01,15\n");
    let [other, again] = ["other.csv", "again.csv"].map(|name| folder.arg(name));
    let first = opm(&["ik", PLANO, "--poses", &poses, "--mode=-+ ++ ++ +", "-o", &other]);
    first.text();
    assert!(!first.stderr.contains("column mode"), "{}", first.stderr);
    let second = opm(&["ik", PLANO, "--poses", &other, "-o", &again]);
    second.text();
    let note = "other.csv: column mode is not read; --mode chooses the working mode";
    assert!(second.stderr.contains(note), "{}", second.stderr);
    let [other, again] = ["other.csv", "again.csv"].map(|name| Csv::parse(&folder.read(name)));
    assert_eq!([other.cell(0, "mode"), again.cell(0, "mode")], ["-+ ++ ++ +", "++ ++ ++ +"]);
}

/// The tolerances are an input as well as the mechanism.
#[test]
fn accuracy_does_not_replace_its_tolerances() {
    let folder = Folder::new();
    let tolerances = folder.write("t.toml", "actuators = 0.001\n");
    let grid = ["--grid", "x=-10mm:10mm:3"];
    let args = ["accuracy", "five-bar", "--tolerances", &tolerances, "-o", &tolerances];
    let parts = ["--output", "t.toml is also the input"];
    opm(&[&args[..], &grid].concat()).fails_with_one_line(2, &parts);
    assert_eq!(folder.read("t.toml"), "actuators = 0.001\n");
}

/// What a symbolic link leads to is replaced, and the link stays.
#[cfg(unix)]
#[test]
fn an_output_is_written_through_a_link() {
    let folder = Folder::new();
    let poses = folder.write("poses.csv", "x\n0.01\n");
    folder.write("real.csv", "old");
    std::os::unix::fs::symlink("real.csv", folder.path("link.csv")).expect("a link");
    opm(&["ik", PLANO, "--poses", &poses, "-o", &folder.arg("link.csv"), "--quiet"]).text();
    assert!(folder.path("link.csv").is_symlink());
    assert!(folder.read("real.csv").starts_with("x,"), "{}", folder.read("real.csv"));
    assert_eq!(folder.names(), ["link.csv", "poses.csv", "real.csv"]);
    // Also where nothing is there yet.
    std::fs::remove_file(folder.path("real.csv")).expect("a file");
    opm(&["ik", PLANO, "--poses", &poses, "-o", &folder.arg("link.csv"), "--quiet"]).text();
    assert!(folder.path("link.csv").is_symlink());
    assert_eq!(folder.names(), ["link.csv", "poses.csv", "real.csv"]);
}

/// A table of places gives what `--transform` gives of each, and the form of the TUM benchmark the same.
#[test]
fn places_in_se3() {
    let folder = Folder::new();
    let half = |angle: f64| [(angle / 2.0).sin(), (angle / 2.0).cos()];
    let rows = [(0.0, 0.52, 0.0), (0.02, 0.53, 0.1), (0.04, 0.54, -0.2), (3.0, 0.54, 0.0)];
    let (mut csv, mut tum) = (String::from("t,x,y,z,qx,qy,qz,qw\n"), String::from("# t x y z q\n"));
    for (number, (x, z, angle)) in rows.into_iter().enumerate() {
        let [s, c] = half(angle);
        csv += &format!("{number},{x},0,{z},0,0,{s},{c}\n");
        tum += &format!("{number} {x} 0   {z}\t0 0 {s} {c}\n");
    }
    let (csv, tum) = (folder.write("places.csv", csv), folder.write("places.tum", tum));
    let out = opm(&["ik", "stewart", "--poses", &csv, "--failures"]);
    assert_eq!(opm(&["ik", "stewart", "--poses", &tum, "--failures"]).stdout, out.stdout);
    let found = Csv::parse(out.text());
    for (row, (x, z, angle)) in rows.into_iter().enumerate() {
        let [s, c] = half(angle);
        let place = format!("{x},0,{z},{c},0,0,{s}");
        let one = opm(&["ik", "stewart", "--transform", &place, "--format", "json"]).json();
        assert_eq!(one["reachable"] == true, found.cell(row, "reachable") == "1");
        for name in ["x", "y", "z", "roll", "pitch", "yaw"] {
            let expected = one["pose"][name].as_f64().unwrap();
            assert!((found.number(row, name) - expected).abs() < 1e-12, "{row} {name}");
        }
        if let Some(joints) = one["solutions"][0]["joints"].as_object() {
            let value = joints["S1"].as_f64().unwrap();
            assert!((found.number(row, "S1") - value).abs() < 1e-12);
        }
    }
    // The last one is far beyond the limits of all struts; prismatic legs reach it.
    assert_eq!((found.cell(3, "within_limits"), found.cell(3, "unreachable")), ("0", ""));
    assert_eq!(found.cell(3, "beyond_limits"), "S1 S2 S3 S4 S5 S6");
    assert_eq!((found.cell(0, "unreachable"), found.cell(0, "beyond_limits")), ("", ""));

    // Wrong tables say where.
    for (text, parts) in [
        ("x,y,z,qx,qy,qz\n0,0,0,0,0,0\n", ["table.csv:1", "no column qw"]),
        ("x,y,z,qx,qy,qz,qw,roll\n0,0,0,0,0,0,1,0\n", ["table.csv:1", "roll beside a quaternion"]),
        ("x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n0,0,0,0,0,0,2\n", ["table.csv:3", "has length 2.0000"]),
        ("x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,\n", ["table.csv:2", "qw"]),
        ("# a\n0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 x\n", ["table.csv:3", "is not a number"]),
    ] {
        let file = folder.write("table.csv", text);
        let out = folder.arg("out.csv");
        opm(&["ik", "stewart", "--poses", &file, "-o", &out]).fails(1, &parts);
    }
    // A place that the plane does not have.
    let file = folder.write("table.csv", "x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n0,0,0.1,0,0,0,1\n");
    let run = opm(&["ik", "planar-3rrr", "--poses", &file]);
    assert!(run.stderr.contains("1 place is outside the manipulator's motion"), "{}", run.stderr);
    let found = Csv::parse(run.text());
    assert_eq!([0, 1].map(|row| found.cell(row, "reachable").to_owned()), ["1", "0"]);
}

/// Rows of poses out of reach have the nearest pose that is in reach, as for one pose.
#[test]
fn the_nearest_poses_of_a_table() {
    let folder = Folder::new();
    let file = folder.write("poses.csv", "t,x,y\n0,0,0.3\n1,-1,0.2\n");
    let run = opm(&["ik", "five-bar", "--poses", &file, "--nearest", "--failures"]);
    let found = Csv::parse(run.text());
    assert_eq!(found.number(0, "distance"), 0.0);
    let asked = ["ik", "five-bar", "--pose", "x=-1,y=0.2", "--nearest", "--format", "json"];
    let one = opm(&asked).json();
    assert_eq!(Some(found.number(1, "distance")), one["nearest_pose"]["distance"].as_f64());
    assert_eq!(Some(found.number(1, "x")), one["nearest_pose"]["pose"]["x"].as_f64());
    assert_eq!((found.cell(1, "reachable"), found.cell(1, "unreachable")), ("1", ""));
    // Without it, the legs that fail are named.
    let run = opm(&["ik", "five-bar", "--poses", &file, "--failures"]);
    let found = Csv::parse(run.text());
    let legs: Vec<&str> =
        one["unreachable"].as_array().unwrap().iter().map(|u| u["leg"].as_str().unwrap()).collect();
    assert!(!legs.is_empty());
    assert_eq!(found.cell(1, "unreachable"), legs.join(" "));
    // What comes out can be read again.
    let again = folder.write("again.csv", run.text());
    opm(&["ik", "five-bar", "--poses", &again]).text();
}
