//! CSV of plain numbers, read and written a row at a time: exact line numbers, bounded memory.
//!
//! ```
//! use opm_mcap::csv::{Lines, Rows};
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
//!
//! let mut lines = Lines::new(Box::new("x, y\n\n1, 2\n".as_bytes()));
//! let header = lines.next()?.map(|line| line.number);
//! assert_eq!(header, Some(1));
//! let row = lines.next()?.expect("a row");
//! assert_eq!(row.number, 3);
//! assert!(row.fields().eq([b"1", b"2"]));
//! # Ok(())
//! # }
//! ```

use csv::{ErrorKind, Writer, WriterBuilder};
use std::collections::HashSet;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::ops::Range;

/// Longest line, in bytes: some hundred numbers, each with more digits than it can use. As many are written at a time.
const LONGEST: usize = 1 << 16;

/// The lines of a CSV file.
pub struct Lines {
    reader: BufReader<Box<dyn Read>>,
    line: Vec<u8>,
    number: u64,
    /// Where the fields of the line are.
    fields: Vec<Range<usize>>,
}

impl Lines {
    /// Reads from the start of a file.
    pub fn new(reader: Box<dyn Read>) -> Self {
        let reader = BufReader::with_capacity(LONGEST, reader);
        Self { reader, line: Vec::new(), number: 0, fields: Vec::new() }
    }

    /// The next line that is not blank; `None` at the end.
    ///
    /// # Errors
    /// The file cannot be read, or a line is longer than 65,536 bytes.
    #[expect(clippy::should_implement_trait, reason = "a line borrows what the next one replaces")]
    pub fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        loop {
            self.line.clear();
            let mut limited = self.reader.by_ref().take(LONGEST as u64 + 1);
            if limited.read_until(b'\n', &mut self.line)? == 0 {
                return Ok(None);
            }
            self.number += 1;
            if self.line.len() > LONGEST {
                let problem = format!("line {} is longer than {LONGEST} bytes", self.number);
                return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        self.split();
        Ok(Some(Line { number: self.number, line: &self.line, fields: &self.fields }))
    }

    /// Finds the fields between the commas, without surrounding spaces and quotes.
    fn split(&mut self) {
        let Self { line, fields, .. } = self;
        let mark = "\u{feff}".as_bytes();
        let mut start = trimmed(line, 0..line.len()).start;
        if self.number == 1 && line[start..].starts_with(mark) {
            start += mark.len();
        }
        fields.clear();
        for piece in line[start..].split(|&byte| byte == b',') {
            let field = trimmed(line, start..start + piece.len());
            start += piece.len() + 1;
            let quoted = match &line[field.clone()] {
                [b'"', .., b'"'] => trimmed(line, field.start + 1..field.end - 1),
                _ => field,
            };
            fields.push(quoted);
        }
    }
}

/// The part of a range that is left without spaces around it.
fn trimmed(line: &[u8], range: Range<usize>) -> Range<usize> {
    let text = line[range.clone()].trim_ascii_start();
    let start = range.end - text.len();
    start..start + text.trim_ascii_end().len()
}

/// One line.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Its number, from 1.
    pub number: u64,
    line: &'a [u8],
    fields: &'a [Range<usize>],
}

