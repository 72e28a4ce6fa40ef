use super::*;
use crate::chain::Branch;
use nalgebra::Point3;

mod fuzz;
mod parametric;
mod problems;
mod round_trip;
mod typed;

/// A file with two joints in each leg and every optional entry of a joint.
const JOINTS: &str = r#"format = 1
name = "pair"
units = { length = "mm", angle = "deg" }

[platform]
point = [10, 20, 30]

[task]
axis = [0, 0, -2]

[[leg]]
name = "left"
joints = [
  { name = "S1", type = "prismatic", axis = [0, 3, 4], actuated = true, home = 12.5, limits = [-300, 300], max_rate = 500, max_acceleration = 2e3 },
  { name = "r1", type = "revolute", axis = [0, 0, 2], point = [100, 40, 0], home = 90, limits = [0, 180] },
  { name = "h1", type = "helical", axis = [0, 1, 0], point = [0, 0, 0], pitch = -20 },
]

[[leg]]
joints = [
  { name = "u1", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [1, 2, 3], home = [10, -20], limits = [[0, 90], [-30, 30]] },
  { name = "c1", type = "cylindrical", axis = [0, 0, 1], point = [0, 0, 5], home = [30, 7], limits = [[0, 90], [-10, 10]], max_rate = [360, 50] },
  { name = "s1", type = "spherical", point = [0, 0, 1], limits = [[-10, 10], [-20, 20], [-30, 30]] },
]
"#;

/// Two sliders on a rail, each with a parallelogram.
const RAIL: &str = r#"
format = 1
name = "rail"
units = { length = "mm", angle = "deg" }
platform = { point = [0, 0, -300] }

[[leg]]
joints = [
  { name = "s1", type = "prismatic", axis = [1, 0, 0], actuated = true },
  { name = "p1", type = "parallelogram", axis = [0, 1, 0], point = [-250, 0, 0], point2 = [-50, 0, -300], home = 20 },
]

[[leg]]
joints = [
  { name = "s2", type = "prismatic", axis = [1, 0, 0], actuated = true },
  { name = "p2", type = "parallelogram", axis = [0, 1, 0], point = [250, 0, 0], point2 = [50, 0, -300] }, # as drawn
]
"#;

fn r1_point(mechanism: &Mechanism) -> Point3<f64> {
    mechanism.joints().find(|joint| joint.name == "r1").unwrap().point
}

