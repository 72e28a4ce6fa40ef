//! The least change of the actuated joints that closes, held against geometry: circles that do not meet, and closures that
//! were computed from distances.

use super::example;
use fastrand::Rng;
use nalgebra::{Vector2, Vector3};
use opm_core::forward::LeastChange;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

fn read(text: &str) -> Manipulator {
    Manipulator::new(file::read(text).unwrap_or_else(|e| panic!("{e:?}\n{text}")).mechanism)
        .unwrap()
}

fn least(m: &Manipulator, joints: &[f64]) -> LeastChange {
    assert!(m.forward(joints).unwrap().list.is_empty());
    m.least_change(joints).unwrap().expect("a least change")
}

/// Two chains that hang from spools, 2974.83 mm apart: they are too short in sum by what is missing to that.
#[test]
fn two_chains_are_too_short_together() {
    let m = read(include_str!("../../../data/reference/forward/hanging-router.toml"));
    let found = least(&m, &[1.0, 1.5]);
    let missing = 2.974_83 - 2.5;
    for change in &found.together {
        assert!((change - 0.5 * missing).abs() < 1e-9, "{found:?}");
    }
    for change in &found.alone {
        assert!((change.unwrap() - missing).abs() < 1e-9, "{found:?}");
    }
    // One is longer than the other and the distance.
    let found = least(&m, &[4.0, 0.5]);
    let surplus = 4.0 - 0.5 - 2.974_83;
    assert!((found.together[0] + 0.5 * surplus).abs() < 1e-9, "{found:?}");
    assert!((found.together[1] - 0.5 * surplus).abs() < 1e-9, "{found:?}");
    assert!((found.alone[0].unwrap() + surplus).abs() < 1e-9, "{found:?}");
    assert!((found.alone[1].unwrap() - surplus).abs() < 1e-9, "{found:?}");
}

/// A five-bar with base points on the x axis, from its numbers.
struct FiveBar {
    base: f64,
    arms: [f64; 2],
    forearms: [f64; 2],
}

impl FiveBar {
    /// Home: both actuated angles, at which the forearms meet above.
    fn manipulator(&self, home: [f64; 2]) -> Option<Manipulator> {
        let [a, b] = self.elbows(home);
        let way = b - a;
        let (d, [p, q]) = (way.norm(), self.forearms);
        let along = (d * d + p * p - q * q) / (2.0 * d);
        let height = (p * p - along * along).sqrt();
        if height.is_nan() || height <= 0.2 * p {
            return None;
        }
        let u = way / d;
        let hand = a + u * along + Vector2::new(-u.y, u.x) * height;
        let mut text = format!(
            "format = 1\nname = \"five-bar\"\nunits = {{ length = \"m\", angle = \"rad\" }}\n[platform]\npoint = [{}, {}, 0]\n",
            hand.x, hand.y
        );
        let joint = |name: &str, at: Vector2<f64>, more: &str| {
            format!(
                "  {{ name = {name:?}, type = \"revolute\", axis = [0, 0, 1], point = [{:?}, {:?}, 0]{more} }},\n",
                at.x, at.y
            )
        };
        let actuated = |home: f64| format!(", actuated = true, home = {home:?}");
        let bases = [Vector2::zeros(), Vector2::new(self.base, 0.0)];
        write!(text, "[[leg]]\nname = \"left\"\njoints = [\n").unwrap();
        text += &(joint("L", bases[0], &actuated(home[0]))
            + &joint("LE", a, "")
            + &joint("H", hand, ""));
        write!(text, "]\n[[leg]]\nname = \"right\"\njoints = [\n").unwrap();
        text += &(joint("R", bases[1], &actuated(home[1])) + &joint("RE", b, "") + "]\n");
        Manipulator::new(file::read(&text).unwrap().mechanism).ok()
    }

    fn elbows(&self, [l, r]: [f64; 2]) -> [Vector2<f64>; 2] {
        let at = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        [at(l) * self.arms[0], Vector2::new(self.base, 0.0) + at(r) * self.arms[1]]
    }

    /// By how much the distance of the elbows is beyond what the forearms span; negative where they meet.
    fn open(&self, angles: [f64; 2]) -> f64 {
        let [a, b] = self.elbows(angles);
        let [p, q] = self.forearms;
        let d = (a - b).norm();
        (d - (p + q)).max((p - q).abs() - d)
    }

