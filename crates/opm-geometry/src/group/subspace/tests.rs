use super::*;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use proptest::prelude::*;

/// Tolerance for geometry fitted to exact screws: the rounding of a few dozen operations on numbers
/// near one.
const EXACT: f64 = 1e-13;

fn direction() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    (-1.0..1.0, 0.0..std::f64::consts::TAU).prop_map(|(z, angle): (f64, f64)| {
        let r = (1.0 - z * z).sqrt();
        Unit::new_normalize(Vector3::new(r * angle.cos(), r * angle.sin(), z))
    })
}

fn point() -> impl Strategy<Value = Point3<f64>> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(Point3::from)
}

/// Pitches that are clearly not zero.
fn pitch() -> impl Strategy<Value = f64> {
    prop_oneof![0.05..0.8, -0.8..-0.05]
}

/// One group of every kind, at any place and in any direction.
fn group() -> impl Strategy<Value = SubspaceClass> {
    use SubspaceClass::*;
    let all = (0..12_usize, direction(), point(), pitch());
    all.prop_map(|(kind, axis, point, pitch)| match kind {
        0 => Identity,
        1 => Rotation { axis, point },
        2 => Translation { axis },
        3 => Helical { axis, point, pitch },
        4 => TranslationalPlane { normal: axis },
        5 => Cylindrical { axis, point },
        6 => TranslationalSpace,
        7 => Planar { normal: axis },
        8 => Spherical { centre: point },
        9 => PlanarHelical { axis, pitch },
        10 => Schoenflies { axis },
        _ => Full,
    })
}

/// A frame that differs from the base's.
fn frame() -> impl Strategy<Value = Frame> {
    (point(), 0.3..3.0).prop_map(|(origin, length)| Frame { origin, length })
}

/// Combinations of a group's basis by a well-conditioned matrix: as many screws, none of them
/// special.
fn mixed(screws: &[Screw], weights: &[f64]) -> Vec<Screw> {
    let n = screws.len();
    let mix = |i: usize| {
        let weight = |j: usize| if i == j { 2.0 } else { weights[i * n + j] / n as f64 };
        let sum = screws.iter().enumerate().map(|(j, s)| s.to_vector() * weight(j)).sum();
        Screw::from_vector(&sum)
    };
    (0..n).map(mix).collect()
}

type Geometry = (Option<Unit<Vector3<f64>>>, Option<Point3<f64>>, f64);

/// The axis or normal, the point and the pitch of a class, if it has them.
fn geometry(class: &SubspaceClass) -> Geometry {
    use SubspaceClass::*;
    match *class {
        Rotation { axis, point } | Cylindrical { axis, point } => (Some(axis), Some(point), 0.0),
        Helical { axis, point, pitch } => (Some(axis), Some(point), pitch),
        Translation { axis } | Schoenflies { axis } => (Some(axis), None, 0.0),
        TranslationalPlane { normal } | Planar { normal } => (Some(normal), None, 0.0),
        Spherical { centre } => (None, Some(centre), 0.0),
        PlanarHelical { axis, pitch } => (Some(axis), None, pitch),
        Identity | TranslationalSpace | Full => (None, None, 0.0),
    }
}

