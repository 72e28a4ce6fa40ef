//! Sources of errors: actuators, axes of joints, links, dimensions of the file.

use crate::chain::{Chain, small_twist, unit};
use nalgebra::{Isometry3, Translation3, Unit, Vector3, Vector6};
use opm_core::Quantity;
use opm_core::group::screw::Screw;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file::MechanismFile;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::{Mechanism, leg::Leg};
use std::ops::Range;

/// What is assembled at home when parts have errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorModel {
    /// Joints are assembled at home without play, with axes that are not where the file has them. Errors act where joints have
    /// moved from home. These are the errors of the numbers in a mechanism file.
    #[default]
    Axes,
    /// Each link, the base and the platform are made with errors: an axis is displaced in the link that carries it, and
    /// everything behind with it. Errors act at home, too.
    Links,
}

impl ErrorModel {
    /// Each model with its name.
    pub const NAMED: [(&'static str, Self); 2] = [("axes", Self::Axes), ("links", Self::Links)];

    /// The model of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMED.into_iter().find(|(known, _)| *known == name).map(|(_, model)| model)
    }
}

/// One error, of which all results are multiples.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its name: that of an actuated joint coordinate, `leg1.S1.angle.1`, or `leg1.h`.
    pub name: String,
    /// Whether it is an angle or a length.
    pub quantity: Quantity,
    /// The name of the joint that it belongs to; `platform` for the platform's end of a leg, `None` for a dimension of the file.
    pub joint: Option<String>,
    /// The direction of an offset or the axis of a rotation, in base coordinates, with the mechanism at home; `None` for
    /// actuators and parameters.
    pub direction: Option<Vector3<f64>>,
    pub(crate) origin: Origin,
}

/// How an error enters the loops.
#[derive(Clone, Debug)]
pub(crate) enum Origin {
    /// Of the actuated joint coordinate with this number.
    Actuator(usize),
    /// Of the axes `first..end` of a leg: their twist at home for a unit of the error.
    Axis { leg: usize, first: usize, end: usize, twist: Screw },
    /// Of a helical joint's pitch: its advance.
    Pitch { leg: usize, first: usize, coordinate: usize, home: f64, advance: Screw },
    /// Of a dimension of the file: the mechanisms with a larger and with a smaller value, and how far these are apart.
    /// `key` is its name in the file, and `part` the number of its component if it is a pair.
    Parameter { mechanisms: Box<[Mechanism; 2]>, apart: f64, key: String, part: usize },
}

impl Source {
    /// Whether it is the error of an actuated joint's value.
    pub fn is_actuator(&self) -> bool {
        matches!(self.origin, Origin::Actuator(_))
    }

    /// Whether it is a dimension of the file.
    pub fn is_parameter(&self) -> bool {
        matches!(self.origin, Origin::Parameter { .. })
    }

    /// The axes that an error of axes displaces, and their twist at home for a unit of it, base coordinates. The axes are
    /// counted in their leg from its base on; a universal joint has two.
    pub fn axes(&self) -> Option<(usize, Range<usize>, Screw)> {
        match &self.origin {
            Origin::Axis { leg, first, end, twist } => Some((*leg, *first..*end, *twist)),
            Origin::Actuator(_) | Origin::Pitch { .. } | Origin::Parameter { .. } => None,
        }
    }

    /// The twists that a unit of the error gives the platform through each leg, if all joints keep their values; `(ω; v)` in
    /// base coordinates.
    pub(crate) fn twists(
        &self,
        model: ErrorModel,
        chains: &[Chain],
        values: &[f64],
    ) -> Vec<Vector6<f64>> {
        let mut twists = vec![Vector6::zeros(); chains.len()];
        match &self.origin {
            Origin::Actuator(number) => {
                let (mut number, mut leg) = (*number, 0);
                let count = |leg: usize| chains[leg].joints.iter().map(|j| j.screws.len()).sum();
                while number >= count(leg) {
                    number -= count(leg);
                    leg += 1;
                }
                let mut screws = chains[leg].joints.iter().flat_map(|joint| &joint.screws);
                let screw = screws.nth(number).expect("the number of a coordinate");
                twists[leg] = screw.to_vector();
            }
            Origin::Axis { leg, first, end, twist } => {
                let carried = &chains[*leg].carried;
                let moved = |i: usize| twist.transformed(&carried[i]).to_vector();
                twists[*leg] = match model {
                    ErrorModel::Axes => moved(*first) - moved(*end),
                    ErrorModel::Links => moved(*first),
                };
            }
            Origin::Pitch { leg, first, coordinate, home, advance } => {
                let moved = advance.transformed(&chains[*leg].carried[*first]);
                twists[*leg] = moved.to_vector() * (values[*coordinate] - home);
            }
            Origin::Parameter { mechanisms, apart, .. } => {
                let [more, less] = mechanisms.each_ref().map(|changed| {
                    let to_reference = Isometry3::from(Translation3::from(changed.platform.coords));
                    let ends = Chain::all(changed, values);
                    ends.iter().map(|chain| chain.end() * to_reference).collect::<Vec<_>>()
                });
                for (twist, (more, less)) in twists.iter_mut().zip(more.iter().zip(&less)) {
                    *twist = small_twist(&(more * less.inverse())) / *apart;
                }
            }
        }
        twists
    }
}