    /// The least distance of angles that close, along rays in many directions, and then between the best ones.
    fn least(&self, given: [f64; 2]) -> f64 {
        let along = |direction: f64, most: f64| {
            let at = |r: f64| {
                self.open([given[0] + r * direction.cos(), given[1] + r * direction.sin()])
            };
            let step = 1e-3;
            let mut r = 0.0;
            while r < most && at(r + step) > 0.0 {
                r += step;
            }
            if r >= most {
                return f64::INFINITY;
            }
            let (mut open, mut closed) = (r, r + step);
            for _ in 0..60 {
                let middle = 0.5 * (open + closed);
                if at(middle) > 0.0 { open = middle } else { closed = middle }
            }
            closed
        };
        let (mut best, mut at, mut span) = (4.0 * PI, 0.0, TAU);
        for _ in 0..12 {
            let from = at - 0.5 * span;
            for i in 0..=200 {
                let direction = from + span * f64::from(i) / 200.0;
                let r = along(direction, best + 1e-3);
                if r < best {
                    (best, at) = (r, direction);
                }
            }
            span *= 0.05;
        }
        best
    }
}

#[test]
fn five_bars_are_changed_as_little_as_geometry_says() {
    let mut rng = Rng::with_seed(61);
    let mut tried = 0;
    while tried < 12 {
        let mut length = |low: f64, high: f64| low + (high - low) * rng.f64();
        let bar = FiveBar {
            base: length(0.2, 0.5),
            arms: [length(0.15, 0.3), length(0.15, 0.3)],
            forearms: [length(0.2, 0.35), length(0.2, 0.35)],
        };
        let home = [length(1.4, 2.4), length(0.7, 1.7)];
        let Some(m) = bar.manipulator(home) else { continue };
        let given = [length(-PI, PI), length(-PI, PI)];
        if bar.open(given) < 1e-3 {
            continue;
        }
        tried += 1;
        let found = least(&m, &given);
        let distance = found.together[0].hypot(found.together[1]);
        let expected = bar.least(given);
        assert!((distance - expected).abs() < 1e-7, "{given:?}: {found:?}, {expected}");
        for joint in 0..2 {
            let at = |change: f64| {
                let mut angles = given;
                angles[joint] += change;
                bar.open(angles)
            };
            let steps = (1..=6283).map(|i| f64::from(i) * TAU / 12_566.0);
            let expected = steps.flat_map(|step| [step, -step]).find(|&step| at(step) <= 0.0);
            match (found.alone[joint], expected) {
                (Some(change), Some(step)) => {
                    assert!((change.abs() - step.abs()).abs() < 6e-4, "{change} {step}");
                    assert!(at(change).abs() < 1e-9, "{change}: {}", at(change));
                }
                (None, None) => {}
                other => panic!("{given:?}, joint {joint}: {other:?}"),
            }
        }
    }
}

/// The forearms of 150 mm are stretched at 133.251365 degrees of the right motor.
#[test]
fn a_millionth_beyond_the_limit() {
    let m = read(include_str!("../../../data/reference/forward/fivebar-150.toml"));
    let (l, r) = (90.0_f64.to_radians(), 133.2513_f64.to_radians());
    let forearm = (200.0 - 144.374_100_255_449_26_f64).hypot(180.0 - 40.695_444_160_611_94);
    let arm = 144.374_100_255_449_26_f64.hypot(40.695_444_160_611_94);
    let open = |r: f64| {
        let [a, b] = [Vector2::new(0.0, arm), Vector2::new(400.0 + arm * r.cos(), arm * r.sin())];
        (a - b).norm() - 2.0 * forearm
    };
    let (mut low, mut high) = (r, r + 1e-3);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if open(middle) > 0.0 { low = middle } else { high = middle }
    }
    let limit = high;
    assert!((limit.to_degrees() - 133.251_365).abs() < 1e-6);
    let found = least(&m, &[l, r]);
    let alone = found.alone[1].unwrap();
    assert!((alone - (limit - r)).abs() < 1e-11, "{alone:e} {:e}", limit - r);
    assert!(alone > 1.0e-6 && alone < 1.2e-6);
    assert!(found.together[0].hypot(found.together[1]) < alone);
}

