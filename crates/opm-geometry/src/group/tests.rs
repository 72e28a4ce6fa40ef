//! The algebra of every subgroup is compared with the group axioms, with SE(3) and with itself: on random
//! elements, and on special ones at which closed forms change from one case to another.

use super::screw::Screw;
use super::*;
use nalgebra::{Complex, Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Rounding of a few dozen operations on numbers up to about ten.
const ROUNDING: f64 = 1e-12;

const KINDS: [SubspaceKind; 6] = [
    SubspaceKind::Identity,
    SubspaceKind::Planar,
    SubspaceKind::Spherical,
    SubspaceKind::Cylindrical,
    SubspaceKind::TranslationalPlane,
    SubspaceKind::TranslationalSpace,
];

fn kind() -> impl Strategy<Value = SubspaceKind> {
    prop::sample::select(KINDS.to_vec())
}

/// A component of a twist: zero, multiples of π/2, small numbers and ordinary ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -3.0..3.0_f64,
        2 => prop::sample::select(vec![0.0, FRAC_PI_2, -FRAC_PI_2, PI, -PI, 1.0]),
        1 => prop::sample::select(vec![1e-9, -1e-9, 1e-5, 1e-300]),
    ]
}

fn twist_of(kind: SubspaceKind, numbers: [f64; 3]) -> LocalTwist {
    LocalTwist::from_fn(|i, _| if i < kind.dimension() { numbers[i] } else { 0.0 })
}

/// A twist of a kind.
fn twist(kind: SubspaceKind) -> impl Strategy<Value = LocalTwist> {
    [number(), number(), number()].prop_map(move |numbers| twist_of(kind, numbers))
}

/// The rotations of a cube: by multiples of π/2 about the axes, and by π and 2π/3 about diagonals.
fn cube_rotations() -> Vec<Matrix3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|a| [a, -a]).concat();
    let mut found = Vec::new();
    for first in &axes {
        for second in axes.iter().filter(|second| first.dot(second) == 0.0) {
            found.push(Matrix3::from_columns(&[*first, *second, first.cross(second)]));
        }
    }
    found
}

