//! Trajectories in the form of the TUM benchmark for visual SLAM: lines of `timestamp tx ty tz qx qy qz qw`, with blanks
//! between the numbers, no header, and comments that begin with `#`.

use std::io::{self, BufRead, BufReader, Cursor, Read};

/// The header of such a table as CSV.
const HEADER: &[u8] = b"t,x,y,z,qx,qy,qz,qw\n";
/// The numbers of a line.
const NUMBERS: usize = 8;
/// Longest beginning of a table that is looked at, bytes.
const LOOKED_AT: u64 = 1 << 16;

/// The table as CSV with a header `t,x,y,z,qx,qy,qz,qw`, if it has this form, and the number of its lines before the first of the file; any
/// other table as it is.
///
/// # Errors
/// The table cannot be read.
pub fn as_csv(mut table: Box<dyn Read>) -> io::Result<(Box<dyn Read>, u64)> {
    let mut begun = Vec::new();
    let mut from = 0;
    // To the end of the first line that is no comment.
    let is_tum = loop {
        if let Some(length) = begun[from..].iter().position(|&byte| byte == b'\n') {
            let line = &begun[from..from + length];
            from += length + 1;
            match is_passed_over(line) {
                true => continue,
                false => break is_row(line),
            }
        }
        let left = LOOKED_AT - begun.len() as u64;
        let mut chunk = vec![0; left.min(4096) as usize];
        let read = match table.read(&mut chunk) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            read => read?,
        };
        if read == 0 {
            break is_row(&begun[from..]);
        }
        begun.extend_from_slice(&chunk[..read]);
    };
    let whole = Cursor::new(begun).chain(table);
    Ok(match is_tum {
        false => (Box::new(whole), 0),
        true => {
            let rows = Rows { lines: BufReader::new(whole), row: Cursor::new(Vec::new()) };
            (Box::new(Cursor::new(HEADER).chain(rows)), 1)
        }
    })
}

/// Whether a line is blank or a comment.
fn is_passed_over(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.is_empty() || line.starts_with(b"#")
}

/// Whether a line is a row: eight numbers with blanks between them.
fn is_row(line: &[u8]) -> bool {
    let Ok(line) = std::str::from_utf8(line) else { return false };
    let numbers = || line.split_ascii_whitespace();
    numbers().count() == NUMBERS && numbers().all(|number| number.parse::<f64>().is_ok())
}

/// Lines with commas in place of blanks; comments are empty lines, so that lines keep their numbers.
struct Rows<R> {
    lines: BufReader<R>,
    row: Cursor<Vec<u8>>,
}

impl<R: Read> Read for Rows<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.row.read(out)?;
            if read > 0 || out.is_empty() {
                return Ok(read);
            }
            let mut line = Vec::new();
            // A line that is too long is refused by who reads the rows.
            if self.lines.by_ref().take(2 * LOOKED_AT).read_until(b'\n', &mut line)? == 0 {
                return Ok(0);
            }
            let mut row = Vec::new();
            if !is_passed_over(&line) {
                let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
                row = words.collect::<Vec<_>>().join(&b',');
            }
            if line.last() == Some(&b'\n') {
                row.push(b'\n');
            }
            self.row = Cursor::new(row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::as_csv;

    fn read(text: &'static str) -> (String, u64) {
        let (mut table, before) = as_csv(Box::new(text.as_bytes())).unwrap();
        let mut csv = String::new();
        table.read_to_string(&mut csv).unwrap();
        (csv, before)
    }

    #[test]
    fn rows_become_csv_and_keep_their_lines() {
        let (csv, before) = read("# a comment\n0 1 2 3  0 0 0 1\n\n# b\r\n1.5\t1 2 3 0 0 0 1\r\n");
        assert_eq!(csv, "t,x,y,z,qx,qy,qz,qw\n\n0,1,2,3,0,0,0,1\n\n\n1.5,1,2,3,0,0,0,1\n");
        assert_eq!(before, 1);
        assert_eq!(read("0 1 2 3 0 0 0 1").0, "t,x,y,z,qx,qy,qz,qw\n0,1,2,3,0,0,0,1");
    }

    #[test]
    fn a_blank_line_of_megabytes_is_passed_over() {
        let rows = format!("0 1 2 3 0 0 0 1\n{}\n1 1 2 3 0 0 0 1\n", " ".repeat(1 << 26));
        let (mut table, _) = as_csv(Box::new(std::io::Cursor::new(rows))).unwrap();
        let mut csv = String::new();
        table.read_to_string(&mut csv).unwrap();
        assert_eq!(csv, "t,x,y,z,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n\n1,1,2,3,0,0,0,1\n");
    }

    #[test]
    fn other_tables_stay_as_they_are() {
        for text in
            ["", "\n", "x,y\n1,2\n", "# x\nx y\n", "0 1 2 3 4 5 6\n", "0,1,2,3,0,0,0,1\n", "x"]
        {
            assert_eq!(read(text), (text.to_owned(), 0));
        }
    }
}
