//! The points of a cloud of poses: rows of values, or packed in the form of recordings.

use super::scale::{Measures, factors};
use crate::columns::{AxisScale, Column, NamedColumn, PointColumns, is_field};
use crate::error::StudyError;
use crate::poses::PoseSource;
use crate::workspace::Workspace;
use opm_analysis::{Index, Indices};
use opm_core::Quantity;
use opm_core::manipulator::{ActuatedJoints, AllModes, Manipulator, Solution};
use opm_core::nalgebra::Point3;
use opm_mcap::{CloudLayout, Packer, RecordError, TableFormat};
use opm_workspace::{Aspects, Conditioned, Count, Hits, Modes, Poses, Progress};
use std::sync::{Mutex, PoisonError};

/// The values of the points in a recording of poses.
#[derive(Clone)]
pub struct Cloud<'a> {
    workspace: &'a Workspace,
    shown: PointColumns,
    aspects: Option<&'a Aspects>,
}

impl<'a> Cloud<'a> {
    /// The cloud of a workspace whose points are poses.
    pub fn new(workspace: &'a Workspace, shown: PointColumns) -> Self {
        Self { workspace, shown, aspects: None }
    }

    /// The same with the aspects of the poses, which only one kind of workspace has.
    pub fn with_aspects(self, aspects: Option<&'a Aspects>) -> Self {
        Self { aspects, ..self }
    }

    /// The number of the aspect that a pose is in; 0 if it is in none.
    fn aspect(&self, pose: &[f64]) -> f64 {
        let label = |aspects: &Aspects| aspects.label(aspects.nearest(pose));
        f64::from(self.aspects.and_then(label).unwrap_or(0))
    }

