//! `opm fk`.

use crate::run::{Folder, keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::Value;
use std::f64::consts::TAU;

fn json(args: &[&str]) -> Value {
    opm(&[args, &["--format", "json"]].concat()).json()
}

/// The joint values of inverse kinematics at a pose, as `S1=...,S2=...`.
fn joints_at(mechanism: &str, pose: &str, mode: &str) -> String {
    let found = json(&["ik", mechanism, "--pose", pose, "--mode", mode]);
    let joints = &found["solutions"][0]["joints"];
    let names: &[&str] = match mechanism {
        PLANO => &["S1", "S2", "S3", "phi14", "phi24"],
        "schoenflies-4dof" => &["phi11", "nut1", "phi12", "nut2"],
        "translational-planar-4dof" => &["S1", "S2", "S3", "S4"],
        _ => &["S1", "S2", "S3"],
    };
    let given = names.iter().map(|name| format!("{name}={}", joints[name]));
    given.collect::<Vec<_>>().join(",")
}

#[test]
fn the_pose_that_the_joints_came_from_is_among_the_assemblies() {
    for mode in ["++ ++ ++ +", "-+ +- ++ -"] {
        let joints = joints_at(PLANO, "x=10mm,y=-5mm,zeta=10deg,xi=15deg,psi=-20deg", mode);
        let found = json(&["fk", PLANO, "--joints", &joints]);
        assert_eq!(keys(&found), ["actuated", "method", "assemblies", "unmet", "loose"]);
        assert_eq!(found["method"], "closed-form");
        let assemblies = found["assemblies"].as_array().unwrap();
        assert!((2..=64).contains(&assemblies.len()), "{}", assemblies.len());
        let wanted =
            [0.01, -0.005, 10.0_f64.to_radians(), 15.0_f64.to_radians(), -20.0_f64.to_radians()];
        let same = |a: &&Value| {
            let names = ["x", "y", "zeta", "xi", "psi"];
            let off =
                names.iter().zip(wanted).map(|(name, q)| (number(&a["pose"][name]) - q).abs());
            a["mode"] == mode && off.fold(0.0, f64::max) < 1e-9
        };
        let at = assemblies.iter().find(same).expect("the pose");
        assert_eq!(keys(at), ["pose", "mode", "within_limits", "joints", "imaginary", "residual"]);
        assert_eq!(keys(&at["imaginary"]), ["theta11", "theta12", "theta13"]);
        for a in assemblies {
            assert!(number(&a["residual"]) < 1e-12);
            // Every assembly has the given joint values.
            for (name, value) in found["actuated"].as_object().unwrap() {
                let off = (number(&a["joints"][name]) - number(value)).rem_euclid(TAU);
                assert!(off.min(TAU - off) < 1e-9, "{name}");
            }
            // One of them is confirmed by inverse kinematics.
            let pose: Vec<String> = (a["pose"].as_object().unwrap().iter())
                .map(|(name, value)| format!("{name}={value}"))
                .collect();
            let mode = a["mode"].as_str().unwrap();
            if std::ptr::eq(a, at) {
                let again = json(&["ik", PLANO, "--pose", &pose.join(","), "--mode", mode]);
                assert_eq!(again["reachable"], true);
            }
        }
        let only = json(&["fk", PLANO, "--joints", &joints, "--mode", mode]);
        let only = only["assemblies"].as_array().unwrap();
        assert!(only.iter().all(|a| a["mode"] == mode) && !only.is_empty());
        let of_mode = assemblies.iter().filter(|a| a["mode"] == mode).count();
        assert_eq!(only.len(), of_mode);
    }
}

#[test]
fn newton_starts_near_a_pose() {
    let joints = joints_at(PLANO, "x=10mm,xi=15deg,psi=5deg", "home");
    let found = json(&["fk", PLANO, "--joints", &joints, "--near", "xi=10deg"]);
    assert_eq!(found["method"], "newton");
    let [assembly] = &found["assemblies"].as_array().unwrap()[..] else { panic!("{found}") };
    assert_eq!(assembly["mode"], "++ ++ ++ +");
    assert!((number(&assembly["pose"]["x"]) - 0.01).abs() < 1e-9);
    assert!((number(&assembly["pose"]["xi"]) - 15.0_f64.to_radians()).abs() < 1e-9);
}

#[test]
fn without_a_closed_form_it_says_so() {
    let name = "translational-planar-4dof";
    let joints = joints_at(name, "x=5mm,w=310mm,phi=3deg", "home");
    let run = opm(&["fk", name, "--joints", &joints]);
    assert!(run.text().contains("1 assembly by Newton's method"), "{}", run.stdout);
    assert!(run.stderr.contains("no closed form"), "{}", run.stderr);
    let found = json(&["fk", name, "--joints", &joints, "--quiet"]);
    assert!((number(&found["assemblies"][0]["pose"]["w"]) - 0.31).abs() < 1e-9);
    // Newton's method does not converge from there: the work failed.
    let far = opm(&["fk", name, "--joints", "S1=1,S2=0,S3=0,S4=0"]);
    far.fails(1, &[name, "no assembly found from this start"]);
    let start = opm(&["fk", name, "--joints", "S1=0,S2=0,S3=0,S4=0", "--near", "w=2"]);
    start.fails_with_one_line(1, &[name, "the start is out of reach", "leg1: "]);
}

#[test]
fn no_assembly_is_an_answer() {
    let joints = "S1=900mm,S2=165mm,S3=160mm,phi14=-150deg,phi24=130deg";
    let found = json(&["fk", PLANO, "--joints", joints]);
    assert_eq!(found["assemblies"], Value::Array(vec![]));
    let unmet = found["unmet"][0].as_str().unwrap();
    assert!(unmet.starts_with("leg1: lower section out of reach by "), "{unmet}");
    let run = opm(&["fk", PLANO, "--joints", joints]);
    assert!(
        run.text().contains("no assembly\n  leg1: lower section out of reach by 659."),
        "{}",
        run.stdout
    );
    assert!(run.stderr.contains("S1 = 900 mm is beyond its limits"), "{}", run.stderr);
    assert_eq!(opm(&["fk", PLANO, "--joints", joints, "--quiet"]).stderr, "");
}

#[test]
fn every_actuated_joint_is_to_be_given() {
    let run = opm(&["fk", PLANO, "--joints", "S1=170mm,phi21=3,foo=2"]);
    run.fails_with_one_line(
        2,
        &[
            "--joints: ",
            "phi21 is passive",
            "no joint \"foo\"",
            "no value for S2, S3, phi14, phi24",
            "the actuated joints are S1, S2, S3, phi14, phi24",
        ],
    );
    let unit = opm(&["fk", HELICAL, "--joints", "S1=1deg,S2=0,S3=0"]);
    unit.fails_with_one_line(
        2,
        &["--joints: S1 is a length, but its value has the unit of an angle"],
    );
    let twice = opm(&["fk", HELICAL, "--joints", "S1=0,S1=0,S2=0,S3=0"]);
    twice.fails(2, &["S1 is given twice"]);
    let huge = opm(&["fk", HELICAL, "--joints", "S1=1e200,S2=0,S3=0"]);
    huge.fails_with_one_line(2, &["--joints: S1 is 1e200"]);
    let near = opm(&["fk", HELICAL, "--joints", "S1=0,S2=0,S3=0", "--near", "q=1"]);
    near.fails_with_one_line(2, &["--near: no task coordinate \"q\""]);
    let mode = opm(&["fk", PLANO, "--joints", &joints_at(PLANO, "", "home"), "--mode", "+"]);
    mode.fails_with_one_line(2, &["--mode"]);
}

/// The paper's second manipulator: three sliders, one pose, linear; text is in its millimetres.
#[test]
fn the_helical_manipulator_is_linear() {
    let joints = joints_at(HELICAL, "x=50mm,y=-30mm,phi=400deg", "home");
    let found = json(&["fk", HELICAL, "--joints", &joints]);
    let [assembly] = &found["assemblies"].as_array().unwrap()[..] else { panic!("{found}") };
    // Revolutions of a screw joint are counted.
    for (name, value) in [("x", 0.05), ("y", -0.03), ("phi", 400.0_f64.to_radians())] {
        assert!((number(&assembly["pose"][name]) - value).abs() < 1e-12, "{name}: {assembly}");
    }
    let text = opm(&["fk", HELICAL, "--joints", &joints]);
    assert!(text.text().contains("1 assembly, within limits"), "{}", text.stdout);
    let row = text.stdout.lines().last().unwrap();
    for value in ["50.000", "-30.000", "400.0000"] {
        assert!(row.contains(value), "{row}");
    }
}

/// Assemblies beyond the limits are marked, not removed.
#[test]
fn assemblies_beyond_limits_are_marked() {
    let folder = Folder::new();
    let text = opm(&["examples", "schoenflies-4dof"])
        .text()
        .replace("limits = [-55, 75]", "limits = [-5, 5]");
    let file = folder.write("narrow.toml", text);
    let joints = joints_at("schoenflies-4dof", "x=20mm", "home");
    let found = json(&["fk", &file, "--joints", &joints]);
    let assemblies = found["assemblies"].as_array().unwrap();
    assert_eq!(assemblies.len(), 2);
    assert!(assemblies.iter().any(|a| a["within_limits"] == false));
    let shown = opm(&["fk", &file, "--joints", &joints]);
    assert!(shown.text().lines().any(|line| line.ends_with('*')), "{}", shown.stdout);
}
