//! `opm`: kinematics and workspaces of overconstrained parallel manipulators, from a mechanism file.

mod args;
mod batch;
mod cloud;
mod completions;
mod decompose;
mod examples;
mod failure;
mod fk;
mod ik;
mod inspect;
mod lines;
mod linkage;
mod load;
mod merge;
mod motion;
mod output;
mod plot;
mod pose;
mod progress;
mod record;
mod scene;
mod shard;
mod source;
mod text;
mod trajectory;
mod transform;
mod velocity;
mod workspace;

use crate::args::{Args, Command};
use crate::failure::Failure;
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(args: &Args) -> Result<(), Failure> {
    let output = &args.output;
    match &args.command {
        Command::Decompose(command) => decompose::run(command, output),
        Command::Ik(command) => ik::run(command, output),
        Command::Velocity(command) => velocity::run(command, output),
        Command::Fk(command) => fk::run(command, output),
        Command::Linkage(command) => linkage::run(command, output),
        Command::Trajectory(command) => trajectory::run(command, output),
        Command::Workspace(command) => workspace::run(command, output),
        Command::Merge(command) => merge::run(command, output),
        Command::Plot(command) => plot::run(command, output),
        Command::Inspect(command) => inspect::run(command, output),
        Command::Examples(command) => examples::run(command, output),
        Command::Completions(command) => completions::run(command),
    }
}
