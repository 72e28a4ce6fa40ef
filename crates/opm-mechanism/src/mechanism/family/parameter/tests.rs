use super::*;
use crate::mechanism::{examples, file};
use ParameterValue::{Number, Pair};
use proptest::prelude::*;

const FAMILIES: [&str; 3] =
    ["plano-spherical-5dof", "translational-helical-3dof", "planar-planar-5dof"];

fn text(name: &str) -> &'static str {
    examples::find(name).unwrap().text
}

fn family(name: &str) -> Family {
    file::read(text(name)).unwrap().family.unwrap()
}

/// The family of the text with each first pattern replaced by the second one; whole lines, from the
/// key on.
fn edited(name: &str, edits: &[(&str, &str)]) -> Family {
    let mut text = text(name).to_owned();
    for (old, new) in edits {
        assert!(text.contains(old), "{old:?}");
        text = text.replace(old, new);
    }
    file::read(&text).unwrap().family.unwrap()
}

#[test]
fn a_change_by_name_is_the_change_in_the_file() {
    let degree = |angle: f64| Number(file::AngleUnit::Degree.factor() * angle);
    let paper = "plano-spherical-5dof";
    for (name, edits, changes) in [
        (paper, &[("\nh = 120", "\nh = 130")][..], &[("h", Number(0.13))][..]),
        (paper, &[("alpha = 150", "alpha = 140")], &[("leg2.alpha", degree(140.0))]),
        (paper, &[("base = [0, 75]", "base = [10, 70]")], &[("leg4.base", Pair([0.01, 0.07]))]),
        (paper, &[("S = [-300, 300]", "S = [-250, 300]")], &[("limits.S", Pair([-0.25, 0.3]))]),
        (paper, &[("limits = { S = [-300, 300] }", "")], &[("limits.S", ParameterValue::None)]),
        (
            paper,
            &[("S = [-300, 300] }", "S = [-300, 300] }\nmax_rate = { S = 500 }")],
            &[("max_rate.S", Number(0.5))],
        ),
        (
            paper,
            &[("b2 = 100", "b2 = 100\nmax_acceleration = { phi2 = 180 }")],
            &[("leg4.max_acceleration.phi2", degree(180.0))],
        ),
        (
            paper,
            &[("b2 = 100", "b2 = 100\nlimits = { phi1 = [-180, 180] }")],
            &[("leg4.limits.phi1", Pair([-180.0, 180.0].map(|v: f64| v.to_radians())))],
        ),
        (
            paper,
            &[("xi = 0", "xi = 5"), ("x = 0, y", "x = 9, y")],
            &[("xi", degree(5.0)), ("home.x", Number(0.009))],
        ),
        // One leg apart from the others, whichever name comes first.
        (
            paper,
            &[
                ("\na2 = 60", "\na2 = 50"),
                (
                    "a2 = 50                        # chosen\nalpha1 = 75                    # printed\nalpha2 = 75                    # printed\neta = 120",
                    "a2 = 70\nalpha1 = 75\nalpha2 = 75\neta = 120",
                ),
            ],
            &[("leg2.a2", Number(0.07)), ("a2", Number(0.05))],
        ),
        ("translational-helical-3dof", &[("pitch = 20", "pitch = 30")], &[("pitch", Number(0.03))]),
    ] {
        let changed = family(name).with(changes.iter().copied()).unwrap();
        assert_eq!(changed, edited(name, edits), "{changes:?}");
        assert_ne!(changed, family(name));
    }
}

/// Whether a value that is not given would be a number, not a pair.
fn is_number(name: &str) -> bool {
    const NUMBERS: [&str; 6] = [
        ".max_",
        ".offset.",
        ".rotor_inertia.",
        ".gear.",
        ".viscous_friction.",
        ".coulomb_friction.",
    ];
    NUMBERS.iter().any(|part| name.contains(part))
}

