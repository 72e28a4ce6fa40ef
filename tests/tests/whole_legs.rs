//! Mechanisms whose legs are solved whole, against plain geometry, products of exponentials and differences.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use opm_core::Manipulator;
use opm_core::decomposition::{DecomposeError, PlatformSet, WholeMiss, decompose};
use opm_core::enclosure::{BoxQuery, Side};
use opm_core::forward::{ForwardError, NoClosedForm};
use opm_core::manipulator::Solution;
use opm_core::mechanism::Cone;
use opm_core::mechanism::examples::{EXAMPLES, Example, SPLIT, find};
use opm_core::mechanism::file;
use opm_core::mechanism::joint::JointKind;
use opm_tests::by_inverse::by_inverse;
use opm_tests::displacement;
use opm_workspace::measure::{CoordinateRange, Domain, DomainError, Goal, measure};
use opm_workspace::{Axis, Grid, GridError, Modes, Progress, Sections, Sweep};

/// The shipped mechanisms whose legs are solved whole.
fn shipped() -> impl Iterator<Item = &'static Example> {
    EXAMPLES.iter().skip(SPLIT.len())
}

fn example(name: &str) -> Manipulator {
    Manipulator::example(name).unwrap()
}

/// A pose near home: lengths within a share of the size, angles within that many radians.
fn near(manipulator: &Manipulator, share: f64, rng: &mut Rng) -> Vec<f64> {
    let size = manipulator.characteristic_length();
    let coordinates = manipulator.task_coordinates().iter();
    coordinates
        .map(|c| {
            let unit = if c.quantity == opm_core::Quantity::Length { size } else { 1.0 };
            c.home + share * unit * (2.0 * rng.f64() - 1.0)
        })
        .collect()
}

/// The platform's displacement by each leg's joints, one after the other, as nalgebra has them.
fn by_exponentials(manipulator: &Manipulator, joints: &[f64]) -> Vec<Isometry3<f64>> {
    let mut values = joints.iter();
    let legs = manipulator.mechanism().legs.iter();
    legs.map(|leg| {
        leg.joints.iter().fold(Isometry3::identity(), |g, joint| {
            let mut next = |i: usize| values.next().unwrap() - joint.coordinates[i].home;
            let about = |turn: UnitQuaternion<f64>, point: Point3<f64>| {
                let place = point.coords;
                Isometry3::from_parts(Translation3::from(place - turned(&turn, place)), turn)
            };
            let turn = |axis: nalgebra::Unit<Vector3<f64>>, q: f64| {
                about(UnitQuaternion::from_axis_angle(&axis, q), joint.point)
            };
            let slide = |q: f64| {
                let along = joint.axis.into_inner() * q;
                Isometry3::from_parts(Translation3::from(along), UnitQuaternion::identity())
            };
            let own = match joint.kind {
                JointKind::Revolute => turn(joint.axis, next(0)),
                JointKind::Prismatic => slide(next(0)),
                JointKind::Helical { pitch } => {
                    let q = next(0);
                    turn(joint.axis, q) * slide(pitch * q)
                }
                JointKind::Cylindrical => turn(joint.axis, next(0)) * slide(next(1)),
                JointKind::Universal { second } => {
                    turn(joint.axis, next(0)) * turn(second, next(1))
                }
                JointKind::Spherical => {
                    let vector = Vector3::new(next(0), next(1), next(2));
                    about(UnitQuaternion::from_scaled_axis(vector), joint.point)
                }
            };
            g * own
        })
    })
    .collect()
}

fn turned(turn: &UnitQuaternion<f64>, vector: Vector3<f64>) -> Vector3<f64> {
    turn * vector
}

