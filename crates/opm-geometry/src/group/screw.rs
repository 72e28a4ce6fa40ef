//! Screws: joint axes and velocities of rigid bodies, as six-vectors.
//!
//! A twist is written `(ω; v)`: the angular velocity first, then the velocity of the body's point
//! that is at the origin. A joint's screw is the twist of its outer link at unit joint rate.

use nalgebra::{Isometry3, Point3, Quaternion, Unit, UnitQuaternion, Vector3, Vector6};
use std::ops::Sub;

/// A twist `(ω; v)` in base coordinates: radians and metres per unit of the joint's coordinate
/// (a radian or a metre).
///
/// ```
/// # extern crate opm_geometry as opm_core;
/// use nalgebra::{Point3, Vector3};
/// use opm_core::group::screw::Screw;
/// use std::f64::consts::PI;
///
/// // Half a revolution about the vertical line through (1, 0, 0) takes the origin to (2, 0, 0).
/// let hinge = Screw::rotation(Vector3::z_axis(), Point3::new(1.0, 0.0, 0.0));
/// let moved = hinge.exp(PI) * Point3::origin();
/// assert!((moved - Point3::new(2.0, 0.0, 0.0)).norm() < 1e-15);
/// // Axes that meet are reciprocal: neither moves against a force along the other.
/// let meets = Screw::rotation(Vector3::y_axis(), Point3::new(1.0, 0.0, 0.0));
/// assert_eq!(hinge.reciprocal(&meets), 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Screw {
    /// The angular part `ω`.
    pub angular: Vector3<f64>,
    /// The linear part `v`: the velocity of the body's point at the origin.
    pub linear: Vector3<f64>,
}

impl Sub for Screw {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { angular: self.angular - other.angular, linear: self.linear - other.linear }
    }
}

impl Screw {
    /// The screw of a unit rotation about the line through `point` along `axis`: `(a; p × a)`.
    #[inline]
    pub fn rotation(axis: Unit<Vector3<f64>>, point: Point3<f64>) -> Self {
        Self::helical(axis, point, 0.0)
    }

    /// The screw of a unit translation along `axis`: `(0; a)`.
    #[inline]
    pub fn translation(axis: Unit<Vector3<f64>>) -> Self {
        Self { angular: Vector3::zeros(), linear: axis.into_inner() }
    }

    /// The screw of a unit rotation about a line with an advance of `pitch` metres per radian:
    /// `(a; p × a + h a)`.
    #[inline]
    pub fn helical(axis: Unit<Vector3<f64>>, point: Point3<f64>, pitch: f64) -> Self {
        let a = axis.into_inner();
        Self { angular: a, linear: point.coords.cross(&a) + pitch * a }
    }

