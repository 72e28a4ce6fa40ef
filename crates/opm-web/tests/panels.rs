//! Bodies, kinds of workspace, motions and handles, compared with the library asked directly.

use opm_core::mechanism::examples::find;
use opm_core::motion::{Instant, examples::MOTIONS, file};
use opm_core::{Manipulator, Solution};
use opm_web::{Reply, Session};
use opm_workspace::{Modes, Progress, Sweep, Visits, default_grid};
use serde_json::{Value, json};

fn ask(session: &mut Session, request: &Value) -> Reply {
    let reply = session.answer(&request.to_string());
    assert!(reply.value().get("problems").is_none(), "{request}: {}", reply.text);
    reply
}

fn problem(session: &mut Session, request: &Value) -> String {
    let value = session.answer(&request.to_string()).value();
    value["problems"][0]["message"].as_str().unwrap_or_else(|| panic!("{value}")).to_owned()
}

fn opened(name: &str) -> (Session, Manipulator) {
    let mut session = Session::default();
    let text = find(name).expect("a shipped example").text;
    ask(&mut session, &json!({ "do": "open", "text": text }));
    (session, Manipulator::example(name).expect("a shipped example"))
}

fn reached(manipulator: &Manipulator, pose: &[f64], buffer: &mut Solution) -> bool {
    let found = manipulator.inverse(pose, manipulator.home_mode(), buffer).unwrap();
    found.is_some_and(Solution::within_limits)
}

fn values(min: f64, max: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| min + (max - min) * i as f64 / (count - 1) as f64).collect()
}

/// Each point of a body at a pose is what inverse kinematics say of it.
#[test]
fn a_body_at_a_pose_has_the_points_that_are_reached() {
    let (mut session, manipulator) = opened("plano-spherical-5dof");
    let fitted = ask(&mut session, &json!({ "do": "fit" })).value();
    let request = json!({ "do": "body", "axes": ["psi", "x", "xi"], "others": "pose",
                          "pose": { "y": 12.5, "zeta": -8, "x": 1e6 } });
    let body = ask(&mut session, &request).value();
    let axis = |name: &str| {
        let axes = fitted["axes"].as_array().unwrap();
        let axis = axes.iter().find(|axis| axis["name"] == name).unwrap();
        let si = if name == "x" { 1e-3 } else { 1_f64.to_radians() };
        let [min, max] = ["min", "max"].map(|end| si * axis[end].as_f64().unwrap());
        values(min, max, 61)
    };
    let (mut count, mut buffer) = (0_u64, manipulator.solution());
    for &psi in &axis("psi") {
        for &x in &axis("x") {
            for &xi in &axis("xi") {
                let given = [x, 0.0125, (-8.0_f64).to_radians(), xi, psi];
                count += u64::from(reached(&manipulator, &given, &mut buffer));
            }
        }
    }
    assert_eq!(body["points"], 61_u64.pow(3));
    // Ends of the fitted range are rounded where they are shown, so that poses at a boundary may differ.
    let inside = body["inside"].as_u64().unwrap();
    assert!(count > 1000 && inside.abs_diff(count) <= count / 2000, "{inside} {count}");
}

/// With other coordinates at any value, it is the projection that the library knows for places.
#[test]
fn a_body_at_any_other_values_is_the_projection() {
    for name in ["cartesian-wrist-6dof", "translational-helical-3dof"] {
        let (mut session, manipulator) = opened(name);
        ask(&mut session, &json!({ "do": "fit" }));
        let modes = Modes::One(manipulator.home_mode());
        let (grid, _) = default_grid(&manipulator, modes, &Progress::default()).unwrap();
        let sweep = Sweep::new(&manipulator, &grid, modes);
        let names: Vec<&str> = grid.axes().iter().map(|axis| &*axis.name).collect();
        let expected = match names.len() {
            3 => sweep.count(&Progress::default()).unwrap().reachable,
            _ => Visits::new(&sweep, &Progress::default()).unwrap().reachable().unwrap().count(),
        };
        let places = &names[..3];
        for axes in [[0, 1, 2], [2, 0, 1], [1, 2, 0]].map(|order| order.map(|i| places[i])) {
            let request = json!({ "do": "body", "axes": axes, "others": "any" });
            let reply = ask(&mut session, &request);
            let body = reply.value();
            assert_eq!(body["inside"], expected, "{name}: {axes:?}");
            let [corners, triangles] =
                ["corners", "triangles"].map(|key| body[key].as_u64().unwrap() as usize);
            assert_eq!(reply.bytes.len(), 12 * (2 * corners + triangles));
        }
        let twice =
            json!({ "do": "body", "axes": [places[0], places[1], places[0]], "others": "any" });
        assert_eq!(problem(&mut session, &twice), "expected three different coordinates");
    }
}

