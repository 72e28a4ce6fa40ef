//! `opm`: kinematics and workspaces of overconstrained parallel manipulators, from a mechanism file.
//!
//! The program is a library with the function [`main`], so that the Python package can include the command.

mod accuracy;
mod analyze;
mod args;
mod batch;
mod calibrate;
mod change;
mod check;
mod completions;
mod convert;
mod decompose;
mod design;
mod examples;
mod explore;
mod export;
mod failure;
mod fk;
mod format;
#[doc(hidden)]
pub mod fuzzed;
mod generate;
mod ik;
mod inspect;
mod interference;
mod layout;
mod licenses;
mod linkage;
mod load;
mod measure;
mod merge;
mod motion;
mod new;
mod output;
mod parameters;
mod path;
mod plot;
mod pose;
mod pose_table;
mod progress;
mod recover;
mod runs;
mod schema;
mod stream;
mod target;
mod text;
mod trajectory;
mod transform;
mod unitless;
mod usage;
mod velocity;
mod workspace;

#[doc(hidden)]
pub use crate::output::look_at_stdout;

use crate::args::{Args, Command};
use crate::failure::Failure;
use std::ffi::OsString;
use std::io::{self, Write as _};

/// Runs a command line, which begins with the program's name, and returns the exit status:
/// 0 done, 1 the work failed, 2 wrong usage, 130 interrupted. All output has then been written to
/// standard output and standard error.
///
/// It handles Ctrl-C during long work, and the second Ctrl-C ends the process. Use it only in a
/// process that does nothing else.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    look_at_stdout();
    let done = match usage::parse(arguments) {
        Ok(args) => run(&args),
        // Help and the version come this way, too, and go to standard output. Nothing in them is of others: clap prints
        // them, with the styles of the terminal.
        Err(usage) if !usage.use_stderr() => output::open()
            .and_then(|()| usage.print())
            .and_then(|()| io::stdout().flush())
            .map_err(Failure::stdout),
        Err(usage) => {
            usage::print(usage::with_tips(usage));
            return 2;
        }
    };
    done.map_or_else(|failure| failure.report(), |()| 0)
}

fn run(args: &Args) -> Result<(), Failure> {
    let output = &args.output;
    match &args.command {
        Command::Decompose(command) => decompose::run(command, output),
        Command::Check(command) => check::run(command, output),
        Command::Ik(command) => ik::run(command, output),
        Command::Velocity(command) => velocity::run(command, output),
        Command::Analyze(command) => analyze::run(command, output),
        Command::Calibrate(command) => calibrate::run(command, output),
        Command::Accuracy(command) => accuracy::run(command, output),
        Command::Design(command) => design::run(command, output),
        Command::Fk(command) => fk::run(command, output),
        Command::Linkage(command) => linkage::run(command, output),
        Command::Trajectory(command) => trajectory::run(command, output),
        Command::Path(command) => path::run(command, output),
        Command::Workspace(command) => workspace::run(command, output),
        Command::Measure(command) => measure::run(command, output),
        Command::Merge(command) => merge::run(command, output),
        Command::Plot(command) => plot::run(command, output),
        Command::Inspect(command) => inspect::run(command, output),
        Command::Recover(command) => recover::run(command, output),
        Command::Layout(command) => layout::run(command, output),
        Command::Explore(command) => explore::run(command, output),
        Command::Convert(command) => convert::run(command, output),
        Command::Export(command) => export::run(command, output),
        Command::Generate(command) => generate::run(command, output),
        Command::New(command) => new::run(command, output),
        Command::Examples(command) => examples::run(command, output),
        Command::Schema(command) => schema::run(command),
        Command::Format(_) => format::run(output),
        Command::Licenses(_) => licenses::run(output),
        Command::Completions(command) => completions::run(command, output),
    }
}
