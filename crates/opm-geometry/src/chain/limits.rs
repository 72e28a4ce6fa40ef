//! Limits of a joint coordinate, tested without trigonometry.

use crate::group::JointDisplacement;
use crate::numeric::angle::unit;
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// A coordinate that is past its limit by less than this, as a fraction of the largest number that it is
/// computed from, counts as inside: the rounding of a solution on a limit must not decide.
const SLACK: f64 = 1e-12;

/// A range without ends.
const EVERYTHING: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// How far past a limit a displacement is that is clearly not allowed: radians, or a fraction of the lengths. It is far
/// more than rounding makes of a joint's displacement where branches meet.
const NEARLY: f64 = 1e-3;

/// The displacements from home that a coordinate may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limits {
    /// Every displacement.
    Free,
    /// A range of a length or of an angle.
    Range {
        /// The lowest displacement from home, metres or radians.
        low: f64,
        /// The highest displacement from home, metres or radians.
        high: f64,
        /// The range of an angle that does not count revolutions, slack included; `None` where the range is a
        /// full revolution or more.
        arc: Option<Arc>,
    },
}

/// An arc of the unit circle, counter-clockwise from `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    pub(crate) from: Complex<f64>,
    pub(crate) to: Complex<f64>,
    /// Whether the arc is longer than a semicircle.
    pub(crate) wide: bool,
}

impl Limits {
    /// The limits for the lowest and the highest value of a coordinate and its value at home, radians or
    /// metres. The ends get a slack for rounding, in proportion to the largest of these numbers and of
    /// `size`: the mechanism's size in metres, or one for an angle.
    pub fn new(limits: Option<[f64; 2]>, home: f64, size: f64) -> Self {
        let Some([low, high]) = limits else { return Self::Free };
        let slack = SLACK * low.abs().max(high.abs()).max(home.abs()).max(size);
        let (low, high) = (low - home - slack, high - home + slack);
        let arc = (high - low < TAU).then(|| Arc {
            from: unit(low),
            to: unit(high),
            wide: high - low > PI,
        });
        Self::Range { low, high, arc }
    }

    /// Whether a displacement from home is allowed. A direction is allowed if its angle is, after any number
    /// of full revolutions.
    #[inline(always)]
    pub fn admits(&self, displacement: JointDisplacement) -> bool {
        match (self, displacement) {
            (Self::Free, _) | (Self::Range { arc: None, .. }, JointDisplacement::Direction(_)) => {
                true
            }
            (Self::Range { low, high, .. }, JointDisplacement::Value(value)) => {
                (value >= *low) & (value <= *high)
            }
            (Self::Range { arc: Some(arc), .. }, JointDisplacement::Direction(e)) => {
                arc.contains(e)
            }
        }
    }

    /// Whether a displacement from home is allowed, or past an end by no more than [`NEARLY`].
    pub(crate) fn nearly_admits(&self, displacement: JointDisplacement) -> bool {
        let near = match (self, displacement) {
            (Self::Range { low, high, .. }, JointDisplacement::Value(value)) => {
                let margin = NEARLY * (low.abs() + high.abs() + value.abs());
                value >= low - margin && value <= high + margin
            }
            (Self::Range { arc: Some(arc), .. }, JointDisplacement::Direction(e)) => {
                [arc.from, arc.to].iter().any(|end| (e - end).norm_sqr() <= NEARLY * NEARLY)
            }
            _ => true,
        };
        near || self.admits(displacement)
    }

    /// The value to report for a displacement from home. Of a direction, it is the angle nearest to home, but
    /// an angle within the limits where there is one.
    #[inline(always)]
    pub fn report(&self, displacement: JointDisplacement) -> f64 {
        let nearest = displacement.value();
        match displacement {
            JointDisplacement::Direction(_) => self.report_angle(nearest),
            JointDisplacement::Value(_) => nearest,
        }
    }

    /// The value to report for an angle within π of home, to which full revolutions may be added.
    #[inline(always)]
    pub fn report_angle(&self, angle: f64) -> f64 {
        match self {
            Self::Free => angle,
            Self::Range { low, high, .. } => brought_into(angle, *low, *high),
        }
    }

    /// The value to report for a displacement from home, and whether it is allowed: as [`Limits::report`] and
    /// [`Limits::admits`] define, or, where `held` is given, the angle nearest to that value and whether
    /// that angle is allowed.
    #[inline(always)]
    pub fn place(&self, displacement: JointDisplacement, held: Option<f64>) -> (f64, bool) {
        match held {
            None => (self.report(displacement), self.admits(displacement)),
            Some(held) => {
                let value = displacement.nearest(held);
                (value, self.admits(JointDisplacement::Value(value)))
            }
        }
    }

    /// The ends of the limits of a length, or of an angle that counts revolutions; `None` where it is free.
    pub(crate) fn value_ends(&self) -> Option<[JointDisplacement; 2]> {
        match self {
            Self::Free => None,
            Self::Range { low, high, .. } => {
                Some([low, high].map(|&end| JointDisplacement::Value(end)))
            }
        }
    }

    /// The ends of the limits of an angle that does not count revolutions; `None` where it is free or may
    /// make a full revolution.
    pub(crate) fn direction_ends(&self) -> Option<[JointDisplacement; 2]> {
        self.arc().map(|arc| [arc.from, arc.to].map(JointDisplacement::Direction))
    }

    /// The limits of an angle that does not count revolutions; `None` where it is free or may make a full revolution.
    pub fn arc(&self) -> Option<&Arc> {
        match self {
            Self::Range { arc, .. } => arc.as_ref(),
            Self::Free => None,
        }
    }