/// Every leg of every mode that reaches a pose ends where the platform is, and modes differ.
#[test]
fn legs_end_where_the_platform_is() {
    let mut rng = Rng::with_seed(1);
    for Example { name, .. } in shipped() {
        let m = example(name);
        assert!(m.is_whole(), "{name}");
        let (mut every, mut at) = (m.all_modes(), m.solution());
        let (mut poses, mut solutions) = (0, 0);
        for trial in 0..60 {
            let share = [0.05, 0.2, 0.5][trial % 3];
            let pose = near(&m, share, &mut rng);
            let Some(found) = m.inverse_all(&pose, &mut every).unwrap() else { continue };
            poses += 1;
            let modes: Vec<_> = found.modes(&m).take(64).collect();
            for mode in modes {
                let joints = m.solution_in_mode(&every, mode, &mut at).unwrap().joints();
                solutions += 1;
                let target = displacement(&m, &pose, mode);
                for end in by_exponentials(&m, joints) {
                    let off =
                        (end * m.mechanism().platform - target * m.mechanism().platform).norm();
                    let turn = end.rotation.angle_to(&target.rotation);
                    let size = m.characteristic_length();
                    assert!(off < 1e-9 * size && turn < 1e-8, "{name} {pose:?}: {off} {turn}");
                }
            }
        }
        assert!(poses >= 30 && solutions > poses, "{name}: {poses} poses, {solutions} solutions");
    }
}

/// Home is home: in the mode at home, every joint has its value there.
#[test]
fn home_is_home() {
    for Example { name, .. } in shipped() {
        let m = example(name);
        let mut at = m.solution();
        let solution = m.inverse(&m.home_pose(), m.home_mode(), &mut at).unwrap().unwrap();
        for (value, c) in solution.joints().iter().zip(m.coordinates()) {
            assert!((value - c.home).abs() < 1e-7, "{name} {}: {value} {}", c.name, c.home);
        }
    }
}

/// The table of R. L. Williams II, "The Delta Parallel Robot: Kinematics Solutions", of ABB's IRB 360-1/1600.
#[test]
fn the_delta_of_williams() {
    let m = example("delta");
    assert_eq!(m.decomposition().platform(), PlatformSet::Subgroup);
    let (mode, mut buffer) = (m.home_mode(), m.actuated_joints());
    for (pose, expected) in
        [([0.0, 0.0, -0.9], [-20.5, -20.5, -20.5]), ([0.3, 0.5, -1.1], [47.5, -11.6, 21.4])]
    {
        let found = m.inverse_actuated(&pose, mode, &mut buffer).unwrap().unwrap();
        for (value, expected) in found.actuated().iter().zip(expected) {
            assert!((value.to_degrees() - expected).abs() < 0.051, "{pose:?}: {value}");
        }
    }
    // The other root of the first one, too: elbows inside.
    let inside = m.parse_mode("-- -- --").unwrap();
    let all: Vec<_> = m.modes().collect();
    assert!(all.contains(&inside));
}

/// The lengths of a hexapod's legs are the distances of its joints.
#[test]
fn the_lengths_of_a_hexapod() {
    let m = example("stewart");
    assert_eq!(m.decomposition().platform(), PlatformSet::Free);
    let names: Vec<_> = m.task_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["x", "y", "z", "roll", "pitch", "yaw"]);
    let (mut rng, mut buffer) = (Rng::with_seed(2), m.actuated_joints());
    for _ in 0..200 {
        let mut pose = near(&m, 0.5, &mut rng);
        pose[2] += 0.1;
        let at = Translation3::new(pose[0], pose[1], pose[2]);
        let turn = Rotation3::from_euler_angles(pose[3], pose[4], pose[5]);
        let found = m.inverse_actuated(&pose, m.home_mode(), &mut buffer).unwrap().unwrap();
        for (leg, length) in m.mechanism().legs.iter().zip(found.actuated()) {
            let [base, top] = [leg.joints[0].point, leg.joints[2].point];
            let moved = at * (turn * Point3::from(top - m.mechanism().platform));
            assert!((length - (moved - base).norm()).abs() < 1e-12, "{pose:?}");
        }
    }
}

/// Each slider of a Tripteron moves the platform along its own axis alone.
#[test]
fn the_sliders_of_a_tripteron() {
    let m = example("tripteron");
    let mut buffer = m.actuated_joints();
    let pose = [0.05, -0.03, 0.02];
    let found = m.inverse_actuated(&pose, m.home_mode(), &mut buffer).unwrap().unwrap();
    for (value, expected) in found.actuated().iter().zip(pose) {
        assert!((value - expected).abs() < 1e-14);
    }
}

