//! What inverse kinematics finds for many poses, as arrays.

use crate::rows::Tables;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use opm_core::manipulator::{Manipulator, Mode};
use pyo3::prelude::*;

/// Joint values of many poses in one working mode.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Solutions {
    /// `(n, k)`: every joint coordinate; NaN where a pose is out of reach.
    joints: Py<PyArray2<f64>>,
    /// `(n, j)`: every imaginary joint.
    imaginary: Py<PyArray2<f64>>,
    /// `(n,)`: in reach.
    reachable: Py<PyArray1<bool>>,
    /// `(n,)`: in reach, and all joints within their limits.
    within_limits: Py<PyArray1<bool>>,
    /// Names of the columns of `joints`.
    joint_names: Vec<String>,
    /// Names of the columns of `imaginary`.
    imaginary_names: Vec<String>,
    /// The working mode.
    mode: String,
    rows: usize,
}

impl Solutions {
    pub fn new(
        py: Python<'_>,
        manipulator: &Manipulator,
        mode: Mode,
        tables: &mut Tables<2>,
    ) -> PyResult<Self> {
        let [reachable, within_limits] = std::mem::take(&mut tables.answers);
        let rows = reachable.len();
        Ok(Self {
            joints: tables.take(py, 0)?.unbind(),
            imaginary: tables.take(py, 1)?.unbind(),
            rows,
            reachable: reachable.into_pyarray(py).unbind(),
            within_limits: within_limits.into_pyarray(py).unbind(),
            joint_names: manipulator.coordinates().iter().map(|c| c.name.clone()).collect(),
            imaginary_names: manipulator.imaginary().iter().map(|j| j.name.clone()).collect(),
            mode: manipulator.format_mode(mode),
        })
    }
}

#[pymethods]
impl Solutions {
    fn __len__(&self) -> usize {
        self.rows
    }

    fn __repr__(&self) -> String {
        format!("<Solutions of {} poses in mode {:?}>", self.rows, self.mode)
    }
}
