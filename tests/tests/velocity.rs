//! Velocities and accelerations on random mechanisms of every pair of subspaces, compared with
//! differences of the inverse kinematics.

use fastrand::Rng;
use nalgebra::{DMatrix, DVector};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Mode, Section, Solution};
use opm_core::velocity::{SingularCause, SingularLeg, VelocityError};
use opm_tests::differences::{Estimate, derivatives};
use opm_tests::random::{Options, PAIRS, mechanism};
use std::f64::consts::TAU;

/// Tolerance relative to the largest derivative of the same order at the pose.
const RATE: f64 = 1e-9;
const ACCELERATION: f64 = 1e-7;
/// Tolerance for a number that is computed in two ways, relative to the intermediate numbers.
const ROUNDING: f64 = 1e-11;

/// A motion through a pose: `pose + rates t + accelerations t² / 2`.
struct Path {
    pose: Vec<f64>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
}

impl Path {
    fn random(rng: &mut Rng, manipulator: &Manipulator) -> Self {
        let reach = 2.0 * rng.f64() * rng.f64();
        let home = manipulator.home_pose();
        let mut any = |size: f64| size * (rng.f64() * 2.0 - 1.0);
        Self {
            pose: home.iter().map(|h| h + any(reach)).collect(),
            rates: home.iter().map(|_| any(1.0)).collect(),
            accelerations: home.iter().map(|_| any(1.0)).collect(),
        }
    }

    fn at(&self, t: f64) -> Vec<f64> {
        let each = self.pose.iter().zip(&self.rates).zip(&self.accelerations);
        each.map(|((q, r), a)| q + t * (r + 0.5 * t * a)).collect()
    }
}

/// The joints, then the imaginary joints, along the motion through a solution.
fn through(
    manipulator: &Manipulator,
    path: &Path,
    mode: Mode,
    at: &Solution,
    t: f64,
) -> Option<Vec<f64>> {
    let mut moved = at.clone();
    let reached = manipulator.inverse_near(&path.at(t), mode, &mut moved).unwrap().is_some();
    reached.then(|| [moved.joints(), moved.imaginary()].concat())
}

#[test]
fn rates_and_accelerations_are_the_derivatives_of_inverse_kinematics() {
    let mut rng = Rng::with_seed(70);
    for pair in PAIRS {
        let (mut compared, mut unsure, mut worst) = (0, 0, [0.0_f64; 2]);
        for round in 0..60 {
            let options = Options { limited: 0.0, balls: round % 2 == 0 };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
            let mut motion = manipulator.joint_motion();
            for _ in 0..4 {
                let path = Path::random(&mut rng, &manipulator);
                manipulator.inverse_all(&path.pose, &mut all).unwrap();
                for mode in all.modes(&manipulator) {
                    assert!(manipulator.solution_in_mode(&all, mode, &mut at).is_some());
                    let differences =
                        derivatives(1e-2, |t| through(&manipulator, &path, mode, &at, t));
                    let Some(differences) = differences else {
                        unsure += 1;
                        continue;
                    };
                    let regular = manipulator
                        .velocity(&at, &path.rates, &path.accelerations, &mut motion)
                        .unwrap();
                    assert!(regular, "{pair:?}: {:?}", motion.singular);
                    let rates = [&motion.joint_rates[..], &motion.imaginary_rates].concat();
                    let accelerations =
                        [&motion.joint_accelerations[..], &motion.imaginary_accelerations].concat();
                    for (order, (found, tolerance)) in
                        [(rates, RATE), (accelerations, ACCELERATION)].into_iter().enumerate()
                    {
                        let known: Vec<Estimate> = differences.iter().map(|d| d[order]).collect();
                        let size = known.iter().fold(1.0_f64, |size, d| size.max(d.value.abs()));
                        if known.iter().any(|d| d.error > 0.1 * tolerance * size) {
                            unsure += 1;
                            continue;
                        }
                        for (i, (found, known)) in found.iter().zip(&known).enumerate() {
                            let off = (found - known.value).abs() / size;
                            worst[order] = worst[order].max(off);
                            assert!(
                                off < tolerance,
                                "{pair:?} {:?} derivative {} of coordinate {i}: {found} {known:?}",
                                manipulator.mechanism(),
                                order + 1,
                            );
                        }
                        compared += 1;
                    }
                }
            }
        }
        println!(
            "{pair:?}: {compared} compared, {unsure} not, worst {:.1e} {:.1e}",
            worst[0], worst[1]
        );
        assert!(compared > 300 && unsure < compared / 5, "{pair:?}: {compared}, {unsure} unsure");
    }
}