/// A count of poses is that of plain geometry: a crank's circle meets a rod's sphere, an arm is long enough.
#[test]
fn counts_are_those_of_plain_geometry() {
    let m = example("delta");
    let axis = |name: &str, from: f64, to: f64| Axis::new(name, from, to, 17);
    let axes = [axis("x", -1.2, 1.2), axis("y", -1.1, 1.3), axis("z", -1.7, 0.3)];
    let grid = Grid::new(&m, axes.into()).unwrap();
    let found = Sweep::new(&m, &grid, Modes::Any).count(&Progress::default()).unwrap();
    let mut expected = 0;
    for number in 0..grid.poses() {
        let pose = grid.pose(number);
        let reached = m.mechanism().legs.iter().all(|leg| {
            let [motor, elbow, top] = [0, 1, 2].map(|i| leg.joints[i].point);
            let axis = leg.joints[0].axis.into_inner();
            let at = top + Vector3::new(pose[0], pose[1], pose[2]) - m.mechanism().platform.coords;
            let (crank, rod) = ((elbow - motor).norm(), (top - elbow).norm());
            let from = at - motor;
            let (across, along) = (from - axis * axis.dot(&from), axis.dot(&from));
            let reach = (rod * rod - along * along).sqrt();
            let d = across.norm();
            d <= crank + reach && d >= (crank - reach).abs()
        });
        expected += u64::from(reached);
    }
    assert_eq!(found.reachable, expected);
    assert!(expected > 100 && expected < grid.poses());
}

/// Jacobians, rates and accelerations are those of differences.
#[test]
fn rates_are_those_of_differences() {
    let mut rng = Rng::with_seed(3);
    for Example { name, .. } in shipped() {
        let m = example(name);
        let (mut at, mut other, mut jacobians) = (m.solution(), m.solution(), m.jacobians());
        let (mut motion, mut singular) = (m.joint_motion(), m.singularities());
        let mut tried = 0;
        for _ in 0..12 {
            let pose = near(&m, 0.2, &mut rng);
            if m.inverse(&pose, m.home_mode(), &mut at).unwrap().is_none() {
                continue;
            }
            if !m.differentiate(&at, &mut jacobians).unwrap() {
                continue;
            }
            m.measure_singularities(&jacobians, &mut singular);
            if singular.legs.iter().any(|[measure, _]| measure.abs() < 1e-2) {
                continue;
            }
            tried += 1;
            let rates: Vec<f64> = pose.iter().map(|_| rng.f64() - 0.5).collect();
            let second: Vec<f64> = pose.iter().map(|_| rng.f64() - 0.5).collect();
            let by_pose = jacobians.joints_by_pose() * nalgebra::DVector::from_vec(rates.clone());
            assert!(m.velocity(&at, &rates, &second, &mut motion).unwrap(), "{name}");
            let step = 1e-4;
            let mut joints = |t: f64| {
                let moved: Vec<f64> = (0..pose.len())
                    .map(|i| pose[i] + t * rates[i] + 0.5 * t * t * second[i])
                    .collect();
                other.clone_from(&at);
                m.inverse_near(&moved, m.home_mode(), &mut other)
                    .unwrap()
                    .unwrap()
                    .joints()
                    .to_vec()
            };
            let (before, here, after) = (joints(-step), joints(0.0), joints(step));
            for i in 0..here.len() {
                let rate = (after[i] - before[i]) / (2.0 * step);
                let acceleration = (after[i] - 2.0 * here[i] + before[i]) / (step * step);
                let c = &m.coordinates()[i].name;
                let scale = 1.0 + rate.abs();
                assert!((motion.joint_rates[i] - by_pose[i]).abs() < 1e-9 * scale, "{name} {c}");
                assert!(
                    (by_pose[i] - rate).abs() < 1e-5 * scale * scale,
                    "{name} {c}: {rate} {}",
                    by_pose[i]
                );
                let found = motion.joint_accelerations[i];
                assert!(
                    (found - acceleration).abs() < 1e-3 * (1.0 + acceleration.abs() + rate * rate),
                    "{name} {c}: {acceleration} {found}"
                );
            }
        }
        assert!(tried >= 4, "{name}: {tried}");
    }
}

