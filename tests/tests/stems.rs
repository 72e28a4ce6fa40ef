//! Platforms that move as one leg does or as several let them, and loops with another link as the platform, against plain
//! geometry and published formulas.

use fastrand::Rng;
use nalgebra::{Matrix3, Rotation3, Vector3};
use opm_core::Manipulator;
use opm_core::decomposition::{PlatformSet, rerooted};
use opm_core::manipulator::{CompileError, ConstraintError};
use opm_core::mechanism::file;

/// The place of a joint coordinate among the joints.
fn number(m: &Manipulator, name: &str) -> usize {
    m.coordinates().iter().position(|c| c.name == name).unwrap()
}

/// A Tricept's stem points from the origin to the platform's point, and its struts are as long as they are.
#[test]
fn a_tricept_by_geometry() {
    let m = Manipulator::example("tricept").unwrap();
    assert_eq!(m.decomposition().platform(), PlatformSet::Stem(3));
    let names =
        |list: &[opm_core::task::TaskCoordinate]| list.iter().map(|c| c.name).collect::<Vec<_>>();
    assert_eq!(names(m.task_coordinates()), ["x", "y", "z"]);
    assert_eq!(names(m.dependent_coordinates()), ["roll", "pitch", "yaw"]);
    let (mut rng, mut at) = (Rng::with_seed(1), m.solution());
    for _ in 0..200 {
        let p = Vector3::new(0.8 * rng.f64() - 0.4, 0.8 * rng.f64() - 0.4, 0.7 + 0.4 * rng.f64());
        let solution = m.inverse(p.as_slice(), m.home_mode(), &mut at).unwrap().unwrap();
        let joint = |name: &str| solution.joints()[number(&m, name)];
        // The stem: R = Rx(a) Ry(b), whose third column is its direction.
        let d = p.normalize();
        let (a, b) = ((-d.y).atan2(d.z), d.x.asin());
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), a)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), b);
        assert!((joint("S4") - p.norm()).abs() < 1e-12);
        assert!((joint("A4.1") - a).abs() < 1e-12 && (joint("A4.2") - b).abs() < 1e-12);
        for (i, angle) in [90.0_f64, 210.0, 330.0].into_iter().enumerate() {
            let (sin, cos) = angle.to_radians().sin_cos();
            let out = Vector3::new(cos, sin, 0.0);
            let length = (p + turn * (out * 0.14) - out * 0.325).norm();
            assert!((joint(&format!("S{}", i + 1)) - length).abs() < 1e-12);
        }
        let [roll, pitch, yaw] = [0, 1, 2].map(|i| solution.dependent()[i]);
        let angles = Rotation3::from_euler_angles(roll, pitch, yaw);
        assert!((angles.matrix() - turn.matrix()).norm() < 1e-12);
    }
}

/// An ankle's rods keep their lengths, and its foot turns as its joint does.
#[test]
fn an_ankle_by_geometry() {
    let m = Manipulator::example("ankle").unwrap();
    let (mut rng, mut all, mut at) = (Rng::with_seed(2), m.all_modes(), m.solution());
    let mut solved = 0;
    for _ in 0..200 {
        let pose = [rng.f64() - 0.5, 1.4 * rng.f64() - 0.7];
        let Some(found) = m.inverse_all(&pose, &mut all).unwrap() else { continue };
        let modes: Vec<_> = found.modes(&m).collect();
        for mode in modes {
            let solution = m.solution_in_mode(&all, mode, &mut at).unwrap();
            let foot = Rotation3::from_euler_angles(pose[0], pose[1], solution.dependent()[0]);
            let [pitch, roll] =
                ["pitch_joint", "roll_joint"].map(|name| solution.joints()[number(&m, name)]);
            let by_joints = Rotation3::from_axis_angle(&Vector3::y_axis(), pitch)
                * Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
            assert!((foot.matrix() - by_joints.matrix()).norm() < 1e-12);
            for (name, side) in [("A1", 1.0), ("A2", -1.0)] {
                let (sin, cos) = solution.joints()[number(&m, name)].sin_cos();
                let pin: Vector3<f64> = Vector3::new(-0.05 * cos, 0.045 * side, 0.18 + 0.05 * sin);
                let heel: Vector3<f64> = foot * Vector3::new(-0.05, 0.036 * side, 0.0);
                let rod = 0.009_f64.hypot(0.18);
                assert!(((pin - heel).norm() - rod).abs() < 1e-12);
            }
            solved += 1;
        }
    }
    assert!(solved > 400, "{solved}");
}

