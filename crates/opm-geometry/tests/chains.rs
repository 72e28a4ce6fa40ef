//! Every closed form, compared with the product of exponentials on random chains and targets.
//!
//! `forward` does not use the closed forms: it multiplies the joints' displacements.

use nalgebra::{Complex, Matrix3, Rotation3, Unit, Vector3};
use opm_geometry::chain::cylindrical::{CoaxialJoint, CylindricalChain};
use opm_geometry::chain::planar::{PlanarChain, PlanarJoint, forward};
use opm_geometry::chain::spatial::SpatialChain;
use opm_geometry::chain::spherical::{Ball, SphericalChain};
use opm_geometry::chain::translational::TranslationalChain;
use opm_geometry::chain::{Branch, ChainError};
use opm_geometry::group::{CylindricalDisplacement, JointDisplacement, PlanarDisplacement};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// Tolerance for closure, as a share of the target's size.
const TOLERANCE: f64 = 1e-10;
const CASES: u32 = 100_000;

fn e(angle: f64) -> Complex<f64> {
    Complex::new(angle.cos(), angle.sin())
}

fn complex(range: f64) -> impl Strategy<Value = Complex<f64>> {
    (-range..range, -range..range).prop_map(|(x, y)| Complex::new(x, y))
}

fn revolute() -> impl Strategy<Value = PlanarJoint> {
    (complex(1.0), any::<bool>()).prop_map(|(at, reversed)| PlanarJoint::Revolute { at, reversed })
}

fn prismatic() -> impl Strategy<Value = PlanarJoint> {
    (-PI..PI).prop_map(|angle| PlanarJoint::Prismatic { along: e(angle) })
}

fn target() -> impl Strategy<Value = PlanarDisplacement> {
    (-PI..PI, complex(3.0))
        .prop_map(|(angle, translation)| PlanarDisplacement { rotation: e(angle), translation })
}

fn distance(a: &PlanarDisplacement, b: &PlanarDisplacement) -> f64 {
    (a.rotation - b.rotation).norm().max((a.translation - b.translation).norm())
}

/// Both branches reach a target that is built from random joint values, and these values are one of
/// the branches. A random target is reached on both branches or on neither.
fn check_planar(
    joints: [PlanarJoint; 3],
    amounts: [f64; 3],
    random: PlanarDisplacement,
) -> Result<(), TestCaseError> {
    let Ok(chain) = PlanarChain::new(joints) else {
        return Err(TestCaseError::reject("degenerate"));
    };
    let made = std::array::from_fn(|i| match joints[i] {
        PlanarJoint::Revolute { .. } => JointDisplacement::Direction(e(amounts[i])),
        PlanarJoint::Prismatic { .. } => JointDisplacement::Value(amounts[i]),
    });
    let reached = forward(&joints, &made);
    let mut found = false;
    for branch in Branch::BOTH {
        let solution = chain.inverse(&reached, branch);
        prop_assert!(solution.is_ok(), "{joints:?} {made:?} {branch:?} {solution:?}");
        let solution = solution.unwrap();
        // Near parallel sliders, their values grow without bound, and so does the rounding.
        let size = solution.iter().map(|a| a.value().abs()).fold(3.0, f64::max);
        let off = distance(&forward(&joints, &solution), &reached);
        prop_assert!(off <= TOLERANCE * size, "{joints:?} {made:?} {branch:?} off by {off}");
        found |= solution.iter().zip(&made).all(|(a, b)| match a {
            JointDisplacement::Direction(_) => {
                (a.unit_direction() - b.unit_direction()).norm() < 1e-5 * size
            }
            JointDisplacement::Value(value) => (value - b.value()).abs() < 1e-5 * size,
        });
    }
    prop_assert!(found, "the amounts that made the target are on no branch: {joints:?} {made:?}");
    let both = Branch::BOTH.map(|branch| chain.inverse(&random, branch));
    match both {
        [Ok(plus), Ok(minus)] => {
            let size = plus.iter().chain(&minus).map(|a| a.value().abs()).fold(3.0, f64::max);
            for solution in [plus, minus] {
                let off = distance(&forward(&joints, &solution), &random);
                prop_assert!(off <= TOLERANCE * size, "{joints:?} {random:?} off by {off}");
            }
            prop_assert_eq!(chain.has_choice(), plus != minus);
        }
        [Err(plus), Err(minus)] => {
            prop_assert_eq!(plus, minus);
            prop_assert!(plus.excess > 0.0);
        }
        mixed => prop_assert!(false, "one branch reaches, the other does not: {mixed:?}"),
    }
    Ok(())
}

