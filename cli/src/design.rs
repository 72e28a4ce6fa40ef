//! `opm design`: dimensions by optimisation.

mod files;
mod picture;
mod report;

use crate::args::{DesignArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::Shown;
use crate::plot::ending::{EXPECTED, Ending};
use crate::progress::{interruptible, watch_steps};
use crate::target::Target;
use crate::workspace::threads;
use files::Files;
use opm_core::mechanism::file::MechanismFile;
use opm_design::{DesignError, Draft, Problem, Variables, Watch, design};
use opm_mcap::input::Expected;
use report::Report;
use std::path::{Path, PathBuf};

pub fn run(args: &DesignArgs, output: &Output) -> Result<(), Failure> {
    let label = args.problem.shown();
    let text = load::existing(&args.problem, Expected::DESIGN)?;
    let (problem, loaded) = read(&text, args)?;
    loaded.warn_of_home(output);
    let picture = match &args.picture {
        None => None,
        Some(path) => {
            let Some(ending) = Ending::of(path) else {
                let problem = format!("{}: {EXPECTED}", path.shown());
                return Err(Failure::flag("--picture", problem));
            };
            loaded.refuse_as_output(path, &[&args.problem])?;
            Some((ending, Target::create(path)?))
        }
    };
    let mut files = Files::new(args, &problem, &loaded)?;
    let (watch, pool) = (Watch::new(interruptible()?), threads(args.threads)?);
    let found = watch_steps(
        output,
        "designing",
        Some(problem.most_evaluations()),
        || watch.evaluated(),
        || pool.install(|| design(&problem, &loaded.file, &mut files.log, &watch)),
    );
    let found = found.map_err(|error| match error {
        DesignError::Cancelled => {
            let evaluated = watch.evaluated();
            let kept = files.kept().map_or_else(String::new, |path| {
                format!("; {} has them, and --resume goes on with it", path.shown())
            });
            Failure::interrupted(format!("interrupted after {evaluated} designs{kept}"))
        }
        DesignError::Log(error) => {
            Failure::at(files.kept().unwrap_or(Path::new("log")).shown(), error)
        }
        error => Failure::at(&label, error),
    })?;
    if found.designs.iter().any(|design| !design.feasible) {
        output.warn(format_args!(
            "{label}: no design keeps all constraints; this is the nearest one"
        ));
    }
    let resumed = files.log.used();
    let names = files.commit(&found, args.designs)?;
    if let Some((ending, target)) = picture {
        let drawing = picture::draw(&problem, &loaded, &found, output)?;
        let path = args.picture.as_deref().unwrap_or(Path::new("")).shown();
        let bytes = ending.bytes(&drawing).map_err(|error| Failure::at(path, error))?;
        target.commit(&bytes)?;
    }
    let report =
        Report { problem: &problem, loaded: &loaded, found: &found, names: &names, resumed };
    output.print(&report.json(), report.text())
}

/// The problem, and the mechanism that it names: a file beside it, or a shipped one.
fn read(text: &str, args: &DesignArgs) -> Result<(Problem, Loaded), Failure> {
    let label = args.problem.shown();
    let wrong =
        |errors: opm_design::ProblemErrors| Failure::because(errors.in_file(&label), errors);
    let draft = Draft::read(text).map_err(wrong)?;
    let folder = args.problem.parent().unwrap_or(Path::new(""));
    let beside = folder.join(draft.mechanism());
    let name = if beside.exists() { beside } else { PathBuf::from(draft.mechanism()) };
    if name == Path::new(load::DASH) {
        return Err(Failure::work(format!("{label}: `mechanism` is -, expected a file or a name")));
    }
    let mut loaded = load::read_as_it_is(&name)
        .map_err(|failure| Failure::work(format!("{label}: `mechanism`: {failure}")))?;
    loaded.compile()?;
    let (problem, file) = draft.resolve(&loaded.file).map_err(wrong)?;
    loaded.file = MechanismFile { places: Default::default(), ..file };
    loaded.text = loaded.file.text();
    let variables = match (&problem.variables, args.undivided) {
        (Variables::Undivided(_), true) => {
            return Err(Failure::flag("--undivided", format!("{label} is not divided")));
        }
        (_, true) => problem.variables.clone().undivided(),
        _ => problem.variables.clone(),
    };
    let budget = args.budget.unwrap_or(problem.budget);
    let seed = args.seed.unwrap_or(problem.seed);
    Ok((Problem { budget, seed, variables, ..problem }, loaded))
}