/// The Jacobians by the rates of the task coordinates give the rates of [`Motion`], which are
/// compared with differences above. The platform's twist is that of its displacement.
#[test]
fn jacobians_compose_to_the_rates() {
    let mut rng = Rng::with_seed(71);
    for pair in PAIRS {
        let mut compared = 0;
        for round in 0..100 {
            let options = Options { limited: 0.0, balls: round % 2 == 0 };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
            let (mut motion, mut jacobians) = (manipulator.joint_motion(), manipulator.jacobians());
            let path = Path::random(&mut rng, &manipulator);
            let task = manipulator.task();
            manipulator.inverse_all(&path.pose, &mut all).unwrap();
            for mode in all.modes(&manipulator) {
                assert!(manipulator.solution_in_mode(&all, mode, &mut at).is_some());
                let still = vec![0.0; path.rates.len()];
                assert!(manipulator.velocity(&at, &path.rates, &still, &mut motion).unwrap());
                assert!(manipulator.differentiate(&at, &mut jacobians).unwrap());
                let twist = &jacobians.pose * DVector::from_column_slice(&path.rates);
                let rates = &jacobians.joints * &twist;
                let size = jacobians.joints.amax().max(1.0) * twist.amax().max(1.0);
                for (found, known) in rates.iter().zip(&motion.joint_rates) {
                    assert!((found - known).abs() < ROUNDING * size, "{pair:?} {found} {known}");
                }
                // q̇ = J_p [J_s upper; lower], at constant height.
                let (n_upper, bridges) = (jacobians.upper.ncols(), jacobians.upper.nrows());
                let level = n_upper + jacobians.lower.ncols() - bridges;
                let known = jacobians.joints.columns(0, level) * twist.rows(0, level);
                let across = &jacobians.upper * twist.rows(0, n_upper);
                let lower = twist.rows(n_upper, jacobians.lower.ncols() - bridges);
                let rates = jacobians.lower.columns(0, bridges) * &across
                    + jacobians.lower.columns_range(bridges..) * lower;
                let size = size * jacobians.lower.amax().max(1.0);
                assert_eq!(rates.len(), jacobians.lower_rows.len());
                for (found, &coordinate) in rates.iter().zip(&jacobians.lower_rows) {
                    let known = known[coordinate];
                    assert!((found - known).abs() < ROUNDING * size, "{pair:?} {found} {known}");
                }

                let moved = |t: f64| task.displacement(&path.at(t));
                let base = |t: f64| moved(t) * moved(0.0).inverse();
                let platform = moved(0.0) * manipulator.mechanism().platform;
                let spin = |t: f64| base(t).rotation.scaled_axis().as_slice().to_vec();
                let way = |t: f64| (base(t) * platform).coords.as_slice().to_vec();
                let found =
                    manipulator.twist_by_pose(&jacobians) * DVector::from_column_slice(&path.rates);
                let found = [found.fixed_rows::<3>(0), found.fixed_rows::<3>(3)];
                let known = [
                    derivatives(1e-2, |t| Some(spin(t))).unwrap(),
                    derivatives(1e-2, |t| Some(way(t))).unwrap(),
                ];
                for (found, known) in found.iter().zip(&known) {
                    for (found, [known, _]) in found.iter().zip(known) {
                        assert!((found - known.value).abs() < RATE, "{pair:?} {found} {known:?}");
                    }
                }
                compared += 1;
            }
        }
        assert!(compared > 50, "{pair:?}: {compared}");
    }
}

