//! Tables of workspaces: of a mechanism with several values of a number, or in every working mode.

use super::{Work, inscribed, request, threads};
use crate::args::{Output, WorkspaceArgs};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::GridAxis;
use crate::progress::interruptible;
use crate::runs::{self, Cell, Runs};
use crate::text::{count, short};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_study::{Shape, WorkspaceKind, WorkspaceRequest};
use opm_workspace::{Modes, Shard};
use serde_json::{Value, json};
use std::sync::Arc;

/// The workspace for each value of a number of the mechanism file.
pub fn vary(
    args: &WorkspaceArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    let silent = output.silent();
    let work = Work { output: &silent, pool: &pool, progress: &progress };
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = Arc::new(changed.compile()?);
        let request = request(args, &manipulator)?;
        cells(args, request, manipulator, &work, loaded.file.units)
    })
}

/// The workspace in every working mode, on the same grid.
pub fn all_modes(args: &WorkspaceArgs, loaded: &Loaded, output: &Output) -> Result<(), Failure> {
    let manipulator = Arc::new(loaded.compile()?);
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    let mut whole = request(args, &manipulator)?;
    whole.modes = Some(Modes::Any);
    let work = Work { output, pool: &pool, progress: &progress };
    if whole.axes.is_empty() && args.kind == WorkspaceKind::Aspects {
        let problem = "with --kind aspects: the modes need a grid in common; give it, with --grid";
        return Err(Failure::flag("--all-modes", problem));
    }
    let axes = match whole.axes.is_empty() {
        false => whole.axes.clone(),
        true => {
            let mut fitted = whole.clone();
            fitted.conditioning = false;
            let fitted = work.fit(fitted.check(Arc::clone(&manipulator))?, loaded.file.units)?;
            fitted.grid().axes().to_vec()
        }
    };
    let silent = output.silent();
    let work = Work { output: &silent, pool: &pool, progress: &progress };
    let mut runs = Runs::new("mode", "mode");
    for mode in manipulator.modes() {
        let mut request = whole.clone();
        (request.modes, request.axes) = (Some(Modes::One(mode)), axes.clone());
        let found = cells(args, request, Arc::clone(&manipulator), &work, loaded.file.units);
        let name = manipulator.format_mode(mode);
        let home = if mode == manipulator.home_mode() { " (home)" } else { "" };
        runs.add(name.clone(), format!("{name}{home}"), found)?;
    }
    let grid: serde_json::Map<String, Value> = (axes.iter())
        .map(|a| (a.name.clone(), json!({ "min": a.min, "max": a.max, "count": a.count })))
        .collect();
    let more = json!({ "kind": args.kind.name(), "grid": grid });
    runs.print(output, &manipulator.mechanism().name, more)
}

/// The results of one workspace.
fn cells(
    args: &WorkspaceArgs,
    request: WorkspaceRequest,
    manipulator: Arc<Manipulator>,
    work: &Work<'_>,
    units: FileUnits,
) -> Result<Vec<Cell>, Failure> {
    let request = request.check(manipulator)?;
    request.refuse_unused_length()?;
    let workspace = work.fit(request, units)?;
    let (found, _) = work.count(&workspace, Shard::WHOLE)?;
    let analysis = work.analyse(&workspace, found, &workspace.poses())?;
    let (kind, points) = (workspace.kind(), &analysis.count);
    let share = analysis.fraction();
    let mut cells = vec![
        Cell {
            header: kind.point_name().to_owned(),
            ..Cell::new("poses", points.poses, count(points.poses))
        },
        Cell {
            header: kind.member_name().to_owned(),
            ..Cell::new("reachable", points.reachable, count(points.reachable))
        },
        Cell {
            header: "share [%]".to_owned(),
            ..Cell::new("fraction", share, share.map_or("-".to_owned(), |s| short(100.0 * s)))
        },
    ];
    if let (Some(si), Some(shown)) =
        (workspace.measure(kind, points, FileUnits::SI), workspace.measure(kind, points, units))
    {
        let header = format!("size [{}]", shown.unit);
        cells.push(Cell { header, ..Cell::new("measure", si.value, short(shown.value)) });
    }
    if let Some(Shape { components, .. }) = &analysis.shape {
        let number = components.len() as u64;
        let name = if kind == WorkspaceKind::Aspects { "aspects" } else { "components" };
        cells.push(Cell::new(name, number, count(number)));
    }
    if let Some(index) = &analysis.conditioning {
        let global = index.global();
        let shown = global.map_or("-".to_owned(), short);
        let header = "conditioning".to_owned();
        cells.push(Cell { header, ..Cell::new("conditioning", global, shown) });
    }
    if let Some(found) = inscribed::find(args, &workspace, &analysis)? {
        cells.push(found.cell(units));
    }
    Ok(cells)
}
