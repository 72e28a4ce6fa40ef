//! Classes that consist of their attributes. They are pickled by these, and are equal if these are equal.

use numpy::PyUntypedArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

/// Makes an array of an immutable object read-only.
pub fn frozen<'py, T>(array: Bound<'py, T>) -> PyResult<Py<T>> {
    // Nothing can be written through the array that it is a view of, either.
    let base = array.as_any().getattr("base")?;
    if base.is_instance_of::<PyUntypedArray>() {
        base.call_method1("setflags", (false,))?;
    }
    array.as_any().call_method1("setflags", (false,))?;
    Ok(array.unbind())
}

/// The attributes with these names.
pub fn attributes<'py>(object: &Bound<'py, PyAny>, names: &[&str]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(object.py());
    for name in names {
        dict.set_item(name, object.getattr(*name)?)?;
    }
    Ok(dict)
}

/// Restores an attribute. An array from a pickle is writable; this makes it read-only.
pub fn attribute<'py, T: pyo3::conversion::FromPyObjectOwned<'py>>(
    attributes: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<T> {
    let missing = || PyValueError::new_err(format!("no {name} in the pickle"));
    let value = attributes.get_item(name)?.ok_or_else(missing)?;
    if value.is_instance_of::<PyUntypedArray>() {
        value.call_method1("setflags", (false,))?;
    }
    value.extract().map_err(Into::into)
}

/// Whether the attributes with these names are equal.
pub fn equal<'py>(a: &Bound<'py, PyAny>, b: &Bound<'py, PyAny>, names: &[&str]) -> PyResult<bool> {
    for name in names {
        if !same(&a.getattr(*name)?, &b.getattr(*name)?)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether values are equal: arrays as a whole, and NaN equal to NaN.
fn same(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> PyResult<bool> {
    if a.is_instance_of::<PyUntypedArray>() {
        let options = PyDict::new(a.py());
        options.set_item("equal_nan", true)?;
        let equal = a.py().import("numpy")?.call_method("array_equal", (a, b), Some(&options))?;
        return equal.is_truthy();
    }
    if a.is_instance_of::<PyTuple>() || a.is_instance_of::<PyList>() {
        if a.len()? != b.len()? {
            return Ok(false);
        }
        for (a, b) in a.try_iter()?.zip(b.try_iter()?) {
            if !same(&a?, &b?)? {
                return Ok(false);
            }
        }
        return Ok(true);
    }
    if a.is_none() || b.is_none() {
        return Ok(a.is_none() && b.is_none());
    }
    // The labels of rows, whose == is by entry.
    if let Some(equals) = a.getattr_opt("equals")? {
        return equals.call1((b,))?.is_truthy();
    }
    a.eq(b)
}

/// Implements pickling and comparison for a class that consists of its attributes.
macro_rules! pickled {
    ($class:ident { $($name:ident),+ $(,)? }) => {
        #[pymethods]
        impl $class {
            fn __eq__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, Self>) -> PyResult<bool> {
                let names = [$(stringify!($name)),+];
                $crate::pickle::equal(slf.as_any(), other.as_any(), &names)
            }

            fn __reduce__<'py>(
                slf: &Bound<'py, Self>,
            ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, pyo3::types::PyDict>,))> {
                let names = [$(stringify!($name)),+];
                let attributes = $crate::pickle::attributes(slf.as_any(), &names)?;
                Ok((slf.get_type().getattr("_restored")?, (attributes,)))
            }

            #[staticmethod]
            fn _restored(attributes: &Bound<'_, pyo3::types::PyDict>) -> PyResult<Self> {
                Ok(Self {
                    $($name: $crate::pickle::attribute(attributes, stringify!($name))?),+
                })
            }
        }
    };
}

pub(crate) use pickled;
