//! Displacements from Python: homogeneous matrices, objects that have them, positions with rotations.

use crate::arguments::numbers;
use crate::error::wrong;
use crate::given::Given;
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyEllipsis, PySlice, PyTuple};

/// Displacements as rows of 16: `(..., 4, 4)` homogeneous matrices; what has them as `as_matrix()`, such as a `RigidTransform` of
/// SciPy; or a pair of positions and rotations.
pub fn matrices<'py>(given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
    if let Some(pair) = pair(given, what)? {
        return Given::new(&pair, 2);
    }
    let expected = || {
        "(..., 4, 4) homogeneous matrices, a RigidTransform, or a pair of positions and rotations"
            .to_owned()
    };
    let array = numbers(&as_matrix(given)?, what, &expected)?;
    match array.shape() {
        [.., 4, 4] => Given::new(&array, 2),
        [.., 3, 3] => Err(wrong(format!(
            "{what} is of rotations alone, expected a pair of positions and rotations"
        ))),
        _ => {
            let shape = array.getattr("shape")?;
            Err(wrong(format!("{what} has shape {shape}, expected {}", expected())))
        }
    }
}

/// What an object has as its matrix; anything else as it is.
fn as_matrix<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    match given.getattr_opt("as_matrix")? {
        Some(matrix) => matrix.call0(),
        None => Ok(given.clone()),
    }
}

/// The homogeneous matrices of a tuple of positions and rotations, if it is one.
fn pair<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Option<Bound<'py, PyUntypedArray>>> {
    let Ok(pair) = given.cast::<PyTuple>() else { return Ok(None) };
    if pair.len() != 2 {
        return Ok(None);
    }
    let (places, turns) = (pair.get_item(0)?, pair.get_item(1)?);
    let expected = || "(..., 3, 3) rotation matrices, or a Rotation".to_owned();
    let Ok(turns) = numbers(&as_matrix(&turns)?, &format!("{what}[1]"), &expected) else {
        return Ok(None);
    };
    let [turned @ .., 3, 3] = turns.shape() else { return Ok(None) };
    let expected = || "(..., 3) positions, metres".to_owned();
    let places = numbers(&places, &format!("{what}[0]"), &expected)?;
    let shape = places.getattr("shape")?;
    let [placed @ .., 3] = places.shape() else {
        return Err(wrong(format!("{what}[0] has shape {shape}, expected {}", expected())));
    };
    let numpy = given.py().import("numpy")?;
    let lead = numpy.call_method1(
        "broadcast_shapes",
        (PyTuple::new(given.py(), placed)?, PyTuple::new(given.py(), turned)?),
    );
    let lead: Vec<usize> = lead
        .map_err(|_| {
            let turns = turns.getattr("shape").map_or_else(|_| "?".into(), |s| s.to_string());
            wrong(format!(
                "{what} has positions {shape} and rotations {turns}: they do not go together"
            ))
        })?
        .extract()?;
    let matrices = numpy.call_method1("zeros", ([&lead[..], &[4, 4]].concat(),))?;
    let all = PyEllipsis::get(given.py());
    let three = PySlice::new(given.py(), 0, 3, 1);
    matrices.set_item((all, &three, &three), turns)?;
    matrices.set_item((all, &three, 3), places)?;
    matrices.set_item((all, 3, 3), 1.0)?;
    Ok(Some(matrices.cast_into()?))
}
