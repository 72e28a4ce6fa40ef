//! Indices of a pose allocate nothing. It counts what its process allocates.

use nalgebra::Vector3;
use opm_analysis::{Gravity, Index, Indices, Load, Setup, Wrench};
use opm_core::Manipulator;
use opm_core::mechanism::examples::{EXAMPLES, Example};
use opm_core::mechanism::file;
use opm_core::skeleton::Density;

#[test]
fn indices_of_a_pose_allocate_nothing() {
    let mut compared = 0;
    for Example { name, text, .. } in EXAMPLES {
        let Ok(manipulator) = Manipulator::read(text) else { continue };
        // With largest efforts, so that there is a payload.
        let text = file::write(manipulator.mechanism(), file::FileUnits::SI, file::Digits::All);
        let text = text.replace("actuated = true", "actuated = true, max_effort = 5");
        let Ok(manipulator) = Manipulator::read(&text) else { continue };
        let length = manipulator.characteristic_length();
        let wrench = Wrench::from_components([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]);
        let load = Some(Load { wrench, ..Load::default() });
        let gravity = Gravity { acceleration: Vector3::z() * -9.81, density: Density::default() };
        let setup = Setup { load, gravity: Some(gravity), ..Setup::new(length) };
        let known = Index::known(&manipulator, &setup);
        let mut indices = Indices::new(&manipulator, &setup, known).unwrap();
        let (mut at, mode) = (manipulator.solution(), manipulator.home_mode());
        let mut pose = manipulator.home_pose();
        for step in 0..3 {
            pose.iter_mut().for_each(|value| *value += 0.001 * f64::from(step));
            let Some(at) = manipulator.inverse(&pose, mode, &mut at).unwrap() else { continue };
            let counted = allocation_counter::measure(|| {
                indices.evaluate(at);
            });
            assert_eq!(counted.count_total, 0, "{name}");
            compared += indices.indices().len();
        }
    }
    assert!(compared > 100, "{compared}");
}
