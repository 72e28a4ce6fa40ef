//! `opm linkage --sweep`: a closed cycle, as CSV or as a recording.

use super::report::Run;
use crate::args::{Format, LinkageArgs, Output};
use crate::failure::Failure;
use crate::layout;
use crate::output::{Shown, stdout};
use crate::progress::clean_up_at_ctrl_c;
use crate::text::count;
use opm_core::linkage::Position;
use opm_mcap::PartialFile;
use opm_mcap::csv::Rows;
use opm_study::recording::record_linkage;
use opm_study::{LinkageRound, RoundSummary, StudyError, input_intervals};
use serde_json::json;
use std::io::{self, Write};
use std::path::Path;

pub fn run(args: &LinkageArgs, output: &Output, run: &Run<'_>) -> Result<(), Failure> {
    let dash = Path::new("-");
    let Run { linkage, input, .. } = run;
    // A linkage that does not come home is refused before anything is written.
    input.cycle().map_err(|error| Failure::at(&run.loaded.label, error))?;
    let sweep = Sweep { run, round: LinkageRound { linkage, input, count: args.count } };
    let Some(path) = args.output.as_deref().filter(|path| *path != dash) else {
        if output.format == Format::Json {
            let problem = "the CSV takes standard output; give it a file with --output";
            return Err(Failure::flag("--format json", problem));
        }
        return match sweep.csv(&mut stdout()) {
            Ok(summary) => {
                sweep.report(None, &summary, output);
                Ok(())
            }
            Err(SweepStop::Write(error)) => Err(Failure::stdout(error)),
            Err(SweepStop::Failure(failure)) => Err(failure),
        };
    };
    run.loaded.refuse_as_output(path, &[])?;
    clean_up_at_ctrl_c()?;
    let place = path.shown();
    let summary = match path.extension().and_then(|ending| ending.to_str()) {
        Some("csv") => {
            let mut file = PartialFile::create(path).map_err(|e| Failure::at(&place, e))?;
            sweep
                .csv(&mut file)
                .and_then(|summary| file.commit().map(|()| summary).map_err(SweepStop::Write))
                .map_err(|error| match error {
                    SweepStop::Write(error) => Failure::at(&place, error),
                    SweepStop::Failure(failure) => failure,
                })?
        }
        Some("mcap") => record_linkage(&sweep.round, run.loaded.attachment(), path)?,
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
        "range": input_intervals(&run.input),
        "full_turn": run.input.range().is_full_turn(),
        "turns": summary.is_revolution,
        "positions": summary.positions,
        "within_limits": summary.within_limits,
    });
    output.print(&json, "")
}

/// Why a sweep ends early.
enum SweepStop {
    Write(io::Error),
    Failure(Failure),
}

impl From<StudyError> for SweepStop {
    fn from(error: StudyError) -> Self {
        Self::Failure(error.into())
    }
}

impl From<io::Error> for SweepStop {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// The requested sweep.
struct Sweep<'a> {
    run: &'a Run<'a>,
    round: LinkageRound<'a>,
}

impl Sweep<'_> {
    fn csv(&self, output: &mut (dyn Write + Send)) -> Result<RoundSummary, SweepStop> {
        let linkage = self.round.linkage;
        let mut rows = Rows::new(output);
        let joints = linkage.coordinates().iter().map(|c| &*c.name);
        let imaginary = linkage.imaginary().iter().map(|joint| &*joint.name);
        let point = ["coupler.x", "coupler.y", "coupler.z"];
        let point = point.into_iter().filter(|_| self.run.coupler.is_some());
        rows.header(joints.chain(imaginary).chain(["branch", "within_limits"]).chain(point))?;
        let row = |_: u32, position: &Position| -> Result<(), SweepStop> {
            let Position { joints, imaginary, branch, within_limits } = position;
            rows.numbers(joints)?;
            imaginary.iter().try_for_each(|value| rows.number(*value))?;
            rows.text(&branch.to_string())?;
            rows.answer(*within_limits)?;
            let at = self.run.coupler_at(position);
            at.iter().flat_map(|at| at.iter()).try_for_each(|value| rows.number(*value))?;
            Ok(rows.end()?)
        };
        let summary = self.round.each(row)?;
        rows.flush()?;
        Ok(summary)
    }

    fn report(&self, path: Option<&Path>, summary: &RoundSummary, output: &Output) {
        let name = &self.run.input.coordinate().name;
        if let Some(path) = path {
            let round =
                if summary.is_revolution { "one revolution of" } else { "there and back with" };
            output.note(format_args!(
                "{}: {} positions, {round} {name}",
                path.shown(),
                count(summary.positions)
            ));
            layout::advise(path, output);
        }
        let beyond = summary.positions - summary.within_limits;
        if beyond > 0 {
            let all = count(summary.positions);
            output.warn(format_args!("{} of {all} positions are beyond limits", count(beyond)));
        }
    }
}
