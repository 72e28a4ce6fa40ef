//! Files of users, read within limits: what is endless, or too large to be what is expected, is refused and not read until
//! the memory ends.

use std::fs::{self, File, FileType, Metadata};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// What a file is expected to be, and its largest size in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// Its name in messages: `a mechanism file`.
    pub what: &'static str,
    /// The largest number of bytes.
    pub longest: u64,
}

impl Expected {
    /// A mechanism file.
    pub const MECHANISM: Self = Self { what: "a mechanism file", longest: 16 << 20 };
    /// A motion file.
    pub const MOTION: Self = Self { what: "a motion file", longest: 64 << 20 };
    /// A table of poses with times: some millions of lines.
    pub const POSES: Self = Self { what: "a table of poses", longest: 1 << 30 };
    /// A table that is read row by row, however long it is.
    pub const ROWS: Self = Self { what: "a table", longest: u64::MAX };
    /// A table of measurements.
    pub const MEASUREMENTS: Self = Self { what: "a table of measurements", longest: 64 << 20 };
    /// The problem of a design.
    pub const DESIGN: Self = Self { what: "a problem of design", longest: 1 << 20 };
    /// The evaluations of a design.
    pub const EVALUATIONS: Self = Self { what: "a table of evaluations", longest: 1 << 30 };
    /// A file of tolerances.
    pub const TOLERANCES: Self = Self { what: "a file of tolerances", longest: 1 << 20 };

    /// The largest size in words.
    fn limit(self) -> String {
        match self.longest {
            u64::MAX => self.what.to_owned(),
            longest => format!("{} of at most {} MiB", self.what, longest >> 20),
        }
    }
}

/// Whether a pipe is read. Who waits for one has to end by itself at Ctrl-C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pipes {
    /// It is read like a file.
    Read,
    /// It is refused.
    Refuse,
}

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// The operating system's reason.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is not UTF-8. Messages have the line behind the file's name.
    #[error("not UTF-8, expected {expected}")]
    NotUtf8 {
        /// The line of the first byte that is wrong, from 1.
        line: usize,
        /// What was expected.
        expected: &'static str,
    },
    /// It is not a file, or too large.
    #[error("{0}")]
    Refused(String),
}

impl InputError {
    /// Whether there is no such file.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Io(error) if error.kind() == ErrorKind::NotFound)
    }

    /// The place of the problem in a file, as messages have it: the file, and the line if it is known.
    pub fn place(&self, file: &str) -> String {
        match self {
            Self::NotUtf8 { line, .. } => format!("{file}:{line}"),
            Self::Io(_) | Self::Refused(_) => file.to_owned(),
        }
    }
}

/// Opens a file whose content is read bit by bit, however long it is.
///
/// # Errors
/// It cannot be opened, or is a device, which may be endless.
pub fn open(path: &Path, expected: Expected, pipes: Pipes) -> Result<File, InputError> {
    // Before it is opened: that waits for who writes to a pipe, and may do something at a device.
    check(&fs::metadata(path)?, expected, pipes)?;
    let file = File::open(path)?;
    // It may be another one by now.
    check(&file.metadata()?, expected, pipes)?;
    Ok(file)
}

/// The text of a file.
///
/// # Errors
/// It cannot be read, is a device or larger than expected, or is not UTF-8.
pub fn text(path: &Path, expected: Expected, pipes: Pipes) -> Result<String, InputError> {
    let file = open(path, expected, pipes)?;
    if file.metadata()?.len() > expected.longest {
        return Err(too_long(expected));
    }
    text_of(file, expected)
}

/// The text that a source gives until its end.
///
/// # Errors
/// It cannot be read, is larger than expected, or is not UTF-8.
pub fn text_of(source: impl Read, expected: Expected) -> Result<String, InputError> {
    let mut bytes = Vec::new();
    source.take(expected.longest + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > expected.longest {
        return Err(too_long(expected));
    }
    String::from_utf8(bytes).map_err(|error| {
        let place = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..place].iter().filter(|&&byte| byte == b'\n').count() + 1;
        InputError::NotUtf8 { line, expected: expected.what }
    })
}

