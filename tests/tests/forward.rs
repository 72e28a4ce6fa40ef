//! Forward kinematics: the joint values that inverse kinematics gives for a pose lead back to it,
//! every assembly that is found is valid, none is missing, and if there is none, the answer says
//! why.

mod closure;
mod edges;
mod least;
mod near;
mod pairs;
mod without_motor;

use closure::Closure;
use fastrand::Rng;
use opm_core::decomposition::mobility::frame;
use opm_core::forward::{Assembly, RESIDUAL};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::family::plano_spherical::Home;
use opm_core::mechanism::joint::{JointKind, Quantity};
use opm_core::mechanism::{Mechanism, examples, file};
use opm_tests::displacement;
use opm_tests::paper::fewer_joints;
use opm_tests::paper::{PlanoSpherical, Signs};
use std::f64::consts::TAU;

/// Two poses are equal if they differ by less than this in rotation and translation, radians and
/// metres. It is far above the rounding of a regular pose and far below the distance of two
/// assemblies.
const SAME: f64 = 1e-7;

/// Tolerance for a joint value that inverse kinematics gives back. Some of 10⁵ assemblies are so
/// near a singularity that they lose half of the digits.
const BACK: f64 = 1e-6;

fn example(name: &str) -> Manipulator {
    let text = examples::find(name).unwrap().text;
    Manipulator::new(unlimited(file::read(text).unwrap().mechanism)).unwrap()
}

fn unlimited(mut mechanism: Mechanism) -> Mechanism {
    let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    joints.flat_map(|joint| &mut joint.coordinates).for_each(|c| c.limits = None);
    mechanism
}

/// A pose within reach, a mode in which it is reached, and its actuated joints.
struct Reached {
    pose: Vec<f64>,
    mode: Mode,
    actuated: Vec<f64>,
}

impl Reached {
    fn at(m: &Manipulator, pose: Vec<f64>, mode: Mode) -> Option<Self> {
        let mut solution = m.solution();
        m.inverse(&pose, mode, &mut solution).unwrap()?;
        let actuated = m.actuated().iter().map(|&i| solution.joints()[i]).collect();
        Some(Self { pose, mode, actuated })
    }

    /// A random pose within `reach` of home, radians and metres, in a random mode.
    fn random(rng: &mut Rng, m: &Manipulator, reach: [f64; 2]) -> Self {
        let mut all = m.all_modes();
        loop {
            let pose: Vec<f64> = (m.task_coordinates().iter())
                .map(|c| {
                    let reach = if c.quantity == Quantity::Length { reach[1] } else { reach[0] };
                    c.home + reach * (2.0 * rng.f64() - 1.0)
                })
                .collect();
            if m.inverse_all(&pose, &mut all).unwrap().is_some() {
                let modes: Vec<Mode> = all.modes(m).collect();
                return Self::at(m, pose, modes[rng.usize(..modes.len())]).unwrap();
            }
        }
    }

    fn is_in(&self, m: &Manipulator, list: &[Assembly]) -> bool {
        let same = |a: &Assembly| apart(m, self.mode, [&a.pose, &self.pose]) < SAME;
        list.iter().any(|a| a.mode == self.mode && same(a))
    }
}

fn apart(m: &Manipulator, mode: Mode, poses: [&[f64]; 2]) -> f64 {
    let [a, b] = poses.map(|pose| displacement(m, pose, mode));
    let p = m.mechanism().platform;
    a.rotation.angle_to(&b.rotation) + (a * p - b * p).norm()
}

/// The distance of two joint values: modulo 2π, except for screws and rotation vectors.
fn off(m: &Manipulator, coordinate: usize, a: f64, b: f64) -> f64 {
    let mut joints = m.mechanism().joints().flat_map(|j| j.coordinates.iter().map(move |_| j.kind));
    let turns = matches!(
        joints.nth(coordinate),
        Some(JointKind::Revolute | JointKind::Universal { .. } | JointKind::Cylindrical)
    );
    let off = a - b;
    match m.coordinates()[coordinate].quantity {
        Quantity::Angle if turns => (off - TAU * (off / TAU).round()).abs(),
        Quantity::Angle | Quantity::Length => off.abs(),
    }
}

/// The residual that rounding may leave where the joints are tens of sizes away from the origin.
fn rounding(m: &Manipulator) -> f64 {
    let points = m.mechanism().joints().map(|joint| joint.point);
    let distances = points.chain([m.mechanism().platform]).map(|point| point.coords.norm());
    300.0 * f64::EPSILON * distances.fold(0.0, f64::max) / frame(m.mechanism()).length
}