macro_rules! planar_chains {
    ($($name:ident: $a:ident $b:ident $c:ident;)*) => {
        proptest! {
            #![proptest_config(ProptestConfig::with_cases(CASES))]
            $(
                #[test]
                fn $name(
                    joints in ($a(), $b(), $c()),
                    amounts in [-3.1..3.1, -3.1..3.1, -3.1..3.1_f64],
                    random in target(),
                ) {
                    check_planar([joints.0, joints.1, joints.2], amounts, random)?;
                }
            )*
        }
    };
}

planar_chains! {
    rrr: revolute revolute revolute;
    prr: prismatic revolute revolute;
    rrp: revolute revolute prismatic;
    rpr: revolute prismatic revolute;
    rpp: revolute prismatic prismatic;
    ppr: prismatic prismatic revolute;
    prp: prismatic revolute prismatic;
}

/// Whether a chain reaches a wrist position, by geometry: the range of distances that its first two
/// joints give.
#[test]
fn reach_is_what_geometry_says() {
    let revolute =
        |x: f64, y: f64| PlanarJoint::Revolute { at: Complex::new(x, y), reversed: false };
    let prismatic = |angle| PlanarJoint::Prismatic { along: e(angle) };
    let moved = |x: f64, y: f64| PlanarDisplacement {
        rotation: e(0.3),
        translation: Complex::new(x, y) - e(0.3) * Complex::new(3.0, 0.0),
    };
    // Links of 2 and 1 from the origin: wrist distances from 1 to 3.
    let rrr =
        PlanarChain::new([revolute(0.0, 0.0), revolute(2.0, 0.0), revolute(3.0, 0.0)]).unwrap();
    let excess = |chain: &PlanarChain, x, y| {
        chain.inverse(&moved(x, y), Branch::Plus).err().map_or(0.0, |gap| gap.excess)
    };
    for angle in [0.0, 1.0, 4.0_f64] {
        for (radius, expected) in [
            (0.0, 1.0),
            (0.75, 0.25),
            (1.0, 0.0),
            (2.0, 0.0),
            (3.0, 0.0),
            (3.5, 0.5),
            (1e6, 999_997.0),
        ] {
            let found = excess(&rrr, radius * angle.cos(), radius * angle.sin());
            assert!((found - expected).abs() < 1e-9, "radius {radius}: {found}, {expected}");
        }
    }
    // A slider along x with a link of 1: wrist positions within 1 of the x axis.
    let prr = PlanarChain::new([prismatic(0.0), revolute(2.0, 0.0), revolute(3.0, 0.0)]).unwrap();
    for (y, expected) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (1.5, 0.5), (-3.0, 2.0)] {
        let found = excess(&prr, 7.0, y);
        assert!((found - expected).abs() < 1e-12, "{y}: {found}");
    }
    // A telescope whose slider passes the inner pivot at a distance of 1.
    let rpr = PlanarChain::new([revolute(0.0, 1.0), prismatic(0.0), revolute(3.0, 0.0)]).unwrap();
    for (radius, expected) in [(0.25, 0.75), (1.0, 0.0), (5.0, 0.0)] {
        let found = excess(&rpr, radius * 0.6, 1.0 + radius * 0.8);
        assert!((found - expected).abs() < 1e-12, "{radius}: {found}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// The number of branches of an RRR chain is the number of elbow positions: crossings of the
    /// elbow's circle with the circle about the wrist, counted along the first one.
    #[test]
    fn rrr_has_as_many_branches_as_circles_cross(
        joints in (revolute(), revolute(), revolute()), target in target(),
    ) {
        let joints = [joints.0, joints.1, joints.2];
        let at = joints.map(|j| match j {
            PlanarJoint::Revolute { at, .. } => at,
            PlanarJoint::Prismatic { .. } => unreachable!(),
        });
        let wrist = target.apply(at[2]);
        let length = (at[2] - at[1]).norm();
        let beyond = |angle: f64| (at[0] + e(angle) * (at[1] - at[0]) - wrist).norm() - length;
        let steps = 5_000;
        let signs: Vec<bool> =
            (0..steps).map(|i| beyond(TAU * f64::from(i) / f64::from(steps)) > 0.0).collect();
        let crossings =
            (0..signs.len()).filter(|&i| signs[i] != signs[(i + 1) % signs.len()]).count();
        let chain = PlanarChain::new(joints).unwrap();
        let branches =
            Branch::BOTH.iter().filter(|&&b| chain.inverse(&target, b).is_ok()).count();
        // Two crossings within one step are not seen: targets near the boundary of reach are left
        // out.
        let first = (at[1] - at[0]).norm();
        let distance = (wrist - at[0]).norm();
        let margin = (distance - (first + length).abs()).abs().min((distance - (first - length).abs()).abs());
        prop_assume!(margin > 1e-5);
        prop_assert_eq!(branches, crossings);
    }
}

fn axis() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    (-1.0..1.0_f64, -PI..PI).prop_map(|(z, a)| {
        let r = (1.0 - z * z).sqrt();
        Unit::new_normalize(Vector3::new(r * a.cos(), r * a.sin(), z))
    })
}

