//! What is calibrated: dimensions of the file, places of joints within their subspaces, offsets of encoders.

use crate::allowed::{Displacement, allowed};
use nalgebra::{DMatrix, Isometry3, Vector6};
use opm_accuracy::{ErrorModel, Model};
use opm_core::Quantity;
use opm_core::decomposition::PlatformSet;
use opm_core::group::screw::Screw;
use opm_core::manipulator::{CompileError, Manipulator};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::family::{Family, ParameterErrors, ParameterValue};
use opm_core::mechanism::file::MechanismFile;
use opm_core::mechanism::joint::{Joint, JointKind};

/// A number of a mechanism that measurements may correct.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name: `leg1.h`, `leg4.base.x` or `leg1.offset.S` in a family; `leg1.r1.offset.1`, `leg1.r2.angle.1`, `leg1.h1.pitch` or
    /// `S1.home` in a list of joints.
    pub name: String,
    /// Whether it is a length or an angle.
    pub quantity: Quantity,
    /// Its value in the file, metres and radians; zero for a displacement of an axis.
    pub before: f64,
    kind: ParameterKind,
}

#[derive(Clone, Debug)]
enum ParameterKind {
    /// A dimension of the file: the number of its source of errors.
    Dimension { name: String, part: Option<usize>, source: usize },
    /// An offset of the family that is the home value of an actuated joint coordinate.
    Offset { name: String, coordinate: usize },
    /// The home value of an actuated joint coordinate of a list.
    Home { coordinate: usize },
    /// A displacement of the axes of a joint of a list, within the subspaces.
    Axes(Displacement),
    /// A pitch, and the number of its source of errors.
    Pitch { leg: usize, joint: usize, source: usize },
}

/// A mechanism with some values of its parameters.
pub struct Instance {
    pub manipulator: Manipulator,
    /// With the dimensions of the mechanism. Where these are named, offsets of encoders are not in it: they would be numbers in
    /// place of expressions.
    pub file: MechanismFile,
    /// Whether dimensions are calibrated, not joints.
    by_dimension: bool,
    /// The values from those of the file on.
    values: Vec<f64>,
}

/// Why a mechanism with changed parameters is none.
#[derive(Debug, thiserror::Error)]
pub enum InstanceError {
    /// The dimensions do not fit.
    #[error(transparent)]
    Parameters(#[from] ParameterErrors),
    /// The mechanism cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// Legs are solved whole, and the platform moves in a subgroup: with a joint that is off, legs do not contain it.
    #[error(
        "calibration of joints is for legs that are split into two sections, or that have six freedoms; this mechanism's legs \
         are each solved by itself, and hold the platform in a subgroup only with the joints of the file: name its dimensions \
         in [parameters], to calibrate these"
    )]
    Whole,
}

impl Instance {
    /// The mechanism of the file.
    pub fn nominal(file: &MechanismFile) -> Result<Self, InstanceError> {
        let manipulator = Manipulator::new(file.mechanism.clone())?;
        let subgroup = manipulator.decomposition().platform() == PlatformSet::Subgroup;
        // Only with these joints do legs hold the platform in a subgroup, whatever the dimensions are that the file names.
        let needs_names = manipulator.is_whole() && subgroup;
        if needs_names && file.parameters.is_empty() {
            return Err(InstanceError::Whole);
        }
        let by_dimension = file.family.is_some() || needs_names;
        Ok(Self { manipulator, file: file.clone(), by_dimension, values: Vec::new() })
    }

