//! Mechanisms whose legs all move in one subgroup: published results of those that are shipped, and what one
//! section means for the rest of the library.

use fastrand::Rng;
use nalgebra::{Complex, Rotation3, UnitQuaternion, Vector3};
use opm_core::Manipulator;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::NoClosedForm;
use opm_tests::random::direction;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A planar place: the platform's point and angle.
type PlanarPlace = (Complex<f64>, f64);

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// The distance of two angles, radians.
fn apart(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// All places of a triangle with two corners on two circles and the third on another, found by scanning the
/// first circle for changes of sign and bisecting: nothing of it is shared with the library.
fn triangle_on_circles(
    bases: [Complex<f64>; 3],
    radii: [f64; 3],
    corners: [Complex<f64>; 3],
) -> Vec<PlanarPlace> {
    const STEPS: usize = 20_000;
    let side = corners[1] - corners[0];
    let place = |t: f64, sign: f64| -> Option<(f64, PlanarPlace)> {
        let first = bases[0] + Complex::from_polar(radii[0], t);
        let across = bases[1] - first;
        let (d, s) = (across.norm(), side.norm());
        let cosine = (d * d + s * s - radii[1] * radii[1]) / (2.0 * d * s);
        if cosine.abs() > 1.0 {
            return None;
        }
        let angle = across.arg() + sign * cosine.acos() - side.arg();
        let third = first + (corners[2] - corners[0]) * Complex::from_polar(1.0, angle);
        Some(((third - bases[2]).norm() - radii[2], (first, angle)))
    };
    let mut found = Vec::new();
    for sign in [1.0, -1.0] {
        for step in 0..STEPS {
            let ends = [step, step + 1].map(|n| n as f64 * TAU / STEPS as f64);
            let (Some((low, _)), Some((high, _))) = (place(ends[0], sign), place(ends[1], sign))
            else {
                continue;
            };
            if low * high >= 0.0 {
                continue;
            }
            let [mut a, mut b] = ends;
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                match place(middle, sign) {
                    Some((value, _)) if value * low > 0.0 => a = middle,
                    _ => b = middle,
                }
            }
            found.extend(place(0.5 * (a + b), sign).map(|(_, place)| place));
        }
    }
    found
}

/// The example of Innocenti and Merlet: six real assemblies, the most that a planar 3-RPR can have.
#[test]
fn the_planar_3rpr_has_its_six_assemblies() {
    let manipulator = Manipulator::example("planar-3rpr").unwrap();
    let lengths = [0.01498, 0.01538, 0.012];
    let bases = [(0.0, 0.0), (0.01591, 0.0), (0.0, 0.01)].map(|(x, y)| Complex::new(x, y));
    let [one, two, three] = [0.01704_f64, 0.01654, 0.02084];
    let foot = (one * one + three * three - two * two) / (2.0 * one);
    let corners = [
        Complex::new(0.0, 0.0),
        Complex::new(one, 0.0),
        Complex::new(foot, (three * three - foot * foot).sqrt()),
    ];
    let expected = triangle_on_circles(bases, lengths, corners);
    assert_eq!(expected.len(), 6);

    // The angle is measured from home.
    let home = manipulator.pose([]).unwrap();
    let at_home = Complex::new(home[0], home[1]);
    let nearest = |point: Complex<f64>| {
        let distance = |place: &&PlanarPlace| (place.0 - point).norm();
        *expected.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    };
    let offset = nearest(at_home).1;
    let assemblies = manipulator.forward(&lengths).unwrap();
    // An angle of a telescope and a negative length are the same place: each assembly once.
    assert_eq!(assemblies.list.len(), 6, "{assemblies:?}");
    for assembly in &assemblies.list {
        let point = Complex::new(assembly.pose[0], assembly.pose[1]);
        let (expected, angle) = nearest(point);
        assert!((expected - point).norm() < 1e-10, "{point} {expected}");
        assert!(apart(assembly.pose[2], angle - offset) < 1e-7, "{assembly:?}");
        assert!(assembly.residual < 1e-12);
    }
}

