use super::*;
use crate::mechanism::examples;
use crate::mechanism::family::Family;
use crate::mechanism::file;
use crate::mechanism::joint::JointCoordinate;
use nalgebra::Vector2;
use proptest::prelude::*;

/// Tolerance: the rounding of a few dozen operations on lengths below a metre and angles of a few
/// radians.
const ROUNDING: f64 = 1e-12;

fn shipped() -> PlanarPlanar {
    let text = examples::find("planar-planar-5dof").unwrap().text;
    match file::read(text).unwrap().family {
        Some(Family::PlanarPlanar(family)) => family,
        other => panic!("{other:?}"),
    }
}

/// The direction `e(t)` in the base's plane.
fn e(t: f64) -> Vector3<f64> {
    Vector3::new(t.cos(), t.sin(), 0.0)
}

/// The direction at angle t in the vertical plane at home, where u is along y.
fn upright(t: f64) -> Vector3<f64> {
    Vector3::new(0.0, t.cos(), t.sin())
}

/// The position `(u, z)`, at home, of a point given in the platform.
fn in_platform(home: &Home, [p, q]: [f64; 2]) -> Vector2<f64> {
    let rotated = nalgebra::Rotation2::new(home.phi) * Vector2::new(p, q);
    Vector2::new(home.y + rotated.x, home.w + rotated.y)
}

/// Checks the meaning of every parameter on the placed joints.
fn assert_geometry(family: &PlanarPlanar, mechanism: &Mechanism) -> Result<(), TestCaseError> {
    let home = &family.home;
    let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() < ROUNDING;
    let up = Vector3::z();
    let value = |c: &Joint| c.coordinates[0].home;
    prop_assert_eq!(mechanism.platform, Point3::new(home.x, home.y, home.w));
    for (i, (given, leg)) in family.slider_legs.iter().zip(&mechanism.legs).enumerate() {
        let names: Vec<_> = leg.coordinates().map(|c: &JointCoordinate| c.name.as_str()).collect();
        let expected = ["S", "phi1", "phi2", "rod", "hinge"].map(|s| format!("{s}{}", i + 1));
        prop_assert_eq!(names, expected);
        let [s, phi1, phi2, rod, hinge] = &leg.joints[..] else { unreachable!() };
        let n = e(given.alpha + FRAC_PI_2);
        let (a, c, foot, k) =
            (phi1.point.coords, phi2.point.coords, rod.point.coords, hinge.point.coords);
        let sigma = leg.imaginary.as_ref().unwrap().home;
        let (first, second) = (value(phi1), value(phi2));

        prop_assert!(near(a, e(given.alpha) * given.h + n * value(s)));
        prop_assert!(near(c - a, e(given.alpha + FRAC_PI_2 + first) * given.a1));
        prop_assert!(near(c, Vector3::new(home.x + given.c, home.y + sigma, 0.0)));
        prop_assert!((e(given.alpha + FRAC_PI_2 + first + second) - e(0.0)).norm() < ROUNDING);
        prop_assert!(near(foot - c, up * given.g));
        prop_assert!(near(k - foot, upright(value(rod)) * given.l));
        prop_assert!((k.yz() - in_platform(home, given.platform)).norm() < ROUNDING);
        prop_assert!((upright(value(rod) + value(hinge)) - upright(home.phi)).norm() < ROUNDING);
        for (joint, axis) in [(s, n), (phi1, up), (phi2, up), (rod, e(0.0)), (hinge, e(0.0))] {
            prop_assert!(near(joint.axis.into_inner(), axis), "{}", joint.name);
        }
        prop_assert!((foot - k).y * given.upper.sign() >= -ROUNDING);
        prop_assert!((a - c).dot(&n) * given.slider.sign() >= -ROUNDING);
    }

    let given = &family.arm_leg;
    let [phi14, phi24, fold1, fold2, hinge] = &mechanism.legs[3].joints[..] else { unreachable!() };
    let (first, second) = (value(phi14), value(phi24));
    let elbow = phi24.point.coords;
    prop_assert!(near(phi14.point.coords, Vector3::new(given.base[0], given.base[1], 0.0)));
    prop_assert!(near(elbow - phi14.point.coords, e(first) * given.b1));
    prop_assert!((elbow.x - home.x - given.c).abs() < ROUNDING);
    prop_assert!((e(first + second) - e(0.0)).norm() < ROUNDING);
    prop_assert!(near(fold1.point.coords - elbow, Vector3::new(0.0, given.f, given.g)));
    let (lower, upper) = (value(fold1), value(fold1) + value(fold2));
    prop_assert!(near(fold2.point - fold1.point, upright(lower) * given.d1));
    prop_assert!(near(hinge.point - fold2.point, upright(upper) * given.d2));
    prop_assert!((hinge.point.coords.yz() - in_platform(home, given.platform)).norm() < ROUNDING);
    prop_assert!((upright(upper + value(hinge)) - upright(home.phi)).norm() < ROUNDING);
    prop_assert!((elbow.y - given.base[1]) * given.lower.sign() >= -ROUNDING);
    prop_assert!(value(fold2).sin() * given.fold.sign() >= -ROUNDING);
    Ok(())
}

