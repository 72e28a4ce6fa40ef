//! Numbers, legs out of reach, distances of bodies and errors as text.

use opm_core::Quantity;
use opm_core::manipulator::Unreachable;
use opm_core::mechanism::file::FileUnits;
use opm_interference::{Interference, Nearest};
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
    let (part, gap) = (unreachable.part(), unreachable.deficit);
    if gap.excess.is_finite() {
        format!("{part} out of reach by {}", units.show(gap.excess, gap.quantity))
    } else {
        format!("{part} out of reach")
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

/// The nearest pair of bodies in words.
pub fn nearest_text(
    interference: &Interference,
    nearest: Option<Nearest>,
    units: FileUnits,
) -> String {
    let Some(Nearest { pair, distance }) = nearest else {
        return "no two bodies that could interfere".to_owned();
    };
    let [one, other] = interference.names_of(pair);
    let what = if distance < 0.0 { "interference" } else { "nearest" };
    format!("{what}: {one} and {other}, {}", length_text(distance, units))
}

/// A signed distance in words: `3 mm apart`, `overlapping by 2 mm`.
pub fn length_text(distance: f64, units: FileUnits) -> String {
    let length = units.show(distance.abs(), Quantity::Length);
    match distance < 0.0 {
        true => format!("overlapping by {length}"),
        false => format!("{length} apart"),
    }
}

/// The number of pairs that overlap at home that are named in a text.
const MOST_NAMED: usize = 6;

/// The pairs that are not tested because they overlap at home, the first ones by name; `None` without such pairs.
pub fn set_aside_text(interference: &Interference, units: FileUnits) -> Option<String> {
    let pairs = interference.set_aside_pairs();
    let each = pairs.iter().take(MOST_NAMED).map(|pair| {
        let [one, other] = &pair.names;
        format!("{one} and {other} by {}", units.show(pair.overlap, Quantity::Length))
    });
    let each: Vec<String> = each.collect();
    let more = match pairs.len() - each.len() {
        0 => String::new(),
        1 => "; and 1 more pair".to_owned(),
        more => format!("; and {more} more pairs"),
    };
    let named = || format!("not tested, because they overlap at home: {}{more}", each.join("; "));
    (!pairs.is_empty()).then(named)
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
