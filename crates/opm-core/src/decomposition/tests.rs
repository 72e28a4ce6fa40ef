use super::samples::*;
use super::*;
use crate::group::screw::Screw;
use crate::group::subspace::TOLERANCE;
use crate::mechanism::file::LengthUnit;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{DMatrix, Isometry3, Point3, Unit, Vector3};
use proptest::prelude::*;

/// Tolerance for geometry fitted to exact joints, relative to the mechanism's size: the rounding of
/// a few dozen operations.
const EXACT: f64 = 1e-13;

/// The numbers λ, N, J and M of a decomposition.
type Counts = [usize; 4];

fn counts(d: &Decomposition) -> Counts {
    [d.lambda, d.mobility, d.imaginary_joints, d.first_section_motions]
}

/// The lower and upper freedoms of every leg, and whether it has an imaginary joint.
fn pattern(d: &Decomposition) -> Vec<(usize, usize, bool)> {
    d.legs.iter().map(|leg| (leg.lower.len(), leg.upper.len(), leg.imaginary)).collect()
}

fn only(mechanism: &Mechanism) -> Decomposition {
    let mut found = decompose(mechanism).unwrap();
    assert_eq!(found.len(), 1, "{} decomposes in one way", mechanism.name);
    found.remove(0)
}

fn line(axis: Unit<Vector3<f64>>, point: Point3<f64>) -> Screw {
    Screw::rotation(axis, point)
}

fn assert_direction(found: Unit<Vector3<f64>>, expected: Unit<Vector3<f64>>) {
    assert!((found.into_inner() - expected.into_inner()).norm() < EXACT, "{found:?}");
}

#[test]
fn plano_spherical() {
    let d = only(&PlanoSpherical::default().mechanism());
    assert_eq!(counts(&d), [5, 5, 3, 2]);
    assert_eq!(pattern(&d), [(3, 2, true), (3, 2, true), (3, 2, true), (2, 3, false)]);
    assert_eq!((d.upper_mobility, d.redundancy), (0, 0));
    assert!(d.deviation < EXACT);
    let SubspaceClass::Planar { normal } = d.lower else { panic!("{}", d.lower) };
    assert_direction(normal, Vector3::z_axis());
    let SubspaceClass::Spherical { centre } = d.upper else { panic!("{}", d.upper) };
    assert!(centre.coords.norm() < EXACT);
    let SubspaceClass::Rotation { axis, point } = d.intersection else { panic!() };
    assert_direction(axis, Vector3::z_axis());
    assert!(point.coords.xy().norm() < EXACT);
}

#[test]
fn translational_helical_mechanism() {
    let d = only(&translational_helical());
    assert_eq!(counts(&d), [3, 3, 1, 2]);
    assert_eq!(pattern(&d), [(2, 1, true), (2, 1, false), (2, 1, false)]);
    // 255 degrees, pointing up.
    let axis = unit(75.0_f64.to_radians().cos(), 75.0_f64.to_radians().sin(), 0.0);
    let SubspaceClass::TranslationalPlane { normal } = d.lower else { panic!("{}", d.lower) };
    assert_direction(normal, Vector3::z_axis());
    let SubspaceClass::Cylindrical { axis: found, point } = d.upper else { panic!("{}", d.upper) };
    assert_direction(found, axis);
    assert!(point.coords.cross(&axis).norm() < EXACT);
    let SubspaceClass::Translation { axis: found } = d.intersection else { panic!() };
    assert_direction(found, axis);
}

#[test]
fn bennetts_double_spherical_linkage() {
    let d = only(&bennett());
    assert_eq!(counts(&d), [5, 1, 1, 0]);
    assert_eq!(pattern(&d), [(1, 1, true), (2, 2, false)]);
    let [a, b] = [[0.0, 0.0, 0.0], [0.3, 0.05, 0.1]].map(Point3::from);
    let SubspaceClass::Spherical { centre } = d.lower else { panic!("{}", d.lower) };
    assert!((centre - a).norm() < EXACT);
    let SubspaceClass::Spherical { centre } = d.upper else { panic!("{}", d.upper) };
    assert!((centre - b).norm() < EXACT);
    let SubspaceClass::Rotation { axis, point } = d.intersection else { panic!() };
    let centres = line(Unit::new_normalize(b - a), a);
    assert!(same_line(&line(axis, point), &centres) < EXACT);
}

