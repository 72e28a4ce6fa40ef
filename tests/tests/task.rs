//! The meaning of the task coordinates, compared with where a solution's joints bring the platform
//! by the undecomposed legs.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3, vector};
use opm_core::decomposition::decompose;
use opm_core::group::MotionType;
use opm_core::group::subspace::{SubspaceClass, UP};
use opm_core::manipulator::{CompileError, Manipulator};
use opm_core::mechanism::family::plano_spherical::Home;
use opm_core::mechanism::family::{Family, PlanoSpherical};
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{FrameHints, Mechanism, TaskHints, examples, file};
use opm_core::task::{CoordinateKind, Subspace, SubspaceKind, TaskError};
use opm_tests::displace::{displace, displace_decomposition};
use opm_tests::random;
use opm_tests::random::{Options, PAIRS, direction, displacement, mechanism, vector};

/// Poses here are of unit size; solutions near the boundary of a leg's reach lose some digits.
const AGREE: f64 = 1e-9;

/// The platform's displacement from home by the joints of the first leg, in any mode that reaches.
fn platform(manipulator: &Manipulator, pose: &[f64]) -> Option<Isometry3<f64>> {
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    manipulator.inverse_all(pose, &mut all).unwrap();
    let mode = all.modes(manipulator).next()?;
    assert!(manipulator.solution_in_mode(&all, mode, &mut solution).is_some());
    let leg = &manipulator.mechanism().legs[0];
    let own = &solution.joints()[..leg.coordinates().count()];
    Some(leg.displacement(own).unwrap())
}

fn about(axis: Unit<Vector3<f64>>, point: Point3<f64>, angle: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&axis, angle);
    Isometry3::from_parts(Translation3::from(point - turn * point), turn)
}

fn along(axis: Unit<Vector3<f64>>, length: f64) -> Isometry3<f64> {
    Isometry3::translation(axis.x * length, axis.y * length, axis.z * length)
}

/// The base's x projected into the plane perpendicular to `normal` (y if x is nearly normal), and
/// the direction π/2 ahead of it.
fn in_plane(normal: Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 2] {
    let base = if normal.x.abs() > 0.995 { Vector3::y() } else { Vector3::x() };
    let first = Unit::new_normalize(base - normal.into_inner() * normal.dot(&base));
    [first, Unit::new_normalize(normal.cross(&first))]
}

/// The one of two opposite directions that points up.
fn upward(v: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if v.dot(&Vector3::from(UP)) < 0.0 { -v } else { v }
}

/// The normal for which the normal and the direction π/2 ahead of x together point up.
fn standing(normal: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    let up = |n: &Unit<Vector3<f64>>| {
        let [_, second] = in_plane(*n);
        (n.into_inner() + second.into_inner()).dot(&Vector3::from(UP)) > 0.0
    };
    [normal, -normal].into_iter().find(up).unwrap()
}

