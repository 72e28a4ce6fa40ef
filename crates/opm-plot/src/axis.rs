//! Axes: ranges that show what matters, and ticks at round numbers.

use crate::font::Face;

/// The steps between ticks: which numbers count as round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// One, two and five times a power of ten.
    Decimal,
    /// As decimal up to ten, then 15, 30, 45, 90, 180, and multiples of 360.
    Degrees,
}

/// The unit of the values along an axis.
///
/// ```
/// use opm_plot::{Steps, Unit};
///
/// let degrees = Unit { symbol: "deg".into(), steps: Steps::Degrees, resolution: 1e-6 };
/// # let _ = degrees;
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The symbol, for instance `mm`; empty for a pure number.
    pub symbol: String,
    /// The steps between ticks that suit it.
    pub steps: Steps,
    /// Values that differ by less than this are drawn as equal: the difference is noise.
    pub resolution: f64,
}

impl Unit {
    /// The unit of a pure number, with decimal steps and a resolution of 1e-12.
    pub fn none() -> Self {
        Self { symbol: String::new(), steps: Steps::Decimal, resolution: 1e-12 }
    }
}

/// A tick of an axis with its number.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The value at the tick.
    pub value: f64,
    /// The text at the tick; empty for the smaller ticks of a logarithmic axis.
    pub label: String,
}

/// The range of an axis, and its ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The values at the two ends, ascending.
    pub range: [f64; 2],
    /// The ticks, in ascending order.
    pub ticks: Vec<Tick>,
    /// The power of ten that labels are divided by.
    exponent: i32,
    logarithmic: bool,
}

/// The share of a range that is added on both sides, so that curves do not touch the frame.
const MARGIN: f64 = 0.06;
/// Values that differ by less than this share of their size are equal: it is double precision after some
/// arithmetic.
const RELATIVE_NOISE: f64 = 1e-9;
/// Beyond these numbers labels would be long.
const LONG_ABOVE: f64 = 1e5;
const LONG_BELOW: f64 = 1e-3;

/// The range of an axis that shows values from `values[0]` to `values[1]`, with a margin; without values it is
/// `[0, 1]`. For a single value, or noise about one, the range is so wide that the curve looks level.
pub fn around(values: Option<[f64; 2]>, unit: &Unit) -> [f64; 2] {
    let Some([low, high]) = values else { return [0.0, 1.0] };
    let largest = low.abs().max(high.abs());
    if high - low <= unit.resolution.max(RELATIVE_NOISE * largest) {
        let middle = 0.5 * (low + high);
        let middle = if middle.abs() <= unit.resolution { 0.0 } else { middle };
        let about = if middle == 0.0 { 1.0 } else { 0.1 * middle.abs() };
        return [middle - about, middle + about];
    }
    let margin = MARGIN * (high - low);
    [low - margin, high + margin]
}

impl Axis {
    /// A linear axis over a range, with `most` ticks at most. There are fewer if `fits` rejects them: it gets
    /// the ticks, and the distance between them as a share of the axis.
    pub fn linear(
        range: [f64; 2],
        steps: Steps,
        most: usize,
        fits: impl Fn(&[Tick], f64) -> bool,
    ) -> Self {
        let [low, high] = range;
        let span = high - low;
        let exponent = exponent(low.abs().max(high.abs()));
        // `most + 1` steps have at most one tick more than the axis may have.
        let mut step = first_step(span / (most.max(1) + 1) as f64, steps);
        loop {
            let ticks = ticks(range, step, exponent);
            if ticks.len() < 2 || ticks.len() <= most && fits(&ticks, step / span) {
                return Self { range, ticks, exponent, logarithmic: false };
            }
            step = next_step(step, steps);
        }
    }

