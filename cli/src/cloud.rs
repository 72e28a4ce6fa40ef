//! What each point of a recorded cloud is made of.

use crate::args::CloudArgs;
use crate::failure::Failure;
use crate::pose::find;
use crate::source::Source;
use crate::workspace::Run;
use opm_core::manipulator::{AllModes, Drives, Manipulator, Solution};
use opm_mcap::cloud::{COLOR_FIELDS, POSITION_FIELDS};
use opm_mcap::{CloudLayout, Packer, RecordError, TableFormat};
use opm_workspace::{Axis, ConditionLimit, Conditioned, Count, Grid, Hits, Modes, Poses, Progress};
use std::sync::{Mutex, PoisonError};

/// The name of the platform's point among the axes.
const TIP: &str = "tip";
/// The local conditioning index among the values of a point.
const INVERSE_CONDITION: &str = "inverse_condition";

/// One value of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// A task coordinate.
    Task(usize),
    /// An imaginary joint.
    Imaginary(usize),
    /// An actuated joint.
    Actuated(usize),
    /// The platform's point: x, y or z.
    Tip(usize),
    /// One over the condition number.
    InverseCondition,
}

/// A value with its name.
type Named = (String, Column);

/// What the flags ask for; the rest depends on the grid.
pub struct Wishes {
    axes: Option<[Named; 3]>,
    scalars: Option<Vec<Named>>,
    color: Option<Named>,
    /// Of condition numbers, metres.
    length: f64,
}

impl Wishes {
    /// From the flags, each of which is checked; condition numbers have this characteristic length.
    pub fn new(args: &CloudArgs, length: f64, manipulator: &Manipulator) -> Result<Self, Failure> {
        let named = |name: &String, flag| column(manipulator, name, flag);
        let color = args.color.as_ref().map(|name| named(name, "--color")).transpose()?;
        let scalars: Option<Vec<Named>> = (args.scalars.as_ref())
            .map(|names| names.iter().map(|name| named(name, "--scalars")).collect())
            .transpose()?;
        for (number, (name, _)) in scalars.iter().flatten().enumerate() {
            let wrong = |problem| Err(Failure::flag("--scalars", problem));
            if is_field(name) {
                return wrong(format!("a cloud has a field {name} already; use --axes"));
            }
            if scalars.iter().flatten().take(number).any(|(earlier, _)| earlier == name) {
                return wrong(format!("{name} is given twice"));
            }
        }
        Ok(Self { axes: axes(&args.axes, manipulator)?, scalars, color, length })
    }
}

impl Wishes {
    /// Whether a value of the points is a condition number.
    pub fn asks_condition(&self) -> bool {
        let mut asked = self.scalars.iter().flatten().chain(&self.color);
        asked.any(|(_, column)| *column == Column::InverseCondition)
    }
}

/// Whether every cloud has a field of this name.
fn is_field(name: &str) -> bool {
    POSITION_FIELDS.contains(&name) || COLOR_FIELDS.contains(&name)
}

/// What the points of a recording are made of.
#[derive(Clone)]
pub struct Cloud<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    limit: Option<ConditionLimit>,
    length: f64,
    axes: [Named; 3],
    scalars: Vec<Named>,
    /// Nobody chose them.
    fitting: bool,
    color: Named,
}

impl<'a> Cloud<'a> {
    /// The cloud of a grid; what was not asked for suits the grid.
    pub fn new(wishes: Wishes, run: &Run<'a>) -> Self {
        let Run { manipulator, grid, modes, limit, .. } = *run;
        let tallest = tallest(grid);
        let task = |number: usize| (grid.axes()[number].name.clone(), Column::Task(number));
        let color = wishes.color.unwrap_or_else(|| task(tallest));
        let several = |number: &usize| grid.axes()[*number].count > 1;
        let varying: Vec<usize> = (0..grid.axes().len()).filter(several).collect();
        let axes = wishes.axes.unwrap_or_else(|| {
            if let [a, b] = varying[..] {
                let flat = (0..grid.axes().len()).rfind(|number| !several(number));
                return [task(a), task(b), task(flat.unwrap_or(tallest))];
            }
            // What varies, then what does not; every pair of subspaces has at least three coordinates.
            let fixed = (0..grid.axes().len()).filter(|number| !several(number));
            let mut order: Vec<usize> = varying.iter().copied().chain(fixed).collect();
            // Places stand on the ground, the tallest orientation above them.
            if varying.len() > 2 && varying[0] < grid.lower() {
                order.retain(|&number| number != tallest);
                order.insert(2, tallest);
            }
            [task(order[0]), task(order[1]), task(order[2])]
        });
        let fitting = wishes.scalars.is_none();
        let scalars = wishes.scalars.unwrap_or_else(|| {
            // What the colour shows can be read off, too.
            let known = axes.contains(&color) || is_field(&color.0);
            if known { vec![] } else { vec![color.clone()] }
        });
        let length = wishes.length;
        Self { manipulator, modes, limit, length, axes, scalars, fitting, color }
    }

