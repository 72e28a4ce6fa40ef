//! RPR: a telescopic link between two pivots.

use super::{
    Attempt, Branch, ClosedForm, Closes, Exception, Joint, Over, Pivot, PlanarJoint, Plane, REACH,
    Real, Truth,
};
use crate::chain::REACH_TOLERANCE;
use crate::chain::region::{Convex, Disc, Region};
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use nalgebra::Complex;

/// A pivot, a slider and a pivot. The branch is `+` where the slider's root has the plus sign: the outer
/// pivot is ahead of the foot of the perpendicular from the inner pivot to the slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpr<Z: Plane = Complex<f64>> {
    pivots: [Pivot<Z>; 2],
    slide: Z,
    /// The vector from the inner to the outer pivot at home: along the slide (re) and perpendicular to it (im).
    offset: Z,
}

impl<Z: Plane> Rpr<Z> {
    pub(super) fn new(p1: Pivot<Z>, slide: Z, p3: Pivot<Z>) -> Self {
        let offset = ((p3.at - p1.at) * slide.conj()).named("offset");
        Self { pivots: [p1, p3], slide, offset }
    }

    pub(super) fn joints(&self) -> [PlanarJoint<Z>; 3] {
        let [inner, outer] = self.pivots.map(Pivot::joint);
        [inner, PlanarJoint::Prismatic { along: self.slide }, outer]
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        [Closes::Always; 2]
    }

    /// The vector from the inner pivot to the outer one at a target.
    #[inline(always)]
    fn reach<T: Over<Z::Real>>(&self, target: &PlanarDisplacement<T::Plane>) -> T::Plane {
        let [inner, outer] = self.pivots;
        target.apply(outer.at) - inner.at
    }
}

impl Rpr {
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
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Rpr<Z> {
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, sign: T::Sign) -> Attempt<T> {
        let reach = self.reach::<T>(target).named("reach");
        let [ahead_at_home, aside] = [self.offset.re(), self.offset.im()];
        let aside_square = aside.square().named("aside_square");
        let square = (reach.norm_sqr() - aside_square).named("square");
        let least = T::from_constant(aside_square).share(REACH, -2.0);
        let closes = square.at_least(least).checked();
        let ahead = (square.root() * sign).named("ahead");
        let telescope = T::Plane::new(ahead, T::from_constant(aside)) * self.slide;
        let telescope = telescope.named("telescope");
        let size = T::from_constant(self.offset.norm_sqr());
        let r1 = (reach * telescope.conj()).direction(size).named("r1");
        let r3 = target.rotation * r1.conj();
        let [inner, outer] = self.pivots;
        let displacements = [
            inner.displacement::<T>(r1),
            T::Joint::value(ahead - ahead_at_home),
            outer.displacement::<T>(r3),
        ];
        Attempt::decided(displacements, closes)
    }

    #[cold]
    fn exception(&self, target: &Self::Target, _: T::Sign) -> Exception<T> {
        let aside = T::from_constant(self.offset.im().absolute());
        Exception::length(aside - self.reach::<T>(target).named("reach").length())
    }

    fn closes(&self, target: &Self::Target) -> Closes<T> {
        let square = self.reach::<T>(target).norm_sqr();
        let aside = self.offset.im();
        // The rounding is in proportion to the square.
        match aside.known() {
            Some(aside) => Closes::Within(square, [aside * aside, f64::INFINITY]),
            None => Closes::Within(square - aside.square(), [0.0, f64::INFINITY]),
        }
    }
}
