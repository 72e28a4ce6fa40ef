//! The picture of a workspace: slices of it, and what the imaginary joints do in it.

use super::cloud::JointCloud;
use super::slices::Slices;
use super::source::{Source, Stop};
use super::{PanelName, drawn};
use crate::args::{Output, PlotArgs};
use crate::failure::Failure;
use crate::text::{count, short};
use opm_core::joint::Quantity;
use opm_mcap::workspace::{SLICES_TOPIC, slice_at};
use opm_plot::{Drawing, Heading, TileFigure};
use opm_workspace::{Axis, Grid};

/// What a recorded workspace is made of.
pub struct Layout {
    /// What can be known of a point: task coordinates, stored values.
    pub coordinates: Vec<Coordinate>,
    /// Names of task coordinates of which a point's value is not stored.
    pub lost: Vec<String>,
    /// What x, y and z of the cloud are, by their numbers among the coordinates.
    pub axes: Vec<usize>,
    /// Names of the values stored with every point.
    pub scalars: Vec<String>,
    /// What the recording's colours show.
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
    /// Its values on the grid, SI; `None` of the platform's point, which is on no grid.
    pub axis: Option<Axis>,
    pub place: Place,
}

/// Where the value of a point's coordinate is found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a field of the cloud.
    Field(String),
    /// In the number of the slice, divided by this.
    Slice(u64),
}

pub fn draw(source: &Source<'_>, args: &PlotArgs, output: &Output) -> Result<Drawing, Failure> {
    let asked = |panel: PanelName| args.panels.contains(&panel);
    for panel in &args.panels {
        if !matches!(panel, PanelName::Slices | PanelName::Imaginary) {
            let problem = format!("{} are of a motion, not of a workspace", panel.name());
            return Err(Failure::flag("--panels", problem));
        }
    }
    let points = source.recording.topic(SLICES_TOPIC).and_then(|topic| topic.points);
    if points.unwrap_or(0) == 0 {
        let label = &source.label;
        return Err(Failure::Work(format!(
            "{label}: nothing to draw: no pose of the grid is reachable"
        )));
    }
    let layout = Layout::new(source);
    let (view, joints) = chosen(&layout, source, args)?;
    let mut slices = match args.panels.is_empty() || asked(PanelName::Slices) {
        true => Some(Slices::new(&layout, source, args, view)?),
        false => None,
    };
    let mut cloud = JointCloud::new(source, &joints);
    if cloud.is_none() && (args.panels.is_empty() || asked(PanelName::Imaginary)) {
        let hint = missing(source);
        if asked(PanelName::Imaginary) && slices.is_none() {
            return Err(Failure::Work(format!("{}: {hint}", source.label)));
        }
        output.note(format_args!("{}: {hint}", source.label));
    }
    if !args.panels.is_empty() && !asked(PanelName::Imaginary) {
        cloud = None;
    }

    source.messages(|message| {
        if message.topic != SLICES_TOPIC {
            return Ok::<(), Stop>(());
        }
        let (Some(found), Some(slice)) = (message.cloud()?, slice_at(message.time)) else {
            return Ok(());
        };
        if let Some(slices) = &mut slices {
            slices.add(&found, slice);
        }
        if let Some(cloud) = &mut cloud {
            cloud.add(&found);
        }
        Ok(())
    })?;

    let mut heading = heading(source, &layout);
    let mut sections = vec![];
    if let Some(slices) = slices {
        heading.notes.extend(slices.notes());
        sections.push(slices.section(source));
    }
    if let Some(cloud) = cloud {
        heading.notes.extend(cloud.notes());
        sections.push(cloud.section());
    }
    heading.notes.extend(source.notes());
    let figure = TileFigure { heading, sections };
    drawn(args, |size| figure.draw(size))
}

