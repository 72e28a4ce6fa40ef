//! Homes as people draw them: flat, symmetric, stretched, with forces that meet in a point, with joints that coincide.
//! Many are singular, or nearly so.

mod commands;
mod exact;
mod near;
mod shapes;

use nalgebra::{Point3, Unit, Vector3};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::file::{self, FileUnits};

/// A joint of a drawing: its axis and a point on it, millimetres.
type Drawn = ([f64; 3], [f64; 3]);

/// A mechanism of revolute joints in millimetres and degrees, the first one of each leg actuated.
fn drawn(legs: &[Vec<Drawn>], platform: [f64; 3]) -> String {
    let mut text = format!(
        "format = 1\nname = \"drawn\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n\
         [platform]\npoint = {platform:?}\n"
    );
    for (leg, joints) in legs.iter().enumerate() {
        text += "[[leg]]\njoints = [\n";
        for (place, (axis, point)) in joints.iter().enumerate() {
            text += &format!(
                "  {{ name = \"j{leg}{place}\", type = \"revolute\", axis = {axis:?}, point = {point:?}, \
                 actuated = {} }},\n",
                place == 0
            );
        }
        text += "]\n";
    }
    text
}

fn read(text: &str) -> Mechanism {
    let read = file::read(text).unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    assert_eq!(read.mechanism.units, read.units);
    read.mechanism
}

const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A five-bar in millimetres. The forearms miss being in line by an angle.
fn five_bar(off: f64) -> String {
    let pen = [200.0, 50.0, 0.0];
    let elbow = [200.0 + 150.0 * off.cos(), 50.0 + 150.0 * off.sin(), 0.0];
    let left = vec![(Z, [0.0; 3]), (Z, [50.0, 50.0, 0.0]), (Z, pen)];
    drawn(&[left, vec![(Z, [400.0, 0.0, 0.0]), (Z, elbow)]], pen)
}

/// A planar 3-RRR whose forearms point to the middle, but for an angle of one of them.
fn three_arms(off: f64) -> String {
    let legs = (0..3).map(|leg| {
        let angle = f64::from(leg) * 2.0944 + 1.571;
        let at = |r: f64, a: f64| [r * (angle + a).cos(), r * (angle + a).sin(), 0.0];
        let wrist = at(50.0, 0.0);
        let turned = if leg == 0 { off } else { 0.0 };
        let forearm = [100.0 * (angle + turned).cos(), 100.0 * (angle + turned).sin()];
        let elbow = [wrist[0] + forearm[0], wrist[1] + forearm[1], 0.0];
        vec![(Z, [elbow[0] - 95.0, elbow[1] + 31.0, 0.0]), (Z, elbow), (Z, wrist)]
    });
    drawn(&legs.collect::<Vec<_>>(), [0.0; 3])
}

/// A spherical 3-RRR whose last two planes of axes meet in one line, but for an angle of one of them.
fn wrist(off: f64) -> String {
    let legs = (0..3).map(|leg| {
        let angle = f64::from(leg) * 2.1;
        let about = |a: f64| [(angle + a).cos(), (angle + a).sin(), 0.0];
        let tilted = if leg == 0 { off } else { 0.0 };
        let [x, y, _] = about(0.0);
        let middle = [x * tilted.sin(), y * tilted.sin(), tilted.cos()];
        vec![(about(0.0), [0.0; 3]), (middle, [0.0; 3]), (about(1.57), [0.0; 3])]
    });
    drawn(&legs.collect::<Vec<_>>(), [0.0; 3])
}

/// The mechanism as it is typed at another assembled pose, with these joint values. Its joints have one freedom each.
fn typed_at(mechanism: &Mechanism, joints: &[f64], platform: Point3<f64>) -> Mechanism {
    let mut typed = mechanism.clone();
    let mut values = joints.iter();
    for leg in &mut typed.legs {
        let mut g = nalgebra::Isometry3::identity();
        for joint in &mut leg.joints {
            let value = values.next().expect("one for each joint");
            let moved = joint.displacement(&[*value]).expect("one freedom");
            let axis: Vector3<f64> = g * joint.axis.into_inner();
            (joint.axis, joint.point) = (Unit::new_normalize(axis), g * joint.point);
            g *= moved;
        }
    }
    typed.platform = platform;
    typed.units = FileUnits::SI;
    typed
}
