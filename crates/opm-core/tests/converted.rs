//! The mechanism of a family, written as a list of joints and read again, is the same mechanism.

use fastrand::Rng;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::OrientationCoordinates;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::mechanism::family::ParameterValue::{Number, Pair};
use opm_core::mechanism::file::{self, Digits, MechanismFile};

/// Radians and metres: rounding of a file's numbers, and of two ways through the same closed forms.
const SAME: f64 = 1e-12;
/// Poses of each mechanism, and how far from home they are, radians and metres.
const POSES: usize = 100;
const FAR: f64 = 0.2;

/// Every shipped family; each also at another home, with tilt and torsion where it has an orientation.
fn families() -> Vec<MechanismFile> {
    let shipped = EXAMPLES.iter().map(|example| file::read(example.text).unwrap());
    let shipped: Vec<_> = shipped.filter(|file| file.family.is_some()).collect();
    assert_eq!(shipped.len(), 3, "every family is shipped");
    let elsewhere = shipped.iter().map(|file| {
        let moved = ["home.x", "home.y", "home.xi", "home.zeta", "home.phi"];
        let moved = moved.into_iter().filter(|name| file.quantity_of(name).is_some());
        let moved = moved.enumerate().map(|(i, name)| (name, Number(5e-4 * (i + 1) as f64)));
        let limits = [("max_rate.S", Number(0.5)), ("limits.S", Pair([-0.6, 0.7]))];
        let mut other = file.with(moved.chain(limits)).unwrap();
        if file.quantity_of("home.xi").is_some() {
            other.mechanism.task.coordinates = Some(OrientationCoordinates::TiltTorsion);
        }
        other
    });
    elsewhere.collect::<Vec<_>>().into_iter().chain(shipped).collect()
}

#[test]
fn a_family_as_a_list_of_joints_has_the_same_inverse_kinematics() {
    let mut rng = Rng::with_seed(19);
    for family in families() {
        let text = file::write(&family.mechanism, family.units, Digits::All);
        let list = file::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert!(list.family.is_none() && !text.contains("family"));
        assert_eq!(list.units, family.units);
        for (one, other) in list.mechanism.joints().zip(family.mechanism.joints()) {
            assert_eq!((&one.name, one.actuated), (&other.name, other.actuated));
            for (one, other) in one.coordinates.iter().zip(&other.coordinates) {
                let ends = |limits: Option<[f64; 2]>| limits.unwrap_or_default();
                assert_eq!(one.limits.is_some(), other.limits.is_some());
                for (one, other) in ends(one.limits).iter().zip(ends(other.limits)) {
                    assert!((one - other).abs() < SAME);
                }
                let rate = |limit: Option<f64>| limit.unwrap_or_default();
                let limits = [one.motion_limits, other.motion_limits];
                let [one, other] = limits.map(|l| [l.max_rate, l.max_acceleration].map(rate));
                assert!(one.iter().zip(other).all(|(one, other)| (one - other).abs() < SAME));
            }
        }
        let [list, family] = [list, family].map(|file| Manipulator::new(file.mechanism).unwrap());
        assert_eq!(list.home_mode(), family.home_mode());
        for (one, other) in list.task_coordinates().iter().zip(family.task_coordinates()) {
            assert_eq!(one.name, other.name);
            assert!((one.home - other.home).abs() < SAME);
        }
        let [mut one, mut other] = [list.solution(), family.solution()];
        let (mut reached, mut within) = (0, 0);
        for _ in 0..POSES {
            let home = family.home_pose();
            let pose: Vec<f64> =
                home.iter().map(|home| home + FAR * (2.0 * rng.f64() - 1.0)).collect();
            for mode in family.modes() {
                let found = list.inverse(&pose, mode, &mut one).unwrap();
                let known = family.inverse(&pose, mode, &mut other).unwrap();
                assert_eq!(found.is_some(), known.is_some(), "{pose:?}");
                let (Some(found), Some(known)) = (found, known) else { continue };
                assert_eq!(found.within_limits(), known.within_limits());
                for (one, other) in found.joints().iter().zip(known.joints()) {
                    assert!((one - other).abs() < SAME, "{pose:?}: {one} {other}");
                }
                reached += 1;
                within += u32::from(found.within_limits());
            }
        }
        assert!(reached > 60 && within > 0, "{reached} {within}");
    }
}
