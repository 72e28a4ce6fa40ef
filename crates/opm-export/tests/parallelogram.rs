//! Models of a mechanism with parallelograms hold both hinges of each together.

use opm_core::mechanism::file;
use opm_core::skeleton::Density;
use opm_export::{Keyframes, MjcfOptions, mjcf, urdf};
use roxmltree::{Document, Node};

const TEXT: &str = r#"
format = 1
name = "rail"
units = { length = "mm", angle = "deg" }
platform = { point = [0, 0, -300] }
[[leg]]
joints = [
  { name = "s1", type = "prismatic", axis = [1, 0, 0], point = [-250, 0, 0], actuated = true },
  { name = "p1", type = "parallelogram", axis = [0, 1, 0], point = [-250, 0, 0], point2 = [-50, 0, -300], home = 30 },
]
[[leg]]
joints = [
  { name = "s2", type = "prismatic", axis = [1, 0, 0], point = [250, 0, 0], actuated = true },
  { name = "p2", type = "parallelogram", axis = [0, 1, 0], point = [250, 0, 0], point2 = [50, 0, -300] },
]
"#;

fn all<'a>(model: &'a Document<'_>, parent: &str, kind: &str) -> Vec<Node<'a, 'a>> {
    let parents = model.descendants().filter(|node| node.has_tag_name(parent));
    parents.flat_map(|node| node.children()).filter(|node| node.has_tag_name(kind)).collect()
}

#[test]
fn hinges_of_a_parallelogram_are_held_together() {
    let mechanism = file::read(TEXT).expect("a mechanism").mechanism;
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