#[test]
fn every_parameter_is_listed_and_can_be_set() {
    for (name, count) in FAMILIES.into_iter().zip([
        5 + 3 * (8 + 9 * 5) + 3 + 9 * 2,
        3 + 3 * (3 + 9 * 3) + 1,
        4 + 3 * (7 + 9 * 5) + 8 + 9 * 5,
    ]) {
        let family = family(name);
        let parameters = family.parameters();
        assert_eq!(parameters.len(), count, "{name}");
        for (parameter, value) in &parameters {
            let changed = match value {
                ParameterValue::None if is_number(parameter) => Number(0.75),
                ParameterValue::None => Pair([-0.1, 0.2]),
                Number(value) => Number(value + 0.125),
                Pair([a, b]) => Pair([a - 0.125, b + 0.25]),
            };
            let other = family.with([(parameter.as_str(), changed)]).unwrap();
            let differing: Vec<_> = other.parameters().into_iter().zip(&parameters).collect();
            for (now, before) in differing {
                assert_eq!(now.1, if now.0 == *parameter { changed } else { before.1 });
            }
        }
        let listed = parameters.iter().map(|(name, value)| (name.as_str(), *value));
        assert_eq!(family.with(listed).unwrap(), family);
    }
}

/// An offset changes what a joint's value is called, and nothing that moves.
#[test]
fn offsets_shift_values_and_move_nothing() {
    for (name, offset, joint) in [
        ("plano-spherical-5dof", "leg2.offset.S", "S2"),
        ("plano-spherical-5dof", "leg4.offset.phi1", "phi14"),
        ("translational-helical-3dof", "leg1.offset.phi", "phi1"),
        ("planar-planar-5dof", "leg1.offset.S", "S1"),
    ] {
        let before = family(name).assemble().unwrap();
        let after = family(name).with([(offset, Number(0.01))]).unwrap().assemble().unwrap();
        for (before, after) in before.joints().zip(after.joints()) {
            assert!((before.point - after.point).norm() < 1e-15 && before.axis == after.axis);
            let shift = if before.name == joint { 0.01 } else { 0.0 };
            let apart = after.coordinates[0].home - before.coordinates[0].home;
            assert!((apart - shift).abs() < 1e-15, "{name} {}: {apart}", before.name);
        }
    }
}

#[test]
fn every_problem_is_reported_with_its_parameter() {
    let paper = family("plano-spherical-5dof");
    let problems = paper
        .with([
            ("leg1.hh", Number(1.0)),
            ("leg1.h", Number(f64::NAN)),
            ("a1", Number(1e10)),
            ("base", Number(1.0)),
            ("leg2.a2", Pair([0.0, 1.0])),
            ("h", ParameterValue::None),
            ("limits.S", Pair([0.3, -0.3])),
            ("leg4.limits.phi2", Number(1.0)),
            ("leg1.max_rate.S", Number(-0.5)),
            ("leg2.max_acceleration.S", Pair([0.0, 1.0])),
            ("leg3.max_rate.S", Number(f64::NAN)),
        ])
        .unwrap_err()
        .problems;
    let expected = [
        "`leg1.hh` is not a parameter; did you mean `leg1.h`? home has x, y, zeta, xi, psi; leg1, leg2, leg3 have alpha, h, \
         a1, a2, alpha1, alpha2, eta, beta, and limits, max_rate, max_acceleration, max_effort, rotor_inertia, gear, viscous_friction, coulomb_friction and offset (limits.S, ...) of S, phi1, phi2, \
         theta2, theta3; leg4 has base, b1, b2, and limits, max_rate, max_acceleration, max_effort, rotor_inertia, gear, viscous_friction, coulomb_friction and offset (limits.phi1, ...) of phi1, \
         phi2",
        "`a1` is 10000000000 m, expected an absolute value of at most 1000000000 m",
        "`base` is a number, expected a point [x, y]",
        "`h` is nothing, expected a number",
        "`limits.S` are reversed: 0.3 m is above -0.3 m, expected [lowest, highest]",
        "`leg1.h` is NaN, expected a finite number",
        "`leg2.a2` is a pair, expected a number",
        "`leg4.limits.phi2` is a number, expected limits [lowest, highest] or none",
        "`leg1.max_rate.S` is -0.5 m/s, expected a value above 0",
        "`leg2.max_acceleration.S` is a pair, expected a number or none",
        "`leg3.max_rate.S` is NaN, expected a finite number",
    ];
    assert_eq!(problems, expected);
    // A parameter that only the helical leg has.
    let helical = family("translational-helical-3dof");
    assert!(helical.with([("leg1.pitch", Number(0.1))]).is_ok());
    let error = helical.with([("leg2.pitch", Number(0.1))]).unwrap_err().to_string();
    assert!(
        error.starts_with("`leg2.pitch` is not a parameter; home has x, y, phi; leg1 has"),
        "{error}"
    );
}