/// An exact rotation of the plane by a multiple of π/2.
fn quarters() -> impl Strategy<Value = Complex<f64>> {
    prop::sample::select(vec![(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
        .prop_map(|(re, im)| Complex::new(re, im))
}

/// Displacements without rounding.
fn structured(kind: SubspaceKind) -> BoxedStrategy<Displacement> {
    let translation = || [number(), number()].prop_map(|[x, y]| Complex::new(x, y));
    match kind {
        SubspaceKind::Identity => Just(kind.identity()).boxed(),
        SubspaceKind::Planar => (quarters(), translation())
            .prop_map(|(rotation, translation)| PlanarDisplacement { rotation, translation }.into())
            .boxed(),
        SubspaceKind::Spherical => {
            prop::sample::select(cube_rotations()).prop_map(Displacement::from).boxed()
        }
        SubspaceKind::Cylindrical => [number(), number()]
            .prop_map(|[angle, advance]| CylindricalDisplacement { angle, advance }.into())
            .boxed(),
        SubspaceKind::TranslationalPlane => translation().prop_map(Displacement::from).boxed(),
        SubspaceKind::TranslationalSpace => [number(), number(), number()]
            .prop_map(|numbers| Displacement::from(Vector3::from(numbers)))
            .boxed(),
    }
}

fn displacement(kind: SubspaceKind) -> BoxedStrategy<Displacement> {
    prop_oneof![
        2 => twist(kind).prop_map(move |twist| kind.exponential(&twist)),
        2 => structured(kind),
        1 => Just(kind.identity()),
    ]
    .boxed()
}

fn displacements<const N: usize>() -> impl Strategy<Value = [Displacement; N]> {
    kind().prop_flat_map(|kind| std::array::from_fn(|_| displacement(kind)))
}

fn with_twist() -> impl Strategy<Value = (Displacement, LocalTwist)> {
    kind().prop_flat_map(|kind| (displacement(kind), twist(kind)))
}

/// Every intersection motion of a kind: rotations, and translations along the axes and in other directions.
fn motion(kind: SubspaceKind) -> BoxedStrategy<IntersectionMotion> {
    let direction = prop_oneof![Just(0.0), Just(FRAC_PI_2), -3.0..3.0_f64]
        .prop_map(|angle| Vector3::new(angle.cos(), angle.sin(), 0.0));
    use MotionType::{Rotation, Translation};
    let new = IntersectionMotion::new;
    let moving = match kind {
        SubspaceKind::Identity => return Just(IntersectionMotion::None(kind)).boxed(),
        SubspaceKind::Planar => prop_oneof![
            Just(new(kind, &Vector3::z(), Rotation)),
            direction.prop_map(move |along| new(kind, &along, Translation)),
        ]
        .boxed(),
        SubspaceKind::Spherical => Just(new(kind, &Vector3::z(), Rotation)).boxed(),
        SubspaceKind::Cylindrical => prop::sample::select(vec![Rotation, Translation])
            .prop_map(move |motion| new(kind, &Vector3::z(), motion))
            .boxed(),
        SubspaceKind::TranslationalPlane => {
            direction.prop_map(move |along| new(kind, &along, Translation)).boxed()
        }
        SubspaceKind::TranslationalSpace => Just(new(kind, &Vector3::z(), Translation)).boxed(),
    };
    prop_oneof![8 => moving, 1 => Just(IntersectionMotion::None(kind))].boxed()
}

fn with_motion() -> impl Strategy<Value = (Displacement, IntersectionMotion)> {
    kind().prop_flat_map(|kind| (displacement(kind), motion(kind)))
}

/// A random frame, or that of the base.
fn frame(kind: SubspaceKind) -> impl Strategy<Value = Subspace> {
    let own = Just((Matrix3::identity(), Point3::origin()));
    let other = ([number(), number(), number()], [number(), number(), number()]).prop_map(
        |(vector, origin)| (Rotation3::new(vector.into()).into_inner(), Point3::from(origin)),
    );
    prop_oneof![1 => own, 3 => other].prop_map(move |(axes, origin)| Subspace {
        kind,
        origin,
        axes,
        measured_from: Point3::origin(),
    })
}

/// The largest difference of the components of two displacements.
fn apart(a: &Displacement, b: &Displacement) -> f64 {
    match a {
        Displacement::Identity(_) => 0.0,
        Displacement::Planar(a) => {
            let b = b.planar();
            (a.rotation - b.rotation).norm().max((a.translation - b.translation).norm())
        }
        Displacement::Spherical(a) => (a - b.spherical()).amax(),
        Displacement::Cylindrical(a) => {
            let b = b.cylindrical();
            (a.angle - b.angle).abs().max((a.advance - b.advance).abs())
        }
        Displacement::Translational(a) => (a - b.translational()).norm(),
        Displacement::Spatial(a) => (a - b.spatial()).norm(),
    }
}

fn isometries_apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).amax()
}

/// The angle of a twist if it counts modulo 2π; zero if it counts full revolutions.
fn wrapped_angle(kind: SubspaceKind, twist: &LocalTwist) -> f64 {
    match kind {
        SubspaceKind::Planar => twist.x.abs(),
        SubspaceKind::Spherical => twist.norm(),
        SubspaceKind::Identity
        | SubspaceKind::Cylindrical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => 0.0,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5_000))]

    #[test]
    fn products_are_a_group([a, b, c] in displacements()) {
        let identity = a.kind().identity();
        prop_assert!(apart(&a.after(&b).after(&c), &a.after(&b.after(&c))) < ROUNDING);
        prop_assert_eq!(a.after(&identity), a);
        prop_assert!(apart(&identity.after(&a), &a) == 0.0);
        prop_assert!(apart(&a.after(&a.inverse()), &identity) < ROUNDING);
        prop_assert!(apart(&a.inverse().after(&a), &identity) < ROUNDING);
        if a.kind().commutes() {
            prop_assert!(apart(&a.after(&b), &b.after(&a)) == 0.0);
        }
    }

    /// This includes rotations by π, at which a logarithm has two values.
    #[test]
    fn the_exponential_undoes_the_logarithm([g] in displacements()) {
        let kind = g.kind();
        let logarithm = g.logarithm();
        prop_assert!(wrapped_angle(kind, &logarithm) <= PI + ROUNDING);
        prop_assert!(apart(&kind.exponential(&logarithm), &g) < ROUNDING, "{:?}", logarithm);
    }

    #[test]
    fn the_logarithm_undoes_the_exponential((g, twist) in with_twist()) {
        let kind = g.kind();
        // Near π, rounding decides between the two values of a logarithm.
        prop_assume!(wrapped_angle(kind, &twist) < 3.1);
        prop_assert!((kind.exponential(&twist).logarithm() - twist).amax() < 1e-10);
    }

    /// The first-order displacement has an error of second order.
    #[test]
    fn steps_are_exponentials_of_small_twists((g, twist) in with_twist()) {
        const SMALL: f64 = 1e-4;
        let (kind, step) = (g.kind(), twist * SMALL);
        let off = apart(&kind.first_order(&step), &kind.exponential(&step));
        prop_assert!(off <= step.norm_squared() + 1e-15, "{}", off);
    }

    /// In any frame, a subgroup is a subgroup of SE(3).
    #[test]
    fn products_are_those_of_isometries(
        ([a, b], frame) in kind().prop_flat_map(|kind| ([displacement(kind), displacement(kind)], frame(kind)))
    ) {
        let in_base = |g: &Displacement| frame.isometry(g);
        let product = in_base(&a) * in_base(&b);
        prop_assert!(isometries_apart(&in_base(&a.after(&b)), &product) < 10.0 * ROUNDING);
        prop_assert!(isometries_apart(&in_base(&a.inverse()), &in_base(&a).inverse()) < 10.0 * ROUNDING);
        let identity = in_base(&a.kind().identity());
        prop_assert!(isometries_apart(&identity, &Isometry3::identity()) < ROUNDING);
    }

    #[test]
    fn points_are_moved_as_by_isometries(
        (g, frame) in kind().prop_flat_map(|kind| (displacement(kind), frame(kind))),
        point in [number(), number(), number()],
    ) {
        let point = Point3::from(point);
        let moved = frame.restored(&g.act(&frame.point(&point)));
        prop_assert!((moved - frame.isometry(&g) * point).amax() < 10.0 * ROUNDING);
    }

    /// The exponential of a twist is that of its screw in base coordinates.
    #[test]
    fn exponentials_are_those_of_screws(
        (twist, frame) in kind().prop_flat_map(|kind| (twist(kind), frame(kind)))
    ) {
        let [angular, at_origin] = frame.embedded(&twist);
        let linear = at_origin - angular.cross(&frame.origin.coords);
        let expected = Screw { angular, linear }.exp(1.0);
        let found = frame.isometry(&frame.kind.exponential(&twist));
        prop_assert!(isometries_apart(&found, &expected) < 10.0 * ROUNDING);
    }

    #[test]
    fn the_adjoint_carries_exponentials((g, twist) in with_twist()) {
        let kind = g.kind();
        let carried = g.adjoint(&twist);
        let expected = g.after(&kind.exponential(&twist)).after(&g.inverse());
        // Cylindrical angles count full revolutions, so that they agree as numbers.
        prop_assert!(apart(&kind.exponential(&carried), &expected) < 20.0 * ROUNDING);
        prop_assert!((g.adjoint_of_inverse(&carried) - twist).amax() < 10.0 * ROUNDING);
        prop_assert!((g.inverse().adjoint(&carried) - twist).amax() < 10.0 * ROUNDING);
    }

    /// The bracket is the derivative of the adjoint action.
    #[test]
    fn the_bracket_differentiates_the_adjoint(
        (kind, a, b) in kind().prop_flat_map(|kind| (Just(kind), twist(kind), twist(kind)))
    ) {
        const STEP: f64 = 1e-4;
        let at = |t: f64| kind.exponential(&(a * t)).adjoint(&b);
        let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        prop_assert!((difference - kind.bracket(&a, &b)).amax() < 1e-5);
    }

    /// Steps along the intersection motion are products with its exponential, for both forms of a joint
    /// displacement.
    #[test]
    fn steps_along_a_motion_are_products((g, motion) in with_motion(), t in number()) {
        let kind = g.kind();
        prop_assert_eq!(motion.kind(), kind);
        let step = kind.exponential(&(motion.unit_twist() * t));
        let value = JointDisplacement::Value(t);
        prop_assert!(apart(&motion.displacement(value), &step) < ROUNDING);
        prop_assert!(apart(&motion.after(&g, value), &g.after(&step)) < ROUNDING);
        prop_assert!(apart(&motion.before(&g, value), &step.after(&g)) < ROUNDING);
        if motion.is_rotation() && !kind.commutes() {
            // A direction may have any length.
            let direction = JointDisplacement::Direction(value.unit_direction() * 7.0);
            prop_assert!(apart(&motion.after(&g, direction), &g.after(&step)) < ROUNDING);
            prop_assert!(apart(&motion.before(&g, direction), &step.after(&g)) < ROUNDING);
        }
        let back = motion.after(&motion.after(&g, value), value.inverse());
        prop_assert!(apart(&back, &g) < ROUNDING);
    }

    #[test]
    fn paths_are_steps_along_a_motion((g, motion) in with_motion(), t in -3.0..3.0_f64) {
        let Some(path) = motion.path(&g) else {
            prop_assert_eq!(motion, IntersectionMotion::None(g.kind()));
            return Ok(());
        };
        let at: Displacement = match path {
            Path::Identity => Displacement::Identity(IdentityDisplacement),
            Path::Planar(PlanarPath::Translation { start, rate }) => {
                PlanarDisplacement { translation: start.translation + rate * t, ..start }.into()
            }
            Path::Planar(PlanarPath::Rotation { start }) => {
                PlanarDisplacement::about(Complex::new(0.0, 0.0), Complex::from_polar(1.0, t))
                    .after(&start)
                    .into()
            }
            Path::Spherical { start, axis } => (Rotation3::new(axis * t).into_inner() * start).into(),
            Path::Cylindrical { start, rate } => CylindricalDisplacement {
                angle: start.angle + t * rate.angle,
                advance: start.advance + t * rate.advance,
            }
            .into(),
            Path::Translational { start, rate } => (start + rate * t).into(),
            Path::Spatial { start, rate } => (start + rate * t).into(),
        };
        prop_assert!(apart(&at, &motion.before(&g, JointDisplacement::Value(t))) < ROUNDING);
    }

    /// A motion and its complement are a basis.
    #[test]
    fn a_motion_has_a_complement((g, motion) in with_motion()) {
        let mut basis = motion.complement();
        basis.extend(motion.motion_type().map(|_| motion.unit_twist()));
        let dimension = g.kind().dimension();
        prop_assert_eq!(basis.len(), dimension);
        let padding = [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()];
        basis.extend(&padding[dimension..]);
        prop_assert!((Matrix3::from_columns(&basis).determinant().abs() - 1.0).abs() < ROUNDING);
        let translation = g.kind().is_translation(&motion.unit_twist());
        prop_assert_eq!(translation, motion.motion_type() == Some(MotionType::Translation));
    }

    /// The displacement of a revolute or prismatic joint is the exponential of its screw.
    #[test]
    fn joints_are_exponentials_of_screws(
        [x, y, q] in [number(), number(), number()],
        reversed in any::<bool>(),
        slider in any::<bool>(),
    ) {
        let screw = match (slider, reversed) {
            (true, _) => angular_and_linear(0.0, Complex::from_polar(1.0, x)),
            (false, false) => LocalTwist::new(1.0, x, y),
            (false, true) => LocalTwist::new(-1.0, x, y),
        };
        let found = PlanarDisplacement::along_screw(&screw, JointDisplacement::Value(q));
        let expected = Planar::exponential(&(screw * q));
        prop_assert!(apart(&found.into(), &expected.into()) < 10.0 * ROUNDING);
        let axis = Vector3::new(x, y, 1.0).normalize();
        let angle = JointDisplacement::Value(q).unit_direction();
        let matrix = rotation_about(&axis, angle);
        prop_assert!((matrix - Spherical::exponential(&(axis * q))).amax() < ROUNDING);
        let v = Vector3::new(y, q, x);
        prop_assert!((rotated(&axis, angle, &v) - matrix * v).amax() < 10.0 * ROUNDING);
    }
}

/// Rotations by exactly π have two rotation vectors, and the identity has none of a definite direction.
#[test]
fn rotation_vectors_of_cube_rotations_are_exact() {
    let rotations = cube_rotations();
    assert_eq!(rotations.len(), 24);
    for r in rotations {
        let vector = rotation_vector(&r);
        let rotation = UnitQuaternion::from_scaled_axis(vector).to_rotation_matrix();
        assert!((rotation.into_inner() - r).amax() < ROUNDING, "{r} {vector}");
        let multiple = vector.norm() / (PI / 6.0);
        assert!((multiple - multiple.round()).abs() < ROUNDING, "{vector}");
    }
    assert_eq!(rotation_vector(&Matrix3::identity()), Vector3::zeros());
}

#[test]
#[should_panic(
    expected = "expected an object of a planar subspace, found one of a spherical subspace"
)]
fn displacements_of_two_subgroups_do_not_multiply() {
    let _ = SubspaceKind::Planar.identity().after(&SubspaceKind::Spherical.identity());
}