/// The file of a mechanism of some legs, in metres and radians, with its platform at a point.
fn text(point: [f64; 3], legs: &[&[&str]]) -> String {
    let leg = |(i, joints): (usize, &&[&str])| {
        let joint = |(k, joint): (usize, &&str)| format!("{{ name = \"j{i}{k}\", {joint} }}");
        let joints: Vec<String> = joints.iter().enumerate().map(joint).collect();
        format!("[[leg]]\nname = \"leg{i}\"\njoints = [\n{},\n]\n", joints.join(",\n"))
    };
    let legs: String = legs.iter().enumerate().map(leg).collect();
    let head = "format = 1\nname = \"loop\"\nunits = { length = \"m\", angle = \"rad\" }\n";
    format!("{head}[platform]\npoint = {point:?}\n{legs}")
}

fn legs(point: [f64; 3], legs: &[&[&str]]) -> Manipulator {
    Manipulator::read(&text(point, legs)).unwrap()
}

fn axis(kind: &str, axis: Vector3<f64>, point: Vector3<f64>) -> String {
    let [axis, point] = [axis, point].map(<[f64; 3]>::from);
    format!("type = \"{kind}\", axis = {axis:?}, point = {point:?}")
}

/// Calls `check` with the crank's angle and all joints, for every mode at angles all around; returns how often.
fn of_crank(m: &Manipulator, check: impl Fn(f64, &[f64])) -> usize {
    let (mut all, mut at, mut solved) = (m.all_modes(), m.solution(), 0);
    for i in -20..=20 {
        let theta = 0.15 * f64::from(i);
        let Some(found) = m.inverse_all(&[theta], &mut all).unwrap() else { continue };
        for mode in found.modes(m).collect::<Vec<_>>() {
            check(theta, m.solution_in_mode(&all, mode, &mut at).unwrap().joints());
            solved += 1;
        }
    }
    solved
}

/// A four-bar's coupler has no closed form, its crank has: the coupler's length stays, on both branches.
#[test]
fn a_four_bar_is_moved_by_its_crank() {
    let z = Vector3::z();
    let at = |x: f64, y: f64| axis("revolute", z, Vector3::new(x, y, 0.0));
    let [a, b, c, d] =
        [at(0.0, 0.0) + ", actuated = true", at(0.03, 0.08), at(0.15, 0.0), at(0.17, 0.11)];
    let m = legs([0.1, 0.1, 0.0], &[&[&a, &b], &[&c, &d]]);
    assert_eq!(m.mechanism().legs[0].joints.len(), 1);
    assert_eq!(m.task_coordinates()[0].name, "theta");
    let turned = |x: f64, y: f64, q: f64| {
        Rotation3::from_axis_angle(&Vector3::z_axis(), q) * Vector3::new(x, y, 0.0)
    };
    let solved = of_crank(&m, |theta, joints| {
        assert!((joints[0] - theta).abs() < 1e-12);
        let pin = turned(0.03, 0.08, theta);
        let tip = Vector3::new(0.15, 0.0, 0.0) + turned(0.02, 0.11, joints[1]);
        assert!(((tip - pin).norm() - 0.14_f64.hypot(0.03)).abs() < 1e-12);
    });
    assert!(solved > 30, "{solved}");
}

/// Two cranks and a rod between balls: an RSSR, of which the rod spins.
#[test]
fn a_spatial_four_bar_keeps_its_rod() {
    let (x, y) = (Vector3::x(), Vector3::y());
    let crank = axis("revolute", x, Vector3::zeros()) + ", actuated = true";
    let rocker = axis("revolute", y, Vector3::new(0.2, 0.1, 0.0));
    let [a, b] = ["[0.02, 0.05, 0.02]", "[0.23, 0.12, 0.08]"]
        .map(|p| format!("type = \"spherical\", point = {p}"));
    let m = legs([0.23, 0.12, 0.08], &[&[&crank, &a], &[&rocker, &b]]);
    assert_eq!(m.decomposition().platform(), PlatformSet::Stem(0));
    let rod = Vector3::<f64>::new(0.21, 0.07, 0.06).norm();
    let solved = of_crank(&m, |theta, joints| {
        let pin: Vector3<f64> =
            Rotation3::from_axis_angle(&Vector3::x_axis(), theta) * Vector3::new(0.02, 0.05, 0.02);
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), joints[1]);
        let tip: Vector3<f64> = Vector3::new(0.2, 0.1, 0.0) + turn * Vector3::new(0.03, 0.02, 0.08);
        assert!(((tip - pin).norm() - rod).abs() < 1e-12);
    });
    assert!(solved > 60, "{solved}");
}

