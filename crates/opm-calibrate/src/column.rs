//! What a measurement measures: the columns of a table.
//!
//! | column | what it is |
//! |---|---|
//! | a task coordinate, or a dependent one: `x`, `xi` | the coordinate of the platform |
//! | an actuated joint coordinate: `S1` | what its encoder shows |
//! | `point.x`, `point.y`, `point.z` | the place of the platform's reference point, base coordinates |
//! | `distance.NAME` | the distance of the reference point from a given point of the base |
//! | `incline.x`, `incline.y` | the angle by which an axis of the platform's frame rises above the plane of the base's x and y: what a level on the platform shows |

use nalgebra::{Isometry3, Point3, RowVector6, Vector3};
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Solution};

/// What the values of a column are.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Whether they are lengths or angles.
    pub quantity: Quantity,
    pub(crate) kind: ColumnKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ColumnKind {
    /// The task coordinate with this number.
    Coordinate(usize),
    /// The dependent coordinate with this number.
    Dependent(usize),
    /// The joint coordinate with this number.
    Joint(usize),
    /// A coordinate of the platform's reference point.
    Point(usize),
    /// The distance of that point from one of the base.
    Distance(Point3<f64>),
    /// The rise of the platform's first or second axis.
    Incline(usize),
}

/// A point of the base, from which distances are measured.
#[derive(Clone, Debug, PartialEq)]
pub struct BasePoint {
    /// Its name, as in `distance.NAME`.
    pub name: String,
    /// Where it is, metres.
    pub at: Point3<f64>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Column {
    /// The column with this name.
    ///
    /// # Errors
    /// What is wrong with the name.
    pub fn named(
        name: &str,
        manipulator: &Manipulator,
        points: &[BasePoint],
    ) -> Result<Self, String> {
        let column = |quantity, kind| Ok(Self { name: name.to_owned(), quantity, kind });
        let coordinates = manipulator.task_coordinates();
        if let Some(number) = coordinates.iter().position(|c| c.name == name) {
            return column(coordinates[number].quantity, ColumnKind::Coordinate(number));
        }
        let dependent = manipulator.dependent_coordinates();
        if let Some(number) = dependent.iter().position(|c| c.name == name) {
            return column(dependent[number].quantity, ColumnKind::Dependent(number));
        }
        let joints = manipulator.coordinates();
        if let Some(number) = joints.iter().position(|c| c.name == name) {
            if !manipulator.actuated().contains(&number) {
                return Err(format!("{name} is a passive joint, expected an actuated one"));
            }
            return column(joints[number].quantity, ColumnKind::Joint(number));
        }
        let (what, of) = name.split_once('.').unwrap_or((name, ""));
        let axis = AXES.iter().position(|axis| *axis == of);
        match (what, axis) {
            ("point", Some(axis)) => column(Quantity::Length, ColumnKind::Point(axis)),
            ("incline", Some(axis @ (0 | 1))) => column(Quantity::Angle, ColumnKind::Incline(axis)),
            ("distance", _) => match points.iter().find(|point| point.name == of) {
                Some(point) => column(Quantity::Length, ColumnKind::Distance(point.at)),
                None => {
                    let known = points.iter().map(|point| &*point.name).collect::<Vec<_>>();
                    let known = if known.is_empty() {
                        "none is given".to_owned()
                    } else {
                        format!("known: {}", known.join(", "))
                    };
                    Err(format!("there is no point {of:?} to measure distances from; {known}"))
                }
            },
            _ => {
                let names: Vec<&str> =
                    coordinates.iter().chain(dependent).map(|c| c.name).collect();
                let actuated = manipulator.actuated().iter().map(|&number| &*joints[number].name);
                Err(format!(
                    "{name:?} is not measured here; expected {}, {}, point.x, point.y, point.z, distance.NAME, incline.x or \
                     incline.y",
                    names.join(", "),
                    actuated.collect::<Vec<_>>().join(", ")
                ))
            }
        }
    }

    /// The columns of a whole measurement: every task coordinate, then every actuated joint.
    pub fn all(manipulator: &Manipulator) -> Vec<Self> {
        let coordinates = manipulator.task_coordinates().iter().map(|c| c.name);
        let joints = manipulator.coordinates();
        let joints = manipulator.actuated().iter().map(|&number| &*joints[number].name);
        let named = coordinates.chain(joints).map(|name| Self::named(name, manipulator, &[]));
        named.filter_map(Result::ok).collect()
    }

    /// Its value at home.
    pub fn home(&self, manipulator: &Manipulator) -> f64 {
        let platform = manipulator.mechanism().platform;
        match self.kind {
            ColumnKind::Coordinate(number) => manipulator.task_coordinates()[number].home,
            ColumnKind::Dependent(number) => manipulator.dependent_coordinates()[number].home,
            ColumnKind::Joint(number) => manipulator.coordinates()[number].home,
            ColumnKind::Point(axis) => platform[axis],
            ColumnKind::Distance(from) => (platform - from).norm(),
            ColumnKind::Incline(_) => 0.0,
        }
    }

    /// Whether it is the value of a joint.
    pub fn is_joint(&self) -> bool {
        matches!(self.kind, ColumnKind::Joint(_))
    }

    /// The value at a solved pose.
    pub(crate) fn value(&self, at: &Solution, body: &Body) -> f64 {
        match self.kind {
            ColumnKind::Coordinate(number) => at.pose()[number],
            ColumnKind::Dependent(number) => at.dependent()[number],
            ColumnKind::Joint(number) => at.joints()[number],
            ColumnKind::Point(axis) => body.point[axis],
            ColumnKind::Distance(from) => (body.point - from).norm(),
            ColumnKind::Incline(axis) => body.axes[axis].z.clamp(-1.0, 1.0).asin(),
        }
    }

    /// The derivative by the platform's twist: its rotation, and the displacement of its reference point. `None` for what is
    /// not a matter of the platform's place alone.
    pub(crate) fn by_twist(&self, body: &Body) -> Option<RowVector6<f64>> {
        let row = |rotation: Vector3<f64>, way: Vector3<f64>| {
            RowVector6::from_fn(|_, i| if i < 3 { rotation[i] } else { way[i - 3] })
        };
        Some(match self.kind {
            ColumnKind::Coordinate(_) | ColumnKind::Dependent(_) | ColumnKind::Joint(_) => {
                return None;
            }
            ColumnKind::Point(axis) => row(Vector3::zeros(), Vector3::ith(axis, 1.0)),
            ColumnKind::Distance(from) => {
                let way = body.point - from;
                row(Vector3::zeros(), way.try_normalize(0.0).unwrap_or_default())
            }
            ColumnKind::Incline(axis) => {
                let axis = body.axes[axis];
                row(axis.cross(&Vector3::z()) / axis.xy().norm(), Vector3::zeros())
            }
        })
    }
}

/// The place of the platform.
pub(crate) struct Body {
    /// Its reference point.
    pub point: Point3<f64>,
    /// The first two axes of its frame.
    pub axes: [Vector3<f64>; 2],
}

impl Body {
    pub fn new(manipulator: &Manipulator, displacement: &Isometry3<f64>) -> Self {
        let place = manipulator.platform_at(displacement);
        let point = place * Point3::origin();
        Self { point, axes: [Vector3::x(), Vector3::y()].map(|axis| place.rotation * axis) }
    }
}
