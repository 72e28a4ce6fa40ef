//! Numbers in pictures.

use crate::text::short;

/// A number with at most four digits, without trailing zeros, with a typographic minus sign.
pub fn value_label(value: f64) -> String {
    let text = short(value);
    let text = match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    text.replace('-', "−")
}
