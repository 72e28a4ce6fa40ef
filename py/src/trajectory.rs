//! Motions of the platform as the joints follow them.

use crate::arguments;
use crate::columns::columns;
use crate::error::{failed, study, wrong};
use crate::html::{self, digits};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::parts::Pickled;
use crate::pickle::{attribute, attributes, equal, frozen, pickled};
use crate::rows::{Rows, no_memory};
use crate::solutions::units;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_analysis::Setup;
use opm_core::manipulator::{self as core, Mode};
use opm_core::mechanism;
use opm_core::motion::{Ends, PlatformMotion, examples, file, table};
use opm_core::trajectory::{self as core_trajectory, Change, Sample, ViolationReport};
use opm_interference::{Distances, Interference, Nearest, Watch, Watched};
use opm_study::recording::{Attachment, MotionRecorder, TableOptions, write_motion_table};
use opm_study::{DEFAULT_RATE, MotionRequest};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// A motion as the joints follow it, ``n`` samples; NaN where it is out of reach, or a joint has no rate.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Trajectory {
    /// (n,), seconds.
    #[pyo3(get)]
    times: Py<PyArray1<f64>>,
    /// (n, d): task coordinates, metres and radians.
    #[pyo3(get)]
    poses: Py<PyArray2<f64>>,
    /// (n, d): their first derivatives by time, m/s and rad/s.
    #[pyo3(get)]
    pose_rates: Py<PyArray2<f64>>,
    /// (n, d): their second derivatives, m/s² and rad/s².
    #[pyo3(get)]
    pose_accelerations: Py<PyArray2<f64>>,
    /// (n, e): every dependent coordinate, metres and radians; angles are continuous, not wrapped at π.
    #[pyo3(get)]
    dependent: Py<PyArray2<f64>>,
    /// (n, e), m/s and rad/s.
    #[pyo3(get)]
    dependent_rates: Py<PyArray2<f64>>,
    /// (n, e), m/s² and rad/s².
    #[pyo3(get)]
    dependent_accelerations: Py<PyArray2<f64>>,
    /// (n, k): every joint coordinate, metres and radians; angles are continuous, not wrapped at π.
    #[pyo3(get)]
    joints: Py<PyArray2<f64>>,
    /// (n, k), m/s and rad/s.
    #[pyo3(get)]
    joint_rates: Py<PyArray2<f64>>,
    /// (n, k), m/s² and rad/s².
    #[pyo3(get)]
    joint_accelerations: Py<PyArray2<f64>>,
    /// (n, j): every imaginary joint, metres and radians.
    #[pyo3(get)]
    imaginary: Py<PyArray2<f64>>,
    /// (n, j), m/s and rad/s.
    #[pyo3(get)]
    imaginary_rates: Py<PyArray2<f64>>,
    /// (n, j), m/s² and rad/s².
    #[pyo3(get)]
    imaginary_accelerations: Py<PyArray2<f64>>,
    /// (n,), no unit: condition number of the actuated joints' Jacobian with respect to the platform's twist.
    #[pyo3(get)]
    condition: Py<PyArray1<f64>>,
    /// (n,): whether the pose is in reach, joint limits not considered.
    #[pyo3(get)]
    reachable: Py<PyArray1<bool>>,
    /// (n,): whether the pose is in reach and all joints are within their limits.
    #[pyo3(get)]
    within_limits: Py<PyArray1<bool>>,
    /// (n,): whether the pose is in reach and every joint has a rate.
    #[pyo3(get)]
    regular: Py<PyArray1<bool>>,
    /// What the mechanism cannot follow, also between the samples, in the order of time.
    #[pyo3(get)]
    violations: Vec<Violation>,
    /// Where two bodies are nearer than `clearance`, also between the samples, in the order of time; None if that was not given.
    #[pyo3(get)]
    contacts: Option<Vec<Contact>>,
    /// The two bodies that are nearest in the whole motion, their distance in metres and the time in seconds.
    #[pyo3(get)]
    nearest: Option<(String, String, f64, f64)>,
    /// Names of the columns of `joints`.
    #[pyo3(get)]
    joint_names: Vec<String>,
    /// Names of the columns of `imaginary`.
    #[pyo3(get)]
    imaginary_names: Vec<String>,
    /// ``"m"`` or ``"rad"`` of every joint and imaginary joint, by name.
    #[pyo3(get)]
    units: BTreeMap<String, String>,
    /// The working mode.
    #[pyo3(get)]
    mode: String,
    /// Name of the motion.
    #[pyo3(get)]
    name: String,
    /// Number of rows, n.
    #[pyo3(get)]
    rows: usize,
    source: Source,
}

