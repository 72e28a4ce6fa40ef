//! Mechanism files, by path or by the name of a shipped example.

use crate::args::{MechanismArgs, Output};
use crate::failure::Failure;
use crate::output::Shown;
use crate::pose::Number;
use crate::progress::Waiting;
use crate::target::refuse_inputs;
use crate::text::chain;
use crate::unitless;
use opm_core::Quantity;
use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{
    DecomposeError, JointMiss, NearMiss, Snapped, doubts, missing_motors, nearly, slightly_off,
    snap,
};
use opm_core::group::subspace::SubspaceClass;
use opm_core::linkage::Linkage;
use opm_core::manipulator::{CompileError, Manipulator, Mode};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::examples::{EXAMPLES, find};
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::mechanism::file::{self, MechanismFile};
use opm_mcap::input::{self, Expected, InputError, Pipes};
use opm_study::recording::Attachment;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The tolerance that messages offer, over the one that just accepts a mechanism.
const MARGIN: f64 = 1.01;

/// A mechanism file that was read.
#[derive(Clone)]
pub struct Loaded {
    /// Its name in messages: the path or the name as given.
    pub label: String,
    /// The file's own name, to attach it under.
    pub file_name: String,
    /// Its path; `None` for a shipped example.
    pub path: Option<PathBuf>,
    /// Its text; if joints were snapped, that of the snapped mechanism.
    pub text: String,
    /// The mechanism and its units.
    pub file: MechanismFile,
    /// The joints that were snapped; `None` without a tolerance.
    pub snapped: Option<Vec<JointMiss>>,
}

/// Reads a mechanism, snaps it if it has a tolerance, and notes what was snapped or is off, and which link is the platform.
pub fn open(given: &MechanismArgs, output: &Output) -> Result<Loaded, Failure> {
    Ok(open_as_it_is(given, output)?.rerooted(output))
}

/// The same with the platform that the file has.
pub fn open_as_it_is(given: &MechanismArgs, output: &Output) -> Result<Loaded, Failure> {
    let loaded = read(given, output)?;
    loaded.note_snapped(output);
    loaded.warn_of_home(output);
    loaded.note_misses(output);
    Ok(loaded)
}

/// Reads a mechanism, and snaps it if it has a tolerance.
pub fn read(given: &MechanismArgs, output: &Output) -> Result<Loaded, Failure> {
    let mut loaded = read_as_it_is(&given.file)?;
    // Before the change: numbers that are misread often fail.
    unitless::note_changes(output, &given.change.set, &loaded);
    loaded.change(&given.change)?;
    if let Some(tolerance) = given.tolerance {
        loaded.snap(tolerance, "--tolerance")?;
    }
    Ok(loaded)
}

/// The name of standard input among files.
pub const DASH: &str = "-";
/// Its name in messages.
pub const STANDARD_INPUT: &str = "standard input";

/// Reads a mechanism: a file, standard input, or an example. An existing path has priority over an example of the same
/// name.
pub fn read_as_it_is(given: &Path) -> Result<Loaded, Failure> {
    if given == Path::new(DASH) {
        let label = STANDARD_INPUT.to_owned();
        let text = input::text_of(io::stdin(), Expected::MECHANISM);
        let text = text.map_err(|error| refused(&label, error))?;
        let file =
            file::read(&text).map_err(|errors| Failure::because(errors.in_file(&label), errors))?;
        let file_name = "mechanism.toml".to_owned();
        return Ok(Loaded { label, file_name, path: None, text, file, snapped: None });
    }
    let label = given.shown();
    let (text, path, file_name) = match text(given, Expected::MECHANISM)? {
        Some(text) => {
            let name = given.file_name().map_or_else(|| label.clone(), |n| n.display().to_string());
            (text, Some(given.to_owned()), name)
        }
        None => match find(&label) {
            Some(example) => (example.text.to_owned(), None, format!("{}.toml", example.name)),
            // A bare word is more likely a name than a path.
            None if given.extension().is_none() && given.components().count() == 1 => {
                let names: Vec<&str> = EXAMPLES.iter().map(|example| example.name).collect();
                return Err(Failure::work(format!(
                    "{label}: no such file, and no such example; {}",
                    expected_one_of(&label, &names)
                )));
            }
            None => return Err(Failure::work(format!("{label}: No such file or directory"))),
        },
    };
    let file =
        file::read(&text).map_err(|errors| Failure::because(errors.in_file(&label), errors))?;
    Ok(Loaded { label, file_name, path, text, file, snapped: None })
}

/// Reads a mechanism file that is no file of the user's: attached to a recording, or shipped. `label` is its name in messages.
pub fn attached(label: &str, file_name: &str, text: &str) -> Result<Loaded, Failure> {
    let file =
        file::read(text).map_err(|errors| Failure::because(errors.in_file(label), errors))?;
    let (label, file_name) = (label.to_owned(), file_name.to_owned());
    Ok(Loaded { label, file_name, path: None, text: text.to_owned(), file, snapped: None })
}

