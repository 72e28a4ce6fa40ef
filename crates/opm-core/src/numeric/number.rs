//! Numbers in messages.

/// From here on digits before the point are no longer counted at a glance.
const LARGE: f64 = 1e15;

/// A number as people write it: with an exponent where it would be a row of zeros.
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
