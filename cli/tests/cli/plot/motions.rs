//! Pictures of motions.

use super::*;
use opm_mcap::trajectory::{Coordinate, Posture, Role, Sample};
use opm_mcap::{Trajectory, TrajectoryRecorder};

#[test]
fn a_motion_has_positions_on_the_left_and_velocities_on_the_right() {
    let folder = Folder::new();
    let file = motion(&folder, &["--motion", MOTION]);
    let (_, svg) = plot(&folder, &file, &[]);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let expected = [
        "Platform position",
        "Platform, velocity",
        "Platform orientation",
        "Platform orientation, velocity",
        "Imaginary joints",
        "Imaginary joints, velocity",
        "Actuated joints",
        "Actuated joints, velocity",
        "Actuated joints",
        "Actuated joints, velocity",
        "Condition number",
    ];
    assert_eq!(titles(&document)[..expected.len()], expected);
    let axes: Vec<&str> = class(document.root(), "y-axis").into_iter().map(label).collect();
    for unit in ["(mm)", "(deg)", "(mm/s)", "(deg/s)"] {
        assert!(axes.iter().any(|axis| axis.ends_with(unit)), "{axes:?}");
    }
    // The motion file: x = 2 mm + 20 mm · sin(0.2 rev/s · t + 265°), sampled a hundred times per second.
    let panel = class(document.root(), "panel")[0];
    let points = pieces(paths(named(panel, "curve", "x"))[0]).concat();
    assert_eq!(points.len(), 1001);
    let up = up(panel);
    for (i, [_, y]) in points.into_iter().enumerate() {
        let angle = std::f64::consts::TAU * 0.2 * 0.01 * i as f64 + 265_f64.to_radians();
        let x = 2.0 + 20.0 * angle.sin();
        assert!((up(y) - x).abs() < 0.05, "{i}: {} {x}", up(y));
    }

    let args = ["--panels", "actuated,accelerations", "--values", "S1,S3"];
    let (_, svg) = plot(&folder, &file, &args);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["Actuated joints, acceleration"]);
    let curves: Vec<&str> = class(document.root(), "curve").into_iter().map(label).collect();
    assert_eq!(curves, ["S1", "S3"]);
    let (_, svg) = plot(&folder, &file, &["--values", "phi11,theta11"]);
    let document = Document::parse(&svg).unwrap();
    let named = ["Imaginary joints", "Passive joints"];
    assert!(titles(&document).iter().all(|t| named.iter().any(|n| t.starts_with(n))));

    // No row is dropped silently.
    let panels = "imaginary,actuated,accelerations";
    let refused = opm(&["plot", &file, "-o", &folder.arg("none.svg"), "--panels", panels]);
    let parts = ["--panels: ", "no imaginary in what --panels and --values ask for"];
    refused.fails_with_one_line(2, &parts);
}

/// Where the mechanism cannot follow, the picture is shaded, the curves of the joints have gaps, and the
/// notes say what happened and when, as in the output of the recording command.
#[test]
fn violations_are_marked() {
    let folder = Folder::new();
    let text = "format = 1\nname = \"far\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
        duration = 4\nrate = 50\n[coordinates]\nx = { amplitude = 400, frequency = 0.25 }\n";
    let far = folder.write("far.toml", text);
    let file = motion(&folder, &["--motion", &far]);
    let (_, svg) = plot(&folder, &file, &[]);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let run = opm(&["trajectory", PLANO, "--motion", &far, "--format", "json"]);
    let violations = run.json()["violations"].as_array().unwrap().clone();
    assert!(!violations.is_empty());
    let panels = class(document.root(), "panel");
    let last = across(panels[panels.len() - 1]);
    let marks = class(panels[panels.len() - 1], "marks")[0];
    let at: Vec<f64> = paths(marks).into_iter().map(|line| last(pieces(line)[0][0][0])).collect();
    assert_eq!(at.len(), violations.len());
    for (at, violation) in at.iter().zip(&violations) {
        let start = number(&violation["start"]);
        assert!((at - start).abs() < 1e-3, "{at} {start}");
    }
    assert!(texts(&document).iter().any(|text| text.contains("out of reach")));
    let joints = panels.iter().find(|panel| label(**panel) == "Actuated joints").unwrap();
    let curve = named(*joints, "curve", "S1");
    assert!(pieces(paths(curve)[0]).len() > 1, "a gap");
    let pose = named(panels[0], "curve", "x");
    assert_eq!(pieces(paths(pose)[0]).len(), 1, "the pose goes on");
    // Out of reach nothing is measured. S1 has a gap only out of reach.
    let measures = panels.iter().find(|panel| label(**panel) == "Singularity measures").unwrap();
    let spans = |panel, name| -> Vec<[i64; 2]> {
        let pieces = pieces(paths(named(panel, "curve", name))[0]);
        let ends = |piece: &Vec<[f64; 2]>| {
            [piece[0][0], piece[piece.len() - 1][0]].map(|x| x.round() as i64)
        };
        pieces.iter().map(ends).collect()
    };
    assert_eq!(spans(*measures, "upper_parallel"), spans(*joints, "S1"));
}