/// What every answer has to hold: the joints close there, and none in many directions do that are nearer.
fn holds(m: &Manipulator, given: &[f64], found: &LeastChange, rng: &mut Rng) {
    let unit: Vec<f64> = (m.actuated().iter())
        .map(|&i| match m.coordinates()[i].quantity {
            opm_core::Quantity::Angle => 1.0,
            opm_core::Quantity::Length => m.characteristic_length(),
        })
        .collect();
    let closes = |changes: &[f64]| {
        let joints: Vec<f64> = given.iter().zip(changes).map(|(q, c)| q + c).collect();
        !m.forward(&joints).unwrap().list.is_empty()
    };
    let beyond: Vec<f64> = found.together.iter().map(|c| c * (1.0 + 1e-5)).collect();
    assert!(closes(&beyond), "{given:?} {found:?}");
    let least = found.together.iter().zip(&unit).map(|(c, u)| (c / u).powi(2)).sum::<f64>().sqrt();
    for _ in 0..300 {
        let direction: Vec<f64> = unit.iter().map(|_| 2.0 * rng.f64() - 1.0).collect();
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        let share = 0.999 * rng.f64().sqrt() * least / length;
        let nearer: Vec<f64> = direction.iter().zip(&unit).map(|(x, u)| x * u * share).collect();
        assert!(!closes(&nearer), "{given:?} {found:?} {nearer:?}");
    }
    for (joint, change) in found.alone.iter().enumerate() {
        let Some(change) = *change else { continue };
        let mut changes = vec![0.0; given.len()];
        changes[joint] = change * (1.0 + 1e-7);
        assert!(closes(&changes), "{given:?} {found:?}");
        assert!(change.abs() / unit[joint] >= least * (1.0 - 1e-7), "{found:?}");
        for share in [0.2, 0.5, 0.8, 0.95, 0.999_99] {
            changes[joint] = change * share;
            assert!(!closes(&changes), "{given:?} {found:?}");
        }
    }
}

#[test]
fn no_nearer_joints_close() {
    let mut rng = Rng::with_seed(62);
    for name in ["five-bar", "planar-3rrr", "planar-3rpr", "agile-eye", "plano-spherical-5dof"] {
        let m = example(name);
        let (mut told, mut silent) = (0, 0);
        while told + silent < 6 {
            let given: Vec<f64> = m
                .actuated()
                .iter()
                .map(|&i| {
                    let c = &m.coordinates()[i];
                    let reach = if c.quantity == opm_core::Quantity::Angle { PI } else { 0.8 };
                    c.home + reach * (2.0 * rng.f64() - 1.0)
                })
                .collect();
            let found = m.forward(&given).unwrap();
            if !found.list.is_empty() || !found.loose.is_empty() {
                // A mechanism that always closes would never end.
                silent += usize::from(rng.u32(..50) == 0);
                continue;
            }
            match m.least_change(&given).unwrap() {
                Some(change) => {
                    holds(&m, &given, &change, &mut rng);
                    told += 1;
                }
                None => silent += 1,
            }
        }
        println!("{name}: {told} told, {silent} not");
        // These two always close.
        assert!(told >= 4 || ["five-bar", "agile-eye"].contains(&name), "{name}: {told} told");
    }
}

