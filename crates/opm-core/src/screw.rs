//! Screws: the joint axes and the velocities of rigid bodies, in one six-vector each.
//!
//! A twist is written `(ω; v)`: angular velocity first, then the velocity of the body's point that
//! passes through the origin. A joint's screw is the twist of its unit rate.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3, Vector6};

/// A twist `(ω; v)` in base coordinates: radians and metres per unit of the joint's own coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw {
    /// Angular part `ω`.
    pub angular: Vector3<f64>,
    /// Linear part `v`: the velocity of the point at the origin.
    pub linear: Vector3<f64>,
}

impl Screw {
    /// Unit rotation about the line through `point` along `axis`: `(a; p × a)`.
    pub fn rotation(axis: Unit<Vector3<f64>>, point: Point3<f64>) -> Self {
        Self::helical(axis, point, 0.0)
    }

    /// Unit translation along `axis`: `(0; a)`.
    pub fn translation(axis: Unit<Vector3<f64>>) -> Self {
        Self { angular: Vector3::zeros(), linear: axis.into_inner() }
    }

    /// Unit rotation about a line with `pitch` metres of advance a radian: `(a; p × a + h a)`.
    pub fn helical(axis: Unit<Vector3<f64>>, point: Point3<f64>, pitch: f64) -> Self {
        let a = axis.into_inner();
        Self { angular: a, linear: point.coords.cross(&a) + pitch * a }
    }

    /// The six components, angular part first.
    pub fn to_vector(self) -> Vector6<f64> {
        let (w, v) = (self.angular, self.linear);
        Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z)
    }

    /// From six components, angular part first.
    pub fn from_vector(s: &Vector6<f64>) -> Self {
        Self {
            angular: s.fixed_rows::<3>(0).into_owned(),
            linear: s.fixed_rows::<3>(3).into_owned(),
        }
    }

    /// Lie bracket `[self, other]`, the derivative of one twist carried along by the other:
    /// `(ω₁ × ω₂; ω₁ × v₂ + v₁ × ω₂)`.
    pub fn bracket(&self, other: &Self) -> Self {
        Self {
            angular: self.angular.cross(&other.angular),
            linear: self.angular.cross(&other.linear) + self.linear.cross(&other.angular),
        }
    }

    /// Reciprocal product `ω₁·v₂ + v₁·ω₂`: the power of one, read as a wrench, on the other.
    pub fn reciprocal(&self, other: &Self) -> f64 {
        self.angular.dot(&other.linear) + self.linear.dot(&other.angular)
    }

    /// The same screw on a body displaced by `g` (adjoint action).
    pub fn transformed(&self, g: &Isometry3<f64>) -> Self {
        let angular = g.rotation * self.angular;
        let linear = g.rotation * self.linear + g.translation.vector.cross(&angular);
        Self { angular, linear }
    }

    /// Displacement after moving along this screw for `amount` of its coordinate.
    pub fn exp(&self, amount: f64) -> Isometry3<f64> {
        let w = self.angular.norm();
        if w == 0.0 {
            return Isometry3::from_parts(
                Translation3::from(self.linear * amount),
                UnitQuaternion::identity(),
            );
        }
        let axis = Unit::new_unchecked(self.angular / w);
        let rotation = UnitQuaternion::from_axis_angle(&axis, w * amount);
        // The axis passes through p = ω × v / |ω|²; the pitch is ω·v / |ω|² (Chasles).
        let point = self.angular.cross(&self.linear) / (w * w);
        let advance = self.angular * (self.angular.dot(&self.linear) / (w * w) * amount);
        Isometry3::from_parts(Translation3::from(point - rotation * point + advance), rotation)
    }
}
