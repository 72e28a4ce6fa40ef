//! Joints that carry the height of a Schoenflies section and lean, compared with geometry: behind an inclined slider or
//! a screw at the base, a leg is the same leg from a base that the lift has moved.

use opm_core::Manipulator;
use opm_core::mechanism::examples;
use opm_workspace::measure::{CoordinateRange, Domain, Goal, SearchEnd, measure};
use opm_workspace::{Grid, GridError, Modes, Progress, Sections};
use std::f64::consts::PI;

/// The file of the shipped mechanism with another first joint of its first leg.
fn text_with(lift: &str) -> String {
    let text = examples::find("schoenflies-column-4dof").unwrap().text;
    let start = text.find("  { name = \"S1\"").unwrap();
    let end = start + text[start..].find('\n').unwrap();
    format!("{}{lift}{}", &text[..start], &text[end..])
}

fn with_lift(lift: &str) -> Manipulator {
    Manipulator::read(&text_with(lift)).unwrap()
}

const SCREW: &str = "  { name = \"S1\", type = \"helical\", pitch = 200, axis = [0, 0, 1], point = [100, 300, 100], \
                     actuated = true, home = 0 },";

/// Compares the first leg at random poses with that of the shipped mechanism at a pose that `moved` gives, whose lift
/// has a value that `lifted` gives for the height above home.
fn compare(lift: &str, moved: impl Fn([f64; 4]) -> [f64; 4], lifted: impl Fn(f64) -> f64) {
    let (leaning, straight) =
        (with_lift(lift), Manipulator::example("schoenflies-column-4dof").unwrap());
    assert_eq!(leaning.leaning_joints().collect::<Vec<_>>(), ["S1"]);
    let mut rng = fastrand::Rng::with_seed(15);
    let mut random = |size: f64| size * (2.0 * rng.f64() - 1.0);
    let [mut one, mut other] = [&leaning, &straight].map(Manipulator::solution);
    let mut compared = 0;
    for _ in 0..500 {
        let pose = [random(0.05), random(0.05), 0.2 + random(0.1), random(0.5)];
        for mode in leaning.modes() {
            // Other legs may be out of reach there.
            leaning.inverse(&pose, mode, &mut one).unwrap();
            straight.inverse(&moved(pose), mode, &mut other).unwrap();
            let reached = |solution: &opm_core::manipulator::Solution| {
                solution.unreachable().iter().all(|missed| missed.leg != 0)
            };
            assert_eq!(reached(&one), reached(&other), "{pose:?}");
            if !one.unreachable().is_empty() || !reached(&other) {
                continue;
            }
            compared += 1;
            let value = lifted(pose[2] - 0.2);
            assert!(
                (one.joints()[0] - value).abs() < 1e-14,
                "{pose:?}: {} {value}",
                one.joints()[0]
            );
            for i in 1..4 {
                let apart = one.joints()[i] - other.joints()[i];
                assert!(apart.abs() < 1e-11, "{pose:?} {i}: {apart:e}");
            }
        }
    }
    assert!(compared > 1_000, "{compared}");
}

#[test]
fn an_inclined_slider_moves_the_base_of_its_leg() {
    // 3 to the side for 4 up, so that 5 along the slider are 4 up.
    compare(
        "  { name = \"S1\", type = \"prismatic\", axis = [0.6, 0, 0.8], point = [0, 300, 100], actuated = true, home = 0 },",
        |[x, y, z, theta]| [x - 0.75 * (z - 0.2), y, z, theta],
        |rise| 1.25 * rise,
    );
}

#[test]
fn a_screw_turns_the_base_of_its_leg() {
    // 0.2 m for one radian, about an axis through (0.1, 0.3).
    compare(
        SCREW,
        |[x, y, z, theta]| {
            let turn = -(z - 0.2) / 0.2;
            let (sin, cos) = turn.sin_cos();
            let (u, v) = (x - 0.1, y - 0.3);
            [0.1 + cos * u - sin * v, 0.3 + sin * u + cos * v, z, theta + turn]
        },
        |rise| rise / 0.2,
    );
}

/// Where an inclined slider brings the axes of two revolute joints together, the leg has no closed form. It counts as
/// out of reach there, and nothing panics.
#[test]
fn a_link_that_vanishes_at_a_height_is_out_of_reach_there() {
    let text = "format = 1\nname = \"scissors\"\nunits = { length = \"m\", angle = \"rad\" }\n\
        [platform]\npoint = [0, 0, 0]\n[[leg]]\nname = \"one\"\njoints = [\n\
        { name = \"a\", type = \"revolute\", axis = [0, 0, 1], point = [0, 0, 0], actuated = true },\n\
        { name = \"s\", type = \"prismatic\", axis = [0.6, 0, 0.8], actuated = true },\n\
        { name = \"b\", type = \"revolute\", axis = [0, 0, 1], point = [-0.3, 0, 0], actuated = true },\n\
        { name = \"c\", type = \"revolute\", axis = [0, 0, 1], point = [0.5, 0.6, 0], actuated = true },\n]\n\
        [[leg]]\nname = \"two\"\njoints = [\n\
        { name = \"t\", type = \"prismatic\", axis = [0, 0, 1] },\n\
        { name = \"d\", type = \"revolute\", axis = [0, 0, 1], point = [0, 1, 0] },\n\
        { name = \"e\", type = \"revolute\", axis = [0, 0, 1], point = [1, 1, 0] },\n\
        { name = \"f\", type = \"revolute\", axis = [0, 0, 1], point = [0.5, 0.6, 0] },\n]\n";
    let m = Manipulator::read(text).unwrap();
    let names: Vec<_> = m.task_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["x", "y", "z", "theta"]);
    let mut solution = m.solution();
    // 0.4 up are 0.3 to the side: then the axes of a and b are one.
    for (rise, expected) in [(0.0, true), (0.4, false), (0.8, true)] {
        let pose = [0.1, 0.0, rise, 0.2];
        let reached = m.inverse(&pose, m.home_mode(), &mut solution).unwrap().is_some();
        assert_eq!(reached, expected, "{rise}: {:?}", solution.unreachable());
        if !expected {
            assert_eq!(solution.unreachable()[0].leg, 0);
            assert_eq!(solution.unreachable()[0].deficit.excess, f64::INFINITY);
        }
    }
}

