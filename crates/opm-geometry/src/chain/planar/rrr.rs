//! RRR: a two-link arm from a fixed pivot, with a wrist.

use super::{
    Attempt, ClosedForm, Closes, Exception, Over, Pivot, PlanarJoint, Plane, REACH, Real, Truth,
};
use crate::chain::REACH_TOLERANCE;
use crate::chain::region::{Convex, Disc, Region};
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use crate::numbers::DEGENERATE;
use nalgebra::Complex;

/// Two links between three pivots. The branch is `+` where the second link points counter-clockwise from
/// the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrr<Z: Plane = Complex<f64>> {
    pivots: [Pivot<Z>; 3],
    /// The links at home.
    first: Z,
    second: Z,
    /// The rotation, from home, that aligns the second link with the first.
    straighten: Z,
    /// `(|first|² + |second|²) / 2` and `|first| |second|`: the law of cosines.
    mean_square: Z::Real,
    product: Z::Real,
}

impl<Z: Plane> Rrr<Z> {
    pub(super) fn new(p1: Pivot<Z>, p2: Pivot<Z>, p3: Pivot<Z>) -> Self {
        let first = (p2.at - p1.at).named("first");
        let second = (p3.at - p2.at).named("second");
        let (a, b) = (first.length().named("a"), second.length().named("b"));
        let product = (a * b).named("product");
        Self {
            pivots: [p1, p2, p3],
            first,
            second,
            straighten: (first * second.conj()).per(product).named("straighten"),
            mean_square: ((a.square() + b.square()) * 0.5).named("mean_square"),
            product,
        }
    }

    pub(super) fn joints(&self) -> [PlanarJoint<Z>; 3] {
        self.pivots.map(Pivot::joint)
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        let [a, b] = [self.first, self.second].map(Plane::norm_sqr);
        let exceeds = |one: Z::Real, other: Z::Real| {
            let least = other.share(DEGENERATE, 1.0).share(DEGENERATE, 1.0);
            Closes::Within(one - least, [0.0, f64::INFINITY])
        };
        [exceeds(a, b), exceeds(b, a)]
    }

    /// The vector from the first pivot to the wrist.
    #[inline(always)]
    fn reach<T: Over<Z::Real>>(&self, target: &PlanarDisplacement<T::Plane>) -> T::Plane {
        let [first, _, wrist] = self.pivots;
        target.apply(wrist.at) - first.at
    }

    /// The cosine of the angle from the first link to the second. The target is in reach where it lies in `[-1, 1]`.
    #[inline(always)]
    fn elbow_cosine<T: Over<Z::Real>>(&self, reach: T::Plane) -> T {
        (reach.norm_sqr() * 0.5 - self.mean_square).per(self.product)
    }

    /// Whether the links are always equally long, so that no target is too near.
    fn folds(&self) -> bool {
        match (self.mean_square.known(), self.product.known()) {
            (Some(mean_square), Some(product)) => {
                mean_square / product <= 1.0 + 0.5 * REACH_TOLERANCE
            }
            _ => false,
        }
    }
}

impl Rrr {
    /// The shape in which the chain closes: the places of the wrist are a ring about the first pivot.
    pub(super) fn shape(&self) -> Shape {
        let swing = self.product * (1.0 + REACH_TOLERANCE);
        let disc = |half_square: f64| Convex::Disc(Disc::new(self.pivots[0].at, 2.0 * half_square));
        let inner = self.mean_square - swing;
        let hole = (inner > 0.0).then(|| disc(inner));
        Shape::of_places(Region { whole: disc(self.mean_square + swing), hole }, self.pivots[2].at)
    }
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Rrr<Z> {
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, sign: T::Sign) -> Attempt<T> {
        let reach = self.reach::<T>(target).named("reach");
        let cosine = self.elbow_cosine::<T>(reach).named("cosine");
        let closes = cosine.within(1.0, REACH).checked();
        let cosine = cosine.at_most_one().named("bend");
        let sine = ((-cosine.square() + 1.0).root() * sign).named("sine");
        let elbow = T::Plane::new(cosine, sine);
        let r2 = (elbow * self.straighten).named("r2");
        let [p1, p2, p3] = self.pivots;
        // As the sum of two angles, or as the rotation from the vector from the first pivot to the wrist with the elbow bent
        // and the first joint at home to the vector that it must become.
        let (r1, turn) = match T::swing(reach, [self.first, self.second], sign) {
            Some(angle) => (angle.unit(), p1.turn::<T>(angle)),
            None => {
                let bent = (r2 * self.second + self.first).named("bent");
                let size = T::from_constant(self.mean_square);
                let r1 = (reach * bent.conj()).direction(size).named("r1");
                (r1, p1.displacement::<T>(r1))
            }
        };
        let r3 = (target.rotation * (r1 * r2).conj()).named("r3");
        Attempt::decided([turn, p2.displacement::<T>(r2), p3.displacement::<T>(r3)], closes)
    }

    #[cold]
    fn exception(&self, target: &Self::Target, _: T::Sign) -> Exception<T> {
        let distance = self.reach::<T>(target).named("reach").length().named("distance");
        let [a, b] = [self.first, self.second].map(|link| T::from_constant(link.length()));
        Exception::length((distance - (a + b)).larger((a - b).absolute() - distance))
    }

    fn closes(&self, target: &Self::Target) -> Closes<T> {
        let nearest = if self.folds() { f64::NEG_INFINITY } else { -1.0 };
        Closes::Within(self.elbow_cosine(self.reach::<T>(target)), [nearest, 1.0])
    }
}