/// The motion that was followed, for a recording.
struct Source {
    manipulator: Py<Manipulator>,
    motion: PlatformMotion,
    /// The file's own name, and its text.
    file_name: String,
    text: String,
    mode: Mode,
    rate: f64,
    /// How the motion through the poses of a table starts and ends.
    ends: Ends,
    /// Whether the motion has the fastest timing instead of its own.
    time_optimal: bool,
    /// The least distance of two bodies that is no contact, metres.
    clearance: Option<f64>,
}

/// A part of a motion that the mechanism cannot follow, or a singularity on its way.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Violation {
    /// ``"reach"``, ``"limit"``, ``"rate"``, ``"acceleration"`` or ``"singularity"``.
    kind: String,
    /// Time at which it starts, seconds.
    start: f64,
    /// Time at which it ends, seconds; equal to `start` for a singularity.
    end: f64,
    /// Time at which it is worst, seconds.
    worst: f64,
    /// How large the violation is at that time, in :attr:`unit`.
    amount: f64,
    /// Unit of the amount: ``"m"``, ``"rad"``; ``"m/s"``, ``"rad/s"``, ``"m/s^2"``, ``"rad/s^2"`` beyond a limit of motion; or ``"1"`` for the remaining measure of a singularity.
    unit: String,
    /// The leg that the violation is about.
    leg: Option<String>,
    /// The joint that is past its limit, or too fast.
    joint: Option<String>,
    /// ``"lower"`` or ``"upper"``: what is out of reach or singular.
    section: Option<String>,
    /// ``"lowest"`` or ``"highest"``: the limit that is passed.
    bound: Option<String>,
    /// ``"serial"`` or ``"parallel"``.
    singularity: Option<String>,
    /// The whole violation in one line.
    message: String,
}

/// A part of a motion in which two bodies are nearer than the clearance.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Contact {
    /// The name of one body.
    one: String,
    /// The name of the other.
    other: String,
    /// Time at which it begins, seconds.
    start: f64,
    /// Time at which it ends, seconds.
    end: f64,
    /// Time at which the two are nearest, seconds.
    worst: f64,
    /// Their distance then, metres; negative where they overlap.
    distance: f64,
}

