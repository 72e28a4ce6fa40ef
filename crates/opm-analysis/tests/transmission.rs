//! Transmission indices against angles that papers and geometry give.

use fastrand::Rng;
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use opm_analysis::{Transmission, Transmissions};
use opm_core::Manipulator;
use opm_core::mechanism::leg::Section;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Rounding of a closed form and a few dozen operations.
const CLOSE: f64 = 1e-9;

/// The moved points of the joints of every leg, from base to platform.
fn points(manipulator: &Manipulator, at: &opm_core::Solution) -> Vec<Vec<Vector3<f64>>> {
    let mut values = at.joints();
    let of = |leg: &opm_core::Leg| {
        let count = leg.coordinates().count();
        let (own, rest) = values.split_at(count);
        values = rest;
        let mut own = own;
        let mut g = nalgebra::Isometry3::identity();
        let mut points = Vec::new();
        for joint in &leg.joints {
            points.push((g * joint.point).coords);
            let (values, rest) = own.split_at(joint.coordinates.len());
            own = rest;
            g *= joint.displacement(values).unwrap();
        }
        points
    };
    manipulator.mechanism().legs.iter().map(of).collect()
}

fn sine(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    (a.perp(&b) / (a.norm() * b.norm())).abs()
}

/// Planar 3-RRR: the input index is the sine of the angle between the two links of a leg; the output index the sine of
/// the angle between the second link and the line from its end to the point that the platform turns about while the other
/// motors are locked, where the other two second links meet (Wang, Wu, Liu 2010, section 4).
#[test]
fn planar_3rrr_has_the_sines_of_its_angles() {
    let manipulator = Manipulator::example("planar-3rrr").unwrap();
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    let (mut rng, mut at) = (Rng::with_seed(1), manipulator.solution());
    let mut compared = 0;
    while compared < 200 {
        let home = manipulator.home_pose();
        let pose: Vec<f64> = home.iter().map(|h| h + 0.2 * (rng.f64() - 0.5)).collect();
        let mode = manipulator.modes().nth(rng.usize(..8)).unwrap();
        if manipulator.inverse(&pose, mode, &mut at).unwrap().is_none() {
            continue;
        }
        let legs = points(&manipulator, &at);
        let link = |leg: usize, i: usize| (legs[leg][i + 1] - legs[leg][i]).xy();
        transmissions.update(&at);
        for found in transmissions.inputs() {
            let leg = found.leg;
            assert!((found.input - sine(link(leg, 0), link(leg, 1))).abs() < CLOSE);
            // Where the lines of the other two second links meet.
            let [a, b] = [(leg + 1) % 3, (leg + 2) % 3];
            let (p, q) = (legs[a][2].xy(), legs[b][2].xy());
            let (u, v) = (link(a, 1), link(b, 1));
            let centre = p + u * ((q - p).perp(&v) / u.perp(&v));
            let expected = sine(link(leg, 1), legs[leg][2].xy() - centre);
            assert!((found.output - expected).abs() < 1e-6, "{} {expected}", found.output);
            compared += 1;
        }
        let all = transmissions.inputs().iter().map(|found| found.input.min(found.output));
        assert_eq!(transmissions.whole().local(), all.fold(1.0, f64::min));
    }
}

/// The Agile Eye in its isotropic pose has the best transmission there is: all arcs are right angles, and so are the
/// angles between them (C. Gosselin, J.-F. Hamel, *The agile eye*, ICRA 1994).
#[test]
fn the_agile_eye_is_best_at_home() {
    let manipulator = Manipulator::example("agile-eye").unwrap();
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    let mut at = manipulator.solution();
    let home = manipulator.home_pose();
    manipulator.inverse(&home, manipulator.home_mode(), &mut at).unwrap().unwrap();
    transmissions.update(&at);
    assert_eq!(transmissions.inputs().len(), 3);
    for found in transmissions.inputs() {
        assert!(
            (found.input - 1.0).abs() < CLOSE && (found.output - 1.0).abs() < CLOSE,
            "{found:?}"
        );
    }
}

/// Spherical 3-RRR: the sine of the dihedral angle at the middle joint, and that at the platform's joint between the
/// second arc and the axis that the platform turns about while the other motors are locked.
#[test]
fn spherical_3rrr_has_the_sines_of_its_dihedral_angles() {
    for name in ["orbita", "agile-eye"] {
        let manipulator = Manipulator::example(name).unwrap();
        let mut transmissions = Transmissions::new(&manipulator).unwrap();
        let (mut rng, mut at) = (Rng::with_seed(2), manipulator.solution());
        let mut compared = 0;
        while compared < 60 {
            let home = manipulator.home_pose();
            let pose: Vec<f64> = home.iter().map(|h| h + 0.6 * (rng.f64() - 0.5)).collect();
            if manipulator.inverse(&pose, manipulator.home_mode(), &mut at).unwrap().is_none() {
                continue;
            }
            let mut values = at.joints();
            let axes: Vec<[Vector3<f64>; 3]> = (manipulator.mechanism().legs.iter())
                .map(|leg| {
                    let mut turned = UnitQuaternion::identity();
                    let (own, rest) = values.split_at(3);
                    values = rest;
                    [0, 1, 2].map(|i| {
                        let joint = &leg.joints[i];
                        let axis = turned * joint.axis.into_inner();
                        turned *= joint.displacement(&own[i..=i]).unwrap().rotation;
                        axis
                    })
                })
                .collect();
            let dihedral = |at: Vector3<f64>, a: Vector3<f64>, b: Vector3<f64>| {
                let [a, b] = [a, b].map(|c| (c - at * at.dot(&c)).normalize());
                a.cross(&b).norm()
            };
            transmissions.update(&at);
            for found in transmissions.inputs() {
                let [u, v, w] = axes[found.leg];
                assert!((found.input - dihedral(v, u, w)).abs() < CLOSE);
                let [a, b] = [1, 2].map(|i| axes[(found.leg + i) % 3]);
                let turns = a[1].cross(&a[2]).cross(&b[1].cross(&b[2])).normalize();
                assert!((found.output - dihedral(w, v, turns)).abs() < 1e-7);
                compared += 1;
            }
        }
    }
}

