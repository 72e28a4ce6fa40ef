//! Singularities: compared with the paper's formulas, at poses that are singular by construction,
//! and with the Jacobians on random mechanisms of every pair of subspaces.

use fastrand::Rng;
use nalgebra::{DMatrix, Matrix3, Vector2, Vector3};
use opm_core::decomposition::{Decomposition, Freedom};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{Manipulator, Mode, Section, Solution};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::family::plano_spherical::Home;
use opm_core::mechanism::joint::{JointKind, Quantity};
use opm_core::velocity::{
    Cause, Conditioning, Jacobians, SINGULAR, SingularCause, SingularLeg, Singularities,
};
use opm_tests::displace::{displace, displace_decomposition};
use opm_tests::height;
use opm_tests::paper::{self, PlanoSpherical, Signs, e, n};
use opm_tests::random;
use opm_tests::random::{Options, PAIRS, displacement, mechanism};
use std::f64::consts::{PI, TAU};

/// Relative tolerance for a number that is computed in two ways.
const AGREE: f64 = 1e-9;

/// All quantities at one pose.
struct AtPose {
    at: Solution,
    jacobians: Jacobians,
    measured: Singularities,
    conditioning: Conditioning,
}

fn look(manipulator: &Manipulator, pose: &[f64], mode: Mode) -> Option<AtPose> {
    let mut at = manipulator.solution();
    manipulator.inverse(pose, mode, &mut at).unwrap().is_some().then(|| measure(manipulator, at))
}

fn measure(manipulator: &Manipulator, at: Solution) -> AtPose {
    let (mut jacobians, mut measured) = (manipulator.jacobians(), manipulator.singularities());
    let regular = manipulator.differentiate(&at, &mut jacobians).unwrap();
    assert_eq!(regular, jacobians.singular.is_empty());
    manipulator.measure_singularities(&jacobians, &mut measured);
    let length = manipulator.characteristic_length();
    let conditioning = manipulator.conditioning(&jacobians, length);
    assert!(conditioning.condition >= 1.0 && conditioning.manipulability >= 0.0);
    let matrices = [&jacobians.upper, &jacobians.lower, &jacobians.joints, &jacobians.pose];
    assert!(matrices.iter().all(|m| m.iter().all(|x| x.is_finite())));
    AtPose { at, jacobians, measured, conditioning }
}

/// A random plano-spherical manipulator without limits, and the working mode in which it is
/// assembled.
fn random(rng: &mut Rng) -> Option<(PlanoSpherical, Signs, Manipulator)> {
    let paper = PlanoSpherical::random(rng);
    let signs = Signs::random(rng);
    let mut near = |by: f64| by * (2.0 * rng.f64() - 1.0);
    let home = Home { x: near(0.05), y: near(0.05), zeta: near(PI), xi: near(0.5), psi: near(PI) };
    let mechanism = paper.family(home, &signs).assemble().ok()?;
    Some((paper, signs, Manipulator::new(mechanism).ok()?))
}

/// The paper's quantities for a leg at a pose: `v × w`, and the vector of link a1.
fn leg_vectors(
    paper: &PlanoSpherical,
    pose: &[f64; 5],
    joints: &paper::Joints,
    i: usize,
) -> (Vector3<f64>, Vector2<f64>) {
    let leg = &paper.legs[i];
    let rho = paper::rotation(pose[2], pose[3], pose[4]);
    let v = Vector3::from(leg.proximal_axis(joints.theta[i]));
    let w = Vector3::from(leg.platform_axis(&rho));
    let c = Vector2::new(pose[0], pose[1]) + leg.a2 * Vector2::from(e(joints.theta[i]));
    let slider =
        leg.h * Vector2::from(e(leg.alpha)) + joints.slider[i] * Vector2::from(n(leg.alpha));
    (v.cross(&w), c - slider)
}

