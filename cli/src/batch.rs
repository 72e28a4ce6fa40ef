//! `opm ik --poses`: a CSV file of poses in, one of joint values out, row by row.

use crate::args::{IkArgs, Output};
use crate::failure::Failure;
use crate::ik::{beyond, nearest};
use crate::load::Loaded;
use crate::pose::Checks;
use crate::pose_table::{self, Totals};
use crate::stream::{self, BEYOND, DISTANCE, MODE, Stream, StreamStop, Streams, UNREACHABLE};
use crate::transform::Located;
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
    /// Whether they name the legs that do not reach, and the joints beyond limits.
    failures: bool,
    /// The characteristic length by which the nearest pose in reach is looked for, metres.
    nearest: Option<f64>,
}

pub fn run(
    args: &IkArgs,
    output: &Output,
    loaded: &Loaded,
    manipulator: &Manipulator,
    modes: Modes,
) -> Result<(), Failure> {
    let input = args.poses.as_deref().unwrap_or(Path::new("-"));
    let (target, columns) = (args.output.as_deref(), args.columns.as_ref());
    let streams = Streams { input, output: target, columns };
    let nearest = args.nearest.then(|| nearest::length(args, manipulator)).transpose()?;
    let (all_joints, failures) = (args.all_joints, args.failures);
    let wanted = RowContent { modes, all_joints, failures, nearest };
    let solve = |stream: Stream<'_>| solve(stream, (loaded, manipulator), wanted);
    let Some(totals) = stream::run(&streams, output, loaded, solve)? else { return Ok(()) };
    totals.tell(&streams, output, &totals)
}

fn solve(
    mut stream: Stream<'_>,
    (loaded, manipulator): (&Loaded, &Manipulator),
    wanted: RowContent,
) -> Result<Totals, StreamStop> {
    let start = Instant::now();
    let (mut columns, places) = pose_table::columns_or_places(&mut stream, (loaded, manipulator))?;
    let mut table = Rows::new((loaded, manipulator), wanted, columns.timed(), &mut stream.rows)?;
    stream.each(
        &mut columns,
        &pose_table::blank_or_places(manipulator),
        |stream, line, time, values| {
            table.time = time;
            let label = stream.label;
            let wrong = |error: &dyn Display| stream::at(label, line, error);
            if !places {
                return table.answer(
                    pose_table::split(manipulator, values),
                    &mut stream.rows,
                    &wrong,
                );
            }
            let place =
                pose_table::transform(manipulator, values).map_err(|error| wrong(&error))?;
            let mode = match wanted.modes {
                Modes::One(mode) => mode,
                Modes::All => manipulator.home_mode(),
            };
            match place.locate(manipulator, mode) {
                Located::Pose(pose) => {
                    table.answer((&pose, Checks::of_row(&[])), &mut stream.rows, &wrong)
                }
                Located::Outside(outside) => table.outside(&outside.nearest, &mut stream.rows),
            }
        },
    )?;
    if table.outside > 0 {
        stream.note(format_args!(
            "{} outside the manipulator's motion: the rows have the nearest pose of the motion, and no joints",
            match table.outside {
                1 => "1 place is".to_owned(),
                number => format!("{number} places are"),
            }
        ));
    }
    Ok(Totals::new(&stream, start, [table.reachable, table.within_limits]))
}

/// The rows of the result.
struct Rows<'a> {
    manipulator: &'a Manipulator,
    units: FileUnits,
    wanted: RowContent,
    /// The name of the mode, if one is requested.
    mode: String,
    /// The places of the joints that are columns among those that are found.
    joints: Vec<usize>,
    drives: ActuatedJoints,
    all: AllModes,
    solution: Solution,
    /// What a pose that fails is solved with once more.
    failed: Solution,
    /// The time of the pose, if the input has times.
    time: Option<f64>,
    /// How far away the pose is that was asked for, metres; `None` where no pose in reach was found.
    distance: Option<f64>,
    /// How many places no pose has.
    outside: u64,
    reachable: u64,
    within_limits: u64,
}

