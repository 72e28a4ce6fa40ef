//! Distances of links against geometry that this file computes by itself.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Vector3};
use opm_core::mechanism::file;
use opm_core::{Manipulator, mechanism::ObstacleShape};
use opm_interference::{Distances, Interference};

/// What the iteration of a distance from a box, and near parallels, may be off, as a share of the mechanism's size.
const CLOSE: f64 = 1e-6;

/// Three arms in a plane each, one above the other, and obstacles of every kind.
const ARMS: &str = r#"
format = 1
name = "arms"
units = { length = "mm", angle = "deg" }

[platform]
point = [0, 0, 0]

[bodies]
radius = 4
radii = { q2 = 6, platform = 3 }

[[obstacle]]
name = "table"
type = "half-space"
point = [0, 0, -40]
normal = [0.1, 0, 1]

[[obstacle]]
name = "post"
type = "capsule"
from = [110, 90, -100]
to = [110, 110, 90]
radius = 7

[[obstacle]]
name = "housing"
type = "box"
centre = [-160, 40, 30]
size = [60, 40, 50]
x = [1, 1, 0]
y = [0, 1, 0.2]

[[leg]]
name = "a"
joints = [
  { name = "p1", type = "revolute", axis = [0, 0, 1], point = [-200, -120, 0], actuated = true },
  { name = "q1", type = "revolute", axis = [0, 0, 1], point = [-90, -160, 10] },
  { name = "r1", type = "revolute", axis = [0, 0, 1], point = [-40, -25, 5] },
]

[[leg]]
name = "b"
joints = [
  { name = "p2", type = "revolute", axis = [0, 0, 1], point = [200, -120, 20], actuated = true },
  { name = "q2", type = "revolute", axis = [0, 0, 1], point = [190, 10, 30] },
  { name = "r2", type = "revolute", axis = [0, 0, 1], point = [40, -25, 25] },
]

[[leg]]
name = "c"
joints = [
  { name = "p3", type = "revolute", axis = [0, 0, 1], point = [0, 230, 40], actuated = true },
  { name = "q3", type = "revolute", axis = [0, 0, 1], point = [-130, 160, 50] },
  { name = "r3", type = "revolute", axis = [0, 0, 1], point = [0, 45, 45] },
]
"#;

type Segment = [Point3<f64>; 2];

fn point_to_segment(p: &Point3<f64>, [a, b]: &Segment) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (p - (a + along * t)).norm()
}

/// The least of the distances of the ends from the other segment, and of the lines where those are nearest inside.
fn segments_apart(one: &Segment, other: &Segment) -> f64 {
    let ends = one.iter().map(|p| point_to_segment(p, other));
    let least = ends.chain(other.iter().map(|p| point_to_segment(p, one))).fold(f64::MAX, f64::min);
    let (u, v, w) = (one[1] - one[0], other[1] - other[0], one[0] - other[0]);
    let (a, b, c, d, e) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let determinant = a * c - b * b;
    let (s, t) = ((b * e - c * d) / determinant, (a * e - b * d) / determinant);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        return least.min(((one[0] + u * s) - (other[0] + v * t)).norm());
    }
    least
}

/// The distance of a segment from a convex set, by the golden section: along a line it falls and then rises.
fn golden(segment: &Segment, distance: impl Fn(&Point3<f64>) -> f64) -> f64 {
    let at = |t: f64| distance(&(segment[0] + (segment[1] - segment[0]) * t));
    let (mut from, mut to) = (0.0, 1.0);
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..90 {
        let [c, d] = [to - ratio * (to - from), from + ratio * (to - from)];
        if at(c) < at(d) { to = d } else { from = c }
    }
    at(0.0).min(at(1.0)).min(at(0.5 * (from + to)))
}

fn box_apart(segment: &Segment, shape: &ObstacleShape) -> f64 {
    let ObstacleShape::Box { centre, size, edges: [x, y] } = shape else { panic!("a box") };
    let x = x.into_inner();
    let y = (y.into_inner() - x * x.dot(y)).normalize();
    golden(segment, |p| {
        let arm = p - centre;
        let local = Vector3::new(arm.dot(&x), arm.dot(&y), arm.dot(&x.cross(&y)));
        local.zip_map(size, |l, s| (l.abs() - 0.5 * s).max(0.0)).norm()
    })
}