/// Bennett's linkage, overconstrained: the product of the half angles' tangents is constant (Bennett 1903).
#[test]
fn bennett_s_linkage() {
    // Links a and b with twists alpha and beta: a / sin alpha = b / sin beta.
    let (a, alpha, beta) = (0.1_f64, 0.6_f64, 1.1_f64);
    let b = a * beta.sin() / alpha.sin();
    let constant = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    // The closed loop at one angle, joint by joint.
    let (first, second) = (1.0_f64, |t: f64| 2.0 * (constant / (0.5 * t).tan()).atan());
    let angles = |t: f64| [t, second(t), -t, -second(t)];
    let links = [(a, alpha), (b, beta), (a, alpha), (b, beta)];
    let place = |t: f64| {
        let (mut turn, mut point, mut axes) = (Rotation3::identity(), Vector3::zeros(), Vec::new());
        for (angle, (length, twist)) in angles(t).into_iter().zip(links) {
            axes.push((turn * Vector3::z(), point));
            turn *= Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            point += turn * Vector3::new(length, 0.0, 0.0);
            turn *= Rotation3::from_axis_angle(&Vector3::x_axis(), twist);
        }
        assert!(point.norm() < 1e-12 && turn.angle() < 1e-7, "{t}: open by {point:?}");
        axes
    };
    let joint = |(u, p): (Vector3<f64>, Vector3<f64>)| axis("revolute", u, p);
    let axes = place(first);
    // The first joint's axis stands still, and the last one's, before the closing link.
    let crank = joint(axes[0]) + ", actuated = true";
    let [two, three, four] = [joint(axes[1]), joint(axes[2]), joint(axes[3])];
    let m = legs([0.05, 0.05, 0.05], &[&[&crank, &two], &[&four, &three]]);
    let (mut all, mut at) = (m.all_modes(), m.solution());
    let mut solved = 0;
    for i in -30..30 {
        let theta = 0.1 * f64::from(i);
        if (0.5 * (first + theta)).tan().abs() < 0.05 {
            continue;
        }
        let found = m.inverse_all(&[theta], &mut all).unwrap().expect("it turns all the way");
        let mode = found.modes(&m).next().unwrap();
        let joints = m.solution_in_mode(&all, mode, &mut at).unwrap().joints();
        // The crank's neighbour counts as before, though it is passed from its other side.
        let moved = second(first + theta) - second(first);
        let own = joints[number(&m, "j01")];
        let off = (0.5 * (own - moved)).sin().abs();
        assert!(off < 1e-8, "{theta}: {own} {moved}");
        solved += 1;
    }
    assert!(solved > 50, "{solved}");
}

/// Of a stem whose coordinates cannot be found one by one, the joints are named; and only loops have other links for a
/// platform.
#[test]
fn what_has_no_closed_form_is_refused() {
    let text = file::write(
        Manipulator::example("tricept").unwrap().mechanism(),
        file::FileUnits::SI,
        file::Digits::All,
    );
    // A stem with an arm at its end, of two revolutes that do not meet.
    let arm = r#"{ name = "A5", type = "revolute", axis = [1, 0, 0], point = [0, 0.1, 1.0], actuated = true },
      { name = "A6", type = "revolute", axis = [0, 1, 0.3], point = [0.1, 0.2, 1.1], actuated = true }
]"#;
    let place = text.rfind(']').unwrap();
    let text = format!("{},\n{arm}", text[..place].trim_end().trim_end_matches(','));
    let mechanism = file::read(&text).unwrap().mechanism;
    assert!(rerooted(&mechanism).is_empty());
    match Manipulator::new(mechanism) {
        Err(CompileError::Constraint(ConstraintError::Stem { leg, reason })) => {
            assert_eq!(leg, "stem");
            assert!(
                reason.to_string().contains("together") || reason.to_string().contains("choices"),
                "{reason}"
            );
        }
        other => panic!("{:?}", other.err()),
    }
}

/// The place and the orientation of a platform in a mode.
fn platform(
    m: &Manipulator,
    pose: &[f64],
    mode: opm_core::Mode,
) -> (Vector3<f64>, nalgebra::Matrix3<f64>) {
    let g = m.displacement_in(pose, mode).unwrap();
    ((g * m.mechanism().platform).coords, g.rotation.to_rotation_matrix().into_inner())
}

