//! A progress bar on a terminal, and Ctrl-C.

use crate::args::Output;
use crate::failure::Failure;
use crate::text::count;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use opm_workspace::Progress;
use std::fmt::Write;
use std::process;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

/// Interval at which the bar is redrawn.
const TICK: Duration = Duration::from_millis(100);

/// The work that Ctrl-C cancels: the last that was begun. A process has one handler.
static WORK: Mutex<Option<Arc<Progress>>> = Mutex::new(None);

/// Progress that the first Ctrl-C cancels. The second one ends the process at once.
pub fn interruptible() -> Result<Arc<Progress>, Failure> {
    let work = || WORK.lock().unwrap_or_else(PoisonError::into_inner);
    let progress = Arc::new(Progress::default());
    if work().replace(Arc::clone(&progress)).is_none() {
        ctrlc::set_handler(move || {
            let Some(heard) = work().clone() else { return };
            if heard.is_cancelled() {
                process::exit(130);
            }
            heard.cancel();
        })
        .map_err(|error| Failure::at("Ctrl-C", error))?;
    }
    Ok(progress)
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

/// As [`watch`], for boxes whose final number is unknown.
pub fn watch_boxes<T>(
    output: &Output,
    label: &'static str,
    done: impl Fn() -> u64 + Send,
    work: impl FnOnce() -> T,
) -> T {
    let bar = ProgressBar::no_length()
        .with_style(style("{spinner} {msg}: {human_pos} boxes, {rate} boxes/s"));
    show(output, &bar, label, done, work)
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
