//! Errors in the print of the paper. Each printed formula is compared with plain geometry, which it
//! does not match, and so is the corrected one, which matches and which the crate computes.
//! docs/errata.md lists them.

mod orientations;
mod position;
mod printed;
mod sample;
mod translational;
mod velocity;

use nalgebra::Vector2;
use opm_tests::paper;
use std::f64::consts::TAU;

/// Tolerance for correct formulas: rounding, in metres and radians on lengths of a tenth of a
/// metre.
const ROUNDING: f64 = 1e-12;

/// The same for rates: differences of fourth order with steps of 1e-3, away from singularities.
const DIFFERENCED: f64 = 1e-7;

/// Wrong formulas miss by more than this: metres, square metres over a tenth of a metre, or
/// radians.
const MARGIN: f64 = 1e-4;

/// The share of random samples in which a wrong formula must miss. In the others it may be right by
/// accident, for instance if a slider or P is near zero.
const MOST: f64 = 0.9;

/// Collects how far a formula is from the geometry, over all samples.
#[derive(Default)]
struct Misses(Vec<f64>);

impl Misses {
    fn add(&mut self, miss: f64) {
        self.0.push(miss.abs());
    }

    #[track_caller]
    fn hold(&self, tolerance: f64) {
        let worst = self.0.iter().copied().fold(0.0, f64::max);
        // NaN is no match either.
        let all = self.0.iter().all(|&miss| miss < tolerance);
        assert!(self.0.len() > 500 && all, "off by {worst:e} at worst, or not a number");
    }

    #[track_caller]
    fn fail(&self) {
        // A formula that gives NaN misses as well.
        let missed = self.0.iter().filter(|miss| miss.is_nan() || **miss > MARGIN).count() as f64;
        let all = self.0.len() as f64;
        assert!(all > 500.0 && missed >= MOST * all, "{missed} of {all} samples are missed");
    }
}

fn e(t: f64) -> Vector2<f64> {
    paper::e(t).into()
}

fn n(t: f64) -> Vector2<f64> {
    paper::n(t).into()
}

/// The angle shifted to between -pi and pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