/// The points of an axis as the command's option gives it, SI.
fn axis(options: &[String], name: &str) -> Vec<f64> {
    let range = options.iter().find_map(|option| option.strip_prefix(&format!("{name}=")));
    let mut parts = range.unwrap_or_else(|| panic!("no {name} in {options:?}")).split(':');
    let mut next = || parts.next().map(str::to_owned);
    let si = |text: &str| match text.strip_suffix("mm") {
        Some(number) => number.parse::<f64>().unwrap() * 1e-3,
        None => text.strip_suffix("deg").unwrap().parse::<f64>().unwrap().to_radians(),
    };
    let min = si(&next().unwrap());
    match (next(), next()) {
        (Some(max), Some(count)) => values(min, si(&max), count.parse().unwrap()),
        _ => vec![min],
    }
}

/// A place is dexterous if each orientation is reached there, and reachable if one is.
#[test]
fn kinds_of_places_are_what_their_names_say() {
    let (mut session, manipulator) = opened("plano-spherical-5dof");
    let mut buffer = manipulator.solution();
    for (kind, all) in [("dexterous", true), ("reachable", false)] {
        let request = json!({ "do": "kind", "kind": kind, "turn": 20, "pose": { "xi": 30 } });
        let found = ask(&mut session, &request).value();
        let options: Vec<String> = serde_json::from_value(found["options"].clone()).unwrap();
        let axes = ["x", "y", "zeta", "xi", "psi"].map(|name| axis(&options, name));
        assert_eq!(axes[3].len(), 5);
        assert!((axes[3][0] - 10_f64.to_radians()).abs() < 1e-12);
        let mut count = 0;
        for &y in &axes[1] {
            for &x in &axes[0] {
                let mut turns = axes[2].iter().flat_map(|&zeta| {
                    let psi = &axes[4];
                    axes[3].iter().flat_map(move |&xi| psi.iter().map(move |&psi| [zeta, xi, psi]))
                });
                let mut at = |[zeta, xi, psi]: [f64; 3]| {
                    reached(&manipulator, &[x, y, zeta, xi, psi], &mut buffer)
                };
                count += u64::from(if all { turns.all(at) } else { turns.any(&mut at) });
            }
        }
        let members = found["members"].as_u64().unwrap();
        assert!(count > 50 && members.abs_diff(count) <= 2, "{kind}: {members} {count}");
        let cell = (axes[0][1] - axes[0][0]) * (axes[1][1] - axes[1][0]) * 1e6;
        let [across, upwards] = [axes[0].len() as f64, axes[1].len() as f64];
        let area = members as f64 * cell * (across - 1.0) * (upwards - 1.0) / (across * upwards);
        assert!((found["measure"].as_f64().unwrap() / area - 1.0).abs() < 1e-9);
        assert_eq!((&found["unit"], &found["varying"]), (&json!("mm^2"), &json!(["x", "y"])));
    }
    assert!(problem(&mut session, &json!({ "do": "kind", "kind": "round" })).contains("round"));
}

/// A kind is measured on the grid of the mechanism as it was at the last fit, and in a mode of its own.
#[test]
fn grids_of_kinds_are_those_of_the_last_fit_and_of_the_mode() {
    let (mut session, _) = opened("plano-spherical-5dof");
    let other = "-+ ++ +- -";
    let kind = |mode: Option<&str>| json!({ "do": "kind", "kind": "reachable", "mode": mode });
    let change = json!({ "do": "change", "changes": { "leg4.b1": [70] } });
    for mode in [None, Some(other)] {
        ask(&mut session, &kind(mode));
    }
    ask(&mut session, &change);
    ask(&mut session, &json!({ "do": "fit" }));
    for mode in [None, Some(other)] {
        let (mut fresh, _) = opened("plano-spherical-5dof");
        ask(&mut fresh, &change);
        assert_eq!(ask(&mut session, &kind(mode)), ask(&mut fresh, &kind(mode)));
    }
}