#[test]
fn two_spherical_subspaces() {
    let d = only(&two_spherical(&mut Numbers::new(3)));
    assert_eq!(counts(&d), [5, 5, 3, 2]);
    assert_eq!(pattern(&d), [(3, 2, true), (3, 2, true), (3, 2, true), (2, 3, false)]);
    assert_eq!((d.lower.name(), d.upper.name()), ("spherical", "spherical"));
    assert_eq!(d.intersection.name(), "rotation");
}

#[test]
fn two_planar_subspaces() {
    let d = only(&two_planar(&mut Numbers::new(4)));
    assert_eq!(counts(&d), [5, 5, 3, 2]);
    assert_eq!(pattern(&d), [(3, 2, true), (3, 2, true), (3, 2, true), (2, 3, false)]);
    assert_eq!((d.lower.name(), d.upper.name()), ("planar", "planar"));
    let SubspaceClass::Translation { axis } = d.intersection else { panic!() };
    let cross = unit(0.1, 0.2, 1.0).cross(&unit(1.0, -0.4, 0.5));
    assert!(axis.cross(&cross).norm() < EXACT);
}

/// Four RRR|RR legs have more imaginary joints than their upper section has freedoms.
#[test]
fn redundant_imaginary_joints() {
    let normals = [unit(0.1, 0.2, 1.0), unit(1.0, -0.4, 0.5)].map(CommonGeometry::Planar);
    let mechanism = two_sections(normals, &[[3, 2]; 4], 5, &mut Numbers::new(5));
    let d = only(&mechanism);
    assert_eq!(counts(&d), [5, 5, 3, 2]);
    assert_eq!(pattern(&d), [(3, 2, true); 4]);
    assert_eq!((d.upper_mobility, d.redundancy), (0, 1));
}

/// With two RR|RR legs, the lower section has exactly the freedoms of the mechanism, and no single
/// imaginary joint moves the upper section. All four together do, so all of them must be there.
#[test]
fn imaginary_joints_that_only_move_together() {
    let normals = [unit(0.1, 0.2, 1.0), unit(1.0, -0.4, 0.5)].map(CommonGeometry::Planar);
    let legs = [[3, 2], [3, 2], [2, 2], [2, 2]];
    let d = only(&two_sections(normals, &legs, 3, &mut Numbers::new(5)));
    assert_eq!(counts(&d), [5, 3, 3, 0]);
    assert!(d.legs.iter().all(|leg| leg.imaginary));
    assert_eq!(d.redundancy, 1);
}

#[test]
fn planar_and_cylindrical_subspaces() {
    let d = only(&planar_cylindrical());
    assert_eq!(counts(&d), [4, 4, 1, 3]);
    assert_eq!(pattern(&d), [(3, 1, false), (3, 1, false), (3, 1, false), (3, 1, true)]);
    assert_eq!((d.lower.name(), d.upper.name()), ("planar", "cylindrical"));
    let SubspaceClass::Translation { axis } = d.intersection else { panic!() };
    assert_direction(axis, Vector3::x_axis());
}

/// It has no partial subspaces: each leg is solved by itself.
#[test]
fn a_gough_platform_is_solved_leg_by_leg() {
    let found = decompose(&gough(&mut Numbers::new(1))).unwrap();
    let [found] = &found[..] else { panic!("{found:?}") };
    assert!(found.is_whole());
    assert_eq!(found.platform(), PlatformSet::Free);
    assert_eq!([found.lambda, found.mobility, found.imaginary_joints], [6, 6, 0]);
    assert!(found.legs.iter().all(|leg| leg.whole.is_some() && leg.lower.len() == 6));
}

/// A revolute joint that passes the common centre is named, with its distance from the centre.
#[test]
fn a_joint_that_misses_the_centre_is_named() {
    let mut mechanism = PlanoSpherical::default().mechanism();
    let joint = &mut mechanism.legs[1].joints[4];
    let across = joint.axis.cross(&Vector3::x()).normalize();
    joint.point += across * 4.3e-3;
    let text = decompose(&mechanism).unwrap_err().to_string();
    assert!(text.contains("within a tolerance of 0.0043 m") && !text.contains("mm"), "{text}");
    mechanism.units.length = LengthUnit::Millimetre;
    let error = decompose(&mechanism).unwrap_err();
    let near = match &error {
        DecomposeError::NoPartialSubspaces { near: Some(near), .. }
        | DecomposeError::SingularHome { near: Some(near), .. } => near,
        _ => panic!("{error}"),
    };
    assert_eq!((near.lower.name(), near.upper.name()), ("planar", "spherical"));
    let [miss] = &near.joints[..] else { panic!("{near}") };
    assert_eq!([&*miss.leg, &*miss.joint], ["leg2", "leg2.5"]);
    assert!((miss.distance - 4.3e-3).abs() < 1e-9, "{miss}");
    let told = "joint leg2.5 of leg leg2: its axis passes the centre of the others at 4.30 mm";
    assert!(error.to_string().ends_with(told), "{error}");
}

