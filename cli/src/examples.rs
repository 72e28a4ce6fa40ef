//! `opm examples`: the mechanism files that come with the program.

use crate::args::{ExamplesArgs, Format, Output};
use crate::failure::Failure;
use crate::load::example_names;
use crate::output::print_with;
use crate::text::Table;
use opm_core::mechanism::examples::{EXAMPLES, find};
use serde_json::json;
use std::io::Write;

pub fn run(args: &ExamplesArgs, output: &Output) -> Result<(), Failure> {
    let Some(name) = &args.name else {
        let list: Vec<_> = EXAMPLES
            .iter()
            .map(|example| json!({ "name": example.name, "description": example.description }))
            .collect();
        let mut table = Table::new(["name", "what it is"]);
        for example in EXAMPLES {
            table.row([example.name, example.description]);
        }
        return output.print(&json!({ "examples": list }), table);
    };
    let example = find(name).ok_or_else(|| {
        Failure::Usage(format!("no example {name:?}; there are {}", example_names()))
    })?;
    match output.format {
        Format::Text => print_with(|out| out.write_all(example.text.as_bytes())),
        Format::Json => {
            let json = json!({
                "name": example.name, "description": example.description, "text": example.text,
            });
            output.print(&json, "")
        }
    }
}
