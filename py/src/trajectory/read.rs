//! The motion that is asked for: of a file, a table of poses, waypoints, or a shipped one.

use crate::arguments;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::rows::Rows;
use opm_core::motion::{Ends, PlatformMotion, examples, file, table};
use opm_mcap::input::Expected;
use pyo3::prelude::*;
use std::path::Path;

/// A motion, the name of its file, and the text of that.
pub(super) type Read = (PlatformMotion, String, String);

/// Waypoints as a table of poses, one second apart if they have no times.
pub(super) fn through(
    manipulator: &Manipulator,
    poses: &Bound<'_, PyAny>,
    times: Option<&[f64]>,
    ends: Ends,
) -> PyResult<Read> {
    let poses = manipulator.poses_of(poses, "motion")?;
    let poses = Rows::new(&poses)?;
    let seconds: Vec<f64> = (0..poses.count).map(|row| row as f64).collect();
    let times = times.unwrap_or(&seconds);
    if poses.count != times.len() {
        let (poses, times) = (poses.count, times.len());
        return Err(wrong(format!("{times} times for {poses} poses, expected one for each pose")));
    }
    let names = manipulator.pose_names();
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
    let motion = table::read(&text, "waypoints", &manipulator.inner, ends).map_err(|errors| {
        // The first line is the header, and poses count from zero.
        let lines = errors.problems.iter().map(|problem| match problem.line {
            0 | 1 => problem.message.clone(),
            line => format!("waypoint {}: {}", line - 2, problem.message),
        });
        wrong(lines.collect::<Vec<_>>().join("\n"))
    })?;
    Ok((motion, "waypoints.csv".to_owned(), text))
}

/// The motion of a file or of a table of poses, or a shipped motion.
pub fn motion(manipulator: &Manipulator, given: &Bound<'_, PyAny>) -> PyResult<PlatformMotion> {
    read(manipulator, given, None).map(|(motion, ..)| motion)
}

/// A motion file, a table of poses, or a shipped motion: an existing path wins.
pub(super) fn read(
    manipulator: &Manipulator,
    motion: &Bound<'_, PyAny>,
    ends: Option<Ends>,
) -> PyResult<Read> {
    let expected = "motion: expected a path, the name of a shipped motion, or poses with times";
    let path = arguments::path(motion).map_err(|_| wrong(expected))?;
    let label = path.display().to_string();
    let (text, name) = match examples::find(&label).filter(|_| !path.exists()) {
        Some(example) => (example.text.to_owned(), format!("{}.toml", example.name)),
        None => {
            let table = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
            let expected = if table { Expected::POSES } else { Expected::MOTION };
            let text = arguments::text(motion.py(), &path, expected, "")?;
            (text, path.file_name().map_or(label.clone(), |n| n.display().to_string()))
        }
    };
    let motion = parse(manipulator, &text, (&name, &label), ends)?;
    Ok((motion, name, text))
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
    ends: Option<Ends>,
) -> PyResult<PlatformMotion> {
    let (inner, path) = (&manipulator.inner, Path::new(name));
    let csv = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    let stem = path.file_stem().map_or_else(|| label.to_owned(), |s| s.display().to_string());
    let motion = match ends {
        _ if csv => table::read(text, &stem, inner, ends.unwrap_or_default()),
        Some(ends) => {
            let problem = "a motion file says it itself, beside its points:";
            return Err(wrong(format!("ends: {problem} ends = {:?}", ends.name())));
        }
        None => file::read(text, inner),
    };
    motion.map_err(|errors| wrong(errors.in_file(label)))
}