#[test]
fn the_first_manipulators_are_the_papers() {
    let mut rng = Rng::with_seed(80);
    let mut compared = 0;
    while compared < 300 {
        let Some((paper, signs, manipulator)) = random(&mut rng) else { continue };
        let mut near = |by: f64| by * (2.0 * rng.f64() - 1.0);
        let pose = [near(0.07), near(0.07), near(PI), near(0.6), near(PI)];
        let Some(joints) = paper.inverse(&pose, &signs) else { continue };
        let mode = manipulator.parse_mode(&signs.written()).unwrap();
        let Some(found) = look(&manipulator, &pose, mode) else { continue };
        if found.measured.whole.serial.abs() < 1e-4 {
            continue;
        }
        let mut rows = Matrix3::zeros();
        let (mut lower, mut parallel, mut upper) = (1.0, 1.0, 1.0);
        for i in 0..3 {
            let (cross, link) = leg_vectors(&paper, &pose, &joints, i);
            let leg = &paper.legs[i];
            rows.set_row(i, &cross.transpose());
            let serial = [link.dot(&Vector2::from(n(leg.alpha))) / leg.a1, cross.z];
            for (found, known) in found.measured.legs[i].iter().zip(serial) {
                assert!((found.abs() - known.abs()).abs() < AGREE, "{found} {known}");
            }
            lower *= serial[0];
            upper *= serial[1];
            parallel *= link.dot(&Vector2::from(n(joints.theta[i]))) / leg.a1;
        }
        lower *= joints.arm[1].sin();
        for (found, known) in [
            (found.measured.upper.serial, upper),
            (found.measured.upper.parallel.unwrap(), rows.determinant()),
            (found.measured.lower.serial, lower),
            (found.measured.lower.parallel.unwrap(), parallel),
            (found.measured.whole.serial, upper * lower),
            (found.measured.whole.parallel.unwrap(), parallel * rows.determinant()),
            (found.measured.coordinates, pose[3].sin()),
        ] {
            assert!((found.abs() - known.abs()).abs() < AGREE, "{found} {known}");
        }
        // J_s and J_p are those of the paper.
        let rho = paper::rotation(pose[2], pose[3], pose[4]);
        let [direct, inverse] = paper.spherical_jacobians(&rho, &joints.theta);
        let known = inverse.try_inverse().unwrap() * direct;
        assert!((&found.jacobians.upper - known).amax() < AGREE * known.amax());
        let [direct, inverse] = paper.planar_jacobians([pose[0], pose[1]], &joints);
        let known = inverse.try_inverse().unwrap() * direct;
        assert!((&found.jacobians.lower - known).amax() < 1e3 * AGREE * known.amax());
        compared += 1;
    }
}

/// Poses of a random first manipulator that are singular by geometry, each with the leg and the
/// kind of singularity.
#[derive(Clone, Copy, Debug)]
enum SingularPose {
    /// Link a1 is perpendicular to its slider.
    LinkSquare,
    /// The arm is stretched.
    ArmStretched,
    /// The spherical links are in one plane.
    Coplanar,
    /// The links a1 and a2 are in line.
    InLine,
}

