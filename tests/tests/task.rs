//! What the task coordinates mean, held against the legs as they are: where a solution's joints bring
//! the platform.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3, vector};
use opm_core::decomposition::decompose;
use opm_core::joint::{Joint, JointKind};
use opm_core::leg::Leg;
use opm_core::manipulator::{CompileError, Manipulator};
use opm_core::mechanism::family::plano_spherical::Home;
use opm_core::mechanism::family::{Family, PlanoSpherical};
use opm_core::mechanism::{Mechanism, TaskHints, examples, file};
use opm_core::subspace::SubspaceClass;
use opm_core::task::TaskError;
use opm_tests::random::{Options, PAIRS, direction, mechanism, vector};

/// Poses here are of the size of one; solutions near the rim of a leg's reach lose some digits.
const AGREE: f64 = 1e-9;

/// Where the joints of the first leg bring the platform from home, in any mode that reaches.
fn platform(manipulator: &Manipulator, pose: &[f64]) -> Option<Isometry3<f64>> {
    let mut all = manipulator.all_modes();
    let mut solution = manipulator.solution();
    manipulator.inverse_all(pose, &mut all).unwrap();
    let mode = all.modes(manipulator).next()?;
    assert!(manipulator.pick(&all, mode, &mut solution));
    Some(manipulator.mechanism().legs[0].displacement(&solution.joints))
}

fn about(axis: Unit<Vector3<f64>>, point: Point3<f64>, angle: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&axis, angle);
    Isometry3::from_parts(Translation3::from(point - turn * point), turn)
}

fn along(axis: Unit<Vector3<f64>>, length: f64) -> Isometry3<f64> {
    Isometry3::translation(axis.x * length, axis.y * length, axis.z * length)
}

/// The base's x laid into the plane square to `normal` (y where x is nearly normal), and the
/// direction a quarter turn ahead of it.
fn in_plane(normal: Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 2] {
    let base = if normal.x.abs() > 0.995 { Vector3::y() } else { Vector3::x() };
    let first = Unit::new_normalize(base - normal.into_inner() * normal.dot(&base));
    [first, Unit::new_normalize(normal.cross(&first))]
}

/// From home, each coordinate alone moves the platform along one screw: the one that the table in
/// the docs of the module names.
#[test]
fn each_coordinate_moves_along_its_own_screw() {
    let mut rng = Rng::with_seed(41);
    let mut checked = 0;
    for pair in PAIRS {
        for _ in 0..30 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, d) = mechanism(&mut rng, pair, options);
            let (axis, line) = match d.intersection {
                SubspaceClass::Rotation { axis, point } => (axis, Some(point)),
                SubspaceClass::Translation { axis } => (axis, None),
                _ => unreachable!(),
            };
            let p = mechanism.platform;
            let reference = line.map_or(p, |q| q + axis.into_inner() * axis.dot(&(p - q)));
            let manipulator = Manipulator::with_decomposition(mechanism, d.clone()).unwrap();
            let home = manipulator.task().home();
            for (number, coordinate) in manipulator.task_coordinates().iter().enumerate() {
                let lower = number < manipulator.task().lower_count;
                let class = if lower { d.lower } else { d.upper };
                let (third, origin) = match class {
                    SubspaceClass::Planar { normal } if line.is_none() => (normal, reference),
                    SubspaceClass::TranslationalPlane { normal } => (normal, reference),
                    SubspaceClass::Cylindrical { point, .. } => {
                        (axis, point + axis.into_inner() * axis.dot(&(reference - point)))
                    }
                    SubspaceClass::Spherical { centre } => (axis, centre),
                    _ => (axis, reference),
                };
                let [first, second] = in_plane(third);
                let (amount, at_home) = (0.1 + 0.1 * rng.f64(), coordinate.home);
                let square = Unit::new_normalize(third.cross(&axis));
                let (expected, measured) = match coordinate.name {
                    "x" => (along(first, amount), first.dot(&origin.coords)),
                    "y" => (along(second, amount), second.dot(&origin.coords)),
                    "z" => (along(third, amount), third.dot(&origin.coords)),
                    "w" => (along(square, amount), square.dot(&origin.coords)),
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

/// Euler angles are those of the platform's orientation, and `x y` its place, whatever they are at
/// home: `P = (x, y, 0)`, `R = Rz(zeta) Ry(xi) Rz(psi)`.
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
        assert_eq!(manipulator.task().home(), home);
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

/// Two spherical subspaces with centres on a line that is level but for rounding.
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
        task: TaskHints::default(),
    }
}

/// The positive direction is one, in the decomposition and in the coordinates, and digits beyond the
/// tolerance do not choose it.
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
            assert_eq!(manipulator.task().direction, axis);
            assert!(axis.dot(&vector![0.6, 0.2, 0.0]) > 0.6, "{rise:e}: {axis:?}");
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared}");
}

/// `[task] axis` chooses a direction, in the decomposition too; square to the motion it chooses none.
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
        let home = manipulator.task().home();
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
