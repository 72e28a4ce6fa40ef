//! `opm completions`: a completion script.

use crate::args::{Args, CompletionsArgs};
use crate::failure::Failure;
use crate::output::print_with;
use clap::CommandFactory;
use std::io::Write;

pub fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "opm", &mut script);
    print_with(|out| out.write_all(&script))
}