/// A pose at such a singularity, or slightly beside it (`off`), and the cause.
fn singular_pose(
    rng: &mut Rng,
    paper: &PlanoSpherical,
    signs: &Signs,
    kind: SingularPose,
    off: f64,
) -> Option<([f64; 5], usize)> {
    let mut near = |by: f64| by * (2.0 * rng.f64() - 1.0);
    let mut pose = [near(0.07), near(0.07), near(PI), near(0.6), near(PI)];
    let i = (near(1.5) + 1.5).floor().min(2.0) as usize;
    let leg = &paper.legs[i];
    // The orientation alone determines the imaginary joint.
    let theta = |pose: &[f64; 5]| -> Option<f64> {
        let rho = paper::rotation(pose[2], pose[3], pose[4]);
        let w = leg.platform_axis(&rho);
        let k = (leg.arc2.cos() - leg.arc1.cos() * w[2])
            / (leg.arc1.sin() * (w[0] * w[0] + w[1] * w[1]).sqrt());
        (k.abs() < 0.99)
            .then(|| w[1].atan2(w[0]) + if signs.legs[i][0] { k.asin() } else { PI - k.asin() })
    };
    match kind {
        SingularPose::LinkSquare => {
            // The condition Q · e(alpha) = a1 with Q = P + a2 e(theta) - h e(alpha).
            let along = Vector2::from(e(leg.alpha));
            let p = Vector2::new(pose[0], pose[1]);
            let q = p + leg.a2 * Vector2::from(e(theta(&pose)?)) - leg.h * along;
            let p = p + along * (leg.a1 - off * leg.a1 - q.dot(&along));
            (pose[0], pose[1]) = (p.x, p.y);
            Some((pose, i))
        }
        SingularPose::ArmStretched => {
            let reach = (paper.b[0] + paper.b[1]) * (1.0 - off);
            let towards = e(near(PI));
            pose[0] = paper.d[0] + reach * towards[0];
            pose[1] = paper.d[1] + reach * towards[1];
            Some((pose, 3))
        }
        SingularPose::Coplanar => {
            // The condition w = Rz(zeta) Ry(arc1 + arc2) z.
            let farthest = (leg.arc1 + leg.arc2).min(TAU - leg.arc1 - leg.arc2);
            pose[3] = farthest - off - leg.beta;
            pose[4] = -leg.eta;
            Some((pose, i))
        }
        SingularPose::InLine => {
            // The condition C - A = a1 e(theta) with P = C - a2 e(theta).
            let theta = theta(&pose)? + off;
            let slider = near(0.1);
            let a = leg.h * Vector2::from(e(leg.alpha)) + slider * Vector2::from(n(leg.alpha));
            let p = a + leg.a1 * Vector2::from(e(theta)) - leg.a2 * Vector2::from(e(theta - off));
            (pose[0], pose[1]) = (p.x, p.y);
            Some((pose, i))
        }
    }
}