/// Three legs at a third of a turn, of joints that `joints` gives for the outward and the tangent direction; the first is along
/// the second base axis.
fn three(height: f64, joints: impl Fn(Vector3<f64>, Vector3<f64>) -> [String; 3]) -> String {
    let leg = |i: u32| {
        let (sin, cos) =
            (std::f64::consts::FRAC_PI_2 + f64::from(i) * std::f64::consts::TAU / 3.0).sin_cos();
        joints(Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0))
    };
    let all: Vec<[String; 3]> = (0..3).map(leg).collect();
    let names: Vec<Vec<&str>> =
        all.iter().map(|leg| leg.iter().map(String::as_str).collect()).collect();
    let slices: Vec<&[&str]> = names.iter().map(Vec::as_slice).collect();
    text([0.0, 0.0, height], &slices)
}

/// The parasitic motions of a 3-RPS (J. A. Carretero and others, "Kinematic analysis and optimization of a new three degree-of-freedom
/// spatial parallel manipulator", 2000): its balls stay in upright planes.
#[test]
fn the_parasitic_motions_of_a_3_rps() {
    let (base, r, height) = (0.2, 0.12, 0.3);
    let text = three(height, |out, tangent| {
        let (foot, tip) = (out * base, out * r + Vector3::z() * height);
        let ball: [f64; 3] = tip.into();
        [
            axis("revolute", tangent, foot),
            axis("prismatic", (tip - foot).normalize(), foot) + ", actuated = true",
            format!("type = \"spherical\", point = {ball:?}"),
        ]
    });
    let m = Manipulator::read(&text).unwrap();
    assert_eq!(m.decomposition().platform(), PlatformSet::Constrained);
    let names: Vec<_> = m.task_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["z", "roll", "pitch"]);
    let (mut rng, mut at) = (Rng::with_seed(3), m.solution());
    for _ in 0..200 {
        let [roll, pitch] = [0, 1].map(|_| 1.2 * rng.f64() - 0.6);
        let pose = [0.25 + 0.1 * rng.f64(), roll, pitch];
        let yaw = (pitch.sin() * roll.sin() / (pitch.cos() + roll.cos())).atan();
        let (p, found) = platform(&m, &pose, m.home_mode());
        let turn = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
        assert!((found - turn).norm() < 1e-11, "{pose:?}");
        let place =
            Vector3::new(-r * turn[(0, 1)], 0.5 * r * (turn[(1, 1)] - turn[(0, 0)]), pose[0]);
        assert!((p - place).norm() < 1e-12, "{pose:?}");
        let solution = m.inverse(&pose, m.home_mode(), &mut at).unwrap().unwrap();
        for i in 0..3 {
            let (sin, cos) = (std::f64::consts::FRAC_PI_2
                + f64::from(i) * std::f64::consts::TAU / 3.0)
                .sin_cos();
            let out = Vector3::new(cos, sin, 0.0);
            let home: f64 = (out * (base - r)).norm().hypot(height);
            let length = (p + turn * (out * r) - out * base).norm();
            assert!((solution.joints()[5 * i as usize + 1] + home - length).abs() < 1e-11);
        }
    }
}

/// A 3-SPR moves inversely: its base, seen from the platform, moves as the platform of a 3-RPS.
#[test]
fn the_parasitic_motions_of_a_3_spr() {
    let (r, top, height) = (0.2, 0.12, 0.3);
    let text = three(height, |out, tangent| {
        let (foot, tip) = (out * r, out * top + Vector3::z() * height);
        let ball: [f64; 3] = foot.into();
        [
            format!("type = \"spherical\", point = {ball:?}"),
            axis("prismatic", (tip - foot).normalize(), foot) + ", actuated = true",
            axis("revolute", tangent, tip),
        ]
    });
    let m = Manipulator::read(&text).unwrap();
    let mut rng = Rng::with_seed(4);
    for _ in 0..200 {
        let pose = [0.25 + 0.1 * rng.f64(), 0.8 * rng.f64() - 0.4, 0.8 * rng.f64() - 0.4];
        let (p, turn) = platform(&m, &pose, m.home_mode());
        assert!((turn[(0, 1)] - turn[(1, 0)]).abs() < 1e-11, "{pose:?}");
        let seen = turn.transpose() * p;
        assert!((seen.x - r * turn[(1, 0)]).abs() < 1e-11, "{pose:?}");
        assert!((seen.y - 0.5 * r * (turn[(0, 0)] - turn[(1, 1)])).abs() < 1e-11, "{pose:?}");
    }
}

