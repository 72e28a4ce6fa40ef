//! A random mechanism that is written and read again is the same.

use crate::mechanism::file::{AngleUnit, Digits, FileUnits, LengthUnit, read, write};
use crate::mechanism::joint::{Joint, JointKind, MotionLimits};
use crate::mechanism::leg::Leg;
use crate::mechanism::{
    BodyMasses, Cone, Difference, FrameHints, HOME_COORDINATES, Mechanism, Obstacle, ObstacleShape,
    OrientationCoordinates, Payload, Shapes, TaskHints,
};
use nalgebra::{Matrix3, Point3, Unit, Vector3};
use proptest::prelude::*;

/// Files have 12 decimals, in metres at worst.
const WRITTEN: f64 = 1e-12;

fn direction() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64]
        .prop_map(Vector3::from)
        .prop_filter("a direction", |v| v.norm() > 0.1)
        .prop_map(Unit::new_normalize)
}

fn point() -> impl Strategy<Value = Point3<f64>> {
    [-2.0..2.0, -2.0..2.0, -2.0..2.0_f64].prop_map(Point3::from)
}

fn kind() -> impl Strategy<Value = JointKind> {
    prop_oneof![
        Just(JointKind::Revolute),
        Just(JointKind::Prismatic),
        Just(JointKind::Cylindrical),
        Just(JointKind::Spherical),
        prop_oneof![-1.0..-0.01, 0.01..1.0].prop_map(|pitch| JointKind::Helical { pitch }),
        direction().prop_map(|second| JointKind::Universal { second }),
    ]
}

prop_compose! {
    /// A joint that has no name yet.
    fn joint()(
        kind in kind(), axis in direction(), point in point(), actuated in any::<bool>(),
        home in [-2.0..2.0, -2.0..2.0, -2.0..2.0_f64],
        room in proptest::option::of([0.0..1.0, 0.0..1.0_f64]),
        largest in [
            proptest::option::of(0.1..3.0_f64), proptest::option::of(0.1..3.0_f64),
            proptest::option::of(0.1..300.0_f64),
        ],
    ) -> Joint {
        let axis = match kind {
            JointKind::Spherical => Vector3::z_axis(),
            JointKind::Universal { second } if axis.cross(&second).norm() < 0.01 => {
                // Any direction that is not parallel to the second axis.
                Unit::new_normalize(Vector3::new(second.y, second.z, second.x) + Vector3::x() * 2.0)
            }
            _ => axis,
        };
        let mut joint = Joint::new("", kind, axis, point);
        joint.actuated = actuated;
        for (coordinate, home) in joint.coordinates.iter_mut().zip(home) {
            coordinate.home = home;
            coordinate.limits = room.map(|[below, above]| [home - below, home + above]);
            let [max_rate, max_acceleration, max_effort] = largest;
            coordinate.motion_limits = MotionLimits { max_rate, max_acceleration };
            coordinate.max_effort = max_effort;
        }
        let tilts = matches!(joint.kind, JointKind::Universal { .. } | JointKind::Spherical);
        let half_angle = room.filter(|_| tilts).map(|[below, above]| 0.2 + below + above);
        joint.cone = half_angle.map(|half_angle| Cone { half_angle, axis: None });
        joint
    }
}

prop_compose! {
    fn frame()(
        x in proptest::option::of(direction()), axis in proptest::option::of(direction()),
        w in proptest::option::of(direction()),
        normal in proptest::option::of(direction()), origin in proptest::option::of(point()),
    ) -> FrameHints {
        let [x, axis, w, normal] = [x, axis, w, normal].map(|given| given.map(Unit::into_inner));
        FrameHints { x, axis, w, normal, origin }
    }
}

prop_compose! {
    fn task()(
        axis in proptest::option::of(direction()), lower in frame(), upper in frame(),
        home in prop::sample::subsequence(&HOME_COORDINATES[..], 0..=HOME_COORDINATES.len()),
        values in prop::collection::vec(-3.0..3.0_f64, HOME_COORDINATES.len()),
        coordinates in proptest::option::of(prop::sample::select(&OrientationCoordinates::NAMED[..])),
        independent in prop::sample::subsequence(vec!["x", "y", "z", "roll"], 0..=4),
    ) -> TaskHints {
        let home = home.into_iter().zip(values).map(|((name, _), value)| (name.to_owned(), value));
        let axis = axis.map(Unit::into_inner);
        let coordinates = coordinates.map(|(_, coordinates)| coordinates);
        let independent = independent.into_iter().map(str::to_owned).collect();
        TaskHints { axis, lower, upper, coordinates, home: home.collect(), independent }
    }
}