/// A source of which no more than expected can be read: beyond, reading fails.
pub fn bounded<R: Read>(source: R, expected: Expected) -> impl Read + use<R> {
    struct Bounded<R>(io::Take<R>, Expected);
    impl<R: Read> Read for Bounded<R> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.0.read(buffer)?;
            match count == 0 && self.0.limit() == 0 && !buffer.is_empty() {
                true => Err(io::Error::other(too_long(self.1).to_string())),
                false => Ok(count),
            }
        }
    }
    Bounded(source.take(expected.longest + 1), expected)
}

/// Whether two names are of one file: through links of either kind, folders and `..`, in capitals or not where the system
/// does not tell them apart. Names of no file are never.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    if let (Ok(a), Ok(b)) = (fs::metadata(a), fs::metadata(b)) {
        use std::os::unix::fs::MetadataExt;
        return (a.dev(), a.ino()) == (b.dev(), b.ino());
    }
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

fn too_long(expected: Expected) -> InputError {
    InputError::Refused(format!(
        "more than {} MiB, expected {}",
        expected.longest >> 20,
        expected.what
    ))
}

fn check(found: &Metadata, expected: Expected, pipes: Pipes) -> Result<(), InputError> {
    let kind = found.file_type();
    // The system says itself that a folder is none to be read.
    let what = match special(kind) {
        Some("a pipe") if pipes == Pipes::Read => return Ok(()),
        Some(what) => what,
        None => return Ok(()),
    };
    Err(InputError::Refused(format!("{what}, expected {}", expected.limit())))
}

/// What a file is that is neither one nor a folder.
#[cfg(unix)]
fn special(kind: FileType) -> Option<&'static str> {
    use std::os::unix::fs::FileTypeExt;
    if kind.is_fifo() {
        Some("a pipe")
    } else if kind.is_char_device() || kind.is_block_device() {
        Some("a device")
    } else if kind.is_socket() {
        Some("a socket")
    } else {
        None
    }
}

#[cfg(not(unix))]
fn special(_: FileType) -> Option<&'static str> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: Expected = Expected { what: "a short text", longest: 1 << 20 };

    fn of(path: &str, pipes: Pipes) -> String {
        text(Path::new(path), SHORT, pipes).expect_err(path).to_string()
    }

    #[test]
    #[cfg(unix)]
    fn devices_folders_and_large_files_are_refused() {
        let device = "a device, expected a short text of at most 1 MiB";
        for path in ["/dev/zero", "/dev/null", "/dev/full"] {
            assert_eq!(of(path, Pipes::Read), device);
        }
        assert!(text(Path::new("/"), SHORT, Pipes::Read).is_err());
        let folder = tempfile::tempdir().unwrap();
        let large = folder.path().join("large");
        // With holes: nothing of it is on the disk, and nothing is read.
        File::create(&large).unwrap().set_len(1 << 40).unwrap();
        assert_eq!(
            of(large.to_str().unwrap(), Pipes::Read),
            "more than 1 MiB, expected a short text"
        );
    }

    #[test]
    fn an_endless_source_ends_at_the_limit() {
        let error = text_of(io::repeat(b'x'), SHORT).unwrap_err();
        assert_eq!(error.to_string(), "more than 1 MiB, expected a short text");
        let mut rest = Vec::new();
        let error = bounded(io::repeat(b'x'), SHORT).read_to_end(&mut rest).unwrap_err();
        assert_eq!(error.to_string(), "more than 1 MiB, expected a short text");
        let whole = vec![b'x'; 1 << 20];
        assert_eq!(text_of(&*whole, SHORT).unwrap().len(), 1 << 20);
        assert_eq!(bounded(&*whole, SHORT).read_to_end(&mut rest).unwrap(), 1 << 20);
    }

    #[test]
    fn the_line_that_is_not_text_is_named() {
        let error = text_of(&b"a\nb\n\xff"[..], SHORT).unwrap_err();
        assert_eq!(error.place("f.toml"), "f.toml:3");
    }
}