/// A rate in --panels does not take away a panel that is named beside it.
#[test]
fn the_condition_number_is_drawn_beside_accelerations() {
    let folder = Folder::new();
    let file = motion(&folder, &["--motion", "plano-spherical-sinusoids", "--rate", "10"]);
    let args = ["--panels", "condition,actuated,accelerations", "--values", "condition,S1"];
    let (_, svg) = plot(&folder, &file, &args);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["Actuated joints, acceleration", "Condition number"]);
}

/// Indices have a panel for each unit, and the values of the table.
#[test]
fn indices_are_drawn_by_their_units() {
    let folder = Folder::new();
    let load = ["--indices", "--wrench", "10,0,0,0,0,0.5", "--link-stiffness", "1e7,1e4"];
    let of = [&["--motion", MOTION, "--rate", "10"], &load[..]].concat();
    let file = motion(&folder, &of);
    let (_, svg) = plot(&folder, &file, &["--panels", "indices,efforts"]);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let panels = class(document.root(), "panel");
    // Each panel is named by what it shows.
    let found = titles(&document);
    for title in ["Transmission indices", "Efforts of joints", "Distance of the nearest bodies"] {
        assert!(found.contains(&title), "{title:?} in {found:?}");
    }
    assert!(!found.contains(&"Indices"));
    let axes: Vec<&str> = class(document.root(), "y-axis").into_iter().map(label).collect();
    let table = folder.arg("table.csv");
    opm(&[&["trajectory", PLANO, "-o", &table], &of[..]].concat()).text();
    let text = folder.read("table.csv");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    for (name, axis) in [
        ("lti", "value"),
        ("effort.S1", "effort (N)"),
        ("effort.phi14", "effort (N m)"),
        ("rotational_stiffness", "value (N m/rad)"),
        ("clearance", "length (mm)"),
    ] {
        let has = |panel| class(panel, "curve").into_iter().any(|curve| label(curve) == name);
        let place = panels.iter().position(|panel| has(*panel)).expect(name);
        assert_eq!(axes[place], axis, "{name}");
        let curve = named(panels[place], "curve", name);
        let points = pieces(paths(curve)[0]).concat();
        let column = rows[0].iter().position(|found| *found == name).expect(name);
        let values: Vec<f64> = rows[1..].iter().map(|row| row[column].parse().unwrap()).collect();
        let [low, high] = values
            .iter()
            .fold([f64::MAX, f64::MIN], |[low, high], &value| [low.min(value), high.max(value)]);
        let scale = if axis.ends_with("(mm)") { 1e3 } else { 1.0 };
        let up = up(panels[place]);
        assert_eq!(points.len(), values.len(), "{name}");
        for ([_, y], value) in points.into_iter().zip(values) {
            let apart = (up(y) / scale - value).abs();
            assert!(apart < 2e-3 * (high - low), "{name}: {} {value}", up(y));
        }
    }
    // With everything else they are below it, and a name selects one.
    let (_, svg) = plot(&folder, &file, &[]);
    let document = Document::parse(&svg).unwrap();
    assert!(titles(&document).ends_with(&found));
    let (_, svg) = plot(&folder, &file, &["--values", "effort.S1"]);
    assert_eq!(titles(&Document::parse(&svg).unwrap()), ["Efforts of joints"]);
    let without = motion(&folder, &["--motion", MOTION, "--rate", "10"]);
    let none = opm(&["plot", &without, "-o", &folder.arg("none.svg"), "--panels", "indices"]);
    none.fails_with_one_line(2, &["--panels: indices: ", "record with `opm trajectory --indices`"]);
}

