//! Chains of three prismatic joints in space.

use super::surface::Surface;
use super::{Attempt, ChainError, ClosedForm, DEGENERATE};
use crate::group::JointDisplacement;
use nalgebra::Vector3;

/// Three sliders in space, in any three independent directions. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialChain {
    /// The sliders' unit directions, base first.
    slides: [Vector3<f64>; 3],
    /// Perpendicular to the first slider, and one along the second.
    second: Vector3<f64>,
    /// Perpendicular to the first two sliders, and one along the third.
    third: Vector3<f64>,
}

impl SpatialChain {
    /// The closed form of three sliders along these unit directions.
    ///
    /// # Errors
    /// Two sliders are parallel, or all three are in one plane.
    pub fn new(slides: [Vector3<f64>; 3]) -> Result<Self, ChainError> {
        let [u, v, w] = slides;
        // The sines of the angles between the sliders.
        if [u.cross(&v), v.cross(&w), w.cross(&u)].iter().any(|sine| sine.norm() <= DEGENERATE) {
            return Err(ChainError::Dependent("two sliders are parallel"));
        }
        // An orthonormal basis, of which the first one and two vectors span what the sliders do. Of sliders that are
        // nearly parallel, the first difference has few digits: the second one makes it perpendicular again.
        let outside = |v: Vector3<f64>| (v - u * u.dot(&v)).normalize();
        let across = outside(outside(v));
        let normal = u.cross(&across);
        let height = normal.dot(&w);
        if height.abs() <= DEGENERATE {
            return Err(ChainError::Dependent("three sliders are in one plane"));
        }
        Ok(Self { slides, second: across / across.dot(&v), third: normal / height })
    }

    /// The sliders' unit directions, base first.
    pub fn slides(&self) -> &[Vector3<f64>; 3] {
        &self.slides
    }

    /// The coefficients of the sliders' displacements: the products of these vectors with a target.
    pub fn coefficients(&self) -> [Vector3<f64>; 3] {
        let ([u, v, w], third) = (self.slides, self.third);
        let second = self.second - third * self.second.dot(&w);
        [u - second * u.dot(&v) - third * u.dot(&w), second, third]
    }

    /// The targets at which slider number `joint` is held at `displacement`, measured across the other two.
    pub(super) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let [u, v, w] = &self.slides;
        let across = match joint {
            0 => v.cross(w),
            1 => w.cross(u),
            _ => u.cross(v),
        };
        Surface::Slab { across, at: displacement.value() * across.dot(&self.slides[joint]) }
    }

    /// The sliders' displacements that translate the outer link by `target`, metres. Each is computed from the rounded
    /// ones after it, so that their sum is the target even where the sliders are nearly parallel.
    #[inline(always)]
    pub fn inverse(&self, target: &Vector3<f64>) -> [JointDisplacement; 3] {
        let [u, v, w] = &self.slides;
        let third = self.third.dot(target);
        let rest = target - w * third;
        let second = self.second.dot(&rest);
        let first = u.dot(&(rest - v * second));
        [first, second, third].map(JointDisplacement::Value)
    }

    /// The translation of the outer link.
    pub fn forward(&self, displacements: &[JointDisplacement; 3]) -> Vector3<f64> {
        let [a, b, c] = displacements.map(JointDisplacement::value);
        let [u, v, w] = &self.slides;
        u * a + v * b + w * c
    }
}

impl ClosedForm for SpatialChain {
    type Target = Vector3<f64>;

    #[inline(always)]
    fn attempt(&self, target: &Vector3<f64>, _: f64) -> Attempt {
        Attempt::decided(self.inverse(target), true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::group::Path;
    use nalgebra::Matrix3;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_map(Vector3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5_000))]

        /// Where a joint has a value, by the linear system of the sliders, a path of targets meets the surface of that
        /// joint held there.
        #[test]
        fn held_joints_are_met_where_they_have_the_value(
            slides in [vector(), vector(), vector()], start in vector(), rate in vector(), t in -1.0..1.0_f64,
        ) {
            let slides = slides.map(|slide| slide.normalize());
            let matrix = Matrix3::from_columns(&slides);
            prop_assume!(matrix.determinant().abs() > 0.05);
            let chain = SpatialChain::new(slides).expect("they are independent");
            let at = matrix.lu().solve(&(start + rate * t)).expect("they are independent");
            for joint in 0..3 {
                let surface = chain.held(joint, JointDisplacement::Value(at[joint]));
                let Surface::Slab { across, at } = surface else { unreachable!() };
                prop_assert!((across.dot(&(start + rate * t)) - at).abs() < 1e-13);
                let slope = across.dot(&rate);
                let roots = surface.along(&Path::Spatial { start, rate }).roots();
                prop_assert_eq!(roots.len(), 1);
                prop_assert!(((roots[0].value() - t) * slope).abs() < 1e-13);
            }
        }
    }
}