    /// The six components `(ω; v)`, angular part first.
    #[inline]
    pub fn to_vector(self) -> Vector6<f64> {
        let (w, v) = (self.angular, self.linear);
        Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z)
    }

    /// Builds a screw from its six components `(ω; v)`, angular part first.
    #[inline]
    pub fn from_vector(s: &Vector6<f64>) -> Self {
        Self {
            angular: s.fixed_rows::<3>(0).into_owned(),
            linear: s.fixed_rows::<3>(3).into_owned(),
        }
    }

    /// The Lie bracket `[self, other] = (ω₁ × ω₂; ω₁ × v₂ + v₁ × ω₂)`: the rate of change of `other`
    /// when it moves with `self`.
    #[inline]
    pub fn bracket(&self, other: &Self) -> Self {
        Self {
            angular: self.angular.cross(&other.angular),
            linear: self.angular.cross(&other.linear) + self.linear.cross(&other.angular),
        }
    }

    /// The reciprocal product `ω₁·v₂ + v₁·ω₂`: the power of one screw, as a wrench, on the other, as a
    /// twist.
    #[inline]
    pub fn reciprocal(&self, other: &Self) -> f64 {
        self.angular.dot(&other.linear) + self.linear.dot(&other.angular)
    }

    /// The screw displaced by `g`, that is, the adjoint action of `g`.
    #[inline]
    pub fn transformed(&self, g: &Isometry3<f64>) -> Self {
        let angular = g.rotation * self.angular;
        let linear = g.rotation * self.linear + g.translation.vector.cross(&angular);
        Self { angular, linear }
    }

    /// The displacement `exp(self · coordinate)`: motion along the screw by a value of its joint
    /// coordinate, in radians or metres.
    #[inline]
    pub fn exp(&self, coordinate: f64) -> Isometry3<f64> {
        let (angular, linear) = (self.angular * coordinate, self.linear * coordinate);
        let angle = angular.norm();
        // The coefficients sin θ / θ, (1 − cos θ) / θ², (θ − sin θ) / θ³ and sin(θ/2) / θ. The
        // cancellation in the third one does no harm, because it is multiplied by θ² again.
        let (sin, cos) = (0.5 * angle).sin_cos();
        let [first, second, third, half] = if angle < SMALL_ANGLE {
            [1.0, 0.5, 1.0 / 6.0, 0.5]
        } else {
            let first = 2.0 * sin * cos / angle;
            let square = angle * angle;
            [first, 2.0 * sin * sin / square, (1.0 - first) / square, sin / angle]
        };
        let along = angular * angular.dot(&linear);
        let translation = linear * first + angular.cross(&linear) * second + along * third;
        let rotation = Quaternion::from_parts(cos, angular * half);
        Isometry3::from_parts(translation.into(), UnitQuaternion::new_unchecked(rotation))
    }
}