#[test]
fn measures_vanish_where_geometry_says_so() {
    let mut rng = Rng::with_seed(81);
    for kind in [
        SingularPose::LinkSquare,
        SingularPose::ArmStretched,
        SingularPose::Coplanar,
        SingularPose::InLine,
    ] {
        let (mut compared, mut made) = (0, None);
        for round in 0..20_000 {
            if round % 100 == 0 {
                made = random(&mut rng);
            }
            let Some((paper, signs, manipulator)) = &made else { continue };
            let seed = rng.u64(..);
            let at = |off: f64| singular_pose(&mut Rng::with_seed(seed), paper, signs, kind, off);
            let (Some((pose, leg)), Some((beside, _)), Some((far, _))) =
                (at(0.0), at(1e-6), at(1e-3))
            else {
                continue;
            };
            // In line, the sign of the root decides the slider's position.
            let modes: Vec<Mode> = {
                let mut all = manipulator.all_modes();
                manipulator.inverse_all(&pose, &mut all).unwrap();
                all.modes(manipulator).collect()
            };
            let own = signs.written();
            let agrees = |mode: &Mode| {
                let text = manipulator.format_mode(*mode);
                let signs: Vec<char> = text.chars().filter(|c| *c != ' ').collect();
                let own: Vec<char> = own.chars().filter(|c| *c != ' ').collect();
                (0..7).all(|i| signs[i] == own[i] || i == 2 * leg + 1 && leg < 3)
            };
            let founds = modes
                .into_iter()
                .filter(agrees)
                .filter_map(|mode| Some((mode, look(manipulator, &pose, mode)?)));
            let value = |found: &AtPose| match kind {
                SingularPose::LinkSquare | SingularPose::ArmStretched => {
                    found.measured.lower.serial
                }
                SingularPose::Coplanar => found.measured.upper.serial,
                SingularPose::InLine => found.measured.lower.parallel.unwrap(),
            };
            let smallest = |(_, a): &(Mode, AtPose), (_, b): &(Mode, AtPose)| {
                value(a).abs().total_cmp(&value(b).abs())
            };
            let Some((mode, found)) = founds.min_by(smallest) else { continue };
            // Other legs must not be near singularities of their own.
            let serial = |found: &AtPose, section: usize| {
                let others = found.measured.legs.iter().enumerate();
                others.filter(|(i, _)| *i != leg).map(|(_, m)| m[section].abs()).fold(1.0, f64::min)
            };
            if serial(&found, 0).min(serial(&found, 1)) < 0.1 {
                continue;
            }
            assert!(value(&found).abs() < SINGULAR, "{kind:?} {}", value(&found));
            let product = match kind {
                SingularPose::InLine => found.measured.whole.parallel.unwrap(),
                _ => found.measured.whole.serial,
            };
            assert!(product.abs() < SINGULAR, "{kind:?} {product}");

            let (Some(beside), Some(far)) =
                (look(manipulator, &beside, mode), look(manipulator, &far, mode))
            else {
                continue;
            };
            let blurred = |found: &AtPose| {
                let [upper, lower] = [found.measured.upper, found.measured.lower]
                    .map(|section| section.parallel.unwrap().abs());
                upper < 0.05 || !matches!(kind, SingularPose::InLine) && lower < 0.05
            };
            if blurred(&found) || blurred(&far) {
                continue;
            }
            let [at, near, away] =
                [&found, &beside, &far].map(|found| found.conditioning.condition);
            assert!(at > 3.0 * near && near > 3.0 * away, "{kind:?}: {at} {near} {away}");
            let expected =
                |section, cause| vec![SingularLeg { leg, section: Some(section), cause }];
            match kind {
                SingularPose::InLine => {
                    assert!(found.jacobians.singular.is_empty());
                    assert!(at > 1e6, "{at}");
                    let causes = manipulator.parallel_causes(&found.measured, Section::Lower);
                    assert_eq!(causes, [Cause { leg, section: Section::Lower }]);
                }
                _ => {
                    let section = match kind {
                        SingularPose::Coplanar => Section::Upper,
                        _ => Section::Lower,
                    };
                    assert!(at.is_infinite() && found.conditioning.manipulability == 0.0);
                    assert_eq!(found.jacobians.singular, expected(section, SingularCause::Serial));
                    let cause = manipulator.serial_cause(&found.measured, section);
                    assert_eq!(cause, Some(Cause { leg, section }));
                    only_that_leg_stands_still(manipulator, &found, &beside);
                }
            }
            compared += 1;
        }
        println!("{kind:?}: {compared}");
        assert!(compared > 100, "{kind:?}: {compared}");
    }
}

/// At a serial singularity the other legs move as they do next to it, and no value is NaN.
fn only_that_leg_stands_still(manipulator: &Manipulator, found: &AtPose, beside: &AtPose) {
    let rates = [0.3, -0.2, 0.5, 0.4, -0.6];
    let (mut motion, mut near) = (manipulator.joint_motion(), manipulator.joint_motion());
    assert!(!manipulator.velocity(&found.at, &rates, &rates, &mut motion).unwrap());
    assert!(manipulator.velocity(&beside.at, &rates, &rates, &mut near).unwrap());
    let lost: Vec<usize> = manipulator.rateless(&motion.singular[0]).collect();
    assert!(!lost.is_empty() && lost.len() < motion.joint_rates.len());
    let size = near.joint_rates.iter().fold(1.0_f64, |size, r| size.max(r.abs()));
    for (i, (rate, near)) in motion.joint_rates.iter().zip(&near.joint_rates).enumerate() {
        assert!(rate.is_finite() && motion.joint_accelerations[i].is_finite());
        if lost.contains(&i) {
            assert_eq!(*rate, 0.0);
        } else {
            assert!((rate - near).abs() < 1e-3 * size, "{rate} {near}");
        }
    }
    let imaginary = manipulator.rateless_imaginary(&motion.singular[0]);
    assert_eq!(imaginary.is_some(), motion.singular[0].section == Some(Section::Upper));
}

