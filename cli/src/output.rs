//! The doors to the terminal: results on standard output, and notes on standard error. Text of others never reaches a
//! terminal but through one of them, which makes visible what it would obey.

use crate::args::{Format, Output};
use crate::failure::{Failure, MessageKind, talk};
use opm_core::text::{is_unseen, visible};
use serde::Serialize;
use serde_json::ser::{CharEscape, CompactFormatter, Formatter, Serializer};
use serde_json::{Map, Value};
use std::fmt::Display;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

impl Output {
    /// The same without progress, notes and warnings: those of every run would hide a table of runs.
    pub fn silent(&self) -> Self {
        Self { quiet: true, ..*self }
    }

    /// Prints a result in the selected format.
    pub fn print(&self, json: &impl Serialize, text: impl Display) -> Result<(), Failure> {
        let write = |out: &mut dyn Write| match self.format {
            Format::Json => {
                json.serialize(&mut Serializer::with_formatter(&mut *out, Seen))?;
                writeln!(out)
            }
            Format::Text => out.write_all(escaped(&text.to_string()).as_bytes()),
        };
        match self.silent {
            true => write(&mut io::sink()).map_err(Failure::stdout),
            false => print_with(|out| write(out)),
        }
    }

    /// Prints a note on standard error, unless --quiet is given.
    pub fn note(&self, message: impl Display) {
        if !self.quiet {
            talk(MessageKind::Note, &message.to_string());
        }
    }

    /// As [`Output::note`], for a warning that the result may be useless.
    pub fn warn(&self, message: impl Display) {
        if !self.quiet {
            talk(MessageKind::Warning, &message.to_string());
        }
    }
}

/// A path in a message: on one line, and visible.
pub trait Shown {
    /// The path as a message shows it.
    fn shown(&self) -> String;
}

impl Shown for Path {
    fn shown(&self) -> String {
        visible(&self.display().to_string()).into_owned()
    }
}

/// Whether a name stands for standard output.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-") || path == Path::new("/dev/stdout")
}

/// Writes to standard output to the last byte.
pub fn print_with(
    write: impl FnOnce(&mut BufWriter<Stdout>) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut out = BufWriter::new(stdout());
    write(&mut out).and_then(|()| out.flush()).map_err(Failure::stdout)
}

/// Whether standard output was closed when the program began.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Finds out whether standard output is closed. The runtime opens `/dev/null` in its place before the program's first line,
/// so this has to be asked before that.
#[cfg(unix)]
pub fn look_at_stdout() {
    use std::os::fd::AsFd;
    if io::stdout().as_fd().try_clone_to_owned().is_err() {
        CLOSED.store(true, Ordering::Relaxed);
    }
}

/// Elsewhere a closed standard output cannot be told from one that nobody reads.
#[cfg(not(unix))]
pub fn look_at_stdout() {}

/// Fails if standard output is closed.
pub fn open() -> io::Result<()> {
    match CLOSED.load(Ordering::Relaxed) {
        true => Err(io::Error::other("it is closed, so that the result is lost")),
        false => Ok(()),
    }
}

/// Standard output. A terminal gets what it would obey as visible text; a pipe or a file gets every byte as it is.
pub fn stdout() -> Stdout {
    let inner = io::stdout();
    Stdout { escapes: inner.is_terminal(), inner, begun: Vec::new() }
}

/// See [`stdout`].
pub struct Stdout {
    inner: io::Stdout,
    escapes: bool,
    /// The first bytes of a character whose others are still to come.
    begun: Vec<u8>,
}

impl Write for Stdout {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        open()?;
        if !self.escapes {
            return self.inner.write(bytes);
        }
        self.begun.extend_from_slice(bytes);
        let text = std::mem::take(&mut self.begun);
        for chunk in text.utf8_chunks() {
            self.inner.write_all(escaped(chunk.valid()).as_bytes())?;
            let invalid = chunk.invalid();
            let is_last = std::ptr::eq(invalid.as_ptr_range().end, text.as_ptr_range().end);
            let is_begun = std::str::from_utf8(invalid).is_err_and(|e| e.error_len().is_none());
            match is_last && is_begun {
                true => self.begun = invalid.to_owned(),
                false => {
                    invalid.iter().try_for_each(|_| self.inner.write_all("\u{fffd}".as_bytes()))?;
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Text for people, or a part of a file or a table for a terminal: lines and tabs stay.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let is_end = c == '\r' && characters.peek() == Some(&'\n');
        match is_unseen(c) && !matches!(c, '\n' | '\t') && !is_end {
            true => out.extend(c.escape_unicode()),
            false => out.push(c),
        }
    }
    out
}

/// JSON in which every character is to be seen: the same values, whoever reads it.
struct Seen;

impl Formatter for Seen {
    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        out: &mut W,
        text: &str,
    ) -> io::Result<()> {
        let mut rest = text;
        while let Some((at, c)) = rest.char_indices().find(|&(_, c)| is_unseen(c)) {
            out.write_all(&rest.as_bytes()[..at])?;
            for unit in c.encode_utf16(&mut [0; 2]) {
                write!(out, "\\u{unit:04x}")?;
            }
            rest = &rest[at + c.len_utf8()..];
        }
        out.write_all(rest.as_bytes())
    }

    fn write_char_escape<W: ?Sized + Write>(
        &mut self,
        out: &mut W,
        escape: CharEscape,
    ) -> io::Result<()> {
        CompactFormatter.write_char_escape(out, escape)
    }
}

/// Named numbers as a JSON object, in their order.
pub fn named<'a>(numbers: impl IntoIterator<Item = (&'a str, f64)>) -> Map<String, Value> {
    numbers.into_iter().map(|(name, value)| (name.to_owned(), value.into())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_is_seen_and_the_same() {
        let hostile = "a\u{1b}[2J\u{9b}\u{202e}\u{fffe}\u{e0041}\n\"ä";
        let mut written = Vec::new();
        hostile.serialize(&mut Serializer::with_formatter(&mut written, Seen)).unwrap();
        let text = String::from_utf8(written).unwrap();
        assert!(!text.contains(is_unseen), "{text}");
        assert_eq!(serde_json::from_str::<String>(&text).unwrap(), hostile);
    }

    #[test]
    fn a_terminal_gets_nothing_to_obey() {
        assert_eq!(escaped("x,\u{1b}[2J\r\ny\rz\n\tä"), "x,\\u{1b}[2J\r\ny\\u{d}z\n\tä");
    }
}
