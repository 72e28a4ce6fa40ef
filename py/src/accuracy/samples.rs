//! Mechanisms with errors that are drawn at random, at many poses.

use crate::columns::tabled;
use crate::error::wrong;
use crate::interrupt;
use crate::pickle::pickled;
use crate::rows::Rows;
use numpy::{IntoPyArray, PyArrayDyn};
use opm_accuracy::{Assembler, Model, Samples};
use opm_core::manipulator::Mode;
use opm_study::Drawing;
use opm_workspace::Progress;
use pyo3::prelude::*;
use std::num::{NonZeroU64, NonZeroUsize};

/// What errors do that are drawn at random, each uniform within its size: of mechanisms that are assembled beyond first order.
/// NaN where a pose is out of reach, and where a number is not known.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct AccuracySamples {
    /// (..., d), metres and radians: the standard deviation of every task coordinate from its nominal value.
    deviations: Py<PyArrayDyn<f64>>,
    /// (...), metres: what 95 % of the displacements of the platform's reference point do not exceed.
    length: Py<PyArrayDyn<f64>>,
    /// (...), radians: what 95 % of the platform's rotations do not exceed.
    angle: Py<PyArrayDyn<f64>>,
    /// (..., j), metres: what 95 % of the plays of each joint do not exceed.
    misfit_length: Py<PyArrayDyn<f64>>,
    /// (..., j), radians: what 95 % of the plays of each joint do not exceed.
    misfit_angle: Py<PyArrayDyn<f64>>,
    /// (...): how many mechanisms cannot be assembled near the pose.
    failed: Py<PyArrayDyn<u64>>,
    /// How many mechanisms are drawn at each pose.
    count: u64,
    /// The seed of what is drawn.
    seed: u64,
    /// Names of the task coordinates.
    pose_names: Vec<String>,
    /// Names of the joints.
    joints: Vec<String>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(AccuracySamples);

pickled!(AccuracySamples {
    deviations,
    length,
    angle,
    misfit_length,
    misfit_angle,
    failed,
    count,
    seed,
    pose_names,
    joints,
    index
});

#[pymethods]
impl AccuracySamples {
    fn __repr__(&self) -> String {
        format!("<AccuracySamples: {} mechanisms at each pose, seed {}>", self.count, self.seed)
    }
}

/// Draws mechanisms at every pose, and assembles them.
pub fn draw(
    py: Python<'_>,
    model: &Model<'_>,
    (poses, mode): (&Rows<'_>, Mode),
    (count, seed): (NonZeroU64, u64),
    sizes: &[f64],
    threads: Option<NonZeroUsize>,
) -> PyResult<AccuracySamples> {
    let manipulator = model.manipulator();
    let progress = Progress::default();
    let at_pose = |row: usize| -> Result<Option<Samples>, String> {
        let mut solution = manipulator.solution();
        if poses.missing(row) {
            return Ok(None);
        }
        let found = manipulator.inverse(poses.row(row), mode, &mut solution);
        let Some(at) = found.map_err(|error| format!("pose {row}: {error}"))? else {
            return Ok(None);
        };
        let assembler = Assembler::new(model, at, mode).map_err(|e| format!("pose {row}: {e}"))?;
        let drawing = Drawing { assembler: &assembler, sizes, count: count.get(), seed };
        // Cancelled work has no use for an answer.
        Ok(drawing.samples(&progress).ok())
    };
    let all = || (0..poses.count).map(at_pose).collect::<Result<Vec<_>, String>>();
    let all = interrupt::run(py, threads, all, || progress.cancel())?.map_err(wrong)?;
    let d = manipulator.task_coordinates().len();
    let j = manipulator.mechanism().joints().count();
    let table = |width: usize, values: &dyn Fn(&Samples) -> Vec<f64>| {
        let rows = all.iter().flat_map(|found| {
            let values = found.as_ref().map(values).unwrap_or_default();
            // Nothing is known where no mechanism was assembled.
            if values.len() == width { values } else { vec![f64::NAN; width] }
        });
        let flat: Vec<f64> = rows.collect();
        poses.frozen(&flat.into_pyarray(py), &[width])
    };
    let flat = |value: fn(&Samples) -> f64| {
        let values = all.iter().map(|found| found.as_ref().map_or(f64::NAN, value));
        poses.frozen(&values.collect::<Vec<_>>().into_pyarray(py), &[])
    };
    let failed: Vec<u64> = all.iter().map(|found| found.as_ref().map_or(0, |s| s.failed)).collect();
    Ok(AccuracySamples {
        deviations: table(d, &|samples| samples.deviations.clone())?,
        length: flat(|samples| samples.length)?,
        angle: flat(|samples| samples.angle)?,
        misfit_length: table(j, &|s| s.misfit.iter().map(|play| play[0]).collect())?,
        misfit_angle: table(j, &|s| s.misfit.iter().map(|play| play[1]).collect())?,
        failed: poses.frozen(&failed.into_pyarray(py), &[])?,
        count: count.get(),
        seed,
        pose_names: manipulator.task_coordinates().iter().map(|c| c.name.into()).collect(),
        joints: manipulator.mechanism().joints().map(|joint| joint.name.clone()).collect(),
        index: poses.index(py),
    })
}
