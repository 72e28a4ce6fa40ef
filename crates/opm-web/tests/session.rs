//! What a page is answered, compared with the library asked directly, pose by pose.

use opm_analysis::{Index, Indices, Setup};
use opm_core::mechanism::examples::{EXAMPLES, find};
use opm_core::mechanism::file;
use opm_core::{Manipulator, Solution};
use opm_web::{Reply, Session};
use serde_json::{Value, json};

fn text(name: &str) -> &'static str {
    find(name).expect("a shipped example").text
}

fn ask(session: &mut Session, request: &Value) -> Reply {
    session.answer(&request.to_string())
}

/// The answer to a request that succeeds.
fn answer(session: &mut Session, request: &Value) -> Value {
    let value = ask(session, request).value();
    assert!(value.get("problems").is_none(), "{request}: {value}");
    value
}

/// The problems of a request that fails.
fn problems(session: &mut Session, request: &Value) -> Vec<Value> {
    let value = ask(session, request).value();
    value["problems"].as_array().unwrap_or_else(|| panic!("{request}: {value}")).clone()
}

fn opened(name: &str) -> (Session, Value) {
    let mut session = Session::default();
    let description = answer(&mut session, &json!({ "do": "open", "text": text(name) }));
    (session, description)
}

/// The number of a pose on a plane of 31 x 25 poses of the plano-spherical mechanism, in mm and degrees as typed.
fn typed(number: usize) -> (f64, f64) {
    let value = |i: usize, low: f64, high: f64, count: usize| {
        low + (high - low) * i as f64 / (count - 1) as f64
    };
    (value(number % 31, -300.0, 300.0, 31), value(number / 31, -60.0, 60.0, 25))
}

#[test]
fn a_slice_is_what_each_of_its_poses_is() {
    let (mut session, description) = opened("plano-spherical-5dof");
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let mut buffer = manipulator.solution();
    // Across x, upwards xi, and then the other way around: the grid has x first in any case.
    let x = json!({ "name": "x", "min": -300, "max": 300, "count": 31 });
    let xi = json!({ "name": "xi", "min": -60, "max": 60, "count": 25 });
    for mode in description["modes"].as_array().unwrap().iter().step_by(37) {
        let mode = mode.as_str().unwrap();
        let held = json!({ "y": 12.5, "zeta": -8, "x": 1e6 });
        let request = json!({ "do": "slice", "x": x, "y": xi, "pose": held, "mode": mode });
        let reply = ask(&mut session, &request);
        assert_eq!(reply.bytes.len(), 31 * 25);
        let mut reachable = 0;
        for (number, &shown) in reply.bytes.iter().enumerate() {
            let (x, xi) = typed(number);
            let values = [
                ("x", x / 1000.0),
                ("y", 12.5 / 1000.0),
                ("zeta", (-8.0_f64).to_radians()),
                ("xi", xi.to_radians()),
            ];
            let pose = manipulator.pose(values).unwrap();
            let parsed = manipulator.parse_mode(mode).unwrap();
            let found = manipulator.inverse(&pose, parsed, &mut buffer).unwrap();
            let within = found.is_some_and(Solution::within_limits);
            assert_eq!(shown == 1, within, "{mode} at {pose:?}");
            reachable += u64::from(within);
        }
        let slice = reply.value();
        assert_eq!(slice["reachable"], reachable);
        assert_eq!(slice["poses"], 31 * 25);

        let request = json!({ "do": "slice", "x": xi, "y": x, "pose": held, "mode": mode });
        let turned = ask(&mut session, &request);
        assert_eq!(turned.value()["reachable"], reachable);
        for (number, &shown) in reply.bytes.iter().enumerate() {
            assert_eq!(shown, turned.bytes[number % 31 * 25 + number / 31]);
        }
        let area = |slice: &Value| -> f64 {
            let rings = slice["rings"].as_array().unwrap();
            rings.iter().map(area_of).sum()
        };
        let (one, other) = (area(&slice), area(&turned.value()));
        assert!((one + other).abs() <= 1e-9 * one.abs(), "mirrored: {one} {other}");
    }
}

/// The area in a ring, by Gauss's formula.
fn area_of(ring: &Value) -> f64 {
    let numbers: Vec<f64> = ring.as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
    let corners: Vec<&[f64]> = numbers.chunks(2).collect();
    let sides = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
    sides.map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
}