/// The inverse kinematics of the planar 3-RRR by its source: each elbow is where two circles meet.
#[test]
fn the_planar_3rrr_has_eight_working_modes() {
    let manipulator = Manipulator::example("planar-3rrr").unwrap();
    assert_eq!(manipulator.choices(), 3);
    let (base, platform) = (0.331 / 3.0_f64.sqrt(), 0.07506);
    let (upper, fore) = (0.166, 0.110);
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    let mut rng = Rng::with_seed(7);
    let mut reached = 0;
    for _ in 0..2_000 {
        let pose = [0.2 * (rng.f64() - 0.5), 0.2 * (rng.f64() - 0.5), 2.0 * (rng.f64() - 0.5)];
        let place = Complex::new(pose[0], pose[1]);
        let distances = [210.0_f64, 330.0, 90.0].map(|azimuth| {
            let towards = Complex::from_polar(1.0, azimuth.to_radians());
            let corner = place + towards * platform * Complex::from_polar(1.0, pose[2]);
            corner - towards * base
        });
        let closes = |d: &Complex<f64>| (upper - fore..=upper + fore).contains(&d.norm());
        let found = manipulator.inverse_all(&pose, &mut all).unwrap().is_some();
        assert_eq!(found, distances.iter().all(closes), "{pose:?}");
        if !found {
            continue;
        }
        reached += 1;
        assert_eq!(all.modes(&manipulator).count(), 8);
        let home = manipulator.coordinates();
        for mode in all.modes(&manipulator) {
            let joints = manipulator.solution_in_mode(&all, mode, &mut solution).unwrap().joints();
            for (leg, d) in distances.iter().enumerate() {
                // Law of cosines for the angle at the motor, on either side.
                let n = d.norm();
                let at = ((upper * upper + n * n - fore * fore) / (2.0 * upper * n)).acos();
                let elbow = manipulator.mechanism().legs[leg].joints[1].point;
                let motor = manipulator.mechanism().legs[leg].joints[0].point;
                let arm = Complex::new(elbow.x - motor.x, elbow.y - motor.y).arg();
                let turned = joints[3 * leg] - home[3 * leg].home + arm;
                let off = [at, -at].map(|side| apart(turned, d.arg() + side));
                assert!(off[0].min(off[1]) < 1e-7, "{pose:?}: {off:?}");
            }
        }
    }
    assert!(reached > 300, "{reached}");
}

/// A random orientation, and its Euler angles in the order of the pose.
fn orientation(rng: &mut Rng, manipulator: &Manipulator) -> (Rotation3<f64>, Vec<f64>) {
    let rotation = UnitQuaternion::from_axis_angle(&direction(rng), rng.f64() * PI);
    let pose = manipulator
        .locate(&nalgebra::Isometry3::from_parts(nalgebra::Translation3::identity(), rotation));
    (rotation.to_rotation_matrix(), pose.unwrap())
}