/// From home, each coordinate alone moves the platform along one screw: the one in the table of the
/// module's docs.
#[test]
fn each_coordinate_moves_along_its_own_screw() {
    let mut rng = Rng::with_seed(41);
    let mut checked = 0;
    for pair in PAIRS {
        for _ in 0..30 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, d) = mechanism(&mut rng, pair, options);
            let (axis, line) = match d.intersection {
                SubspaceClass::Rotation { axis, point } => (Some(axis), Some(point)),
                SubspaceClass::Translation { axis } => (Some(axis), None),
                SubspaceClass::Identity => (None, None),
                _ => unreachable!(),
            };
            let p = mechanism.platform;
            let on = |q: Point3<f64>, axis: Unit<Vector3<f64>>| {
                q + axis.into_inner() * axis.dot(&(p - q))
            };
            let reference = line.zip(axis).map_or(p, |(q, axis)| on(q, axis));
            let manipulator = Manipulator::with_decomposition(mechanism, d.clone()).unwrap();
            let home = manipulator.home_pose();
            for (number, coordinate) in manipulator.task_coordinates().iter().enumerate() {
                let lower = number < manipulator.task().lower_count;
                let class = if lower { d.lower } else { d.upper };
                let mut plane = None;
                let (third, origin) = match class {
                    SubspaceClass::Planar { normal }
                    | SubspaceClass::Schoenflies { axis: normal }
                        if line.is_none() =>
                    {
                        plane = Some(normal);
                        (standing(normal), reference)
                    }
                    SubspaceClass::TranslationalPlane { normal } => {
                        plane = Some(normal);
                        (standing(normal), reference)
                    }
                    SubspaceClass::Cylindrical { point, axis: own } => {
                        let axis = axis.unwrap_or_else(|| upward(own));
                        (axis, point + axis.into_inner() * axis.dot(&(reference - point)))
                    }
                    SubspaceClass::Spherical { centre } => {
                        (axis.unwrap_or(Vector3::z_axis()), centre)
                    }
                    SubspaceClass::TranslationalSpace => {
                        (axis.unwrap_or(Vector3::z_axis()), reference)
                    }
                    _ => (axis.unwrap(), reference),
                };
                // A plane perpendicular to the common rotation, where it stands upright: y points up.
                let turns = line.is_some() && !matches!(class, SubspaceClass::Cylindrical { .. });
                let fixed = turns || matches!(class, SubspaceClass::TranslationalSpace);
                let mut senses = in_plane(third);
                let sum = third.into_inner() + senses[1].into_inner();
                if fixed && sum.dot(&Vector3::from(UP)) < 0.0 {
                    senses = senses.map(|direction| -direction);
                }
                let [first, second] = senses;
                let (amount, at_home) = (0.1 + 0.1 * rng.f64(), coordinate.home);
                let w = match (axis, plane, class) {
                    (Some(axis), Some(normal), _) => {
                        upward(Unit::new_normalize(normal.cross(&axis)))
                    }
                    (_, _, SubspaceClass::TranslationalSpace) => first,
                    _ => third,
                };
                let h = match class {
                    SubspaceClass::TranslationalSpace => second,
                    _ => third,
                };
                let (expected, measured) = match coordinate.name {
                    "x" => (along(first, amount), first.dot(&origin.coords)),
                    "y" => (along(second, amount), second.dot(&origin.coords)),
                    "z" => (along(third, amount), third.dot(&origin.coords)),
                    "h" => (along(h, amount), h.dot(&origin.coords)),
                    "w" => (along(w, amount), w.dot(&origin.coords)),
                    "theta" | "phi" | "zeta" | "psi" => (about(third, origin, amount), 0.0),
                    "mu" => (about(first, origin, amount), 0.0),
                    "nu" | "xi" => (about(second, origin, amount), 0.0),
                    other => panic!("{other}"),
                };
                assert!((measured - at_home).abs() < AGREE, "{pair:?} {coordinate:?} {measured}");
                let mut pose = home.clone();
                pose[number] += amount;
                let Some(moved) = platform(&manipulator, &pose) else { continue };
                let off = (moved.to_homogeneous() - expected.to_homogeneous()).amax();
                assert!(off < AGREE, "{pair:?} {} is off by {off:e}", coordinate.name);
                checked += 1;
            }
        }
    }
    assert!(checked > 1_000, "{checked} coordinates");
}

/// The Euler angles are those of the platform's orientation, and `x y` is its position, whatever
/// they are at home: `P = (x, y, 0)`, `R = Rz(zeta) Ry(xi) Rz(psi)`.
#[test]
fn a_familys_pose_is_absolute_whatever_its_home() {
    let mut rng = Rng::with_seed(42);
    let text = examples::find("plano-spherical-5dof").unwrap().text;
    let Some(Family::PlanoSpherical(family)) = file::read(text).unwrap().family else { panic!() };
    let orientation = |q: &[f64]| {
        let [z, y] = [Vector3::z_axis(), Vector3::y_axis()];
        UnitQuaternion::from_axis_angle(&z, q[2])
            * UnitQuaternion::from_axis_angle(&y, q[3])
            * UnitQuaternion::from_axis_angle(&z, q[4])
    };
    let mut any = |size: f64| size * (rng.f64() * 2.0 - 1.0);
    let mut checked = 0;
    for _ in 0..300 {
        let home = [any(0.05), any(0.05), any(2.0), any(0.5), any(2.0)];
        let [x, y, zeta, xi, psi] = home;
        let placed = PlanoSpherical { home: Home { x, y, zeta, xi, psi }, ..family.clone() };
        let Ok(mut mechanism) = placed.assemble() else { continue };
        let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
        joints.flat_map(|joint| &mut joint.coordinates).for_each(|c| c.limits = None);
        // A few of these homes are within the tolerance of a singular pose.
        let Ok(manipulator) = Manipulator::new(mechanism) else { continue };
        assert_eq!(manipulator.home_pose(), home);
        let pose = home.map(|q| q + any(0.1));
        let Some(moved) = platform(&manipulator, &pose) else { continue };
        let turned = moved.rotation * orientation(&home);
        assert!(turned.angle_to(&orientation(&pose)) < AGREE);
        let place = moved * Point3::new(x, y, 0.0);
        assert!((place - Point3::new(pose[0], pose[1], 0.0)).norm() < AGREE);
        checked += 1;
    }
    assert!(checked > 100, "{checked} poses");
}