    /// The mechanism with changes of its parameters. The decomposition stays: parameters do not leave the class.
    pub fn changed(
        &self,
        parameters: &[Parameter],
        changes: &[f64],
    ) -> Result<Self, InstanceError> {
        let by_dimension = self.by_dimension;
        let mut file = match by_dimension {
            true => dimensioned(&self.file, parameters, changes)?,
            false => self.file.clone(),
        };
        let mut mechanism = file.mechanism.clone();
        displace(&mut mechanism, parameters, changes);
        if !by_dimension {
            file.mechanism = mechanism.clone();
        }
        let decomposition = self.manipulator.decomposition().clone();
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition)?;
        Ok(Self { manipulator, file, by_dimension, values: changes.to_vec() })
    }

    /// The file of the mechanism as it is.
    pub fn made(&self) -> MechanismFile {
        MechanismFile { mechanism: self.manipulator.mechanism().clone(), ..self.file.clone() }
    }

    /// Its errors. The actuators are the first sources. Where places of joints are calibrated, dimensions that the file names are
    /// none: joints that are displaced are not what they give any more.
    pub fn model(&self) -> Model<'_> {
        let file = self.by_dimension.then_some(&self.file);
        Model::new(&self.manipulator, file, ErrorModel::Axes)
    }

    /// The twists through all legs for units of the parameters at a solved pose, if joints keep their values; weighted as in
    /// [`opm_accuracy::Closure`].
    pub fn twists(
        &self,
        parameters: &[Parameter],
        closure: &opm_accuracy::Closure,
    ) -> DMatrix<f64> {
        let mut twists = DMatrix::zeros(closure.joints.nrows(), parameters.len());
        for (column, parameter) in parameters.iter().enumerate() {
            match &parameter.kind {
                ParameterKind::Dimension { source, .. } | ParameterKind::Pitch { source, .. } => {
                    twists.set_column(column, &closure.errors.column(*source));
                }
                // Where an encoder's zero is moves nothing.
                ParameterKind::Offset { .. } | ParameterKind::Home { .. } => {}
                ParameterKind::Axes(displacement) => {
                    let leg = displacement.leg;
                    let carried = &closure.carried[leg];
                    let twist = self.axis_twist(parameters, displacement, carried);
                    let twist = closure.weight * twist;
                    twists.fixed_view_mut::<6, 1>(6 * leg, column).copy_from(&twist);
                }
            }
        }
        twists
    }

    /// The twist for a unit of a displacement, on top of all displacements that the joint already has.
    fn axis_twist(
        &self,
        parameters: &[Parameter],
        displacement: &Displacement,
        carried: &[Isometry3<f64>],
    ) -> Vector6<f64> {
        let mut sum = Vector6::zeros();
        for (number, own) in displacement.twists.iter().enumerate() {
            let total = total(parameters, &self.values, displacement, number);
            let own = derivative_of_exp(&total, own);
            let [before, after] = [0, 1].map(|i| &carried[displacement.axis + number + i]);
            sum += own.transformed(before).to_vector() - own.transformed(after).to_vector();
        }
        sum
    }

    /// The change of the value of an actuated coordinate for a unit of a parameter that is its offset.
    pub fn by_offset(parameter: &Parameter, of: usize) -> f64 {
        match parameter.kind {
            ParameterKind::Offset { coordinate, .. } | ParameterKind::Home { coordinate } => {
                f64::from(u8::from(coordinate == of))
            }
            _ => 0.0,
        }
    }
}

/// The sum of the twists of all parameters that displace the same axis, for these values.
fn total(
    parameters: &[Parameter],
    values: &[f64],
    displacement: &Displacement,
    number: usize,
) -> Screw {
    let mut sum = Vector6::zeros();
    for (parameter, value) in parameters.iter().zip(values) {
        if let ParameterKind::Axes(other) = &parameter.kind
            && (other.leg, other.joint) == (displacement.leg, displacement.joint)
        {
            sum += other.twists[number].to_vector() * *value;
        }
    }
    Screw::from_vector(&sum)
}

/// The twist of `exp(a + ε b) exp(-a)` for a unit of ε: `b + [a, b]/2 + [a, [a, b]]/6 + ...` (K. Lynch, F. Park, *Modern
/// Robotics*, 2017, section 8.1). Displacements are small, and the series converges like that of exp.
fn derivative_of_exp(a: &Screw, b: &Screw) -> Screw {
    const TERMS: u32 = 20;
    let (mut sum, mut term) = (b.to_vector(), *b);
    for n in 1..TERMS {
        term = Screw::from_vector(&(a.bracket(&term).to_vector() / f64::from(n + 1)));
        sum += term.to_vector();
    }
    Screw::from_vector(&sum)
}

