//! The nearest pose in reach, against boundaries in closed form and against a dense random search.

use fastrand::Rng;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::{Manipulator, Mode, Quantity, Solution};

/// Where the boundary is a circle, the search ends on it to rounding; at corners of circles, too.
const CLOSED: f64 = 1e-9;

fn reaches(m: &Manipulator, pose: &[f64], mode: Option<Mode>, solution: &mut Solution) -> bool {
    match mode {
        Some(mode) => m.inverse(pose, mode, solution).unwrap().is_some_and(Solution::within_limits),
        None => {
            let mut all = m.all_modes();
            let found = m.inverse_all(pose, &mut all).unwrap();
            found.is_some_and(|all| m.solution_within_limits(all, solution).is_some())
        }
    }
}

/// Discs of radius 445 mm about both shoulders of the five-bar, without those of radius 169 mm: the nearest point of a
/// ring, or a corner of both.
#[test]
fn the_rings_of_a_five_bar() {
    let m = Manipulator::example("five-bar").unwrap();
    let shoulders: [[f64; 2]; 2] = [[-0.16, 0.0], [0.16, 0.0]];
    let (least, most) = (0.307 - 0.138, 0.307 + 0.138);
    let apart = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    let rng = &mut Rng::with_seed(7);
    let (mut corners, mut rings) = (0, 0);
    for _ in 0..60 {
        let wanted = [3.0 * rng.f64() - 1.5, 3.0 * rng.f64() - 1.5];
        let within = |p: [f64; 2]| {
            shoulders.iter().all(|&s| (least - 1e-9..=most + 1e-9).contains(&apart(p, s)))
        };
        if within(wanted) {
            continue;
        }
        // The feet on each circle, and the points where two circles of different shoulders meet.
        let mut candidates = Vec::new();
        for radius in [least, most] {
            for s in shoulders {
                let share = radius / apart(wanted, s);
                let foot = |sign: f64| {
                    [
                        s[0] + sign * share * (wanted[0] - s[0]),
                        s[1] + sign * share * (wanted[1] - s[1]),
                    ]
                };
                candidates.extend([(foot(1.0), false), (foot(-1.0), false)]);
            }
            for other in [least, most] {
                let x = (radius * radius - other * other) / (4.0 * 0.16);
                let y = (radius * radius - (x + 0.16) * (x + 0.16)).sqrt();
                candidates.extend([([x, y], true), ([x, -y], true)]);
            }
        }
        let nearest = candidates
            .into_iter()
            .filter(|&(p, _)| p[1].is_finite() && within(p))
            .min_by(|a, b| apart(a.0, wanted).total_cmp(&apart(b.0, wanted)))
            .unwrap();
        let length = m.characteristic_length();
        let found = m.reach().nearest(&wanted, None, length).unwrap().unwrap();
        let expected = apart(nearest.0, wanted);
        assert!((found.distance - expected).abs() < CLOSED, "{wanted:?}: {found:?}, {nearest:?}");
        if nearest.1 { corners += 1 } else { rings += 1 }
    }
    assert!(corners > 5 && rings > 5, "{corners} corners, {rings} on rings");
}

/// The platform of the 3-RRR at its home angle: three rings about the motors, moved by the corners. With a large
/// characteristic length the platform does not turn to come nearer.
#[test]
fn a_planar_3rrr_far_away_in_one_orientation() {
    let m = Manipulator::example("planar-3rrr").unwrap();
    let at = |radius: f64, degrees: f64| {
        [radius * degrees.to_radians().cos(), radius * degrees.to_radians().sin()]
    };
    let (radius, apart) =
        (0.331 / 3_f64.sqrt(), |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]));
    let centres: Vec<[f64; 2]> = [210.0, 330.0, 90.0]
        .map(|angle| {
            let ([a, b], [c, d]) = (at(radius, angle), at(0.07506, angle));
            [a - c, b - d]
        })
        .to_vec();
    let within =
        |p: [f64; 2]| centres.iter().all(|&c| (0.056 - 1e-9..=0.276 + 1e-9).contains(&apart(p, c)));
    for angle in [3.0, 31.0, 77.0, 140.0, 200.0, 290.0] {
        let wanted = at(1.0, angle);
        let mut expected = f64::INFINITY;
        // The boundary of the rings, point by point.
        for &c in &centres {
            for radius in [0.056, 0.276] {
                for step in 0..36_000 {
                    let e = at(radius, f64::from(step) * 1e-2);
                    let p = [c[0] + e[0], c[1] + e[1]];
                    if within(p) {
                        expected = expected.min(apart(p, wanted));
                    }
                }
            }
        }
        let found = m.reach().nearest(&[wanted[0], wanted[1], 0.0], None, 1e3).unwrap().unwrap();
        // The circles are compared at points that are 48 µm apart. A turn of the platform costs so much with this length that
        // it gains less than that.
        assert!((found.distance - expected).abs() < 5e-5, "{angle}: {found:?}, {expected}");
        assert!(found.pose[2].abs() < 1e-5, "{found:?}");
    }
}