impl Layout {
    fn new(source: &Source<'_>) -> Self {
        let run = source.metadata("run");
        let clouds = source.metadata("clouds");
        let list = |key: &str| -> Vec<String> {
            let text = clouds.get(key).map_or("", |text| text);
            text.split(',').filter(|name| !name.is_empty()).map(str::to_owned).collect()
        };
        let (names, scalars) = (list("axes"), list("scalars"));
        let field = |name: &str| {
            let axis = names.iter().position(|axis| axis == name);
            let axis = axis.and_then(|i| opm_mcap::cloud::POSITION_FIELDS.get(i));
            let scalar = scalars.iter().find(|scalar| *scalar == name);
            axis.map(|field| (*field).to_owned()).or_else(|| scalar.cloned())
        };
        let axis = |name: &str| axis(name, run.get(&format!("grid.{name}"))?);
        let mut layout = Self {
            coordinates: vec![],
            lost: vec![],
            axes: vec![],
            scalars: scalars.clone(),
            colored: clouds.get("color").cloned(),
            color: None,
        };

        let manipulator = source.manipulator();
        let grid = manipulator.and_then(|manipulator| {
            let axes = manipulator.task_coordinates().iter().map(|c| axis(c.name));
            Grid::new(manipulator, axes.collect::<Option<_>>()?).ok()
        });
        if let (Some(manipulator), Some(grid)) = (manipulator, grid) {
            let together = crate::record::together(&grid);
            let mut product = 1;
            for (i, (c, axis)) in manipulator.task_coordinates().iter().zip(grid.axes()).enumerate()
            {
                // The slices of the first axes of the upper section may have been recorded as one.
                let place = if i < grid.lower() {
                    field(c.name).map(Place::Field)
                } else {
                    let slice = (product >= together).then(|| Place::Slice(product / together));
                    product *= axis.count;
                    slice.or_else(|| field(c.name).map(Place::Field))
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
        // The platform's point; or of an unknown mechanism, the axes as they are called.
        for (i, name) in names.iter().enumerate().take(3) {
            if layout.coordinates.iter().any(|c| c.name == *name) {
                continue;
            }
            let tip = name.starts_with("tip.");
            layout.coordinates.push(Coordinate {
                name: name.clone(),
                quantity: tip.then_some(Quantity::Length),
                home: None,
                axis: axis(name),
                place: Place::Field(opm_mcap::cloud::POSITION_FIELDS[i].to_owned()),
            });
        }
        if names.is_empty() {
            for field in opm_mcap::cloud::POSITION_FIELDS {
                let place = Place::Field(field.to_owned());
                let name = field.to_owned();
                layout.coordinates.push(Coordinate {
                    name,
                    quantity: None,
                    home: None,
                    axis: None,
                    place,
                });
            }
        }
        let shown = if names.is_empty() {
            opm_mcap::cloud::POSITION_FIELDS.map(str::to_owned).into()
        } else {
            names
        };
        layout.axes = shown.iter().filter_map(|name| layout.find(name)).collect();
        let number = |key: &str| clouds.get(key).and_then(|text| text.parse().ok());
        layout.color = clouds
            .get("color")
            .filter(|name| scalars.contains(name))
            .and_then(|name| Some((name.clone(), [number("color_min")?, number("color_max")?])));
        layout
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
    (min <= max && count >= 1.0 && count <= 1e15).then(|| Axis::new(name, min, max, count as u64))
}

/// What `--values` names: two coordinates to see the slices along, and stored values.
fn chosen(
    layout: &Layout,
    source: &Source<'_>,
    args: &PlotArgs,
) -> Result<(Option<[usize; 2]>, Vec<String>), Failure> {
    let wrong = |problem: String| Err(Failure::flag("--values", problem));
    let (mut view, mut joints) = (vec![], vec![]);
    for name in &args.values {
        if view.iter().any(|&i: &usize| layout.coordinates[i].name == *name)
            || joints.contains(name)
        {
            return wrong(format!("{name} is given twice"));
        }
        if let Some(number) = layout.find(name) {
            view.push(number);
        } else if layout.scalars.contains(name) {
            joints.push(name.clone());
        } else {
            let known = [&[layout.names()], &layout.scalars[..]].concat().join(", ");
            return wrong(format!("{name:?} is none of {known}"));
        }
    }
    let view = match view[..] {
        [] => None,
        [a, b] => Some([a, b]),
        _ => {
            let names = layout.names();
            return wrong(format!("two of {names} are seen at a time, not {}", view.len()));
        }
    };
    if joints.is_empty() {
        let imaginary = source.manipulator().map(|m| m.imaginary()).unwrap_or_default();
        let names = imaginary.iter().map(|joint| joint.name.clone());
        joints = names.filter(|name| layout.scalars.contains(name)).collect();
    }
    Ok((view, joints))
}

/// How to record what is not there.
fn missing(source: &Source<'_>) -> String {
    let imaginary = source.manipulator().map(|m| m.imaginary()).unwrap_or_default();
    let names: Vec<&str> = imaginary.iter().map(|joint| &*joint.name).collect();
    match &names[..] {
        [] => "no values of imaginary joints are stored with the points".to_owned(),
        names => format!(
            "without the imaginary joints; to draw them too, record with --scalars {}",
            names.join(",")
        ),
    }
}

fn heading(source: &Source<'_>, layout: &Layout) -> Heading {
    let (run, result) = (source.metadata("run"), source.metadata("result"));
    let mut parts = vec![];
    if let Some(mode) = run.get("mode").filter(|mode| !mode.is_empty()) {
        parts.push(format!("mode {mode}"));
    }
    let number = |text: Option<&String>| text.and_then(|text| text.parse::<u64>().ok());
    match (number(result.get("reachable")), number(run.get("poses"))) {
        (Some(reachable), Some(poses)) if poses > 0 => {
            let share = value_label(100.0 * reachable as f64 / poses as f64);
            let (reachable, poses) = (count(reachable), count(poses));
            parts.push(format!("{reachable} of {poses} poses reachable ({share} %)"));
        }
        _ => {
            let points = source.recording.topic(SLICES_TOPIC).and_then(|topic| topic.points);
            parts.push(format!("{} poses", count(points.unwrap_or(0))));
        }
    }
    let mut lines = vec![format!("{}; {}", parts.join(", "), source.units_line())];
    let grid: Vec<String> = layout
        .coordinates
        .iter()
        .filter_map(|c| Some(range(source, c, c.axis.as_ref()?)))
        .collect();
    if !grid.is_empty() {
        lines.push(format!("grid (values): {}", grid.join(", ")));
    }
    let mut title = source.title();
    title.push_str(": workspace");
    Heading { title, lines, notes: vec![] }
}

/// A grid axis as the heading tells it.
fn range(source: &Source<'_>, coordinate: &Coordinate, axis: &Axis) -> String {
    let (measure, factor) =
        source.measure(&axis.name, coordinate.quantity, super::source::Rate::Position);
    let [min, max] = [axis.min, axis.max].map(|value| value_label(value / factor));
    let symbol = &measure.unit.symbol;
    match axis.count {
        1 => format!("{} = {min} {symbol}", axis.name),
        count => format!("{} {min} to {max} {symbol} ({count})", axis.name),
    }
}

/// A number to four digits at most, without trailing zeros, with a minus sign.
pub fn value_label(value: f64) -> String {
    let text = short(value);
    let text = match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    text.replace('-', "−")
}
