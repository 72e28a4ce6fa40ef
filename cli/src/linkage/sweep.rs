//! `opm linkage --sweep`: once round, as CSV or as a recording.

use super::Run;
use crate::args::{Format, LinkageArgs, Output};
use crate::failure::Failure;
use crate::scene::{Scene, imaginary_coordinates, joint_coordinates};
use crate::text::count;
use csv::WriterBuilder;
use opm_core::linkage::Position;
use opm_core::skeleton::{self as core, Cuts};
use opm_mcap::trajectory::{Posture, Sample};
use opm_mcap::{Metadata, PartialFile, RecordError, Sink, Trajectory, TrajectoryRecorder};
use serde_json::json;
use std::io::{self, Write};
use std::path::Path;

/// How long a recorded round lasts, in nanoseconds.
const ROUND: u64 = 10_000_000_000;

pub fn run(args: &LinkageArgs, output: &Output, run: &Run<'_>) -> Result<(), Failure> {
    let dash = Path::new("-");
    let sweep = Sweep { run, count: args.count };
    let Some(path) = args.output.as_deref().filter(|path| *path != dash) else {
        if output.format == Format::Json {
            let problem = "the CSV takes standard output; give it a file with --output";
            return Err(Failure::flag("--format json", problem));
        }
        return match sweep.csv(io::stdout().lock()) {
            Ok(summary) => {
                sweep.report(None, &summary, output);
                Ok(())
            }
            Err(Stop::Write(error)) => Err(Failure::stdout(&error)),
            Err(Stop::Failure(failure)) => Err(failure),
        };
    };
    run.loaded.refuse_as_output(path, &[])?;
    let place = path.display();
    let summary = match path.extension().and_then(|ending| ending.to_str()) {
        Some("csv") => {
            let mut file = PartialFile::create(path).map_err(|e| Failure::at(&place, &e))?;
            sweep
                .csv(&mut file)
                .and_then(|summary| file.commit().map(|()| summary).map_err(Stop::Write))
                .map_err(|error| match error {
                    Stop::Write(error) => Failure::at(&place, &error),
                    Stop::Failure(failure) => failure,
                })?
        }
        Some("mcap") => sweep.record(path)?,
        _ => {
            let problem = format!("{place}: expected a name that ends in .csv or .mcap");
            return Err(Failure::flag("--output", problem));
        }
    };
    sweep.report(Some(path), &summary, output);
    if output.format == Format::Text {
        return Ok(());
    }
    let json = json!({
        "name": run.linkage.mechanism().name,
        "input": { "joint": run.input.coordinate().name },
        "range": run.intervals(),
        "full_turn": run.input.range().is_full_turn(),
        "turns": summary.turns,
        "positions": summary.positions,
        "within_limits": summary.within_limits,
    });
    output.print(&json, "")
}

/// Why a sweep ends early.
enum Stop {
    Write(io::Error),
    Failure(Failure),
}

impl From<csv::Error> for Stop {
    fn from(error: csv::Error) -> Self {
        Self::Write(error.into())
    }
}

/// What was swept.
struct Summary {
    positions: u64,
    within_limits: u64,
    /// The input went all the way round.
    turns: bool,
}

struct Sweep<'a> {
    run: &'a Run<'a>,
    count: u32,
}

