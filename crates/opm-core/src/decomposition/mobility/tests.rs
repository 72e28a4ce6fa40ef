use super::*;
use crate::decomposition::decompose;
use crate::decomposition::samples::*;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::Leg;
use nalgebra::{Point3, Unit, Vector3};
use proptest::prelude::*;

fn report(mechanism: &Mechanism) -> Mobility {
    mobility(mechanism).unwrap()
}

/// Manipulators 1 with any proportions that can be assembled and a distance of more than a
/// twentieth from their singular poses, measured by the published singularity conditions.
fn plano_spherical() -> impl Strategy<Value = PlanoSpherical> {
    let angles = [0.0..6.3, 0.0..6.3, 0.0..6.3];
    let arcs = [0.5..1.6, 0.5..1.6];
    let lengths = (0.02..0.2, 0.15..0.4, 0.03..0.1);
    let arm = ([-0.15..0.15, -0.15..0.15], [0.05..0.15, 0.05..0.15]);
    let all = (angles.clone(), angles, 0.3..1.4, arcs, lengths, arm);
    all.prop_map(|(alpha, eta, beta, arcs, (h, a1, a2), (base, arm))| PlanoSpherical {
        alpha,
        h,
        a1,
        a2,
        arcs,
        eta,
        beta,
        base,
        arm,
    })
    .prop_filter("cannot be assembled or nearly singular", |p| {
        const MARGIN: f64 = 0.05;
        let Some(mechanism) = p.try_mechanism() else { return false };
        let mut normals = vec![];
        for i in 0..3 {
            let joints = &mechanism.legs[i].joints;
            let slider = joints[0].axis.into_inner();
            let link = (joints[2].point - joints[1].point) / p.a1;
            let elbow = joints[2].point.coords / p.a2;
            let normal = joints[3].axis.cross(&joints[4].axis);
            let margins = [link.dot(&slider), link.cross(&elbow).z, normal.z];
            if margins.iter().any(|m| m.abs() < MARGIN) {
                return false;
            }
            normals.push(normal);
        }
        let [base, elbow] = [0, 1].map(|i| mechanism.legs[3].joints[i].point.coords);
        let fold = (elbow - base).cross(&elbow).z / (p.arm[0] * p.arm[1]);
        fold.abs() > MARGIN && normals[0].dot(&normals[1].cross(&normals[2])).abs() > MARGIN
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, max_global_rejects: 100_000, ..Default::default() })]

    /// Regular manipulators are found regular, with the published numbers, for any proportions.
    #[test]
    fn regular_manipulators_are_regular(p in plano_spherical()) {
        let report = report(&p.mechanism());
        prop_assert_eq!(&report.singular, &vec![]);
        prop_assert_eq!((report.lambda, report.mobility, report.idle), (5, 5, 0));
        prop_assert_eq!((report.actuators, report.controlled), (5, 5));
        prop_assert!(report.loose.is_empty() && report.redundant.is_empty());
    }
}

/// The links a1 and a2 of one leg are in line, so the slider has no lever arm on the imaginary
/// joint. This is a parallel singularity of the lower section; the leg itself is as mobile as ever.
#[test]
fn links_in_line_are_a_parallel_singularity() {
    let mut p = PlanoSpherical::default();
    let (_, theta) = p.upper(0).unwrap();
    // The foot of the slider's normal on the line of the links, a1 beyond the elbow.
    p.h = (p.a2 + p.a1) * (theta - p.alpha[0]).cos();
    let mut mechanism = p.mechanism();
    let [pin, elbow] = [1, 2].map(|i| mechanism.legs[0].joints[i].point.coords);
    if pin.cross(&elbow).norm() > 1e-9 {
        // The other root puts the pin there.
        let pin = elbow * (1.0 + p.a1 / p.a2);
        mechanism.legs[0].joints[1].point = pin.into();
    }
    let singular = report(&mechanism).singular;
    assert!(
        matches!(&singular[..], [HomeSingularity::Parallel { home: 1, nearby: 0, loose }] if loose.len() == 1),
        "{singular:?}"
    );
    assert!(decompose(&mechanism).is_ok());
}