/// The Agile Eye by Bonev, Chablat and Wenger (arXiv 0708.3936): eight solutions of the inverse problem, each
/// with `w · v = 0`; four assemblies that are not singular. The other four solutions of the forward problem are
/// orientations at which every leg rotates freely, whatever the motors do.
#[test]
fn the_agile_eye_has_eight_modes_and_four_assemblies() {
    let manipulator = Manipulator::example("agile-eye").unwrap();
    let mut rng = Rng::with_seed(8);
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    let home = [Vector3::new(0.0, -1.0, 0.0), Vector3::new(0.0, 0.0, -1.0), -Vector3::x()];
    for _ in 0..500 {
        let (r, pose) = orientation(&mut rng, &manipulator);
        let [v1, v2, v3] = home.map(|v| r * v);
        assert!(manipulator.inverse_all(&pose, &mut all).unwrap().is_some());
        assert_eq!(all.modes(&manipulator).count(), 8);
        for mode in all.modes(&manipulator) {
            let q = manipulator.solution_in_mode(&all, mode, &mut solution).unwrap().joints();
            let [a, b, c] = [q[0], q[3], q[6]].map(f64::sin_cos);
            let w = [
                Vector3::new(0.0, -a.0, a.1),
                Vector3::new(b.1, 0.0, -b.0),
                Vector3::new(-c.0, c.1, 0.0),
            ];
            for (w, v) in w.iter().zip([v1, v2, v3]) {
                assert!(w.dot(&v).abs() < 1e-9, "{pose:?}: {}", w.dot(&v));
            }
        }
    }
    let mut counts = [0; 9];
    for _ in 0..200 {
        let motors = [0; 3].map(|_| TAU * (rng.f64() - 0.5));
        let assemblies = manipulator.forward(&motors).unwrap();
        // Assemblies at one orientation differ in their passive joints only.
        let mut orientations: Vec<Rotation3<f64>> = Vec::new();
        for assembly in &assemblies.list {
            let r = manipulator.displacement(&assembly.pose).unwrap().rotation;
            // They differ by half turns.
            let r = r.to_rotation_matrix();
            if orientations.iter().all(|other| (r.matrix() - other.matrix()).norm() > 1e-6) {
                orientations.push(r);
            }
            assert!(assembly.residual < 1e-12);
        }
        counts[orientations.len()] += 1;
    }
    assert_eq!(counts[4], 200, "{counts:?}");
}

/// Orbita by the equation of its documentation, `w · v = 0`, with discs that are measured from home.
#[test]
fn orbita_turns_its_discs_as_its_documentation_says() {
    let manipulator = Manipulator::example("orbita").unwrap();
    let alpha = 54.0_f64.to_radians();
    let mut rng = Rng::with_seed(9);
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    let mut reached = 0;
    for _ in 0..1_000 {
        let (r, pose) = orientation(&mut rng, &manipulator);
        let corners =
            [0.0, TAU / 3.0, -TAU / 3.0].map(|a| (a, r * Vector3::new(a.cos(), a.sin(), 0.0)));
        // sin(alpha) (v.x sin t - v.y cos t) = cos(alpha) v.z has a solution.
        let closes = |v: &Vector3<f64>| alpha.sin() * v.x.hypot(v.y) >= (alpha.cos() * v.z).abs();
        let found = manipulator.inverse_all(&pose, &mut all).unwrap().is_some();
        assert_eq!(found, corners.iter().all(|(_, v)| closes(v)), "{pose:?}");
        if !found {
            continue;
        }
        reached += 1;
        assert_eq!(all.modes(&manipulator).count(), 8);
        for mode in all.modes(&manipulator) {
            let q = manipulator.solution_in_mode(&all, mode, &mut solution).unwrap().joints();
            for (leg, (start, v)) in corners.iter().enumerate() {
                let (sin, cos) = (q[3 * leg] + start).sin_cos();
                let w = Vector3::new(alpha.sin() * sin, -alpha.sin() * cos, -alpha.cos());
                assert!(w.dot(v).abs() < 1e-9, "{pose:?}");
            }
        }
    }
    assert!(reached > 100, "{reached}");
}

/// Axes whose points are written with few digits miss the centre by their rounding, and legs then close to some
/// multiple of that. Such a mechanism is assembled all the same.
#[test]
fn axes_that_miss_the_centre_by_rounding_are_assembled() {
    let exact = Manipulator::example("orbita").unwrap();
    for digits in [5, 7, 10] {
        let unit = 10_f64.powi(-digits);
        let rounded = |c: f64| (c / unit).round() * unit;
        let mut mechanism = exact.mechanism().clone();
        for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
            joint.point = (joint.axis.into_inner() * 0.06).map(rounded).into();
        }
        let manipulator = Manipulator::new(mechanism).unwrap();
        let pose = manipulator.pose([("zeta", 0.3), ("xi", 0.2), ("psi", -0.4)]).unwrap();
        let mut buffer = manipulator.solution();
        let solution =
            manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer).unwrap().unwrap();
        let discs = [0, 3, 6].map(|joint| solution.joints()[joint]);
        let assemblies = manipulator.forward(&discs).unwrap();
        let near = |a: &[f64]| a.iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(assemblies.list.iter().any(|a| near(&a.pose)), "{digits}: {assemblies:?}");
    }
}

