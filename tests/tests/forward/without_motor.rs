//! A leg without a motor may stand in several ways with the same platform and the same motors: each is an assembly of a mode.

use fastrand::Rng;
use opm_core::Manipulator;

/// 2-UPR + 2-RPU: the fourth leg repeats the constraint of the third one, and follows.
const FILE: &str = r#"
format = 1
name = "2UPR-2RPU"
units = { length = "mm", angle = "deg" }
platform = { point = [0, 0, 300] }
[[leg]]
name = "upr{i}"
pattern = { angles = [0, 180], axis = [0, 0, 1] }
joints = [
  { name = "u{i}", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [200, 0, 0] },
  { name = "p{i}", type = "prismatic", axis = [-120, 0, 300], point = [200, 0, 0], actuated = true },
  { name = "r{i}", type = "revolute", axis = [0, 1, 0], point = [80, 0, 300] },
]
[[leg]]
name = "driven"
joints = [
  { name = "r3", type = "revolute", axis = [1, 0, 0], point = [0, 200, 0] },
  { name = "p3", type = "prismatic", axis = [0, -120, 300], point = [0, 200, 0], actuated = true },
  { name = "u3", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [0, 80, 300] },
]
[[leg]]
name = "led"
joints = [
  { name = "r4", type = "revolute", axis = [1, 0, 0], point = [0, -200, 0] },
  { name = "p4", type = "prismatic", axis = [0, 120, 300], point = [0, -200, 0] },
  { name = "u4", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [0, -80, 300] },
]
"#;

#[test]
fn an_assembly_is_found_in_each_mode_of_a_leg_without_a_motor() {
    let m = Manipulator::read(FILE).unwrap();
    let mut rng = Rng::with_seed(3);
    let mut at = m.solution();
    let mut compared = 0;
    for _ in 0..12 {
        let pose: Vec<f64> = (m.task_coordinates().iter())
            .map(|c| {
                c.home
                    + if c.quantity == opm_core::Quantity::Length { 0.02 } else { 0.2 }
                        * (rng.f64() - 0.5)
            })
            .collect();
        for mode in m.modes() {
            let Some(solution) = m.inverse(&pose, mode, &mut at).unwrap() else { continue };
            let joints = solution.joints().to_vec();
            let actuated: Vec<f64> = m.actuated().iter().map(|&i| joints[i]).collect();
            let mut list = m.forward(&actuated).unwrap().list;
            m.keep_assemblies_in(&mut list, mode);
            let same = |found: &[f64]| found.iter().zip(&joints).all(|(a, b)| (a - b).abs() < 1e-8);
            let found = list.iter().filter(|assembly| same(&assembly.joints)).count();
            assert_eq!(found, 1, "{pose:?} {}", m.format_mode(mode));
            compared += 1;
        }
    }
    assert!(compared > 150, "{compared}");
}
