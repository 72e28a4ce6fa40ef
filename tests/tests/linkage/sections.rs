//! Random linkages of every pair of subspaces, with every kind of loop, anywhere in space.

use super::random::{direction, displacement};
use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use opm_core::linkage::{Linkage, LinkageError};
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, TaskHints};
use std::f64::consts::{PI, TAU};

/// No joint of a random linkage moves faster than this at home, radians or metres for each radian or
/// metre of any other one: home is well away from singularities.
const FASTEST: f64 = 20.0;

/// Hardly any random linkage is singular at home, and about half are calm.
const MOST_TRIES: usize = 50;

/// What the two sections share: a rotation about the x-axis, or a translation along it, before the
/// whole linkage is displaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shared {
    Rotation,
    Translation,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    Planar,
    Spherical,
    Cylindrical,
    Translational,
    TranslationalSpace,
}

/// Every combination, in one order of the sections; the other one is drawn at random.
pub const COMBINATIONS: [(Shared, [Section; 2]); 11] = {
    use Section::{Cylindrical, Planar, Spherical, Translational, TranslationalSpace};
    use Shared::{Rotation, Translation};
    [
        (Rotation, [Spherical, Spherical]),
        (Rotation, [Planar, Spherical]),
        (Rotation, [Planar, Cylindrical]),
        (Rotation, [Spherical, Cylindrical]),
        (Translation, [Planar, Planar]),
        (Translation, [Planar, Cylindrical]),
        (Translation, [Cylindrical, Cylindrical]),
        (Translation, [Planar, Translational]),
        (Translation, [Cylindrical, Translational]),
        (Translation, [Translational, Translational]),
        (Translation, [Cylindrical, TranslationalSpace]),
    ]
};

impl Section {
    /// The joints of a loop in the order after the imaginary joint: revolute, prismatic, helical.
    fn orders(self, shared: Shared) -> &'static [&'static str] {
        match (self, shared) {
            (Self::Planar, Shared::Rotation) => &["rrr", "rrp", "rpr", "prr", "rpp", "prp", "ppr"],
            (Self::Planar, Shared::Translation) => &["rrr", "rrp", "rpr", "prr"],
            (Self::Spherical, _) => &["rrr"],
            (Self::Cylindrical, Shared::Rotation) => &["hp", "ph", "hh"],
            (Self::Cylindrical, Shared::Translation) => &["rh", "hr", "hh"],
            (Self::Translational, _) => &["pp"],
            (Self::TranslationalSpace, _) => &["ppp"],
        }
    }

    fn joints(self, rng: &mut Rng, shared: Shared, order: &str, letter: char) -> Vec<Joint> {
        let sign = |rng: &mut Rng| if rng.bool() { 1.0 } else { -1.0 };
        let unit = |[x, y, z]: [f64; 3]| Unit::new_normalize(Vector3::new(x, y, z));
        let place = |rng: &mut Rng| Point3::from(Vector3::from_fn(|_, _| rng.f64() * 2.0 - 1.0));
        let around = |angle: f64| unit([0.0, angle.cos(), angle.sin()]);
        // The plane's normal, and the centre or the axis of the section.
        let normal = match shared {
            Shared::Rotation => Vector3::x_axis(),
            Shared::Translation => around(rng.f64() * TAU),
        };
        let centre = match shared {
            Shared::Rotation => Point3::new(rng.f64() * 4.0 - 2.0, 0.0, 0.0),
            Shared::Translation => place(rng),
        };
        let in_plane = |rng: &mut Rng| {
            let first = match shared {
                Shared::Rotation => Vector3::y(),
                Shared::Translation => Vector3::x(),
            };
            let (sin, cos) = (rng.f64() * TAU).sin_cos();
            Unit::new_normalize(first * cos + normal.cross(&first) * sin)
        };
        let mut joints = Vec::new();
        for (number, kind) in order.chars().enumerate() {
            let name = format!("{letter}{}", number + 1);
            let backwards = sign(rng);
            let along =
                |axis: Unit<Vector3<f64>>| Unit::new_unchecked(axis.into_inner() * backwards);
            let joint = match (self, kind) {
                (Self::Spherical, _) => {
                    Joint::new(name, JointKind::Revolute, direction(rng), centre)
                }
                (Self::Cylindrical, 'h') => {
                    let pitch = (0.1 + 0.2 * rng.f64() + 0.3 * number as f64) * sign(rng);
                    Joint::new(name, JointKind::Helical { pitch }, along(Vector3::x_axis()), centre)
                }
                (Self::Cylindrical, 'p') => {
                    Joint::new(name, JointKind::Prismatic, along(Vector3::x_axis()), centre)
                }
                (Self::Cylindrical, _) => {
                    Joint::new(name, JointKind::Revolute, along(Vector3::x_axis()), centre)
                }
                (Self::Planar, 'r') => {
                    Joint::new(name, JointKind::Revolute, along(normal), place(rng))
                }
                (Self::TranslationalSpace, _) => {
                    Joint::new(name, JointKind::Prismatic, direction(rng), place(rng))
                }
                (Self::Planar | Self::Translational, _) => {
                    Joint::new(name, JointKind::Prismatic, in_plane(rng), place(rng))
                }
            };
            joints.push(joint.at(rng.f64() - 0.5));
        }
        joints
    }
}

