//! The kinds of workspace, each counted and measured.

use crate::explorer::Explorer;
use crate::problem::Problems;
use crate::request::Coordinates;
use crate::session::Reply;
use crate::units::shown;
use opm_core::Quantity;
use opm_study::text::chain;
use opm_study::{Workspace, WorkspaceKind, WorkspaceRequest};
use opm_workspace::{Axis, Count, Modes, Progress};
use serde::Serialize;
use std::collections::BTreeMap;

/// Values of each orientation coordinate about that of the pose.
const TURNS: u64 = 5;

/// A kind, and why this mechanism has no workspace of it.
#[derive(Serialize)]
struct KindAnswer {
    name: &'static str,
    description: &'static str,
    /// Whether orientations about that of the pose can be asked for.
    turns: bool,
    refused: Option<String>,
}

/// A workspace of one kind.
#[derive(Serialize)]
struct Counted {
    points: u64,
    members: u64,
    /// The names of the points, and the adjective of those that belong to the set.
    point_name: &'static str,
    member_name: &'static str,
    measure: Option<f64>,
    unit: String,
    /// The coordinates of the points that have several values.
    varying: Vec<String>,
    /// The coordinates along which it goes beyond the grid.
    unbounded: Vec<String>,
    /// The boundary where two coordinates vary, as closed polylines of both values.
    rings: Vec<Vec<f64>>,
    /// What the command counts in the same way.
    options: Vec<String>,
}

