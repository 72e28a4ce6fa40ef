//! The problems of a file, with their locations.

use crate::mechanism::TaskKey;
use std::fmt;

/// One problem of a file, with its location.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// Line number, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What was found and what was expected.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.line, self.column, self.message)
    }
}

/// A list of all problems of a file, in the order of their locations; at least one.
///
/// The text has one line per problem, `LINE:COLUMN: message`; [`FileErrors::in_file`] adds the
/// file's name in front.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", lines(.problems, ""))]
#[non_exhaustive]
pub struct FileErrors {
    /// The problems, sorted by location.
    pub problems: Vec<Problem>,
}

impl FileErrors {
    /// These problems, sorted by location.
    pub fn new(problems: Vec<Problem>) -> Self {
        Self { problems }
    }

    /// The text with one line per problem, `FILE:LINE:COLUMN: message`.
    pub fn in_file(&self, file: impl fmt::Display) -> String {
        lines(&self.problems, &format!("{file}:"))
    }
}

fn lines(problems: &[Problem], prefix: &str) -> String {
    problems.iter().map(|p| format!("{prefix}{p}")).collect::<Vec<_>>().join("\n")
}

/// A line and a column in characters, both from 1.
pub type Location = (usize, usize);

/// Locations, in a file that lists joints, of what may later turn out to be inconsistent: as
/// [`Location`]s, or as byte offsets during reading. Nothing is noted for families, which have
/// their own checks.
#[derive(Clone, Debug, PartialEq)]
pub struct Locations<T = Location> {
    /// The location of each leg, in order.
    pub legs: Vec<T>,
    /// The location of each value given in `[task]`.
    pub task: Vec<(TaskKey, T)>,
}

impl<T> Default for Locations<T> {
    fn default() -> Self {
        Self { legs: Vec::new(), task: Vec::new() }
    }
}

impl<T: Copy> Locations<T> {
    /// The location of a value in `[task]`, if the file gives it.
    pub fn of_task(&self, key: TaskKey) -> Option<T> {
        self.task.iter().find(|(known, _)| *known == key).map(|&(_, location)| location)
    }
}

impl Locations<usize> {
    pub(super) fn in_text(&self, text: &str) -> Locations {
        let lines = Lines::new(text);
        Locations {
            legs: self.legs.iter().map(|&at| lines.location(at)).collect(),
            task: self.task.iter().map(|&(key, at)| (key, lines.location(at))).collect(),
        }
    }
}

/// The line starts of a text, to convert byte offsets to locations.
pub(super) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let after_newlines = text.match_indices('\n').map(|(newline, _)| newline + 1);
        Self { text, starts: std::iter::once(0).chain(after_newlines).collect() }
    }

    /// Converts a byte offset to a line and a column, both from 1.
    pub(super) fn location(&self, offset: usize) -> Location {
        let mut end = offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let line = self.starts.partition_point(|&start| start <= end);
        (line, self.text[self.starts[line - 1]..end].chars().count() + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locations_count_lines_and_characters_from_one() {
        let text = "ab\nñé = 1\n";
        let lines = Lines::new(text);
        assert_eq!(lines.location(0), (1, 1));
        assert_eq!(lines.location(3), (2, 1));
        assert_eq!(lines.location(text.find('=').unwrap()), (2, 4));
        assert_eq!(lines.location(text.len()), (3, 1));
        assert_eq!(lines.location(text.len() + 7), (3, 1), "past the end is the end");
        assert_eq!(lines.location(4), (2, 1), "inside a character is that character");
        assert_eq!(Lines::new("").location(0), (1, 1));
    }

    #[test]
    fn problems_are_lines_with_the_name_of_the_file() {
        let problem = |line, message: &str| Problem { line, column: 4, message: message.into() };
        let errors = FileErrors { problems: vec![problem(1, "one"), problem(12, "two")] };
        assert_eq!(errors.to_string(), "1:4: one\n12:4: two");
        assert_eq!(errors.in_file("a.toml"), "a.toml:1:4: one\na.toml:12:4: two");
    }
}
