//! Solutions of the inverse kinematics of many poses, as arrays.

use crate::columns::columns;
use crate::error::failed;
use crate::pickle::{frozen, pickled};
use crate::rows::{Rows, Tables};
use crate::shared::Shared;
use crate::{html, interrupt};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use opm_core::Quantity;
use opm_core::linkage::{Linkage, LinkageBranch};
use opm_core::manipulator::{Batch, BatchError, BatchOutput, Manipulator, Mode};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

/// Poses that a thread solves between two checks whether it should stop.
const PART: usize = 4096;

/// Joint values of poses, NaN where a pose is out of reach.
///
/// The arrays begin with the axes of the poses: none for one pose, one for rows of poses. For one working mode they have the
/// shapes below. For all modes they have one more axis after those, with one entry for each mode: ``(..., m, k)``,
/// ``(..., m, j)``, ``(..., m)``.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Solutions {
    /// (..., k): every joint coordinate, metres and radians.
    joints: Py<PyArrayDyn<f64>>,
    /// (..., j): every imaginary joint, metres and radians.
    imaginary: Py<PyArrayDyn<f64>>,
    /// (...): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArrayDyn<bool>>,
    /// (...): whether the pose is in reach and all joints are within their limits.
    within_limits: Py<PyArrayDyn<bool>>,
    /// Names along the last axis of `joints`.
    joint_names: Shared<Vec<String>>,
    /// Names along the last axis of `imaginary`.
    imaginary_names: Shared<Vec<String>>,
    /// ``"m"`` or ``"rad"`` of every joint and imaginary joint, by name.
    units: Shared<BTreeMap<String, String>>,
    /// The working mode, or ``"all"``.
    mode: String,
    /// The working modes, in the order of the mode axis if there is one.
    modes: Vec<String>,
    /// Number of poses.
    rows: usize,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

