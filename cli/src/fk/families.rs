//! Families of assemblies, in words and as JSON.

use crate::output::named;
use opm_core::forward::Family;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use serde::Serialize;
use serde_json::{Map, Value};

#[derive(Serialize)]
pub struct Json {
    dimension: usize,
    platform_dimension: usize,
    /// Whether a curve is closed; null where it is not known.
    closed: Option<bool>,
    /// One of its poses, with all joints.
    pose: Map<String, Value>,
    joints: Map<String, Value>,
}

impl Json {
    pub fn new(m: &Manipulator, family: &Family) -> Self {
        let pose = m.task_coordinates().iter().map(|c| c.name).zip(family.pose.iter().copied());
        let joints = m.coordinates().iter().map(|c| &*c.name).zip(family.joints.iter().copied());
        Self {
            dimension: family.dimension,
            platform_dimension: family.platform,
            closed: family.closed,
            pose: named(pose.collect::<Vec<_>>()),
            joints: named(joints.collect::<Vec<_>>()),
        }
    }
}

/// A family, in words.
pub fn line(m: &Manipulator, family: &Family, units: FileUnits) -> String {
    let along = match (family.dimension, family.closed) {
        (1, Some(true)) => "a closed curve".to_owned(),
        (1, _) => "a curve".to_owned(),
        (n, _) => format!("a family of dimension {n}"),
    };
    let moves = match family.platform {
        0 => "joints of a leg move, while the platform stands still, along".to_owned(),
        n if n == family.dimension => "the platform moves along".to_owned(),
        n => format!("the platform moves, with {n} of the freedoms, along"),
    };
    let pose = m.task_coordinates().iter().zip(&family.pose);
    let pose: Vec<String> =
        pose.map(|(c, &value)| format!("{} = {}", c.name, units.show(value, c.quantity))).collect();
    let several = if family.multiple { " (or several like it)" } else { "" };
    format!(
        "self-motion: with these joints held {moves} {along} of assemblies{several}; one of them is {}",
        pose.join(", ")
    )
}
