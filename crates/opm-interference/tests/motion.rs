//! Contacts along a motion whose times are known.

use nalgebra::{Unit, Vector3};
use opm_core::mechanism::{Obstacle, ObstacleShape, examples, file};
use opm_core::motion::{Harmonics, Instant, Path, PlatformMotion, Sinusoid};
use opm_core::numeric::Quantity;
use opm_core::{Manipulator, Trajectory};
use opm_interference::{Contact, Distances, Interference, Watch, Watched};
use std::f64::consts::PI;

/// Times are found to 1e-10 of a step; distances are exact to rounding, and the lowest to 1e-8 of a step.
const CLOSE: f64 = 1e-7;

const RADIUS: f64 = 0.002;
const AMPLITUDE: f64 = 0.03;

/// The contacts of the platform with a wall, where the platform of a 3-RRR swings along x by `AMPLITUDE` once in two
/// seconds. At rest the platform is at such a distance of the wall that the largest swing passes it by `share` less.
fn contacts(share: f64, clearance: f64, rate: f64) -> (Vec<Contact>, f64) {
    let text = examples::find("planar-3rrr").unwrap().text;
    let mut mechanism = file::read(text).unwrap().mechanism;
    let ends = mechanism.legs.iter().map(|leg| leg.joints[2].point.x);
    let right = ends.chain([mechanism.platform.x]).fold(f64::MIN, f64::max) + RADIUS;
    let point = Vector3::x() * (right + clearance + share * AMPLITUDE);
    let normal = Unit::new_normalize(-Vector3::x());
    let shape = ObstacleShape::HalfSpace { point: point.into(), normal };
    mechanism.shapes.obstacles = vec![Obstacle { name: "wall".to_owned(), shape }];
    mechanism.shapes.radius = Some(RADIUS);
    let manipulator = Manipulator::new(mechanism).unwrap();
    let coordinates = manipulator.task_coordinates().iter();
    let mut path: Vec<_> = coordinates.map(|c| Harmonics::constant(c.home)).collect();
    path[0].sinusoids.push(Sinusoid { amplitude: AMPLITUDE, frequency: 0.5, phase: 0.0 });
    let (name, path) = ("swing".to_owned(), Path::Harmonics(path));
    let motion = PlatformMotion { name, start: 0.0, duration: 2.0, rate: None, mode: None, path };
    let mode = manipulator.home_mode();
    let interference = Interference::new(manipulator.mechanism());
    let of = Watched { manipulator: &manipulator, motion: &motion, mode, clearance };
    let mut watch = Watch::new(of, Distances::new(&interference));
    let mut trajectory = Trajectory::new(&manipulator, &motion, mode, rate).unwrap();
    while trajectory.advance().unwrap() {
        let sample = trajectory.sample();
        assert!(sample.reached);
        watch.advance(sample.time, 1.0 / rate, Some(&sample.solution)).unwrap();
    }
    let (contacts, nearest) = watch.finish();
    let (nearest, _) = nearest.unwrap();
    let platform = |c: &Contact| interference.names_of(c.pair) == ["platform", "wall"];
    (contacts.into_iter().filter(platform).collect(), nearest.distance)
}

#[test]
fn contacts_begin_and_end_when_the_platform_passes() {
    // The last one is over between two samples, which do not touch.
    for (share, rate) in [(0.5, 40.0), (0.5, 5.0), (0.9, 19.0), (0.9999, 19.0)] {
        for clearance in [0.0, 0.004] {
            let (found, nearest) = contacts(share, clearance, rate);
            let [contact] = &found[..] else { panic!("{share}: {found:?}") };
            let start = f64::asin(share) / PI;
            assert!((contact.start - start).abs() < CLOSE, "{share}: {contact:?}, not {start}");
            assert!((contact.end - (1.0 - start)).abs() < CLOSE, "{share}: {contact:?}");
            assert!((contact.worst - 0.5).abs() < 1e-4, "{contact:?}");
            let distance = clearance - (1.0 - share) * AMPLITUDE;
            assert!((contact.distance - distance).abs() < CLOSE, "{contact:?}, not {distance}");
            assert!(nearest <= contact.distance + CLOSE);
        }
    }
}

#[test]
fn what_does_not_touch_is_no_contact() {
    assert_eq!(contacts(1.0001, 0.0, 19.0).0, []);
}

