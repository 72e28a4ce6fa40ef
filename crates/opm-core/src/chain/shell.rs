//! The targets at which a spherical chain closes, whatever its first and last joints do: its last axis is between two
//! cones about its first one.
//!
//! On a branch the middle joint moves on a half circle, along which the cosine of the angle between the first axis and the
//! last one falls or grows all the way. So limits of that joint are two cosines.

use super::surface::{Surface, Uncertainty};
use crate::group::Path;
use crate::numeric::angle::atan2;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// The targets `g` with `fixed · g carried` between two cosines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// A fixed unit direction.
    pub fixed: Vector3<f64>,
    /// A unit direction that moves with the target.
    pub carried: Vector3<f64>,
    /// The least and the largest cosine; the first one is larger where no target is possible.
    pub cosines: [f64; 2],
}

/// An interval of a path's parameter, with another one that lies in it: the parameters of the inner one are certainly out of
/// the shell, those outside of the outer one certainly in it or in another hole. Either is empty where its second number is
/// less than its first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcHole {
    /// The interval of what is certain.
    pub inner: [f64; 2],
    /// The interval of what is possible.
    pub outer: [f64; 2],
}

impl Shell {
    /// The largest value at which a target on one of the cones may be to the other side of it.
    pub fn tolerance(&self) -> f64 {
        let cone = Surface::Cone { fixed: self.fixed, carried: self.carried, cosine: 0.0 };
        cone.tolerance(Uncertainty { size: 1.0, blur: 0.0 })
    }

    /// What a path on the sphere is out of, in one revolution: what is too near to the first axis, and what is too far from
    /// it. Within `margin` of the ends, radians, nothing is certain. It has no branches: loops over many paths are vectorised.
    #[inline(always)]
    pub fn holes(&self, path: &Path, tolerance: f64, margin: f64) -> [ArcHole; 2] {
        let Self { fixed, carried, cosines: [least, most] } = *self;
        // kept + r cos(t - phase)
        let [kept, cosine, sine] =
            Surface::Cone { fixed, carried, cosine: 0.0 }.along(path).coefficients();
        let r = (cosine * cosine + sine * sine).sqrt();
        let phase = atan2(sine, cosine);
        let near = Edge::new(most - kept, r, tolerance);
        let far = Edge::new(least - kept, r, tolerance);
        let opposite = phase + 0.5 * TAU;
        [
            hole(phase, near.angle, near.half + margin, near.misses & (near.angle < 1.0)),
            hole(
                opposite,
                0.5 * TAU - far.angle,
                far.half + margin,
                far.misses & (far.angle > 1.0),
            ),
        ]
    }
}

/// Where `r cos t` has a value.
#[derive(Clone, Copy)]
struct Edge {
    /// The angle between 0 and π; one of these where no angle has the value.
    angle: f64,
    /// How far it may be off.
    half: f64,
    /// Whether no angle has the value.
    misses: bool,
}

impl Edge {
    #[inline(always)]
    fn new(value: f64, r: f64, tolerance: f64) -> Self {
        let square = (r - value) * (r + value);
        let slope = square.max(0.0).sqrt();
        // See `Equation::near_zeros`.
        let parted = square > 4.0 * r * tolerance;
        let half = if parted { 2.0 * tolerance / slope } else { 10.0 * (tolerance / r).sqrt() };
        let misses = value.abs() > r + tolerance;
        Self { angle: atan2(slope, value), half: if misses { 0.0 } else { half }, misses }
    }
}

/// The angles that are nearer to one than a half width, which may be off by `margin`.
#[inline(always)]
fn hole(middle: f64, half: f64, margin: f64, empty: bool) -> ArcHole {
    let (inner, outer) = (half - margin, half + margin);
    let outer = if empty { -1.0 } else { outer };
    ArcHole { inner: [middle - inner, middle + inner], outer: [middle - outer, middle + outer] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Branch;
    use crate::chain::limits::Limits;
    use crate::chain::spherical::SphericalChain;
    use nalgebra::{Matrix3, Rotation3, Unit};
    use proptest::prelude::*;

    fn axis() -> impl Strategy<Value = Unit<Vector3<f64>>> {
        let whole = || (-1..=1_i32).prop_map(f64::from);
        let any = || -1.0..1.0_f64;
        let vector = prop_oneof![(whole(), whole(), whole()), (any(), any(), any())];
        vector
            .prop_filter("a direction", |(x, y, z)| x * x + y * y + z * z > 0.1)
            .prop_map(|(x, y, z)| Unit::new_normalize(Vector3::new(x, y, z)))
    }

    fn limits() -> impl Strategy<Value = Option<[f64; 2]>> {
        let eighths = |n: i32| f64::from(n) * TAU / 8.0;
        prop_oneof![
            Just(None),
            (-4..4_i32, 1..8_i32).prop_map(move |(low, n)| Some([eighths(low), eighths(low + n)])),
            (-3.0..3.0_f64, 0.0..6.2_f64).prop_map(|(low, width)| Some([low, low + width])),
        ]
    }

    fn rotation(axis: &Unit<Vector3<f64>>, angle: f64) -> Matrix3<f64> {
        Rotation3::from_axis_angle(axis, angle).into_inner()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// A shell has the targets at which the chain closes with its middle joint within limits, and no others; its holes
        /// along a path are where the path leaves it.
        #[test]
        fn a_shell_is_where_the_chain_closes(
            axes in [axis(), axis(), axis()], limits in limits(), plus in any::<bool>(),
            start in (axis(), -3.0..3.0_f64), about in axis(), shares in prop::array::uniform8(0.0..1.0_f64),
        ) {
            let Ok(chain) = SphericalChain::new(axes) else { return Ok(()) };
            let limits = Limits::new(limits, 0.0, 1.0);
            let branch = if plus { Branch::Plus } else { Branch::Minus };
            let start = rotation(&start.0, start.1);
            let path = Path::Spherical { start, axis: about.into_inner() };
            let Some(shell) = chain.shell(branch, &limits) else {
                // The limits leave both ends of the branch.
                prop_assert!(limits.range().1 - limits.range().0 > TAU / 2.0);
                return Ok(());
            };
            let holes = shell.holes(&path, shell.tolerance(), 1e-9);
            for share in shares {
                let t = TAU * share;
                let target = rotation(&about, t) * start;
                let found = chain.inverse(&target, branch);
                let reached = found.is_ok_and(|joints| limits.admits(joints[1]));
                let cosine = shell.fixed.dot(&(target * shell.carried));
                let [low, high] = shell.cosines;
                let margin = (cosine - low).min(high - cosine);
                prop_assume!(margin.abs() > 1e-6);
                prop_assert_eq!(reached, margin > 0.0, "{} in {:?}", cosine, shell.cosines);
                let is_in = |[from, to]: [f64; 2]| {
                    (-2..3).any(|n| (from..=to).contains(&(t + TAU * f64::from(n))))
                };
                let certain = holes.iter().any(|hole| is_in(hole.inner));
                let possible = holes.iter().any(|hole| is_in(hole.outer));
                prop_assert!(certain == possible || margin.abs() < 1e-3, "{holes:?} at {t}");
                if certain == possible {
                    prop_assert_eq!(certain, !reached, "{:?} at {}", holes, t);
                }
            }
        }
    }
}
