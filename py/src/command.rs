//! The program `opm`, inside the module.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Does what a command line asks for, the program's name first, and returns the status to exit with.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| opm_cli::main(arguments))
}