/// Of every shipped mechanism, far and near poses: what is found is in reach by the tool's own check, at the distance that
/// is said, and no random pose of many is nearer.
#[test]
fn no_random_pose_is_nearer() {
    let mut compared = 0;
    for example in EXAMPLES {
        let Ok(m) = Manipulator::example(example.name) else { continue };
        let (length, mode) = (m.characteristic_length(), Some(m.home_mode()));
        let (mut solution, rng) = (m.solution(), &mut Rng::with_seed(11));
        let home = m.home_pose();
        let weight = |i: usize| match m.task_coordinates()[i].quantity {
            Quantity::Length => 1.0,
            Quantity::Angle => length,
        };
        for far in [1.0, 2.5] {
            let wanted: Vec<f64> = (0..home.len())
                .map(|i| home[i] + far * length * (2.0 * rng.f64() - 1.0) / weight(i))
                .collect();
            let found = m.reach().nearest(&wanted, mode, length).unwrap();
            let found = found.unwrap_or_else(|| panic!("{}: nothing", example.name));
            assert!(reaches(&m, &found.pose, mode, &mut solution), "{}: {found:?}", example.name);
            let distance = |pose: &[f64]| -> f64 {
                (0..pose.len())
                    .map(|i| ((pose[i] - wanted[i]) * weight(i)).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            assert!((distance(&found.pose) - found.distance).abs() < 1e-9 * (1.0 + found.distance));
            if found.distance == 0.0 {
                continue;
            }
            compared += 1;
            let mut nearest = f64::INFINITY;
            for number in 0..30_000 {
                // In the box about the wanted pose, and close about the pose that was found.
                let (centre, half) = match number % 3 {
                    0 => (&wanted, found.distance),
                    1 => (&found.pose, 0.1 * found.distance),
                    _ => (&found.pose, 0.005 * found.distance),
                };
                let pose: Vec<f64> = (0..home.len())
                    .map(|i| centre[i] + half * (2.0 * rng.f64() - 1.0) / weight(i))
                    .collect();
                if distance(&pose) < nearest.min(found.distance)
                    && reaches(&m, &pose, mode, &mut solution)
                {
                    nearest = distance(&pose);
                }
            }
            assert!(
                nearest > found.distance * (1.0 - 1e-4),
                "{}: {} found, {nearest} at random",
                example.name,
                found.distance
            );
        }
    }
    assert!(compared >= 25, "{compared}");
}

#[test]
fn wrong_poses_and_poses_in_reach() {
    let m = Manipulator::example("delta").unwrap();
    let home = m.home_pose();
    let found = m.reach().nearest(&home, Some(m.home_mode()), 0.1).unwrap().unwrap();
    assert_eq!((found.pose, found.distance), (home, 0.0));
    assert!(m.reach().nearest(&[0.0, 0.0], None, 0.1).is_err());
    assert!(m.reach().nearest(&[f64::NAN, 0.0, 0.0], None, 0.1).is_err());
    assert!(m.reach().nearest(&[1e300, 0.0, 0.0], None, 0.1).is_err());
    // Far away: the direction is all that counts.
    let far = m.reach().nearest(&[1e6, 0.0, 0.0], None, 0.1).unwrap().unwrap();
    assert!((far.distance - 1e6).abs() < 10.0 && far.pose[0].abs() < 10.0, "{far:?}");
}