/// The parallel singularity of the spherical section: a root of the paper's determinant, between
/// two poses of opposite sign.
#[test]
fn the_upper_sections_parallel_measure_changes_sign_at_the_papers_root() {
    let mut rng = Rng::with_seed(82);
    let (mut compared, mut made) = (0, None);
    for round in 0..20_000 {
        if round % 100 == 0 {
            made = random(&mut rng);
        }
        let Some((paper, signs, manipulator)) = &made else { continue };
        let mode = manipulator.parse_mode(&signs.written()).unwrap();
        let mut near = |by: f64| by * (2.0 * rng.f64() - 1.0);
        let mut pose = [near(0.03), near(0.03), near(PI), near(0.9), near(PI)];
        let turn = near(1.0);
        let mut determinant = |t: f64| -> Option<f64> {
            pose[3] += t * turn;
            let joints = paper.inverse(&pose, signs);
            let rows = joints.map(|joints| {
                let row = |i| leg_vectors(paper, &pose, &joints, i).0.transpose();
                Matrix3::from_rows(&[row(0), row(1), row(2)]).determinant()
            });
            pose[3] -= t * turn;
            rows
        };
        let (Some(start), Some(end)) = (determinant(0.0), determinant(1.0)) else { continue };
        if start * end >= 0.0 {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut lost = false;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match determinant(middle) {
                Some(value) if value * start > 0.0 => low = middle,
                Some(_) => high = middle,
                None => lost = true,
            }
        }
        if lost {
            continue;
        }
        let at = |t: f64| {
            let mut moved = pose;
            moved[3] += t * turn;
            look(manipulator, &moved, mode)
        };
        let founds = [at(low), at(low - 1e-4), at(low + 1e-4)];
        let [Some(found), Some(before), Some(after)] = founds else { continue };
        if found.measured.whole.serial.abs() < 0.01 || before.measured.whole.serial.abs() < 0.01 {
            continue;
        }
        let value = |found: &AtPose| found.measured.upper.parallel.unwrap();
        assert!(value(&found).abs() < 1e-12, "{}", value(&found));
        assert!(value(&before) * value(&after) < 0.0);
        assert!(found.conditioning.condition > 1e3 * before.conditioning.condition.min(1e6));
        let causes = manipulator.parallel_causes(&found.measured, Section::Upper);
        assert!(causes.iter().all(|c| c.section == Section::Upper && c.leg < 3));
        assert!(causes.len() >= 2, "{causes:?}: wrenches that depend on one another");
        compared += 1;
        if compared == 100 {
            return;
        }
    }
    panic!("{compared} singular poses");
}

/// A random mechanism with as many actuators as freedoms, anywhere in its legs.
fn actuated(rng: &mut Rng, mechanism: &mut Mechanism, count: usize) -> bool {
    mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints).for_each(|j| j.actuated = false);
    let mut joints: Vec<_> = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints).collect();
    rng.shuffle(&mut joints);
    let mut left = count;
    for joint in joints {
        if joint.freedoms() <= left {
            left -= joint.freedoms();
            joint.actuated = true;
        }
    }
    left == 0
}

