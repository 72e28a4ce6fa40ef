use super::*;
use crate::chain::Branch;

mod fuzz;
mod problems;
mod round_trip;

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
    assert_eq!(s1.point, mechanism.platform, "a slider without a point is drawn at the platform");
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
    let text = include_str!("../../../mechanisms/plano-spherical-5dof.toml");
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
