//! The program `opm`, inside the module.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Do what a command line asks for.
///
/// Parameters
/// ----------
/// arguments : sequence of str
///     The program's name first.
///
/// Returns
/// -------
/// int
///     The status to exit with.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| opm_cli::main(arguments))
}
