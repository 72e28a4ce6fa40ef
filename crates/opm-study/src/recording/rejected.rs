//! The points of a recording that are rejected, coloured by what rejects them.

use super::points::tip;
use crate::columns::{Column, NamedColumn, PointColumns};
use crate::error::StudyError;
use crate::workspace::Workspace;
use opm_core::manipulator::{Manipulator, part_of};
use opm_mcap::rejected::{CAUSE, MAX_CAUSES, SLICE};
use opm_mcap::workspace::MAX_OVERVIEW_POINTS;
use opm_mcap::{CloudLayout, RecordError, RejectedCause, RejectedPoints, WorkspaceRecorder};
use opm_workspace::{Cause, PointsOf, Progress, RejectedPoint, Rejection, Rejections};

/// The colour of points with several causes.
const SEVERAL: [u8; 3] = [0x99; 3];
/// The colours of M. Okabe and K. Ito (jfly.uni-koeln.de/color).
const COLORS: [[u8; 3]; 7] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
    [0xf0, 0xe4, 0x42],
];

/// The colour of a numbered class of points: a cause that rejects them, or the aspect that they are in. Number 0 is
/// for points that are in several classes, or in no class. Numbers 8 to 14 have the colours of 1 to 7, but darker; from 15 on, these 14
/// colours are used again.
pub fn class_color(number: usize) -> [u8; 3] {
    match number.checked_sub(1) {
        None => SEVERAL,
        Some(i) => {
            let dark = i / COLORS.len() % 2 == 1;
            COLORS[i % COLORS.len()].map(|channel| if dark { channel / 2 } else { channel })
        }
    }
}

/// A cause in words, with the name of its leg.
fn words(manipulator: &Manipulator, Rejection { leg, cause, .. }: &Rejection) -> String {
    let name = |joint: usize| &manipulator.coordinates()[joint].name;
    let what = match *cause {
        Cause::Reach(section) => format!("{} out of reach", part_of(section)),
        Cause::Lowest(joint) => format!("{} below its limit", name(joint)),
        Cause::Highest(joint) => format!("{} above its limit", name(joint)),
        Cause::Cone(joint) => format!("{} beyond its cone", name(joint)),
        Cause::Difference(number) => {
            format!("{} beyond its limits", manipulator.differences()[number].name)
        }
    };
    format!("{}: {what}", manipulator.mechanism().legs[*leg].name)
}

/// What is known about the points of a recording, rejected or not.
pub struct Rejected<'a> {
    /// The workspace.
    pub workspace: &'a Workspace,
    /// What rejects its poses.
    pub rejections: &'a Rejections,
    /// The values of the points in the set.
    pub shown: &'a PointColumns,
    /// The layout of these.
    pub layout: &'a CloudLayout,
    /// The number of the points in the set.
    pub held: u64,
}

impl Rejected<'_> {
    /// Records every k-th of the points. `slice` gives the number of the slice that a point is in.
    pub fn record(
        &self,
        recorder: &mut WorkspaceRecorder<'_>,
        slice: impl Fn(&RejectedPoint) -> u64 + Sync,
        progress: &Progress,
        failed: impl Fn(RecordError) -> StudyError + Sync,
    ) -> Result<(), StudyError> {
        let Self { workspace, rejections, shown, layout, held } = *self;
        let Workspace { manipulator, kind, grid, modes, .. } = workspace;
        let set = PointsOf {
            grid,
            axes: kind.axes(grid),
            required: kind.required_visits(grid).unwrap_or(1),
        };
        let each = grid.poses() / set.points().max(1);
        let rejected = set.points().saturating_sub(held);
        let every = rejected.div_ceil(MAX_OVERVIEW_POINTS).max(1);

        let is_known = |named: &&NamedColumn| {
            matches!(named.column, Column::Coordinate(_) | Column::Share | Column::Zero)
        };
        let scalars: Vec<NamedColumn> = shown.scalars.iter().filter(is_known).cloned().collect();
        let names = scalars.iter().map(|named| &*named.name).chain([SLICE, CAUSE]);
        let scalar_names = names.map(str::to_owned).collect();
        let layout =
            CloudLayout { scalars: scalar_names, color: CAUSE.to_owned(), ..layout.clone() };
        let known = rejections.rejections.len().min(MAX_CAUSES);
        let colors: Vec<[u8; 3]> = (0..=known).map(class_color).collect();
        let capacity = usize::try_from(rejected.div_ceil(every)).unwrap_or(usize::MAX);
        let mut points = RejectedPoints::new(&layout, capacity, &colors).map_err(&failed)?;

        let columns: Vec<Column> =
            shown.axes.iter().chain(&scalars).map(|named| named.column).collect();
        let (mut pose, mut row) = (vec![0.0; grid.axes().len()], Vec::new());
        let mut seen = vec![false; 1 + known];
        let mut number = 0_u64;
        let visit = |point: RejectedPoint| -> Result<(), StudyError> {
            number += 1;
            if !(number - 1).is_multiple_of(every) {
                return Ok(());
            }
            grid.pose_into(point.pose, &mut pose);
            let cause = point.cause.map_or(0, |row| 1 + row).min(known);
            row.clear();
            let mut position = None;
            row.extend(columns.iter().map(|column| match *column {
                Column::Coordinate(i) => pose[set.axes.start + i],
                Column::Share => point.reached as f64 / each as f64,
                Column::Tip(i) => {
                    position.get_or_insert_with(|| tip(manipulator, *modes, &pose))[i]
                }
                Column::Zero
                | Column::Imaginary(_)
                | Column::Actuated(_)
                | Column::InverseCondition
                | Column::Aspect
                | Column::Index(_)
                | Column::Effort(_) => 0.0,
            }));
            if !row.iter().all(|value| value.is_finite()) {
                // Without its dependent coordinates, a pose does not say where the platform is.
                return Ok(());
            }
            row.extend([slice(&point) as f64, cause as f64]);
            seen[cause] = true;
            points.push(&row).map_err(&failed)
        };
        rejections.points(manipulator, *modes, &set, progress, visit)?;

        let text = |number: usize| match number.checked_sub(1) {
            None => "several causes".to_owned(),
            Some(row) => words(manipulator, &rejections.rejections[row]),
        };
        let causes = (0..=known).filter(|&number| seen[number]).map(|number| RejectedCause {
            number,
            text: text(number),
            color: class_color(number),
        });
        recorder.rejected(points, &causes.collect::<Vec<_>>(), every).map_err(failed)
    }
}