/// The link a1 is perpendicular to its slider and the leg is stretched: its joints are dependent.
#[test]
fn a_link_perpendicular_to_its_slider_is_a_serial_singularity() {
    let mut p = PlanoSpherical::default();
    let (_, theta) = p.upper(0).unwrap();
    p.h = p.a2 * (theta - p.alpha[0]).cos() + p.a1;
    p.alpha[1] -= 0.3;
    p.alpha[2] -= 0.2;
    let singular = report(&p.mechanism()).singular;
    let serial = HomeSingularity::Serial { leg: "leg1".to_owned(), home: 4, nearby: 5 };
    assert_eq!(singular, [serial]);
}

/// The arm of the fourth leg stretched out: D, elbow and P in line.
#[test]
fn a_stretched_arm_is_a_serial_singularity() {
    let p = PlanoSpherical { base: [0.0, 0.2], ..Default::default() };
    let serial = HomeSingularity::Serial { leg: "leg4".to_owned(), home: 4, nearby: 5 };
    assert_eq!(report(&p.mechanism()).singular, [serial]);
}

/// Three planar RRR legs. If the lines of the outer links meet in one point, the platform can
/// rotate about it.
fn planar(links: [[[f64; 2]; 3]; 3]) -> Mechanism {
    let joint = |[x, y]: [f64; 2]| revolute(Vector3::z_axis(), Point3::new(x, y, 0.0));
    let leg = |[base, elbow, wrist]: [[f64; 2]; 3]| {
        vec![joint(base).actuated(), joint(elbow), joint(wrist)]
    };
    mechanism("planar 3-RRR", links.map(leg).to_vec())
}

#[test]
fn three_forces_through_a_point_are_a_parallel_singularity() {
    let wrists = [[0.1, 0.0], [-0.05, 0.08], [-0.05, -0.08]];
    // The outer links are along the radii of the wrists, the bases to the side.
    let meeting =
        wrists.map(|[x, y]| [[3.0 * x - 2.0 * y, 3.0 * y + 2.0 * x], [3.0 * x, 3.0 * y], [x, y]]);
    let singular = report(&planar(meeting)).singular;
    let [HomeSingularity::Parallel { home: 1, nearby: 0, loose }] = &singular[..] else {
        panic!("{singular:?}")
    };
    let [SubspaceClass::Rotation { axis, point }] = loose[..] else { panic!("{loose:?}") };
    assert!((axis.z - 1.0).abs() < 1e-12 && point.coords.norm() < 1e-9, "{singular:?}");
    // With the elbows off the radii, the mechanism is regular.
    let apart = meeting.map(|[base, [x, y], wrist]| [base, [x - 0.5 * y, y + 0.5 * x], wrist]);
    let report = report(&planar(apart));
    assert_eq!((report.lambda, report.mobility, report.controlled), (3, 3, 3));
    assert_eq!(report.singular, []);
}

/// Four bars in one line: two motions meet in this pose, elsewhere there is only one.
#[test]
fn a_flat_parallelogram_is_a_constraint_singularity() {
    let z = |x: f64| revolute(Vector3::z_axis(), Point3::new(x, 0.0, 0.0));
    let mut legs = vec![vec![z(0.0).actuated(), z(0.1)], vec![z(0.3), z(0.4)]];
    let singular = report(&mechanism("flat", legs.clone())).singular;
    assert!(singular.contains(&HomeSingularity::Constraint { home: 2, nearby: 1 }), "{singular:?}");
    // With the cranks turned up, the mechanism is regular.
    for (leg, x) in legs.iter_mut().zip([0.05, 0.35]) {
        leg[1] = revolute(Vector3::z_axis(), Point3::new(x, 0.08, 0.0));
    }
    let report = report(&mechanism("upright", legs));
    assert_eq!((report.lambda, report.mobility), (3, 1));
    assert_eq!(report.singular, []);
}

/// Two rods end to end between fixed pins move to first order but are rigid to second order.
#[test]
fn a_shaky_structure_is_singular() {
    let z = |x: f64| revolute(Vector3::z_axis(), Point3::new(x, 0.0, 0.0));
    let legs = vec![vec![z(0.0).actuated(), z(0.1)], vec![z(0.35)]];
    let report = report(&mechanism("shaky", legs));
    assert_eq!(report.mobility, 1);
    assert_eq!(report.singular, [HomeSingularity::Isolated { mobility: 1 }]);
}