/// An Exechon, 2-UPR + SPR: two legs share an axis of the base, which the platform's second direction stays perpendicular to.
#[test]
fn an_exechon_by_its_rows() {
    let height = 0.5;
    let upr = |side: f64| {
        let (foot, tip) =
            (Vector3::new(0.3 * side, 0.0, 0.0), Vector3::new(0.1 * side, 0.0, height));
        let x = axis("universal", Vector3::x(), foot) + ", axis2 = [0.0, 1.0, 0.0]";
        [
            x,
            axis("prismatic", (tip - foot).normalize(), foot) + ", actuated = true",
            axis("revolute", Vector3::y(), tip),
        ]
    };
    let (foot, tip) = (Vector3::new(0.0, 0.35, 0.0), Vector3::new(0.0, 0.12, height));
    let third = [
        "type = \"spherical\", point = [0.0, 0.35, 0.0]".to_owned(),
        axis("prismatic", (tip - foot).normalize(), foot) + ", actuated = true",
        axis("revolute", Vector3::x(), tip),
    ];
    let all = [upr(1.0), upr(-1.0), third];
    let names: Vec<Vec<&str>> =
        all.iter().map(|leg| leg.iter().map(String::as_str).collect()).collect();
    let slices: Vec<&[&str]> = names.iter().map(Vec::as_slice).collect();
    let m = legs([0.0, 0.0, height], &slices);
    let (mut rng, mut all, mut at) = (Rng::with_seed(5), m.all_modes(), m.solution());
    let mut solved = 0;
    for _ in 0..100 {
        let pose = [0.4 + 0.2 * rng.f64(), 0.8 * rng.f64() - 0.4, 0.8 * rng.f64() - 0.4];
        let Some(found) = m.inverse_all(&pose, &mut all).unwrap() else { continue };
        let modes: Vec<_> = found.modes(&m).collect();
        for mode in modes {
            let (p, turn) = platform(&m, &pose, mode);
            // The axis of both universal joints, and the planes of the legs about it and of the third leg.
            assert!(turn[(0, 1)].abs() < 1e-11, "{pose:?}");
            assert!(turn.column(1).dot(&p).abs() < 1e-11, "{pose:?}");
            assert!(turn.column(0).dot(&(foot - p)).abs() < 1e-11, "{pose:?}");
            let joints = m.solution_in_mode(&all, mode, &mut at).unwrap().joints();
            let (home, now) =
                ((tip - foot).norm(), (p + turn * (tip - Vector3::z() * height) - foot).norm());
            let third = joints[number(&m, "j21")] + home;
            assert!((third.abs() - now).abs() < 1e-11, "{pose:?}: {third} {now}");
            solved += 1;
        }
    }
    assert!(solved > 500, "{solved}");
}

const EXECHON: &str = include_str!("../../crates/opm-core/templates/exechon.toml");

fn exechon(independent: &str) -> Result<Manipulator, String> {
    let text = EXECHON
        .replace("[platform]", &format!("[task]\nindependent = {independent}\n\n[platform]"));
    Manipulator::read(&text).map_err(|error| error.to_string())
}

