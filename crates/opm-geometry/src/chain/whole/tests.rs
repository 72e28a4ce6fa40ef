//! Legs of each type, solved at displacements that are made by products of exponentials.

use super::*;
use nalgebra::{Translation3, UnitQuaternion};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A length that the legs are compared with.
const SIZE: f64 = 0.5;
/// Rounding of a leg near no singularity, where joints are found one after the other.
const ROUNDING: f64 = 1e-8;
/// Joints are regular where no singular value of their screws is smaller.
const REGULAR: f64 = 0.05;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Where the joints are.
const A: [f64; 3] = [0.2, 0.0, 0.0];
const B: [f64; 3] = [0.35, 0.0, 0.1];
const C: [f64; 3] = [0.1, 0.02, 0.4];
/// Seen from `A` across y: the second axis of a universal joint, so that its leg points in every direction.
const D: [f64; 3] = [0.1, 0.0, 0.4];

fn unit(v: [f64; 3]) -> Unit<Vector3<f64>> {
    Unit::new_normalize(v.into())
}

fn r(axis: [f64; 3], point: [f64; 3]) -> LegJoint {
    h(axis, point, 0.0)
}

fn h(axis: [f64; 3], point: [f64; 3], pitch: f64) -> LegJoint {
    LegJoint::Screw { axis: unit(axis), point: point.into(), pitch }
}

fn p(axis: [f64; 3]) -> LegJoint {
    LegJoint::Slide { axis: unit(axis) }
}

fn s(point: [f64; 3]) -> LegJoint {
    LegJoint::Ball { point: point.into() }
}

/// A parallelogram.
fn pa(axis: [f64; 3], point: [f64; 3], arm: [f64; 3]) -> LegJoint {
    LegJoint::Parallelogram { axis: unit(axis), point: point.into(), arm: arm.into() }
}

/// A type of leg.
struct Type {
    name: &'static str,
    joints: Vec<LegJoint>,
    motor: usize,
    /// The number of choices.
    choices: usize,
    /// Makes the joints' values such that the platform moves as it should.
    within: fn(&mut [f64]),
}