/// A platform of three legs of one kind, a third of a turn apart, has equal indices in all legs at a symmetric pose, and
/// poses that mirror or turn it have the same indices.
#[test]
fn symmetric_legs_are_alike() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    let mut at = manipulator.solution();
    let mut of = |pose: &[f64]| {
        manipulator.inverse(pose, manipulator.home_mode(), &mut at).unwrap().unwrap();
        transmissions.update(&at);
        transmissions.inputs().to_vec()
    };
    let found = of(&[0.0; 5]);
    let sliders: Vec<_> =
        found.iter().filter(|f| f.leg < 3).map(|f| (f.section, f.input, f.output)).collect();
    assert_eq!(sliders.len(), 6);
    for section in [Section::Lower, Section::Upper] {
        let own: Vec<_> = sliders.iter().filter(|(s, ..)| *s == section).collect();
        assert!(
            own.iter().all(|(_, i, o)| (i - own[0].1).abs() < 1e-9 && (o - own[0].2).abs() < 1e-9)
        );
    }
    // Rotating a tilted platform by 120 degrees about the vertical puts leg 1 where leg 2 was.
    let [a, b] = [0.2, 0.2 + TAU / 3.0].map(|zeta| of(&[0.0, 0.0, zeta, 0.3, -zeta]));
    for section in [Section::Lower, Section::Upper] {
        for leg in 0..3 {
            let of = |all: &[opm_analysis::InputIndices], leg: usize| {
                let found = all.iter().find(|f| f.leg == leg && f.section == section).unwrap();
                Vector2::new(found.input, found.output)
            };
            let next = (leg + 1) % 3;
            assert!((of(&a, leg) - of(&b, next)).norm() < 1e-9, "{section} {leg}");
        }
    }
}

/// The arm of the first manipulator of the paper: the sine of its elbow, and that of the angle between the forearm and the
/// line to its shoulder. A slider: the cosine of the angle between its rod and the slider, and the sine of that between
/// both rods, which are zero at the singularities of section 3.1.
#[test]
fn sections_have_the_angles_of_the_paper() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    let mut at = manipulator.solution();
    let (x, y) = (0.012, -0.02);
    let pose = [x, y, 0.1, 0.3, -0.2];
    manipulator.inverse(&pose, manipulator.home_mode(), &mut at).unwrap().unwrap();
    transmissions.update(&at);
    let e = |angle: f64| Vector2::new(angle.cos(), angle.sin());
    let value = |name: &str| {
        at.joints()[manipulator.coordinates().iter().position(|c| c.name == name).unwrap()]
    };
    let (h, a2) = (0.12, 0.06);
    for leg in 0..3 {
        let alpha = f64::from([30, 150, 270][leg]).to_radians();
        let theta = at.imaginary()[leg];
        let end = Vector2::new(x, y) + e(theta) * a2 - e(alpha) * h;
        let rod = end - e(alpha + FRAC_PI_2) * value(&format!("S{}", leg + 1));
        let own = |section| {
            let found = transmissions.inputs().iter();
            found.clone().find(|f| f.leg == leg && f.section == section).unwrap()
        };
        let lower = own(Section::Lower);
        assert!((lower.input - sine(rod, e(alpha))).abs() < CLOSE, "{lower:?}");
        assert!((lower.output - sine(rod, e(theta))).abs() < CLOSE, "{lower:?}");
        // The second arc is perpendicular to its dihedral angle's axis at 75 degrees from the vertical.
        assert!(own(Section::Upper).coordinate.is_none());
    }
    let base = Vector2::new(0.0, 0.075);
    let first = e(value("phi14")) * 0.1;
    let elbow = base + first;
    let second = Vector2::new(x, y) - elbow;
    assert!((second.norm() - 0.1).abs() < 1e-12);
    let arm: Vec<_> = transmissions.inputs().iter().filter(|f| f.leg == 3).collect();
    let reach = Vector2::new(x, y) - base;
    let expected = [
        // The force along the forearm on the upper arm, and on the point, which turns about the shoulder.
        (sine(first, second), sine(second, reach)),
        // The force along the line from the shoulder on the forearm, and on the point, which turns about the elbow.
        (sine(second, reach), sine(reach, second)),
    ];
    assert_eq!(arm.len(), 2);
    for (found, (input, output)) in arm.iter().zip(expected) {
        assert!(
            (found.input - input).abs() < CLOSE && (found.output - output).abs() < CLOSE,
            "{found:?} {input} {output}"
        );
    }
    let least = |section| transmissions.section(section).unwrap();
    let whole = transmissions.whole();
    let both = [least(Section::Lower), least(Section::Upper)].map(|t| Transmission::local(&t));
    assert_eq!(whole.local(), both[0].min(both[1]));
}