/// The boundary runs half-way between the points of the grid, so that it holds a cell for each point but for corners.
#[test]
fn the_boundary_holds_the_reachable_poses() {
    let (mut session, _) = opened("plano-spherical-5dof");
    let axis = |name: &str| json!({ "name": name, "min": -300, "max": 300, "count": 201 });
    let request = json!({ "do": "slice", "x": axis("x"), "y": axis("y") });
    let slice = answer(&mut session, &request);
    let (cell, reachable) = (3.0 * 3.0, slice["reachable"].as_f64().unwrap());
    let rings = slice["rings"].as_array().unwrap();
    let area: f64 = rings.iter().map(area_of).sum();
    assert!((area / (cell * reachable) - 1.0).abs() < 0.02, "{area}");
    assert_eq!(slice["unit"], "mm^2");
}

/// The count of a fitted grid is that of the library, and that of its poses one by one.
#[test]
fn the_whole_workspace_is_counted_on_the_fitted_grid() {
    use opm_workspace::{Modes, Progress, Sweep, default_grid};
    let (mut session, _) = opened("translational-helical-3dof");
    let whole = json!({ "do": "whole" });
    assert_eq!(problems(&mut session, &whole)[0]["message"], "no grid was fitted");
    let fitted = answer(&mut session, &json!({ "do": "fit" }));
    let found = answer(&mut session, &whole);
    let manipulator = Manipulator::example("translational-helical-3dof").unwrap();
    let modes = Modes::One(manipulator.home_mode());
    let progress = Progress::default();
    let (grid, _) = default_grid(&manipulator, modes, &progress).unwrap();
    assert_eq!(fitted["poses"], grid.poses());
    let count = Sweep::new(&manipulator, &grid, modes).count(&progress).unwrap();
    assert_eq!(found["reachable"], count.reachable);
    let mut buffer = manipulator.solution();
    let reached = |number: u64, buffer: &mut Solution| {
        let found = manipulator.inverse(&grid.pose(number), manipulator.home_mode(), buffer);
        found.unwrap().is_some_and(Solution::within_limits)
    };
    let each = (0..grid.poses()).filter(|&number| reached(number, &mut buffer)).count();
    assert_eq!(each as u64, count.reachable);
}

/// The library gives them in metres and radians, and the platform's place as a displacement.
#[test]
fn a_pose_has_the_joints_of_inverse_kinematics_in_the_units_of_the_file() {
    let (mut session, description) = opened("plano-spherical-5dof");
    let request = json!({ "do": "pose", "pose": { "x": 10, "xi": 15 } });
    let reply = ask(&mut session, &request);
    let pose = reply.value();
    assert_eq!((&pose["reached"], &pose["within"]), (&json!(true), &json!(true)));
    assert_eq!(pose["mode"], "++ ++ ++ +");
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let si = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())]).unwrap();
    let mut buffer = manipulator.solution();
    let solution = manipulator.inverse(&si, manipulator.home_mode(), &mut buffer).unwrap().unwrap();
    let names = description["joints"].as_array().unwrap();
    let all = solution.joints().iter().chain(solution.imaginary());
    let shown = pose["values"].as_array().unwrap();
    assert_eq!(names.len(), shown.len());
    for ((joint, shown), value) in names.iter().zip(shown).zip(all) {
        let factor = match joint["unit"].as_str().unwrap() {
            "mm" => 1000.0,
            _ => 1_f64.to_degrees(),
        };
        let shown = shown.as_f64().unwrap();
        assert!((shown - value * factor).abs() < 1e-8, "{joint}");
    }
    // The platform's matrix is its displacement and its place at home.
    let bodies = description["bodies"].as_array().unwrap();
    let platform = bodies.iter().position(|body| body["name"] == "platform").unwrap();
    assert_eq!(reply.bytes.len(), bodies.len() * 64);
    let number = |i: usize| {
        let at = platform * 64 + i * 4;
        f64::from(f32::from_le_bytes(reply.bytes[at..at + 4].try_into().unwrap()))
    };
    let g = solution.displacement(&manipulator);
    let place = g * manipulator.mechanism().platform;
    let matrix = g.rotation.to_rotation_matrix();
    for row in 0..3 {
        assert!((number(12 + row) - place[row]).abs() < 1e-6);
        for column in 0..3 {
            assert!((number(4 * column + row) - matrix[(row, column)]).abs() < 1e-6);
        }
    }
    // Every mode that is listed reaches the pose, and no other does.
    let listed: Vec<&str> =
        pose["modes"].as_array().unwrap().iter().map(|m| m["mode"].as_str().unwrap()).collect();
    let reaches =
        |mode| manipulator.inverse(&si, mode, &mut manipulator.solution()).unwrap().is_some();
    let expected = manipulator.modes().filter(|&mode| reaches(mode));
    assert_eq!(listed, expected.map(|mode| manipulator.format_mode(mode)).collect::<Vec<_>>());
}

