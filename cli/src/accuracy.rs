//! `opm accuracy`: pose errors, sensitivities and misfits.

mod grid;
mod over;
mod poses;
mod report;
mod row;
pub mod sizes;
mod table;

use crate::args::{AccuracyArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::{Checks, Number};
use crate::progress::{interruptible, watch};
use crate::unitless;
use crate::workspace::threads;
use opm_accuracy::{Allocation, Assembler, Budget, Model, Samples};
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_study::{Drawing, characteristic_length};
use opm_workspace::Cancelled;
use report::{PoseAccuracy, Report};

/// Mechanisms with drawn errors, assembled at a pose.
fn sampled(
    args: &AccuracyArgs,
    output: &Output,
    setting: &Setting<'_>,
    at: &Solution,
    count: u64,
) -> Result<Samples, Failure> {
    let assembler = Assembler::new(&setting.model, at, setting.mode);
    let assembler = assembler.map_err(|error| Failure::flag("--pose", error))?;
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    let drawing = Drawing { assembler: &assembler, sizes: &setting.sizes, count, seed: args.seed };
    let job = || pool.install(|| drawing.samples(&progress));
    watch(output, "assembling", Some(count), || progress.done(), job)
        .map_err(|Cancelled| Failure::interrupted("interrupted"))
}

/// What all forms of the command have in common.
pub struct Setting<'a> {
    pub loaded: &'a Loaded,
    pub model: Model<'a>,
    /// The size of each error, radians and metres.
    pub sizes: Vec<f64>,
    pub mode: Mode,
}

impl<'a> Setting<'a> {
    fn new(
        args: &AccuracyArgs,
        loaded: &'a Loaded,
        manipulator: &'a Manipulator,
    ) -> Result<Self, Failure> {
        let mode = load::mode(manipulator, &args.mode)?;
        let length = args.length.map(Number::characteristic_length).transpose()?;
        let length = characteristic_length(length, manipulator)?;
        let model = Model::new(manipulator, Some(&loaded.file), args.errors);
        let model = model.with_length(length);
        let sizes = sizes::read(args, model.sources())?;
        Ok(Self { loaded, model, sizes, mode })
    }

    pub fn manipulator(&self) -> &'a Manipulator {
        self.model.manipulator()
    }
}

/// Notes that there is nothing to add up.
fn note_zero(args: &AccuracyArgs, output: &Output, setting: &Setting<'_>) {
    let sized = setting.sizes.iter().any(|&size| size > 0.0);
    if !sized && (args.poses.is_some() || args.clearance.is_none()) {
        output
            .note("all errors are zero: give their sizes with --actuators, --axes or --tolerances");
    }
}

pub fn run(args: &AccuracyArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    if let (Some(path), Some(tolerances)) = (&args.output, &args.tolerances) {
        loaded.refuse_as_output(path, &[tolerances])?;
    }
    if let Some(vary) = &args.vary {
        return table::run(args, &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let setting = Setting::new(args, &loaded, &manipulator)?;
    note_zero(args, output, &setting);
    if let Some(input) = &args.poses {
        return poses::run(args, input, output, &setting);
    }
    if !args.grid.is_empty() {
        return grid::run(args, output, &setting);
    }
    if !args.over.is_empty() {
        return over::run(args, output, &setting);
    }
    if args.output.is_some() {
        return Err(Failure::flag("--output", "is for --poses and --grid"));
    }
    unitless::note_pose(output, "--pose", &args.pose, &loaded, &manipulator);
    let (pose, checks) = match &args.transform {
        Some(transform) => (transform.pose(&manipulator, setting.mode)?, Checks::none()),
        None => args.pose.resolve_with_checks(&manipulator)?,
    };
    let mut at = manipulator.solution();
    let found = manipulator.inverse(&pose, setting.mode, &mut at);
    let reached = found.map_err(|error| Failure::flag("--pose", error))?.is_some();
    let mut found = None;
    if reached {
        let verified = checks.verify(&manipulator, at.dependent(), loaded.file.units);
        verified.map_err(|error| Failure::flag("--pose", error))?;
        let response = setting.model.at(&at).map_err(|error| Failure::flag("--pose", error))?;
        let budget = Budget::new(&response, &setting.sizes);
        let sources = setting.model.sources();
        let allocation = args.clearance.map(|clearance| {
            let length = setting.model.length();
            let mut allocation = Allocation::new(clearance.0, length, sources.len());
            allocation.add(&response, sources);
            allocation
        });
        let samples = args.samples.map(|count| sampled(args, output, &setting, &at, count));
        found = Some(PoseAccuracy { response, budget, allocation, samples: samples.transpose()? });
    }
    let report = Report { setting: &setting, at: &at, pose: &pose, found };
    output.print(&report.json(), report.text())
}
