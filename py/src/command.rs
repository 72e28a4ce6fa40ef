//! The program `opm`, inside the module.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Run a command line of ``opm``.
///
/// Parameters
/// ----------
/// arguments : sequence of str
///     The program's name first.
///
/// Returns
/// -------
/// int
///     The exit status.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| opm_cli::main(arguments))
}
