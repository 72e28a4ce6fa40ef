//! Reading `[[obstacle]]`: what stands around a mechanism.

use super::reader::{Table, UniqueNames, Value};
use crate::mechanism::{BodyMasses, Obstacle, ObstacleShape, Shapes};
use nalgebra::{Point3, Unit, Vector3};

pub(super) const TYPES: [(&str, Type); 3] =
    [("box", Type::Box), ("capsule", Type::Capsule), ("half-space", Type::HalfSpace)];

/// Sine of the angle below which two edges of a box count as parallel.
const PARALLEL: f64 = 1e-6;

/// The `type` of an obstacle.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Type {
    Box,
    Capsule,
    HalfSpace,
}

impl Type {
    /// The keys that an obstacle of this type must have, besides `type`.
    pub fn needs(self) -> &'static [&'static str] {
        match self {
            Self::Box => &["centre", "size"],
            Self::Capsule => &["from", "to", "radius"],
            Self::HalfSpace => &["point", "normal"],
        }
    }

    /// The keys that it may have besides.
    fn may_have(self) -> &'static [&'static str] {
        match self {
            Self::Box => &["x", "y"],
            Self::Capsule | Self::HalfSpace => &[],
        }
    }

    pub fn keys(self) -> Vec<&'static str> {
        [&["name", "type"], self.needs(), self.may_have()].concat()
    }
}

/// Reads the obstacles of a file, if there are any.
pub(super) fn read(root: &Table<'_>) -> Vec<Obstacle> {
    let mut names = UniqueNames::new("obstacles");
    names.reserve(Shapes::BASE, "the base");
    names.reserve(BodyMasses::PLATFORM, "the platform");
    let read = |(index, table): (usize, Table<'_>)| {
        let kind = table.require("type", "the obstacle's type")?.word(&TYPES)?;
        table.allow(&kind.keys());
        let given = table.get("name").and_then(|value| value.name());
        let name = given.map_or_else(|| format!("obstacle{}", index + 1), str::to_owned);
        names.add(&name, table.reader, table.location_of("name"));
        Some(Obstacle { name, shape: shape(&table, kind)? })
    };
    root.open_tables("obstacle").into_iter().enumerate().filter_map(read).collect()
}

fn shape(table: &Table<'_>, kind: Type) -> Option<ObstacleShape> {
    let point = |key, what| {
        table.require(key, what).and_then(|value| value.point()).map(Point3::<f64>::from)
    };
    match kind {
        Type::Box => {
            let centre = point("centre", "the centre of the box, [x, y, z]");
            let size = table.require("size", "the lengths of the edges, [a, b, c]");
            let size = size.and_then(|value| value.positive_lengths());
            let edges = edges(table);
            Some(ObstacleShape::Box { centre: centre?, size: size?.into(), edges: edges? })
        }
        Type::Capsule => {
            let from = point("from", "one end of the axis, [x, y, z]");
            let to = point("to", "the other end of the axis, [x, y, z]");
            let radius = table.require("radius", "the radius, a length");
            let radius = radius.and_then(|value| value.positive_length());
            Some(ObstacleShape::Capsule { ends: [from?, to?], radius: radius? })
        }
        Type::HalfSpace => {
            let point = point("point", "a point [x, y, z] of the plane");
            let normal = table.require("normal", "the direction [x, y, z] out of the obstacle");
            let normal = normal.and_then(|value| value.direction());
            Some(ObstacleShape::HalfSpace { point: point?, normal: normal? })
        }
    }
}

/// Reads the directions of the first two edges of a box; `None` if one cannot be read.
fn edges(table: &Table<'_>) -> Option<[Unit<Vector3<f64>>; 2]> {
    let level = ObstacleShape::level();
    let edge =
        |key, level| table.get(key).map_or(Some(level), |value: Value<'_>| value.direction());
    let (x, y) = (edge("x", level[0]), edge("y", level[1]));
    let (x, y) = (x?, y?);
    if x.cross(&y).norm() < PARALLEL {
        let key = if table.get("y").is_some() { "y" } else { "x" };
        let problem = "`x` and `y` are parallel, expected the directions of two edges; `y` is [0, 1, 0] if it is not \
                       given, and `x` is [1, 0, 0]";
        table.reader.report(table.location_of(key), problem);
        return None;
    }
    Some([x, y])
}
