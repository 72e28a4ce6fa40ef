//! What is serialised has the names and numbers that the getters have.

#![cfg(all(feature = "serde", feature = "files"))]

use opm_core::Manipulator;
use serde_json::{Value, json};

#[test]
fn solutions_and_assemblies_are_serialised() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let (mode, mut buffer) = (manipulator.home_mode(), manipulator.solution());
    let pose = manipulator.pose([("x", 0.01), ("xi", 0.26)]).unwrap();
    let solution = manipulator.inverse(&pose, mode, &mut buffer).unwrap().unwrap();
    let expected = json!({
        "joints": solution.joints(),
        "imaginary": solution.imaginary(),
        "within_limits": true,
        "unreachable": [],
    });
    assert_eq!(serde_json::to_value(solution).unwrap(), expected);

    let actuated: Vec<f64> =
        manipulator.actuated().iter().map(|&number| solution.joints()[number]).collect();
    let assemblies = serde_json::to_value(manipulator.forward(&actuated).unwrap()).unwrap();
    let poses: Vec<&Value> =
        assemblies["list"].as_array().unwrap().iter().map(|a| &a["pose"]).collect();
    let near = |found: &Value| {
        let numbers = found.as_array().unwrap().iter().map(|q| q.as_f64().unwrap());
        numbers.zip(&pose).all(|(a, b)| (a - b).abs() < 1e-9)
    };
    assert!(poses.into_iter().any(near));

    let far = [9.0, 0.0, 0.0, 0.0, 0.0];
    assert!(manipulator.inverse(&far, mode, &mut buffer).unwrap().is_none());
    let unreachable = &serde_json::to_value(&buffer).unwrap()["unreachable"];
    assert_eq!(unreachable[0]["leg"], buffer.unreachable()[0].leg);
    assert_eq!(unreachable[0]["deficit"]["quantity"], "Length");
}

#[test]
fn mechanisms_are_serialised() {
    let manipulator = Manipulator::example("schoenflies-4dof").unwrap();
    let mechanism = serde_json::to_value(manipulator.mechanism()).unwrap();
    let legs = mechanism["legs"].as_array().unwrap();
    assert_eq!(legs.len(), manipulator.mechanism().legs.len());
    let first = &manipulator.mechanism().legs[0].joints[0];
    assert_eq!(legs[0]["joints"][0]["name"], *first.name);
    assert_eq!(legs[0]["joints"][0]["actuated"], first.actuated);
}