impl Sweep<'_> {
    /// Shows every position of the round, in order, with its number.
    fn each<E>(
        &self,
        mut show: impl FnMut(u32, &Position) -> Result<(), E>,
        lost: impl Fn(Failure) -> E,
    ) -> Result<Summary, E> {
        let cycle = self.run.input.cycle();
        let mut position = self.run.input.home();
        let mut within_limits = 0;
        for number in 0..self.count {
            let phase = f64::from(number) / f64::from(self.count - 1);
            let (value, branch) = cycle.at(phase);
            if !self.run.input.position_near(value, branch, &mut position) {
                let name = &self.run.input.coordinate().name;
                let problem = format!("{name} = {value}: the loop does not close in {branch}");
                return Err(lost(Failure::Work(problem)));
            }
            within_limits += u64::from(position.within_limits);
            show(number, &position)?;
        }
        Ok(Summary { positions: self.count.into(), within_limits, turns: cycle.is_turn() })
    }

    fn csv(&self, output: impl Write) -> Result<Summary, Stop> {
        let linkage = self.run.linkage;
        let mut writer = WriterBuilder::new().has_headers(false).from_writer(output);
        let joints = linkage.coordinates().iter().map(|c| &*c.name);
        writer.write_record(joints.chain([
            &*linkage.imaginary().name,
            "branch",
            "within_limits",
        ]))?;
        let row = |_: u32, position: &Position| {
            let Position { joints, imaginary, branch, within_limits } = position;
            let row = (joints, imaginary, branch.to_string(), u8::from(*within_limits));
            Ok(writer.serialize(row)?)
        };
        let summary = self.each(row, Stop::Failure)?;
        writer.flush().map_err(Stop::Write)?;
        Ok(summary)
    }

    fn record(&self, path: &Path) -> Result<Summary, Failure> {
        let Run { loaded, linkage, input } = self.run;
        let place = path.display();
        let failed = |error: RecordError| Failure::at(&place, &error);
        let steps = u64::from(self.count - 1);
        let mechanism = linkage.mechanism();
        let cuts = Cuts {
            decomposition: linkage.decomposition(),
            imaginary: std::slice::from_ref(linkage.imaginary()),
        };
        let mut scene = Scene::new(mechanism, cuts);
        let trajectory = Trajectory {
            pose: Vec::new(),
            joints: joint_coordinates(mechanism),
            imaginary: imaginary_coordinates(cuts.imaginary),
            rates: false,
            measures: Vec::new(),
            bodies: scene.bodies(),
            files: vec![(&loaded.file_name, loaded.text.as_bytes())],
            run: record([
                ("command", "linkage".to_owned()),
                ("mechanism", mechanism.name.clone()),
                ("input", input.coordinate().name.clone()),
                ("range", json!(self.run.intervals()).to_string()),
                ("branch", input.home_branch().to_string()),
                ("positions", self.count.to_string()),
                ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ]),
        };
        let mut recorder = TrajectoryRecorder::create(path, &trajectory).map_err(failed)?;
        let write = |number: u32, position: &Position| {
            let time = u64::from(number) * ROUND / steps;
            let (joints, imaginary) = (&position.joints, &[position.imaginary]);
            let frames = if recorder.shows(time) {
                let platform = mechanism.legs[0].displacement(joints);
                scene.frames(&core::Posture { joints, imaginary, platform })
            } else {
                &[]
            };
            let posture = Posture { joints, imaginary, rates: None, frames };
            let sample = Sample {
                valid: position.within_limits,
                posture: Some(posture),
                ..Sample::default()
            };
            recorder.push(time, &sample).map_err(failed)
        };
        let summary = self.each(write, |failure| failure)?;
        let result = record([
            ("positions", summary.positions.to_string()),
            ("within_limits", summary.within_limits.to_string()),
            ("turns", summary.turns.to_string()),
        ]);
        recorder.finish(&result).map_err(failed)?;
        Ok(summary)
    }

    fn report(&self, path: Option<&Path>, summary: &Summary, output: &Output) {
        let name = &self.run.input.coordinate().name;
        if let Some(path) = path {
            let round = if summary.turns { "one turn of" } else { "there and back with" };
            output.note(format_args!(
                "{}: {} positions, {round} {name}",
                path.display(),
                count(summary.positions)
            ));
        }
        let beyond = summary.positions - summary.within_limits;
        if beyond > 0 {
            let all = count(summary.positions);
            output.warn(format_args!("{} of {all} positions are beyond limits", count(beyond)));
        }
    }
}

fn record<const N: usize>(pairs: [(&str, String); N]) -> Metadata {
    pairs.map(|(key, value)| (key.to_owned(), value)).into()
}
