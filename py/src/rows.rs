//! Work on every row of an array, on many threads, into tables of numbers.

use crate::error::wrong;
use crate::given::Given;
use crate::interrupt;
use crate::pickle::frozen;
use numpy::{Element, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use rayon::prelude::*;
use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rows that a thread works on between two checks whether it should stop.
const BLOCK: usize = 1024;

/// An array from Python: rows of `names`.
pub struct Rows<'a> {
    values: Cow<'a, [f64]>,
    pub count: usize,
    width: usize,
    /// The axes along which the rows were given; results have the same ones.
    pub lead: &'a [usize],
    index: Option<&'a Py<PyAny>>,
}

impl<'a> Rows<'a> {
    /// An array of float64 in C order is used without a copy. The interpreter's lock is released while rows
    /// are worked on. Other threads must not write to the array then, as with functions of NumPy.
    pub fn new(given: &'a Given<'_>) -> PyResult<Self> {
        let array = &given.array;
        let [count, width] = [array.shape()[0], array.shape()[1]];
        let values = match array.as_slice() {
            Ok(values) if array.is_c_contiguous() => Cow::Borrowed(values),
            _ => {
                // NumPy copies an array whose elements are not aligned: Rust cannot read these.
                let aligned = array.is_aligned().then(|| array.as_any().clone());
                let aligned = aligned.map_or_else(|| array.call_method0("copy"), Ok)?;
                let aligned = aligned.cast_into::<PyArray2<f64>>()?.readonly();
                let mut values = memory(count, width)?;
                values.extend(aligned.as_array());
                Cow::Owned(values)
            }
        };
        Ok(Self { values, count, width, lead: &given.lead, index: given.index.as_ref() })
    }

    /// The labels of the rows, if they were given with some.
    pub fn index(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.index.map(|index| index.clone_ref(py))
    }

    /// The values of all rows, one row after the other.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    pub fn row(&self, number: usize) -> &[f64] {
        &self.values[number * self.width..][..self.width]
    }

    /// Whether a row has an entry that is not a number. What is asked of such a row has no answer: NaN.
    pub fn missing(&self, number: usize) -> bool {
        self.row(number).iter().any(|value| value.is_nan())
    }

    /// A table with a row for each of these rows, as an array of rows of this shape along the axes of these rows.
    pub fn shaped<'py, T: Element>(
        &self,
        table: &Bound<'py, PyAny>,
        row: &[usize],
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        Ok(table.call_method1("reshape", ([self.lead, row].concat(),))?.cast_into()?)
    }

    /// The same, read-only.
    pub fn frozen<T: Element>(
        &self,
        table: &Bound<'_, PyAny>,
        row: &[usize],
    ) -> PyResult<Py<PyArrayDyn<T>>> {
        frozen(self.shaped(table, row)?)
    }
}

/// Tables with one row for every row of the input. Entries that were not written are NaN. Each row has two
/// flags.
pub struct Tables<'py, const N: usize> {
    numbers: Vec<Bound<'py, PyArray2<f64>>>,
    pub answers: [Vec<bool>; 2],
}

/// Memory for a table, or Python's exception that there is none.
fn memory<T>(count: usize, width: usize) -> PyResult<Vec<T>> {
    let mut table = Vec::new();
    let size = count.checked_mul(width).filter(|&size| table.try_reserve_exact(size).is_ok());
    size.map(|_| table).ok_or_else(|| no_memory(format_args!("{count} rows of {width}")))
}

/// A table of one value.
fn table<T: Clone>(count: usize, width: usize, value: T) -> PyResult<Vec<T>> {
    let mut table = memory(count, width)?;
    table.resize(count * width, value);
    Ok(table)
}

/// The exception that there is no memory for `what`.
pub fn no_memory(what: impl std::fmt::Display) -> PyErr {
    PyMemoryError::new_err(format!("no memory for {what}"))
}

