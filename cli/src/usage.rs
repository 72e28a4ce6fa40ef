//! Errors of usage, with tips that help.

use crate::args::Args;
use clap::CommandFactory;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

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