#[test]
fn the_shipped_parameters_are_where_they_belong() {
    let family = shipped();
    assert_geometry(&family, &family.assemble().unwrap()).unwrap();
}

fn branch() -> impl Strategy<Value = Branch> {
    prop::bool::ANY.prop_map(|plus| if plus { Branch::Plus } else { Branch::Minus })
}

fn point(size: f64) -> impl Strategy<Value = [f64; 2]> {
    [-size..size, -size..size]
}

prop_compose! {
    fn slider(index: usize)(
        alpha in -4.0..4.0_f64, h in 0.0..0.4_f64, a1 in 0.1..0.5_f64, c in -0.2..0.2_f64,
        g in -0.1..0.1_f64, l in 0.1..0.5_f64, platform in point(0.1),
        upper in branch(), slider in branch(),
    ) -> SliderLeg {
        let name = format!("leg{}", index + 1);
        let limits = SliderLimits::default();
        SliderLeg { name, alpha, h, a1, c, g, l, platform, upper, slider, limits }
    }
}

prop_compose! {
    fn arm()(
        base in point(0.4), b1 in 0.1..0.5_f64, c in -0.2..0.2_f64, f in -0.1..0.1_f64,
        g in -0.1..0.1_f64, d1 in 0.1..0.4_f64, d2 in 0.1..0.4_f64, platform in point(0.1),
        lower in branch(), fold in branch(),
    ) -> ArmLeg {
        let limits = ArmLimits::default();
        ArmLeg { name: "leg4".into(), base, b1, c, f, g, d1, d2, platform, lower, fold, limits }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5_000, max_global_rejects: 400_000, ..Default::default() })]

    #[test]
    fn whatever_assembles_is_where_it_belongs(
        place in point(0.1), w in 0.1..0.4_f64, phi in -3.0..3.0_f64,
        legs in (slider(0), slider(1), slider(2)), arm_leg in arm(),
    ) {
        let family = PlanarPlanar {
            name: "random".into(),
            home: Home { x: place[0], y: place[1], w, phi },
            slider_legs: vec![legs.0, legs.1, legs.2],
            arm_leg,
        };
        let assembled = family.assemble();
        // One draw in forty is within reach of all four legs.
        prop_assume!(assembled.is_ok());
        assert_geometry(&family, &assembled.unwrap())?;
    }
}

/// Each problem is reported for its own leg, in the words of the file.
#[test]
fn every_problem_is_reported() {
    let mut family = shipped();
    family.slider_legs[0].l = 0.1;
    family.slider_legs[1].a1 = -1.0;
    family.slider_legs[2].limits.s.range = Some([0.0, 0.1]);
    family.arm_leg.b1 = 0.05;
    let problems = family.assemble().unwrap_err().problems;
    let found: Vec<_> = problems.iter().map(|p| (p.leg, p.parameter)).collect();
    let expected =
        [(Some(0), None), (Some(1), Some("a1")), (Some(2), Some("limits")), (Some(3), None)];
    assert_eq!(found, expected, "{problems:?}");
    assert!(problems[0].to_string().contains("rods"), "{}", problems[0]);
    assert!(problems[3].to_string().contains("links"), "{}", problems[3]);
}

#[test]
fn home_and_the_number_of_legs_are_checked() {
    let mut family = shipped();
    family.home.w = f64::NAN;
    family.slider_legs.pop();
    let problems = family.assemble().unwrap_err().problems;
    let found: Vec<_> = problems.iter().map(|p| (p.leg, p.parameter)).collect();
    assert_eq!(found, [(None, Some("w")), (None, Some("slider_leg"))], "{problems:?}");
}
