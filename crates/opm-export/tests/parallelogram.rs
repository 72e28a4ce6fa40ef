//! Models of a mechanism with parallelograms hold both hinges of each together.

use opm_core::mechanism::file;
use opm_core::skeleton::Density;
use opm_export::{Keyframes, MjcfOptions, mjcf, urdf};
use roxmltree::{Document, Node};

/// Two sliders on a rail, each with a parallelogram.
const TEXT: &str = include_str!("../../../tests/tests/parallelograms/rail.toml");

fn all<'a>(model: &'a Document<'_>, parent: &str, kind: &str) -> Vec<Node<'a, 'a>> {
    let parents = model.descendants().filter(|node| node.has_tag_name(parent));
    parents.flat_map(|node| node.children()).filter(|node| node.has_tag_name(kind)).collect()
}

#[test]
fn hinges_of_a_parallelogram_are_held_together() {
    let turned = TEXT.replacen("point2 = [-50, 0, -300]", "point2 = [-50, 0, -300], home = 30", 1);
    assert_ne!(turned, TEXT);
    let mechanism = file::read(&turned).expect("a mechanism").mechanism;
    let text = mjcf(&Keyframes::of(&mechanism), &MjcfOptions::default());
    let model = Document::parse(&text).expect("XML");
    let held: Vec<_> = all(&model, "equality", "joint")
        .iter()
        .map(|node| ["joint1", "joint2", "polycoef"].map(|key| node.attribute(key).unwrap()))
        .collect();
    assert_eq!(held, [["p1.end", "p1", "0 -1 0 0 0"], ["p2.end", "p2", "0 -1 0 0 0"]]);

    let text = urdf(&mechanism, Density::default()).tree;
    let model = Document::parse(&text).expect("XML");
    let led: Vec<_> = all(&model, "joint", "mimic")
        .iter()
        .map(|node| ["joint", "multiplier", "offset"].map(|key| node.attribute(key).unwrap()))
        .collect();
    // The values, too, are opposite, with 30 degrees at home.
    assert_eq!(led, [["p1", "-1", "0"], ["p2", "-1", "0"]]);
}
