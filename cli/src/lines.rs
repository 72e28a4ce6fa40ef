//! CSV of plain numbers, read a line at a time: exact line numbers, bounded memory.

use std::io::{self, BufRead, BufReader, Read};

/// Longest line, in bytes: some hundred numbers, each with more digits than it can use.
const LONGEST: usize = 1 << 16;

/// The lines of a CSV file.
pub struct Lines<R> {
    reader: BufReader<R>,
    line: Vec<u8>,
    number: u64,
}

impl<R: Read> Lines<R> {
    /// Reads from the start of a file.
    pub fn new(reader: R) -> Self {
        Self { reader: BufReader::with_capacity(LONGEST, reader), line: Vec::new(), number: 0 }
    }

    /// The next line that is not blank; `None` at the end.
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
        let mut text = self.line.trim_ascii();
        if self.number == 1 {
            text = text.strip_prefix("\u{feff}".as_bytes()).unwrap_or(text);
        }
        Ok(Some(Line { number: self.number, text }))
    }
}

/// One line.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Its number, from 1.
    pub number: u64,
    text: &'a [u8],
}

impl<'a> Line<'a> {
    /// The fields between the commas, without surrounding spaces and quotes.
    pub fn fields(self) -> impl Iterator<Item = &'a [u8]> {
        self.text.split(|&byte| byte == b',').map(|field| {
            let field = field.trim_ascii();
            let quoted = field.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
            quoted.map_or(field, <[u8]>::trim_ascii)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(u64, Vec<String>)> {
        let mut lines = Lines::new(text.as_bytes());
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
    }

    #[test]
    fn a_file_without_line_ends_is_not_swallowed_whole() {
        let mut lines = Lines::new(io::repeat(b'1'));
        let error = lines.next().map(|line| line.is_some()).unwrap_err();
        assert!(error.to_string().contains("line 1 is longer"), "{error}");
    }
}