/// A leg that reaches every pose.
const ANYWHERE: &str = "[[leg]]\nname = \"two\"\njoints = [\n\
    { name = \"X2\", type = \"prismatic\", axis = [1, 0, 0] },\n\
    { name = \"Y2\", type = \"prismatic\", axis = [0, 1, 0] },\n\
    { name = \"Z2\", type = \"prismatic\", axis = [0, 0, 1] },\n\
    { name = \"R2\", type = \"revolute\", axis = [0, 0, 1], point = [0, 0, 0] },\n]\n";

/// The place of a point of the plane at a height.
type Move<'a> = &'a dyn Fn([f64; 2], f64) -> [f64; 2];

/// A leg of three revolute joints reaches rings, which have the area `4π a b`, with `a` and `b` its links' lengths.
/// A lift between the joints makes one of them longer or shorter.
#[test]
fn rings_at_all_heights_have_a_known_volume() {
    let pivots = [[0.0, 0.0], [0.5, 0.1], [0.8, -0.2]];
    let slider = "{ name = \"S\", type = \"prismatic\", axis = [0.6, 0, 0.8], point = [0, 0, 0], actuated = true }";
    let screw = "{ name = \"S\", type = \"helical\", pitch = 0.3, axis = [0, 0, 1], point = [0.2, 0.3, 0], \
                 actuated = true }";
    // What a lift does in the plane at a height.
    let slid = |[x, y]: [f64; 2], z: f64| [x + 0.75 * z, y];
    let turned = |[x, y]: [f64; 2], z: f64| {
        let ((sin, cos), u, v) = ((z / 0.3).sin_cos(), x - 0.2, y - 0.3);
        [0.2 + cos * u - sin * v, 0.3 + sin * u + cos * v]
    };
    let moves: [Move<'_>; 2] = [&slid, &turned];
    for (lift, moved) in [slider, screw].into_iter().zip(moves) {
        for before in 0..=3 {
            let mut joints: Vec<String> = (pivots.iter().zip(["a", "b", "c"]))
                .map(|([x, y], name)| {
                    format!(
                        "{{ name = \"{name}\", type = \"revolute\", axis = [0, 0, 1], point = [{x}, {y}, 0], \
                         actuated = true }}"
                    )
                })
                .collect();
            joints.insert(before, lift.into());
            let m = Manipulator::read(&format!(
                "format = 1\nname = \"alone\"\nunits = {{ length = \"m\", angle = \"rad\" }}\n[platform]\n\
                 point = [0.8, -0.2, 0]\n[[leg]]\nname = \"one\"\njoints = [\n{}\n]\n{ANYWHERE}",
                joints.join(",\n")
            ))
            .unwrap();
            // The place of the last pivot depends on the orientation of the platform alone.
            let theta = 0.4;
            let ring = |z: f64| {
                let places: Vec<[f64; 2]> = (0..3)
                    .map(|i| if i >= before { moved(pivots[i], z) } else { pivots[i] })
                    .collect();
                let link = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
                4.0 * PI * link(places[0], places[1]) * link(places[1], places[2])
            };
            // Simpson's rule, to far less than the tolerance.
            let (from, to, pieces) = (-0.1, 0.2, 200);
            let step = (to - from) / f64::from(pieces);
            let volume = (0..=pieces)
                .map(|i| {
                    let weight =
                        if i == 0 || i == pieces { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
                    weight * step / 3.0 * ring(from + step * f64::from(i))
                })
                .sum::<f64>();
            let ranges =
                [("x", -2.0, 2.0), ("y", -2.0, 2.0), ("z", from, to), ("theta", theta, theta)];
            let ranges = ranges.map(|(name, min, max)| CoordinateRange::new(name, min, max));
            let domain = Domain::new(&m, Sections::Whole, &ranges).unwrap();
            let goal = Goal { tolerance: 0.002, ..Goal::default() };
            let found = measure(&m, &domain, Modes::Any, &goal, &Progress::default());
            assert_eq!(found.stop, SearchEnd::Tolerance, "{before}");
            assert!(found.lower <= volume && volume <= found.upper, "{before}: {volume} {found:?}");
            println!("{before} {} boxes", found.boxes);
        }
    }
}

/// A screw in a leg that lacks a joint is refused by name; a slider along the direction is not.
#[test]
fn a_screw_in_a_leg_with_too_few_joints_is_named() {
    let without_elbow = |text: &str| {
        let lines = text.lines().filter(|line| !line.contains("\"b1\""));
        lines.collect::<Vec<_>>().join("\n")
    };
    let told = Manipulator::read(&without_elbow(&text_with(SCREW))).unwrap_err().to_string();
    assert!(
        told.contains("leg1") && told.contains("joint S1 changes it, which is no slider"),
        "{told}"
    );
    let shipped = examples::find("schoenflies-column-4dof").unwrap().text;
    let m = Manipulator::read(&without_elbow(shipped)).unwrap();
    assert_eq!(m.dependent_coordinates().len(), 1);
    assert_eq!(Grid::of(Sections::Lower, &m, vec![]).unwrap_err(), GridError::NotAlone);
}
