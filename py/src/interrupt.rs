//! Long computations without the interpreter's lock. Ctrl-C stops them.

use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use std::num::NonZeroUsize;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use crate::error::{failed, wrong};

/// The interval at which Python's signal handlers run.
const PATIENCE: Duration = Duration::from_millis(50);

/// How many threads are worth it for work that comes in so many pieces: to make one takes as long as to decide
/// some ten thousand poses of a sweep, and one without a piece has nothing to do.
pub fn few(threads: Option<NonZeroUsize>, pieces: u64) -> Option<NonZeroUsize> {
    let pieces = usize::try_from(pieces).ok().and_then(NonZeroUsize::new)?;
    match threads {
        Some(threads) => Some(threads.min(pieces)),
        // Without a number, the thread pool uses one thread for each processor.
        None => Some(pieces).filter(|pieces| pieces.get() == 1),
    }
}

/// Does `work` in a thread pool of its own while this thread listens to signals; at the first that
/// raises, asks the work to stop with `cancel`, waits for it, and gives the exception. A pool a call: one
/// that outlives it would be lost in a forked process, and the work with it.
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
                // There is no receiver any more if a signal handler has raised.
                let _ = sender.send(work());
            });
            loop {
                match receiver.recv_timeout(PATIENCE) {
                    Ok(result) => return Ok(result),
                    Err(RecvTimeoutError::Timeout) => {
                        // A function of any lifetime, which the method alone is not.
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
