//! What is probably a mistake in a mechanism file is told; nothing of the shipped mechanisms.

use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{check_actuators, doubts, missing_motors};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::examples::{EXAMPLES, find};
use opm_core::mechanism::file;

fn told(mechanism: &Mechanism) -> Vec<String> {
    doubts(mechanism)
}

/// A shipped mechanism with some of its text exchanged.
fn changed(name: &str, changes: &[(&str, &str)]) -> Mechanism {
    let mut text = find(name).unwrap().text.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    file::read(&text).unwrap().mechanism
}

#[test]
fn nothing_is_doubtful_in_what_is_shipped() {
    for example in EXAMPLES {
        let mechanism = file::read(example.text).unwrap().mechanism;
        assert_eq!(told(&mechanism), Vec::<String>::new(), "{}", example.name);
    }
}

#[test]
fn radians_in_a_file_in_degrees() {
    let limited = |limits: &str| {
        let joint = format!("name = \"C{{i}}\", limits = {limits}, type");
        changed("planar-3rrr", &[("name = \"C{i}\", type", &joint)])
    };
    let [doubt] = &told(&limited("[-1.57, 1.57]"))[..] else { panic!("one doubt") };
    assert!(doubt.starts_with("the limits of C1, C2, C3 are at most 1.57 deg"), "{doubt}");
    assert!(told(&limited("[-90, 90]")).is_empty());
    // One end far away: degrees.
    assert!(told(&limited("[-1.5, 60]")).is_empty());
}

#[test]
fn metres_in_a_file_in_millimetres() {
    let metres = [
        ("value = 331", "value = 0.331"),
        ("value = 75.06", "value = 0.07506"),
        ("value = 166", "value = 0.166"),
        ("value = 110", "value = 0.11"),
    ];
    let [doubt] = &told(&changed("planar-3rrr", &metres))[..] else { panic!("one doubt") };
    assert!(doubt.contains("write units.length = \"m\""), "{doubt}");
    let mut inches = metres.to_vec();
    inches.push(("length = \"mm\"", "length = \"in\""));
    assert_eq!(told(&changed("planar-3rrr", &inches)).len(), 1);
    inches.pop();
    inches.push(("length = \"mm\"", "length = \"m\""));
    assert!(told(&changed("planar-3rrr", &inches)).is_empty());
}

/// The motor is 116.04 mm from its corner of the platform.
#[test]
fn links_in_line() {
    let links = |lower: &str, upper: &str| {
        let (lower, upper) = (format!("value = {lower}"), format!("value = {upper}"));
        told(&changed("planar-3rrr", &[("value = 166", &lower), ("value = 110", &upper)]))
    };
    let stretched = links("60", "56.06");
    assert_eq!(stretched.len(), 3, "{stretched:?}");
    assert!(stretched[0].starts_with("leg1: the links A1-B1 and B1-C1"), "{stretched:?}");
    let folded = links("20", "136.02");
    assert_eq!(folded.len(), 3, "{folded:?}");
    assert!(links("60", "70").is_empty());
    // A crank in line with its rod: the rod of this Delta is as long as is needed.
    let delta = told(&changed("delta", &[("rod = { value = 1244", "rod = { value = 2000")]));
    assert!(delta.is_empty(), "{delta:?}");
}

#[test]
fn a_motor_that_was_forgotten() {
    let mut compared = 0;
    for example in EXAMPLES {
        let whole = file::read(example.text).unwrap().mechanism;
        let report = mobility(&whole).unwrap();
        if check_actuators(&report).is_err() || report.actuators > report.controlled {
            continue;
        }
        for leg in 0..whole.legs.len() {
            let mut less = whole.clone();
            let Some(joint) = less.legs[leg].joints.iter_mut().find(|joint| joint.actuated) else {
                continue;
            };
            let name = joint.name.clone();
            joint.actuated = false;
            let report = mobility(&less).unwrap();
            if check_actuators(&report).is_ok() || whole.legs.len() == 2 {
                continue;
            }
            let doubt =
                missing_motors(&less, &report).unwrap_or_else(|| panic!("{} {name}", example.name));
            // What is named completes the set.
            let named = doubt.split(" at ").nth(1).unwrap().split(" complete").next().unwrap();
            for joint in less.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
                joint.actuated |= named.split(", ").any(|one| one == joint.name);
            }
            assert!(
                check_actuators(&mobility(&less).unwrap()).is_ok(),
                "{}: {doubt}",
                example.name
            );
            compared += 1;
        }
    }
    assert!(compared > 40, "{compared}");
}
