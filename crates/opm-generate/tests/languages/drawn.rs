//! The mechanisms and the poses that generated code is tested with.

use crate::program::Question;
use fastrand::Rng;
use opm_core::mechanism::examples::SPLIT;
use opm_core::mechanism::joint::{Drive, JointKind};
use opm_core::mechanism::{Cone, Difference, Payload};
use opm_core::nalgebra::{Matrix3, Vector3};
use opm_core::{Manipulator, Quantity};
use opm_generate::Content;
use opm_tests::random::{self, Options};
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

/// The shipped mechanisms whose legs are split, and some whose legs are solved whole: with universal joints, with spherical ones and
/// cones, with a height, with parallelograms; with a stem that determines positions, with one that turns; with constraints of several
/// legs; a symmetric one.
pub fn shipped() -> Vec<Manipulator> {
    let split = SPLIT.iter().filter_map(|example| Manipulator::read(example.text).ok());
    let example = |name: &str| Manipulator::example(name).expect("it is shipped");
    let whole = ["delta", "quadrupteron", "tricept", "ankle"].map(example);
    let typed = [
        with_cones(&example("stewart")),
        with_difference(&example("five-bar"), [-0.4, 0.3]),
        with_difference(&example("planar-3rrr"), [-3.0, 0.2]),
        three_rps(),
        three_psp(),
        omni_wrist(),
        generator(),
    ];
    split.chain(whole).chain(typed).map(|m| driven(&m)).collect()
}

/// The dynamics, too, where they can be written.
pub fn content(m: &Manipulator) -> Content {
    opm_generate::check_dynamics(m).map_or(Content::Kinematics, |()| Content::Dynamics)
}

/// The same mechanism with motors, friction in all joints but balls, and a payload.
fn driven(m: &Manipulator) -> Manipulator {
    let mut mechanism = m.mechanism().clone();
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        if joint.kind == JointKind::Spherical {
            continue;
        }
        for (number, coordinate) in (1..).zip(&mut joint.coordinates) {
            coordinate.drive = Drive {
                rotor_inertia: if joint.actuated { 3e-4 } else { 0.0 },
                gear: if joint.actuated { 7.0 } else { 1.0 },
                viscous_friction: 0.2 * f64::from(number),
                coulomb_friction: 0.3,
            };
        }
    }
    mechanism.bodies.payload = Some(Payload {
        mass: 0.6,
        centre: Some(mechanism.platform + Vector3::new(0.01, -0.02, 0.03)),
        inertia: Matrix3::new(4e-4, 1e-5, -2e-5, 1e-5, 3e-4, 3e-5, -2e-5, 3e-5, 5e-4),
    });
    Manipulator::new(mechanism).expect("it moves as before")
}

/// Two legs of a hinge, two parallelograms in a row, and a hinge (the Schoenflies Motion Generator).
fn generator() -> Manipulator {
    let text = include_str!("../../../../tests/tests/parallelograms/generator.toml");
    Manipulator::read(text).expect("its platform translates and turns about the vertical")
}

/// Three legs of a hinge, a motor that slides, and a ball: the platform turns as it tilts.
fn three_rps() -> Manipulator {
    let leg = |i: u32| {
        let (sin, cos) = (0.3 + f64::from(i) * TAU / 3.0).sin_cos();
        let foot = [0.2 * cos, 0.2 * sin, 0.0];
        let tip = [0.12 * cos, 0.12 * sin, 0.3];
        let along = [tip[0] - foot[0], tip[1] - foot[1], 0.3];
        let tangent = [-sin, cos, 0.0];
        format!(
            "[[leg]]\njoints = [{{ name = \"r{i}\", type = \"revolute\", axis = {tangent:?}, point = {foot:?} }}, \
             {{ name = \"p{i}\", type = \"prismatic\", axis = {along:?}, actuated = true, limits = [-0.1, 0.1] }}, \
             {{ name = \"s{i}\", type = \"spherical\", point = {tip:?} }}]\n"
        )
    };
    let legs: String = (0..3).map(leg).collect();
    let head = "format = 1\nname = \"three-rps\"\nunits = { length = \"m\", angle = \"rad\" }\n";
    let text = format!("{head}[platform]\npoint = [0.0, 0.0, 0.3]\n{legs}");
    Manipulator::read(&text).expect("its legs constrain the platform together")
}

/// Balls on upright lines of the base and on lines of the platform: the lines meet.
fn three_psp() -> Manipulator {
    let text = r#"
format = 1
name = "three-psp"
units = { length = "m", angle = "rad" }
platform = { point = [0, 0, 0.3] }
[[leg]]
name = "leg{i}"
pattern = { count = 3, axis = [0, 0, 1] }
joints = [
  { name = "p{i}", type = "prismatic", axis = [0, 0, 1], point = [0.2, 0, 0], actuated = true, limits = [-0.1, 0.1] },
  { name = "s{i}", type = "spherical", point = [0.2, 0, 0.3] },
  { name = "r{i}", type = "prismatic", axis = [1, 0.2, 0.1], point = [0.2, 0, 0.3] },
]
"#;
    Manipulator::read(text).expect("its legs constrain the platform together")
}