/// Two spherical subspaces whose centres are on a line that is level except for rounding.
fn level(rng: &mut Rng, rise: f64) -> Mechanism {
    let centres = [Point3::origin(), Point3::new(0.6, 0.2, rise)];
    let legs = (1..=4).map(|number| {
        let counts = if number < 4 { [3, 2] } else { [2, 3] };
        let mut joints = vec![];
        for (centre, count) in centres.iter().zip(counts) {
            for _ in 0..count {
                let name = format!("{}{number}", (b'a' + joints.len() as u8) as char);
                joints.push(Joint::new(name, JointKind::Revolute, direction(rng), *centre));
            }
        }
        joints[0].actuated = true;
        joints[1].actuated = number == 1;
        Leg::new(format!("leg{number}"), joints)
    });
    Mechanism {
        name: "level".into(),
        legs: legs.collect(),
        platform: centres[1] + vector(rng) * 0.1,
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}

/// The positive direction is the same in the decomposition and in the coordinates, and digits
/// beyond the tolerance do not change it.
#[test]
fn rounding_does_not_turn_the_positive_direction() {
    let mut compared = 0;
    for seed in 0..20 {
        for rise in [0.0, 3e-6, -3e-6, 2e-5, -2e-5] {
            let mechanism = level(&mut Rng::with_seed(seed), rise);
            let Ok(manipulator) = Manipulator::new(mechanism) else { continue };
            let SubspaceClass::Rotation { axis, .. } = manipulator.decomposition().intersection
            else {
                panic!()
            };
            assert_eq!(manipulator.task().intersection.as_ref().unwrap().direction, axis);
            assert!(axis.dot(&vector![0.6, 0.2, 0.0]) > 0.6, "{rise:e}: {axis:?}");
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared}");
}

/// `[task] axis` chooses a direction, in the decomposition too. Perpendicular to the motion, it
/// chooses none.
#[test]
fn the_hint_chooses_the_positive_direction() {
    let text = examples::find("plano-spherical-5dof-joints").unwrap().text;
    let mut mechanism = file::read(text).unwrap().mechanism;
    for z in [1.0, -1.0] {
        mechanism.task.axis = Some(vector![0.5, 0.0, 2.0 * z]);
        let SubspaceClass::Rotation { axis, .. } = decompose(&mechanism).unwrap()[0].intersection
        else {
            panic!()
        };
        assert!((axis.into_inner() - Vector3::z() * z).norm() < AGREE);
        let manipulator = Manipulator::new(mechanism.clone()).unwrap();
        let home = manipulator.home_pose();
        let turned = [home[0], home[1], 0.2, 0.0, 0.0];
        let moved = platform(&manipulator, &turned).unwrap();
        let expected = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.2 * z);
        assert!((moved.rotation.to_rotation_matrix().matrix() - expected.matrix()).amax() < AGREE);
    }
    mechanism.task.axis = Some(vector![1.0, 0.0, 0.0]);
    let error = Manipulator::new(mechanism).unwrap_err();
    assert!(matches!(error, CompileError::Task(TaskError::Axis { .. })), "{error}");
    assert!(error.to_string().contains("(1.000000, 0.000000, 0.000000)"), "{error}");
}

/// Directions whose angles are multiples of 15 degrees, measured about any axis of the base from
/// any other, and those of the edges and diagonals of a cube.
fn usual_directions() -> Vec<Vector3<f64>> {
    let mut all = Vec::new();
    let turns = |n: i32| f64::from(15 * n).to_radians();
    for (azimuth, elevation) in (0..24).flat_map(|a| (-6..=6).map(move |e| (turns(a), turns(e)))) {
        let (a, e) = (azimuth.sin_cos(), elevation.sin_cos());
        let v = [e.1 * a.1, e.1 * a.0, e.0];
        for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            all.push(vector![v[i], v[j], v[k]]);
        }
    }
    for number in (0..125).filter(|&number| number != 62) {
        let [x, y, z] = [number / 25, number / 5 % 5, number % 5].map(|n| f64::from(n - 2));
        all.push(vector![x, y, z].normalize());
    }
    all
}

