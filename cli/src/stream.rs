//! Commands that read CSV of plain numbers, and write CSV row by row: bounded memory.

use crate::args::{Format, Output};
use crate::failure::Failure;
use crate::load::{self, DASH, Loaded};
use crate::output::{Shown, is_stdout, stdout};
use crate::progress::{interruptible, watch};
use crate::target::ends_in;
use crate::text::plural;
use opm_analysis::Index;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::{FileUnits, Heading};
use opm_core::table::{
    ColumnNames, FieldPlace, Line, Lines, Plausible, Suggestion, hint, hint_of_row, not_commas, tum,
};
use opm_core::text::quoted;
use opm_mcap::PartialFile;
use opm_mcap::csv::Rows;
use opm_mcap::input::Expected;
use opm_study::effort_names;
use opm_workspace::Progress;
use std::fmt::Display;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Why a stream ends early.
pub enum StreamStop {
    Write(io::Error),
    Failure(Failure),
}

impl From<Failure> for StreamStop {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl From<io::Error> for StreamStop {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// The names of what is read and written, as they were given; `-` is a standard stream.
pub struct Streams<'a> {
    pub input: &'a Path,
    pub output: Option<&'a Path>,
    /// The columns that --columns names.
    pub columns: Option<&'a ColumnNames>,
}

/// Input and output of a command while it runs.
pub struct Stream<'a> {
    /// The name of the input in messages.
    pub label: &'a str,
    pub lines: Lines<'static>,
    /// The number of lines before the first one of the file.
    before: u64,
    pub rows: Rows<'a>,
    names: Option<&'a ColumnNames>,
    output: &'a Output,
    /// The number of rows that were read.
    pub number: &'a AtomicU64,
    progress: &'a Progress,
}

