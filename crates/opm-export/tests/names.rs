//! Names in a model are unique, whatever those of the mechanism are.

use opm_core::mechanism::file;
use opm_export::{Keyframes, MjcfOptions, mjcf};
use roxmltree::Document;
use std::collections::HashSet;

/// A leg that is called as its screw is, a joint that is called as the screw's slide would be, and legs and joints whose
/// names are the same once they are put together.
const TEXT: &str = r#"
format = 1
name = "names"
units = { length = "mm", angle = "deg" }

[platform]
point = [0, 0, 100]

[[leg]]
name = "screw"
joints = [
  { name = "screw", type = "helical", axis = [0, 0, 1], point = [0, 0, 0], pitch = 5 },
  { name = "screw.slide", type = "revolute", axis = [1, 0, 0], point = [0, 50, 0] },
]

[[leg]]
name = "a"
joints = [
  { name = "b.c", type = "revolute", axis = [1, 0, 0], point = [0, 0, 0] },
  { name = "platform", type = "revolute", axis = [1, 0, 0], point = [0, 50, 0] },
]

[[leg]]
name = "a.b"
joints = [
  { name = "c", type = "revolute", axis = [1, 0, 0], point = [80, 0, 0] },
  { name = "d", type = "spherical", point = [80, 50, 0] },
]
"#;

#[test]
fn names_are_unique_and_those_of_joints_stay() {
    let mechanism = file::read(TEXT).expect("a mechanism").mechanism;
    let text = mjcf(&Keyframes::of(&mechanism), &MjcfOptions::default());
    let model = Document::parse(&text).expect("XML");
    let names = |parent: Option<&str>, kinds: &[&str]| -> Vec<String> {
        let of_kind = model.descendants().filter(|node| {
            let inside = node
                .parent()
                .is_some_and(|p| parent.is_none_or(|wanted| p.tag_name().name() == wanted));
            inside && kinds.contains(&node.tag_name().name())
        });
        of_kind.filter_map(|node| node.attribute("name")).map(str::to_owned).collect()
    };
    let joints = names(Some("body"), &["joint"]);
    let screw = joints[1].clone();
    assert_eq!(joints, ["screw", &*screw, "screw.slide", "b.c", "platform", "c", "d"]);
    let constraints = names(Some("equality"), &["joint", "weld"]);
    assert_eq!(constraints.len(), 3);
    assert!(constraints.contains(&"a".to_owned()) && constraints.contains(&"a.b".to_owned()));
    let bodies = names(None, &["body"]);
    assert!(bodies.contains(&"platform".to_owned()), "{bodies:?}");
    for list in [joints, constraints, bodies] {
        assert_eq!(list.iter().collect::<HashSet<_>>().len(), list.len(), "{list:?}");
    }
}
