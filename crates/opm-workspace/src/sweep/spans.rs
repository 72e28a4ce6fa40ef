//! Turns of imaginary joints that need no angle, since others on both sides of them were found before.

use nalgebra::Complex;
use opm_core::manipulator::Follow;

/// How far inside a span a turn has to be, far more than an angle is rounded.
const MARGIN: f64 = 1e-12;

/// The least and the largest turn of each leg.
#[derive(Clone, Debug)]
pub struct Spans(Vec<Option<Span>>);

#[derive(Clone, Copy, Debug)]
struct Span {
    angles: [f64; 2],
    directions: [Complex<f64>; 2],
}

impl Spans {
    /// Of no turns yet, of so many legs.
    pub fn new(legs: usize) -> Self {
        Self(vec![None; legs])
    }

    /// Whether the turn of a leg that follows in this way lies between others; if not, its span then
    /// reaches that far.
    pub fn hold(&mut self, way: &Follow) -> bool {
        let (Some(direction), Some(span)) = (way.direction(), self.0.get_mut(way.leg())) else {
            return false;
        };
        if span.is_some_and(|span| span.holds(direction)) {
            return true;
        }
        let Some(angle) = way.cut() else { return false };
        let at = Span { angles: [angle; 2], directions: [direction; 2] };
        let Span { angles: [least, most], directions } = span.get_or_insert(at);
        if angle < *least {
            (*least, directions[0]) = (angle, direction);
        }
        if angle > *most {
            (*most, directions[1]) = (angle, direction);
        }
        false
    }
}

impl Span {
    fn holds(&self, direction: Complex<f64>) -> bool {
        let [least, most] = self.directions;
        // Up to half a turn, what is to the left of the one and to the right of the other is between them.
        let left = |a: Complex<f64>, b: Complex<f64>| {
            a.re * b.im - a.im * b.re > MARGIN * a.l1_norm() * b.l1_norm()
        };
        self.angles[1] - self.angles[0] < 3.0 && left(least, direction) && left(direction, most)
    }
}