/// Some rows of the tables.
struct Block<'a, const N: usize> {
    first: usize,
    numbers: [&'a mut [f64]; N],
    answers: [&'a mut [bool]; 2],
}

impl<'py, const N: usize> Tables<'py, N> {
    /// Fills tables of `count` rows. `fill` writes a row of each table and returns the two flags of that row;
    /// `scratch` makes its buffers. The result does not depend on the number of threads.
    pub fn fill<S>(
        py: Python<'py>,
        count: usize,
        widths: [usize; N],
        threads: Option<NonZeroUsize>,
        scratch: impl Fn() -> S + Sync,
        fill: impl Fn(&mut S, usize, [&mut [f64]; N]) -> Result<[bool; 2], String> + Sync,
    ) -> PyResult<Self> {
        Self::fill_in_blocks(py, (count, BLOCK), widths, threads, scratch, fill)
    }

    /// As [`Tables::fill`], with another number of rows that a thread works on between two checks whether it should stop.
    pub fn fill_in_blocks<S>(
        py: Python<'py>,
        (count, block): (usize, usize),
        widths: [usize; N],
        threads: Option<NonZeroUsize>,
        scratch: impl Fn() -> S + Sync,
        fill: impl Fn(&mut S, usize, [&mut [f64]; N]) -> Result<[bool; 2], String> + Sync,
    ) -> PyResult<Self> {
        let numpy = py.import("numpy")?;
        // NumPy allocates these, and raises an exception if there is no memory. They are not filled here: the
        // system takes seconds to provide gigabytes, and Ctrl-C would have no effect meanwhile.
        let empty = |width| -> PyResult<Bound<'py, PyArray2<f64>>> {
            Ok(numpy.call_method1("empty", ((count, width),))?.cast_into()?)
        };
        let numbers = widths.into_iter().map(empty).collect::<PyResult<Vec<_>>>()?;
        let mut answers = [table(count, 1, false)?, table(count, 1, false)?];
        let mut lent: Vec<_> = numbers.iter().map(PyArrayMethods::readwrite).collect();
        let mut lent = lent.iter_mut();
        let slices = std::array::from_fn(|_| {
            let slice = lent.next().and_then(|array| array.as_slice_mut().ok());
            slice.unwrap_or_default()
        });
        let blocks = blocks(slices, (block, widths), &mut answers);
        let stop = AtomicBool::new(false);
        let work = |block: Block<'_, N>| -> Result<(), String> {
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let Block { first, mut numbers, answers: [yes, also] } = block;
            numbers.iter_mut().for_each(|table| table.fill(f64::NAN));
            let mut scratch = scratch();
            for row in 0..yes.len() {
                let mut number = 0;
                let of_row = numbers.each_mut().map(|table| {
                    let width = widths[number];
                    number += 1;
                    &mut table[row * width..][..width]
                });
                [yes[row], also[row]] = fill(&mut scratch, first + row, of_row)?;
            }
            Ok(())
        };
        let done = if count <= block {
            blocks.into_iter().try_for_each(work)
        } else {
            let all = || blocks.into_par_iter().try_for_each(work);
            interrupt::run(py, threads, all, || stop.store(true, Ordering::Relaxed))?
        };
        done.map_err(wrong)?;
        Ok(Self { numbers, answers })
    }

    /// Table `number` as an array.
    pub fn table(&self, number: usize) -> Bound<'py, PyArray2<f64>> {
        self.numbers[number].clone()
    }
}

/// Tables in parts of so many rows.
fn blocks<'a, const N: usize>(
    mut rest: [&'a mut [f64]; N],
    (size, widths): (usize, [usize; N]),
    [yes, also]: &'a mut [Vec<bool>; 2],
) -> Vec<Block<'a, N>> {
    let answers = yes.chunks_mut(size).zip(also.chunks_mut(size)).enumerate();
    answers
        .map(|(block, (yes, also))| {
            let mut number = 0;
            let numbers = rest.each_mut().map(|table| {
                let taken = std::mem::take(table);
                let (part, left) = taken.split_at_mut(yes.len() * widths[number]);
                (*table, number) = (left, number + 1);
                part
            });
            Block { first: block * size, numbers, answers: [yes, also] }
        })
        .collect()
}
