//! Errors of usage, with tips that help.

use crate::args::{Args, FEW, WIDEST};
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, FromArgMatches};
use opm_core::text::{message, visible};
use std::ffi::OsString;
use std::io::{self, IsTerminal, Write};

/// Reads a command line, which begins with the program's name.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Args, clap::Error> {
    let mut command = with_short_help(Args::command());
    if has_no_width() {
        command = command.term_width(WIDEST);
    }
    let mut matches = command.try_get_matches_from_mut(arguments)?;
    Args::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command))
}

/// The program where the short help of a command with many options has only those without a heading, and says so.
fn with_short_help(program: clap::Command) -> clap::Command {
    program.mut_subcommands(|command| {
        let command = with_short_help(command);
        if command.get_opts().count() <= FEW {
            return command;
        }
        command
            .mut_args(|argument| {
                let headed = argument.get_help_heading().is_some();
                argument.hide_short_help(headed)
            })
            .after_help("--help has all options.")
    })
}

/// Whether the width of the help is unknown. Without a terminal clap takes it from COLUMNS, also where that is 0.
fn has_no_width() -> bool {
    let terminal =
        io::stdout().is_terminal() || io::stderr().is_terminal() || io::stdin().is_terminal();
    !terminal && std::env::var("COLUMNS").is_ok_and(|columns| columns.parse() == Ok(0))
}

/// An error for an unknown option without the tip to pass it as a value, which no command takes. If other commands have
/// this option, they are named.
pub fn with_tips(mut error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    error.remove(ContextKind::Suggested);
    let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidArg) else {
        return error;
    };
    let owners = owners(given);
    if !owners.is_empty() {
        let tip = format!("{given} is an option of {}", owners.join(", "));
        let tips = vec![StyledStr::from(tip)];
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    error
}

/// Prints an error on standard error. What it repeats of the command line is made visible, and shortened; then it has no
/// styles.
pub fn print(mut error: clap::Error) {
    // On one line: the next one may look like another message.
    let values = error.context().filter_map(|(kind, value)| match value {
        ContextValue::String(text) => {
            Some((kind, ContextValue::String(visible(text).into_owned())))
        }
        _ => None,
    });
    for (kind, value) in values.collect::<Vec<_>>() {
        error.insert(kind, value);
    }
    let plain = error.render().to_string();
    let shown = message(&plain);
    // Nobody is left to be told of a failure.
    let _ = match *shown == *plain {
        true => error.print(),
        false => io::stderr().write_all(shown.as_bytes()),
    };
}

/// The commands that have an option of this name.
fn owners(option: &str) -> Vec<String> {
    let Some(name) = option.strip_prefix("--") else { return Vec::new() };
    let args = Args::command();
    let has = |command: &&clap::Command| {
        command.get_arguments().any(|argument| argument.get_long() == Some(name))
    };
    args.get_subcommands()
        .filter(has)
        .map(|command| format!("opm {}", command.get_name()))
        .collect()
}
