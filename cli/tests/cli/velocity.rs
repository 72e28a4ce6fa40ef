//! `opm velocity`.

use crate::run::{keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::Value;

/// Differences of step 1e-4 s, to the fourth order.
const STEP: f64 = 1e-4;
const DIFFERENCED: f64 = 1e-8;

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
    assert_eq!(found["unreachable"], serde_json::json!(["leg1", "leg2", "leg4"]));
    let text = opm(&["velocity", PLANO, "--pose", "x=1"]);
    assert!(text.text().contains("leg4: lower section out of reach"), "{}", text.stdout);
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
