//! A machine whose axes are off in any direction, measured: the worked example of docs/calibration.md.
//!
//! Every axis of the paper's manipulator is off by up to 0.05 mm and 0.02 degrees. Its legs are then no longer of the class,
//! and the platform goes where `opm-accuracy` says, to first order. Poses and encoders are read at 40 poses with a standard
//! deviation of 20 µm and 20 µrad. Prints a table for `opm calibrate --measurements`.
//!
//! ```text
//! cargo run -p opm-calibrate --example machine > m.csv
//! ```

use fastrand::Rng;
use nalgebra::DVector;
use opm_accuracy::{ErrorModel, Model};
use opm_calibrate::{Column, candidates};
use opm_core::{Manipulator, Quantity};
use opm_workspace::Progress;

const NOISE: f64 = 20e-6;

fn normal(rng: &mut Rng) -> f64 {
    (-2.0 * (1.0 - rng.f64()).ln()).sqrt() * (std::f64::consts::TAU * rng.f64()).cos()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let manipulator = Manipulator::example("plano-spherical-5dof-joints")?;
    let mode = manipulator.home_mode();
    let mut rng = Rng::with_seed(2);
    let model = Model::new(&manipulator, None, ErrorModel::Links);
    let errors = model.sources().iter().map(|source| {
        let size = match source.quantity {
            Quantity::Length => 0.05e-3,
            Quantity::Angle => 0.02_f64.to_radians(),
        };
        if source.is_actuator() { 0.0 } else { size * (2.0 * rng.f64() - 1.0) }
    });
    let errors = DVector::from_iterator(model.sources().len(), errors);
    let columns = Column::all(&manipulator);
    let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
    println!("{}", names.join(","));
    let (mut at, mut play) = (manipulator.solution(), 0.0_f64);
    for pose in candidates(&manipulator, mode, 40, 1, &Progress::default())? {
        let at = manipulator.inverse(&pose, mode, &mut at)?.ok_or("out of reach")?;
        let response = model.at(at)?;
        let moved = &response.coordinates * &errors;
        let coordinates = pose.iter().zip(moved.iter()).map(|(q, moved)| q + moved);
        let joints = manipulator.actuated().iter().map(|&number| at.joints()[number]);
        let cells = coordinates
            .chain(joints)
            .map(|value| format!("{:.8}", value + NOISE * normal(&mut rng)));
        println!("{}", cells.collect::<Vec<_>>().join(","));
        for plays in &response.plays {
            play = play.max((plays * &errors).fixed_rows::<3>(3).norm());
        }
    }
    eprintln!("the largest play of a joint is {:.0} um", 1e6 * play);
    Ok(())
}
