use super::*;
use crate::mechanism::examples;
use crate::mechanism::family::{AssemblyReason, Family};
use crate::mechanism::file;
use nalgebra::Isometry3;
use proptest::prelude::*;

/// Tolerance: the rounding of a few dozen operations on lengths below a metre and angles of a few
/// radians.
const ROUNDING: f64 = 1e-12;

/// Tolerance for reference values: half a unit of their sixth decimal.
const PRINTED: f64 = 0.5e-6;

fn paper() -> PlanoSpherical {
    let text = examples::find("plano-spherical-5dof").unwrap().text;
    match file::read(text).unwrap().family {
        Some(Family::PlanoSpherical(family)) => family,
        other => panic!("{other:?}"),
    }
}

fn at(mut family: PlanoSpherical, degrees: [f64; 3], upper: Branch) -> PlanoSpherical {
    let [zeta, xi, psi] = degrees.map(f64::to_radians);
    family.home = Home { zeta, xi, psi, ..family.home };
    for leg in &mut family.slider_legs {
        leg.upper = upper;
    }
    family
}

fn theta1(mechanism: &Mechanism) -> [f64; 3] {
    [0, 1, 2].map(|i| mechanism.legs[i].imaginary.as_ref().unwrap().home)
}

/// Whether two angles are equal up to full revolutions.
fn same_angle(a: f64, b: f64, tolerance: f64) -> bool {
    let apart = (a - b) / TAU;
    ((apart - apart.round()) * TAU).abs() < tolerance
}

#[test]
fn imaginary_joints_have_the_published_values() {
    let plus = Branch::Plus;
    let minus = Branch::Minus;
    // Values of an independent implementation for the paper's parameters.
    for (pose, upper, expected) in [
        ([0.0, 0.0, 0.0], plus, [0.155_324, 2.249_719, 4.344_115]),
        ([0.0, 0.0, 0.0], minus, [2.986_268, 5.080_663, 0.891_873]),
        ([0.0, 20.0, 0.0], plus, [0.226_775, 2.006_096, 4.538_244]),
        ([0.0, 20.0, 0.0], minus, [2.914_818, 4.886_534, 1.135_496]),
        ([30.0, 20.0, -10.0], plus, [0.595_875, 2.365_971, 4.869_578]),
        ([30.0, 20.0, -10.0], minus, [3.286_056, 5.226_662, 1.484_959]),
    ] {
        let found = theta1(&at(paper(), pose, upper).assemble().unwrap());
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < PRINTED, "{pose:?}: {found} {expected}");
        }
    }
}

