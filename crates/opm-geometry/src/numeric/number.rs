//! Formatting of numbers in messages.

/// From this size on, a number is written with an exponent.
const LARGE: f64 = 1e15;

/// Formats a number for a message, with an exponent if it would otherwise be a long row of digits.
pub fn readable(value: f64) -> String {
    if value.abs() < LARGE { value.to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_numbers_have_an_exponent() {
        let shown =
            [1.0, -0.25, 123_456_789.5, 1e15, -1e308, f64::INFINITY, f64::NAN].map(readable);
        assert_eq!(shown, ["1", "-0.25", "123456789.5", "1e15", "-1e308", "inf", "NaN"]);
    }
}
