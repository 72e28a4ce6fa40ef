//! A progress bar on a terminal, and Ctrl-C.

use crate::args::Output;
use crate::failure::Failure;
use crate::output::Shown;
use crate::text::count;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use opm_workspace::Progress;
use std::fmt::Write;
use std::io::{self, Read};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

/// Interval at which the bar is redrawn.
const TICK: Duration = Duration::from_millis(100);

/// The work that Ctrl-C cancels: the last that was begun. A process has one handler.
static WORK: Mutex<Option<Arc<Progress>>> = Mutex::new(None);

/// Whether a source is read that gives something only when somebody writes it: then the work does not hear of Ctrl-C.
static WAITING: AtomicBool = AtomicBool::new(false);

/// Progress that the first Ctrl-C cancels. The second one ends the process at once.
pub fn interruptible() -> Result<Arc<Progress>, Failure> {
    let progress = Arc::new(Progress::default());
    work().replace(Arc::clone(&progress));
    clean_up_at_ctrl_c()?;
    Ok(progress)
}

fn work() -> MutexGuard<'static, Option<Arc<Progress>>> {
    WORK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From here on Ctrl-C, where it does not cancel work, ends the process in order: files that nothing was written to are
/// removed, and the others are named.
pub fn clean_up_at_ctrl_c() -> Result<(), Failure> {
    static HANDLED: Mutex<bool> = Mutex::new(false);
    let mut handled = HANDLED.lock().unwrap_or_else(PoisonError::into_inner);
    if !*handled {
        ctrlc::set_handler(|| match work().as_ref() {
            Some(heard) if !heard.is_cancelled() && !WAITING.load(Ordering::Relaxed) => {
                heard.cancel();
            }
            _ => end(),
        })
        .map_err(|error| Failure::at("Ctrl-C", error))?;
        *handled = true;
    }
    Ok(())
}

/// Ends the process.
fn end() -> ! {
    let left: Vec<_> = opm_mcap::unfinished().iter().map(|path| path.shown()).collect();
    let left = match &*left {
        [] => String::new(),
        left => format!("; what was written so far is in {}", left.join(", ")),
    };
    process::exit(Failure::interrupted(format!("interrupted{left}")).report().into())
}

/// A source that may have to be waited for, during which Ctrl-C ends the process.
pub struct Waiting<R>(pub R);

impl<R: Read> Read for Waiting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        WAITING.store(true, Ordering::Relaxed);
        let count = self.0.read(buffer);
        WAITING.store(false, Ordering::Relaxed);
        count
    }
}

/// Does some work while a bar shows its progress, `done` out of `total` poses. The bar is on
/// standard error, and only if that is a terminal.
pub fn watch<T>(
    output: &Output,
    label: &'static str,
    total: Option<u64>,
    done: impl Fn() -> u64 + Send,
    work: impl FnOnce() -> T,
) -> T {
    let bar = match total {
        Some(total) => ProgressBar::new(total).with_style(style(
            "{msg} {wide_bar} {percent}% of {human_len} poses, {rate} poses/s, ETA {eta}",
        )),
        None => ProgressBar::no_length()
            .with_style(style("{spinner} {msg}: {human_pos} poses, {rate} poses/s")),
    };
    show(output, &bar, label, done, work)
}

/// As [`watch`], for at most `budget` boxes. `told` is what is known so far.
pub fn watch_boxes<T>(
    output: &Output,
    budget: u64,
    told: impl Fn() -> String + Send,
    done: impl Fn() -> u64 + Send,
    work: impl FnOnce() -> T,
) -> T {
    let bar = ProgressBar::new(budget).with_style(style(
        "{msg} {wide_bar} {percent}% of the budget of {human_len} boxes, {rate} boxes/s",
    ));
    let line = bar.clone();
    let done = move || {
        line.set_message(told());
        done()
    };
    show(output, &bar, "", done, work)
}

/// As [`watch`], for this number of steps, or for steps whose final number is unknown.
pub fn watch_steps<T>(
    output: &Output,
    label: &'static str,
    total: Option<u64>,
    done: impl Fn() -> u64 + Send,
    work: impl FnOnce() -> T,
) -> T {
    let bar = match total {
        Some(total) => {
            ProgressBar::new(total).with_style(style("{msg} {wide_bar} {percent}%, ETA {eta}"))
        }
        None => ProgressBar::no_length()
            .with_style(style("{spinner} {msg}: {human_pos} steps, {elapsed}")),
    };
    show(output, &bar, label, done, work)
}

/// As [`watch`], for reading a recording with this number of messages, or with an unknown number.
pub fn watch_reading<T>(
    output: &Output,
    total: Option<u64>,
    done: impl Fn() -> u64 + Send,
    work: impl FnOnce() -> T,
) -> T {
    let bar = match total {
        Some(total) => ProgressBar::new(total)
            .with_style(style("{msg} {wide_bar} {percent}% of {human_len} messages, ETA {eta}")),
        None => ProgressBar::no_length().with_style(style("{spinner} {msg}: {human_pos} messages")),
    };
    show(output, &bar, "reading", done, work)
}

fn show<T>(
    output: &Output,
    bar: &ProgressBar,
    label: &'static str,
    done: impl Fn() -> u64 + Send,
    work: impl FnOnce() -> T,
) -> T {
    if output.quiet {
        return work();
    }
    bar.set_message(label);
    thread::scope(|scope| {
        let (finished, waiting) = mpsc::channel::<()>();
        // As one type, for which threads are compiled once.
        let draw: Box<dyn FnOnce() + Send + '_> = Box::new(move || {
            // Nothing is sent. The other end is dropped when the work is done, even by a panic.
            while waiting.recv_timeout(TICK) == Err(mpsc::RecvTimeoutError::Timeout) {
                bar.set_position(done());
                bar.tick();
            }
            bar.finish_and_clear();
        });
        scope.spawn(draw);
        let result = work();
        drop(finished);
        result
    })
}

fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template);
    let rate = |state: &ProgressState, text: &mut dyn Write| {
        let _ = text.write_str(&count(state.per_sec() as u64));
    };
    style.unwrap_or_else(|_| ProgressStyle::default_bar()).with_key("rate", rate)
}
