//! The lines of a table, a row at a time: exact line numbers, bounded memory.

use std::io::{self, BufRead, BufReader, Read};
use std::ops::Range;

/// Longest line, in bytes: some hundred numbers, each with more digits than it can use.
const LONGEST: usize = 1 << 16;

/// What some programs write before the first line of a text.
const MARK: char = '\u{feff}';

/// The lines of a CSV file.
pub struct Lines<'r> {
    reader: BufReader<Box<dyn Read + 'r>>,
    line: Vec<u8>,
    number: u64,
    /// Where the fields of the line are.
    fields: Vec<Range<usize>>,
}

impl<'r> Lines<'r> {
    /// Reads from the start of a file.
    pub fn new(reader: Box<dyn Read + 'r>) -> Self {
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
        let mut start = trimmed(line, 0..line.len()).start;
        if self.number == 1 && line[start..].starts_with(MARK.to_string().as_bytes()) {
            start += MARK.len_utf8();
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

    /// The place of a field in its line, in characters from 1.
    pub fn column(self, field: usize) -> usize {
        let before = String::from_utf8_lossy(&self.line[..self.fields[field].start]);
        let mark = usize::from(self.number == 1 && before.starts_with(MARK));
        before.chars().count() - mark + 1
    }

    /// The line without what ends it.
    pub fn text(self) -> std::borrow::Cow<'a, str> {
        let text = String::from_utf8_lossy(self.line.trim_ascii_end());
        match text.strip_prefix(MARK) {
            Some(rest) => rest.to_owned().into(),
            None => text,
        }
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
    /// use opm_core::table::{Lines, FieldPlace};
    ///
    /// # fn main() -> std::io::Result<()> {
    /// let mut lines = Lines::new(Box::new("2,home,\n".as_bytes()));
    /// let line = lines.next()?.expect("a row");
    /// let place = |number, optional| Some(FieldPlace { number, optional, usual: [-1.0, 1.0] });
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
        places: &[Option<FieldPlace>],
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
pub struct FieldPlace {
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
