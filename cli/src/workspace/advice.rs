//! Notes and warnings about a workspace: options that may be a mistake, and flags that help.

use crate::args::Output;
use crate::pose::flag_value;
use crate::text::count;
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_core::numeric::number::readable;
use opm_study::{Analysis, Workspace, WorkspaceKind};
use opm_workspace::{Axis, Coordinate, Grid, Sections};

/// Prints which grid was fitted, and where the workspace extends beyond it.
pub fn of_fitted(workspace: &Workspace, units: FileUnits, output: &Output) {
    let flags = grid_flags(workspace.grid(), units);
    output.note(format_args!("grid fitted to the workspace: {flags}"));
    for name in workspace.unbounded().unwrap_or_default() {
        output.warn(format_args!(
            "the workspace continues beyond this grid along {name}; limit a joint, or give --grid"
        ));
    }
}

/// Warns of options that may be a mistake, before the sweep.
pub fn before(workspace: &Workspace, output: &Output) {
    let (kind, manipulator) = (workspace.kind(), workspace.manipulator());
    if kind.sections() != Sections::Whole && !manipulator.workspace_factorises() {
        output.note(
            "a leg that is split in its lower section has upper joints that are limited, actuated or \
             sometimes out of reach. Neither section alone tests them, so the whole workspace is \
             smaller than where both sections agree",
        );
    }
    if let Some(warning) = one_orientation(kind, workspace.grid()) {
        output.warn(warning);
    }
}

/// Warns if nothing is in reach.
pub fn after(workspace: &Workspace, analysis: &Analysis, output: &Output) {
    if analysis.count.reachable == 0 {
        let kind = workspace.kind();
        let mut limited = Vec::new();
        if let Some(limit) = workspace.limit() {
            limited.extend(limit.max_condition().map(|_| "condition number"));
            limited.extend(limit.indices.iter().map(|(index, _)| index.name()));
        }
        let nothing = kind.nothing(&limited);
        let apart = match workspace.clearance() {
            Some(_) => " with that clearance",
            None => "",
        };
        let hint = fewer(kind, workspace.grid());
        let hint = hint.map_or_else(String::new, |hint| format!("; {hint}"));
        output.warn(format_args!("{nothing}{apart}{hint}"));
    }
}

/// The warning for a set over orientations that is requested at the home orientation only.
fn one_orientation(kind: WorkspaceKind, grid: &Grid) -> Option<String> {
    let orientation = &grid.axes()[grid.orientations()];
    let none = orientation.is_empty() || kind.required_visits(grid).is_none();
    if none || orientation.iter().any(|axis| axis.count > 1) {
        return None;
    }
    let names: Vec<String> =
        orientation.iter().map(|axis| format!("--grid {}=MIN:MAX:COUNT", axis.name)).collect();
    let names = names.join(", ");
    Some(format!("--kind {kind} has only one orientation here; for more, give {names}"))
}

/// Advice to request fewer orientations if no place is in reach at all of them.
fn fewer(kind: WorkspaceKind, grid: &Grid) -> Option<String> {
    /// Values of a coordinate, and its largest distance from home if it is an angle.
    const VALUES: u64 = 5;
    const HALF: f64 = 20.0;
    let axes = || grid.orientations().map(|i| (&grid.axes()[i], &grid.coordinates()[i]));
    let orientations = grid.orientation_count();
    if kind != WorkspaceKind::Dexterous || orientations == 1 {
        return None;
    }
    // A part of the range, around home if home is in it.
    let flags = axes().filter(|(axis, _)| axis.count > 1).map(|(axis, c)| {
        let (unit, scale, most) = match c.quantity {
            Quantity::Angle => ("deg", 1_f64.to_degrees(), HALF),
            Quantity::Length => ("mm", 1e3, f64::INFINITY),
        };
        let [min, max] = [axis.min, axis.max].map(|end| end * scale);
        let middle = (c.home * scale).clamp(min, max);
        let half = (0.25 * (max - min)).min(most);
        let end = |value: f64| readable((1e2 * value.clamp(min, max)).round() / 1e2 + 0.0);
        let [from, to] = [end(middle - half), end(middle + half)];
        format!("--grid {}={from}{unit}:{to}{unit}:{VALUES}", axis.name)
    });
    let flags: Vec<String> = flags.collect();
    let (number, flags) = (count(orientations), flags.join(" "));
    Some(format!("these are {number} orientations; ask for fewer, for example {flags}"))
}

/// The flags for a grid, in these units.
pub fn grid_flags(grid: &Grid, units: FileUnits) -> String {
    let flag = |(Axis { name, min, max, count }, c): (&Axis, &Coordinate)| {
        let end = |value: &f64| flag_value(*value, c.quantity, units);
        match count {
            1 => format!("--grid {name}={}", end(min)),
            _ => format!("--grid {name}={}:{}:{count}", end(min), end(max)),
        }
    };
    grid.axes().iter().zip(grid.coordinates()).map(flag).collect::<Vec<_>>().join(" ")
}