/// Every source of a manipulator: actuators first, then the dimensions of its file, then joint by joint.
pub(crate) fn sources(
    manipulator: &Manipulator,
    file: Option<&MechanismFile>,
    model: ErrorModel,
) -> Vec<Source> {
    let coordinates = manipulator.coordinates();
    let actuators = manipulator.actuated().iter().map(|&number| {
        let c = &coordinates[number];
        Source {
            name: c.name.clone(),
            quantity: c.quantity,
            joint: None,
            direction: None,
            origin: Origin::Actuator(number),
        }
    });
    let mut all: Vec<Source> = actuators.collect();
    let mechanism = manipulator.mechanism();
    // Coordinates that depend on others change with a dimension, too, which errors of the pose do not tell apart.
    if let Some(file) = file.filter(|_| manipulator.dependent_coordinates().is_empty()) {
        parameters(file, mechanism, manipulator.characteristic_length(), &mut all);
    }
    let mut coordinate = 0;
    for (number, leg) in mechanism.legs.iter().enumerate() {
        let mut of_leg = OfLeg { leg, number, axis: 0, coordinate, model, all: &mut all };
        leg.joints.iter().for_each(|joint| of_leg.joint(joint));
        of_leg.platform();
        coordinate += leg.coordinates().count();
    }
    all
}

/// The sources of one leg, from base to platform.
struct OfLeg<'a> {
    leg: &'a Leg,
    number: usize,
    axis: usize,
    coordinate: usize,
    model: ErrorModel,
    all: &'a mut Vec<Source>,
}

impl OfLeg<'_> {
    fn push(&mut self, joint: &str, what: &str, quantity: Quantity, d: Vector3<f64>, o: Origin) {
        self.all.push(Source {
            name: format!("{}.{joint}.{what}", self.leg.name),
            quantity,
            joint: Some(joint.to_owned()),
            direction: Some(d),
            origin: o,
        });
    }

    /// Rotations about some directions through the joint's point, of the axes from `first` to `end`.
    fn angles(&mut self, joint: &Joint, name: &str, [first, end]: [usize; 2], about: &[Named]) {
        for &(suffix, direction) in about {
            let axis = Unit::new_unchecked(direction);
            let twist = Screw::rotation(axis, joint.point);
            let origin = Origin::Axis { leg: self.number, first, end, twist };
            self.push(name, &format!("angle.{suffix}"), Quantity::Angle, direction, origin);
        }
    }

    fn offsets(&mut self, name: &str, [first, end]: [usize; 2], along: &[Named]) {
        for &(suffix, direction) in along {
            let twist = Screw::translation(Unit::new_unchecked(direction));
            let origin = Origin::Axis { leg: self.number, first, end, twist };
            self.push(name, &format!("offset.{suffix}"), Quantity::Length, direction, origin);
        }
    }

    fn joint(&mut self, joint: &Joint) {
        let (name, first) = (&*joint.name, self.axis);
        let one = [first, first + 1];
        let pair = across(&joint.axis);
        match joint.kind {
            JointKind::Spherical => self.offsets(name, one, &BASE),
            JointKind::Universal { second } => {
                let [[_, a], [_, b]] = [pair, across(&second)].map(|p| p.map(|(_, d)| d));
                let [c, d] = [pair[0].1, across(&second)[0].1];
                self.angles(joint, name, one, &[("1", c), ("2", a)]);
                self.angles(joint, name, [first + 1, first + 2], &[("3", d), ("4", b)]);
                self.offsets(name, [first, first + 2], &BASE);
                self.axis += 1;
            }
            JointKind::Prismatic => {
                self.angles(joint, name, one, &pair);
                // The place of a slider's axis has no effect on how it moves.
                if self.model == ErrorModel::Links {
                    self.offsets(name, one, &pair);
                }
            }
            JointKind::Revolute | JointKind::Cylindrical | JointKind::Helical { .. } => {
                self.angles(joint, name, one, &pair);
                self.offsets(name, one, &pair);
                if matches!(joint.kind, JointKind::Helical { .. }) {
                    let origin = Origin::Pitch {
                        leg: self.number,
                        first,
                        coordinate: self.coordinate,
                        home: joint.coordinates[0].home,
                        advance: Screw::translation(joint.axis),
                    };
                    self.push(name, "pitch", Quantity::Length, joint.axis.into_inner(), origin);
                }
            }
        }
        self.axis += 1;
        self.coordinate += joint.freedoms();
    }

    /// Where the platform carries the last joint: an error of the platform as a link.
    fn platform(&mut self) {
        let (ErrorModel::Links, Some(last)) = (self.model, self.leg.joints.last()) else { return };
        let end = [self.axis; 2];
        self.angles(last, PLATFORM, end, &BASE);
        self.offsets(PLATFORM, end, &BASE);
    }
}