fn rotation() -> impl Strategy<Value = Matrix3<f64>> {
    (axis(), 0.0..PI)
        .prop_map(|(axis, angle)| Rotation3::from_axis_angle(&axis, angle).into_inner())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn spherical_rrr(
        axes in [axis(), axis(), axis()],
        amounts in [-3.1..3.1, -3.1..3.1, -3.1..3.1_f64],
        random in rotation(),
    ) {
        let Ok(chain) = SphericalChain::new(axes) else {
            return Err(TestCaseError::reject("degenerate"));
        };
        let made = amounts.map(|a| JointDisplacement::Direction(e(a)));
        let reached = chain.forward(&made);
        let mut found = false;
        for branch in Branch::BOTH {
            let solution = chain.inverse(&reached, branch);
            prop_assert!(solution.is_ok(), "{axes:?} {amounts:?}: {solution:?}");
            let solution = solution.unwrap();
            let off = (chain.forward(&solution) - reached).norm();
            prop_assert!(off < TOLERANCE, "{axes:?} {amounts:?} {branch:?}: off by {off}");
            found |= solution.iter().zip(&made).all(|(a, b)| (a.unit_direction() - b.unit_direction()).norm() < 1e-4);
            // The branch is the sign of the triple product of the moved axes.
            let turn = |i: usize| Rotation3::from_axis_angle(&axes[i], solution[i].value());
            let second = turn(0) * axes[1].into_inner();
            let third = turn(0) * turn(1) * axes[2].into_inner();
            let triple = axes[0].dot(&second.cross(&third));
            prop_assert!(triple * branch.sign() > -1e-6, "{triple} on {branch:?}");
        }
        prop_assert!(found, "{axes:?} {amounts:?}: made on no branch");
        // A random rotation is in reach exactly if the angle from the first axis to the rotated
        // third axis is between the difference and the sum of the links' arcs.
        let (a12, a23) = (axes[0].angle(&axes[1]), axes[1].angle(&axes[2]));
        let between = axes[0].angle(&(random * axes[2].into_inner()));
        let (low, high) = ((a12 - a23).abs(), (a12 + a23).min(TAU - a12 - a23));
        for branch in Branch::BOTH {
            match chain.inverse(&random, branch) {
                Ok(solution) => {
                    prop_assert!((chain.forward(&solution) - random).norm() < TOLERANCE);
                    prop_assert!(between > low - 1e-6 && between < high + 1e-6);
                }
                Err(gap) => {
                    let excess = (low - between).max(between - high);
                    prop_assert!((gap.excess - excess).abs() < 1e-6, "{gap:?}, {excess}");
                }
            }
        }
    }

    #[test]
    fn ball(target in rotation(), axes in rotation()) {
        let ball = Ball { axes };
        let amounts = ball.inverse(&target);
        prop_assert!((ball.forward(&amounts) - target).norm() < TOLERANCE);
        // In base coordinates the rotation is axes · target · axesᵀ, about an axis that it keeps.
        let vector = Vector3::from_fn(|i, _| amounts[i].value());
        let kept = axes * target * axes.transpose() * vector;
        prop_assert!((kept - vector).norm() < TOLERANCE);
    }

    #[test]
    fn coaxial(kinds in [0..3, 0..3], pitches in [-2.0..2.0, -2.0..2.0_f64], angle in -20.0..20.0, advance in -3.0..3.0_f64) {
        let joint = |i: usize| match kinds[i] {
            0 => CoaxialJoint { rotation: 1.0, advance: 0.0 },
            1 => CoaxialJoint { rotation: 0.0, advance: -1.0 },
            _ => CoaxialJoint { rotation: -1.0, advance: pitches[i] },
        };
        let Ok(chain) = CylindricalChain::new([joint(0), joint(1)]) else {
            prop_assert!(kinds[0] == kinds[1], "only two of one kind are dependent");
            return Ok(());
        };
        let target = CylindricalDisplacement { angle, advance };
        let amounts = chain.inverse(&target);
        let reached = chain.forward(&amounts);
        let size = amounts.iter().map(|a| a.value().abs()).fold(20.0, f64::max);
        // A revolute joint does not count revolutions; a chain without one does.
        let apart = reached.angle - angle;
        let turns = if kinds.contains(&0) { (apart / TAU).round() } else { 0.0 };
        prop_assert_eq!(chain.counts_turns(), !kinds.contains(&0));
        prop_assert!((apart - turns * TAU).abs() < TOLERANCE * size);
        prop_assert!((reached.advance - advance).abs() < TOLERANCE * size);
    }

    #[test]
    fn two_sliders(angles in [-PI..PI, -PI..PI], target in complex(3.0)) {
        let Ok(chain) = TranslationalChain::new(angles.map(e)) else {
            return Err(TestCaseError::reject("parallel"));
        };
        let amounts = chain.inverse(target);
        let size = amounts.iter().map(|a| a.value().abs()).fold(3.0, f64::max);
        prop_assert!((chain.forward(&amounts) - target).norm() < TOLERANCE * size);
    }
}