    /// A logarithmic axis over positive values, with about `most` labels at most. Ticks are at powers of ten,
    /// and at two and five times these if there are few of them.
    pub fn logarithmic(values: [f64; 2], most: usize) -> Self {
        let [low, high] = values.map(f64::log10);
        let margin = (MARGIN * (high - low)).max(0.02);
        let range = [10_f64.powf(low - margin), 10_f64.powf(high + margin)];
        let decades = range[0].log10().floor() as i32..=range[1].log10().ceil() as i32;
        let inside = |value: f64| value >= range[0] && value <= range[1];
        let powers = decades.clone().filter(|&k| inside(10_f64.powi(k))).count();
        let every = powers.div_ceil(most.max(2)).max(1) as i32;
        let mut ticks = Vec::new();
        for k in decades {
            for digit in [1.0, 2.0, 5.0] {
                let value = digit * 10_f64.powi(k);
                let named = digit == 1.0 && k.rem_euclid(every) == 0 || powers < 2;
                if inside(value) && (digit == 1.0 || powers <= 3) {
                    let label = if named { power_label(digit, k) } else { String::new() };
                    ticks.push(Tick { value, label });
                }
            }
        }
        Self { range, ticks, exponent: 0, logarithmic: true }
    }

    /// The place of a value along the axis: 0 at its start, 1 at its end.
    pub fn share(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if self.logarithmic {
            (value / low).log10() / (high / low).log10()
        } else {
            (value - low) / (high - low)
        }
    }

    /// Whether a value has a place on the axis: it is finite, and positive on a logarithmic axis.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }

    /// The title of the axis: a name, and the unit that the labels are in.
    pub fn title(&self, name: &str, unit: &Unit) -> String {
        let power = match self.exponent {
            0 => String::new(),
            e => format!("10{}", superscript(e)),
        };
        match (power.is_empty(), unit.symbol.is_empty()) {
            (true, true) => name.to_owned(),
            (true, false) => format!("{name} ({})", unit.symbol),
            (false, true) => format!("{name} ({power})"),
            (false, false) => format!("{name} ({power} {})", unit.symbol),
        }
    }

    /// The width of the widest label, in pixels.
    pub fn label_width(&self, face: Face, size: f64) -> f64 {
        self.ticks.iter().map(|tick| face.width(&tick.label, size)).fold(0.0, f64::max)
    }
}

/// The power of ten, a multiple of three, that labels of numbers up to `largest` are in.
fn exponent(largest: f64) -> i32 {
    if largest > 0.0 && !(LONG_BELOW..LONG_ABOVE).contains(&largest) {
        (largest.log10() / 3.0).floor() as i32 * 3
    } else {
        0
    }
}

/// The steps from ten on that suit degrees.
const ANGLES: [f64; 6] = [10.0, 15.0, 30.0, 45.0, 90.0, 180.0];

/// The smallest round step of at least this size.
fn first_step(size: f64, steps: Steps) -> f64 {
    let decimal = |size: f64| {
        let power = 10_f64.powf(size.log10().floor());
        // A step that is smaller by rounding alone will do.
        let found = [1.0, 2.0, 5.0].map(|digit| digit * power);
        found.into_iter().find(|&step| step >= size * (1.0 - 1e-9)).unwrap_or(10.0 * power)
    };
    if steps == Steps::Decimal || size <= 5.0 {
        return decimal(size);
    }
    let angle = ANGLES.into_iter().find(|&step| step >= size);
    angle.unwrap_or_else(|| 360.0 * decimal(size / 360.0).max(1.0))
}

fn next_step(step: f64, steps: Steps) -> f64 {
    first_step(step * 1.01, steps)
}

fn ticks([low, high]: [f64; 2], step: f64, exponent: i32) -> Vec<Tick> {
    // A tick that is at an end up to rounding is on the axis.
    let slack = 1e-9;
    let first = (low / step - slack).ceil();
    let last = (high / step + slack).floor();
    let scale = 10_f64.powi(exponent);
    let decimals = (-(step / scale).log10().floor()).max(0.0) as usize;
    let mut found = Vec::new();
    let mut number = first;
    // On an axis so narrow that doubles cannot tell its values apart, counting would not end.
    while number <= last && found.len() < 1000 {
        let value = number * step;
        found.push(Tick { value, label: label(value / scale, decimals) });
        number += 1.0;
    }
    found
}