/// The four axes of Bennett's 4R linkage move only because of its proportions: sin(alpha) / a is
/// equal in both links. It is built from Denavit and Hartenberg's parameters, at any angle.
#[test]
fn bennetts_four_bar_moves() {
    use nalgebra::{Isometry3, Translation3, UnitQuaternion};
    let (alpha, beta) = (0.6_f64, 1.1_f64);
    let (a, b) = (0.2 * alpha.sin(), 0.2 * beta.sin());
    let first = 0.9_f64;
    // tan(θ1/2) tan(θ2/2) = sin((β+α)/2) / sin((β−α)/2); θ3 = −θ1, θ4 = −θ2.
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let second = 2.0 * (ratio / (0.5 * first).tan()).atan();
    let link = |theta: f64, length: f64, twist: f64| {
        Isometry3::rotation(Vector3::z() * theta)
            * Isometry3::from_parts(
                Translation3::new(length, 0.0, 0.0),
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), twist),
            )
    };
    let links = [(first, a, alpha), (second, b, beta), (-first, a, alpha), (-second, b, beta)];
    let mut frame = Isometry3::identity();
    let mut axes = vec![];
    for (theta, length, twist) in links {
        axes.push(revolute(Unit::new_normalize(frame * Vector3::z()), frame * Point3::origin()));
        frame *= link(theta, length, twist);
    }
    assert!((frame.to_homogeneous() - nalgebra::Matrix4::identity()).amax() < 1e-12, "{frame}");
    let [j1, j2, j3, j4] = <[Joint; 4]>::try_from(axes).unwrap();
    let report = report(&mechanism("bennett 4R", vec![vec![j1.actuated(), j2], vec![j4, j3]]));
    assert_eq!((report.mobility, report.controlled), (1, 1));
    assert_eq!(report.singular, []);
}

#[test]
fn spinning_struts_are_idle_and_not_loose() {
    let mut mechanism = gough(&mut Numbers::new(1));
    for leg in &mut mechanism.legs {
        let foot = leg.joints[0].point;
        leg.joints[0] =
            Joint::new(leg.joints[0].name.clone(), JointKind::Spherical, Vector3::z_axis(), foot);
    }
    let report = report(&mechanism);
    assert_eq!((report.lambda, report.mobility, report.idle), (6, 12, 6));
    assert_eq!((report.actuators, report.controlled), (6, 6));
    assert!(report.loose.is_empty() && report.singular.is_empty());
    let found = decompose(&mechanism).unwrap();
    assert!(found[0].is_whole() && found[0].mobility == 12);
}

#[test]
fn redundant_actuators_are_named() {
    let mut mechanism = translational_helical();
    mechanism.legs[1].joints[1].actuated = true;
    let report = report(&mechanism);
    assert_eq!((report.actuators, report.controlled), (4, 3));
    // The two sliders of leg 2 fix x and y, so that leg 3's slider repeats them, or either of leg
    // 2's sliders repeats the two others. Only leg 1's slider controls the rotation.
    assert_eq!(report.redundant, ["leg2.1", "leg2.2", "leg3.1"]);
    assert!(decompose(&mechanism).is_ok());
}

#[test]
fn too_many_joints_are_reported() {
    let z = |i: usize| revolute(Vector3::z_axis(), Point3::new(i as f64, 0.0, 0.0));
    let legs = (0..MAX_FREEDOMS).map(|i| vec![z(i), z(i + 1)]).collect();
    let refused = mobility(&mechanism("many", legs));
    assert_eq!(refused, Err(MobilityError::TooLarge { freedoms: 2 * MAX_FREEDOMS }));
}

/// A point of an axis may be given anywhere on it.
#[test]
fn the_choice_of_points_does_not_matter() {
    let mechanism = PlanoSpherical::default().mechanism();
    let mut moved = mechanism.clone();
    for (i, joint) in moved.legs.iter_mut().flat_map(|leg: &mut Leg| &mut leg.joints).enumerate() {
        if joint.kind == JointKind::Revolute {
            joint.point += joint.axis.into_inner() * (3.0 * (i as f64).sin());
        }
    }
    let without_pose = |mechanism| Mobility { nearby: None, ..report(mechanism) };
    assert_eq!(without_pose(&moved), without_pose(&mechanism));
    let (a, b) = (frame(&mechanism), frame(&moved));
    assert!((a.length / b.length - 1.0).abs() < 1e-12);
}
