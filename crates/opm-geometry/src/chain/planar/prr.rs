//! PRR: a slider that carries a link (Eqs. 13-16 of the paper, with the division by 2 that its
//! Eq. 16 lacks).

use super::{Branch, ChainError, LinkLimits, Pivot, PlanarJoint, ReachDeficit};
use crate::chain::limits::Limits;
use crate::chain::region::{Band, Capsule, Convex, Region};
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm, REACH_TOLERANCE};
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// A slider and a link between two pivots. The branch is `+` where the slider's root has the plus sign: the
/// slider is ahead of the link's outer pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prr {
    slide: Complex<f64>,
    pivots: [Pivot; 2],
    link: Complex<f64>,
    link_square: f64,
}

impl Prr {
    pub(super) fn new(slide: Complex<f64>, p2: Pivot, p3: Pivot) -> Result<Self, ChainError> {
        let link = p3.at - p2.at;
        if link.norm() == 0.0 {
            return Err(ChainError::Dependent("two pivots coincide: a zero-length link"));
        }
        Ok(Self { slide, pivots: [p2, p3], link, link_square: link.norm_sqr() })
    }

    /// For the outer pivot at `outer`: its coordinate along the slide, measured from the inner pivot at
    /// home, and the square of the link's component along the slide. The target is in reach where that square
    /// is not negative; the slider is then at the coordinate plus or minus the root of the square.
    #[inline]
    fn triangle(&self, outer: Complex<f64>) -> (f64, f64) {
        let local = (outer - self.pivots[0].at) * self.slide.conj();
        (local.re, self.link_square - local.im * local.im)
    }

    /// Whether the target is in reach for this square of the link's component along the slide, the boundary
    /// of reach included.
    #[inline]
    fn closes(&self, square: f64) -> bool {
        square >= -2.0 * REACH_TOLERANCE * self.link_square
    }

    /// The position of the outer pivot at home, to which targets are applied.
    #[inline]
    fn outer(&self) -> Complex<f64> {
        self.pivots[1].at
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        let [inner, outer] = self.pivots.map(|pivot| pivot.joint());
        [PlanarJoint::Prismatic { along: self.slide }, inner, outer]
    }

    /// The shape in which the chain closes. The places of the outer pivot are the area that half a circle
    /// about the inner pivot sweeps as the slider goes through its range: the area swept from one end on,
    /// less the area swept beyond the other end.
    pub(super) fn shape(
        &self,
        branch: Branch,
        range: [f64; 2],
        [inner, outer]: [&Limits; 2],
    ) -> Shape {
        let [p2, p3] = self.pivots.map(|pivot| pivot.reversed);
        self.places(branch, range, [(inner, p2), (outer, p3)])
    }

    /// The shape for limits of the pivots, each with whether it turns clockwise.
    pub(super) fn places(
        &self,
        branch: Branch,
        [low, high]: [f64; 2],
        pivots: [(&Limits, bool); 2],
    ) -> Shape {
        let home = self.pivots[0].at;
        // The slider is ahead of the outer pivot by the root, or behind it: sweep in that direction.
        let (along, start, end) = match branch {
            Branch::Plus => (self.slide, low, high),
            Branch::Minus => (-self.slide, -high, -low),
        };
        let capsule =
            |at: f64| Capsule::new(home + along * at, along, self.link_square, REACH_TOLERANCE);
        let whole = if start == f64::NEG_INFINITY {
            let (across, radius) =
                (along * Complex::i(), self.link_square.sqrt() * (1.0 + REACH_TOLERANCE));
            let middle = across.re * home.re + across.im * home.im;
            Convex::Bands([Band::new(across, [middle - radius, middle + radius]); 2])
        } else {
            Convex::Capsule(capsule(start))
        };
        let hole = (end < f64::INFINITY).then(|| Convex::Capsule(capsule(end)));
        let ends = [home, self.link];
        // Where the slider is ahead, the link points back.
        let link = LinkLimits::new(self.slide, ends, branch == Branch::Minus, pivots);
        Shape::of_places(Region { whole, hole }, self.outer()).with_link(link)
    }
}

impl ClosedForm for Prr {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, branch: Branch) -> Attempt {
        let outer = target.apply(self.outer());
        let (along, square) = self.triangle(outer);
        let slider = along + branch.sign() * square.max(0.0).sqrt();
        let link = outer - self.pivots[0].at - self.slide * slider;
        let r2 = link * self.link.conj();
        let r3 = target.rotation * r2.conj();
        let displacements = [
            JointDisplacement::Value(slider),
            self.pivots[0].displacement(r2),
            self.pivots[1].displacement(r3),
        ];
        Attempt::decided(displacements, self.closes(square))
    }

    #[cold]
    fn exception(
        &self,
        target: &PlanarDisplacement,
        _: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let local = (target.apply(self.outer()) - self.pivots[0].at) * self.slide.conj();
        Err(ReachDeficit::length(local.im.abs() - self.link.norm()))
    }
}