/// The text of a number with so many decimals: with a typographic minus sign, and without negative zeros.
pub fn label(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

fn power_label(digit: f64, power: i32) -> String {
    match power {
        -3..=4 => label(digit * 10_f64.powi(power), (-power).max(0) as usize),
        _ if digit == 1.0 => format!("10{}", superscript(power)),
        _ => format!("{digit}·10{}", superscript(power)),
    }
}

fn superscript(number: i32) -> String {
    let sign = |c| match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32(digit as u32 - '4' as u32 + '⁴' as u32).unwrap_or(digit),
    };
    number.to_string().chars().map(sign).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MM: fn() -> Unit =
        || Unit { symbol: "mm".into(), steps: Steps::Decimal, resolution: 1e-6 };

    fn labels(range: [f64; 2], steps: Steps, most: usize) -> Vec<String> {
        let axis = Axis::linear(range, steps, most, |_, _| true);
        axis.ticks.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels([-210.0, 210.0], Steps::Decimal, 5), ["−200", "−100", "0", "100", "200"]);
        assert_eq!(labels([0.0, 10.0], Steps::Decimal, 6), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels([-0.001, 0.0011], Steps::Decimal, 3), ["−0.001", "0.000", "0.001"]);
        assert_eq!(labels([0.0, 2.5e6], Steps::Decimal, 3), ["0", "1", "2"]);
    }

    #[test]
    fn angles_are_in_parts_of_a_turn() {
        assert_eq!(labels([-185.0, 185.0], Steps::Degrees, 5), ["−180", "−90", "0", "90", "180"]);
        assert_eq!(labels([0.0, 100.0], Steps::Degrees, 4), ["0", "30", "60", "90"]);
        assert_eq!(labels([-70.0, 70.0], Steps::Degrees, 3), ["−45", "0", "45"]);
        assert_eq!(labels([0.0, 9.0], Steps::Degrees, 5), ["0", "2", "4", "6", "8"]);
        assert_eq!(labels([0.0, 600.0], Steps::Degrees, 4), ["0", "180", "360", "540"]);
        assert_eq!(labels([0.0, 2000.0], Steps::Degrees, 3), ["0", "720", "1440"]);
    }

    #[test]
    fn a_level_curve_is_drawn_level() {
        let mm = MM();
        assert_eq!(around(Some([1e-17, -1e-17].map(f64::abs)), &mm), [-1.0, 1.0]);
        let [low, high] = around(Some([200.0, 200.0 + 1e-10]), &mm);
        assert!(low < 185.0 && high > 215.0);
        let [low, high] = around(Some([0.0, 100.0]), &mm);
        assert_eq!([low, high], [-6.0, 106.0]);
        assert_eq!(around(None, &mm), [0.0, 1.0]);
    }

    #[test]
    fn a_title_tells_the_unit_and_the_power() {
        let axis = |range| Axis::linear(range, Steps::Decimal, 4, |_, _| true);
        assert_eq!(axis([0.0, 10.0]).title("length", &MM()), "length (mm)");
        assert_eq!(axis([0.0, 2e7]).title("length", &MM()), "length (10⁶ mm)");
        assert_eq!(axis([0.0, 2e-7]).title("n", &Unit::none()), "n (10⁻⁹)");
    }

    #[test]
    fn logarithms_have_decades() {
        let labels = |values| -> Vec<String> {
            let ticks = Axis::logarithmic(values, 5).ticks.into_iter();
            ticks.map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
        };
        assert_eq!(labels([3.0, 4e4]), ["10", "100", "1000", "10000"]);
        assert_eq!(labels([1.9, 8.0]), ["2", "5"]);
        assert_eq!(labels([1.0, 1e9]), ["1", "100", "10000", "10⁶", "10⁸"]);
        let axis = Axis::logarithmic([1.0, 100.0], 5);
        assert!((axis.share(10.0) - 0.5).abs() < 1e-12);
        assert!(!axis.holds(0.0) && !axis.holds(f64::NAN));
    }
}
