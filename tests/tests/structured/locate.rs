//! Poses and displacements of the platform, there and back.

use fastrand::Rng;
use nalgebra::{Isometry3, Matrix3, Vector3};
use opm_core::manipulator::Manipulator;
use opm_core::numeric::rotation;
use opm_tests::random::{Options, PAIRS, mechanism};
use opm_tests::structured::{
    angles, apart, axes, displacement, manipulators, matrix, pose, quarter_turns,
};

/// Rounding of two dozen operations.
const ROUNDING: f64 = 1e-12;
/// The same, and tilts of up to 1e-13 that are given as none, with levers of some hundred sizes of the mechanism.
const BACK: f64 = 1e-10;

/// Whether other coordinates do not follow from those of a pose: where a Tricept's stem is level, along the first axis of its
/// universal joint, its position does not tell how it is turned.
fn loses_its_way(m: &Manipulator, pose: &[f64]) -> bool {
    if m.decomposition().constrained.is_none() {
        return false;
    }
    let (mut at, mut jacobians, mut measured) = (m.solution(), m.jacobians(), m.singularities());
    if m.inverse(pose, m.home_mode(), &mut at).unwrap().is_none() {
        return true;
    }
    let _ = m.differentiate(&at, &mut jacobians);
    m.measure_singularities(&jacobians, &mut measured);
    measured.coordinates.abs() < 1e-3
}

/// A pose leads to a displacement of the platform, that back to a pose, and that to the same displacement. Returns `false` for a
/// pose without a displacement of its own.
fn there_and_back(m: &Manipulator, pose: &[f64]) -> bool {
    let (name, task) = (&m.mechanism().name, m.task());
    // Dependent coordinates have no solution at some poses.
    let Ok(target) = m.displacement(pose) else { return false };
    if m.dependent_coordinates().is_empty() {
        let (v, b) = (task.lower(pose), task.upper(&pose[task.lower_count..]));
        let found = task.pose(&v, &b, task.rise(pose));
        let off = apart(m, &task.displacement(&found), &target);
        assert!(off < BACK, "{name} {pose:?}: {found:?} is {off:e} off");
    }
    if loses_its_way(m, pose) {
        return false;
    }
    let found = m.locate(&target).unwrap_or_else(|e| panic!("{name} {pose:?}: {e}"));
    let off = apart(m, &m.displacement(&found).unwrap(), &target);
    assert!(off < BACK, "{name} {pose:?}: {found:?} is {off:e} off");
    let target = m.platform_pose(pose).unwrap();
    let found = m.locate_platform(&target).unwrap_or_else(|e| panic!("{name} {pose:?}: {e}"));
    let off = apart(m, &m.platform_pose(&found).unwrap(), &target);
    assert!(off < BACK, "{name} {pose:?}: {found:?} is {off:e} off");
    true
}

#[test]
fn poses_come_back_from_their_displacements() {
    let mut rng = Rng::with_seed(1);
    let shipped = |m: &Manipulator, rng: &mut Rng| {
        let mut came_back = 0;
        for _ in 0..1_500 {
            came_back += usize::from(there_and_back(m, &pose(rng, m)));
            came_back += usize::from(there_and_back(m, &quarter_turns(rng, m)));
        }
        assert!(came_back > 300, "{}: {came_back}", m.mechanism().name);
    };
    let (whole, split): (Vec<_>, Vec<_>) =
        manipulators().into_iter().partition(Manipulator::is_whole);
    split.iter().for_each(|m| shipped(m, &mut rng));
    for pair in PAIRS {
        for _ in 0..20 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let m = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            for _ in 0..50 {
                there_and_back(&m, &pose(&mut rng, &m));
                there_and_back(&m, &quarter_turns(&mut rng, &m));
            }
        }
    }
    whole.iter().for_each(|m| shipped(m, &mut rng));
}

