//! The layout of the points of a recorded workspace.

use super::grid::{is_home, nearest};
use super::source::Source;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_mcap::cloud::POSITION_FIELDS;
use opm_mcap::workspace::BOUNDARY_TOPIC;
use opm_study::recording::slices_together;
use opm_study::{NO_AXIS, WorkspaceKind};
use opm_workspace::{Axis, Grid};

/// The layout of a recorded workspace.
pub struct Layout {
    /// The kind of the workspace.
    pub kind: WorkspaceKind,
    /// Whether the recording has the boundary.
    pub bounded: bool,
    /// The available values of a point: task coordinates and stored values.
    pub coordinates: Vec<Coordinate>,
    /// The whole grid, in the order of the task coordinates.
    pub grid: Vec<(Quantity, Axis)>,
    /// Whether home is on that grid, to within half a step.
    pub has_home: bool,
    /// Names of task coordinates whose values are not stored with the points.
    pub lost: Vec<String>,
    /// The coordinates that are x, y and z of the cloud, by index.
    pub axes: Vec<usize>,
    /// Names of the values stored with every point.
    pub scalars: Vec<String>,
    /// The value that the recording's colours show.
    pub colored: Option<String>,
    /// The same, if it is stored with the points, and its values at the ends of the colours.
    pub color: Option<(String, [f64; 2])>,
}

/// One coordinate of the points.
pub struct Coordinate {
    pub name: String,
    pub quantity: Option<Quantity>,
    /// SI.
    pub home: Option<f64>,
    /// Its values on the grid, SI; `None` for the reference point of the platform, which is not on a grid.
    pub axis: Option<Axis>,
    pub place: ValueSource,
}

/// The source of the value of a point's coordinate.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueSource {
    /// A field of the cloud, whose values were multiplied by this.
    Field(String, f64),
    /// The number of the slice, divided by this.
    Slice(u64),
}

impl Layout {
    pub fn new(source: &Source<'_>) -> Self {
        let run = source.metadata("run");
        let clouds = source.metadata("clouds");
        let list = |key: &str| -> Vec<String> {
            let text = clouds.get(key).map_or("", |text| text);
            text.split(',').filter(|name| !name.is_empty()).map(str::to_owned).collect()
        };
        let scalars = list("scalars");
        let names = match list("axes") {
            none if none.is_empty() => POSITION_FIELDS.map(str::to_owned).into(),
            names => names,
        };
        let factors: Vec<f64> = list("scale").iter().filter_map(|text| text.parse().ok()).collect();
        let factor = |i: usize| factors.get(i).copied().filter(|f| *f > 0.0).unwrap_or(1.0);
        let field = |name: &str| {
            let axis = names.iter().position(|axis| axis == name);
            let axis = axis.and_then(|i| Some((*POSITION_FIELDS.get(i)?, factor(i))));
            let scalar = scalars.iter().find(|scalar| *scalar == name);
            let scalar = scalar.map(|scalar| (&**scalar, 1.0));
            axis.or(scalar).map(|(field, factor)| ValueSource::Field(field.to_owned(), factor))
        };
        let axis = |name: &str| axis(name, run.get(&format!("grid.{name}"))?);
        let mut layout = Self {
            kind: run.get("kind").and_then(|name| name.parse().ok()).unwrap_or_default(),
            bounded: source.recording.topic(BOUNDARY_TOPIC).is_some(),
            coordinates: vec![],
            grid: vec![],
            has_home: true,
            lost: vec![],
            axes: vec![],
            scalars: scalars.clone(),
            colored: clouds.get("color").cloned(),
            color: None,
        };

        let manipulator = source.manipulator();
        if let (Some(manipulator), Some(names)) = (manipulator, run.get("set")) {
            layout.add_set(manipulator, names.split(','), axis, field);
        }
        let grid = manipulator.filter(|_| layout.kind.is_of_poses()).and_then(|manipulator| {
            let axes = manipulator.task_coordinates().iter().map(|c| axis(c.name));
            Grid::new(manipulator, axes.collect::<Option<_>>()?).ok()
        });
        if let (Some(manipulator), Some(grid)) = (manipulator, grid) {
            let together = slices_together(&grid);
            let mut product = 1;
            for (i, (c, axis)) in manipulator.task_coordinates().iter().zip(grid.axes()).enumerate()
            {
                layout.add_axis(c.quantity, axis, c.home);
                // The slices of the first axes of the upper section may have been recorded as one.
                let place = if i < grid.lower() {
                    field(c.name)
                } else {
                    let slice =
                        (product >= together).then(|| ValueSource::Slice(product / together));
                    product *= axis.count;
                    slice.or_else(|| field(c.name))
                };
                let Some(place) = place else {
                    if axis.count > 1 {
                        layout.lost.push(c.name.to_owned());
                    }
                    continue;
                };
                layout.coordinates.push(Coordinate {
                    name: c.name.to_owned(),
                    quantity: Some(c.quantity),
                    home: Some(c.home),
                    axis: Some(axis.clone()),
                    place,
                });
            }
        }
        // The axes are the platform's reference point; for an unknown mechanism, they keep their names.
        let shown = names.iter().zip(POSITION_FIELDS).enumerate();
        for (i, (name, field)) in shown.filter(|(_, (name, _))| *name != NO_AXIS) {
            if layout.find(name).is_none() {
                layout.coordinates.push(Coordinate {
                    name: name.clone(),
                    quantity: match name.starts_with("tip.") {
                        true => Some(Quantity::Length),
                        false => source.joint_quantity(name),
                    },
                    home: None,
                    axis: axis(name),
                    place: ValueSource::Field(field.to_owned(), factor(i)),
                });
            }
        }
        layout.axes = names.iter().filter_map(|name| layout.find(name)).collect();
        let number = |key: &str| clouds.get(key).and_then(|text| text.parse().ok());
        layout.color = clouds
            .get("color")
            .filter(|name| scalars.contains(name))
            .and_then(|name| Some((name.clone(), [number("color_min")?, number("color_max")?])));
        layout
    }

