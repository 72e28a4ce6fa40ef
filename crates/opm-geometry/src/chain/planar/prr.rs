//! PRR: a slider that carries a link (Eqs. 13-16 of the paper, with the division by 2 that its
//! Eq. 16 lacks).

use super::{
    Attempt, Branch, ClosedForm, Closes, Exception, Joint, LinkLimits, Over, Pivot, PlanarJoint,
    Plane, REACH, Real, Truth,
};
use crate::chain::REACH_TOLERANCE;
use crate::chain::limits::Limits;
use crate::chain::region::{Band, Capsule, Convex, Region};
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use nalgebra::Complex;

/// A slider and a link between two pivots. The branch is `+` where the slider's root has the plus sign: the
/// slider is ahead of the link's outer pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prr<Z: Plane = Complex<f64>> {
    slide: Z,
    pivots: [Pivot<Z>; 2],
    link: Z,
    link_square: Z::Real,
}

impl<Z: Plane> Prr<Z> {
    pub(super) fn new(slide: Z, p2: Pivot<Z>, p3: Pivot<Z>) -> Self {
        let link = (p3.at - p2.at).named("link");
        let link_square = link.norm_sqr().named("link_square");
        Self { slide, pivots: [p2, p3], link, link_square }
    }

    pub(super) fn joints(&self) -> [PlanarJoint<Z>; 3] {
        let [inner, outer] = self.pivots.map(Pivot::joint);
        [PlanarJoint::Prismatic { along: self.slide }, inner, outer]
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        [Closes::Within(self.link_square, [0.0, f64::INFINITY]), Closes::Always]
    }

    /// The vector from the inner pivot at home to the outer one, along the slide and across it. The target is in reach
    /// where its component across is not longer than the link.
    #[inline(always)]
    fn local<T: Over<Z::Real>>(&self, target: &PlanarDisplacement<T::Plane>) -> T::Plane {
        let [inner, outer] = self.pivots;
        (target.apply(outer.at) - inner.at) * self.slide.conj()
    }
}

impl Prr {
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
        Shape::of_places(Region { whole, hole }, self.pivots[1].at).with_link(link)
    }
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Prr<Z> {
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, sign: T::Sign) -> Attempt<T> {
        let local = self.local::<T>(target).named("local");
        // The square of the link's component along the slide.
        let square = (-local.im().square() + self.link_square).named("square");
        let least = T::from_constant(self.link_square).share(REACH, -2.0);
        let closes = square.at_least(least).checked();
        let root = (square.root() * sign).named("root");
        // The link is turned from where it points at home to where it points from the slider.
        let r2 = (T::Plane::new(-root, local.im()) * (self.slide * self.link.conj())).named("r2");
        let r3 = target.rotation * r2.conj();
        let [inner, outer] = self.pivots;
        let slider = T::Joint::value(local.re() + root);
        Attempt::decided([slider, inner.displacement::<T>(r2), outer.displacement::<T>(r3)], closes)
    }

    #[cold]
    fn exception(&self, target: &Self::Target, _: T::Sign) -> Exception<T> {
        let aside = self.local::<T>(target).im().absolute();
        Exception::length(aside - self.link.length())
    }

    fn closes(&self, target: &Self::Target) -> Closes<T> {
        let aside = self.local::<T>(target).im();
        let link = self.link.length();
        match link.known() {
            Some(link) => Closes::Within(aside, [-link, link]),
            None => Closes::Within(aside.per(link), [-1.0, 1.0]),
        }
    }
}
