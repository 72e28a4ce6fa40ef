//! Times of a table: as they are, or counted from the first one.

use crate::mechanism::file::LARGEST;
use crate::table::hint;
use crate::text::quoted;

/// Seconds since 1970 have not come so far yet; milliseconds have.
const MILLISECONDS: f64 = 1e11;

/// The times of a table.
pub(super) struct Clock<'a> {
    /// Whether they count from the first one.
    relative: bool,
    /// How that is asked for.
    advice: &'a str,
    first: Option<Moment>,
}

/// A number as a whole one and the rest. Of seconds since 1970 a float holds no more than six or seven decimals.
#[derive(Clone, Copy)]
struct Moment {
    whole: i64,
    rest: f64,
}

impl Moment {
    /// The number in a text, whose value is the same.
    fn new(text: &str, value: f64) -> Self {
        let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
        let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if digits(whole)
            && digits(decimals)
            && let (Ok(whole), Ok(rest)) = (whole.parse(), format!("0.{decimals}0").parse())
        {
            return Self { whole, rest };
        }
        Self { whole: value.floor() as i64, rest: value - value.floor() }
    }

    /// Seconds since another moment.
    fn since(self, first: Self) -> f64 {
        self.whole.saturating_sub(first.whole) as f64 + (self.rest - first.rest)
    }
}

impl<'a> Clock<'a> {
    pub fn new(relative: bool, advice: &'a str) -> Self {
        Self { relative, advice, first: None }
    }

    /// The time in a cell, in seconds.
    pub fn seconds(&mut self, cell: &str, value: f64) -> Result<f64, String> {
        let mut time = value;
        if self.relative && value.abs() < MILLISECONDS {
            let moment = Moment::new(cell, value);
            time = moment.since(*self.first.get_or_insert(moment));
        }
        if time.abs() <= LARGEST {
            return Ok(time);
        }
        let (text, expected) = (quoted(cell), "expected seconds, of at most 1e9");
        if !value.is_finite() {
            return Err(format!("{text}, {expected}{}", hint(cell)));
        }
        if value.abs() >= MILLISECONDS {
            let problem = "looks like milliseconds, or finer, since 1970";
            return Err(format!("t is {text}, which {problem}; {expected}: divide the times"));
        }
        let advice = match self.advice {
            "" => "subtract the first time from all".to_owned(),
            advice => format!("{advice} counts them from the first row"),
        };
        Err(format!("t is {text}, which looks like seconds since 1970; {expected}: {advice}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(relative: bool, cells: &[&str]) -> Vec<Result<f64, String>> {
        let mut clock = Clock::new(relative, "--relative-time");
        cells.iter().map(|cell| clock.seconds(cell, cell.parse().unwrap())).collect()
    }

    /// Nanoseconds of a clock that counts from 1970 are kept: a float of the whole number has steps of 240 of them.
    #[test]
    fn times_since_1970_keep_their_nanoseconds() {
        let cells = ["1700000000.000000001", "1700000000.001000002", "1700000001.5", "1700000002"];
        let expected = [0.0, 0.001_000_001, 1.499_999_999, 1.999_999_999];
        for (found, expected) in read(true, &cells).into_iter().zip(expected) {
            assert!((found.unwrap() - expected).abs() < 1e-15);
        }
        let others = read(true, &["-2.5", "1e1", "+12.25"]);
        assert_eq!(others, [Ok(0.0), Ok(12.5), Ok(14.75)]);
        assert_eq!(read(false, &["-2.5", "1e1"]), [Ok(-2.5), Ok(10.0)]);
    }

    #[test]
    fn times_of_other_clocks_are_told_what_they_are() {
        let of = |relative, cell| read(relative, &[cell]).remove(0).unwrap_err();
        let seconds = of(false, "1700000000.0");
        assert!(seconds.contains("seconds since 1970"), "{seconds}");
        assert!(seconds.ends_with("--relative-time counts them from the first row"), "{seconds}");
        for relative in [false, true] {
            assert!(of(relative, "1700000000000").contains("milliseconds, or finer, since 1970"));
        }
        let apart = read(true, &["0", "2e9"]);
        assert!(apart[1].as_ref().is_err_and(|e| e.contains("at most 1e9")), "{apart:?}");
    }
}