/// Newton's method finds the pose that the motors were computed from.
#[test]
fn forward_kinematics_near_a_pose() {
    let mut rng = Rng::with_seed(4);
    for Example { name, .. } in shipped() {
        let m = example(name);
        let mut at = m.solution();
        let mut found = 0;
        for _ in 0..20 {
            let pose = near(&m, 0.05, &mut rng);
            let Some(solution) = m.inverse(&pose, m.home_mode(), &mut at).unwrap() else {
                continue;
            };
            let actuated: Vec<f64> = m.actuated().iter().map(|&i| solution.joints()[i]).collect();
            let Ok(assembly) = m.forward_near(&actuated, &m.home_pose(), m.home_mode()) else {
                continue;
            };
            found +=
                usize::from(assembly.pose.iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-9));
            assert!(assembly.residual < 1e-9, "{name}: {}", assembly.residual);
        }
        assert!(found >= 18, "{name}: {found} of 20");
    }
}

/// Rods that are more level hold less of what is upright: the parallel measure of a Delta falls as it rises.
#[test]
fn a_delta_with_rods_that_are_nearly_level() {
    let m = example("delta");
    let (mut at, mut jacobians, mut measured) = (m.solution(), m.jacobians(), m.singularities());
    let mut parallel = |z: f64| {
        m.inverse(&[0.0, 0.0, z], m.home_mode(), &mut at).unwrap().unwrap();
        m.differentiate(&at, &mut jacobians).unwrap();
        m.measure_singularities(&jacobians, &mut measured);
        measured.whole.parallel.unwrap().abs()
    };
    let found = [-1.06, -0.9, -0.8].map(&mut parallel);
    assert!(found[0] > 0.05 && found.is_sorted_by(|a, b| a > b), "{found:?}");
}

/// A mechanism whose motors go a little way.
fn with_limits(text: &str) -> Manipulator {
    let mut mechanism = file::read(text).unwrap().mechanism;
    let size = Manipulator::read(text).unwrap().characteristic_length();
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        let slides = joint.kind == JointKind::Prismatic;
        for c in joint.coordinates.iter_mut().filter(|_| joint.actuated) {
            let far = if slides { 0.2 * size } else { 0.3 };
            c.limits = Some([c.home - far, c.home + far]);
        }
    }
    Manipulator::new(mechanism).unwrap()
}

/// Sweeps, which do not compute joints, decide as inverse kinematics do, at round poses and with limits too.
#[test]
fn sweeps_decide_as_inverse_kinematics_do() {
    for Example { name, text, .. } in shipped() {
        let size = example(name).characteristic_length();
        for m in [example(name), with_limits(text)] {
            let axes = m.task_coordinates().iter().enumerate().map(|(i, c)| {
                let (far, count) = match c.quantity {
                    opm_core::Quantity::Length => (0.5 * size, 5),
                    opm_core::Quantity::Angle => (0.5, 3),
                };
                Axis::new(c.name, c.home - far, c.home + far, if i < 3 { count } else { 3 })
            });
            let grid = Grid::new(&m, axes.collect()).unwrap();
            for modes in [Modes::Any, Modes::One(m.home_mode())] {
                let found = Sweep::new(&m, &grid, modes).count(&Progress::default()).unwrap();
                let expected = match modes {
                    Modes::One(_) => by_inverse(&m, &grid, modes).1.reachable,
                    // Too many modes to list.
                    Modes::Any => {
                        let mut all = m.all_modes();
                        let mut within = |number| {
                            let found = m.inverse_all(&grid.pose(number), &mut all).unwrap();
                            found.is_some_and(|all| all.within_limits_in_any(&m, |_, _| {}))
                        };
                        (0..grid.poses()).filter(|&number| within(number)).count() as u64
                    }
                };
                assert_eq!(found.reachable, expected, "{name} {modes:?}");
            }
        }
    }
}