/// The displacements of three sliders solve the linear system of their directions.
fn check_spatial(slides: [Vector3<f64>; 3], target: Vector3<f64>) -> Result<(), TestCaseError> {
    let Ok(chain) = SpatialChain::new(slides) else {
        return Err(TestCaseError::reject("dependent"));
    };
    let amounts = chain.inverse(&target);
    let values = Vector3::from(amounts.map(JointDisplacement::value));
    let matrix = Matrix3::from_columns(&slides);
    let size = values.amax().max(3.0);
    prop_assert!((matrix * values - target).norm() < TOLERANCE * size);
    prop_assert!((chain.forward(&amounts) - target).norm() < TOLERANCE * size);
    let solved = matrix.lu().solve(&target).expect("the sliders are independent");
    let volume = matrix.determinant().abs();
    prop_assert!(
        (solved - values).norm() * volume * volume < TOLERANCE * size,
        "{values} {solved}"
    );
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]
    #[test]
    fn three_sliders(
        slides in [[-1.0..1.0, -1.0..1.0, -1.0..1.0_f64], [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64],
            [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64]],
        target in [-3.0..3.0, -3.0..3.0, -3.0..3.0_f64],
    ) {
        let slides = slides.map(|slide| Vector3::from(slide).normalize());
        check_spatial(slides, Vector3::from(target))?;
    }
}

/// Three sliders along the axes give the coordinates themselves, in any order and sense; others along axes and
/// diagonals solve the linear system.
#[test]
fn three_sliders_along_axes_and_diagonals() {
    let target = Vector3::new(0.25, -1.5, 3.0);
    let mut along_axes = 0;
    let axes: Vec<Vector3<f64>> = (0..27)
        .map(|n| Vector3::new((n % 3) as f64 - 1.0, (n / 3 % 3) as f64 - 1.0, (n / 9) as f64 - 1.0))
        .filter(|axis| axis.norm() > 0.0)
        .collect();
    for u in &axes {
        for v in &axes {
            for w in &axes {
                let volume = Matrix3::from_columns(&[*u, *v, *w]).determinant();
                let slides = [u, v, w].map(Vector3::normalize);
                let chain = SpatialChain::new(slides);
                assert_eq!(chain.is_ok(), volume != 0.0, "{slides:?}");
                let Ok(chain) = chain else { continue };
                check_spatial(slides, target).unwrap();
                if [u, v, w].iter().all(|axis| axis.norm() == 1.0) {
                    along_axes += 1;
                    let expected = slides.map(|slide| slide.dot(&target));
                    assert_eq!(chain.inverse(&target).map(JointDisplacement::value), expected);
                }
            }
        }
    }
    assert_eq!(along_axes, 48);
}