/// The text of a file; `None` if there is no such file.
pub fn text(given: &Path, expected: Expected) -> Result<Option<String>, Failure> {
    match input::text(given, expected, Pipes::Read) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.is_missing() => Ok(None),
        Err(error) => Err(refused(&given.shown(), error)),
    }
}

/// The text of a file that has to be there.
pub fn existing(given: &Path, expected: Expected) -> Result<String, Failure> {
    let missing = || Failure::work(format!("{}: No such file or directory", given.shown()));
    text(given, expected)?.ok_or_else(missing)
}

/// A table that is read row by row, and its name in messages: a file, or standard input if it is `-`.
pub fn table(given: &Path, expected: Expected) -> Result<(String, Box<dyn Read>), Failure> {
    if given == Path::new(DASH) {
        return Ok((STANDARD_INPUT.to_owned(), Box::new(Waiting(io::stdin()))));
    }
    let label = given.shown();
    let file = input::open(given, expected, Pipes::Read);
    let file = file.map_err(|error| refused(&label, error))?;
    let is_file = file.metadata().is_ok_and(|found| found.is_file());
    Ok((label, if is_file { Box::new(file) } else { Box::new(Waiting(file)) }))
}

/// The failure for an input that is not read.
fn refused(label: &str, error: InputError) -> Failure {
    match error {
        InputError::Io(error) => Failure::at(label, error),
        error => Failure::because(format!("{}: {error}", error.place(label)), error),
    }
}

impl Loaded {
    /// Whether the mechanism was read from standard input.
    pub fn is_standard_input(&self) -> bool {
        self.path.is_none() && self.label == STANDARD_INPUT
    }

    /// Moves joints that miss their subspaces by at most a tolerance exactly into these.
    pub fn snap(&mut self, tolerance: Number, flag: &str) -> Result<(), Failure> {
        let length = tolerance.value_of("the tolerance", Quantity::Length);
        let length = length.map_err(|error| Failure::flag(flag, error))?;
        if !(length > 0.0 && length.is_finite()) {
            return Err(Failure::flag(flag, format!("{length} m, expected a positive length")));
        }
        if self.file.family.is_some() {
            // The joints of a family are exact by construction.
            self.snapped = Some(Vec::new());
            return Ok(());
        }
        let Snapped { mechanism, joints } =
            snap(&self.file.mechanism, length).map_err(|error| Failure::at(&self.label, error))?;
        if !joints.is_empty() {
            // A recording holds the mechanism that was computed with.
            self.file.mechanism = mechanism;
            self.text = self.file.text();
        }
        self.snapped = Some(joints);
        Ok(())
    }

    /// Notes which joints were snapped, and by how much.
    pub fn note_snapped(&self, output: &Output) {
        for miss in self.snapped.iter().flatten() {
            output.note(format_args!("{}: snapped {miss}", self.label));
        }
    }

    /// The mechanism with the platform that it is solved with: another link of the loop where that of the file has no closed
    /// form. A note says which.
    pub fn rerooted(mut self, output: &Output) -> Self {
        if let Some((mechanism, joint)) = rerooted(&self.file.mechanism) {
            output.note(format_args!(
                "{}: the platform has no closed form as a link between both legs of the loop: the link behind {joint} \
                 is taken as the platform",
                self.label
            ));
            self.file.mechanism = mechanism;
        }
        self
    }

    /// Warns where the home pose is a parallel singularity, and of what is probably a mistake in the file.
    pub fn warn_of_home(&self, output: &Output) {
        if output.quiet {
            return;
        }
        let Ok(report) = mobility(&self.file.mechanism) else { return };
        for text in report.parallel_home().into_iter().chain(doubts(&self.file.mechanism)) {
            output.warn(format_args!("{}: {text}", self.label));
        }
    }

    /// Notes which joints of a mechanism that decomposes are off, and by how much.
    fn note_misses(&self, output: &Output) {
        // The joints of a family are exact by construction.
        if output.quiet || self.file.family.is_some() {
            return;
        }
        if let Some(near) = slightly_off(&self.file.mechanism) {
            output.note(format_args!("{}: {}", self.label, self.misses(&near)));
        }
    }

    /// Which joints of a mechanism that decomposes are off, and what to do about it.
    pub fn misses(&self, near: &NearMiss) -> String {
        let (lower, upper) = (near.lower.name(), near.upper.name());
        let sections = match near.upper {
            SubspaceClass::Identity => lower.to_owned(),
            _ => format!("{lower} and {upper}"),
        };
        let hint = self.tolerance_hint(near);
        format!("joints are slightly off their subspaces ({sections}): {near}{hint}")
    }

