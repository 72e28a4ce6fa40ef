//! A recording to be drawn, and its mechanism as far as it is known.

use crate::args::Output;
use crate::failure::Failure;
use crate::output::Shown;
use crate::progress::watch_reading;
use crate::text::count;
use opm_core::linkage::Linkage;
use opm_core::manipulator::{ImaginaryJoint, Manipulator};
use opm_core::mechanism::file::{AngleUnit, FileUnits, MechanismFile, read as read_mechanism};
use opm_core::{Leg, Quantity};
use opm_mcap::workspace::SLICES_TOPIC;
use opm_mcap::{Message, Metadata, ReadError, Recording, read};
use opm_plot::{Measure, Steps, Unit};
use opm_workspace::Progress;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Differences of SI values below this are noise of the arithmetic.
const NOISE: f64 = 1e-9;
/// Number of messages between two checks for Ctrl-C.
const PORTION: u64 = 64;

/// A recording that has been read once.
pub struct Source<'a> {
    /// Its name in messages.
    pub label: String,
    path: &'a Path,
    pub recording: Recording,
    /// The mechanism, if its file is attached to the recording.
    pub mechanism: Option<Mechanism>,
    output: &'a Output,
    progress: &'a Progress,
}

/// The moving system.
pub struct Mechanism {
    pub file: MechanismFile,
    pub kind: SourceSolver,
}

/// The solver for it.
pub enum SourceSolver {
    Manipulator(Box<Manipulator>),
    Linkage(Box<Linkage>),
    Other,
}

/// The reason why reading stops early.
pub enum ReadStop {
    Read(ReadError),
    Interrupted,
}

impl From<ReadError> for ReadStop {
    fn from(error: ReadError) -> Self {
        Self::Read(error)
    }
}

