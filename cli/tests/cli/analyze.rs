//! `opm analyze`.

use crate::PLANO;
use crate::run::{keys, number, opm, opm_reading};
use serde_json::Value;

fn analyze(args: &[&str]) -> Value {
    opm(&[&["analyze"], args, &["--format", "json"]].concat()).json()
}

/// A slider that points up carries 30 N with +30 N. One that is inclined by 60 degrees to the load carries more.
const LIFT: &str = r#"
format = 1
name = "lift"
units = { length = "mm", angle = "deg" }
[platform]
point = [0, 0, 100]
[[leg]]
name = "a"
joints = [
  { name = "Z", type = "prismatic", axis = [0, 0, 1], point = [0, 0, 0], actuated = true, max_effort = 40 },
  { name = "Xa", type = "prismatic", axis = [1, 0, 0], point = [0, 0, 100] },
]
[[leg]]
name = "b"
joints = [
  { name = "X", type = "prismatic", axis = [1, 0, 0], point = [0, 0, 0], actuated = true, max_effort = 10 },
  { name = "Zb", type = "prismatic", axis = [0, 0, 1], point = [0, 0, 100] },
]
"#;

fn lift(args: &[&str]) -> Value {
    opm_reading(LIFT, &[&["analyze", "-"], args, &["--format", "json"]].concat()).json()
}

#[test]
fn the_json_is_one_object_with_these_keys() {
    let found = analyze(&[PLANO, "--pose", "x=10mm,xi=15deg", "--wrench", "10,0,0,0,0,0.5"]);
    let expected = [
        "pose",
        "mode",
        "reachable",
        "wrench",
        "gravity",
        "balance",
        "efforts",
        "imaginary_efforts",
        "loose_motions",
        "internal_efforts",
        "worst",
        "capacity",
        "transmission",
        "stiffness",
        "indices",
        "length",
        "transform",
    ];
    assert_eq!(keys(&found), expected);
    assert_eq!(keys(&found["efforts"]), ["S1", "S2", "S3", "phi14", "phi24"]);
    assert_eq!(keys(&found["imaginary_efforts"]), ["theta11", "theta12", "theta13"]);
    assert_eq!((&found["balance"], &found["capacity"]), (&"balanced".into(), &Value::Null));
    assert_eq!(found["transmission"]["inputs"].as_array().unwrap().len(), 8);
    // Without a load there are no efforts, but all else.
    let bare = analyze(&[PLANO, "--pose", "x=10mm,xi=15deg"]);
    assert_eq!((&bare["efforts"], &bare["balance"]), (&Value::Null, &Value::Null));
    assert_eq!((&bare["worst"], &bare["transmission"]), (&found["worst"], &found["transmission"]));
    // Every index is a number here.
    assert_eq!(found["indices"]["lti"], found["transmission"]["lti"]);
    assert!(number(&found["indices"]["effort"]) > 0.0 && bare["indices"].get("effort").is_none());
    assert!(number(&bare["indices"]["clearance"]).is_finite());
    // Out of reach is an answer.
    let out = analyze(&[PLANO, "--pose", "x=9", "--wrench", "10,0,0,0,0,0.5"]);
    assert_eq!((&out["reachable"], &out["efforts"]), (&false.into(), &Value::Null));
    assert!(!out["unreachable"].as_array().unwrap().is_empty());
}