/// The upright platform rotates with its discs, by any angle: `zeta + psi`.
#[test]
fn orbita_s_yaw_is_that_of_its_discs() {
    let manipulator = Manipulator::example("orbita").unwrap();
    let mut buffer = manipulator.solution();
    for yaw in [0.3, -1.2, FRAC_PI_2, 3.0] {
        let pose = manipulator.pose([("psi", yaw)]).unwrap();
        let solution = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer).unwrap();
        let q = solution.expect("an upright platform is in reach").joints();
        assert!([q[0], q[3], q[6]].iter().all(|disc| close(*disc, yaw)), "{q:?}");
    }
}

/// There is one section: no imaginary joint, nothing to share, and the pose has all coordinates of the group.
#[test]
fn one_subspace_has_no_upper_section() {
    for (name, coordinates) in [("planar-3rrr", "x y theta"), ("agile-eye", "zeta xi psi")] {
        let manipulator = Manipulator::example(name).unwrap();
        let d = manipulator.decomposition();
        assert_eq!((d.upper, d.intersection), (SubspaceClass::Identity, SubspaceClass::Identity));
        assert!(manipulator.imaginary().is_empty());
        let names: Vec<_> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
        assert_eq!(names.join(" "), coordinates);
        assert_eq!(manipulator.task().lower_count, 3);
        assert!(manipulator.task().intersection.is_none());
    }
}

/// The five-bar by the law of cosines: each arm reaches the hand with two angles of its shoulder, and the right
/// forearm's angle follows. The hand is where two circles about the elbows meet.
#[test]
fn the_five_bar_is_two_arms_of_two_links() {
    let m = Manipulator::example("five-bar").unwrap();
    let names = |list: &[opm_core::TaskCoordinate]| list.iter().map(|c| c.name).collect::<Vec<_>>();
    assert_eq!(names(m.task_coordinates()), ["x", "y"]);
    assert_eq!(names(m.dependent_coordinates()), ["theta"]);
    let (upper, fore, half): (f64, f64, f64) = (0.138, 0.307, 0.160);
    // The shoulder's angle with the elbow on one side, and the forearm's direction.
    let arm = |shoulder: f64, hand: Complex<f64>, side: f64| {
        let way = hand - shoulder;
        let d = way.norm();
        let cosine = (upper * upper + d * d - fore * fore) / (2.0 * upper * d);
        let angle = (cosine.abs() <= 1.0).then(|| way.arg() + side * cosine.acos())?;
        Some((angle, (hand - shoulder - Complex::from_polar(upper, angle)).arg()))
    };
    let home = (Complex::new(0.0, 0.323_981_552_428_366)
        - Complex::new(0.229, 0.119_511_505_722_253))
    .arg();
    let mut rng = Rng::with_seed(5);
    let (mut all, mut at) = (m.all_modes(), m.solution());
    let (mut reached, mut beyond) = (0, 0);
    for _ in 0..2_000 {
        let hand = Complex::new(rng.f64() - 0.5, 1.2 * rng.f64() - 0.6);
        let pose = [hand.re, hand.im];
        let found = m.inverse_all(&pose, &mut all).unwrap().is_some();
        let sides = [1.0, -1.0].map(|side| [arm(-half, hand, side), arm(half, hand, side)]);
        assert_eq!(found, sides[0].iter().all(Option::is_some), "{hand}");
        if !found {
            beyond += 1;
            continue;
        }
        reached += 1;
        let mut seen = Vec::new();
        for mode in all.modes(&m) {
            m.solution_in_mode(&all, mode, &mut at).unwrap();
            let shoulders: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
            let which = |arm: usize| {
                sides.iter().position(|side| {
                    let (angle, forearm) = side[arm].unwrap();
                    let theta = arm == 0 || apart(forearm - home, at.dependent()[0]) < 1e-7;
                    apart(angle, shoulders[arm]) < 1e-7 && theta
                })
            };
            seen.push([which(0).unwrap(), which(1).unwrap()]);
            // Forward: one of the two places where the forearms' circles meet is the hand.
            let elbow = |base: f64, angle: f64| base + Complex::from_polar(upper, angle);
            let [a, b] = [elbow(-half, shoulders[0]), elbow(half, shoulders[1])];
            let (middle, across) = (0.5 * (a + b), b - a);
            let height = (fore * fore - 0.25 * across.norm_sqr()).max(0.0).sqrt();
            let up = across * Complex::i() / across.norm() * height;
            let assemblies = m.forward(&shoulders).unwrap().list;
            for place in [middle + up, middle - up] {
                let same = |a: &opm_core::forward::Assembly| {
                    (Complex::new(a.pose[0], a.pose[1]) - place).norm() < 1e-6
                };
                assert!(assemblies.iter().any(same), "{place} is not in {assemblies:?}");
            }
            assert!(assemblies.len() <= 2, "{assemblies:?}");
        }
        seen.sort_unstable();
        assert_eq!(seen, [[0, 0], [0, 1], [1, 0], [1, 1]], "{hand}");
    }
    assert!(reached > 300 && beyond > 300, "{reached} {beyond}");
}

