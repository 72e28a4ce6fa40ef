//! `opm velocity`.

use crate::run::{keys, number, opm};
use crate::{HELICAL, PLANO};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

/// Differences of step 1e-4 s, to the fourth order.
const STEP: f64 = 1e-4;
const DIFFERENCED: f64 = 1e-8;
/// Differences of step 1e-4 s, to the second order: third derivatives are below ten.
const TWIST: f64 = 1e-7;

fn velocity(args: &[&str]) -> Value {
    opm(&[&["velocity"], args, &["--format", "json"]].concat()).json()
}

#[test]
fn the_json_is_one_object_with_these_keys() {
    let found = velocity(&[PLANO, "--pose", "x=10mm,xi=15deg", "--rates", "zeta=1,x=10mm"]);
    let expected = [
        "pose",
        "mode",
        "rates",
        "reachable",
        "joint_rates",
        "imaginary_rates",
        "jacobian",
        "twist",
        "twist_jacobian",
        "transform",
        "singularity",
    ];
    assert_eq!(keys(&found), expected);
    assert_eq!(keys(&found["rates"]), ["x", "y", "zeta", "xi", "psi"]);
    assert_eq!(number(&found["rates"]["x"]), 0.01);
    assert_eq!(number(&found["rates"]["zeta"]), 1.0);
    assert_eq!(number(&found["rates"]["psi"]), 0.0);
    assert_eq!(found["mode"], "++ ++ ++ +");
    assert_eq!(keys(&found["imaginary_rates"]), ["theta11", "theta12", "theta13"]);
    let jacobian = &found["jacobian"];
    assert_eq!(keys(jacobian), ["rows", "columns", "values"]);
    assert_eq!(jacobian["rows"], serde_json::json!(["S1", "S2", "S3", "phi14", "phi24"]));
    assert_eq!(jacobian["columns"], serde_json::json!(["x", "y", "zeta", "xi", "psi"]));
    for key in ["upper_serial", "upper_parallel", "lower_serial", "lower_parallel", "condition"] {
        assert!(number(&found["singularity"][key]).is_finite(), "{key}");
    }
    // The rates are the Jacobian's: column x times 0.01 m/s, column zeta times 1 rad/s.
    for (row, name) in jacobian["rows"].as_array().unwrap().iter().enumerate() {
        let values = &jacobian["values"][row];
        let rate = 0.01 * number(&values[0]) + number(&values[2]);
        let found = number(&found["joint_rates"][name.as_str().unwrap()]);
        assert!((rate - found).abs() < 1e-12, "{name}: {rate} {found}");
    }
}

/// The twist is the difference of the platform's transforms before and after, also where coordinates depend on others.
#[test]
fn the_twist_is_that_of_the_transform() {
    for (file, pose, rates) in [
        (PLANO, "x=0.01,y=-0.02,zeta=0.3,xi=0.2,psi=-0.1", "x=0.1,y=-0.2,zeta=1,xi=0.5,psi=-0.7"),
        (HELICAL, "x=0.002,y=-0.01,phi=0.4", "x=0.1,y=-0.2,phi=0.7"),
        ("five-bar", "x=0.01,y=0.33", "x=0.3,y=-0.2"),
        ("schoenflies-lift-4dof", "", "x=0.3,z=-0.2"),
    ] {
        let moved = |sign: f64| {
            let parse = |text: &str| -> Vec<(String, f64)> {
                let parts = text.split(',').filter_map(|part| part.split_once('='));
                parts.map(|(name, value)| (name.to_owned(), value.parse().unwrap())).collect()
            };
            let mut at = parse(pose);
            for (name, rate) in parse(rates) {
                match at.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, value)) => *value += sign * STEP * rate,
                    None => {
                        let found = &velocity(&[file])["pose"][&name];
                        at.push((name, number(found) + sign * STEP * rate));
                    }
                }
            }
            let at: Vec<String> = at.iter().map(|(name, v)| format!("{name}={v:?}")).collect();
            let found = velocity(&[file, "--pose", &at.join(",")]);
            let q: Vec<f64> =
                (0..4).map(|i| number(&found["transform"]["quaternion"][i])).collect();
            let p: Vec<f64> = (0..3).map(|i| number(&found["transform"]["position"][i])).collect();
            (
                UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3])),
                Vector3::from_vec(p),
            )
        };
        let found = velocity(&[file, "--pose", pose, "--rates", rates]);
        let (before, after) = (moved(-1.0), moved(1.0));
        let spin = (after.0 * before.0.inverse()).scaled_axis() / (2.0 * STEP);
        let way = (after.1 - before.1) / (2.0 * STEP);
        let names = ["wx", "wy", "wz", "vx", "vy", "vz"];
        for (name, known) in names.iter().zip(spin.iter().chain(&way)) {
            let twist = number(&found["twist"][*name]);
            assert!((twist - known).abs() < TWIST, "{file} {name}: {twist} {known}");
        }
        let jacobian = &found["twist_jacobian"];
        assert_eq!(keys(jacobian), ["rows", "columns", "frame", "point", "values"]);
        assert_eq!(jacobian["rows"], serde_json::json!(names));
        assert_eq!((&jacobian["frame"], &jacobian["point"]), (&"base".into(), &"platform".into()));
        for (row, name) in names.iter().enumerate() {
            let columns = jacobian["columns"].as_array().unwrap().iter().enumerate();
            let sum: f64 = columns
                .map(|(i, column)| {
                    let rate = number(&found["rates"][column.as_str().unwrap()]);
                    number(&jacobian["values"][row][i]) * rate
                })
                .sum();
            assert!((sum - number(&found["twist"][*name])).abs() < 1e-12, "{file} {name}");
        }
    }
}

