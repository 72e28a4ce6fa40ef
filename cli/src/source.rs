//! Where the points of a recording come from: a sweep, or what sweeps of its shards stored.

use crate::failure::Failure;
use opm_mcap::read;
use opm_workspace::{Grid, Hits, Poses, Progress, Run, SetError, Sweep, replay};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;

/// Messages that are read ahead: bounds the memory that runs wait in.
const AHEAD: usize = 4;

/// Gives the reachable poses of a grid, in order, as often as asked for.
pub enum Source<'a> {
    /// By sweeping.
    Sweep(Sweep<'a>),
    /// From the files of all shards, in their order.
    Shards { grid: &'a Grid, files: Vec<PathBuf> },
}

impl Poses for Source<'_> {
    type Error = Failure;

    fn grid(&self) -> &Grid {
        match self {
            Self::Sweep(sweep) => sweep.grid(),
            Self::Shards { grid, .. } => grid,
        }
    }

    fn points<T: Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), Failure> + Send,
    ) -> Result<(), Failure> {
        match self {
            Self::Sweep(sweep) => sweep.points(progress, make, empty, visit),
            Self::Shards { grid, files } => thread::scope(|scope| {
                let (sender, runs) = mpsc::sync_channel(AHEAD);
                scope.spawn(move || {
                    for file in files {
                        let send = |runs| sender.send(runs).map_err(|_| Failure::Closed);
                        let sent = runs_of(file, |runs| send(runs.into_iter().map(Ok).collect()));
                        if let Err(failure) = sent {
                            // Nobody hears of it who has gone.
                            let _ = send(vec![Err(failure)]);
                            return;
                        }
                    }
                });
                replay(grid, runs.into_iter().flatten(), progress, make, empty, visit)
            }),
        }
    }
}

impl From<SetError> for Failure {
    fn from(error: SetError) -> Self {
        match error {
            SetError::Cancelled(cancelled) => cancelled.into(),
            other => Self::Work(other.to_string()),
        }
    }
}

/// Reads the runs of a shard's file, message by message.
pub fn runs_of(
    file: &Path,
    mut visit: impl FnMut(Vec<Run>) -> Result<(), Failure>,
) -> Result<opm_mcap::Recording, Failure> {
    read(file, |message| match message.runs()? {
        Some(runs) => Ok(visit(runs.into_iter().map(|[from, to]| Run { from, to }).collect())?),
        None => Ok(()),
    })
    .map_err(|stop| match stop {
        Stop::Unread(error) => Failure::at(file.display(), &error),
        Stop::Other(failure) => failure,
    })
}

/// Why reading ended.
enum Stop {
    Unread(opm_mcap::ReadError),
    Other(Failure),
}

impl From<opm_mcap::ReadError> for Stop {
    fn from(error: opm_mcap::ReadError) -> Self {
        Self::Unread(error)
    }
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Other(failure)
    }
}
