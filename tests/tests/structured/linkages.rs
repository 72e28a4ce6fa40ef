//! Linkages at half and quarter turns of their inputs, at home, and at the ends of their ranges.

use nalgebra::{Point3, Unit, Vector3};
use opm_core::Linkage;
use opm_core::linkage::InputRange;
use opm_core::mechanism::joint::{Joint, JointKind, Quantity};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, TaskHints, examples, file};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The bound on closure of the loop, metres and radians: the shipped linkage is about a metre in size.
const CLOSES: f64 = 1e-10;

fn shipped() -> Mechanism {
    file::read(examples::find("bennett-double-spherical-6r").unwrap().text).unwrap().mechanism
}

/// How far the platform by one leg is from the platform by the other, from the products of exponentials.
fn gap(mechanism: &Mechanism, joints: &[f64]) -> f64 {
    let (one, two) = joints.split_at(mechanism.legs[0].coordinates().count());
    let [one, two] =
        [(0, one), (1, two)].map(|(leg, q)| mechanism.legs[leg].displacement(q).unwrap());
    (one.to_homogeneous() - two.to_homogeneous()).norm()
}

#[test]
fn structured_inputs_close_the_loop() {
    let mechanism = shipped();
    let linkage = Linkage::new(&mechanism).unwrap();
    let mut closed = 0;
    for coordinate in linkage.coordinates() {
        let input = linkage.input(&coordinate.name).unwrap();
        let mut values: Vec<f64> = (-16..=16).map(|n| f64::from(n) * FRAC_PI_4).collect();
        values.extend((-8..=8).map(|n| coordinate.home + f64::from(n) * FRAC_PI_2));
        for value in values {
            let positions = input.solve(value);
            assert_eq!(!positions.is_empty(), input.range().contains(value), "{value}");
            for position in positions {
                let off = gap(&mechanism, &position.joints);
                assert!(off < CLOSES, "{} = {value}: {off:e}", coordinate.name);
                closed += 1;
            }
        }
        // Home is one of the positions at its own input.
        let home =
            |q: &[f64]| linkage.coordinates().iter().zip(q).all(|(c, q)| (q - c.home).abs() < 1e-7);
        let at_home = input.solve(coordinate.home);
        assert!(at_home.iter().any(|position| home(&position.joints)), "{}", coordinate.name);
        if let InputRange::Intervals { intervals, .. } = input.range() {
            for end in intervals.iter().flatten() {
                for position in input.solve(*end) {
                    // Two branches meet there, so that half of the digits are lost.
                    assert!(
                        gap(&mechanism, &position.joints) < 1e-7,
                        "{} at {end}",
                        coordinate.name
                    );
                    closed += 1;
                }
            }
        }
    }
    assert!(closed > 200, "{closed}");
}

fn revolute(name: &str, axis: Vector3<f64>, [x, y, z]: [f64; 3]) -> Joint {
    Joint::new(name, JointKind::Revolute, Unit::new_normalize(axis), Point3::new(x, y, z))
}

fn slider(name: &str, axis: Vector3<f64>) -> Joint {
    Joint::new(name, JointKind::Prismatic, Unit::new_normalize(axis), Point3::origin())
}

