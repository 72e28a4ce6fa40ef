//! Masses, centres and inertias that a mechanism gives, and a payload, against points that move with the bodies.

#[allow(dead_code, reason = "energies are for other tests")]
mod bodies;

use bodies::Bodies;
use nalgebra::{DMatrix, DVector, Matrix3, Point3, Vector3};
use opm_analysis::{Dynamics, Gravity, Setup};
use opm_core::Manipulator;
use opm_core::mechanism::{BodyMasses, Mechanism, Payload};
use opm_core::skeleton::Density;

const STEP: f64 = 1e-4;

/// Masses of points in base coordinates at home, about a point, kilograms and metres: no axis of symmetry.
fn points(about: Point3<f64>, size: f64) -> Vec<(f64, Point3<f64>)> {
    let all = [
        (0.7, [0.3, 0.1, -0.2]),
        (0.2, [-0.4, 0.2, 0.1]),
        (0.5, [0.1, -0.3, 0.5]),
        (0.4, [0.2, 0.6, 0.3]),
    ];
    all.map(|(mass, at)| (mass, about + Vector3::from(at) * size)).to_vec()
}

/// The mass of points, its centre, and its inertia about that centre, by Huygens and Steiner's theorem from that about the origin.
fn as_body(points: &[(f64, Point3<f64>)]) -> (f64, Point3<f64>, Matrix3<f64>) {
    let square = |v: &Vector3<f64>| Matrix3::identity() * v.norm_squared() - v * v.transpose();
    let mass: f64 = points.iter().map(|(mass, _)| mass).sum();
    let centre: Vector3<f64> = points.iter().map(|(m, at)| at.coords * (*m / mass)).sum();
    let about_origin: Matrix3<f64> = points.iter().map(|(m, at)| square(&at.coords) * *m).sum();
    (mass, centre.into(), about_origin - square(&centre) * mass)
}

fn with(mechanism: &Mechanism, bodies: BodyMasses) -> Manipulator {
    Manipulator::new(Mechanism { bodies, ..mechanism.clone() }).unwrap()
}

/// What a body adds to the mass matrix, and to the forces that a motion needs, at a pose; two mechanisms differ by the body.
fn added(
    [without, with]: [&Manipulator; 2],
    gravity: &Gravity,
    [x, v, a]: [&DVector<f64>; 3],
) -> (DMatrix<f64>, DVector<f64>) {
    let [without, with] = [without, with].map(|m| {
        let setup = Setup { gravity: Some(*gravity), ..Setup::new(m.characteristic_length()) };
        let at = Bodies::new(m, gravity).solved(x.as_slice()).expect("in reach");
        let mut dynamics = Dynamics::new(m, &setup);
        assert!(dynamics.update(&at).unwrap());
        let mass = dynamics.mass_matrix().unwrap();
        let forces = &mass * a + dynamics.bias(v).unwrap() + dynamics.gravity().unwrap();
        (mass, forces)
    });
    (with.0 - without.0, with.1 - without.1)
}

/// Newton's second law for each point, whose places are those of a body of the skeleton, with differences of fourth order.
fn of_points(
    m: &Manipulator,
    body: usize,
    points: &[(f64, Point3<f64>)],
    gravity: &Gravity,
    [x, v, a]: [&DVector<f64>; 3],
) -> (DMatrix<f64>, DVector<f64>) {
    let bodies = Bodies::new(m, gravity);
    let home = bodies.placed(&m.home_pose()).expect("home")[body];
    let place = |x: &DVector<f64>, at: &Point3<f64>| {
        bodies.placed(x.as_slice()).expect("in reach")[body] * (home.inverse() * at)
    };
    let count = x.len();
    let (mut mass, mut forces) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for (kilograms, at) in points {
        let rate = |j: usize| {
            let of = |k: f64| {
                let mut moved = x.clone();
                moved[j] += k * STEP;
                place(&moved, at).coords
            };
            ((of(1.0) - of(-1.0)) * 8.0 - (of(2.0) - of(-2.0))) / (12.0 * STEP)
        };
        let columns: Vec<Vector3<f64>> = (0..count).map(rate).collect();
        let jacobian = DMatrix::from_fn(3, count, |i, j| columns[j][i]);
        let time = 10.0 * STEP;
        let on_path = |k: f64| {
            let t = k * time;
            place(&(x + v * t + a * (0.5 * t * t)), at).coords
        };
        let sides = [1.0, 2.0].map(|k| on_path(k) + on_path(-k));
        let acceleration =
            (sides[0] * 16.0 - sides[1] - on_path(0.0) * 30.0) / (12.0 * time * time);
        mass += jacobian.tr_mul(&jacobian) * *kilograms;
        let needed = (acceleration - gravity.acceleration) * *kilograms;
        forces += jacobian.tr_mul(&DVector::from_column_slice(needed.as_slice()));
    }
    (mass, forces)
}

