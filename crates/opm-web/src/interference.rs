//! How far the bodies are from each other at a pose.

use crate::explorer::Explorer;
use crate::problem::Problems;
use opm_core::Quantity;
use opm_core::manipulator::Solution;
use opm_interference::Distances;
use opm_study::text::{nearest_text, set_aside_text};
use serde::Serialize;
use std::collections::BTreeSet;

/// The distances of bodies at a pose, in words, and what is too near.
#[derive(Serialize)]
pub struct Contacts {
    /// The bodies and obstacles that overlap another one, or are nearer to it than the clearance: see the `member` of solids.
    near: BTreeSet<String>,
    /// Whether two bodies overlap.
    overlap: bool,
    /// The nearest pair and its distance.
    nearest: String,
    /// The pairs that are not tested, because they overlap at home.
    set_aside: Option<String>,
}

/// The distances at a solution, with a clearance in the file's units.
pub fn contacts(
    explorer: &Explorer,
    solution: &Solution,
    clearance: Option<f64>,
) -> Result<Contacts, Problems> {
    let (interference, units) = (explorer.interference(), explorer.units());
    let clearance = clearance.unwrap_or(0.0);
    if !(clearance >= 0.0 && clearance.is_finite()) {
        let length = units.length.symbol();
        let problem = format!("the clearance is {clearance} {length}, expected 0 or more");
        return Err(Problems::one(problem));
    }
    let mut distances = Distances::new(interference);
    distances.place(explorer.manipulator(), solution);
    let nearest = distances.nearest();
    let near = distances.nearer_than(units.si(clearance, Quantity::Length));
    let near = near.flat_map(|near| interference.names_of(near.pair)).map(str::to_owned);
    Ok(Contacts {
        near: near.collect(),
        overlap: nearest.is_some_and(|nearest| nearest.distance < 0.0),
        nearest: nearest_text(interference, nearest, units),
        set_aside: set_aside_text(interference, units),
    })
}
