//! The values of joints, their limits, and the joints nearest to previous ones.

use super::*;

functions! {
    /// The branch of a choice in a mode: -1 where its bit is set.
    #[inline]
    fn sign(mode: Bits, bit: Bits) -> Real {
        (mode >> bit & 1_u32).is_not(0_u32).choose(-1.0, 1.0)
    }

    /// The size of a limit; zero where there is none.
    #[inline]
    fn end(limit: Real) -> Real {
        name!(size = abs(limit));
        size.lt(Real::infinity()).choose(size, 0.0)
    }

    /// The rounding that a value at a limit may have.
    #[inline]
    fn slack(joint: In<Joint>) -> Real {
        name!(ends = max(end(joint.low), end(joint.high)));
        REACH * max(ends, max(abs(joint.home), joint.size))
    }

    /// Brings an angle into its limits by full revolutions, where these do.
    fn into_limits(joint: In<Joint>, value: Real) -> Real {
        name!(slack = slack(joint), low = joint.low - slack, high = joint.high + slack);
        when(value.lt(low) | value.gt(high), || {
            name!(
                past = value.lt(low).choose(low - value, value - high),
                turns = TAU * ceil(past / TAU),
                moved = value.lt(low).choose(value + turns, value - turns)
            );
            give((moved.ge(low) & moved.le(high)).choose(moved, value));
        });
        value
    }

    /// The value of an angle: within half a revolution of home, or within its limits where full revolutions bring it
    /// there.
    #[inline]
    fn reported(joint: In<Joint>, angle: Real) -> Real {
        name!(value = joint.home + angle);
        (value.ge(joint.low) & value.le(joint.high)).choose(value, into_limits(joint, value))
    }

    /// The angle of a joint that is nearest to a previous value of it.
    #[inline]
    fn nearest_angle(joint: In<Joint>, direction: Complex, previous: Real) -> Real {
        near(joint.home + angle(direction), previous)
    }

    /// The rotation vector nearest to a previous one among those of the same rotation, which differ by full revolutions.
    #[inline]
    fn nearest_rotation(vector: Vector, previous: Vector) -> Vector {
        name!(angle = sqrt(dot(vector, vector)), held = sqrt(dot(previous, previous)));
        name!(zero = vector_of(0.0, 0.0, 0.0));
        let turns = Real::empty("turns");
        when(angle.lt(REACH / 100.0), || {
            note(
                "Full revolutions about any axis are the identity: the nearest axis is that of the previous one.",
            );
            turns.set(round(held / TAU));
            give(turns.gt(0.0).choose(add(zero, TAU * turns / held, previous), vector));
        });
        turns.set((dot(previous, vector) / angle - angle) / TAU);
        abs(turns).le(0.5).choose(vector, add(zero, 1.0 + TAU * round(turns) / angle, vector))
    }

    /// The square of a joint's motion from a previous value, in radians or sizes of the mechanism.
    #[inline]
    fn moved(joint: In<Joint>, value: Real, previous: Real) -> Real {
        name!(moved = (value - previous) / joint.size);
        moved * moved
    }
}