/// Any rotation is a pose of a manipulator with a spherical upper section: here matrices, not poses, are what
/// is given, and products of matrices of what comes back.
#[test]
fn rotation_matrices_are_located() {
    let all = manipulators();
    let m = all.iter().find(|m| m.mechanism().name == "plano-spherical-5dof").unwrap();
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let check = |given: &Matrix3<f64>| {
        let rotation = rotation::nearest(given).unwrap();
        let place = Isometry3::from_parts(Vector3::new(0.1, -0.2, 0.0).into(), rotation);
        let pose = m.locate_platform(&place).unwrap();
        assert!((pose[0] - 0.1).abs() + (pose[1] + 0.2).abs() < ROUNDING, "{given}{pose:?}");
        let found = matrix(&z, pose[2]) * matrix(&y, pose[3]) * matrix(&z, pose[4]);
        assert!((found - given).amax() < ROUNDING, "{given}{pose:?}");
    };
    check(&Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0)));
    for first in [x, y, z] {
        for second in axes() {
            for angle in angles() {
                check(&matrix(&second, angle));
                check(&(matrix(&first, std::f64::consts::FRAC_PI_2) * matrix(&second, angle)));
            }
        }
    }
    let mut rng = Rng::with_seed(2);
    for _ in 0..2_000 {
        // Exact half turns: the matrix is symmetric.
        let axis = opm_tests::random::direction(&mut rng).into_inner();
        check(&(axis * axis.transpose() * 2.0 - Matrix3::identity()));
    }
}

/// What is outside of the motion: no pose that many others lead to is nearer than the one that is told, and
/// what is told to be missing is what is missing.
#[test]
fn nothing_is_nearer_than_the_nearest() {
    let mut rng = Rng::with_seed(3);
    let (mut outside, mut beaten) = (0, 0);
    // With dependent coordinates the pose that is told is near, not nearest.
    for m in manipulators().into_iter().filter(|m| m.dependent_coordinates().is_empty()) {
        let (name, size) = (&m.mechanism().name, m.characteristic_length());
        let miss = |target: &Isometry3<f64>, pose: &[f64]| {
            let here = m.task().displacement(pose);
            let turn = (target.rotation * here.rotation.inverse()).angle();
            let way = (target * m.mechanism().platform - here * m.mechanism().platform) / size;
            turn.hypot(way.norm())
        };
        for _ in 0..15 {
            let mut target = displacement(&mut rng);
            target.translation.vector *= size;
            let Err(told) = m.locate(&target) else { continue };
            outside += 1;
            let here = m.task().displacement(&told.nearest);
            let off = told.rotation.norm().hypot(told.translation.norm() / size);
            assert!((off - miss(&target, &told.nearest)).abs() < 1e-9, "{name}");
            let turned = matrix(
                &told.rotation.try_normalize(0.0).unwrap_or(Vector3::x()),
                told.rotation.norm(),
            ) * here.rotation.to_rotation_matrix().into_inner();
            let given = target.rotation.to_rotation_matrix().into_inner();
            assert!((turned - given).amax() < 1e-9, "{name}");
            let point = here * m.mechanism().platform + told.translation;
            assert!((point - target * m.mechanism().platform).norm() < 1e-9 * size, "{name}");
            // A search that only compares: ever smaller steps from many poses.
            let mut best = f64::INFINITY;
            for start in 0..24 {
                let mut pose = if start == 0 { m.home_pose() } else { pose(&mut rng, &m) };
                let (mut least, mut step) = (miss(&target, &pose), 1.0);
                while step > 1e-3 {
                    let mut better = false;
                    for i in 0..pose.len() {
                        for by in [step, -step] {
                            let before = pose[i];
                            pose[i] += by;
                            let now = miss(&target, &pose);
                            if now < least {
                                (least, better) = (now, true);
                            } else {
                                pose[i] = before;
                            }
                        }
                    }
                    step *= if better { 1.0 } else { 0.5 };
                }
                best = best.min(least);
            }
            if best < off - 1e-6 {
                beaten += 1;
                println!("{name}: {off} where {best} is possible; {target}");
            }
        }
    }
    assert!(outside > 80, "{outside}");
    assert_eq!(beaten, 0, "of {outside}");
}
