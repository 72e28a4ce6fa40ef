//! `opm completions`: a completion script, or manual pages.

use crate::args::{Args, Completion, CompletionsArgs, Output};
use crate::failure::Failure;
use crate::output::{Shown, print_with};
use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;
use std::fs;
use std::io::Write;
use std::path::Path;

pub fn run(args: &CompletionsArgs, output: &Output) -> Result<(), Failure> {
    let shell = match args.shell {
        Completion::Bash => Shell::Bash,
        Completion::Elvish => Shell::Elvish,
        Completion::Fish => Shell::Fish,
        Completion::PowerShell => Shell::PowerShell,
        Completion::Zsh => Shell::Zsh,
        Completion::Man => return manual(args.directory.as_deref(), output),
    };
    if args.directory.is_some() {
        return Err(Failure::flag("--directory", "only manual pages are written to a folder"));
    }
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Args::command(), "opm", &mut script);
    print_with(|out| out.write_all(&script))
}

/// Prints the page of opm, or writes it and those of its commands to a folder.
fn manual(directory: Option<&Path>, output: &Output) -> Result<(), Failure> {
    let Some(directory) = directory else {
        return print_with(|out| Man::new(Args::command()).render(out));
    };
    let written = fs::create_dir_all(directory)
        .and_then(|()| clap_mangen::generate_to(Args::command(), directory));
    written.map_err(|error| Failure::at(directory.shown(), error))?;
    output.note(format_args!("{}: manual pages of opm and its commands", directory.shown()));
    Ok(())
}
