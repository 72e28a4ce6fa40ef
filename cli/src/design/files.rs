//! The files that a design writes.

use crate::args::DesignArgs;
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::{Shown, is_stdout};
use crate::target::{Target, ends_in};
use opm_design::{Design, Log, LogError, Outcome, Problem, columns};
use opm_mcap::input::{Expected, is_same_file};
use std::path::{Path, PathBuf};

/// The mechanism files, and the evaluations beside them.
pub struct Files {
    pub log: Log,
    /// That of a single design, opened before the work.
    target: Option<Target>,
    output: Option<PathBuf>,
    evaluations: Option<PathBuf>,
}

impl Files {
    pub fn new(args: &DesignArgs, problem: &Problem, loaded: &Loaded) -> Result<Self, Failure> {
        let Some(output) = &args.output else {
            return Ok(Self { log: Log::none(), target: None, output: None, evaluations: None });
        };
        if is_stdout(output) {
            let problem = "the report goes to standard output, expected a file";
            return Err(Failure::flag("--output", problem));
        }
        ends_in(output, &["toml"])?;
        loaded.refuse_as_output(output, &[&args.problem])?;
        let inputs: Vec<&Path> =
            loaded.path.as_deref().into_iter().chain([&*args.problem]).collect();
        if problem.objectives.len() > 1 {
            refuse_front(output, &inputs, problem.budget)?;
        }
        let evaluations = output.with_extension("csv");
        loaded.refuse_as_output(&evaluations, &inputs)?;
        if evaluations.exists() && !args.resume && !args.force {
            let problem = format!(
                "{} is there already: --resume goes on with the evaluations of an earlier run, --force replaces the file",
                evaluations.shown()
            );
            return Err(Failure::flag("--output", problem));
        }
        let target = match problem.objectives.len() {
            1 => Some(Target::create(output)?),
            _ => None,
        };
        let columns = columns(problem, &loaded.file);
        let log = match args.resume {
            true => {
                let text = load::existing(&evaluations, Expected::EVALUATIONS)?;
                Log::resume(&evaluations, &text, &columns)
            }
            false => Log::create(&evaluations, &columns),
        };
        let log = log.map_err(|error| match error {
            LogError::OtherProblem => {
                Failure::flag("--resume", format!("{}: {error}", evaluations.shown()))
            }
            error => Failure::at(evaluations.shown(), error),
        })?;
        Ok(Self { log, target, output: Some(output.clone()), evaluations: Some(evaluations) })
    }

    /// The file of the evaluations.
    pub fn kept(&self) -> Option<&Path> {
        self.evaluations.as_deref()
    }

    /// Writes the designs, and gives the name of the file of each; `None` for one that is not written.
    pub fn commit(
        self,
        found: &Outcome,
        most: Option<u64>,
    ) -> Result<Vec<Option<PathBuf>>, Failure> {
        let count = found.designs.len();
        let Some(output) = self.output else { return Ok(vec![None; count]) };
        if let Some(target) = self.target {
            target.commit(found.designs[0].file.text().as_bytes())?;
            return Ok(vec![Some(output)]);
        }
        let stem = stem(&output);
        let digits = count.to_string().len();
        let chosen = spread(count, most);
        let write = |(number, design): (usize, &Design)| {
            if !chosen.contains(&number) {
                return Ok(None);
            }
            let path = output.with_file_name(format!("{stem}-{:0digits$}.toml", number + 1));
            Target::create(&path)?.commit(design.file.text().as_bytes())?;
            Ok::<_, Failure>(Some(path))
        };
        found.designs.iter().enumerate().map(write).collect()
    }
}

/// The name of a file without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.display().to_string())
}

/// Refuses to write a design of a front, of `most` at most, over an input: each has a number behind the name of the output.
fn refuse_front(output: &Path, inputs: &[&Path], most: u64) -> Result<(), Failure> {
    let folder = output.parent().filter(|parent| *parent != Path::new(""));
    // Where there is no folder yet, nothing is in it.
    let Ok(entries) = folder.unwrap_or(Path::new(".")).read_dir() else { return Ok(()) };
    let before = format!("{}-", stem(output));
    for entry in entries.flatten() {
        let name = entry.file_name().display().to_string();
        let number = name.strip_prefix(&before).and_then(|rest| rest.strip_suffix(".toml"));
        let number = number.filter(|digits| digits.bytes().all(|digit| digit.is_ascii_digit()));
        let is_design = number
            .and_then(|digits| digits.parse().ok())
            .is_some_and(|n: u64| (1..=most).contains(&n));
        if is_design && inputs.iter().any(|input| is_same_file(input, &entry.path())) {
            let problem =
                format!("{name} is also the input, and a design of the front would replace it");
            return Err(Failure::flag("--output", problem));
        }
    }
    Ok(())
}

/// At most `most` of some numbers from 0 on, evenly spread, with both ends.
fn spread(count: usize, most: Option<u64>) -> Vec<usize> {
    let most = most.map_or(count, |most| count.min(usize::try_from(most).unwrap_or(count)));
    match most {
        0 | 1 => (0..count.min(most)).collect(),
        _ => (0..most).map(|i| (i * (count - 1) + (most - 1) / 2) / (most - 1)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn designs_are_chosen_evenly() {
        assert_eq!(spread(5, None), [0, 1, 2, 3, 4]);
        assert_eq!(spread(5, Some(9)), [0, 1, 2, 3, 4]);
        assert_eq!(spread(9, Some(3)), [0, 4, 8]);
        assert_eq!(spread(9, Some(1)), [0]);
        assert_eq!(spread(100, Some(4)), [0, 33, 66, 99]);
    }
}
