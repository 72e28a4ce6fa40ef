//! `opm ik` at one pose.

use crate::run::{Folder, keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::Value;
use std::f64::consts::TAU;

/// Six decimals of the published numbers.
const PUBLISHED: f64 = 1e-6;
/// Sums of a few doubles.
const EXACT: f64 = 1e-12;

fn ik(args: &[&str]) -> Value {
    let all: Vec<&str> = [&["ik"], args, &["--format", "json"]].concat();
    opm(&all).json()
}

/// Whether two angles are equal modulo a revolution.
#[track_caller]
fn assert_angle(found: &Value, expected: f64) {
    let off = (number(found) - expected).rem_euclid(TAU);
    assert!(off.min(TAU - off) < PUBLISHED, "{found}, expected {expected}");
}

#[test]
fn imaginary_joints_are_the_published_ones() {
    for (pose, plus, minus) in [
        ("", [0.155_324, 2.249_719, 4.344_115], [2.986_268, 5.080_663, 0.891_873]),
        ("xi=20deg", [0.226_775, 2.006_096, 4.538_244], [2.914_818, 4.886_534, 1.135_496]),
        (
            "zeta=30deg,xi=20deg,psi=-10deg",
            [0.595_875, 2.365_971, 4.869_578],
            [3.286_056, 5.226_662, 1.484_959],
        ),
    ] {
        for (mode, thetas) in [("++ ++ ++ +", plus), ("-+ -+ -+ +", minus)] {
            let found = ik(&[PLANO, "--pose", pose, "--mode", mode]);
            let imaginary = &found["solutions"][0]["imaginary"];
            for (name, theta) in ["theta11", "theta12", "theta13"].into_iter().zip(thetas) {
                assert_angle(&imaginary[name], theta);
            }
        }
    }
}

#[test]
fn one_solution_has_every_joint() {
    let found = ik(&[PLANO, "--pose", "x=10mm,xi=15deg"]);
    let expected = ["pose", "reachable", "solutions", "unreachable", "transform", "set_aside"];
    assert_eq!(keys(&found), expected);
    assert_eq!(keys(&found["pose"]), ["x", "y", "zeta", "xi", "psi"]);
    assert_eq!(number(&found["pose"]["x"]), 0.01);
    assert!((number(&found["pose"]["xi"]) - 15.0_f64.to_radians()).abs() < EXACT);
    assert_eq!(found["reachable"], true);
    assert_eq!(found["unreachable"], Value::Array(vec![]));
    let solutions = found["solutions"].as_array().unwrap();
    assert_eq!(solutions.len(), 1);
    assert_eq!(keys(&solutions[0]), ["mode", "within_limits", "joints", "imaginary", "nearest"]);
    assert_eq!(keys(&solutions[0]["nearest"]), ["pair", "distance"]);
    assert_eq!(solutions[0]["mode"], "++ ++ ++ +");
    assert_eq!(keys(&solutions[0]["imaginary"]), ["theta11", "theta12", "theta13"]);
    let joints = keys(&solutions[0]["joints"]);
    assert_eq!(joints.len(), 3 * 5 + 2 + 3, "three PRRRR legs and one RRS leg");
    for name in ["S1", "phi11", "theta33", "phi24", "s4.x", "s4.y", "s4.z"] {
        assert!(joints.contains(&name), "{name} in {joints:?}");
    }
}

/// The transform of a pose, given to --transform, returns that pose; here with R = Rz(zeta) Ry(xi) Rz(psi).
#[test]
fn a_transform_is_a_pose_and_back() {
    for (file, pose) in [
        (PLANO, "x=10mm,y=-20mm,zeta=30deg,xi=20deg,psi=-10deg"),
        (HELICAL, "x=20mm,y=5mm,phi=40deg"),
        ("planar-planar-5dof-joints", "x=20mm,theta=10deg,w=320mm,phi=-5deg"),
        ("schoenflies-4dof", "x=20mm,phi=40deg,z=-170mm"),
        ("translational-planar-4dof", "x=20mm,y=-10mm,w=310mm,phi=5deg"),
    ] {
        let by_pose = ik(&[file, "--pose", pose]);
        let transform = &by_pose["transform"];
        let parts = ["position", "quaternion"].map(|key| transform[key].as_array().unwrap());
        let numbers: Vec<String> = parts.into_iter().flatten().map(Value::to_string).collect();
        let by_transform = ik(&[file, "--transform", &numbers.join(",")]);
        assert_eq!(keys(&by_transform), keys(&by_pose));
        for (name, value) in by_pose["pose"].as_object().unwrap() {
            let off = number(value) - number(&by_transform["pose"][name]);
            assert!(off.abs() < 1e-8, "{file} {name} {off}");
        }
        let joints = |found: &Value| found["solutions"][0]["joints"].clone();
        for (name, value) in joints(&by_pose).as_object().unwrap() {
            let off = number(value) - number(&joints(&by_transform)[name]);
            assert!(off.abs() < 1e-7, "{file} {name} {off}");
        }
    }
    let found = ik(&[PLANO, "--pose", "x=10mm,y=-20mm,xi=60deg"]);
    let quaternion = found["transform"]["quaternion"].as_array().unwrap();
    // The quaternion has half the angle about y.
    for (part, expected) in quaternion.iter().zip([0.75_f64.sqrt(), 0.0, 0.5, 0.0]) {
        assert!((number(part) - expected).abs() < EXACT);
    }
    for (part, expected) in
        found["transform"]["position"].as_array().unwrap().iter().zip([0.01, -0.02, 0.0])
    {
        assert!((number(part) - expected).abs() < EXACT);
    }
}

/// A transform off the plane of the lower section gives the distance and the direction.
#[test]
fn a_transform_outside_the_motion_is_told_how_far() {
    let transform = ["--transform", "10mm,0,20mm,0.8,0,0.6,0"];
    let found = ik(&[PLANO, transform[0], transform[1]]);
    assert_eq!(found["reachable"], false);
    assert_eq!(found["solutions"], Value::Array(vec![]));
    let translation = found["outside"]["translation"].as_array().unwrap();
    for (found, expected) in translation.iter().zip([0.0, 0.0, 0.02]) {
        assert!((number(found) - expected).abs() < 1e-9);
    }
    assert!((number(&found["pose"]["x"]) - 0.01).abs() < 1e-9, "the nearest pose");
    let run = opm(&["ik", PLANO, transform[0], transform[1]]);
    let text =
        "outside the manipulator's motion by 20 mm along (0, 0, 1)\nnearest pose: x = 10.000";
    assert!(run.text().contains(text), "{}", run.stdout);
    // The motion has three translations and a rotation about z: a tilt is outside.
    let tilted = "0,340mm,-150mm,0.996195,0.0871557,0,0";
    let run = opm(&["ik", "schoenflies-4dof", "--transform", tilted]);
    assert!(run.text().contains("motion by 9.99999 deg about (1, 0, 0)\n"), "{}", run.stdout);
    // A transform with six digits counts as in the motion.
    let rounded = "0,0,0,0.996195,0,0.0871557,0";
    assert_eq!(ik(&[PLANO, "--transform", rounded])["reachable"], true);
}

/// The sliders of the helical manipulator by the paper's linear formula, corrected.
#[test]
fn sliders_of_the_helical_manipulator_follow_the_formula() {
    let (x, y, phi, pitch) = (0.05_f64, -0.03_f64, 0.7_f64, 0.02_f64);
    let found = ik(&[HELICAL, "--pose", "x=50mm,y=-30mm,phi=0.7"]);
    let solution = &found["solutions"][0];
    assert_eq!(solution["mode"], "");
    assert!((number(&solution["imaginary"]["S"]) - pitch * phi).abs() < EXACT);
    let legs = [(210.0_f64, 45.0_f64, 0.010), (330.0, 285.0, 0.015), (90.0, 165.0, 0.025)];
    for (number_, (alpha, beta, k)) in legs.into_iter().enumerate() {
        let (sin, cos) = alpha.to_radians().sin_cos();
        let along = k + if number_ == 0 { pitch * phi } else { 0.0 };
        let expected = -sin * x + cos * y + beta.to_radians().sin() * along;
        let found = number(&solution["joints"][format!("S{}", number_ + 1)]);
        assert!((found - expected).abs() < EXACT, "S{}: {found}, {expected}", number_ + 1);
    }
}

#[test]
fn all_modes_are_told_apart() {
    let found = ik(&[PLANO, "--pose", "xi=15deg", "--all-modes"]);
    let solutions = found["solutions"].as_array().unwrap();
    let mut modes: Vec<&str> = solutions.iter().map(|s| s["mode"].as_str().unwrap()).collect();
    assert_eq!(modes[0], "++ ++ ++ +");
    modes.sort_unstable();
    modes.dedup();
    assert_eq!(modes.len(), 128, "2^7: two choices in each of three legs, one in the fourth");
    for solution in [&solutions[1], &solutions[77]] {
        let mode = solution["mode"].as_str().unwrap();
        let alone = ik(&[PLANO, "--pose", "xi=15deg", "--mode", mode]);
        assert_eq!(&alone["solutions"][0], solution);
    }
}

#[test]
fn a_mode_may_start_with_a_minus_and_home_is_one() {
    for mode in ["-+ ++ ++ +", "-- -- -- -"] {
        let found = ik(&[PLANO, "--pose", "xi=5deg", "--mode", mode]);
        assert_eq!(found["solutions"][0]["mode"], mode);
    }
    let home = ik(&[PLANO, "--pose", "xi=5deg", "--mode", "home"]);
    assert_eq!(home, ik(&[PLANO, "--pose", "xi=5deg"]));
}

#[test]
fn out_of_reach_is_an_answer() {
    // Arm leg: |P - D| = 1 m - 75 mm below the base point along y, of which the links span 200 mm.
    let found = ik(&[PLANO, "--pose", "y=-1"]);
    assert_eq!(found["reachable"], false);
    assert_eq!(found["solutions"], Value::Array(vec![]));
    let legs = found["unreachable"].as_array().unwrap();
    let arm = legs.iter().find(|leg| leg["leg"] == "leg4").expect("the arm does not reach");
    assert_eq!(keys(arm), ["leg", "reason"]);
    assert_eq!(arm["reason"], "lower section out of reach by 0.875 m");
    let text = opm(&["ik", PLANO, "--pose", "y=-1"]);
    assert!(text.text().contains("leg4: lower section out of reach by 875 mm"), "{}", text.stdout);

    // A platform axis within 30 degrees of -z is out of the upper section's reach, in every mode.
    let tilted = ik(&[PLANO, "--pose", "xi=120deg", "--all-modes"]);
    assert_eq!(tilted["reachable"], false);
    let reason = tilted["unreachable"][0]["reason"].as_str().unwrap();
    assert!(reason.starts_with("upper section out of reach by "), "{reason}");
}

#[test]
fn beyond_limits_is_reachable_and_marked() {
    let found = ik(&[HELICAL, "--pose", "x=1"]);
    assert_eq!(found["reachable"], true);
    assert_eq!(found["solutions"][0]["within_limits"], false);
    let run = opm(&["ik", HELICAL, "--pose", "x=1"]);
    let marked: Vec<&str> = run.text().lines().filter(|line| line.ends_with('*')).collect();
    // S = -sin(alpha) x + ...: about 0.5, 0.5 and -1 m, all beyond 0.4.
    assert_eq!(marked.len(), 3, "{}", run.stdout);
}

#[test]
fn text_is_in_the_units_of_the_file() {
    let run = opm(&["ik", HELICAL, "--pose", "x=0.05,phi=0.5rad"]);
    let text = run.text();
    assert!(text.contains("x = 50.000 mm"), "{text}");
    assert!(text.contains("phi = 28.6479 deg"), "{text}");
    let imaginary = text.lines().find(|line| line.contains("imaginary")).expect("joint S");
    assert!(imaginary.contains("10.000  mm"), "20 mm/rad over 0.5 rad: {imaginary}");
}

/// The arm of a five-bar ties the forearm's angle to the place of the hand.
/// The angle by which the five-bar's right forearm has turned from home, by the law of cosines; millimetres.
fn right_forearm(x: f64, y: f64) -> f64 {
    let (shoulder, upper, fore) = (160.0, 138.0_f64, 307.0_f64);
    let away = (x - shoulder).hypot(y);
    let at_shoulder = (upper * upper + away * away - fore * fore) / (2.0 * upper * away);
    let arm = y.atan2(x - shoulder) - at_shoulder.acos();
    let home = 60_f64.to_radians();
    let elbow = |arm: f64| [shoulder + upper * arm.cos(), upper * arm.sin()];
    let ([ex, ey], [hx, hy]) = (elbow(arm), elbow(home));
    // At home the hand is above the middle between the shoulders.
    let hand = hy + (fore * fore - hx * hx).sqrt();
    (y - ey).atan2(x - ex) - (hand - hy).atan2(-hx)
}

/// A table with the angle that follows is read back, and checked line by line.
#[test]
fn dependent_coordinates_are_columns_of_tables() {
    let folder = Folder::new();
    let theta = right_forearm(20.0, 300.0).to_degrees();
    let rows = format!("20,300,{theta:.6},1\n20,300,,2\n0,900,33,3\n");
    let table = folder.write("a.csv", format!("x [mm],y [mm],theta [deg],S1 [deg]\n{rows}"));
    let solved = opm(&["ik", "five-bar", "--poses", &table]).text().to_owned();
    let lines: Vec<&str> = solved.lines().collect();
    assert!(lines[0].starts_with("x,y,theta,reachable"), "{solved}");
    assert_eq!(lines[1], lines[2], "a cell may be empty");
    assert!(
        lines[3].starts_with("0.0,0.9,,0,0,"),
        "out of reach there is nothing to check: {solved}"
    );
    // What was written is read again, empty cells too.
    let again = folder.write("b.csv", &solved);
    assert_eq!(opm(&["ik", "five-bar", "--poses", &again]).text(), solved);
    let all = opm(&["ik", "five-bar", "--all-modes", "--poses", &table]);
    let all = all.text();
    // The elbow of the other arm is up or down; without a value this one's is, too.
    assert_eq!(all.lines().count(), 1 + 2 + 4 + 1, "{all}");
    let wrong = folder.write("c.csv", "x [mm],y [mm],theta [deg]\n20,300,\n20,300,3\n");
    let follows = format!(
        "theta is given as 3 deg, but follows from the other coordinates as {theta:.5} deg"
    );
    let out = folder.arg("out.csv");
    for command in ["ik", "analyze"] {
        let run = opm(&[command, "five-bar", "--poses", &wrong, "-o", &out]);
        run.fails(1, &["c.csv:3", &follows]);
    }
    let run = opm(&["ik", "five-bar", "--all-modes", "--poses", &wrong, "-o", &out]);
    run.fails(1, &["c.csv:3", "other values in all 4 working modes"]);
}

#[test]
fn dependent_coordinates_are_given_and_checked() {
    let found = ik(&["five-bar", "--pose", "x=20mm,y=300mm"]);
    assert_eq!(keys(&found["pose"]), ["x", "y", "theta"]);
    let theta = number(&found["pose"]["theta"]);
    assert!((theta - right_forearm(20.0, 300.0)).abs() < EXACT);
    assert_eq!(number(&found["solutions"][0]["dependent"]["theta"]), theta);
    // The transform is the forearm's: the hand, and its rotation from home.
    let [w, z] = [0, 3].map(|i| number(&found["transform"]["quaternion"][i]));
    assert!((2.0 * z.atan2(w) - theta).abs() < EXACT);
    let given = format!("x=20mm,y=300mm,theta={theta}rad");
    assert_eq!(ik(&["five-bar", "--pose", &given])["pose"], found["pose"]);
    // With all modes, those that have the value are left.
    let all = ik(&["five-bar", "--all-modes", "--pose", "x=20mm,y=300mm"]);
    assert_eq!(all["solutions"].as_array().unwrap().len(), 4);
    // The forearm's angle differs from mode to mode, and with it where the platform is.
    let mut angles = Vec::new();
    for solution in all["solutions"].as_array().unwrap() {
        let angle = number(&solution["dependent"]["theta"]);
        let [w, z] = [0, 3].map(|i| number(&solution["transform"]["quaternion"][i]));
        assert!((2.0 * z.atan2(w) - angle).sin().abs() < EXACT, "{solution}");
        let position = [0, 1].map(|i| number(&solution["transform"]["position"][i]));
        assert!((position[0] - 0.02).hypot(position[1] - 0.3) < EXACT, "{solution}");
        angles.push(angle);
    }
    assert!(angles.iter().any(|angle| (angle - angles[0]).abs() > 0.1));
    assert_eq!(all["transform"], all["solutions"][0]["transform"]);
    let some = ik(&["five-bar", "--all-modes", "--pose", &given]);
    assert_eq!(some["solutions"].as_array().unwrap().len(), 2);
    let wrong = ["ik", "five-bar", "--pose", "x=20mm,y=300mm,theta=3deg"];
    let follows = format!("{:.5} deg", theta.to_degrees());
    opm(&wrong).fails_with_one_line(2, &["--pose", "theta is given as 3 deg", &follows]);
    let wrong = [&wrong[..], &["--all-modes"]].concat();
    opm(&wrong).fails_with_one_line(2, &["other values in all 4 working modes"]);
    let far = ik(&["five-bar", "--pose", "y=500mm"]);
    assert_eq!(
        (&far["reachable"], &far["unreachable"][0]["leg"]),
        (&false.into(), &"right".into())
    );
}

/// The right arm of the five-bar is 445 mm long, its shoulder at (160 mm, 0); the nearest place is on its circle, where the
/// left arm reaches, too.
#[test]
fn the_nearest_pose_in_reach() {
    let asked = ["ik", "five-bar", "--pose", "x=-1,y=1", "--nearest", "--all-modes"];
    let found = opm(&[&asked[..], &["--format", "json"]].concat()).json();
    let nearest = &found["nearest_pose"];
    let away = 1.16_f64.hypot(1.0);
    assert!((number(&nearest["distance"]) - (away - 0.445)).abs() < 1e-9, "{nearest}");
    assert!((number(&nearest["pose"]["x"]) - (0.16 - 1.16 * 0.445 / away)).abs() < 1e-6);
    assert_eq!(found["reachable"], false);
    assert!(!nearest["solutions"].as_array().unwrap().is_empty());
    let text = opm(&asked);
    assert!(text.text().contains("nearest found in reach, 1086.5"), "{}", text.stdout);
    // A pose in reach is its own answer.
    let asked = ["ik", "five-bar", "--pose", "x=0", "--nearest"];
    let home = opm(&[&asked[..], &["--format", "json"]].concat()).json();
    assert!(home["nearest_pose"].is_null() && home["reachable"] == true);
    assert_eq!(opm(&asked).text(), opm(&asked[..4]).text());
    assert!(
        opm(&["ik", "five-bar", "--pose", "x=0", "--format", "json"])
            .json()
            .get("nearest_pose")
            .is_none()
    );
    opm(&["ik", "five-bar", "--pose", "x=9", "--nearest", "--length", "0"])
        .fails(2, &["--length", "positive"]);
    opm(&["ik", "five-bar", "--pose", "x=9", "--length", "1"]).fails(2, &["--nearest"]);
}

#[test]
fn doubts_about_a_file_are_warnings() {
    let folder = Folder::new();
    let text = opm(&["examples", "planar-3rrr"]).stdout;
    let limited = text.replace("name = \"C{i}\", ", "name = \"C{i}\", limits = [-1.5, 1.5], ");
    let file = folder.write("limited.toml", &limited);
    for command in [&["ik", &file, "--pose", "x=0"][..], &["check", &file, "--samples", "1"]] {
        let told = opm(command);
        assert_eq!(told.stderr.matches("warning").count(), 1, "{}", told.stderr);
        assert!(told.stderr.contains("limits of C1, C2, C3 are at most 1.5"), "{}", told.stderr);
    }
    assert_eq!(opm(&["ik", &file, "--pose", "x=0", "-q"]).stderr, "");
    let warnings = &opm(&["decompose", &file, "--format", "json"]).json()["warnings"];
    assert_eq!(warnings.as_array().unwrap().len(), 1, "{warnings}");
    // A model of another program: one message, and where to go.
    let urdf =
        folder.write("a.urdf", "\u{feff}<?xml version=\"1.0\"?>\n<robot name=\"a\">\n</robot>\n");
    opm(&["check", &urdf])
        .fails_with_one_line(1, &["a.urdf:1:1: this is a URDF model", "opm help format"]);
}