impl Solutions {
    /// Inverse kinematics of every pose in one mode, straight into arrays of NumPy, with these columns of joints. The
    /// result does not depend on the number of threads.
    pub fn find(
        py: Python<'_>,
        manipulator: &Manipulator,
        poses: &Rows<'_>,
        (mode, columns): (Mode, &[usize]),
        names: Names,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Self> {
        let numpy = py.import("numpy")?;
        let widths = [columns.len(), manipulator.imaginary().len()];
        // NumPy allocates these, and raises an exception if there is no memory.
        let table = |width| -> PyResult<Bound<'_, PyArrayDyn<f64>>> {
            Ok(numpy.call_method1("empty", ((poses.count, width),))?.cast_into()?)
        };
        let answers = || -> PyResult<Bound<'_, PyArrayDyn<bool>>> {
            Ok(numpy.call_method1("zeros", (poses.count, py.get_type::<PyBool>()))?.cast_into()?)
        };
        let (joints, imaginary) = (table(widths[0])?, table(widths[1])?);
        let (reachable, within_limits) = (answers()?, answers()?);
        PosesPart {
            first: 0,
            poses: poses.values(),
            out: BatchOutput {
                joints: joints.readwrite().as_slice_mut()?,
                imaginary: imaginary.readwrite().as_slice_mut()?,
                reachable: reachable.readwrite().as_slice_mut()?,
                within_limits: within_limits.readwrite().as_slice_mut()?,
            },
        }
        .solve(py, manipulator, (mode, columns), threads)?;
        let tables =
            [poses.shaped(&joints, &widths[..1])?, poses.shaped(&imaginary, &widths[1..])?];
        let answers = [poses.shaped(&reachable, &[])?, poses.shaped(&within_limits, &[])?];
        Self::new(names, poses, tables, answers)
    }

    /// Makes solutions from tables with one row for each mode of each of these rows, the modes of a row together.
    pub fn of_all_modes(
        names: Names,
        rows: &Rows<'_>,
        mut tables: Tables<'_, 2>,
    ) -> PyResult<Self> {
        let modes = names.modes.len();
        let [joints, imaginary] = [names.joints.len(), names.imaginary.len()];
        let numbers = [
            rows.shaped(&tables.table(0), &[modes, joints])?,
            rows.shaped(&tables.table(1), &[modes, imaginary])?,
        ];
        let py = numbers[0].py();
        let [reachable, within_limits] = std::mem::take(&mut tables.answers)
            .map(|answers| rows.shaped(&answers.into_pyarray(py), &[modes]));
        Self::new(names, rows, numbers, [reachable?, within_limits?])
    }

    /// The arrays and the names along their axes.
    fn new(
        names: Names,
        rows: &Rows<'_>,
        [joints, imaginary]: [Bound<'_, PyArrayDyn<f64>>; 2],
        [reachable, within_limits]: [Bound<'_, PyArrayDyn<bool>>; 2],
    ) -> PyResult<Self> {
        let index = rows.index(joints.py());
        let numbers = [frozen(joints)?, frozen(imaginary)?];
        let answers = [frozen(reachable)?, frozen(within_limits)?];
        Self::of_arrays(names, rows.count, numbers, answers, index)
    }

    /// The same from read-only arrays.
    pub fn of_arrays(
        names: Names,
        rows: usize,
        [joints, imaginary]: [Py<PyArrayDyn<f64>>; 2],
        [reachable, within_limits]: [Py<PyArrayDyn<bool>>; 2],
        index: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let Names { joints: joint_names, imaginary: imaginary_names, units, mode, modes } = names;
        Ok(Self {
            joints,
            imaginary,
            reachable,
            within_limits,
            joint_names,
            imaginary_names,
            units,
            mode,
            modes,
            rows,
            index,
        })
    }
}

/// The names along the axes of solutions, and the units of their numbers.
pub struct Names {
    joints: Shared<Vec<String>>,
    imaginary: Shared<Vec<String>>,
    units: Shared<BTreeMap<String, String>>,
    mode: String,
    modes: Vec<String>,
}

/// The names and units of a manipulator, which all of its results have in common.
pub struct CommonNames {
    all: Shared<Vec<String>>,
    actuated: Shared<Vec<String>>,
    imaginary: Shared<Vec<String>>,
    units: Shared<BTreeMap<String, String>>,
    home_mode: String,
}

impl CommonNames {
    pub fn of(manipulator: &Manipulator) -> Self {
        let coordinates = manipulator.coordinates();
        let actuated = manipulator.actuated().iter().map(|&i| coordinates[i].name.clone());
        let imaginary = manipulator.imaginary().iter().map(|j| j.name.clone());
        Self {
            all: Shared::new(coordinates.iter().map(|c| c.name.clone()).collect()),
            actuated: Shared::new(actuated.collect()),
            imaginary: Shared::new(imaginary.collect()),
            units: Shared::new(units(manipulator)),
            home_mode: manipulator.format_mode(manipulator.home_mode()),
        }
    }

    /// Those of all joints, or of the actuated ones, in one mode or in all.
    pub fn names(&self, manipulator: &Manipulator, mode: Option<Mode>, actuated: bool) -> Names {
        let format = |mode| manipulator.format_mode(mode);
        let (mode, modes) = match mode {
            Some(mode) => {
                let home = mode == manipulator.home_mode();
                let signs = if home { self.home_mode.clone() } else { format(mode) };
                (signs.clone(), vec![signs])
            }
            None => ("all".to_owned(), manipulator.modes().map(format).collect()),
        };
        Names {
            joints: if actuated { self.actuated.clone() } else { self.all.clone() },
            imaginary: self.imaginary.clone(),
            units: self.units.clone(),
            mode,
            modes,
        }
    }
}

impl Names {
    /// The names and units of a linkage's joints in all branches of its input.
    pub fn of_branches(linkage: &Linkage, branches: &[LinkageBranch]) -> Self {
        let joints: Vec<_> = linkage.coordinates().iter().map(|c| c.name.clone()).collect();
        let imaginary: Vec<_> = linkage.imaginary().iter().map(|j| j.name.clone()).collect();
        let quantities = linkage.coordinates().iter().map(|c| c.quantity);
        let quantities = quantities.chain(linkage.imaginary().iter().map(|j| j.quantity));
        let names = joints.iter().chain(&imaginary).cloned();
        let unit = |(name, quantity): (String, Quantity)| (name, quantity.unit().to_owned());
        Self {
            units: Shared::new(names.zip(quantities).map(unit).collect()),
            joints: Shared::new(joints),
            imaginary: Shared::new(imaginary),
            mode: "all".to_owned(),
            modes: branches.iter().map(ToString::to_string).collect(),
        }
    }
}

/// The working memory of a thread.
struct Scratch {
    batch: Batch,
    home: Vec<f64>,
    /// Poses without NaN.
    patched: Vec<f64>,
    /// Every joint, of which some columns are wanted.
    joints: Vec<f64>,
}

impl Scratch {
    fn new(manipulator: &Manipulator) -> Self {
        let (batch, home) = (manipulator.batch(), manipulator.home_pose());
        Self { batch, home, patched: Vec::new(), joints: Vec::new() }
    }
}

/// Some of the poses, and the memory for their results.
struct PosesPart<'a> {
    /// Index of the first pose.
    first: usize,
    poses: &'a [f64],
    out: BatchOutput<'a>,
}

