//! Which pairs are tested, and which meet by construction.

use opm_core::Manipulator;
use opm_core::mechanism::file;
use opm_interference::{Distances, Interference};

fn of(text: &str) -> Interference {
    Interference::new(&file::read(text).unwrap().mechanism)
}

fn pairs(interference: &Interference) -> Vec<[String; 2]> {
    let all = 0..interference.pairs();
    all.map(|pair| interference.names_of(pair).map(str::to_owned)).collect()
}

/// Two legs with concentric balls on the platform, one of them a telescope, the other on a slider; it has two
/// coaxial joints at one point.
const LEGS: &str = r#"
format = 1
name = "legs"
units = { length = "mm", angle = "deg" }
[platform]
point = [0, 0, 300]
[bodies]
radius = 5
[[leg]]
name = "a"
joints = [
  { name = "ua", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [-200, 0, 0] },
  { name = "pa", type = "prismatic", axis = [1, 0, 1], point = [-100, 0, 100], actuated = true, limits = [-50, 50] },
  { name = "sa", type = "spherical", point = [50, 0, 250] },
]
[[leg]]
name = "b"
joints = [
  { name = "pb", type = "prismatic", axis = [0, 1, 0], point = [200, 0, 0], actuated = true, limits = [-80, 80] },
  { name = "rb", type = "revolute", axis = [0, 0, 1], point = [200, 0, 0] },
  { name = "vb", type = "revolute", axis = [1, 0, 0], point = [200, 100, 80] },
  { name = "wb", type = "revolute", axis = [1, 0, 0], point = [200, 100, 80] },
  { name = "sb", type = "spherical", point = [50, 0, 250] },
]
"#;

#[test]
fn what_meets_in_a_point_is_not_tested() {
    let interference = of(LEGS);
    let names: Vec<_> = interference.members().iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        names,
        ["a/ua", "a/pa", "b/pb", "b/rb", "b/vb", "b/wb", "base/pb", "platform"],
        "a telescope has no guide"
    );
    // Links without length have no shape: those between a slider and the joint at its centre, and between coaxial joints at
    // one point. The telescope's slider is at its ball, which is that of the second leg's last link, too.
    let mut expected = vec![
        ["a/ua", "b/rb"],
        ["a/ua", "base/pb"],
        ["b/rb", "platform"],
        ["b/wb", "base/pb"],
        ["base/pb", "platform"],
    ];
    let found = pairs(&interference);
    let mut found: Vec<[&str; 2]> = found.iter().map(|[a, b]| [&**a, &**b]).collect();
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected);
}

/// The stretch of a telescope is as long as the joint says, and its link is not tested against what it carries.
#[test]
fn a_telescope_ends_at_its_slider() {
    let manipulator = Manipulator::example("planar-3rpr").unwrap();
    let interference = Interference::new(manipulator.mechanism());
    let mut names = interference.members().iter().map(|member| &*member.name);
    assert!(!names.any(|name| name.starts_with("base/")));
    // One arm alone is longer; what is near its end is then nearer. The others are as they were.
    let mut distances = Distances::new(&interference);
    let mut solution = manipulator.solution();
    let home = manipulator.home_pose();
    let mode = manipulator.home_mode();
    let [mut near, mut far] = [0.0; 2];
    for (step, least) in [(0.0, &mut near), (0.02, &mut far)] {
        let pose = [home[0] + step, home[1], home[2]];
        let solution = manipulator.inverse(&pose, mode, &mut solution).unwrap().unwrap();
        distances.place(&manipulator, solution);
        *least = distances.nearest().unwrap().distance;
    }
    assert!(near != far);
}

#[test]
fn what_overlaps_at_home_is_named() {
    let text = format!(
        "{LEGS}\n[[obstacle]]\nname = \"floor\"\ntype = \"half-space\"\npoint = [0, 0, 2]\nnormal = [0, 0, 1]\n"
    );
    let interference = of(&text);
    let aside = interference.set_aside_pairs();
    // The first leg stands on the floor: 2 mm and the radius.
    let found: Vec<_> = aside.iter().map(|pair| pair.names.join(" ")).collect();
    assert_eq!(found, ["a/ua floor", "b/rb floor"]);
    assert!(aside.iter().all(|pair| (pair.overlap - 0.007).abs() < 1e-12));
    // The guide and the floor are both at rest, and not tested.
    assert!(!pairs(&interference).iter().flatten().any(|name| name == "base/pb floor"));
}
