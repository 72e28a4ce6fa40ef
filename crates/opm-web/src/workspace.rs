//! Workspaces: plane slices, and the whole on a fitted grid.

use crate::explorer::Explorer;
use crate::problem::{Problem, Problems};
use crate::request::{AxisRequest, Coordinates};
use crate::session::Reply;
use crate::units::{shown, shown_range};
use opm_core::Quantity;
use opm_study::{Workspace, WorkspaceKind, WorkspaceRequest};
use opm_workspace::{Axis, Count, GridSet, Modes, Progress, boundary, default_grid};
use serde::Serialize;

/// Most points of a slice: more than a screen has.
const MOST_POINTS: u64 = 1 << 24;

/// The answer to a fit.
#[derive(Serialize)]
struct Fitted {
    axes: Vec<FittedAxis>,
    poses: u64,
}

/// The range of a task coordinate that holds the workspace.
#[derive(Serialize)]
struct FittedAxis {
    name: String,
    min: f64,
    max: f64,
    count: u64,
    unbounded: bool,
}

/// The count of a whole workspace.
#[derive(Serialize)]
struct Whole {
    poses: u64,
    reachable: u64,
    measure: f64,
    unit: String,
    /// The lowest and highest value of each imaginary joint over the reachable poses.
    imaginary: Vec<Option<[f64; 2]>>,
}

/// The answer to a slice. The bytes have a 1 for each reachable pose, row by row from the lowest value of y on.
#[derive(Serialize)]
struct Slice {
    poses: u64,
    reachable: u64,
    measure: f64,
    unit: String,
    imaginary: Vec<Option<[f64; 2]>>,
    /// The boundary as closed polylines: x and y of one corner after the other.
    rings: Vec<Vec<f64>>,
}

/// Fits a grid to the workspace in a mode.
pub fn fit(explorer: &Explorer, mode: Option<&str>) -> Result<(Reply, Vec<Axis>), Problems> {
    let (manipulator, units) = (explorer.manipulator(), explorer.units());
    let modes = Modes::One(explorer.mode(mode)?);
    let (grid, extents) = default_grid(manipulator, modes, &Progress::default())
        .map_err(|error| Problems::of(&error))?;
    let axes = grid.axes().iter().zip(grid.coordinates()).zip(extents);
    let axes = axes.map(|((axis, c), extent)| FittedAxis {
        name: axis.name.clone(),
        min: shown(axis.min, c.quantity, units),
        max: shown(axis.max, c.quantity, units),
        count: axis.count,
        unbounded: extent.unbounded,
    });
    let fitted = Fitted { axes: axes.collect(), poses: grid.poses() };
    Ok((Reply::new(&fitted), grid.axes().to_vec()))
}

/// Counts the reachable poses of a fitted grid.
pub fn whole(explorer: &Explorer, fitted: &[Axis], mode: Option<&str>) -> Result<Reply, Problems> {
    if fitted.is_empty() {
        return Err(Problems::one("no grid was fitted"));
    }
    let workspace = grid(explorer, fitted.to_vec(), mode)?;
    let count =
        workspace.sweep().count(&Progress::default()).map_err(|error| Problems::of(&error))?;
    let (measure, unit) = measure(explorer, &workspace, &count);
    let imaginary = imaginary(explorer, &count);
    let Count { poses, reachable, .. } = count;
    Ok(Reply::new(&Whole { poses, reachable, measure, unit, imaginary }))
}

/// The reachable poses of a plane grid.
pub fn slice(
    explorer: &Explorer,
    axes: [&AxisRequest; 2],
    pose: &Coordinates,
    mode: Option<&str>,
) -> Result<Reply, Problems> {
    let plane = Plane::new(explorer, axes, pose, mode)?;
    let (count, poses) = plane
        .workspace
        .count_and_keep(&Progress::default())
        .map_err(|error| Problems::of(&error))?;
    let set = GridSet::reached(&poses, &Progress::default()).map_err(|e| Problems::of(&e))?;
    let mut mask = vec![0_u8; plane.points()];
    set.numbers().for_each(|number| mask[plane.place(number)] = 1);
    let outlines = boundary(&set).unwrap_or_default();
    let rings = outlines.iter().flat_map(|outline| &outline.rings);
    let [x, y] = plane.quantities();
    let ring = rings.map(|ring| {
        let corners = ring.points.iter().map(|&[a, b]| if plane.swapped { [b, a] } else { [a, b] });
        let units = explorer.units();
        corners.flat_map(|[a, b]| [a / units.factor(x), b / units.factor(y)]).collect()
    });
    let rings = ring.collect();
    let (measure, unit) = measure(explorer, &plane.workspace, &count);
    let imaginary = imaginary(explorer, &count);
    let Count { poses, reachable, .. } = count;
    Ok(Reply::with_bytes(&Slice { poses, reachable, measure, unit, imaginary, rings }, mask))
}