impl Stream<'_> {
    /// Calls `take` with every line of numbers: the time if it has one, and the values, which are as given where there is no
    /// column.
    pub fn each(
        &mut self,
        columns: &mut Columns<'_>,
        values: &[f64],
        mut take: impl FnMut(&mut Self, u64, Option<f64>, &[f64]) -> Result<(), StreamStop>,
    ) -> Result<(), StreamStop> {
        let places = columns.places();
        // The time has the last place.
        let mut row = [values, &[f64::NAN]].concat();
        loop {
            let label = self.label;
            let line = self.lines.next().map_err(|error| Failure::at(label, error))?;
            let Some(line) = line else { break };
            if self.progress.is_cancelled() {
                return Err(Failure::interrupted("interrupted").into());
            }
            let number = line.number - self.before;
            let usual =
                columns.read(line, &places, &mut row, |problem| at(label, number, problem))?;
            let [values @ .., time] = &*row else { unreachable!("the row has a place for a time") };
            if !usual {
                columns.note(values, |problem| {
                    self.output.note(format_args!("{label}:{number}: {problem}"));
                });
            }
            take(self, number, (!time.is_nan()).then_some(*time), values)?;
            self.number.fetch_add(1, Ordering::Relaxed);
        }
        self.rows.flush().map_err(StreamStop::Write)
    }

    /// Prints a note about the input.
    pub fn note(&self, message: impl Display) {
        self.output.note(format_args!("{}: {message}", self.label));
    }

    /// What is in every column, by the header. `find` gives the number of a named value, or `None` for a column that is
    /// not read.
    pub fn columns<'n>(
        &mut self,
        values: Vec<Wanted<'n>>,
        mut find: impl FnMut(&str) -> Result<Option<usize>, String>,
    ) -> Result<Columns<'n>, Failure> {
        let label = self.label;
        let header = self.lines.next().map_err(|error| Failure::at(label, error))?;
        let names = || values.iter().filter(|value| value.offered).map(|value| value.name);
        let no_header = |number| {
            let names = names().collect::<Vec<_>>().join(",");
            at(label, number, format!("no header, expected one of names: {names}"))
        };
        let Some(header) = header else { return Err(no_header(1)) };
        let number = (header.number - self.before).max(1);
        if let Some(problem) = not_commas(header) {
            return Err(at(label, number, problem));
        }
        let given: Vec<_> = header.fields().map(String::from_utf8_lossy).collect();
        let given: Vec<&str> = given.iter().map(|text| &**text).collect();
        if given.iter().all(|name| name.parse::<f64>().is_ok()) {
            return Err(no_header(number));
        }
        if let Some((name, heading)) = self.names.and_then(|n| n.missing(&given)) {
            let headings =
                given.iter().map(|text| quoted(text).to_string()).collect::<Vec<_>>().join(", ");
            let problem = format!("no column {heading:?} for {name}, the table has {headings}");
            return Err(at(label, number, format!("{problem} (--columns)")));
        }
        let mut columns = Vec::new();
        for text in &given {
            let wrong = |error: &dyn Display| {
                at(label, number, format!("column {}: {error}", quoted(text)))
            };
            let mut heading = Heading::parse(text);
            if let Some(names) = self.names {
                let Some(name) = names.name_of(heading, text).map_err(|e| wrong(&e))? else {
                    columns.push((Column::Other, None));
                    continue;
                };
                heading.name = name;
            }
            let column = match (heading.name, heading.unit) {
                ("t", None | Some("s")) => Column::Time,
                ("t", Some(_)) => return Err(wrong(&"expected t or t [s]")),
                (name, _) => match find(name) {
                    Ok(Some(number)) => Column::Value(number),
                    Ok(None) => Column::Other,
                    Err(error) => {
                        // What the others may be called; the time is not needed.
                        let known = names().collect::<Vec<_>>();
                        let mut meant = Suggestion::new(std::iter::once("t").chain(known), &given);
                        meant.0.retain(|(_, heading)| {
                            given.iter().any(|g| Heading::parse(g).name == heading)
                        });
                        let advice =
                            if meant.0.is_empty() { String::new() } else { columns_flag(&meant) };
                        return Err(wrong(&format!("{error}{advice}")));
                    }
                },
            };
            let units = match column {
                Column::Value(number) => heading.units(values[number].quantity),
                Column::Time | Column::Other => Ok(None),
            };
            let units = units.map_err(|error| wrong(&error))?;
            if column != Column::Other && columns.iter().any(|(known, _)| *known == column) {
                return Err(wrong(&"given twice"));
            }
            columns.push((column, units));
        }
        let noted = vec![false; values.len()];
        let with_unit = |&(column, units): &(Column, Option<FileUnits>)| match column {
            Column::Value(number) => Some((number, units?)),
            Column::Time | Column::Other => None,
        };
        let converted = columns.iter().filter_map(with_unit).collect();
        Ok(Columns { number, columns, converted, values, noted })
    }
}

