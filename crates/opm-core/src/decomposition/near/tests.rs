use super::*;
use crate::Manipulator;
use crate::decomposition::samples::{Numbers, displaced, gough};
use crate::group::subspace::Frame;
use crate::mechanism::examples::SPLIT;
use crate::mechanism::file::{self, AngleUnit, FileUnits, LengthUnit};
use crate::mechanism::joint::{Joint, JointKind};
use crate::numeric::Quantity;
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// The units that messages are in here.
const MILLIMETRES: FileUnits =
    FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };

/// Rounding of exact numbers, relative to the mechanism's size.
const ROUNDED: f64 = 1e-12;
/// Legs of a solved pose meet to this; the pose is some sizes away from home.
const CLOSED: f64 = 1e-10;

/// The shipped mechanisms that are lists of joints.
fn shipped() -> Vec<Mechanism> {
    let read = |text| file::read(text).expect("a shipped mechanism");
    let files = SPLIT.iter().map(|example| read(example.text));
    let lists: Vec<_> = files.filter(|f| f.family.is_none()).map(|f| f.mechanism).collect();
    assert!(lists.len() >= 9);
    lists
}

fn example(name: &str) -> Mechanism {
    shipped().into_iter().find(|mechanism| mechanism.name == name).expect("a shipped mechanism")
}

/// A number with some significant digits.
fn digits(value: f64, count: usize) -> f64 {
    format!("{value:.*e}", count - 1).parse().expect("a number")
}

/// A mechanism whose axes and points (in millimetres) have some significant digits.
fn rounded(mechanism: &Mechanism, count: usize) -> Mechanism {
    let direction = |axis: Unit<Vector3<f64>>| Unit::new_normalize(axis.map(|c| digits(c, count)));
    let mut rounded = mechanism.clone();
    for joint in rounded.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        joint.axis = direction(joint.axis);
        joint.point = joint.point.map(|c| digits(c * 1e3, count) / 1e3);
        if let JointKind::Universal { second } = &mut joint.kind {
            *second = direction(*second);
        }
    }
    rounded
}

/// A mechanism at some place, so that rounding changes all of its numbers.
fn somewhere(mechanism: &Mechanism, seed: u64) -> Mechanism {
    displaced(mechanism, &Numbers::new(seed).displacement(0.1))
}

/// λ, N, J, M, the sections, and the split of each leg, of the preferred decomposition.
fn essence(mechanism: &Mechanism) -> String {
    let found = plain(mechanism).unwrap_or_else(|error| panic!("{}: {error}", mechanism.name));
    let d = &found[0];
    let names = [d.lower, d.upper, d.intersection].map(|class| class.name());
    let counts = (d.lambda, d.mobility, d.imaginary_joints, d.first_section_motions);
    format!("{counts:?} {names:?} {:?}", d.legs)
}

/// Asserts that a mechanism is exact and has the decomposition of another one, and that its legs meet
/// at poses about home.
#[track_caller]
fn assert_exact(found: &Mechanism, original: &Mechanism) {
    assert_eq!(essence(found), essence(original), "{}", found.name);
    assert!(plain(found).unwrap()[0].deviation < ROUNDED, "{}", found.name);
    // Linkages and mechanisms without closed forms have no inverse kinematics.
    let Ok(manipulator) = Manipulator::new(found.clone()) else {
        assert!(Manipulator::new(original.clone()).is_err(), "{}", found.name);
        return;
    };
    let home: Vec<f64> = manipulator.task_coordinates().iter().map(|c| c.home).collect();
    let mut buffer = manipulator.solution();
    let mut numbers = Numbers::new(1);
    let mut reached = 0;
    for _ in 0..50 {
        let pose: Vec<f64> = home.iter().map(|c| c + 0.02 * numbers.next()).collect();
        let mode = manipulator.home_mode();
        let Ok(Some(solution)) = manipulator.inverse(&pose, mode, &mut buffer) else { continue };
        reached += 1;
        let mut first = 0;
        let tips = found.legs.iter().map(|leg| {
            let count = leg.coordinates().count();
            first += count;
            leg.displacement(&solution.joints()[first - count..first]).unwrap()
        });
        let tips: Vec<_> = tips.collect();
        for tip in &tips[1..] {
            let gap = (tip.to_homogeneous() - tips[0].to_homogeneous()).amax();
            assert!(gap < CLOSED, "{}: {gap}", found.name);
        }
    }
    assert!(reached > 10, "{}: {reached} poses in reach", found.name);
}

