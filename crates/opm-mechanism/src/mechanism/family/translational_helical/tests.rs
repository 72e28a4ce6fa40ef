use super::*;
use crate::mechanism::examples;
use crate::mechanism::family::Family;
use crate::mechanism::file;
use proptest::prelude::*;

/// Tolerance: the rounding of a few dozen operations on lengths below a metre.
const ROUNDING: f64 = 1e-12;

fn paper() -> TranslationalHelical {
    let text = examples::find("translational-helical-3dof").unwrap().text;
    match file::read(text).unwrap().family {
        Some(Family::TranslationalHelical(family)) => family,
        other => panic!("{other:?}"),
    }
}

/// Checks the meaning of every parameter on the placed joints.
fn assert_geometry(
    family: &TranslationalHelical,
    mechanism: &Mechanism,
) -> Result<(), TestCaseError> {
    let Home { x, y, phi } = family.home;
    let platform = Point3::new(x, y, 0.0);
    prop_assert_eq!(mechanism.platform, platform);
    let direction = family.legs[0].alpha + family.legs[0].beta;
    let k_hat = Vector3::new(direction.cos(), direction.sin(), 0.0);
    prop_assert!((mechanism.task.axis.unwrap() + k_hat).norm() < ROUNDING);
    let home = [("x", x), ("y", y), ("phi", phi)].map(|(name, value)| (name.to_owned(), value));
    prop_assert_eq!(&mechanism.task.home, &home);
    for (i, (given, leg)) in family.legs.iter().zip(&mechanism.legs).enumerate() {
        let [s, r, last] = &leg.joints[..] else { unreachable!() };
        let names = [&s.name, &r.name, &last.name].map(String::as_str);
        prop_assert_eq!(names, ["S", "r", "phi"].map(|n| format!("{n}{}", i + 1)));
        prop_assert_eq!([s.actuated, r.actuated, last.actuated], [true, false, false]);
        let home = |joint: &Joint| joint.coordinates[0].home;
        let e = Vector3::new(given.alpha.cos(), given.alpha.sin(), 0.0);
        let n = Vector3::new(-e.y, e.x, 0.0);
        prop_assert!((s.axis.into_inner() - n).norm() < ROUNDING);
        prop_assert!((r.axis.into_inner() - e).norm() < ROUNDING);
        prop_assert!((last.axis.into_inner() + k_hat).norm() < ROUNDING);
        // Eqs. 27-28 as vectors: P = r e + S n - (k + p φ) k̂.
        let advance = given.pitch.map_or(0.0, |pitch| pitch * phi);
        let p = e * home(r) + n * home(s) - k_hat * (given.k + advance);
        prop_assert!((p - platform.coords).norm() < ROUNDING);
        prop_assert!(
            (last.point.coords - platform.coords - k_hat * (given.k + advance)).norm() < ROUNDING
        );
        prop_assert_eq!(home(last), phi);

        match (given.pitch, &leg.imaginary) {
            (Some(pitch), Some(label)) => {
                prop_assert_eq!(last.kind, JointKind::Helical { pitch });
                prop_assert_eq!(&label.name, "S");
                prop_assert!((label.home - pitch * phi).abs() < ROUNDING);
                prop_assert!((label.positive - k_hat).norm() < ROUNDING);
            }
            (None, None) => prop_assert_eq!(last.kind, JointKind::Revolute),
            other => prop_assert!(false, "{:?}", other),
        }
        // Rotating the last joint alone, with the sliders held, moves P by -p dφ k̂; so S grows by
        // p dφ.
        let rotated = leg.displacement(&[home(s), home(r), phi + 0.3]).unwrap();
        let moved = rotated * platform - platform;
        let expected = -k_hat * (0.3 * given.pitch.unwrap_or(0.0));
        prop_assert!((moved - expected).norm() < ROUNDING);
    }
    Ok(())
}

#[test]
fn the_paper_s_parameters_are_where_they_belong() {
    let mut family = paper();
    assert_geometry(&family, &family.assemble().unwrap()).unwrap();
    family.home = Home { x: 0.03, y: -0.05, phi: 7.5 };
    assert_geometry(&family, &family.assemble().unwrap()).unwrap();
}

#[test]
fn sliders_at_home_are_those_of_equation_27() {
    // S_i = n(α_i)·P + sin(β_i) k_i with P = 0 and the printed k, in metres.
    let mechanism = paper().assemble().unwrap();
    let expected = [
        0.010 * 45.0_f64.to_radians().sin(),
        0.015 * 285.0_f64.to_radians().sin(),
        0.025 * 165.0_f64.to_radians().sin(),
    ];
    for (leg, expected) in mechanism.legs.iter().zip(expected) {
        assert!((leg.joints[0].coordinates[0].home - expected).abs() < ROUNDING);
    }
}

prop_compose! {
    fn any_family()(
        direction in -7.0..7.0_f64,
        alphas in [-7.0..7.0_f64, -7.0..7.0_f64, -7.0..7.0_f64],
        ks in [-0.2..0.2, -0.2..0.2, -0.2..0.2],
        turns in [-2..3, -2..3, -2..3],
        helical in 0..3_usize,
        pitch in prop_oneof![-0.1..-0.001, 0.001..0.1],
        x in -0.3..0.3, y in -0.3..0.3, phi in -20.0..20.0_f64,
    ) -> TranslationalHelical {
        let leg = |i: usize| TranslationalLeg {
            name: format!("leg{i}"),
            alpha: alphas[i],
            beta: direction - alphas[i] + TAU * f64::from(turns[i]),
            k: ks[i],
            pitch: (i == helical).then_some(pitch),
            limits: LegLimits::default(),
        };
        TranslationalHelical {
            name: "random".into(), home: Home { x, y, phi }, legs: vec![leg(0), leg(1), leg(2)],
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    #[test]
    fn random_parameters_assemble(family in any_family()) {
        let mechanism = family.assemble().map_err(|error| TestCaseError::fail(error.to_string()))?;
        assert_geometry(&family, &mechanism)?;
    }
}

#[test]
fn legs_of_different_directions_are_refused_with_both_angles() {
    let mut family = paper();
    family.legs[2].beta += 5.0_f64.to_radians();
    let error = family.assemble().unwrap_err();
    let [problem] = &error.problems[..] else { panic!("{error}") };
    assert_eq!((problem.leg, problem.parameter), (Some(2), Some("beta")));
    let degrees =
        file::FileUnits { length: file::LengthUnit::Millimetre, angle: file::AngleUnit::Degree };
    let text = problem.describe(degrees);
    assert!(text.contains("260 deg") && text.contains("expected 255 deg"), "{text}");
}

#[test]
fn exactly_one_leg_has_a_pitch() {
    let mut none = paper();
    none.legs[0].pitch = None;
    assert!(none.assemble().unwrap_err().to_string().contains("has no `pitch`"));

    let mut two = paper();
    two.legs[2].pitch = Some(0.02);
    let problems = two.assemble().unwrap_err().problems;
    assert_eq!((problems[0].leg, problems[0].parameter), (Some(2), Some("pitch")));
    assert_eq!(problems[0].reason, AssemblyReason::HelicalLegs(2));

    let mut zero = paper();
    zero.legs[0].pitch = Some(0.0);
    assert_eq!(zero.assemble().unwrap_err().problems[0].reason, AssemblyReason::NoPitch);
}