fn types() -> Vec<Type> {
    let free: fn(&mut [f64]) = |_| {};
    // The last one of three parallel revolutes, the first of which is given, keeps directions.
    let sum: fn(&mut [f64]) = |q| q[3] = -q[1] - q[2];
    let of = |name, joints: &[LegJoint], motor, choices, within| Type {
        name,
        joints: joints.to_vec(),
        motor,
        choices,
        within,
    };
    let along = [-0.1, 0.02, 0.4];
    let tilted = [0.1, 0.5, 1.0];
    let d = [0.05, 0.1, 0.3];
    vec![
        of("UPS", &[r(X, A), r(Y, A), p([-0.1, 0.0, 0.4]), s(D)], 2, 2, free),
        of("SPS", &[s(A), p([-0.1, 0.0, 0.4]), s(D)], 1, 1, free),
        of("PUS", &[p(X), r(X, B), r(Y, B), s(C)], 0, 2, free),
        of("RUS", &[r(Y, A), r(Y, B), r(tilted, B), s(C)], 0, 2, free),
        of("RSS", &[r(Y, A), s(B), s(C)], 0, 1, free),
        of("PPPS", &[p(X), p(Y), p(Z), s(C)], 0, 0, free),
        of("RPRS", &[r(Z, A), p(Z), r(Y, B), s(C)], 0, 2, free),
        of("RRRS", &[r(Z, A), r(Z, B), r(X, d), s(C)], 0, 2, free),
        of("PRRRRR", &[p(Z), r(Z, A), r(Z, B), r(X, C), r(Y, C), r(tilted, C)], 0, 2, free),
        of("RUU", &[r(Y, A), r(Y, B), r(X, B), r(X, C), r(Y, C)], 0, 2, |q| {
            (q[3], q[4]) = (-q[2], -q[0] - q[1]);
        }),
        of("PUU", &[p(X), r(Y, B), r(X, B), r(X, C), r(Y, C)], 0, 2, |q| {
            (q[3], q[4]) = (-q[2], -q[1]);
        }),
        of("UPU", &[r(Y, A), r(X, A), p(along), r(X, C), r(Y, C)], 2, 2, |q| {
            (q[3], q[4]) = (-q[1], -q[0]);
        }),
        of("RRPRR", &[r(Y, A), r(X, A), p(along), r(tilted, C), r(Y, C)], 2, 2, free),
        of("PRRR", &[p(X), r(X, A), r(X, B), r(X, C)], 0, 1, sum),
        of("CRR", &[r(X, A), p(X), r(X, B), r(X, C)], 1, 1, |q| q[3] = -q[0] - q[2]),
        of("RHRR", &[r(X, A), h(X, B, 0.05), r(X, C), r(X, d)], 1, 1, |q| {
            q[3] = -q[0] - q[1] - q[2];
        }),
        of("PRRU", &[p(X), r(X, A), r(X, B), r(X, C), r(Y, C)], 0, 1, free),
        of("PRS", &[p(Z), r(Y, A), s(C)], 0, 1, free),
        of("RRS", &[r(Y, A), r(Y, B), s(C)], 0, 1, free),
        of("RPS", &[r(Y, A), p([-0.1, 0.0, 0.4]), s(C)], 1, 1, free),
        of("RRR", &[r(Y, A), r(Y, B), r(Y, C)], 0, 1, free),
        of("RRR about a point", &[r(X, A), r(Y, A), r(tilted, A)], 0, 1, free),
        of("RPPR", &[r(Z, A), p(X), p(Z), r(Y, C)], 1, 0, free),
        of("UPR", &[r(X, A), r(Y, A), p([-0.1, 0.0, 0.4]), r(Y, C)], 2, 1, free),
        of("PCU", &[p(X), r(Z, A), p(Z), r(X, C), r(Y, C)], 0, 1, free),
        of(
            "RRPaR",
            &[r(Y, A), r(Y, B), pa([0.3, 0.0, 0.25], B, [-0.25, 0.0, 0.3]), r(Y, C)],
            0,
            2,
            |q| {
                (q[3], q[4]) = (-q[2], -q[0] - q[1]);
            },
        ),
        of("PRPaR", &[p(X), r(Y, B), pa(X, B, [0.0, 0.02, 0.3]), r(Y, C)], 0, 2, |q| {
            (q[3], q[4]) = (-q[2], -q[1]);
        }),
        of("RPaR", &[r(Z, A), pa(Z, B, [-0.3, 0.1, 0.0]), r(Z, C)], 0, 1, |q| q[2] = -q[1]),
        of("RPaPaR", &[r(Z, A), pa(Y, A, d), pa(Y, B, [-0.2, 0.0, 0.1]), r(Z, C)], 0, 2, |q| {
            (q[2], q[4]) = (-q[1], -q[3]);
        }),
        of("PaS", &[pa(Y, A, d), s(C)], 0, 0, |q| q[1] = -q[0]),
        of("RC", &[r(X, A), r(Y, B), p(Y)], 0, 0, free),
        of("HH", &[h(Z, A, 0.02), h(Z, B, 0.03)], 0, 0, free),
        of("S", &[s(C)], 0, 0, free),
    ]
}

fn freedoms(joint: &LegJoint) -> usize {
    match joint {
        LegJoint::Screw { .. } | LegJoint::Slide { .. } => 1,
        LegJoint::Parallelogram { .. } => 2,
        LegJoint::Ball { .. } => 3,
    }
}

/// The displacement of a joint, by nalgebra's rotations.
fn exponential(joint: &LegJoint, q: &[f64]) -> Isometry3<f64> {
    let about = |point: Point3<f64>, rotation: UnitQuaternion<f64>| {
        let shift = point.coords - rotation * point.coords;
        Isometry3::from_parts(Translation3::from(shift), rotation)
    };
    match *joint {
        LegJoint::Screw { axis, point, pitch } => {
            let shift = Translation3::from(axis.into_inner() * (pitch * q[0]));
            shift * about(point, UnitQuaternion::from_axis_angle(&axis, q[0]))
        }
        LegJoint::Slide { axis } => Translation3::from(axis.into_inner() * q[0]).into(),
        LegJoint::Ball { point } => {
            about(point, UnitQuaternion::from_scaled_axis(Vector3::new(q[0], q[1], q[2])))
        }
        // Two hinges.
        LegJoint::Parallelogram { axis, point, arm } => {
            let [there, back] = [q[0], -q[0]].map(|q| UnitQuaternion::from_axis_angle(&axis, q));
            about(point, there) * about(point + arm, back)
        }
    }
}

