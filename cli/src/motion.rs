//! Motions, by path or by the name of a shipped example.

use crate::args::{MotionTableArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::Shown;
use crate::stream::columns_flag;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::motion::table::{Advice, TableOptions};
use opm_core::motion::{Ends, PlatformMotion, examples, file, table};
use opm_mcap::input::Expected;
use opm_study::recording::Attachment;
use std::path::{Path, PathBuf};

/// A motion that was read.
pub struct LoadedMotion {
    /// Its name in messages: the path or the name as given.
    pub label: String,
    /// The file's own name, to attach it under.
    pub file_name: String,
    /// Its path; `None` for a shipped example.
    pub path: Option<PathBuf>,
    /// Its text.
    pub text: String,
    /// The motion.
    pub motion: PlatformMotion,
    /// What its numbers may have been meant to be.
    doubts: Vec<String>,
}

impl LoadedMotion {
    /// The file, as an attachment of a recording.
    pub fn attachment(&self) -> Attachment<'_> {
        Attachment { name: &self.file_name, text: &self.text }
    }

    /// Notes numbers that look misread.
    pub fn note_doubts(&self, output: &Output) {
        for doubt in &self.doubts {
            output.note(doubt);
        }
    }
}

/// How a table of poses is read.
pub struct Reading<'a> {
    /// How the motion starts and ends.
    pub ends: Option<Ends>,
    /// Its columns and times.
    pub table: &'a MotionTableArgs,
}

/// Reads a motion: a table of poses if the name says so ([`table::is_table`]), a motion file otherwise, which says itself how it
/// starts and ends. An existing path has priority over an example of the same name.
pub fn open(
    given: &Path,
    Reading { ends, table: of }: &Reading<'_>,
    (loaded, manipulator): (&Loaded, &Manipulator),
) -> Result<LoadedMotion, Failure> {
    let label = given.shown();
    let table = table::is_table(given);
    let expected = if table { Expected::POSES } else { Expected::MOTION };
    let source = match load::text(given, expected)? {
        Some(text) => {
            let name = given.file_name().map_or_else(|| label.clone(), |n| n.display().to_string());
            (text, name, Some(given.to_owned()))
        }
        None => {
            let example = examples::find(&label).ok_or_else(|| unknown(given, &label))?;
            (example.text.to_owned(), format!("{}.toml", example.name), None)
        }
    };
    let (text, file_name, path) = source;
    let stem = given.file_stem().map_or_else(|| label.clone(), |stem| Path::new(stem).shown());
    let options = TableOptions {
        ends: ends.unwrap_or_default(),
        columns: of.columns.as_ref(),
        relative_time: of.relative_time,
        units: loaded.file.units,
        advice: Advice { columns: columns_flag, relative_time: "--relative-time" },
    };
    let mut doubts = Vec::new();
    let motion = match (ends, of.given()) {
        _ if table => table::read(&text, &stem, manipulator, &options).map(|read| {
            let doubt = |(line, doubt)| format!("{label}:{line}: {doubt}");
            doubts = read.doubts.into_iter().map(doubt).collect();
            read.motion
        }),
        (None, Some(flag)) => {
            return Err(Failure::flag(
                flag,
                "a motion file has its own names and times, expected a CSV file",
            ));
        }
        (Some(ends), _) => {
            let problem = format!(
                "a motion file says it itself: write `ends = \"{}\"` beside its points",
                ends.name()
            );
            return Err(Failure::flag("--ends", problem));
        }
        (None, None) => file::read(&text, manipulator),
    };
    let motion = motion.map_err(|errors| Failure::because(errors.in_file(&label), errors))?;
    Ok(LoadedMotion { label, file_name, path, text, motion, doubts })
}

fn unknown(given: &Path, label: &str) -> Failure {
    let names: Vec<_> = examples::MOTIONS.iter().map(|example| example.name).collect();
    // A bare word is more likely a name than a path.
    if given.extension().is_none() && given.components().count() == 1 {
        let expected = expected_one_of(label, &names);
        return Failure::work(format!("{label}: no such file, and no such motion; {expected}"));
    }
    Failure::work(format!("{label}: no such file"))
}