impl<'a> Source<'a> {
    /// Reads a recording and collects its contents.
    pub fn open(
        path: &'a Path,
        output: &'a Output,
        progress: &'a Progress,
    ) -> Result<Self, Failure> {
        let label = path.shown();
        // The file is read more than once.
        if fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return Err(Failure::work(format!(
                "{label}: not a regular file, expected a recording"
            )));
        }
        let recording = Recording {
            topics: vec![],
            time_range: None,
            extents: vec![],
            metadata: vec![],
            attachments: vec![],
            complete: false,
        };
        let mut source = Self { label, path, recording, mechanism: None, output, progress };
        source.recording = source.each(None, |_| Ok(()))?;
        source.mechanism = source.find_mechanism();
        Ok(source)
    }

    /// Calls `visit` with every message.
    pub fn messages(
        &self,
        visit: impl FnMut(&Message<'_>) -> Result<(), ReadStop>,
    ) -> Result<(), Failure> {
        let total = self.recording.topics.iter().map(|topic| topic.messages).sum();
        self.each(Some(total), visit).map(|_| ())
    }

    fn each(
        &self,
        total: Option<u64>,
        mut visit: impl FnMut(&Message<'_>) -> Result<(), ReadStop>,
    ) -> Result<Recording, Failure> {
        let seen = AtomicU64::new(0);
        let look = |message: &Message<'_>| {
            let number = seen.fetch_add(1, Ordering::Relaxed);
            if number.is_multiple_of(PORTION) && self.progress.is_cancelled() {
                return Err(ReadStop::Interrupted);
            }
            visit(message)
        };
        let done = || seen.load(Ordering::Relaxed);
        let found = watch_reading(self.output, total, done, || read(self.path, look));
        found.map_err(|stop| match stop {
            ReadStop::Interrupted => {
                let seen = count(done());
                Failure::interrupted(format!("interrupted while reading; messages so far: {seen}"))
            }
            ReadStop::Read(error) => match error {
                ReadError::Io { source, .. } => Failure::at(&self.label, source),
                ReadError::NotMcap { .. } => {
                    Failure::because(format!("{}: not an MCAP file", self.label), error)
                }
                _ => Failure::at(&self.label, error),
            },
        })
    }

    /// The first attachment that is a mechanism file.
    fn find_mechanism(&self) -> Option<Mechanism> {
        let texts = self.recording.attachments.iter().filter_map(|attached| {
            let content = attached.content.as_deref()?;
            std::str::from_utf8(content).ok()
        });
        let file = texts.filter_map(|text| read_mechanism(text).ok()).next()?;
        let kind = match Manipulator::new(file.mechanism.clone()) {
            Ok(manipulator) => SourceSolver::Manipulator(Box::new(manipulator)),
            Err(_) => match Linkage::new(&file.mechanism) {
                Ok(linkage) => SourceSolver::Linkage(Box::new(linkage)),
                Err(_) => SourceSolver::Other,
            },
        };
        Some(Mechanism { file, kind })
    }

    /// The mechanism, if it has inverse kinematics.
    pub fn manipulator(&self) -> Option<&Manipulator> {
        match &self.mechanism.as_ref()?.kind {
            SourceSolver::Manipulator(manipulator) => Some(manipulator),
            SourceSolver::Linkage(_) | SourceSolver::Other => None,
        }
    }

    /// Its imaginary joints.
    pub fn imaginary(&self) -> &[ImaginaryJoint] {
        self.manipulator().map(Manipulator::imaginary).unwrap_or_default()
    }

    /// The quantity of an imaginary or other joint with this name, if the mechanism is known.
    pub fn joint_quantity(&self, name: &str) -> Option<Quantity> {
        let imaginary = self.imaginary().iter().map(|joint| (&*joint.name, joint.quantity));
        let coordinates = self.manipulator().map(Manipulator::coordinates).unwrap_or_default();
        let joints = coordinates.iter().map(|c| (&*c.name, c.quantity));
        imaginary.chain(joints).find(|(known, _)| *known == name).map(|(_, quantity)| quantity)
    }

    /// The quantity of a task coordinate, if the mechanism is known.
    pub fn quantity_of(&self, name: &str) -> Option<Quantity> {
        let mut coordinates =
            self.manipulator().into_iter().flat_map(Manipulator::task_coordinates);
        coordinates.find(|c| c.name == name).map(|c| c.quantity)
    }

    /// The joint that moves a recorded linkage, and its quantity.
    pub fn input(&self) -> Option<(String, Quantity)> {
        let run = self.metadata("run");
        let name =
            run.get("input").filter(|_| run.get("command").is_some_and(|c| c == "linkage"))?;
        let legs = self.mechanism.iter().flat_map(|known| &known.file.mechanism.legs);
        let known = legs.flat_map(Leg::coordinates).find(|c| c.name == *name);
        let recorded = || {
            let joints = self.metadata("joints");
            let field =
                joints.iter().find(|(_, joint)| *joint == name).map_or(name, |found| found.0);
            quantity(self.metadata("quantities").get(field).map(String::as_str))
        };
        known.map(|c| c.quantity).or_else(recorded).map(|quantity| (name.clone(), quantity))
    }

    /// The progress of reading, which Ctrl-C cancels.
    pub fn progress(&self) -> &'a Progress {
        self.progress
    }

    pub fn is_workspace(&self) -> bool {
        self.recording.topic(SLICES_TOPIC).is_some_and(|topic| topic.points.is_some())
    }

    /// A metadata record; empty if it does not exist.
    pub fn metadata(&self, name: &str) -> Metadata {
        self.recording.metadata(name).cloned().unwrap_or_default()
    }

    /// The title: the name of the mechanism, or of the file.
    pub fn title(&self) -> String {
        let run = self.metadata("run");
        let name = self.mechanism.as_ref().map(|mechanism| &mechanism.file.mechanism.name);
        run.get("mechanism").or(name).unwrap_or(&self.label).clone()
    }

    /// The units of the numbers in the picture.
    pub fn units(&self) -> FileUnits {
        self.mechanism.as_ref().map_or(FileUnits::SI, |mechanism| mechanism.file.units)
    }

    /// Notes below every picture of this recording.
    pub fn notes(&self) -> Vec<String> {
        if self.recording.complete {
            return vec![];
        }
        vec!["The recording is unfinished: this is what it holds so far.".to_owned()]
    }

    /// Notes which units the picture has, and why.
    pub fn units_line(&self) -> String {
        let units = self.units();
        let [length, angle] = [Quantity::Length, Quantity::Angle].map(|q| units.symbol(q));
        match self.mechanism {
            Some(_) => format!("in {length} and {angle}, the units of the mechanism file"),
            None => format!("in {length} and {angle}; no mechanism file in the recording"),
        }
    }

    /// The name and unit of values named `name`, and the divisor from SI values to the picture's unit.
    pub fn measure(&self, name: &str, quantity: Option<Quantity>, rate: Rate) -> (Measure, f64) {
        let units = self.units();
        let name = name.to_owned();
        let Some(quantity) = quantity else { return (Measure { name, unit: Unit::none() }, 1.0) };
        let symbol = format!("{}{}", units.symbol(quantity), rate.suffix());
        let turns = quantity == Quantity::Angle && rate == Rate::Position;
        let degrees = turns && units.angle == AngleUnit::Degree;
        let factor = units.factor(quantity);
        let steps = if degrees { Steps::Degrees } else { Steps::Decimal };
        (Measure { name, unit: Unit { symbol, steps, resolution: NOISE / factor } }, factor)
    }
}

/// The order of the derivative by time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rate {
    Position,
    Velocity,
    Acceleration,
}

impl Rate {
    fn suffix(self) -> &'static str {
        match self {
            Self::Position => "",
            Self::Velocity => "/s",
            Self::Acceleration => "/s²",
        }
    }
}

/// The quantity that an SI unit measures.
pub fn quantity(unit: Option<&str>) -> Option<Quantity> {
    [Quantity::Angle, Quantity::Length].into_iter().find(|q| Some(q.unit()) == unit)
}
