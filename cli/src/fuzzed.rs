//! What fuzzers and their replay in the tests call. It is no part of the library's interface.

use crate::args::Args;
use crate::change::Change;
use crate::failure::Failure;
use crate::plot::options::PictureSize;
use crate::pose::{GridAxis, IndexLimit, Number, OverAxis, Pose, SliceValue};
use crate::transform::Transform;
use crate::usage;
use clap::{ArgAction, CommandFactory, Parser, ValueHint};
use std::ffi::OsString;

/// Reads a text as every kind of value that has numbers with units. A number is the same number wherever it stands.
///
/// # Panics
/// If it is not.
pub fn number(text: &str) {
    let number = text.parse::<Number>();
    if let Ok(number) = &number {
        assert!(number.without_unit().is_none_or(f64::is_finite), "{text:?}");
        assert_eq!(number.quantity().is_none(), number.without_unit().is_some(), "{text:?}");
    }
    let assigned = format!("x={text}");
    let (pose, grid, over) =
        (assigned.parse::<Pose>(), assigned.parse::<GridAxis>(), assigned.parse::<OverAxis>());
    let (slice, change) = (assigned.parse::<SliceValue>(), assigned.parse::<Change>());
    if !text.contains([',', ':']) && text.trim() != "none" {
        let accepted = number.is_ok();
        let all = [pose.is_ok(), grid.is_ok(), over.is_ok(), slice.is_ok(), change.is_ok()];
        assert_eq!(all, [accepted; 5], "{text:?}");
    }
    if let (Ok(number), Ok(slice)) = (&number, &slice) {
        assert_eq!(*number, slice.value, "{text:?}");
    }
    if let (Ok(grid), Ok(over)) = (&grid, &over) {
        assert_eq!(grid.ends(), over.ends(), "{text:?}");
    }
    let _ = (text.parse::<Pose>(), text.parse::<GridAxis>(), text.parse::<OverAxis>());
    let _ = (text.parse::<SliceValue>(), text.parse::<Change>(), text.parse::<IndexLimit>());
    let _ = (text.parse::<Transform>(), text.parse::<PictureSize>());
}

/// The name of a command, and its options with whether they take a value.
pub type QuickCommand = (String, Vec<(String, bool)>);

/// The commands that read no other file than a mechanism and that answer at once, each with its options that name no
/// file. `true` for those that take a value.
pub fn quick_commands() -> Vec<QuickCommand> {
    const QUICK: [&str; 6] = ["decompose", "ik", "velocity", "fk", "analyze", "accuracy"];
    const LONG: [&str; 4] = ["samples", "threads", "grid", "aspects"];
    let takes = |arg: &clap::Arg| matches!(arg.get_action(), ArgAction::Set | ArgAction::Append);
    let is_file = |arg: &clap::Arg| matches!(arg.get_value_hint(), ValueHint::FilePath);
    let program = Args::command();
    let globals = [("format".to_owned(), true)];
    let options = |command: &clap::Command| {
        let own = command.get_arguments().filter(|arg| !is_file(arg)).filter_map(|arg| {
            let name = arg.get_long().filter(|name| !LONG.contains(name))?;
            Some((name.to_owned(), takes(arg)))
        });
        own.chain(globals.clone()).collect()
    };
    QUICK
        .iter()
        .filter_map(|name| program.find_subcommand(name))
        .map(|command| (command.get_name().to_owned(), options(command)))
        .collect()
}

/// Runs a command line and prints nothing; what it would have printed of a failure is returned.
///
/// # Errors
/// The message, for wrong usage and for work that failed.
pub fn silently(arguments: impl IntoIterator<Item = OsString>) -> Result<(), String> {
    let mut args = Args::try_parse_from(arguments)
        .map_err(|error| usage::with_tips(error).render().to_string())?;
    (args.output.quiet, args.output.silent) = (true, true);
    super::run(&args).map_err(|failure: Failure| failure.to_string())
}