/// Usual directions are far from where the rule for "up" reverses a direction, and their signs are:
/// positive along z, else y, else x.
#[test]
fn no_usual_direction_is_near_to_turning_round() {
    let up = Vector3::from(UP).normalize();
    let degrees_off = |v: &Vector3<f64>| v.dot(&up).asin().to_degrees();
    for v in usual_directions() {
        let flat = v.iter().any(|c| c.abs() < 1e-9);
        let least = if flat { 2.8 } else { 0.7 };
        assert!(degrees_off(&v).abs() > least, "{v:?} {}", degrees_off(&v));
        let level = v.z.abs() < 1e-9;
        let points_up = if level { v.y > 1e-9 || (v.y > -1e-9 && v.x > 0.0) } else { v.z > 0.0 };
        if level || v.z.abs() > 0.5 {
            assert_eq!(degrees_off(&v) > 0.0, points_up, "{v:?}");
        }
    }
}

fn axes_apart(a: &Subspace, b: &Subspace) -> f64 {
    (a.axes - b.axes).amax()
}

/// Mechanisms in every usual orientation, rotated by a small angle: the frames rotate by as much,
/// `w` and the intersection motion are positive upwards, and `x y` are the base's if the plane is
/// level.
#[test]
fn a_small_turn_turns_no_coordinate_round() {
    const LITTLE: f64 = 0.004;
    let mut rng = Rng::with_seed(43);
    let up = Vector3::from(UP);
    let quarter = std::f64::consts::FRAC_PI_2;
    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let rotation = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    let (mut compared, mut level) = (0, 0);
    let stands = [
        (rotation(axes[0], 0.0), axes[2]),
        (rotation(axes[0], 0.0), axes[0]),
        (rotation(axes[0], quarter), axes[2]),
        (rotation(axes[1], quarter), axes[2]),
    ];
    for name in [
        "translational-planar-4dof",
        "planar-planar-5dof-joints",
        "plano-cylindrical-4dof",
        "schoenflies-4dof",
        "translational-helical-3dof-joints",
    ] {
        let mut mechanism = file::read(examples::find(name).unwrap().text).unwrap().mechanism;
        mechanism.task = TaskHints::default();
        for (stand, axis) in stands {
            for turns in 0..24 {
                let turn = rotation(axis, f64::from(15 * turns).to_radians()) * stand;
                let little = rotation(direction(&mut rng), LITTLE);
                let of = |turn: UnitQuaternion<f64>| {
                    let turn = Isometry3::from_parts(Translation3::identity(), turn);
                    Manipulator::new(displace(&mechanism, &turn)).unwrap()
                };
                let (one, other) = (of(turn), of(little * turn));
                let (task, turned) = (one.task(), other.task());
                let direction = task.intersection.as_ref().unwrap().direction;
                assert!(direction.dot(&up) > 0.0);
                for (frame, after) in [(&task.lower, &turned.lower), (&task.upper, &turned.upper)] {
                    // A direction projected into a plane moves by more than the plane: at most by
                    // the inverse of the sine of 6 degrees, the steepest angle at which x is
                    // projected.
                    let off = axes_apart(frame, after);
                    assert!(off < 11.0 * LITTLE, "{name}: {off} {frame:?} {after:?}");
                    let normal = frame.axes.column(2).into_owned();
                    if frame.kind != SubspaceKind::Cylindrical && normal.z > 1.0 - 1e-9 {
                        let w = task.coordinates.iter().any(|c| c.name == "w");
                        let upper = std::ptr::eq(frame, &task.upper);
                        if !(w && upper) {
                            assert!((frame.axes.column(0) - Vector3::x()).norm() < 1e-9);
                            level += 1;
                        }
                    }
                }
                if task.coordinates.iter().any(|c| c.name == "w") {
                    assert!(task.upper.axes.column(1).dot(&up) > 0.0);
                }
                compared += 1;
            }
        }
    }
    assert!(compared == 480 && level > 100, "{compared} {level}");
}

