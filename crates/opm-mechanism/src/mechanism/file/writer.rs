//! Writing a mechanism as the text of a file that lists its joints.

use super::FileUnits;
use crate::mechanism::joint::{DriveLimit, DriveNumber, Joint, JointCoordinate, JointKind};
use crate::mechanism::{
    Cone, HOME_COORDINATES, Mechanism, Obstacle, ObstacleShape, Payload, TaskHints,
};
use crate::numeric::Quantity;
use nalgebra::{Matrix3, Point3, Vector3};
use std::fmt::Write;

/// How many digits the numbers of a written file have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// As many digits as are needed to read exactly the same numbers again.
    All,
    /// Only digits that rounding errors cannot have changed: for people.
    Sure,
}

/// The number of decimals of a length or an angle with [`Digits::Sure`]. It is coarser than
/// rounding errors, so that 119.99999999999999 mm is written as 120.
const DECIMALS: usize = 12;

/// The same for components of unit vectors.
const UNIT_DECIMALS: usize = 14;

/// Writes a mechanism as a file that lists its joints. The names of imaginary joints and their values at home, which a
/// family sets, have no place in such a file and are lost: there they are `tau.LEG`, and zero at home.
pub fn write(mechanism: &Mechanism, units: FileUnits, digits: Digits) -> String {
    let writer = Writer { units, digits };
    let mut text = format!(
        "format = 1\nname = {}\nunits = {{ length = \"{}\", angle = \"{}\" }}\n",
        quoted(&mechanism.name),
        units.length.symbol(),
        units.angle.symbol()
    );
    let _ = write!(text, "\n[platform]\npoint = {}\n", writer.point(mechanism.platform));
    text.push_str(&writer.task(&mechanism.task));
    text.push_str(&writer.surroundings(mechanism));
    for leg in &mechanism.legs {
        let _ = write!(text, "\n[[leg]]\nname = {}\njoints = [\n", quoted(&leg.name));
        for joint in &leg.joints {
            let _ = writeln!(text, "  {{ {} }},", writer.entries(joint).join(", "));
        }
        text.push_str("]\n");
    }
    text
}

/// The table `[task]` of a mechanism, or nothing if there are no hints.
pub(super) fn task(hints: &TaskHints, units: FileUnits, digits: Digits) -> String {
    Writer { units, digits }.task(hints)
}

/// The table `[bodies]` of a mechanism, its obstacles and its differences; nothing if none of it is given.
pub(super) fn surroundings(mechanism: &Mechanism, units: FileUnits, digits: Digits) -> String {
    Writer { units, digits }.surroundings(mechanism)
}

/// A table of values by the names of bodies; nothing if there are none.
fn by_name<T>(key: &str, given: &[(String, T)], value: impl Fn(&T) -> String) -> String {
    let entries = given.iter().map(|(name, of)| format!("{} = {}", quoted(name), value(of)));
    let entries: Vec<_> = entries.collect();
    match entries.is_empty() {
        true => String::new(),
        false => format!("{key} = {{ {} }}\n", entries.join(", ")),
    }
}

/// A tensor of inertia, without the products where all are zero.
fn inertia(tensor: &Matrix3<f64>) -> String {
    let mut entries = vec![tensor.m11, tensor.m22, tensor.m33];
    let products = [tensor.m12, tensor.m13, tensor.m23];
    if products != [0.0; 3] {
        entries.extend(products);
    }
    format!("{entries:?}")
}

#[derive(Clone, Copy)]
struct Writer {
    units: FileUnits,
    digits: Digits,
}