    /// The lowest and the highest displacement from home; infinite where it is free.
    #[inline]
    pub fn range(&self) -> (f64, f64) {
        match self {
            Self::Free => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Range { low, high, .. } => (*low, *high),
        }
    }

    /// Whether the coordinate is limited at all.
    pub fn any(&self) -> bool {
        !matches!(self, Self::Free)
    }
}

impl Arc {
    /// The arc turned by a rotation.
    pub(crate) fn turned(self, rotation: Complex<f64>) -> Self {
        Self { from: rotation * self.from, to: rotation * self.to, ..self }
    }

    /// The arc reflected by a map of the directions.
    pub(crate) fn reflected(self, reflect: impl Fn(Complex<f64>) -> Complex<f64>) -> Self {
        Self { from: reflect(self.to), to: reflect(self.from), ..self }
    }

    /// Whether a direction is left of the first end and right of the second; for a wide arc either suffices.
    #[inline(always)]
    fn contains(&self, e: Complex<f64>) -> bool {
        let cross = |a: Complex<f64>, b: Complex<f64>| a.re * b.im - a.im * b.re;
        let (after, before) = (cross(self.from, e) >= 0.0, cross(e, self.to) >= 0.0);
        if self.wide { after | before } else { after & before }
    }
}

/// The components across a half circle's axis, from -1 to 1, of an arc's directions on it: those in a range that are not
/// inside a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Components {
    pub whole: [f64; 2],
    pub hole: Option<[f64; 2]>,
}

impl Components {
    /// The imaginary parts of those directions of an arc whose real part is not negative.
    pub fn of(arc: &Arc) -> Self {
        let ahead = |e: Complex<f64>| (e.re >= 0.0).then_some(e.im);
        let all = |whole| Self { whole, hole: None };
        let [least, most] = EVERYTHING;
        match [ahead(arc.from), ahead(arc.to)] {
            // Around the half circle, or within it.
            [Some(from), Some(to)] if arc.wide => {
                Self { whole: EVERYTHING, hole: (to < from).then_some([to, from]) }
            }
            // An arc of no more than its slack may be rounded to the other order.
            [Some(from), Some(to)] => all([from.min(to), from.max(to)]),
            [Some(from), None] => all([from, most]),
            [None, Some(to)] => all([least, to]),
            [None, None] if arc.wide => all(EVERYTHING),
            [None, None] => all([most, least]),
        }
    }
}

/// The angle with full revolutions added that bring it into a range; unchanged where none do.
#[inline(always)]
fn brought_into(angle: f64, low: f64, high: f64) -> f64 {
    let (below, above) = (angle < low, angle > high);
    let past = if below { low - angle } else { angle - high };
    let turns = TAU * (past / TAU).ceil();
    let moved = if below { angle + turns } else { angle - turns };
    let within = (moved >= low) & (moved <= high);
    if (below | above) & within { moved } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of_angle(low: f64, high: f64, home: f64) -> Limits {
        Limits::new(Some([low, high]), home, 1.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// The arc test agrees with the test of the angle modulo a revolution.
        #[test]
        fn arcs_are_ranges_modulo_a_turn(
            home in -7.0..7.0_f64, low in -7.0..7.0_f64, width in 0.0..7.0_f64, angle in -7.0..7.0_f64,
        ) {
            let limits = of_angle(low, low + width, home);
            let from_low = (angle + home - low).rem_euclid(TAU);
            let margin = (from_low - width).abs().min(from_low).min(TAU - from_low);
            prop_assume!(margin > 1e-9);
            let inside = from_low <= width;
            prop_assert_eq!(limits.admits(JointDisplacement::Direction(unit(angle))), inside);
            let reported = home + limits.report(JointDisplacement::Direction(unit(angle)));
            prop_assert!((unit(reported) - unit(home + angle)).norm() < 1e-9);
            prop_assert_eq!(inside, (low..=low + width).contains(&reported));
        }
    }

    #[test]
    fn a_limit_is_inside() {
        for (low, high, home) in
            [(-0.3, 0.3, 0.1), (0.0, 0.0, 0.0), (-3.0, 3.0, 2.0), (1.0, 1.5, 1.2)]
        {
            let limits = of_angle(low, high, home);
            for end in [low, high] {
                assert!(limits.admits(JointDisplacement::Value(end - home)), "{low} {high} {home}");
                assert!(
                    limits.admits(JointDisplacement::Direction(unit(end - home))),
                    "{low} {high} {home}"
                );
            }
            assert!(!limits.admits(JointDisplacement::Value(high - home + 1e-9)));
            assert!(!limits.admits(JointDisplacement::Direction(unit(high - home + 1e-9))));
        }
    }
    /// A limit of zero has a slack too: the rounding there is in proportion to the size of the mechanism.
    #[test]
    fn a_limit_at_zero_is_inside() {
        for size in [1e-6, 1.0, 1e6] {
            let locked = Limits::new(Some([0.0, 0.0]), 0.0, size);
            for rounding in [0.0, f64::EPSILON, -f64::EPSILON] {
                assert!(locked.admits(JointDisplacement::Value(rounding * size)));
            }
            assert!(!locked.admits(JointDisplacement::Value(1e-9 * size)));
        }
        let locked = of_angle(0.0, 0.0, 0.0);
        assert!(locked.admits(JointDisplacement::Value(f64::EPSILON)));
        assert!(locked.admits(JointDisplacement::Direction(unit(f64::EPSILON))));
        assert!(!locked.admits(JointDisplacement::Value(1e-9)));
    }
}