#[test]
fn dependent_sliders_are_told_apart() {
    let [x, y] = [Vector3::x(), Vector3::y()];
    let reason = |slides| SpatialChain::new(slides).unwrap_err().to_string();
    for slides in [[x, x, y], [x, y, -x], [y, x, x]] {
        assert_eq!(reason(slides), "two sliders are parallel");
    }
    assert_eq!(reason([x, y, (x - y).normalize()]), "three sliders are in one plane");
}

/// Sliders that are nearly parallel close the loop as well as others: digits lost in their
/// difference are not lost in their sum.
#[test]
fn sliders_next_to_parallel_close() {
    let revolute = PlanarJoint::Revolute { at: Complex::new(0.3, -0.2), reversed: false };
    let slide = |angle| PlanarJoint::Prismatic { along: e(angle) };
    for i in 0..2_000 {
        let angle = 0.003_1 * f64::from(i);
        let apart = 1e-8 * (1.0 + f64::from(i));
        let (u, v) = (angle, angle + apart);
        let made = [0.9, -1.4].map(JointDisplacement::Value);
        let turn = JointDisplacement::Direction(e(0.7));
        for (joints, amounts) in [
            ([slide(u), slide(v), revolute], [made[0], made[1], turn]),
            ([revolute, slide(u), slide(v)], [turn, made[0], made[1]]),
            ([slide(u), revolute, slide(v - 0.7)], [made[0], turn, made[1]]),
        ] {
            let target = forward(&joints, &amounts);
            let chain = PlanarChain::new(joints).unwrap();
            let solution = chain.inverse(&target, Branch::Plus).unwrap();
            let off = distance(&forward(&joints, &solution), &target);
            assert!(off < 1e-14, "{joints:?}: off by {off:e}");
        }
        let chain = TranslationalChain::new([e(u), e(v)]).unwrap();
        let target = chain.forward(&made);
        assert!((chain.forward(&chain.inverse(target)) - target).norm() < 1e-14);
        let made = [made[0], made[1], JointDisplacement::Value(0.4)];
        let [u, v] = [u, v].map(|angle| Vector3::new(angle.cos(), angle.sin(), 0.0));
        // Nearly parallel sliders first, last, and at both ends; and three that are nearly in one plane.
        let other = Vector3::new(0.3, -0.5, 0.8).normalize();
        let flat = (u + v - other + Vector3::z() * apart).normalize();
        for slides in [[u, v, other], [other, u, v], [u, other, v], [other, flat, u]] {
            let chain = SpatialChain::new(slides).unwrap();
            let target = chain.forward(&made);
            let off = (chain.forward(&chain.inverse(&target)) - target).norm();
            assert!(off < 1e-14, "{slides:?}: off by {off:e}");
        }
    }
}

#[test]
fn the_boundary_is_inside_and_both_branches_meet_there() {
    let revolute = |x: f64| PlanarJoint::Revolute { at: Complex::new(x, 0.0), reversed: false };
    let joints = [revolute(0.0), revolute(0.1), revolute(0.3)];
    let chain = PlanarChain::new(joints).unwrap();
    for angle in (0..100).map(|i| 0.0628 * f64::from(i)) {
        for radius in [0.3_f64, 0.1] {
            let target =
                PlanarDisplacement { rotation: e(angle), translation: e(angle) * (radius - 0.3) };
            for branch in Branch::BOTH {
                let solution = chain.inverse(&target, branch).unwrap();
                assert!(distance(&forward(&joints, &solution), &target) < 1e-10);
            }
            let outside = if radius > 0.2 { 1e-6 } else { -1e-6 };
            let beyond = PlanarDisplacement {
                rotation: e(angle),
                translation: e(angle) * (radius - 0.3 + outside),
            };
            let gap = chain.inverse(&beyond, Branch::Plus).unwrap_err();
            assert!((gap.excess - 1e-6).abs() < 1e-12, "{gap:?}");
        }
    }
    let axes = [Vector3::z_axis(), Vector3::y_axis(), Vector3::x_axis()];
    let chain = SphericalChain::new(axes).unwrap();
    // Third axis straight up and straight down: it is on the first axis, and in reach with arcs of
    // 90 degrees.
    for angle in [-90.0_f64, 90.0] {
        let target =
            Rotation3::from_axis_angle(&Vector3::y_axis(), angle.to_radians()).into_inner();
        for branch in Branch::BOTH {
            let solution = chain.inverse(&target, branch).unwrap();
            assert!((chain.forward(&solution) - target).norm() < 1e-10, "{angle} {solution:?}");
        }
    }
}

