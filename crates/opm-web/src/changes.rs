//! The numbers of a mechanism that can be changed: its named parameters, those of a family, or the joints of a list.

use crate::problem::{Problem, Problems};
use crate::request::Changes;
use crate::units::{rounded, shown};
use opm_core::Quantity;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::family::{Family, ParameterValue};
use opm_core::mechanism::file::{FileUnits, MechanismFile, NamedParameter, NamedValue};
use opm_core::mechanism::joint::{DriveLimit, Joint, JointKind};
use opm_core::nalgebra::{Point3, Unit, Vector3};
use serde::Serialize;

/// Largest accepted length, metres, as in files.
const LARGEST: f64 = 1e9;

/// Shortest vector, in the file's numbers, that is still a direction.
const SHORTEST: f64 = 1e-9;

/// A number of the mechanism, or several that belong together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dimension {
    /// Its name in changes.
    name: String,
    /// The leg that it belongs to, `home` or `platform`.
    group: String,
    /// Its name within the group.
    label: String,
    /// The symbol of its unit, empty for a direction.
    unit: &'static str,
    /// The names of its numbers: none for a single one, `min` and `max` for limits, `x` and so on for a point.
    parts: &'static [&'static str],
    /// Its numbers in the file's unit; none for limits that are not given.
    values: Vec<f64>,
}

const SINGLE: &[&str] = &[];
const LIMITS: &[&str] = &["min", "max"];
const SPACE: &[&str] = &["x", "y", "z"];
const PLANE: &[&str] = &["x", "y"];

/// Every number of the mechanism that can be changed, in the order of the file.
pub fn dimensions(file: &MechanismFile) -> Vec<Dimension> {
    let mut all = of_names(file);
    all.extend(match &file.family {
        Some(family) => of_family(family, file.units),
        None if all.is_empty() => of_joints(file),
        // Places follow from the parameters.
        None => of_joints(file).into_iter().filter(|d| d.name.ends_with(".limits")).collect(),
    });
    all
}

/// The named parameters, but for points and those that follow from others.
fn of_names(file: &MechanismFile) -> Vec<Dimension> {
    let units = file.units;
    let dimension = |parameter: &NamedParameter| {
        let NamedValue::Number(value) = parameter.value else { return None };
        let (unit, value) = match parameter.unit.quantity() {
            Some(quantity) => (units.symbol(quantity), shown(value, quantity, units)),
            None => ("", rounded(value)),
        };
        let (name, group) = (parameter.name.clone(), "parameters".to_owned());
        let label = name.clone();
        Some(Dimension { name, group, label, unit, parts: SINGLE, values: vec![value] })
    };
    let given = file.parameters.iter().filter(|parameter| parameter.formula.is_none());
    given.filter_map(dimension).collect()
}

/// The parameters of a family, but for the limits of how joints are driven, on which nothing that is shown depends, and the
/// offsets of encoders.
fn of_family(family: &Family, units: FileUnits) -> Vec<Dimension> {
    let drives = DriveLimit::ALL.map(|limit| format!(".{}.", limit.key()));
    let moves =
        |name: &str| name.contains(".offset.") || drives.iter().any(|drive| name.contains(drive));
    let dimension = |(name, value): (String, ParameterValue)| {
        let quantity = family.quantity_of(&name)?;
        let (group, label) = name.split_once('.')?;
        let parts = match value {
            _ if label.starts_with("limits.") => LIMITS,
            ParameterValue::Pair(_) => PLANE,
            ParameterValue::Number(_) | ParameterValue::None => SINGLE,
        };
        let values = match value {
            ParameterValue::None => vec![],
            ParameterValue::Number(value) => vec![value],
            ParameterValue::Pair(pair) => pair.to_vec(),
        };
        Some(Dimension {
            group: group.to_owned(),
            label: label.to_owned(),
            unit: units.symbol(quantity),
            parts,
            values: values.into_iter().map(|value| shown(value, quantity, units)).collect(),
            name,
        })
    };
    family.parameters().into_iter().filter(|(name, _)| !moves(name)).filter_map(dimension).collect()
}

/// The places, limits and home values of the joints of a list, and the platform's point.
fn of_joints(file: &MechanismFile) -> Vec<Dimension> {
    let (units, length) = (file.units, file.units.length.symbol());
    let mut all = Vec::new();
    let point = |point: Point3<f64>| {
        point.coords.iter().map(|&c| shown(c, Quantity::Length, units)).collect::<Vec<_>>()
    };
    let direction = |axis: Unit<Vector3<f64>>| axis.iter().map(|&c| rounded(c)).collect::<Vec<_>>();
    let mut add = |group: &str, label: String, unit, parts, values| {
        let (name, group) = (label.clone(), group.to_owned());
        all.push(Dimension { name, group, label, unit, parts, values });
    };
    add("platform", PLATFORM.to_owned(), length, SPACE, point(file.mechanism.platform));
    for leg in &file.mechanism.legs {
        for joint in &leg.joints {
            for &part in PlacePart::of(joint) {
                let label = format!("{}.{}", joint.name, part.key());
                let (unit, parts, values) = match (part, joint.kind) {
                    (PlacePart::Point, _) => (length, SPACE, point(joint.point)),
                    (PlacePart::Axis2, JointKind::Universal { second }) => {
                        ("", SPACE, direction(second))
                    }
                    (PlacePart::Pitch, JointKind::Helical { pitch }) => {
                        (length, SINGLE, vec![shown(pitch, Quantity::Length, units)])
                    }
                    _ => ("", SPACE, direction(joint.axis)),
                };
                add(&leg.name, label, unit, parts, values);
            }
            for c in &joint.coordinates {
                let unit = units.symbol(c.quantity);
                let of = |value: f64| shown(value, c.quantity, units);
                add(&leg.name, format!("{}.home", c.name), unit, SINGLE, vec![of(c.home)]);
                let limits = c.limits.map_or(vec![], |limits| limits.map(of).to_vec());
                add(&leg.name, format!("{}.limits", c.name), unit, LIMITS, limits);
            }
        }
    }
    all
}

