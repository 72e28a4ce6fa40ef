//! Legs of each type, solved at displacements that are made by products of exponentials.

use super::*;

fn axis(x: f64, y: f64, z: f64) -> Unit<Vector3<f64>> {
    Unit::new_normalize(Vector3::new(x, y, z))
}

/// Home has no joint displaced, and a longer leg is found by the length.
#[test]
fn a_leg_of_a_hexapod() {
    let (a, b) = (Point3::new(0.2, 0.1, 0.0), Point3::new(0.1, 0.0, 0.5));
    let joints = [
        LegJoint::Screw { axis: axis(1.0, 0.0, 0.0), point: a, pitch: 0.0 },
        LegJoint::Screw { axis: axis(0.0, 1.0, 0.0), point: a, pitch: 0.0 },
        LegJoint::Slide { axis: Unit::new_normalize(b - a) },
        LegJoint::Ball { point: b },
    ];
    let motion = |i: i32| {
        let t = f64::from(i);
        let shift = Vector3::new(0.1 * t.sin(), 0.1 * (2.0 * t).cos(), 0.1 * (3.0 * t).sin());
        Isometry3::new(shift, 5.0 * Vector3::new(shift.y, shift.z, shift.x))
    };
    let motions: Vec<_> = (0..8).map(motion).collect();
    let leg = WholeLeg::new(&joints, &[false, false, true, false], &motions, 0.5).unwrap();
    assert_eq!(leg.choosing_joints().last(), Some(&2));
    let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
    for g in &motions {
        leg.solve(g, [Branch::Plus; 2], &mut out).unwrap();
        let length = (g * b - a).norm() - (b - a).norm();
        assert!((out[2].value() - length).abs() < 1e-14);
    }
}
