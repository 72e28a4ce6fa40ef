//! One pose alone, as a controller or an integrator asks thousands of times a second: without what only many poses need.
//!
//! A pose that is an array of float64, or a list of numbers, is read as it is; the working memory is kept from call to call; names
//! and units are shared by all results. Everything else goes the way of many poses. The results are equal to the bit.

use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::solutions::{Names, Solutions};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use opm_core::manipulator::{self as core, Mode, Solution};
use opm_core::velocity::Jacobians;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyEllipsis, PyList};
use std::borrow::Cow;
use std::sync::Mutex;

/// The working memory of one call.
pub struct Memory {
    pub solution: Solution,
    pub jacobians: Jacobians,
}

/// Working memory that no call uses at the moment.
#[derive(Default)]
pub struct Memories(Mutex<Vec<Memory>>);

impl Memories {
    fn with<T>(&self, of: &core::Manipulator, work: impl FnOnce(&mut Memory) -> T) -> T {
        let kept = self.0.lock().ok().and_then(|mut kept| kept.pop());
        let mut memory =
            kept.unwrap_or_else(|| Memory { solution: of.solution(), jacobians: of.jacobians() });
        let done = work(&mut memory);
        if let Ok(mut kept) = self.0.lock() {
            kept.push(memory);
        }
        done
    }
}

/// One pose of this width, if it is one, is given plainly, and has no gaps.
pub fn plain(given: &Bound<'_, PyAny>, width: usize) -> Option<Vec<f64>> {
    let pose = if given.is_exact_instance_of::<PyUntypedArray>() {
        let array = given.cast::<PyArray1<f64>>().ok().filter(|array| array.len() == width)?;
        array.try_readonly().ok()?.as_slice().ok()?.to_vec()
    } else {
        given.cast_exact::<PyList>().ok().filter(|list| list.len() == width)?.extract().ok()?
    };
    (!pose.iter().any(|value| value.is_nan())).then_some(pose)
}

/// These numbers as a read-only array.
fn frozen(py: Python<'_>, numbers: &[f64]) -> PyResult<Py<PyArrayDyn<f64>>> {
    let array = PyArray1::from_slice(py, numbers);
    array.call_method1(intern!(py, "setflags"), (false,))?;
    Ok(array.to_dyn().clone().unbind())
}

/// An answer as a read-only array without axes. All results have the same two: nobody can write to a view of what is read-only.
fn answer(py: Python<'_>, value: bool) -> PyResult<Py<PyArrayDyn<bool>>> {
    static ANSWERS: PyOnceLock<[Py<PyArrayDyn<bool>>; 2]> = PyOnceLock::new();
    let answers = ANSWERS.get_or_try_init(py, || -> PyResult<_> {
        let both = PyArray1::from_slice(py, &[false, true]);
        both.call_method1("setflags", (false,))?;
        let view = |at: usize| -> PyResult<Py<PyArrayDyn<bool>>> {
            let place = (at, PyEllipsis::get(py));
            Ok(both.get_item(place)?.cast_into()?.unbind())
        };
        Ok([view(0)?, view(1)?])
    })?;
    Ok(answers[usize::from(value)].clone_ref(py))
}

impl Manipulator {
    /// Inverse kinematics of one pose.
    pub fn inverse_one(
        &self,
        py: Python<'_>,
        pose: &[f64],
        (mode, columns): (Mode, &[usize]),
        names: Names,
    ) -> PyResult<Solutions> {
        self.memories.with(&self.inner, |Memory { solution, .. }| {
            let found = self.inner.inverse(pose, mode, solution);
            let reached = found.map_err(|error| wrong(format!("pose 0: {error}")))?.is_some();
            let every = columns.len() == solution.joints().len();
            let some = |of: &[f64]| columns.iter().map(|&column| of[column]).collect::<Vec<_>>();
            let numbers = match reached {
                true if every => [solution.joints().into(), solution.imaginary().into()],
                true => [Cow::from(some(solution.joints())), solution.imaginary().into()],
                false => [columns.len(), self.inner.imaginary().len()]
                    .map(|count| vec![f64::NAN; count].into()),
            };
            let within = reached && solution.within_limits();
            Solutions::of_arrays(
                names,
                1,
                [frozen(py, &numbers[0])?, frozen(py, &numbers[1])?],
                [answer(py, reached)?, answer(py, within)?],
                None,
            )
        })
    }

    /// The Jacobian of one pose, row by row.
    pub fn jacobian_one(
        &self,
        pose: &[f64],
        (mode, rows): (Mode, &[usize]),
        out: &mut [f64],
    ) -> PyResult<()> {
        self.memories.with(&self.inner, |Memory { solution, jacobians }| {
            let found = self.inner.inverse(pose, mode, solution);
            match found.map_err(|error| wrong(format!("pose 0: {error}")))? {
                Some(_) => self.joint_rows(solution, jacobians, rows, out).map_err(wrong)?,
                None => {
                    out.fill(f64::NAN);
                    false
                }
            };
            Ok(())
        })
    }
}

/// Lends the numbers of an array that is given for a result of this shape.
pub fn lend<T>(
    out: &Bound<'_, PyAny>,
    shape: &[usize],
    fill: impl FnOnce(&mut [f64]) -> PyResult<T>,
) -> PyResult<T> {
    let expected = || {
        let shape = shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        format!(
            "expected a float64 array of the shape ({shape}) in C order, which can be written to"
        )
    };
    let Ok(array) = out.cast::<PyArrayDyn<f64>>() else {
        let kind = out.get_type().name()?;
        let of = out.getattr("dtype").map_or_else(|_| String::new(), |d| format!(" of {d}"));
        return Err(wrong(format!("out is an object of {kind}{of}, {}", expected())));
    };
    if array.shape() != shape || !array.is_c_contiguous() {
        let given = array.getattr("shape")?;
        return Err(wrong(format!("out has shape {given}, {}", expected())));
    }
    let Ok(mut lent) = array.try_readwrite() else {
        return Err(wrong(format!(
            "out is read-only, or shares memory with poses; {}",
            expected()
        )));
    };
    fill(lent.as_slice_mut()?)
}