/// `det J = c · parallel / serial`, with one constant for all poses and modes of a mechanism. The
/// measures of the closures, which have no poles, are compared with the Jacobian, which is compared
/// with differences elsewhere.
#[test]
fn measures_are_numerator_and_denominator_of_the_jacobian() {
    let mut rng = Rng::with_seed(83);
    for pair in PAIRS {
        let mut compared = 0;
        for _ in 0..100 {
            let options = Options { limited: 0.0, balls: false };
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let freedoms = decomposition.mobility;
            if !actuated(&mut rng, &mut mechanism, freedoms) {
                continue;
            }
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut all = manipulator.all_modes();
            // What carries a height has no part in the rest, but for an imaginary joint that has a part in the height.
            let driven = |leg: usize, freedoms: &[Freedom], class: &SubspaceClass, lift: bool| {
                let leg = &manipulator.mechanism().legs[leg];
                let own = freedoms.iter().filter(|f| height::is_lift(leg, **f, class) == lift);
                own.into_iter().any(|freedom| leg.joints[freedom.joint].actuated)
            };
            let d = manipulator.decomposition();
            // A section that passes no motion on to an actuator is not a part of the Jacobian. Sections that
            // share no motion pass none on to each other.
            let bridged = manipulator.task().shared().is_some();
            let parts: Vec<[bool; 2]> = (d.legs.iter().enumerate())
                .map(|(i, split)| {
                    let lower = driven(i, &split.lower, &d.lower, false);
                    let upper = driven(i, &split.upper, &d.upper, false);
                    let lifted = height::inclined(d).is_some()
                        && (driven(i, &split.lower, &d.lower, true)
                            || driven(i, &split.upper, &d.upper, true));
                    let passes_on = bridged && !split.imaginary && (upper || lifted);
                    [lower || passes_on, split.imaginary || upper]
                })
                .collect();
            let mut constant: Option<f64> = None;
            for _ in 0..6 {
                let home = manipulator.home_pose();
                let pose: Vec<f64> = home.iter().map(|q| q + rng.f64() - 0.5).collect();
                manipulator.inverse_all(&pose, &mut all).unwrap();
                for mode in all.modes(&manipulator) {
                    let mut at = manipulator.solution();
                    assert!(manipulator.solution_in_mode(&all, mode, &mut at).is_some());
                    let found = measure(&manipulator, at);
                    let rows = manipulator.actuated();
                    let jacobian = DMatrix::from_fn(freedoms, freedoms, |i, j| {
                        found.jacobians.joints[(rows[i], j)]
                    });
                    let parallel = found.measured.whole.parallel.unwrap();
                    let legs = found.measured.legs.iter().flatten();
                    let serial: f64 = (legs.zip(parts.iter().flatten()))
                        .filter_map(|(measure, part)| part.then_some(measure))
                        .product();
                    // If only rounding is left, there is nothing to compare.
                    if serial.abs() < 1e-5 || parallel.abs() < 1e-6 {
                        continue;
                    }
                    let ratio = jacobian.determinant() * serial / parallel;
                    let constant = *constant.get_or_insert(ratio);
                    let off = (ratio / constant - 1.0).abs();
                    assert!(off < 1e-5, "{pair:?}: {ratio} {constant}");
                    compared += 1;
                }
            }
        }
        println!("{pair:?}: {compared}");
        assert!(compared > 40, "{pair:?}: {compared}");
    }
}

/// The mechanism scaled by a factor.
fn scaled(
    mechanism: &Mechanism,
    decomposition: &Decomposition,
    size: f64,
) -> (Mechanism, Decomposition) {
    let (mut mechanism, mut decomposition) = (mechanism.clone(), decomposition.clone());
    mechanism.platform *= size;
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        joint.point *= size;
        if let JointKind::Helical { pitch } = &mut joint.kind {
            *pitch *= size;
        }
        let lengths = joint.coordinates.iter_mut().filter(|c| c.quantity == Quantity::Length);
        lengths.for_each(|coordinate| coordinate.home *= size);
    }
    let Decomposition { lower, upper, intersection, .. } = &mut decomposition;
    for class in [lower, upper, intersection] {
        match class {
            SubspaceClass::Spherical { centre: point }
            | SubspaceClass::Cylindrical { point, .. }
            | SubspaceClass::Rotation { point, .. } => *point *= size,
            _ => {}
        }
    }
    (mechanism, decomposition)
}

