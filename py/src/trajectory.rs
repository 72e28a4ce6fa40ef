//! Motions of the platform as the joints follow them.

use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::rows::no_memory;
use crate::solutions::{column, units};
use numpy::{AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArrayLike2, PyArrayMethods};
use opm_core::manipulator as core;
use opm_core::motion::{Motion, Path as Course, Spline, examples, file, table};
use opm_core::trajectory::{self as core_trajectory, Change, Sample, Told};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Samples a second where nobody says, as on the command line.
const RATE: f64 = 100.0;

/// A motion as the joints follow it.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Trajectory {
    times: Py<PyArray1<f64>>,
    poses: Py<PyArray2<f64>>,
    pose_rates: Py<PyArray2<f64>>,
    pose_accelerations: Py<PyArray2<f64>>,
    joints: Py<PyArray2<f64>>,
    joint_rates: Py<PyArray2<f64>>,
    joint_accelerations: Py<PyArray2<f64>>,
    imaginary: Py<PyArray2<f64>>,
    imaginary_rates: Py<PyArray2<f64>>,
    imaginary_accelerations: Py<PyArray2<f64>>,
    condition: Py<PyArray1<f64>>,
    reachable: Py<PyArray1<bool>>,
    within_limits: Py<PyArray1<bool>>,
    regular: Py<PyArray1<bool>>,
    violations: Vec<Violation>,
    joint_names: Vec<String>,
    imaginary_names: Vec<String>,
    units: BTreeMap<String, &'static str>,
    mode: String,
    name: String,
    rows: usize,
}

/// A part of a motion that the mechanism cannot follow, or a singularity on its way.
#[pyclass(frozen, get_all, eq, module = "opm_kinematics")]
#[derive(Clone, PartialEq)]
pub struct Violation {
    kind: &'static str,
    start: f64,
    end: f64,
    worst: f64,
    amount: f64,
    unit: &'static str,
    leg: Option<String>,
    joint: Option<String>,
    section: Option<String>,
    bound: Option<&'static str>,
    singularity: Option<&'static str>,
    message: String,
}

/// Follows a motion: one that a file describes, or the cubic spline through poses at `times`.
#[pyfunction]
#[pyo3(signature = (manipulator, motion, /, *, times = None, rate = None, mode = None))]
pub fn trajectory(
    py: Python<'_>,
    manipulator: &Manipulator,
    motion: &Bound<'_, PyAny>,
    times: Option<Vec<f64>>,
    rate: Option<f64>,
    mode: Option<&str>,
) -> PyResult<Trajectory> {
    let motion = match times {
        Some(times) => through(manipulator, motion, times)?,
        None => read(manipulator, motion)?,
    };
    let mode = match mode {
        Some(mode) => manipulator.mode(mode)?,
        None => motion.mode.unwrap_or_else(|| manipulator.inner.home_mode()),
    };
    let rate = rate.or(motion.rate).unwrap_or(RATE);
    let inner = &*manipulator.inner;
    let followed = core_trajectory::Trajectory::new(inner, &motion, mode, rate);
    let followed = followed.map_err(|error| failed(&error))?;
    let stop = AtomicBool::new(false);
    let one = std::num::NonZeroUsize::new(1);
    let work = || Record::follow(inner, followed, &stop);
    let record = interrupt::run(py, one, work, || stop.store(true, Ordering::Relaxed))??;
    record.finish(py, inner, inner.format_mode(mode), motion.name.clone())
}

/// The natural cubic spline through waypoints.
fn through(
    manipulator: &Manipulator,
    poses: &Bound<'_, PyAny>,
    times: Vec<f64>,
) -> PyResult<Motion> {
    let array = poses.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>();
    let array = array.map_err(|_| wrong("motion: with times, expected (w, d) poses"))?;
    let poses = manipulator.poses(&array)?;
    if poses.count != times.len() {
        let (poses, times) = (poses.count, times.len());
        return Err(wrong(format!("{times} times of {poses} poses, expected one a pose")));
    }
    let names = manipulator.inner.task_coordinates();
    let values = (0..poses.count).flat_map(|row| poses.row(row)).chain(&times);
    if let Some(odd) = values.copied().find(|v| v.is_nan() || v.abs() > core::LARGEST) {
        return Err(wrong(format!("{odd} among the poses and times, expected numbers")));
    }
    let column = |i: usize| (0..poses.count).map(|row| poses.row(row)[i]).collect();
    let columns = (0..names.len()).map(column).collect();
    let (start, end) = (times.first().copied(), times.last().copied());
    let spline = Spline::new(times, columns).map_err(|error| failed(&error))?;
    let start = start.unwrap_or_default();
    Ok(Motion {
        name: "waypoints".to_owned(),
        start,
        duration: end.unwrap_or_default() - start,
        rate: None,
        mode: None,
        path: Course::Spline(spline),
    })
}

/// A motion file, a table of poses, or a shipped motion: an existing path wins.
fn read(manipulator: &Manipulator, motion: &Bound<'_, PyAny>) -> PyResult<Motion> {
    let expected = "motion: expected a path, the name of a shipped motion, or poses with times";
    let path: PathBuf = motion.extract().map_err(|_| wrong(expected))?;
    let label = path.display().to_string();
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => match examples::find(&label) {
            Some(example) => example.text.to_owned(),
            None => return Err(error.into()),
        },
    };
    let inner = &manipulator.inner;
    let csv = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    let stem = path.file_stem().map_or_else(|| label.clone(), |s| s.display().to_string());
    let motion = if csv { table::read(&text, &stem, inner) } else { file::read(&text, inner) };
    motion.map_err(|errors| wrong(errors.in_file(&label)))
}