fn compare(
    name: &str,
    found: &(DMatrix<f64>, DVector<f64>),
    expected: &(DMatrix<f64>, DVector<f64>),
) {
    let off = (&found.0 - &expected.0).amax();
    assert!(off < 1e-7 * expected.0.amax(), "{name}: {} {}", found.0, expected.0);
    let off = (&found.1 - &expected.1).amax();
    assert!(off < 1e-6 * expected.1.amax(), "{name}: {} {}", found.1, expected.1);
}

#[test]
fn what_a_file_gives_moves_as_points_do() {
    let acceleration = Vector3::new(0.3, -0.5, -9.81);
    let gravity = Gravity { acceleration, density: Density::default() };
    for name in ["delta", "stewart", "plano-spherical-5dof", "planar-3rrr", "tricept"] {
        let m = Manipulator::example(name).unwrap();
        let (mechanism, size) = (m.mechanism(), m.characteristic_length());
        let home = DVector::from_vec(m.home_pose());
        let vector = |size_of: f64, seed: usize| {
            DVector::from_fn(home.len(), |j, _| {
                let length = m.task_coordinates()[j].quantity == opm_core::Quantity::Length;
                let unit = if length { size } else { 1.0 };
                size_of * unit * (1.0 + 2.3 * (seed + j) as f64).sin()
            })
        };
        let (x, v, a) = (&home + vector(0.05, 0), vector(1.2, 3), vector(5.0, 7));
        let platform = mechanism.body_names().count();

        // On the platform.
        let carried = points(mechanism.platform, size);
        let (mass, centre, inertia) = as_body(&carried);
        let payload = Some(Payload { mass, centre: Some(centre), inertia });
        let laden = with(mechanism, BodyMasses { payload, ..BodyMasses::default() });
        let state = [&x, &v, &a];
        let found = added([&m, &laden], &gravity, state);
        compare(name, &found, &of_points(&m, platform, &carried, &gravity, state));

        // In place of a link: of the one without a mass there is a microgram.
        let link = mechanism.body_names().next().unwrap().to_owned();
        let own = points(mechanism.legs[0].joints[0].point, size);
        let (mass, centre, inertia) = as_body(&own);
        let none = BodyMasses { masses: vec![(link.clone(), 1e-9)], ..BodyMasses::default() };
        let given = BodyMasses {
            masses: vec![(link.clone(), mass)],
            centres: vec![(link.clone(), centre)],
            inertias: vec![(link, inertia)],
            ..BodyMasses::default()
        };
        let both = [&with(mechanism, none), &with(mechanism, given)];
        let found = added(both, &gravity, state);
        compare(name, &found, &of_points(&m, 1, &own, &gravity, state));
    }
}

/// Without a centre it is at the platform's reference point, without an inertia a point.
#[test]
fn a_payload_is_a_point_if_nothing_else_is_given() {
    let text = include_str!("lift.toml");
    let masses = "masses = { platform = 3 }\n";
    assert!(text.contains(masses));
    let weight = |payload: &str| {
        let text = text.replace(masses, &format!("{masses}{payload}\n"));
        let m = Manipulator::read(&text).unwrap();
        let mut dynamics = Dynamics::new(&m, &Setup::new(1.0));
        assert!(dynamics.update(&m.solution()).unwrap());
        dynamics.gravity().unwrap().amax()
    };
    let own = weight("");
    let laden = weight("payload = { mass = 2 }");
    assert!((laden - own - 2.0 * 9.81).abs() < 1e-12, "{own} {laden}");
}
