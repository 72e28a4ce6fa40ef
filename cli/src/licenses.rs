//! `opm licenses`: the licences of opm, and of everything that is part of the program.

use crate::args::Output;
use crate::failure::Failure;
use serde_json::json;

/// Written by `make notices`; `tests/python/test_notices.py` compares it with Cargo.lock.
const THIRD_PARTY: &str = include_str!("../THIRD-PARTY.txt");
const MIT: &str = include_str!("../LICENSE-MIT");
const APACHE: &str = include_str!("../LICENSE-APACHE");

pub fn run(output: &Output) -> Result<(), Failure> {
    let text = format!(
        "opm is licensed under either of the MIT licence or the Apache License, version 2.0, at your option.\n\n\
         {MIT}\n{APACHE}\n{THIRD_PARTY}"
    );
    output.print(&json!({ "text": text }), &text)
}
