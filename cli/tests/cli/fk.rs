//! `opm fk`.

use crate::run::{Folder, keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::Value;
use std::collections::HashMap;
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
        assert_eq!(
            keys(&found),
            ["actuated", "method", "assemblies", "unmet", "least_change", "loose"]
        );
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
        assert_eq!(
            keys(at),
            [
                "pose",
                "mode",
                "within_limits",
                "joints",
                "imaginary",
                "residual",
                "certificate",
                "radius",
                "distinct",
                "home_aspect"
            ]
        );
        assert_eq!(keys(&at["imaginary"]), ["theta11", "theta12", "theta13"]);
        for a in assemblies {
            assert!(number(&a["residual"]) < 1e-12);
            assert_eq!((&a["certificate"], &a["distinct"]), (&"proven".into(), &true.into()));
            assert!((0.0..1e-8).contains(&number(&a["radius"])));
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
    let start = opm(&["fk", name, "--joints", "S1=0,S2=0,S3=0,S4=0", "--near", "w=2000mm"]);
    start.fails_with_one_line(1, &[name, "the start is out of reach", "leg1: "]);
}

/// Legs that are solved whole: all assemblies, with the number of all solutions.
#[test]
fn a_hexapod_has_assemblies_by_continuation() {
    let joints = "S1=560mm,S2=530mm,S3=540mm,S4=535mm,S5=537mm,S6=545mm";
    let found = json(&["fk", "stewart", "--joints", joints]);
    assert_eq!(
        keys(&found),
        ["actuated", "method", "solutions", "assemblies", "unmet", "least_change", "loose"]
    );
    assert_eq!(found["method"], "continuation");
    let [all, of] = ["found", "of"].map(|key| found["solutions"][key].as_u64().unwrap());
    let listed = found["assemblies"].as_array().unwrap().len() as u64;
    assert!(
        all == of && listed <= of && listed.is_multiple_of(2) && listed > 0,
        "{listed} {all} {of}"
    );
    let run = opm(&["fk", "stewart", "--joints", joints]);
    assert!(run.text().contains(&format!("{listed} assemblies by continuation")), "{}", run.stdout);
    assert!(run.text().contains("with probability one"), "{}", run.stdout);
    // The one near home, by Newton's method, is one of them.
    let near = json(&["fk", "stewart", "--joints", joints, "--near", "x=0"]);
    assert_eq!(near["method"], "newton");
    let z = |found: &Value| number(&found["assemblies"][0]["pose"]["z"]);
    assert!((z(&found) - z(&near)).abs() < 1e-9);
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
    assert!(text.stdout.contains("It is proven: one exact assembly"), "{}", text.stdout);
    let row = text.stdout.lines().find(|line| line.starts_with("1  ")).unwrap();
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

/// The rows of a CSV as named cells.
fn rows(text: &str) -> Vec<HashMap<String, String>> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let named = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        names.iter().zip(cells).map(|(n, c)| ((*n).to_owned(), c.to_owned())).collect()
    };
    lines.map(named).collect()
}

fn cell(row: &HashMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap_or(f64::NAN)
}

