//! `opm calibrate`: parameters from measurements, and poses to measure.

pub mod given;
mod planned;
mod report;
mod table;

use crate::args::{CalibrateArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::is_stdout;
use crate::progress::{interruptible, watch_steps};
use crate::target::{Target, ends_in};
use crate::unitless;
use opm_calibrate::{BasePoint, CalibrateError, Options, calibrate};
use opm_core::Quantity;
use report::Report;
use std::sync::atomic::{AtomicU64, Ordering};

pub fn run(args: &CalibrateArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    let manipulator = loaded.compile()?;
    if !(args.weakest > 0.0 && args.weakest.is_finite()) {
        return Err(Failure::flag(
            "--weakest",
            format!("{}, expected a positive number", args.weakest),
        ));
    }
    if args.plan.is_none() {
        // clap does not require --plan beside --measurements, with which it conflicts.
        let given = [("--columns", !args.columns.is_empty()), ("--poses", args.poses.is_some())];
        if let Some((flag, _)) = given.into_iter().find(|(_, given)| *given) {
            return Err(Failure::flag(flag, "is for --plan, which is not given"));
        }
    }
    let options = Options {
        mode: Some(load::mode(&manipulator, &args.mode)?),
        sigma: args.sigma.map(|given| given.sigma),
        joint_sigma: args.joint_sigma.map(|given| given.sigma),
        only: args.only.clone(),
        hold: args.hold.clone(),
        reject_outliers: args.reject_outliers,
        weakest: args.weakest,
    };
    for (flag, given) in [("--sigma", &args.sigma), ("--joint-sigma", &args.joint_sigma)] {
        if let Some(given) = given {
            let quantities = [Quantity::Length, Quantity::Angle];
            let values = given.given.into_iter().zip(quantities);
            unitless::note_values(output, flag, (&loaded, &manipulator), values);
        }
    }
    let points: Vec<BasePoint> = args.point.iter().map(|point| point.0.clone()).collect();
    if let Some(count) = args.plan {
        return planned::run(args, output, (&loaded, &manipulator), &points, (&options, count));
    }
    let Some(path) = &args.measurements else { return Ok(()) };
    let table = table::read(path, (&loaded, &manipulator), &points, output)?;
    let target = match &args.output {
        Some(target) if is_stdout(target) => {
            let problem = "the report goes to standard output, expected a file";
            return Err(Failure::flag("--output", problem));
        }
        Some(target) => {
            loaded.refuse_as_output(target, &[path])?;
            ends_in(target, &["toml"])?;
            Some(Target::create(target)?)
        }
        None => None,
    };
    let progress = interruptible()?;
    let steps = AtomicU64::new(0);
    let found = watch_steps(
        output,
        "calibrating",
        None,
        || steps.load(Ordering::Relaxed),
        || {
            calibrate(&loaded.file, &table.measurements, &options, &mut |_| {
                steps.fetch_add(1, Ordering::Relaxed);
                !progress.is_cancelled()
            })
        },
    );
    let found = found.map_err(|error| failure(error, &table.label))?;
    for &row in &found.unused {
        let line = table.lines[row];
        output.warn(format_args!(
            "{}:{line}: no pose in reach comes near; the row takes no part",
            table.label
        ));
    }
    let report =
        Report { loaded: &loaded, table: &table, found: &found, known: args.sigma.is_some() };
    output.print(&report.json(), report.text())?;
    match target {
        Some(target) => target.commit(found.text().as_bytes()),
        None => Ok(()),
    }
}

/// The failure of a calibration.
fn failure(error: CalibrateError, label: &str) -> Failure {
    match error {
        CalibrateError::Stopped => Failure::interrupted("interrupted"),
        CalibrateError::Unknown { .. } => Failure::flag("--only, --hold", error),
        CalibrateError::NothingVaries => Failure::flag("--hold", error),
        error => Failure::at(label, error),
    }
}