/// The square of an angle (in radians) below this one vanishes beside 1 in double precision.
const SMALL_ANGLE: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Matrix6};
    use proptest::prelude::*;

    /// Rounding of a few dozen operations on numbers up to about ten.
    const ROUNDING: f64 = 1e-12;
    /// The error of central differences with this step is its square times a third derivative.
    const STEP: f64 = 1e-5;
    const DIFFERENCE: f64 = 1e-8;

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        [-2.0..2.0, -2.0..2.0, -2.0..2.0].prop_map(Vector3::from)
    }

    /// Screws with an angular part of any size, including tiny and zero.
    fn screw() -> impl Strategy<Value = Screw> {
        let size = prop_oneof![Just(1.0), Just(0.0), (-12.0..0.0).prop_map(|e| 10.0_f64.powf(e))];
        (vector(), vector(), size).prop_map(|(w, linear, size)| Screw { angular: w * size, linear })
    }

    fn isometry() -> impl Strategy<Value = Isometry3<f64>> {
        (vector(), vector()).prop_map(|(t, r)| Isometry3::new(t, r))
    }

    /// The twist as a 4 × 4 matrix.
    fn hat(s: &Screw) -> Matrix4<f64> {
        let mut m = s.angular.cross_matrix().to_homogeneous();
        m.fixed_view_mut::<3, 1>(0, 3).copy_from(&s.linear);
        m[(3, 3)] = 0.0;
        m
    }

    fn adjoint(g: &Isometry3<f64>) -> Matrix6<f64> {
        let mut m = Matrix6::zeros();
        for i in 0..6 {
            let unit = Vector6::ith(i, 1.0);
            m.set_column(i, &Screw::from_vector(&unit).transformed(g).to_vector());
        }
        m
    }

    fn close(a: &Screw, b: &Screw, tolerance: f64) -> bool {
        (a.to_vector() - b.to_vector()).amax() < tolerance
    }

    fn displacement_error(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        (a.to_homogeneous() - b.to_homogeneous()).amax()
    }

    proptest! {
        #[test]
        fn exponential_is_the_series(s in screw(), coordinate in -2.0..2.0) {
            let x = hat(&s) * coordinate;
            let (mut term, mut sum) = (Matrix4::identity(), Matrix4::identity());
            // ‖x‖ < 8: the terms have fallen below rounding well before the sixtieth.
            for k in 1..60 {
                term = term * x / f64::from(k);
                sum += term;
            }
            prop_assert!((s.exp(coordinate).to_homogeneous() - sum).amax() < 1e-11);
        }

        #[test]
        fn exponentials_of_one_screw_are_a_group(s in screw(), a in -2.0..2.0, b in -2.0..2.0) {
            prop_assert!(displacement_error(&(s.exp(a) * s.exp(b)), &s.exp(a + b)) < ROUNDING);
            prop_assert!(displacement_error(&s.exp(a).inverse(), &s.exp(-a)) < ROUNDING);
        }

        #[test]
        fn a_displaced_screw_moves_along_the_displaced_path(s in screw(), g in isometry(), a in -2.0..2.0) {
            let conjugate = g * s.exp(a) * g.inverse();
            prop_assert!(displacement_error(&s.transformed(&g).exp(a), &conjugate) < ROUNDING);
        }

        #[test]
        fn adjoint_action_is_a_homomorphism(g in isometry(), h in isometry()) {
            prop_assert!((adjoint(&(g * h)) - adjoint(&g) * adjoint(&h)).amax() < ROUNDING);
        }

        #[test]
        fn bracket_is_the_derivative_of_the_adjoint_action(a in screw(), b in screw()) {
            let side = |t: f64| b.transformed(&a.exp(t)).to_vector();
            let derivative = (side(STEP) - side(-STEP)) / (2.0 * STEP);
            prop_assert!((derivative - a.bracket(&b).to_vector()).amax() < DIFFERENCE);
        }

        #[test]
        fn bracket_is_the_commutator_of_matrices(a in screw(), b in screw()) {
            let commutator = hat(&a) * hat(&b) - hat(&b) * hat(&a);
            prop_assert!((commutator - hat(&a.bracket(&b))).amax() < ROUNDING);
        }

        #[test]
        fn bracket_obeys_jacobi(a in screw(), b in screw(), c in screw()) {
            let nested = |x: &Screw, y: &Screw, z: &Screw| x.bracket(&y.bracket(z)).to_vector();
            let sum = nested(&a, &b, &c) + nested(&b, &c, &a) + nested(&c, &a, &b);
            prop_assert!(sum.amax() < ROUNDING);
        }

        #[test]
        fn bracket_moves_along(a in screw(), b in screw(), g in isometry()) {
            let moved = a.transformed(&g).bracket(&b.transformed(&g));
            prop_assert!(close(&moved, &a.bracket(&b).transformed(&g), 1e-11));
        }

        #[test]
        fn reciprocal_product_is_invariant(a in screw(), b in screw(), g in isometry()) {
            let moved = a.transformed(&g).reciprocal(&b.transformed(&g));
            prop_assert!((moved - a.reciprocal(&b)).abs() < 1e-11);
        }

        #[test]
        fn points_of_a_helical_axis_only_advance(
            a in vector(), p in vector(), pitch in -1.0..1.0, angle in -3.0..3.0, along in -2.0..2.0,
        ) {
            prop_assume!(a.norm() > 0.1);
            let axis = Unit::new_normalize(a);
            let point = Point3::from(p + axis.into_inner() * along);
            let moved = Screw::helical(axis, Point3::from(p), pitch).exp(angle) * point;
            prop_assert!((moved - point - axis.into_inner() * (pitch * angle)).amax() < ROUNDING);
        }
    }

    /// The reciprocal product of rotations about two lines is minus their distance times the sine of
    /// the angle between them.
    #[test]
    fn reciprocal_product_of_two_lines() {
        let x_axis = Screw::rotation(Vector3::x_axis(), Point3::origin());
        let above = Screw::rotation(Vector3::y_axis(), Point3::new(5.0, 7.0, 2.0));
        assert!((x_axis.reciprocal(&above) + 2.0).abs() < ROUNDING);
        let meets = Screw::rotation(Vector3::y_axis(), Point3::new(5.0, 7.0, 0.0));
        assert!(x_axis.reciprocal(&meets).abs() < ROUNDING);
    }
}