/// Every vector of a `[task]`.
fn vectors(task: &TaskHints) -> Vec<Option<Vector3<f64>>> {
    let frame = |f: &FrameHints| [f.x, f.axis, f.w, f.normal, f.origin.map(|p| p.coords)];
    [task.axis].into_iter().chain(frame(&task.lower)).chain(frame(&task.upper)).collect()
}

fn obstacle() -> impl Strategy<Value = ObstacleShape> {
    let length = || 0.01..2.0_f64;
    let edges = prop_oneof![
        Just(ObstacleShape::level()),
        [direction(), direction()].prop_filter("two edges", |[x, y]| x.cross(y).norm() > 0.1),
    ];
    prop_oneof![
        (point(), [length(), length(), length()], edges).prop_map(|(centre, size, edges)| {
            ObstacleShape::Box { centre, size: size.into(), edges }
        }),
        ([point(), point()], length())
            .prop_map(|(ends, radius)| ObstacleShape::Capsule { ends, radius }),
        (point(), direction())
            .prop_map(|(point, normal)| ObstacleShape::HalfSpace { point, normal }),
    ]
}

/// Every number of a shape.
fn numbers_of(shape: &ObstacleShape) -> Vec<f64> {
    match shape {
        ObstacleShape::Box { centre, size, edges: [x, y] } => {
            let numbers = centre.iter().chain(size.iter());
            numbers.chain(x.iter()).chain(y.iter()).copied().collect()
        }
        ObstacleShape::Capsule { ends: [a, b], radius } => {
            a.iter().chain(b.iter()).chain([radius]).copied().collect()
        }
        ObstacleShape::HalfSpace { point, normal } => {
            point.iter().chain(normal.iter()).copied().collect()
        }
    }
}

/// The inertia of a body that consists of three points.
fn inertia() -> impl Strategy<Value = Matrix3<f64>> {
    let of_point = |p: Point3<f64>| {
        Matrix3::identity() * p.coords.norm_squared() - p.coords * p.coords.transpose()
    };
    prop_oneof![
        Just(Matrix3::zeros()),
        [point(), point(), point()].prop_map(move |all| all.map(of_point).into_iter().sum()),
    ]
}

