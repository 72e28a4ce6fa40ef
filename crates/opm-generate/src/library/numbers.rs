//! Functions of numbers.

use super::*;

functions! {
    #[inline]
    fn clamp(x: Real, low: Real, high: Real) -> Real {
        x.lt(low).choose(low, x.gt(high).choose(high, x))
    }

    /// The angle plus full revolutions, within half of one of the reference.
    #[inline]
    fn near(angle: Real, reference: Real) -> Real {
        name!(revolutions = (angle - reference) / TAU);
        abs(revolutions).le(0.5).choose(angle, angle - TAU * round(revolutions))
    }

    /// The deficit of a target out of reach: positive, and infinite where it is unknown.
    #[inline]
    fn missed(excess: Real) -> Real {
        excess.is_not(excess).choose(Real::infinity(), max(excess, 1e-37))
    }
}