#[test]
fn an_effort_holds_up_a_weight() {
    let found = lift(&["--wrench", "0,0,-30,0,0,0"]);
    assert!((number(&found["efforts"]["Z"]) - 30.0).abs() < 1e-9);
    assert!(number(&found["efforts"]["X"]).abs() < 1e-9);
    // On top of it, Z bears 10 N more downwards, and X bears 10 N. Without the load X alone is the least.
    assert!((number(&found["capacity"]["force"]) - 10.0).abs() < 1e-9);
    let more = lift(&["--wrench", "0,0,-37,0,0,0"]);
    assert!((number(&more["capacity"]["force"]) - 3.0).abs() < 1e-9);
    let over = lift(&["--wrench", "0,0,-45,0,0,0"]);
    assert!((number(&over["capacity"]["force"]) + 5.0).abs() < 1e-9);
    assert_eq!(over["balance"], "balanced");
    // No moment does any work here.
    assert_eq!(over["capacity"]["moment"], Value::Null);
    assert_eq!(over["capacity"]["facets"].as_array().unwrap().len(), 2);
    // The legs' sliders carry what is not theirs by their stiffness: 30 N down with 1e3 N/m in Z.
    let soft = ["--wrench", "0,0,-30,0,0,0", "--link-stiffness", "1e12,1e12"];
    let soft = lift(&[&soft[..], &["--joint-stiffness", "Z=1e3"]].concat());
    assert!((number(&soft["stiffness"]["displacement"][2]) + 0.03).abs() < 1e-6);
    assert!((number(&soft["stiffness"]["matrix"][2][2]) - 1e3).abs() < 1e-3);
    assert!((number(&soft["stiffness"]["efforts"]["Z"]) - 30.0).abs() < 1e-6);
    // What swings on that spring is what the mass matrix says.
    let heavy = lift(&[
        "--gravity",
        "0,0,-9.81",
        "--link-stiffness",
        "1e9,1e9",
        "--joint-stiffness",
        "Z=1e3",
    ]);
    let of = |i: usize| number(&heavy["gravity"]["forces"][i]);
    let up = usize::from(of(1).abs() > of(0).abs());
    let mass = number(&heavy["gravity"]["mass_matrix"][up][up]);
    assert!((of(up).abs() - 9.81 * mass).abs() < 1e-9 * mass && of(1 - up).abs() < 1e-9);
    let lowest = &heavy["stiffness"]["vibrations"][0];
    let expected = (1e3 / mass).sqrt() / std::f64::consts::TAU;
    assert!((number(&lowest["frequency"]) - expected).abs() < 1e-3 * expected, "{lowest} {mass}");
    assert_eq!(lowest["frequency"], heavy["indices"]["natural_frequency"]);
}

/// The joints on the base hold the weight of all bodies, and springs do not change efforts that statics determine.
#[test]
fn legs_share_the_weight_of_bodies() {
    let heavy = ["--pose", "x=10mm,xi=15deg", "--gravity", "0,0,-9.81"];
    let soft = ["--link-stiffness", "1e7,1e4"];
    let found = analyze(&[&[PLANO][..], &heavy, &soft].concat());
    let weight = 9.81 * number(&found["gravity"]["mass"]);
    let on_base = |found: &Value| -> f64 {
        let joints = &found["stiffness"]["joints"];
        ["S1", "S2", "S3", "phi14"].iter().map(|joint| number(&joints[joint][2])).sum()
    };
    assert!((on_base(&found) + weight).abs() < 1e-6 * weight);
    for joint in ["S1", "S2", "S3", "phi14", "phi24"] {
        let [soft, rigid] =
            [&found["stiffness"]["efforts"], &found["efforts"]].map(|of| number(&of[joint]));
        assert!((soft - rigid).abs() < 1e-6 * weight, "{joint}: {soft} {rigid}");
    }
    let loaded = ["--wrench", "0,0,-100,0,0,0"];
    let found = analyze(&[&[PLANO][..], &heavy, &soft, &loaded].concat());
    assert!((on_base(&found) + weight + 100.0).abs() < 1e-6 * weight);
    // The legs carry what acts on the platform: the load, and the platform's own weight.
    let legs = found["stiffness"]["legs"].as_object().unwrap();
    let carried: f64 = legs.values().map(|leg| number(&leg[2])).sum();
    assert!(-carried > 100.0 && -carried < 100.0 + weight, "{carried}");
}