fn forward(joints: &[LegJoint], q: &[f64]) -> Isometry3<f64> {
    let mut slot = 0;
    joints.iter().fold(Isometry3::identity(), |all, joint| {
        let one = exponential(joint, &q[slot..]);
        slot += freedoms(joint);
        all * one
    })
}

/// The displacement of the freedoms of a leg of a type by shares between -1 and 1.
fn values(leg: &Type, shares: &[f64; 7], angle: f64, length: f64) -> Vec<f64> {
    let mut q = Vec::new();
    for joint in &leg.joints {
        for _ in 0..freedoms(joint) {
            let slides = matches!(joint, LegJoint::Slide { .. });
            q.push(shares[q.len()] * if slides { length } else { angle });
        }
    }
    (leg.within)(&mut q);
    q
}

/// Numbers between -1 and 1.
fn random(seed: u64) -> impl Iterator<Item = [f64; 7]> {
    let mut random = fastrand::Rng::with_seed(seed);
    std::iter::repeat_with(move || [(); 7].map(|()| 2.0 * random.f64() - 1.0))
}

fn compiled(leg: &Type) -> WholeLeg {
    let motions: Vec<_> = random(1)
        .take(12)
        .map(|shares| forward(&leg.joints, &values(leg, &shares, 1.0, 0.15)))
        .collect();
    let mut actuated = vec![false; leg.joints.len()];
    actuated[leg.motor] = true;
    let whole = WholeLeg::new(&leg.joints, &actuated, &motions, SIZE, &[]);
    whole.unwrap_or_else(|error| panic!("{}: {error}", leg.name))
}

/// The values on each branch on which the target is in reach, and how far they are from it.
fn solved(leg: &Type, whole: &WholeLeg, g: &Isometry3<f64>) -> Vec<(Vec<f64>, f64)> {
    let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
    let mut all = Vec::new();
    for branches in whole.branches() {
        if whole.solve(g, [branches[0], branches[1]], &mut out).is_ok() {
            let found: Vec<f64> =
                out[..whole.freedoms()].iter().map(|joint| joint.value()).collect();
            let off = forward(&leg.joints, &found).to_homogeneous() - g.to_homogeneous();
            all.push((found, off.amax()));
        }
    }
    all
}

/// How far two configurations are apart. Of two balls, which may spin, and of one near half a turn, the values are not
/// compared.
fn apart(leg: &Type, a: &[f64], b: &[f64]) -> f64 {
    let mut slot = 0;
    let mut most = 0.0_f64;
    for joint in &leg.joints {
        let off = a[slot] - b[slot];
        most = match joint {
            LegJoint::Screw { .. } | LegJoint::Parallelogram { .. } => {
                most.max((off - TAU * (off / TAU).round()).abs())
            }
            LegJoint::Slide { .. } => most.max(off.abs() / SIZE),
            LegJoint::Ball { .. } => most,
        };
        slot += freedoms(joint);
    }
    most
}

/// The smallest singular value of the screws, lengths over the size, apart from spins of legs with two balls.
fn regularity(leg: &Type, q: &[f64]) -> f64 {
    let n = q.len();
    let step = 1e-6;
    let mut columns = nalgebra::DMatrix::zeros(6, n);
    for i in 0..n {
        let moved = |by: f64| {
            let mut q = q.to_vec();
            q[i] += by;
            forward(&leg.joints, &q)
        };
        let rest = moved(step) * moved(-step).inverse();
        let turn = rest.rotation.scaled_axis() / (2.0 * step);
        let shift = (rest * Point3::from(C) - Point3::from(C)) / (2.0 * step * SIZE);
        columns.fixed_view_mut::<3, 1>(0, i).copy_from(&turn);
        columns.fixed_view_mut::<3, 1>(3, i).copy_from(&shift);
    }
    // The second hinge of a parallelogram moves with the first one.
    let hinges = leg.joints.iter().filter(|joint| matches!(joint, LegJoint::Parallelogram { .. }));
    let rank = (n - hinges.count()).min(6);
    let values = columns.singular_values();
    values.iter().take(rank).fold(f64::INFINITY, |least, &one| least.min(one))
}