#[test]
fn a_pose_out_of_reach_names_the_leg_and_the_distance() {
    let (mut session, _) = opened("plano-spherical-5dof");
    let reply = ask(&mut session, &json!({ "do": "pose", "pose": { "y": 900 } }));
    assert!(reply.bytes.is_empty());
    let pose = reply.value();
    assert_eq!(pose["reached"], false);
    let arm = pose["out_of_reach"].as_array().unwrap();
    let arm = arm.iter().find(|missed| missed["leg"] == "leg4").unwrap();
    // The arm has its base at y = 75 mm and two links of 100 mm: it reaches to y = 275 mm.
    assert!((arm["deficit"].as_f64().unwrap() - (900.0 - 275.0)).abs() < 1e-6, "{arm}");
    assert_eq!((&arm["unit"], &arm["section"]), (&json!("mm"), &json!("lower")));
    assert_eq!(arm["text"], "lower section out of reach by 625 mm");
}

#[test]
fn forward_kinematics_give_the_pose_of_the_joints() {
    let (mut session, description) = opened("plano-spherical-5dof");
    let given = json!({ "x": 10, "y": -20, "zeta": 5, "xi": 15, "psi": 3 });
    let pose = answer(&mut session, &json!({ "do": "pose", "pose": given }));
    let joints =
        description["joints"].as_array().unwrap().iter().zip(pose["values"].as_array().unwrap());
    let actuated = joints.filter(|(joint, _)| joint["kind"] == "actuated");
    let values: serde_json::Map<String, Value> = actuated
        .map(|(joint, value)| (joint["name"].as_str().unwrap().into(), value.clone()))
        .collect();
    let request = json!({ "do": "forward", "joints": values, "pose": given });
    let found = answer(&mut session, &request);
    let nearest = found["assemblies"][0]["pose"].as_array().unwrap();
    for (value, expected) in nearest.iter().zip([10.0, -20.0, 5.0, 15.0, 3.0]) {
        assert!((value.as_f64().unwrap() - expected).abs() < 1e-6, "{nearest:?}");
    }
    let missing = problems(&mut session, &json!({ "do": "forward", "joints": {} }));
    assert_eq!(missing[0]["message"], "no value for S1");
}

/// Each number of each mechanism, set to what it is shown as, leaves the mechanism as it was.
#[test]
fn every_dimension_can_be_set_to_what_it_is() {
    let mut changed = 0;
    for example in EXAMPLES {
        let mut session = Session::default();
        let before = ask(&mut session, &json!({ "do": "open", "text": example.text })).value();
        if before.get("problems").is_some() {
            continue; // a single loop
        }
        for dimension in before["dimensions"].as_array().unwrap() {
            let (name, values) = (dimension["name"].as_str().unwrap(), &dimension["values"]);
            let after =
                answer(&mut session, &json!({ "do": "change", "changes": { name: values } }));
            assert_eq!(after["joints"], before["joints"], "{}: {name}", example.name);
            assert_same(&after["dimensions"], &before["dimensions"]);
            changed += 1;
        }
    }
    assert!(changed > 500, "{changed}");
}

/// Dimensions are the same; a direction is normalised anew, which may change the last of its twelve digits.
fn assert_same(after: &Value, before: &Value) {
    let list = |all: &Value| all.as_array().unwrap().clone();
    assert_eq!(list(after).len(), list(before).len());
    for (after, before) in list(after).iter().zip(list(before)) {
        assert_eq!(after["name"], before["name"]);
        for (after, before) in list(&after["values"]).iter().zip(list(&before["values"])) {
            let [after, before] = [after, &before].map(|v| v.as_f64().unwrap());
            assert!((after - before).abs() <= 1e-11 * before.abs().max(1e-3), "{after} {before}");
        }
    }
}

#[test]
fn a_change_changes_the_mechanism_and_none_is_the_file_again() {
    for (name, change, pose) in [
        ("plano-spherical-5dof", json!({ "leg1.h": [130] }), json!({ "x": 10 })),
        ("plano-spherical-5dof-joints", json!({ "S1.limits": [] }), json!({ "x": 10 })),
    ] {
        let (mut session, before) = opened(name);
        let changed = answer(&mut session, &json!({ "do": "change", "changes": change }));
        assert_ne!(before["dimensions"], changed["dimensions"]);
        let text = answer(&mut session, &json!({ "do": "file" }));
        // The written file is the changed mechanism.
        let written =
            Manipulator::new(file::read(text.as_str().unwrap()).unwrap().mechanism).unwrap();
        let shown = answer(&mut session, &json!({ "do": "pose", "pose": pose }));
        let pose = written.pose([("x", 0.01)]).unwrap();
        let mut buffer = written.solution();
        let solution = written.inverse(&pose, written.home_mode(), &mut buffer).unwrap().unwrap();
        let s1 = shown["values"][0].as_f64().unwrap();
        assert!((s1 - solution.joints()[0] * 1000.0).abs() < 1e-8, "{name}");
        let again = answer(&mut session, &json!({ "do": "change", "changes": {} }));
        assert_eq!(again, before);
    }
}

