//! Points as one flat table: NPY for NumPy, PLY for mesh tools.
//!
//! | ending | format | point |
//! |---|---|---|
//! | `.npy` | a structured array of one axis, which can be memory-mapped (`numpy.load(..., mmap_mode="r")`) | one float64 for each column, by its name |
//! | `.ply` | binary, little-endian; one element, `vertex` | x y z and the scalars as float32, red green blue alpha as bytes |
//!
//! Values are SI and radians. The number of points is stored in front of them, so it has to be known first.
//! As a recording, a table gets its name once it is whole.

use std::fmt::Write as _;

use crate::cloud::{COLOR_FIELDS, POSITION_FIELDS};
use crate::{CloudLayout, Metadata, RecordError, Sink};

/// The number of bytes that the array of an NPY file is aligned to.
const ALIGNMENT: usize = 64;

/// A format of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// NumPy's own format.
    Npy,
    /// Stanford's polygon file format.
    Ply,
}

/// Writes a table of points. Any error is final.
///
/// ```
/// use opm_mcap::{CloudLayout, Metadata, PartialFile, TableFormat, TableRecorder, table_columns};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("points.npy");
/// let layout = CloudLayout {
///     axes: ["x", "y", "xi"].map(String::from),
///     scalars: vec![],
///     color: "xi".into(),
///     color_range: [0.0, 1.0],
///     frame_id: "base".into(),
///     scale: [1.0; 3],
///     units: ["m", "m", "rad"],
/// };
/// let file = PartialFile::create(&path)?;
/// let (points, run) = (1, Metadata::new());
/// let mut table = TableRecorder::new(file, TableFormat::Npy, &layout, points, &run)?;
/// assert_eq!(table_columns(&layout), ["x", "y", "xi"]);
/// table.push_rows(&[0.1, 0.2, 0.3])?;
/// table.finish()?;
/// assert!(std::fs::read(&path)?.starts_with(b"\x93NUMPY"));
/// # Ok(())
/// # }
/// ```
pub struct TableRecorder<'w> {
    /// `None` after an error.
    sink: Option<Box<dyn Sink + 'w>>,
    stride: usize,
    announced: u64,
    pushed: u64,
    /// Rows as bytes.
    bytes: Vec<u8>,
}

impl<'w> TableRecorder<'w> {
    /// Starts a table with the given number of points, which is written to `sink`. `run` is written as
    /// comments, if the format has comments.
    ///
    /// # Errors
    /// A failed write.
    pub fn new(
        sink: impl Sink + 'w,
        format: TableFormat,
        layout: &CloudLayout,
        points: u64,
        run: &Metadata,
    ) -> Result<Self, RecordError> {
        match format {
            TableFormat::Npy => Self::npy(sink, &table_columns(layout), points),
            TableFormat::Ply => {
                Self::begin(Box::new(sink), &ply(layout, points, run), layout.stride(), points)
            }
        }
    }

    /// Starts an NPY table of rows of any named columns.
    ///
    /// # Errors
    /// A failed write.
    pub fn npy(sink: impl Sink + 'w, columns: &[&str], rows: u64) -> Result<Self, RecordError> {
        Self::begin(Box::new(sink), &npy(columns, rows), 8 * columns.len(), rows)
    }

    /// Starts a table with this header, whose rows have `stride` bytes.
    fn begin(
        mut sink: Box<dyn Sink + 'w>,
        header: &[u8],
        stride: usize,
        rows: u64,
    ) -> Result<Self, RecordError> {
        sink.write_all(header).map_err(RecordError::Io)?;
        Ok(Self { sink: Some(sink), stride, announced: rows, pushed: 0, bytes: Vec::new() })
    }

    /// Adds rows of numbers to an NPY table, in the order of its columns ([`table_columns`] for points).
    ///
    /// # Errors
    /// As [`TableRecorder::push`].
    pub fn push_rows(&mut self, rows: &[f64]) -> Result<(), RecordError> {
        let mut bytes = std::mem::take(&mut self.bytes);
        little_endian(rows, &mut bytes);
        self.push(&bytes)?;
        self.bytes = bytes;
        Ok(())
    }