/// Runs a command from one CSV to another; the summary, and the note about it, are of the command. A file gets its name
/// when it is whole. The result is `None` where the rows went to standard output.
pub fn run<T>(
    streams: &Streams<'_>,
    output: &Output,
    loaded: &Loaded,
    solve: impl FnOnce(Stream<'_>) -> Result<T, StreamStop>,
) -> Result<Option<T>, Failure> {
    let input = streams.input;
    let target = streams.output.filter(|path| !is_stdout(path));
    if output.format == Format::Json && target.is_none() {
        let problem = "the CSV takes standard output; give it a file with --output";
        return Err(Failure::flag("--format json", problem));
    }
    if input == Path::new(DASH) && loaded.is_standard_input() {
        let problem = "standard input is the mechanism already, expected a file";
        return Err(Failure::flag("--poses", problem));
    }
    let (label, reader) = load::table(input, Expected::ROWS)?;
    let progress = interruptible()?;
    let (reader, before) = tum::as_csv(reader).map_err(|error| Failure::at(&label, error))?;
    let rows = AtomicU64::new(0);
    let (label, names) = (&*label, streams.columns);
    let source =
        Source { label, reader, before, names, output, number: &rows, progress: &progress };
    let Some(path) = target else {
        // There is no progress bar, since the rows may go to the terminal.
        return match solve(source.to(&mut stdout())) {
            Ok(_) => Ok(None),
            Err(StreamStop::Write(error)) => Err(Failure::stdout(error)),
            Err(StreamStop::Failure(failure)) => Err(failure),
        };
    };
    loaded.refuse_as_output(path, &[input])?;
    ends_in(path, &["csv"])?;
    let place = path.shown();
    let mut file = PartialFile::create(path).map_err(|error| Failure::at(&place, error))?;
    let work = || solve(source.to(&mut file));
    let summary =
        match watch(output, "solving", None, || rows.load(Ordering::Relaxed), work) {
            Ok(summary) => summary,
            Err(StreamStop::Failure(Failure::Interrupted(message))) => {
                return Err(Failure::Interrupted(message.reworded(|message| {
                    format!("{message}; what was solved is in {place}.partial")
                })));
            }
            Err(stop) => {
                // The file is discarded: the rows before a wrong one would look like the whole answer.
                file.discard();
                return Err(match stop {
                    StreamStop::Write(error) => Failure::at(&place, error),
                    StreamStop::Failure(failure) => failure,
                });
            }
        };
    file.commit().map_err(|error| Failure::at(&place, error))?;
    Ok(Some(summary))
}

/// The column of the working mode in tables that are written.
pub const MODE: &str = "mode";

/// The column of how far away the pose is that was asked for.
pub const DISTANCE: &str = "distance";
/// The column of the legs that do not reach.
pub const UNREACHABLE: &str = "unreachable";
/// The column of the joints beyond limits.
pub const BEYOND: &str = "beyond_limits";

/// What a stream reads, without where it writes.
struct Source<'a> {
    label: &'a str,
    reader: Box<dyn Read>,
    before: u64,
    names: Option<&'a ColumnNames>,
    output: &'a Output,
    number: &'a AtomicU64,
    progress: &'a Progress,
}

impl<'a> Source<'a> {
    fn to(self, sink: &'a mut (dyn Write + Send)) -> Stream<'a> {
        let Self { label, reader, before, names, output, number, progress } = self;
        let (lines, rows) = (Lines::new(reader), Rows::new(sink));
        Stream { label, lines, before, rows, names, output, number, progress }
    }
}

/// What is in a column of the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    /// A time, which is carried through.
    Time,
    /// The value of this number.
    Value(usize),
    /// Nothing that is read.
    Other,
}

/// A value that a column may have.
pub struct Wanted<'a> {
    /// The heading of its column, without a unit.
    pub name: &'a str,
    pub quantity: Quantity,
    /// What says whether a value looks misread.
    pub plausible: Plausible,
    /// Whether a row may have an empty cell there, which is read as not a number.
    pub optional: bool,
    /// Whether messages offer its name.
    pub offered: bool,
}

/// The columns of the input.
pub struct Columns<'a> {
    /// The line of the header.
    pub number: u64,
    /// What is in every column, and in which units if its heading names one.
    columns: Vec<(Column, Option<FileUnits>)>,
    /// The numbers of the values whose heading names units, and these.
    converted: Vec<(usize, FileUnits)>,
    values: Vec<Wanted<'a>>,
    /// The values that have been noted to look misread: each is noted once.
    noted: Vec<bool>,
}