#[test]
fn joints_of_a_list_are_moved() {
    let (mut session, before) = opened("plano-spherical-5dof-joints");
    let dimensions = before["dimensions"].as_array().unwrap();
    let of_joint =
        |d: &&Value| d["group"] == "leg1" && d["label"].as_str().unwrap().ends_with(".point");
    let point = dimensions.iter().find(of_joint).unwrap();
    let (name, values) = (point["name"].as_str().unwrap(), point["values"].as_array().unwrap());
    let moved: Vec<f64> = values.iter().map(|v| v.as_f64().unwrap() + 1.0).collect();
    let after = answer(&mut session, &json!({ "do": "change", "changes": { name: moved } }));
    let shown = after["dimensions"].as_array().unwrap().iter().find(|d| d["name"] == name).unwrap();
    assert_eq!(shown["values"], json!(moved));
    // A revolute joint that is no longer parallel to the others breaks the decomposition, and the session goes on.
    let axis = name.replace(".point", ".axis");
    let broken =
        problems(&mut session, &json!({ "do": "change", "changes": { axis.clone(): [0, 1, 1] } }));
    assert!(!broken[0]["message"].as_str().unwrap().is_empty());
    assert!(broken[0]["place"].is_array(), "{broken:?}");
    let zero =
        problems(&mut session, &json!({ "do": "change", "changes": { axis.clone(): [0, 0, 0] } }));
    let message = zero[0]["message"].as_str().unwrap();
    assert_eq!(message, format!("`{axis}` is [0.0, 0.0, 0.0], expected a direction"));
    assert_eq!(answer(&mut session, &json!({ "do": "change", "changes": {} })), before);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let mut session = Session::default();
    let good = text("plano-spherical-5dof");
    let broken = good.replace("alpha = 30 ", "alpha = \"thirty\" ");
    let found = problems(&mut session, &json!({ "do": "open", "text": broken }));
    let line = 1 + good.lines().position(|line| line.starts_with("alpha = 30 ")).unwrap();
    assert_eq!(found[0]["place"], json!([line, 10]));
    assert_eq!(
        file::read(&broken).unwrap_err().problems[0].message,
        found[0]["message"].as_str().unwrap()
    );

    let closed = problems(&mut session, &json!({ "do": "pose" }));
    assert_eq!(closed[0]["message"], "no mechanism is open");
    answer(&mut session, &json!({ "do": "open", "text": good }));
    for request in [
        json!({ "do": "dance" }),
        json!({ "do": "pose", "pose": { "w": 1 } }),
        json!({ "do": "pose", "mode": "+" }),
        json!({ "do": "change", "changes": { "leg1.k": [1] } }),
        json!({ "do": "change", "changes": { "leg1.h": [1, 2, 3] } }),
        json!({ "do": "change", "changes": { "leg1.limits.S": [1, -1] } }),
        json!({ "do": "change", "changes": { "leg1.a1": [1e30] } }),
        json!({ "do": "slice", "x": { "name": "x", "min": 0, "max": 1, "count": 3 },
                               "y": { "name": "x", "min": 0, "max": 1, "count": 3 } }),
        json!({ "do": "slice", "x": { "name": "w", "min": 0, "max": 1, "count": 3 },
                               "y": { "name": "x", "min": 0, "max": 1, "count": 3 } }),
        json!({ "do": "slice", "x": { "name": "x", "min": 0, "max": 1, "count": 99999 },
                               "y": { "name": "y", "min": 0, "max": 1, "count": 99999 } }),
        json!({ "do": "slice", "x": { "name": "x", "min": 1, "max": 0, "count": 9 },
                               "y": { "name": "y", "min": 0, "max": 1, "count": 9 } }),
    ] {
        assert!(!problems(&mut session, &request).is_empty());
    }
    // A request that fails leaves the mechanism as it was.
    assert_eq!(answer(&mut session, &json!({ "do": "pose" }))["reached"], true);
}