fn moved(joint: &Joint, by: &Isometry3<f64>) -> Joint {
    let mut joint = joint.clone();
    joint.axis = Unit::new_normalize(by * joint.axis.into_inner());
    joint.point = by * joint.point;
    joint
}

/// A linkage of this combination, assembled at a regular home.
pub fn linkage(rng: &mut Rng, (shared, sections): (Shared, [Section; 2])) -> Linkage {
    for _ in 0..MOST_TRIES {
        let mechanism = mechanism(rng, shared, sections);
        let linkage = match Linkage::new(&mechanism) {
            Ok(linkage) if !linkage.is_traced() => linkage,
            Ok(_) => continue,
            // Nearly parallel sliders, or nearly singular at home.
            Err(LinkageError::Decompose(_)) => continue,
            Err(error) => panic!("{shared:?} {sections:?}: {error}\n{mechanism:?}"),
        };
        let calm = linkage.coordinates().iter().all(|coordinate| {
            let input = linkage.input(&coordinate.name).unwrap();
            let rates = input.rates(&input.home());
            rates.is_some_and(|rates| rates.joints.iter().all(|rate| rate.abs() < FASTEST))
        });
        if calm {
            return linkage;
        }
    }
    panic!("{shared:?} {sections:?}: {MOST_TRIES} times no regular linkage");
}

fn mechanism(rng: &mut Rng, shared: Shared, mut sections: [Section; 2]) -> Mechanism {
    if rng.bool() {
        sections.reverse();
    }
    let by = displacement(rng);
    let joints = [(0, 'a'), (1, 'b')].map(|(i, letter)| {
        let section = sections[i];
        let orders = section.orders(shared);
        let order = orders[rng.usize(..orders.len())];
        let joints = section.joints(rng, shared, order, letter);
        joints.iter().map(|joint| moved(joint, &by)).collect::<Vec<_>>()
    });
    let [lower, upper] = &joints;
    let back = |joints: &[Joint]| joints.iter().rev().cloned().collect::<Vec<_>>();
    let mut legs = loop {
        let (at, over) = (rng.usize(..=lower.len()), rng.usize(..=upper.len()));
        // Lower: one leg from the base, the other one back to it. Upper: the same from the platform.
        let one = [lower[..at].to_vec(), back(&upper[..over])].concat();
        let two = [back(&lower[at..]), upper[over..].to_vec()].concat();
        if !one.is_empty() && !two.is_empty() {
            break vec![Leg::new("one", one), Leg::new("two", two)];
        }
    };
    let leg = rng.usize(..2);
    let joint = rng.usize(..legs[leg].joints.len());
    legs[leg].joints[joint].actuated = true;
    let platform = by * Point3::new(0.3, 0.2, -rng.f64());
    Mechanism {
        name: "random".into(),
        legs,
        platform,
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}

/// A random value within half a revolution or some metres of home.
pub fn near(rng: &mut Rng, home: f64) -> f64 {
    home + (rng.f64() * 2.0 - 1.0) * PI
}
