//! Limits on the direction of a link whose one end slides: bands of the plane.
//!
//! In a slider with a link, the branch leaves the link's direction a half circle, on which the direction's component
//! across the slide grows from one end to the other. So a limit on the direction is a range of that component, or
//! everything but one, and the places of the link's outer end are a band along the slide, or everything but one.

use crate::chain::limits::{Arc, Components, Limits};
use crate::chain::region::{Band, Convex, Region};
use nalgebra::Complex;

/// The limits on the direction of a link, by its joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkLimits {
    /// The slide, the position of the slider's pivot at home, and the length of the link.
    slide: Complex<f64>,
    pivot: Complex<f64>,
    length: f64,
    /// Whether the link points ahead along the slide.
    ahead: bool,
    /// The directions from the slide that the slider's pivot allows.
    inner: Option<Arc>,
    /// The directions from the slide that the outer pivot allows where the target does not rotate. They rotate with it.
    outer: Option<Arc>,
}

impl LinkLimits {
    /// The limits of a link from a slider's pivot at `pivot` to the outer one, which is `link` away at home. The pivots
    /// are given by their limits, and whether they turn clockwise. `None` where neither limits the link.
    pub(super) fn new(
        slide: Complex<f64>,
        [pivot, link]: [Complex<f64>; 2],
        ahead: bool,
        [inner, outer]: [(&Limits, bool); 2],
    ) -> Option<Self> {
        let home = slide.conj() * link / link.norm();
        // The inner pivot turns the link; the outer one turns the target against it.
        let directions = |limits: &Limits, clockwise: bool| {
            let arc = *limits.arc()?;
            let arc = if clockwise { arc.reflected(|e| e.conj()) } else { arc };
            Some(arc.turned(home))
        };
        let (inner, outer) = (directions(inner.0, inner.1), directions(outer.0, !outer.1));
        let limits = Self { slide, pivot, length: link.norm(), ahead, inner, outer };
        (inner.is_some() || outer.is_some()).then_some(limits)
    }

    /// Calls `found` with the places of the outer pivot that each pivot allows, at a rotation of the target.
    pub fn places(&self, rotation: Complex<f64>, mut found: impl FnMut(Region)) {
        let outer = self.outer.map(|arc| arc.turned(rotation));
        for arc in [self.inner, outer].into_iter().flatten() {
            let ahead = if self.ahead { arc } else { arc.reflected(|e| -e.conj()) };
            let Components { whole, hole } = Components::of(&ahead);
            let across = self.slide * Complex::i();
            let middle = (across.conj() * self.pivot).re;
            let band = |range: [f64; 2]| {
                let band = Band::new(across, range.map(|end| middle + self.length * end));
                Convex::Bands([band; 2])
            };
            found(Region { whole: band(whole), hole: hole.map(band) });
        }
    }
}
