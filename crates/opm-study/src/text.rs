//! Numbers and errors as text.

use std::error::Error;
use std::fmt::{Display, Write};

/// A whole number, with digits in groups of three.
pub fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// An error and its causes, on one line.
pub fn chain(error: &(dyn Error + '_)) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let _ = write!(text, ": {cause}");
        source = cause.source();
    }
    text
}

/// An error with the place where it happened, for instance a file. If the error names the place itself, it
/// is not repeated.
pub fn located(place: impl Display, error: &(dyn Error + '_)) -> String {
    let (place, text) = (place.to_string(), chain(error));
    if text.split([' ', ':']).any(|word| word == place) {
        return text;
    }
    format!("{place}: {text}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_in_groups() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(9_600_001), "9,600,001");
    }
}
