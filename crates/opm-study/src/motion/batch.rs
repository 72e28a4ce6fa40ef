//! The samples of a motion in batches. While one batch is received, the next ones are computed.

use super::MotionRequest;
use crate::error::StudyError;
use opm_core::trajectory::{Change, Sample, Trajectory, TrajectoryError, Violation};
use std::panic::resume_unwind;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread;

/// Number of samples in a batch. The work can be cancelled between two batches.
const BATCH: usize = 256;

/// Number of batches that may wait for the receiver.
const WAITING: usize = 4;

/// Samples, each with the transitions up to it.
pub(super) type Batch = Vec<(Sample, Vec<Change>)>;

impl MotionRequest<'_> {
    /// Follows the motion from end to end. On this thread, calls `take` with every batch of samples, in order.
    /// Returns the violations that last to the end.
    ///
    /// The motion is followed on a thread of its own. Where no thread can be started (WebAssembly has none),
    /// it is followed on this one. The batches are the same.
    pub(super) fn each_batch(
        &self,
        mut trajectory: Trajectory<'_>,
        mut take: impl FnMut(&Batch) -> Result<(), StudyError>,
    ) -> Result<Vec<Violation>, StudyError> {
        match self.each_batch_ahead(&mut trajectory, &mut take) {
            Some(followed) => followed?,
            None => self.each_batch_here(&mut trajectory, &mut take)?,
        }
        Ok(trajectory.open().copied().collect())
    }

    /// Follows the motion on a thread of its own; `None` if no thread can be started.
    fn each_batch_ahead(
        &self,
        trajectory: &mut Trajectory<'_>,
        mut take: impl FnMut(&Batch) -> Result<(), StudyError>,
    ) -> Option<Result<(), StudyError>> {
        thread::scope(|scope| {
            let (ahead, batches) = mpsc::sync_channel(WAITING);
            let (back, used) = mpsc::channel();
            let follow = move || send_batches(trajectory, &ahead, &used);
            let follower = thread::Builder::new().spawn_scoped(scope, follow).ok()?;
            for batch in batches {
                if let Err(error) = take(&batch) {
                    return Some(Err(error));
                }
                // When the follower has finished, it needs no more buffers.
                let _ = back.send(batch);
            }
            let followed = follower.join().unwrap_or_else(|panic| resume_unwind(panic));
            Some(followed.map_err(|error| self.failed(error)))
        })
    }

    /// Follows the motion on this thread.
    fn each_batch_here(
        &self,
        trajectory: &mut Trajectory<'_>,
        mut take: impl FnMut(&Batch) -> Result<(), StudyError>,
    ) -> Result<(), StudyError> {
        let mut batch = Batch::new();
        while fill(trajectory, &mut batch).map_err(|error| self.failed(error))? {
            take(&batch)?;
        }
        Ok(())
    }
}

/// Sends all samples, in batches that come back to be used again.
fn send_batches(
    trajectory: &mut Trajectory<'_>,
    ahead: &SyncSender<Batch>,
    used: &Receiver<Batch>,
) -> Result<(), TrajectoryError> {
    loop {
        let mut batch = used.try_recv().unwrap_or_default();
        // The receiver has gone if the work failed or was cancelled.
        if !fill(trajectory, &mut batch)? || ahead.send(batch).is_err() {
            return Ok(());
        }
    }
}

/// Overwrites a batch with the next samples; returns whether there were any.
fn fill(trajectory: &mut Trajectory<'_>, batch: &mut Batch) -> Result<bool, TrajectoryError> {
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
    Ok(length > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example;
    use opm_core::motion::{self, PlatformMotion};

    /// There are more batches than may wait, and the last one is incomplete.
    #[test]
    fn batches_are_the_same_on_one_thread_and_on_two() {
        let manipulator = example();
        let text = motion::examples::MOTIONS[0].text;
        let motion: PlatformMotion = motion::file::read(text, &manipulator).unwrap();
        let request = MotionRequest::new(&manipulator, &motion, "motion").rate(333.0);
        let follow = |ahead: bool| {
            let mut trajectory = request.trajectory().unwrap();
            let mut batches: Vec<String> = Vec::new();
            let take = |batch: &Batch| {
                batches.push(format!("{batch:?}"));
                Ok(())
            };
            match ahead {
                true => request.each_batch_ahead(&mut trajectory, take).expect("a thread").unwrap(),
                false => request.each_batch_here(&mut trajectory, take).unwrap(),
            }
            (batches, format!("{:?}", trajectory.open().collect::<Vec<_>>()))
        };
        let (here, ahead) = (follow(false), follow(true));
        assert!(here.0.len() > WAITING + 1, "{} batches", here.0.len());
        assert!(here == ahead);
    }
}
