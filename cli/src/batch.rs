//! `opm ik --poses`: a CSV file of poses in, one of joint values out, row by row.

use crate::args::{IkArgs, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::Checks;
use crate::pose_table::{self, Totals};
use crate::stream::{self, MODE, Stop, Stream, Streams};
use opm_core::manipulator::{ActuatedJoints, AllModes, Manipulator, Mode, PoseError, Solution};
use opm_core::mechanism::file::FileUnits;
use opm_mcap::csv;
use std::fmt::Display;
use std::path::Path;
use std::time::Instant;

/// The requested working modes.
#[derive(Clone, Copy)]
pub enum Modes {
    All,
    One(Mode),
}

/// What the rows hold.
#[derive(Clone, Copy)]
struct RowContent {
    modes: Modes,
    /// Whether they have every joint, and not the actuated ones alone.
    all_joints: bool,
}

pub fn run(
    args: &IkArgs,
    output: &Output,
    loaded: &Loaded,
    manipulator: &Manipulator,
    modes: Modes,
) -> Result<(), Failure> {
    let input = args.poses.as_deref().unwrap_or(Path::new("-"));
    let streams = Streams { input, output: args.output.as_deref() };
    let wanted = RowContent { modes, all_joints: args.all_joints };
    let solve = |stream: Stream<'_>| solve(stream, (loaded, manipulator), wanted);
    let Some(totals) = stream::run(&streams, output, loaded, solve)? else { return Ok(()) };
    totals.tell(&streams, output, &totals)
}

fn solve(
    mut stream: Stream<'_>,
    (loaded, manipulator): (&Loaded, &Manipulator),
    wanted: RowContent,
) -> Result<Totals, Stop> {
    let start = Instant::now();
    let mut columns = pose_table::columns(&mut stream, (loaded, manipulator))?;
    let mut table = Rows::new((loaded, manipulator), wanted, columns.timed(), &mut stream.rows)?;
    let mut values = pose_table::blank(manipulator);
    stream.each(&mut columns, &mut values, |stream, line, time, values| {
        table.time = time;
        let label = stream.label;
        let wrong = |error: &dyn Display| stream::at(label, line, error);
        table.row(pose_table::split(manipulator, values), &mut stream.rows, &wrong)
    })?;
    Ok(Totals::new(&stream, start, [table.reachable, table.within_limits]))
}

/// The rows of the result.
struct Rows<'a> {
    manipulator: &'a Manipulator,
    units: FileUnits,
    wanted: RowContent,
    /// The name of the mode, if one is requested.
    mode: String,
    /// The numbers of the joint coordinates that are columns.
    joints: Vec<usize>,
    drives: ActuatedJoints,
    all: AllModes,
    solution: Solution,
    /// The time of the pose, if the input has times.
    time: Option<f64>,
    /// Imaginary joints, then the other joints; empty if the pose is out of reach.
    cells: Vec<Option<f64>>,
    /// Dependent coordinates; empty if they have no solution.
    dependent: Vec<Option<f64>>,
    reachable: u64,
    within_limits: u64,
}