fn worst_joint(near: &NearMiss) -> [&str; 2] {
    [&near.joints[0].leg, &near.joints[0].joint]
}

#[test]
fn exact_mechanisms_stay_as_they_are() {
    for mechanism in shipped() {
        assert_eq!(nearly(&mechanism), Ok(None), "{}", mechanism.name);
        for tolerance in [1e-6, 1e-3] {
            let snapped = snap(&mechanism, tolerance).unwrap();
            let kept = Snapped { mechanism: mechanism.clone(), joints: vec![] };
            assert_eq!(snapped, kept, "{}", mechanism.name);
        }
    }
}

#[test]
fn two_or_three_digits_are_enough() {
    let mut snapped_some = 0;
    for mechanism in shipped() {
        for seed in 0..5 {
            let placed = if seed == 0 { mechanism.clone() } else { somewhere(&mechanism, seed) };
            for (count, tolerance) in [(2, 0.02), (3, 0.002)] {
                let printed = rounded(&placed, count);
                let snapped = snap(&printed, tolerance).unwrap();
                assert_exact(&snapped.mechanism, &mechanism);
                if snapped.joints.is_empty() {
                    continue;
                }
                snapped_some += 1;
                // The tolerance that a message offers is enough.
                if let Some(near) = nearly(&printed).unwrap() {
                    let offered = snap(&printed, near.tolerance * 1.001).unwrap();
                    assert_exact(&offered.mechanism, &mechanism);
                    assert!(near.joints.len() <= snapped.joints.len());
                }
            }
        }
    }
    assert!(snapped_some > 30, "{snapped_some} mechanisms were not exact after rounding");
}

/// The directions of the joints that an inexact axis makes inexact.
fn tilt(joint: &mut Joint, across: Vector3<f64>) {
    let axis = Unit::new_normalize(joint.axis.cross(&across));
    joint.axis = UnitQuaternion::from_axis_angle(&axis, 1_f64.to_radians()) * joint.axis;
}

#[test]
fn an_axis_that_is_one_degree_off_is_named() {
    let (mut named, mut alone) = (0, 0);
    for mechanism in shipped() {
        let length = frame(&mechanism).length;
        for leg in 0..mechanism.legs.len() {
            for joint in 0..mechanism.legs[leg].joints.len() {
                let mut bent = somewhere(&mechanism, 7);
                let id =
                    [&bent.legs[leg].name, &bent.legs[leg].joints[joint].name].map(String::clone);
                tilt(&mut bent.legs[leg].joints[joint], Vector3::new(0.3, 0.5, -0.8));
                let Some(near) = nearly(&bent).unwrap() else { continue };
                named += 1;
                // Where a section has few joints, its fit may give the angle to several of them.
                let is_it = |miss: &JointMiss| [&miss.leg, &miss.joint] == [&id[0], &id[1]];
                assert!(near.joints.iter().any(is_it), "{}: {near}", mechanism.name);
                if near.joints.len() > 1 {
                    println!("{}: {near}\n{:?} {}", mechanism.name, near.lower, near.upper);
                }
                alone += usize::from(near.joints.len() == 1);
                // Of a slider, the part of the angle in its plane does not matter; of an axis through a
                // centre, its distance counts.
                let off = near.joints[0].relative(length);
                assert!(off < 2.0 * 1_f64.to_radians(), "{near}");
                let snapped = snap(&bent, 2.0 * 1_f64.to_radians() * length).unwrap();
                assert_exact(&snapped.mechanism, &mechanism);
            }
        }
    }
    assert!(named > 50 && 10 * alone >= 9 * named, "{alone} of {named}");
}

