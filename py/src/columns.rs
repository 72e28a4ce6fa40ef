//! The values of one joint, from results with a table of joints and one of imaginary joints.

use opm_core::text::cell;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyEllipsis;

/// The table that a function of the package's module `_tables` makes of results.
pub fn table<'py>(of: &Bound<'py, PyAny>, function: &str) -> PyResult<Bound<'py, PyAny>> {
    of.py().import("opm_kinematics._tables")?.call_method1(function, (of,))
}

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
    Err(PyKeyError::new_err(format!("{}: no such joint among {known}", cell(name))))
}

/// A view of a mapping, by the class of `collections.abc` with this name.
pub fn view<'py>(of: &Bound<'py, PyAny>, class: &str) -> PyResult<Bound<'py, PyAny>> {
    of.py().import("collections.abc")?.getattr(class)?.call1((of,))
}

/// Makes a class of results a mapping of the names of columns to these.
macro_rules! columns {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            fn __len__(&self) -> usize {
                self.joint_names.len() + self.imaginary_names.len()
            }

            fn __iter__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<Bound<'py, pyo3::types::PyIterator>> {
                let names = self.joint_names.iter().chain(self.imaginary_names.iter());
                pyo3::types::PyList::new(py, names)?.try_iter()
            }

            fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
                let known = |name: &String| {
                    self.joint_names.contains(name) || self.imaginary_names.contains(name)
                };
                name.extract::<String>().is_ok_and(|name| known(&name))
            }

            /// The names of the joints, then of the imaginary joints.
            ///
            /// Returns
            /// -------
            /// KeysView
            ///     The names, in order.
            fn keys<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                $crate::columns::view(slf.as_any(), "KeysView")
            }

            /// The values of each joint and imaginary joint: views.
            ///
            /// Returns
            /// -------
            /// ValuesView
            ///     The values of each, as ``self[name]``.
            fn values<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                $crate::columns::view(slf.as_any(), "ValuesView")
            }

            /// Names and values.
            ///
            /// Returns
            /// -------
            /// ItemsView
            ///     Names with values.
            fn items<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                $crate::columns::view(slf.as_any(), "ItemsView")
            }

            /// The values of one joint or imaginary joint, or something else if there is none of this name.
            ///
            /// Parameters
            /// ----------
            /// name : str
            ///     Name of the joint.
            /// default : object, optional
            ///     What is returned if there is none.
            ///
            /// Returns
            /// -------
            /// ndarray or object
            ///     ``self[name]``, or `default`.
            #[pyo3(signature = (name, default = None, /))]
            fn get<'py>(
                &self,
                py: Python<'py>,
                name: &str,
                default: Option<Bound<'py, PyAny>>,
            ) -> Option<Bound<'py, PyAny>> {
                self.__getitem__(py, name).ok().or(default)
            }

            /// A table of pandas, with a row for each row of the arrays and each mode, and a column for each joint.
            ///
            /// Returns
            /// -------
            /// pandas.DataFrame
            ///     SI units and radians.
            fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                $crate::columns::table(slf.as_any(), "to_pandas")
            }

            /// A dataset of xarray, with a variable for each joint, which has its unit.
            ///
            /// Returns
            /// -------
            /// xarray.Dataset
            ///     SI units and radians.
            fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                $crate::columns::table(slf.as_any(), "to_xarray")
            }

            /// The values of one joint or imaginary joint, (...): a view.
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

/// Implements a table of pandas for a result.
macro_rules! tabled {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// A table of pandas.
            ///
            /// Of a result at poses it has a row for each pose and a column for each number, such as ``joint_rates.S1``; of others
            /// it has a row for each entry. The rows of a data frame keep their labels.
            ///
            /// Returns
            /// -------
            /// pandas.DataFrame
            ///     SI units and radians.
            fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                $crate::columns::table(slf.as_any(), "result_to_pandas")
            }
        }
    };
}

pub(crate) use tabled;