/// A circle of the platform goes through inverse kinematics to joints, and back to the circle. In the middle the joints
/// are those of nothing; the next row is found again.
#[test]
fn joints_of_a_motion_lead_back_to_it() {
    let folder = Folder::new();
    for (mechanism, names) in [(PLANO, ["x", "y"]), (HELICAL, ["x", "y"])] {
        let place = |i: u32| {
            let (sin, cos) = (f64::from(i) * TAU / 60.0).sin_cos();
            [0.03 * sin, 0.03 * (cos - 1.0)]
        };
        let lines: String =
            (0..=60).map(|i| format!("{i},{},{}\n", place(i)[0], place(i)[1])).collect();
        let poses = folder.write("poses.csv", format!("t,x,y\n{lines}"));
        let solved = rows(opm(&["ik", mechanism, "--poses", &poses]).text());
        let joints: &[&str] = match mechanism {
            PLANO => &["phi24", "S1", "S2", "S3", "phi14"],
            _ => &["S3", "S1", "S2"],
        };
        let mut text = format!("t,{}\n", joints.join(","));
        for (i, row) in solved.iter().enumerate() {
            let value = |name: &&str| if i == 30 { "5.0" } else { &*row[*name] };
            let cells: Vec<&str> = joints.iter().map(value).collect();
            text.push_str(&format!("{},{}\n", row["t"], cells.join(",")));
        }
        let given = folder.write("joints.csv", text);
        let out = folder.arg("back.csv");
        let run = opm(&["fk", mechanism, "--poses", &given, "-o", &out]);
        run.text();
        let told = if mechanism == PLANO { "61 rows, 60 in reach" } else { "61 rows, " };
        assert!(run.stderr.contains(told), "{}", run.stderr);
        let text = folder.read("back.csv");
        assert!(text.starts_with("t,x,y,"), "{text}");
        let back = rows(&text);
        assert_eq!(back.len(), 61);
        // The table of inverse kinematics is read as it is, too.
        let whole = folder.arg("joints.csv");
        opm(&["ik", mechanism, "--poses", &poses, "-o", &whole]).text();
        let again = rows(opm(&["fk", mechanism, "--poses", &whole]).text());
        for (i, row) in again.iter().enumerate() {
            assert!((cell(row, "x") - place(i as u32)[0]).abs() < 1e-9, "{i}");
        }
        for (i, row) in back.iter().enumerate() {
            assert_eq!(cell(row, "t"), i as f64);
            if i == 30 {
                if mechanism == PLANO {
                    assert_eq!((&*row["reachable"], &*row["x"], &*row["mode"]), ("0", "", ""));
                }
                continue;
            }
            assert_eq!((&*row["reachable"], &*row["within_limits"]), ("1", "1"));
            for (name, expected) in names.iter().zip(place(i as u32)) {
                assert!((cell(row, name) - expected).abs() < 1e-9, "{i}: {name}");
            }
        }
    }
}

/// Every row has all assemblies of `--joints`; those nearest to home, or to --near, come first.
#[test]
fn all_assemblies_of_each_row_are_sorted() {
    let folder = Folder::new();
    let poses = ["x=10mm,xi=15deg", "y=-20mm,zeta=20deg,xi=12deg"];
    let joints: Vec<String> = poses.iter().map(|pose| joints_at(PLANO, pose, "home")).collect();
    let names = ["S1", "S2", "S3", "phi14", "phi24"];
    let line = |joints: &String| {
        joints.split(',').map(|one| one.split('=').nth(1).unwrap()).collect::<Vec<_>>().join(",")
    };
    let lines: Vec<String> = joints.iter().map(line).collect();
    let text = format!("{}\n{}\n9,9,9,0,0\n", names.join(","), lines.join("\n"));
    let given = folder.write("joints.csv", text);
    for near in [None, Some("y=-20mm,zeta=20deg,xi=12deg")] {
        let mut args = vec!["fk", PLANO, "--poses", &given, "--all"];
        args.extend(near.iter().flat_map(|pose| ["--near", pose]));
        let found = rows(opm(&args).text());
        for (number, joints) in joints.iter().enumerate() {
            let own: Vec<_> =
                found.iter().filter(|row| row["row"] == (number + 1).to_string()).collect();
            let alone = json(&["fk", PLANO, "--joints", joints]);
            assert_eq!(own.len(), alone["assemblies"].as_array().unwrap().len());
            assert!(own.len() > 1);
            for (i, row) in own.iter().enumerate() {
                assert_eq!(row["assembly"], (i + 1).to_string());
            }
        }
        // The angle of R = Rz(zeta) Ry(xi) Rz(psi) from home, and the distance of (x, y), do not both fall.
        if near.is_none() {
            let own: Vec<_> = found.iter().filter(|row| row["row"] == "1").collect();
            let far = |row: &HashMap<String, String>| {
                let half = |name: &str| cell(row, name) / 2.0;
                let cosine = (half("xi").cos() * (half("zeta") + half("psi")).cos()).abs().min(1.0);
                [2.0 * cosine.acos(), cell(row, "x").hypot(cell(row, "y"))]
            };
            for pair in own.windows(2) {
                let ([angle, way], [next_angle, next_way]) = (far(pair[0]), far(pair[1]));
                assert!(angle <= next_angle + 1e-9 || way <= next_way + 1e-9, "{pair:?}");
            }
            let [angle, way] = far(own[0]);
            assert!(own.iter().any(|row| far(row)[0] > angle + 0.1 || far(row)[1] > way + 0.01));
        }
        // The pose that the second row came from is the seed itself.
        if near.is_some() {
            let first = found.iter().find(|row| row["row"] == "2").unwrap();
            for (name, expected) in [
                ("x", 0.0),
                ("y", -0.02),
                ("zeta", 20_f64.to_radians()),
                ("xi", 12_f64.to_radians()),
            ] {
                assert!((cell(first, name) - expected).abs() < 1e-9, "{name}: {first:?}");
            }
        }
        let last = found.last().unwrap();
        assert_eq!((&*last["row"], &*last["assembly"], &*last["reachable"]), ("3", "0", "0"));
    }
}