/// The hints that a file may give for the frame of a section.
fn hints(frame: &Subspace, names: &[&str], shared: Option<MotionType>) -> FrameHints {
    let axis = |number: usize| Some(frame.axes.column(number).into_owned());
    let plane = matches!(frame.kind, SubspaceKind::Planar | SubspaceKind::TranslationalPlane);
    let space = frame.kind == SubspaceKind::TranslationalSpace;
    let has = |name| names.contains(&name);
    FrameHints {
        x: axis(0).filter(|_| has("x") || has("mu") || has("zeta") || space),
        w: axis(1).filter(|_| plane && has("w")),
        axis: axis(2).filter(|_| !plane && shared.is_none() && !names.is_empty()),
        normal: axis(2).filter(|_| plane && shared != Some(MotionType::Rotation) && names != ["w"]),
        origin: Some(frame.measured_from).filter(|_| ["x", "w", "z"].iter().any(|name| has(name))),
    }
}

/// The frames of a mechanism can be written down and displaced with it. Its coordinates and its
/// joints are then the same numbers, wherever it is.
#[test]
fn displaced_with_its_frames_a_mechanism_has_the_same_coordinates() {
    let mut rng = Rng::with_seed(44);
    let mut solved = 0;
    for pair in PAIRS {
        for _ in 0..40 {
            // A spherical joint's rotation vector is in base coordinates, which do not move.
            let options = Options { limited: 0.0, balls: false };
            let (plain, decomposition) = mechanism(&mut rng, pair, options);
            let here = Manipulator::with_decomposition(plain.clone(), decomposition.clone());
            let here = here.unwrap();
            let task = here.task();
            let shared = task.shared();
            let names: Vec<&str> = task.coordinates.iter().map(|c| c.name).collect();
            let (v, b) = names.split_at(task.lower_count);
            let mut framed = plain.clone();
            framed.task = TaskHints {
                axis: task.intersection.as_ref().map(|axis| axis.direction.into_inner()),
                lower: hints(&task.lower, v, shared),
                upper: hints(&task.upper, b, shared),
                ..TaskHints::default()
            };
            let g = displacement(&mut rng);
            let there = Manipulator::with_decomposition(
                displace(&framed, &g),
                displace_decomposition(&decomposition, &g),
            )
            .unwrap();
            for (c, other) in here.task_coordinates().iter().zip(there.task_coordinates()) {
                assert_eq!(c.name, other.name);
                assert!((c.home - other.home).abs() < AGREE, "{pair:?} {c:?} {other:?}");
            }
            let pose: Vec<f64> = task.home().iter().map(|q| q + rng.f64() - 0.5).collect();
            for number in 0..here.choices() {
                let signs = |i| if i == number { '-' } else { '+' };
                let signs: String = (0..here.choices()).map(signs).collect();
                let [mode, other] = [&here, &there].map(|m| m.parse_mode(&signs).unwrap());
                let (mut one, mut two) = (here.solution(), there.solution());
                let reached = here.inverse(&pose, mode, &mut one).unwrap().is_some();
                assert_eq!(reached, there.inverse(&pose, other, &mut two).unwrap().is_some());
                if reached {
                    solved += 1;
                    for (q, p) in one.joints().iter().zip(two.joints()) {
                        assert!((q - p).abs() < 1e-6, "{pair:?}: {q} {p}");
                    }
                }
            }
        }
    }
    assert!(solved > 300, "{solved} solutions");
}

