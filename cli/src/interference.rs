//! What commands say about the distances of links.

use crate::args::Output;
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::Number;
use crate::unitless;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_interference::{Interference, Nearest};
use serde_json::{Value, json};

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

/// Notes a --clearance that looks misread.
pub fn note_clearance(output: &Output, given: Option<Number>, of: (&Loaded, &Manipulator)) {
    let value = given.map(|number| (number, Quantity::Length));
    unitless::note_values(output, "--clearance", of, value);
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
