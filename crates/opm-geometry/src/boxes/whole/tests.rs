//! The closed form of a whole leg over a box of poses.

use crate::boxes::{Affine, Enclosed, Rotation};
use crate::chain::Branch;
use crate::chain::whole::{LegJoint, MOST_FREEDOMS, WholeLeg};
use crate::numbers::JointDisplacement;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// Rounding of the numbers of a box, which are not widened by it.
const ROUNDING: f64 = 1e-12;

fn screw(axis: [f64; 3], point: [f64; 3], pitch: f64) -> LegJoint {
    LegJoint::Screw { axis: Unit::new_normalize(axis.into()), point: point.into(), pitch }
}

fn slide(axis: [f64; 3]) -> LegJoint {
    LegJoint::Slide { axis: Unit::new_normalize(axis.into()) }
}

/// Legs with all kernels of six freedoms.
fn legs() -> Vec<Vec<LegJoint>> {
    let (a, b, c) = ([0.2, 0.0, 0.0], [0.35, 0.0, 0.1], [0.1, 0.02, 0.4]);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let ball = LegJoint::Ball { point: c.into() };
    vec![
        vec![screw(x, a, 0.0), screw(y, a, 0.0), slide([-0.1, 0.02, 0.4]), ball],
        vec![slide(x), screw(x, b, 0.0), screw(y, b, 0.0), ball],
        vec![screw(y, a, 0.0), screw(y, b, 0.0), screw([0.1, 0.5, 1.0], b, 0.0), ball],
        vec![screw(y, a, 0.0), LegJoint::Ball { point: b.into() }, ball],
        vec![slide(x), slide(y), slide(z), ball],
    ]
}

fn target(random: &mut fastrand::Rng, size: f64) -> Isometry3<f64> {
    let mut vector = || Vector3::from([(); 3].map(|()| size * (2.0 * random.f64() - 1.0)));
    let shift = 0.1 * vector();
    // About a point of the platform.
    let centre = Point3::new(0.0, 0.0, 0.4);
    let turn = Isometry3::rotation_wrt_point(Isometry3::new(shift, vector()).rotation, centre);
    nalgebra::Translation3::from(shift) * turn
}

#[test]
fn bounds_over_a_box_hold_its_poses() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut held = 0;
    for joints in legs() {
        let motions: Vec<_> = (0..12).map(|_| target(&mut random, 0.6)).collect();
        let leg = WholeLeg::new(&joints, &[true, false, false, false], &motions, 0.5, &[]).unwrap();
        // All freedoms but those of spherical joints.
        let turns = joints.iter().flat_map(|joint| vec![joint.freedoms() == 1; joint.freedoms()]);
        let turns: Vec<bool> = turns.collect();
        let asked = |freedom: usize| turns.get(freedom) == Some(&true);
        let reach = leg.reach(asked).unwrap();
        for g in &motions {
            let half = 1e-3;
            let rotation = g.rotation.to_rotation_matrix().into_inner();
            let row = |i: usize| [0, 1, 2].map(|j| Affine::<3>::constant(rotation[(i, j)]));
            let number = |i| Affine::<3>::coordinate(g.translation.vector[i], half, i);
            let over = (Rotation([row(0), row(1), row(2)]), [number(0), number(1), number(2)]);
            for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let (share, bounds) = super::enclose(&reach, over, signs);
                for _ in 0..5 {
                    let off = Vector3::from([(); 3].map(|()| half * (2.0 * random.f64() - 1.0)));
                    let at = g.translation.vector + off;
                    let target = Isometry3::from_parts(at.into(), g.rotation);
                    let branches = signs.map(|sign| Branch::BOTH[usize::from(sign < 0.0)]);
                    let mut found = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
                    let reached = leg.solve(&target, branches, &mut found).is_ok();
                    assert!(
                        if reached { share.upper > 0.0 } else { share.lower < 1.0 },
                        "{share:?}"
                    );
                    if !reached {
                        continue;
                    }
                    held += 1;
                    for (freedom, bound) in bounds.iter().enumerate().filter(|(i, _)| asked(*i)) {
                        let pairs = match (found[freedom], *bound) {
                            (JointDisplacement::Value(q), Enclosed::Value(over)) => {
                                vec![(q, over)]
                            }
                            (JointDisplacement::Direction(e), Enclosed::Direction(over)) => {
                                vec![(e.re, over.re), (e.im, over.im)]
                            }
                            (one, bound) => panic!("{one:?} {bound:?}"),
                        };
                        for (q, over) in pairs {
                            let (low, high) = (over.low() - ROUNDING, over.high() + ROUNDING);
                            assert!(low <= q && q <= high, "{q} {low} {high}");
                        }
                    }
                }
            }
        }
    }
    assert!(held > 500, "{held}");
}