impl Columns<'_> {
    /// Whether there are times.
    pub fn timed(&self) -> bool {
        self.columns.iter().any(|(column, _)| *column == Column::Time)
    }

    /// The names of the values that have no column.
    pub fn missing(&self) -> Vec<&str> {
        let values = self.values.iter().enumerate();
        values.filter(|&(i, _)| !self.has_value(i)).map(|(_, v)| v.name).collect()
    }

    /// Whether a value of this name has a column.
    pub fn has(&self, name: &str) -> bool {
        self.values.iter().enumerate().any(|(i, value)| value.name == name && self.has_value(i))
    }

    fn has_value(&self, number: usize) -> bool {
        self.columns.iter().any(|(column, _)| *column == Column::Value(number))
    }

    /// Notes values of columns without a unit that look as if they were meant in another one.
    fn note(&mut self, values: &[f64], say: impl Fn(String)) {
        for &(column, units) in &self.columns {
            let (Column::Value(number), None) = (column, units) else { continue };
            let Wanted { name, plausible, .. } = &self.values[number];
            if self.noted[number] || values[number].is_nan() || plausible.holds(values[number]) {
                continue;
            }
            self.noted[number] = true;
            say(plausible.column(name, values[number]));
        }
    }

    /// The place of every column's number in a row: that of its value, or behind the values for the time.
    fn places(&self) -> Vec<Option<FieldPlace>> {
        const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        let place = |&(column, units): &(Column, Option<FileUnits>)| match column {
            Column::Time => {
                Some(FieldPlace { number: self.values.len(), optional: false, usual: ANY })
            }
            Column::Value(number) => {
                let Wanted { plausible, optional, .. } = self.values[number];
                let usual = if units.is_none() { plausible.usual() } else { ANY };
                Some(FieldPlace { number, optional, usual })
            }
            Column::Other => None,
        };
        self.columns.iter().map(place).collect()
    }

    /// Reads a row. Returns whether the values of columns without a unit are usual.
    fn read(
        &self,
        line: Line<'_>,
        places: &[Option<FieldPlace>],
        row: &mut [f64],
        at: impl Fn(String) -> Failure,
    ) -> Result<bool, Failure> {
        let name = |column: Column| match column {
            Column::Time => "t",
            Column::Value(number) => self.values[number].name,
            Column::Other => "...",
        };
        let given = line.fields().len();
        if given != self.columns.len() {
            let names: Vec<_> = self.columns.iter().map(|&(column, _)| name(column)).collect();
            let given = plural(given as u64, "column");
            let (expected, names) = (self.columns.len(), names.join(","));
            let hint = hint_of_row(line, expected);
            return Err(at(format!("{given}, expected {expected}: {names}{hint}")));
        }
        let usual = line.numbers(places, row).map_err(|(number, problem)| {
            let field = line.fields().nth(number).map(String::from_utf8_lossy).unwrap_or_default();
            let (name, hint) = (name(self.columns[number].0), hint(&field));
            at(format!("column {name}: {} {problem}{hint}", quoted(&field)))
        })?;
        for &(number, units) in &self.converted {
            row[number] = units.si(row[number], self.values[number].quantity);
        }
        Ok(usual)
    }
}

/// The names of columns that tables of this program have beside the values that a command reads: joints with their
/// rates, and what is known of a pose.
pub fn other_columns(manipulator: &Manipulator) -> Vec<String> {
    let joints = manipulator.coordinates().iter().map(|c| &*c.name);
    let imaginary = manipulator.imaginary().iter().map(|joint| &*joint.name);
    let tasks = manipulator.task_coordinates().iter().chain(manipulator.dependent_coordinates());
    let names: Vec<&str> = joints.chain(imaginary).collect();
    let rates = names.iter().copied().chain(tasks.map(|c| c.name));
    let rates = rates.flat_map(|name| [format!("d.{name}"), format!("dd.{name}")]);
    let known = [
        "reachable",
        "within_limits",
        MODE,
        DISTANCE,
        UNREACHABLE,
        BEYOND,
        "valid",
        "inverse_condition",
    ];
    let known = known.into_iter().chain(Index::ALL.map(Index::name)).map(str::to_owned);
    let efforts = effort_names(manipulator);
    names.iter().map(|&name| name.to_owned()).chain(rates).chain(known).chain(efforts).collect()
}

/// How --columns names columns, as the end of a message.
pub fn columns_flag(suggestion: &Suggestion) -> String {
    let names = suggestion.to_string();
    let plain = |c: char| c.is_alphanumeric() || "=,._-".contains(c);
    let quote = if names.chars().all(plain) { "" } else { "'" };
    format!("; --columns {quote}{names}{quote} says which columns to read")
}

/// The failure for a problem in a line of the input.
pub fn at(label: &str, line: u64, problem: impl Display) -> Failure {
    Failure::work(format!("{label}:{line}: {problem}"))
}