#[test]
fn problems_have_the_file_and_the_kind_that_the_page_needs() {
    let mut session = Session::default();
    let request = json!({ "do": "open", "name": "a.toml", "text": "legs = 3\n" });
    let open = session.answer(&request.to_string()).value();
    assert_eq!(open["problems"][0]["file"], "a.toml");
    let (mut session, _) = opened("plano-spherical-5dof");
    let mut first =
        |request: Value| session.answer(&request.to_string()).value()["problems"][0].clone();
    let motion = first(json!({ "do": "motion", "name": "away.csv", "text": "t,y\n0,zero\n1,0\n" }));
    assert_eq!((&motion["file"], &motion["place"]), (&json!("away.csv"), &json!([2, 3])));
    let mode = first(json!({ "do": "pose", "mode": "zzz" }));
    assert_eq!((&mode["kind"], &mode["file"]), (&json!("mode"), &Value::Null));
    let axis = |name: &str, min: f64| json!({ "name": name, "min": min, "max": 270, "count": 3 });
    let slice = first(json!({ "do": "slice", "x": axis("x", 500.0), "y": axis("y", -10.0) }));
    let expected = "slice along x: 3 values from 500 to 270 mm, expected the smaller end first";
    assert_eq!(slice["message"], expected);
}

#[test]
fn kinds_that_a_mechanism_has_not_are_refused_with_the_reason() {
    let (mut session, _) = opened("agile-eye");
    let kinds = ask(&mut session, &json!({ "do": "kinds" })).value();
    for kind in kinds.as_array().unwrap() {
        let name = kind["name"].as_str().unwrap();
        let request = json!({ "do": "kind", "kind": name });
        match kind["refused"].as_str() {
            Some(reason) => assert!(problem(&mut session, &request).contains(reason), "{name}"),
            None => assert!(ask(&mut session, &request).value()["points"].as_u64() > Some(0)),
        }
    }
    assert!(kinds[4]["refused"].is_string(), "a wrist has no places: {kinds}");
}

/// Rows are the poses of the motion's formula, with the joints of inverse kinematics.
#[test]
fn a_motion_is_followed_as_its_formula_says() {
    let (mut session, manipulator) = opened("plano-spherical-5dof");
    let shipped = ask(&mut session, &json!({ "do": "motions" })).value();
    assert_eq!(shipped[0]["mechanism"], "plano-spherical-5dof");
    let request = json!({ "do": "motion", "name": "a.toml", "text": shipped[0]["text"] });
    let reply = ask(&mut session, &request);
    let followed = reply.value();
    assert_eq!((&followed["samples"], &followed["valid"]), (&json!(1001), &json!(1001)));
    assert_eq!(followed["violation_count"], 0);
    let columns = followed["columns"].as_u64().unwrap() as usize;
    let numbers: Vec<f64> =
        reply.bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()).into()).collect();
    assert_eq!(numbers.len(), 1001 * columns);
    let motion = file::read(MOTIONS[0].text, &manipulator).unwrap();
    let (mut instant, mut buffer) = (Instant::new(5), manipulator.solution());
    for row in numbers.chunks(columns).step_by(97) {
        motion.at(row[0], &mut instant);
        let found = manipulator.inverse(&instant.pose, manipulator.home_mode(), &mut buffer);
        let s1 = found.unwrap().unwrap().joints()[0] * 1000.0;
        for (shown, value) in
            [(row[1], instant.pose[0] * 1e3), (row[4], instant.pose[3].to_degrees()), (row[6], s1)]
        {
            assert!((shown - value).abs() < 1e-3, "{shown} {value} at {} s", row[0]);
        }
    }
}

/// Where a table leaves the workspace, the violation starts between the last pose in reach and the first out of it.
#[test]
fn a_motion_out_of_reach_says_when_and_which_leg() {
    let (mut session, manipulator) = opened("plano-spherical-5dof");
    let text = "t,y [mm]\n0,0\n1,600\n";
    let request = json!({ "do": "motion", "name": "out.CSV", "text": text });
    let reply = ask(&mut session, &request);
    let followed = reply.value();
    let list = followed["violations"].as_array().unwrap();
    let reach = list.iter().find(|v| v["kind"] == "reach").unwrap_or_else(|| panic!("{followed}"));
    assert!(reach["text"].as_str().unwrap().starts_with("leg"), "{reach}");
    let start = list.iter().filter(|v| v["kind"] == "reach").map(|v| v["start"].as_f64().unwrap());
    let start = start.fold(f64::INFINITY, f64::min);
    let motion = opm_core::motion::table::read(text, "out", &manipulator, &Default::default())
        .unwrap()
        .motion;
    let (mut instant, mut buffer) = (Instant::new(5), manipulator.solution());
    for (time, expected) in [(start - 1e-6, true), (start + 1e-6, false)] {
        motion.at(time, &mut instant);
        let found = manipulator.inverse(&instant.pose, manipulator.home_mode(), &mut buffer);
        assert_eq!(found.unwrap().is_some(), expected, "{time}");
    }
    // The last pose is out of reach: it has no joints.
    let last = &reply.bytes[reply.bytes.len() - 4..];
    assert!(f32::from_le_bytes(last.try_into().unwrap()).is_nan());
    let wrong = json!({ "do": "motion", "name": "a.csv", "text": "t,w\n0,0\n1,1\n" });
    assert!(problem(&mut session, &wrong).contains('w'));
}