/// Checks the meaning of every parameter on the placed joints.
fn assert_geometry(family: &PlanoSpherical, mechanism: &Mechanism) -> Result<(), TestCaseError> {
    let Home { x, y, .. } = family.home;
    let platform = Point3::new(x, y, 0.0);
    prop_assert_eq!(mechanism.platform, platform);
    for (i, (given, leg)) in family.slider_legs.iter().zip(&mechanism.legs).enumerate() {
        let names: Vec<_> = leg.joints.iter().map(|joint| joint.name.as_str()).collect();
        let expected = ["S", "phi1", "phi2", "theta2", "theta3"].map(|s| format!("{s}{}", i + 1));
        prop_assert_eq!(names, expected);
        let [s, phi1, phi2, theta2, theta3] = &leg.joints[..] else { unreachable!() };
        let home = |joint: &Joint| joint.coordinates[0].home;
        let (a, c) = (phi1.point, phi2.point);
        let e = Vector3::new(given.alpha.cos(), given.alpha.sin(), 0.0);
        let n = Vector3::new(-e.y, e.x, 0.0);

        prop_assert!((a - Point3::from(e * given.h + n * home(s))).norm() < ROUNDING);
        prop_assert!(((c - a).norm() - given.a1).abs() < ROUNDING);
        prop_assert!(((platform - c).norm() - given.a2).abs() < ROUNDING);
        prop_assert!((theta2.point - platform).norm() < ROUNDING);
        prop_assert!((theta3.point - platform).norm() < ROUNDING);
        prop_assert!((s.axis.into_inner() - n).norm() < ROUNDING);
        prop_assert!((phi1.axis.into_inner() - Vector3::z()).norm() < ROUNDING);
        prop_assert!((phi2.axis.into_inner() - Vector3::z()).norm() < ROUNDING);

        let (v, w) = (theta2.axis.into_inner(), theta3.axis.into_inner());
        let r = family.home.rotation().into_inner();
        let (se, ce, sb, cb) =
            (given.eta.sin(), given.eta.cos(), given.beta.sin(), given.beta.cos());
        prop_assert!((w - r * Vector3::new(sb * ce, sb * se, cb)).norm() < ROUNDING);
        prop_assert!((v.z - given.alpha1.cos()).abs() < ROUNDING);
        prop_assert!((v.dot(&w) - given.alpha2.cos()).abs() < ROUNDING);

        // The directions of the links, from the reported values.
        let theta1 = leg.imaginary.as_ref().unwrap().home;
        prop_assert!((0.0..TAU).contains(&theta1));
        let direction = |from: Point3<f64>, to: Point3<f64>| (to.y - from.y).atan2(to.x - from.x);
        prop_assert!(same_angle(direction(platform, c), theta1, 1e-9), "{i}: a2 along theta1");
        let a1_angle = given.alpha + FRAC_PI_2 + home(phi1);
        prop_assert!(same_angle(direction(a, c), a1_angle, 1e-9), "{i}: a1 along phi1");
        prop_assert!(same_angle(a1_angle + home(phi2), theta1, 1e-9), "{i}: phi2");
        prop_assert!((v - rz(theta1) * rx(given.alpha1) * Vector3::z()).norm() < ROUNDING);
        // The whole upper section at once.
        let chain =
            rz(theta1) * rx(given.alpha1) * rz(home(theta2)) * rx(given.alpha2) * rz(home(theta3));
        let platform_axis = Rotation3::from_matrix_unchecked(r) * rz(given.eta) * ry(given.beta);
        prop_assert!((chain.matrix() - platform_axis.matrix()).norm() < ROUNDING);

        // The branches: on which sides z, v, w and the slider are.
        let side = Vector3::z().dot(&v.cross(&w));
        prop_assert!(side * given.upper.sign() >= -1e-9);
        prop_assert!((c - a).dot(&n) * given.slider.sign() <= 1e-9);
    }
    let given = &family.arm_leg;
    let [phi14, phi24, s4] = &mechanism.legs[3].joints[..] else { unreachable!() };
    let (d, elbow) = (phi14.point, phi24.point);
    prop_assert!((d - Point3::new(given.base[0], given.base[1], 0.0)).norm() < ROUNDING);
    prop_assert!(((elbow - d).norm() - given.b1).abs() < ROUNDING);
    prop_assert!(((platform - elbow).norm() - given.b2).abs() < ROUNDING);
    prop_assert_eq!(s4.point, platform);
    let first = phi14.coordinates[0].home;
    let second = phi24.coordinates[0].home;
    let along = |length: f64, angle: f64| Vector3::new(angle.cos(), angle.sin(), 0.0) * length;
    prop_assert!((elbow - d - along(given.b1, first)).norm() < ROUNDING);
    prop_assert!((platform - elbow - along(given.b2, first + second)).norm() < ROUNDING);
    prop_assert!(second.sin() * given.elbow.sign() >= -1e-9);
    Ok(())
}

#[test]
fn the_paper_s_parameters_are_where_they_belong() {
    let family = paper();
    assert_geometry(&family, &family.assemble().unwrap()).unwrap();
}

fn branch() -> impl Strategy<Value = Branch> {
    prop::bool::ANY.prop_map(|plus| if plus { Branch::Plus } else { Branch::Minus })
}

prop_compose! {
    fn slider(index: usize)(
        alpha in -7.0..7.0_f64, h in 0.0..0.3, a1 in 0.02..0.5, a2 in 0.02..0.3,
        alpha1 in 0.1..3.0_f64, alpha2 in 0.1..3.0_f64, eta in -7.0..7.0_f64, beta in -3.0..3.0_f64,
        upper in branch(), slider in branch(),
    ) -> SliderLeg {
        SliderLeg {
            name: format!("leg{index}"), alpha, h, a1, a2, alpha1, alpha2, eta, beta, upper, slider,
            limits: SliderLimits::default(),
        }
    }
}

prop_compose! {
    fn any_family()(
        sliders in [slider(1), slider(2), slider(3)],
        x in -0.2..0.2, y in -0.2..0.2, zeta in -4.0..4.0_f64, xi in -2.0..2.0_f64,
        psi in -4.0..4.0_f64, base in [-0.2..0.2, -0.2..0.2], b1 in 0.05..0.4, b2 in 0.05..0.4,
        elbow in branch(),
    ) -> PlanoSpherical {
        let free = JointLimits::default();
        PlanoSpherical {
            name: "random".into(),
            home: Home { x, y, zeta, xi, psi },
            slider_legs: sliders.into(),
            arm_leg: ArmLeg { name: "arm".into(), base, b1, b2, elbow, phi1: free, phi2: free },
        }
    }
}

/// The angle by which the leg's arcs miss home; negative if they reach it.
fn arcs_short_by(home: &Home, leg: &SliderLeg) -> f64 {
    let w = home.rotation() * rz(leg.eta) * ry(leg.beta) * Vector3::z();
    let to_z = w.z.clamp(-1.0, 1.0).acos();
    let (nearest, sum) = ((leg.alpha1 - leg.alpha2).abs(), leg.alpha1 + leg.alpha2);
    (nearest - to_z).max(to_z - sum.min(TAU - sum))
}

