//! `opm decompose` agrees with the paper about its mechanisms.

use crate::run::{Folder, keys, number, opm, opm_reading};
use crate::{HELICAL, PLANO};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Parallel directions and coordinates in metres: rounding only.
const EXACT: f64 = 1e-9;

fn decompose(file: &str) -> Value {
    opm(&["decompose", file, "--format", "json", "--quiet"]).json()
}

/// Where there are Euler angles, their convention is printed.
#[test]
fn the_convention_of_euler_angles() {
    for (file, printed) in [(PLANO, true), ("double-spherical-5dof", true), (HELICAL, false)] {
        let convention = "R = Rz(zeta) Ry(xi) Rz(psi)";
        assert_eq!(opm(&["decompose", file]).text().contains(convention), printed, "{file}");
    }
}

#[test]
fn the_plano_spherical_manipulator() {
    let found = decompose(PLANO);
    let expected = [
        "name",
        "lambda",
        "mobility",
        "platform",
        "imaginary_joints",
        "first_section_motions",
        "lower",
        "upper",
        "intersection",
        "task_coordinates",
        "dependent_coordinates",
        "legs",
        "frames",
        "applies",
        "reference_point",
        "joints",
        "warnings",
    ];
    assert_eq!(keys(&found), expected, "its decomposition is unique: no alternatives");
    assert_eq!(found["name"], PLANO);
    assert_eq!((&found["applies"], &found["warnings"]), (&json!("two subspaces"), &json!([])));
    let counts = ["lambda", "mobility", "imaginary_joints", "first_section_motions"];
    assert_eq!(counts.map(|key| found[key].as_u64().unwrap()), [5, 5, 3, 2]);
    assert_eq!(found["lower"], json!({ "subspace": "planar" }));
    assert_eq!(found["upper"], json!({ "subspace": "spherical" }));
    assert_eq!(keys(&found["intersection"]), ["kind", "axis", "point", "pitch"]);
    assert_eq!(found["intersection"]["kind"], "rotation");
    assert_eq!(found["intersection"]["axis"], json!([0.0, 0.0, 1.0]));
    assert_eq!(found["intersection"]["pitch"], Value::Null);
    // The axis is the normal through P, which is the origin at home.
    let point = found["intersection"]["point"].as_array().unwrap();
    assert!(number(&point[0]).hypot(number(&point[1])) < EXACT);

    let coordinates = found["task_coordinates"].as_array().unwrap();
    let names: Vec<&str> = coordinates.iter().map(|c| c["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["x", "y", "zeta", "xi", "psi"]);
    assert_eq!(coordinates[0], json!({ "name": "x", "home": 0.0, "unit": "m" }));
    assert_eq!(coordinates[3], json!({ "name": "xi", "home": 0.0, "unit": "rad" }));

    let legs = found["legs"].as_array().unwrap();
    assert_eq!(legs.len(), 4);
    let prr = json!({
        "name": "leg1",
        "lower": ["S1", "phi11", "phi21"],
        "upper": ["theta21", "theta31"],
        "imaginary": "theta11",
        "solved": "sections",
    });
    assert_eq!(legs[0], prr);
    assert_eq!(legs[3]["lower"], json!(["phi14", "phi24"]));
    assert_eq!(legs[3]["imaginary"], Value::Null);
}

/// The mechanism of cli/src/format.md has one joint of each type; its numbers are those of the file, SI.
const EVERY_TYPE: &str = r#"
format = 1
name = "every-type"
units = { length = "mm", angle = "deg" }
[platform]
point = [0, 20, 300]
[[leg]]
name = "one"
joints = [
  { name = "r", type = "revolute", axis = [0, 0, 2], point = [100, 40, 0], actuated = true, home = 90, limits = [0, 180] },
  { name = "p", type = "prismatic", axis = [0, 1, 0], limits = [-300, 300], max_rate = 500, max_acceleration = 2000 },
  { name = "h", type = "helical", axis = [0, 0, 1], point = [0, 0, 0], pitch = 20 },
]
[[leg]]
name = "two"
joints = [
  { name = "c", type = "cylindrical", axis = [1, 0, 0], point = [0, 0, 50], limits = [[-90, 90], [-10, 10]] },
  { name = "u", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [0, 0, 0], home = [0, 180] },
  { name = "s", type = "spherical", point = [0, 0, 200] },
]
"#;

#[test]
fn joints_are_those_of_the_file() {
    let found = opm_reading(EVERY_TYPE, &["decompose", "-", "--format", "json", "--quiet"]).json();
    assert_eq!(found["applies"], "outside");
    assert_eq!(found["reference_point"], json!([0.0, 0.02, 0.3]));
    let joints = found["joints"].as_array().unwrap();
    let r = json!({
        "name": "r", "leg": "one", "type": "revolute", "axis": [0.0, 0.0, 1.0], "axis2": null,
        "point": [0.1, 0.04, 0.0], "pitch": null, "actuated": true, "coordinates": ["r"],
        "unit": "rad", "home": PI / 2.0, "limits": [0.0, PI], "max_rate": null,
        "max_acceleration": null,
        "max_effort": null,
    });
    assert_eq!(joints[0], r);
    let p = &joints[1];
    assert_eq!((&p["unit"], &p["limits"]), (&json!("m"), &json!([-0.3, 0.3])));
    assert_eq!((&p["max_rate"], &p["max_acceleration"]), (&json!(0.5), &json!(2.0)));
    assert_eq!(joints[2]["pitch"], 0.02);
    assert_eq!(joints[3]["coordinates"], json!(["c.angle", "c.slide"]));
    assert_eq!(joints[3]["unit"], json!(["rad", "m"]));
    assert_eq!(joints[3]["limits"], json!([[-PI / 2.0, PI / 2.0], [-0.01, 0.01]]));
    assert_eq!(
        (&joints[4]["axis2"], &joints[4]["home"]),
        (&json!([0.0, 1.0, 0.0]), &json!([0.0, PI]))
    );
    assert_eq!(joints[5]["axis"], Value::Null);
    assert_eq!(joints[5]["limits"], json!([null, null, null]));
    assert_eq!(joints[5]["leg"], "two");
}

#[test]
fn the_helical_manipulator() {
    let found = decompose(HELICAL);
    let counts = ["lambda", "mobility", "imaginary_joints", "first_section_motions"];
    assert_eq!(counts.map(|key| found[key].as_u64().unwrap()), [3, 3, 1, 2]);
    assert_eq!(found["lower"]["subspace"], "translational plane");
    assert_eq!(found["upper"]["subspace"], "cylindrical");
    assert_eq!(found["intersection"]["kind"], "translation");
    assert_eq!(found["intersection"]["point"], Value::Null);
    // The common axis of the R and H joints is at 255 degrees; its direction may point either way.
    let axis = found["intersection"]["axis"].as_array().unwrap();
    let (sin, cos) = 255.0_f64.to_radians().sin_cos();
    assert!((number(&axis[0]) * sin - number(&axis[1]) * cos).abs() < EXACT);
    let imaginary: Vec<&Value> =
        found["legs"].as_array().unwrap().iter().map(|leg| &leg["imaginary"]).collect();
    assert_eq!(imaginary, [&json!("S"), &Value::Null, &Value::Null]);
}

#[test]
fn a_joint_list_has_default_names() {
    let found = decompose(&format!("{PLANO}-joints"));
    assert_eq!(found["legs"][0]["imaginary"], "tau.leg1");
    assert_eq!(found["legs"][0]["lower"], json!(["S1", "phi11", "phi21"]));
}

#[test]
fn the_text_explains_and_says_what_has_no_closed_form() {
    let run = opm(&["decompose", "bennett-double-spherical-6r"]);
    let text = run.text();
    for part in ["lambda = 5", "N = 1", "J = 1", "M = N - J = 1 - 1 = 0", "(200, 0, 0) mm"] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    assert!(run.stderr.contains("no closed-form inverse kinematics"), "{}", run.stderr);
    let quiet = opm(&["decompose", "bennett-double-spherical-6r", "--quiet"]);
    assert_eq!((quiet.text(), &*quiet.stderr), (text, ""));
}

/// Three legs like the helical manipulator's first two, but the first has its slider along the
/// cylinder's axis and its rotation about it as one cylindrical joint, which can be divided.
#[test]
fn a_divided_joint_goes_by_its_coordinates() {
    let folder = Folder::new();
    let leg = |name: &str, slider: [f64; 2]| {
        format!(
            "[[leg]]\nname = \"{name}\"\njoints = [\n\
             {{ name = \"S{name}\", type = \"prismatic\", axis = [{}, {}, 0], actuated = true }},\n\
             {{ name = \"C{name}\", type = \"cylindrical\", axis = [0, 1, 0], point = [0, 0, 0] }},\n]\n",
            slider[0], slider[1]
        )
    };
    let helical = "[[leg]]\nname = \"H\"\njoints = [\n\
         { name = \"S3\", type = \"prismatic\", axis = [1, 0, 0] },\n\
         { name = \"S4\", type = \"prismatic\", axis = [0, 1, 0], actuated = true },\n\
         { name = \"h\", type = \"helical\", axis = [0, 1, 0], point = [0, 0, 0], pitch = 0.02, \
         actuated = true },\n]\n";
    let head = "format = 1\nname = \"divided\"\nunits = { length = \"m\", angle = \"rad\" }\n\
         [platform]\npoint = [0, 0, 0]\n";
    let text = format!("{head}{}{}{helical}", leg("A", [1.0, 0.0]), leg("B", [1.0, 0.5]));
    let file = folder.write("divided.toml", text);
    let found = decompose(&file);
    let first = &found["legs"][0];
    assert_eq!(first["lower"], json!(["SA", "CA.slide"]), "{found}");
    assert_eq!(first["upper"], json!(["CA.angle"]), "{found}");
}

/// A shipped mechanism with a `[task]`, and its frames as they are printed: the directions of the
/// file, and home's values measured with them.
#[test]
fn frames_are_printed_and_can_be_set() {
    let folder = Folder::new();
    let shipped = opm(&["examples", "translational-planar-4dof"]).text().to_owned();
    let task = "[task]\naxis = [0, -2, 0]\n\
         lower = { x = [0, 1, 0], normal = [0, 0, -1], origin = [100, 0, 0] }\n\
         upper = { w = [0, 0, -1], normal = [-3, 0, 0], origin = [0, 0, 50] }\n\n[platform]";
    let file = folder.write("framed.toml", shipped.replacen("[platform]", task, 1));
    let found = decompose(&file);
    assert_eq!(found["intersection"]["axis"], json!([0.0, -1.0, 0.0]));
    let numbers = |value: &Value| -> Vec<f64> {
        let rows = value.as_array().unwrap().iter();
        rows.flat_map(|row| row.as_array().unwrap()).map(number).collect()
    };
    let near = |value: &Value, expected: [[f64; 3]; 3]| {
        let pairs = numbers(value).into_iter().zip(expected.concat());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < EXACT
    };
    let frames = &found["frames"];
    assert!(
        near(&frames["lower"]["axes"], [[0., 1., 0.], [1., 0., 0.], [0., 0., -1.]]),
        "{frames}"
    );
    assert!(near(&frames["upper"]["axes"], [[0., 1., 0.], [0., 0., -1.], [-1., 0., 0.]]));
    assert_eq!(frames["lower"]["origin"], json!([0.1, 0.0, 0.0]));
    assert_eq!(frames["upper"]["origin"], json!([0.0, 0.0, 0.05]));
    assert_eq!(frames["lower"]["centre"], json!([0.0, 0.0, 0.3]));
    let home: Vec<f64> = found["task_coordinates"]
        .as_array()
        .unwrap()
        .iter()
        .map(|coordinate| number(&coordinate["home"]))
        .collect();
    // The platform stands at (0, 0, 300): x is base y, y base x less 100, w down from 50.
    for (home, expected) in home.iter().zip([0.0, -0.1, -0.25, 0.0]) {
        assert!((home - expected).abs() < EXACT, "{home} {expected}");
    }
    let text = opm(&["decompose", &file, "--quiet"]).text().to_owned();
    for part in ["lower  (100, 0, 0)", "(0, 0, 300)", "(0, 0, -1)", "origin, mm"] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
}

/// Every subcommand checks a `[task]` against the geometry, and reports errors at their line and
/// column.
#[test]
fn frames_that_do_not_fit_are_refused_where_they_stand() {
    let folder = Folder::new();
    let pairs = [
        ("translational-planar-4dof", "upper = { ^w = [1, 0, 0] }", "expected (0.000000, 0.0000"),
        ("translational-planar-4dof", "upper = { ^x = [0, 1, 0] }", "has w, normal, origin to"),
        (
            "translational-planar-4dof",
            "lower = { ^x = [0, 1, 1] }",
            "perpendicular to (0.000000, 0.000",
        ),
        ("translational-planar-4dof", "lower = { ^normal = [0, 1, 0] }", "is (0.000000, 1.000000"),
        (
            "translational-planar-4dof",
            "^axis = [1, 0, 0]",
            "perpendicular to the intersection motion",
        ),
        ("double-spherical-5dof", "lower = { ^x = [1, 0, 1] }", "[task] lower.x is (0.707107"),
        (
            "double-spherical-5dof",
            "lower = { ^origin = [1, 0, 1] }",
            "this spherical subspace has x",
        ),
        ("plano-cylindrical-4dof", "upper = { ^origin = [1, 0, 1] }", "has nothing to choose"),
        ("schoenflies-4dof", "lower = { ^normal = [0, 0, 1] }", "has x, origin to choose"),
        ("schoenflies-4dof", "upper = { ^x = [1, 0, 0] }", "this cylindrical subspace has origin"),
    ];
    for (name, task, message) in pairs {
        let shipped = opm(&["examples", name]).text().to_owned();
        // The marker is before the key; the position in the message is that of the value.
        let plain = task.replace('^', "");
        let head = format!("[task]\n{plain}\n\n[platform]");
        let text = shipped.replacen("[platform]", &head, 1);
        let line = text[..text.find(&plain).unwrap()].matches('\n').count() + 1;
        let key = task.find('^').unwrap();
        let column = key + plain[key..].find("= ").unwrap() + 3;
        let file = folder.write("bad.toml", text);
        let place = format!("bad.toml:{line}:{column}: [task]");
        for command in [&["decompose", &file][..], &["ik", &file, "--pose", ""]] {
            opm(command).fails_with_one_line(1, &[&place, message]);
        }
    }
}

/// A Gough platform as a mechanism file.
fn gough() -> String {
    let mut text = "format = 1\nname = \"gough\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
                    [platform]\npoint = [0, 0, 600]\n"
        .to_owned();
    for i in 0..6 {
        let number = f64::from(i);
        let side = if i % 2 == 0 { -1.0 } else { 1.0 };
        let pair = f64::from(i / 2) * 120.0;
        let around = |angle: f64, radius: f64| {
            let angle = angle.to_radians();
            [radius * angle.cos(), radius * angle.sin()]
        };
        let foot = around(pair + 15.0 * side, 500.0);
        let top = around(pair + 45.0 * side + 3.0 * number, 250.0);
        let strut = [top[0] - foot[0], top[1] - foot[1], 600.0];
        text += &format!(
            "[[leg]]\njoints = [\n\
             {{ name = \"u{i}\", type = \"universal\", axis = [{}, {}, 0], axis2 = [{}, {}, 1], point = [{}, {}, 0] }},\n\
             {{ name = \"p{i}\", type = \"prismatic\", axis = [{}, {}, 600], actuated = true }},\n\
             {{ name = \"s{i}\", type = \"spherical\", point = [{}, {}, 600] }},\n]\n",
            -strut[1],
            strut[0],
            -600.0 * strut[0] / (strut[0].powi(2) + strut[1].powi(2)),
            -600.0 * strut[1] / (strut[0].powi(2) + strut[1].powi(2)),
            foot[0],
            foot[1],
            strut[0],
            strut[1],
            top[0],
            top[1],
        );
    }
    text
}

/// It has no sections: each leg is solved by itself, and every command takes it.
#[test]
fn a_gough_platform_is_solved_leg_by_leg() {
    let folder = Folder::new();
    let file = folder.write("gough.toml", gough());
    let run = opm(&["decompose", &file]);
    let text = run.text();
    for part in [
        "lambda = 6, mobility N = 6",
        "translations and rotations of space",
        "Every leg is solved by itself, one joint after the other",
        "roll, pitch and yaw: R = Rz(yaw) Ry(pitch) Rx(roll)",
        "2^12 working modes",
    ] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    assert_eq!(run.stderr, "");
    let found = decompose(&file);
    assert_eq!(found["applies"], json!("every leg"));
    assert_eq!(found["platform"]["kind"], json!("free"));
    let names: Vec<_> =
        found["task_coordinates"].as_array().unwrap().iter().map(|c| &c["name"]).collect();
    assert_eq!(names, ["x", "y", "z", "roll", "pitch", "yaw"]);
    let leg = &found["legs"][0];
    assert_eq!((&leg["solved"], &leg["upper"]), (&json!("whole"), &json!([])));
    assert_eq!(leg["kernels"][0]["root"], json!("quadratic"));
    assert_eq!(leg["kernels"][0]["invariant"], json!("distance"));
    let choices =
        leg["kernels"].as_array().unwrap().iter().filter(|kernel| kernel["choice"] == true);
    assert_eq!(choices.count(), 2, "two signs for each leg");
    assert!(text.contains("p0±"), "{text}");
    opm(&["ik", &file, "--pose", "x=1mm"]).text();
    let over = ["--over", "z=0.1:1", "--tolerance", "0.001"];
    let found = opm(&[&["measure", &file, "--format", "json"][..], &over].concat()).json();
    let [least, most] = ["lower", "upper"].map(|end| found[end].as_f64().unwrap());
    assert!(0.0 < least && most < 1.001 * least, "{found}");
    opm(&["generate", "c", &file, "-o", &folder.arg("code")]).text();
}

/// Without motors, or with too few or too many, the sections come first and a warning after them.
#[test]
fn actuators_are_a_warning() {
    let folder = Folder::new();
    let shipped = opm(&["examples", "plano-spherical-5dof-joints"]).text().to_owned();
    let none = shipped.replace(", actuated = true", "");
    let few = shipped.replacen(", actuated = true", "", 1);
    let many = shipped.replacen("type = \"spherical\"", "type = \"spherical\", actuated = true", 1);
    for (name, text, told) in [
        (
            "none.toml",
            none,
            "no joint is actuated, expected `actuated = true` in at least one; the mobility is N = 5",
        ),
        ("few.toml", few, "control 4 of the 5 freedoms"),
        ("many.toml", many, "the actuators are redundant: 8 actuated freedoms for 5"),
    ] {
        let file = folder.write(name, text);
        let run = opm(&["decompose", &file]);
        assert!(run.text().contains("lower section   planar"), "{}", run.stdout);
        assert!(run.stderr.contains("warning: ") && run.stderr.contains(told), "{}", run.stderr);
        let found = decompose(&file);
        let warnings = found["warnings"].as_array().unwrap();
        assert!(warnings.iter().any(|w| w.as_str().unwrap().contains(told)), "{found}");
        assert_eq!(found["lower"]["subspace"], "planar");
    }
    opm(&["ik", &folder.arg("none.toml"), "--pose", ""])
        .fails_with_one_line(1, &["no joint is actuated"]);
    opm(&["ik", &folder.arg("few.toml"), "--pose", ""])
        .fails_with_one_line(1, &["control 4 of the 5"]);
}

/// A five-bar in inches whose forearms are in line at home. Every command tells it in one line, in the file's units, and
/// does its work; `fk` at home, too, and what asks about rates there says so.
#[test]
fn a_parallel_singularity_at_home_is_one_warning() {
    let folder = Folder::new();
    let joint = |name: &str, point: &str, actuated: bool| {
        format!(
            "{{ name = \"{name}\", type = \"revolute\", axis = [0, 0, 1], point = {point}, actuated = {actuated} }}"
        )
    };
    let text = format!(
        "format = 1\nname = \"flat\"\nunits = {{ length = \"in\", angle = \"deg\" }}\n[platform]\npoint = [8, 2, 0]\n\
         [[leg]]\njoints = [{}, {}, {}]\n[[leg]]\njoints = [{}, {}]\n",
        joint("L", "[0, 0, 0]", true),
        joint("LE", "[2, 2, 0]", false),
        joint("pen", "[8, 2, 0]", false),
        joint("R", "[16, 0, 0]", true),
        joint("RE", "[14, 2, 0]", false),
    );
    let file = folder.write("flat.toml", text.clone());
    let told = "home pose is a parallel singularity";
    let loose = "rotation about (0, 0, 1) through (14, 2, 0) in";
    for (line, code) in [
        ("decompose FILE", 0),
        ("ik FILE --pose x=7.85in", 0),
        ("ik FILE --pose x=7.85in --all-modes", 0),
        ("fk FILE --joints L=45deg,R=0deg", 0),
        ("velocity FILE --pose x=7.5in", 0),
        ("workspace FILE --grid x=7in:8in:3 --grid y=1in:2in:3", 0),
        ("convert FILE", 0),
        ("check FILE --samples 5", 0),
    ] {
        let words: Vec<&str> =
            line.split(' ').map(|word| if word == "FILE" { &*file } else { word }).collect();
        let run = opm(&words);
        assert_eq!(run.code, Some(code), "{line}: {}", run.stderr);
        assert_eq!(run.stderr.matches("warning: ").count(), 1, "{line}: {}", run.stderr);
        assert!(run.stderr.contains(told) && run.stderr.contains(loose), "{line}: {}", run.stderr);
        assert!(!run.stdout.contains("could be left out"), "{}", run.stdout);
    }
    let found = decompose(&file);
    assert_eq!((&found["mobility"], found["warnings"].as_array().unwrap().len()), (&json!(2), 1));
    // With one motor alone, the platform is loose everywhere: one other warning, with its verb in the singular.
    let few = folder.write(
        "few.toml",
        text.replace("point = [16, 0, 0], actuated = true", "point = [16, 0, 0]"),
    );
    let run = opm(&["decompose", &few]);
    assert_eq!(run.stderr.matches("warning: ").count(), 1, "{}", run.stderr);
    assert!(
        run.stderr.contains("1 actuated freedom controls 1 of the 2 freedoms"),
        "{}",
        run.stderr
    );
    assert!(run.stderr.contains(" in") && !run.stderr.contains(") m"), "{}", run.stderr);
}

/// One axis passes the centre at half a millimetre.
#[test]
fn a_joint_that_is_nearly_right_is_named_and_can_be_snapped() {
    let folder = Folder::new();
    let shipped = opm(&["examples", "plano-spherical-5dof-joints"]).text().to_owned();
    let line = shipped.lines().find(|line| line.contains("\"theta32\"")).unwrap();
    let moved = line.replace("point = [0, 0, 0]", "point = [0.4330127, 0.25, 0]");
    assert_ne!(line, moved);
    let file = folder.write("off.toml", shipped.replace(line, &moved));
    let miss = "joint theta32 of leg leg2: its axis passes the centre of the others at 0.50 mm";
    let hint = "--tolerance 0.51mm accepts and snaps it";

    let run = opm(&["decompose", &file]);
    for part in ["nearly two subspaces", "planar, normal (0, 0, 1)", miss, hint] {
        assert!(run.text().contains(part), "no {part:?} in\n{}", run.text());
    }
    let found = decompose(&file);
    assert_eq!(found["applies"], "nearly");
    let joint = &found["nearly"]["joints"][0];
    assert_eq!((&joint["leg"], &joint["joint"]), (&json!("leg2"), &json!("theta32")));
    assert!((number(&joint["distance"]) - 0.5e-3).abs() < 1e-8, "{joint}");
    opm(&["ik", &file, "--pose", ""]).fails_with_one_line(1, &["off.toml:", miss, hint]);

    let snapped = opm(&["decompose", &file, "--tolerance", "0.51mm"]);
    for part in ["upper section   spherical", "snapped by --tolerance: 1 joint", miss] {
        assert!(snapped.text().contains(part), "no {part:?} in\n{}", snapped.text());
    }
    let found = opm(&["decompose", &file, "--tolerance", "0.51mm", "--format", "json"]).json();
    assert_eq!(found["snapped"][0]["joint"], "theta32");
    assert_eq!(found["warnings"], json!([]));
    let run = opm(&["ik", &file, "--tolerance", "1mm", "--pose", "x=10mm", "--format", "json"]);
    assert_eq!(run.json()["reachable"], true);
    assert!(run.stderr.contains("snapped joint theta32"), "{}", run.stderr);
    let plain = opm(&["ik", "plano-spherical-5dof-joints", "--pose", "x=10mm", "--format", "json"]);
    let joint = |run: &crate::run::Run| number(&run.json()["solutions"][0]["joints"]["S2"]);
    assert!((joint(&run) - joint(&plain)).abs() < 1e-12);
    let args = ["measure", &file, "--joint-tolerance", "1mm", "--section", "upper", "--quiet"];
    opm(&[&args[..], &["--tolerance", "0.3"]].concat()).text();

    let too_small = opm(&["decompose", &file, "--tolerance", "0.4mm"]);
    assert!(too_small.text().contains("nearly two subspaces"), "{}", too_small.text());
    assert!(too_small.text().contains("snapped by --tolerance: none"));
    for bad in ["0", "-1mm", "1deg"] {
        opm(&["decompose", &file, "--tolerance", bad]).fails_with_one_line(2, &["--tolerance"]);
    }
}

/// A recording holds the mechanism that was computed with: it needs no tolerance any more.
#[test]
fn a_recording_holds_the_snapped_mechanism() {
    let folder = Folder::new();
    let shipped = opm(&["examples", "plano-spherical-5dof-joints"]).text().to_owned();
    let file = folder.write(
        "off.toml",
        shipped.replace("point = [0, 0, 0], home = 117", "point = [0.1, 0, 0], home = 117"),
    );
    let part = folder.arg("part.mcap");
    let grid = ["--grid", "x=-10mm:10mm:3", "--tolerance", "1mm", "--quiet"];
    let shard = ["workspace", &file, "--shard", "1/1", "-o", &part];
    opm(&[&shard[..], &grid].concat()).text();
    let merged = opm(&["merge", &part, "--format", "json"]).json();
    let whole = opm(&[&["workspace", &file, "--format", "json"][..], &grid].concat()).json();
    assert_eq!(merged["reachable"], whole["reachable"]);
}

#[test]
fn a_constraining_leg_is_named() {
    let found = opm(&["decompose", "five-bar", "--format", "json"]).json();
    let names = |key: &str| -> Vec<String> {
        let list = found[key].as_array().unwrap().iter();
        list.map(|c| c["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names("task_coordinates"), ["x", "y"]);
    assert_eq!(names("dependent_coordinates"), ["theta"]);
    let run = opm(&["decompose", "five-bar"]);
    let told = "right has too few freedoms to follow every motion: a pose is given by x y, and theta \
                follows from it.";
    assert!(run.text().contains(told), "{}", run.stdout);
    let run = opm(&["velocity", "five-bar"]);
    assert!(run.stdout.contains("theta"), "{}", run.stdout);
}

/// J is no number of joints: with one imaginary joint the upper section may have two motions, and with four it may have three.
#[test]
fn one_is_not_many() {
    for (name, joints, motions, told) in [
        ("schoenflies-lift-4dof", 1, 2, "with the imaginary joints locked, 1 motion is left."),
        ("translational-planar-4dof", 4, 3, "Of the imaginary joints, 1 is redundant."),
    ] {
        let found = opm(&["decompose", name, "--format", "json"]).json();
        let legs = found["legs"].as_array().unwrap();
        let named = legs.iter().filter(|leg| !leg["imaginary"].is_null()).count();
        assert_eq!((named, &found["imaginary_joints"]), (joints, &motions.into()));
        let run = opm(&["decompose", name]);
        assert!(run.text().contains(told), "{}", run.stdout);
    }
}

/// A four-bar is solved with the link behind its motor as the platform, whichever leg that is in; a note says so. A conversion
/// keeps the platform of the file.
#[test]
fn a_loop_has_another_platform_where_its_coupler_has_no_closed_form() {
    let folder = Folder::new();
    let joint = |name: &str, x: f64, y: f64| {
        let motor = if name == "M" { ", actuated = true" } else { "" };
        format!(
            "{{ name = \"{name}\", type = \"revolute\", axis = [0, 0, 1], point = [{x:?}, {y:?}, 0]{motor} }}"
        )
    };
    let leg = |name: &str, joints: [String; 2]| {
        format!("[[leg]]\nname = \"{name}\"\njoints = [\n{}\n]\n", joints.join(",\n"))
    };
    let crank = leg("crank", [joint("M", 0.0, 0.0), joint("A", 30.0, 80.0)]);
    let rocker = leg("rocker", [joint("B", 150.0, 0.0), joint("C", 170.0, 110.0)]);
    let head = "format = 1\nname = \"four-bar\"\nunits = { length = \"mm\", angle = \"deg\" }\n[platform]\npoint = [100, 100, 0]\n";
    for (legs, passed) in [([&crank, &rocker], ["M", "B C A"]), ([&rocker, &crank], ["B C A", "M"])]
    {
        let text = format!("{head}{}{}", legs[0], legs[1]);
        let file = folder.write("four-bar.toml", text);
        let run = opm(&["decompose", &file]);
        assert!(
            run.stderr.contains("the link behind M is taken as the platform"),
            "{}",
            run.stderr
        );
        let found = decompose(&file);
        let of_leg = |leg: &Value| {
            let joints = leg["lower"].as_array().unwrap().iter();
            joints.map(|name| name.as_str().unwrap()).collect::<Vec<_>>().join(" ")
        };
        let listed: Vec<String> = found["legs"].as_array().unwrap().iter().map(of_leg).collect();
        assert_eq!(listed, passed);
        assert_eq!(found["task_coordinates"][0]["name"], "theta");
        let converted = folder.arg(&format!("{}.toml", passed[0].len()));
        opm(&["convert", &file, "-o", &converted]).text();
        let converted = std::fs::read_to_string(converted).unwrap();
        let [first, second] = ["crank", "rocker"].map(|leg| {
            let own = converted.split("[[leg]]").find(|text| text.contains(leg)).unwrap();
            own.matches("type = \"revolute\"").count()
        });
        assert_eq!([first, second], [2, 2], "{converted}");
    }
}

/// The report ends with commands for this very mechanism, which work as they are typed.
#[test]
fn the_next_commands_work() {
    let folder = Folder::new();
    let text = opm(&["examples", "stewart"]).stdout;
    let file = folder.write("it's mine.toml", &text);
    for args in [
        &["decompose", &file][..],
        &["decompose", "delta", "--set", "rod=1.2,rp=50mm"],
        &["decompose", PLANO, "--coordinates", "tilt-torsion", "--tolerance", "0.5mm"],
        &["decompose", "bennett-double-spherical-6r"],
    ] {
        let report = opm(args);
        let (_, next) = report.text().split_once("\nnext:\n").expect("commands");
        assert!(next.lines().count() >= 2, "{next}");
        for line in next.lines() {
            let (command, _) = line.trim().split_once("  ").expect("what it does");
            let program = env!("CARGO_BIN_EXE_opm");
            let command = command.replacen("opm", program, 1);
            let run = std::process::Command::new("sh")
                .args(["-c", &command])
                .current_dir(folder.path("."))
                .output()
                .unwrap();
            assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
            let told = String::from_utf8_lossy(&run.stdout);
            assert!(!told.contains("out of reach"), "{command}: {told}");
        }
    }
    // What came through a pipe cannot be read again.
    assert!(!opm_reading(&text, &["decompose", "-"]).text().contains("next:"));
}
