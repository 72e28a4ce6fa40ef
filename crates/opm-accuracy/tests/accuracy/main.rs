//! First-order responses, compared with mechanisms that are made with errors and assembled by Newton's method.

mod assembled;
mod enclosed;
mod family;

use assembled::Assembly;
use fastrand::Rng;
use nalgebra::{DVector, Vector6};
use opm_accuracy::{
    Allocation, Assembler, Both, Budget, ErrorModel, Model, Permitted, Response, Samples, draw,
    sample, sample_assembled,
};
use opm_core::Manipulator;
use opm_core::manipulator::Solution;
use opm_tests::random::{Options, PAIRS, mechanism};
use opm_tests::structured;

/// How often something was compared.
#[derive(Debug, Default)]
struct Counts {
    compared: usize,
    misfits: usize,
    loose: usize,
    unclear: usize,
}

/// The error of a central difference with this step is about its square.
const STEP: f64 = 1e-4;
/// Tolerance relative to the largest component.
const DIFFERENCE: f64 = 2e-5;

/// All errors at once, in random proportions.
fn compare(manipulator: &Manipulator, at: &Solution, errors: ErrorModel, rng: &mut Rng) -> Counts {
    let mut counts = Counts::default();
    let model = Model::new(manipulator, None, errors);
    let response = model.at(at).unwrap();
    let assembly = Assembly { model: &model, errors, joints: at.joints() };
    let Some(ranks) = assembly.ranks() else {
        counts.unclear += 1;
        return counts;
    };
    assert_eq!(response.held, ranks.held);
    assert_eq!(response.overconstraints, ranks.overconstraints);
    if !response.held {
        assert!(response.twists.iter().all(|number| number.is_nan()));
        counts.loose += 1;
        return counts;
    }
    let length = manipulator.characteristic_length();
    let sizes = model.sources().iter().map(|source| match source.quantity {
        opm_core::Quantity::Angle => rng.f64() - 0.5,
        opm_core::Quantity::Length => length * (rng.f64() - 0.5),
    });
    let sizes = DVector::from_iterator(model.sources().len(), sizes);
    let ends = [STEP, -STEP].map(|step| assembly.assemble(&(&sizes * step)));
    let [Some(more), Some(less)] = ends else {
        counts.unclear += 1;
        return counts;
    };
    let scaled = |twist: Vector6<f64>| {
        Vector6::from_fn(|i, _| if i < 3 { twist[i] } else { twist[i] / length })
    };
    let all = std::iter::once(&response.twists).chain(&response.plays);
    let found: Vec<Vector6<f64>> = all.map(|by| scaled(by * &sizes)).collect();
    let expected = more.iter().zip(&less).map(|(a, b)| scaled((a - b) / (2.0 * STEP)));
    let expected: Vec<Vector6<f64>> = expected.collect();
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().map(nalgebra::Matrix::amax).fold(1.0, f64::max);
    for (number, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let off = (found - expected).amax();
        assert!(
            off < DIFFERENCE * scale,
            "{} number {number}: {off:e} of {scale}: {found} {expected}",
            manipulator.mechanism().name
        );
    }
    counts.compared += 1;
    counts.misfits += usize::from(found[1..].iter().any(|play| play.amax() > 1e-3));
    counts
}

/// How far the assembly of the library and that of this test may differ: the latter stops at steps of 1e-12, and its
/// derivatives are differences.
const ASSEMBLED: f64 = 1e-8;

