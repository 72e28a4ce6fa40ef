//! Text of others in names and messages: what a reader or a terminal would take for a command is refused in names and made
//! visible in messages, and what is long is shortened. This module knows nothing of mechanisms.

use std::borrow::Cow;
use std::fmt::{self, Write as _};

/// The longest word of a message, in characters, that is shown whole; longer than nearly all paths.
const LONGEST_WORD: usize = 400;
/// The longest line of a message, in characters.
const LONGEST_LINE: usize = 4000;
/// The most lines of a message.
const MOST_LINES: usize = 200;
/// The number of characters of a text in quotes that a message shows.
const SHOWN: usize = 60;

/// Whether a character is none to be seen: a control character, one that turns the direction of what follows, a separator
/// of lines, or none of Unicode's. Terminals obey them, compilers refuse them in source code, XML cannot have them.
pub fn is_unseen(c: char) -> bool {
    let code = u32::from(c);
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
        || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
        || matches!(c, '\u{fdd0}'..='\u{fdef}')
        || code & 0xfffe == 0xfffe
}

/// The text with every such character as its number, `\u{1b}`.
pub fn visible(text: &str) -> Cow<'_, str> {
    seen(text, is_unseen)
}

/// As [`visible`], for a text of several lines.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    seen(text, |c| is_unseen(c) && c != '\n')
}

fn seen(text: &str, unseen: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&unseen) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match unseen(c) {
            true => out.extend(c.escape_unicode()),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// A text of others in a message: in quotes, visible, and shortened.
///
/// ```
/// # extern crate opm_geometry as opm_core;
/// use opm_core::text::quoted;
///
/// assert_eq!(quoted("a\u{1b}b").to_string(), r#""a\u{1b}b""#);
/// assert!(quoted(&"x".repeat(1000)).to_string().ends_with("x\"... (940 more characters)"));
/// ```
pub fn quoted(text: &str) -> impl fmt::Display + '_ {
    struct Quoted<'a>(&'a str);
    impl fmt::Display for Quoted<'_> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            let (start, more) = start(self.0, SHOWN);
            // Debugging escapes quotes, and most of what is unseen.
            f.write_str(&visible(&format!("{start:?}")))?;
            more_characters(f, more)
        }
    }
    Quoted(text)
}

/// A message for people: visible, its longest words, lines and lists shortened.
pub fn message(text: &str) -> Cow<'_, str> {
    let fits = |line: &str| {
        line.len() <= LONGEST_WORD
            || (line.len() <= LONGEST_LINE
                && line.split(' ').all(|word| word.len() <= LONGEST_WORD))
    };
    if text.lines().count() <= MOST_LINES && text.lines().all(fits) {
        return visible_lines(text);
    }
    let mut out = String::new();
    for (number, line) in text.lines().enumerate() {
        if number == MOST_LINES {
            let _ = write!(out, "\n  and {} more lines", text.lines().count() - MOST_LINES);
            break;
        }
        if number > 0 {
            out.push('\n');
        }
        let mut short = String::new();
        for (number, word) in line.split(' ').enumerate() {
            if number > 0 {
                short.push(' ');
            }
            if word.chars().nth(LONGEST_WORD).is_none() {
                short.push_str(word);
                continue;
            }
            // The quote and the comma behind a word are those of the message.
            let word_alone = word.trim_end_matches(['"', '\'', '`', ',', ';', ':', '.', ')']);
            let behind = word.get(word_alone.len()..).filter(|behind| behind.len() <= 4);
            let behind = behind.unwrap_or_default();
            let (start, more) = start(&word[..word.len() - behind.len()], SHOWN);
            short.push_str(start);
            let _ = more_characters(&mut short, more);
            short.push_str(behind);
        }
        let (start, more) = start(&short, LONGEST_LINE);
        out.push_str(&visible(start));
        let _ = more_characters(&mut out, more);
    }
    Cow::Owned(out)
}

/// A text of others in a cell of a table for people: on one line, visible, and shortened.
pub fn cell(text: &str) -> Cow<'_, str> {
    let (start, more) = start(text, LONGEST_WORD);
    let mut shown = visible(start);
    if more > 0 {
        let _ = more_characters(shown.to_mut(), more);
    }
    shown
}

/// The first characters of a text, and how many there are behind them.
fn start(text: &str, most: usize) -> (&str, usize) {
    match text.char_indices().nth(most) {
        Some((end, _)) => (&text[..end], text[end..].chars().count()),
        None => (text, 0),
    }
}

fn more_characters(out: &mut impl fmt::Write, more: usize) -> fmt::Result {
    match more {
        0 => Ok(()),
        1 => out.write_str("... (1 more character)"),
        more => write!(out, "... ({more} more characters)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unseen_is_shown_by_its_number() {
        assert_eq!(visible("leg\u{1b}[2J\u{202e}\u{fffe}\n"), r"leg\u{1b}[2J\u{202e}\u{fffe}\u{a}");
        assert_eq!(visible_lines("ä\n\u{9b}"), "ä\n\\u{9b}");
        assert!(matches!(visible("Bein 1, ζ, 脚, 🦿"), Cow::Borrowed(_)));
    }

    #[test]
    fn what_is_long_is_shortened() {
        let long = "x".repeat(1_000_000);
        assert_eq!(message("short\nlines"), "short\nlines");
        let said = message(&format!("a.csv:2: \"{long}\" is not a number")).into_owned();
        assert!(said.starts_with("a.csv:2: \"xxx") && said.ends_with("is not a number"), "{said}");
        assert!(said.contains("... (999941 more characters)\" is") && said.len() < 200, "{said}");
        let many = "a b ".repeat(100_000);
        assert!(message(&many).len() < 4100);
        assert!(message(&"line\n".repeat(100_000)).ends_with("\n  and 99800 more lines"));
        assert!(cell(&long).len() < 450 && quoted(&long).to_string().len() < 100);
    }
}
