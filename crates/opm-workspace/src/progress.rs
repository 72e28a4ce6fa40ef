//! How far a sweep has come, and the request to stop it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The progress of a sweep, shared with the thread that watches it and may cancel it.
///
/// ```
/// use opm_workspace::Progress;
///
/// let progress = Progress::default();
/// assert_eq!(progress.done(), 0);
/// progress.cancel(); // from any thread: the sweep returns `Cancelled` soon
/// assert!(progress.is_cancelled());
/// ```
#[derive(Debug, Default)]
pub struct Progress {
    done: AtomicU64,
    cancelled: AtomicBool,
}

/// The sweep was cancelled by [`Progress::cancel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Progress {
    /// The number of poses decided so far. For a measure, the number of boxes.
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Asks the sweep to stop soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the sweep was asked to stop by [`Progress::cancel`].
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Counts poses as decided.
    ///
    /// # Errors
    /// The work was asked to stop.
    #[doc(hidden)]
    pub fn advance(&self, poses: u64) -> Result<(), Cancelled> {
        self.done.fetch_add(poses, Ordering::Relaxed);
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}
