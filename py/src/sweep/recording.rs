//! Recordings of a sweep's points.

use super::Sweep;
use super::questions::Inscribed;
use crate::arguments;
use crate::error::{request, study, wrong};
use crate::interrupt;
use opm_study::recording::{Attachment, Findings, WorkspaceRecording};
use opm_study::{Analysis, AxisScale, PointOptions};
use opm_workspace::Progress;
use pyo3::prelude::*;
use std::path::PathBuf;

#[pymethods]
impl Sweep {
    /// Record the points as ``opm workspace -o`` does, byte for byte.
    ///
    /// The boundary is recorded too, except for kind ``"grid"``. Points that are not poses can only be written as MCAP. The
    /// fields of an NPY file are those of ``axes``, then of ``scalars``, then of ``color``, each once; without ``scalars`` the
    /// other task coordinates come last.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     Ends in ``.mcap`` (Foxglove, Lichtblick, Rerun), ``.npy`` (NumPy) or ``.ply`` (mesh tools). The file appears
    ///     when it is complete.
    /// axes : sequence of three str, or "tip", optional
    ///     The coordinates that are x, y and z of the cloud (imaginary joints for kind ``"imaginary"``), or the platform's point.
    /// scalars : sequence of str, optional
    ///     Values stored with every point: task coordinates, imaginary joints, actuated joints, ``inverse_condition``; for places
    ///     the ``share`` of orientations in which they are reached.
    /// color : str, optional
    ///     The value that the colour shows.
    /// scale : {"comparable", "none"}, optional
    ///     The scale of the cloud's axes in an MCAP file: those of another unit than the first are multiplied by 1, 2 or 5
    ///     times a power of ten, so that the extents are comparable, or no axis is.
    /// inscribed : Inscribed, optional
    ///     A shape in the set, from :meth:`inscribed`; ``opm plot`` draws it. In MCAP only.
    /// explain : bool, optional
    ///     Also record the points that are rejected, with their causes (:meth:`rejections`) as colours. In MCAP only.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A name is unknown, or the file cannot be written.
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None, scale = "comparable", inscribed = None, explain = false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        #[pyo3(from_py_with = arguments::cloud_axes)] axes: Option<Vec<String>>,
        #[pyo3(from_py_with = arguments::scalars)] scalars: Option<Vec<String>>,
        color: Option<String>,
        scale: &str,
        inscribed: Option<PyRef<'_, Inscribed>>,
        explain: bool,
    ) -> PyResult<()> {
        let (of, workspace) = (self.of.get(), &self.workspace);
        let scale = AxisScale::from_name(scale).ok_or_else(|| {
            wrong(format!("scale {scale:?}, expected \"comparable\" or \"none\""))
        })?;
        let points = PointOptions { axes: axes.unwrap_or_default(), scalars, color, scale };
        let points = points.choose(workspace.kind(), workspace.manipulator(), workspace.setup());
        let points = points.map_err(|error| request(&error))?;
        let is_mcap = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"));
        if !is_mcap && (explain || inscribed.is_some()) {
            let what = if explain { "explain" } else { "inscribed" };
            let path = path.display();
            return Err(wrong(format!("{what} is for a path that ends in .mcap, not for {path}")));
        }
        let inscribed = inscribed.map(|found| found.of(workspace)).transpose()?;
        let name = of.file_name();
        let mechanism = Attachment { name: &name, text: of.text() };
        let progress = Progress::default();
        let work = || {
            let recording = WorkspaceRecording::of_workspace(&path, workspace, points)?;
            let (poses, count) = (&workspace.poses(), self.count.clone());
            let analysis = &Analysis::of_points(workspace, count, poses, &progress)?;
            let rejections = explain.then(|| workspace.rejections(&progress)).transpose()?;
            let (inscribed, rejections) = (inscribed.as_ref(), rejections.as_ref());
            let findings =
                Findings { mechanism, workspace, poses, analysis, inscribed, rejections };
            recording.write(&findings, &progress)
        };
        interrupt::run(py, self.threads, work, || progress.cancel())?.map_err(study)?;
        Ok(())
    }

    /// Like :meth:`write` for a path that ends in ``.mcap``.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     The file appears when it is complete.
    /// axes : sequence of three str, or "tip", optional
    ///     As for :meth:`write`.
    /// scalars : sequence of str, optional
    ///     As for :meth:`write`.
    /// color : str, optional
    ///     As for :meth:`write`.
    /// scale : {"comparable", "none"}, optional
    ///     As for :meth:`write`.
    /// inscribed : Inscribed, optional
    ///     As for :meth:`write`.
    /// explain : bool, optional
    ///     As for :meth:`write`.
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None, scale = "comparable", inscribed = None, explain = false))]
    fn write_mcap(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        #[pyo3(from_py_with = arguments::cloud_axes)] axes: Option<Vec<String>>,
        #[pyo3(from_py_with = arguments::scalars)] scalars: Option<Vec<String>>,
        color: Option<String>,
        scale: &str,
        inscribed: Option<PyRef<'_, Inscribed>>,
        explain: bool,
    ) -> PyResult<()> {
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) {
            let path = path.display();
            return Err(wrong(format!("{path}, expected a name that ends in .mcap")));
        }
        self.write(py, path, axes, scalars, color, scale, inscribed, explain)
    }
}
