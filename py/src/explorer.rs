//! The explorer: a page that shows a mechanism in a browser, or in a notebook.

use crate::error::{failed, wrong};
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use opm_mcap::{PartialFile, RecordError};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

/// Height of the page in a notebook, pixels.
const HEIGHT: u32 = 780;

/// A page that shows a mechanism and its workspace in a browser, without a network: the file that ``opm explore`` writes.
///
/// In a notebook it shows itself, as the last value of a cell.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Explorer {
    /// The mechanism's name.
    #[pyo3(get)]
    name: String,
    /// The whole page: the text of an HTML file.
    #[pyo3(get)]
    html: String,
}

#[pymethods]
impl Explorer {
    /// Write the page to a file, which is replaced if it exists.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     Name of the file, which ends in ``.html``.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be written.
    /// OpmError
    ///     Its name does not end in ``.html``.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        // As the command does: browsers take the kind of a file from its ending.
        if !path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"))
        {
            return Err(wrong(format!("{}: expected a name that ends in .html", path.display())));
        }
        py.detach(|| {
            let mut file = PartialFile::create(&path)?;
            let written = file.write_all(self.html.as_bytes()).and_then(|()| file.flush());
            match written {
                Ok(()) => file.commit(),
                Err(error) => {
                    // What was written of it has no use.
                    file.discard();
                    Err(error)
                }
            }
            .map_err(RecordError::Io)
        })
        .map_err(|error| {
            let cause = error.source().map_or_else(String::new, |cause| format!(": {cause}"));
            PyOSError::new_err(format!("{}: {error}{cause}", path.display()))
        })
    }

    fn _repr_html_(&self) -> String {
        let page = self.html.replace('&', "&amp;").replace('"', "&quot;");
        let name = self.name.replace('&', "&amp;").replace('"', "&quot;");
        format!(
            "<iframe title=\"{name}\" srcdoc=\"{page}\" allow=\"clipboard-write\" \
             style=\"width: 100%; height: {HEIGHT}px; border: 0\"></iframe>"
        )
    }

    fn __repr__(&self) -> String {
        format!("<Explorer of {}: {} bytes of HTML>", self.name, self.html.len())
    }
}

pickled!(Explorer { name, html });

/// A page that shows a mechanism and its workspace in a browser: the mechanism in space, to be moved; slices and kinds of its
/// workspace, which follow every dimension; motions. The page needs no network.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
///     The mechanism.
///
/// Returns
/// -------
/// Explorer
///     It shows itself in a notebook; :meth:`Explorer.save` writes it to a file.
#[pyfunction]
pub fn explore(py: Python<'_>, manipulator: &Manipulator) -> PyResult<Explorer> {
    let (file, text) = (manipulator.file_name(), manipulator.text());
    let page = py.detach(|| opm_export::explorer(&file, text));
    let html = page.map_err(|error| failed(&error))?;
    Ok(Explorer { name: manipulator.inner.mechanism().name.clone(), html })
}