/// The parameters of a mechanism: the dimensions of its file, or places of joints; then the offsets of actuated joints.
pub fn parameters(instance: &Instance) -> Vec<Parameter> {
    let manipulator = &instance.manipulator;
    let model = instance.model();
    let mut all = match instance.by_dimension {
        true => of_dimensions(&instance.file, &model),
        false => of_joints(manipulator, &model),
    };
    match &instance.file.family {
        Some(family) => all.extend(offsets(family, manipulator)),
        None => all.extend(manipulator.actuated().iter().map(|&coordinate| {
            let c = &manipulator.coordinates()[coordinate];
            let kind = ParameterKind::Home { coordinate };
            let name = format!("{}.home", c.name);
            Parameter { name, quantity: c.quantity, before: c.home, kind }
        })),
    }
    all
}

/// The dimensions of a file that are sources of errors.
fn of_dimensions(file: &MechanismFile, model: &Model<'_>) -> Vec<Parameter> {
    let named = file.dimensions();
    let parameter = |(source, of): (usize, &opm_accuracy::Source)| {
        let (name, part, before) = named.iter().find_map(|(name, value)| {
            let rest = of.name.strip_prefix(name.as_str())?;
            match (rest, value) {
                ("", ParameterValue::Number(value)) => Some((name, None, *value)),
                (".x", ParameterValue::Pair(pair)) => Some((name, Some(0), pair[0])),
                (".y", ParameterValue::Pair(pair)) => Some((name, Some(1), pair[1])),
                _ => None,
            }
        })?;
        let kind = ParameterKind::Dimension { name: name.clone(), part, source };
        Some(Parameter { name: of.name.clone(), quantity: of.quantity, before, kind })
    };
    let sources = model.sources().iter().enumerate().filter(|(_, source)| source.is_parameter());
    sources.filter_map(parameter).collect()
}

/// The offsets of a family that are those of actuated joints.
fn offsets(family: &Family, manipulator: &Manipulator) -> Vec<Parameter> {
    const SHIFT: f64 = 1e-3;
    let coordinates = manipulator.coordinates();
    let offset = |(name, value): (String, ParameterValue)| {
        if !name.contains(".offset.") {
            return None;
        }
        let before = match value {
            ParameterValue::Number(value) => value,
            ParameterValue::Pair(_) | ParameterValue::None => 0.0,
        };
        // The joint whose value is another; without limits, which may exclude it.
        let limits = family.parameters().into_iter().map(|(name, _)| name);
        let limits: Vec<String> = limits.filter(|name| name.contains(".limits.")).collect();
        let changes = limits.iter().map(|name| (name.as_str(), ParameterValue::None));
        let changes = changes.chain([(name.as_str(), ParameterValue::Number(before + SHIFT))]);
        let changed = family.with(changes).ok()?.assemble().ok()?;
        let shifted = |&number: &usize| {
            let now = changed.coordinates().nth(number);
            let apart = now.map_or(0.0, |c| c.home - coordinates[number].home);
            let turns = (apart / std::f64::consts::TAU).round() * std::f64::consts::TAU;
            (apart - turns - SHIFT).abs() < 1e-6 * SHIFT
        };
        let coordinate = manipulator.actuated().iter().copied().find(shifted)?;
        let quantity = coordinates[coordinate].quantity;
        let kind = ParameterKind::Offset { name: name.clone(), coordinate };
        Some(Parameter { name, quantity, before, kind })
    };
    family.parameters().into_iter().filter_map(offset).collect()
}

