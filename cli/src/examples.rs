//! `opm examples`: the mechanism and motion files that come with the program.

use crate::args::{ExamplesArgs, Format, Output};
use crate::failure::Failure;
use crate::load::example_names;
use crate::output::print_with;
use crate::text::Table;
use opm_core::mechanism::examples::{EXAMPLES, find};
use opm_core::motion::examples::{self as motion, MOTIONS, MotionExample};
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
        let moving = |motion: &MotionExample| {
            json!({
                "name": motion.name,
                "mechanism": motion.mechanism,
                "description": motion.description,
            })
        };
        let motions: Vec<_> = MOTIONS.iter().map(moving).collect();
        let mut moves = Table::new(["motion", "of", "what it is"]);
        for motion in MOTIONS {
            moves.row([motion.name, motion.mechanism, motion.description]);
        }
        let text = format!("{table}\n{moves}");
        return output.print(&json!({ "examples": list, "motions": motions }), text);
    };
    let mechanism = find(name).map(|example| (example.name, example.description, example.text));
    let motion =
        motion::find(name).map(|example| (example.name, example.description, example.text));
    let (name, description, text) = mechanism.or(motion).ok_or_else(|| {
        let motions: Vec<_> = MOTIONS.iter().map(|motion| motion.name).collect();
        let names = format!("{}, {}", example_names(), motions.join(", "));
        Failure::Usage(format!("no example {name:?}; there are {names}").into())
    })?;
    match output.format {
        Format::Text => print_with(|out| out.write_all(text.as_bytes())),
        Format::Json => {
            let json = json!({ "name": name, "description": description, "text": text });
            output.print(&json, "")
        }
    }
}