/// Every exchange of two neighbours that matters is named, and so is a leg from platform to base: what is named makes the
/// mechanism what it was.
#[test]
fn a_wrong_order_of_joints_is_named() {
    let right = PlanoSpherical::default().mechanism();
    let mut named = 0;
    for leg in 0..right.legs.len() {
        for joint in 1..right.legs[leg].joints.len() {
            let mut wrong = right.clone();
            wrong.legs[leg].joints.swap(joint - 1, joint);
            let Err(error) = decompose(&wrong) else { continue };
            let [a, b] = [joint - 1, joint].map(|i| wrong.legs[leg].joints[i].name.clone());
            let told = format!(
                "; leg {}: exchange {a} and {b}: then it decomposes into planar and spherical",
                right.legs[leg].name
            );
            assert!(error.to_string().ends_with(&told), "{error}");
            named += 1;
        }
        let mut wrong = right.clone();
        wrong.legs[leg].joints.reverse();
        let error = decompose(&wrong).unwrap_err().to_string();
        assert!(error.contains(&format!("leg {}: ", right.legs[leg].name)), "{error}");
        assert!(error.ends_with(": then it decomposes into planar and spherical"), "{error}");
    }
    // The planar joint and the spherical one that meet in each of three legs, and the ball in the fourth.
    assert!(named >= 4, "{named}");

    // The same slip in all legs of a kind.
    let mut wrong = right.clone();
    wrong.legs[..3].iter_mut().for_each(|leg| leg.joints.swap(2, 3));
    let error = decompose(&wrong).unwrap_err();
    let (DecomposeError::SingularHome { order: Some(order), .. }
    | DecomposeError::NoPartialSubspaces { order: Some(order), .. }) = &error
    else {
        panic!("{error}")
    };
    let exchange = |leg: &str| OrderChange::Exchange {
        leg: leg.to_owned(),
        joints: [format!("{leg}.4"), format!("{leg}.3")],
    };
    assert_eq!(order.changes, ["leg1", "leg2", "leg3"].map(exchange));

    // Two of four legs from platform to base: those, and not the other two.
    let mut wrong = right.clone();
    wrong.legs[..2].iter_mut().for_each(|leg| leg.joints.reverse());
    let error = decompose(&wrong).unwrap_err().to_string();
    let told = "leg leg1: reverse its joints, which run from base to platform; leg leg2: reverse its joints";
    assert!(error.contains(told), "{error}");
}

/// A joint along the intersection motion may belong to either section.
#[test]
fn every_decomposition_is_listed_and_a_passive_upper_section_is_preferred() {
    let mut mechanism = PlanoSpherical::default().mechanism();
    let leg = &mut mechanism.legs[0].joints;
    leg[2].point = Point3::new(0.0, 0.0, 0.4);
    // The slider has no lever arm on such a joint; a motor on the joint itself has.
    leg[0].actuated = false;
    leg[2].actuated = true;
    let found = decompose(&mechanism).unwrap();
    let splits: Vec<_> = found.iter().map(|d| (pattern(d)[0], d.upper_mobility)).collect();
    assert_eq!(splits, [((3, 2, true), 0), ((2, 3, false), 1)]);
    assert!(found.iter().all(|d| counts(d)[1..] == counts(&found[0])[1..]));
}