/// Two sinusoids in every coordinate, of random sizes.
fn wandering(manipulator: &Manipulator, rng: &mut fastrand::Rng) -> PlatformMotion {
    let coordinates = manipulator.task_coordinates().iter();
    let path = coordinates.map(|coordinate| {
        let most = match coordinate.quantity {
            Quantity::Angle => 0.3,
            Quantity::Length => 0.1 * manipulator.characteristic_length(),
        };
        let sinusoids = [0.5, 1.5].map(|frequency| {
            let (amplitude, phase) = (most * rng.f64(), 2.0 * PI * rng.f64());
            Sinusoid { amplitude, frequency, phase }
        });
        Harmonics { sinusoids: sinusoids.to_vec(), ..Harmonics::constant(coordinate.home) }
    });
    let (name, path) = ("wandering".to_owned(), Path::Harmonics(path.collect()));
    PlatformMotion { name, start: 0.0, duration: 2.0, rate: None, mode: None, path }
}

/// How often the distances are measured in each step that a motion is watched at.
const TIMES: usize = 10;

/// Checks that all distances, measured at many instants, tell of the same contacts. Returns their number.
fn check_contacts(manipulator: &Manipulator, motion: &PlatformMotion, rate: f64) -> usize {
    let interference = Interference::new(manipulator.mechanism());
    let mut distances = Distances::new(&interference);
    let mode = manipulator.home_mode();
    let mut trajectory = Trajectory::new(manipulator, motion, mode, rate * TIMES as f64).unwrap();
    let mut measured: Vec<Option<(f64, Vec<f64>)>> = Vec::new();
    while trajectory.advance().unwrap() {
        let sample = trajectory.sample();
        measured.push(sample.reached.then(|| {
            distances.place(manipulator, &sample.solution);
            let of_pairs = (0..interference.pairs()).map(|pair| distances.of(pair));
            (sample.time, of_pairs.collect())
        }));
    }
    // Whole steps of the watch that are in reach: a motion may leave it between two of its samples.
    let in_reach: Vec<_> = measured
        .windows(TIMES + 1)
        .step_by(TIMES)
        .filter_map(|step| step.iter().cloned().collect::<Option<Vec<_>>>())
        .flatten()
        .collect();
    let all = in_reach.iter().flat_map(|(_, of_pairs)| of_pairs);
    let Some(least) = all.copied().min_by(f64::total_cmp) else { return 0 };
    let mut contacts_seen = 0;
    let mut instant = Instant::new(manipulator.task_coordinates().len());
    let mut solution = manipulator.solution();
    // A clearance that some pairs do not keep all the time.
    for clearance in [0.0, least + 0.02 * manipulator.characteristic_length()] {
        let of = Watched { manipulator, motion, mode, clearance };
        let mut watch = Watch::new(of, Distances::new(&interference));
        let mut trajectory = Trajectory::new(manipulator, motion, mode, rate).unwrap();
        while trajectory.advance().unwrap() {
            let sample = trajectory.sample();
            let solution = Some(&sample.solution).filter(|_| sample.reached);
            watch.advance(sample.time, 1.0 / rate, solution).unwrap();
        }
        let (contacts, nearest) = watch.finish();
        contacts_seen += contacts.len();
        let (nearest, time) = nearest.unwrap();
        assert!(nearest.distance < least + 1e-9, "{nearest:?}, not {least}");
        // The distances that are told are those at the times that are told.
        let worst = contacts.iter().map(|c| (c.pair, c.worst, c.distance));
        for (pair, time, told) in worst.chain([(nearest.pair, time, nearest.distance)]) {
            motion.at(time, &mut instant);
            let found = manipulator.inverse(&instant.pose, mode, &mut solution).unwrap().unwrap();
            distances.place(manipulator, found);
            let distance = distances.of(pair);
            assert!(
                (distance - told).abs() < 1e-6,
                "pair {pair} at {time}: {distance}, not {told}"
            );
        }
        for (time, of_pairs) in &in_reach {
            for (pair, distance) in of_pairs.iter().enumerate() {
                let mut of_pair = contacts.iter().filter(|contact| contact.pair == pair);
                let within = of_pair.find(|c| (c.start - CLOSE..=c.end + CLOSE).contains(time));
                // Distances from boxes are exact to 1e-6 of the size.
                let level = distance - clearance;
                match within {
                    None => assert!(level > -1e-6, "pair {pair} at {time}: {level}"),
                    Some(contact) => {
                        assert!(level < 1e-6, "{contact:?} at {time}: {level}");
                        assert!(contact.distance <= distance + 1e-8, "{contact:?}: {distance}");
                    }
                }
            }
        }
    }
    contacts_seen
}

#[test]
fn contacts_are_those_of_all_distances_at_many_instants() {
    let mut rng = fastrand::Rng::with_seed(15);
    let mut contacts = 0;
    // Some linkages have no closed form.
    for manipulator in examples::EXAMPLES.iter().filter_map(|e| Manipulator::example(e.name).ok()) {
        let motion = wandering(&manipulator, &mut rng);
        for rate in [25.0, 100.0] {
            contacts += check_contacts(&manipulator, &motion, rate);
        }
    }
    assert!(contacts > 40, "{contacts}");
}