/// The grids that were fitted, by kind and working mode.
pub type Grids = BTreeMap<(&'static str, String), Fitted>;

/// A fitted grid.
#[derive(Clone, Debug)]
pub struct Fitted {
    axes: Vec<Axis>,
    /// The coordinates along which the workspace goes beyond it.
    unbounded: Vec<String>,
}

/// All kinds.
pub fn kinds(explorer: &Explorer) -> Reply {
    // A page has no list of aspects; the command has.
    let shown = WorkspaceKind::ALL.into_iter().filter(|kind| *kind != WorkspaceKind::Aspects);
    let list = shown.map(|kind| {
        let checked = WorkspaceRequest::new(kind).check(explorer.manipulator().clone());
        KindAnswer {
            name: kind.name(),
            description: kind.description(),
            turns: kind.is_of_places(),
            refused: checked.err().map(|error| chain(&error)),
        }
    });
    Reply::new(&list.collect::<Vec<_>>())
}

/// Counts and measures a workspace of one kind. What is held is that of the pose, and with `turn` the orientations are
/// those within this much of the pose's.
pub fn count(
    explorer: &Explorer,
    grids: &mut Grids,
    name: &str,
    pose: &Coordinates,
    mode: Option<&str>,
    turn: Option<f64>,
) -> Result<Reply, Problems> {
    let kind: WorkspaceKind = name.parse().map_err(|error| Problems::of(&error))?;
    let mode = explorer.mode(mode)?;
    let resolve = |axes: Vec<Axis>| {
        let mut request = WorkspaceRequest::new(kind).modes(Modes::One(mode));
        request.axes = axes;
        let resolved = request.resolve(explorer.manipulator().clone(), &Progress::default());
        resolved.map_err(|error| Problems::of(&error))
    };
    let key = (kind.name(), explorer.manipulator().format_mode(mode));
    let Fitted { axes, unbounded } = match grids.get(&key) {
        Some(fitted) => fitted.clone(),
        None => {
            let found = resolve(vec![])?;
            let unbounded = found.unbounded().unwrap_or_default().to_vec();
            let fitted = Fitted { axes: found.grid().axes().to_vec(), unbounded };
            grids.insert(key, fitted.clone());
            fitted
        }
    };
    let workspace = resolve(about(explorer, &resolve(axes)?, pose, turn)?)?;
    let analysis = workspace.analyse(&Progress::default()).map_err(|error| Problems::of(&error))?;
    let Count { poses: points, reachable: members, .. } = analysis.count;
    let (grid, units) = (workspace.grid(), explorer.units());
    let several = kind.axes(grid).filter(|&i| grid.axes()[i].count > 1);
    let several: Vec<usize> = several.collect();
    let factor = |i: usize| units.factor(grid.coordinates()[several[i]].quantity);
    let outlines = if several.len() == 2 { analysis.boundary() } else { None };
    let rings = outlines.into_iter().flatten().flat_map(|outline| &outline.rings);
    let rings = rings.map(|ring| {
        ring.points.iter().flat_map(|&[a, b]| [a / factor(0), b / factor(1)]).collect()
    });
    let rings = rings.collect();
    let varying: Vec<String> = several.iter().map(|&i| grid.axes()[i].name.clone()).collect();
    let swept = |name: &String| grid.axes().iter().any(|a| a.name == *name && a.count > 1);
    let measure = workspace.measure(kind, &analysis.count, units);
    let counted = Counted {
        points,
        members,
        point_name: kind.point_name(),
        member_name: kind.member_name(),
        unit: measure.as_ref().map_or_else(String::new, |measure| measure.unit.clone()),
        measure: measure.map(|measure| measure.value),
        varying,
        unbounded: unbounded.into_iter().filter(swept).collect(),
        rings,
        options: options(explorer, &workspace),
    };
    Ok(Reply::new(&counted))
}

/// The axes of a fitted grid, in numbers as they are shown, with held values and orientations about those of the pose.
fn about(
    explorer: &Explorer,
    fitted: &Workspace,
    pose: &Coordinates,
    turn: Option<f64>,
) -> Result<Vec<Axis>, Problems> {
    let (grid, kind, units) = (fitted.grid(), fitted.kind(), explorer.units());
    let at = explorer.pose(pose)?;
    let coordinates = explorer.manipulator().task_coordinates();
    let (held, turned) = (kind.held_axes(grid), grid.orientations());
    let axis = |(i, axis): (usize, &Axis)| {
        let quantity = grid.coordinates()[i].quantity;
        let as_shown = |value: f64| units.si(shown(value, quantity, units), quantity);
        let now = coordinates.iter().position(|c| c.name == axis.name).map(|number| at[number]);
        match (now, turn) {
            (Some(now), _) if held.contains(&i) => Axis::fixed(&*axis.name, as_shown(now)),
            (Some(now), Some(turn)) if kind.is_of_places() && turned.contains(&i) => {
                let turn = units.si(turn.abs(), quantity);
                match turn > 0.0 {
                    true => {
                        let (low, high) = (as_shown(now - turn), as_shown(now + turn));
                        Axis::new(&*axis.name, low, high, TURNS)
                    }
                    false => Axis::fixed(&*axis.name, as_shown(now)),
                }
            }
            _ => Axis::new(&*axis.name, as_shown(axis.min), as_shown(axis.max), axis.count),
        }
    };
    Ok(grid.axes().iter().enumerate().map(axis).collect())
}

/// The options with which the command counts the same: the kind, each axis and the mode.
fn options(explorer: &Explorer, workspace: &Workspace) -> Vec<String> {
    let (grid, units) = (workspace.grid(), explorer.units());
    let mut options = vec!["--kind".to_owned(), workspace.kind().name().to_owned()];
    for (axis, coordinate) in grid.axes().iter().zip(grid.coordinates()) {
        let number = |value: f64| {
            let unit = match coordinate.quantity {
                Quantity::Length => units.length.symbol(),
                Quantity::Angle => units.angle.symbol(),
            };
            format!("{}{unit}", shown(value, coordinate.quantity, units))
        };
        let Axis { name, min, max, count } = axis;
        let range = match count {
            1 => format!("{name}={}", number(*min)),
            _ => format!("{name}={}:{}:{count}", number(*min), number(*max)),
        };
        options.extend(["--grid".to_owned(), range]);
    }
    options.extend(["--mode".to_owned(), workspace.mode_name()]);
    options
}