/// After a full revolution the rotation vector of a passive spherical joint has no derivative; the
/// mechanism does not depend on it.
#[test]
fn a_ball_at_a_whole_turn_is_no_singularity_of_the_mechanism() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let ball: Vec<usize> = (manipulator.coordinates().iter().enumerate())
        .filter_map(|(i, c)| c.name.starts_with("s4.").then_some(i))
        .collect();
    let (mut at, mut motion) = (manipulator.solution(), manipulator.joint_motion());
    let mut jacobians = manipulator.jacobians();
    let mut path = |zeta: f64| {
        let pose = [0.01, 0.0, zeta, 0.0, 0.0];
        assert!(
            manipulator.inverse_near(&pose, manipulator.home_mode(), &mut at).unwrap().is_some()
        );
        // The spherical joint rotates relative to the arm: by zeta minus the arm's angles.
        let turned = ball.iter().map(|&i| at.joints()[i].powi(2)).sum::<f64>().sqrt();
        (turned, at.clone())
    };
    let mut zeta = 0.0;
    while path(zeta).0 < TAU - 0.1 {
        zeta += 0.01;
    }
    // The rest is exact to the last digit or two.
    for _ in 0..3 {
        zeta += TAU - path(zeta).0 - 1e-9;
    }
    let (turned, at) = path(zeta);
    assert!((turned - TAU).abs() < 1e-8, "{turned}");
    let rates = [0.1, 0.2, 0.3, 0.4, 0.5];
    assert!(!manipulator.velocity(&at, &rates, &rates, &mut motion).unwrap());
    let singular =
        SingularLeg { leg: 3, section: Some(Section::Upper), cause: SingularCause::RotationVector };
    assert_eq!(motion.singular, [singular]);
    assert_eq!(manipulator.rateless(&singular).collect::<Vec<_>>(), ball);
    assert_eq!(manipulator.rateless_imaginary(&singular), None);
    assert!(!manipulator.differentiate(&at, &mut jacobians).unwrap());
    let conditioning = manipulator.conditioning(&jacobians, 0.1);
    assert!(conditioning.condition < 20.0, "{conditioning:?}");
    // All other joints move as they do in a solution without the revolution.
    let (mut fresh, mut known) = (manipulator.solution(), manipulator.joint_motion());
    let pose = [0.01, 0.0, zeta, 0.0, 0.0];
    assert!(manipulator.inverse(&pose, manipulator.home_mode(), &mut fresh).unwrap().is_some());
    manipulator.velocity(&fresh, &rates, &rates, &mut known).unwrap();
    for i in (0..motion.joint_rates.len()).filter(|i| !ball.contains(i)) {
        assert!((motion.joint_rates[i] - known.joint_rates[i]).abs() < 1e-9);
        assert!((motion.joint_accelerations[i] - known.joint_accelerations[i]).abs() < 1e-9);
    }
}

/// For all poses and rates, the answer is a finite number or an error.
#[test]
fn enormous_poses_and_rates_give_numbers_or_are_refused() {
    let mut rng = Rng::with_seed(72);
    let (mut answered, mut refused) = (0, 0);
    for pair in PAIRS {
        for _ in 0..40 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
            let (mut motion, mut jacobians) = (manipulator.joint_motion(), manipulator.jacobians());
            let mut measured = manipulator.singularities();
            let mut any =
                || 10.0_f64.powf(rng.f64() * 150.0 - 75.0) * if rng.bool() { 1.0 } else { -1.0 };
            let n = manipulator.task_coordinates().len();
            let [pose, rates, accelerations]: [Vec<f64>; 3] =
                std::array::from_fn(|_| (0..n).map(|_| any()).collect());
            manipulator.inverse_all(&pose, &mut all).unwrap();
            for mode in all.modes(&manipulator).take(2) {
                assert!(manipulator.solution_in_mode(&all, mode, &mut at).is_some());
                match manipulator.velocity(&at, &rates, &accelerations, &mut motion) {
                    Ok(_) => {
                        let rates = motion.joint_rates.iter().chain(&motion.imaginary_rates);
                        let accelerations = motion
                            .joint_accelerations
                            .iter()
                            .chain(&motion.imaginary_accelerations);
                        assert!(rates.chain(accelerations).all(|rate| rate.is_finite()));
                        answered += 1;
                    }
                    Err(error) => {
                        assert!(matches!(error, VelocityError::Overflow { .. }), "{error}");
                        refused += 1;
                    }
                }
                manipulator.differentiate(&at, &mut jacobians).unwrap();
                let conditioning =
                    manipulator.conditioning(&jacobians, manipulator.characteristic_length());
                assert!(conditioning.condition >= 1.0, "{pair:?} {conditioning:?}");
                assert!(conditioning.manipulability >= 0.0, "{pair:?} {conditioning:?}");
                manipulator.measure_singularities(&jacobians, &mut measured);
                for measures in [measured.upper, measured.lower, measured.whole] {
                    assert!(!measures.serial.is_nan(), "{pair:?} {measures:?}");
                    assert!(!measures.parallel.unwrap_or(0.0).is_nan(), "{pair:?} {measures:?}");
                }
            }
        }
    }
    println!("{answered} answered, {refused} refused");
    assert!(answered > 200, "{answered}");
}

