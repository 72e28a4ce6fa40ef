//! Evaluations in a table, of which an interrupted run goes on.
//!
//! An optimiser with a seed asks for the same designs again. Those that the table has are not evaluated again, so that a
//! run that goes on ends as one that was never interrupted.

use std::collections::{HashMap, HashSet};
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

/// A table of evaluated designs.
#[derive(Debug, Default)]
pub struct Log {
    known: HashMap<Key, Option<Vec<f64>>>,
    /// Those of an interrupted run that have not been asked for yet.
    unused: HashSet<Key>,
    /// How many of that run have been.
    used: u64,
    file: Option<csv::Writer<File>>,
    columns: usize,
    problem: String,
}

/// A stage of the design, and the numbers of the variables, bit by bit.
type Key = (String, Vec<u64>);

/// Why a table cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// It cannot be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is not a table of evaluations of this problem.
    #[error("the evaluations in it are of another problem")]
    OtherProblem,
    /// A row is not one of evaluations.
    #[error("line {line}: {problem}")]
    Row {
        /// The line, counted from 1 on.
        line: u64,
        /// What is wrong.
        problem: String,
    },
}

/// The columns before those of the variables.
const BEFORE: [&str; 3] = ["problem", "stage", "assembled"];

/// What a table holds: the name of the problem in it, its variables, and the numbers of all stages.
#[derive(Clone, Debug)]
pub struct Columns {
    /// A fingerprint of the problem.
    pub problem: String,
    /// The names of the variables, SI.
    pub variables: Vec<String>,
    /// The names of the numbers of all stages.
    pub numbers: Vec<String>,
}

impl Columns {
    fn header(&self) -> Vec<&str> {
        let before = BEFORE.iter().copied();
        before.chain(self.variables.iter().chain(&self.numbers).map(String::as_str)).collect()
    }
}

impl Log {
    /// A table that is kept in memory alone.
    pub fn none() -> Self {
        Self::default()
    }

    /// Begins a table in a file, which is overwritten.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(path: &Path, columns: &Columns) -> Result<Self, LogError> {
        let mut file = csv::Writer::from_writer(File::create(path)?);
        file.write_record(columns.header()).map_err(io)?;
        file.flush()?;
        let known = HashMap::new();
        Ok(Self::with(columns, known, file))
    }

    /// Reads `text`, the table of an interrupted run in a file, and goes on with it. A last row that is cut short is left
    /// out.
    ///
    /// # Errors
    /// It cannot be read or written, or is of another problem.
    pub fn resume(path: &Path, text: &str, columns: &Columns) -> Result<Self, LogError> {
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let mut reader =
            csv::ReaderBuilder::new().flexible(true).from_reader(&text.as_bytes()[..whole]);
        let header = reader.headers().map_err(io)?;
        if !header.iter().eq(columns.header()) {
            return Err(LogError::OtherProblem);
        }
        let mut known = HashMap::new();
        for row in reader.records() {
            let row = row.map_err(io)?;
            let line = row.position().map_or(0, csv::Position::line);
            let wrong = |problem: String| LogError::Row { line, problem };
            if row.len() != columns.header().len() {
                let problem = format!("{} cells, expected {}", row.len(), columns.header().len());
                return Err(wrong(problem));
            }
            if row[0] != columns.problem {
                return Err(LogError::OtherProblem);
            }
            let numbers = |cells: std::ops::Range<usize>| -> Result<Vec<f64>, LogError> {
                let filled = cells.filter(|&cell| !row[cell].is_empty());
                let number = |cell: usize| {
                    let value = row[cell].parse();
                    value.map_err(|_| wrong(format!("{:?}, expected a number", &row[cell])))
                };
                filled.map(number).collect()
            };
            let split = BEFORE.len() + columns.variables.len();
            let variables = numbers(BEFORE.len()..split)?;
            let values = numbers(split..row.len())?;
            known.insert(key(&row[1], &variables), (&row[2] == "true").then_some(values));
        }
        // What was cut short is written again.
        let file = OpenOptions::new().write(true).open(path)?;
        file.set_len(whole as u64)?;
        drop(file);
        let file = OpenOptions::new().append(true).open(path)?;
        let file = csv::WriterBuilder::new().has_headers(false).from_writer(file);
        Ok(Self::with(columns, known, file))
    }

    fn with(
        columns: &Columns,
        known: HashMap<Key, Option<Vec<f64>>>,
        file: csv::Writer<File>,
    ) -> Self {
        let problem = columns.problem.clone();
        let unused = known.keys().cloned().collect();
        Self { known, unused, used: 0, file: Some(file), columns: columns.header().len(), problem }
    }

    /// How many designs of an interrupted run were not evaluated again. The table may have more, of another seed.
    pub fn used(&self) -> u64 {
        self.used
    }

    /// The numbers of a design that was evaluated; `Some(None)` for one that does not assemble.
    pub(crate) fn known(&mut self, stage: &str, variables: &[f64]) -> Option<Option<Vec<f64>>> {
        let key = key(stage, variables);
        self.used += u64::from(self.unused.remove(&key));
        self.known.get(&key).cloned()
    }

    /// Adds a design. `cells` are all cells of its variables and numbers; those of another stage are empty.
    pub(crate) fn add(
        &mut self,
        stage: &str,
        variables: &[f64],
        cells: &[Option<f64>],
        numbers: Option<Vec<f64>>,
    ) -> Result<(), LogError> {
        if let Some(file) = &mut self.file {
            let assembled = numbers.is_some().to_string();
            let before = [self.problem.clone(), stage.to_owned(), assembled];
            let cells = cells.iter().map(|cell| cell.map_or_else(String::new, |x| x.to_string()));
            let row: Vec<String> = before.into_iter().chain(cells).collect();
            debug_assert_eq!(row.len(), self.columns, "a cell for each column");
            file.write_record(row).map_err(io)?;
        }
        self.known.insert(key(stage, variables), numbers);
        Ok(())
    }

    /// Writes what was added to the file.
    pub(crate) fn flush(&mut self) -> Result<(), LogError> {
        if let Some(file) = &mut self.file {
            file.flush()?;
        }
        Ok(())
    }
}

fn key(stage: &str, variables: &[f64]) -> Key {
    (stage.to_owned(), variables.iter().map(|x| x.to_bits()).collect())
}

fn io(error: csv::Error) -> LogError {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => LogError::Io(error),
        csv::ErrorKind::Utf8 { .. } => LogError::OtherProblem,
        other => LogError::Io(io::Error::other(format!("{other:?}"))),
    }
}

/// A fingerprint of some text (FNV-1a, 64 bits).
pub fn fingerprint(text: &str) -> String {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", text.bytes().fold(0xcbf2_9ce4_8422_2325, step))
}
