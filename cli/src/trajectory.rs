//! `opm trajectory`: a motion as the joints follow it.

mod summary;

use crate::args::{Output, TrajectoryArgs};
use crate::failure::Failure;
use crate::load;
use crate::motion;
use crate::progress::{interruptible, watch};
use crate::text::count;
use opm_study::recording::{MotionRecorder, partial};
use opm_study::{MotionRequest, StudyError};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use summary::Report;

pub fn run(args: &TrajectoryArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    let manipulator = loaded.compile()?;
    let motion = motion::open(&args.motion, &manipulator)?;
    let mut request = MotionRequest::new(&manipulator, &motion.motion, &motion.label);
    if let Some(mode) = &args.mode {
        request = request.mode(load::mode(&manipulator, mode)?);
    }
    if let Some(rate) = args.rate {
        request = request.rate(rate);
    }
    let trajectory = request.trajectory()?;
    let recorder = match &args.output {
        Some(path) => {
            loaded
                .refuse_as_output(path, &motion.path.as_deref().into_iter().collect::<Vec<_>>())?;
            let files = [loaded.attachment(), motion.attachment()];
            Some(MotionRecorder::create(path, request, files)?)
        }
        None => None,
    };
    let progress = interruptible()?;
    let samples = trajectory.samples();
    let done = AtomicU64::new(0);
    let go_on = |number| {
        done.store(number, Ordering::Relaxed);
        !progress.is_cancelled()
    };
    let follow = || match recorder {
        Some(recorder) => recorder.follow(trajectory, go_on),
        None => request.follow(trajectory, |_, _, _| Ok(()), go_on),
    };
    let followed =
        watch(output, "following", Some(samples), || done.load(Ordering::Relaxed), follow);
    let summary = followed.map_err(|error| match error {
        StudyError::Cancelled => {
            let (done, samples) = (count(done.load(Ordering::Relaxed)), count(samples));
            let kept = args.output.as_deref().map_or_else(String::new, |path: &Path| {
                format!("; what was recorded is in {}", partial(path).display())
            });
            let message = format!("interrupted; {done} of {samples} samples were followed{kept}");
            Failure::interrupted(message)
        }
        other => other.into(),
    })?;
    if let Some(path) = &args.output {
        output.note(format_args!("{}: {} samples", path.display(), count(summary.samples)));
    }
    let violations = summary.violation_count;
    if violations > 0 && !args.strict {
        let what = if violations == 1 { "violation" } else { "violations" };
        output.warn(format_args!(
            "the mechanism cannot follow all of it: {} {what}",
            count(violations)
        ));
    }
    let report = Report { request, summary: &summary, units: loaded.file.units };
    output.print(&report.json(), report.text())?;
    match args.strict && violations > 0 {
        true => Err(Failure::work(format!(
            "{}: the mechanism cannot follow all of it (--strict): {}",
            motion.label,
            report.first()
        ))),
        false => Ok(()),
    }
}