/// Every rate is the difference of what `opm ik` gives before and after.
#[test]
fn rates_are_those_of_inverse_kinematics() {
    for (file, pose, rates, mode) in [
        (PLANO, [0.01, -0.02, 0.3, 0.2, -0.1], [0.1, -0.2, 1.0, 0.5, -0.7], "-+ +- ++ -"),
        (PLANO, [0.0, 0.02, -0.3, -0.2, 0.4], [-0.1, 0.3, 0.2, -0.5, 0.1], "home"),
    ] {
        let names = ["x", "y", "zeta", "xi", "psi"];
        let joined = |values: &[f64]| {
            let parts = names.iter().zip(values).map(|(name, value)| format!("{name}={value:?}"));
            parts.collect::<Vec<_>>().join(",")
        };
        let at = |t: f64| {
            let moved: Vec<f64> = pose.iter().zip(rates).map(|(q, r)| q + t * r).collect();
            let pose = joined(&moved);
            let found =
                opm(&["ik", file, "--pose", &pose, "--mode", mode, "--format", "json"]).json();
            found["solutions"][0].clone()
        };
        let positions = [-2.0, -1.0, 1.0, 2.0].map(|steps| at(steps * STEP));
        let found =
            velocity(&[file, "--pose", &joined(&pose), "--rates", &joined(&rates), "--mode", mode]);
        for (kind, of) in [("joint_rates", "joints"), ("imaginary_rates", "imaginary")] {
            let names = keys(&found[kind]);
            assert_eq!(names, keys(&positions[0][of]));
            for name in names {
                let [far, near, ahead, beyond] =
                    [0, 1, 2, 3].map(|i| number(&positions[i][of][name]));
                let known = (8.0 * (ahead - near) - (beyond - far)) / (12.0 * STEP);
                let rate = number(&found[kind][name]);
                assert!((rate - known).abs() < DIFFERENCED, "{file} {name}: {rate} {known}");
            }
        }
    }
}

