//! Tables of several runs: one for each value of `--vary`, or for each working mode.

use crate::args::Output;
use crate::change::Varied;
use crate::failure::Failure;
use crate::load::Loaded;
use crate::text::{self, Table, count, short};
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use serde_json::{Map, Value, json};

/// What stands in place of a number that there is not.
const NONE: &str = "-";

/// One result of a run.
#[derive(Clone)]
pub struct Cell {
    /// Its name in JSON, and the header of its column.
    pub name: String,
    /// The header, where that says more.
    pub header: String,
    pub json: Value,
    pub text: String,
}

impl Cell {
    pub fn new(name: &str, json: impl Into<Value>, text: impl Into<String>) -> Self {
        let header = name.replace('_', " ");
        Self { name: name.to_owned(), header, json: json.into(), text: text.into() }
    }

    /// A number without a unit; not finite where there is none.
    pub fn number(name: &str, value: f64) -> Self {
        let shown = if value.is_finite() { short(value) } else { NONE.to_owned() };
        Self::new(name, value, shown)
    }

    /// A whole number.
    pub fn count(name: &str, number: u64) -> Self {
        Self::new(name, number, count(number))
    }

    /// A length or an angle in SI, shown in the file's unit; not finite where there is none.
    pub fn measured(name: &str, value: f64, quantity: Quantity, units: FileUnits) -> Self {
        let shown = match value.is_finite() {
            true => text::number(value, quantity, units),
            false => NONE.to_owned(),
        };
        Self { header: text::header(name, quantity, units), ..Self::new(name, value, shown) }
    }

    /// The answer to a question.
    pub fn answer(name: &str, yes: bool) -> Self {
        Self::new(name, yes, if yes { "yes" } else { "no" })
    }
}

/// One run.
struct Run {
    json: Value,
    text: String,
    /// The results, or why there are none.
    found: Result<Vec<Cell>, String>,
}

/// The runs of a command.
pub struct Runs {
    /// What distinguishes them, in JSON.
    key: String,
    /// The header of its column.
    header: String,
    runs: Vec<Run>,
}

impl Runs {
    pub fn new(key: &str, header: &str) -> Self {
        Self { key: key.to_owned(), header: header.to_owned(), runs: Vec::new() }
    }

    /// Adds a run. A run whose work fails is a row that says why; wrong usage and interruptions end all.
    pub fn add(
        &mut self,
        json: impl Into<Value>,
        text: impl Into<String>,
        found: Result<Vec<Cell>, Failure>,
    ) -> Result<(), Failure> {
        let found = match found {
            Ok(cells) => Ok(cells),
            Err(Failure::Work(problem)) => Err(problem.to_string()),
            Err(other) => return Err(other),
        };
        self.runs.push(Run { json: json.into(), text: text.into(), found });
        Ok(())
    }

    /// Prints the table, under a title. Where no run has succeeded, the work failed.
    pub fn print(&self, output: &Output, title: &str, more: Value) -> Result<(), Failure> {
        let rows: Vec<Value> = (self.runs.iter())
            .map(|run| {
                let mut row = Map::new();
                row.insert(self.key.clone(), run.json.clone());
                match &run.found {
                    Ok(cells) => {
                        row.extend(cells.iter().map(|c| (c.name.clone(), c.json.clone())));
                    }
                    Err(problem) => {
                        row.insert("problem".to_owned(), problem.clone().into());
                    }
                }
                Value::Object(row)
            })
            .collect();
        let mut json = more;
        json["runs"] = rows.into();
        let first = self.runs.iter().find_map(|run| run.found.as_ref().ok());
        let headers = first.into_iter().flatten().map(|cell| format!(">{}", cell.header));
        let mut table = Table::new([self.header.clone()].into_iter().chain(headers));
        let mut problems = String::new();
        for run in &self.runs {
            let cells = run.found.iter().flatten().map(|cell| cell.text.clone());
            match &run.found {
                Ok(_) => table.row([run.text.clone()].into_iter().chain(cells)),
                Err(problem) => {
                    table.row([run.text.clone(), NONE.to_owned()]);
                    problems += &format!("{}: {problem}\n", run.text.trim());
                }
            }
        }
        let problems = if problems.is_empty() { problems } else { format!("\n{problems}") };
        output.print(&json, format_args!("{title}\n\n{table}{problems}"))?;
        match (&*self.runs, first) {
            ([one], None) => {
                Err(Failure::work(format!("the only run failed: {} {}", self.key, one.text.trim())))
            }
            (runs @ [_, ..], None) => Err(Failure::work(format!("all {} runs failed", runs.len()))),
            _ => Ok(()),
        }
    }
}

/// Runs a command for each value of a number of the mechanism file, and prints a table.
pub fn vary(
    loaded: &Loaded,
    varied: &Varied<'_>,
    output: &Output,
    mut run: impl FnMut(&Loaded) -> Result<Vec<Cell>, Failure>,
) -> Result<(), Failure> {
    let units = loaded.file.units;
    let header = match varied.quantity {
        Some(quantity) => text::header(varied.name, quantity, units),
        None => varied.name.to_owned(),
    };
    let mut runs = Runs::new("value", &header);
    for &value in &varied.values {
        // A mechanism that does not assemble is a result.
        let found = loaded.with(varied.name, value).and_then(|changed| run(&changed));
        let shown = match varied.quantity {
            Some(quantity) => text::number(value, quantity, units),
            None => value.to_string(),
        };
        runs.add(value, shown, found)?;
    }
    let unit = varied.quantity.map_or("", |quantity| FileUnits::SI.symbol(quantity));
    let more = json!({ "vary": varied.name, "units": unit });
    runs.print(output, &loaded.file.mechanism.name, more)
}