impl<'a> Rows<'a> {
    fn new(
        (loaded, manipulator): (&Loaded, &'a Manipulator),
        wanted: RowContent,
        timed: bool,
        writer: &mut csv::Rows<'_>,
    ) -> Result<Self, StreamStop> {
        let coordinates = manipulator.coordinates();
        let joints = match wanted.all_joints {
            true => (0..coordinates.len()).collect(),
            false => manipulator.actuated().to_vec(),
        };
        let header: Vec<&str> = (timed.then_some("t").into_iter())
            .chain(manipulator.task_coordinates().iter().map(|c| c.name))
            .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
            .chain(["reachable", "within_limits", MODE])
            .chain(wanted.nearest.map(|_| DISTANCE))
            .chain(wanted.failures.then_some([UNREACHABLE, BEYOND]).into_iter().flatten())
            .chain(manipulator.imaginary().iter().map(|joint| &*joint.name))
            .chain(joints.iter().map(|&i| &*coordinates[i].name))
            .collect();
        writer.header(header)?;
        // In one mode, no other joints are found.
        let places = match wanted.modes {
            Modes::One(_) => (0..joints.len()).collect(),
            Modes::All => joints,
        };
        let mode = match wanted.modes {
            Modes::One(mode) => manipulator.format_mode(mode),
            Modes::All => String::new(),
        };
        Ok(Self {
            manipulator,
            units: loaded.file.units,
            wanted,
            mode,
            joints: places,
            drives: manipulator.actuated_joints(),
            all: manipulator.all_modes(),
            solution: manipulator.solution(),
            failed: manipulator.solution(),
            time: None,
            distance: None,
            outside: 0,
            reachable: 0,
            within_limits: 0,
        })
    }

    /// Writes the row of a place that no pose has; `nearest` is the pose of the motion that is nearest to it.
    fn outside(&mut self, nearest: &[f64], writer: &mut csv::Rows<'_>) -> Result<(), StreamStop> {
        self.outside += 1;
        let Self { manipulator, time, joints, wanted, .. } = &*self;
        let distance = wanted.nearest.map(|_| None);
        let row = PoseRow { manipulator, time: *time, pose: nearest, joints, distance };
        let failures = wanted.failures.then(Failures::default);
        row.write(writer, None, (false, "", failures), None)
    }

    /// Writes the row of a pose, or that of the nearest one in reach, if that is asked for.
    fn answer(
        &mut self,
        (pose, checks): (&[f64], Checks),
        writer: &mut csv::Rows<'_>,
        wrong: &dyn Fn(&dyn Display) -> Failure,
    ) -> Result<(), StreamStop> {
        self.distance = Some(0.0);
        let Some(length) = self.wanted.nearest else {
            return self.row((pose, checks), writer, wrong);
        };
        let found = nearest::pose(self.manipulator, self.wanted.modes, pose, length)?;
        self.distance = found.as_ref().map(|found| found.distance);
        match found {
            Some(found) if found.distance > 0.0 => {
                self.row((&found.pose, Checks::of_row(&[])), writer, wrong)
            }
            _ => self.row((pose, checks), writer, wrong),
        }
    }

    /// Writes the row of a pose; with all modes, one row for each mode that reaches it. The values that are given of
    /// dependent coordinates are checked where the pose is in reach.
    fn row(
        &mut self,
        (pose, checks): (&[f64], Checks),
        writer: &mut csv::Rows<'_>,
        wrong: &dyn Fn(&dyn Display) -> Failure,
    ) -> Result<(), StreamStop> {
        let (manipulator, time, joints) = (self.manipulator, self.time, &*self.joints);
        let distance = self.wanted.nearest.map(|_| self.distance);
        let row = PoseRow { manipulator, time, pose, joints, distance };
        let of_pose = |error: PoseError| wrong(&error);
        match self.wanted.modes {
            Modes::One(mode) => {
                let (joints, within) = if self.wanted.all_joints {
                    let found =
                        manipulator.inverse(pose, mode, &mut self.solution).map_err(of_pose)?;
                    let joints = found.map(|found| [found.imaginary(), found.joints()]);
                    (joints, found.is_some_and(Solution::within_limits))
                } else {
                    let found = manipulator.inverse_actuated(pose, mode, &mut self.drives);
                    let found = found.map_err(of_pose)?;
                    let joints = found.map(|found| [found.imaginary(), found.actuated()]);
                    (joints, found.is_some_and(ActuatedJoints::within_limits))
                };
                self.reachable += u64::from(joints.is_some());
                self.within_limits += u64::from(within);
                let mut dependent = None;
                if !manipulator.dependent_coordinates().is_empty() {
                    dependent = manipulator.dependent_values(pose, mode).ok().flatten();
                    if let (Some(_), Some(values)) = (joints, &dependent) {
                        let verified = checks.verify(manipulator, values, self.units);
                        verified.map_err(|error| wrong(&error))?;
                    }
                }
                let failures = self.wanted.failures.then(|| match (joints.is_some(), within) {
                    (true, true) => Ok(Failures::default()),
                    _ => Failures::of(manipulator, pose, mode, &mut self.failed),
                });
                let failures = failures.transpose().map_err(of_pose)?;
                row.write(writer, dependent.as_deref(), (within, &self.mode, failures), joints)
            }
            Modes::All => {
                let found = manipulator.inverse_all(pose, &mut self.all).map_err(of_pose)?;
                let reachable = found.is_some();
                self.reachable += u64::from(reachable);
                if !reachable {
                    let legs = self.all.unreachable().map(|missed| missed.leg);
                    let failures =
                        self.wanted.failures.then(|| Failures::legs(manipulator, legs.collect()));
                    return row.write(writer, None, (false, "", failures), None);
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
                    any_within |= within;
                    let (dependent, mode) =
                        (Some(solution.dependent()), manipulator.format_mode(mode));
                    let joints = Some([solution.imaginary(), solution.joints()]);
                    let failures = self.wanted.failures.then(|| Failures {
                        beyond: beyond(manipulator, solution).join(" "),
                        ..Failures::default()
                    });
                    row.write(writer, dependent, (within, &mode, failures), joints)?;
                }
                self.within_limits += u64::from(any_within);
                match held {
                    0 => Err(wrong(&Checks::refusal(found.len())).into()),
                    _ => Ok(()),
                }
            }
        }
    }
}

/// Why a pose fails: names with a space between them.
#[derive(Default)]
struct Failures {
    unreachable: String,
    beyond: String,
}

impl Failures {
    /// Those of a pose in a mode.
    fn of(
        manipulator: &Manipulator,
        pose: &[f64],
        mode: Mode,
        buffer: &mut Solution,
    ) -> Result<Self, PoseError> {
        if let Some(solution) = manipulator.inverse(pose, mode, buffer)? {
            return Ok(Self { beyond: beyond(manipulator, solution).join(" "), ..Self::default() });
        }
        let legs = buffer.unreachable().iter().map(|missed| missed.leg);
        Ok(Self::legs(manipulator, legs.collect()))
    }

