//! What commands say about the distances of bodies.

use crate::PLANO;
use crate::run::{Folder, number, opm};
use serde_json::json;

const SINUSOIDS: &str = "plano-spherical-sinusoids";

/// A ball over the platform's reference point of a planar mechanism, whose links are in the plane z = 0.
fn ball_over_platform(folder: &Folder, radius: f64) -> String {
    let text = opm(&["convert", "planar-3rrr"]).text().to_owned();
    let shapes = format!(
        "\n[bodies]\nradius = 2\n\n[[obstacle]]\nname = \"ball\"\ntype = \"capsule\"\nfrom = [0, 0, 30]\nto = [0, 0, 30]\nradius = {radius}\n"
    );
    folder.write("ball.toml", format!("{text}{shapes}"))
}

#[test]
fn the_nearest_bodies_are_named() {
    let folder = Folder::new();
    for (radius, distance) in [(5.0, 0.023), (40.0, -0.012)] {
        let file = ball_over_platform(&folder, radius);
        let found = opm(&["ik", &file, "--pose", "", "--format", "json"]).json();
        let nearest = &found["solutions"][0]["nearest"];
        if distance > 0.0 {
            assert_eq!(nearest["pair"], json!(["platform", "ball"]));
            assert!((number(&nearest["distance"]) - distance).abs() < 1e-9, "{nearest}");
            assert_eq!(found["set_aside"], json!([]));
            let text = opm(&["ik", &file, "--pose", ""]).text().to_owned();
            assert!(text.contains("nearest: platform and ball, 23 mm apart"), "{text}");
        } else {
            // It overlaps at home, and is named in place of being tested.
            let aside = found["set_aside"].as_array().unwrap();
            let own =
                aside.iter().find(|pair| pair["pair"] == json!(["platform", "ball"])).unwrap();
            assert!((number(&own["overlap"]) + distance).abs() < 1e-9, "{own}");
            let text = opm(&["ik", &file, "--pose", ""]).text().to_owned();
            assert!(text.contains("overlap at home: "), "{text}");
        }
    }
}

#[test]
fn a_motion_has_contacts_and_strict_fails() {
    let run = |more: &[&str]| {
        let all = [&["trajectory", PLANO, "--motion", SINUSOIDS][..], more].concat();
        opm(&all)
    };
    let found = run(&["--clearance", "1", "--format", "json", "--quiet"]).json();
    let contacts = found["interference"]["contacts"].as_array().unwrap();
    // Nothing of this mechanism is a metre apart: every pair is a contact from start to end.
    assert!(contacts.len() > 50);
    for contact in contacts {
        assert_eq!((number(&contact["start"]), number(&contact["end"])), (0.0, 10.0));
    }
    let least = contacts.iter().map(|c| number(&c["distance"])).fold(f64::MAX, f64::min);
    assert_eq!(number(&found["interference"]["nearest"]["distance"]), least);
    let strict = run(&["--clearance", "1m", "--strict"]);
    assert_eq!(strict.code, Some(1));
    assert!(strict.stderr.contains("bodies interfere (--strict)"), "{}", strict.stderr);
    let wrong = run(&["--clearance", "5deg"]);
    assert_eq!(wrong.code, Some(2), "{}", wrong.stderr);
    assert!(wrong.stderr.contains("--clearance"), "{}", wrong.stderr);
}

#[test]
fn a_workspace_keeps_a_clearance() {
    let run = |more: &[&str]| {
        let grid = ["workspace", PLANO, "--grid", "x=-0.1:0.1:21", "--grid", "y=-0.1:0.1:21"];
        opm(&[&grid[..], more].concat())
    };
    let count = |more: &[&str]| {
        let found = run(&[more, &["--format", "json", "--quiet"]].concat()).json();
        number(&found["reachable"])
    };
    let counts = [count(&[]), count(&["--clearance", "0"]), count(&["--clearance", "3mm"])];
    assert!(counts[0] >= counts[1] && counts[1] > counts[2], "{counts:?}");
    assert_eq!(count(&["--clearance", "10m"]), 0.0);
    for (more, part) in [
        (&["--clearance", "-1mm"][..], "expected a length of 0 or more"),
        (&["--clearance", "1mm", "--mode", "any"], "bodies are elsewhere in each mode"),
        (&["--clearance", "1mm", "--kind", "upper"], "a section alone has no clearance"),
    ] {
        let wrong = run(more);
        assert_eq!(wrong.code, Some(2), "{}", wrong.stderr);
        assert!(wrong.stderr.contains(part), "{}", wrong.stderr);
    }
}

#[test]
fn interfering_bodies_are_red_in_pictures() {
    let folder = Folder::new();
    let file = ball_over_platform(&folder, 20.0);
    let picture = |pose: &str, name: &str| {
        opm(&["plot", &file, "--pose", pose, "-o", &folder.arg(name)]).text();
        folder.read(name)
    };
    let home = picture("x=0", "home.svg");
    assert!(home.contains("obstacle") && !home.contains("interfering"));
    // A large ball at the side is reached by a link as the platform moves there.
    let text = folder.read("ball.toml");
    let text = text.replace("= [0, 0, 30]", "= [90, 0, 0]");
    folder.write("ball.toml", text);
    let near = opm(&["ik", &file, "--pose", "x=60mm", "--format", "json"]).json();
    assert!(number(&near["solutions"][0]["nearest"]["distance"]) < 0.0, "{near}");
    assert!(picture("x=60mm", "near.svg").contains("interfering"));
}