    fn manipulator(&self) -> &'a Manipulator {
        &self.workspace.manipulator
    }

    /// The same with every task coordinate as a value of a point, if no values were requested: rows of
    /// a table have no slices. For mesh tools, x, y and z are the axes.
    pub fn with_every_coordinate(mut self, format: TableFormat) -> Self {
        self.shown.scale = AxisScale::None;
        if self.shown.scalars_chosen {
            return self;
        }
        let grid = &self.workspace.grid;
        let coordinates = grid.coordinates().iter().enumerate();
        let named = coordinates.map(|(number, c)| NamedColumn {
            name: c.name.clone(),
            column: Column::Coordinate(number),
        });
        let PointColumns { axes, scalars, .. } = &self.shown;
        let more: Vec<NamedColumn> = named
            .filter(|named| !axes.contains(named) && !scalars.contains(named))
            .filter(|named| format == TableFormat::Npy || !is_field(&named.name))
            .collect();
        self.shown.scalars.extend(more);
        self
    }

    /// The number of sweeps of the grid that recording it takes.
    pub fn passes(&self) -> u64 {
        match self.shown.color.column {
            Column::Actuated(number) if self.limits(number).is_none() => 3,
            Column::InverseCondition | Column::Index(_) | Column::Effort(_) => 3,
            Column::Coordinate(_)
            | Column::Imaginary(_)
            | Column::Actuated(_)
            | Column::Tip(_)
            | Column::Share
            | Column::Aspect
            | Column::Zero => 2,
        }
    }

    fn limits(&self, actuated: usize) -> Option<[f64; 2]> {
        let manipulator = self.manipulator();
        manipulator.coordinates()[manipulator.actuated()[actuated]].limits
    }

    /// The layout of the points, for a recorder.
    pub fn layout(&self, color_range: [f64; 2]) -> CloudLayout {
        let of_base = matches!(self.shown.axes[0].column, Column::Tip(_));
        let frame = if of_base { "base" } else { "task" };
        layout(&self.shown, color_range, frame, self.measures())
    }

    /// The quantities and the extents of the axes.
    fn measures(&self) -> Measures {
        let grid = &self.workspace.grid;
        self.shown.axes.each_ref().map(|named| match named.column {
            Column::Coordinate(i) => {
                let axis = &grid.axes()[i];
                Some((grid.coordinates()[i].quantity, axis.max - axis.min))
            }
            Column::Tip(_) => Some((Quantity::Length, 0.0)),
            _ => None,
        })
    }

    /// The position of a pose in the cloud.
    pub fn place(&self, pose: &[f64]) -> [f64; 3] {
        let tip = || tip(self.manipulator(), self.workspace.modes, pose);
        let at = self.shown.axes.each_ref().map(|named| match named.column {
            Column::Coordinate(number) => pose[number],
            Column::Tip(i) => tip()[i],
            Column::Zero => 0.0,
            Column::Imaginary(_)
            | Column::Actuated(_)
            | Column::InverseCondition
            | Column::Aspect
            | Column::Index(_)
            | Column::Effort(_)
            | Column::Share => unreachable!("axes are task coordinates, or the platform's point"),
        });
        let scale = scale(&self.shown, self.measures());
        std::array::from_fn(|i| scale[i] * at[i])
    }

    /// The values that are shown, by name.
    pub fn shown(&self) -> &PointColumns {
        &self.shown
    }

    /// The values of a row, in the order of [`CloudLayout::columns`].
    pub fn columns(&self) -> Vec<Column> {
        self.shown.columns()
    }

    /// Whether all values of a point are task coordinates, or zero.
    pub fn is_plain(&self) -> bool {
        is_plain(&self.columns())
    }

    /// The values at the ends of the colour scale. A task coordinate has those of the grid; a joint has its
    /// limits or the range that occurs; condition numbers and indices have the range that occurs.
    pub fn color_range(
        &self,
        poses: &PoseSource<'_>,
        count: &Count,
        progress: &Progress,
    ) -> Result<[f64; 2], StudyError> {
        let axis = |number: usize| &self.workspace.grid.axes()[number];
        let color = self.shown.color.column;
        let known = match color {
            Column::Coordinate(number) => Some([axis(number).min, axis(number).max]),
            Column::Imaginary(number) => Some(count.imaginary[number].unwrap_or_default()),
            Column::Actuated(number) => self.limits(number),
            Column::Aspect => {
                let last = self.aspects.map_or(0, |aspects| aspects.list().len());
                Some([1.0_f64.min(last as f64), last as f64])
            }
            Column::InverseCondition
            | Column::Index(_)
            | Column::Effort(_)
            | Column::Tip(_)
            | Column::Share
            | Column::Zero => None,
        };
        if let Some(range) = known {
            return Ok(range);
        }
        let columns = [color];
        let mut range: Option<[f64; 2]> = None;
        poses.points(
            progress,
            |hits, points: &mut Points<'_>| points.add(hits),
            || Points::new(self, &columns, None),
            |mut points| {
                for value in points.take()?.into_iter().flat_map(|portion| portion.values) {
                    let [low, high] = range.unwrap_or([value; 2]);
                    range = Some([low.min(value), high.max(value)]);
                }
                Ok(())
            },
        )?;
        Ok(range.unwrap_or_default())
    }
}

fn is_plain(columns: &[Column]) -> bool {
    columns.iter().all(|column| matches!(column, Column::Coordinate(_) | Column::Zero))
}

/// The layout of points with these values, for a recorder.
pub fn layout(
    shown: &PointColumns,
    color_range: [f64; 2],
    frame: &str,
    measures: Measures,
) -> CloudLayout {
    CloudLayout {
        axes: shown.axes.each_ref().map(|named| named.name.clone()),
        scalars: shown.scalars.iter().map(|named| named.name.clone()).collect(),
        color: shown.color.name.clone(),
        color_range,
        frame_id: frame.to_owned(),
        scale: scale(shown, measures),
        units: measures.map(|measure| measure.map_or("", |(quantity, _)| quantity.unit())),
    }
}

/// What the axes are multiplied by.
pub fn scale(shown: &PointColumns, measures: Measures) -> [f64; 3] {
    match shown.scale {
        AxisScale::Comparable => factors(measures),
        AxisScale::None => [1.0; 3],
    }
}