/// The name of the platform among joints.
const PLATFORM: &str = "platform";

type Named = (&'static str, Vector3<f64>);

const BASE: [Named; 3] = [
    ("x", Vector3::new(1.0, 0.0, 0.0)),
    ("y", Vector3::new(0.0, 1.0, 0.0)),
    ("z", Vector3::new(0.0, 0.0, 1.0)),
];

/// Two directions across an axis: the first is that of the base's axis which is most nearly perpendicular, made
/// perpendicular; the second completes a right-handed frame whose third direction is the axis.
fn across(axis: &Unit<Vector3<f64>>) -> [Named; 2] {
    /// Components that differ by rounding count as equal.
    const ROUNDING: f64 = 1e-9;
    let mut least = 0;
    for k in 1..3 {
        if axis[k].abs() < axis[least].abs() - ROUNDING {
            least = k;
        }
    }
    let base = BASE[least].1;
    let first = (base - axis.into_inner() * axis.dot(&base)).normalize();
    [("1", first), ("2", axis.cross(&first))]
}

/// The mechanism of a file with another dimension; `None` if it cannot be assembled.
pub(crate) fn changed_file(
    file: &MechanismFile,
    mechanism: &Mechanism,
    change: (&str, ParameterValue),
) -> Option<Mechanism> {
    let mut changed = file.with([change]).ok()?.mechanism;
    // Encoders may have been set since the file was read.
    let set = mechanism.coordinates().zip(file.mechanism.coordinates());
    let set: Vec<f64> = set.map(|(now, read)| now.home - read.home).collect();
    let legs = changed.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let coordinates = legs.flat_map(|joint| &mut joint.coordinates);
    coordinates.zip(set).for_each(|(c, set)| c.home += set);
    // A loop may have another platform than that of its file.
    let names = |mechanism: &Mechanism| -> Vec<String> {
        mechanism.joints().map(|joint| joint.name.clone()).collect()
    };
    (names(&changed) == names(mechanism)).then_some(changed)
}

/// The names of the numbers of a dimension, behind its own.
pub(crate) fn parts(value: ParameterValue) -> &'static [&'static str] {
    match value {
        ParameterValue::Number(_) => &[""],
        ParameterValue::Pair(_) => &[".x", ".y"],
        ParameterValue::None => &[],
    }
}

/// A dimension of which one of the [`parts`] is larger by a step.
pub(crate) fn stepped(value: ParameterValue, part: usize, step: f64) -> ParameterValue {
    let mut changed = value;
    match &mut changed {
        ParameterValue::Number(number) => *number += step,
        ParameterValue::Pair(pair) => pair[part] += step,
        ParameterValue::None => {}
    }
    changed
}

/// The step of a parameter in shares of the mechanism's size: the error of a central difference is its square.
pub(crate) const STEP: f64 = 1e-5;

/// The dimensions of a file that are geometry: its named lengths and angles, and the parameters of a family's legs, without
/// limits. One that cannot change alone is none: errors of axes have its part.
fn parameters(file: &MechanismFile, mechanism: &Mechanism, length: f64, all: &mut Vec<Source>) {
    for (name, value) in file.dimensions() {
        let own = |leg: &Leg| Some(name.strip_prefix(&*leg.name)?.strip_prefix('.')?.to_owned());
        let own = mechanism.legs.iter().find_map(own);
        if file.parameter(&name).is_none() && own.is_none_or(|own| own.contains('.')) {
            continue;
        }
        let Some(quantity) = file.quantity_of(&name) else { continue };
        let step = STEP * unit(quantity, length);
        for (part, suffix) in parts(value).iter().enumerate() {
            let assembled =
                |step: f64| changed_file(file, mechanism, (&name, stepped(value, part, step)));
            let ends = match (assembled(step), assembled(-step)) {
                (Some(more), Some(less)) => Some(([more, less], 2.0 * step)),
                // At an end of its range the difference is to one side.
                (Some(more), None) => assembled(0.0).map(|less| ([more, less], step)),
                (None, Some(less)) => assembled(0.0).map(|more| ([more, less], step)),
                // Other parameters decide it.
                (None, None) => None,
            };
            let Some((mechanisms, apart)) = ends else { continue };
            all.push(Source {
                name: format!("{name}{suffix}"),
                quantity,
                joint: None,
                direction: None,
                origin: Origin::Parameter {
                    mechanisms: Box::new(mechanisms),
                    apart,
                    key: name.clone(),
                    part,
                },
            });
        }
    }
}
