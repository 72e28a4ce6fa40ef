//! Skeletons of the shipped mechanisms: their frames at home, and that bodies with a common joint
//! stay together.

use super::*;
use crate::decomposition::mobility::frame;
use crate::manipulator::Manipulator;
use crate::mechanism::examples::EXAMPLES;
use crate::mechanism::file;
use std::collections::HashSet;

/// Tolerance: rounding of a leg's product of exponentials, as a share of the mechanism's size.
const ROUNDING: f64 = 1e-12;

fn manipulators() -> Vec<Manipulator> {
    let mechanism = |text| file::read(text).unwrap().mechanism;
    let all: Vec<_> =
        EXAMPLES.iter().filter_map(|e| Manipulator::new(mechanism(e.text)).ok()).collect();
    assert!(all.len() >= EXAMPLES.len() - 3, "all mechanisms except the linkages");
    all
}

fn skeleton(manipulator: &Manipulator) -> Skeleton {
    let imaginary_joints = ImaginaryJoints {
        decomposition: manipulator.decomposition(),
        imaginary: manipulator.imaginary(),
    };
    Skeleton::new(manipulator.mechanism(), Some(imaginary_joints))
}

/// The transforms from each body's frame to the base's.
fn absolute(skeleton: &Skeleton, placed: &[Isometry3<f64>]) -> Vec<Isometry3<f64>> {
    let mut all: Vec<Isometry3<f64>> = Vec::new();
    for (body, transform) in skeleton.bodies().iter().zip(placed) {
        all.push(body.parent.map_or(*transform, |parent| all[parent] * transform));
    }
    all
}

#[test]
fn at_home_frames_stand_at_their_origins() {
    for manipulator in manipulators() {
        let skeleton = skeleton(&manipulator);
        let joints: Vec<f64> = manipulator.coordinates().iter().map(|c| c.home).collect();
        let imaginary: Vec<f64> = manipulator.imaginary().iter().map(|j| j.home).collect();
        let platform = Isometry3::identity();
        let configuration = Configuration { joints: &joints, imaginary: &imaginary, platform };
        let mut placed = Vec::new();
        skeleton.place(&configuration, &mut placed).unwrap();
        for (body, g) in skeleton.bodies().iter().zip(absolute(&skeleton, &placed)) {
            assert!((g.translation.vector - body.origin.coords).norm() < ROUNDING, "{}", body.name);
            assert!(g.rotation.angle() < ROUNDING, "{}", body.name);
        }
        let names: HashSet<_> = skeleton.bodies().iter().map(|b| &b.name).collect();
        assert_eq!(names.len(), skeleton.bodies().len());
    }
}

/// Every joint, real or imaginary, belongs to two bodies. Its centre and axis agree in both of
/// them, at poses around home. The platform is moved by the pose alone, so this also tests the
/// closure of every leg.
#[test]
fn what_shares_a_joint_stays_together() {
    for manipulator in manipulators() {
        let name = &manipulator.mechanism().name;
        let skeleton = skeleton(&manipulator);
        let size = frame(manipulator.mechanism()).length;
        let mut solution = manipulator.solution();
        let mut placed = Vec::new();
        let mut reached = 0;
        for sample in 0..50 {
            let step = |i: usize| (f64::from(sample) * (0.7 + i as f64)).sin();
            let pose: Vec<f64> = manipulator
                .task_coordinates()
                .iter()
                .enumerate()
                .map(|(i, c)| match c.quantity {
                    crate::mechanism::joint::Quantity::Angle => c.home + 0.15 * step(i),
                    crate::mechanism::joint::Quantity::Length => c.home + 0.08 * size * step(i),
                })
                .collect();
            if manipulator.inverse(&pose, manipulator.home_mode(), &mut solution).unwrap().is_none()
            {
                continue;
            }
            reached += 1;
            let platform = solution.displacement(&manipulator);
            let (joints, imaginary) = (&solution.joints, &solution.imaginary);
            skeleton.place(&Configuration { joints, imaginary, platform }, &mut placed).unwrap();
            let frames = absolute(&skeleton, &placed);
            let mut seats: Vec<(&Seat, Isometry3<f64>)> = Vec::new();
            for (body, g) in skeleton.bodies().iter().zip(&frames) {
                seats.extend(body.seats.iter().map(|seat| (seat, *g)));
            }
            let expected = manipulator.mechanism().joints().count() + 2 * imaginary.len();
            assert_eq!(seats.len(), 2 * expected, "{name}");
            for (seat, g) in &seats {
                let other = seats.iter().find(|(o, h)| o.joint == seat.joint && h != g);
                let Some((other, h)) = other else { continue };
                let offset = h * other.centre - g * seat.centre;
                let turned = (g * seat.axis).cross(&(h * other.axis)).norm();
                let off = match seat.motion {
                    SeatMotion::Turn => offset.norm() + size * turned,
                    SeatMotion::Slide => offset.cross(&(g * seat.axis)).norm() + size * turned,
                    SeatMotion::Ball => offset.norm(),
                    SeatMotion::Weld => {
                        offset.norm() + size * (g.rotation.inverse() * h.rotation).angle()
                    }
                };
                assert!(off < 1e3 * ROUNDING * size, "{name}: {} is {off} apart", seat.joint);
            }
        }
        assert!(reached > 20, "{name}: {reached}");
    }
}