/// A spherical five-bar: the forearms, arcs of some angle, span at most their sum.
#[test]
fn spherical_arcs_are_too_short_together() {
    let m = read(include_str!("../../../data/reference/forward/spherical-fivebar-5R.toml"));
    let mechanism = m.mechanism();
    let axis = |leg: usize, joint: usize| mechanism.legs[leg].joints[joint].axis.into_inner();
    // The platform is the outer link of the first leg, and carries the last axis of the second.
    let hand = axis(1, 2);
    let arc = |a: Vector3<f64>, b: Vector3<f64>| a.dot(&b).clamp(-1.0, 1.0).acos();
    let forearms = [arc(axis(0, 1), hand), arc(axis(1, 1), hand)];
    let home = [
        mechanism.legs[0].joints[0].coordinates[0].home,
        mechanism.legs[1].joints[0].coordinates[0].home,
    ];
    let open = |angles: [f64; 2]| {
        let moved = |leg: usize| {
            let turn = nalgebra::Rotation3::from_axis_angle(
                &mechanism.legs[leg].joints[0].axis,
                angles[leg] - home[leg],
            );
            turn * axis(leg, 1)
        };
        let d = arc(moved(0), moved(1));
        let sum = forearms[0] + forearms[1];
        (d - sum.min(TAU - sum)).max((forearms[0] - forearms[1]).abs() - d)
    };
    let mut rng = Rng::with_seed(63);
    let mut tried = 0;
    for _ in 0..2_000 {
        let given = [0, 1].map(|_| PI * (2.0 * rng.f64() - 1.0));
        if open(given) < 1e-3 || tried == 6 {
            continue;
        }
        tried += 1;
        let found = least(&m, &given);
        let end = [given[0] + found.together[0], given[1] + found.together[1]];
        assert!(open(end).abs() < 1e-9, "{found:?} {}", open(end));
        let radius = found.together[0].hypot(found.together[1]);
        for i in 0..3_600 {
            let (sin, cos) = (f64::from(i) * TAU / 3_600.0).sin_cos();
            for share in [0.3, 0.7, 0.95, 0.999] {
                let r = share * radius;
                assert!(
                    open([given[0] + r * cos, given[1] + r * sin]) > 0.0,
                    "{given:?} {found:?}"
                );
            }
        }
    }
    assert_eq!(tried, 6);
}

/// One motor: the range of a crank ends where coupler and rocker are in line.
#[test]
fn a_single_motor_goes_to_the_end_of_its_range() {
    let text = "format = 1\nname = \"rocker\"\nunits = { length = \"m\", angle = \"rad\" }\n[platform]\npoint = [4, 2, 0]\n[[leg]]\nname = \"crank\"\njoints = [\n\
        { name = \"A\", type = \"revolute\", axis = [0, 0, 1], point = [0, 0, 0], actuated = true },\n\
        { name = \"B\", type = \"revolute\", axis = [0, 0, 1], point = [3, 0, 0] },\n\
        { name = \"C\", type = \"revolute\", axis = [0, 0, 1], point = [4, 2, 0] },\n]\n\
        [[leg]]\nname = \"rocker\"\njoints = [\n\
        { name = \"D\", type = \"revolute\", axis = [0, 0, 1], point = [5, 0, 0] },\n]\n";
    let m = read(text);
    // Crank 3, ground 5, coupler and rocker √5: they span 2 √5, and 9 + 25 - 30 cos A = 20 at the end.
    let end = (14.0_f64 / 30.0).acos();
    for given in [1.5, 2.5, -1.5] {
        let found = least(&m, &[given]);
        let expected = end.copysign(given) - given;
        assert!((found.together[0] - expected).abs() < 1e-9, "{given}: {found:?} {expected}");
        assert_eq!(found.alone, [Some(found.together[0])]);
    }
}

/// More motors than freedoms: what is wrong with one is distributed over all, and each alone says how far it is off.
#[test]
fn redundant_motors_are_off_by_what_was_added() {
    let mut mechanism = example("five-bar").mechanism().clone();
    mechanism.legs[0].joints[1].actuated = true;
    let m = Manipulator::new(mechanism).unwrap();
    let (mode, mut solution) = (m.home_mode(), m.solution());
    let mut rng = Rng::with_seed(64);
    let mut tried = 0;
    while tried < 10 {
        let home = m.home_pose();
        let pose: Vec<f64> = home.iter().map(|q| q + 0.05 * (2.0 * rng.f64() - 1.0)).collect();
        if m.inverse(&pose, mode, &mut solution).unwrap().is_none() {
            continue;
        }
        tried += 1;
        let right: Vec<f64> = m.actuated().iter().map(|&i| solution.joints()[i]).collect();
        for joint in 0..3 {
            let mut given = right.clone();
            given[joint] += 0.01;
            let found = least(&m, &given);
            let changes = &found.together;
            let norm = changes.iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!(norm <= 0.01 + 1e-12, "{found:?}");
            let there: Vec<f64> = given.iter().zip(changes).map(|(q, c)| q + c).collect();
            assert!(!m.forward(&there).unwrap().list.is_empty(), "{found:?}");
            let alone = found.alone[joint].expect("the value that it had");
            assert!(alone.abs() <= 0.01 + 1e-9, "{found:?}");
            given[joint] += alone;
            assert!(!m.forward(&given).unwrap().list.is_empty(), "{found:?}");
        }
    }
}
