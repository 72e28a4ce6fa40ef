//! Text for people: aligned tables, and numbers in the units of a mechanism file.

pub use opm_study::text::{chain, count, length_text, nearest_text, reason, set_aside_text};

use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::{AngleUnit, FileUnits, LengthUnit};
use opm_core::text;
use std::fmt;

/// A table whose columns are two spaces apart.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
    right: Vec<bool>,
}

impl Table {
    /// A header for each column. A header that starts with `>` aligns its column to the right.
    pub fn new<T: AsRef<str>>(headers: impl IntoIterator<Item = T>) -> Self {
        let mut table = Self::default();
        let mut row = Vec::new();
        for header in headers {
            let header = header.as_ref();
            table.right.push(header.starts_with('>'));
            row.push(text::cell(header.trim_start_matches('>')).into_owned());
        }
        table.rows.push(row);
        table
    }

    /// Adds a row. Each cell is on one line, and not endless.
    pub fn row<T: Into<String>>(&mut self, cells: impl IntoIterator<Item = T>) {
        let shown = |cell: T| text::cell(&cell.into()).into_owned();
        self.rows.push(cells.into_iter().map(shown).collect());
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.right.len()).map(width).collect();
        for row in &self.rows {
            let mut line = String::new();
            for ((cell, width), right) in row.iter().zip(&widths).zip(&self.right) {
                if !line.is_empty() {
                    line.push_str("  ");
                }
                let pad = " ".repeat(width - cell.chars().count());
                line.push_str(&if *right { pad + cell } else { cell.clone() + &pad });
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// An SI value in the file's unit, without the unit's symbol: to about a micrometre or microradian.
pub fn number(value: f64, quantity: Quantity, units: FileUnits) -> String {
    let decimals = match quantity {
        Quantity::Length => match units.length {
            LengthUnit::Metre => 6,
            LengthUnit::Centimetre | LengthUnit::Inch => 4,
            LengthUnit::Millimetre => 3,
            LengthUnit::Micrometre => 0,
        },
        Quantity::Angle => match units.angle {
            AngleUnit::Radian => 6,
            AngleUnit::Milliradian => 3,
            AngleUnit::Microradian => 0,
            AngleUnit::Degree => 4,
        },
    };
    fixed(value / units.factor(quantity), decimals)
}

/// The names and values of a pose, then those of its dependent coordinates, radians and metres.
pub fn whole_pose(
    manipulator: &Manipulator,
    pose: &[f64],
    dependent: &[f64],
) -> impl Iterator<Item = (&'static str, f64)> {
    let own = manipulator.task_coordinates().iter().zip(pose);
    let others = manipulator.dependent_coordinates().iter().zip(dependent);
    own.chain(others).map(|(c, &value)| (c.name, value)).collect::<Vec<_>>().into_iter()
}

/// A name with the unit of its values, as the header of a column aligned to the right.
pub fn header(name: &str, quantity: Quantity, units: FileUnits) -> String {
    format!(">{name} [{}]", units.symbol(quantity))
}

/// The lowest and the highest value in the file's unit.
pub fn range([low, high]: [f64; 2], quantity: Quantity, units: FileUnits) -> String {
    format!("{} .. {}", number(low, quantity, units), number(high, quantity, units))
}

/// That a joint is beyond its limits, in the file's unit.
pub fn beyond_limits(
    name: &str,
    value: f64,
    limits: [f64; 2],
    quantity: Quantity,
    units: FileUnits,
) -> String {
    let (value, limits) = (units.show(value, quantity), range(limits, quantity, units));
    format!("{name} = {value} is beyond its limits, {limits} {}", units.symbol(quantity))
}

/// A count with its noun.
pub fn plural(number: u64, what: &str) -> String {
    format!("{} {what}{}", count(number), if number == 1 { "" } else { "s" })
}

/// A number to four significant digits.
pub fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&exponent) && value != 0.0 {
        return format!("{value:.3e}");
    }
    let decimals = if value == 0.0 { 0 } else { (3.0 - exponent).max(0.0) as usize };
    fixed(value, decimals)
}

fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // A rounded `-0` would look like a mistake.
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}

/// A word, quoted for a shell if necessary.
pub fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "._-/=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MM_DEG: FileUnits =
        FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let mut table = Table::new(["leg", ">value"]);
        table.row(["a", "10.5"]);
        table.row(["théta", "-1.25"]);
        assert_eq!(table.to_string(), "leg    value\na       10.5\nthéta  -1.25\n");
    }

    #[test]
    fn numbers_are_in_the_units_of_the_file() {
        assert_eq!(number(0.0123, Quantity::Length, MM_DEG), "12.300");
        assert_eq!(number(std::f64::consts::PI, Quantity::Angle, MM_DEG), "180.0000");
        assert_eq!(number(-1e-9, Quantity::Length, MM_DEG), "0.000");
        assert_eq!(header("S1", Quantity::Length, MM_DEG), ">S1 [mm]");
    }

    #[test]
    fn shares_are_short() {
        assert_eq!(short(12.345_678), "12.35");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(123_456.0), "123456");
        assert_eq!(short(1.5e12), "1.500e12");
        assert_eq!(short(2.5e-7), "2.500e-7");
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(shell_word("part-3.mcap"), "part-3.mcap");
        assert_eq!(shell_word("++ -+"), "'++ -+'");
        assert_eq!(shell_word("it's"), "'it'\\''s'");
    }
}