proptest! {
    /// Every group is recovered, with its geometry, from combinations of its screws.
    #[test]
    fn groups_are_recognised(
        group in group(), frame in frame(), weights in prop::collection::vec(-1.0..1.0, 36),
    ) {
        let screws = mixed(&group.screws(), &weights);
        let subspace = MotionSubspace::span(frame, &screws);
        prop_assert_eq!(subspace.dimension(), group.dimension());
        prop_assert!(subspace.is_subalgebra());
        let found = subspace.class();
        prop_assert_eq!(found.map(|c| c.name()), Some(group.name()));
        let ((axis, point, pitch), (a, p, h)) = (geometry(&group), geometry(&found.unwrap()));
        if let (Some(axis), Some(a)) = (axis, a) {
            prop_assert!(axis.cross(&a).norm() < EXACT);
        }
        if let (Some(point), Some(p)) = (point, p) {
            let along = axis.map_or(Vector3::zeros(), |a| a.into_inner() * a.dot(&(p - point)));
            prop_assert!((p - point - along).norm() < 10.0 * EXACT);
        }
        prop_assert!((pitch - h).abs() < 10.0 * EXACT);
    }

    /// A subgroup's algebra is invariant under the group's own displacements: products of
    /// exponentials carry members to members.
    #[test]
    fn a_groups_own_displacements_keep_it(
        group in group(), frame in frame(), weights in prop::collection::vec(-1.0..1.0, 36),
    ) {
        let screws = group.screws();
        let subspace = MotionSubspace::span(frame, &screws);
        let g = screws.iter().zip(&weights).fold(Isometry3::identity(), |g, (s, w)| g * s.exp(*w));
        for screw in &screws {
            prop_assert!(subspace.distance(&screw.transformed(&g)) < 100.0 * EXACT);
        }
    }

    /// The closure of any screws under the bracket is one of the listed groups, and a class is
    /// found exactly where the span is already closed: the list is complete. The screws are drawn
    /// from few directions, points and pitches, so that special positions are common.
    #[test]
    fn closures_are_the_listed_groups(
        draws in prop::collection::vec((0..4_usize, 0..3_usize, 0..4_usize), 1..5),
    ) {
        let axes = [Vector3::x_axis(), Vector3::z_axis(), Unit::new_normalize(Vector3::new(1.0, 1.0, 0.0)),
            Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8))];
        let points = [Point3::origin(), Point3::new(0.0, 0.0, 1.0), Point3::new(0.4, -0.7, 0.2)];
        let screws: Vec<_> = draws.iter().map(|&(axis, point, pitch)| match pitch {
            0 => Screw::translation(axes[axis]),
            1 => Screw::helical(axes[axis], points[point], 0.3),
            _ => Screw::rotation(axes[axis], points[point]),
        }).collect();
        let frame = Frame { origin: Point3::new(0.1, 0.2, 0.3), length: 0.7 };
        let span = MotionSubspace::span(frame, &screws);
        prop_assert_eq!(span.class().is_some(), span.is_subalgebra());
        let closure = span.closure();
        prop_assert!(closure.is_subalgebra());
        let class = closure.class().expect("a subalgebra is one of the classes");
        prop_assert_eq!(class.dimension(), closure.dimension());
        for screw in &screws {
            prop_assert!(closure.distance(screw) < 100.0 * EXACT);
        }
    }

    /// Two spherical subspaces intersect in the rotation about the line of their centres, two
    /// planar ones in the translation along the line of both planes, a spherical and a planar one
    /// in the rotation about the normal through the centre.
    #[test]
    fn intersections_agree_with_geometry(
        a in direction(), b in direction(), p in point(), q in point(), frame in frame(),
    ) {
        prop_assume!(a.cross(&b).norm() > 0.1 && (p - q).norm() > 0.1);
        let span = |class: SubspaceClass| MotionSubspace::span(frame, &class.screws());
        let meet = |x, y| span(x).intersection(&span(y));
        let cases = [
            (SubspaceClass::Spherical { centre: p }, SubspaceClass::Spherical { centre: q },
                Screw::rotation(Unit::new_normalize(q - p), p)),
            (SubspaceClass::Planar { normal: a }, SubspaceClass::Planar { normal: b },
                Screw::translation(Unit::new_normalize(a.cross(&b)))),
            (SubspaceClass::Planar { normal: a }, SubspaceClass::Spherical { centre: p },
                Screw::rotation(a, p)),
        ];
        for (x, y, expected) in cases {
            let common = meet(x, y);
            prop_assert_eq!(common.dimension(), 1);
            prop_assert!(common.distance(&expected) < 100.0 * EXACT);
        }
        let none = meet(SubspaceClass::TranslationalSpace, SubspaceClass::Spherical { centre: p });
        prop_assert_eq!(none.dimension(), 0);
        let inside = meet(SubspaceClass::Schoenflies { axis: a }, SubspaceClass::Planar { normal: a });
        prop_assert_eq!(inside.class().map(|c| c.name()), Some("planar"));
    }

    #[test]
    fn the_frame_moves_with_the_axes(
        lines in prop::collection::vec((direction(), point(), -0.5..0.5), 2..8),
        r in point(), t in point(), along in -5.0..5.0,
    ) {
        let g = Isometry3::new(t.coords * 10.0, r.coords);
        let axes: Vec<_> = lines.iter().map(|&(a, p, h)| (Screw::helical(a, p, h), p)).collect();
        let moved: Vec<_> = axes.iter().map(|(s, p)| (s.transformed(&g), g * p)).collect();
        let (here, there) = (Frame::of(&axes), Frame::of(&moved));
        prop_assert!((g * here.origin - there.origin).norm() < 1e-11);
        prop_assert!((here.length - there.length).abs() < 1e-12);
        // The screws have the same components in both frames.
        for ((s, _), (m, _)) in axes.iter().zip(&moved) {
            let turned = Isometry3::from_parts(Default::default(), g.rotation);
            let difference = here.normalised(s).transformed(&turned).to_vector()
                - there.normalised(m).to_vector();
            prop_assert!(difference.norm() < 1e-10);
        }
        // The length depends on the lines, not on the points with which they are given.
        let slid: Vec<_> =
            axes.iter().map(|(s, p)| (*s, p + s.angular * along)).collect();
        if lines.iter().any(|(a, ..)| a.cross(&lines[0].0).norm() > 0.5) {
            prop_assert!((Frame::of(&slid).length - here.length).abs() < 1e-12);
        }
    }
}