/// A joint that is moved after the mechanism was decomposed counts where it is.
#[test]
fn a_changed_joint_counts_where_it_is() {
    let text = find("stewart").unwrap().text;
    let mut mechanism = file::read(text).unwrap().mechanism;
    let before = decompose(&mechanism).unwrap().remove(0);
    mechanism.legs[2].joints[0].point.x += 0.01;
    let changed = Manipulator::with_decomposition(mechanism.clone(), before).unwrap();
    let leg = &mechanism.legs[2];
    let mut buffer = changed.actuated_joints();
    let home = changed.home_pose();
    let found = changed.inverse_actuated(&home, changed.home_mode(), &mut buffer).unwrap();
    let c = &leg.joints[1].coordinates[0];
    // Its foot is not in line with its slider any more, so that only the distance tells the slide.
    let [foot, head] = [leg.joints[0].point, leg.joints[2].point];
    let at = |slide: f64| (head + leg.joints[1].axis.into_inner() * (slide - c.home) - foot).norm();
    let length = (head - foot).norm();
    assert!((at(found.unwrap().actuated()[2]) - length).abs() < 1e-12);
}

/// Axes in single precision contain no translations of space: that is said, and not found out far from home.
#[test]
fn joints_that_nearly_contain_a_subgroup_are_refused() {
    let text = find("delta").unwrap().text;
    let mut mechanism = file::read(text).unwrap().mechanism;
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        joint.axis = nalgebra::Unit::new_normalize(joint.axis.map(|c| f64::from((0.7 * c) as f32)));
    }
    let refused = decompose(&mechanism).unwrap_err();
    let DecomposeError::NoPartialSubspaces { whole: Some(whole), .. } = &refused else {
        panic!("{refused}")
    };
    let WholeMiss::Inexact { deviation, .. } = **whole else { panic!("{whole}") };
    assert!(deviation > 1e-10 && deviation < 1e-6 && refused.to_string().contains("twelve digits"));
}

/// A box that is all in reach has only poses that are, and one that is out of reach has none.
#[test]
fn boxes_tell_of_their_poses() {
    let mut rng = Rng::with_seed(6);
    let (mut inside, mut outside) = (0, 0);
    for Example { name, text, .. } in shipped() {
        let plain = example(name);
        if !plain.has_enclosures() {
            assert!(!plain.dependent_coordinates().is_empty(), "{name}");
            continue;
        }
        for m in [plain, with_limits(text)] {
            let size = m.characteristic_length();
            let all: Vec<_> = m.modes().take(8).collect();
            let mut solution = m.solution();
            for number in 0..400 {
                let far = [0.1, 0.5, 1.5][number % 3];
                let half = [1e-4, 1e-2, 0.05][number / 3 % 3];
                let middle = near(&m, far, &mut rng);
                let widths = m.task_coordinates().iter().zip(&middle).map(|(c, &middle)| {
                    let unit = if c.quantity == opm_core::Quantity::Length { size } else { 1.0 };
                    let half = if rng.f64() < 0.6 { half * unit } else { 0.0 };
                    Side { middle, half, half_turn: None }
                });
                let sides: Vec<Side> = widths.collect();
                let mode = (number % 2 == 0).then(|| all[number / 2 % all.len()]);
                let verdict = m.enclose(BoxQuery::Whole, mode, &sides);
                if verdict.lower < 1.0 && verdict.upper > 0.0 {
                    continue;
                }
                for _ in 0..5 {
                    let at = |side: &Side| side.middle + side.half * (2.0 * rng.f64() - 1.0);
                    let pose: Vec<f64> = sides.iter().map(at).collect();
                    let within = match mode {
                        Some(mode) => {
                            let found = m.inverse(&pose, mode, &mut solution).unwrap();
                            found.is_some_and(Solution::within_limits)
                        }
                        None => {
                            let mut every = m.all_modes();
                            let found = m.inverse_all(&pose, &mut every).unwrap();
                            found.is_some_and(|all| all.within_limits_in_any(&m, |_, _| {}))
                        }
                    };
                    assert_eq!(within, verdict.lower >= 1.0, "{name} {pose:?} {verdict:?}");
                    *(if within { &mut inside } else { &mut outside }) += 1;
                }
            }
        }
    }
    assert!(inside > 500 && outside > 500, "{inside} {outside}");
}