/// Eq. 29, without the divisor that the print has: `n(alpha) . P + sin(beta) p phi`.
#[test]
fn the_second_manipulators_jacobian_is_constant() {
    let rows = [(210.0_f64, 45.0_f64, 0.02), (330.0, 285.0, 0.0), (90.0, 165.0, 0.0)];
    for pose in ["", "x=20mm,y=-5mm,phi=2"] {
        let found = velocity(&[HELICAL, "--pose", pose, "--rates", "phi=90deg"]);
        for (i, (alpha, beta, pitch)) in rows.iter().enumerate() {
            let (sin, cos) = alpha.to_radians().sin_cos();
            let known = [-sin, cos, beta.to_radians().sin() * pitch];
            for (j, known) in known.iter().enumerate() {
                let found = number(&found["jacobian"]["values"][i][j]);
                assert!((found - known).abs() < 1e-12, "{i} {j}: {found} {known}");
            }
        }
        let rate = number(&found["imaginary_rates"]["S"]);
        assert!((rate - 0.02 * std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}

/// At home the Euler angles are singular (`xi = 0`) and the mechanism is not.
#[test]
fn singular_coordinates_are_no_singularity() {
    let found = velocity(&[PLANO]);
    let singularity = &found["singularity"];
    assert_eq!(number(&singularity["coordinates"]), 0.0);
    assert!(number(&singularity["condition"]) < 10.0);
    assert!(number(&singularity["upper_parallel"]).abs() > 0.1);
    let values = found["jacobian"]["values"].as_array().unwrap();
    assert!(values.iter().all(|row| (number(&row[2]) - number(&row[4])).abs() < 1e-12));
    assert!(opm(&["velocity", PLANO]).text().contains("the pose's coordinates are singular here"));
}

/// D is at (0, 75) mm and the arm's links are 100 mm: at (0, -125) it is stretched.
#[test]
fn a_stretched_arm_has_no_rates_and_the_others_have_theirs() {
    let pose = ["--pose", "y=-125mm", "--rates", "y=1,zeta=1", "--length", "100mm"];
    let found = velocity(&[&[PLANO], &pose[..]].concat());
    assert!(found["joint_rates"]["phi14"].is_null() && found["joint_rates"]["phi24"].is_null());
    assert!(found["joint_rates"]["s4.x"].is_null(), "it is solved after the arm");
    assert!(number(&found["joint_rates"]["S1"]).abs() > 0.01);
    assert!(number(&found["imaginary_rates"]["theta11"]).abs() > 0.01);
    let singularity = &found["singularity"];
    assert!(number(&singularity["lower_serial"]).abs() < 1e-6);
    assert!(number(&singularity["upper_serial"]).abs() > 0.1);
    assert!(singularity["condition"].is_null());
    assert_eq!(number(&singularity["manipulability"]), 0.0);
    assert_eq!(number(&singularity["length"]), 0.1);
    assert_eq!(singularity["nearest"]["lower_serial"], serde_json::json!(["leg4"]));
    let rows = found["jacobian"]["values"].as_array().unwrap();
    assert!(rows[3].as_array().unwrap().iter().all(Value::is_null));
    let text = opm(&[&["velocity", PLANO], &pose[..]].concat());
    for part in ["condition number infinite", "leg4: lower section without rates", " -  deg/s"] {
        assert!(text.text().contains(part), "{part}: {}", text.stdout);
    }
}

#[test]
fn out_of_reach_is_an_answer() {
    let found = velocity(&[PLANO, "--pose", "x=1"]);
    assert_eq!(found["reachable"], false);
    for key in ["joint_rates", "imaginary_rates", "jacobian", "singularity"] {
        assert!(found[key].is_null(), "{key}");
    }
    let solved = opm(&["ik", PLANO, "--pose", "x=1", "--format", "json"]).json();
    assert_eq!(found["unreachable"], solved["unreachable"]);
    assert_eq!(found["unreachable"][2]["leg"], "leg4");
    let text = opm(&["velocity", PLANO, "--pose", "x=1"]);
    assert!(
        text.text().contains("leg4: lower section out of reach by 802.809 mm"),
        "{}",
        text.stdout
    );
}

#[test]
fn text_is_in_the_units_of_the_file() {
    let text = opm(&["velocity", HELICAL, "--rates", "phi=180deg"]);
    let line = |name: &str| {
        let mut lines = text.text().lines().filter(|line| line.contains(name));
        lines.next().unwrap_or_else(|| panic!("{name}: {}", text.stdout)).to_owned()
    };
    assert!(line("imaginary").contains("62.832  mm/s"), "20 mm/rad, half a turn a second");
    assert!(line("phi1 ").contains("180.0000  deg/s"), "{}", text.stdout);
    // 20 mm/rad times sin 45 degrees, per degree.
    assert!(line("S1 [mm]").ends_with("0.2468"), "{}", text.stdout);
}

#[test]
fn wrong_usage_names_the_flag() {
    let enormous = "x=1e70,y=1e70,phi=1e70";
    for (flags, parts) in [
        (&["--rates", "x"][..], &["--rates", "expected NAME=VALUE"][..]),
        (&["--rates", "x=1,x=2"], &["--rates", "x is given twice"]),
        (&["--rates", "yaw=1"], &["--rates", "\"yaw\"", "x, y, phi"]),
        (&["--rates", "x=1deg"], &["--rates", "x is a length"]),
        (&["--rates", "phi=1mm"], &["--rates", "phi is an angle"]),
        (&["--rates", "phi=nan"], &["--rates", "not a number"]),
        (&["--rates", "phi=1e200"], &["--rates", "phi is 1e200", "1e75"]),
        (&["--pose", "x=1e200"], &["--pose", "x is 1e200"]),
        (&["--mode", "+"], &["--mode", "1 sign for 0"]),
        (&["--length", "0"], &["--length", "0.0 m", "positive"]),
        (&["--length=-1mm"], &["--length", "positive"]),
        (&["--length", "1deg"], &["--length", "unit of an angle"]),
        (&["--length", "long"], &["--length", "not a number"]),
    ] {
        opm(&[&["velocity", HELICAL], flags].concat()).fails(2, parts);
    }
    velocity(&[HELICAL, "--rates", enormous, "--pose", enormous]);
}
