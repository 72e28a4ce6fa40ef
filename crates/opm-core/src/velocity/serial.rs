//! How far a leg is from a serial singularity, whether or not the others reach.

use crate::manipulator::{Manipulator, Section, Solution};

impl Manipulator {
    /// Of a leg that reaches: the smaller of its two sections' measures, without its sign, and whose.
    pub(crate) fn serial(&self, at: &Solution, leg: usize) -> (f64, Section) {
        let differential = self.leg_differential(at, leg);
        let [lower, upper] = [&differential.lower, &differential.upper].map(|d| d.measure.abs());
        if lower <= upper { (lower, Section::Lower) } else { (upper, Section::Upper) }
    }
}