fn mechanism() -> impl Strategy<Value = Mechanism> {
    let legs = prop::collection::vec(prop::collection::vec(joint(), 1..6), 2..6);
    // Names consist of all letters that a name may have.
    let names = proptest::string::string_regex(r#"[^\pC\s,="](.{0,8}[^\pC\s,="])?"#);
    let names = names.unwrap().prop_filter("a name", |name| {
        !name.contains(|c: char| crate::text::is_unseen(c) || ",=\"".contains(c))
    });
    let payload = (0.01..9.0_f64, proptest::option::of(point()), inertia());
    let payload = payload.prop_map(|(mass, centre, inertia)| Payload { mass, centre, inertia });
    let weights = (
        proptest::option::of(1.0..9e3_f64),
        prop::collection::vec(0.01..9.0_f64, 0..30),
        prop::collection::vec((point(), inertia()), 0..30),
        proptest::option::of(payload),
    );
    let around = (
        proptest::option::of(0.001..0.1_f64),
        prop::collection::vec(0.001..0.1_f64, 0..30),
        prop::collection::vec(obstacle(), 0..4),
    );
    let all = (names, legs, point(), task(), weights, around);
    all.prop_map(|(name, legs, platform, task, weights, around)| {
        let mut number = 0;
        let mut legs: Vec<Leg> = legs
            .into_iter()
            .enumerate()
            .map(|(i, joints)| {
                let named = joints.into_iter().map(|joint| {
                    number += 1;
                    let mut named =
                        Joint::new(format!("{name}{number}"), joint.kind, joint.axis, joint.point);
                    (named.actuated, named.cone) = (joint.actuated, joint.cone);
                    for (to, from) in named.coordinates.iter_mut().zip(joint.coordinates) {
                        (to.home, to.limits) = (from.home, from.limits);
                    }
                    named
                });
                let mut leg = Leg::new(format!("{name} {i}"), named.collect());
                let rods: Vec<usize> = leg.cones().iter().map(|cone| cone.joint).collect();
                for (number, joint) in leg.joints.iter_mut().enumerate() {
                    joint.cone = joint.cone.filter(|_| rods.contains(&number));
                    if let Some(cone) = joint.cone.as_mut().filter(|_| number % 2 == 1) {
                        cone.half_angle = 3.0;
                        cone.axis = Some(joint.axis);
                    }
                }
                let inside = leg.cones();
                let inside = inside.iter().filter(|cone| cone.admits(&[0.0; 3]));
                let inside: Vec<usize> = inside.map(|cone| cone.joint).collect();
                for (number, joint) in leg.joints.iter_mut().enumerate() {
                    joint.cone = joint.cone.filter(|_| inside.contains(&number));
                }
                leg
            })
            .collect();
        legs[0].joints[0].actuated = true;
        let (bodies, shapes) = (BodyMasses::default(), Shapes::default());
        let mut mechanism = Mechanism {
            name,
            legs,
            platform,
            differences: Vec::new(),
            task,
            bodies,
            shapes,
            units: FileUnits::SI,
        };
        // Between the first two of a kind.
        let all: Vec<_> = mechanism.coordinates().cloned().collect();
        let other = all[1..].iter().find(|c| c.quantity == all[0].quantity);
        mechanism.differences.extend(other.map(|other| {
            let (joints, home) =
                ([&all[0], other].map(|c| c.name.clone()), all[0].home - other.home);
            Difference { joints, limits: [home - 1.0, home + 0.5] }
        }));
        let names: Vec<_> = mechanism.body_names().map(str::to_owned).collect();
        let (density, masses, placed, payload) = weights;
        let with_names = || names.iter().cloned();
        mechanism.bodies = BodyMasses {
            density,
            masses: with_names().zip(masses).collect(),
            centres: with_names().zip(placed.iter().map(|of| of.0)).collect(),
            inertias: with_names().zip(placed.iter().map(|of| of.1)).collect(),
            payload,
        };
        let (radius, radii, shapes) = around;
        let bodies = mechanism.body_names().chain([Shapes::BASE]).map(str::to_owned);
        let radii = bodies.zip(radii).collect();
        let obstacle =
            |(number, shape)| Obstacle { name: format!("{} {number}", mechanism.name), shape };
        let obstacles = shapes.into_iter().enumerate().map(obstacle).collect();
        mechanism.shapes = Shapes { radius, radii, obstacles };
        mechanism
    })
}

fn units() -> impl Strategy<Value = FileUnits> {
    (prop::sample::select(&LengthUnit::ALL[..]), prop::sample::select(&AngleUnit::ALL[..]))
        .prop_map(|(length, angle)| FileUnits { length, angle })
}

/// Every number of a joint, and everything else of it.
fn numbers(joint: &Joint) -> (Vec<f64>, impl PartialEq + std::fmt::Debug) {
    let mut numbers: Vec<f64> = joint.axis.iter().chain(joint.point.iter()).copied().collect();
    let kind = match joint.kind {
        JointKind::Helical { pitch } => {
            numbers.push(pitch);
            JointKind::Helical { pitch: 0.0 }
        }
        JointKind::Universal { second } => {
            numbers.extend(second.iter());
            JointKind::Universal { second: Vector3::x_axis() }
        }
        kind => kind,
    };
    for coordinate in &joint.coordinates {
        numbers.push(coordinate.home);
        numbers.extend(coordinate.limits.into_iter().flatten());
    }
    if let Some(Cone { half_angle, axis }) = &joint.cone {
        numbers.push(*half_angle);
        numbers.extend(axis.iter().flat_map(|axis| axis.iter()));
    }
    let names: Vec<_> = joint.coordinates.iter().map(|c| (c.name.clone(), c.quantity)).collect();
    (numbers, (joint.name.clone(), kind, joint.actuated, names))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read(mechanism in mechanism(), units in units()) {
        let text = write(&mechanism, units, Digits::Sure);
        let file = read(&text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(file.units, units);
        let read = file.mechanism;
        prop_assert_eq!(&read.name, &mechanism.name);
        prop_assert!((read.platform - mechanism.platform).norm() < WRITTEN);
        for (read, written) in vectors(&read.task).iter().zip(vectors(&mechanism.task)) {
            prop_assert_eq!(read.is_some(), written.is_some());
            let off = read.unwrap_or_default() - written.unwrap_or_default();
            prop_assert!(off.norm() < WRITTEN, "{text}");
        }
        let (found, expected) = (&read.bodies, &mechanism.bodies);
        prop_assert_eq!(found.density, expected.density);
        prop_assert_eq!(&found.masses, &expected.masses);
        prop_assert_eq!(&found.inertias, &expected.inertias);
        prop_assert_eq!(found.centres.len(), expected.centres.len());
        for ((name, centre), (other, expected)) in found.centres.iter().zip(&expected.centres) {
            prop_assert!(name == other && (centre - expected).norm() < WRITTEN, "{text}");
        }
        prop_assert_eq!(
            found.payload.map(|of| (of.mass, of.centre.is_some(), of.inertia)),
            expected.payload.map(|of| (of.mass, of.centre.is_some(), of.inertia))
        );
        if let (Some(found), Some(expected)) = (found.payload, expected.payload) {
            let off = found.centre.unwrap_or_default() - expected.centre.unwrap_or_default();
            prop_assert!(off.norm() < WRITTEN, "{text}");
        }
        let (found, expected) = (&read.shapes, &mechanism.shapes);
        let near = |a: f64, b: f64| (a - b).abs() < WRITTEN;
        prop_assert_eq!(found.radius.is_some(), expected.radius.is_some());
        prop_assert!(near(found.radius.unwrap_or_default(), expected.radius.unwrap_or_default()));
        prop_assert_eq!(found.radii.len(), expected.radii.len());
        for ((name, radius), (other, expected)) in found.radii.iter().zip(&expected.radii) {
            prop_assert!(name == other && near(*radius, *expected), "{text}");
        }
        prop_assert_eq!(found.obstacles.len(), expected.obstacles.len());
        for (found, expected) in found.obstacles.iter().zip(&expected.obstacles) {
            prop_assert_eq!(&found.name, &expected.name);
            let [found, expected] = [found, expected].map(|obstacle| numbers_of(&obstacle.shape));
            prop_assert_eq!(found.len(), expected.len());
            prop_assert!(found.iter().zip(expected).all(|(a, b)| near(*a, b)), "{text}");
        }
        prop_assert_eq!(read.task.coordinates, mechanism.task.coordinates);
        prop_assert_eq!(read.task.home.len(), mechanism.task.home.len());
        for (read, written) in read.task.home.iter().zip(&mechanism.task.home) {
            prop_assert_eq!(&read.0, &written.0);
            prop_assert!((read.1 - written.1).abs() < WRITTEN);
        }
        let names = |m: &Mechanism| -> Vec<_> {
            m.legs.iter().map(|leg| (leg.name.clone(), leg.joints.len())).collect()
        };
        prop_assert_eq!(names(&read), names(&mechanism));
        for (read, written) in read.joints().zip(mechanism.joints()) {
            let ((found, rest), (expected, other)) = (numbers(read), numbers(written));
            prop_assert_eq!(rest, other);
            prop_assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() < WRITTEN, "{found} {expected}\n{text}");
            }
        }
    }

    /// Unit vectors may differ in the last digit, because reading normalises them again.
    #[test]
    fn all_digits_are_read_again(mechanism in mechanism()) {
        let text = write(&mechanism, FileUnits::SI, Digits::All);
        let read = read(&text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?.mechanism;
        prop_assert_eq!(read.platform, mechanism.platform);
        for (read, written) in read.joints().zip(mechanism.joints()) {
            prop_assert_eq!(&read.coordinates, &written.coordinates);
            prop_assert_eq!(read.point, written.point);
            prop_assert!((read.axis.into_inner() - written.axis.into_inner()).norm() < 1e-15);
            if let (JointKind::Helical { pitch }, JointKind::Helical { pitch: written }) =
                (read.kind, written.kind)
            {
                prop_assert_eq!(pitch, written);
            }
        }
    }
}
