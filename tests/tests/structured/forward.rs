//! Forward kinematics of the joints of structured poses.

use fastrand::Rng;
use nalgebra::{Isometry3, Translation3};
use opm_core::forward::{Completeness, ForwardMethod, RESIDUAL};
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::mechanism::joint::JointKind;
use opm_tests::displacement;
use opm_tests::structured::{apart, gap, manipulators, pose, quarter_turns};
use std::f64::consts::TAU;

/// Near a singularity half of the digits go, and some more with lengths beside the mechanism's size.
const SAME: f64 = 1e-6;
/// The same where equations are fitted to some 1e-12, of which a double solution keeps half of the digits.
const SAME_FITTED: f64 = 1e-5;

/// Every assembly closes; the one that the joints came from is among them, unless the answer says that the
/// joints leave it loose, or that assemblies meet.
fn check(m: &Manipulator, pose: &[f64], mode: Mode) -> [usize; 2] {
    let name = &m.mechanism().name;
    let mut at = m.solution();
    if m.inverse(pose, mode, &mut at).unwrap().is_none() {
        return [0, 0];
    }
    let actuated: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
    let target = at.displacement(m);
    let Ok(found) = m.forward(&actuated) else { return [0, 0] };
    for a in &found.list {
        let off = gap(m, &a.joints, &displacement(m, &a.pose, a.mode));
        assert!(off < 10.0 * RESIDUAL, "{name} {pose:?}: {a:?} is {off:e} off");
    }
    let (meets, same) = match found.completeness {
        Completeness::ClosedForm if m.forward_closed_form().is_ok() => (false, SAME),
        // Spheres and planes that are fitted.
        Completeness::ClosedForm => (is_singular(m, &at), SAME_FITTED),
        Completeness::Continuation { found, of } => (found < of, SAME_FITTED),
    };
    // Continuation finds isolated assemblies.
    let loose = match found.completeness {
        Completeness::ClosedForm => meets || !found.loose.is_empty(),
        Completeness::Continuation { .. } => {
            meets || is_singular(m, &at) || !is_told_by_coordinates(m, pose, mode)
        }
    };
    if loose {
        return [0, 1];
    }
    let targets = advanced(m, &target);
    let back = found.list.iter().any(|a| {
        let here = displacement(m, &a.pose, a.mode);
        targets.iter().any(|target| apart(m, &here, target) < same)
    });
    assert!(
        back,
        "{name} {pose:?} {} {actuated:?}: none of {:?}",
        m.format_mode(mode),
        found.list.iter().map(|a| (&a.pose, m.format_mode(a.mode))).collect::<Vec<_>>()
    );
    [1, 0]
}

/// Whether the platform can move at a solution with its actuated joints held, or legs are stretched there.
fn is_singular(m: &Manipulator, at: &Solution) -> bool {
    let (mut jacobians, mut measured) = (m.jacobians(), m.singularities());
    if !m.differentiate(at, &mut jacobians).is_ok_and(|regular| regular) {
        return true;
    }
    m.measure_singularities(&jacobians, &mut measured);
    let zero = |measure: f64| measure.abs() < 1e-6;
    measured.legs.iter().flatten().any(|measure| zero(*measure))
        || measured.whole.parallel.is_none_or(zero)
}

/// Whether coordinates tell a place: they are found again from it, and their rounding moves the platform by little more than rounding.
/// Neither holds everywhere: at a pole of the angles, and on the first axis of a Tricept's universal joint, where x, y and z leave
/// the angle about it open.
fn is_told_by_coordinates(m: &Manipulator, pose: &[f64], mode: Mode) -> bool {
    let place = m.displacement_in(pose, mode).unwrap();
    let near = |pose: &[f64]| {
        m.displacement_in(pose, mode).is_ok_and(|other| apart(m, &other, &place) < SAME)
    };
    m.locate(&place).is_ok_and(|pose| near(&pose))
        && (0..pose.len()).all(|coordinate| {
            let mut other = pose.to_vec();
            other[coordinate] += 1e-10;
            near(&other)
        })
}

/// A place, and those that whole turns of a screw advance it to: inverse kinematics do not tell the turns of a
/// revolute that hands them on to a screw.
fn advanced(m: &Manipulator, target: &Isometry3<f64>) -> Vec<Isometry3<f64>> {
    let mut all = vec![*target];
    for joint in m.mechanism().joints() {
        if let JointKind::Helical { pitch } = joint.kind {
            let advance = joint.axis.into_inner() * (pitch * TAU);
            let by = |turns: i32| Translation3::from(advance * f64::from(turns)) * target;
            all.extend((-8..=8).map(by));
        }
    }
    all
}

#[test]
fn joints_of_structured_poses_lead_back() {
    let mut rng = Rng::with_seed(40);
    for m in manipulators() {
        let modes: Vec<Mode> = m.modes().collect();
        let [mut found, mut loose] = [0, 0];
        // A continuation takes some milliseconds.
        let method = m.forward_method();
        let rounds = if method == Ok(ForwardMethod::Continuation) { 30 } else { 300 };
        for round in 0..rounds {
            let pose =
                if round % 3 == 0 { quarter_turns(&mut rng, &m) } else { pose(&mut rng, &m) };
            let mode = if rng.bool() { m.home_mode() } else { modes[rng.usize(..modes.len())] };
            let [one, other] = check(&m, &pose, mode);
            (found, loose) = (found + one, loose + other);
        }
        println!("{}: {found} found, {loose} loose", m.mechanism().name);
        let enough = match method {
            Ok(ForwardMethod::ClosedForm) => found > 50,
            Ok(ForwardMethod::Continuation) => found > 10,
            Err(_) => true,
        };
        assert!(enough, "{}: {found}", m.mechanism().name);
    }
}

/// Newton's method from a structured pose to one nearby: it ends at an assembly, or says why not.
#[test]
fn steps_from_structured_poses_arrive() {
    let mut rng = Rng::with_seed(41);
    for m in manipulators() {
        let name = &m.mechanism().name;
        let (mut arrived, mut tried) = (0, 0);
        for _ in 0..100 {
            let start = pose(&mut rng, &m);
            let aim: Vec<f64> = start.iter().map(|q| q + 0.004 * (rng.f64() - 0.5)).collect();
            let (mut at, mode) = (m.solution(), m.home_mode());
            if m.inverse(&start, mode, &mut at).unwrap().is_none()
                || m.inverse(&aim, mode, &mut at).unwrap().is_none()
            {
                continue;
            }
            tried += 1;
            let actuated: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
            if let Ok(found) = m.forward_near(&actuated, &start, mode) {
                arrived += 1;
                let off = gap(&m, &found.joints, &displacement(&m, &found.pose, found.mode));
                assert!(off < 10.0 * RESIDUAL, "{name} {start:?}: {off:e}");
                for (&i, given) in m.actuated().iter().zip(&actuated) {
                    let off = found.joints[i] - given;
                    let turns = (off / TAU).round() * TAU;
                    assert!((off - turns).abs() < 1e-9, "{name} {start:?}");
                }
            }
        }
        println!("{name}: {arrived} of {tried}");
        assert!(2 * arrived > tried && tried > 20, "{name}: {arrived} of {tried}");
    }
}
