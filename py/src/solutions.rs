//! What inverse kinematics finds for many poses, as arrays.

use crate::html;
use crate::rows::Tables;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use opm_core::manipulator::{Manipulator, Mode};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyEllipsis;
use std::collections::BTreeMap;

/// Joint values of many poses, in one working mode or in all of them.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Solutions {
    /// `(n, k)`, or `(n, m, k)` of all modes: every joint coordinate; NaN out of reach.
    joints: Py<PyArrayDyn<f64>>,
    /// `(n, j)` or `(n, m, j)`: every imaginary joint.
    imaginary: Py<PyArrayDyn<f64>>,
    /// `(n,)` or `(n, m)`: in reach.
    reachable: Py<PyArrayDyn<bool>>,
    /// `(n,)` or `(n, m)`: in reach, and all joints within their limits.
    within_limits: Py<PyArrayDyn<bool>>,
    /// Names of the last axis of `joints`.
    joint_names: Vec<String>,
    /// Names of the last axis of `imaginary`.
    imaginary_names: Vec<String>,
    /// `m` or `rad` of every joint and imaginary joint, by name.
    units: BTreeMap<String, &'static str>,
    /// The working mode, or `all`.
    mode: String,
    /// The working modes: of the mode axis, if there is one.
    modes: Vec<String>,
    rows: usize,
}

impl Solutions {
    /// From tables with a row a pose in one mode; or, without a mode, a row for each mode of each pose,
    /// the modes of a pose together.
    pub fn new(
        py: Python<'_>,
        manipulator: &Manipulator,
        mode: Option<Mode>,
        tables: &mut Tables<2>,
    ) -> PyResult<Self> {
        let modes: Vec<String> = match mode {
            Some(mode) => vec![manipulator.format_mode(mode)],
            None => manipulator.modes().map(|mode| manipulator.format_mode(mode)).collect(),
        };
        let answers = std::mem::take(&mut tables.answers);
        let rows = answers[0].len() / modes.len();
        let axis = mode.is_none().then_some(modes.len());
        let shape = |last: Option<usize>| -> Vec<usize> {
            [Some(rows), axis, last].into_iter().flatten().collect()
        };
        let widths = [manipulator.coordinates().len(), manipulator.imaginary().len()];
        let [joints, imaginary] = widths.map(|width| shape(Some(width)));
        let [reachable, within_limits] =
            answers.map(|answers| answers.into_pyarray(py).reshape(shape(None)));
        Ok(Self {
            joints: tables.take(py, 0)?.reshape(joints)?.unbind(),
            imaginary: tables.take(py, 1)?.reshape(imaginary)?.unbind(),
            rows,
            reachable: reachable?.unbind(),
            within_limits: within_limits?.unbind(),
            units: units(manipulator),
            joint_names: manipulator.coordinates().iter().map(|c| c.name.clone()).collect(),
            imaginary_names: manipulator.imaginary().iter().map(|j| j.name.clone()).collect(),
            mode: if axis.is_some() { "all".to_owned() } else { modes[0].clone() },
            modes,
        })
    }
}

/// The units of all joints and imaginary joints.
pub fn units(manipulator: &Manipulator) -> BTreeMap<String, &'static str> {
    let joints = manipulator.coordinates().iter().map(|c| (&c.name, c.quantity));
    let imaginary = manipulator.imaginary().iter().map(|joint| (&joint.name, joint.quantity));
    joints.chain(imaginary).map(|(name, quantity)| (name.clone(), quantity.unit())).collect()
}

/// The entries of one name, along the last axis of whichever table has it: a view.
pub fn column<'py>(
    tables: [(&[String], &Bound<'py, PyAny>); 2],
    name: &str,
) -> PyResult<Bound<'py, PyAny>> {
    for (names, table) in tables {
        if let Some(number) = names.iter().position(|known| known == name) {
            return table.get_item((PyEllipsis::get(table.py()), number));
        }
    }
    let known = tables.map(|(names, _)| names.join(", ")).join(", ");
    Err(PyKeyError::new_err(format!("{name}: no such joint among {known}")))
}

#[pymethods]
impl Solutions {
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