/// A frame given by a file is used, and home's values are measured in it.
#[test]
fn given_frames_shift_home() {
    let text = examples::find("translational-planar-4dof").unwrap().text;
    let mut mechanism = file::read(text).unwrap().mechanism;
    let (x, y) = (vector![0.6, 0.8, 0.0], vector![0.8, -0.6, 0.0]);
    mechanism.task = TaskHints {
        axis: Some(-Vector3::y()),
        lower: FrameHints {
            x: Some(x * 3.0),
            normal: Some(-Vector3::z()),
            origin: Some(Point3::new(1.0, 2.0, 3.0)),
            ..FrameHints::default()
        },
        upper: FrameHints {
            w: Some(-Vector3::z()),
            normal: Some(-Vector3::x()),
            origin: Some(Point3::new(0.0, 0.0, 1.0)),
            ..FrameHints::default()
        },
        ..TaskHints::default()
    };
    let manipulator = Manipulator::new(mechanism.clone()).unwrap();
    let home = manipulator.home_pose();
    let from = mechanism.platform - Point3::new(1.0, 2.0, 3.0);
    let expected = [from.dot(&x), from.dot(&y), 1.0 - mechanism.platform.z, 0.0];
    for (value, expected) in home.iter().zip(expected) {
        assert!((value - expected).abs() < AGREE, "{home:?}");
    }
    let moved = manipulator.task().displacement(&[home[0], home[1], home[2] + 0.1, 0.2]);
    let turn = UnitQuaternion::from_axis_angle(&-Vector3::x_axis(), 0.2);
    assert!(moved.rotation.angle_to(&turn) < AGREE);
    let expected = mechanism.platform - Vector3::z() * 0.1;
    assert!((moved * mechanism.platform - expected).norm() < AGREE);
}

/// A joint cannot have the name of any task coordinate: both are columns of one table.
#[test]
fn names_of_coordinates_are_no_names_of_joints() {
    let text = opm_core::mechanism::examples::find("five-bar").unwrap().text;
    use CoordinateKind::{Azimuth, H, Pitch, Roll, Tilt, Torsion, Yaw};
    let rare = [Azimuth, H, Tilt, Torsion, Roll, Pitch, Yaw];
    for kind in CoordinateKind::ALL.into_iter().filter(|kind| !rare.contains(kind)) {
        let renamed = text.replacen("name = \"S1\"", &format!("name = {:?}", kind.name()), 1);
        assert_ne!(renamed, text);
        let error = Manipulator::read(&renamed).unwrap_err().to_string();
        assert!(error.contains("is the name of a task coordinate"), "{error}");
    }
    // Few mechanisms have the coordinate `h`.
    let mut rng = Rng::with_seed(45);
    let meet = random::Meet::Translation;
    for pair in [
        [random::RandomSubspace::Cylindrical(meet), random::RandomSubspace::Schoenflies(meet)],
        [random::RandomSubspace::Schoenflies(meet), random::RandomSubspace::Cylindrical(meet)],
    ] {
        let options = Options { limited: 0.0, balls: false };
        let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
        mechanism.legs[1].joints[0].name = "h".into();
        let found = Manipulator::with_decomposition(mechanism, decomposition);
        let refused = found.err().map(|error| error.to_string());
        let has_h = matches!(pair, [random::RandomSubspace::Cylindrical(_), _]);
        assert_eq!(refused.is_some_and(|told| told.starts_with("joint h of leg leg2")), has_h);
    }
}

/// In every upright plane the second axis points up, and the intersection motion towards positive y, or else x: the directions
/// are computed by hand. The plane is that of the legs of a plano-spherical mechanism, turned on its side.
#[test]
fn y_of_an_upright_plane_points_up() {
    let text = examples::find("plano-spherical-5dof-joints").unwrap().text;
    for degrees in (0..360).step_by(15) {
        let azimuth = f64::from(degrees).to_radians();
        let mut mechanism = file::read(text).unwrap().mechanism;
        mechanism.task = TaskHints::default();
        let normal = vector![azimuth.cos(), azimuth.sin(), 0.0];
        let turned = UnitQuaternion::rotation_between(&Vector3::z(), &normal).unwrap();
        let turned = Isometry3::from_parts(Translation3::identity(), turned);
        let manipulator = Manipulator::new(displace(&mechanism, &turned)).unwrap();
        let task = manipulator.task();
        for frame in [&task.lower, &task.upper] {
            let [first, second, third] = [0, 1, 2].map(|i| frame.axes.column(i).into_owned());
            assert!((second - Vector3::z()).amax() < AGREE, "{degrees}: {second:?}");
            assert!(third.y > 1e-9 || third.x > 0.99, "{degrees}: {third:?}");
            assert!((first.cross(&second) - third).amax() < AGREE);
        }
        // The first two coordinates move the platform along these directions.
        for (number, direction) in [(0, task.lower.axes.column(0).into_owned()), (1, Vector3::z())]
        {
            let mut pose = manipulator.home_pose();
            pose[number] += 0.01;
            let moved = platform(&manipulator, &pose).unwrap().translation.vector;
            assert!((moved - direction * 0.01).amax() < AGREE, "{degrees}: {moved:?}");
        }
    }
}