#[test]
fn a_load_has_a_point_and_axes() {
    let with = |more: &[&str]| {
        let pose = ["planar-3rrr", "--pose", "x=10mm,theta=90deg"];
        analyze(&[&pose[..], &["--wrench", "2,0,0,0,0,1"], more].concat())["wrench"].clone()
    };
    let close = |found: &Value, expected: [f64; 6]| {
        let found = found.as_array().unwrap().iter().map(number);
        assert!(found.zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{expected:?}");
    };
    close(&with(&[]), [2.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    close(&with(&["--frame", "platform"]), [0.0, 2.0, 0.0, 0.0, 0.0, 1.0]);
    close(&with(&["--at", "0,0.5,0"]), [2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    close(&with(&["--at", "0,500mm,0", "--frame", "platform"]), [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_table_of_poses_gets_efforts_and_indices() {
    let table = "t,x [mm],xi [deg]\n0,10,15\n1,9000,0\n";
    let args = ["analyze", PLANO, "--poses", "-", "--wrench", "10,0,0,0,0,0.5", "--quiet"];
    let rows = opm_reading(table, &args).text().to_owned();
    let mut lines = rows.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let one = analyze(&[PLANO, "--pose", "x=10mm,xi=15deg", "--wrench", "10,0,0,0,0,0.5"]);
    let (near, far) = (lines.next().unwrap(), lines.next().unwrap());
    let at = |name: &str| header.iter().position(|column| *column == name).expect(name);
    let value = |name: &str| near[at(name)].parse::<f64>().unwrap();
    assert_eq!(value("effort.S1"), number(&one["efforts"]["S1"]));
    assert_eq!(value("effort.theta12"), number(&one["imaginary_efforts"]["theta12"]));
    assert_eq!(value("lti"), number(&one["transmission"]["lti"]));
    assert_eq!((near[at("balance")], far[at("balance")], far[at("lti")]), ("balanced", "", ""));
    // No joint has a largest effort.
    assert!(!header.contains(&"payload"));
}

#[test]
fn wrong_input_gets_one_message() {
    for (args, expected) in [
        (&["--wrench", "1,2"][..], "2 numbers in \"1,2\", expected 6: FX,FY,FZ,MX,MY,MZ"),
        (&["--wrench", "1,2,3,4,5,6", "--at", "tool"], "expected platform, base, or a point"),
        (&["--at", "base"], "--wrench"),
        (&["--wrench", "1,2,3,4,5,6", "--frame", "tool"], "platform"),
        (&["--link-stiffness", "1e6"], "1 number in \"1e6\", expected 2: KT,KR"),
        (&["--link-stiffness", "1e6,-1"], "KR is -1.0, expected a number above 0"),
        (
            &["--link-stiffness", "1,1", "--joint-stiffness", "Q=1"],
            "--joint-stiffness: no actuated joint \"Q\"",
        ),
        (&["--gravity", "0,0"], "2 numbers in \"0,0\", expected 3: X,Y,Z"),
        (&["--density", "7800"], "--gravity"),
        (&["--gravity", "0,0,-9.81", "--density", "0"], "--density: 0, expected a number from"),
        (&["--length", "0"], "expected a positive length"),
        (&["--set", "max_effort.S=50mm"], "max_effort.S is in N or N m"),
        (&["--set", "max_effort.S=-5"], "is -5 N, expected a value above 0"),
    ] {
        let run = opm(&[&["analyze", PLANO], args].concat());
        assert_eq!(run.code, Some(2), "{args:?}: {}", run.stderr);
        assert!(run.stderr.contains(expected), "{args:?}: {}", run.stderr);
    }
    let found = analyze(&[PLANO, "--set", "max_effort.S=50", "--set", "leg4.max_effort.phi1=3"]);
    assert!(number(&found["capacity"]["force"]) > 0.0);
}

#[test]
fn a_workspace_is_limited_by_indices() {
    let grid = ["workspace", "planar-3rrr", "--grid", "x=-0.1:0.1:21", "--grid", "y=-0.1:0.1:21"];
    let all = opm(&[&grid[..], &["--format", "json"]].concat()).json();
    let good = opm(&[&grid[..], &["--limit", "lti=0.6", "--format", "json"]].concat()).json();
    assert!(number(&good["reachable"]) < number(&all["reachable"]));
    assert_eq!(good["limits"], serde_json::json!({ "lti": 0.6 }));
    assert!(number(&good["reachable"]) > 0.0 && all.get("limits").is_none());
    let text = opm(&[&grid[..], &["--limit", "lti=0.6"]].concat()).text().to_owned();
    assert!(text.contains("local transmission index at least 0.6"), "{text}");
    for (limit, expected) in [
        ("lte=0.7", "--limit: no index \"lte\", expected one of iti, oti, lti"),
        ("lti=0.7mm", "lti has a unit"),
        ("payload=5", "payload: no actuated joint has a `max_effort`"),
    ] {
        let run = opm(&[&grid[..], &["--limit", limit]].concat());
        assert!(run.stderr.contains(expected), "{}", run.stderr);
    }
}