/// A point of a link, rotated by angles about vertical axes.
fn rotated(p: Point3<f64>, about: Point3<f64>, angle: f64) -> Point3<f64> {
    let arm = p - about;
    let (s, c) = angle.sin_cos();
    about + Vector3::new(c * arm.x - s * arm.y, s * arm.x + c * arm.y, arm.z)
}

#[test]
fn distances_are_those_of_the_links() {
    let mechanism = file::read(ARMS).unwrap().mechanism;
    let manipulator = Manipulator::new(mechanism.clone()).unwrap();
    let interference = Interference::new(&mechanism);
    assert_eq!(interference.set_aside_pairs(), []);
    // Six links, the platform and three obstacles: of 21 pairs of bodies each leg has two neighbours, those of its elbow and
    // of its platform joint; 7 bodies against 3 obstacles.
    assert_eq!(interference.pairs(), 21 - 6 + 21);
    let mut distances = Distances::new(&interference);
    let mut solution = manipulator.solution();
    let mut rng = Rng::with_seed(7);
    let (mut reached, mut overlaps) = (0, 0);
    for _ in 0..400 {
        let pose = [0.0; 3].map(|_| 0.12 * (2.0 * rng.f64() - 1.0));
        let mode = manipulator.modes().nth(rng.usize(0..8)).unwrap();
        let Some(solution) = manipulator.inverse(&pose, mode, &mut solution).unwrap() else {
            continue;
        };
        reached += 1;
        distances.place(&manipulator, solution);
        // Every link by its joint angles, the platform by the pose.
        let platform =
            Isometry3::new(Vector3::new(pose[0], pose[1], 0.0), Vector3::new(0.0, 0.0, pose[2]));
        let mut rods: Vec<(String, Vec<Segment>, f64)> = Vec::new();
        let mut of_platform = Vec::new();
        for (leg, angles) in mechanism.legs.iter().zip(solution.joints().chunks(3)) {
            let [p, q, r] = [0, 1, 2].map(|i| leg.joints[i].point);
            let elbow = rotated(q, p, angles[0]);
            let hand = rotated(rotated(r, q, angles[1]), p, angles[0]);
            assert!((hand - platform * r).norm() < 1e-12);
            let name = |joint: usize| format!("{}/{}", leg.name, leg.joints[joint].name);
            rods.push((name(0), vec![[p, elbow]], 0.004));
            let radius = if leg.name == "b" { 0.006 } else { 0.004 };
            rods.push((name(1), vec![[elbow, hand]], radius));
            of_platform.push([hand, platform * mechanism.platform]);
        }
        rods.push(("platform".to_owned(), of_platform, 0.003));
        let mut nearest = f64::MAX;
        for pair in 0..interference.pairs() {
            let [one, other] = interference.names_of(pair);
            let find = |name: &str| rods.iter().find(|rod| rod.0 == name);
            let (_, segments, radius) = find(one).expect("links come first");
            let obstacle = |segment: &Segment| {
                let obstacles = &mechanism.shapes.obstacles;
                let shape = &obstacles.iter().find(|o| o.name == other).unwrap().shape;
                match shape {
                    ObstacleShape::Capsule { ends, radius } => {
                        segments_apart(segment, ends) - radius
                    }
                    ObstacleShape::Box { .. } => box_apart(segment, shape),
                    ObstacleShape::HalfSpace { point, normal } => {
                        segment.iter().map(|p| normal.dot(&(p - point))).fold(f64::MAX, f64::min)
                    }
                }
            };
            let expected = segments.iter().map(|segment| match find(other) {
                Some((_, others, r)) => {
                    let all = others.iter().map(|other| segments_apart(segment, other));
                    all.fold(f64::MAX, f64::min) - r
                }
                None => obstacle(segment),
            });
            let expected = expected.fold(f64::MAX, f64::min) - radius;
            let found = distances.of(pair);
            assert!((found - expected).abs() < CLOSE, "{one} {other}: {found}, not {expected}");
            overlaps += usize::from(expected < 0.0);
            nearest = nearest.min(found);
        }
        let found = distances.nearest().unwrap();
        assert_eq!(found.distance, nearest);
        assert_eq!(distances.of(found.pair), nearest);
        let near: Vec<_> = distances.nearer_than(nearest + 1e-12).map(|n| n.pair).collect();
        assert!(near.contains(&found.pair));
    }
    assert!(reached > 200 && overlaps > 20, "{reached} poses, {overlaps} overlaps");
}