/// A plane grid.
pub struct Plane {
    /// Its poses.
    pub workspace: Workspace,
    /// The numbers of values across and upwards.
    counts: [u64; 2],
    /// The numbers of both coordinates among those of the grid.
    coordinates: [usize; 2],
    /// Whether the coordinate upwards comes before that across in the grid.
    swapped: bool,
}

impl Plane {
    /// The grid of two axes, with the other coordinates at a pose.
    pub fn new(
        explorer: &Explorer,
        axes: [&AxisRequest; 2],
        pose: &Coordinates,
        mode: Option<&str>,
    ) -> Result<Self, Problems> {
        let counts = axes.map(|axis| axis.count);
        if counts[0].saturating_mul(counts[1]) > MOST_POINTS {
            let [x, y] = counts;
            let problem = format!("{x} x {y} points, expected at most {MOST_POINTS}");
            return Err(Problems::one(problem));
        }
        let coordinates = explorer.manipulator().task_coordinates();
        let number = |axis: &AxisRequest| coordinates.iter().position(|c| c.name == axis.name);
        let units = explorer.units();
        let unit =
            |axis| number(axis).map_or("", |number| units.symbol(coordinates[number].quantity));
        let wrong = axes.iter().filter_map(|axis| refusal(axis, unit(axis)));
        let wrong: Vec<Problem> = wrong.collect();
        if !wrong.is_empty() {
            return Err(Problems { problems: wrong });
        }
        let given = axes.map(|axis| {
            // An unknown name is for the grid to report.
            let si = |value| match number(axis) {
                Some(number) => units.si(value, coordinates[number].quantity),
                None => value,
            };
            Axis::new(&*axis.name, si(axis.min), si(axis.max), axis.count)
        });
        let held = pose.iter().filter(|(name, _)| axes.iter().all(|axis| axis.name != **name));
        let held = held.map(|(name, &value)| (name.clone(), value)).collect();
        let at = explorer.pose(&held)?;
        let fixed = held.keys().filter_map(|name| {
            let number = coordinates.iter().position(|c| c.name == name)?;
            Some(Axis::fixed(&**name, at[number]))
        });
        let workspace = grid(explorer, given.into_iter().chain(fixed).collect(), mode)?;
        let [Some(x), Some(y)] = axes.map(number) else {
            return Err(Problems::one("an axis is not a task coordinate"));
        };
        Ok(Self { workspace, counts, coordinates: [x, y], swapped: y < x })
    }

    /// The number of its points.
    pub fn points(&self) -> usize {
        let [x, y] = self.counts;
        (x * y) as usize
    }

    /// The place of a pose among the points, row by row.
    pub fn place(&self, number: u64) -> usize {
        let [across, upwards] = self.counts;
        let place = match self.swapped {
            false => number,
            true => number % upwards * across + number / upwards,
        };
        place as usize
    }

    fn quantities(&self) -> [Quantity; 2] {
        self.coordinates.map(|number| self.workspace.grid().coordinates()[number].quantity)
    }
}

/// What is wrong with the numbers of an axis, as they are given.
fn refusal(axis: &AxisRequest, unit: &str) -> Option<Problem> {
    let AxisRequest { name, min, max, count } = axis;
    let expected = match count {
        0 => "expected at least one",
        1 if min != max => "expected at least two, or equal ends",
        2.. if min >= max => "expected the smaller end first",
        _ => return None,
    };
    let values = if *count == 1 { "value" } else { "values" };
    let range = format!("slice along {name}: {count} {values} from {min} to {max} {unit}");
    Some(Problem { message: format!("{}, {expected}", range.trim_end()), ..Problem::default() })
}

/// The workspace over some axes in one mode.
pub fn grid(
    explorer: &Explorer,
    axes: Vec<Axis>,
    mode: Option<&str>,
) -> Result<Workspace, Problems> {
    let mut request = WorkspaceRequest::new(WorkspaceKind::Grid);
    request.axes = axes;
    request.modes = Some(Modes::One(explorer.mode(mode)?));
    let manipulator = explorer.manipulator().clone();
    request.resolve(manipulator, &Progress::default()).map_err(|error| Problems::of(&error))
}

/// The measure of the reachable set, and its unit.
fn measure(explorer: &Explorer, workspace: &Workspace, count: &Count) -> (f64, String) {
    let measure = workspace.measure(WorkspaceKind::Grid, count, explorer.units());
    measure.map_or((0.0, "1".to_owned()), |measure| (measure.value, measure.unit))
}

/// The ranges of the imaginary joints in the file's units.
fn imaginary(explorer: &Explorer, count: &Count) -> Vec<Option<[f64; 2]>> {
    let joints = explorer.manipulator().imaginary().iter().zip(&count.imaginary);
    let range = |quantity, range: [f64; 2]| shown_range(range, quantity, explorer.units());
    joints.map(|(joint, found)| found.map(|found| range(joint.quantity, found))).collect()
}
