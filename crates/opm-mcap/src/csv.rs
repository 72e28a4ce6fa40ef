//! CSV of plain numbers, written a row at a time with bounded memory; `opm_core::table` reads it.
//!
//! ```
//! use opm_mcap::csv::Rows;
//!
//! # fn main() -> std::io::Result<()> {
//! let mut text = Vec::new();
//! let mut rows = Rows::new(&mut text);
//! rows.header(["x", "mode", "y"])?;
//! rows.number(0.5)?;
//! rows.text("+-")?;
//! rows.cells(&[None])?;
//! rows.end()?;
//! rows.flush()?;
//! drop(rows);
//! assert_eq!(text, b"x,mode,y\n0.5,+-,\n");
//! # Ok(())
//! # }
//! ```

use csv::{ErrorKind, Writer, WriterBuilder};
use std::collections::HashSet;
use std::io::{self, Write};

/// The number of bytes that are written at a time.
const BUFFER: usize = 1 << 16;

/// Refuses names of columns of which two are the same but for their units: who reads the table cannot tell which is
/// meant.
///
/// # Errors
/// The name that is given twice.
pub fn distinct<'n>(names: impl IntoIterator<Item = &'n str>) -> io::Result<()> {
    let mut seen = HashSet::new();
    let without_unit = |name: &'n str| name.split(" [").next().unwrap_or(name);
    match names.into_iter().map(without_unit).find(|name| !seen.insert(*name)) {
        None => Ok(()),
        Some(name) => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("two columns would be called {name:?}, expected another name of the joint"),
        )),
    }
}

/// Writes rows, cell by cell. Everything has been written after [`Rows::flush`].
pub struct Rows<'w> {
    writer: Writer<&'w mut (dyn Write + Send)>,
}

impl<'w> Rows<'w> {
    /// Begins a file.
    pub fn new(sink: &'w mut (dyn Write + Send)) -> Self {
        let mut options = WriterBuilder::new();
        options.has_headers(false).buffer_capacity(BUFFER);
        Self { writer: options.from_writer(sink) }
    }

    /// Writes a row of names.
    ///
    /// # Errors
    /// Two names are the same ([`distinct`]), or the file cannot be written, which may be said by all that follows, too.
    pub fn header<'n>(&mut self, names: impl IntoIterator<Item = &'n str>) -> io::Result<()> {
        let names: Vec<&str> = names.into_iter().collect();
        distinct(names.iter().copied())?;
        names.into_iter().try_for_each(|name| self.text(name))?;
        self.end()
    }

    /// Writes a cell.
    pub fn text(&mut self, text: &str) -> io::Result<()> {
        self.writer.write_field(text).map_err(failure)
    }

    /// Writes a number, a finite one as JSON has it: with as many digits as tell it from its neighbours.
    pub fn number(&mut self, value: f64) -> io::Result<()> {
        self.text(zmij::Buffer::new().format(value))
    }

    /// Writes numbers.
    pub fn numbers(&mut self, values: &[f64]) -> io::Result<()> {
        values.iter().try_for_each(|&value| self.number(value))
    }

    /// Writes numbers; `count` empty cells if they are unknown.
    pub fn known(&mut self, values: Option<&[f64]>, count: usize) -> io::Result<()> {
        match values {
            Some(values) => self.numbers(values),
            None => (0..count).try_for_each(|_| self.text("")),
        }
    }

    /// Writes the numbers that have these places; an empty cell for each place if they are unknown.
    pub fn selected(&mut self, values: Option<&[f64]>, places: &[usize]) -> io::Result<()> {
        match values {
            Some(values) => places.iter().try_for_each(|&place| self.number(values[place])),
            None => self.known(None, places.len()),
        }
    }

    /// Writes numbers; an empty cell where there is none.
    pub fn cells(&mut self, values: &[Option<f64>]) -> io::Result<()> {
        values.iter().try_for_each(|value| match value {
            Some(value) => self.number(*value),
            None => self.text(""),
        })
    }

    /// Writes a whole number.
    pub fn count(&mut self, number: u64) -> io::Result<()> {
        self.text(itoa::Buffer::new().format(number))
    }

    /// Writes answers, as [`Rows::answer`] does.
    pub fn answers(&mut self, answers: &[bool]) -> io::Result<()> {
        answers.iter().try_for_each(|&yes| self.answer(yes))
    }

    /// Writes an answer, as 1 or 0.
    pub fn answer(&mut self, yes: bool) -> io::Result<()> {
        self.text(if yes { "1" } else { "0" })
    }

    /// Ends the row.
    pub fn end(&mut self) -> io::Result<()> {
        self.writer.write_record(None::<&[u8]>).map_err(failure)
    }

    /// Writes all that is left.
    pub fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

fn failure(error: csv::Error) -> io::Error {
    match error.into_kind() {
        ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the crate `csv` writes the same cells by serde, except that large exponents have a sign.
    #[test]
    fn rows_are_those_of_csv() {
        let numbers = [0.1, -0.0, 1e300, 5e-324, f64::NAN, f64::INFINITY, 1.0, 123_456_789.25];
        let cells = [Some(2.5), None, Some(-1e-9)];
        let (mut own, mut other) = (Vec::new(), csv::WriterBuilder::new());
        let mut other = other.has_headers(false).from_writer(Vec::new());
        let mut rows = Rows::new(&mut own);
        for text in ["+--", "", "a,b", "say \"so\""] {
            rows.numbers(&numbers).unwrap();
            rows.cells(&cells).unwrap();
            rows.known(Some(&numbers[..2]), 2).unwrap();
            rows.known(None, 2).unwrap();
            rows.selected(Some(&numbers), &[7, 0]).unwrap();
            rows.selected(None, &[7, 0]).unwrap();
            rows.count(u64::MAX).unwrap();
            rows.answers(&[true, false]).unwrap();
            rows.text(text).unwrap();
            rows.end().unwrap();
            let none = [None::<f64>; 2];
            let given = (&numbers[..2], none, [numbers[7], numbers[0]], none);
            other.serialize((numbers, cells, given, u64::MAX, [1, 0], text)).unwrap();
        }
        rows.flush().unwrap();
        drop(rows);
        let other = String::from_utf8(other.into_inner().unwrap()).unwrap();
        let other = other.replace("1e300", "1e+300");
        assert_eq!(String::from_utf8(own).unwrap(), other);

        // Rows of one cell, which must not be blank lines.
        let mut own = Vec::new();
        let mut rows = Rows::new(&mut own);
        for cell in [None, Some(1.0)] {
            rows.cells(&[cell]).unwrap();
            rows.end().unwrap();
        }
        drop(rows);
        assert_eq!(own, b"\"\"\n1.0\n");
    }

    #[test]
    fn numbers_are_those_of_json() {
        for number in [0.0, 1.0, 1e-4, 1e-5, 1.5e-7, 1e15, 1e16, 1e17, 1e22, 5e-324, f64::MAX] {
            for number in [number, -number, number / 3.0] {
                let mut own = Vec::new();
                let mut rows = Rows::new(&mut own);
                rows.number(number).unwrap();
                rows.end().unwrap();
                rows.flush().unwrap();
                drop(rows);
                let json = serde_json::to_string(&number).unwrap();
                assert_eq!(String::from_utf8(own).unwrap(), format!("{json}\n"));
            }
        }
    }
}