#[test]
fn more_than_two_parallelograms_are_refused() {
    let joints = [pa(X, A, Y), pa(Y, B, X), pa(Z, C, X)];
    let motions = [forward(&joints, &[0.1, -0.1, 0.2, -0.2, 0.3, -0.3])];
    let refused = WholeLeg::new(&joints, &[true; 3], &motions, SIZE, &[]).unwrap_err();
    assert_eq!(refused, NoOrder::Parallelograms { found: 3 });
}

#[test]
fn each_type_has_its_choices() {
    for leg in types() {
        let whole = compiled(&leg);
        assert_eq!(whole.choices(), leg.choices, "{}", leg.name);
        assert!(whole.choosing_joints().is_sorted(), "{}", leg.name);
        assert_eq!(whole.steps().count(), leg.joints.len(), "{}", leg.name);
    }
}

/// A leg that stands elsewhere, with other sampled motions, has the same order and the same branches.
#[test]
fn congruent_legs_have_the_same_order() {
    let place = Isometry3::new(Vector3::new(0.3, -0.8, 0.2), Vector3::new(0.4, 1.1, -0.9));
    for leg in types() {
        let turned =
            |axis: Unit<Vector3<f64>>| Unit::new_normalize(place.rotation * axis.into_inner());
        let stands = |joint: &LegJoint| match *joint {
            LegJoint::Screw { axis, point, pitch } => {
                LegJoint::Screw { axis: turned(axis), point: place * point, pitch }
            }
            LegJoint::Slide { axis } => LegJoint::Slide { axis: turned(axis) },
            LegJoint::Ball { point } => LegJoint::Ball { point: place * point },
            LegJoint::Parallelogram { axis, point, arm } => LegJoint::Parallelogram {
                axis: turned(axis),
                point: place * point,
                arm: place.rotation * arm,
            },
        };
        let joints: Vec<LegJoint> = leg.joints.iter().map(stands).collect();
        let motions: Vec<_> = random(9)
            .take(12)
            .map(|shares| forward(&joints, &values(&leg, &shares, 0.8, 0.12)))
            .collect();
        let mut actuated = vec![false; joints.len()];
        actuated[leg.motor] = true;
        let elsewhere = WholeLeg::new(&joints, &actuated, &motions, SIZE, &[]).unwrap();
        let whole = compiled(&leg);
        let steps = [&whole, &elsewhere].map(|leg| leg.steps().collect::<Vec<_>>());
        assert_eq!(steps[0], steps[1], "{}", leg.name);
        let known = WholeLeg::new(&joints, &actuated, &motions, SIZE, &[&whole]).unwrap();
        assert_eq!(known.program, elsewhere.program, "{}", leg.name);
        for shares in random(5).take(40) {
            let q = values(&leg, &shares, 1.0, 0.15);
            let g = forward(&leg.joints, &q);
            for branches in whole.branches() {
                let mut outs = [[JointDisplacement::Value(0.0); MOST_FREEDOMS]; 2];
                let one = whole.solve(&g, [branches[0], branches[1]], &mut outs[0]);
                let there = place * g * place.inverse();
                let two = elsewhere.solve(&there, [branches[0], branches[1]], &mut outs[1]);
                if let (Ok(()), Ok(())) = (one, two) {
                    let [one, two] = outs.map(|out| out.map(JointDisplacement::value));
                    if regularity(&leg, &one[..whole.freedoms()]) > REGULAR {
                        assert!(apart(&leg, &one, &two) < ROUNDING, "{}", leg.name);
                    }
                }
            }
        }
    }
}

#[test]
fn home_displaces_no_joint() {
    for leg in types() {
        let home = solved(&leg, &compiled(&leg), &Isometry3::identity());
        let zero = |(found, _): &(Vec<f64>, f64)| found.iter().all(|q| q.abs() < 1e-7);
        assert!(home.iter().any(zero), "{}: {home:?}", leg.name);
    }
}