/// A linkage of which one leg moves in the lower subspace and the other one in the upper one.
fn apart(mut lower: Vec<Joint>, upper: Vec<Joint>) -> Mechanism {
    lower[0].actuated = true;
    let legs = vec![Leg::new("lower", lower), Leg::new("upper", upper)];
    let platform = Point3::origin();
    Mechanism {
        name: "structured".into(),
        legs,
        platform,
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}

/// Planar loops with a pivot at the origin, which is the imaginary joint, about z.
fn planar_loops() -> Vec<(&'static str, Vec<Joint>)> {
    let pivot = |name: &str, x: f64, y: f64| revolute(name, Vector3::z(), [x, y, 0.0]);
    let four_bar = |points: [[f64; 2]; 3]| {
        let [a, b, c] = points;
        vec![pivot("a1", a[0], a[1]), pivot("a2", b[0], b[1]), pivot("a3", c[0], c[1])]
    };
    let corner = (0.6 + 0.14_f64.sqrt()) / 4.0;
    let (sin, cos) = 50_f64.to_radians().sin_cos();
    vec![
        ("parallelogram", four_bar([[0.3, 0.0], [0.4, 0.2], [0.1, 0.2]])),
        ("square", four_bar([[0.2, 0.0], [0.2, 0.2], [0.0, 0.2]])),
        ("kite", four_bar([[0.3, 0.0], [corner, corner], [0.0, 0.3]])),
        (
            "slider-crank, no offset, equal links",
            vec![
                pivot("a1", 0.2 * cos, 0.2 * sin),
                pivot("a2", 0.4 * cos, 0.0),
                slider("a3", Vector3::x()),
            ],
        ),
        (
            "slider-crank at right angles",
            vec![pivot("a1", 0.2, 0.0), pivot("a2", 0.2, 0.3), slider("a3", Vector3::y())],
        ),
        (
            "inverted slider-crank, no offset",
            vec![
                pivot("a1", 0.2, 0.1),
                slider("a2", Vector3::new(0.3, -0.1, 0.0)),
                pivot("a3", 0.5, 0.0),
            ],
        ),
        (
            "Scotch yoke",
            vec![pivot("a1", 0.1, 0.1), slider("a2", Vector3::x()), slider("a3", Vector3::y())],
        ),
    ]
}

/// Spherical loops about the origin with the imaginary joint along z.
fn spherical_loops() -> Vec<(&'static str, Vec<Joint>)> {
    let about = |axes: [Vector3<f64>; 3]| {
        let name = |i: usize| format!("b{}", i + 1);
        axes.iter().enumerate().map(|(i, axis)| revolute(&name(i), *axis, [0.0; 3])).collect()
    };
    let (sin, cos) = 40_f64.to_radians().sin_cos();
    let (first, last) = (Vector3::new(cos, sin, 0.0), Vector3::new(1.0, 0.0, 1.0));
    let arm = |around: f64| {
        let (sin, cos) = around.to_radians().sin_cos();
        Vector3::new(0.75_f64.sqrt() * cos, 0.75_f64.sqrt() * sin, 0.5)
    };
    let middle = (arm(0.0) + arm(80.0)).normalize();
    vec![
        ("Hooke's joint", about([first, first.cross(&last), last])),
        // All arcs are 60 degrees.
        ("rhombus", about([arm(0.0), middle * (2.0 * middle.z) - Vector3::z(), arm(80.0)])),
    ]
}

/// Sarrus' linkage with equal plates of 0.1 m whose hinges are above each other, its plates at right
/// angles, and one with a crank that passes through the line of the slider.
fn sarrus_linkages() -> Vec<(&'static str, Mechanism)> {
    let side = |letter: char, out: Vector3<f64>, points: [[f64; 2]; 3]| -> Vec<Joint> {
        let axis = out.cross(&Vector3::z());
        let place = |[r, h]: [f64; 2]| (out * r + Vector3::z() * h).into();
        let joint = |(i, p)| revolute(&format!("{letter}{}", i + 1), axis, place(p));
        points.into_iter().enumerate().map(joint).collect()
    };
    let (x, y) = (Vector3::x(), Vector3::y());
    let (sin, cos) = (0.08, 0.06);
    let equal = [[0.05, 0.0], [0.05 + cos, sin], [0.05, 2.0 * sin]];
    let square = [[0.05, 0.0], [0.15, 0.0], [0.15, 0.16]];
    vec![
        ("equal", apart(side('a', x, equal), side('b', y, equal))),
        ("equal, oblique", apart(side('a', x, equal), side('b', x + y, equal))),
        ("right angles", apart(side('a', x, equal), side('b', y, square))),
    ]
}

#[test]
fn structured_sections_close_the_loop() {
    let mut linkages: Vec<(String, Mechanism)> = Vec::new();
    for (planar, lower) in planar_loops() {
        for (spherical, upper) in spherical_loops() {
            linkages.push((format!("{planar}, {spherical}"), apart(lower.clone(), upper)));
        }
    }
    linkages.extend(sarrus_linkages().into_iter().map(|(name, m)| (format!("Sarrus, {name}"), m)));
    let (mut closed, mut folded) = (0, 0);
    for (name, mechanism) in linkages {
        let linkage = Linkage::new(&mechanism).unwrap_or_else(|error| panic!("{name}: {error}"));
        for coordinate in linkage.coordinates() {
            let input = linkage.input(&coordinate.name).unwrap();
            let range = input.range();
            let step = if coordinate.quantity == Quantity::Angle { FRAC_PI_4 } else { 0.01 };
            for value in (-24..=24).map(|n| coordinate.home + f64::from(n) * step) {
                let positions = input.solve(value);
                // A structured input may be at an end, or fold a loop without changing its range.
                let inside = [-1e-9, 1e-9].map(|off| range.contains(value + off));
                let found = !positions.is_empty();
                assert!(inside.contains(&found), "{name}: {} = {value}", coordinate.name);
                for position in positions {
                    let off = gap(&mechanism, &position.joints);
                    assert!(off < 1e-7, "{name}: {} = {value}: {off:e}", coordinate.name);
                    folded += usize::from(input.rates(&position).is_none());
                    closed += 1;
                }
            }
            let home = input.solve(coordinate.home);
            let at_home = |q: &[f64]| {
                linkage.coordinates().iter().zip(q).all(|(c, q)| (q - c.home).abs() < 1e-7)
            };
            assert!(home.iter().any(|position| at_home(&position.joints)), "{name}");
        }
    }
    println!("{closed} positions, {folded} at dead points");
    assert!(closed > 3_000 && folded > 20, "{closed} {folded}");
}