/// Checks what an assembly claims: its legs close with the joint values that were given, and
/// inverse kinematics in its mode gives these values back.
fn check(m: &Manipulator, actuated: &[f64], a: &Assembly) {
    assert!(a.residual <= RESIDUAL.max(rounding(m)), "{a:?}");
    let target = displacement(m, &a.pose, a.mode);
    let mut joints = &a.joints[..];
    for leg in &m.mechanism().legs {
        let (own, rest) = joints.split_at(leg.coordinates().count());
        joints = rest;
        let end = leg.displacement(own).unwrap();
        let way = (end * m.mechanism().platform - target * m.mechanism().platform).norm();
        // The angle is found by a square root, so it has half of the digits. Lengths here are below
        // ten.
        assert!(
            end.rotation.angle_to(&target.rotation) < 1e-7 && way < 1e-11,
            "{} {way:e}",
            leg.name
        );
    }
    let mut solution = m.solution();
    assert!(m.inverse(&a.pose, a.mode, &mut solution).unwrap().is_some());
    for (&i, &given) in m.actuated().iter().zip(actuated) {
        let name = &m.coordinates()[i].name;
        assert!(off(m, i, a.joints[i], given) < 1e-12, "{name} {} {given}", a.joints[i]);
        assert!(off(m, i, solution.joints()[i], given) < BACK, "{name} {}", solution.joints()[i]);
    }
}

/// Checks that all are assemblies, and that no two are equal.
fn check_all(m: &Manipulator, actuated: &[f64], list: &[Assembly]) {
    for (number, a) in list.iter().enumerate() {
        check(m, actuated, a);
        for other in &list[..number] {
            let same = other.mode == a.mode && apart(m, a.mode, [&other.pose, &a.pose]) < 1e-9;
            assert!(!same, "twice: {a:?}");
        }
    }
}

/// The paper's manipulator, as printed and with random geometry: ten thousand poses in random
/// modes.
#[test]
fn joints_of_a_pose_lead_back_to_it() {
    let mut rng = Rng::with_seed(1);
    let printed = example("plano-spherical-5dof");
    let (mut poses, mut most, mut assemblies, mut worst) = (0, 0, 0, 0.0_f64);
    let mut run = |rng: &mut Rng, m: &Manipulator, count: usize| {
        assert_eq!(m.forward_closed_form(), Ok(()));
        for _ in 0..count {
            let reached = Reached::random(rng, m, [1.2, 0.15]);
            let found = m.forward(&reached.actuated).unwrap();
            assert!(found.loose.is_empty(), "{:?}", reached.pose);
            let pose = || format!("{:?} {}", reached.pose, m.format_mode(reached.mode));
            assert!(reached.is_in(m, &found.list), "{}: {:?}", pose(), found.list.len());
            check_all(m, &reached.actuated, &found.list);
            poses += 1;
            assemblies += found.list.len();
            most = most.max(found.list.len());
            worst = found.list.iter().map(|a| a.residual).fold(worst, f64::max);
        }
    };
    run(&mut rng, &printed, 4_000);
    for _ in 0..3_000 {
        let family =
            PlanoSpherical::random(&mut rng).family(Home::default(), &Signs::random(&mut rng));
        let Ok(mechanism) = family.assemble() else { continue };
        // A few of these homes are singular.
        let Ok(m) = Manipulator::new(unlimited(mechanism)) else { continue };
        run(&mut rng, &m, 5);
    }
    println!("{poses} poses, {assemblies} assemblies, at most {most}, residuals up to {worst:.1e}");
    assert!(poses >= 10_000, "{poses}");
    assert!(most <= 64, "{most}: more than 8 rotations for 8 sets of imaginary joints");
}

/// A buffer that was used for other joints, in reach or not, gives the same assemblies.
#[test]
fn buffers_are_used_again() {
    let mut rng = Rng::with_seed(12);
    let planes = ["planar-3rrr", "five-bar", "schoenflies-4dof", "schoenflies-lift-4dof"];
    let others = ["plano-spherical-5dof", "double-spherical-5dof", "agile-eye", "orbita"];
    for name in planes.into_iter().chain(others) {
        let m = example(name);
        let mut buffer = m.forward_buffer();
        let (mut found, mut none) = (0, 0);
        for round in 0..100 {
            let mut actuated = Reached::random(&mut rng, &m, [0.7, 0.1]).actuated;
            if round % 4 == 3 {
                actuated.iter_mut().for_each(|joint| *joint += 4.0 * (rng.f64() - 0.5));
            }
            let alone = m.forward(&actuated).unwrap();
            assert_eq!(m.forward_into(&actuated, &mut buffer).unwrap(), &alone, "{name}");
            found += usize::from(!alone.list.is_empty());
            none += usize::from(alone.list.is_empty());
        }
        println!("{name}: {found} assembled, {none} not");
        assert!(found >= 75, "{name}");
    }
}