    /// Adds points as bytes: in PLY, points of a [`Packer`](crate::Packer); in NPY, rows of little-endian doubles.
    ///
    /// # Errors
    /// [`RecordError::Layout`] if `points` is not a whole number of points, or a failed write.
    pub fn push(&mut self, points: &[u8]) -> Result<(), RecordError> {
        let Some(mut sink) = self.sink.take() else { return Err(RecordError::AfterFailure) };
        if !points.len().is_multiple_of(self.stride) {
            let (bytes, stride) = (points.len(), self.stride);
            let problem = format!("{bytes} bytes are no whole number of points of {stride}");
            return Err(RecordError::Layout(problem));
        }
        self.pushed += (points.len() / self.stride) as u64;
        sink.write_all(points).map_err(RecordError::Io)?;
        self.sink = Some(sink);
        Ok(())
    }

    /// Completes the table, which only now gets its name.
    ///
    /// # Errors
    /// [`RecordError::Count`] if there were fewer or more points than announced, or a failed write.
    pub fn finish(self) -> Result<(), RecordError> {
        let (found, expected) = (self.pushed, self.announced);
        if found != expected {
            return Err(RecordError::Count { what: "table", found, expected });
        }
        let sink = self.sink.ok_or(RecordError::AfterFailure)?;
        sink.commit().map_err(RecordError::Io)
    }
}

/// Puts numbers into `bytes`, instead of what is there.
fn little_endian(numbers: &[f64], bytes: &mut Vec<u8>) {
    bytes.resize(8 * numbers.len(), 0);
    for (number, bytes) in numbers.iter().zip(bytes.as_chunks_mut().0) {
        *bytes = number.to_le_bytes();
    }
}

/// The names of the columns of an NPY table: those of the layout, each once.
pub fn table_columns(layout: &CloudLayout) -> Vec<&str> {
    let mut columns: Vec<&str> = Vec::new();
    for name in layout.columns() {
        if !columns.contains(&name) {
            columns.push(name);
        }
    }
    columns
}

/// The header of an NPY file, version 1.0, or 3.0 for names that are not ASCII: see `numpy.lib.format`.
fn npy(columns: &[&str], points: u64) -> Vec<u8> {
    let mut fields = String::new();
    for name in columns {
        let quoted = name.replace('\\', "\\\\").replace('\'', "\\'");
        let _ = write!(fields, "('{quoted}', '<f8'), ");
    }
    let mut text =
        format!("{{'descr': [{fields}], 'fortran_order': False, 'shape': ({points},), }}");
    let wide = !text.is_ascii() || text.len() + ALIGNMENT > usize::from(u16::MAX);
    let head = 8 + if wide { 4 } else { 2 };
    // Spaces up to a newline, behind which the array begins.
    let end = (head + text.len() + 1).next_multiple_of(ALIGNMENT);
    text.extend(std::iter::repeat_n(' ', end - 1 - head - text.len()));
    text.push('\n');
    let mut header = b"\x93NUMPY".to_vec();
    if wide {
        header.extend([3, 0]);
        header.extend((text.len() as u32).to_le_bytes());
    } else {
        header.extend([1, 0]);
        header.extend((text.len() as u16).to_le_bytes());
    }
    header.extend(text.as_bytes());
    header
}

/// The header of a PLY file.
fn ply(layout: &CloudLayout, points: u64, run: &Metadata) -> Vec<u8> {
    // Lines of printable characters, names of one word.
    let line = |text: &str| text.replace(char::is_control, " ");
    let word = |text: &str| text.replace(|c: char| c.is_control() || c.is_whitespace(), "_");
    let mut text = "ply\nformat binary_little_endian 1.0\n".to_owned();
    for (key, value) in run {
        let _ = writeln!(text, "comment {}: {}", line(key), line(value));
    }
    let [x, y, z] = &layout.axes;
    let _ =
        writeln!(text, "comment x, y, z: {}, {}, {}; SI and radians", line(x), line(y), line(z));
    let _ = writeln!(text, "comment color: {}", line(&layout.color));
    let _ = writeln!(text, "element vertex {points}");
    let scalars = layout.scalars.iter().map(|name| &**name);
    for name in POSITION_FIELDS.into_iter().chain(scalars) {
        let _ = writeln!(text, "property float {}", word(name));
    }
    for name in COLOR_FIELDS {
        let _ = writeln!(text, "property uchar {name}");
    }
    text.push_str("end_header\n");
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_array_of_an_npy_file_is_aligned() {
        for columns in [&["x"][..], &["x", "it's", "tip.x"], &["φ"], &["a"; 9000]] {
            let header = npy(columns, 12);
            assert!(header.len().is_multiple_of(ALIGNMENT));
            assert_eq!(header.last(), Some(&b'\n'));
        }
    }
}
