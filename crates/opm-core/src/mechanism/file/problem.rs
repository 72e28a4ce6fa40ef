//! What is wrong with a file, and where.

use crate::mechanism::TaskKey;
use std::fmt;

/// One problem of a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// Line, from 1.
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

/// Every problem of a file, in the order of their places; at least one.
///
/// Displayed one a line, `LINE:COLUMN: message`; [`FileErrors::in_file`] puts the file's name first.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", lines(.problems, ""))]
pub struct FileErrors {
    /// The problems, sorted by place.
    pub problems: Vec<Problem>,
}

impl FileErrors {
    /// One line a problem, `FILE:LINE:COLUMN: message`.
    pub fn in_file(&self, file: impl fmt::Display) -> String {
        lines(&self.problems, &format!("{file}:"))
    }
}

fn lines(problems: &[Problem], prefix: &str) -> String {
    problems.iter().map(|p| format!("{prefix}{p}")).collect::<Vec<_>>().join("\n")
}

/// A line and a column in characters, both from 1.
pub type Place = (usize, usize);

/// Where a file that lists joints says what may turn out not to fit together; as [`Place`]s, or as
/// byte offsets while it is read. Families have their own checks: of them nothing is noted.
#[derive(Clone, Debug, PartialEq)]
pub struct Places<T = Place> {
    /// Each leg, in order.
    pub legs: Vec<T>,
    /// What `[task]` gives.
    pub task: Vec<(TaskKey, T)>,
}

impl<T> Default for Places<T> {
    fn default() -> Self {
        Self { legs: Vec::new(), task: Vec::new() }
    }
}

impl<T: Copy> Places<T> {
    /// The place of a value in `[task]`, if the file gives it.
    pub fn of_task(&self, key: TaskKey) -> Option<T> {
        self.task.iter().find(|(known, _)| *known == key).map(|&(_, place)| place)
    }
}

impl Places<usize> {
    pub(super) fn in_text(&self, text: &str) -> Places {
        let lines = Lines::new(text);
        Places {
            legs: self.legs.iter().map(|&at| lines.place(at)).collect(),
            task: self.task.iter().map(|&(key, at)| (key, lines.place(at))).collect(),
        }
    }
}

/// Where the lines of a text start, to name the place of a byte offset.
pub(super) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let after_newlines = text.match_indices('\n').map(|(newline, _)| newline + 1);
        Self { text, starts: std::iter::once(0).chain(after_newlines).collect() }
    }

    /// Line and column, both from 1, of a byte offset.
    pub(super) fn place(&self, offset: usize) -> Place {
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
    fn places_count_lines_and_characters_from_one() {
        let text = "ab\nñé = 1\n";
        let lines = Lines::new(text);
        assert_eq!(lines.place(0), (1, 1));
        assert_eq!(lines.place(3), (2, 1));
        assert_eq!(lines.place(text.find('=').unwrap()), (2, 4));
        assert_eq!(lines.place(text.len()), (3, 1));
        assert_eq!(lines.place(text.len() + 7), (3, 1), "past the end is the end");
        assert_eq!(lines.place(4), (2, 1), "inside a character is that character");
        assert_eq!(Lines::new("").place(0), (1, 1));
    }

    #[test]
    fn problems_are_lines_with_the_name_of_the_file() {
        let problem = |line, message: &str| Problem { line, column: 4, message: message.into() };
        let errors = FileErrors { problems: vec![problem(1, "one"), problem(12, "two")] };
        assert_eq!(errors.to_string(), "1:4: one\n12:4: two");
        assert_eq!(errors.in_file("a.toml"), "a.toml:1:4: one\na.toml:12:4: two");
    }
}
