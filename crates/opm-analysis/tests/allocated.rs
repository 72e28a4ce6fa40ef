//! Indices of a pose allocate nothing. It counts what its process allocates.

use opm_analysis::{Index, Indices};
use opm_core::Manipulator;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::mechanism::file;

#[test]
fn indices_of_a_pose_allocate_nothing() {
    let mut compared = 0;
    for example in EXAMPLES {
        let Ok(manipulator) = Manipulator::read(example.text) else { continue };
        // With largest efforts, so that there is a payload.
        let text = file::write(manipulator.mechanism(), file::FileUnits::SI, file::Digits::All);
        let text = text.replace("actuated = true", "actuated = true, max_effort = 5");
        let Ok(manipulator) = Manipulator::read(&text) else { continue };
        let length = manipulator.characteristic_length();
        let known = Index::ALL.into_iter().filter(|index| index.check(&manipulator).is_ok());
        let mut indices = Indices::new(&manipulator, length, known).unwrap();
        let (mut at, mode) = (manipulator.solution(), manipulator.home_mode());
        let mut pose = manipulator.home_pose();
        for step in 0..3 {
            pose.iter_mut().for_each(|value| *value += 0.001 * f64::from(step));
            let Some(at) = manipulator.inverse(&pose, mode, &mut at).unwrap() else { continue };
            let counted = allocation_counter::measure(|| {
                indices.evaluate(at);
            });
            assert_eq!(counted.count_total, 0, "{}", example.name);
            compared += indices.indices().len();
        }
    }
    assert!(compared > 100, "{compared}");
}
