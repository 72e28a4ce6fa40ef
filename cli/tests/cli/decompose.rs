//! `opm decompose` agrees with the paper about its mechanisms.

use crate::run::{Folder, keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::{Value, json};

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
        "imaginary_joints",
        "first_section_motions",
        "lower",
        "upper",
        "intersection",
        "task_coordinates",
        "legs",
        "frames",
    ];
    assert_eq!(keys(&found), expected, "its decomposition is unique: no alternatives");
    assert_eq!(found["name"], PLANO);
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
    });
    assert_eq!(legs[0], prr);
    assert_eq!(legs[3]["lower"], json!(["phi14", "phi24"]));
    assert_eq!(legs[3]["imaginary"], Value::Null);
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
    assert_eq!(frames["lower"]["reference"], json!([0.0, 0.0, 0.3]));
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
