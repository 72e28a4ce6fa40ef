//! Screws, rotation vectors and subspaces.

use fastrand::Rng;
use nalgebra::{Isometry3, Matrix4, Point3, Unit, Vector3};
use opm_core::chain::spherical::Ball;
use opm_core::group::screw::Screw;
use opm_core::group::subspace::{Frame, MotionSubspace, SubspaceClass};
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_tests::structured::{angles, axes, matrix, quaternion};
use std::f64::consts::PI;

const ROUNDING: f64 = 1e-12;

fn points() -> [Point3<f64>; 4] {
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -2.0, 1.0], [1.0, 1.0, 1.0]].map(Point3::from)
}

/// Exponentials are Rodrigues' matrices about a point, with an advance.
#[test]
fn exponentials_turn_about_their_axes() {
    for axis in axes() {
        for point in points() {
            for pitch in [0.0, -0.5] {
                let screw = Screw::helical(Unit::new_normalize(axis), point, pitch);
                for angle in angles() {
                    let turn = matrix(&axis, angle);
                    let way = point.coords - turn * point.coords + axis * (pitch * angle);
                    let mut expected = turn.to_homogeneous();
                    expected.fixed_view_mut::<3, 1>(0, 3).copy_from(&way);
                    let off: Matrix4<f64> = screw.exp(angle).to_homogeneous() - expected;
                    assert!(off.amax() < ROUNDING, "{axis}{point} {pitch} {angle}");
                }
            }
        }
    }
}

/// The rotation vector of a ball is one of the rotation that it was asked for, half a turn at most.
#[test]
fn balls_measure_rotation_vectors() {
    let joint = Joint::new("s", JointKind::Spherical, Vector3::z_axis(), Point3::origin());
    for frame in axes().into_iter().flat_map(|axis| [0.0, PI / 2.0, PI].map(|a| matrix(&axis, a))) {
        let ball = Ball { axes: frame };
        for axis in axes() {
            for angle in angles() {
                let turn = matrix(&axis, angle);
                let amounts = ball.inverse(&turn);
                let vector = amounts.map(opm_core::group::JointDisplacement::value);
                let length = Vector3::from(vector).norm();
                assert!(length <= PI + ROUNDING, "{axis}{angle}: {vector:?}");
                let (expected, found) = (frame * turn * frame.transpose(), Vector3::from(vector));
                let unit = found.try_normalize(0.0).unwrap_or(Vector3::x());
                assert!((matrix(&unit, length) - expected).amax() < ROUNDING, "{axis}{angle}");
                assert!((ball.forward(&amounts) - turn).amax() < ROUNDING, "{axis}{angle}");
                let moved = joint.displacement(&vector).unwrap().rotation.to_rotation_matrix();
                assert!((moved.into_inner() - expected).amax() < ROUNDING, "{axis}{angle}");
            }
        }
    }
}

/// Subspaces in every structured attitude are what they were made as, with the same axis and point.
#[test]
fn subspaces_are_recognised() {
    let frame = |screws: &[(Screw, Point3<f64>)]| {
        let only: Vec<Screw> = screws.iter().map(|(screw, _)| *screw).collect();
        MotionSubspace::span(Frame::of(screws), &only).class()
    };
    let mut classes = 0;
    for axis in axes() {
        for angle in [0.0, PI / 2.0, PI, -2.0 * PI / 3.0] {
            for point in points() {
                let rotation = quaternion(&axis, angle);
                let g = Isometry3::from_parts(point.coords.into(), rotation);
                let direction =
                    |x: f64, y: f64, z: f64| g * Unit::new_normalize(Vector3::new(x, y, z));
                let at = |x: f64, y: f64, z: f64| g * Point3::new(x, y, z);
                let turn = |axis, point| (Screw::rotation(axis, point), point);
                let slide = |axis| (Screw::translation(axis), point);
                let [x, y, z] =
                    [direction(1.0, 0.0, 0.0), direction(0.0, 1.0, 0.0), direction(0.0, 0.0, 1.0)];
                let along =
                    |a: &Unit<Vector3<f64>>, b: Unit<Vector3<f64>>| a.cross(&b).norm() < 1e-9;
                let on = |p: &Point3<f64>, q: Point3<f64>, a: Unit<Vector3<f64>>| {
                    (p - q).cross(&a).norm() < 1e-9
                };

                for screws in [
                    vec![turn(z, at(0.0, 0.0, 0.0)), turn(z, at(1.0, 0.0, 0.0)), slide(x)],
                    vec![
                        turn(z, at(0.0, 0.0, 0.0)),
                        turn(-z, at(1.0, 0.0, 3.0)),
                        turn(z, at(0.0, 1.0, 0.0)),
                    ],
                    vec![
                        slide(x),
                        slide(y),
                        turn(-z, at(0.5, 0.0, 0.0)),
                        slide(direction(1.0, 1.0, 0.0)),
                    ],
                ] {
                    let found = frame(&screws);
                    assert!(
                        matches!(&found, Some(SubspaceClass::Planar { normal }) if along(normal, z)),
                        "{g}: {found:?}"
                    );
                    classes += 1;
                }
                for screws in [
                    vec![turn(x, point), turn(y, point), turn(z, point)],
                    vec![
                        turn(x, at(2.0, 0.0, 0.0)),
                        turn(direction(1.0, 1.0, 0.0), point),
                        turn(-z, at(0.0, 0.0, 1.0)),
                        turn(z, point),
                    ],
                ] {
                    let found = frame(&screws);
                    assert!(
                        matches!(&found, Some(SubspaceClass::Spherical { centre }) if (centre - point).norm() < 1e-9),
                        "{g}: {found:?}"
                    );
                    classes += 1;
                }
                let found =
                    frame(&[turn(z, at(1.0, 0.0, 0.0)), slide(-z), turn(z, at(1.0, 0.0, 5.0))]);
                assert!(
                    matches!(&found, Some(SubspaceClass::Cylindrical { axis, point })
                        if along(axis, z) && on(point, at(1.0, 0.0, 0.0), z)),
                    "{g}: {found:?}"
                );
                let found = frame(&[slide(x), slide(-x), slide(direction(1.0, 1.0, 0.0))]);
                assert!(
                    matches!(&found, Some(SubspaceClass::TranslationalPlane { normal }) if along(normal, z)),
                    "{g}: {found:?}"
                );
                classes += 2;
            }
        }
    }
    assert_eq!(classes, 13 * 4 * 4 * 7);
}

/// The middle of a set of axes is where the squares of the distances are least: their gradient is zero there.
#[test]
fn the_middle_of_axes_is_nearest_to_them() {
    let (axes, points) = (axes(), points());
    let mut rng = Rng::with_seed(60);
    for _ in 0..20_000 {
        let lines: Vec<(Screw, Point3<f64>)> = (0..2 + rng.usize(..4))
            .map(|_| {
                let axis = axes[rng.usize(..axes.len())] * [1.0, -1.0][rng.usize(..2)];
                let point = points[rng.usize(..points.len())];
                (Screw::rotation(Unit::new_normalize(axis), point), point)
            })
            .collect();
        let frame = Frame::of(&lines);
        let gradient: Vector3<f64> = (lines.iter())
            .map(|(screw, point)| {
                let off = frame.origin - point;
                off - screw.angular * screw.angular.dot(&off)
            })
            .sum();
        assert!(gradient.norm() < 1e-11, "{lines:?}: {frame:?}");
        assert!(frame.length.is_finite() && frame.length > 0.0, "{lines:?}: {frame:?}");
    }
}
