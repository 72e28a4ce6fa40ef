//! The poses that are stored in the files of shards.

use crate::error::StudyError;
use opm_mcap::{ReadError, Recording, read};
use opm_workspace::{Grid, Hits, Progress, Run, replay};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;

/// Number of messages that are read ahead. This bounds the memory of waiting runs.
const AHEAD: usize = 4;

/// The poses that are stored in the files of all shards of a workspace.
pub struct ShardPoses<'a> {
    grid: &'a Grid,
    files: Vec<PathBuf>,
}

impl<'a> ShardPoses<'a> {
    /// The poses in the files of all shards, which are in order.
    pub(crate) fn new(grid: &'a Grid, files: Vec<PathBuf>) -> Self {
        Self { grid, files }
    }

    pub(crate) fn grid(&self) -> &Grid {
        self.grid
    }

    pub(crate) fn points<T: Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), StudyError> + Send,
    ) -> Result<(), StudyError> {
        thread::scope(|scope| {
            let (sender, runs) = mpsc::sync_channel(AHEAD);
            scope.spawn(move || {
                for file in &self.files {
                    let send = |runs| sender.send(runs).map_err(|_| StudyError::Closed);
                    let sent = runs_of(file, |runs| send(runs.into_iter().map(Ok).collect()));
                    if let Err(error) = sent {
                        // The receiver of the runs may have stopped.
                        let _ = send(vec![Err(error)]);
                        return;
                    }
                }
            });
            replay(self.grid, runs.into_iter().flatten(), progress, make, empty, visit)
        })
    }
}

/// Reads the runs of the file of a shard, message by message.
pub(crate) fn runs_of(
    file: &Path,
    mut visit: impl FnMut(Vec<Run>) -> Result<(), StudyError>,
) -> Result<Recording, StudyError> {
    /// The error that ended the reading.
    enum ReadEnd {
        Unread(ReadError),
        Study(StudyError),
    }
    impl From<ReadError> for ReadEnd {
        fn from(error: ReadError) -> Self {
            Self::Unread(error)
        }
    }
    let read = read(file, |message| match message.runs()? {
        Some(runs) => {
            let runs = runs.into_iter().map(|[from, to]| Run { from, to }).collect();
            visit(runs).map_err(ReadEnd::Study)
        }
        None => Ok(()),
    });
    read.map_err(|stop| match stop {
        ReadEnd::Unread(error) => StudyError::Read { place: file.display().to_string(), error },
        ReadEnd::Study(error) => error,
    })
}
