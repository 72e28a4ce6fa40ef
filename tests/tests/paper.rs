//! The two manipulators of the paper: compared with its corrected formulas on random geometries,
//! and with golden vectors from an independent program.

use fastrand::Rng;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::family::{plano_spherical, translational_helical};
use opm_tests::paper;
use std::f64::consts::{PI, TAU};

/// Tolerance in metres and radians. Both sides compute in double precision with different formulas,
/// which lose half of their digits near the boundary of a leg's reach (see `REACH_MARGIN`).
const AGREE: f64 = 1e-10;

/// Oracle values this near to the boundary, as a share of reach, are compared less strictly.
const REACH_MARGIN: f64 = 1e-9;

fn example(name: &str) -> Manipulator {
    Manipulator::example(name).unwrap()
}

fn close_angle(a: f64, b: f64) -> bool {
    let apart = (a - b).rem_euclid(TAU);
    apart.min(TAU - apart) < AGREE
}

/// The rows of the CSV file, with their values by column name.
fn rows(file: &str) -> Vec<std::collections::HashMap<String, String>> {
    let path = format!("{}/../data/reference/independent/{file}", env!("CARGO_MANIFEST_DIR"));
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

fn value_of(manipulator: &Manipulator, joints: &[f64], name: &str) -> f64 {
    joints[manipulator.coordinates().iter().position(|c| c.name == name).unwrap()]
}

#[test]
fn golden_vectors_of_the_plano_spherical_manipulator() {
    for name in ["plano-spherical-5dof", "plano-spherical-5dof-joints"] {
        let manipulator = example(name);
        let mut solution = manipulator.solution();
        let (mut closed, mut within) = (0, 0);
        let rows = rows("plano_spherical_ik.csv");
        for row in &rows {
            let pose = ["x", "y", "zeta", "xi", "psi"].map(|name| row[name].parse().unwrap());
            let mode = manipulator.parse_mode(&row["mode"]).unwrap();
            let reached = manipulator.inverse(&pose, mode, &mut solution).unwrap().is_some();
            assert_eq!(reached, row["closes"] == "1", "{name} {row:?}");
            if !reached {
                continue;
            }
            closed += 1;
            within += u32::from(solution.within_limits());
            assert_eq!(solution.within_limits(), row["within_limits"] == "1", "{name} {row:?}");
            for (number, theta) in ["theta11", "theta12", "theta13"].iter().enumerate() {
                // In a joint list, the imaginary joint is zero at home.
                let found = if name.ends_with("joints") {
                    let home = paper_home().theta[number];
                    home + solution.imaginary()[number]
                } else {
                    solution.imaginary()[number]
                };
                assert!(close_angle(found, row[*theta].parse().unwrap()), "{name} {theta} {row:?}");
            }
            for slider in ["S1", "S2", "S3"] {
                let found = value_of(&manipulator, solution.joints(), slider);
                assert!((found - row[slider].parse::<f64>().unwrap()).abs() < AGREE, "{row:?}");
            }
            for arm in ["phi14", "phi24"] {
                let found = value_of(&manipulator, solution.joints(), arm);
                assert!(close_angle(found, row[arm].parse().unwrap()), "{name} {arm} {row:?}");
            }
        }
        assert!(
            rows.len() == 200 && closed > 50 && within > 10,
            "{closed} closed, {within} within"
        );
    }
}

fn paper_home() -> paper::Joints {
    let plus = paper::Signs { legs: [[true; 2]; 3], arm: true };
    paper::PlanoSpherical::printed().inverse(&[0.0; 5], &plus).unwrap()
}

#[test]
fn golden_vectors_of_the_translational_helical_manipulator() {
    for name in ["translational-helical-3dof", "translational-helical-3dof-joints"] {
        let manipulator = example(name);
        assert_eq!(manipulator.choices(), 0);
        assert_eq!(manipulator.format_mode(manipulator.home_mode()), "");
        let mut solution = manipulator.solution();
        let rows = rows("translational_helical_ik.csv");
        for row in &rows {
            let pose = ["x", "y", "phi"].map(|name| row[name].parse().unwrap());
            assert!(manipulator.inverse(&pose, Mode::default(), &mut solution).unwrap().is_some());
            assert_eq!(solution.within_limits(), row["within_limits"] == "1", "{name} {row:?}");
            for slider in ["S1", "S2", "S3"] {
                let found = value_of(&manipulator, solution.joints(), slider);
                let expected: f64 = row[slider].parse().unwrap();
                assert!((found - expected).abs() < AGREE, "{name} {slider} {found} {expected}");
            }
            let imaginary: f64 = row["S"].parse().unwrap();
            assert!((solution.imaginary()[0].abs() - imaginary.abs()).abs() < AGREE, "{name}");
            if !name.ends_with("joints") {
                assert_eq!(manipulator.imaginary()[0].name, "S");
                assert!((solution.imaginary()[0] - imaginary).abs() < AGREE, "{name}");
            }
        }
        assert_eq!(rows.len(), 100);
    }
}

/// The values of theta_1i for the printed parameters at three orientations, on both branches. They
/// are published, and an independent public implementation of the coaxial 3-RRR agrees with them.
#[test]
fn published_imaginary_joints() {
    let manipulator = example("plano-spherical-5dof");
    let expected = [
        ([0.0, 0.0, 0.0], [0.155324, 2.249719, 4.344115], [2.986268, 5.080663, 0.891873]),
        ([0.0, 20.0, 0.0], [0.226775, 2.006096, 4.538244], [2.914818, 4.886534, 1.135496]),
        ([30.0, 20.0, -10.0], [0.595875, 2.365971, 4.869578], [3.286056, 5.226662, 1.484959]),
    ];
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    for (degrees, plus, minus) in expected {
        let [zeta, xi, psi] = degrees.map(f64::to_radians);
        // A point where the whole manipulator closes on every spherical branch.
        let mut seen = [[false; 2]; 3];
        for (x, y) in
            (0..400).map(|i| (0.01 * f64::from(i % 20) - 0.1, 0.01 * f64::from(i / 20) - 0.05))
        {
            manipulator.inverse_all(&[x, y, zeta, xi, psi], &mut all).unwrap();
            for mode in all.modes(&manipulator) {
                assert!(manipulator.solution_in_mode(&all, mode, &mut solution).is_some());
                let signs = manipulator.format_mode(mode);
                for leg in 0..3 {
                    let upper = signs.split(' ').nth(leg).unwrap().starts_with('+');
                    let expected: f64 = if upper { plus[leg] } else { minus[leg] };
                    let apart = (solution.imaginary()[leg] - expected).rem_euclid(TAU);
                    assert!(apart.min(TAU - apart) < 1e-6, "{degrees:?} leg {leg} {signs}");
                    seen[leg][usize::from(upper)] = true;
                }
            }
        }
        assert_eq!(seen, [[true; 2]; 3]);
    }
}

#[test]
fn the_papers_formulas_on_random_geometries() {
    let mut rng = Rng::with_seed(20);
    let (mut mechanisms, mut compared, mut outside) = (0, 0, 0);
    while mechanisms < 150 {
        let oracle = paper::PlanoSpherical::random(&mut rng);
        let mut within = |low: f64, high: f64| low + (high - low) * rng.f64();
        let home = plano_spherical::Home {
            x: within(-0.05, 0.05),
            y: within(-0.05, 0.05),
            zeta: within(-1.0, 1.0),
            xi: within(-0.5, 0.5),
            psi: within(-1.0, 1.0),
        };
        let at_home = paper::Signs::random(&mut rng);
        let family = oracle.family(home, &at_home);
        let pose = [home.x, home.y, home.zeta, home.xi, home.psi];
        let Ok(mechanism) = family.assemble() else {
            let oracle_closes = oracle.inverse(&pose, &at_home).is_some();
            assert!(!oracle_closes, "the family refuses a home that the formulas reach");
            continue;
        };
        let Ok(manipulator) = Manipulator::new(mechanism) else { continue };
        mechanisms += 1;
        assert_eq!(manipulator.format_mode(manipulator.home_mode()), at_home.written());
        let mut solution = manipulator.solution();
        for _ in 0..100 {
            let signs = paper::Signs::random(&mut rng);
            let mode = manipulator.parse_mode(&signs.written()).unwrap();
            let mut near = |around: f64, by: f64| around + by * (2.0 * rng.f64() - 1.0);
            let pose = [
                near(home.x, 0.1),
                near(home.y, 0.1),
                near(0.0, PI),
                near(0.0, 1.0),
                near(0.0, PI),
            ];
            let reached = manipulator.inverse(&pose, mode, &mut solution).unwrap().is_some();
            let Some(expected) = oracle.inverse(&pose, &signs) else {
                outside += 1;
                let gap = |u: &opm_core::manipulator::Unreachable| u.deficit.excess < REACH_MARGIN;
                assert!(!reached || solution.unreachable().iter().all(gap));
                continue;
            };
            assert!(reached, "{:?}", solution.unreachable());
            compared += 1;
            // Derivatives grow with one over the square root of the distance to the boundary of
            // reach.
            let near_rim = oracle.legs.iter().zip(expected.theta).any(|(leg, theta)| {
                let (b, c) = paper::slider_quadratic(leg, [pose[0], pose[1]], theta);
                b * b - 4.0 * c < 1e-6
            }) || expected.arm[1].sin().abs() < 1e-3;
            let agree = if near_rim { 1e-5 } else { 1e-9 };
            for i in 0..3 {
                let slider = value_of(&manipulator, solution.joints(), &format!("S{}", i + 1));
                assert!((slider - expected.slider[i]).abs() < agree, "{pose:?} {signs:?} S{i}");
                let apart = (solution.imaginary()[i] - expected.theta[i]).rem_euclid(TAU);
                assert!(apart.min(TAU - apart) < 1e-6, "{pose:?} {signs:?} theta{i}");
            }
            for (i, name) in ["phi14", "phi24"].iter().enumerate() {
                let found = value_of(&manipulator, solution.joints(), name);
                let apart = (found - expected.arm[i]).rem_euclid(TAU);
                assert!(apart.min(TAU - apart) < agree, "{pose:?} {signs:?} {name}");
            }
        }
    }
    println!("{compared} compared, {outside} out of reach");
    assert!(compared > 1_500 && outside > 1_500, "{compared} {outside}");
}

#[test]
fn the_helical_formulas_on_random_geometries() {
    let mut rng = Rng::with_seed(21);
    for _ in 0..100 {
        let (legs, pitched) = paper::TranslationalLeg::random(&mut rng);
        let home = translational_helical::Home {
            x: 0.1 * rng.f64(),
            y: 0.1 * rng.f64(),
            phi: 3.0 * rng.f64(),
        };
        let family = paper::TranslationalLeg::family(&legs, home);
        let Ok(mechanism) = family.assemble() else { continue };
        let manipulator = match Manipulator::new(mechanism) {
            Ok(manipulator) => manipulator,
            Err(error) => panic!("{legs:?}: {error}"),
        };
        let mut solution = manipulator.solution();
        for _ in 0..50 {
            let pose = [rng.f64() - 0.5, rng.f64() - 0.5, 30.0 * (rng.f64() - 0.5)];
            assert!(manipulator.inverse(&pose, Mode::default(), &mut solution).unwrap().is_some());
            for (i, leg) in legs.iter().enumerate() {
                let found = value_of(&manipulator, solution.joints(), &format!("S{}", i + 1));
                let expected = leg.slider([pose[0], pose[1]], pose[2]);
                assert!((found - expected).abs() < 1e-11, "{legs:?} {pose:?} S{i}");
            }
            let expected = legs[pitched].pitch * pose[2];
            assert!((solution.imaginary()[0] - expected).abs() < 1e-11);
        }
    }
}

#[test]
fn family_and_joint_list_agree() {
    for name in ["plano-spherical-5dof", "translational-helical-3dof"] {
        let family = example(name);
        let list = example(&format!("{name}-joints"));
        let names = |m: &Manipulator| -> Vec<String> {
            m.coordinates().iter().map(|c| c.name.clone()).collect()
        };
        assert_eq!(names(&family), names(&list));
        assert_eq!(family.task_coordinates().len(), list.task_coordinates().len());
        for (a, b) in family.task_coordinates().iter().zip(list.task_coordinates()) {
            assert!(a.name == b.name && (a.home - b.home).abs() < 1e-12, "{a:?} {b:?}");
        }
        let mut rng = Rng::with_seed(22);
        let (mut all, mut other) = (family.all_modes(), list.all_modes());
        let (mut a, mut b) = (family.solution(), list.solution());
        let mut compared = 0;
        for _ in 0..2_000 {
            let pose: Vec<f64> = family
                .task_coordinates()
                .iter()
                .map(|c| (rng.f64() - 0.5) * if c.quantity.unit() == "m" { 0.3 } else { 2.0 })
                .collect();
            family.inverse_all(&pose, &mut all).unwrap();
            list.inverse_all(&pose, &mut other).unwrap();
            let modes: Vec<Mode> = all.modes(&family).collect();
            assert_eq!(modes, other.modes(&list).collect::<Vec<_>>(), "{pose:?}");
            for mode in modes {
                assert!(
                    family.solution_in_mode(&all, mode, &mut a).is_some()
                        && list.solution_in_mode(&other, mode, &mut b).is_some()
                );
                assert_eq!(a.within_limits(), b.within_limits());
                for ((p, q), c) in a.joints().iter().zip(b.joints()).zip(family.coordinates()) {
                    // The coordinates of the joint list are written with at least twelve digits.
                    assert!((p - q).abs() < 1e-8 || close_angle(*p, *q), "{} {p} {q}", c.name);
                }
                compared += 1;
            }
        }
        assert!(compared > 1_000, "{name}: {compared}");
    }
}