/// Errors that are not small: the library's assembly is that of this test, to the second order and beyond.
fn compare_assembled(
    manipulator: &Manipulator,
    at: &Solution,
    errors: ErrorModel,
    rng: &mut Rng,
) -> bool {
    let model = Model::new(manipulator, None, errors);
    let response = model.at(at).unwrap();
    let assembly = Assembly { model: &model, errors, joints: at.joints() };
    if !response.held || assembly.ranks().is_none() {
        return false;
    }
    let length = manipulator.characteristic_length();
    let size = 3e-3;
    let sizes = model.sources().iter().map(|source| {
        let size = size * (rng.f64() - 0.5);
        if source.quantity == opm_core::Quantity::Angle { size } else { length * size }
    });
    let sizes: Vec<f64> = sizes.collect();
    let drawn = DVector::from_column_slice(&sizes);
    let assembler = Assembler::new(&model, at, manipulator.home_mode()).unwrap();
    let (Some(found), Some(expected)) = (assembler.assemble(&sizes), assembly.assemble(&drawn))
    else {
        return false;
    };
    let all = std::iter::once(&found.platform).chain(&found.plays);
    let scaled = |twist: &Vector6<f64>| {
        Vector6::from_fn(|i, _| if i < 3 { twist[i] } else { twist[i] / length })
    };
    let by = std::iter::once(&response.twists).chain(&response.plays);
    let mut second = 0.0_f64;
    let scale = expected.iter().map(|t| scaled(t).amax()).fold(size, f64::max);
    for ((found, expected), by) in all.zip(&expected).zip(by) {
        let off = (scaled(found) - scaled(expected)).amax();
        assert!(
            off < ASSEMBLED * scale / size,
            "{} {errors:?}: {off:e}",
            manipulator.mechanism().name
        );
        second = second.max((scaled(expected) - scaled(&(by * &drawn))).amax());
    }
    // The terms beyond first order are far larger than what the assemblies differ by.
    second > 1e-3 * size * scale
}

#[test]
fn mechanisms_with_large_errors_are_assembled_as_by_differences() {
    let mut rng = Rng::with_seed(17);
    let mut count = 0;
    for manipulator in structured::manipulators() {
        for errors in [ErrorModel::Axes, ErrorModel::Links] {
            if let Some(at) = near_home(&mut rng, &manipulator) {
                count += usize::from(compare_assembled(&manipulator, &at, errors, &mut rng));
            }
        }
    }
    println!("{count}");
    assert!(count >= 10, "{count}");
}