impl PosesPart<'_> {
    fn solve(
        self,
        py: Python<'_>,
        manipulator: &Manipulator,
        (mode, columns): (Mode, &[usize]),
        threads: Option<NonZeroUsize>,
    ) -> PyResult<()> {
        let stop = AtomicBool::new(false);
        let work = |scratch: &mut Scratch, part: PosesPart<'_>| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let first = part.first;
            let solved = part.solve_here(manipulator, (mode, columns), scratch);
            solved.err().map(|error| match error {
                BatchError::Pose { row, error } => BatchError::Pose { row: first + row, error },
                other => other,
            })
        };
        let scratch = || Scratch::new(manipulator);
        // If several poses are wrong, the message is about the first.
        let wrong = if self.out.reachable.len() <= PART {
            work(&mut scratch(), self)
        } else {
            let parts = self.parts(manipulator, columns.len());
            let all = || {
                let parts = parts.into_par_iter().map_init(scratch, work);
                parts.flatten().min_by_key(|error| match error {
                    BatchError::Pose { row, .. } => *row,
                    _ => 0,
                })
            };
            interrupt::run(py, threads, all, || stop.store(true, Ordering::Relaxed))?
        };
        wrong.map_or(Ok(()), |error| Err(failed(&error)))
    }

    /// Solves these poses. Rows with NaN are solved at home, and then marked as out of reach.
    fn solve_here(
        self,
        manipulator: &Manipulator,
        (mode, columns): (Mode, &[usize]),
        scratch: &mut Scratch,
    ) -> Result<(), BatchError> {
        let PosesPart { poses, mut out, .. } = self;
        let Scratch { batch, home, patched, joints } = scratch;
        let (width, all) = (home.len(), manipulator.coordinates().len());
        let missing = |pose: &[f64]| pose.iter().any(|value| value.is_nan());
        let whole = !missing(poses);
        if !whole {
            patched.clear();
            for pose in poses.chunks_exact(width) {
                patched.extend_from_slice(if missing(pose) { home } else { pose });
            }
        }
        let solved = if whole { poses } else { patched };
        if columns.len() == all {
            manipulator.inverse_many(solved, mode, batch, &mut out)?;
        } else {
            joints.resize(all * out.reachable.len(), f64::NAN);
            let BatchOutput { joints: some, imaginary, reachable, within_limits } = &mut out;
            let mut every = BatchOutput { joints, imaginary, reachable, within_limits };
            manipulator.inverse_many(solved, mode, batch, &mut every)?;
            let rows = some.chunks_exact_mut(columns.len()).zip(every.joints.chunks_exact(all));
            for (some, every) in rows {
                some.iter_mut().zip(columns).for_each(|(to, &column)| *to = every[column]);
            }
        }
        if !whole {
            let imaginary = manipulator.imaginary().len();
            for (row, _) in poses.chunks_exact(width).enumerate().filter(|(_, p)| missing(p)) {
                out.joints[row * columns.len()..][..columns.len()].fill(f64::NAN);
                out.imaginary[row * imaginary..][..imaginary].fill(f64::NAN);
                (out.reachable[row], out.within_limits[row]) = (false, false);
            }
        }
        Ok(())
    }

    fn parts(self, manipulator: &Manipulator, joints: usize) -> Vec<Self> {
        let [width, imaginary] =
            [manipulator.task_coordinates().len(), manipulator.imaginary().len()];
        let Self { mut first, poses, mut out } = self;
        let mut parts = Vec::with_capacity(out.reachable.len().div_ceil(PART));
        for poses in poses.chunks(PART * width) {
            let rows = poses.len() / width;
            let answers = BatchOutput {
                joints: split(&mut out.joints, rows * joints),
                imaginary: split(&mut out.imaginary, rows * imaginary),
                reachable: split(&mut out.reachable, rows),
                within_limits: split(&mut out.within_limits, rows),
            };
            parts.push(Self { first, poses, out: answers });
            first += rows;
        }
        parts
    }
}

/// Removes the first elements from a slice, and returns them.
fn split<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (taken, left) = std::mem::take(rest).split_at_mut(count);
    *rest = left;
    taken
}

/// The units of all joints and imaginary joints.
pub fn units(manipulator: &Manipulator) -> BTreeMap<String, String> {
    let joints = manipulator.coordinates().iter().map(|c| (&c.name, c.quantity));
    let imaginary = manipulator.imaginary().iter().map(|joint| (&joint.name, joint.quantity));
    joints
        .chain(imaginary)
        .map(|(name, quantity)| (name.clone(), quantity.unit().to_owned()))
        .collect()
}

columns!(Solutions);

pickled!(Solutions {
    joints,
    imaginary,
    reachable,
    within_limits,
    joint_names,
    imaginary_names,
    units,
    mode,
    modes,
    rows,
    index,
});

#[pymethods]
impl Solutions {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (poses, mode) = (self.rows, &self.mode);
        let [reachable, within] = [&self.reachable, &self.within_limits]
            .map(|answers| answers.bind(py).call_method0("sum")?.extract::<usize>());
        let (reachable, within) = (reachable?, within?);
        let of = match self.modes.len() {
            modes if mode == "all" => format!("{modes} modes"),
            _ => format!("mode {mode:?}"),
        };
        Ok(format!(
            "<Solutions of {poses} poses in {of}: {reachable} reachable, {within} within limits>"
        ))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "solutions")
    }
}
