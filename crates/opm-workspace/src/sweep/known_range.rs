//! The displacements of imaginary joints that were found before: one between two of them widens no range, so
//! that its angle need not be computed.

use nalgebra::Complex;
use opm_core::reach::LegBranch;

/// How far inside a range a direction has to lie, radians: far more than an angle is rounded.
const MARGIN: f64 = 1e-12;

/// The widest range for which directions tell what lies inside: less than half a turn, radians.
const WIDEST: f64 = 3.0;

/// The least and the largest angle of each leg's imaginary joint, as far as they were found.
#[derive(Clone, Debug)]
pub struct KnownRanges(Vec<Option<KnownRange>>);

#[derive(Clone, Copy, Debug)]
struct KnownRange {
    angles: [f64; 2],
    directions: [Complex<f64>; 2],
}

impl KnownRanges {
    /// No angle is known yet of any of so many legs.
    pub fn new(legs: usize) -> Self {
        Self(vec![None; legs])
    }

    /// Whether the angle of a leg branch lies between known ones. If not, the leg's range is widened to it.
    pub fn contain_or_widen(&mut self, branch: &LegBranch) -> bool {
        let (Some(direction), Some(known)) = (branch.direction(), self.0.get_mut(branch.leg()))
        else {
            return false;
        };
        if known.is_some_and(|known| known.contains(direction)) {
            return true;
        }
        let Some(angle) = branch.intersection_displacement() else { return false };
        let here = KnownRange { angles: [angle; 2], directions: [direction; 2] };
        let KnownRange { angles: [least, most], directions } = known.get_or_insert(here);
        if angle < *least {
            (*least, directions[0]) = (angle, direction);
        }
        if angle > *most {
            (*most, directions[1]) = (angle, direction);
        }
        false
    }
}

impl KnownRange {
    fn contains(&self, direction: Complex<f64>) -> bool {
        let [least, most] = self.directions;
        // In a range of less than half a turn, what is to the left of its start and to the right of its
        // end is inside.
        let left = |a: Complex<f64>, b: Complex<f64>| {
            a.re * b.im - a.im * b.re > MARGIN * a.l1_norm() * b.l1_norm()
        };
        self.angles[1] - self.angles[0] < WIDEST && left(least, direction) && left(direction, most)
    }
}