impl<'a> Rows<'a> {
    fn new(
        (loaded, manipulator): (&Loaded, &'a Manipulator),
        wanted: RowContent,
        timed: bool,
        writer: &mut csv::Rows<'_>,
    ) -> Result<Self, Stop> {
        let coordinates = manipulator.coordinates();
        let joints = match wanted.all_joints {
            true => (0..coordinates.len()).collect(),
            false => manipulator.actuated().to_vec(),
        };
        let header: Vec<&str> = (timed.then_some("t").into_iter())
            .chain(manipulator.task_coordinates().iter().map(|c| c.name))
            .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
            .chain(["reachable", "within_limits", MODE])
            .chain(manipulator.imaginary().iter().map(|joint| &*joint.name))
            .chain(joints.iter().map(|&i| &*coordinates[i].name))
            .collect();
        writer.header(header)?;
        let mode = match wanted.modes {
            Modes::One(mode) => manipulator.format_mode(mode),
            Modes::All => String::new(),
        };
        Ok(Self {
            manipulator,
            units: loaded.file.units,
            wanted,
            mode,
            joints,
            drives: manipulator.actuated_joints(),
            all: manipulator.all_modes(),
            solution: manipulator.solution(),
            time: None,
            cells: Vec::new(),
            dependent: Vec::new(),
            reachable: 0,
            within_limits: 0,
        })
    }

    /// Writes the row of a pose; with all modes, one row for each mode that reaches it. The values that are given of
    /// dependent coordinates are checked where the pose is in reach.
    fn row(
        &mut self,
        (pose, checks): (&[f64], Checks),
        writer: &mut csv::Rows<'_>,
        wrong: &dyn Fn(&dyn Display) -> Failure,
    ) -> Result<(), Stop> {
        let manipulator = self.manipulator;
        let of_pose = |error: PoseError| wrong(&error);
        match self.wanted.modes {
            Modes::One(mode) => {
                let [reachable, within] = if self.wanted.all_joints {
                    let found =
                        manipulator.inverse(pose, mode, &mut self.solution).map_err(of_pose)?;
                    let answers = [found.is_some(), found.is_some_and(Solution::within_limits)];
                    self.take_solution(answers[0]);
                    answers
                } else {
                    let found = manipulator.inverse_actuated(pose, mode, &mut self.drives);
                    let found = found.map_err(of_pose)?;
                    let answers =
                        [found.is_some(), found.is_some_and(ActuatedJoints::within_limits)];
                    let joints = self.drives.imaginary().iter().chain(self.drives.actuated());
                    fill(&mut self.cells, joints.copied(), answers[0]);
                    answers
                };
                self.reachable += u64::from(reachable);
                self.within_limits += u64::from(within);
                let dependent = manipulator.dependent_values(pose, mode).ok().flatten();
                if reachable && let Some(values) = &dependent {
                    let verified = checks.verify(manipulator, values, self.units);
                    verified.map_err(|error| wrong(&error))?;
                }
                self.depend(dependent.as_deref());
                self.write(writer, pose, [reachable, within], &self.mode)
            }
            Modes::All => {
                let found = manipulator.inverse_all(pose, &mut self.all).map_err(of_pose)?;
                let reachable = found.is_some();
                self.reachable += u64::from(reachable);
                if !reachable {
                    self.take_solution(false);
                    self.depend(None);
                    return self.write(writer, pose, [false, false], "");
                }
                let (mut any_within, mut held) = (false, 0);
                let found: Vec<_> = self.all.modes(manipulator).collect();
                for &mode in &found {
                    let solution =
                        manipulator.solution_in_mode(&self.all, mode, &mut self.solution);
                    let Some(solution) = solution else { continue };
                    if !checks.hold(manipulator, solution.dependent()) {
                        continue;
                    }
                    held += 1;
                    let within = solution.within_limits();
                    self.dependent.clear();
                    self.dependent.extend(solution.dependent().iter().map(|&value| Some(value)));
                    self.take_solution(true);
                    any_within |= within;
                    self.write(writer, pose, [true, within], &manipulator.format_mode(mode))?;
                }
                self.within_limits += u64::from(any_within);
                match held {
                    0 => Err(wrong(&Checks::refusal(found.len())).into()),
                    _ => Ok(()),
                }
            }
        }
    }

    /// Takes the joints of the solution, if the pose is in reach.
    fn take_solution(&mut self, reachable: bool) {
        let solution = &self.solution;
        let joints = self.joints.iter().map(|&i| solution.joints()[i]);
        let joints = solution.imaginary().iter().copied().chain(joints);
        fill(&mut self.cells, joints, reachable);
    }

    /// Takes the values of the dependent coordinates, if they have some.
    fn depend(&mut self, values: Option<&[f64]>) {
        let count = self.manipulator.dependent_coordinates().len();
        self.dependent.clear();
        self.dependent.extend((0..count).map(|i| values.map(|values| values[i])));
    }

    /// Writes a row; `answers` are whether the pose is in reach, and within limits.
    fn write(
        &self,
        writer: &mut csv::Rows<'_>,
        pose: &[f64],
        answers: [bool; 2],
        mode: &str,
    ) -> Result<(), Stop> {
        pose_table::begin(writer, self.time, pose, &self.dependent, answers, mode)?;
        writer.cells(&self.cells)?;
        Ok(writer.end()?)
    }
}

fn fill(cells: &mut Vec<Option<f64>>, joints: impl Iterator<Item = f64>, reachable: bool) {
    cells.clear();
    cells.extend(joints.map(|value| reachable.then_some(value)));
}