/// A nut on a long-pitched screw, and a slider with a passive revolute joint on the same axis: the advance turns the
/// nut by `s / p`. A locked revolute joint that completes the nut's leg has no revolutions to lose.
#[test]
fn a_nut_on_a_screw_has_a_closed_form() {
    let pitch = 0.4;
    let text = |nut: &str, slider: &str, pivot: &str| {
        format!(
            "format = 1\nname = \"nut\"\nunits = {{ length = \"m\", angle = \"rad\" }}\n\
             [platform]\npoint = [0.05, 0, 0.1]\n\
             [[leg]]\nname = \"screw\"\njoints = [\n\
             {{ name = \"H\", type = \"helical\", axis = [0, 0, 1], point = [0, 0, 0], pitch = {pitch}{nut} }},\n]\n\
             [[leg]]\nname = \"guide\"\njoints = [\n\
             {{ name = \"S\", type = \"prismatic\", axis = [0, 0, 1], point = [0, 0, 0.02]{slider} }},\n\
             {{ name = \"R\", type = \"revolute\", axis = [0, 0, 1], point = [0, 0, 0.04]{pivot} }},\n]\n"
        )
    };
    let actuated = ", actuated = true";
    let slid = Manipulator::read(&text("", actuated, "")).unwrap();
    let turned = Manipulator::read(&text(actuated, "", "")).unwrap();
    assert_eq!(slid.dependent_coordinates().len(), 1);
    for advance in [0.01, -0.3, 0.9, 4.0] {
        // The leg of the screw counts revolutions, the pivot does not.
        for (m, input) in [(&slid, advance), (&turned, advance / pitch)] {
            assert_eq!(m.forward_closed_form(), Ok(()));
            let found = m.forward(&[input]).unwrap();
            assert_eq!(found.list.len(), 1, "{advance}: {found:?}");
            let mut at = m.solution();
            let joints = m.inverse(&found.list[0].pose, m.home_mode(), &mut at).unwrap();
            let joints = joints.expect("an assembly is in reach").joints();
            let off = [joints[0] - advance / pitch, joints[1] - advance];
            assert!(off.iter().all(|off| off.abs() < 1e-12), "{advance}: {joints:?}");
            assert!(apart(joints[2], advance / pitch) < 1e-12, "{advance}: {joints:?}");
        }
    }
    // A motor on the pivot does not tell by how many revolutions the nut is turned.
    let pivoted = Manipulator::read(&text("", "", actuated)).unwrap();
    assert_eq!(pivoted.forward_closed_form(), Err(NoClosedForm::Turns));
}
