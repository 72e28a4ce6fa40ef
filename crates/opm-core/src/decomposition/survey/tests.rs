use super::*;
use crate::decomposition::samples::*;
use crate::decomposition::{DecomposeError, PlatformSet, decompose, search_all};
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{Point3, Unit, Vector3};

type Direction = Unit<Vector3<f64>>;

fn universal(first: Direction, second: Direction, point: Point3<f64>) -> Joint {
    Joint::new("", JointKind::Universal { second }, first, point)
}

/// Legs around the vertical: the outward direction and the tangent of each.
fn around(count: usize) -> impl Iterator<Item = (Vector3<f64>, Direction)> {
    (0..count).map(move |i| {
        let angle = std::f64::consts::TAU * i as f64 / count as f64 + 0.1 + 0.03 * i as f64;
        (Vector3::new(angle.cos(), angle.sin(), 0.0), unit(-angle.sin(), angle.cos(), 0.0))
    })
}

/// RUU legs whose first axis and whose outer axes of the universal joints are parallel.
fn ruu(count: usize, vertical: bool) -> Mechanism {
    let leg = |(outward, tangent): (Vector3<f64>, Direction)| {
        let axis = if vertical { Vector3::z_axis() } else { tangent };
        let elbow_at =
            if vertical { outward * 0.3 + tangent.into_inner() * 0.12 } else { outward * 0.33 };
        let (base, elbow) = (Point3::from(outward * 0.2), Point3::from(elbow_at));
        let end = Point3::from(outward * 0.06 - Vector3::z() * 0.4);
        let across = Unit::new_normalize((end - elbow).cross(&axis));
        vec![
            revolute(axis, base).actuated(),
            universal(axis, across, elbow),
            universal(across, axis, end),
        ]
    };
    mechanism("ruu", around(count).map(leg).collect())
}

fn rps() -> Mechanism {
    let leg = |(outward, tangent): (Vector3<f64>, Direction)| {
        let (base, top) = (outward * 0.2, outward * 0.12 + Vector3::z() * 0.3);
        vec![
            revolute(tangent, base.into()),
            prismatic(Unit::new_normalize(top - base)).actuated(),
            spherical(top.into()),
        ]
    };
    mechanism("rps", around(3).map(leg).collect())
}

fn because(found: &Survey) -> String {
    let Applies::Outside(reason) = &found.applies else { panic!("{:?}", found.applies) };
    reason.to_string()
}

#[test]
fn a_gough_platform() {
    let found = survey(&gough(&mut Numbers::new(1))).unwrap();
    assert_eq!((&*found.notation, found.common_name), ("6-UPS", Some("Gough-Stewart platform")));
    let motion =
        PlatformMotion { dimension: 6, translations: 3, subspace: Some(SubspaceClass::Full) };
    assert_eq!((found.mobility.mobility, &found.platform), (6, &motion));
    for leg in &found.legs {
        assert_eq!(
            (&*leg.chain, leg.span, leg.subspace, leg.is_closed()),
            ("UPS", 6, SubspaceClass::Full, true)
        );
        assert_eq!(leg.actuated.len(), 1);
    }
    assert_eq!(found.applies.name(), "every leg");
}

/// The legs generate all displacements, although they have five freedoms each.
#[test]
fn a_delta_robot() {
    let found = survey(&ruu(3, false)).unwrap();
    assert_eq!(found.notation, "3-RUU");
    assert!(found.common_name.unwrap().starts_with("Delta robot"), "{:?}", found.common_name);
    assert_eq!(found.platform.subspace, Some(SubspaceClass::TranslationalSpace));
    assert_eq!((found.platform.dimension, found.platform.translations), (3, 3));
    let leg = &found.legs[0];
    assert_eq!((leg.span, leg.subspace, leg.is_closed()), (5, SubspaceClass::Full, false));
    assert_eq!(found.applies.name(), "every leg");
}

#[test]
fn four_ruu_legs() {
    let found = survey(&ruu(4, true)).unwrap();
    assert_eq!(found.notation, "4-RUU");
    assert_eq!(found.common_name, Some("4-RUU Schoenflies-motion generator"));
    let Some(SubspaceClass::Schoenflies { axis }) = found.platform.subspace else { panic!() };
    assert!(axis.cross(&Vector3::z()).norm() < 1e-12);
    assert_eq!(found.applies.name(), "every leg");
}

/// Each leg has a plane and a centre of its own.
#[test]
fn three_rps_legs() {
    let found = survey(&rps()).unwrap();
    assert_eq!((&*found.notation, found.common_name), ("3-RPS", Some("3-RPS tripod")));
    assert_eq!((found.platform.dimension, found.platform.translations), (3, 1));
    assert_eq!(found.platform.subspace, None);
    let Applies::Decomposed(ways) = &found.applies else { panic!("{:?}", found.applies) };
    assert_eq!(ways[0].platform(), PlatformSet::Constrained);
    assert_eq!((found.applies.name(), ways[0].upper.name()), ("every leg", "spherical"));
}