#[test]
fn wrong_tables_of_joints_are_told() {
    let folder = Folder::new();
    for (text, part) in [
        ("S1,S2\n0,0\n", "joints.csv:1: no column S3; the actuated joints are S1, S2, S3"),
        ("S1,S2,S3,S9\n", "column \"S9\": no joint \"S9\"; the actuated joints are"),
        ("S1,S2,S3,S1\n", "column \"S1\": given twice"),
        ("1,2,3\n", "no header"),
        ("S1,S2,S3\n0,zero,0\n", "joints.csv:2: column S2: \"zero\" is not a number"),
        ("S1,S2,S3\n0,0\n", "joints.csv:2: 2 columns, expected 3: S1,S2,S3"),
    ] {
        let given = folder.write("joints.csv", text);
        let out = folder.arg("out.csv");
        opm(&["fk", HELICAL, "--poses", &given, "-o", &out]).fails_with_one_line(1, &[part]);
    }
    assert_eq!(folder.names(), ["joints.csv"]);
    opm(&["fk", HELICAL]).fails(2, &["--joints", "--poses"]);
    opm(&["fk", HELICAL, "--joints", "S1=0,S2=0,S3=0", "--all"]).fails(2, &["--all"]);
}

/// A platform that is congruent to its base moves along a circle while its legs, of one length, stay parallel.
#[test]
fn a_self_motion_is_told_once() {
    let folder = Folder::new();
    let mut file =
        "format = 1\nname = \"congruent\"\nunits = { length = \"m\", angle = \"deg\" }\n\
                    [platform]\npoint = [0, 0.3, 0]\n"
            .to_owned();
    for (i, [x, y]) in [[0.0, 0.0], [1.0, 0.0], [0.4, 0.7]].into_iter().enumerate() {
        file += &format!(
            "[[leg]]\nname = \"leg{i}\"\njoints = [\n\
             {{ name = \"r{i}\", type = \"revolute\", axis = [0, 0, 1], point = [{x}, {y}, 0] }},\n\
             {{ name = \"p{i}\", type = \"prismatic\", axis = [0, 1, 0], actuated = true }},\n\
             {{ name = \"s{i}\", type = \"revolute\", axis = [0, 0, 1], point = [{x}, {}, 0] }},\n]\n",
            y + 0.3
        );
    }
    let path = folder.write("congruent.toml", &file);
    let equal = "p0=0.1,p1=0.1,p2=0.1";
    let found = json(&["fk", &path, "--joints", equal]);
    assert_eq!(found["assemblies"].as_array().unwrap().len(), 0);
    let [family] = &found["families"].as_array().unwrap()[..] else { panic!("{found}") };
    assert_eq!((&family["dimension"], &family["platform_dimension"]), (&1.into(), &1.into()));
    assert_eq!(family["closed"], true);
    let [x, y] = ["x", "y"].map(|name| number(&family["pose"][name]));
    assert!((x.hypot(y) - 0.4).abs() < 1e-8, "{x} {y}");
    let text = opm(&["fk", &path, "--joints", equal]);
    let told = "self-motion: with these joints held the platform moves along a closed curve of assemblies; one of them is x = ";
    assert!(text.stdout.contains(told), "{}", text.stdout);
    assert!(json(&["fk", &path, "--joints", "p0=0.01,p1=0,p2=0"]).get("families").is_none());
}

/// The aspects that a grid finds are those that are told without: M. Husty (2009) has three assemblies in each of two aspects.
#[test]
fn the_aspect_of_home_is_told() {
    let joints = joints_at("planar-3rpr", "", "home");
    let found = json(&["fk", "planar-3rpr", "--joints", &joints, "--aspects"]);
    let assemblies = found["assemblies"].as_array().unwrap();
    assert_eq!(assemblies[0]["home_aspect"], "shared");
    let own = &assemblies[0]["aspect"];
    let mut apart = 0;
    for a in assemblies {
        match a["home_aspect"].as_str() {
            Some("shared") => assert_eq!(&a["aspect"], own),
            Some("apart") => {
                assert_ne!(&a["aspect"], own);
                apart += 1;
            }
            other => assert!(other.is_none(), "{a}"),
        }
    }
    assert_eq!(apart, 3, "{found}");
}
