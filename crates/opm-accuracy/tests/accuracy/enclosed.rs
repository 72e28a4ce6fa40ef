//! Bounds over boxes: no pose of a box has larger errors, and small boxes have tight ones.

use opm_accuracy::{Assembler, Budget, ErrorModel, Model, Samples, sample_assembled};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::examples::EXAMPLES;

/// How far errors of some tens of nanometres deviate from first order, as a share.
const SECOND_ORDER: f64 = 1e-3;

/// The rounding of a worst case.
const ROUNDING: f64 = 1e-12;

/// The worst displacement and rotation at a pose in reach, by the pseudo-inverse of the closure.
fn at(model: &Model<'_>, sizes: &[f64], pose: &[f64]) -> Option<[f64; 2]> {
    let manipulator = model.manipulator();
    let mut buffer = manipulator.solution();
    let at = manipulator.inverse(pose, manipulator.home_mode(), &mut buffer).ok()??;
    let budget = Budget::new(&model.at(at).ok()?, sizes);
    budget.length.worst.is_finite().then_some([budget.length.worst, budget.angle.worst])
}

/// The displacement and rotation of a mechanism whose errors are drawn, a thousandth of these sizes, and which is assembled
/// beyond first order by Newton's method; for errors of these sizes.
fn made(model: &Model<'_>, sizes: &[f64], pose: &[f64], rng: &mut fastrand::Rng) -> [f64; 2] {
    const SHARE: f64 = 1e-3;
    let manipulator = model.manipulator();
    let mut at = manipulator.solution();
    let found = manipulator.inverse(pose, manipulator.home_mode(), &mut at).unwrap().unwrap();
    let assembler = Assembler::new(model, found, manipulator.home_mode()).unwrap();
    // Corners of the errors are the worst.
    let errors: Vec<f64> =
        sizes.iter().map(|size| if rng.bool() { SHARE * size } else { -SHARE * size }).collect();
    let sample = sample_assembled(&assembler, &errors);
    assert!(sample.is_some(), "{}: {pose:?}", manipulator.mechanism().name);
    let made = Samples::of([sample]);
    [made.length / SHARE, made.angle / SHARE]
}

/// Axes and actuators are off by up to 50 µm and 0.3 mrad.
fn sizes(model: &Model<'_>) -> Vec<f64> {
    let size = |quantity| if quantity == Quantity::Length { 50e-6 } else { 3e-4 };
    let bounded = |source: &opm_accuracy::Source| source.is_actuator() || source.axes().is_some();
    let sources = model.sources().iter();
    sources.map(|source| if bounded(source) { size(source.quantity) } else { 0.0 }).collect()
}

/// On all shipped mechanisms that have bounds over boxes, with boxes of several sizes at random places. Bounds exceed what was
/// found by less as boxes get smaller.
#[test]
fn no_pose_of_a_box_exceeds_its_bound() {
    let mut rng = fastrand::Rng::with_seed(17);
    let (mut mechanisms, mut assembled) = (0, 0);
    for example in EXAMPLES {
        let Ok(manipulator) = Manipulator::read(example.text) else { continue };
        if !manipulator.encloses_places() {
            continue;
        }
        let length = manipulator.characteristic_length();
        let (mut bounded, mut none) = ([0; 2], 0);
        for errors in [ErrorModel::Axes, ErrorModel::Links] {
            let model = Model::new(&manipulator, None, errors);
            let sizes = sizes(&model);
            for (share, far) in [(0.02, 0.15), (0.002, 0.15), (0.02, 0.04), (0.002, 0.04)] {
                for _ in 0..4 {
                    let mut ends = Vec::new();
                    for (home, c) in
                        manipulator.home_pose().iter().zip(manipulator.task_coordinates())
                    {
                        let unit = if c.quantity == Quantity::Length { length } else { 1.0 };
                        let middle = home + far * unit * (2.0 * rng.f64() - 1.0);
                        ends.push([middle - share * unit, middle + share * unit]);
                    }
                    // At most three coordinates vary, or the test takes long.
                    while ends.iter().filter(|[low, high]| low < high).count() > 3 {
                        let number = rng.usize(..ends.len());
                        ends[number][1] = ends[number][0];
                    }
                    let Some(found) = model.over_box(manipulator.home_mode(), &ends, &sizes) else {
                        none += 1;
                        continue;
                    };
                    let mut largest = [0.0_f64; 2];
                    for number in 0..40 {
                        let along = |[low, high]: &[f64; 2]| match rng.u8(..3) {
                            0 => *low,
                            1 => *high,
                            _ => low + (high - low) * rng.f64(),
                        };
                        let pose: Vec<f64> = ends.iter().map(along).collect();
                        let Some(values) = at(&model, &sizes, &pose) else { continue };
                        largest = [largest[0].max(values[0]), largest[1].max(values[1])];
                        if number == 0 {
                            assembled += 1;
                            let made = made(&model, &sizes, &pose, &mut rng);
                            assert!(
                                made[0] <= found.length * (1.0 + SECOND_ORDER),
                                "{made:?} {found:?}"
                            );
                            assert!(
                                made[1] <= found.angle * (1.0 + SECOND_ORDER),
                                "{made:?} {found:?}"
                            );
                        }
                    }
                    for (largest, bound) in largest.iter().zip([found.length, found.angle]) {
                        assert!(
                            *largest <= bound * (1.0 + ROUNDING),
                            "{}: {largest} {bound}",
                            example.name
                        );
                    }
                    if largest[0] > 0.0 {
                        let tight = found.length < 1.1 * largest[0];
                        bounded[0] += 1;
                        bounded[1] += u32::from(tight && share < 0.01);
                    }
                }
            }
        }
        println!("{}: {bounded:?}, {none} without bounds", example.name);
        assert!(bounded[0] >= 18 && bounded[1] >= 12, "{}: {bounded:?}", example.name);
        mechanisms += 1;
    }
    assert!(mechanisms >= 17 && assembled > 400, "{mechanisms} {assembled}");
}