/// The platform is shifted by lengths, and turned by angles: by as much as they change.
#[test]
fn handles_move_the_platform_as_its_coordinates_do() {
    let (mut session, manipulator) = opened("plano-spherical-5dof");
    let request = json!({ "do": "pose", "pose": { "x": 10, "zeta": 30, "xi": 15 } });
    let handles = &ask(&mut session, &request).value()["handles"];
    let vector = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
    let pose = [("x", 0.01), ("zeta", 30_f64.to_radians()), ("xi", 15_f64.to_radians())];
    let placed = manipulator.platform_pose(&manipulator.pose(pose).unwrap()).unwrap();
    let near = |one: &[f64], other: &[f64]| {
        assert!(one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-8), "{one:?} {other:?}");
    };
    near(&vector(&handles["at"]), placed.translation.vector.as_slice());
    near(&vector(&handles["moves"][0]["shift"]), &[1.0, 0.0, 0.0]);
    near(&vector(&handles["moves"][1]["shift"]), &[0.0, 1.0, 0.0]);
    near(&vector(&handles["moves"][0]["turn"]), &[0.0; 3]);
    for i in 2..5 {
        let turn = vector(&handles["moves"][i]["turn"]);
        near(&[turn.iter().map(|c| c * c).sum::<f64>()], &[1.0]);
    }
    let away = ask(&mut session, &json!({ "do": "pose", "pose": { "y": 900 } })).value();
    assert!(away["handles"].is_null());
}

/// A post through the place to which the platform goes: their axes meet, so the overlap is the sum of the radii.
#[test]
fn what_overlaps_or_is_too_near_is_named() {
    let post = "\n[bodies]\nradius = 4\n[[obstacle]]\nname = \"post\"\ntype = \"capsule\"\n\
                from = [90, 60, -500]\nto = [90, 60, 500]\nradius = 5\n";
    let text = find("plano-spherical-5dof").expect("a shipped example").text.to_owned() + post;
    let mut session = Session::default();
    let description = ask(&mut session, &json!({ "do": "open", "text": text })).value();
    let bodies = description["bodies"].as_array().unwrap();
    let of_post = bodies.iter().find(|body| body["name"] == "post").unwrap();
    let solids = of_post["solids"].as_array().unwrap();
    assert!(solids.iter().all(|s| s["material"] == "obstacle" && s["member"] == "post"));
    let mut at = |x: f64, y: f64, clearance: f64| {
        let pose = json!({ "x": x, "y": y });
        let reply =
            ask(&mut session, &json!({ "do": "pose", "pose": pose, "clearance": clearance }));
        // Obstacles have a place, too.
        assert_eq!(reply.bytes.len(), 64 * bodies.len());
        reply.value()["contacts"].take()
    };
    let hit = at(90.0, 60.0, 0.0);
    let near: Vec<&str> =
        hit["near"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(near.contains(&"post") && near.contains(&"platform"), "{hit}");
    assert_eq!(hit["overlap"], true);
    let nearest = hit["nearest"].as_str().unwrap();
    assert!(
        nearest.starts_with("interference: ") && nearest.ends_with("overlapping by 9 mm"),
        "{hit}"
    );
    // Every name is that of solids which can be shown red.
    let members = bodies.iter().flat_map(|body| body["solids"].as_array().unwrap());
    let members: Vec<&str> = members.filter_map(|solid| solid["member"].as_str()).collect();
    assert!(near.iter().all(|name| members.contains(name)), "{near:?}");

    let apart = at(0.0, 0.0, 0.0);
    assert_eq!((&apart["near"], &apart["overlap"]), (&json!([]), &json!(false)));
    assert!(apart["nearest"].as_str().unwrap().ends_with(" mm apart"), "{apart}");
    let all = at(0.0, 0.0, 1000.0);
    assert!(all["near"].as_array().unwrap().contains(&json!("post")) && all["overlap"] == false);
    let wrong = problem(&mut session, &json!({ "do": "pose", "clearance": -1 }));
    assert_eq!(wrong, "the clearance is -1 mm, expected 0 or more");
}
