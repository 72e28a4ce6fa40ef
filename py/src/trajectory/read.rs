//! The motion that is asked for: of a file, a table of poses, waypoints, or a shipped one.

use crate::arguments;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::rows::Rows;
use opm_core::motion::table::{Advice, TableOptions};
use opm_core::motion::{Ends, Instant, Path as MotionPath, PlatformMotion, examples, file, table};
use opm_core::table::{ColumnNames, Suggestion};
use opm_mcap::input::Expected;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;
use std::path::Path;

/// A motion, the name of its file, and the text of that.
pub(super) type Read = (PlatformMotion, String, String);

/// How a file is read, if it is a table of poses.
#[derive(Clone, Copy, Default)]
pub(super) struct Reading<'a> {
    /// How the motion starts and ends.
    pub ends: Option<Ends>,
    /// Which columns are read, and by which names.
    pub columns: Option<&'a ColumnNames>,
    /// Whether times count from that of the first row.
    pub relative_time: bool,
}

/// How columns are chosen.
fn chosen(suggestion: &Suggestion) -> String {
    let pairs = suggestion.0.iter().map(|(name, heading)| format!("{name:?}: {heading:?}"));
    let pairs = pairs.collect::<Vec<_>>().join(", ");
    format!("; columns={{{pairs}}} says which columns to read")
}

/// Waypoints as a table of poses, one second apart if they have no times.
pub(super) fn through(
    manipulator: &Manipulator,
    poses: &Bound<'_, PyAny>,
    times: Option<&[f64]>,
    ends: Ends,
) -> PyResult<Read> {
    let names = manipulator.pose_names();
    let poses = manipulator.poses_of(poses, "motion")?.in_order("motion", &names)?;
    let poses = Rows::new(&poses)?;
    let seconds: Vec<f64> = (0..poses.count).map(|row| row as f64).collect();
    let times = times.unwrap_or(&seconds);
    if poses.count != times.len() {
        let (poses, times) = (poses.count, times.len());
        return Err(wrong(format!("{times} times for {poses} poses, expected one for each pose")));
    }
    for row in 0..poses.count {
        if let Some(number) = poses.row(row).iter().position(|value| !value.is_finite()) {
            let (name, value) = (names[number], poses.row(row)[number]);
            return Err(wrong(format!("waypoint {row}: {name} is {value:?}, expected a number")));
        }
    }
    let mut text = ["t"].into_iter().chain(names).collect::<Vec<_>>().join(",");
    for (row, time) in times.iter().enumerate() {
        let cells = [time].into_iter().chain(poses.row(row)).map(|value| format!("{value:?}"));
        text = text + "\n" + &cells.collect::<Vec<_>>().join(",");
    }
    text.push('\n');
    let options = TableOptions { ends, ..Default::default() };
    let read = table::read(&text, "waypoints", &manipulator.inner, &options).map_err(|errors| {
        // The first line is the header, and poses count from zero.
        let lines = errors.problems.iter().map(|problem| match problem.line {
            0 | 1 => problem.message.clone(),
            line => format!("waypoint {}: {}", line - 2, problem.message),
        });
        wrong(lines.collect::<Vec<_>>().join("\n"))
    })?;
    Ok((read.motion, "waypoints.csv".to_owned(), text))
}

/// The motion of a file or of a table of poses, or a shipped motion.
pub fn motion(manipulator: &Manipulator, given: &Bound<'_, PyAny>) -> PyResult<PlatformMotion> {
    read(manipulator, given, Reading::default()).map(|(motion, ..)| motion)
}

/// A motion file, a table of poses, or a shipped motion: an existing path wins.
pub(super) fn read(
    manipulator: &Manipulator,
    motion: &Bound<'_, PyAny>,
    reading: Reading<'_>,
) -> PyResult<Read> {
    let path = arguments::path(motion).map_err(|_| {
        let expected = "a path, the name of a shipped motion, or poses with times";
        wrong(format!("motion is {}, expected {expected}", arguments::shown(motion)))
    })?;
    let label = path.display().to_string();
    let (text, name) = match examples::find(&label).filter(|_| !path.exists()) {
        Some(example) => (example.text.to_owned(), format!("{}.toml", example.name)),
        None => {
            let table = table::is_table(&path);
            let expected = if table { Expected::POSES } else { Expected::MOTION };
            let text = arguments::text(motion.py(), &path, expected, "")?;
            (text, path.file_name().map_or(label.clone(), |n| n.display().to_string()))
        }
    };
    let (read, doubts) = parse(manipulator, &text, (&name, &label), reading)?;
    for (line, doubt) in doubts {
        let message = CString::new(format!("{label}:{line}: {doubt}"))?;
        PyErr::warn(motion.py(), &motion.py().get_type::<PyUserWarning>(), &message, 1)?;
    }
    // Whoever reads the text again has to find the same motion in it.
    let text = match &read.path {
        MotionPath::Spline(_) if reading.columns.is_some() || reading.relative_time => {
            as_table(manipulator, &read)
        }
        _ => text,
    };
    Ok((read, name, text))
}

/// The points of a spline as a table of poses with the names of the mechanism, in SI.
fn as_table(manipulator: &Manipulator, motion: &PlatformMotion) -> String {
    let MotionPath::Spline(spline) = &motion.path else { return String::new() };
    let mut instant = Instant::new(motion.coordinate_count());
    let mut text = ["t"].into_iter().chain(manipulator.pose_names()).collect::<Vec<_>>().join(",");
    text.push('\n');
    for &time in spline.times() {
        motion.at(time, &mut instant);
        let cells = [time].into_iter().chain(instant.pose.iter().copied());
        text += &cells.map(|value| format!("{value:?}")).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

/// The ends of this name.
pub(super) fn spline_ends(name: &str) -> PyResult<Ends> {
    let found = Ends::NAMES.iter().find(|(known, _)| *known == name);
    found.map(|(_, ends)| *ends).ok_or_else(|| {
        let names = Ends::NAMES.map(|(name, _)| format!("{name:?}")).join(", ");
        wrong(format!("ends: {name:?}, expected one of {names}"))
    })
}

/// The motion in the text of a file of this name; messages call it `label`.
pub(super) fn parse(
    manipulator: &Manipulator,
    text: &str,
    (name, label): (&str, &str),
    Reading { ends, columns, relative_time }: Reading<'_>,
) -> PyResult<(PlatformMotion, Vec<(u64, String)>)> {
    let (inner, path) = (&manipulator.inner, Path::new(name));
    let csv = table::is_table(path);
    let stem = path.file_stem().map_or_else(|| label.to_owned(), |s| s.display().to_string());
    let advice = Advice { columns: chosen, relative_time: "relative_time=True" };
    let ends_or_rest = ends.unwrap_or_default();
    let options =
        TableOptions { ends: ends_or_rest, columns, relative_time, advice, ..Default::default() };
    let motion = match ends {
        _ if csv => {
            table::read(text, &stem, inner, &options).map(|read| (read.motion, read.doubts))
        }
        _ if columns.is_some() || relative_time => {
            let given = if columns.is_some() { "columns" } else { "relative_time" };
            let problem = "a motion file has its own names and times, expected a CSV file";
            return Err(wrong(format!("{given}: {problem}")));
        }
        Some(ends) => {
            let problem = "a motion file says it itself, beside its points:";
            return Err(wrong(format!("ends: {problem} ends = {:?}", ends.name())));
        }
        None => file::read(text, inner).map(|motion| (motion, Vec::new())),
    };
    motion.map_err(|errors| wrong(errors.in_file(label)))
}