#[test]
fn what_is_no_rate_is_refused() {
    let manipulator = Manipulator::example("translational-helical-3dof").unwrap();
    let (mut at, mut motion) = (manipulator.solution(), manipulator.joint_motion());
    let still = [0.0; 3];
    for (rates, message) in [
        (&[0.0; 2][..], "2 rates, expected 3"),
        (&[0.0, f64::NAN, 0.0], "y is NaN"),
        (&[f64::INFINITY, 0.0, 0.0], "x is inf"),
        (&[0.0, 0.0, -1e80], "phi is -1e80"),
    ] {
        let error = manipulator.velocity(&at, rates, &still, &mut motion).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        assert_eq!(
            manipulator.velocity(&at, &still, rates, &mut motion).unwrap_err().to_string(),
            error.to_string()
        );
    }
    // Before any pose, a solution is home.
    assert!(manipulator.velocity(&at, &still, &still, &mut motion).unwrap());
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    (at, motion) = (manipulator.solution(), manipulator.joint_motion());
    assert!(manipulator.inverse(&[9.0; 5], manipulator.home_mode(), &mut at).unwrap().is_none());
    let refused = manipulator.velocity(&at, &[0.0; 5], &[0.0; 5], &mut motion);
    assert_eq!(refused, Err(VelocityError::OutOfReach));
    assert!(manipulator.differentiate(&at, &mut manipulator.jacobians()).is_err());
}

/// The condition number and the manipulability, compared with another program's singular values,
/// from the platform's twist and the joints' rates by task coordinates: with fewer actuators than
/// freedoms, with as many, and with all joints actuated.
#[test]
fn conditioning_is_that_of_the_singular_values() {
    let mut rng = Rng::with_seed(73);
    let (mut compared, mut few) = (0, 0);
    for pair in PAIRS {
        for round in 0..40 {
            let options = Options { limited: 0.0, balls: round % 2 == 0 };
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
            for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
                joint.actuated = rng.f64() < 0.25 + 0.25 * f64::from(round % 4);
            }
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let path = Path::random(&mut rng, &manipulator);
            let mut at = manipulator.solution();
            if manipulator.inverse(&path.pose, manipulator.home_mode(), &mut at).unwrap().is_none()
            {
                continue;
            }
            let mut jacobians = manipulator.jacobians();
            assert!(manipulator.differentiate(&at, &mut jacobians).unwrap());
            let length = 0.1 + rng.f64();
            let found = manipulator.conditioning(&jacobians, length);
            let n = jacobians.pose.nrows();
            let actuated = manipulator.actuated();
            if actuated.len() < n {
                assert!(found.condition.is_infinite() && found.manipulability.is_infinite());
                let mut measured = manipulator.singularities();
                manipulator.measure_singularities(&jacobians, &mut measured);
                assert_eq!(measured.whole.parallel, None);
                few += 1;
                continue;
            }
            let by_pose = jacobians.joints_by_pose();
            let rows = DMatrix::from_fn(actuated.len(), n, |i, j| {
                let angle = manipulator.coordinates()[actuated[i]].quantity == Quantity::Angle;
                by_pose[(actuated[i], j)] / if angle { 1.0 } else { length }
            });
            let mut twists = &jacobians.platform * &jacobians.pose;
            twists.rows_mut(3, 3).scale_mut(1.0 / length);
            // The square root of the metric by its eigenvectors.
            let metric = (twists.transpose() * &twists).symmetric_eigen();
            if metric.eigenvalues.min() < 1e-4 * metric.eigenvalues.max() {
                continue; // The coordinates are nearly singular: not what is compared here.
            }
            let roots = metric.eigenvalues.map(|value| 1.0 / value.sqrt());
            let unit = &metric.eigenvectors * DMatrix::from_diagonal(&roots);
            let values = (rows * unit).singular_values();
            let condition = values.max() / values.min();
            if condition > 1e6 {
                continue;
            }
            let manipulability = 1.0 / values.iter().product::<f64>();
            assert!((found.condition / condition - 1.0).abs() < 1e-7, "{found:?} {condition}");
            let off = found.manipulability / manipulability - 1.0;
            assert!(off.abs() < 1e-7, "{found:?} {manipulability}");
            compared += 1;
        }
    }
    println!("{compared} compared, {few} with too few actuators");
    assert!(compared > 200 && few > 50, "{compared} {few}");
}