/// Joints with several freedoms in place of single ones: the split goes through them.
#[test]
fn cuts_within_universal_and_cylindrical_joints() {
    let mut mechanism = planar_cylindrical();
    let leg = &mut mechanism.legs[0].joints;
    // The third joint rotates about z, the fourth about x: with a common point they are a universal
    // joint.
    let corner = Point3::new(leg[2].point.x, 0.0, 0.0);
    let kind = JointKind::Universal { second: leg[3].axis };
    leg.truncate(2);
    leg.push(Joint::new("u", kind, Vector3::z_axis(), corner));
    // A fifth leg ends in a cylindrical joint along x. Its translation is along the intersection
    // motion, so it may belong to either section; its rotation can only be in the upper section.
    let kind = JointKind::Cylindrical;
    let fifth = vec![
        revolute(Vector3::z_axis(), Point3::new(0.3, -0.3, 0.0)),
        revolute(Vector3::z_axis(), Point3::new(0.1, -0.25, 0.0)),
        Joint::new("c", kind, Vector3::x_axis(), Point3::origin()),
    ];
    mechanism.legs.push(Leg::new("leg5", fifth));

    let found = decompose(&mechanism).unwrap();
    let freedom = |joint, index| Freedom { joint, index };
    let ends = |d: &Decomposition, leg: usize| {
        (*d.legs[leg].lower.last().unwrap(), *d.legs[leg].upper.first().unwrap())
    };
    for d in &found {
        assert_eq!(ends(d, 0), (freedom(2, 0), freedom(2, 1)));
        assert_eq!((d.lower.name(), d.upper.name()), ("planar", "cylindrical"));
    }
    // The split that leaves the cylindrical joint whole is preferred.
    let ways: Vec<_> = found.iter().map(|d| ends(d, 4)).collect();
    assert_eq!(ways, [(freedom(1, 0), freedom(2, 0)), (freedom(2, 1), freedom(2, 0))]);
    for d in &found {
        assert_eq!(counts(d), [4, 4, 1, 3]);
        let imaginary: Vec<_> = d.legs.iter().map(|leg| leg.imaginary).collect();
        assert_eq!(imaginary, [false, false, false, true, false]);
    }
}

#[test]
fn structures_and_missing_actuators_are_reported() {
    let mut numbers = Numbers::new(7);
    let two = [unit(0.1, 0.2, 1.0), unit(1.0, -0.4, 0.5)].map(CommonGeometry::Planar);
    let rigid = two_sections(two, &[[2, 1]; 4], 1, &mut numbers);
    assert_eq!(decompose(&rigid), Err(DecomposeError::NoFreedom { lambda: 5, near: None }));

    let mut idle = PlanoSpherical::default().mechanism();
    idle.legs.iter_mut().flat_map(|leg| &mut leg.joints).for_each(|joint| joint.actuated = false);
    assert_eq!(decompose(&idle), Err(DecomposeError::NoActuator { mobility: 5 }));
}

#[test]
fn a_loose_platform_is_reported_with_its_motion() {
    let mut mechanism = PlanoSpherical::default().mechanism();
    mechanism.legs[3].joints[1].actuated = false;
    let error = decompose(&mechanism).unwrap_err();
    let DecomposeError::Loose { mobility: 5, actuators: 4, controlled: 4, free, .. } = &error
    else {
        panic!("{error}")
    };
    assert_eq!(free.len(), 1);
    // With the elbow locked, the upper arm's end can only rotate about its base. P moves
    // perpendicular to the arm's outer link about the elbow.
    let motion = &free[0].screws()[0];
    let elbow = mechanism.legs[3].joints[1].point;
    assert!(motion.linear.dot(&(Point3::origin() - elbow)).abs() < 1e-12);
    assert!(error.to_string().contains("4 actuated freedoms control 4"));
}

#[test]
fn legs_that_are_missing_are_reported() {
    let mut mechanism = bennett();
    mechanism.legs[1].joints.clear();
    let error = decompose(&mechanism).unwrap_err();
    assert_eq!(error.to_string(), "leg \"leg2\" has no joints");
    mechanism.legs.pop();
    let error = decompose(&mechanism).unwrap_err();
    assert!(error.to_string().contains("\"bennett\": number of legs is 1"), "{error}");
}

#[test]
fn numbers_that_are_not_finite_are_reported() {
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let mut mechanism = bennett();
        mechanism.legs[1].joints[2].point.y = bad;
        let error = decompose(&mechanism).unwrap_err();
        assert!(error.to_string().contains("leg \"leg2\", joint \"leg2.3\""), "{error}");
    }
}