impl Writer {
    /// The table `[task]`, or nothing if there are no hints.
    fn task(self, hints: &TaskHints) -> String {
        let mut lines = Vec::new();
        if let Some(axis) = hints.axis {
            lines.push(format!("axis = {}", self.direction(&axis)));
        }
        for (name, frame) in [("lower", &hints.lower), ("upper", &hints.upper)] {
            let directions =
                [("x", frame.x), ("axis", frame.axis), ("w", frame.w), ("normal", frame.normal)];
            let mut keys: Vec<_> = directions
                .into_iter()
                .filter_map(|(key, given)| Some(format!("{key} = {}", self.direction(&given?))))
                .collect();
            if let Some(origin) = frame.origin {
                keys.push(format!("origin = {}", self.point(origin)));
            }
            if !keys.is_empty() {
                lines.push(format!("{name} = {{ {} }}", keys.join(", ")));
            }
        }
        let home = hints.home.iter().filter_map(|(name, value)| {
            let (_, quantity) = HOME_COORDINATES.into_iter().find(|(known, _)| known == name)?;
            Some(format!("{name} = {}", self.number(*value, quantity)))
        });
        let home: Vec<_> = home.collect();
        if !home.is_empty() {
            lines.push(format!("home = {{ {} }}", home.join(", ")));
        }
        if !hints.independent.is_empty() {
            let names: Vec<String> = hints.independent.iter().map(|name| quoted(name)).collect();
            lines.push(format!("independent = [{}]", names.join(", ")));
        }
        if let Some(coordinates) = hints.coordinates {
            lines.push(format!("coordinates = {}", quoted(coordinates.name())));
        }
        if lines.is_empty() { String::new() } else { format!("\n[task]\n{}\n", lines.join("\n")) }
    }

    fn surroundings(self, mechanism: &Mechanism) -> String {
        let obstacles = mechanism.shapes.obstacles.iter().map(|obstacle| self.obstacle(obstacle));
        let differences = mechanism.differences.iter().filter_map(|difference| {
            let quantity = difference.quantity(mechanism).ok()?;
            let [one, other] = difference.joints.each_ref().map(|name| quoted(name));
            let [low, high] = difference.limits.map(|limit| self.number(limit, quantity));
            Some(format!("\n[[difference]]\njoints = [{one}, {other}]\nlimits = [{low}, {high}]\n"))
        });
        let text = self.bodies(mechanism) + &obstacles.collect::<String>();
        text + &differences.collect::<String>()
    }

    /// The table `[bodies]`, or nothing if it has no entries.
    fn bodies(self, mechanism: &Mechanism) -> String {
        let (weights, shapes) = (&mechanism.bodies, &mechanism.shapes);
        let mut text = String::new();
        if let Some(density) = weights.density {
            let _ = writeln!(text, "density = {density:?}");
        }
        text += &by_name("masses", &weights.masses, |mass| format!("{mass:?}"));
        text += &by_name("centres", &weights.centres, |centre| self.point(*centre));
        text += &by_name("inertias", &weights.inertias, inertia);
        if let Some(Payload { mass, centre, inertia: tensor }) = weights.payload {
            let mut keys = vec![format!("mass = {mass:?}")];
            keys.extend(centre.map(|centre| format!("centre = {}", self.point(centre))));
            if tensor != Matrix3::zeros() {
                keys.push(format!("inertia = {}", inertia(&tensor)));
            }
            let _ = writeln!(text, "payload = {{ {} }}", keys.join(", "));
        }
        if let Some(radius) = shapes.radius {
            let _ = writeln!(text, "radius = {}", self.length(radius));
        }
        text += &by_name("radii", &shapes.radii, |radius| self.length(*radius));
        if text.is_empty() { text } else { format!("\n[bodies]\n{text}") }
    }

    /// A table `[[obstacle]]`.
    fn obstacle(self, obstacle: &Obstacle) -> String {
        let keys = match &obstacle.shape {
            ObstacleShape::Box { centre, size, edges: [x, y] } => {
                let [a, b, c] = size.map(|edge| self.length(edge)).into();
                let mut keys = format!(
                    "type = \"box\"\ncentre = {}\nsize = [{a}, {b}, {c}]\n",
                    self.point(*centre)
                );
                if [*x, *y] != ObstacleShape::level() {
                    let (x, y) = (self.direction(x), self.direction(y));
                    let _ = write!(keys, "x = {x}\ny = {y}\n");
                }
                keys
            }
            ObstacleShape::Capsule { ends, radius } => {
                let [from, to] = ends.map(|end| self.point(end));
                let radius = self.length(*radius);
                format!("type = \"capsule\"\nfrom = {from}\nto = {to}\nradius = {radius}\n")
            }
            ObstacleShape::HalfSpace { point, normal } => {
                let (point, normal) = (self.point(*point), self.direction(normal));
                format!("type = \"half-space\"\npoint = {point}\nnormal = {normal}\n")
            }
        };
        format!("\n[[obstacle]]\nname = {}\n{keys}", quoted(&obstacle.name))
    }