/// Points of one slice: values, or bytes of a cloud where there is a packer.
pub struct Portion {
    pub slice: u64,
    pub values: Vec<f64>,
    pub packed: Vec<u8>,
}

/// Packs points into buffers that are reused. New buffers from the system would first be cleared page by
/// page, which takes a third as long as everything else.
pub struct Packing {
    packer: Packer,
    buffers: Mutex<Buffers>,
}

/// Buffers that are free.
#[derive(Default)]
struct Buffers {
    free: Vec<Vec<u8>>,
    /// The most bytes that were packed into one: a new one gets room for as many, so that it does not grow step by step.
    most: usize,
}

impl Packing {
    /// A packer for the points of this layout.
    pub fn new(layout: &CloudLayout) -> Result<Self, RecordError> {
        Ok(Self { packer: Packer::new(layout)?, buffers: Mutex::default() })
    }

    /// An empty buffer.
    fn buffer(&self) -> Vec<u8> {
        let mut buffers = self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        let most = buffers.most;
        buffers.free.pop().unwrap_or_else(|| Vec::with_capacity(most))
    }

    /// Takes back the buffer of points that have been written.
    pub fn reuse(&self, portion: Portion) {
        let mut buffer = portion.packed;
        let mut buffers = self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        buffers.most = buffers.most.max(buffer.len());
        buffer.clear();
        buffers.free.push(buffer);
    }
}

/// Points of a cloud that is being built, in portions of one slice.
pub struct Points<'a> {
    cloud: &'a Cloud<'a>,
    columns: &'a [Column],
    packing: Option<&'a Packing>,
    /// All columns are task coordinates, or zero.
    plain: bool,
    joints: Joints<'a>,
    conditions: Option<Box<Conditions<'a>>>,
    /// The indices that are columns.
    indices: Option<Indices<'a>>,
    pose: Vec<f64>,
    row: Vec<f64>,
    portions: Vec<Portion>,
    /// A pose that the sweep found and inverse kinematics did not, or a value that is not a number.
    wrong: Option<StudyError>,
}

/// The local conditioning indices of points that differ in the first coordinate, which are found together.
struct Conditions<'a> {
    conditioned: Conditioned<'a>,
    /// The poses, row after row.
    poses: Vec<f64>,
    indices: Vec<f64>,
}

impl Conditions<'_> {
    fn find(&mut self, modes: Modes, first: &[f64], others: &[f64]) {
        self.poses.clear();
        for &value in first {
            self.poses.push(value);
            self.poses.extend_from_slice(others);
        }
        self.indices.resize(first.len(), f64::NAN);
        self.conditioned.local_indices(&self.poses, modes, &mut self.indices);
    }
}