    /// The same with every task coordinate as a value of a point, where nobody chose the values: rows of
    /// a table know nothing of slices. A mesh tool's x, y and z are the axes.
    pub fn with_every_coordinate(mut self, format: TableFormat) -> Self {
        if !self.fitting {
            return self;
        }
        let coordinates = self.manipulator.task_coordinates().iter().enumerate();
        let named = coordinates.map(|(number, c)| (c.name.to_owned(), Column::Task(number)));
        let (axes, scalars) = (&self.axes, &self.scalars);
        let more: Vec<Named> = named
            .filter(|named| !axes.contains(named) && !scalars.contains(named))
            .filter(|(name, _)| format == TableFormat::Npy || !is_field(name))
            .collect();
        self.scalars.extend(more);
        self
    }

    /// How often the grid is swept to record it.
    pub fn passes(&self) -> u64 {
        match self.color.1 {
            Column::Actuated(number) if self.limits(number).is_none() => 3,
            Column::InverseCondition => 3,
            _ => 2,
        }
    }

    fn limits(&self, actuated: usize) -> Option<[f64; 2]> {
        self.manipulator.coordinates()[self.manipulator.actuated()[actuated]].limits
    }

    /// What a recorder is to know of it.
    pub fn layout(&self, color_range: [f64; 2]) -> CloudLayout {
        let frame = if matches!(self.axes[0].1, Column::Tip(_)) { "base" } else { "task" };
        CloudLayout {
            axes: self.axes.clone().map(|(name, _)| name),
            scalars: self.scalars.iter().map(|(name, _)| name.clone()).collect(),
            color: self.color.0.clone(),
            color_range,
            frame_id: frame.to_owned(),
        }
    }

    /// Where a pose is in the cloud.
    pub fn place(&self, pose: &[f64]) -> [f64; 3] {
        let tip = || {
            let task = self.manipulator.task();
            task.displacement(pose) * self.manipulator.mechanism().platform
        };
        self.axes.each_ref().map(|(_, column)| match *column {
            Column::Task(number) => pose[number],
            Column::Tip(i) => tip()[i],
            Column::Imaginary(_) | Column::Actuated(_) | Column::InverseCondition => {
                unreachable!("axes are task coordinates, or the platform's point")
            }
        })
    }

    /// The values of a row, in the order of [`CloudLayout::columns`].
    pub fn columns(&self) -> Vec<Column> {
        let listed = || self.axes.iter().chain(&self.scalars);
        let mut columns: Vec<Column> = listed().map(|(_, column)| *column).collect();
        if !listed().any(|(name, _)| *name == self.color.0) {
            columns.push(self.color.1);
        }
        columns
    }