/// Follow a motion of the platform.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
/// motion : path, str or (w, d) array_like
///     A motion file, a table of poses (``.csv``), or the name of a shipped motion; or, with `times`, waypoints with one
///     column for each task coordinate, through which a cubic spline passes. Angles are brought within π of the
///     preceding waypoint, as those of a table are.
/// times : (w,) sequence of float, optional
///     Times of the waypoints, seconds, increasing; at least two. With `time_optimal` they may be left out: the curve is
///     then that of waypoints one second apart.
/// rate : float, optional
///     Samples per second; if not given, the rate of the file, or 100. The last sample is at the end of the motion.
/// mode : str, optional
///     ``"home"``, or a sign for every two-valued choice; if not given, the mode of the file, or home.
/// ends : str, optional
///     How a spline through waypoints or the poses of a table starts and ends: ``"rest"`` (no speed; if not given),
///     ``"natural"`` (no acceleration), or ``"periodic"`` (as it ends, so it starts). A motion file says it itself.
/// time_optimal : bool, optional
///     The fastest timing along the same path, from rest to rest, within ``max_rate`` and ``max_acceleration`` of the
///     joints in the mechanism file. Every actuated joint needs a ``max_acceleration``.
/// clearance : float, optional
///     Least distance of two bodies, metres: where it is less, they are in contact (:attr:`Trajectory.contacts`); 0 for
///     overlaps.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// OpmError
///     Lists every problem of the file with its line and column; or waypoints are not poses, or times do not increase (the
///     message gives the index of the waypoint, counted from zero).
#[pyfunction]
#[pyo3(signature = (manipulator, motion, /, *, times = None, rate = None, mode = None, ends = None, time_optimal = false, clearance = None))]
#[allow(clippy::too_many_arguments)]
pub fn trajectory(
    py: Python<'_>,
    manipulator: &Bound<'_, Manipulator>,
    motion: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
    rate: Option<f64>,
    mode: Option<&str>,
    ends: Option<&str>,
    time_optimal: bool,
    clearance: Option<f64>,
) -> PyResult<Trajectory> {
    if let Some(odd) = clearance.filter(|least| !(*least >= 0.0 && least.is_finite())) {
        return Err(wrong(format!("clearance is {odd:?} m, expected a length of 0 or more")));
    }
    let (owner, manipulator) = (manipulator, manipulator.get());
    let ends = ends.map(spline_ends).transpose()?;
    let (motion, file_name, text) = match times {
        Some(times) => {
            let times = arguments::list(times, "times")?;
            through(manipulator, motion, Some(&times), ends.unwrap_or_default())?
        }
        // The fastest timing does not ask when, only along which curve.
        None if time_optimal && motion.extract::<PathBuf>().is_err() => {
            through(manipulator, motion, None, ends.unwrap_or_default())?
        }
        None => read(manipulator, motion, ends)?,
    };
    let ends = ends.unwrap_or_default();
    let mode = match mode {
        Some(mode) => manipulator.mode(mode)?,
        None => motion.mode.unwrap_or_else(|| manipulator.inner.home_mode()),
    };
    let rate = rate.or(motion.rate).unwrap_or(DEFAULT_RATE);
    let inner = &*manipulator.inner;
    let motion = match time_optimal {
        true => motion.time_optimal(inner, mode).map_err(|error| failed(&error))?,
        false => motion,
    };
    let followed = core_trajectory::Trajectory::new(inner, &motion, mode, rate);
    let followed = followed.map_err(|error| failed(&error))?;
    let stop = AtomicBool::new(false);
    let interference = clearance.map(|_| Interference::new(inner.mechanism()));
    let motion_of = &motion;
    let watch = clearance.zip(interference.as_ref()).map(|(clearance, interference)| {
        let of = Watched { manipulator: inner, motion: motion_of, mode, clearance };
        (Watch::new(of, Distances::new(interference)), 1.0 / rate)
    });
    let work = || Record::follow(inner, followed, watch, &stop);
    let record =
        interrupt::run(py, NonZeroUsize::new(1), work, || stop.store(true, Ordering::Relaxed))??;
    let manipulator = owner.clone().unbind();
    let source =
        Source { manipulator, motion, file_name, text, mode, rate, ends, time_optimal, clearance };
    record.finish(py, source, interference.as_ref())
}

/// A motion, the name of its file, and the text of that.
type Read = (PlatformMotion, String, String);

/// Waypoints as a table of poses, one second apart if they have no times.
fn through(
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
fn read(
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
            let text = arguments::text(motion.py(), &path, "a motion file", "")?;
            (text, path.file_name().map_or(label.clone(), |n| n.display().to_string()))
        }
    };
    let motion = parse(manipulator, &text, (&name, &label), ends)?;
    Ok((motion, name, text))
}

/// The ends of this name.
fn spline_ends(name: &str) -> PyResult<Ends> {
    let found = Ends::NAMES.iter().find(|(known, _)| *known == name);
    found.map(|(_, ends)| *ends).ok_or_else(|| {
        let names = Ends::NAMES.map(|(name, _)| format!("{name:?}")).join(", ");
        wrong(format!("ends: {name:?}, expected one of {names}"))
    })
}