#[test]
fn an_angle_left_free_is_home() {
    let revolute = |x: f64| PlanarJoint::Revolute { at: Complex::new(x, 0.0), reversed: false };
    // Equal links fold back onto the first pivot: the first angle is arbitrary.
    let joints = [revolute(0.0), revolute(1.0), revolute(2.0)];
    let chain = PlanarChain::new(joints).unwrap();
    let target =
        PlanarDisplacement { rotation: e(0.5), translation: -e(0.5) * Complex::new(2.0, 0.0) };
    for branch in Branch::BOTH {
        let solution = chain.inverse(&target, branch).unwrap();
        assert_eq!(solution[0].value(), 0.0);
        assert!(distance(&forward(&joints, &solution), &target) < 1e-10);
    }
    // Arcs of 60 degrees fold the third axis onto the first.
    let axes = [0.0, 60.0, 120.0_f64].map(|a| {
        Unit::new_normalize(Vector3::new(a.to_radians().sin(), 0.0, a.to_radians().cos()))
    });
    let chain = SphericalChain::new(axes).unwrap();
    let target =
        Rotation3::from_axis_angle(&Vector3::y_axis(), -120.0_f64.to_radians()).into_inner();
    for branch in Branch::BOTH {
        let solution = chain.inverse(&target, branch).unwrap();
        assert!((chain.forward(&solution) - target).norm() < 1e-10);
    }
}

#[test]
fn chains_that_cannot_reach_a_neighbourhood_are_refused() {
    let revolute = |x: f64| PlanarJoint::Revolute { at: Complex::new(x, 0.0), reversed: false };
    let prismatic = |angle| PlanarJoint::Prismatic { along: e(angle) };
    for joints in [
        [revolute(0.0), revolute(0.0), revolute(1.0)],
        [revolute(0.0), revolute(1.0), revolute(1.0)],
        [prismatic(0.0), revolute(1.0), revolute(1.0)],
        [revolute(1.0), revolute(1.0), prismatic(0.0)],
        [revolute(0.0), prismatic(1.0), prismatic(1.0)],
        [prismatic(1.0), prismatic(1.0 + PI), revolute(0.0)],
        [prismatic(0.0), prismatic(1.0), prismatic(2.0)],
    ] {
        assert!(matches!(PlanarChain::new(joints), Err(ChainError::Dependent(_))), "{joints:?}");
    }
    let (x, z) = (Vector3::x_axis(), Vector3::z_axis());
    for axes in [[z, z, x], [x, z, z], [z, -z, x]] {
        assert!(matches!(SphericalChain::new(axes), Err(ChainError::Dependent(_))), "{axes:?}");
    }
    assert!(TranslationalChain::new([e(0.4), -e(0.4)]).is_err());
    let helix = CoaxialJoint { rotation: 1.0, advance: 0.02 };
    assert!(CylindricalChain::new([helix, helix]).is_err());
}

#[test]
fn nothing_that_is_not_a_number_gets_out() {
    let revolute = |x: f64| PlanarJoint::Revolute { at: Complex::new(x, 0.0), reversed: false };
    let prismatic = |angle| PlanarJoint::Prismatic { along: e(angle) };
    let (r, p) = (revolute, prismatic);
    for joints in [
        [r(0.0), r(1.0), r(2.0)],
        [p(0.0), r(1.0), r(2.0)],
        [r(0.0), r(1.0), p(0.0)],
        [r(0.0), p(0.0), r(0.0)],
        [r(0.0), p(0.0), r(1.0)],
        [r(0.0), p(0.0), p(1.0)],
        [p(0.0), p(1.0), r(0.0)],
        [p(0.0), r(0.0), p(0.0)],
    ] {
        let chain = PlanarChain::new(joints).unwrap();
        for size in [0.0, 1e-300, 1e-20, 1e-12, 1.0, 1e12, 1e100] {
            for angle in [0.0, PI / 2.0, PI, 1e-9, 2.5] {
                for direction in [0.0, PI / 2.0, 3.0] {
                    let target =
                        PlanarDisplacement { rotation: e(angle), translation: e(direction) * size };
                    for branch in Branch::BOTH {
                        match chain.inverse(&target, branch) {
                            Ok(amounts) => {
                                for amount in amounts {
                                    assert!(amount.value().is_finite(), "{joints:?} {target:?}");
                                }
                            }
                            Err(gap) => assert!(gap.excess > 0.0),
                        }
                    }
                }
            }
        }
    }
}
