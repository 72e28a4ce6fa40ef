//! Limits of differences of joints, against inverse kinematics of the mechanism without them, mode by mode.

use opm_core::mechanism::Difference;
use opm_core::motion::{Ends, Path, PlatformMotion, Spline};
use opm_core::trajectory::{Change, Gauge, Trajectory, ViolationReport};
use opm_core::{Manipulator, Mode, Quantity, Solution};
use opm_workspace::measure::{Domain, DomainError};
use opm_workspace::{Axis, Cause, Grid, GridError, Modes, Progress, Rejections, Sections, Sweep};
use std::f64::consts::TAU;

/// A shipped mechanism whose first actuated joints of two legs are limited to a room about their difference at home, which is
/// shifted; and the same without.
fn limited(name: &str, [one, other]: [usize; 2], room: [f64; 2]) -> [Manipulator; 2] {
    let free = Manipulator::example(name).unwrap();
    let mut mechanism = free.mechanism().clone();
    let actuated = free.actuated().iter().map(|&number| &free.coordinates()[number]);
    let actuated: Vec<_> = actuated.collect();
    let home = actuated[one].home - actuated[other].home;
    let joints = [one, other].map(|i| actuated[i].name.clone());
    let limits = room.map(|end| home + end);
    mechanism.differences.push(Difference { joints, limits });
    [free, Manipulator::new(mechanism).unwrap()]
}

/// Whether a solution without the limit is within it, by the values of the joints.
fn expected(m: &Manipulator, at: &Solution) -> bool {
    let difference = &m.mechanism().differences[0];
    let number = |name: &String| m.coordinates().iter().position(|c| c.name == *name).unwrap();
    let [one, other] = difference.joints.each_ref().map(number);
    let turns = match m.coordinates()[one].quantity {
        Quantity::Angle => vec![-2.0 * TAU, -TAU, 0.0, TAU, 2.0 * TAU],
        Quantity::Length => vec![0.0],
    };
    let apart = at.joints()[one] - at.joints()[other];
    let [low, high] = difference.limits;
    at.within_limits() && turns.iter().any(|turn| (low..=high).contains(&(apart + turn)))
}

/// A grid about home, at odd shares, so that no pose is exactly on a limit.
fn grid(m: &Manipulator, half: f64) -> Grid {
    let axes = m.task_coordinates().iter().enumerate().map(|(i, c)| {
        let few = m.task_coordinates().len() > 3;
        let (half, count) = match c.quantity {
            Quantity::Length if i < 2 => (half * 1.0137, if few { 5 } else { 13 }),
            Quantity::Length => (half * 1.0137, 3),
            Quantity::Angle => (0.4319, if few { 3 } else { 5 }),
        };
        Axis::new(c.name, c.home - half, c.home + half, count)
    });
    Grid::new(m, axes.collect()).unwrap()
}

#[test]
fn counts_are_those_of_single_poses() {
    for (name, joints, room, half) in [
        ("five-bar", [0, 1], [-0.4, 0.3], 0.15),
        ("planar-3rrr", [2, 0], [-0.5, 0.2], 0.08),
        ("plano-spherical-5dof", [0, 1], [-0.05, 0.08], 0.15),
        ("agile-eye", [0, 2], [-0.2, 0.3], 0.0),
        ("stewart", [0, 3], [-0.02, 0.03], 0.1),
        ("delta", [1, 0], [-0.3, 0.2], 0.15),
        ("tricept", [0, 1], [-0.05, 0.1], 0.3),
    ] {
        let [free, m] = limited(name, joints, room);
        let grid = grid(&m, half);
        let (mut at, mut solution, mut all) = (free.solution(), m.solution(), m.all_modes());
        let mut motors = m.actuated_joints();
        let (mut of_home, mut of_any, mut without) = (0, 0, 0);
        for number in 0..grid.poses() {
            let pose = grid.pose(number);
            let mut reach = |mode: Mode| {
                let found = free.inverse(&pose, mode, &mut at).unwrap();
                (
                    found.is_some_and(|at| expected(&m, at)),
                    found.is_some_and(Solution::within_limits),
                )
            };
            let (in_home, loose) = reach(m.home_mode());
            without += u64::from(loose);
            let modes: Vec<Mode> = m.modes().filter(|&mode| reach(mode).0).collect();
            of_home += u64::from(in_home);
            of_any += u64::from(!modes.is_empty());

            let found = m.inverse(&pose, m.home_mode(), &mut solution).unwrap();
            assert_eq!(found.is_some_and(Solution::within_limits), in_home, "{name} {pose:?}");
            if let Some(found) = found {
                assert_eq!(m.beyond_limits(found).count() == 0, in_home, "{name} {pose:?}");
                let joints = found.joints().to_vec();
                let few = m.inverse_actuated(&pose, m.home_mode(), &mut motors).unwrap().unwrap();
                assert_eq!(few.within_limits(), in_home, "{name} {pose:?}");
                for (value, &number) in few.actuated().iter().zip(m.actuated()) {
                    assert_eq!(*value, joints[number], "{name}");
                }
            }
            let found = m.inverse_all(&pose, &mut all).unwrap();
            let first = found.and_then(|all| m.solution_within_limits(all, &mut solution));
            assert_eq!(first.map(|(mode, _)| mode), modes.first().copied(), "{name} {pose:?}");
        }
        assert!(0 < of_home && of_home < without, "{name}: {of_home} of {without}");
        for (modes, expected) in [(Modes::One(m.home_mode()), of_home), (Modes::Any, of_any)] {
            let progress = Progress::default();
            let found = Sweep::new(&m, &grid, modes).count(&progress).unwrap();
            assert_eq!(found.reachable, expected, "{name} {modes:?}");
            let told = Rejections::new(&m, &grid, modes, &progress).unwrap();
            assert_eq!(told.reachable, expected, "{name} {modes:?}");
            if let Modes::One(_) = modes {
                let cause = told.rejections.iter().find(|r| r.cause == Cause::Difference(0));
                let alone = cause.map_or(0, |cause| cause.alone);
                assert_eq!(alone, without - of_home, "{name}");
            }
        }
        let told = Domain::new(&m, Sections::Whole, &[]).unwrap_err();
        assert!(
            matches!(&told, DomainError::Differences { name } if name.contains(" - ")),
            "{told}"
        );
    }
}