/// The efforts of a recorded motion are those of the table, and a limit of theirs is a dashed line on both sides.
#[test]
fn efforts_are_drawn_with_their_limits() {
    let folder = Folder::new();
    // The largest effort is 0.18 N. Limits are drawn where they are no farther from the curves than these are high.
    let limits = ["--set", "max_effort.S=0.2", "--set", "leg1.max_effort.S=0.25"];
    let of = [&["--motion", MOTION, "--rate", "10", "--efforts"], &limits[..]].concat();
    let file = motion(&folder, &of);
    let (_, svg) = plot(&folder, &file, &["--panels", "efforts"]);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    assert!(titles(&document).iter().all(|title| *title == "Efforts of joints"));
    let axes: Vec<&str> = class(document.root(), "y-axis").into_iter().map(label).collect();
    let place = axes.iter().position(|axis| *axis == "effort (N)").unwrap();
    let panel = class(document.root(), "panel")[place];
    let up = up(panel);
    let table = folder.arg("table.csv");
    opm(&[&["trajectory", PLANO, "-o", &table], &of[..]].concat()).text();
    let text = folder.read("table.csv");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = rows[0].iter().position(|found| *found == "effort.S1").unwrap();
    let points = pieces(paths(named(panel, "curve", "effort.S1"))[0]).concat();
    assert_eq!(points.len(), rows.len() - 1);
    for ([_, y], row) in points.into_iter().zip(&rows[1..]) {
        let value: f64 = row[column].parse().unwrap();
        assert!((up(y) - value).abs() < 2e-3, "{} {value}", up(y));
    }
    let levels = paths(class(panel, "limits")[0]).into_iter().map(|level| {
        let ends = pieces(level).concat();
        assert_eq!(ends.len(), 2);
        assert!((ends[0][1] - ends[1][1]).abs() < 1e-9);
        (100.0 * up(ends[0][1])).round() as i32
    });
    let mut levels: Vec<i32> = levels.collect();
    levels.sort_unstable();
    assert_eq!(levels, [-25, -20, 20, 25]);
    let without = motion(&folder, &["--motion", MOTION, "--rate", "10"]);
    let none = opm(&["plot", &without, "-o", &folder.arg("none.svg"), "--panels", "efforts"]);
    none.fails_with_one_line(2, &["--panels: efforts: ", "record with `opm trajectory --efforts`"]);
}

/// Limits are dashed in every panel that has any, what is used of them is told, and accelerations are drawn where they are too
/// large.
#[test]
fn demands_are_shown_against_limits() {
    let folder = Folder::new();
    let limits = |acceleration: &str| {
        let file = motion(
            &folder,
            &["--motion", MOTION, "--set", "leg1.max_rate.S=50mm", "--set", acceleration],
        );
        plot(&folder, &file, &[]).1
    };
    let svg = limits("leg1.max_acceleration.S=50mm");
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    // The motion reaches 44.3 mm/s and 77.9 mm/s².
    let told = texts(&document).into_iter().find(|text| text.starts_with("S1: ")).unwrap();
    assert!(told.ends_with(", 89 % of its max_rate, 156 % of its max_acceleration"), "{told}");
    for title in ["Actuated joints, velocity", "Actuated joints, acceleration"] {
        let panel = named(document.root(), "panel", title);
        let up = up(panel);
        let lines = class(panel, "limits");
        let lines = paths(lines[0]).into_iter().map(|line| up(pieces(line)[0][0][1]));
        let mut found: Vec<f64> = lines.map(f64::round).collect();
        found.sort_by(f64::total_cmp);
        assert_eq!(found, [-50.0, 50.0], "{title}");
    }
    // Where it is not, there is no third column.
    let svg = limits("leg1.max_acceleration.S=200mm");
    let document = Document::parse(&svg).unwrap();
    assert!(!titles(&document).contains(&"Actuated joints, acceleration"));
}