/// The measures do not depend on the mechanism's pose in space and on its size, except for their
/// signs, which depend on the frames.
#[test]
fn measures_do_not_depend_on_place_and_size() {
    let mut rng = Rng::with_seed(84);
    let mut lengthless = 0;
    for pair in PAIRS {
        let mut compared = 0;
        for round in 0..100 {
            let options = Options { limited: 0.0, balls: round % 2 == 0 };
            let (here, decomposition) = mechanism(&mut rng, pair, options);
            let size = 10.0_f64.powf(rng.f64() * 4.0 - 2.0);
            let g = displacement(&mut rng);
            let (there, moved) = scaled(&here, &decomposition, size);
            let (there, moved) = (displace(&there, &g), displace_decomposition(&moved, &g));
            let here = Manipulator::with_decomposition(here, decomposition).unwrap();
            let there = Manipulator::with_decomposition(there, moved).unwrap();
            let mode = here.home_mode();
            let home = here.home_pose();
            let pose: Vec<f64> = home.iter().map(|q| q + 0.6 * (rng.f64() - 0.5)).collect();
            let Some(found) = look(&here, &pose, mode) else { continue };
            let mut way = here.task().displacement(&pose);
            way.translation.vector *= size;
            let Ok(other) = there.locate(&(g * way * g.inverse())) else {
                panic!("{pair:?}: the displaced platform is not located")
            };
            // The same configuration: the signs of modes depend on the frames.
            let mut all = there.all_modes();
            there.inverse_all(&other, &mut all).unwrap();
            let off = |at: &Solution| -> f64 {
                let each = here.coordinates().iter().zip(found.at.joints()).zip(at.joints());
                let off =
                    |((c, a), b): ((&opm_core::mechanism::joint::JointCoordinate, &f64), &f64)| {
                        match c.quantity {
                            Quantity::Length => (a - b / size).abs(),
                            // The components of a rotation vector are in base coordinates.
                            Quantity::Angle if c.name.ends_with(['x', 'y', 'z']) => 0.0,
                            Quantity::Angle => {
                                let off = (a - b).rem_euclid(TAU);
                                off.min(TAU - off)
                            }
                        }
                    };
                each.map(off).sum()
            };
            let mut at = there.solution();
            let nearest = all.modes(&there).map(|mode| {
                assert!(there.solution_in_mode(&all, mode, &mut at).is_some());
                (off(&at), at.clone())
            });
            let (off, at) = nearest.min_by(|(a, _), (b, _)| a.total_cmp(b)).unwrap();
            if found.measured.legs.iter().flatten().any(|m| m.abs() < 0.02) {
                continue;
            }
            assert!(off < 1e-5, "{pair:?}: {off:e}");
            let same = measure(&there, at);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-5 * a.abs().max(1.0);
            for section in [
                [found.measured.upper, same.measured.upper],
                [found.measured.lower, same.measured.lower],
                [found.measured.whole, same.measured.whole],
            ] {
                let [a, b] = section;
                assert!(close(a.serial.abs(), b.serial.abs()), "{pair:?} {a:?} {b:?}");
                let (a, b) = (a.parallel, b.parallel);
                assert_eq!(a.is_none(), b.is_none());
                assert!(
                    close(a.unwrap_or(0.0).abs(), b.unwrap_or(0.0).abs()),
                    "{pair:?} {a:?} {b:?}"
                );
            }
            let [a, b] = [found.conditioning, same.conditioning];
            if here.characteristic_length() == 1.0 && there.characteristic_length() == 1.0 {
                // Sliders and a single axis, or a single centre: the mechanism has no length of its own.
                let planar = |kind: &random::RandomSubspace| {
                    matches!(kind, random::RandomSubspace::Planar(_))
                };
                lengthless += usize::from(pair.iter().any(planar));
            } else if a.condition < 1e4 {
                assert!(close(a.condition / b.condition, 1.0), "{pair:?} {a:?} {b:?}");
                assert!(close(a.manipulability / b.manipulability, 1.0), "{pair:?} {a:?} {b:?}");
            } else {
                assert!(b.condition > 1e3, "{pair:?} {a:?} {b:?}");
            }
            compared += 1;
        }
        println!("{pair:?}: {compared}");
        assert!(compared > 20, "{pair:?}: {compared}");
    }
    // Where there are pivots, most mechanisms have more than one.
    assert!(lengthless < 200, "{lengthless} without a length");
}