/// An Exechon is at a place with four orientations: two of the plane of its first two legs, and two in it. That of a pose is
/// among them, with the same joints, and each of them is as geometry has it.
#[test]
fn an_exechon_by_its_position() {
    let plain = Manipulator::read(EXECHON).unwrap();
    let m = exechon(r#"["x", "y", "z"]"#).unwrap();
    let names: Vec<&str> = m.task_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["x", "y", "z"]);
    assert_eq!(m.dependent_coordinates().len(), 3);
    let foot = Vector3::new(0.0, 0.4, 0.0);
    let mut rng = Rng::with_seed(8);
    let (mut known, mut at) = (plain.solution(), m.solution());
    let mut four = 0;
    for _ in 0..100 {
        let pose = [0.7 + 0.4 * rng.f64(), rng.f64() - 0.5, rng.f64() - 0.5];
        let (p, turn) = platform(&plain, &pose, plain.home_mode());
        let joints = plain.inverse(&pose, plain.home_mode(), &mut known).unwrap();
        let joints = joints.map(|solution| solution.joints().to_vec());
        let mut orientations: Vec<Matrix3<f64>> = Vec::new();
        let mut found = false;
        for mode in m.modes() {
            let Ok(Some(_)) = m.dependent_values(p.as_slice(), mode) else { continue };
            let (there, other) = platform(&m, p.as_slice(), mode);
            assert!((there - p).norm() < 1e-11);
            assert!(other[(0, 1)].abs() < 1e-11);
            assert!(other.column(1).dot(&p).abs() < 1e-11);
            assert!(other.column(0).dot(&(foot - p)).abs() < 1e-11);
            if orientations.iter().all(|one| (one - other).norm() > 1e-6) {
                orientations.push(other);
            }
            if (other - turn).norm() < 1e-9
                && let (Some(joints), Some(solution)) =
                    (&joints, m.inverse(p.as_slice(), mode, &mut at).unwrap())
            {
                let off = solution.joints().iter().zip(joints).map(|(a, b)| (a - b).abs());
                found |= off.fold(0.0, f64::max) < 1e-9;
            }
        }
        assert!(found || joints.is_none(), "{pose:?}");
        assert!(orientations.len() <= 4 && orientations.len().is_multiple_of(2));
        four += usize::from(orientations.len() == 4);
    }
    assert!(four > 90, "{four}");

    // Rates against differences.
    let home = m.home_pose();
    let pose: Vec<f64> =
        home.iter().enumerate().map(|(i, q)| q + 0.03 * (i as f64 + 1.0)).collect();
    let rates = [0.3, -0.2, 0.1];
    let (mut motion, mut other) = (m.joint_motion(), m.solution());
    m.inverse(&pose, m.home_mode(), &mut at).unwrap().unwrap();
    assert!(m.velocity(&at, &rates, &[0.0; 3], &mut motion).unwrap());
    let mut joints = |t: f64| {
        let moved: Vec<f64> = pose.iter().zip(rates).map(|(q, rate)| q + t * rate).collect();
        other.clone_from(&at);
        m.inverse_near(&moved, m.home_mode(), &mut other).unwrap().unwrap().joints().to_vec()
    };
    let (before, after) = (joints(-1e-5), joints(1e-5));
    for (i, rate) in motion.joint_rates.iter().enumerate() {
        assert!(((after[i] - before[i]) / 2e-5 - rate).abs() < 1e-7 * (1.0 + rate.abs()));
    }
}

/// Coordinates that cannot be the independent ones, or that there are not, are refused by name.
#[test]
fn independent_coordinates_are_checked() {
    assert!(exechon(r#"["z", "roll", "pitch"]"#).is_ok());
    for (given, message) in [
        (
            r#"["x", "y", "h"]"#,
            "`independent` has \"h\", expected one of x, y, z, roll, pitch, yaw",
        ),
        (
            r#"["x", "roll", "yaw"]"#,
            "the coordinates that follow from x, roll, yaw have no closed form",
        ),
        (r#"["x", "y"]"#, "`independent` is x, y, but"),
        (r#"["x", "y", "x"]"#, "twice"),
        ("[]", "is empty"),
        ("7", "array of names"),
    ] {
        let problem = exechon(given).unwrap_err();
        assert!(problem.contains(message), "{given}: {problem}");
    }
    // A Delta has nothing to choose.
    let delta = opm_core::mechanism::examples::find("delta").unwrap().text;
    let asked = |names: &str| {
        delta.replace("[platform]", &format!("[task]\nindependent = {names}\n[platform]"))
    };
    assert!(Manipulator::read(&asked(r#"["z", "y", "x"]"#)).is_ok());
    let problem = Manipulator::read(&asked(r#"["x", "y"]"#)).unwrap_err().to_string();
    assert!(problem.contains("`independent` is x, y, but the coordinates from which the others follow in closed form are x, y, z"), "{problem}");
}

/// A leg whose ball stays on a torus constrains in another way: that is said, with the leg.
#[test]
fn rows_that_are_not_affine_are_refused() {
    let text = three(0.3, |out, tangent| {
        let (foot, tip) = (out * 0.2, out * 0.12 + Vector3::z() * 0.3);
        let ball: [f64; 3] = tip.into();
        [
            axis("revolute", tangent, foot) + ", actuated = true",
            axis(
                "revolute",
                (tangent + Vector3::z() * 0.4).normalize(),
                foot + Vector3::new(0.03, 0.02, 0.1),
            ),
            format!("type = \"spherical\", point = {ball:?}"),
        ]
    });
    let refused = Manipulator::read(&text).err().unwrap().to_string();
    assert!(refused.contains("leg0 constrains the platform in another way"), "{refused}");
}
