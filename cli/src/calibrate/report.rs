//! The report of a calibration.

use super::table::Table as Measured;
use crate::load::Loaded;
use crate::text::{Table, plural, short};
use opm_calibrate::{Calibration, Cell, Combination};
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use serde_json::{Map, Value, json};
use std::fmt::Write;

pub struct Report<'a> {
    pub loaded: &'a Loaded,
    pub table: &'a Measured,
    pub found: &'a Calibration,
    /// Whether standard deviations were given.
    pub known: bool,
}

/// Pairs of parameters that are correlated more than this are named.
const CORRELATED: f64 = 0.95;
/// The largest number of lines of a list in the text; JSON has all.
const LISTED: usize = 12;

/// What a unit of a quantity is called in SI.
fn si(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Angle => "rad",
        Quantity::Length => "m",
    }
}

impl Report<'_> {
    pub fn json(&self) -> Value {
        let found = self.found;
        let parameters = found.parameters.iter().map(|parameter| {
            json!({
                "name": parameter.name,
                "unit": si(parameter.quantity),
                "before": parameter.before,
                "after": parameter.after,
                "standard_error": parameter.standard_error,
                "identifiable": parameter.identifiable,
            })
        });
        let columns = &self.table.measurements.columns;
        let residuals = found.cells.iter().map(|cell| {
            json!({
                "line": self.table.lines[cell.row],
                "column": columns[cell.column].name,
                "measured": cell.measured,
                "residual": cell.residual,
                "studentised": cell.studentised,
                "outlier": cell.outlier,
                "rejected": cell.rejected,
            })
        });
        let held = found.held.iter().map(|combination| {
            let terms = combination.terms.iter().map(|(name, by)| (name.clone(), (*by).into()));
            Value::Object(terms.collect::<Map<_, _>>())
        });
        let play = found.play.joints.iter().map(
            |joint| json!({ "name": joint.name, "length": joint.length, "angle": joint.angle }),
        );
        let correlations: Vec<Vec<f64>> =
            found.correlations.row_iter().map(|row| row.iter().copied().collect()).collect();
        json!({
            "parameters": parameters.collect::<Vec<_>>(),
            "residuals": residuals.collect::<Vec<_>>(),
            "rank": found.rank,
            "singular_values": found.singular_values,
            "held": held.collect::<Vec<_>>(),
            "correlations": correlations,
            "surplus": found.surplus,
            "deviation": found.deviation,
            "deviation_before": found.deviation_before,
            "unused": found.unused.iter().map(|&row| self.table.lines[row]).collect::<Vec<_>>(),
            "play": { "combinations": found.play.combinations, "joints": play.collect::<Vec<_>>() },
        })
    }

    pub fn text(&self) -> String {
        let found = self.found;
        let units = self.loaded.file.units;
        let mut text = String::new();
        let rows = self.table.measurements.rows.len() - found.unused.len();
        let told = found.parameters.iter().filter(|p| p.identifiable).count();
        let values = found.cells.iter().filter(|cell| !cell.rejected).count();
        let _ = writeln!(
            text,
            "{}: {} with {}; {told} of {} told, rank {}",
            self.loaded.file.mechanism.name,
            plural(rows as u64, "measurement"),
            plural(values as u64, "value"),
            plural(found.parameters.len() as u64, "parameter"),
            found.rank,
        );
        let shown = |deviation: Option<f64>| deviation.map_or_else(|| "-".to_owned(), short);
        let meaning = match self.known {
            true => "1 is what --sigma says",
            false => "in radians, and lengths over the mechanism's size",
        };
        let _ = writeln!(
            text,
            "deviation of the residuals: {} before, {} now ({meaning}; {} of surplus)\n",
            shown(found.deviation_before),
            shown(found.deviation),
            plural(found.surplus as u64, "value"),
        );
        let _ = writeln!(text, "{}", self.parameters(units));
        self.held(&mut text);
        self.correlated(&mut text);
        self.outliers(&mut text, units);
        self.play(&mut text, units);
        text.trim_end().to_owned() + "\n"
    }

    fn parameters(&self, units: FileUnits) -> Table {
        let mut table =
            Table::new(["parameter", ">before", ">after", ">change", ">standard error", "unit"]);
        for p in &self.found.parameters {
            let factor = units.factor(p.quantity);
            let error =
                p.standard_error.map_or_else(|| "not told".to_owned(), |e| short(e / factor));
            // As many decimals as the error is worth.
            let size = p.standard_error.unwrap_or(1e-6) / factor;
            let decimals = (1.0 - size.max(1e-12).log10().floor()).clamp(0.0, 12.0) as usize;
            let number = |value: f64| format!("{:.decimals$}", value / factor);
            table.row([
                p.name.clone(),
                number(p.before),
                number(p.after),
                number(p.after - p.before),
                error,
                units.symbol(p.quantity).to_owned(),
            ]);
        }
        table
    }

    fn held(&self, text: &mut String) {
        if self.found.held.is_empty() {
            return;
        }
        let _ = writeln!(text, "Not told by these measurements, and held:");
        for combination in self.found.held.iter().take(LISTED) {
            let _ = writeln!(text, "  {}", combination_text(combination));
        }
        rest(text, self.found.held.len());
    }

    fn correlated(&self, text: &mut String) {
        let found = self.found;
        let names = |i: usize| &found.parameters[i].name;
        let mut pairs = Vec::new();
        for i in 0..found.parameters.len() {
            for j in 0..i {
                let correlation = found.correlations[(i, j)];
                if correlation.abs() > CORRELATED {
                    pairs.push((j, i, correlation));
                }
            }
        }
        pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        if !pairs.is_empty() {
            let _ = writeln!(text, "Hardly told apart (correlation):");
            for (i, j, correlation) in pairs.iter().take(LISTED) {
                let _ = writeln!(text, "  {} and {}: {correlation:.4}", names(*i), names(*j));
            }
            rest(text, pairs.len());
        }
    }

    fn outliers(&self, text: &mut String, units: FileUnits) {
        let odd: Vec<&Cell> =
            self.found.cells.iter().filter(|cell| cell.outlier || cell.rejected).collect();
        if odd.is_empty() {
            return;
        }
        let _ = writeln!(text, "Outliers:");
        for cell in odd.iter().take(LISTED) {
            let column = &self.table.measurements.columns[cell.column];
            let off = short(cell.residual / units.factor(column.quantity));
            let how = match cell.studentised {
                _ if cell.rejected => "left out".to_owned(),
                Some(t) => format!("{} standard deviations", short(t.abs())),
                None => "not checked".to_owned(),
            };
            let _ = writeln!(
                text,
                "  {}:{}: {} is off by {off} {}, {how}",
                self.table.label,
                self.table.lines[cell.row],
                column.name,
                units.symbol(column.quantity),
            );
        }
        rest(text, odd.len());
    }

    fn play(&self, text: &mut String, units: FileUnits) {
        let play = &self.found.play;
        if play.combinations == 0 {
            let _ = writeln!(text, "The residuals show no error that leaves the class.");
            return;
        }
        let _ = writeln!(
            text,
            "The residuals show errors that leave the class ({}). The joints need at least this play:",
            plural(play.combinations as u64, "combination"),
        );
        let headers =
            [Quantity::Length, Quantity::Angle].map(|q| format!(">[{}]", units.symbol(q)));
        let mut table = Table::new(["  joint", &headers[0], &headers[1]]);
        for joint in &play.joints {
            // Rounding is no play.
            let shown = |play: f64| short(if play < 1e-12 { 0.0 } else { play });
            table.row([
                format!("  {}", joint.name),
                shown(joint.length / units.factor(Quantity::Length)),
                shown(joint.angle / units.factor(Quantity::Angle)),
            ]);
        }
        let _ = writeln!(text, "{table}");
    }
}

fn rest(text: &mut String, count: usize) {
    if count > LISTED {
        let _ = writeln!(text, "  and {} more (--format json lists all)", count - LISTED);
    }
    text.push('\n');
}

/// Parameters that change together, in SI.
fn combination_text(combination: &Combination) -> String {
    let mut text = String::new();
    for (number, (name, by)) in combination.terms.iter().enumerate() {
        let _ = match number {
            0 => write!(text, "{name}"),
            _ if *by < 0.0 => write!(text, " - {} {name}", short(-by)),
            _ => write!(text, " + {} {name}", short(*by)),
        };
    }
    text
}