/// A recording of an unknown mechanism, with two joints.
fn unknown_motion(path: &str, values: &[[f64; 2]]) {
    unknown_motion_with(path, values, &[], &Metadata::new());
}

fn unknown_motion_with(
    path: &str,
    values: &[[f64; 2]],
    violations: &[Metadata],
    result: &Metadata,
) {
    let joint = |name: &str| Coordinate { name: name.into(), unit: "rad", role: Role::Actuated };
    let trajectory = Trajectory {
        pose: vec![],
        joints: vec![joint("a"), joint("b")],
        dependent: vec![],
        imaginary: vec![],
        rates: false,
        measures: vec![],
        indices: Vec::new(),
        bodies: vec![],
        files: vec![("nonsense.toml", b"nonsense")],
        run: Metadata::new(),
    };
    let mut recorder = TrajectoryRecorder::create(path.as_ref(), &trajectory).unwrap();
    for (i, joints) in (0..).zip(values) {
        let posture = Some(Posture { joints, ..Posture::default() });
        recorder.push(i * 1_000_000, &Sample { posture, ..Sample::default() }).unwrap();
    }
    for (number, violation) in (1..).zip(violations) {
        recorder.describe(&format!("violation.{number}"), violation).unwrap();
    }
    recorder.finish(result).unwrap();
}

/// A recording holds the first of very many violations; the notes count all.
#[test]
fn violations_that_are_not_in_the_recording_are_counted() {
    let folder = Folder::new();
    let file = folder.arg("many.mcap");
    let record = |pairs: &[(&str, &str)]| -> Metadata {
        pairs.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect()
    };
    let violations = [record(&[("kind", "singularity"), ("start", "0.001")])];
    let result = record(&[("violations", "50000")]);
    unknown_motion_with(&file, &[[1.0, 2.0]; 5], &violations, &result);
    let (_, svg) = plot(&folder, &file, &[]);
    let document = Document::parse(&svg).unwrap();
    assert!(texts(&document).contains(&"and 49,999 more; the first 1 are marked"));
    unknown_motion_with(&file, &[[1.0, 2.0]; 5], &violations, &Metadata::new());
    let (_, svg) = plot(&folder, &file, &[]);
    assert!(!svg.contains(" more"));
}

#[test]
fn what_is_not_a_number_is_a_gap() {
    let folder = Folder::new();
    let file = folder.arg("odd.mcap");
    let mut values = [[1.0, 1e-17]; 30];
    for (i, odd) in [(10, f64::NAN), (11, f64::INFINITY), (20, f64::NEG_INFINITY)] {
        values[i][0] = odd;
    }
    unknown_motion(&file, &values);
    let (_, svg) = plot(&folder, &file, &[]);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let lengths = |name| -> Vec<usize> {
        pieces(paths(named(document.root(), "curve", name))[0]).iter().map(Vec::len).collect()
    };
    assert_eq!((lengths("a"), lengths("b")), (vec![10, 8, 9], vec![30]));
    assert!(texts(&document).iter().any(|text| text.contains("no mechanism file")));
    assert!(texts(&document).contains(&"angle (rad)"));
    for values in [&[[f64::NAN; 2]; 3][..], &[[1.0, 2.0]]] {
        unknown_motion(&file, values);
        assert_legible(&plot(&folder, &file, &[]).1);
    }
    unknown_motion(&file, &[]);
    opm(&["plot", &file, "-o", &folder.arg("none.svg")])
        .fails_with_one_line(1, &["odd.mcap", "no sample to draw"]);
}