/// Every shipped mechanism that has closed-form forward kinematics.
#[test]
fn shipped_mechanisms_are_solved() {
    let mut rng = Rng::with_seed(2);
    let mut closed = Vec::new();
    for shipped in examples::SPLIT {
        let mechanism = unlimited(file::read(shipped.text).unwrap().mechanism);
        let Ok(m) = Manipulator::new(mechanism) else { continue };
        if m.forward_closed_form().is_err() {
            continue;
        }
        closed.push(shipped.name);
        let pitch = if shipped.name == "schoenflies-4dof" { Some(0.01) } else { None };
        let mut singular = 0;
        for _ in 0..500 {
            let mut reached = Reached::random(&mut rng, &m, [0.7, 0.1]);
            if let Some(pitch) = pitch {
                // Its height depends on full revolutions, which the nut does not show: here within
                // π.
                let mut pose = reached.pose.clone();
                pose[3] = m.home_pose()[3] + pitch * (TAU * rng.f64() - TAU / 2.0);
                reached = Reached::at(&m, pose, reached.mode).unwrap();
            }
            let found = m.forward(&reached.actuated).unwrap();
            check_all(&m, &reached.actuated, &found.list);
            // Two rods of the planar-planar manipulator carry one hinge: side by side they act as
            // one.
            if found.loose.is_empty() {
                let pose = || format!("{:?} {}", reached.pose, m.format_mode(reached.mode));
                assert!(reached.is_in(&m, &found.list), "{} {}", shipped.name, pose());
            } else {
                assert!(shipped.name.starts_with("planar-planar"), "{}", shipped.name);
                singular += 1;
            }
        }
        assert!(singular < 400, "{} {singular}", shipped.name);
    }
    let open: Vec<_> =
        examples::SPLIT.iter().map(|e| e.name).filter(|n| !closed.contains(n)).collect();
    let linkages = ["bennett-double-spherical-6r", "bennett-plano-spherical-6r"];
    assert_eq!(open, [&linkages[..], &["translational-planar-4dof"]].concat());
}

/// There are as many assemblies as a numeric solver finds that uses no sections: damped least
/// squares on the legs' products of exponentials, from thousands of random starts.
#[test]
fn none_is_missing() {
    let mut rng = Rng::with_seed(3);
    let shipped = [
        ("plano-spherical-5dof", 3_000, 3),
        ("double-spherical-5dof", 4_000, 1),
        ("planar-planar-5dof", 2_000, 2),
        ("plano-cylindrical-4dof", 600, 3),
        ("schoenflies-4dof", 300, 3),
    ];
    for (name, starts, sets) in shipped {
        none_is_missing_of(&mut rng, name, &example(name), [starts, sets]);
    }
    // Legs with too few freedoms.
    none_is_missing_of(&mut rng, "five-bar", &example("five-bar"), [300, 3]);
    for (name, text) in fewer_joints() {
        let m = Manipulator::new(unlimited(file::read(&text).unwrap().mechanism)).unwrap();
        none_is_missing_of(&mut rng, name, &m, [2_000, 1]);
    }
}

fn none_is_missing_of(rng: &mut Rng, name: &str, m: &Manipulator, [starts, sets]: [usize; 2]) {
    for _ in 0..sets {
        let (reached, found) = loop {
            let reached = Reached::random(rng, m, [0.5, 0.08]);
            let found = m.forward(&reached.actuated).unwrap();
            if found.loose.is_empty() {
                // Whole turns of a screw are other assemblies.
                let screws = name.starts_with("schoenflies");
                assert!(screws || reached.is_in(m, &found.list), "{name} {:?}", reached.pose);
                break (reached, found);
            }
        };
        let closure = Closure::new(m.mechanism(), &reached.actuated);
        let numeric = closure.solutions(rng, starts);
        // Screws that are full revolutions apart are equal here.
        let known = |joints: &Vec<f64>| found.list.iter().any(|a| closure.same(joints, &a.joints));
        for joints in &numeric {
            assert!(known(joints), "{name} {:?}: missing {joints:?}", reached.actuated);
        }
        println!("{name}: {} assemblies, {} by least squares", found.list.len(), numeric.len());
        assert_eq!(numeric.len(), found.list.len(), "{name} {:?}", reached.actuated);
    }
}