#[test]
fn what_sections_do_not_know_is_refused() {
    let [_, m] = limited("plano-spherical-5dof", [0, 1], [-0.05, 0.08]);
    assert_eq!(Grid::of(Sections::Upper, &m, vec![]), Err(GridError::NotAlone));
    assert!(!m.has_enclosures());
}

/// Along x, a Delta's first two arms part: the motion leaves the limit where the poses do.
#[test]
fn a_motion_tells_when_a_difference_leaves_its_limits() {
    let [free, m] = limited("delta", [1, 0], [-0.3, 0.2]);
    let home = m.home_pose();
    let columns =
        home.iter().enumerate().map(|(i, c)| vec![*c, c + if i < 2 { 0.15 } else { 0.0 }]);
    let path = Path::Spline(Spline::new(vec![0.0, 1.0], columns.collect(), Ends::Natural).unwrap());
    let name = "aside".to_owned();
    let motion = PlatformMotion { name, start: 0.0, duration: 1.0, rate: None, mode: None, path };
    let mut trajectory = Trajectory::new(&m, &motion, m.home_mode(), 10.0).unwrap();
    let mut begun = Vec::new();
    while trajectory.advance().unwrap() {
        let begins = trajectory.changes().iter().filter_map(|change| match change {
            Change::Begins(violation) => Some(*violation),
            Change::Ends(_) => None,
        });
        begun
            .extend(begins.filter(|violation| matches!(violation.gauge, Gauge::Difference { .. })));
    }
    // By bisection of poses without the limit.
    let mut at = free.solution();
    let mut inside = |t: f64| {
        let pose: Vec<f64> =
            home.iter().enumerate().map(|(i, c)| c + if i < 2 { 0.15 * t } else { 0.0 }).collect();
        expected(&m, free.inverse(&pose, m.home_mode(), &mut at).unwrap().unwrap())
    };
    let [mut low, mut high] = [0.0, 1.0];
    assert!(inside(low) && !inside(high));
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if inside(middle) { low = middle } else { high = middle }
    }
    assert_eq!(begun.len(), 1);
    assert!((begun[0].start - low).abs() < 1e-6, "{} {low}", begun[0].start);
    let report = ViolationReport::new(&begun[0], &m);
    let [one, other] = &m.mechanism().differences[0].joints;
    assert!(
        report.what().contains(&format!("{one} - {other} beyond its limits")),
        "{}",
        report.what()
    );
}

/// Coaxial motors without limits of their own turn as often as they like: only how far they are apart counts.
#[test]
fn full_turns_of_free_motors_do_not_count() {
    let [_, m] = limited("agile-eye", [0, 2], [-0.2, 0.3]);
    let difference = &m.differences()[0];
    let mut joints = m.solution().joints().to_vec();
    assert!(difference.turns && difference.allows(&joints));
    joints[difference.coordinates[0]] += TAU;
    assert!(difference.allows(&joints));
    joints[difference.coordinates[1]] += 0.25;
    assert!(!difference.allows(&joints));
    assert!((difference.room(&joints) + 0.05).abs() < 1e-9);
}
