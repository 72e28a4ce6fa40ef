//! The points of a set in memory in the form of recordings, and boundaries as lines in space.

use super::points::{layout, scale};
use super::scale::Measures;
use super::slices::{point_area, slice_axis};
use crate::analysis::Analysis;
use crate::columns::{Column, PointChoice, PointColumns};
use crate::error::{RequestError, SetPart, StudyError};
use crate::workspace::Workspace;
use opm_core::reach::LegBranch;
use opm_mcap::{ClosedLine, CloudLayout, MAX_SLICES, Slices};
use opm_workspace::{Grid, GridSet, Outline, Visits};

/// Closed lines, slice by slice.
pub type BoundaryLines = Vec<(u64, Vec<ClosedLine>)>;

/// The points of a set in memory.
pub struct SetCloud<'a> {
    workspace: &'a Workspace,
    analysis: &'a Analysis,
    set: &'a GridSet,
    shown: PointColumns,
    /// Number of points of a slice, in the set or not.
    slice: u64,
    /// The axis that has another value in each slice.
    held: Option<usize>,
}

impl<'a> SetCloud<'a> {
    /// The points of the set of an analysis. Values that were not requested suit the set.
    pub fn new(
        workspace: &'a Workspace,
        analysis: &'a Analysis,
        set: &'a GridSet,
        choice: PointChoice,
    ) -> Result<Self, RequestError> {
        let varying = set.varying();
        let held = match varying[..] {
            [_, _, .., slowest] => Some(slowest),
            _ => None,
        };
        let slices = held.map_or(1, |axis| set.axes()[axis].axis.count);
        if slices > MAX_SLICES {
            return Err(RequestError::TooManySlices {
                part: SetPart::Values,
                given: slices,
                axis: set.axes()[varying[varying.len() - 1]].axis.name.clone(),
                most: MAX_SLICES,
            });
        }
        let slice = set.points() / slices;
        let shown = PointColumns::of_set(choice, set);
        Ok(Self { workspace, analysis, set, shown, slice, held })
    }

    /// The values that are shown, by name.
    pub fn shown(&self) -> &PointColumns {
        &self.shown
    }

    /// The number of the slice that the point of this number is in.
    pub fn slice_of(&self, number: u64) -> u64 {
        number / self.slice
    }

    /// The slices.
    pub fn slices(&self) -> Slices {
        let Workspace { grid, kind, .. } = self.workspace;
        let (first, axes) = (kind.axes(grid).start, self.set.axes());
        let held = self
            .held
            .map(|i| slice_axis(&axes[i].axis, grid.coordinates()[first + i].quantity.unit()));
        let within = axes.iter().enumerate().filter(|(i, _)| Some(*i) != self.held);
        let point_area = point_area(within.map(|(_, axis)| &axis.axis));
        Slices { axes: held.into_iter().collect(), point_area }
    }

    /// The layout of the points, for a recorder.
    pub fn layout(&self) -> CloudLayout {
        let color_range = match self.shown.color.column {
            Column::Coordinate(i) => {
                let axis = &self.set.axes()[i].axis;
                [axis.min, axis.max]
            }
            Column::Share => [0.0, 1.0],
            Column::Imaginary(i) => self.analysis.count.imaginary[i].unwrap_or_default(),
            Column::Zero
            | Column::Actuated(_)
            | Column::Tip(_)
            | Column::InverseCondition
            | Column::Aspect
            | Column::Index(_)
            | Column::Effort(_) => [0.0, 0.0],
        };
        layout(&self.shown, color_range, "task", self.measures())
    }

    /// The quantities and the extents of the axes.
    fn measures(&self) -> Measures {
        let Workspace { grid, manipulator, kind, .. } = self.workspace;
        let first = kind.axes(grid).start;
        self.shown.axes.each_ref().map(|named| match named.column {
            Column::Coordinate(i) => {
                let axis = &self.set.axes()[i].axis;
                Some((grid.coordinates()[first + i].quantity, axis.max - axis.min))
            }
            Column::Imaginary(i) => {
                let [low, high] = self.analysis.count.imaginary[i]?;
                Some((manipulator.imaginary()[i].quantity, high - low))
            }
            _ => None,
        })
    }

    /// The names of the set's axes.
    pub fn axis_names(&self) -> String {
        let names: Vec<&str> = self.set.axes().iter().map(|a| &*a.axis.name).collect();
        names.join(",")
    }

