//! The table of a motion: a row for each sample, as CSV or as NPY.

use super::judged::Judged;
use super::{create, refuse_standard_output};
use crate::error::{RequestError, StudyError};
use crate::motion::{Driven, MotionRequest, MotionSummary, Reacting};
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_core::trajectory::{Sample, Trajectory};
use opm_mcap::csv::distinct;
use opm_mcap::{RecordError, TableRecorder};
use std::io::{self, Write};
use std::path::Path;

/// What the table of a motion has beside the time, the task coordinates and the joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TableOptions {
    /// The first derivatives by time, as `d.NAME`.
    pub rates: bool,
    /// The second derivatives by time, as `dd.NAME`.
    pub accelerations: bool,
    /// Units of a file, which the header then names: `S1 [mm]`. If not given, SI and radians without a name.
    pub units: Option<FileUnits>,
}

/// A format of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    Npy,
}

/// The columns of a table: `t`, task coordinates, dependent coordinates, joints, imaginary joints; then the rates of
/// all of them but `t`, in the same order, and their accelerations; then efforts, reactions, and indices.
struct Columns<'a> {
    options: TableOptions,
    indices: Option<Judged<'a>>,
    efforts: Option<Driven<'a>>,
    reactions: Option<Reacting<'a>>,
    /// The columns of efforts, then of reactions, with their units.
    forces: Vec<(String, &'static str)>,
    /// Names and quantities, without `t`.
    coordinates: Vec<(String, Quantity)>,
}

impl<'a> Columns<'a> {
    fn new(request: &MotionRequest<'a>, options: TableOptions) -> Self {
        let manipulator = request.manipulator;
        let indices = Judged::of(request);
        let tasks = manipulator.task_coordinates().iter();
        let tasks = tasks.chain(manipulator.dependent_coordinates());
        let joints = manipulator.coordinates().iter().map(|c| (c.name.clone(), c.quantity));
        let imaginary = manipulator.imaginary().iter().map(|j| (j.name.clone(), j.quantity));
        let coordinates =
            tasks.map(|c| (c.name.to_owned(), c.quantity)).chain(joints).chain(imaginary).collect();
        let efforts = request.efforts.map(|setup| Driven::new(manipulator, setup));
        let reactions = request.reactions.and_then(|setup| Reacting::new(manipulator, setup));
        let own = efforts.iter().flat_map(|_| Driven::columns(manipulator));
        let through = reactions.iter().flat_map(|_| Reacting::columns(manipulator));
        let forces = own.chain(through).collect();
        Self { options, indices, efforts, reactions, forces, coordinates }
    }

    /// The prefix of the name and the suffix of the unit of each derivative that is asked for.
    fn derivatives(&self) -> impl Iterator<Item = (usize, &'static str, &'static str)> {
        let TableOptions { rates, accelerations, .. } = self.options;
        [(0, "", "", true), (1, "d.", "/s", rates), (2, "dd.", "/s2", accelerations)]
            .into_iter()
            .filter_map(|(order, name, unit, asked)| asked.then_some((order, name, unit)))
    }

    /// The names of the columns.
    ///
    /// # Errors
    /// Two are the same: a joint is called like another column.
    fn header(&self) -> io::Result<Vec<String>> {
        let units = self.options.units;
        let mut names = vec![if units.is_some() { "t [s]" } else { "t" }.to_owned()];
        for (_, prefix, per) in self.derivatives() {
            names.extend(self.coordinates.iter().map(|(name, quantity)| match units {
                Some(units) => format!("{prefix}{name} [{}{per}]", units.symbol(*quantity)),
                None => format!("{prefix}{name}"),
            }));
        }
        names.extend(self.forces.iter().map(|(name, unit)| match units {
            Some(_) => format!("{name} [{unit}]"),
            None => name.clone(),
        }));
        for (name, unit) in self.indices.iter().flat_map(Judged::columns) {
            names.push(match (units, unit) {
                (None, _) | (_, "") => name.to_owned(),
                (Some(_), unit) => format!("{name} [{unit}]"),
            });
        }
        distinct(names.iter().map(String::as_str))?;
        Ok(names)
    }