/// Four legs of two axes through a centre of the base, and their mirror images through one of the platform (Omni-Wrist III).
fn omni_wrist() -> Manipulator {
    let leg = |i: u32| {
        let (sin, cos) = (f64::from(i) * TAU / 4.0).sin_cos();
        let [x, y] = [0.55 * cos - 0.7 * sin, 0.55 * sin + 0.7 * cos];
        let joint = |name: &str, axis: [f64; 3], height: f64| {
            let driven = if name == "a" && i < 2 { ", actuated = true" } else { "" };
            format!(
                "{{ name = \"{name}{i}\", type = \"revolute\", axis = {axis:?}, point = [0.0, 0.0, {height:?}]{driven} }}"
            )
        };
        let joints = [
            joint("a", [cos, sin, 0.0], 0.0),
            joint("b", [x, y, 0.45], 0.0),
            joint("c", [x, y, -0.45], 0.12),
            joint("d", [cos, sin, 0.0], 0.12),
        ];
        format!("[[leg]]\njoints = [{}]\n", joints.join(", "))
    };
    let legs: String = (0..4).map(leg).collect();
    let head = "format = 1\nname = \"omni-wrist\"\nunits = { length = \"m\", angle = \"rad\" }\n";
    let text = format!("{head}[platform]\npoint = [0.0, 0.0, 0.12]\n{legs}");
    Manipulator::read(&text).expect("its platform is the image of its base")
}

/// The same mechanism, whose universal and spherical joints have cones.
fn with_cones(m: &Manipulator) -> Manipulator {
    let mut mechanism = m.mechanism().clone();
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        let tilts = matches!(joint.kind, JointKind::Universal { .. } | JointKind::Spherical);
        joint.cone = tilts.then_some(Cone { half_angle: 0.5, axis: None });
    }
    Manipulator::new(mechanism).expect("the cones have home inside")
}

/// The same mechanism, whose first two motors have a limited difference about that at home.
fn with_difference(m: &Manipulator, room: [f64; 2]) -> Manipulator {
    let mut mechanism = m.mechanism().clone();
    mechanism.name.push_str("-apart");
    let [one, other] = [0, 1].map(|i| &m.coordinates()[m.actuated()[i]]);
    let limits = room.map(|end| one.home - other.home + end);
    let joints = [one, other].map(|c| c.name.clone());
    mechanism.differences.push(Difference { joints, limits });
    Manipulator::new(mechanism).expect("home is inside")
}

/// A random mechanism of every pair of subspaces, and some of which a leg constrains the platform.
pub fn random_mechanisms(seed: u64) -> Vec<Manipulator> {
    let mut rng = Rng::with_seed(seed);
    let mut all = Vec::new();
    for pair in random::PAIRS {
        let options = Options { limited: 0.3, balls: true };
        let mut drawn = vec![random::mechanism(&mut rng, pair, options)];
        for lacks in [[1, 0], [0, 1], [2, 0], [0, 2], [1, 1]] {
            let options = Options { limited: 0.3, balls: false };
            let repeated = rng.bool();
            drawn.extend(random::constrained(&mut rng, pair, lacks, repeated, options));
        }
        for (mut mechanism, decomposition) in drawn {
            mechanism.name = format!("m{}", all.len());
            let Ok(m) = Manipulator::with_decomposition(mechanism.clone(), decomposition.clone())
            else {
                continue;
            };
            // An orientation at home other than the identity has closed forms of its own.
            let oriented = m.task().coordinates.iter().any(|c| c.name == "zeta") && rng.bool();
            if oriented {
                let home = [("zeta", 0.3), ("xi", 0.7), ("psi", -0.4)];
                mechanism.task.home = home.map(|(name, value)| (name.into(), value)).into();
            }
            all.extend(Manipulator::with_decomposition(mechanism, decomposition));
        }
    }
    assert!(all.len() > 150, "{}", all.len());
    all
}

/// Those of the random mechanisms whose code has a function that no code before has, and one in so many of the others.
pub fn covering(seed: u64, every: usize) -> Vec<Manipulator> {
    let mut known = HashSet::new();
    let mut all = random_mechanisms(seed);
    let mut number = 0;
    all.retain(|m| {
        number += 1;
        let code = opm_generate::c(m, Content::Kinematics).expect("few choices");
        let prefix = format!("{}_", code.name);
        let before = known.len();
        let functions = code.source.split(&*prefix).filter_map(|rest| rest.split_once('('));
        let whole = |name: &str| !name.contains(|c: char| !c.is_ascii_alphabetic() && c != '_');
        known.extend(functions.map(|(name, _)| name.to_owned()).filter(|name| whole(name)));
        known.len() > before || number % every == 0
    });
    all
}

/// What questions are drawn from.
pub struct Drawn<'a> {
    pub rng: &'a mut Rng,
    pub manipulator: &'a Manipulator,
}

impl Drawn<'_> {
    /// Poses about home in random modes, half of them near home, and a pose near each.
    pub fn questions(&mut self, count: usize) -> Vec<Question> {
        (0..count).map(|_| self.question()).collect()
    }

    fn question(&mut self) -> Question {
        let m = self.manipulator;
        let size = m.characteristic_length();
        let far = if self.rng.bool() { 1.0 } else { 0.3 };
        let unit = |quantity| if quantity == Quantity::Angle { PI } else { size };
        let (mut pose, mut next) = (Vec::new(), Vec::new());
        for c in m.task_coordinates() {
            let at = c.home + far * unit(c.quantity) * (2.0 * self.rng.f64() - 1.0);
            pose.push(at);
            next.push(at + 0.02 * unit(c.quantity) * (self.rng.f64() - 0.5));
        }
        let signs: String =
            (0..m.choices()).map(|_| if self.rng.bool() { '-' } else { '+' }).collect();
        Question { mode: m.parse_mode(&signs).expect("as many signs as choices"), pose, next }
    }
}