    /// The values at the ends of the colours: of a task coordinate the grid's, of a joint its
    /// limits or what there is; of condition numbers what there is.
    pub fn color_range(
        &self,
        source: &Source<'_>,
        found: &Count,
        grid: &Grid,
        progress: &Progress,
    ) -> Result<[f64; 2], Failure> {
        let known = match self.color.1 {
            Column::Task(number) => Some([grid.axes()[number].min, grid.axes()[number].max]),
            Column::Imaginary(number) => Some(found.imaginary[number].unwrap_or_default()),
            Column::Actuated(number) => self.limits(number),
            Column::InverseCondition | Column::Tip(_) => None,
        };
        if let Some(range) = known {
            return Ok(range);
        }
        let columns = [self.color.1];
        let mut range: Option<[f64; 2]> = None;
        source.points(
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

/// The coordinate that a picture of the workspace is tallest in: the tilt where it varies, else the
/// slowest varying one of the upper section, else of the lower.
fn tallest(grid: &Grid) -> usize {
    let several = |axis: &Axis| axis.count > 1;
    let tilts = |axis: &Axis| axis.name == "xi" && several(axis);
    let upper = &grid.axes()[grid.lower()..];
    match upper.iter().position(tilts).or_else(|| upper.iter().rposition(several)) {
        Some(number) => grid.lower() + number,
        None => grid.axes().iter().position(several).unwrap_or(0),
    }
}

/// What `--axes` names.
fn axes(given: &[String], manipulator: &Manipulator) -> Result<Option<[Named; 3]>, Failure> {
    let wrong = |problem: String| Failure::flag("--axes", problem);
    match given {
        [] => Ok(None),
        [one] if one == TIP => {
            let tip = |i: usize| (format!("{TIP}.{}", POSITION_FIELDS[i]), Column::Tip(i));
            Ok(Some([tip(0), tip(1), tip(2)]))
        }
        [a, b, c] if a != b && b != c && a != c => {
            let task = |name: &String| match find(name, manipulator.task_coordinates()) {
                Ok(number) => Ok((name.clone(), Column::Task(number))),
                Err(error) => Err(wrong(error.to_string())),
            };
            Ok(Some([task(a)?, task(b)?, task(c)?]))
        }
        _ => Err(wrong(format!(
            "{:?}, expected three different task coordinates, or {TIP}",
            given.join(",")
        ))),
    }
}

/// What a name of `--color` or `--scalars` stands for.
fn column(manipulator: &Manipulator, name: &str, flag: &str) -> Result<Named, Failure> {
    let coordinates = manipulator.coordinates();
    let task: Vec<&str> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
    let imaginary: Vec<&str> = manipulator.imaginary().iter().map(|j| &*j.name).collect();
    let actuated: Vec<&str> =
        manipulator.actuated().iter().map(|&i| &*coordinates[i].name).collect();
    let find = |names: &[&str]| names.iter().position(|known| *known == name);
    (find(&task).map(Column::Task))
        .or_else(|| find(&imaginary).map(Column::Imaginary))
        .or_else(|| find(&actuated).map(Column::Actuated))
        .or_else(|| (name == INVERSE_CONDITION).then_some(Column::InverseCondition))
        .map(|column| (name.to_owned(), column))
        .ok_or_else(|| {
            let known = [task, imaginary, actuated, vec![INVERSE_CONDITION]].concat().join(", ");
            Failure::flag(flag, format!("{name:?} is none of {known}"))
        })
}

/// Points of one slice: values, or bytes of a cloud where there is a packer.
pub struct Portion {
    pub slice: u64,
    pub values: Vec<f64>,
    pub packed: Vec<u8>,
}

/// Packs points, into buffers that are used again: those of the system are cleared first, page by page,
/// which takes a third as long as everything else.
pub struct Packing {
    packer: Packer,
    buffers: Mutex<Vec<Vec<u8>>>,
}

impl Packing {
    /// For the points of this layout.
    pub fn new(layout: &CloudLayout) -> Result<Self, RecordError> {
        Ok(Self { packer: Packer::new(layout)?, buffers: Mutex::default() })
    }

    /// An empty buffer.
    fn buffer(&self) -> Vec<u8> {
        let mut buffers = self.buffers.lock().unwrap_or_else(PoisonError::into_inner);
        buffers.pop().unwrap_or_default()
    }

    /// Takes back the buffer of points that are written.
    pub fn reuse(&self, portion: Portion) {
        let mut buffer = portion.packed;
        buffer.clear();
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner).push(buffer);
    }
}

/// Points of a cloud in the making, in portions of one slice.
pub struct Points<'a> {
    cloud: &'a Cloud<'a>,
    columns: &'a [Column],
    packing: Option<&'a Packing>,
    /// All columns are task coordinates.
    plain: bool,
    joints: Joints<'a>,
    pose: Vec<f64>,
    row: Vec<f64>,
    portions: Vec<Portion>,
    /// A pose that the sweep found and inverse kinematics did not, or a value that is no number.
    wrong: Option<Failure>,
}

/// Buffers for what inverse kinematics finds.
enum Joints<'a> {
    /// No column asks for joints.
    Unused,
    One(Drives),
    Any(Box<(AllModes, Solution)>),
    /// With a limit on the condition number, which decides on the mode, or with a column that asks for
    /// that number.
    Limited(Box<(Conditioned<'a>, Solution)>),
}

impl<'a> Points<'a> {
    pub fn new(cloud: &'a Cloud<'a>, columns: &'a [Column], packing: Option<&'a Packing>) -> Self {
        let manipulator = cloud.manipulator;
        let asked = |c: &Column| matches!(c, Column::Imaginary(_) | Column::Actuated(_));
        let condition = columns.contains(&Column::InverseCondition);
        let joints = match (cloud.modes, cloud.limit) {
            _ if condition => {
                let limit = cloud.limit.unwrap_or(ConditionLimit::none(cloud.length));
                let conditioned = Conditioned::new(manipulator, limit);
                Joints::Limited(Box::new((conditioned, manipulator.solution())))
            }
            _ if !columns.iter().any(asked) => Joints::Unused,
            (Modes::One(_), _) => Joints::One(manipulator.drives()),
            (Modes::Any, Some(limit)) => {
                let conditioned = Conditioned::new(manipulator, limit);
                Joints::Limited(Box::new((conditioned, manipulator.solution())))
            }
            (Modes::Any, None) => {
                Joints::Any(Box::new((manipulator.all_modes(), manipulator.solution())))
            }
        };
        let plain = columns.iter().all(|column| matches!(column, Column::Task(_)));
        let (pose, row, portions) = (Vec::new(), Vec::new(), Vec::new());
        Self { cloud, columns, packing, plain, joints, pose, row, portions, wrong: None }
    }

    pub fn add(&mut self, hits: &Hits<'_>) {
        self.line(hits.slice, hits.first, hits.others);
    }

    /// The points of a slice that have these first coordinates, and all others in common.
    pub fn line(&mut self, slice: u64, first: &[f64], others: &[f64]) {
        let mut pose = std::mem::take(&mut self.pose);
        pose.clear();
        pose.push(0.0);
        pose.extend(others);
        match self.packing {
            Some(packing) if self.plain => self.plain_line(&packing.packer, slice, first, &pose),
            _ => {
                for &value in first {
                    pose[0] = value;
                    self.point(slice, &pose);
                }
                self.pack();
            }
        }
        self.pose = pose;
    }

    /// Points that have nothing but coordinates.
    fn plain_line(&mut self, packer: &Packer, slice: u64, first: &[f64], pose: &[f64]) {
        let value = |column: &Column| match *column {
            Column::Task(number) => pose[number],
            _ => unreachable!("plain points are made of task coordinates"),
        };
        let mut row = std::mem::take(&mut self.row);
        row.clear();
        row.extend(self.columns.iter().map(value));
        let column = self.columns.iter().position(|column| *column == Column::Task(0));
        self.open(slice);
        if let Some(portion) = self.portions.last_mut()
            && let Err(error) = packer.pack_line(&row, column, first, &mut portion.packed)
        {
            self.wrong.get_or_insert(Failure::at("a point", &error));
        }
        self.row = row;
    }

    /// Packs the values so far.
    fn pack(&mut self) {
        let (Some(packing), Some(portion)) = (self.packing, self.portions.last_mut()) else {
            return;
        };
        if let Err(error) = packing.packer.pack(&portion.values, &mut portion.packed) {
            self.wrong.get_or_insert(Failure::at("a point", &error));
        }
        portion.values.clear();
    }

    /// Makes the last portion one of this slice.
    fn open(&mut self, slice: u64) {
        if self.portions.last().is_none_or(|last| last.slice != slice) {
            let packed = self.packing.map_or_else(Vec::new, Packing::buffer);
            self.portions.push(Portion { slice, values: Vec::new(), packed });
        }
    }

    fn point(&mut self, slice: u64, pose: &[f64]) {
        let manipulator = self.cloud.manipulator;
        let found = match (&mut self.joints, self.cloud.modes) {
            (Joints::One(drives), Modes::One(mode)) => {
                manipulator.inverse_drives(pose, mode, drives) == Ok(true)
            }
            (Joints::Any(buffers), _) => {
                let (all, solution) = &mut **buffers;
                manipulator.inverse_all(pose, all) == Ok(true)
                    && manipulator.pick_within_limits(all, solution).is_some()
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
        if !found {
            self.wrong.get_or_insert_with(|| {
                Failure::Work(format!(
                    "the sweep counts the pose {pose:?}, but inverse kinematics does not reach it"
                ))
            });
            return;
        }
        self.open(slice);
        let Some(Portion { values: row, .. }) = self.portions.last_mut() else { return };
        let mut tip = None;
        for column in self.columns {
            row.push(match (*column, &self.joints) {
                (Column::Task(number), _) => pose[number],
                (Column::Tip(i), _) => tip.get_or_insert_with(|| {
                    manipulator.task().displacement(pose) * manipulator.mechanism().platform
                })[i],
                (Column::Imaginary(number), Joints::One(drives)) => drives.imaginary[number],
                (Column::Actuated(number), Joints::One(drives)) => drives.actuated[number],
                (Column::Imaginary(number), Joints::Any(buffers)) => buffers.1.imaginary[number],
                (Column::Actuated(number), Joints::Any(buffers)) => {
                    buffers.1.joints[manipulator.actuated()[number]]
                }
                (Column::Imaginary(number), Joints::Limited(buffers)) => {
                    buffers.1.imaginary[number]
                }
                (Column::Actuated(number), Joints::Limited(buffers)) => {
                    buffers.1.joints[manipulator.actuated()[number]]
                }
                (Column::InverseCondition, Joints::Limited(buffers)) => buffers.0.index(),
                (
                    Column::Imaginary(_) | Column::Actuated(_) | Column::InverseCondition,
                    Joints::Unused | Joints::One(_) | Joints::Any(_),
                ) => {
                    unreachable!("Points::new has buffers for what columns ask for")
                }
            });
        }
    }

    /// The points so far; the next ones start anew.
    pub fn take(&mut self) -> Result<Vec<Portion>, Failure> {
        self.pack();
        self.wrong.take().map_or_else(|| Ok(std::mem::take(&mut self.portions)), Err)
    }
}