/// The displacements of the joints of a list within their subspaces, and pitches.
fn of_joints(manipulator: &Manipulator, model: &Model<'_>) -> Vec<Parameter> {
    let mut all = Vec::new();
    for (leg, own) in manipulator.mechanism().legs.iter().enumerate() {
        for joint in 0..own.joints.len() {
            for displacement in allowed(manipulator, model, leg, joint) {
                let (name, quantity) = (displacement.name.clone(), displacement.quantity);
                let kind = ParameterKind::Axes(displacement);
                all.push(Parameter { name, quantity, before: 0.0, kind });
            }
            if let JointKind::Helical { pitch } = own.joints[joint].kind
                && crate::allowed::pitch(manipulator, leg, joint)
            {
                let name = format!("{}.{}.pitch", own.name, own.joints[joint].name);
                let source = model.sources().iter().position(|source| source.name == name);
                let Some(source) = source else { continue };
                let kind = ParameterKind::Pitch { leg, joint, source };
                all.push(Parameter { name, quantity: Quantity::Length, before: pitch, kind });
            }
        }
    }
    all
}

/// The file with changes of its dimensions.
fn dimensioned(
    file: &MechanismFile,
    parameters: &[Parameter],
    changes: &[f64],
) -> Result<MechanismFile, ParameterErrors> {
    let mut pairs: Vec<(&str, ParameterValue)> = Vec::new();
    for (parameter, change) in parameters.iter().zip(changes) {
        let value = parameter.before + change;
        match &parameter.kind {
            ParameterKind::Dimension { name, part: None, .. }
            | ParameterKind::Offset { name, .. } => {
                // An offset that is not given stays away where nothing is changed.
                if *change != 0.0 {
                    pairs.push((name, ParameterValue::Number(value)));
                }
            }
            ParameterKind::Dimension { name, part: Some(part), .. } => {
                let known = pairs.iter_mut().find(|(known, _)| known == name);
                match known {
                    Some((_, ParameterValue::Pair(pair))) => pair[*part] = value,
                    _ => {
                        let of = |number: usize| {
                            let other = parameters.iter().find(|other| {
                                matches!(&other.kind, ParameterKind::Dimension { name: known, part: Some(part), .. }
                                    if known == name && *part == number)
                            });
                            other.map_or(0.0, |other| other.before)
                        };
                        let mut pair = [of(0), of(1)];
                        pair[*part] = value;
                        pairs.push((name, ParameterValue::Pair(pair)));
                    }
                }
            }
            ParameterKind::Home { .. } | ParameterKind::Axes(_) | ParameterKind::Pitch { .. } => {}
        }
    }
    file.with(pairs)
}

/// Displaces the joints of a list.
fn displace(mechanism: &mut Mechanism, parameters: &[Parameter], changes: &[f64]) {
    for (parameter, change) in parameters.iter().zip(changes) {
        match &parameter.kind {
            ParameterKind::Home { coordinate } => {
                let all = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
                let mut all = all.flat_map(|joint| &mut joint.coordinates);
                if let Some(c) = all.nth(*coordinate) {
                    c.home += change;
                }
            }
            ParameterKind::Pitch { leg, joint, .. } => {
                let joint = &mut mechanism.legs[*leg].joints[*joint];
                if let JointKind::Helical { pitch } = &mut joint.kind {
                    *pitch += change;
                }
            }
            ParameterKind::Axes(displacement) => {
                // All displacements of the joint at once, with its first.
                let first = parameters.iter().find_map(|other| match &other.kind {
                    ParameterKind::Axes(of)
                        if (of.leg, of.joint) == (displacement.leg, displacement.joint) =>
                    {
                        Some(&other.name)
                    }
                    _ => None,
                });
                if first == Some(&parameter.name) {
                    let total = |number| total(parameters, changes, displacement, number).exp(1.0);
                    let moved: Vec<Isometry3<f64>> =
                        (0..displacement.twists.len()).map(total).collect();
                    let joint = &mut mechanism.legs[displacement.leg].joints[displacement.joint];
                    place(joint, &moved);
                }
            }
            ParameterKind::Dimension { .. } | ParameterKind::Offset { .. } => {}
        }
    }
}

/// Displaces each axis of a joint.
fn place(joint: &mut Joint, moved: &[Isometry3<f64>]) {
    joint.axis = moved[0].rotation * joint.axis;
    joint.point = moved[0] * joint.point;
    if let JointKind::Universal { second } = &mut joint.kind {
        *second = moved[1].rotation * *second;
    }
}