/// A hexapod goes up and down as far as the shells about its feet let it: the measure of that is a length.
#[test]
fn the_height_of_a_hexapod_is_a_length() {
    let text = find("stewart").unwrap().text;
    let m = with_limits(text);
    let over = [CoordinateRange::new("z", -0.2, 0.9)];
    let domain = Domain::new(&m, Sections::Whole, &over).unwrap();
    let goal = Goal { tolerance: 1e-9, budget: 20_000 };
    let modes = Modes::One(m.home_mode());
    let found = measure(&m, &domain, modes, &goal, &Progress::default());
    // Each leg allows two intervals of heights; those above its foot.
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    let home = m.home_pose()[2];
    for leg in &m.mechanism().legs {
        let [base, top] = [leg.joints[0].point, leg.joints[2].point];
        let span = top - base;
        let [low, high] = leg.joints[1].coordinates[0].limits.unwrap();
        let height = |length: f64| {
            let level = span.x.hypot(span.y);
            home - span.z + (length * length - level * level).max(0.0).sqrt()
        };
        (from, to) = (height(low).max(from), height(high).min(to));
    }
    let length = to - from;
    assert!(length > 0.05 && found.lower <= length && length <= found.upper, "{length} {found:?}");
    assert!(found.upper - found.lower < 1e-6, "{found:?}");
}

/// Bounds of measures hold what is counted.
#[test]
fn measures_hold_what_is_counted() {
    let mut rng = Rng::with_seed(8);
    for (name, far, budget) in
        [("delta", 0.8, 40_000), ("tripteron", 0.5, 20_000), ("3-upu", 0.5, 20_000)]
    {
        for m in [example(name), with_limits(find(name).unwrap().text)] {
            let size = m.characteristic_length();
            let over = m.task_coordinates().iter();
            let over = over
                .map(|c| CoordinateRange::new(c.name, c.home - far * size, c.home + far * size));
            let domain = Domain::new(&m, Sections::Whole, &over.collect::<Vec<_>>()).unwrap();
            let goal = Goal { tolerance: 0.01, budget };
            let modes = Modes::One(m.home_mode());
            let bounds = measure(&m, &domain, modes, &goal, &Progress::default());
            let (mut hits, samples) = (0, 20_000);
            let mut solution = m.solution();
            for _ in 0..samples {
                let pose = domain.pose(&[rng.f64(), rng.f64(), rng.f64()]).unwrap();
                let found = m.inverse(&pose, m.home_mode(), &mut solution).unwrap();
                hits += u32::from(found.is_some_and(Solution::within_limits));
            }
            let sampled = bounds.whole * f64::from(hits) / f64::from(samples);
            // Four standard deviations of a count.
            let slack = 2.0 * bounds.whole / f64::from(samples).sqrt();
            assert!(hits > 0 && bounds.lower > 0.0, "{name}: {bounds:?} {hits}");
            let held = bounds.lower - slack < sampled && sampled < bounds.upper + slack;
            assert!(held, "{name}: {bounds:?} {sampled}");
            assert!(bounds.upper - bounds.lower < 0.15 * bounds.whole, "{name}: {bounds:?}");
        }
    }
}

/// A hexapod whose universal and spherical joints tilt no further than these angles.
fn with_cones(base: Cone, top: Cone) -> Manipulator {
    let mut mechanism = file::read(find("stewart").unwrap().text).unwrap().mechanism;
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        joint.cone = match joint.kind {
            JointKind::Universal { .. } => Some(base),
            JointKind::Spherical => Some(top),
            _ => None,
        };
    }
    Manipulator::new(mechanism).unwrap()
}

