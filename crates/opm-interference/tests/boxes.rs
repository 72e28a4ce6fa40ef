//! Bounds over boxes hold at random poses in them.

use fastrand::Rng;
use opm_core::Manipulator;
use opm_core::enclosure::{Affine, BodyPoint, MovingBody, Side};
use opm_core::manipulator::Mode;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::mechanism::joint::Quantity;
use opm_core::skeleton::{Configuration, Skeleton};
use opm_interference::{BoxTest, Clearance, Distances, Interference};

/// Rounding of products of exponentials, as a share of the mechanism's size.
const ROUNDING: f64 = 1e-11;

/// The shipped mechanisms whose boxes are enclosed.
fn manipulators() -> Vec<Manipulator> {
    let all = EXAMPLES.iter().filter_map(|e| Manipulator::example(e.name).ok());
    let enclosed: Vec<_> = all.filter(Manipulator::encloses_places).collect();
    assert!(enclosed.len() >= 14, "{}", enclosed.len());
    enclosed
}

/// A random box of poses about home, wide in two of the coordinates at most.
fn random_box(manipulator: &Manipulator, size: f64, rng: &mut Rng) -> Vec<Side> {
    let coordinates = manipulator.task_coordinates();
    let wide = [rng.usize(0..coordinates.len()), rng.usize(0..coordinates.len())];
    let half = 10.0_f64.powf(-1.0 - 3.0 * rng.f64());
    let sides = coordinates.iter().enumerate().map(|(number, c)| {
        let unit = if c.quantity == Quantity::Length { size } else { 1.0 };
        let middle = c.home + 0.2 * unit * (2.0 * rng.f64() - 1.0);
        let half = if wide.contains(&number) { half * unit } else { 0.0 };
        Side { middle, half, half_turn: None }
    });
    sides.collect()
}

fn pose_in(sides: &[Side], rng: &mut Rng) -> Vec<f64> {
    let at = |side: &Side| {
        let share: f64 = [-1.0, 1.0, 2.0 * rng.f64() - 1.0][rng.usize(0..3)];
        side.middle + share * side.half
    };
    sides.iter().map(at).collect()
}

/// Where a pose is in a box: for each side with a width, from -1 to 1.
fn place_in(sides: &[Side], pose: &[f64]) -> [f64; 2] {
    let wide = sides.iter().zip(pose).filter(|(side, _)| side.half > 0.0);
    let mut at = [0.0; 2];
    for (at, (side, x)) in at.iter_mut().zip(wide) {
        *at = (x - side.middle) / side.half;
    }
    at
}

fn random_mode(manipulator: &Manipulator, rng: &mut Rng) -> Mode {
    let modes: Vec<Mode> = manipulator.modes().collect();
    modes[rng.usize(0..modes.len())]
}

