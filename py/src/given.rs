//! Rows of numbers from Python: arrays, one row alone, or columns by name.

use crate::arguments::{Array, numbers, shown};
use crate::error::wrong;
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::intern;
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
    /// The axes before that of the columns; none of one row alone.
    pub lead: Vec<usize>,
    /// The labels of its rows, if it is a data frame of pandas.
    pub index: Option<Py<PyAny>>,
}

impl<'a> Columns<'a> {
    pub fn all(names: &'a [&'a str]) -> Self {
        Self { names, otherwise: None }
    }

    /// Rows of these columns, along any axes: an array, a table with names, or numbers by name.
    pub fn read<'py>(self, given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
        let read = self.read_numbers(given, what)?;
        let framed = read.lead.len() == 1
            && !given.is_instance_of::<PyUntypedArray>()
            && given.hasattr(intern!(given.py(), "columns"))?;
        let index = match framed {
            true => given.getattr_opt(intern!(given.py(), "index"))?.map(Bound::unbind),
            false => None,
        };
        Ok(Given { index, ..read })
    }

    fn read_numbers<'py>(self, given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
        if let Some(labels) = labels(given)? {
            return self.by_name(given, &labels, what);
        }
        let width = self.names.len();
        let expected = || format!("(..., {width}): {}", self.names.join(", "));
        let array = numbers(given, what, &expected)?;
        match array.shape() {
            [.., last] if *last == width => Given::new(&array, 1),
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
            found[number] = Some(numbers_or_one(&given.get_item(label)?, what, &name)?);
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
            let shapes = columns.iter().zip(self.names).filter_map(|(column, name)| {
                let shape = column.getattr("shape").ok()?;
                Some(format!("{name} {shape}"))
            });
            let shapes: Vec<_> = shapes.collect();
            wrong(format!(
                "{what} has columns of shapes that do not go together: {}",
                shapes.join(", ")
            ))
        })?;
        let options = PyDict::new(given.py());
        options.set_item("axis", -1)?;
        options.set_item("dtype", "float64")?;
        let array: Bound<'py, PyUntypedArray> =
            numpy.call_method("stack", (together,), Some(&options))?.cast_into()?;
        Given::new(&array, 1)
    }
}

impl<'py> Given<'py> {
    /// An array whose last axes, so many of them, are one row.
    pub fn new(array: &Bound<'py, PyUntypedArray>, of_row: usize) -> PyResult<Self> {
        let (lead, row) = array.shape().split_at(array.ndim() - of_row);
        let lead = lead.to_vec();
        let shape = (lead.iter().product::<usize>(), row.iter().product::<usize>());
        let array = match array.ndim() == 2 && of_row == 1 {
            true => array.extract()?,
            false => array.call_method1("reshape", (shape,))?.extract()?,
        };
        Ok(Self { array, lead, index: None })
    }

    /// The same, if it is one row or one axis of rows: what is followed in time.
    pub fn in_order(self, what: &str, names: &[&str]) -> PyResult<Self> {
        match self.lead.len() {
            0 | 1 => Ok(self),
            _ => {
                let width = names.len();
                let (shape, names) =
                    (shape(&[&self.lead[..], &[width]].concat()), names.join(", "));
                Err(wrong(format!("{what} has shape {shape}, expected (n, {width}): {names}")))
            }
        }
    }

    /// Gives it these axes of rows, as NumPy broadcasts them.
    fn stretch(&mut self, lead: &[usize]) -> PyResult<()> {
        let array: &Bound<'py, _> = &self.array;
        let width = array.shape()[1];
        let with = |lead: &[usize]| [lead, &[width]].concat();
        let numpy = array.py().import("numpy")?;
        let full = array.call_method1("reshape", (with(&self.lead),))?;
        let full = numpy.call_method1("broadcast_to", (full, with(lead)))?;
        let rows = lead.iter().product::<usize>();
        self.array = full.call_method1("reshape", ((rows, width),))?.extract()?;
        (self.lead, self.index) = (lead.to_vec(), None);
        Ok(())
    }
}

/// Broadcasts the rows of arguments that go together, as NumPy does. One row of the others is for all, and stays one.
pub fn together<'py>(
    (first, what): (&mut Given<'py>, &str),
    others: &mut [(Option<&mut Given<'py>>, &str)],
) -> PyResult<()> {
    let mut lead = first.lead.clone();
    for (other, name) in others.iter().filter_map(|(o, name)| Some((o.as_ref()?, name))) {
        lead = broadcast(&lead, &other.lead).ok_or_else(|| {
            let [rows, expected] = [&other.lead, &lead].map(|lead| match &lead[..] {
                [count] => count.to_string(),
                axes => shape(axes),
            });
            wrong(format!("{rows} rows of {name}, expected {expected} as of {what}, or one"))
        })?;
    }
    let others = others.iter_mut().filter_map(|(other, _)| other.as_deref_mut());
    let other_than_one = others.filter(|other| other.array.shape()[0] != 1);
    for given in other_than_one.chain([first]).filter(|given| given.lead != lead) {
        given.stretch(&lead)?;
    }
    Ok(())
}

/// A shape, as NumPy writes it.
fn shape(axes: &[usize]) -> String {
    let axes = axes.iter().map(ToString::to_string).collect::<Vec<_>>();
    format!("({})", axes.join(", "))
}

/// The axes that arrays of these axes have together.
fn broadcast(a: &[usize], b: &[usize]) -> Option<Vec<usize>> {
    let (long, short) = if a.len() < b.len() { (b, a) } else { (a, b) };
    let (own, shared) = long.split_at(long.len() - short.len());
    let shared = shared.iter().zip(short).map(|pair| match pair {
        (&a, &b) if a == b || b == 1 => Some(a),
        (1, &b) => Some(b),
        _ => None,
    });
    own.iter().copied().map(Some).chain(shared).collect()
}

/// One column: numbers, or one number.
fn numbers_or_one<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
    name: &str,
) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(number) = given.extract::<f64>() {
        return Ok(number.into_pyobject(given.py())?.into_any());
    }
    let expected = || "a number or an array of numbers".to_owned();
    Ok(numbers(given, &format!("{name} of {what}"), &expected)?.into_any())
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
