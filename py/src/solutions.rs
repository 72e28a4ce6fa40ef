//! What inverse kinematics finds for many poses, as arrays.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
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
    /// Numbers as a table, which takes them over.
    pub fn table(
        py: Python<'_>,
        numbers: Vec<f64>,
        shape: [usize; 2],
    ) -> PyResult<Py<PyArray2<f64>>> {
        Ok(numbers.into_pyarray(py).reshape(shape)?.unbind())
    }

    pub fn new(
        py: Python<'_>,
        manipulator: &Manipulator,
        mode: Mode,
        (joints, imaginary): (Py<PyArray2<f64>>, Py<PyArray2<f64>>),
        (reachable, within_limits): (Vec<bool>, Vec<bool>),
    ) -> PyResult<Self> {
        Ok(Self {
            joints,
            imaginary,
            rows: reachable.len(),
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
