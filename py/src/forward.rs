//! Forward kinematics: the poses at given joint values.

use crate::error::failed;
use crate::manipulator::Manipulator;
use crate::rows::Rows;
use numpy::{AllowTypeChange, IntoPyArray, PyArray1, PyArrayLike2};
use pyo3::prelude::*;

/// One way in which the mechanism can be assembled for given actuated joints.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Assembly {
    pose: Py<PyArray1<f64>>,
    mode: String,
    joints: Py<PyArray1<f64>>,
    imaginary: Py<PyArray1<f64>>,
    within_limits: bool,
    residual: f64,
}

#[pymethods]
impl Assembly {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let pose = self.pose.bind(py).repr()?;
        Ok(format!("<Assembly in mode {:?} at {pose}>", self.mode))
    }
}

#[pymethods]
impl Manipulator {
    /// Every assembly, for each row of actuated joints.
    fn forward<'py>(
        &self,
        py: Python<'py>,
        joints: PyArrayLike2<'py, f64, AllowTypeChange>,
    ) -> PyResult<Vec<Vec<Assembly>>> {
        let coordinates = self.inner.coordinates();
        let names: Vec<_> =
            self.inner.actuated().iter().map(|&i| coordinates[i].name.as_str()).collect();
        let rows = Rows::new(&joints, "joints", &names)?;
        let array = |numbers: Vec<f64>| numbers.into_pyarray(py).unbind();
        (0..rows.count)
            .map(|row| {
                py.check_signals()?;
                let found = py.detach(|| self.inner.forward(rows.row(row)));
                let assemblies = found.map_err(|error| failed(&error))?.list.into_iter();
                Ok(assemblies
                    .map(|assembly| Assembly {
                        pose: array(assembly.pose),
                        mode: self.inner.format_mode(assembly.mode),
                        joints: array(assembly.joints),
                        imaginary: array(assembly.imaginary),
                        within_limits: assembly.within_limits,
                        residual: assembly.residual,
                    })
                    .collect())
            })
            .collect()
    }
}
