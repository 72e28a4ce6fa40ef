//! Derivatives, compared with differences of the closed forms of changed mechanisms.

use crate::column::{BasePoint, Column};
use crate::parameter::{Instance, parameters};
use crate::prediction::Predictor;
use fastrand::Rng;
use nalgebra::Point3;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::mechanism::file;

/// Every column that a mechanism can have.
fn every_column(manipulator: &Manipulator) -> Vec<Column> {
    let points = [BasePoint { name: "A".into(), at: Point3::new(0.31, -0.22, 0.47) }];
    let dependent = manipulator.dependent_coordinates().iter().map(|c| c.name);
    let others = ["point.x", "point.y", "point.z", "distance.A", "incline.x", "incline.y"];
    let more = dependent.chain(others).map(|name| Column::named(name, manipulator, &points));
    Column::all(manipulator).into_iter().chain(more.map(Result::unwrap)).collect()
}

fn near_home(rng: &mut Rng, manipulator: &Manipulator) -> Option<Vec<f64>> {
    let length = manipulator.characteristic_length();
    let mut at = manipulator.solution();
    for _ in 0..50 {
        let mut pose = manipulator.home_pose();
        for (value, c) in pose.iter_mut().zip(manipulator.task_coordinates()) {
            let unit = if c.quantity == Quantity::Angle { 1.0 } else { length };
            *value += 0.3 * (rng.f64() - 0.5) * unit;
        }
        if manipulator.inverse(&pose, manipulator.home_mode(), &mut at).unwrap().is_some() {
            return Some(pose);
        }
    }
    None
}

#[test]
fn derivatives_are_those_of_differences() {
    /// The error of a central difference is about the square of its step, in shares of the size.
    const STEP: f64 = 1e-5;
    const TOLERANCE: f64 = 2e-7;
    let mut rng = Rng::with_seed(4);
    let (mut compared, mut mechanisms) = (0, 0);
    for example in EXAMPLES {
        let Ok(read) = file::read(example.text) else { continue };
        let Ok(nominal) = Instance::nominal(&read) else { continue };
        let all = parameters(&nominal);
        let length = nominal.manipulator.characteristic_length();
        let unit = |q| if q == Quantity::Angle { 1.0 } else { length };
        // Not at the values of the file: displacements of one joint do not commute.
        let base: Vec<f64> =
            all.iter().map(|p| 2e-3 * (rng.f64() - 0.5) * unit(p.quantity)).collect();
        let instance = nominal.changed(&all, &base).unwrap();
        let columns = every_column(&instance.manipulator);
        let mode = nominal.manipulator.home_mode();
        let at = |instance: &Instance, pose: &[f64]| {
            Predictor { instance, columns: &columns, mode }.at(pose, None)
        };
        let Some(pose) = near_home(&mut rng, &instance.manipulator) else { continue };
        let model = instance.model();
        let predictor = Predictor { instance: &instance, columns: &columns, mode };
        let Some(found) = predictor.at(&pose, Some((&model, &all))) else { continue };
        mechanisms += 1;
        let check =
            |analytic: f64, ends: [f64; 2], step: f64, of: Quantity, row: usize, what: &str| {
                let difference =
                    (ends[0] - ends[1]) / (2.0 * step) * unit(of) / unit(columns[row].quantity);
                let analytic = analytic * unit(of) / unit(columns[row].quantity);
                let scale = 1.0_f64.max(difference.abs());
                assert!(
                    (analytic - difference).abs() < TOLERANCE * scale,
                    "{}: {} by {what}: {analytic} is {difference} by differences",
                    example.name,
                    columns[row].name
                );
            };
        for (k, parameter) in all.iter().enumerate() {
            let step = STEP * unit(parameter.quantity);
            let ends = [step, -step].map(|step| {
                let mut changes = base.clone();
                changes[k] += step;
                at(&nominal.changed(&all, &changes).unwrap(), &pose).unwrap().values
            });
            let by = found.by_parameter.as_ref().unwrap();
            for (row, (more, less)) in ends[0].iter().zip(&ends[1]).enumerate() {
                let of = parameter.quantity;
                check(by[(row, k)], [*more, *less], step, of, row, &parameter.name);
                compared += 1;
            }
        }
        for (k, c) in instance.manipulator.task_coordinates().iter().enumerate() {
            let step = STEP * unit(c.quantity);
            let ends = [step, -step].map(|step| {
                let mut pose = pose.clone();
                pose[k] += step;
                at(&instance, &pose).unwrap().values
            });
            for (row, (more, less)) in ends[0].iter().zip(&ends[1]).enumerate() {
                let of = c.quantity;
                check(found.by_pose[(row, k)], [*more, *less], step, of, row, c.name);
            }
        }
    }
    println!("{mechanisms} mechanisms, {compared} derivatives by parameters");
    assert!(mechanisms >= 19 && compared > 2000, "{mechanisms} {compared}");
}