#[test]
fn joints_are_among_the_branches() {
    for leg in types() {
        let whole = compiled(&leg);
        let mut regular = 0;
        for shares in random(2).take(300) {
            let q = values(&leg, &shares, 1.2, 0.2);
            let found = solved(&leg, &whole, &forward(&leg.joints, &q));
            for (_, off) in &found {
                assert!(*off < 3.0 * CLOSURE, "{}: {off:e}", leg.name);
            }
            if regularity(&leg, &q) < REGULAR {
                continue;
            }
            regular += 1;
            let nearest = found.iter().map(|(one, _)| apart(&leg, one, &q));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest < ROUNDING, "{}: {q:?}: {nearest:e}", leg.name);
            for (i, (one, _)) in found.iter().enumerate() {
                for (two, _) in &found[i + 1..] {
                    let near = apart(&leg, one, two) < ROUNDING;
                    let meet = regularity(&leg, one) < 1e-4;
                    assert!(!near || meet, "{}: {one:?}", leg.name);
                }
            }
        }
        assert!(regular > 30, "{}: {regular}", leg.name);
    }
}

/// Zeros, right angles and stretched legs: at some of them joints are free, or branches meet.
#[test]
fn special_configurations_close() {
    for leg in types() {
        let whole = compiled(&leg);
        for number in 0..3_usize.pow(7) {
            let digit = |i: u32| [0.0, 1.0, -1.0][number / 3_usize.pow(i) % 3];
            let shares = [0, 1, 2, 3, 4, 5, 6].map(digit);
            for angle in [FRAC_PI_2, PI] {
                let q = values(&leg, &shares, angle, 0.1);
                let found = solved(&leg, &whole, &forward(&leg.joints, &q));
                assert!(!found.is_empty(), "{}: {q:?}", leg.name);
                for (_, off) in &found {
                    assert!(*off < 3.0 * CLOSURE, "{}: {off:e}", leg.name);
                }
            }
        }
    }
}

/// Where the general case holds, it gives what the solution does.
#[test]
fn the_general_case_is_the_solution() {
    for leg in types() {
        let whole = compiled(&leg);
        let mut held = 0;
        for shares in random(4).take(40) {
            let g = forward(&leg.joints, &values(&leg, &shares, 1.0, 0.1));
            let rotation = g.rotation.to_rotation_matrix().into_inner();
            for branches in whole.branches() {
                let signs = branches.map(Branch::sign);
                let mut roots = General::new(whole.size());
                let target = (rotation, g.translation.vector);
                let general = whole.run::<f64>(target, [signs[0], signs[1]], &mut roots);
                let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
                let solved = whole.solve(&g, [branches[0], branches[1]], &mut out);
                if roots.doubt() + general.open() <= CLOSURE * CLOSURE {
                    held += 1;
                    assert!(solved.is_ok(), "{}", leg.name);
                    let mut slot = 0;
                    for joint in &leg.joints {
                        if freedoms(joint) == 1 {
                            assert_eq!(out[slot], general.displacement(slot), "{}", leg.name);
                        }
                        slot += freedoms(joint);
                    }
                }
            }
        }
        assert!(held >= 20, "{}: {held}", leg.name);
    }
}

fn typed(name: &str) -> (Type, WholeLeg) {
    let leg = types().into_iter().find(|leg| leg.name == name).unwrap();
    let whole = compiled(&leg);
    (leg, whole)
}

