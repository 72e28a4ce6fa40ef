//! Results on standard output, and notes on standard error.

use crate::args::{Format, Output};
use crate::failure::{Failure, Kind, talk};
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

impl Output {
    /// The same without progress, notes and warnings: those of every run would hide a table of runs.
    pub fn silent(&self) -> Self {
        Self { quiet: true, ..*self }
    }

    /// Prints a result in the selected format.
    pub fn print(&self, json: &impl Serialize, text: impl Display) -> Result<(), Failure> {
        let write = |out: &mut dyn Write| match self.format {
            Format::Json => {
                serde_json::to_writer(&mut *out, json)?;
                writeln!(out)
            }
            Format::Text => write!(out, "{text}"),
        };
        match self.silent {
            true => write(&mut io::sink()).map_err(Failure::stdout),
            false => print_with(|out| write(out)),
        }
    }

    /// Prints a note on standard error, unless --quiet is given.
    pub fn note(&self, message: impl Display) {
        if !self.quiet {
            talk(Kind::Note, &message.to_string());
        }
    }

    /// As [`Output::note`], for a warning that the result may be useless.
    pub fn warn(&self, message: impl Display) {
        if !self.quiet {
            talk(Kind::Warning, &message.to_string());
        }
    }
}

/// Whether a name stands for standard output.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-") || path == Path::new("/dev/stdout")
}

/// Writes to standard output to the last byte.
pub fn print_with(
    write: impl FnOnce(&mut io::BufWriter<io::StdoutLock<'static>>) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    write(&mut out).and_then(|()| out.flush()).map_err(Failure::stdout)
}

/// Named numbers as a JSON object, in their order.
pub fn named<'a>(numbers: impl IntoIterator<Item = (&'a str, f64)>) -> Map<String, Value> {
    numbers.into_iter().map(|(name, value)| (name.to_owned(), value.into())).collect()
}
