//! What each point of a recorded cloud is made of.

use crate::args::CloudArgs;
use crate::failure::Failure;
use crate::pose::find;
use crate::source::Source;
use crate::workspace::Run;
use opm_core::manipulator::{AllModes, Drives, Manipulator, Solution};
use opm_mcap::CloudLayout;
use opm_mcap::cloud::{COLOR_FIELDS, POSITION_FIELDS};
use opm_workspace::{Axis, ConditionLimit, Conditioned, Count, Grid, Hits, Modes, Progress};

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
pub struct Cloud<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    limit: Option<ConditionLimit>,
    length: f64,
    axes: [Named; 3],
    scalars: Vec<Named>,
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
            // Every pair of subspaces has at least three coordinates.
            let mut others = (0..grid.axes().len()).filter(|&number| number != tallest);
            let mut other = || others.next().unwrap_or(tallest);
            [task(other()), task(other()), task(tallest)]
        });
        let scalars = wishes.scalars.unwrap_or_else(|| {
            // What the colour shows can be read off, too.
            let known = axes.contains(&color) || is_field(&color.0);
            if known { vec![] } else { vec![color.clone()] }
        });
        Self { manipulator, modes, limit, length: wishes.length, axes, scalars, color }
    }

    /// How often the grid is swept to record it.
    pub fn passes(&self) -> u64 {
        match self.color.1 {
            Column::Actuated(number) if self.limits(number).is_none() => 3,
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
    /// limits or what there is.
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
            Column::InverseCondition => Some([0.0, 1.0]),
            Column::Tip(_) => None,
        };
        if let Some(range) = known {
            return Ok(range);
        }
        let columns = [self.color.1];
        let mut range: Option<[f64; 2]> = None;
        source.points(
            progress,
            |hits, points: &mut Points<'_>| points.add(hits),
            || Points::new(self, &columns),
            |mut points| {
                for value in points.take()?.into_iter().flat_map(|(_, values)| values) {
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

/// Reachable poses, packed: points that share all but the first coordinate share the rest.
#[derive(Default)]
pub struct Poses {
    first: Vec<f64>,
    /// Where each run of `first` ends.
    ends: Vec<usize>,
    others: Vec<f64>,
    width: usize,
}

impl Poses {
    pub fn add(&mut self, hits: &Hits<'_>) {
        self.first.extend(hits.first);
        self.ends.push(self.first.len());
        self.others.extend(hits.others);
        self.width = hits.others.len();
    }

    pub fn each(&self, mut visit: impl FnMut(&[f64])) {
        let mut pose = vec![0.0; self.width + 1];
        let mut start = 0;
        for (number, &end) in self.ends.iter().enumerate() {
            let others = number * self.width..(number + 1) * self.width;
            pose[1..].copy_from_slice(&self.others[others]);
            for &first in &self.first[start..end] {
                pose[0] = first;
                visit(&pose);
            }
            start = end;
        }
    }
}

/// Rows of a cloud in the making, in runs of one slice.
pub struct Points<'a> {
    cloud: &'a Cloud<'a>,
    columns: &'a [Column],
    joints: Joints<'a>,
    pose: Vec<f64>,
    runs: Vec<(u64, Vec<f64>)>,
    /// A pose that the sweep found and inverse kinematics did not.
    lost: Option<Vec<f64>>,
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
    pub fn new(cloud: &'a Cloud<'a>, columns: &'a [Column]) -> Self {
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
        Self { cloud, columns, joints, pose: Vec::new(), runs: Vec::new(), lost: None }
    }

    pub fn add(&mut self, hits: &Hits<'_>) {
        let mut pose = std::mem::take(&mut self.pose);
        pose.clear();
        pose.push(0.0);
        pose.extend(hits.others);
        for &first in hits.first {
            pose[0] = first;
            self.point(hits.slice, &pose);
        }
        self.pose = pose;
    }

    pub fn point(&mut self, slice: u64, pose: &[f64]) {
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
            self.lost.get_or_insert_with(|| pose.to_vec());
            return;
        }
        if self.runs.last().is_none_or(|(last, _)| *last != slice) {
            self.runs.push((slice, Vec::new()));
        }
        let Some((_, row)) = self.runs.last_mut() else { return };
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

    /// The rows so far; the next ones start anew.
    pub fn take(&mut self) -> Result<Vec<(u64, Vec<f64>)>, Failure> {
        match &self.lost {
            None => Ok(std::mem::take(&mut self.runs)),
            Some(pose) => Err(Failure::Work(format!(
                "the sweep counts the pose {pose:?}, but inverse kinematics does not reach it"
            ))),
        }
    }
}