/// The motion in the text of a file of this name; messages call it `label`.
fn parse(
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

/// The columns while they are filled.
#[derive(Default)]
struct Record {
    times: Vec<f64>,
    /// Poses, rates and accelerations; of the dependent coordinates; of the joints; of the imaginary joints.
    tables: [Vec<f64>; 12],
    condition: Vec<f64>,
    /// Reachable, within limits, regular.
    answers: [Vec<bool>; 3],
    violations: Vec<core_trajectory::Violation>,
    /// The contacts, and the nearest pair with its time.
    contacts: (Vec<opm_interference::Contact>, Option<(Nearest, f64)>),
}

impl Record {
    fn follow(
        manipulator: &core::Manipulator,
        mut followed: core_trajectory::Trajectory<'_>,
        mut watch: Option<(Watch<'_>, f64)>,
        stop: &AtomicBool,
    ) -> PyResult<Self> {
        let mut record = Self::default();
        let samples = followed.samples();
        let width = manipulator.task_coordinates().len()
            + manipulator.dependent_coordinates().len()
            + manipulator.coordinates().len()
            + manipulator.imaginary().len();
        let room = usize::try_from(samples).ok().and_then(|n| n.checked_mul(3 * width));
        // Memory is allocated table by table; this reports early if there is not enough.
        let whole = room.filter(|&room| Vec::<f64>::new().try_reserve_exact(room).is_ok());
        whole.ok_or_else(|| no_memory(format_args!("{samples} samples")))?;
        while !stop.load(Ordering::Relaxed) && followed.advance().map_err(|e| failed(&e))? {
            let sample = followed.sample();
            record.add(sample);
            if let Some((watch, step)) = &mut watch {
                let solution = sample.reached.then_some(&sample.solution);
                watch.advance(sample.time, *step, solution).map_err(|error| failed(&error))?;
            }
            for change in followed.changes() {
                if let Change::Ends(violation) = change {
                    record.violations.push(*violation);
                }
            }
        }
        record.violations.extend(followed.open());
        record.violations.sort_by(|a, b| a.start.total_cmp(&b.start));
        if let Some((watch, _)) = watch {
            record.contacts = watch.finish();
        }
        Ok(record)
    }

    fn add(&mut self, sample: &Sample) {
        let Sample { time, instant, reached, solution, regular, motion, condition, .. } = sample;
        self.times.push(*time);
        self.condition.push(if *reached { *condition } else { f64::NAN });
        let rows: [(&[f64], bool); 12] = [
            (&instant.pose, true),
            (&instant.velocity, true),
            (&instant.acceleration, true),
            (solution.dependent(), *reached),
            (&motion.dependent_rates, *reached && *regular),
            (&motion.dependent_accelerations, *reached && *regular),
            (solution.joints(), *reached),
            (&motion.joint_rates, *reached && *regular),
            (&motion.joint_accelerations, *reached && *regular),
            (solution.imaginary(), *reached),
            (&motion.imaginary_rates, *reached && *regular),
            (&motion.imaginary_accelerations, *reached && *regular),
        ];
        for (table, (row, known)) in self.tables.iter_mut().zip(rows) {
            table.extend(row.iter().map(|&value| if known { value } else { f64::NAN }));
        }
        let answers = [*reached, sample.valid(), *reached && *regular];
        for (list, answer) in self.answers.iter_mut().zip(answers) {
            list.push(answer);
        }
    }

    fn finish(
        self,
        py: Python<'_>,
        source: Source,
        interference: Option<&Interference>,
    ) -> PyResult<Trajectory> {
        let manipulator = &*source.manipulator.get().inner;
        let rows = self.times.len();
        let widths = [
            manipulator.task_coordinates().len(),
            manipulator.dependent_coordinates().len(),
            manipulator.coordinates().len(),
            manipulator.imaginary().len(),
        ];
        let mut tables = self.tables.into_iter().enumerate();
        let mut table = || -> PyResult<Py<PyArray2<f64>>> {
            let (number, values) = tables.next().unwrap_or_default();
            frozen(values.into_pyarray(py).reshape([rows, widths[number / 3]])?)
        };
        let [reachable, within_limits, regular] =
            self.answers.map(|answers| frozen(answers.into_pyarray(py)));
        Ok(Trajectory {
            times: frozen(self.times.into_pyarray(py))?,
            poses: table()?,
            pose_rates: table()?,
            pose_accelerations: table()?,
            dependent: table()?,
            dependent_rates: table()?,
            dependent_accelerations: table()?,
            joints: table()?,
            joint_rates: table()?,
            joint_accelerations: table()?,
            imaginary: table()?,
            imaginary_rates: table()?,
            imaginary_accelerations: table()?,
            condition: frozen(self.condition.into_pyarray(py))?,
            reachable: reachable?,
            within_limits: within_limits?,
            regular: regular?,
            violations: self.violations.iter().map(|v| Violation::new(v, manipulator)).collect(),
            contacts: interference
                .map(|of| self.contacts.0.iter().map(|found| Contact::new(found, of)).collect()),
            nearest: interference.zip(self.contacts.1).map(|(of, (nearest, time))| {
                let [one, other] = of.names_of(nearest.pair).map(str::to_owned);
                (one, other, nearest.distance, time)
            }),
            joint_names: manipulator.coordinates().iter().map(|c| c.name.clone()).collect(),
            imaginary_names: manipulator.imaginary().iter().map(|j| j.name.clone()).collect(),
            units: units(manipulator),
            mode: manipulator.format_mode(source.mode),
            name: source.motion.name.clone(),
            rows,
            source,
        })
    }
}

impl Contact {
    fn new(found: &opm_interference::Contact, of: &Interference) -> Self {
        let opm_interference::Contact { pair, start, end, worst, distance } = *found;
        let [one, other] = of.names_of(pair).map(str::to_owned);
        Self { one, other, start, end, worst, distance }
    }
}

pickled!(Contact { one, other, start, end, worst, distance });

#[pymethods]
impl Contact {
    fn __repr__(&self) -> String {
        let Self { one, other, .. } = self;
        let [start, end, distance] = [self.start, self.end, self.distance].map(digits);
        format!("<Contact of {one} and {other} from {start} to {end} s: {distance} m>")
    }
}

impl Violation {
    fn new(violation: &core_trajectory::Violation, manipulator: &core::Manipulator) -> Self {
        let report = ViolationReport::new(violation, manipulator);
        Self {
            kind: report.kind.to_owned(),
            start: violation.start,
            end: violation.end,
            worst: violation.worst,
            amount: violation.amount,
            unit: report.unit().to_owned(),
            leg: report.leg.map(str::to_owned),
            joint: report.joint.map(str::to_owned),
            section: report.section.map(|section| section.to_string()),
            bound: report.bound.map(|bound| bound.name().to_owned()),
            singularity: report.singularity().map(str::to_owned),
            message: report.si(),
        }
    }
}

pickled!(Violation {
    kind,
    start,
    end,
    worst,
    amount,
    unit,
    leg,
    joint,
    section,
    bound,
    singularity,
    message,
});

columns!(Trajectory);

/// The parts of a trajectory in the form that Python sees.
const ATTRIBUTES: [&str; 26] = [
    "times",
    "poses",
    "pose_rates",
    "pose_accelerations",
    "dependent",
    "dependent_rates",
    "dependent_accelerations",
    "joints",
    "joint_rates",
    "joint_accelerations",
    "imaginary",
    "imaginary_rates",
    "imaginary_accelerations",
    "condition",
    "reachable",
    "within_limits",
    "regular",
    "violations",
    "contacts",
    "nearest",
    "joint_names",
    "imaginary_names",
    "units",
    "mode",
    "name",
    "rows",
];

/// The pickled input of a trajectory: manipulator, name and text of the file, rate, ends of a table, whether it has the
/// fastest timing, and the clearance.
type Followable = (Py<Manipulator>, String, String, f64, &'static str, bool, Option<f64>);

/// The same, as it is read.
type Restored = (Py<Manipulator>, String, String, f64, String, bool, Option<f64>);

#[pymethods]
impl Violation {
    fn __repr__(&self) -> String {
        let [start, end] = [self.start, self.end].map(digits);
        format!("<Violation from {start} to {end} s: {}>", self.message)
    }
}

#[pymethods]
impl Trajectory {
    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, Self>) -> PyResult<bool> {
        let [of, same] = [slf, other].map(|one| one.get().source.manipulator.get());
        Ok(of == same && equal(slf.as_any(), other.as_any(), &ATTRIBUTES)?)
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Pickled<'py, (Bound<'py, PyDict>, Followable)>> {
        let Source { manipulator, file_name, text, rate, ends, time_optimal, clearance, .. } =
            &slf.get().source;
        let manipulator = manipulator.clone_ref(slf.py());
        let (file_name, text, ends) = (file_name.clone(), text.clone(), ends.name());
        let source = (manipulator, file_name, text, *rate, ends, *time_optimal, *clearance);
        let attributes = attributes(slf.as_any(), &ATTRIBUTES)?;
        Ok((slf.get_type().getattr("_restored")?, (attributes, source)))
    }

    #[staticmethod]
    fn _restored(attributes: &Bound<'_, PyDict>, source: Restored) -> PyResult<Self> {
        let (manipulator, file_name, text, rate, ends, time_optimal, clearance) = source;
        let ends = spline_ends(&ends)?;
        let csv = file_name.to_ascii_lowercase().ends_with(".csv").then_some(ends);
        let motion = parse(manipulator.get(), &text, (&file_name, &file_name), csv)?;
        let mode: String = attribute(attributes, "mode")?;
        let signs = manipulator.get().mode(&mode)?;
        let motion = match time_optimal {
            true => motion
                .time_optimal(&manipulator.get().inner, signs)
                .map_err(|error| failed(&error))?,
            false => motion,
        };
        Ok(Self {
            times: attribute(attributes, "times")?,
            poses: attribute(attributes, "poses")?,
            pose_rates: attribute(attributes, "pose_rates")?,
            pose_accelerations: attribute(attributes, "pose_accelerations")?,
            dependent: attribute(attributes, "dependent")?,
            dependent_rates: attribute(attributes, "dependent_rates")?,
            dependent_accelerations: attribute(attributes, "dependent_accelerations")?,
            joints: attribute(attributes, "joints")?,
            joint_rates: attribute(attributes, "joint_rates")?,
            joint_accelerations: attribute(attributes, "joint_accelerations")?,
            imaginary: attribute(attributes, "imaginary")?,
            imaginary_rates: attribute(attributes, "imaginary_rates")?,
            imaginary_accelerations: attribute(attributes, "imaginary_accelerations")?,
            condition: attribute(attributes, "condition")?,
            reachable: attribute(attributes, "reachable")?,
            within_limits: attribute(attributes, "within_limits")?,
            regular: attribute(attributes, "regular")?,
            violations: attribute(attributes, "violations")?,
            contacts: attribute(attributes, "contacts")?,
            nearest: attribute(attributes, "nearest")?,
            joint_names: attribute(attributes, "joint_names")?,
            imaginary_names: attribute(attributes, "imaginary_names")?,
            units: attribute(attributes, "units")?,
            name: attribute(attributes, "name")?,
            rows: attribute(attributes, "rows")?,
            mode,
            source: Source {
                manipulator,
                motion,
                file_name,
                text,
                mode: signs,
                rate,
                ends,
                time_optimal,
                clearance,
            },
        })
    }

    /// Record the motion as ``opm trajectory -o`` does, byte for byte: it plays in Foxglove, Lichtblick and Rerun.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     The file appears when it is complete.
    /// indices : bool, optional
    ///     Also the indices of :class:`Analysis` that the mechanism has.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The file cannot be written.
    #[pyo3(signature = (path, *, indices = false))]
    fn write_mcap(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        indices: bool,
    ) -> PyResult<()> {
        let Source { manipulator, motion, file_name, text, mode, rate, clearance, .. } =
            &self.source;
        let manipulator = manipulator.get();
        let name = manipulator.file_name();
        let files = [
            Attachment { name: &name, text: manipulator.text() },
            Attachment { name: file_name, text },
        ];
        let request = MotionRequest::new(&manipulator.inner, motion, file_name);
        let request = request.mode(*mode).rate(*rate).clearance(clearance.unwrap_or(0.0));
        let setup = Setup::new(manipulator.inner.characteristic_length());
        let request = if indices { request.indices(&setup) } else { request };
        let stop = AtomicBool::new(false);
        let work = || {
            let trajectory = request.trajectory()?;
            let recorder = MotionRecorder::create(&path, request, files)?;
            recorder.follow(trajectory, |_| !stop.load(Ordering::Relaxed)).map(|_| ())
        };
        interrupt::run(py, NonZeroUsize::new(1), work, || stop.store(true, Ordering::Relaxed))?
            .map_err(study)
    }

    /// Write the motion as a table, as ``opm trajectory -o`` does, byte for byte: a row for each sample.
    ///
    /// The columns are ``t``, the task coordinates, the dependent coordinates, the joints and the imaginary joints, by
    /// their names; then ``d.NAME`` of all of them but ``t``, and ``dd.NAME``. Where there is no number, a cell of a CSV
    /// file is empty, and NaN in an NPY file.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     Its name ends in ``.csv``, or in ``.npy`` for a structured array. The file appears when it is complete.
    /// rates : bool, optional
    ///     Also the first derivatives by time.
    /// accelerations : bool, optional
    ///     Also the second derivatives by time.
    /// indices : bool, optional
    ///     Also the indices of :class:`Analysis` that the mechanism has, by their names.
    /// units : str, optional
    ///     ``"si"``: metres and radians; or ``"file"``: those of the mechanism file, which the header names: ``S1 [mm]``.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The file cannot be written, or its name ends otherwise.
    #[pyo3(signature = (path, *, rates = false, accelerations = false, indices = false, units = "si"))]
    fn write_table(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        rates: bool,
        accelerations: bool,
        indices: bool,
        units: &str,
    ) -> PyResult<()> {
        let Source { manipulator, motion, file_name, mode, rate, .. } = &self.source;
        let manipulator = manipulator.get();
        let units = match units {
            "si" => None,
            "file" => Some(
                mechanism::file::read(manipulator.text()).map_err(|error| failed(&error))?.units,
            ),
            other => return Err(wrong(format!("units: {other:?}, expected \"si\" or \"file\""))),
        };
        let options = TableOptions { rates, accelerations, units };
        let setup = Setup::new(manipulator.inner.characteristic_length());
        let request = MotionRequest::new(&manipulator.inner, motion, file_name);
        let request = request.mode(*mode).rate(*rate);
        let request = if indices { request.indices(&setup) } else { request };
        let stop = AtomicBool::new(false);
        let work = || {
            let trajectory = request.trajectory()?;
            let go_on = |_| !stop.load(Ordering::Relaxed);
            write_motion_table(request, trajectory, options, &path, go_on).map(|_| ())
        };
        interrupt::run(py, NonZeroUsize::new(1), work, || stop.store(true, Ordering::Relaxed))?
            .map_err(study)
    }

    /// Names of the columns of `poses`.
    #[getter]
    fn pose_names(&self) -> Vec<String> {
        let manipulator = self.source.manipulator.get();
        manipulator.pose_names().into_iter().map(str::to_owned).collect()
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "trajectory")
    }

    fn __repr__(&self) -> String {
        let (name, rows, mode, many) = (&self.name, self.rows, &self.mode, self.violations.len());
        format!("<Trajectory {name}: {rows} samples in mode {mode:?}, {many} violations>")
    }
}