    fn length(self, length: f64) -> String {
        self.number(length, Quantity::Length)
    }

    /// The entries of a joint, one per key.
    fn entries(self, joint: &Joint) -> Vec<String> {
        let kind = joint.kind.name();
        let mut entries =
            vec![format!("name = {}", quoted(&joint.name)), format!("type = \"{kind}\"")];
        if joint.kind != JointKind::Spherical {
            entries.push(format!("axis = {}", self.direction(&joint.axis)));
        }
        if let JointKind::Universal { second } = joint.kind {
            entries.push(format!("axis2 = {}", self.direction(&second)));
        }
        entries.push(format!("point = {}", self.point(joint.point)));
        if let JointKind::Helical { pitch } = joint.kind {
            entries.push(format!("pitch = {}", self.number(pitch, Quantity::Length)));
        }
        if joint.actuated {
            entries.push("actuated = true".into());
        }
        if joint.turns_back {
            entries.push(format!("{} = true", Joint::TURNS_BACK));
        }

        let one_or_all = |values: Vec<String>| match &values[..] {
            [one] => one.clone(),
            all => format!("[{}]", all.join(", ")),
        };
        let coordinates = &joint.coordinates;
        if coordinates.iter().any(|c| c.home != 0.0) {
            let home = coordinates.iter().map(|c| self.number(c.home, c.quantity));
            entries.push(format!("home = {}", one_or_all(home.collect())));
        }
        let limits = coordinates.iter().map(|c| {
            let [low, high] = c.limits?.map(|limit| self.number(limit, c.quantity));
            Some(format!("[{low}, {high}]"))
        });
        if let Some(limits) = limits.collect() {
            entries.push(format!("limits = {}", one_or_all(limits)));
        }
        if let Some(Cone { half_angle, axis }) = joint.cone {
            let angle = self.number(half_angle, Quantity::Angle);
            entries.push(match axis {
                None => format!("cone = {angle}"),
                Some(axis) => {
                    format!("cone = {{ angle = {angle}, axis = {} }}", self.direction(&axis))
                }
            });
        }
        for limit in DriveLimit::ALL {
            let largest =
                coordinates.iter().map(|c| Some(self.drive_limit(limit, limit.of(c)?, c.quantity)));
            if let Some(largest) = largest.collect() {
                entries.push(format!("{} = {}", limit.key(), one_or_all(largest)));
            }
        }
        for number in DriveNumber::ALL {
            let value = |c: &JointCoordinate| {
                let unit = number.in_file(c.quantity, self.units);
                format!("{:?}", number.of(&c.drive) * unit)
            };
            if coordinates.iter().any(|c| number.of(&c.drive) != number.usual()) {
                let values = coordinates.iter().map(value).collect();
                entries.push(format!("{} = {}", number.key(), one_or_all(values)));
            }
        }
        entries
    }

    /// A limit of how a joint is driven, in the file's units.
    pub fn drive_limit(self, limit: DriveLimit, value: f64, quantity: Quantity) -> String {
        match limit.has_units_of_file() {
            true => self.number(value, quantity),
            false => self.digits.of(value, DECIMALS),
        }
    }

    fn point(self, point: Point3<f64>) -> String {
        let [x, y, z] = point.coords.map(|c| self.number(c, Quantity::Length)).into();
        format!("[{x}, {y}, {z}]")
    }

    fn direction(self, axis: &Vector3<f64>) -> String {
        let [x, y, z] = axis.map(|c| self.digits.of(c, UNIT_DECIMALS)).into();
        format!("[{x}, {y}, {z}]")
    }

    /// A length or an angle in the file's units.
    fn number(self, value: f64, quantity: Quantity) -> String {
        self.digits.of(self.units.number_of(value, quantity), DECIMALS)
    }
}

impl Digits {
    fn of(self, value: f64, decimals: usize) -> String {
        if self == Self::All {
            return format!("{value:?}");
        }
        let text = format!("{value:.decimals$}");
        let short = text.trim_end_matches('0').trim_end_matches('.');
        if short == "-0" { "0".into() } else { short.into() }
    }
}

pub(in crate::mechanism) fn quoted(name: &str) -> String {
    let escaped = name.chars().map(|c| match c {
        '\\' | '"' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}