/// The joints' centres in every body, which the skeleton places from the joint values.
#[test]
fn places_are_linear_to_within_their_errors() {
    let mut rng = Rng::with_seed(11);
    for manipulator in manipulators() {
        let name = manipulator.mechanism().name.clone();
        let skeleton = Skeleton::new(manipulator.mechanism(), None);
        let size = skeleton.size();
        let legs = manipulator.mechanism().legs.iter().enumerate();
        let links = legs.flat_map(|(leg, joints)| {
            (1..joints.joints.len()).map(move |joints| MovingBody::Link { leg, joints })
        });
        let bodies: Vec<_> = links.chain([MovingBody::Platform]).collect();
        let mut points = Vec::new();
        let mut local = Vec::new();
        for (number, body) in (1..).zip(bodies) {
            let of = &skeleton.bodies()[number];
            for seat in &of.seats {
                local.push((number, seat.centre));
                points.push(BodyPoint { body, home: seat.centre + of.origin.coords });
            }
        }
        let (mut solution, mut found) = (manipulator.solution(), Vec::new());
        let (mut reached, mut tight) = (0, 0);
        for _ in 0..300 {
            let sides = random_box(&manipulator, size, &mut rng);
            let mode = random_mode(&manipulator, &mut rng);
            manipulator.places_over(mode, &sides, &points, &mut found);
            for _ in 0..6 {
                let pose = pose_in(&sides, &mut rng);
                let Ok(Some(solution)) = manipulator.inverse(&pose, mode, &mut solution) else {
                    continue;
                };
                reached += 1;
                let platform = solution.displacement(&manipulator);
                let joints = solution.joints();
                let at = Configuration { joints, imaginary: &[], platform };
                let placed = skeleton.place_in_base(&at).unwrap();
                let at = place_in(&sides, &pose);
                for ((body, centre), found) in local.iter().zip(&found) {
                    let Some(found) = found else { continue };
                    let placed = placed[*body] * centre;
                    for (x, place) in found.iter().zip(placed.iter()) {
                        let linear = x.centre + x.slope[0] * at[0] + x.slope[1] * at[1];
                        let off = (place - linear).abs() - x.total_error();
                        assert!(off <= ROUNDING * size, "{name}, body {body}: off by {off} m");
                    }
                }
            }
            let is_tight =
                |place: &[Affine<2>; 3]| place.iter().all(|x| x.total_error() < 0.1 * size);
            tight += usize::from(found.iter().all(|place| place.as_ref().is_some_and(is_tight)));
        }
        assert!(reached > 50 && tight > 50, "{name}: {reached} poses, {tight} boxes");
    }
}

/// Boxes that are clear or blocked are so at each pose that is reached, and so are poses that bounds in the box decide; single
/// poses agree with distances.
#[test]
fn boxes_decide_as_the_distances_do() {
    let (mut rng, mut in_box) = (Rng::with_seed(5), 0);
    for manipulator in manipulators() {
        let name = manipulator.mechanism().name.clone();
        let interference = Interference::new(manipulator.mechanism());
        let mut distances = Distances::new(&interference);
        let Some(at_home) = distances.nearest() else { continue };
        let size = Skeleton::new(manipulator.mechanism(), None).size();
        let mut solution = manipulator.solution();
        let mut decided = 0;
        for _ in 0..400 {
            let sides = random_box(&manipulator, size, &mut rng);
            let mode = random_mode(&manipulator, &mut rng);
            // Often next to a distance that occurs in the box, so that it has poses of both kinds.
            let pose = pose_in(&sides, &mut rng);
            let least = match manipulator.inverse(&pose, mode, &mut solution) {
                Ok(Some(solution)) if rng.bool() => {
                    distances.place(&manipulator, solution);
                    distances.nearest().unwrap().distance.max(0.0) + 1e-9 * size
                }
                _ => at_home.distance * 2.0 * rng.f64(),
            };
            let mut test = BoxTest::new(&manipulator, &interference, least);
            let (all, mut open) = (test.all(), Default::default());
            let verdict = test.over_box(mode, &sides, &all, &mut open);
            for _ in 0..5 {
                let pose = pose_in(&sides, &mut rng);
                let Ok(Some(solution)) = manipulator.inverse(&pose, mode, &mut solution) else {
                    continue;
                };
                distances.place(&manipulator, solution);
                let clear = distances.nearest().unwrap().distance >= least;
                assert_eq!(test.at(solution, &all), clear, "{name}");
                match verdict {
                    Clearance::Clear => assert!(clear, "{name}: not clear"),
                    Clearance::Blocked => assert!(!clear, "{name}: not blocked"),
                    Clearance::Open => assert_eq!(test.at(solution, &open), clear, "{name}"),
                }
                decided += usize::from(verdict != Clearance::Open);
                if verdict == Clearance::Open {
                    match test.in_box(&pose) {
                        Clearance::Clear => assert!(clear, "{name}: not clear in a box"),
                        Clearance::Blocked => assert!(!clear, "{name}: not blocked in a box"),
                        Clearance::Open => continue,
                    }
                    in_box += 1;
                }
            }
        }
        assert!(decided > 20, "{name}: {decided}");
    }
    assert!(in_box > 1000, "{in_box} poses decided by bounds in an open box");
}
