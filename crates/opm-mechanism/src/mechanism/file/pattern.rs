//! Patterns of legs: one description, and legs that are turned about an axis or mirrored.

use super::expression::{reflected, turned};
use super::reader::Value;
use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::{Joint, JointKind};
use crate::numeric::Quantity;
use crate::numeric::number::readable;
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::TAU;

/// The keys of `pattern`.
pub(super) const KEYS: &[&str] = &["count", "axis", "point", "angles", "repeat", "mirror", "first"];
/// The keys that say how many legs there are, of which one is given.
const COUNTS: [&str; 3] = ["count", "angles", "repeat"];
/// The keys of `mirror` in it.
pub(super) const MIRROR_KEYS: &[&str] = &["normal", "point"];

/// What stands for a leg's number in the names of a pattern.
pub(super) const PLACE: &str = "{i}";

/// The most legs that a pattern makes.
const MOST: i64 = 100;

/// How the legs of a pattern are placed: the first one as it is described, in the default.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// The axis about which legs are turned.
    pub axis: Unit<Vector3<f64>>,
    /// A point of the axis, metres.
    pub point: Point3<f64>,
    /// By how much each leg is turned, radians.
    pub angles: Vec<f64>,
    /// The number of the first leg in names and expressions.
    pub first: usize,
    /// A plane in which each of them is mirrored, if there is one: its normal and a point. The image of a leg follows it.
    pub mirror: Option<(Unit<Vector3<f64>>, Point3<f64>)>,
}

impl Pattern {
    /// Reads the key `pattern` of a leg.
    pub(super) fn read(value: &Value<'_>) -> Option<Self> {
        let table = value.table(KEYS)?;
        let axis = table.get("axis").and_then(|value| value.direction());
        let point = table.get("point").and_then(|value| value.point());
        let mirror = table.get("mirror").and_then(|value| read_mirror(&value));
        let mut given = COUNTS.iter().filter_map(|&key| Some((key, table.get(key)?)));
        let angles = match (given.next(), given.next()) {
            (Some((key, _)), Some((_, other))) => {
                other.report(format!("is given beside `{key}`, expected one of them"));
                None
            }
            (Some(("count", count)), None) => read_count(&count).map(around),
            (Some(("angles", angles)), None) => read_angles(&angles),
            (Some((_, repeat)), None) => read_count(&repeat).map(|count| vec![0.0; count as usize]),
            (None, _) if table.get("mirror").is_some() => Some(vec![0.0]),
            (None, _) => {
                value.report("has no legs, expected `count`, `angles`, `repeat` or `mirror`");
                None
            }
        };
        let first = table.get("first").map_or(Some(1), |first| read_first(&first));
        Some(Self {
            axis: axis.unwrap_or(Vector3::z_axis()),
            point: point.map_or_else(Point3::origin, Point3::from),
            angles: angles?,
            first: first?,
            mirror,
        })
    }

    /// The number of legs.
    pub fn count(&self) -> usize {
        self.angles.len() * if self.mirror.is_some() { 2 } else { 1 }
    }

    /// How the legs lie, for people; empty if none is a copy of another, since each has points of its own.
    pub(super) fn describe(&self, units: FileUnits) -> String {
        let vector = |axis: &Vector3<f64>| {
            let short = |c: f64| readable((c * 1e4).round() / 1e4);
            format!("({})", [axis.x, axis.y, axis.z].map(short).join(", "))
        };
        let show = |angle: f64| units.show(angle, Quantity::Angle).to_string();
        let mut parts = Vec::new();
        if self.angles.len() > 1 && self.angles.iter().all(|&angle| angle == 0.0) {
            return String::new();
        }
        if let [first, second, ..] = *self.angles {
            let step = second - first;
            let even = self.angles.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-9);
            let turns = match even {
                true => format!("{} apart", show(step)),
                false => {
                    let all: Vec<String> = self.angles.iter().copied().map(show).collect();
                    format!("turned by {}", all.join(", "))
                }
            };
            parts.push(format!("{turns} about {}", vector(&self.axis)));
        }
        if let Some((normal, _)) = &self.mirror {
            parts.push(format!("mirrored across the plane with the normal {}", vector(normal)));
        }
        parts.join(", and ")
    }

    /// Where the leg of a number, from 0, is.
    pub(super) fn place(&self, number: usize) -> Placement {
        let (turn, mirrored) = match self.mirror {
            Some(plane) => (number / 2, (number % 2 == 1).then_some(plane)),
            None => (number, None),
        };
        Placement { axis: self.axis, point: self.point, angle: self.angles[turn], mirrored }
    }
}

