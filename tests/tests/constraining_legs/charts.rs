//! What forward kinematics give as a pose is where the assembly's own joints put every leg: all coordinates, dependent ones
//! too, are of one chart of the angles.

use super::{actuated, solutions};
use fastrand::Rng;
use nalgebra::Isometry3;
use opm_core::Mode;
use opm_core::forward::Assembly;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file;
use opm_tests::random::{LACKS, PAIRS};
use opm_tests::structured::gap;

/// Products of a few exponentials of joints that are up to ten.
const CLOSED: f64 = 1e-9;

/// Two places of the platform are the same: near a fold, dependent coordinates have half of the digits.
const SAME: f64 = 1e-6;

const MECHANISMS: [&str; 7] = [
    include_str!("../../../data/reference/forward/spherical-5R-symmetric-orthogonal.toml"),
    include_str!("../../../data/reference/forward/spherical-fivebar-5R.toml"),
    include_str!("../../../data/reference/forward/2UPR-2RPU.toml"),
    include_str!("../../../data/reference/forward/2UPR-RPU.toml"),
    include_str!("../../../data/reference/forward/sph4-1.toml"),
    include_str!("../../../data/reference/forward/sph4-x.toml"),
    include_str!("../../../data/reference/forward/sph4-y.toml"),
];

/// The displacement of the coordinates as they are given, put together by name.
fn stated(m: &Manipulator, assembly: &Assembly) -> Isometry3<f64> {
    let own = m.task_coordinates().iter().zip(&assembly.pose);
    let others = m.dependent_coordinates().iter().zip(&assembly.dependent);
    let given: Vec<_> = own.chain(others).map(|(c, value)| (c.name, *value)).collect();
    let named = |name: &str| given.iter().find(|(own, _)| *own == name).unwrap().1;
    let all: Vec<f64> = m.task().coordinates.iter().map(|c| named(c.name)).collect();
    m.task().displacement(&all)
}

fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).amax()
}

/// Checks an assembly, in its mode and in each other one that has it; the number of these.
fn check(m: &Manipulator, assembly: &Assembly) -> usize {
    let what = || format!("{}: {assembly:?}", m.mechanism().name);
    let there = stated(m, assembly);
    let off = gap(m, &assembly.joints, &there);
    assert!(off < CLOSED, "off by {off:e}, {}", what());
    assert!(apart(&m.displacement_of(assembly), &there) < 1e-12, "{}", what());
    let mut solution = m.solution();
    let mut names = 0;
    for mode in m.modes() {
        let Some(named) = m.assembly_in(assembly, mode) else { continue };
        names += 1;
        assert!(apart(&stated(m, &named), &there) < 1e-9, "{named:?} for {}", what());
        let follows =
            m.inverse(&named.pose, mode, &mut solution).unwrap().map(|s| s.displacement(m));
        let follows = follows.unwrap_or_else(|| panic!("{named:?} is out of reach, {}", what()));
        assert!(apart(&follows, &there) < SAME, "{named:?} for {}", what());
    }
    names
}

/// Every assembly for the joints of a pose, by every method and from several starts. Returns how many were checked, and how
/// many modes name one of them.
fn assemblies(m: &Manipulator, (pose, mode): (&[f64], Mode), joints: &[f64]) -> [usize; 2] {
    let home = m.home_pose();
    let between: Vec<f64> =
        pose.iter().zip(&home).map(|(q, home)| 0.98 * q + 0.02 * home).collect();
    let starts = [pose, &between, &home];
    let near = starts.into_iter().filter_map(|start| m.forward_near(joints, start, mode).ok());
    let mut list: Vec<Assembly> = near.collect();
    assert!(list.iter().all(|assembly| assembly.mode == mode));
    if m.forward_closed_form().is_ok() {
        list.extend(m.forward(joints).unwrap().list);
    }
    let names = list.iter().map(|assembly| check(m, assembly)).sum();
    [list.len(), names]
}

#[test]
fn poses_are_where_the_joints_put_the_legs() {
    let mut rng = Rng::with_seed(150);
    let (mut checked, mut modes) = (0, 0);
    for pair in PAIRS {
        for lacks in LACKS {
            for round in 0..6 {
                let Some(m) = actuated(&mut rng, pair, lacks, round) else { continue };
                for (pose, mode, at) in solutions(&mut rng, &m).into_iter().take(6) {
                    let joints: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
                    let [list, names] = assemblies(&m, (&pose, mode), &joints);
                    (checked, modes) = (checked + list, modes + names);
                }
            }
        }
    }
    println!("{checked} assemblies, with {modes} names");
    assert!(checked > 3_000 && modes >= checked, "{checked} {modes}");
}

#[test]
fn published_mechanisms_are_where_their_joints_put_them() {
    let mut rng = Rng::with_seed(151);
    for text in MECHANISMS {
        let m = Manipulator::new(file::read(text).unwrap().mechanism).unwrap();
        let (mut checked, mut back) = (0, 0);
        let closed = m.forward_closed_form().is_ok();
        for round in 0..100 {
            for (pose, mode, at) in solutions(&mut rng, &m) {
                let joints: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
                checked += assemblies(&m, (&pose, mode), &joints)[0];
                // The pose itself is found in its own mode, whichever triple of angles it was given with.
                let here = at.displacement(&m);
                // A continuation takes some milliseconds.
                if !closed && round > 2 {
                    continue;
                }
                let Ok(found) = m.forward(&joints) else { continue };
                for assembly in &found.list {
                    check(&m, assembly);
                }
                let found = found.list.iter().filter_map(|a| m.assembly_in(a, mode));
                let found: Vec<_> = found.collect();
                let is_here = |a: &Assembly| apart(&stated(&m, a), &here) < SAME;
                assert!(found.iter().any(is_here), "{} {pose:?}", m.mechanism().name);
                back += 1;
            }
        }
        println!("{}: {checked} assemblies, {back} poses", m.mechanism().name);
        assert!(checked > 200 && (back > 80 || !closed), "{} {back}", m.mechanism().name);
    }
}

/// A pose that was computed by hand: forward kinematics near it, from joints of inverse kinematics there, give the coordinate
/// that inverse kinematics give, 11.23 degrees, or all coordinates of the other triple.
#[test]
fn the_start_may_be_in_the_other_chart() {
    let m = Manipulator::new(file::read(MECHANISMS[0]).unwrap().mechanism).unwrap();
    let mode = m.parse_mode("+ +").unwrap();
    let joints = [3.094_312_841_837_383_8, -2.907_540_733_630_259];
    let start = [-0.238_387_865_750_683_6, -0.201_508_856_585_876_7];
    let found = m.forward_near(&joints, &start, mode).unwrap();
    check(&m, &found);
    let degrees = found.dependent[0].to_degrees();
    let expected = if found.pose[0] > 0.0 { 11.2275 } else { 11.2275 - 180.0 };
    assert!((degrees - expected).abs() < 1e-3, "{found:?}");
}