/// The rod of a hexapod's leg is the line between its joints: it stays in a cone of the base, and in one of the platform.
#[test]
fn rods_stay_in_their_cones() {
    let upright = Unit::new_normalize(Vector3::new(0.1, 0.0, 1.0));
    let about_home = |half_angle| Cone { half_angle, axis: None };
    let others = (Cone { half_angle: 0.4, axis: Some(upright) }, about_home(0.3));
    for (base, top) in [(about_home(0.2), about_home(0.35)), others] {
        let m = with_cones(base, top);
        assert!(m.has_cones() && !m.has_enclosures());
        let axis = |name: &str, far: f64, count| Axis::new(name, -far, far, count);
        let axes = [axis("x", 0.25, 9), axis("roll", 0.5, 7), axis("yaw", 0.6, 7)];
        let grid = Grid::new(&m, axes.into()).unwrap();
        let mut expected = 0;
        let (mut solution, mut motors) = (m.solution(), m.actuated_joints());
        for number in 0..grid.poses() {
            let pose = grid.pose(number);
            let turn = Rotation3::from_euler_angles(pose[3], pose[4], pose[5]);
            let reached = m.mechanism().legs.iter().all(|leg| {
                let [foot, head] = [leg.joints[0].point, leg.joints[2].point];
                let [low, high] = leg.joints[1].coordinates[0].limits.unwrap();
                let from = Vector3::new(pose[0], pose[1], pose[2]);
                let moved = Point3::from(from + turn * (head - m.mechanism().platform));
                let (rod, home) = (moved - foot, head - foot);
                let tilt = rod.angle(&base.axis.map_or(home, Unit::into_inner));
                let below = (-rod).angle(&(turn * -home));
                (low..=high).contains(&rod.norm())
                    && tilt <= base.half_angle
                    && below <= top.half_angle
            });
            let found = m.inverse(&pose, m.home_mode(), &mut solution).unwrap().unwrap();
            assert_eq!(found.within_limits(), reached, "{pose:?}");
            let beyond = m.beyond_limits(found).count();
            assert_eq!(beyond == 0, reached, "{pose:?}");
            let found = m.inverse_actuated(&pose, m.home_mode(), &mut motors).unwrap().unwrap();
            assert_eq!(found.within_limits(), reached, "{pose:?}");
            expected += u64::from(reached);
        }
        assert!(expected > 20 && expected < grid.poses() - 20, "{expected}");
        for modes in [Modes::One(m.home_mode()), Modes::Any] {
            let found = Sweep::new(&m, &grid, modes).count(&Progress::default()).unwrap();
            assert_eq!(found.reachable, expected, "{modes:?}");
        }
        let told = Domain::new(&m, Sections::Whole, &[]).unwrap_err();
        assert_eq!(told, DomainError::Cones);
    }
}

/// Cones of legs that are split count, too, though their rows are decided otherwise.
#[test]
fn cones_of_split_legs_count() {
    let text = find("plano-spherical-5dof-joints").unwrap().text;
    let mut mechanism = file::read(text).unwrap().mechanism;
    let ball = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let ball = ball.filter(|joint| joint.kind == JointKind::Spherical);
    ball.for_each(|joint| joint.cone = Some(Cone { half_angle: 0.3, axis: None }));
    let m = Manipulator::new(mechanism).unwrap();
    let free = example("plano-spherical-5dof-joints");
    let axis = |name: &str, far: f64, count| Axis::new(name, -far, far, count);
    let axes =
        || vec![axis("x", 0.1, 21), axis("y", 0.1, 5), axis("xi", 0.8, 5), axis("zeta", 0.5, 3)];
    let grid = Grid::new(&m, axes()).unwrap();
    for modes in [Modes::One(m.home_mode()), Modes::Any] {
        let count = |m| Sweep::new(m, &grid, modes).count(&Progress::default()).unwrap().reachable;
        let expected = by_inverse(&m, &grid, modes).1.reachable;
        assert_eq!(count(&m), expected);
        assert!(0 < expected && expected < count(&free), "{expected}");
    }
    assert_eq!(Grid::of(Sections::Upper, &m, vec![]), Err(GridError::NotAlone));
}

/// What follows from sections is refused by name.
#[test]
fn what_whole_legs_do_not_have_is_refused() {
    let m = example("delta");
    assert_eq!(m.forward_closed_form(), Err(NoClosedForm::Whole));
    assert_eq!(m.least_change(&[0.0; 3]), Err(ForwardError::NoClosedForm(NoClosedForm::Whole)));
    assert_eq!(Domain::new(&m, Sections::Upper, &[]), Err(DomainError::NoUpperSection));
    assert_eq!(Domain::new(&m, Sections::Lower, &[]), Err(DomainError::NoSections));
    assert_eq!(Domain::new(&example("tricept"), Sections::Whole, &[]), Err(DomainError::Whole));
    assert!(m.has_enclosures() && !m.encloses_places() && !m.workspace_factorises());
}
