//! Dimensions of files: parameters of families and named ones. Their errors leave the mechanism in its class, and fit.

use crate::assembled::has_direction;
use crate::near_home;
use fastrand::Rng;
use nalgebra::{DMatrix, DVector};
use opm_accuracy::{ErrorModel, Model};
use opm_core::Manipulator;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file::{self, MechanismFile};

/// The pose at which the actuators of another mechanism of the same class have these values, by Newton's method.
fn pose_at(manipulator: &Manipulator, start: &[f64], actuated: &DVector<f64>) -> DVector<f64> {
    let mut pose = DVector::from_column_slice(start);
    let mut at = manipulator.solution();
    for _ in 0..20 {
        let found = manipulator.inverse(pose.as_slice(), manipulator.home_mode(), &mut at).unwrap();
        let joints = found.expect("a pose in reach").joints();
        let values = manipulator.actuated().iter().map(|&i| joints[i]);
        let off = DVector::from_iterator(actuated.len(), values) - actuated;
        if off.amax() < 1e-15 {
            break;
        }
        let mut jacobians = manipulator.jacobians();
        manipulator.differentiate(&at, &mut jacobians).unwrap();
        let rates = jacobians.joints_by_pose().select_rows(manipulator.actuated());
        pose -= rates.lu().solve(&off).unwrap();
    }
    pose
}

fn changed(file: &MechanismFile, name: &str, step: f64) -> Manipulator {
    let (own, part) = match name.strip_suffix(".x").map(|own| (own, 0)) {
        Some(pair) => pair,
        None => name.strip_suffix(".y").map_or((name, 0), |own| (own, 1)),
    };
    let value = file.dimensions().into_iter().find(|(known, _)| known == own).unwrap().1;
    let value = match value {
        ParameterValue::Number(number) => ParameterValue::Number(number + step),
        ParameterValue::Pair(mut pair) => {
            pair[part] += step;
            ParameterValue::Pair(pair)
        }
        ParameterValue::None => panic!("{name} has no value"),
    };
    Manipulator::new(file.with([(own, value)]).unwrap().mechanism).unwrap()
}

#[test]
fn parameters_move_the_platform_as_forward_kinematics_do_and_fit() {
    let mut rng = Rng::with_seed(21);
    let mut count = 0;
    for example in EXAMPLES {
        let Ok(read) = file::read(example.text) else { continue };
        // Of a loop, the file may name the dimensions, but no pose.
        let Ok(manipulator) = Manipulator::new(read.mechanism.clone()) else { continue };
        if read.dimensions().is_empty() {
            continue;
        }
        let at = near_home(&mut rng, &manipulator).expect("a pose in reach");
        let (pose, joints) = (at.pose().to_vec(), at.joints());
        let values = manipulator.actuated().iter().map(|&i| joints[i]);
        let actuated = DVector::from_iterator(manipulator.actuated().len(), values);
        let model = Model::new(&manipulator, Some(&read), ErrorModel::Axes);
        assert!(model.sources().iter().all(has_direction));
        let response = model.at(&at).unwrap();
        for (column, source) in model.sources().iter().enumerate() {
            if !source.is_parameter() {
                continue;
            }
            // Differences of two steps, extrapolated: poses near a singularity have large third derivatives.
            // So have small mechanisms.
            let least = 1e-6 * manipulator.characteristic_length().clamp(0.05, 1.0);
            let difference = |step: f64| {
                let ends = [step, -step]
                    .map(|step| pose_at(&changed(&read, &source.name, step), &pose, &actuated));
                (&ends[0] - &ends[1]) / (2.0 * step)
            };
            let expected = (difference(least) * 4.0 - difference(2.0 * least)) / 3.0;
            let found: DMatrix<f64> = response.coordinates.columns(column, 1).into_owned();
            let scale = expected.amax().max(1.0);
            assert!(
                (&found - &expected).amax() < 1e-6 * scale,
                "{} {}: {found} {expected}",
                example.name,
                source.name
            );
            let play = response.plays.iter().map(|plays| plays.column(column).amax());
            let play = play.fold(0.0, f64::max);
            assert!(play < 1e-7 * scale, "{} {}: {play}", example.name, source.name);
            assert!(response.parasitic.column(column).amax() < 1e-7 * scale);
            count += 1;
        }
    }
    assert!(count > 30, "{count}");
}