fn read_mirror(value: &Value<'_>) -> Option<(Unit<Vector3<f64>>, Point3<f64>)> {
    let table = value.table(MIRROR_KEYS)?;
    let normal = table.require("normal", "the normal [x, y, z] of the plane")?.direction();
    let point = table.get("point").and_then(|value| value.point());
    Some((normal?, point.map_or_else(Point3::origin, Point3::from)))
}

/// Reads the number of legs.
fn read_count(value: &Value<'_>) -> Option<i64> {
    let count = value.integer()?;
    if !(1..=MOST).contains(&count) {
        value.report(format!("is {count}, expected 1 to {MOST} legs"));
        return None;
    }
    Some(count)
}

/// The angles of so many legs, all around the axis.
fn around(count: i64) -> Vec<f64> {
    (0..count).map(|number| TAU * number as f64 / count as f64).collect()
}

/// Reads the number of the first leg.
fn read_first(value: &Value<'_>) -> Option<usize> {
    let first = value.integer()?;
    if !(1..=MOST).contains(&first) {
        value.report(format!("is {first}, expected the number of the first leg, 1 to {MOST}"));
        return None;
    }
    Some(first as usize)
}

/// Reads the angles of legs, one by one.
fn read_angles(value: &Value<'_>) -> Option<Vec<f64>> {
    let items = value.items("an array of angles")?;
    if !(1..=MOST as usize).contains(&items.len()) {
        value.report(format!("has {} angles, expected 1 to {MOST}", items.len()));
        return None;
    }
    super::all(items.iter().map(|item| item.quantity(Quantity::Angle)))
}

/// How one leg of a pattern is placed: mirrored, if it is, and then turned.
pub(super) struct Placement {
    axis: Unit<Vector3<f64>>,
    point: Point3<f64>,
    angle: f64,
    mirrored: Option<(Unit<Vector3<f64>>, Point3<f64>)>,
}

impl Placement {
    /// Moves a joint of the described leg to this one. Its coordinates keep their values: those of a mirror image are
    /// counted so that equal values are images of each other.
    pub fn place(&self, joint: &mut Joint) {
        joint.point = self.point(joint.point);
        match &mut joint.kind {
            // It has no axis of its own.
            JointKind::Spherical => {}
            kind => {
                // An axis of rotation turns the other way in a mirror.
                let turns = !matches!(kind, JointKind::Prismatic);
                joint.axis = self.axis(joint.axis, turns);
            }
        }
        match &mut joint.kind {
            JointKind::Universal { second } => *second = self.axis(*second, true),
            // Along its axis, which is turned round, the image advances the other way.
            JointKind::Helical { pitch } if self.mirrored.is_some() => *pitch = -*pitch,
            JointKind::Cylindrical if self.mirrored.is_some() => {
                if let Some(slide) = joint.coordinates.last_mut() {
                    slide.home = -slide.home;
                    slide.limits = slide.limits.map(|[low, high]| [-high, -low]);
                }
            }
            _ => {}
        }
        if let Some(cone) = &mut joint.cone {
            cone.axis = cone.axis.map(|axis| self.axis(axis, false));
        }
    }

    fn point(&self, point: Point3<f64>) -> Point3<f64> {
        let image = match self.mirrored {
            Some((normal, through)) => through + reflected(normal, point - through),
            None => point,
        };
        self.point + turned(self.axis, self.angle, image - self.point)
    }

    fn axis(&self, axis: Unit<Vector3<f64>>, turns: bool) -> Unit<Vector3<f64>> {
        let image = match self.mirrored {
            Some((normal, _)) if turns => -reflected(normal, *axis),
            Some((normal, _)) => reflected(normal, *axis),
            None => *axis,
        };
        Unit::new_normalize(turned(self.axis, self.angle, image))
    }
}

/// A name of a pattern's leg or joint, with the leg's number of so many legs; a problem is reported if it would be that of several legs.
pub(super) fn numbered(
    value: Option<&Value<'_>>,
    name: &str,
    number: Option<(usize, usize)>,
) -> String {
    match number {
        Some((number, count)) => {
            if count > 1
                && !name.contains(PLACE)
                && let Some(value) = value
            {
                value.report(format!(
                    "is {name:?} in every leg of the pattern, expected a name with {PLACE}, the number of the leg"
                ));
            }
            name.replace(PLACE, &number.to_string())
        }
        None => {
            if name.contains(PLACE)
                && let Some(value) = value
            {
                value.report(format!("has {PLACE}, which is the number of a leg of a `pattern`"));
            }
            name.to_owned()
        }
    }
}