#[test]
fn six_legs_of_six_joints_visit_few_splits() {
    // Each has 7^6 = 117649 splits, or 5^6 where spherical joints stay whole.
    let normals = [unit(0.1, 0.2, 1.0), unit(1.0, -0.4, 0.5)].map(CommonGeometry::Planar);
    let redundant = two_sections(normals, &[[3, 3]; 6], 11, &mut Numbers::new(8));
    let spherical = [Point3::new(0.1, 0.0, 0.05), Point3::new(-0.1, 0.2, 0.3)];
    let pairs = two_sections(
        spherical.map(CommonGeometry::Spherical),
        &[[3, 3]; 6],
        11,
        &mut Numbers::new(9),
    );
    let gough = gough(&mut Numbers::new(1));
    for (mechanism, ways) in [(&redundant, 1), (&pairs, 1), (&gough, 0)] {
        let report = crate::decomposition::mobility::mobility(mechanism).unwrap();
        let (found, visited) = search(mechanism, &report, 1);
        assert_eq!(found.len(), ways);
        // A leg has seven candidates; six of them are dropped at once.
        assert!(visited <= 7 * 6, "{}: {visited}", mechanism.name);
    }
}

/// The mechanisms above whose decomposition is known, by number; the random ones are regular.
fn sample(which: usize, seed: u64) -> Mechanism {
    let numbers = &mut Numbers::new(seed);
    match which {
        0 => PlanoSpherical::default().mechanism(),
        1 => translational_helical(),
        2 => bennett(),
        3 => regular(|| two_spherical(numbers)),
        4 => regular(|| two_planar(numbers)),
        _ => planar_cylindrical(),
    }
}

/// The first mechanism whose legs and actuators are far from singular. The measure is the smallest
/// singular value, by nalgebra's decomposition, of matrices that must have full rank.
fn regular(mut draw: impl FnMut() -> Mechanism) -> Mechanism {
    const FAR: f64 = 1e-3;
    let smallest = |matrix: DMatrix<f64>| matrix.singular_values().min();
    let columns =
        |screws: &[Screw]| DMatrix::from_fn(6, screws.len(), |i, j| screws[j].to_vector()[i]);
    loop {
        let mechanism = draw();
        let legs = mechanism.legs.iter().map(|leg| smallest(columns(&leg.screws())));
        let passive = mechanism.legs.iter().map(|leg| -> Vec<Screw> {
            leg.joints.iter().filter(|j| !j.actuated).flat_map(Joint::screws).collect()
        });
        let passive: Vec<_> = passive.collect();
        let count = passive.iter().map(Vec::len).sum::<usize>();
        let mut closure = DMatrix::zeros(6 * passive.len(), count + 6);
        let mut column = 0;
        for (k, leg) in passive.iter().enumerate() {
            closure.view_mut((6 * k, column), (6, leg.len())).copy_from(&columns(leg));
            closure.view_mut((6 * k, count), (6, 6)).fill_with_identity();
            column += leg.len();
        }
        if legs.fold(smallest(closure), f64::min) > FAR {
            return mechanism;
        }
    }
}

const SAMPLES: usize = 6;

fn moved(class: &SubspaceClass, g: &Isometry3<f64>) -> SubspaceClass {
    use SubspaceClass::*;
    let turn = |axis: &Unit<Vector3<f64>>| g.rotation * *axis;
    match class {
        Rotation { axis, point } => Rotation { axis: turn(axis), point: g * point },
        Translation { axis } => Translation { axis: turn(axis) },
        TranslationalPlane { normal } => TranslationalPlane { normal: turn(normal) },
        Cylindrical { axis, point } => Cylindrical { axis: turn(axis), point: g * point },
        Planar { normal } => Planar { normal: turn(normal) },
        Spherical { centre } => Spherical { centre: g * centre },
        other => panic!("{other} does not occur here"),
    }
}

/// Largest difference between two classes of one kind. Axes are compared as lines; lengths are
/// divided by `size`.
fn difference(a: &SubspaceClass, b: &SubspaceClass, size: f64) -> f64 {
    use SubspaceClass::*;
    let axes = |a: &Unit<Vector3<f64>>, b: &Unit<Vector3<f64>>| a.cross(b).norm();
    let points = |p: &Point3<f64>, q: &Point3<f64>| (p - q).norm() / size;
    match (a, b) {
        (Translation { axis: a }, Translation { axis: b })
        | (TranslationalPlane { normal: a }, TranslationalPlane { normal: b })
        | (Planar { normal: a }, Planar { normal: b }) => axes(a, b),
        (Rotation { axis: a, point: p }, Rotation { axis: b, point: q })
        | (Cylindrical { axis: a, point: p }, Cylindrical { axis: b, point: q }) => {
            // Points on one line, each nearest to the origin of its base.
            let apart = p - q;
            axes(a, b).max(points(p, &(q + a.into_inner() * a.dot(&apart))))
        }
        (Spherical { centre: p }, Spherical { centre: q }) => points(p, q),
        _ => f64::INFINITY,
    }
}

