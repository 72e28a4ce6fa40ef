//! Motions of the platform as the joints follow them.

mod events;
mod read;
mod record;

use crate::arguments;
use crate::columns::columns;
use crate::error::{failed, study, wrong};
use crate::html;
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::parts::Pickled;
use crate::pickle::{attribute, attributes, equal};
use crate::velocity::characteristic_length;
pub use events::{Contact, Violation};
use numpy::{PyArray1, PyArray2};
use opm_analysis::{Setup, time_optimal_with_tool};
use opm_core::manipulator::Mode;
use opm_core::mechanism;
use opm_core::motion::table::is_table;
use opm_core::motion::{Ends, PlatformMotion, ToolLimits};
use opm_core::table::ColumnNames;
use opm_core::trajectory as core_trajectory;
use opm_interference::{Distances, Interference, Watch, Watched};
use opm_study::recording::{Attachment, MotionRecorder, TableOptions, write_motion_table};
use opm_study::{DEFAULT_RATE, MotionRequest};
use pyo3::prelude::*;
use pyo3::types::PyDict;
pub use read::motion;
use read::{Reading, parse, read, spline_ends, through};
use record::Record;
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
    /// The caps of the tool's motion if the motion has the fastest timing instead of its own.
    time_optimal: Option<ToolLimits>,
    /// The least distance of two bodies that is no contact, metres.
    clearance: Option<f64>,
}

/// The motion with its fastest timing.
fn timed(
    motion: &PlatformMotion,
    (inner, mode): (&opm_core::Manipulator, Mode),
    tool: ToolLimits,
) -> PyResult<PlatformMotion> {
    let setup = Setup::new(characteristic_length(inner, None)?);
    time_optimal_with_tool(motion, (inner, mode), &setup, tool).map_err(|error| failed(&error))
}

