//! Reading mechanism files whose joints nearly fit their subspaces.

use crate::error::{failed, wrong};
use opm_core::decomposition::{Snapped, slightly_off, snap};
use opm_core::mechanism::file::{self, MechanismFile};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;

/// Reads the text of a mechanism file, and snaps it within a tolerance (metres) if one is given. Also gives
/// the text of the mechanism as it is afterwards.
pub fn read(
    py: Python<'_>,
    text: String,
    label: &str,
    tolerance: Option<f64>,
) -> PyResult<(MechanismFile, String)> {
    within(py, unwarned(text, label)?, label, tolerance)
}

/// Snaps a mechanism that was read, with its text, within a tolerance (metres) if one is given; else warns of joints that are
/// off.
pub fn within(
    py: Python<'_>,
    (mut read, text): (MechanismFile, String),
    label: &str,
    tolerance: Option<f64>,
) -> PyResult<(MechanismFile, String)> {
    let Some(tolerance) = tolerance else {
        // The joints of a family are exact by construction.
        if read.family.is_none()
            && let Some(near) = slightly_off(&read.mechanism)
        {
            let (tolerance, what) =
                (near.tolerance * 1.01, "joints are slightly off their subspaces");
            let message = format!("{label}: {what}: {near}; tolerance={tolerance:.3e} snaps it");
            let message = CString::new(message)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
        }
        return Ok((read, text));
    };
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(wrong(format!(
            "tolerance is {tolerance:?}, expected a positive length in metres"
        )));
    }
    if read.family.is_some() {
        // The joints of a family are exact by construction.
        return Ok((read, text));
    }
    let Snapped { mechanism, joints } =
        snap(&read.mechanism, tolerance).map_err(|error| failed(&error))?;
    if joints.is_empty() {
        return Ok((read, text));
    }
    for miss in joints {
        let message = CString::new(format!("{label}: snapped {miss}"))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
    }
    read.mechanism = mechanism;
    let text = read.text();
    Ok((read, text))
}

/// Reads the text of a mechanism file as it is.
pub fn unwarned(text: String, label: &str) -> PyResult<(MechanismFile, String)> {
    let read = file::read(&text).map_err(|errors| wrong(errors.in_file(label)))?;
    Ok((read, text))
}