    /// What to do about a mechanism that nearly decomposes.
    pub fn tolerance_hint(&self, near: &NearMiss) -> String {
        let unit = self.file.units.length;
        let length = rounded_up(MARGIN * near.tolerance / unit.factor());
        format!(
            "; more digits or a correction of the file help, or --tolerance {length}{} accepts and \
             snaps it",
            unit.symbol()
        )
    }

    /// Which motors are missing, for the end of an error about actuators.
    pub fn motors_hint(&self) -> String {
        let mechanism = &self.file.mechanism;
        let missing =
            mobility(mechanism).ok().and_then(|report| missing_motors(mechanism, &report));
        missing.map_or_else(String::new, |text| format!("; {text}"))
    }

    /// What a mechanism that cannot be compiled misses, if it nearly decomposes.
    fn near_hint(&self, error: &CompileError) -> String {
        match error {
            CompileError::Decompose(
                DecomposeError::NoFreedom { near, .. }
                | DecomposeError::SingularHome { near, .. }
                | DecomposeError::NoPartialSubspaces { near, .. },
            ) => near.as_ref().map_or_else(String::new, |near| self.tolerance_hint(near)),
            CompileError::Decompose(
                DecomposeError::NoActuator { .. } | DecomposeError::Loose { .. },
            ) => self.motors_hint(),
            CompileError::Decompose(_) | CompileError::Choices(_) => String::new(),
            _ => match nearly(&self.file.mechanism) {
                Ok(Some(near)) => {
                    format!(
                        "; it nearly decomposes into {} and {}: {near}{}",
                        near.lower.name(),
                        near.upper.name(),
                        self.tolerance_hint(&near)
                    )
                }
                Ok(None) | Err(_) => String::new(),
            },
        }
    }

    /// The file, as an attachment of a recording.
    pub fn attachment(&self) -> Attachment<'_> {
        Attachment { name: &self.file_name, text: &self.text }
    }

    /// The mechanism compiled for inverse kinematics.
    pub fn compile(&self) -> Result<Manipulator, Failure> {
        Manipulator::new(self.file.mechanism.clone()).map_err(|error| {
            let hint = self.linkage_hint();
            let near = self.near_hint(&error);
            let text = format!("{}: {}{near}{hint}", self.place_of(&error), chain(&error));
            Failure::because(text, error)
        })
    }

    /// The place of an error in messages: the file, and the line if it is
    /// known.
    pub fn place_of(&self, error: &CompileError) -> String {
        match error.location(&self.file) {
            Some((line, column)) => format!("{}:{line}:{column}", self.label),
            None => self.label.clone(),
        }
    }

    /// The advice for a mechanism without inverse kinematics: it may be a linkage.
    pub fn linkage_hint(&self) -> String {
        match Linkage::new(&self.file.mechanism) {
            Ok(_) => format!("; it is a linkage: use `opm linkage {}`", self.label),
            Err(_) => String::new(),
        }
    }

    /// Refuses to write over the mechanism file or another input.
    pub fn refuse_as_output(&self, output: &Path, others: &[&Path]) -> Result<(), Failure> {
        let inputs = self.path.as_deref().into_iter().chain(others.iter().copied());
        refuse_inputs("--output", output, inputs)
    }
}

/// A loop with another link as the platform, if only so it has a closed form, and the joint that carries that link.
fn rerooted(mechanism: &Mechanism) -> Option<(Mechanism, String)> {
    if mechanism.legs.len() != 2 {
        return None;
    }
    let manipulator = Manipulator::new(mechanism.clone()).ok()?;
    let solved = manipulator.mechanism();
    let mut legs = solved.legs.iter().zip(&mechanism.legs);
    let (stem, _) = legs.find(|(stem, leg)| stem.joints.len() < leg.joints.len())?;
    Some((solved.clone(), stem.joints.last()?.name.clone()))
}

/// A positive number, rounded up to two significant digits, for a flag.
fn rounded_up(value: f64) -> String {
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    let digits = (value / unit * (1.0 + 1e-9)).ceil() as i64;
    let decimals = (-unit.log10().round()).max(0.0) as usize;
    format!("{:.decimals$}", digits as f64 * unit)
}

/// The working mode that `--mode` names.
pub fn mode(manipulator: &Manipulator, given: &str) -> Result<Mode, Failure> {
    match given {
        "home" => Ok(manipulator.home_mode()),
        signs => manipulator.parse_mode(signs).map_err(|e| Failure::flag("--mode", e)),
    }
}

/// The names of the shipped examples, as a list.
pub fn example_names() -> String {
    EXAMPLES.iter().map(|example| example.name).collect::<Vec<_>>().join(", ")
}