/// Small errors, assembled, have the deviation of the root of squares.
#[test]
fn assembled_samples_of_small_errors_are_those_of_first_order() {
    let manipulator = Manipulator::example("plano-spherical-5dof-joints").unwrap();
    let at = near_home(&mut Rng::with_seed(14), &manipulator).unwrap();
    let model = Model::new(&manipulator, None, ErrorModel::Links);
    let response = model.at(&at).unwrap();
    let assembler = Assembler::new(&model, &at, manipulator.home_mode()).unwrap();
    let errors = vec![1e-8; model.sources().len()];
    let first = Samples::of((0..200).map(|i| Some(sample(&response, &draw(&errors, 3, i)))));
    let whole = Samples::of((0..200).map(|i| sample_assembled(&assembler, &draw(&errors, 3, i))));
    assert_eq!(whole.failed, 0);
    for (a, b) in first.deviations.iter().zip(&whole.deviations) {
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
    assert!((first.length / whole.length - 1.0).abs() < 1e-4);
    for (a, b) in first.misfit.iter().flatten().zip(whole.misfit.iter().flatten()) {
        assert!((a - b).abs() < 1e-4 * a.max(1e-9), "{a} {b}");
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.compared += other.compared;
        self.misfits += other.misfits;
        self.loose += other.loose;
        self.unclear += other.unclear;
    }
}

fn near_home(rng: &mut Rng, manipulator: &Manipulator) -> Option<Solution> {
    let mut at = manipulator.solution();
    let length = manipulator.characteristic_length();
    for _ in 0..20 {
        let mut pose = manipulator.home_pose();
        for (value, c) in pose.iter_mut().zip(manipulator.task_coordinates()) {
            *value += 0.6
                * (rng.f64() - 0.5)
                * match c.quantity {
                    opm_core::Quantity::Angle => 1.0,
                    opm_core::Quantity::Length => length,
                };
        }
        if manipulator.inverse(&pose, manipulator.home_mode(), &mut at).unwrap().is_some() {
            return Some(at);
        }
    }
    None
}

#[test]
fn responses_of_shipped_mechanisms_are_those_of_assembled_ones() {
    let mut rng = Rng::with_seed(11);
    let mut counts = Counts::default();
    for manipulator in structured::manipulators() {
        for errors in [ErrorModel::Axes, ErrorModel::Links] {
            if let Some(at) = near_home(&mut rng, &manipulator) {
                counts += compare(&manipulator, &at, errors, &mut rng);
            }
        }
    }
    println!("{counts:?}");
    assert!(counts.compared >= 10 && counts.misfits >= 10, "{counts:?}");
}

#[test]
fn responses_of_random_mechanisms_are_those_of_assembled_ones() {
    let mut rng = Rng::with_seed(12);
    let mut counts = Counts::default();
    for pair in PAIRS {
        for errors in [ErrorModel::Axes, ErrorModel::Links] {
            let options = Options { limited: 0.0, balls: rng.bool() };
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
            // Two or three actuators a leg hold most platforms.
            for leg in &mut mechanism.legs {
                leg.joints.iter_mut().take(2).for_each(|joint| joint.actuated = true);
            }
            let Ok(manipulator) = Manipulator::with_decomposition(mechanism, decomposition) else {
                continue;
            };
            if let Some(at) = near_home(&mut rng, &manipulator) {
                counts += compare(&manipulator, &at, errors, &mut rng);
            }
        }
    }
    println!("{counts:?}");
    assert!(counts.compared >= 30 && counts.misfits >= 25, "{counts:?}");
}

/// Joints are assembled at home: errors of axes do nothing there. Errors of links do.
#[test]
fn axes_fit_at_home() {
    let manipulator = Manipulator::example("plano-spherical-5dof-joints").unwrap();
    let [axes, links] = [ErrorModel::Axes, ErrorModel::Links].map(|errors| {
        let response = Model::new(&manipulator, None, errors).at(&manipulator.solution()).unwrap();
        response.plays[0].columns(manipulator.actuated().len(), 20).amax()
    });
    assert!(axes < 1e-12 && links > 1e-3, "{axes} {links}");
}

/// Actuators move the platform by the inverse of their Jacobian, and fit.
#[test]
fn actuators_move_the_platform_by_the_inverse_of_their_jacobian() {
    let mut rng = Rng::with_seed(13);
    let mut count = 0;
    for manipulator in structured::manipulators() {
        let actuators = manipulator.actuated().len();
        if actuators != manipulator.task_coordinates().len() {
            continue;
        }
        let at = near_home(&mut rng, &manipulator).unwrap();
        let mut jacobians = manipulator.jacobians();
        assert!(manipulator.differentiate(&at, &mut jacobians).unwrap());
        let rates = jacobians.joints_by_pose().select_rows(manipulator.actuated());
        let response = Model::new(&manipulator, None, ErrorModel::Axes).at(&at).unwrap();
        if !response.held || response.coordinates.iter().any(|number| number.is_nan()) {
            continue;
        }
        let product = &rates * response.coordinates.columns(0, actuators);
        let identity = nalgebra::DMatrix::identity(actuators, actuators);
        assert!((product - identity).amax() < 1e-6, "{}", manipulator.mechanism().name);
        let play = |plays: &nalgebra::Matrix6xX<f64>| plays.columns(0, actuators).amax();
        let largest = response.plays.iter().map(play).fold(0.0, f64::max);
        let scale = response.twists.columns(0, actuators).amax();
        assert!(largest < 1e-9 * scale.max(1.0), "{largest} {}", manipulator.mechanism().name);
        count += 1;
    }
    assert!(count >= 4, "{count}");
}

fn example() -> (Response, Vec<f64>) {
    let manipulator = Manipulator::example("plano-spherical-5dof-joints").unwrap();
    let at = near_home(&mut Rng::with_seed(14), &manipulator).unwrap();
    let model = Model::new(&manipulator, None, ErrorModel::Links);
    let response = model.at(&at).unwrap();
    let errors = (0..model.sources().len()).map(|k| 1e-5 * (1.0 + (k % 3) as f64)).collect();
    (response, errors)
}

/// No errors with any signs exceed the worst case, and those of the signs that a coordinate asks for reach it.
#[test]
fn the_worst_case_is_reached_and_not_exceeded() {
    let (response, errors) = example();
    let budget = Budget::new(&response, &errors);
    let mut rng = Rng::with_seed(15);
    for _ in 0..2000 {
        let drawn = errors.iter().map(|size| if rng.bool() { *size } else { -size });
        let drawn = DVector::from_iterator(errors.len(), drawn);
        let twist = &response.twists * &drawn;
        assert!(twist.fixed_rows::<3>(3).norm() <= budget.length.worst * (1.0 + 1e-12));
        assert!(twist.fixed_rows::<3>(0).norm() <= budget.angle.worst * (1.0 + 1e-12));
    }
    for (i, spread) in budget.coordinates.iter().enumerate() {
        let row = response.coordinates.row(i);
        let worst = row.iter().zip(&errors).map(|(by, size)| size.copysign(*by));
        let reached = row * DVector::from_iterator(errors.len(), worst);
        assert!((reached[0] - spread.worst).abs() < 1e-12 * spread.worst);
    }
    // The longest displacement is reached by the signs of its own direction.
    let along = |k: usize| response.twists.fixed_view::<3, 1>(3, k).dot(&budget.worst_displacement);
    let signs = DVector::from_fn(errors.len(), |k, _| errors[k].copysign(along(k)));
    let reached = (&response.twists * signs).fixed_rows::<3>(3).norm();
    assert!((reached - budget.length.worst).abs() < 1e-12 * reached);
}

/// The variance of a uniform distribution between -1 and 1 is a third.
#[test]
fn samples_have_the_deviation_of_the_root_of_squares() {
    let (response, errors) = example();
    let budget = Budget::new(&response, &errors);
    let drawn = || (0..20_000).map(|number| Some(sample(&response, &draw(&errors, 1, number))));
    let samples = Samples::of(drawn());
    assert_eq!(samples, Samples::of(drawn()));
    assert_eq!((samples.count, samples.failed), (20_000, 0));
    for (deviation, spread) in samples.deviations.iter().zip(&budget.coordinates) {
        let expected = spread.root_sum_square / 3.0_f64.sqrt();
        // Six standard errors of a standard deviation of 20000 samples.
        assert!((deviation / expected - 1.0).abs() < 6.0 / (2.0_f64 * 20_000.0).sqrt());
    }
    assert!(
        samples.length < budget.length.worst
            && samples.length > budget.length.root_sum_square / 2.0
    );
}

/// At home, axes that are not where the file has them do nothing: joints are assembled there. So any tolerance keeps any
/// clearance, and what rounding leaves of their plays permits no number. Away from home, what needs play has a tolerance of the
/// order of the clearance.
#[test]
fn what_needs_no_play_may_have_any_tolerance() {
    let clearance = Both { length: Some(20e-6), angle: Some(20e-6) };
    let (mut finite, mut rng) = (0, Rng::with_seed(41));
    for example in opm_core::mechanism::examples::EXAMPLES {
        // Single loops are no manipulators.
        let Ok(manipulator) = Manipulator::read(example.text) else { continue };
        let model = Model::new(&manipulator, None, ErrorModel::Axes);
        let mut at = manipulator.solution();
        let mut permitted = |pose: &[f64]| {
            let mode = manipulator.home_mode();
            let at = manipulator.inverse(pose, mode, &mut at).unwrap()?;
            let sources = model.sources();
            let mut found = Allocation::new(clearance, model.length(), sources.len());
            found.add(&model.at(at).unwrap(), sources);
            Some(found)
        };
        let home = manipulator.home_pose();
        let at_home = permitted(&home).expect("home is in reach");
        assert!(at_home.permitted().iter().all(|&p| p == Permitted::UNLIMITED), "{}", example.name);
        assert_eq!(at_home.uniform(), [f64::INFINITY; 2], "{}", example.name);
        for _ in 0..5 {
            let pose: Vec<f64> = home.iter().map(|q| q + 0.05 * (rng.f64() - 0.5)).collect();
            let Some(found) = permitted(&pose) else { continue };
            let numbers = found.permitted().iter().map(|p| p.alone).filter(|p| p.is_finite());
            for number in numbers {
                assert!(number < 1e3, "{}: {number} at {pose:?}", example.name);
                finite += 1;
            }
        }
    }
    assert!(finite > 300, "{finite} tolerances");
}