#[test]
fn every_kind_of_joint_is_read_in_si() {
    use crate::mechanism::joint::{JointKind, MotionLimits};
    use nalgebra::{Point3, Unit, Vector3};

    let file = read(JOINTS).unwrap();
    assert_eq!(file.units.length, LengthUnit::Millimetre);
    assert_eq!(file.units.angle, AngleUnit::Degree);
    assert_eq!((file.family, file.mode), (None, None));
    let mechanism = file.mechanism;
    assert_eq!(mechanism.name, "pair");
    assert_eq!(mechanism.platform, Point3::new(0.01, 0.02, 0.03));
    assert_eq!(mechanism.task.axis, Some(-Vector3::z()));
    let names: Vec<_> = mechanism.legs.iter().map(|leg| leg.name.as_str()).collect();
    assert_eq!(names, ["left", "leg2"]);

    let [s1, r1, h1] = &mechanism.legs[0].joints[..] else { panic!() };
    assert_eq!((s1.kind, s1.actuated), (JointKind::Prismatic, true));
    assert_eq!(s1.axis, Unit::new_normalize(Vector3::new(0.0, 0.6, 0.8)));
    assert_eq!(
        s1.point,
        r1_point(&mechanism),
        "a slider without a point is where the next joint is"
    );
    assert_eq!(s1.coordinates[0].home, 12.5 * 0.001);
    assert_eq!(s1.coordinates[0].limits, Some([-300.0 * 0.001, 300.0 * 0.001]));
    let limits = s1.coordinates[0].motion_limits;
    assert_eq!((limits.max_rate, limits.max_acceleration), (Some(0.5), Some(2.0)));
    assert_eq!(r1.coordinates[0].motion_limits, MotionLimits::default());
    assert_eq!((r1.kind, r1.actuated), (JointKind::Revolute, false));
    assert_eq!(r1.point, Point3::new(100.0 * 0.001, 40.0 * 0.001, 0.0));
    assert!((r1.coordinates[0].home - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert_eq!(h1.kind, JointKind::Helical { pitch: -0.02 });
    assert_eq!((h1.coordinates[0].home, h1.coordinates[0].limits), (0.0, None));

    let [u1, c1, s1] = &mechanism.legs[1].joints[..] else { panic!() };
    assert_eq!(u1.kind, JointKind::Universal { second: Vector3::y_axis() });
    let home = |joint: &crate::mechanism::joint::Joint| -> Vec<f64> {
        joint.coordinates.iter().map(|c| c.home).collect()
    };
    assert_eq!(home(u1), [10.0_f64.to_radians(), -20.0_f64.to_radians()]);
    assert_eq!(home(c1), [30.0_f64.to_radians(), 7.0 * 0.001]);
    assert_eq!(c1.coordinates[1].limits, Some([-10.0 * 0.001, 10.0 * 0.001]));
    let rates = c1.coordinates.iter().map(|c| c.motion_limits.max_rate.unwrap());
    assert_eq!(rates.collect::<Vec<_>>(), [360.0_f64.to_radians(), 0.05]);
    assert_eq!(c1.coordinates[0].motion_limits.max_acceleration, None);
    assert_eq!(home(s1), [0.0; 3]);
    assert_eq!(s1.coordinates[2].limits.unwrap()[1], 30.0_f64.to_radians());
}

#[test]
fn a_family_keeps_its_parameters_units_and_mode() {
    let text = include_str!("../../../../opm-core/mechanisms/plano-spherical-5dof.toml");
    let changed = text
        .replace("mode = \"++ ++ ++ +\"", "mode = \"+- -+ ++ -\"")
        .replace("home = { x = 0, y = 0,", "home = { x = 10, y = -5,")
        .replace("S = [-300, 300] }", "S = [-300, 300] }\nmax_rate = { S = 400, theta2 = 90 }")
        .replace("\nb2 = 100", "\nb2 = 100\nmax_acceleration = { phi2 = 720 }");
    let file = read(&changed).unwrap();
    assert_eq!(file.mode.as_deref(), Some("+- -+ ++ -"));
    let Some(Family::PlanoSpherical(family)) = file.family else { panic!() };
    assert_eq!((family.home.x, family.home.y), (0.01, -0.005));
    assert_eq!(family.slider_legs[1].upper, Branch::Minus);
    assert_eq!(family.slider_legs[0].slider, Branch::Minus);
    assert_eq!(family.slider_legs[2].eta, 240.0_f64.to_radians());
    assert_eq!(family.arm_leg.base, [0.0, 0.075]);
    assert_eq!(family.slider_legs[2].limits.s.motion.max_rate, Some(0.4));
    let slider = file.mechanism.coordinates().find(|c| c.name == "S3").unwrap();
    assert_eq!(slider.motion_limits, family.slider_legs[2].limits.s.motion);
    let arm = &file.mechanism.legs[3].joints[1].coordinates[0];
    assert_eq!((arm.name.as_str(), arm.motion_limits.max_rate), ("phi24", None));
    assert_eq!(arm.motion_limits.max_acceleration, Some(720.0_f64.to_radians()));
    let assembled = Mechanism { units: file.units, ..family.assemble().unwrap() };
    assert_eq!(assembled, file.mechanism);

    let lines = |key: &str| text.lines().filter(|l| !l.starts_with(key)).collect::<Vec<_>>();
    assert_eq!(read(&lines("home").join("\n")), read(text), "home is zero where it is not given");
    assert_eq!(read(&lines("mode").join("\n")), read(text), "choices are + where not given");
    let unnamed = read(&lines("name = \"leg").join("\n")).unwrap();
    assert_eq!(unnamed.mechanism, read(text).unwrap().mechanism, "legs are named by their number");
}

/// A slider without a point is on its leg: at the next joint that has one, over other sliders, or else at the one before. In a leg
/// of sliders alone it is at the platform. One with a point stays there.
#[test]
fn sliders_without_points_are_on_their_legs() {
    let slider = |name: &str, rest: &str| {
        format!("{{ name = \"{name}\", type = \"prismatic\", axis = [1, 0, 0]{rest} }}")
    };
    let pivot = |name: &str, x: f64| {
        format!(
            "{{ name = \"{name}\", type = \"revolute\", axis = [0, 0, 1], point = [{x:?}, 2, 0] }}"
        )
    };
    let legs = [
        vec![slider("a1", ", actuated = true"), pivot("a2", 3.0), pivot("a3", 4.0)],
        vec![slider("b1", ", actuated = true"), slider("b2", ""), pivot("b3", 5.0)],
        vec![pivot("c1", 6.0), pivot("c2", 7.0), slider("c3", "")],
        vec![slider("d1", ", point = [8, 2, 0]"), pivot("d2", 9.0), slider("d3", "")],
        vec![slider("e1", ""), slider("e2", "")],
    ];
    let mut text = "format = 1\nname = \"sliders\"\nunits = { length = \"m\", angle = \"rad\" }\n\
                    [platform]\npoint = [-1, 0, 0]\n"
        .to_owned();
    for (number, joints) in legs.iter().enumerate() {
        text += &format!("[[leg]]\nname = \"leg{number}\"\njoints = [{}]\n", joints.join(", "));
    }
    let mechanism = read(&text).unwrap().mechanism;
    let expected = [
        ("a1", 3.0),
        ("b1", 5.0),
        ("b2", 5.0),
        ("c3", 7.0),
        ("d1", 8.0),
        ("d3", 9.0),
        ("e1", -1.0),
        ("e2", -1.0),
    ];
    for (name, x) in expected {
        let joint = mechanism.joints().find(|joint| joint.name == name).unwrap();
        assert_eq!(joint.point.x, x, "{name}");
    }
    // They are drawn there, so that no two legs meet in one point; d1, whose line passes through d2, is drawn at that.
    let drawn = opm_core::mechanism::file::read(&text).unwrap().mechanism;
    let skeleton = opm_core::skeleton::Skeleton::new(&drawn, None);
    let seats = skeleton.bodies().iter().flat_map(|body| {
        body.seats.iter().map(|seat| (seat.joint.clone(), body.origin + seat.centre.coords))
    });
    for (joint, centre) in seats.filter(|(joint, _)| !joint.starts_with('e') && joint != "d1") {
        if let Some((_, x)) = expected.iter().find(|(name, _)| *name == joint) {
            assert!((centre - Point3::new(*x, 2.0, 0.0)).norm() < 1e-12, "{joint}: {centre}");
        }
    }
}

/// A parallelogram is two hinges. A changed file keeps it as it was typed, and a written one says the same with hinges.
#[test]
fn a_parallelogram_stays_as_it_was_typed() {
    let text = RAIL;
    let file = read(text).unwrap();
    let leg = &file.mechanism.legs[0];
    let names: Vec<&str> = leg.coordinates().map(|c| &*c.name).collect();
    assert_eq!(names, ["s1", "p1", "p1.end"]);
    let home: Vec<f64> = leg.coordinates().map(|c| c.home.to_degrees()).collect();
    assert!((home[1] - 20.0).abs() < 1e-12 && home[1] == -home[2]);

    let mut moved = file.clone();
    moved.mechanism.legs[1].joints[2].point.z = -0.31;
    moved.mechanism.legs[0].joints[1].coordinates[0].home = 25_f64.to_radians();
    moved.mechanism.legs[0].joints[2].coordinates[0].home = -25_f64.to_radians();
    let expected = text
        .replace("point2 = [50, 0, -300]", "point2 = [50, 0, -310]")
        .replace("home = 20", "home = 25");
    assert_eq!(moved.text(), expected);
    // Hinges that are no longer opposite cannot be said as one joint.
    moved.mechanism.legs[0].joints[2].coordinates[0].home = 0.0;
    assert!(!moved.text().contains("# as drawn"));

    let written = write(&file.mechanism, file.units, Digits::All);
    assert!(written.contains("turns_back = true"), "{written}");
    assert_eq!(read(&written).unwrap().mechanism, file.mechanism);
}
