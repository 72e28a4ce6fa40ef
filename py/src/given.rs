//! Rows of numbers from Python: arrays, one row alone, or columns by name.

use crate::arguments::{Array, numbers, shown};
use crate::error::wrong;
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

/// The columns that an argument has.
#[derive(Clone, Copy)]
pub struct Columns<'a> {
    pub names: &'a [&'a str],
    /// The values of columns that are not among those given by name. Without them, each has to be given.
    pub otherwise: Option<&'a [f64]>,
}

/// Rows of numbers, as they were given.
pub struct Given<'py> {
    pub array: Array<'py>,
    /// Whether it was one row, without an axis of rows.
    pub one: bool,
}

impl<'a> Columns<'a> {
    pub fn all(names: &'a [&'a str]) -> Self {
        Self { names, otherwise: None }
    }

    /// Rows of these columns, or one row: an array, a table with names, or numbers by name.
    pub fn read<'py>(self, given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
        if let Some(labels) = labels(given)? {
            return self.by_name(given, &labels, what);
        }
        let width = self.names.len();
        let expected = || format!("({width},) or (n, {width}): {}", self.names.join(", "));
        let array = numbers(given, what, &expected)?;
        match array.shape() {
            [one] if *one == width => Given::one(&array),
            [_, one] if *one == width => Ok(Given { array: array.extract()?, one: false }),
            _ => {
                let shape = array.getattr("shape")?;
                Err(wrong(format!("{what} has shape {shape}, expected {}", expected())))
            }
        }
    }

    /// The same from columns with these labels, in any order.
    fn by_name<'py>(
        self,
        given: &Bound<'py, PyAny>,
        labels: &[Bound<'py, PyAny>],
        what: &str,
    ) -> PyResult<Given<'py>> {
        let expected = || format!("expected {}", self.names.join(", "));
        let mut found: Vec<Option<Bound<'py, PyAny>>> = vec![None; self.names.len()];
        for label in labels {
            let name = label.extract::<String>().unwrap_or_default();
            let Some(number) = self.names.iter().position(|known| *known == name) else {
                let label = shown(label);
                return Err(wrong(format!("{what} has a column {label}, {}", expected())));
            };
            if found[number].is_some() {
                return Err(wrong(format!("{what} has two columns {name}")));
            }
            let scalar_or_column = || "a number or (n,) numbers".to_owned();
            let column = numbers_or_one(&given.get_item(label)?, what, &name, &scalar_or_column)?;
            found[number] = Some(column);
        }
        for (number, column) in found.iter_mut().enumerate() {
            if column.is_none() {
                let name = self.names[number];
                let missing = || wrong(format!("{what} has no column {name}, {}", expected()));
                let value = self.otherwise.ok_or_else(missing)?[number];
                *column = Some(value.into_pyobject(given.py())?.into_any());
            }
        }
        let numpy = given.py().import("numpy")?;
        let columns: Vec<_> = found.into_iter().flatten().collect();
        let together = numpy
            .call_method1("broadcast_arrays", pyo3::types::PyTuple::new(given.py(), &columns)?);
        let together = together.map_err(|_| {
            let lengths = columns.iter().zip(self.names).filter_map(|(column, name)| {
                let length = column.len().ok()?;
                Some(format!("{name} {length}"))
            });
            let lengths: Vec<_> = lengths.collect();
            wrong(format!("{what} has columns of different lengths: {}", lengths.join(", ")))
        })?;
        let options = PyDict::new(given.py());
        options.set_item("axis", -1)?;
        options.set_item("dtype", "float64")?;
        let array: Bound<'py, PyUntypedArray> =
            numpy.call_method("stack", (together,), Some(&options))?.cast_into()?;
        match array.ndim() {
            1 => Given::one(&array),
            _ => Ok(Given { array: array.extract()?, one: false }),
        }
    }
}

impl<'py> Given<'py> {
    fn one(array: &Bound<'py, PyUntypedArray>) -> PyResult<Self> {
        let width = array.shape()[0];
        Ok(Self { array: array.call_method1("reshape", ((1, width),))?.extract()?, one: true })
    }
}

/// One column: numbers, or one number.
fn numbers_or_one<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
    name: &str,
    expected: &dyn Fn() -> String,
) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(number) = given.extract::<f64>() {
        return Ok(number.into_pyobject(given.py())?.into_any());
    }
    let column = numbers(given, &format!("{name} of {what}"), expected)?;
    if column.ndim() != 1 {
        let shape = column.getattr("shape")?;
        return Err(wrong(format!("{name} of {what} has shape {shape}, expected {}", expected())));
    }
    Ok(column.into_any())
}

/// The labels of columns: those of a mapping, a data frame, a series, or a structured array. `None` if nothing has a
/// name: a data frame of a plain array has numbers for labels.
fn labels<'py>(given: &Bound<'py, PyAny>) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    let columns = if let Ok(structured) = given.cast::<PyUntypedArray>() {
        structured.dtype().getattr("names")?.extract()?
    } else {
        match given.getattr_opt("keys")? {
            Some(keys) => Some(keys.call0()?),
            // A data frame of Polars has no keys.
            None => given.getattr_opt("columns")?,
        }
    };
    let Some(columns) = columns else { return Ok(None) };
    let labels = columns.try_iter()?.collect::<PyResult<Vec<_>>>()?;
    let unnamed = labels.iter().all(|label| label.extract::<String>().is_err());
    match unnamed && given.cast::<PyMapping>().is_err() {
        true => Ok(None),
        false => Ok(Some(labels)),
    }
}

/// A masked array, or a column with missing entries, as an array with NaN in their places.
pub fn unmasked<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let numpy = given.py().import("numpy")?;
    if given.is_instance(&numpy.getattr("ma")?.getattr("MaskedArray")?)? {
        let filled = given.call_method1("astype", ("float64",))?;
        return filled.call_method1("filled", (f64::NAN,));
    }
    // A series of pandas has entries that no float stands for; others have no such arguments.
    if given.hasattr("isna")? {
        let options = PyDict::new(given.py());
        options.set_item("dtype", "float64")?;
        options.set_item("na_value", f64::NAN)?;
        return match given.call_method("to_numpy", (), Some(&options)) {
            Err(error) if error.is_instance_of::<PyTypeError>(given.py()) => Ok(given.clone()),
            other => other,
        };
    }
    Ok(given.clone())
}