    /// Calls `visit` with the slice and the values of every point, in the order of [`CloudLayout::columns`].
    pub fn points(
        &self,
        mut visit: impl FnMut(u64, &[f64]) -> Result<(), StudyError>,
    ) -> Result<(), StudyError> {
        let columns = self.shown.columns();
        let (mut row, mut branches) = (vec![0.0; columns.len()], vec![]);
        for number in self.set.numbers() {
            let point = self.set.point(number);
            let mut imaginary: Option<Vec<f64>> = None;
            for (value, column) in row.iter_mut().zip(&columns) {
                *value = match *column {
                    Column::Coordinate(i) => point[i],
                    Column::Share => {
                        let share = |visits: &Visits| visits.share(number);
                        self.analysis.visits.as_ref().map_or(0.0, share)
                    }
                    Column::Imaginary(i) => {
                        imaginary.get_or_insert_with(|| self.imaginary(&point, &mut branches))[i]
                    }
                    Column::Zero => 0.0,
                    Column::Actuated(_)
                    | Column::Tip(_)
                    | Column::InverseCondition
                    | Column::Aspect
                    | Column::Index(_)
                    | Column::Effort(_) => {
                        unreachable!("points of a set are not poses")
                    }
                };
            }
            visit(self.slice_of(number), &row)?;
        }
        Ok(())
    }

    /// Every imaginary joint at the upper section's coordinates, in the first mode that closes.
    fn imaginary(&self, upper: &[f64], branches: &mut Vec<LegBranch>) -> Vec<f64> {
        let manipulator = &self.workspace.manipulator;
        let (reach, upper) = (manipulator.reach(), manipulator.task().upper(upper));
        let value = |leg: usize| {
            branches.clear();
            reach.leg_branches(leg, &upper, self.workspace.modes.one(), branches);
            let first = branches.first();
            first.and_then(|branch| reach.imaginary_value(branch)).map_or(0.0, |v| v.1)
        };
        manipulator.imaginary().iter().map(|joint| joint.leg).map(value).collect()
    }

    /// The boundary in the axes of the cloud.
    pub fn boundary(&self) -> Option<BoundaryLines> {
        let coordinates: Option<Vec<_>> = (self.shown.axes.iter())
            .map(|named| match named.column {
                Column::Coordinate(i) => Some(Some(i)),
                Column::Zero => Some(None),
                Column::Share
                | Column::Imaginary(_)
                | Column::Actuated(_)
                | Column::Tip(_)
                | Column::InverseCondition
                | Column::Aspect
                | Column::Index(_)
                | Column::Effort(_) => None,
            })
            .collect();
        let coordinates = coordinates?;
        let scale = scale(&self.shown, self.measures());
        let place = |point: &[f64]| -> [f64; 3] {
            std::array::from_fn(|i| coordinates[i].map_or(0.0, |number| scale[i] * point[number]))
        };
        Some(boundary_lines(self.set, self.analysis.boundary()?, place, |slice| slice))
    }
}

/// The boundary of a set as lines in space. `place` gives the position of a point. `slice` gives the slice of
/// the recording in which a value of the set's third axis is shown.
fn boundary_lines(
    set: &GridSet,
    outlines: &[Outline],
    place: impl Fn(&[f64]) -> [f64; 3],
    slice: impl Fn(u64) -> u64,
) -> BoundaryLines {
    let axes = set.varying();
    let mut lines: BoundaryLines = vec![];
    for outline in outlines {
        let mut point: Vec<f64> = set.axes().iter().map(|a| a.axis.min).collect();
        if let Some(number) = outline.slice {
            point[axes[2]] = set.axes()[axes[2]].axis.value(number);
        }
        let rings = outline.rings.iter().map(|ring| {
            let corner = |&[x, y]: &[f64; 2]| {
                (point[axes[0]], point[axes[1]]) = (x, y);
                place(&point)
            };
            ring.points.iter().map(corner).collect::<ClosedLine>()
        });
        let at = slice(outline.slice.unwrap_or(0));
        match lines.last_mut() {
            Some((last, all)) if *last == at => all.extend(rings),
            _ => lines.push((at, rings.collect())),
        }
    }
    lines
}

/// The boundary of poses. A slice of the recording consists of `together` slices of the grid.
pub fn pose_boundary(
    grid: &Grid,
    analysis: &Analysis,
    together: u64,
    place: impl Fn(&[f64]) -> [f64; 3],
) -> Option<BoundaryLines> {
    let (set, outlines) = (analysis.set.as_ref()?, analysis.boundary()?);
    let third = set.varying().get(2).copied().filter(|&axis| axis >= grid.lower());
    // The third axis is the slowest, so that the slices come in order of time.
    let before = |axis: usize| grid.axes()[grid.lower()..axis].iter().map(|a| a.count).product();
    let stride: u64 = third.map_or(0, before);
    Some(boundary_lines(set, outlines, place, |number| number * stride / together))
}
