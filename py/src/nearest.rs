//! The nearest poses in reach to poses that are not.

use crate::arguments;
use crate::columns::tabled;
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use crate::rows::{Rows, Tables};
use crate::velocity::characteristic_length;
use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use std::num::NonZeroUsize;

/// The nearest poses found that are in reach within all limits.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct NearestReachable {
    /// (..., d): task coordinates, metres and radians: those given where these are in reach; NaN where no pose in reach was
    /// found.
    poses: Py<PyArrayDyn<f64>>,
    /// (...): distances from the poses given, metres; zero where these are in reach.
    distance: Py<PyArrayDyn<f64>>,
    /// The characteristic length by which angles are multiplied, metres.
    length: f64,
    /// Names along the last axis of `poses`.
    pose_names: Vec<String>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(NearestReachable);

pickled!(NearestReachable { poses, distance, length, pose_names, index });

#[pymethods]
impl NearestReachable {
    fn __repr__(&self, py: Python<'_>) -> String {
        let distance = self.distance.bind(py).readonly();
        let distance = distance.as_array();
        let moved = distance.iter().filter(|&&distance| distance > 0.0).count();
        let none = distance.iter().filter(|distance| distance.is_nan()).count();
        let all = distance.len();
        format!("<NearestReachable of {all} poses: {moved} moved, {none} without a pose in reach>")
    }
}

#[pymethods]
impl Manipulator {
    /// The nearest poses found that are in reach within all limits, for poses that need not be.
    ///
    /// Nearest in the coordinates of a pose: the root of the sum of the squares of the differences, of lengths in metres and of
    /// angles in radians times `length`; angles count modulo a revolution, but where a screw turns with them. The search
    /// begins at poses in reach, bisects the way to the pose, and follows the boundary of reach down. What it finds is in
    /// reach by the same computation as :meth:`inverse`. Nothing proves that it is the nearest of all.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     The working mode in which poses are in reach, ``"home"`` for that of home, or ``"any"``.
    /// length : float, optional
    ///     Characteristic length by which angles are multiplied, metres; the spread of the joint axes if not given.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// NearestReachable
    ///     With `poses` (..., d), `distance` (...) in metres, and `length`. NaN where no pose in reach was found, and for rows with
    ///     NaN.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The columns are not the task coordinates, a number is infinite, the mode is unknown, or the length is not positive.
    ///
    /// Examples
    /// --------
    /// The right arm of this five-bar, 445 mm long, stands at (160 mm, 0).
    ///
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("five-bar")
    /// >>> found = m.nearest_reachable({"x": -1.0, "y": 1.0}, mode="any")
    /// >>> bool(abs(found.distance - ((1.16**2 + 1) ** 0.5 - 0.445)) < 1e-9)
    /// True
    #[pyo3(signature = (poses, *, mode = "home", length = None, threads = None))]
    fn nearest_reachable<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<NearestReachable> {
        let mode = if mode == "any" { None } else { Some(self.mode(mode)?) };
        let length = characteristic_length(&self.inner, length)?;
        let poses = self.poses(poses)?;
        let poses = Rows::new(&poses)?;
        let (width, none) = (self.pose_names().len(), || ());
        // Each takes milliseconds: a thread looks whether it should stop after every one.
        let (all, widths) = ((poses.count, 1), [width, 1]);
        let tables = Tables::fill_in_blocks(py, all, widths, threads, none, |(), row, out| {
            if poses.missing(row) {
                return Ok([false; 2]);
            }
            let found = self.inner.reach().nearest(poses.row(row), mode, length);
            let found = found.map_err(|error| format!("pose {row}: {error}"))?;
            let Some(found) = found else { return Ok([false; 2]) };
            let [pose, distance] = out;
            pose.copy_from_slice(&found.pose);
            distance[0] = found.distance;
            Ok([true; 2])
        })?;
        Ok(NearestReachable {
            poses: poses.frozen(&tables.table(0), &[width])?,
            distance: poses.frozen(&tables.table(1), &[])?,
            length,
            pose_names: self.pose_names().into_iter().map(str::to_owned).collect(),
            index: poses.index(py),
        })
    }
}
