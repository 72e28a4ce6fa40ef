//! Reading `[bodies]`: what the bodies of a mechanism weigh, and how thick they are.

use super::checks::{self, DENSITIES, MASSES};
use super::hint::expected_one_of;
use super::reader::{Table, Value, all};
use crate::mechanism::{BodyMasses, Mechanism, Payload, Shapes};
use nalgebra::{Matrix3, Point3};

pub(super) const KEYS: &[&str] =
    &["density", "masses", "centres", "inertias", "payload", "radius", "radii"];

/// The keys of a payload.
pub(super) const PAYLOAD: &[&str] = &["mass", "centre", "inertia"];

/// The largest entry of a tensor of inertia, kilograms times square metres: a thousand tons at a kilometre.
pub(super) const INERTIA: f64 = 1e12;
/// The share of a principal moment of inertia that is rounding.
const ROUNDING: f64 = 1e-9;

/// Reads the table, if there is one, into a mechanism.
pub(super) fn read(root: &Table<'_>, mechanism: &mut Mechanism) {
    let Some(table) = root.get("bodies").and_then(|value| value.table(KEYS)) else { return };
    let density = table.get("density").and_then(|value| within(&value, DENSITIES, "kg/m^3"));
    let moving: Vec<&str> = mechanism.body_names().collect();
    let masses = table.get("masses").and_then(|value| value.open_table());
    let masses = masses
        .map(|masses| by_name(&masses, mechanism, &moving, |mass| within(mass, MASSES, "kg")));
    let centres = table.get("centres").and_then(|value| value.open_table());
    let centres = centres.map(|centres| by_name(&centres, mechanism, &moving, point));
    let inertias = table.get("inertias").and_then(|value| value.open_table());
    let inertias = inertias.map(|inertias| by_name(&inertias, mechanism, &moving, inertia));
    let payload = table.get("payload").and_then(|value| value.table(PAYLOAD)).and_then(payload);
    let radius = table.get("radius").and_then(|value| value.positive_length());
    let all = [&moving[..], &[Shapes::BASE]].concat();
    let radii = table.get("radii").and_then(|value| value.open_table());
    let radii = radii.map(|radii| by_name(&radii, mechanism, &all, length));
    mechanism.bodies = BodyMasses {
        density,
        masses: masses.unwrap_or_default(),
        centres: centres.unwrap_or_default(),
        inertias: inertias.unwrap_or_default(),
        payload,
    };
    (mechanism.shapes.radius, mechanism.shapes.radii) = (radius, radii.unwrap_or_default());
}

fn length(value: &Value<'_>) -> Option<f64> {
    value.positive_length()
}

fn point(value: &Value<'_>) -> Option<Point3<f64>> {
    value.point().map(Point3::from)
}

/// Reads what the platform carries.
fn payload(table: Table<'_>) -> Option<Payload> {
    let mass = table.require("mass", "the payload's mass, kilograms");
    let mass = mass.and_then(|value| within(&value, MASSES, "kg"));
    let centre = table.get("centre").map(|value| point(&value));
    let tensor = table.get("inertia").map(|value| inertia(&value));
    let (centre, tensor) = (centre.map_or(Some(None), |read| read.map(Some))?, tensor);
    Some(Payload { mass: mass?, centre, inertia: tensor.unwrap_or(Some(Matrix3::zeros()))? })
}

/// Reads a tensor of inertia: `[xx, yy, zz]`, or `[xx, yy, zz, xy, xz, yz]`.
fn inertia(value: &Value<'_>) -> Option<Matrix3<f64>> {
    let expected = "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz]";
    let items = value.items(expected)?;
    if items.len() != 3 && items.len() != 6 {
        let values = if items.len() == 1 { "value" } else { "values" };
        value.report(format!("has {} {values}, expected {expected}", items.len()));
        return None;
    }
    let given = all(items.iter().map(|item| within(item, [-INERTIA, INERTIA], "kg m^2")))?;
    let [xx, yy, zz] = [given[0], given[1], given[2]];
    let [xy, xz, yz] = [3, 4, 5].map(|number| given.get(number).copied().unwrap_or_default());
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let mut moments: [f64; 3] = tensor.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [least, middle, most] = moments;
    // Each moment is the sum of two second moments of the mass, none of which is negative.
    let rounding = ROUNDING * most;
    if least >= -rounding && most <= least + middle + rounding {
        return Some(tensor);
    }
    value.report(format!(
        "is the inertia of no body: its principal moments are {least:.3e}, {middle:.3e} and {most:.3e} kg m^2, \
         expected none below 0 and none above the sum of the other two"
    ));
    None
}

/// Reads a value for some of the bodies with these names.
fn by_name<T>(
    given: &Table<'_>,
    mechanism: &Mechanism,
    names: &[&str],
    read: impl Fn(&Value<'_>) -> Option<T>,
) -> Vec<(String, T)> {
    let known = names.iter().filter_map(|&name| Some((name.to_owned(), read(&given.get(name)?)?)));
    let known = known.collect();
    for name in given.keys().filter(|name| !names.contains(name)) {
        let at = given.location_of(name);
        let carries = mechanism.joints().any(|joint| joint.name == name);
        let problem = match carries {
            true => format!("the joint {name} carries the platform, expected `platform`"),
            false => format!("no body is called {name:?}, {}", expected_one_of(name, names)),
        };
        given.reader.report(at, problem);
    }
    known
}

/// Reads a number in a range.
fn within(value: &Value<'_>, range: [f64; 2], unit: &str) -> Option<f64> {
    let checked = checks::within(value.number()?, range, unit);
    checked.map_err(|problem| value.report(problem)).ok()
}