#[test]
fn screws_come_back_from_the_frame() {
    let frame = Frame { origin: Point3::new(3.0, -2.0, 1.0), length: 0.25 };
    let screw = Screw::helical(Vector3::y_axis(), Point3::new(2.9, 0.0, 1.1), 0.02);
    let back = frame.restored(&frame.normalised(&screw).to_vector());
    assert!((back.to_vector() - screw.to_vector()).norm() < EXACT);
}

#[test]
fn concurrent_axes_and_no_axes_have_a_frame() {
    let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let at = |axis: Unit<Vector3<f64>>| {
        let point = Point3::from(axis.into_inner() * 0.2);
        (Screw::rotation(axis, point), point)
    };
    let frame = Frame::of(&[x, y, z].map(at));
    assert!(frame.origin.coords.norm() < EXACT);
    // The spread of the points is used instead: each is 0.2 √(2/3) from their mean.
    assert!((frame.length - 0.2 * (2.0_f64 / 3.0).sqrt()).abs() < EXACT);
    let none = Frame::of(&[(Screw::translation(x), Point3::new(9.0, 9.0, 9.0))]);
    assert_eq!(none, Frame { origin: Point3::origin(), length: 1.0 });
}

#[test]
fn a_pitch_within_the_tolerance_is_zero() {
    let frame = Frame { origin: Point3::origin(), length: 1.0 };
    let class = |pitch| {
        let screws = SubspaceClass::PlanarHelical { axis: Vector3::z_axis(), pitch }.screws();
        MotionSubspace::span(frame, &screws).class().map(|class| class.name())
    };
    assert_eq!(class(0.5 * TOLERANCE), Some("planar"));
    assert_eq!(class(3.0 * TOLERANCE), Some("planar helical"));
}

#[test]
fn classes_are_displayed_in_words() {
    let class = SubspaceClass::Helical {
        axis: Vector3::z_axis(),
        point: Point3::new(0.1, -0.0, -1e-9),
        pitch: 0.02,
    };
    assert_eq!(
        class.to_string(),
        "helical about (0, 0, 1) through (0.1, 0, 0) m, pitch 0.020000 m/rad"
    );
}

/// Axes that meet in one point have no characteristic length, wherever that point is and however
/// its coordinates are rounded.
#[test]
fn axes_that_meet_in_one_point_are_measured_in_metres() {
    for digits in [15, 6] {
        let point = Point3::from([1.0 / 3.0, 200.0 / 7.0, -3.0 / 11.0].map(|x: f64| {
            let scale = 10_f64.powi(digits - 1 - x.abs().log10().floor() as i32);
            (x * scale).round() / scale
        }));
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()].map(|axis| {
            let rounding = Vector3::repeat(0.5 * 10_f64.powi(2 - digits));
            (Screw::rotation(axis, point + axis.cross(&rounding)), point + axis.cross(&rounding))
        });
        assert_eq!(Frame::of(&axes).length, 1.0, "{digits} digits");
    }
}
