//! Shipped mechanisms on their side, on their head and on diagonals: the same mechanism there.

use fastrand::Rng;
use nalgebra::Isometry3;
use opm_core::manipulator::Manipulator;
use opm_core::skeleton::{Configuration, ImaginaryJoints, SeatMotion, Skeleton};
use opm_tests::structured::{apart, gap, mechanisms, placed, pose};

#[test]
fn mechanisms_are_the_same_anywhere() {
    let mut rng = Rng::with_seed(50);
    for mechanism in mechanisms() {
        let here = Manipulator::new(mechanism.clone()).unwrap();
        let places = placed(&mechanism);
        // Each of them for some mechanism: to decompose takes its time.
        for (g, moved) in places.into_iter().skip(rng.usize(..4)).step_by(4) {
            let name = &mechanism.name;
            let there = Manipulator::new(moved).unwrap_or_else(|e| panic!("{name} at {g}: {e}"));
            let [a, b] = [here.decomposition(), there.decomposition()];
            assert_eq!((a.lambda, a.mobility), (b.lambda, b.mobility), "{name} at {g}");
            let names =
                |m: &Manipulator| [m.decomposition().lower.name(), m.decomposition().upper.name()];
            assert_eq!(names(&here), names(&there), "{name} at {g}");
            let [x, y] = [here.characteristic_length(), there.characteristic_length()];
            assert!((x - y).abs() < 1e-9 * x, "{name} at {g}");
            let (mut at, home) = (there.solution(), there.home_pose());
            assert!(
                there.inverse(&home, there.home_mode(), &mut at).unwrap().is_some(),
                "{name} at {g}"
            );
            for (c, q) in there.coordinates().iter().zip(at.joints()) {
                assert!((c.home - q).abs() < 1e-6, "{name} at {g}, {}: {q}", c.name);
            }
            let (decomposition, imaginary) = (there.decomposition(), there.imaginary());
            let drawn = Skeleton::new(
                there.mechanism(),
                Some(ImaginaryJoints { decomposition, imaginary }),
            );
            for _ in 0..12 {
                let pose = pose(&mut rng, &there);
                // Dependent coordinates have no solution at some poses.
                let Ok(target) = there.displacement(&pose) else { continue };
                let back = there.locate(&target).unwrap_or_else(|e| panic!("{name} at {g}: {e}"));
                let off = apart(&there, &there.displacement(&back).unwrap(), &target);
                assert!(off < 1e-11, "{name} at {g} {pose:?}: {off:e}");
                if there.inverse(&pose, there.home_mode(), &mut at).unwrap().is_some() {
                    let off = gap(&there, at.joints(), &target);
                    assert!(off < 1e-7, "{name} at {g} {pose:?}: {off:e}");
                    let (joints, imaginary) = (&at.joints(), &at.imaginary());
                    let off = torn(&drawn, &Configuration { joints, imaginary, platform: target });
                    let size = there.characteristic_length();
                    assert!(off < 1e-7 * size, "{name} at {g} {pose:?}: {off:e}");
                }
            }
        }
    }
}

/// How far what two bodies hold of a joint is apart, at worst: metres.
fn torn(skeleton: &Skeleton, posture: &Configuration<'_>) -> f64 {
    let mut placed = Vec::new();
    skeleton.place(posture, &mut placed).unwrap();
    let mut frames: Vec<Isometry3<f64>> = Vec::new();
    for (body, g) in skeleton.bodies().iter().zip(&placed) {
        frames.push(body.parent.map_or(*g, |parent| frames[parent] * g));
    }
    let bodies = || skeleton.bodies().iter().zip(&frames);
    let seats = || bodies().flat_map(|(body, g)| body.seats.iter().map(move |seat| (seat, g)));
    let mut worst = 0.0_f64;
    for (seat, g) in seats() {
        for (other, h) in seats().filter(|(other, h)| other.joint == seat.joint && *h != g) {
            let offset = h * other.centre - g * seat.centre;
            worst = worst.max(match seat.motion {
                SeatMotion::Turn | SeatMotion::Ball | SeatMotion::Weld => offset.norm(),
                SeatMotion::Slide => offset.cross(&(g * seat.axis)).norm(),
            });
        }
    }
    worst
}