/// Follow a motion of the platform.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
/// motion : path, str or (w, d) array_like
///     A motion file, a table of poses (``.csv``) or of places in SE(3) (``t,x,y,z,qx,qy,qz,qw``, or the form of the TUM
///     benchmark in ``.tum`` and ``.txt``), or the name of a shipped motion; or, with `times`, waypoints with one
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
/// columns : dict of str, optional
///     The columns of a table of poses (``.csv``) that are read: for ``t`` and each task coordinate the heading of its column,
///     such as ``{"t": "stamp", "x": "pos_x"}``. Others are passed over.
/// relative_time : bool, optional
///     Count the times of a table of poses (``.csv``) from that of its first row, such as seconds since 1970.
/// time_optimal : bool, optional
///     The fastest timing along the same path, from rest to rest, within ``max_rate``, ``max_acceleration`` and
///     ``max_effort`` of the joints in the mechanism file. Every actuated joint needs one of the last two. Efforts are those of
///     :meth:`Manipulator.inverse_dynamics`, with 9.81 m/s² along -z.
/// tool_speed, tool_acceleration : float, optional
///     With `time_optimal`: the largest speed of the platform's reference point, m/s, and its largest acceleration, m/s².
/// tool_angular_speed, tool_angular_acceleration : float, optional
///     With `time_optimal`: the largest angular speed of the platform, rad/s, and its largest angular acceleration, rad/s².
///     Joints need no limits where both accelerations are capped, or the one that the platform has.
/// clearance : float, optional
///     Least distance of two bodies, metres: where it is less, they are in contact (:attr:`Trajectory.contacts`); 0 for
///     overlaps.
///
/// Returns
/// -------
/// Trajectory
///     Joint values and rates at each sample, and what cannot be followed.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// OpmError
///     Lists every problem of the file with its line and column; or waypoints are not poses, or times do not increase (the
///     message gives the index of the waypoint, counted from zero).
#[pyfunction]
#[pyo3(signature = (manipulator, motion, /, *, times = None, rate = None, mode = None, ends = None, columns = None, relative_time = false, time_optimal = false, tool_speed = None, tool_acceleration = None, tool_angular_speed = None, tool_angular_acceleration = None, clearance = None))]
#[allow(clippy::too_many_arguments)]
pub fn trajectory(
    py: Python<'_>,
    manipulator: &Bound<'_, Manipulator>,
    motion: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
    rate: Option<f64>,
    mode: Option<&str>,
    ends: Option<&str>,
    columns: Option<BTreeMap<String, String>>,
    relative_time: bool,
    time_optimal: bool,
    tool_speed: Option<f64>,
    tool_acceleration: Option<f64>,
    tool_angular_speed: Option<f64>,
    tool_angular_acceleration: Option<f64>,
    clearance: Option<f64>,
) -> PyResult<Trajectory> {
    let tool = ToolLimits {
        speed: tool_speed,
        acceleration: tool_acceleration,
        angular_speed: tool_angular_speed,
        angular_acceleration: tool_angular_acceleration,
    };
    if tool != ToolLimits::default() && !time_optimal {
        let problem = "tool_speed, tool_acceleration, tool_angular_speed and tool_angular_acceleration are caps of the fastest timing, expected time_optimal=True";
        return Err(wrong(problem.to_owned()));
    }
    if let Some(odd) = clearance.filter(|least| !(*least >= 0.0 && least.is_finite())) {
        return Err(wrong(format!("clearance is {odd:?} m, expected a length of 0 or more")));
    }
    let (owner, manipulator) = (manipulator, manipulator.get());
    let ends = ends.map(spline_ends).transpose()?;
    let columns = columns.map(|names| ColumnNames::new(names.into_iter().collect())).transpose();
    let columns = columns.map_err(|problem| wrong(format!("columns: {problem}")))?;
    let reading = Reading { ends, columns: columns.as_ref(), relative_time };
    if (columns.is_some() || relative_time) && motion.extract::<PathBuf>().is_err() {
        let given = if columns.is_some() { "columns" } else { "relative_time" };
        return Err(wrong(format!("{given}: waypoints have neither, expected a CSV file")));
    }
    let (motion, file_name, text) = match times {
        Some(times) => {
            let times = arguments::list(times, "times")?;
            through(manipulator, motion, Some(&times), ends.unwrap_or_default())?
        }
        // The fastest timing does not ask when, only along which curve.
        None if time_optimal && motion.extract::<PathBuf>().is_err() => {
            through(manipulator, motion, None, ends.unwrap_or_default())?
        }
        None => read(manipulator, motion, reading)?,
    };
    let ends = ends.unwrap_or_default();
    let mode = match mode {
        Some(mode) => manipulator.mode(mode)?,
        None => motion.mode.unwrap_or_else(|| manipulator.inner.home_mode()),
    };
    let rate = rate.or(motion.rate).unwrap_or(DEFAULT_RATE);
    let inner = &*manipulator.inner;
    let time_optimal = time_optimal.then_some(tool);
    let motion = match time_optimal {
        Some(tool) => timed(&motion, (inner, mode), tool)?,
        None => motion,
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

/// The pickled input of a trajectory: manipulator, name and text of the file, rate, ends of a table, the caps of the fastest
/// timing if it has that, and the clearance.
type Followable = (Py<Manipulator>, String, String, f64, &'static str, Caps, Option<f64>);

/// The same, as it is read.
type Restored = (Py<Manipulator>, String, String, f64, String, Caps, Option<f64>);

/// The pickled caps of the tool's motion: speed, acceleration, angular speed and angular acceleration.
type Caps = Option<[Option<f64>; 4]>;

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
        let caps = time_optimal.map(|tool| {
            [tool.speed, tool.acceleration, tool.angular_speed, tool.angular_acceleration]
        });
        let source = (manipulator, file_name, text, *rate, ends, caps, *clearance);
        let attributes = attributes(slf.as_any(), &ATTRIBUTES)?;
        Ok((slf.get_type().getattr("_restored")?, (attributes, source)))
    }

    #[staticmethod]
    fn _restored(attributes: &Bound<'_, PyDict>, source: Restored) -> PyResult<Self> {
        let (manipulator, file_name, text, rate, ends, caps, clearance) = source;
        let time_optimal =
            caps.map(|[speed, acceleration, angular_speed, angular_acceleration]| ToolLimits {
                speed,
                acceleration,
                angular_speed,
                angular_acceleration,
            });
        let ends = spline_ends(&ends)?;
        let csv = is_table(Path::new(&file_name)).then_some(ends);
        let reading = Reading { ends: csv, ..Default::default() };
        let (motion, _) = parse(manipulator.get(), &text, (&file_name, &file_name), reading)?;
        let mode: String = attribute(attributes, "mode")?;
        let signs = manipulator.get().mode(&mode)?;
        let motion = match time_optimal {
            Some(tool) => timed(&motion, (&manipulator.get().inner, signs), tool)?,
            None => motion,
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