/// All axes but one meet in a point: nothing but that joint has a length, so no miss is small. It is named, with the
/// distance by which it misses the centre.
#[test]
fn the_axis_that_misses_the_centre_of_all_others_is_named() {
    for name in ["agile-eye", "orbita"] {
        let text = crate::mechanism::examples::find(name).unwrap().text;
        let exact = crate::mechanism::file::read(text).unwrap().mechanism;
        for off in [1e-5, 5e-4, 2e-2] {
            for (leg, joint) in (0..3).flat_map(|leg| (0..3).map(move |joint| (leg, joint))) {
                let mut bent = exact.clone();
                let odd = &mut bent.legs[leg].joints[joint];
                let across = odd.axis.cross(&Vector3::new(0.3, 0.5, -0.8)).normalize();
                odd.point += across * off;
                let name = odd.name.clone();
                let found = survey(&bent).unwrap();
                let Applies::Outside(
                    Outside::Indivisible { odd: Some(odd), .. }
                    | Outside::NothingShared { odd: Some(odd), .. },
                ) = &found.applies
                else {
                    panic!("{name} off by {off}: {:?}", found.applies)
                };
                assert_eq!(odd.joint, name);
                assert!((odd.distance - off).abs() < 1e-9 * off, "{odd}");
                let told = because(&found);
                let expected = format!("only joint {name} of leg leg{} does not fit", leg + 1);
                assert!(told.contains(&expected), "{told}");
            }
        }
    }
}

#[test]
fn a_mechanism_of_the_class_decomposes() {
    let found = survey(&PlanoSpherical::default().mechanism()).unwrap();
    assert_eq!(found.notation, "3-PRRRR + RRS");
    assert_eq!((found.applies.name(), found.near), ("two subspaces", None));
    assert_eq!(found.legs[3].subspace, SubspaceClass::Full);
    assert_eq!(found.legs.iter().map(|leg| leg.span).collect::<Vec<_>>(), [5, 5, 5, 5]);
}

/// The groups that legs generate, from the literature: Hervé's table of subgroups.
#[test]
fn what_joints_generate() {
    let (o, p) = (Point3::origin(), Point3::new(0.1, 0.2, 0.0));
    let (x, z) = (Vector3::x_axis(), Vector3::z_axis());
    let oblique = unit(1.0, 0.0, 1.0);
    let cases: Vec<(&str, Vec<Joint>)> = vec![
        ("rotation", vec![revolute(z, o), revolute(z, Point3::new(0.0, 0.0, 1.0))]),
        ("translation", vec![prismatic(x), prismatic(x)]),
        ("helical", vec![helical(z, o, 0.01), helical(z, o, 0.01)]),
        ("cylindrical", vec![helical(z, o, 0.01), helical(z, o, 0.02)]),
        ("cylindrical", vec![revolute(z, o), prismatic(z)]),
        ("translational plane", vec![prismatic(x), prismatic(oblique)]),
        (
            "translational space",
            vec![prismatic(x), prismatic(oblique), prismatic(Vector3::y_axis())],
        ),
        ("planar", vec![revolute(z, o), revolute(z, p)]),
        ("planar", vec![revolute(z, o), prismatic(x)]),
        ("planar helical", vec![helical(z, o, 0.01), helical(z, p, 0.01)]),
        ("schoenflies", vec![helical(z, o, 0.01), revolute(z, p)]),
        ("schoenflies", vec![revolute(z, o), prismatic(oblique)]),
        ("spherical", vec![revolute(z, o), revolute(x, o)]),
        ("spherical", vec![revolute(x, p), spherical(p)]),
        ("full", vec![revolute(z, o), revolute(x, p + Vector3::z())]),
        ("full", vec![spherical(o), prismatic(x)]),
    ];
    for (name, joints) in cases {
        let found =
            survey(&mechanism(name, vec![joints, vec![spherical(p), spherical(o)]])).unwrap();
        assert_eq!(found.legs[0].subspace.name(), name, "{}", found.legs[0].chain);
    }
}

/// At design stage there are no motors yet: the sections come first.
#[test]
fn actuators_do_not_decide_the_sections() {
    let exact = PlanoSpherical::default().mechanism();
    let expected = decompose(&exact).unwrap();
    let mut passive = exact.clone();
    passive
        .legs
        .iter_mut()
        .flat_map(|leg| &mut leg.joints)
        .for_each(|joint| joint.actuated = false);
    let mut redundant = exact.clone();
    redundant.legs[0].joints[1].actuated = true;
    let mut loose = exact;
    loose.legs[3].joints[1].actuated = false;
    for mechanism in [&passive, &redundant, &loose] {
        assert_eq!(search_all(mechanism).as_ref(), Ok(&expected));
        assert_eq!(survey(mechanism).unwrap().applies, Applies::Decomposed(expected.clone()));
    }
    assert!(matches!(decompose(&passive), Err(DecomposeError::NoActuator { mobility: 5 })));
    assert!(matches!(decompose(&loose), Err(DecomposeError::Loose { .. })));
}

#[test]
fn structures_and_singular_homes_are_told() {
    let two = [unit(0.1, 0.2, 1.0), unit(1.0, -0.4, 0.5)].map(CommonGeometry::Planar);
    let rigid = two_sections(two, &[[2, 1]; 4], 1, &mut Numbers::new(7));
    let found = survey(&rigid).unwrap();
    assert_eq!(because(&found), "it cannot move: its mobility N is 0");

    // The arm is stretched.
    let mut singular = PlanoSpherical::default().mechanism();
    let arm = &mut singular.legs[3].joints;
    arm[1].point = Point3::from(arm[0].point.coords * 0.5);
    let found = survey(&singular).unwrap();
    assert!(
        because(&found).starts_with("its home pose is singular (serial"),
        "{}",
        because(&found)
    );
}