/// Columns in the making.
#[derive(Default)]
struct Record {
    times: Vec<f64>,
    /// Poses, rates and accelerations; of the joints; of the imaginary joints.
    tables: [Vec<f64>; 9],
    condition: Vec<f64>,
    /// Reachable, within limits, regular.
    answers: [Vec<bool>; 3],
    violations: Vec<core_trajectory::Violation>,
}

impl Record {
    fn follow(
        manipulator: &core::Manipulator,
        mut followed: core_trajectory::Trajectory<'_>,
        stop: &AtomicBool,
    ) -> PyResult<Self> {
        let mut record = Self::default();
        let samples = followed.samples();
        let width = manipulator.task_coordinates().len()
            + manipulator.coordinates().len()
            + manipulator.imaginary().len();
        let room = usize::try_from(samples).ok().and_then(|n| n.checked_mul(3 * width));
        // The room itself is asked for table by table; this says early that there is none.
        let whole = room.filter(|&room| Vec::<f64>::new().try_reserve_exact(room).is_ok());
        whole.ok_or_else(|| no_memory(format_args!("{samples} samples")))?;
        while !stop.load(Ordering::Relaxed) && followed.advance().map_err(|e| failed(&e))? {
            record.add(followed.sample());
            for change in followed.changes() {
                if let Change::Ends(violation) = change {
                    record.violations.push(*violation);
                }
            }
        }
        record.violations.extend(followed.open());
        record.violations.sort_by(|a, b| a.start.total_cmp(&b.start));
        Ok(record)
    }

    fn add(&mut self, sample: &Sample) {
        let Sample { time, instant, reached, solution, regular, motion, condition, .. } = sample;
        self.times.push(*time);
        self.condition.push(if *reached { *condition } else { f64::NAN });
        let rows: [(&[f64], bool); 9] = [
            (&instant.pose, true),
            (&instant.velocity, true),
            (&instant.acceleration, true),
            (&solution.joints, *reached),
            (&motion.joint_rates, *reached && *regular),
            (&motion.joint_accelerations, *reached && *regular),
            (&solution.imaginary, *reached),
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
        manipulator: &core::Manipulator,
        mode: String,
        name: String,
    ) -> PyResult<Trajectory> {
        let rows = self.times.len();
        let widths = [
            manipulator.task_coordinates().len(),
            manipulator.coordinates().len(),
            manipulator.imaginary().len(),
        ];
        let mut tables = self.tables.into_iter().enumerate();
        let mut table = || -> PyResult<Py<PyArray2<f64>>> {
            let (number, values) = tables.next().unwrap_or_default();
            Ok(values.into_pyarray(py).reshape([rows, widths[number / 3]])?.unbind())
        };
        let [reachable, within_limits, regular] =
            self.answers.map(|answers| answers.into_pyarray(py).unbind());
        Ok(Trajectory {
            times: self.times.into_pyarray(py).unbind(),
            poses: table()?,
            pose_rates: table()?,
            pose_accelerations: table()?,
            joints: table()?,
            joint_rates: table()?,
            joint_accelerations: table()?,
            imaginary: table()?,
            imaginary_rates: table()?,
            imaginary_accelerations: table()?,
            condition: self.condition.into_pyarray(py).unbind(),
            reachable,
            within_limits,
            regular,
            violations: self.violations.iter().map(|v| Violation::new(v, manipulator)).collect(),
            joint_names: manipulator.coordinates().iter().map(|c| c.name.clone()).collect(),
            imaginary_names: manipulator.imaginary().iter().map(|j| j.name.clone()).collect(),
            units: units(manipulator),
            mode,
            name,
            rows,
        })
    }
}

impl Violation {
    fn new(violation: &core_trajectory::Violation, manipulator: &core::Manipulator) -> Self {
        let told = Told::new(violation, manipulator);
        Self {
            kind: told.kind,
            start: violation.start,
            end: violation.end,
            worst: violation.worst,
            amount: violation.amount,
            unit: told.unit(),
            leg: told.leg.map(str::to_owned),
            joint: told.joint.map(str::to_owned),
            section: told.section.map(|section| section.to_string()),
            bound: told.bound.map(core_trajectory::Bound::name),
            singularity: told.singularity(),
            message: told.si(),
        }
    }
}

#[pymethods]
impl Violation {
    fn __repr__(&self) -> String {
        format!("<Violation from {} to {} s: {}>", self.start, self.end, self.message)
    }
}

#[pymethods]
impl Trajectory {
    fn __len__(&self) -> usize {
        self.rows
    }

    /// The values of one joint or imaginary joint: a view.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let tables = [
            (&self.joint_names[..], self.joints.bind(py).as_any()),
            (&self.imaginary_names[..], self.imaginary.bind(py).as_any()),
        ];
        column(tables, name)
    }

    fn __repr__(&self) -> String {
        let (name, rows, mode, many) = (&self.name, self.rows, &self.mode, self.violations.len());
        format!("<Trajectory {name}: {rows} samples in mode {mode:?}, {many} violations>")
    }
}