fn deviation(a: &Decomposition, b: &Decomposition, g: &Isometry3<f64>, size: f64) -> f64 {
    let pairs = [(&a.lower, &b.lower), (&a.upper, &b.upper), (&a.intersection, &b.intersection)];
    pairs.iter().map(|(a, b)| difference(&moved(a, g), b, size)).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn decomposition_moves_with_the_mechanism(
        which in 0..SAMPLES, seed in 0..20_u64, reach in 0.0..3.0,
    ) {
        let mechanism = sample(which, seed);
        let g = Numbers::new(seed).displacement(reach);
        let (here, there) = (only(&mechanism), only(&displaced(&mechanism, &g)));
        prop_assert_eq!(&here.legs, &there.legs);
        prop_assert_eq!(counts(&here), counts(&there));
        // Points several sizes away lose several times as many digits.
        prop_assert!(deviation(&here, &there, &g, frame(&mechanism).length) < 100.0 * EXACT);
    }

    #[test]
    fn decomposition_does_not_depend_on_the_order_of_legs(
        which in 0..SAMPLES, seed in 0..20_u64, order in Just([0, 1, 2, 3]).prop_shuffle(),
    ) {
        let mechanism = sample(which, seed);
        let order: Vec<usize> = order.into_iter().filter(|&i| i < mechanism.legs.len()).collect();
        let mut shuffled = mechanism.clone();
        shuffled.legs = order.iter().map(|&i| mechanism.legs[i].clone()).collect();
        let (here, there) = (only(&mechanism), only(&shuffled));
        for (to, &from) in order.iter().enumerate() {
            prop_assert_eq!(&here.legs[from], &there.legs[to]);
        }
        prop_assert_eq!(counts(&here), counts(&there));
        let size = frame(&mechanism).length;
        prop_assert!(deviation(&here, &there, &Isometry3::identity(), size) < 10.0 * EXACT);
    }

    #[test]
    fn decomposition_does_not_depend_on_the_unit_of_length(
        which in 0..SAMPLES, seed in 0..20_u64, exponent in -3.0..3.0,
    ) {
        let mechanism = sample(which, seed);
        let factor = 10.0_f64.powf(exponent);
        let (here, there) = (only(&mechanism), only(&scaled(&mechanism, factor)));
        prop_assert_eq!(&here.legs, &there.legs);
        prop_assert_eq!(counts(&here), counts(&there));
        let back = match there.upper {
            SubspaceClass::Spherical { centre } => SubspaceClass::Spherical { centre: centre / factor },
            SubspaceClass::Cylindrical { axis, point } => {
                SubspaceClass::Cylindrical { axis, point: point / factor }
            }
            other => other,
        };
        prop_assert!(difference(&here.upper, &back, frame(&mechanism).length) < 10.0 * EXACT);
    }

    /// Six significant digits, anywhere within a few metres: five times the size of these
    /// mechanisms.
    #[test]
    fn decomposition_survives_six_digits(
        which in 0..SAMPLES, seed in 0..20_u64, reach in 0.0..1.5,
    ) {
        let mechanism = sample(which, seed);
        let g = Numbers::new(seed).displacement(reach);
        let exact = only(&mechanism);
        let printed = only(&rounded(&displaced(&mechanism, &g)));
        prop_assert_eq!(&exact.legs, &printed.legs);
        prop_assert_eq!(counts(&exact), counts(&printed));
        prop_assert!(printed.deviation < TOLERANCE);
        prop_assert!(deviation(&exact, &printed, &g, frame(&mechanism).length) < 10.0 * TOLERANCE);
    }
}

#[test]
fn results_are_the_same_in_every_run() {
    for which in 0..SAMPLES {
        let mechanism = sample(which, 1);
        assert_eq!(decompose(&mechanism), decompose(&mechanism));
    }
}
