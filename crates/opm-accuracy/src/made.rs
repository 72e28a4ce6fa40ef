//! A mechanism that is made with errors of some size.

use crate::chain::{Chain, displaced};
use crate::response::Model;
use crate::source::{ErrorModel, Origin, stepped};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file::MechanismFile;
use opm_core::mechanism::joint::JointKind;
use std::collections::BTreeMap;

/// A mechanism with errors.
pub struct Made {
    /// Its joints, with the errors of axes as the model [`ErrorModel::Axes`] has them.
    pub mechanism: Mechanism,
    /// By how much the axis of a leg, by their numbers, is displaced in the link that carries it.
    links: BTreeMap<(usize, usize), Isometry3<f64>>,
    /// The errors of actuated joint coordinates, by their numbers.
    pub actuators: Vec<(usize, f64)>,
}

impl Made {
    /// With an error for each source of a model, radians and metres; `None` if the mechanism cannot be assembled with them.
    pub fn new(model: &Model<'_>, errors: &[f64]) -> Option<Self> {
        let mut mechanism = dimensions(model, errors)?;
        let (mut actuators, mut axes) = (Vec::new(), BTreeMap::new());
        for (source, &error) in model.sources().iter().zip(errors).filter(|(_, e)| **e != 0.0) {
            match &source.origin {
                Origin::Actuator(number) => actuators.push((*number, error)),
                Origin::Axis { leg, first, twist, .. } => {
                    let sum = axes.entry((*leg, *first)).or_insert([Vector3::zeros(); 2]);
                    sum[0] += twist.angular * error;
                    sum[1] += twist.linear * error;
                }
                Origin::Pitch { leg, first, .. } => {
                    let (joint, _) = place(&mechanism, *leg, *first);
                    if let JointKind::Helical { pitch } =
                        &mut mechanism.legs[*leg].joints[joint].kind
                    {
                        *pitch += error;
                    }
                }
                Origin::Parameter { .. } => {}
            }
        }
        let mut links = BTreeMap::new();
        let drawn = mechanism.clone();
        for ((leg, axis), [rotation, linear]) in axes {
            let (number, second) = place(&mechanism, leg, axis);
            let joint = &mut mechanism.legs[leg].joints[number];
            // A rotation about the joint's point, and what is left. The first axis of a universal joint may have moved it already.
            let point = drawn.legs[leg].joints[number].point;
            let way = linear - point.coords.cross(&rotation);
            match model.error_model() {
                ErrorModel::Links => {
                    links.insert((leg, axis), displaced(rotation, &point, way));
                }
                ErrorModel::Axes => {
                    let turned = UnitQuaternion::from_scaled_axis(rotation);
                    match &mut joint.kind {
                        JointKind::Universal { second: axis } if second => *axis = turned * *axis,
                        _ => joint.axis = turned * joint.axis,
                    }
                    joint.point += way;
                }
            }
        }
        Some(Self { mechanism, links, actuators })
    }

    /// Its legs for the values of all joint coordinates, without the errors of actuators.
    pub fn chains(&self, values: &[f64]) -> Vec<Chain> {
        Chain::all_with(&self.mechanism, values, |leg, axis| self.links.get(&(leg, axis)).copied())
    }
}

/// The mechanism with the errors of its file's dimensions.
fn dimensions(model: &Model<'_>, errors: &[f64]) -> Option<Mechanism> {
    let mut changed: BTreeMap<&str, ParameterValue> = BTreeMap::new();
    let nominal = model.file().map(MechanismFile::dimensions).unwrap_or_default();
    for (source, &error) in model.sources().iter().zip(errors).filter(|(_, e)| **e != 0.0) {
        let Origin::Parameter { key, part, .. } = &source.origin else { continue };
        let known = nominal.iter().find(|(name, _)| name == key).map(|(_, value)| *value);
        let value = changed.entry(key).or_insert(known?);
        *value = stepped(*value, *part, error);
    }
    match model.file() {
        Some(file) if !changed.is_empty() => Some(file.with(changed).ok()?.mechanism),
        _ => Some(model.manipulator().mechanism().clone()),
    }
}

/// The number of the joint in its leg that has an axis, and whether it is the second one of a universal joint. The number after
/// the last axis, that of the platform, gives the last joint.
fn place(mechanism: &Mechanism, leg: usize, axis: usize) -> (usize, bool) {
    let joints = &mechanism.legs[leg].joints;
    let mut first = 0;
    for (number, joint) in joints.iter().enumerate() {
        let count = if matches!(joint.kind, JointKind::Universal { .. }) { 2 } else { 1 };
        if axis < first + count {
            return (number, axis > first);
        }
        first += count;
    }
    (joints.len().saturating_sub(1), false)
}