/// The length by which the arm's links miss home.
fn arm_short_by(home: &Home, arm: &ArmLeg) -> f64 {
    let distance = (home.x - arm.base[0]).hypot(home.y - arm.base[1]);
    (distance - arm.b1 - arm.b2).max((arm.b1 - arm.b2).abs() - distance)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    #[test]
    fn random_parameters_assemble_or_say_which_arcs_or_links_fall_short(family in any_family()) {
        match family.assemble() {
            Ok(mechanism) => assert_geometry(&family, &mechanism)?,
            Err(error) => {
                for problem in &error.problems {
                    let AssemblyReason::OutOfReach { links, deficit } = &problem.reason else {
                        return Err(TestCaseError::fail(format!("{problem}")));
                    };
                    // acos loses half the digits near the poles.
                    let short_by = match (problem.leg.unwrap(), *links) {
                        (SLIDER_LEGS, _) => arm_short_by(&family.home, &family.arm_leg),
                        (i, "arcs") => arcs_short_by(&family.home, &family.slider_legs[i]),
                        // The links of a slider leg are checked only after its arcs have been found
                        // to reach.
                        (i, _) => {
                            let leg = &family.slider_legs[i];
                            prop_assert!(arcs_short_by(&family.home, leg) < 1e-7);
                            prop_assert!(deficit.excess > 0.0);
                            continue;
                        }
                    };
                    prop_assert!((deficit.excess - short_by).abs() < 1e-7, "{} {short_by}", deficit.excess);
                }
            }
        }
    }
}

#[test]
fn a_leg_that_is_too_short_says_by_how_much() {
    let mut family = paper();
    // From P at the origin, and a2 = 60 mm, C is 60 mm away; e(α) of leg 1 leads 120 mm out.
    family.slider_legs[0].a1 = 0.01;
    let text = family.assemble().unwrap_err().to_string();
    // |Q·e(α)| - a1 with Q·e(α) = a2 cos(θ1 - α) - h.
    let theta1 = 0.155_323_8_f64;
    let gap = (0.06 * (theta1 - 30.0_f64.to_radians()).cos() - 0.12).abs() - 0.01;
    assert!(
        text.starts_with(&format!("leg 1: home is out of this leg's reach by {gap:.6} m")),
        "{text}"
    );

    let mut family = paper();
    family.arm_leg.base = [0.0, 0.275];
    let text = family.assemble().unwrap_err().to_string();
    assert!(text.contains("leg 4: home is out of this leg's reach by 0.075 m"), "{text}");

    let mut family = paper();
    family.slider_legs[2].alpha2 = 150.0_f64.to_radians();
    // |75 - 150| = 75 degrees, and the axis is 60 degrees from z.
    let text = family.assemble().unwrap_err().to_string();
    assert!(text.contains("leg 3: home is out of this leg's reach by 0.261799 rad"), "{text}");
}

#[test]
fn every_problem_is_reported_with_its_leg() {
    let mut family = paper();
    family.slider_legs[1].a1 = -0.2;
    family.slider_legs[1].alpha1 = 0.0;
    family.slider_legs[2].name = "leg1".into();
    family.arm_leg.b2 = f64::NAN;
    family.slider_legs[0].limits.s.range = Some([0.4, 0.5]);
    let problems = family.assemble().unwrap_err().problems;
    let found: Vec<_> = problems.iter().map(|p| (p.leg, p.parameter)).collect();
    assert_eq!(
        found,
        [
            (Some(0), Some("limits")),
            (Some(1), Some("a1")),
            (Some(1), Some("alpha1")),
            (Some(2), Some("name")),
            (Some(3), Some("b2"))
        ]
    );
}

#[test]
fn an_angle_at_home_is_taken_within_its_limits() {
    let mut family = paper();
    let free = family.assemble().unwrap();
    let phi1 = free.legs[0].joints[1].coordinates[0].home;
    family.slider_legs[0].limits.phi1.range = Some([phi1 + TAU - 0.1, phi1 + TAU + 0.2]);
    let limited = family.assemble().unwrap();
    let joint = &limited.legs[0].joints[1];
    assert!((joint.coordinates[0].home - phi1 - TAU).abs() < ROUNDING);
    // It is the same position.
    let moved = joint.displacement(&[joint.coordinates[0].home]).unwrap();
    assert!((moved.to_matrix() - Isometry3::identity().to_matrix()).norm() < ROUNDING);
}

#[test]
fn the_working_mode_is_written_leg_by_leg() {
    let mut family = paper();
    assert_eq!(family.mode(), "++ ++ ++ +");
    family.slider_legs[1].slider = Branch::Minus;
    family.arm_leg.elbow = Branch::Minus;
    assert_eq!(family.mode(), "++ +- ++ -");
}