#[test]
fn what_does_not_assemble_is_reported_by_leg() {
    let paper = family("plano-spherical-5dof").with([("a1", Number(-1.0)), ("b1", Number(9.0))]);
    let paper = paper.unwrap();
    let found = paper.explain(&paper.assemble().unwrap_err()).problems;
    assert_eq!(found.len(), 4);
    assert_eq!(found[1], "leg2: `a1` is -1 m, expected a length above 0");
    assert!(found[3].starts_with("leg4: home is out of this leg's reach by "), "{}", found[3]);
}

#[test]
fn a_name_with_dots_and_backslashes_is_still_a_name() {
    let mut paper = family("plano-spherical-5dof");
    if let Family::PlanoSpherical(family) = &mut paper {
        family.slider_legs[0].name = r"left.h\é".into();
        family.slider_legs[1].name = "home".into();
    }
    let changed = paper.with([(r"left.h\é.h", Number(0.1)), ("home.h", Number(0.2))]).unwrap();
    let values: Vec<_> =
        changed.parameters().into_iter().filter(|(name, _)| name.ends_with(".h")).collect();
    assert_eq!(
        [&values[0].1, &values[1].1, &values[2].1],
        [&Number(0.1), &Number(0.2), &Number(0.12)]
    );
    assert_eq!(file::read(&changed.write()).unwrap().family.unwrap(), changed);
}

proptest! {
    /// Written and read again, a family is the same to the last bit; so is its mechanism.
    #[test]
    fn a_written_family_is_read_again(
        which in 0..FAMILIES.len(),
        shares in prop::collection::vec(-0.02..0.02_f64, 260),
        signs in prop::collection::vec(any::<bool>(), 8),
    ) {
        let family = family(FAMILIES[which]);
        let changed = family.parameters().into_iter().zip(shares);
        let changed: Vec<_> = changed
            // Directions of the helical family's legs have to agree.
            .filter(|((name, _), _)| which != 1 || !(name.ends_with("alpha") || name.ends_with("beta")))
            .map(|((name, value), share)| match value {
                Number(value) => (name, Number(value * (1.0 + share))),
                Pair(pair) => (name, Pair(pair.map(|value| value * (1.0 + share)))),
                ParameterValue::None if name.contains(".offset.") => (name, Number(share)),
                ParameterValue::None if is_number(&name) => (name, Number(1.0 + share)),
                ParameterValue::None => (name, Pair([-10.0 + share, 10.0 + share])),
            })
            .collect();
        let mut changed =
            family.with(changed.iter().map(|(name, value)| (name.as_str(), *value))).unwrap();
        let branch = |i: usize| [crate::chain::Branch::Plus, crate::chain::Branch::Minus][usize::from(signs[i])];
        if let Family::PlanoSpherical(family) = &mut changed {
            for (i, leg) in family.slider_legs.iter_mut().enumerate() {
                (leg.upper, leg.slider) = (branch(2 * i), branch(2 * i + 1));
            }
            family.arm_leg.elbow = branch(6);
        }
        let mechanism = changed.assemble();
        prop_assume!(mechanism.is_ok());
        let read = file::read(&changed.write()).unwrap();
        prop_assert_eq!(read.family.unwrap(), changed);
        prop_assert_eq!(read.mechanism, mechanism.unwrap());
    }
}
