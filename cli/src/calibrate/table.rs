//! Tables of measurements.

use crate::args::Output;
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::stream::{at, other_columns};
use crate::unitless::plausible;
use opm_calibrate::{BasePoint, Column, Measurements};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::{FileUnits, Heading};
use opm_core::table::{self, Lines, Plausible, hint, hint_of_row, not_commas};
use opm_core::text::quoted;
use opm_mcap::input::{Expected, bounded};
use std::path::Path;

/// A table, and where its rows stand in the file.
pub struct Table {
    pub label: String,
    pub measurements: Measurements,
    /// The number of the line of each row.
    pub lines: Vec<u64>,
}

/// Reads a CSV file of measurements.
pub fn read(
    path: &Path,
    (loaded, manipulator): (&Loaded, &Manipulator),
    points: &[BasePoint],
    output: &Output,
) -> Result<Table, Failure> {
    let (label, source) = load::table(path, Expected::MEASUREMENTS)?;
    let failed = |error| Failure::at(&label, error);
    let mut input = Lines::new(Box::new(bounded(source, Expected::MEASUREMENTS)));
    // What other commands write beside poses and joints is not measured.
    let others = other_columns(manipulator);
    let mut columns = Vec::new();
    let mut places: Vec<Option<(usize, FileUnits)>> = Vec::new();
    // What looks right in columns without a unit; each is noted once.
    let mut usual: Vec<Option<Plausible>> = Vec::new();
    let Some(header) = input.next().map_err(failed)? else {
        return Err(Failure::work(format!(
            "{label}: empty, expected a header with names of columns"
        )));
    };
    let number = header.number;
    if let Some(problem) = not_commas(header) {
        return Err(at(&label, number, problem));
    }
    for text in header.fields() {
        let text = String::from_utf8_lossy(text);
        let heading = Heading::parse(&text);
        let wrong = |problem: String| at(&label, number, format!("column {text:?}: {problem}"));
        let found = Column::named(heading.name, manipulator, points);
        let column = match found {
            Ok(column) => column,
            Err(_) if heading.name == "t" || others.iter().any(|name| name == heading.name) => {
                places.push(None);
                continue;
            }
            Err(problem) => return Err(wrong(problem)),
        };
        if columns.iter().any(|known: &Column| known.name == column.name) {
            return Err(wrong("given twice".into()));
        }
        let units = heading.units(column.quantity).map_err(wrong)?;
        let right = plausible(column.quantity, column.home(manipulator), (loaded, manipulator));
        usual.push(units.is_none().then_some(right));
        places.push(Some((columns.len(), units.unwrap_or(FileUnits::SI))));
        columns.push(column);
    }
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    while let Some(line) = input.next().map_err(failed)? {
        let fields: Vec<&[u8]> = line.fields().collect();
        if fields.len() > places.len() {
            let hint = hint_of_row(line, places.len());
            let problem =
                format!("{} cells, expected at most {}{hint}", fields.len(), places.len());
            return Err(at(&label, line.number, problem));
        }
        let mut row = vec![None; columns.len()];
        for (field, place) in fields.iter().zip(&places) {
            let Some((column, units)) = place else { continue };
            if field.is_empty() {
                continue;
            }
            let Ok(value) = table::number(field) else {
                let (name, text) = (&columns[*column].name, String::from_utf8_lossy(field));
                let (text, hint) = (quoted(&text), hint(&text));
                let problem = format!("{name} is {text}, expected a number or nothing{hint}");
                return Err(at(&label, line.number, problem));
            };
            if let Some(doubted) = usual[*column].take_if(|right| !right.holds(value)) {
                let doubt = doubted.column(&columns[*column].name, value);
                output.note(format_args!("{label}:{}: {doubt}", line.number));
            }
            row[*column] = Some(units.si(value, columns[*column].quantity));
        }
        rows.push(row);
        numbers.push(line.number);
    }
    if rows.is_empty() {
        return Err(Failure::work(format!("{label}: no rows, expected measurements")));
    }
    Ok(Table { label, measurements: Measurements { columns, rows }, lines: numbers })
}
