//! Numbers, legs out of reach and errors as text.

use opm_core::manipulator::Unreachable;
use opm_core::mechanism::file::FileUnits;
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

/// The section of the leg that does not close, and by how much.
pub fn reason(unreachable: &Unreachable, units: FileUnits) -> String {
    let (section, gap) = (unreachable.section, unreachable.deficit);
    if gap.excess.is_finite() {
        format!("{section} section out of reach by {}", units.show(gap.excess, gap.quantity))
    } else {
        format!("{section} section out of reach")
    }
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
