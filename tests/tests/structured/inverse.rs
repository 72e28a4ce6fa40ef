//! Inverse kinematics at structured poses: what is found closes the legs as they stand in the mechanism.

use fastrand::Rng;
use opm_core::manipulator::{BatchOutput, Manipulator, Mode};
use opm_tests::random::{Options, PAIRS, mechanism};
use opm_tests::structured::{gap, manipulators, pose, quarter_turns};

/// At singular poses, where joints are the root of what rounding leaves, this is its size.
const CLOSES: f64 = 1e-7;

/// Every mode closes, says what it is, and is found again by each of the other ways. Returns how many.
fn check(m: &Manipulator, pose: &[f64]) -> usize {
    let name = &m.mechanism().name;
    let (mut all, mut picked, mut alone) = (m.all_modes(), m.solution(), m.solution());
    let mut drives = m.actuated_joints();
    let reached = m.inverse_all(pose, &mut all).unwrap().is_some();
    let modes: Vec<Mode> = all.modes(m).collect();
    assert_eq!(reached, !modes.is_empty(), "{name} {pose:?}");
    for &mode in &modes {
        assert!(m.solution_in_mode(&all, mode, &mut picked).is_some(), "{name} {pose:?}");
        assert!(m.inverse(pose, mode, &mut alone).unwrap().is_some(), "{name} {pose:?}");
        assert_eq!((&picked.joints(), &picked.imaginary()), (&alone.joints(), &alone.imaginary()));
        assert!(m.inverse_actuated(pose, mode, &mut drives).unwrap().is_some(), "{name} {pose:?}");
        let actuated: Vec<f64> = m.actuated().iter().map(|&i| alone.joints()[i]).collect();
        assert_eq!((drives.actuated(), drives.imaginary()), (&actuated[..], alone.imaginary()));
        let off = gap(m, alone.joints(), &alone.displacement(m));
        assert!(off < CLOSES, "{name} {pose:?} {}: off by {off:e}", m.format_mode(mode));
        // From where it is, nothing moves.
        let before = alone.joints().to_vec();
        assert!(m.inverse_near(pose, mode, &mut alone).unwrap().is_some());
        let moved = before.iter().zip(alone.joints()).map(|(a, b)| (a - b).abs());
        assert!(moved.fold(0.0, f64::max) < 1e-9, "{name} {pose:?}");
    }
    modes.len()
}

/// Many poses at once give what one gives, to the bit.
fn check_many(m: &Manipulator, poses: &[Vec<f64>], mode: Mode) {
    let (joints, imaginary) = (m.coordinates().len(), m.imaginary().len());
    let mut out = (vec![0.0; poses.len() * joints], vec![0.0; poses.len() * imaginary]);
    let (mut reachable, mut within) = (vec![false; poses.len()], vec![false; poses.len()]);
    let mut answers = BatchOutput {
        joints: &mut out.0,
        imaginary: &mut out.1,
        reachable: &mut reachable,
        within_limits: &mut within,
    };
    m.inverse_many(&poses.concat(), mode, &mut m.batch(), &mut answers).unwrap();
    let mut solution = m.solution();
    for (row, pose) in poses.iter().enumerate() {
        let name = &m.mechanism().name;
        let reached = m.inverse(pose, mode, &mut solution).unwrap().is_some();
        assert_eq!(reachable[row], reached, "{name} {pose:?}");
        if reached {
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let found = &out.0[row * joints..][..joints];
            assert_eq!(bits(found), bits(solution.joints()), "{name} {pose:?}");
            let found = &out.1[row * imaginary..][..imaginary];
            assert_eq!(bits(found), bits(solution.imaginary()), "{name} {pose:?}");
        }
    }
}

#[test]
fn solutions_close_in_every_mode() {
    let mut rng = Rng::with_seed(10);
    for m in manipulators() {
        // A hexapod has thousands of modes at each pose.
        let many = m.modes().nth(300).is_some();
        let poses: Vec<Vec<f64>> = (0..if many { 30 } else { 600 })
            .map(|i| if i % 2 == 0 { pose(&mut rng, &m) } else { quarter_turns(&mut rng, &m) })
            .collect();
        let found: usize = poses.iter().map(|pose| check(&m, pose)).sum();
        assert!(found > 300, "{}: {found}", m.mechanism().name);
        let modes: Vec<Mode> = m.modes().collect();
        for mode in [m.home_mode(), modes[rng.usize(..modes.len())]] {
            check_many(&m, &poses, mode);
        }
    }
    for pair in PAIRS {
        for _ in 0..8 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let m = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let poses: Vec<Vec<f64>> = (0..60).map(|_| pose(&mut rng, &m)).collect();
            let found: usize = poses.iter().map(|pose| check(&m, pose)).sum();
            assert!(found > 0, "{pair:?}");
            check_many(&m, &poses, m.home_mode());
        }
    }
}

/// At home, in the mode it is assembled in, every joint is at home.
#[test]
fn home_is_home() {
    for m in manipulators() {
        let mut solution = m.solution();
        assert!(m.inverse(&m.home_pose(), m.home_mode(), &mut solution).unwrap().is_some());
        for (c, q) in m.coordinates().iter().zip(solution.joints()) {
            assert!((c.home - q).abs() < 1e-7, "{} {}: {q}", m.mechanism().name, c.name);
        }
    }
}

/// Every mode is read from what it is written as.
#[test]
fn modes_are_read_as_they_are_written() {
    for m in manipulators() {
        let mut texts: Vec<String> = m.modes().map(|mode| m.format_mode(mode)).collect();
        for (mode, text) in m.modes().zip(&texts) {
            assert_eq!(m.parse_mode(text).unwrap(), mode);
            let bare: String = text.split(' ').collect();
            assert_eq!(m.parse_mode(&bare).unwrap(), mode);
            assert_eq!(bare.len(), m.choices() as usize);
        }
        texts.sort();
        texts.dedup();
        assert_eq!(texts.len(), 1 << m.choices());
        let few = "+".repeat((m.choices() as usize).saturating_sub(1));
        assert_eq!(m.parse_mode(&few).is_ok(), m.choices() == 0);
    }
}