impl<'a> Line<'a> {
    /// The fields between the commas, without surrounding spaces and quotes.
    pub fn fields(self) -> impl ExactSizeIterator<Item = &'a [u8]> {
        self.fields.iter().map(move |field| &self.line[field.clone()])
    }

    /// Reads the numbers of a row, of which `places` says where each field's belongs; `None` is passed over. An optional number
    /// whose field is empty is NaN. Returns whether all others are usual.
    ///
    /// # Errors
    /// The number of the first wrong field, and what is wrong with it ([`number`]).
    ///
    /// # Panics
    /// If a place is outside of the row.
    ///
    /// ```
    /// use opm_mcap::csv::{Lines, Place};
    ///
    /// # fn main() -> std::io::Result<()> {
    /// let mut lines = Lines::new(Box::new("2,home,\n".as_bytes()));
    /// let line = lines.next()?.expect("a row");
    /// let place = |number, optional| Some(Place { number, optional, usual: [-1.0, 1.0] });
    /// let mut row = [0.0; 2];
    /// assert_eq!(line.numbers(&[place(1, false), None, place(0, true)], &mut row), Ok(false));
    /// assert!(row[0].is_nan() && row[1] == 2.0);
    /// let wrong = line.numbers(&[place(1, false), place(0, false), None], &mut row);
    /// assert_eq!(wrong, Err((1, "is not a number")));
    /// # Ok(())
    /// # }
    /// ```
    pub fn numbers(
        self,
        places: &[Option<Place>],
        row: &mut [f64],
    ) -> Result<bool, (usize, &'static str)> {
        let mut usual = true;
        for (i, (field, place)) in self.fields().zip(places).enumerate() {
            let Some(place) = place else { continue };
            if place.optional && field.is_empty() {
                row[place.number] = f64::NAN;
                continue;
            }
            let number = number(field).map_err(|problem| (i, problem))?;
            let [low, high] = place.usual;
            usual &= low <= number && number <= high;
            row[place.number] = number;
        }
        Ok(usual)
    }
}

/// Where the number of a field belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its place in the row.
    pub number: usize,
    /// Whether the field may be empty.
    pub optional: bool,
    /// The least and the largest number that is usual there.
    pub usual: [f64; 2],
}

/// The number in a field.
///
/// # Errors
/// What is wrong with it: it is not a number, or not a finite one.
pub fn number(field: &[u8]) -> Result<f64, &'static str> {
    let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
    let number: f64 = number.ok_or("is not a number")?;
    number.is_finite().then_some(number).ok_or("is not a finite number")
}

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
        options.has_headers(false).buffer_capacity(LONGEST);
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

    fn read(text: &'static str) -> Vec<(u64, Vec<String>)> {
        let mut lines = Lines::new(Box::new(text.as_bytes()));
        let mut found = Vec::new();
        while let Some(line) = lines.next().unwrap() {
            let fields = line.fields().map(|f| String::from_utf8(f.to_vec()).unwrap()).collect();
            found.push((line.number, fields));
        }
        found
    }

    #[test]
    fn lines_are_numbered_as_an_editor_numbers_them() {
        let found = read("\u{feff}x, \"y\"\r\n\r\n 1,2\n\n3,");
        let row = |number, fields: [&str; 2]| (number, fields.map(str::to_owned).to_vec());
        assert_eq!(found, [row(1, ["x", "y"]), row(3, ["1", "2"]), row(5, ["3", ""])]);
        assert_eq!(read(""), []);
        assert_eq!(read("\" a \" ,\",\"\"b"), [row_of(1, &["a", "\"", "\"\"b"])]);
    }

    fn row_of(number: u64, fields: &[&str]) -> (u64, Vec<String>) {
        (number, fields.iter().map(|&field| field.to_owned()).collect())
    }

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

    #[test]
    fn a_field_is_a_finite_number_or_it_is_told_what_is_wrong() {
        assert_eq!(number(b"-1.5e-3"), Ok(-0.0015));
        for text in ["", "1,5", "x", "0x10"] {
            assert_eq!(number(text.as_bytes()), Err("is not a number"), "{text}");
        }
        assert_eq!(number(&[b'1', 0xff]), Err("is not a number"));
        for text in ["nan", "-inf", "1e400"] {
            assert_eq!(number(text.as_bytes()), Err("is not a finite number"), "{text}");
        }
    }

    #[test]
    fn a_file_without_line_ends_is_not_swallowed_whole() {
        let mut lines = Lines::new(Box::new(io::repeat(b'1')));
        let error = lines.next().map(|line| line.is_some()).unwrap_err();
        assert!(error.to_string().contains("line 1 is longer"), "{error}");
    }
}
