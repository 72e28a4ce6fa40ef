//! `opm trajectory`: a motion as the joints follow it.

mod play;
mod summary;

use crate::args::{Output, TrajectoryArgs};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::motion::{self, LoadedMotion};
use crate::progress::{interruptible, watch};
use crate::record::partial;
use crate::text::count;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::trajectory::{Change, Sample, Trajectory, TrajectoryError, Violation};
use opm_mcap::PartialFile;
use play::Player;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread;
use summary::Summary;

/// Samples a second where nobody says.
const RATE: f64 = 100.0;

/// Samples that are handed over at a time; in between, somebody may press Ctrl-C.
const BATCH: usize = 256;

/// Batches that may wait to be recorded.
const WAITING: usize = 4;

/// The clock of a recording counts nanoseconds: at more samples a second they would coincide.
const HIGHEST_RATE: f64 = 1e9;

/// Longest motion, seconds: a recording's stamps count seconds in 32 bits.
const LONGEST: f64 = 4e9;

/// What is followed.
pub struct Run<'a> {
    pub loaded: &'a Loaded,
    pub motion: &'a LoadedMotion,
    pub manipulator: &'a Manipulator,
    pub mode: Mode,
    pub rate: f64,
}

/// Reads a number of samples a second.
pub fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if rate > 0.0 && rate <= HIGHEST_RATE => Ok(rate),
        _ => Err(format!("expected a number of hertz above 0 and at most {HIGHEST_RATE:e}")),
    }
}

pub fn run(args: &TrajectoryArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.file)?;
    let manipulator = loaded.compile()?;
    let motion = motion::open(&args.motion, &manipulator)?;
    let mode = match &args.mode {
        Some(mode) => load::mode(&manipulator, mode)?,
        None => motion.motion.mode.unwrap_or_else(|| manipulator.home_mode()),
    };
    let rate = args.rate.or(motion.motion.rate).unwrap_or(RATE);
    let run = Run { loaded: &loaded, motion: &motion, manipulator: &manipulator, mode, rate };
    run.check()?;
    let trajectory = run.trajectory()?;
    let player = match &args.output {
        Some(path) => {
            loaded
                .refuse_as_output(path, &motion.path.as_deref().into_iter().collect::<Vec<_>>())?;
            Some(Player::create(path, &run)?)
        }
        None => None,
    };
    let progress = interruptible()?;
    let samples = trajectory.samples();
    let done = AtomicU64::new(0);
    let follow = || run.follow(trajectory, player, &done, || progress.is_cancelled());
    let followed =
        watch(output, "following", Some(samples), || done.load(Ordering::Relaxed), follow);
    let summary = followed.map_err(|failure| match failure {
        Failure::Interrupted(_) => {
            let (done, samples) = (count(done.load(Ordering::Relaxed)), count(samples));
            let kept = args.output.as_deref().map_or_else(String::new, |path: &Path| {
                format!("; what was recorded is in {}", partial(path).display())
            });
            let message = format!("interrupted; {done} of {samples} samples were followed{kept}");
            Failure::Interrupted(message)
        }
        other => other,
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
    output.print(&summary.json(&run), summary.text(&run))?;
    match args.strict && violations > 0 {
        true => Err(Failure::Work(format!(
            "{}: the mechanism cannot follow all of it (--strict): {}",
            motion.label,
            summary.first(&run)
        ))),
        false => Ok(()),
    }
}

/// Samples on their way from who follows the motion to who records it.
type Batch = Vec<(Sample, Vec<Change>)>;

impl Run<'_> {
    /// Records the motion from end to end.
    pub fn record(
        &self,
        path: &Path,
        done: &AtomicU64,
        cancelled: impl Fn() -> bool,
    ) -> Result<(), Failure> {
        self.check()?;
        let trajectory = self.trajectory()?;
        let player = Player::create(path, self)?;
        self.follow(trajectory, Some(player), done, cancelled).map(|_| ())
    }

    /// Refuses what a recording has no clock for.
    fn check(&self) -> Result<(), Failure> {
        let (label, duration) = (&self.motion.label, self.motion.motion.duration);
        let long = format!("{label}: lasts {duration:e} s, expected at most {LONGEST:e} s");
        if duration > LONGEST { Err(Failure::Work(long)) } else { Ok(()) }
    }

    fn trajectory(&self) -> Result<Trajectory<'_>, Failure> {
        Trajectory::new(self.manipulator, &self.motion.motion, self.mode, self.rate)
            .map_err(|error| Failure::at(&self.motion.label, &error))
    }

    /// Follows the motion from end to end, and records it where there is a player: the one on a thread
    /// of its own, while the other takes down what came before.
    fn follow(
        &self,
        trajectory: Trajectory<'_>,
        mut player: Option<Player<PartialFile>>,
        done: &AtomicU64,
        cancelled: impl Fn() -> bool,
    ) -> Result<Summary, Failure> {
        let mut summary = Summary::new(self.manipulator);
        let open = thread::scope(|scope| {
            let (ahead, batches) = mpsc::sync_channel::<Batch>(WAITING);
            let (back, used) = mpsc::channel::<Batch>();
            let follower = scope.spawn(move || follow(trajectory, &ahead, &used));
            let mut number = 0;
            for batch in batches {
                for (sample, changes) in &batch {
                    summary.add(sample);
                    if let Some(player) = &mut player {
                        player.sample(self, number, sample, changes)?;
                    }
                    for change in changes {
                        if let Change::Ends(violation) = change {
                            summary.violation(*violation);
                        }
                    }
                    number += 1;
                }
                done.store(number, Ordering::Relaxed);
                if cancelled() {
                    return Err(Failure::Interrupted(String::new()));
                }
                // Once the follower has come to its end it needs no more room.
                let _ = back.send(batch);
            }
            let followed = follower.join().unwrap_or_else(|panic| resume_unwind(panic));
            followed.map_err(|error| Failure::at(&self.motion.label, &error))
        })?;
        open.into_iter().for_each(|violation| summary.violation(violation));
        summary.sort();
        if let Some(player) = player {
            player.finish(self, &summary)?;
        }
        Ok(summary)
    }
}

/// Sends all samples, batch by batch, in batches that come back; the violations that last to the end.
fn follow(
    mut trajectory: Trajectory<'_>,
    ahead: &SyncSender<Batch>,
    used: &Receiver<Batch>,
) -> Result<Vec<Violation>, TrajectoryError> {
    loop {
        let mut batch = used.try_recv().unwrap_or_default();
        let mut length = 0;
        while length < BATCH && trajectory.advance()? {
            let (sample, changes) = (trajectory.sample(), trajectory.changes());
            match batch.get_mut(length) {
                Some((held, held_changes)) => {
                    held.copy_from(sample);
                    held_changes.clear();
                    held_changes.extend_from_slice(changes);
                }
                None => batch.push((sample.clone(), changes.to_vec())),
            }
            length += 1;
        }
        batch.truncate(length);
        // Nobody listens any more once the recording has failed or was interrupted.
        if length == 0 || ahead.send(batch).is_err() {
            return Ok(trajectory.open().copied().collect());
        }
    }
}
