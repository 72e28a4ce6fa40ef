//! Conversion of displacements of the platform to task coordinates and back.

use fastrand::Rng;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::examples;
use opm_tests::random::{Options, PAIRS, direction, mechanism};

const OPTIONS: Options = Options { limited: 0.0, balls: true };

fn off(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).norm()
}

#[test]
fn poses_come_back_from_their_displacements() {
    let mut rng = Rng::with_seed(40);
    for pair in PAIRS {
        for _ in 0..20 {
            let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            for _ in 0..20 {
                let home = manipulator.home_pose();
                let pose: Vec<f64> = home.iter().map(|q| q + 5.0 * (rng.f64() - 0.5)).collect();
                let displacement = manipulator.task().displacement(&pose);
                let located = manipulator.locate(&displacement);
                let located = located.unwrap_or_else(|e| panic!("{pair:?} {pose:?}: {e}"));
                let back = manipulator.task().displacement(&located);
                assert!(off(&back, &displacement) < 1e-8, "{pair:?} {pose:?} {located:?}");
            }
        }
    }
}

/// A pose of the motion subspace is moved out of it. Along directions that the motion lacks, the
/// distance is the one moved; for the paper's pair, planar and spherical, that is the plane's
/// normal.
#[test]
fn outside_says_how_far_and_where() {
    let mut rng = Rng::with_seed(41);
    for _ in 0..50 {
        let (mut mechanism, decomposition) = mechanism(&mut rng, PAIRS[0], OPTIONS);
        let SubspaceClass::Spherical { centre } = decomposition.upper else { unreachable!() };
        mechanism.platform = centre;
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let pose: Vec<f64> = manipulator.home_pose().iter().map(|q| q + rng.f64() - 0.5).collect();
        let normal = manipulator.task().intersection.as_ref().unwrap().direction;
        let by = 0.01 + 0.2 * rng.f64();
        let out =
            Translation3::from(normal.into_inner() * by) * manipulator.task().displacement(&pose);
        let outside = manipulator.locate(&out).unwrap_err();
        assert!(outside.rotation.norm() < 1e-6, "{outside}");
        assert!((outside.translation - normal.into_inner() * by).norm() < 1e-6, "{outside}");
    }
    // A motion of six dimensions leaves nothing outside.
    for pair in PAIRS {
        let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
        if decomposition.lambda == 6 {
            continue;
        }
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let anywhere = Isometry3::from_parts(
            Translation3::from(direction(&mut rng).into_inner() * 0.7),
            UnitQuaternion::from_axis_angle(&direction(&mut rng), 1.0),
        );
        // At most five freedoms: a random displacement is outside the motion subspace.
        let outside = manipulator.locate(&anywhere).unwrap_err();
        let nearest = manipulator.task().displacement(&outside.nearest);
        let turn = (anywhere.rotation * nearest.rotation.inverse()).scaled_axis();
        assert!((turn - outside.rotation).norm() < 1e-9);
        assert!(outside.rotation.norm() + outside.translation.norm() > 1e-6);
    }
}

/// The platform's pose in SE(3) is its reference point and its orientation: for the paper's pair
/// `(x, y, 0)` and `Rz(zeta) Ry(xi) Rz(psi)`, whatever they are at home. It leads back to the task
/// coordinates.
#[test]
fn the_platforms_place_is_its_point_and_its_orientation() {
    let text = examples::find("plano-spherical-5dof").unwrap().text;
    let text = text.replace("zeta = 0, xi = 0, psi = 0", "zeta = 25, xi = 10, psi = -40");
    let manipulator = Manipulator::read(&text).unwrap();
    assert!(manipulator.home_pose()[2] > 0.4, "home is turned");
    let mut rng = Rng::with_seed(44);
    for _ in 0..20 {
        let home = manipulator.home_pose();
        let pose: Vec<f64> = home.iter().map(|q| q + rng.f64() - 0.5).collect();
        let place = manipulator.platform_pose(&pose).unwrap();
        let [z, y] = [Vector3::z_axis(), Vector3::y_axis()];
        let turn = UnitQuaternion::from_axis_angle(&z, pose[2])
            * UnitQuaternion::from_axis_angle(&y, pose[3])
            * UnitQuaternion::from_axis_angle(&z, pose[4]);
        assert!(place.rotation.angle_to(&turn) < 1e-12);
        assert!((place.translation.vector - Vector3::new(pose[0], pose[1], 0.0)).norm() < 1e-12);
        let back = manipulator.locate_platform(&place).unwrap();
        assert!(off(&manipulator.platform_pose(&back).unwrap(), &place) < 1e-8);
    }
    for pair in PAIRS {
        let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let home = manipulator.platform_pose(&manipulator.home_pose()).unwrap();
        assert!(home.rotation.angle() < 1e-12);
        assert!((home.translation.vector - manipulator.mechanism().platform.coords).norm() < 1e-12);
    }
}

/// There is one reference point, wherever it is on the platform: every leg carries it to where the pose in SE(3) says, and
/// its velocity is that of the twist.
#[test]
fn legs_carry_the_reference_point_to_where_it_is_said_to_be() {
    const STEP: f64 = 1e-6;
    let mut rng = Rng::with_seed(45);
    for pair in PAIRS {
        let mut solved = 0;
        for _ in 0..20 {
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            mechanism.platform += 0.4 * direction(&mut rng).into_inner();
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let home = manipulator.home_pose();
            let pose: Vec<f64> = home.iter().map(|q| q + 0.1 * (rng.f64() - 0.5)).collect();
            let mut buffer = manipulator.solution();
            let found = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer).unwrap();
            let Some(solution) = found else { continue };
            solved += 1;
            let place = manipulator.platform_pose(&pose).unwrap().translation.vector;
            let point = manipulator.mechanism().platform;
            let mut joints = solution.joints();
            for leg in &manipulator.mechanism().legs {
                let (own, others) = joints.split_at(leg.coordinates().count());
                joints = others;
                let carried = leg.displacement(own).unwrap() * point;
                assert!((carried.coords - place).norm() < 1e-8, "{pair:?}: {}", leg.name);
            }
            let mut jacobians = manipulator.jacobians();
            manipulator.differentiate(solution, &mut jacobians).unwrap();
            let twist = manipulator.twist_by_pose(&jacobians);
            for coordinate in 0..pose.len() {
                let [ahead, behind] = [STEP, -STEP].map(|step| {
                    let mut moved = pose.clone();
                    moved[coordinate] += step;
                    manipulator.platform_pose(&moved).unwrap().translation.vector
                });
                let velocity = twist.column(coordinate).fixed_rows::<3>(3).into_owned();
                let difference = (ahead - behind) / (2.0 * STEP);
                assert!((velocity - difference).norm() < 1e-7, "{pair:?}, {coordinate}");
            }
        }
        assert!(solved > 0, "{pair:?}");
    }
}
