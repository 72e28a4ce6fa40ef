//! `opm format`, `opm help format`: the format of mechanism and motion files.

use crate::args::Output;
use crate::failure::Failure;
use serde_json::json;

/// The explanation.
pub const TEXT: &str = include_str!("format.md");

pub fn run(output: &Output) -> Result<(), Failure> {
    output.print(&json!({ "text": TEXT }), TEXT)
}
