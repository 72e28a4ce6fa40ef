//! Long computations without the interpreter's lock. Ctrl-C stops them.

use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use std::num::NonZeroUsize;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use crate::error::{failed, wrong};

/// The interval at which Python's signal handlers run.
const PATIENCE: Duration = Duration::from_millis(50);

/// The number of threads for work that comes in this many pieces. To start a thread takes as long as to decide
/// some ten thousand poses of a sweep, and a thread without a piece has nothing to do.
pub fn few(threads: Option<NonZeroUsize>, pieces: u64) -> Option<NonZeroUsize> {
    let pieces = usize::try_from(pieces).ok().and_then(NonZeroUsize::new)?;
    match threads {
        Some(threads) => Some(threads.min(pieces)),
        // Without a number, the thread pool uses one thread for each processor.
        None => Some(pieces).filter(|pieces| pieces.get() == 1),
    }
}

/// Does `work` in a thread pool of its own while this thread runs Python's signal handlers. If one of them
/// raises, `cancel` tells the work to stop, and the exception is returned when it has stopped. Every call makes
/// its own pool: a forked process would lose the threads of one that outlives the call.
pub fn run<T: Send>(
    py: Python<'_>,
    threads: Option<NonZeroUsize>,
    work: impl FnOnce() -> T + Send,
    cancel: impl Fn() + Sync,
) -> PyResult<T> {
    let threads = threads.map_or(0, NonZeroUsize::get);
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| failed(&e))?;
    py.detach(|| {
        pool.in_place_scope(|scope| {
            let (sender, receiver) = channel();
            scope.spawn(move |_| {
                // If a signal handler has raised, the receiver is gone.
                let _ = sender.send(work());
            });
            loop {
                match receiver.recv_timeout(PATIENCE) {
                    Ok(result) => return Ok(result),
                    Err(RecvTimeoutError::Timeout) => {
                        // The closure works for any lifetime; the method alone does not.
                        #[allow(clippy::redundant_closure_for_method_calls)]
                        let heard = Python::attach(|py| py.check_signals());
                        if let Err(raised) = heard {
                            cancel();
                            return Err(raised);
                        }
                    }
                    // The work has panicked, so the scope will panic, too.
                    Err(RecvTimeoutError::Disconnected) => return Err(wrong("the work panicked")),
                }
            }
        })
    })
}
