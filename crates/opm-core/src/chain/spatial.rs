//! Chains of three prismatic joints in space.

use super::surface::Surface;
use super::{Attempt, Branch, ChainError, ClosedForm, DEGENERATE};
use crate::group::JointDisplacement;
use nalgebra::{Matrix3, Vector3};

/// Three sliders in space, in any three independent directions. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialChain {
    /// The sliders' unit directions as columns, base first.
    slides: Matrix3<f64>,
    /// The inverse of that matrix. Its rows are perpendicular to the other two sliders.
    inverse: Matrix3<f64>,
}

impl SpatialChain {
    /// The closed form of three sliders along these unit directions.
    ///
    /// # Errors
    /// Two sliders are parallel, or all three are in one plane.
    pub fn new(slides: [Vector3<f64>; 3]) -> Result<Self, ChainError> {
        let [u, v, w] = &slides;
        // The sines of the angles between the sliders.
        if [u.cross(v), v.cross(w), w.cross(u)].iter().any(|sine| sine.norm() <= DEGENERATE) {
            return Err(ChainError::Dependent("two sliders are parallel"));
        }
        let volume = u.cross(v).dot(w);
        if volume.abs() <= DEGENERATE {
            return Err(ChainError::Dependent("three sliders are in one plane"));
        }
        let rows = [v.cross(w), w.cross(u), u.cross(v)].map(|row| (row / volume).transpose());
        Ok(Self { slides: Matrix3::from_columns(&slides), inverse: Matrix3::from_rows(&rows) })
    }

    /// The sliders' unit directions, base first.
    pub fn slides(&self) -> [Vector3<f64>; 3] {
        [0, 1, 2].map(|joint| self.slides.column(joint).into_owned())
    }

    /// The matrix that takes a translation to the sliders' displacements.
    pub(crate) fn coefficients(&self) -> &Matrix3<f64> {
        &self.inverse
    }

    /// The targets at which slider number `joint` is held at `displacement`, measured across the other two.
    pub(super) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let row = self.inverse.row(joint).transpose();
        let length = row.norm();
        Surface::Slab { across: row / length, at: displacement.value() / length }
    }

    /// The sliders' displacements that translate the outer link by `target`, metres.
    #[inline(always)]
    pub fn inverse(&self, target: &Vector3<f64>) -> [JointDisplacement; 3] {
        let found = self.inverse * target;
        [found.x, found.y, found.z].map(JointDisplacement::Value)
    }

    /// The translation of the outer link.
    pub fn forward(&self, displacements: &[JointDisplacement; 3]) -> Vector3<f64> {
        self.slides * Vector3::from(displacements.map(JointDisplacement::value))
    }
}

impl ClosedForm for SpatialChain {
    type Target = Vector3<f64>;

    #[inline(always)]
    fn attempt(&self, target: &Vector3<f64>, _: Branch) -> Attempt {
        Attempt::decided(self.inverse(target), true)
    }
}
