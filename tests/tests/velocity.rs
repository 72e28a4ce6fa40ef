//! Velocities and accelerations on random mechanisms of every pair of subspaces, held against
//! differences of the inverse kinematics.

use fastrand::Rng;
use nalgebra::DVector;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_tests::differences::{Estimate, derivatives};
use opm_tests::random::{Options, PAIRS, mechanism};

/// Relative to the largest derivative of the same order at the pose.
const RATE: f64 = 1e-9;
const ACCELERATION: f64 = 1e-7;
/// Two ways to the same number, relative to the numbers on the way.
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
        let home = manipulator.task().home();
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

/// Joints, then imaginary joints, on the way through a solution.
fn through(
    manipulator: &Manipulator,
    path: &Path,
    mode: Mode,
    at: &Solution,
    t: f64,
) -> Option<Vec<f64>> {
    let mut moved = at.clone();
    let reached = manipulator.inverse_near(&path.at(t), mode, &mut moved).unwrap();
    reached.then(|| [moved.joints, moved.imaginary].concat())
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
            let mut motion = manipulator.motion();
            for _ in 0..4 {
                let path = Path::random(&mut rng, &manipulator);
                manipulator.inverse_all(&path.pose, &mut all).unwrap();
                for mode in all.modes(&manipulator) {
                    assert!(manipulator.pick(&all, mode, &mut at));
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

/// The Jacobians by the rates of the task coordinates give the rates of [`Motion`], which are held
/// against differences above; the platform's twist is that of its displacement.
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
            let (mut motion, mut jacobians) = (manipulator.motion(), manipulator.jacobians());
            let path = Path::random(&mut rng, &manipulator);
            let task = manipulator.task();
            manipulator.inverse_all(&path.pose, &mut all).unwrap();
            for mode in all.modes(&manipulator) {
                assert!(manipulator.pick(&all, mode, &mut at));
                let still = vec![0.0; path.rates.len()];
                assert!(manipulator.velocity(&at, &path.rates, &still, &mut motion).unwrap());
                assert!(manipulator.differentiate(&at, &mut jacobians).unwrap());
                let twist = &jacobians.pose * DVector::from_column_slice(&path.rates);
                let rates = &jacobians.joints * &twist;
                let size = jacobians.joints.amax().max(1.0) * twist.amax().max(1.0);
                for (found, known) in rates.iter().zip(&motion.joint_rates) {
                    assert!((found - known).abs() < ROUNDING * size, "{pair:?} {found} {known}");
                }
                // q̇ = J_p [J_s upper; lower].
                let (n_upper, bridges) = (jacobians.upper.ncols(), jacobians.upper.nrows());
                let across = &jacobians.upper * twist.rows(0, n_upper);
                let lower = twist.rows(n_upper, twist.len() - n_upper);
                let rates = jacobians.lower.columns(0, bridges) * &across
                    + jacobians.lower.columns_range(bridges..) * lower;
                let size = size * jacobians.lower.amax().max(1.0);
                assert_eq!(rates.len(), jacobians.lower_rows.len());
                for (found, &coordinate) in rates.iter().zip(&jacobians.lower_rows) {
                    let known = motion.joint_rates[coordinate];
                    assert!((found - known).abs() < ROUNDING * size, "{pair:?} {found} {known}");
                }

                let moved = |t: f64| task.displacement(&path.at(t));
                let base = |t: f64| moved(t) * moved(0.0).inverse();
                let platform = moved(0.0) * manipulator.mechanism().platform;
                let spin = |t: f64| base(t).rotation.scaled_axis().as_slice().to_vec();
                let way = |t: f64| (base(t) * platform).coords.as_slice().to_vec();
                let v = task.lower.isometry(&task.lower(&path.pose)).rotation;
                let found = &jacobians.platform * &twist;
                let (omega, velocity) = (found.fixed_rows::<3>(0), found.fixed_rows::<3>(3));
                let found = [v * omega.into_owned(), v * velocity.into_owned()];
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