/// Buffers for the results of inverse kinematics.
enum Joints<'a> {
    /// No column needs joint values.
    Unused,
    One(ActuatedJoints),
    Any(Box<(AllModes, Solution)>),
    /// There is a limit on what a pose is like, which selects the mode, or a column that needs all of a solution.
    Limited(Box<(Conditioned<'a>, Solution)>),
}

impl<'a> Points<'a> {
    pub fn new(cloud: &'a Cloud<'a>, columns: &'a [Column], packing: Option<&'a Packing>) -> Self {
        let manipulator = cloud.manipulator();
        let asked = |c: &Column| matches!(c, Column::Imaginary(_) | Column::Actuated(_));
        let condition = columns.contains(&Column::InverseCondition);
        let asked_indices: Vec<Index> = (columns.iter())
            .filter_map(
                |column| if let Column::Index(index) = column { Some(*index) } else { None },
            )
            .collect();
        let setup = &cloud.workspace.setup;
        let efforts = columns.iter().any(|column| matches!(column, Column::Effort(_)));
        let indices = match asked_indices.is_empty() && !efforts {
            true => None,
            false => Indices::new(manipulator, setup, asked_indices).ok(),
        };
        let indices = match efforts {
            true => indices.map(|indices| indices.with_efforts(setup)),
            false => indices,
        };
        let given = cloud.workspace.limit();
        let limited = || {
            let conditioned = Conditioned::new(manipulator, cloud.workspace.limit_or_none());
            Joints::Limited(Box::new((conditioned, manipulator.solution())))
        };
        let joints = match cloud.workspace.modes {
            _ if indices.is_some() => limited(),
            _ if !columns.iter().any(asked) => Joints::Unused,
            Modes::One(_) => Joints::One(manipulator.actuated_joints()),
            Modes::Any if given.is_some() || condition => limited(),
            Modes::Any => Joints::Any(Box::new((manipulator.all_modes(), manipulator.solution()))),
        };
        let conditions = condition.then(|| {
            let conditioned = Conditioned::new(manipulator, cloud.workspace.limit_or_none());
            Box::new(Conditions { conditioned, poses: Vec::new(), indices: Vec::new() })
        });
        Self {
            cloud,
            columns,
            packing,
            plain: is_plain(columns),
            joints,
            conditions,
            indices,
            pose: Vec::new(),
            row: Vec::new(),
            portions: Vec::new(),
            wrong: None,
        }
    }

    pub fn add(&mut self, hits: &Hits<'_>) {
        self.line(hits.slice, hits.first, hits.others);
    }

    /// The points of a slice that have these first coordinates and share all others.
    pub fn line(&mut self, slice: u64, first: &[f64], others: &[f64]) {
        let mut pose = std::mem::take(&mut self.pose);
        pose.clear();
        pose.push(0.0);
        pose.extend(others);
        if self.plain {
            self.plain_line(slice, first, &pose);
        } else {
            if let Some(conditions) = &mut self.conditions {
                conditions.find(self.cloud.workspace.modes, first, others);
            }
            for (number, &value) in first.iter().enumerate() {
                pose[0] = value;
                self.point(slice, &pose, number);
            }
            self.pack();
        }
        self.pose = pose;
    }

    /// Points whose values are all coordinates, or zero.
    fn plain_line(&mut self, slice: u64, first: &[f64], pose: &[f64]) {
        let value = |column: &Column| match *column {
            Column::Coordinate(number) => pose[number],
            Column::Zero => 0.0,
            _ => unreachable!("plain points are made of task coordinates and zeros"),
        };
        let mut row = std::mem::take(&mut self.row);
        row.clear();
        row.extend(self.columns.iter().map(value));
        let column = self.columns.iter().position(|column| *column == Column::Coordinate(0));
        self.open(slice);
        let Some(Portion { values, packed, .. }) = self.portions.last_mut() else { return };
        if let Some(packing) = self.packing {
            if let Err(error) = packing.packer.pack_line(&row, column, first, packed) {
                self.wrong.get_or_insert(StudyError::record("a point", error));
            }
        } else {
            for &value in first {
                if let Some(column) = column {
                    row[column] = value;
                }
                values.extend_from_slice(&row);
            }
        }
        self.row = row;
    }

    /// Packs the values so far.
    fn pack(&mut self) {
        let (Some(packing), Some(portion)) = (self.packing, self.portions.last_mut()) else {
            return;
        };
        if let Err(error) = packing.packer.pack(&portion.values, &mut portion.packed) {
            self.wrong.get_or_insert(StudyError::record("a point", error));
        }
        portion.values.clear();
    }

    /// Makes sure that the last portion belongs to this slice.
    fn open(&mut self, slice: u64) {
        if self.portions.last().is_none_or(|last| last.slice != slice) {
            let packed = self.packing.map_or_else(Vec::new, Packing::buffer);
            self.portions.push(Portion { slice, values: Vec::new(), packed });
        }
    }

    /// A point, by its number among those that were found together.
    fn point(&mut self, slice: u64, pose: &[f64], number: usize) {
        let manipulator = self.cloud.manipulator();
        let condition = self.conditions.as_ref().map_or(0.0, |found| found.indices[number]);
        let found = match (&mut self.joints, self.cloud.workspace.modes) {
            (Joints::One(drives), Modes::One(mode)) => {
                matches!(manipulator.inverse_actuated(pose, mode, drives), Ok(Some(_)))
            }
            (Joints::Any(buffers), _) => {
                let (all, solution) = &mut **buffers;
                matches!(manipulator.inverse_all(pose, all), Ok(Some(_)))
                    && manipulator.solution_within_limits(all, solution).is_some()
            }
            (Joints::Limited(buffers), modes) => {
                let (conditioned, solution) = &mut **buffers;
                let first = conditioned.first(pose, modes);
                first.is_some_and(|first| {
                    solution.clone_from(first);
                    true
                })
            }
            _ => true,
        };
        if !found || condition.is_nan() {
            self.wrong.get_or_insert_with(|| StudyError::LostPose { pose: pose.to_vec() });
            return;
        }
        self.open(slice);
        let Some(Portion { values: row, .. }) = self.portions.last_mut() else { return };
        let mut tip = None;
        if let (Some(indices), Joints::Limited(buffers)) = (&mut self.indices, &self.joints) {
            indices.evaluate(&buffers.1);
        }
        for column in self.columns {
            row.push(match (*column, &self.joints) {
                (Column::Coordinate(number), _) => pose[number],
                (Column::Tip(i), _) => {
                    let modes = self.cloud.workspace.modes;
                    tip.get_or_insert_with(|| self::tip(manipulator, modes, pose))[i]
                }
                (Column::Imaginary(number), Joints::One(drives)) => drives.imaginary()[number],
                (Column::Actuated(number), Joints::One(drives)) => drives.actuated()[number],
                (Column::Imaginary(number), Joints::Any(buffers)) => buffers.1.imaginary()[number],
                (Column::Actuated(number), Joints::Any(buffers)) => {
                    buffers.1.joints()[manipulator.actuated()[number]]
                }
                (Column::Imaginary(number), Joints::Limited(buffers)) => {
                    buffers.1.imaginary()[number]
                }
                (Column::Actuated(number), Joints::Limited(buffers)) => {
                    buffers.1.joints()[manipulator.actuated()[number]]
                }
                (Column::InverseCondition, _) => condition,
                (Column::Index(index), Joints::Limited(_)) => {
                    let found = self.indices.as_ref().and_then(|indices| indices.value(index));
                    found.unwrap_or(f64::NAN)
                }
                (Column::Effort(number), Joints::Limited(_)) => {
                    let efforts = self.indices.as_ref().map(Indices::efforts);
                    efforts.and_then(|efforts| efforts.get(number).copied()).unwrap_or(f64::NAN)
                }
                (
                    Column::Imaginary(_)
                    | Column::Actuated(_)
                    | Column::Index(_)
                    | Column::Effort(_),
                    Joints::Unused | Joints::One(_) | Joints::Any(_),
                ) => {
                    unreachable!("Points::new has buffers for what columns ask for")
                }
                (Column::Zero, _) => 0.0,
                (Column::Aspect, _) => self.cloud.aspect(pose),
                (Column::Share, _) => unreachable!("poses have no share of orientations"),
            });
        }
    }

    /// Takes the points so far; the next ones start a new buffer.
    pub fn take(&mut self) -> Result<Vec<Portion>, StudyError> {
        self.pack();
        self.wrong.take().map_or_else(|| Ok(std::mem::take(&mut self.portions)), Err)
    }
}

/// The platform's reference point at a pose in reach. Where some coordinates depend on those of the pose, it is the
/// one of the first mode that reaches the pose within the limits.
pub fn tip(manipulator: &Manipulator, modes: Modes, pose: &[f64]) -> Point3<f64> {
    let reference = manipulator.mechanism().platform;
    if manipulator.dependent_coordinates().is_empty() {
        return manipulator.task().displacement(pose) * reference;
    }
    let mut at = manipulator.solution();
    match modes {
        Modes::One(mode) => {
            let _ = manipulator.inverse(pose, mode, &mut at);
        }
        Modes::Any => {
            let mut all = manipulator.all_modes();
            if let Ok(Some(all)) = manipulator.inverse_all(pose, &mut all) {
                let _ = manipulator.solution_within_limits(all, &mut at);
            }
        }
    }
    at.displacement(manipulator) * reference
}
