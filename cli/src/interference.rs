//! What commands say about the distances of links.

use crate::failure::Failure;
use crate::pose::Number;
use crate::text;
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_interference::{Interference, Nearest};
use serde_json::{Value, json};

/// Number of pairs that overlap at home in text; JSON has all of them.
const MOST_SHOWN: usize = 6;

/// The nearest pair with its distance, metres; null without pairs.
pub fn nearest_json(interference: &Interference, nearest: Option<Nearest>) -> Value {
    nearest.map_or(Value::Null, |Nearest { pair, distance }| {
        json!({ "pair": interference.names_of(pair), "distance": distance })
    })
}

/// The pairs that are not tested, because they overlap at home.
pub fn set_aside_json(interference: &Interference) -> Value {
    let each = interference.set_aside_pairs().iter();
    each.map(|pair| json!({ "pair": pair.names, "overlap": pair.overlap })).collect()
}

/// The nearest pair in words.
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

/// The value of --clearance, metres.
pub fn clearance(given: Option<Number>) -> Result<Option<f64>, Failure> {
    let Some(number) = given else { return Ok(None) };
    let least = number.value_of("the clearance", Quantity::Length);
    let least = least.map_err(|error| Failure::flag("--clearance", error))?;
    match least >= 0.0 && least.is_finite() {
        true => Ok(Some(least)),
        false => {
            let problem = format!("{least} m, expected a length of 0 or more");
            Err(Failure::flag("--clearance", problem))
        }
    }
}

/// A line that names the pairs that are not tested, because they overlap at home; empty without such pairs.
pub fn set_aside_text(interference: &Interference, units: FileUnits) -> String {
    let pairs = interference.set_aside_pairs();
    if pairs.is_empty() {
        return String::new();
    }
    let each = pairs.iter().take(MOST_SHOWN).map(|pair| {
        let [one, other] = &pair.names;
        format!("{one} and {other} by {}", units.show(pair.overlap, Quantity::Length))
    });
    let each: Vec<String> = each.collect();
    let more = match pairs.len() - each.len() {
        0 => String::new(),
        more => format!("; and {} (JSON has all)", text::plural(more as u64, "more pair")),
    };
    format!("not tested, because they overlap at home: {}{more}\n", each.join("; "))
}
