//! RPR: a telescopic link between two pivots.

use super::{Branch, Pivot, PlanarJoint, ReachDeficit};
use crate::chain::region::{Convex, Disc, Region};
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm, REACH_TOLERANCE, direction};
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// A pivot, a slider and a pivot. The branch is `+` where the slider's root has the plus sign: the outer
/// pivot is ahead of the foot of the perpendicular from the inner pivot to the slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpr {
    pivots: [Pivot; 2],
    slide: Complex<f64>,
    /// The vector from the inner to the outer pivot at home: along the slide (re) and perpendicular to it (im).
    offset: Complex<f64>,
}

impl Rpr {
    pub(super) fn new(p1: Pivot, slide: Complex<f64>, p3: Pivot) -> Self {
        Self { pivots: [p1, p3], slide, offset: (p3.at - p1.at) * slide.conj() }
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        let [inner, outer] = self.pivots.map(|pivot| pivot.joint());
        [inner, PlanarJoint::Prismatic { along: self.slide }, outer]
    }

    /// The shape in which the chain closes. The places of the outer pivot are a ring about the inner one,
    /// between the lengths that the slider allows.
    pub(super) fn shape(&self, branch: Branch, [low, high]: [f64; 2]) -> Shape {
        let [centre, outer] = self.pivots.map(|pivot| pivot.at);
        let [low, high] = [low + self.offset.re, high + self.offset.re];
        let [low, high] = match branch {
            Branch::Plus => [low, high],
            Branch::Minus => [-high, -low],
        };
        if high < 0.0 {
            return Shape::of_places(Region::NOTHING, outer);
        }
        let aside = self.offset.im * self.offset.im;
        let disc = |square: f64| Convex::Disc(Disc::new(centre, square));
        let inner =
            if low > 0.0 { aside + low * low } else { aside * (1.0 - 2.0 * REACH_TOLERANCE) };
        let hole = (inner > 0.0).then(|| disc(inner));
        Shape::of_places(Region { whole: disc(aside + high * high), hole }, outer)
    }

    /// The vector from the inner pivot to the outer one at a target.
    #[inline(always)]
    fn reach(&self, target: &PlanarDisplacement) -> Complex<f64> {
        target.apply(self.pivots[1].at) - self.pivots[0].at
    }
}

impl ClosedForm for Rpr {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, branch: Branch) -> Attempt {
        let reach = self.reach(target);
        let aside = self.offset.im * self.offset.im;
        let square = reach.norm_sqr() - aside;
        let ahead = branch.sign() * square.max(0.0).sqrt();
        let telescope = Complex::new(ahead, self.offset.im) * self.slide;
        let r1 = direction(reach * telescope.conj(), self.offset.norm_sqr());
        let r3 = target.rotation * r1.conj();
        let displacements = [
            self.pivots[0].displacement(r1),
            JointDisplacement::Value(ahead - self.offset.re),
            self.pivots[1].displacement(r3),
        ];
        Attempt::decided(displacements, square >= -2.0 * REACH_TOLERANCE * aside)
    }

    #[cold]
    fn exception(
        &self,
        target: &PlanarDisplacement,
        _: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        Err(ReachDeficit::length(self.offset.im.abs() - self.reach(target).norm()))
    }
}
