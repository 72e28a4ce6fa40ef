//! The values of one joint, from results with a table of joints and one of imaginary joints.

use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyEllipsis;

/// The entries with this name along the last axis of the table that has it: a view.
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

/// Makes a class of results a container of rows, with columns by name.
macro_rules! columns {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            fn __len__(&self) -> usize {
                self.rows
            }

            /// The values of one joint or imaginary joint, (n,): a view.
            fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
                let tables = [
                    (&self.joint_names[..], self.joints.bind(py).as_any()),
                    (&self.imaginary_names[..], self.imaginary.bind(py).as_any()),
                ];
                $crate::columns::column(tables, name)
            }
        }
    };
}

pub(crate) use columns;
