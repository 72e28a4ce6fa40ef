//! The joints of all legs at a solved pose.
//!
//! A leg's joints displace each other from the base on: the screw of a joint is its screw at home, displaced by all
//! joints before it (the product of exponentials; R. Murray, Z. Li, S. Sastry, *A Mathematical Introduction to Robotic
//! Manipulation*, 1994, eq. 3.54).

use nalgebra::{
    Isometry3, Matrix3, Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6,
};
use opm_core::Quantity;
use opm_core::group::screw::Screw;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;

/// A leg at a pose.
pub struct Chain {
    /// The displacement from home of what carries each axis; then that of the platform. A universal joint has two axes.
    pub carried: Vec<Isometry3<f64>>,
    /// Its joints, from base to platform.
    pub joints: Vec<PlacedJoint>,
}

/// A joint at a pose.
pub struct PlacedJoint {
    /// Its point, metres.
    pub point: Point3<f64>,
    /// The twist of its outer link for a unit rate of each coordinate, base coordinates.
    pub screws: Vec<Screw>,
}

impl Chain {
    /// The legs of a mechanism for the values of all joint coordinates.
    pub fn all(mechanism: &Mechanism, values: &[f64]) -> Vec<Self> {
        Self::all_with(mechanism, values, |_, _| None)
    }

    /// The same with links that are made with errors: `off` tells by how much the axis of a leg with a number, counted from the
    /// base on, is displaced in what carries it. The number after the last axis is that of the platform.
    pub fn all_with(
        mechanism: &Mechanism,
        values: &[f64],
        off: impl Fn(usize, usize) -> Option<Isometry3<f64>>,
    ) -> Vec<Self> {
        let mut rest = values;
        let leg = |(number, leg): (usize, &Leg)| {
            let (own, others) = rest.split_at(leg.joints.iter().map(Joint::freedoms).sum());
            rest = others;
            Self::new(&leg.joints, own, |axis| off(number, axis))
        };
        mechanism.legs.iter().enumerate().map(leg).collect()
    }

    fn new(
        joints: &[Joint],
        mut values: &[f64],
        off: impl Fn(usize) -> Option<Isometry3<f64>>,
    ) -> Self {
        let (mut at, mut carried, mut placed) = (Isometry3::identity(), Vec::new(), Vec::new());
        let displace = |at: Isometry3<f64>, axis: usize| off(axis).map_or(at, |off| at * off);
        for joint in joints {
            let (own, rest) = values.split_at(joint.freedoms());
            values = rest;
            let from_home = |i: usize| own[i] - joint.coordinates[i].home;
            at = displace(at, carried.len());
            let point = at * joint.point;
            let home = joint.screws();
            carried.push(at);
            let screws = match joint.kind {
                JointKind::Spherical => {
                    let rates = by_rotation_vector(&Vector3::from_fn(|i, _| from_home(i)));
                    let rate = |k: usize| {
                        let angular = rates.column(k).into_owned();
                        Screw { angular, linear: joint.point.coords.cross(&angular) }
                    };
                    let screws = (0..3).map(|k| rate(k).transformed(&at)).collect();
                    at *= joint.displacement(own).expect("a value for each coordinate");
                    screws
                }
                JointKind::Universal { .. } => {
                    let first = home[0].transformed(&at);
                    at = displace(at * home[0].exp(from_home(0)), carried.len());
                    carried.push(at);
                    let screws = vec![first, home[1].transformed(&at)];
                    at *= home[1].exp(from_home(1));
                    screws
                }
                // The freedoms of a cylindrical joint commute.
                _ => {
                    let screws = home.iter().map(|screw| screw.transformed(&at)).collect();
                    at *= joint.displacement(own).expect("a value for each coordinate");
                    screws
                }
            };
            placed.push(PlacedJoint { point, screws });
        }
        carried.push(displace(at, carried.len()));
        Self { carried, joints: placed }
    }

    /// The displacement of the platform from home.
    pub fn end(&self) -> &Isometry3<f64> {
        &self.carried[self.carried.len() - 1]
    }
}

/// The angular velocity for unit rates of the components of a rotation vector `w` with angle `a`, a column for each (Murray,
/// Li, Sastry, chapter 2, exercise 13):
///
/// ```text
/// 1 + (1 - cos a) / a² [w] + (a - sin a) / a³ [w]²
/// ```
pub fn by_rotation_vector(w: &Vector3<f64>) -> Matrix3<f64> {
    /// Below this angle the next terms of the series vanish beside the first.
    const SMALL: f64 = 1e-4;
    let (angle, cross) = (w.norm(), w.cross_matrix());
    let [first, second] = if angle < SMALL {
        [0.5, 1.0 / 6.0]
    } else {
        let half = (0.5 * angle).sin() / angle;
        [2.0 * half * half, (angle - angle.sin()) / angle.powi(3)]
    };
    Matrix3::identity() + cross * first + cross * cross * second
}

/// A matrix that takes twists `(ω; v)` in base coordinates to `(ω; u / length)`, where `u` is the velocity of the body's
/// point that is at `point`.
pub fn at_point(point: &Point3<f64>, length: f64) -> Matrix6<f64> {
    let mut to = Matrix6::identity();
    to.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-point.coords.cross_matrix() / length));
    to.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Matrix3::identity() / length));
    to
}

/// The inverse of [`at_point`].
pub fn from_point(point: &Point3<f64>, length: f64) -> Matrix6<f64> {
    let mut from = Matrix6::identity();
    from.fixed_view_mut::<3, 3>(3, 0).copy_from(&point.coords.cross_matrix());
    from.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Matrix3::identity() * length));
    from
}

/// The small twist `(ω; v)` of a displacement near the identity, to second order.
pub fn small_twist(g: &Isometry3<f64>) -> Vector6<f64> {
    let (angular, linear) = (g.rotation.scaled_axis(), g.translation.vector);
    Screw { angular, linear: linear - angular.cross(&linear) / 2.0 }.to_vector()
}

/// A rotation about a point, as a rotation vector, then a translation.
pub fn displaced(rotation: Vector3<f64>, about: &Point3<f64>, way: Vector3<f64>) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(rotation);
    let about = about.coords;
    Isometry3::from_parts(Translation3::from(about - rotation * about + way), rotation)
}

/// The rotation vector of a displacement, and the displacement of a point.
pub fn difference(g: &Isometry3<f64>, point: &Point3<f64>) -> Vector6<f64> {
    let (w, v) = (g.rotation.scaled_axis(), g * point - point);
    Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z)
}

/// One unit of a quantity in units of the characteristic length.
pub fn unit(quantity: Quantity, length: f64) -> f64 {
    match quantity {
        Quantity::Angle => 1.0,
        Quantity::Length => length,
    }
}