    /// The numbers of a sample; not a number where there is none.
    fn write(&mut self, sample: &Sample, row: &mut Vec<f64>) {
        let Sample { time, instant, solution, motion, reached, .. } = sample;
        let moving = *reached && sample.regular;
        row.clear();
        row.push(*time);
        for (order, ..) in self.derivatives() {
            let known = if order == 0 { *reached } else { moving };
            let parts: [&[f64]; 4] = match order {
                0 => {
                    let (dependent, joints) = (solution.dependent(), solution.joints());
                    [&instant.pose, dependent, joints, solution.imaginary()]
                }
                1 => [
                    &instant.velocity,
                    &motion.dependent_rates,
                    &motion.joint_rates,
                    &motion.imaginary_rates,
                ],
                _ => [
                    &instant.acceleration,
                    &motion.dependent_accelerations,
                    &motion.joint_accelerations,
                    &motion.imaginary_accelerations,
                ],
            };
            let values = parts.iter().enumerate().flat_map(|(number, part)| {
                let known = known || number == 0;
                part.iter().map(move |&value| if known { value } else { f64::NAN })
            });
            row.extend(values.zip(&self.coordinates).map(|(value, (_, quantity))| {
                value / self.options.units.map_or(1.0, |units| units.factor(*quantity))
            }));
        }
        if let Some(efforts) = &mut self.efforts {
            row.extend(efforts.values(sample));
        }
        if let Some(reactions) = &mut self.reactions {
            row.extend(reactions.values(sample));
        }
        if let Some(indices) = &mut self.indices {
            row.extend(indices.values(reached.then_some(solution)));
        }
    }
}

/// Writes a motion as CSV while it is followed: see [`MotionRequest::follow`]. A cell without a number is empty: all
/// but the time and the pose where the pose is out of reach, and rates where a joint has none.
///
/// # Errors
/// A pose is not finite, a write fails ([`StudyError::Record`] for `place`), or the work was cancelled.
pub fn write_motion_csv(
    request: MotionRequest<'_>,
    trajectory: Trajectory<'_>,
    options: TableOptions,
    (place, output): (&str, &mut dyn Write),
    go_on: impl Fn(u64) -> bool,
) -> Result<MotionSummary, StudyError> {
    let mut columns = Columns::new(&request, options);
    let failed = |error: io::Error| StudyError::record(place, RecordError::Io(error));
    let mut output = io::BufWriter::new(output);
    let header = columns.header().map_err(failed)?;
    writeln!(output, "{}", header.join(",")).map_err(failed)?;
    let (mut row, mut line) = (Vec::new(), Vec::new());
    let take = |_, sample: &Sample, _: &[_]| {
        columns.write(sample, &mut row);
        line.clear();
        for (number, value) in row.iter().enumerate() {
            let comma = if number == 0 { "" } else { "," };
            let written = match value.is_nan() {
                true => write!(line, "{comma}"),
                false => write!(line, "{comma}{value:?}"),
            };
            written.map_err(failed)?;
        }
        line.push(b'\n');
        output.write_all(&line).map_err(failed)
    };
    let summary = request.follow(trajectory, take, go_on)?;
    output.flush().map_err(failed)?;
    Ok(summary)
}

/// Writes a motion as a table in a file while it is followed, in the format of the name's ending: `.csv`, or `.npy` for
/// a structured array with a float64 field for each column. It has not a number where CSV has an empty cell. The file
/// gets its name when it is whole.
///
/// # Errors
/// The name ends otherwise, the file cannot be written, a pose is not finite, or the work was cancelled.
pub fn write_motion_table(
    request: MotionRequest<'_>,
    trajectory: Trajectory<'_>,
    options: TableOptions,
    path: &Path,
    go_on: impl Fn(u64) -> bool,
) -> Result<MotionSummary, StudyError> {
    let format = format(path)?;
    let place = path.display().to_string();
    let failed = |error| StudyError::record(&place, error);
    let mut file = create(path)?;
    match format {
        Format::Csv => {
            let output = (&*place, &mut file as &mut dyn Write);
            let summary = write_motion_csv(request, trajectory, options, output, go_on)?;
            file.commit().map_err(|error| failed(RecordError::Io(error)))?;
            Ok(summary)
        }
        Format::Npy => {
            let mut columns = Columns::new(&request, options);
            let header = columns.header().map_err(|error| failed(RecordError::Io(error)))?;
            let names: Vec<&str> = header.iter().map(String::as_str).collect();
            let samples = trajectory.samples();
            let mut table = TableRecorder::npy(file, &names, samples).map_err(failed)?;
            let mut row = Vec::new();
            let take = |_, sample: &Sample, _: &[_]| {
                columns.write(sample, &mut row);
                table.push_rows(&row).map_err(failed)
            };
            let summary = request.follow(trajectory, take, go_on)?;
            table.finish().map_err(failed)?;
            Ok(summary)
        }
    }
}

/// Whether a name is that of a table of a motion: it ends in `.csv` or `.npy`.
pub fn is_motion_table(path: &Path) -> bool {
    format(path).is_ok()
}

fn format(path: &Path) -> Result<Format, RequestError> {
    refuse_standard_output(path)?;
    let ending = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
    if ending("csv") {
        Ok(Format::Csv)
    } else if ending("npy") {
        Ok(Format::Npy)
    } else {
        Err(RequestError::TableEnding { path: path.to_owned() })
    }
}