#[test]
fn a_point_that_is_half_a_millimetre_off_is_named() {
    for name in ["plano-spherical-5dof-joints", "double-spherical-5dof"] {
        let mechanism = example(name);
        for (leg, joint) in [(0, 3), (1, 4), (3, 2)] {
            let mut bent = somewhere(&mechanism, 3);
            let id = [&bent.legs[leg].name, &bent.legs[leg].joints[joint].name].map(String::clone);
            let odd = &mut bent.legs[leg].joints[joint];
            let across = odd.axis.cross(&Vector3::new(0.3, 0.5, -0.8)).normalize();
            odd.point += across * 0.5e-3;
            let near = nearly(&bent).unwrap().expect("nearly a mechanism");
            assert_eq!(worst_joint(&near), [&*id[0], &*id[1]], "{near}");
            assert_eq!(near.joints.len(), 1, "{near}");
            assert!((near.joints[0].distance - 0.5e-3).abs() < 1e-8, "{near}");
            assert!(
                near.to_string().contains("the others at 0.50 mm")
                    || near.to_string().contains("0.50 mm from"),
                "{near}"
            );
            let snapped = snap(&bent, 0.6e-3).unwrap();
            assert_exact(&snapped.mechanism, &mechanism);
            // A smaller tolerance does not accept it.
            assert_eq!(snap(&bent, 0.4e-3).unwrap().mechanism, bent);
        }
    }
}

/// Axes of a spherical mechanism that miss the centre: they have no length of their own to be small against, but the
/// places of the joints have.
#[test]
fn axes_that_nearly_meet_in_one_point_are_named() {
    for name in ["agile-eye", "orbita"] {
        let mut exact = example(name);
        for (number, joint) in exact.legs.iter_mut().flat_map(|leg| &mut leg.joints).enumerate() {
            joint.point += joint.axis.into_inner() * (0.04 + 0.005 * number as f64);
        }
        assert_eq!(nearly(&exact), Ok(None));
        for off in [3e-5, 1e-4, 3e-4] {
            let mut bent = somewhere(&exact, 3);
            for (leg, joint, share) in [(0, 1, 1.0), (2, 0, 0.5)] {
                let odd = &mut bent.legs[leg].joints[joint];
                let across = odd.axis.cross(&Vector3::new(0.3, 0.5, -0.8)).normalize();
                odd.point += across * off * share;
            }
            let id = [&bent.legs[0].name, &bent.legs[0].joints[1].name].map(String::clone);
            let Some(near) = nearly(&bent).unwrap() else { panic!("{name} off by {off}") };
            assert_eq!(worst_joint(&near), [&*id[0], &*id[1]], "{near}");
            assert_eq!((near.lower.name(), near.upper.name()), ("spherical", "identity"));
            assert!(near.joints.len() == 2 && (near.tolerance - off).abs() < 1e-2 * off, "{near}");
            let snapped = snap(&bent, 1.01 * near.tolerance).unwrap();
            assert_exact(&snapped.mechanism, &exact);
        }
    }
}

/// The directions that a file names for its task coordinates follow the joints.
#[test]
fn hints_are_snapped_too() {
    let mut mechanism = example("plano-spherical-5dof-joints");
    mechanism.task.axis = Some(Vector3::z());
    mechanism.task.lower.x = Some(Vector3::y());
    let g = Numbers::new(2).displacement(0.1);
    let mut placed = displaced(&mechanism, &g);
    placed.task.axis = Some(g.rotation * Vector3::z());
    placed.task.lower.x = Some((g.rotation * Vector3::y()).map(|c| digits(c, 2)));
    let snapped = snap(&rounded(&placed, 2), 0.02).unwrap();
    let manipulator = Manipulator::new(snapped.mechanism).unwrap();
    let x = manipulator.task().lower.axes.column(0).into_owned();
    assert!((x - g.rotation * Vector3::y()).norm() < 0.02);
}

#[test]
fn a_mechanism_outside_the_class_is_not_snapped() {
    for seed in 0..20 {
        let mechanism = gough(&mut Numbers::new(seed));
        let Frame { length, .. } = frame(&mechanism);
        assert_eq!(nearly(&mechanism), Ok(None));
        assert_eq!(snap(&mechanism, 1e-3).unwrap().mechanism, mechanism);
        assert_eq!(snap(&mechanism, 0.03 * length).unwrap().mechanism, mechanism);
    }
    // An axis that misses the centre by 10 mm is a design of its own.
    let mut offset = example("plano-spherical-5dof-joints");
    let joint = &mut offset.legs[0].joints[4];
    joint.point += joint.axis.cross(&Vector3::z()).normalize() * 10e-3;
    assert_eq!(snap(&offset, 1e-3).unwrap().mechanism, offset);
}