    /// Legs that do not reach, by their numbers.
    fn legs(manipulator: &Manipulator, mut legs: Vec<usize>) -> Self {
        legs.sort_unstable();
        legs.dedup();
        let all = &manipulator.mechanism().legs;
        let names: Vec<&str> = legs.into_iter().map(|leg| &*all[leg].name).collect();
        Self { unreachable: names.join(" "), ..Self::default() }
    }
}

/// What is written about a pose.
struct PoseRow<'a> {
    manipulator: &'a Manipulator,
    time: Option<f64>,
    pose: &'a [f64],
    /// The places of the joints that are columns.
    joints: &'a [usize],
    /// How far away the pose is that was asked for, if that is a column.
    distance: Option<Option<f64>>,
}

impl PoseRow<'_> {
    /// Writes the row of a mode: the dependent coordinates if they are known, whether the pose is within limits, and, if it is
    /// in reach, the imaginary joints and the other ones.
    fn write(
        &self,
        writer: &mut csv::Rows<'_>,
        dependent: Option<&[f64]>,
        (within, mode, failures): (bool, &str, Option<Failures>),
        joints: Option<[&[f64]; 2]>,
    ) -> Result<(), StreamStop> {
        let manipulator = self.manipulator;
        let dependent = (dependent, manipulator.dependent_coordinates().len());
        let answers = [joints.is_some(), within];
        pose_table::begin(writer, self.time, self.pose, dependent, answers, mode)?;
        writer.cells(self.distance.as_slice())?;
        if let Some(Failures { unreachable, beyond }) = failures {
            writer.text(&unreachable)?;
            writer.text(&beyond)?;
        }
        writer.known(joints.map(|[imaginary, _]| imaginary), manipulator.imaginary().len())?;
        writer.selected(joints.map(|[_, others]| others), self.joints)?;
        Ok(writer.end()?)
    }
}
