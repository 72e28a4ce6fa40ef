//! The targets at which a spherical chain closes, whatever its first and last joints do: its last axis is between two
//! cones about its first one.
//!
//! On a branch the middle joint moves on a half circle, along which the cosine of the angle between the first axis and the
//! last one falls or grows all the way. So limits of that joint are two cosines.

use super::surface::{Surface, Uncertainty};
use crate::numeric::angle::atan2;
use nalgebra::Vector3;

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
    /// Two cones: a target is out of the shell where its last axis is in either, nearer to the cone's own axis than its
    /// surface.
    pub fn cones(&self) -> [Surface; 2] {
        let Self { fixed, carried, cosines: [least, most] } = *self;
        [
            Surface::Cone { fixed, carried, cosine: most },
            Surface::Cone { fixed: -fixed, carried, cosine: -least },
        ]
    }

    /// The largest value at which a target on one of the cones may be to the other side of it.
    pub fn tolerance(&self) -> f64 {
        self.cones()[0].tolerance(Uncertainty { size: 1.0, blur: 0.0 })
    }
}

/// Whether `c₀ + c₁ cos t + c₂ sin t` may be positive anywhere, if values below the tolerance may have either sign.
#[inline(always)]
pub fn may_have_hole([c0, c1, c2]: [f64; 3], tolerance: f64) -> bool {
    c0 + (c1 * c1 + c2 * c2).sqrt() >= -tolerance
}

/// The angles at which `c₀ + c₁ cos t + c₂ sin t` is positive, if values below the tolerance may have either sign. Within
/// `margin` of the ends, radians, nothing is certain. It has no branches: loops over many functions are vectorised.
#[inline(always)]
pub fn hole([c0, c1, c2]: [f64; 3], tolerance: f64, margin: f64) -> ArcHole {
    // c₀ + r cos(t - phase)
    let r = (c1 * c1 + c2 * c2).sqrt();
    let square = (r - c0) * (r + c0);
    let slope = square.max(0.0).sqrt();
    let (middle, apart) = (atan2(c2, c1), atan2(slope, -c0));
    // See `Equation::near_zeros`.
    let parted = square > 4.0 * r * tolerance;
    let share = tolerance / if parted { slope } else { r };
    let off = if parted { 2.0 * share } else { 10.0 * share.sqrt() };
    let has_no_zero = c0.abs() > r + tolerance;
    let off = if has_no_zero { margin } else { off + margin };
    let (inner, outer) = (apart - off, apart + off);
    let outer = if has_no_zero & (c0 < 0.0) { -1.0 } else { outer };
    ArcHole { inner: [middle - inner, middle + inner], outer: [middle - outer, middle + outer] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Branch;
    use crate::chain::limits::Limits;
    use crate::chain::spherical::SphericalChain;
    use crate::group::Path;
    use nalgebra::{Matrix3, Rotation3, Unit};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

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
            let holes = shell.cones().map(|cone| {
                let along = cone.along(&path).coefficients();
                let found = hole(along, shell.tolerance(), 1e-9);
                if !may_have_hole(along, shell.tolerance()) {
                    assert!(found.outer[1] < found.outer[0], "{found:?}");
                }
                found
            });
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