#[test]
fn incomplete_mechanisms_are_refused() {
    let mut mechanism = example("plano-spherical-5dof-joints");
    mechanism.legs[0].joints[0].point.x = f64::NAN;
    mechanism.legs[0].joints[1].point.x = f64::NAN;
    assert!(nearly(&mechanism).is_err());
    assert!(snap(&mechanism, 1e-3).is_err());
}

/// A mechanism that decomposes although a joint is off: the joint is named, with its true distance or angle.
#[test]
fn a_joint_that_is_slightly_off_is_named() {
    for exact in shipped() {
        assert_eq!(slightly_off(&exact), None, "{}", exact.name);
    }
    let exact = example("plano-spherical-5dof-joints");
    let slipped = |change: &dyn Fn(&mut Joint), leg: usize, joint: usize| {
        let mut off = exact.clone();
        change(&mut off.legs[leg].joints[joint]);
        slightly_off(&off).expect("a joint that is off")
    };
    // The axis of theta32 is (-0.433, 0.75, 0.5): a shift along x leaves 0.01 mm times the sine of the angle with it.
    let near = slipped(&|joint| joint.point.x += 1e-5, 1, 4);
    let sine = (1.0 - 0.433_012_701_892_22_f64.powi(2)).sqrt();
    assert!((near.joints[0].distance - 1e-5 * sine).abs() < 1e-11, "{near}");
    let told = "joint theta32 of leg leg2: its axis passes the centre of the others at 0.0090 mm";
    assert_eq!(near.to_string(), told);
    let near = slipped(&|joint| joint.point.z += 5e-6, 3, 2);
    assert_eq!(
        near.to_string(),
        "joint s4 of leg leg4: its centre is 0.0050 mm from the centre of the others"
    );
    let tilt = 0.002_f64.to_radians();
    let turned =
        |axis: Unit<Vector3<f64>>| Unit::new_normalize(axis.into_inner() + Vector3::z() * tilt);
    let near = slipped(&|joint| joint.axis = turned(joint.axis), 2, 0);
    assert_eq!(
        near.to_string(),
        "joint S3 of leg leg3: its direction is 0.0020 deg off the plane of the others"
    );
    let turned =
        |axis: Unit<Vector3<f64>>| Unit::new_normalize(axis.into_inner() + Vector3::x() * tilt);
    let near = slipped(&|joint| joint.axis = turned(joint.axis), 0, 1);
    let told =
        "joint phi11 of leg leg1: its axis is 0.0020 deg off the normal of the plane of the others";
    assert_eq!(near.to_string(), told);
}

/// Of a screw, the pitch is told where it is the pitch that differs.
#[test]
fn a_pitch_that_differs_is_told() {
    let screw = |pitch, x| {
        let point = nalgebra::Point3::new(x, 0.0, 0.0);
        Joint::new("h", JointKind::Helical { pitch }, Vector3::z_axis(), point)
    };
    let (axis, point) = (Vector3::z_axis(), nalgebra::Point3::origin());
    let planar = SubspaceClass::PlanarHelical { axis, pitch: 0.02 };
    let helical = SubspaceClass::Helical { axis, point, pitch: 0.02 };
    for (joint, group, told) in [
        (screw(0.0203, 0.5), planar, "its pitch differs from that of the others by 0.30 mm/rad"),
        (
            screw(0.020_01, 0.0),
            helical,
            "its pitch differs from that of the others by 0.010 mm/rad",
        ),
        (screw(0.02, 1e-5), helical, "its axis passes the axis of the others at 0.010 mm"),
    ] {
        let leg = crate::mechanism::leg::Leg::new("leg", vec![joint]);
        let freedoms = [crate::decomposition::Freedom { joint: 0, index: 0 }];
        let section = crate::mechanism::leg::Section::Lower;
        let misses = misses_of(&leg, &freedoms, section, group);
        assert_eq!(misses[0].1.clone().in_units(MILLIMETRES).reason(), told);
    }
}

#[test]
fn small_numbers_keep_two_digits() {
    for (value, text) in [
        (0.0, "0.00"),
        (4.3, "4.30"),
        (123.456, "123.46"),
        (0.5, "0.50"),
        (0.0978, "0.098"),
        (0.009_78, "0.0098"),
        (0.009_999, "0.010"),
        (1.234e-4, "0.00012"),
        (3.2e-7, "3.2e-7"),
    ] {
        assert_eq!(shown(value, Quantity::Length, FileUnits::SI), format!("{text} m"));
    }
}
