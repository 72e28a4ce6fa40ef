//! `opm trajectory`: a motion as the joints follow it.

mod overshoot;
mod summary;
mod table;

use crate::args::{Format, Output, TableUnits, TrajectoryArgs};
use crate::failure::Failure;
use crate::interference;
use crate::layout;
use crate::load::{self, Loaded};
use crate::motion::{self, LoadedMotion, Reading};
use crate::output::{Shown, is_stdout, stdout};
use crate::progress::{interruptible, watch};
use crate::text::count;
use opm_analysis::{Gravity, time_optimal_with_tool};
use opm_core::manipulator::Manipulator;
use opm_core::motion::TimingError;
use opm_mcap::RecordError;
use opm_study::recording::{
    MotionRecorder, TableOptions, is_motion_table, partial, write_motion_csv, write_motion_table,
};
use opm_study::{MotionRequest, SetupOptions, StudyError};
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use summary::Report;

/// More samples than anybody wants by accident.
const MANY: u64 = 10_000_000;

/// Where the samples of a motion go.
enum Target<'a> {
    Nowhere,
    /// CSV on standard output.
    Printed,
    Table(&'a Path),
    Recording(&'a Path),
}

impl<'a> Target<'a> {
    /// What the name of the output and the options of tables say together.
    fn of(args: &'a TrajectoryArgs, output: &Output) -> Result<Self, Failure> {
        let target = match args.output.as_deref() {
            None => Self::Nowhere,
            Some(path) if is_stdout(path) => Self::Printed,
            Some(path) if is_motion_table(path) => Self::Table(path),
            Some(path) if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mcap")) => {
                Self::Recording(path)
            }
            Some(path) => {
                let problem =
                    "expected a name that ends in .mcap (a recording), .csv or .npy (NumPy)";
                return Err(Failure::flag("--output", format_args!("{}, {problem}", path.shown())));
            }
        };
        if let Self::Recording(_) = target {
            let options = [
                ("--reactions", args.reactions, "a recording has none"),
                ("--rates", args.rates, "a recording has them anyway"),
                ("--accelerations", args.accelerations, "a recording has them anyway"),
                ("--units", args.units == TableUnits::File, "a recording is in metres and radians"),
            ];
            if let Some((flag, _, why)) = options.into_iter().find(|(_, given, _)| *given) {
                let problem = format_args!("{why}; for tables, whose names end in .csv or .npy");
                return Err(Failure::flag(flag, problem));
            }
        }
        if let (Self::Printed, Format::Json) = (&target, output.format) {
            let problem = "the CSV takes standard output; give it a file with --output";
            return Err(Failure::flag("--format json", problem));
        }
        Ok(target)
    }

    /// The file.
    fn path(&self) -> Option<&'a Path> {
        match *self {
            Self::Nowhere | Self::Printed => None,
            Self::Table(path) | Self::Recording(path) => Some(path),
        }
    }
}

/// The first flag of a setup that was given.
fn given_setup(setup: &SetupOptions) -> &'static str {
    match setup {
        SetupOptions { load: Some(_), .. } => "--wrench",
        SetupOptions { gravity: Some(_), .. } => "--gravity",
        _ => "--link-stiffness",
    }
}

/// The motion of the flags, and the duration that it was given with if it got another timing.
fn motion(
    args: &TrajectoryArgs,
    (loaded, manipulator): (&Loaded, &Manipulator),
) -> Result<(LoadedMotion, Option<f64>), Failure> {
    let reading = Reading { ends: args.ends.map(Into::into), table: &args.table };
    let mut motion = motion::open(&args.motion, &reading, (loaded, manipulator))?;
    if let Some(mode) = &args.mode {
        motion.motion.mode = Some(load::mode(manipulator, mode)?);
    }
    if !args.time_optimal {
        return Ok((motion, None));
    }
    let given_duration = motion.motion.duration;
    let mode = motion.motion.mode.unwrap_or_else(|| manipulator.home_mode());
    // What acts besides springs takes part of the largest efforts.
    let acting = SetupOptions { springs: None, ..args.setup.options(None)? };
    let (acting, tool) = (acting.check(manipulator)?, args.tool.limits());
    let timed = time_optimal_with_tool(&motion.motion, (manipulator, mode), &acting, tool);
    motion.motion = timed.map_err(|error| {
        let (of, flags) = match error {
            TimingError::NoLimits { .. } => (
                &args.mechanism.file,
                "--time-optimal, --tool-acceleration, --tool-angular-acceleration",
            ),
            _ => (&args.motion, "--time-optimal"),
        };
        Failure::work(format!("{}: {error} ({flags})", of.shown()))
    })?;
    Ok((motion, Some(given_duration)))
}

/// What is asked of a motion.
fn request<'a>(
    args: &TrajectoryArgs,
    manipulator: &'a Manipulator,
    motion: &'a LoadedMotion,
    clearance: Option<f64>,
) -> MotionRequest<'a> {
    let mut request = MotionRequest::new(manipulator, &motion.motion, &motion.label);
    if let Some(rate) = args.rate {
        request = request.rate(rate);
    }
    request.clearance(clearance.unwrap_or(0.0))
}