    /// Takes the axes of a set whose points are not poses.
    fn add_set<'a>(
        &mut self,
        manipulator: &Manipulator,
        names: impl Iterator<Item = &'a str>,
        axis: impl Fn(&str) -> Option<Axis>,
        place: impl Fn(&str) -> Option<ValueSource>,
    ) {
        let known = self.kind.sections().coordinates(manipulator);
        for c in &known {
            if let Some(axis) = axis(&c.name) {
                self.add_axis(c.quantity, &axis, c.home);
            }
        }
        for name in names {
            let (Some(c), Some(axis)) = (known.iter().find(|c| c.name == name), axis(name)) else {
                continue;
            };
            match place(name) {
                Some(place) => self.coordinates.push(Coordinate {
                    name: name.to_owned(),
                    quantity: Some(c.quantity),
                    home: Some(c.home),
                    axis: Some(axis),
                    place,
                }),
                None if axis.count > 1 => self.lost.push(name.to_owned()),
                None => {}
            }
        }
    }

    fn add_axis(&mut self, quantity: Quantity, axis: &Axis, home: f64) {
        self.has_home &= is_home(axis, home, nearest(axis, home));
        self.grid.push((quantity, axis.clone()));
    }

    pub fn find(&self, name: &str) -> Option<usize> {
        self.coordinates.iter().position(|c| c.name == name)
    }

    pub fn names(&self) -> String {
        self.coordinates.iter().map(|c| &*c.name).collect::<Vec<_>>().join(", ")
    }
}

/// A grid axis from the metadata: its ends and the number of its values.
fn axis(name: &str, text: &str) -> Option<Axis> {
    let mut parts = text.split(':');
    let mut number = || parts.next()?.parse::<f64>().ok().filter(|number| number.is_finite());
    let (min, max, count) = (number()?, number()?, number()?);
    (min <= max && (1.0..=1e15).contains(&count)).then(|| Axis::new(name, min, max, count as u64))
}