proptest! {
    /// The actuated length of a hexapod's leg is the distance of its ends, wherever the platform is.
    #[test]
    fn length_of_a_hexapod_leg(
        shift in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
        turn in [-1.7..1.7_f64, -1.7..1.7, -1.7..1.7],
    ) {
        let g = Isometry3::new(shift.into(), turn.into());
        for name in ["UPS", "SPS"] {
            let (leg, whole) = typed(name);
            let length = |b: Point3<f64>| (b - Point3::from(A)).norm();
            let aim = g * Point3::from(D);
            let slot = if name == "UPS" { 2 } else { 3 };
            let found = solved(&leg, &whole, &g);
            prop_assert_eq!(found.len(), 1 << leg.choices);
            for (joints, off) in found {
                prop_assert!(off < 3.0 * CLOSURE);
                let moved = forward(&leg.joints[..leg.motor + 1], &joints) * Point3::from(D);
                prop_assert!((length(moved) - length(aim)).abs() < 1e-12);
                // The axis meets both centres.
                let by = length(Point3::from(D)) + joints[slot];
                prop_assert!((by.abs() - length(aim)).abs() < 1e-12);
            }
        }
    }

    /// The crank of a leg with a rod, by the circle that its end moves on and the sphere about the platform's joint; the rod's
    /// excess where they do not meet.
    #[test]
    fn crank_by_circle_and_sphere(
        shift in [-0.7..0.7_f64, -0.7..0.7, -0.7..0.7],
        turn in [-1.7..1.7_f64, -1.7..1.7, -1.7..1.7],
    ) {
        let (_, whole) = typed("RSS");
        let g = Isometry3::new(shift.into(), turn.into());
        let aim = g * Point3::from(C) - Point3::from(A);
        let crank = Point3::from(B) - Point3::from(A);
        let rod = (Point3::from(C) - Point3::from(B)).norm();
        // In the plane of the circle, which is across y.
        let (reach, radius) = (aim.x.hypot(aim.z), crank.norm());
        let square = rod * rod - aim.y * aim.y;
        let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
        let cosine = (reach * reach + radius * radius - square) / (2.0 * reach * radius);
        for branch in Branch::BOTH {
            let found = whole.solve(&g, [branch; 2], &mut out);
            if cosine.abs() <= 1.0 {
                prop_assert!(found.is_ok());
                let end = exponential(&r(Y, A), &[out[0].value()]) * Point3::from(B);
                prop_assert!(((end - Point3::from(A) - aim).norm() - rod).abs() < 1e-9);
                let between = (end - Point3::from(A)).dot(&Vector3::new(aim.x, 0.0, aim.z));
                prop_assert!((between / (radius * reach) - cosine).abs() < 1e-7);
                // The end nears the aim as the crank turns on, or leaves it.
                let rate = Vector3::y().cross(&(end - Point3::from(A))).dot(&aim);
                prop_assert!(rate * branch.sign() > -1e-9);
            } else {
                let nearest = (reach - radius).hypot(aim.y);
                let furthest = (reach + radius).hypot(aim.y);
                let excess = if cosine > 1.0 { nearest - rod } else { rod - furthest };
                let deficit = found.unwrap_err();
                prop_assert!((deficit.excess - excess).abs() < 1e-9, "{:?} {}", deficit, excess);
                prop_assert_eq!(deficit.quantity, crate::numeric::Quantity::Length);
            }
        }
    }
}

#[test]
fn a_rotation_is_out_of_reach_of_a_leg_that_has_none() {
    let (_, whole) = typed("PRRR");
    let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
    let g = Isometry3::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 0.01));
    for branch in Branch::BOTH {
        let deficit = whole.solve(&g, [branch; 2], &mut out).unwrap_err();
        assert!(deficit.excess > 1e-3, "{deficit:?}");
    }
}

/// Skew axes give two equations in two joints: a quartic.
#[test]
fn a_leg_without_an_order_says_which_joints_are_coupled() {
    let joints =
        [r(X, A), r([0.3, 1.0, 0.2], B), r([0.1, 0.2, 1.0], [0.0, 0.3, 0.3]), s([0.3, 0.1, 0.6])];
    let leg =
        Type { name: "skew RRRS", joints: joints.to_vec(), motor: 0, choices: 0, within: |_| {} };
    let motions: Vec<_> = random(3)
        .take(6)
        .map(|shares| forward(&leg.joints, &values(&leg, &shares, 0.5, 0.0)))
        .collect();
    let error =
        WholeLeg::new(&joints, &[true, false, false, false], &motions, SIZE, &[]).unwrap_err();
    assert_eq!(error, NoOrder::Coupled { joints: vec![0, 1, 2, 3] });
    assert!(error.to_string().starts_with("joints 0, 1, 2 and 3 "), "{error}");
}