pub fn run(args: &TrajectoryArgs, output: &Output) -> Result<(), Failure> {
    let target = Target::of(args, output)?;
    let loaded = load::open(&args.mechanism, output)?;
    if let Some(vary) = &args.vary {
        return table::run(args, &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let (motion, given_duration) = motion(args, (&loaded, &manipulator))?;
    motion.note_doubts(output);
    overshoot::note(&motion, (&loaded, &manipulator), output);
    let mut setup = args.setup.options(None)?;
    if args.reactions && setup.springs.is_none() {
        let problem = "legs share a load by how much they give way; give --link-stiffness";
        return Err(Failure::flag("--reactions", problem));
    }
    if args.efforts || args.reactions {
        // Motors carry the mechanism.
        setup.gravity = setup.gravity.or(Some(Gravity::default()));
    }
    let limited = |&c: &usize| manipulator.coordinates()[c].max_effort.is_some();
    let pushed = args.time_optimal && manipulator.actuated().iter().any(limited);
    let used = args.indices || args.efforts || args.reactions || pushed && setup.springs.is_none();
    if setup != SetupOptions::default() && !used {
        let problem = "nothing uses it; --indices, --efforts and --reactions do, and --time-optimal uses loads where joints have a max_effort";
        return Err(Failure::flag(given_setup(&setup), problem));
    }
    let setup = setup.check(&manipulator)?;
    let clearance = interference::clearance(args.clearance)?;
    interference::note_clearance(output, args.clearance, (&loaded, &manipulator));
    let mut request = request(args, &manipulator, &motion, clearance);
    if args.indices {
        request = request.indices(&setup);
    }
    if args.efforts {
        request = request.efforts(&setup);
    }
    if args.reactions {
        request = request.reactions(&setup);
    }
    let trajectory = request.trajectory()?;
    if let Some(path) = target.path() {
        loaded.refuse_as_output(path, &motion.path.as_deref().into_iter().collect::<Vec<_>>())?;
    }
    // Before there is a file that nobody would be told of.
    let progress = interruptible()?;
    let recorder = match target {
        Target::Recording(path) => {
            let files = [loaded.attachment(), motion.attachment()];
            Some(MotionRecorder::create(path, request, files)?)
        }
        Target::Nowhere | Target::Printed | Target::Table(_) => None,
    };
    let options = TableOptions {
        rates: args.rates,
        accelerations: args.accelerations,
        units: (args.units == TableUnits::File).then_some(loaded.file.units),
    };
    let samples = trajectory.samples();
    if samples > MANY {
        let (rate, samples) = (request.rate, count(samples));
        output.note(format_args!("{samples} samples at {rate:e} Hz; --rate asks for fewer"));
    }
    let done = AtomicU64::new(0);
    let go_on = |number| {
        done.store(number, Ordering::Relaxed);
        !progress.is_cancelled()
    };
    let follow = || match (recorder, &target) {
        (Some(recorder), _) => recorder.follow(trajectory, go_on),
        (None, Target::Table(path)) => {
            write_motion_table(request, trajectory, options, path, go_on)
        }
        (None, Target::Printed) => {
            let mut stdout = stdout();
            let printed = ("standard output", &mut stdout as &mut dyn io::Write);
            write_motion_csv(request, trajectory, options, printed, go_on)
        }
        (None, _) => request.follow(trajectory, |_, _, _| Ok(()), go_on),
    };
    // There is no progress bar where rows may go to the terminal.
    let followed = match target {
        Target::Printed => follow(),
        _ => watch(output, "following", Some(samples), || done.load(Ordering::Relaxed), follow),
    };
    let summary = followed.map_err(|error| match error {
        StudyError::Cancelled => {
            let (done, samples) = (count(done.load(Ordering::Relaxed)), count(samples));
            let kept = target.path().map_or_else(String::new, |path| {
                format!("; what was recorded is in {}", partial(path).shown())
            });
            let message = format!("interrupted; {done} of {samples} samples were followed{kept}");
            Failure::interrupted(message)
        }
        StudyError::Record { error: RecordError::Io(error), .. }
            if matches!(target, Target::Printed) =>
        {
            Failure::stdout(error)
        }
        other => other.into(),
    })?;
    if let Some(path) = target.path() {
        output.note(format_args!("{}: {} samples", path.shown(), count(summary.samples)));
        layout::advise(path, output);
    }
    let violations = summary.violation_count;
    if violations > 0 && !args.strict {
        let what = if violations == 1 { "violation" } else { "violations" };
        output.warn(format_args!(
            "the mechanism cannot follow all of it: {} {what}",
            count(violations)
        ));
    }
    let contacts = summary.contacts.iter().map(|found| found.contacts.len()).sum::<usize>();
    if contacts > 0 && clearance.is_some() {
        let stretches = crate::text::plural(contacts as u64, "contact");
        output.warn(format_args!("bodies interfere: {stretches}"));
    }
    let report = Report { request, summary: &summary, units: loaded.file.units, given_duration };
    if !matches!(target, Target::Printed) {
        output.print(&report.json(), report.text())?;
    }
    if args.strict && clearance.is_some() && violations == 0 && contacts > 0 {
        let problem =
            format!("{}: bodies interfere (--strict): {}", motion.label, report.first_contact());
        return Err(Failure::work(problem));
    }
    match args.strict && violations > 0 {
        true => Err(Failure::work(format!(
            "{}: the mechanism cannot follow all of it (--strict): {}",
            motion.label,
            report.first()
        ))),
        false => Ok(()),
    }
}
