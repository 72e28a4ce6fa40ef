//! Files that are nearly right: joints in a wrong order, joints slightly off, and where a tool's tip is.

use crate::run::{Folder, number, opm};
use serde_json::json;

/// The manipulator of the paper as a list of joints, with some text replaced in the line of a joint.
fn with_joint(folder: &Folder, name: &str, from: &str, to: &str) -> String {
    let shipped = opm(&["examples", "plano-spherical-5dof-joints"]).text().to_owned();
    let line = shipped.lines().find(|line| line.contains(&format!("\"{name}\""))).unwrap();
    assert!(line.contains(from), "{line}");
    folder.write("off.toml", shipped.replace(line, &line.replace(from, to)))
}

#[test]
fn two_joints_in_a_wrong_order_are_named() {
    let folder = Folder::new();
    let shipped = opm(&["examples", "plano-spherical-5dof-joints"]).text().to_owned();
    let line =
        |name: &str| shipped.lines().find(|line| line.contains(&format!("\"{name}\""))).unwrap();
    let (below, above) = (line("phi22"), line("theta22"));
    let swapped = shipped.replace(&format!("{below}\n{above}"), &format!("{above}\n{below}"));
    assert_ne!(swapped, shipped);
    let file = folder.write("order.toml", swapped);
    let told = "leg leg2: exchange theta22 and phi22: then it decomposes into planar and spherical";
    opm(&["ik", &file, "--pose", ""]).fails_with_one_line(1, &["order.toml:24:1: ", told]);
    let found = opm(&["decompose", &file]);
    assert!(found.text().contains(told), "{}", found.text());
    let json = opm(&["decompose", &file, "--format", "json"]).json();
    assert!(json["because"].as_str().unwrap().ends_with(told), "{json}");
}

/// The mechanism decomposes; every command says which joint is off.
#[test]
fn a_joint_that_is_slightly_off_is_named_by_every_command() {
    let folder = Folder::new();
    let file = with_joint(&folder, "theta32", "point = [0, 0, 0]", "point = [0.01, 0, 0]");
    // The point is 0.01 mm off along x, and the axis (-0.433, 0.75, 0.5).
    let told = "joint theta32 of leg leg2: its axis passes the centre of the others at 0.0090 mm";
    let hint = "--tolerance 0.0092mm accepts and snaps it";
    for args in [
        &["decompose", &file][..],
        &["ik", &file, "--pose", "x=1mm"],
        &["velocity", &file, "--pose", "x=1mm,xi=5deg"],
        &["workspace", &file, "--grid", "x=0:0.01:2", "--grid", "y=0", "--grid", "xi=0.1"],
    ] {
        let run = opm(args);
        let lines: Vec<&str> = run.stderr.lines().filter(|line| line.contains(told)).collect();
        assert!(lines.len() == 1 && lines[0].contains(hint), "{args:?}: {}", run.stderr);
    }
    let snapped = opm(&["ik", &file, "--pose", "x=1mm", "--tolerance", "0.0092mm"]);
    assert!(snapped.stderr.contains("snapped joint theta32"), "{}", snapped.stderr);
    assert_eq!(opm(&["ik", &file, "--pose", "x=1mm", "--quiet"]).stderr, "");
}

/// The tip of a tool is 10, 20 and 50 mm from the centre of a wrist.
#[test]
fn a_wrist_with_a_tool_has_one_reference_point() {
    let folder = Folder::new();
    let wrist = opm(&["examples", "agile-eye"]).text().to_owned();
    let point = wrist.lines().find(|line| line.starts_with("point = ")).unwrap();
    let file = folder
        .write("wrist.toml", wrist.replace(&format!("\n{point}\n"), "\npoint = [10, 20, 50]\n"));
    let found = opm(&["decompose", &file, "--format", "json", "--quiet"]).json();
    assert_eq!(found["reference_point"], json!([0.01, 0.02, 0.05]));
    assert_eq!(found["frames"]["lower"]["centre"], json!([0.0, 0.0, 0.0]));
    let text = opm(&["decompose", &file, "--quiet"]);
    let told = "reference point of the platform at home: (10, 20, 50) mm; --transform and velocities are about it";
    assert!(text.text().contains(told), "{}", text.text());
    assert_eq!(text.text().matches("reference point").count(), 1);

    let at = |transform: &str| {
        opm(&["ik", &file, "--transform", transform, "--format", "json", "--quiet"]).json()
    };
    let home = at("10mm,20mm,50mm,1,0,0,0");
    assert_eq!((&home["reachable"], &home["outside"]), (&json!(true), &json!(null)));
    // The centre is sqrt(10^2 + 20^2 + 50^2) mm away from where the tip can be.
    let centre = at("0,0,0,1,0,0,0");
    let off = centre["outside"]["translation"].as_array().unwrap();
    let off: f64 = off.iter().map(|part| number(part).powi(2)).sum();
    assert!((off.sqrt() - 3000_f64.sqrt() * 1e-3).abs() < 1e-6, "{centre}");
    let run = opm(&["ik", &file, "--transform", "0,0,0,1,0,0,0", "--quiet"]);
    let told = "it places the reference point, which is at (10, 20, 50) mm at home";
    assert!(run.text().contains(told), "{}", run.text());
    // The pose in SE(3) of the answer says where the tip goes: turned by half a turn about z.
    let turned = opm(&["ik", &file, "--pose", "zeta=180deg", "--format", "json", "--quiet"]).json();
    let position: Vec<f64> =
        turned["transform"]["position"].as_array().unwrap().iter().map(number).collect();
    for (found, expected) in position.iter().zip([-0.01, -0.02, 0.05]) {
        assert!((found - expected).abs() < 1e-12, "{position:?}");
    }
}
