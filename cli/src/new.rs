//! `opm new`: mechanism files of common architectures, with dimensions of one's own.

mod sketch;

use crate::args::{Format, NewArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::{is_stdout, print_with};
use crate::parameters;
use crate::target::{Target, ends_in};
use crate::text::chain;
use crate::unitless;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::examples::{EXAMPLES, Example, TEMPLATES};
use opm_core::mechanism::file::hint::expected_one_of;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

pub fn run(args: &NewArgs, output: &Output) -> Result<(), Failure> {
    let Some(name) = &args.name else {
        return list(args, output);
    };
    let mut loaded = opened(name)?;
    unitless::note_changes(output, &args.change.set, &loaded);
    loaded.change(&args.change)?;
    // A loop has no inverse kinematics of a pose, but is a mechanism, too.
    if let Err(error) = Manipulator::new(loaded.file.mechanism.clone())
        && loaded.linkage_hint().is_empty()
    {
        output.warn(format_args!("{name}: with these dimensions, {}", chain(&error)));
    }
    let text = loaded.text.as_bytes();
    let Some(path) = args.output.as_deref().filter(|path| !is_stdout(path)) else {
        return match output.format {
            Format::Text => print_with(|out| out.write_all(text)),
            Format::Json => output.print(&described(&loaded, description(name)), ""),
        };
    };
    ends_in(path, &["toml"])?;
    if path.exists() && !args.force {
        let problem = format!("{} exists; --force writes over it", path.display());
        return Err(Failure::flag("--output", problem));
    }
    Target::create(path)?.commit(text)
}

/// Every architecture: families and joint lists. The same as a list of joints is none of its own.
fn architectures() -> impl Iterator<Item = &'static Example> {
    EXAMPLES.iter().filter(|example| !example.name.ends_with("-joints")).chain(TEMPLATES)
}

fn description(name: &str) -> &'static str {
    architectures().find(|known| known.name == name).map_or("", |known| known.description)
}

fn opened(name: &str) -> Result<Loaded, Failure> {
    let Some(found) = architectures().find(|known| known.name == name) else {
        let names: Vec<&str> = architectures().map(|known| known.name).collect();
        let problem = format!("no architecture {name:?}; {}", expected_one_of(name, &names));
        return Err(Failure::Usage(problem.into()));
    };
    load::attached(name, &format!("{name}.toml"), found.text)
}

/// An architecture with its dimensions, for programs.
fn described(loaded: &Loaded, description: &str) -> Value {
    json!({
        "name": loaded.label,
        "description": description,
        "parameters": parameters::json(&loaded.file),
        "text": loaded.text,
    })
}

/// Lists every architecture.
fn list(args: &NewArgs, output: &Output) -> Result<(), Failure> {
    if !args.change.set.is_empty() || args.output.is_some() {
        return Err(Failure::Usage("NAME is missing: `opm new` lists the architectures".into()));
    }
    let (mut text, mut all) = (String::new(), Vec::new());
    for known in architectures() {
        let loaded = opened(known.name)?;
        let _ = writeln!(text, "{}: {}\n", known.name, known.description);
        let drawing = sketch::lines(&loaded.file.mechanism);
        let dimensions = parameters::lines(&loaded.file);
        for row in 0..drawing.len().max(dimensions.len()) {
            let of = |lines: &[String]| lines.get(row).cloned().unwrap_or_default();
            let line =
                format!("  {:<width$}  {}", of(&drawing), of(&dimensions), width = sketch::WIDTH);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text.push('\n');
        all.push(described(&loaded, known.description));
    }
    text.push_str("opm new NAME --set DIMENSION=VALUE,... -o FILE.toml writes one\n");
    output.print(&json!({ "architectures": all }), text)
}