/// The colours are the conditioning index and the joint values of the reachable poses, and nothing elsewhere.
#[test]
fn colours_are_numbers_of_the_reachable_poses() {
    let (mut session, _) = opened("plano-spherical-5dof");
    let axes = [
        json!({ "name": "y", "min": -200, "max": 200, "count": 21 }),
        json!({ "name": "x", "min": -200, "max": 200, "count": 17 }),
    ];
    let plane = |what: &str, by: Option<&str>| {
        let mut request = json!({ "do": what, "x": axes[0], "y": axes[1], "pose": { "xi": 20 } });
        if let Some(by) = by {
            request["by"] = json!(by);
        }
        request
    };
    let mask = ask(&mut session, &plane("slice", None)).bytes;
    let numbers = |reply: &Reply| -> Vec<f64> {
        let numbers = reply.bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
        numbers.map(f64::from).collect()
    };
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let (mut buffer, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
    let by_condition = numbers(&ask(&mut session, &plane("colours", Some("condition"))));
    let by_joint = numbers(&ask(&mut session, &plane("colours", Some("theta11"))));
    let by_transmission = numbers(&ask(&mut session, &plane("colours", Some("lti"))));
    let by_clearance = numbers(&ask(&mut session, &plane("colours", Some("clearance"))));
    let setup = Setup::new(manipulator.characteristic_length());
    let mut indices = Indices::new(&manipulator, &setup, [Index::Lti, Index::Clearance]).unwrap();
    let length = manipulator.characteristic_length();
    let mut reached = 0;
    for (number, &inside) in mask.iter().enumerate() {
        assert_eq!(by_condition[number].is_nan(), inside == 0);
        assert_eq!(by_joint[number].is_nan(), inside == 0);
        assert_eq!(by_transmission[number].is_nan(), inside == 0);
        assert_eq!(by_clearance[number].is_nan(), inside == 0);
        if inside == 0 {
            continue;
        }
        let [y, x] = [-0.2 + 0.02 * (number % 21) as f64, -0.2 + 0.025 * (number / 21) as f64];
        let pose = manipulator.pose([("x", x), ("y", y), ("xi", 20_f64.to_radians())]).unwrap();
        let found = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer);
        let solution = found.unwrap().expect("it is reachable");
        let theta = solution.imaginary()[0].to_degrees();
        assert!((by_joint[number] - theta).abs() < 1e-4);
        manipulator.differentiate(solution, &mut jacobians).unwrap();
        let index = manipulator.conditioning(&jacobians, length).condition.recip();
        assert!((by_condition[number] - index).abs() < 1e-5);
        let &[lti, clearance] = indices.evaluate(solution) else { unreachable!() };
        assert!((by_transmission[number] - lti).abs() < 1e-6);
        // Millimetres.
        assert!((by_clearance[number] - 1e3 * clearance).abs() < 1e-4);
        reached += 1;
    }
    assert!(reached > 50);
    let unknown = problems(&mut session, &plane("colours", Some("w9")));
    let message = "\"w9\" is not a joint, nor \"condition\", \"lti\" or \"clearance\"";
    assert_eq!(unknown[0]["message"], message);
    // A mechanism that has no such index says why.
    let (mut session, _) = opened("planar-planar-5dof");
    let mut request = plane("colours", Some("lti"));
    request["pose"] = json!({});
    let refused = problems(&mut session, &request);
    assert!(refused[0]["message"].as_str().unwrap().starts_with("lti: "), "{refused:?}");
}

#[test]
fn every_shipped_mechanism_with_a_pose_can_be_explored() {
    let list = answer(&mut Session::default(), &json!({ "do": "examples" }));
    let names: Vec<&str> =
        list.as_array().unwrap().iter().map(|e| e["name"].as_str().unwrap()).collect();
    assert_eq!(names, EXAMPLES.iter().map(|example| example.name).collect::<Vec<_>>());
    // Bennett's loops have no pose to ask for: `opm linkage` is for them.
    for name in names.into_iter().filter(|name| !name.starts_with("bennett")) {
        let (mut session, description) = opened(name);
        let reply = ask(&mut session, &json!({ "do": "pose" }));
        let home = reply.value();
        assert_eq!(
            (&home["reached"], &home["mode"]),
            (&json!(true), &description["home_mode"]),
            "{name}"
        );
        let joints = description["joints"].as_array().unwrap();
        for (joint, value) in joints.iter().zip(home["values"].as_array().unwrap()) {
            let [value, home] = [value, &joint["home"]].map(|v| v.as_f64().unwrap());
            assert!((value - home).abs() < 1e-6, "{name}: {joint}");
        }
        assert_eq!(reply.bytes.len(), description["bodies"].as_array().unwrap().len() * 64);
    }
}
