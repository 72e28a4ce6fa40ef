//! RRR: a two-link arm from a fixed pivot, with a wrist.

use super::{Branch, ChainError, Pivot, PlanarJoint, ReachDeficit};
use crate::chain::region::{Convex, Disc, Region};
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm, DEGENERATE, REACH_TOLERANCE, direction};
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// Two links between three pivots. The branch is `+` where the second link points counter-clockwise from
/// the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrr {
    pivots: [Pivot; 3],
    /// The links at home.
    first: Complex<f64>,
    second: Complex<f64>,
    /// The rotation, from home, that aligns the second link with the first.
    straighten: Complex<f64>,
    /// `(|first|² + |second|²) / 2` and `|first| |second|`: the law of cosines.
    mean_square: f64,
    product: f64,
}

impl Rrr {
    pub(super) fn new(p1: Pivot, p2: Pivot, p3: Pivot) -> Result<Self, ChainError> {
        let (first, second) = (p2.at - p1.at, p3.at - p2.at);
        let (a, b) = (first.norm(), second.norm());
        if a.min(b) <= DEGENERATE * a.max(b) {
            return Err(ChainError::Dependent("two pivots coincide: a zero-length link"));
        }
        Ok(Self {
            pivots: [p1, p2, p3],
            first,
            second,
            straighten: first * second.conj() / (a * b),
            mean_square: (a * a + b * b) / 2.0,
            product: a * b,
        })
    }

    /// The cosine of the angle from the first link to the second with the wrist at `wrist`. The target is in
    /// reach where it lies in `[-1, 1]`.
    #[inline]
    fn elbow_cosine(&self, wrist: Complex<f64>) -> f64 {
        ((wrist - self.pivots[0].at).norm_sqr() / 2.0 - self.mean_square) / self.product
    }

    /// Whether the target is in reach for this cosine of the elbow, the boundary of reach included.
    #[inline]
    fn closes(cosine: f64) -> bool {
        cosine.abs() <= 1.0 + REACH_TOLERANCE
    }

    /// The shape in which the chain closes: the places of the wrist are a ring about the first pivot.
    pub(super) fn shape(&self) -> Shape {
        let swing = self.product * (1.0 + REACH_TOLERANCE);
        let disc = |half_square: f64| Convex::Disc(Disc::new(self.pivots[0].at, 2.0 * half_square));
        let inner = self.mean_square - swing;
        let hole = (inner > 0.0).then(|| disc(inner));
        Shape::of_places(Region { whole: disc(self.mean_square + swing), hole }, self.wrist())
    }

    /// The position of the wrist at home, to which targets are applied.
    #[inline]
    fn wrist(&self) -> Complex<f64> {
        self.pivots[2].at
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        self.pivots.map(|pivot| pivot.joint())
    }
}

impl ClosedForm for Rrr {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, branch: Branch) -> Attempt {
        let wrist = target.apply(self.wrist());
        let cosine = self.elbow_cosine(wrist);
        let closes = Self::closes(cosine);
        let cosine = cosine.clamp(-1.0, 1.0);
        let elbow = Complex::new(cosine, branch.sign() * (1.0 - cosine * cosine).sqrt());
        let r2 = elbow * self.straighten;
        // The vector from the first pivot to the wrist with the elbow bent and the first joint at home, and
        // the vector that it must become.
        let bent = self.first + r2 * self.second;
        let reach = wrist - self.pivots[0].at;
        let r1 = direction(reach * bent.conj(), self.mean_square);
        let r3 = target.rotation * (r1 * r2).conj();
        let [p1, p2, p3] = self.pivots;
        Attempt::decided([p1.displacement(r1), p2.displacement(r2), p3.displacement(r3)], closes)
    }

    #[cold]
    fn exception(
        &self,
        target: &PlanarDisplacement,
        _: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let distance = (target.apply(self.wrist()) - self.pivots[0].at).norm();
        let (a, b) = (self.first.norm(), self.second.norm());
        Err(ReachDeficit::length((distance - (a + b)).max((a - b).abs() - distance)))
    }
}