/// The name of the platform's reference point.
const PLATFORM: &str = "platform.point";

/// What of a joint's place can be changed.
#[derive(Clone, Copy, PartialEq)]
enum PlacePart {
    Point,
    Axis,
    Axis2,
    Pitch,
}

impl PlacePart {
    const ALL: [Self; 4] = [Self::Point, Self::Axis, Self::Axis2, Self::Pitch];

    /// Its key in files.
    fn key(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Axis => "axis",
            Self::Axis2 => "axis2",
            Self::Pitch => "pitch",
        }
    }

    /// Those that a joint has.
    fn of(joint: &Joint) -> &'static [Self] {
        match joint.kind {
            JointKind::Revolute | JointKind::Prismatic | JointKind::Cylindrical => {
                &[Self::Point, Self::Axis]
            }
            JointKind::Helical { .. } => &[Self::Point, Self::Axis, Self::Pitch],
            JointKind::Universal { .. } => &[Self::Point, Self::Axis, Self::Axis2],
            JointKind::Spherical => &[Self::Point],
        }
    }
}

/// A file with some of its numbers changed.
pub fn apply(original: &MechanismFile, changes: &Changes) -> Result<MechanismFile, Problems> {
    let mut file = original.clone();
    let (mut numbers, mut problems) = (Vec::new(), Vec::new());
    for (name, given) in changes {
        let done = match &file.family {
            None => place(&mut file.mechanism, name, given, original.units),
            Some(_) => None,
        };
        let done = done.unwrap_or_else(|| {
            numbers.push((&**name, value(original, name, given)?));
            Ok(())
        });
        let problem = |what| Problem { message: format!("`{name}` {what}"), ..Problem::default() };
        problems.extend(done.err().map(problem));
    }
    if !problems.is_empty() {
        return Err(Problems { problems });
    }
    if numbers.is_empty() { Ok(file) } else { Ok(file.with(numbers)?) }
}

/// A value that [`MechanismFile::with`] takes, SI. A name that it does not know is for it to report.
fn value(file: &MechanismFile, name: &str, given: &[f64]) -> Result<ParameterValue, String> {
    let quantity = file.quantity_of(name);
    let si = |value: f64| quantity.map_or(value, |quantity| file.units.si(value, quantity));
    match *given {
        [] => Ok(ParameterValue::None),
        [value] => Ok(ParameterValue::Number(si(value))),
        [low, high] => Ok(ParameterValue::Pair([si(low), si(high)])),
        _ => Err(format!("has {} numbers, expected at most two", given.len())),
    }
}

/// Moves a joint of a list, or the platform's point; `None` if the name is that of neither.
fn place(
    mechanism: &mut Mechanism,
    name: &str,
    given: &[f64],
    units: FileUnits,
) -> Option<Result<(), String>> {
    if name == PLATFORM {
        return Some(point(given, units).map(|point| mechanism.platform = point));
    }
    let (joint, key) = name.rsplit_once('.')?;
    let part = PlacePart::ALL.into_iter().find(|part| part.key() == key)?;
    let mut joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let joint = joints.find(|known| known.name == joint)?;
    if !PlacePart::of(joint).contains(&part) {
        return None;
    }
    Some(match part {
        PlacePart::Point => point(given, units).map(|point| joint.point = point),
        PlacePart::Axis => direction(given).map(|axis| joint.axis = axis),
        PlacePart::Axis2 => {
            direction(given).map(|second| joint.kind = JointKind::Universal { second })
        }
        PlacePart::Pitch => {
            pitch(given, units).map(|pitch| joint.kind = JointKind::Helical { pitch })
        }
    })
}

fn point(given: &[f64], units: FileUnits) -> Result<Point3<f64>, String> {
    let [x, y, z] = three(given)?.map(|c| units.si(c, Quantity::Length));
    match [x, y, z].iter().all(|c| c.abs() <= LARGEST) {
        true => Ok(Point3::new(x, y, z)),
        false => Err(format!("is {given:?}, expected numbers of at most {LARGEST:e} m")),
    }
}

fn direction(given: &[f64]) -> Result<Unit<Vector3<f64>>, String> {
    let vector = Vector3::from(three(given)?);
    let unit = Unit::try_new(vector, SHORTEST).filter(|_| vector.norm_squared().is_finite());
    unit.ok_or_else(|| format!("is {given:?}, expected a direction"))
}

fn pitch(given: &[f64], units: FileUnits) -> Result<f64, String> {
    match *given {
        [value] if value.abs() <= LARGEST => Ok(units.si(value, Quantity::Length)),
        _ => Err(format!("is {given:?}, expected a number")),
    }
}

fn three(given: &[f64]) -> Result<[f64; 3], String> {
    given.try_into().map_err(|_| format!("has {} numbers, expected three", given.len()))
}
