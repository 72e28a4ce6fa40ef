//! How far a leg is from a serial singularity. The other legs may be out of reach.

use crate::manipulator::{Manipulator, Section, Solution};

impl Manipulator {
    /// The smaller of the serial measures of a leg's two sections, without its sign, and that section; of a leg that is
    /// solved whole, its measure. The leg must be in reach.
    pub(crate) fn serial(&self, at: &Solution, leg: usize) -> (f64, Option<Section>) {
        if self.is_whole() {
            return (self.whole_measure(at, leg).abs(), None);
        }
        let differential = self.leg_differential(at, leg);
        let [lower, upper] = [&differential.lower, &differential.upper].map(|d| d.measure.abs());
        if lower <= upper { (lower, Some(Section::Lower)) } else { (upper, Some(Section::Upper)) }
    }
}
