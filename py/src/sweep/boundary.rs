//! The boundary of a workspace: closed lines in a plane, or in slices of a third coordinate.

use super::Sweep;
use crate::arguments;
use crate::error::{failed, wrong};
use crate::html::digits;
use crate::parts::Parts;
use crate::pickle::{equal, frozen};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_study::WorkspaceKind;
use opm_workspace::boundary;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::collections::BTreeMap;
use std::num::NonZeroU64;

/// The boundary of a workspace in a plane, or of one slice of it: closed polylines along the steps of the grid.
///
/// They run half-way between points inside and their neighbours outside, and along the edge of the grid where the
/// workspace continues beyond it.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Outline {
    /// The coordinates of the plane: the columns of the polylines.
    #[pyo3(get)]
    axes: (String, String),
    /// The coordinate of the slice and its value; empty if there is only one plane.
    #[pyo3(get)]
    at: BTreeMap<String, f64>,
    /// Area of the pieces without the holes, in the product of both coordinates' units.
    #[pyo3(get)]
    area: f64,
    /// Closed polylines, (n, 2) each, metres and radians; the last corner is the first one again. Counter-clockwise around
    /// pieces of the workspace, clockwise around holes.
    rings: Vec<(f64, Py<PyArray2<f64>>)>,
}

/// An outline as it is pickled.
type Spec = ((String, String), BTreeMap<String, f64>, f64, Vec<(f64, Py<PyArray2<f64>>)>);

#[pymethods]
impl Outline {
    /// Closed polylines, (n, 2) each, metres and radians; the last corner is the first one again. Counter-clockwise around
    /// pieces of the workspace, clockwise around holes.
    #[getter]
    fn rings<'py>(&self, py: Python<'py>) -> Bound<'py, PyTuple> {
        self.those(py, |_| true)
    }

    /// The polylines around pieces.
    #[getter]
    fn outer<'py>(&self, py: Python<'py>) -> Bound<'py, PyTuple> {
        self.those(py, |area| area >= 0.0)
    }

    /// The polylines around holes.
    #[getter]
    fn holes<'py>(&self, py: Python<'py>) -> Bound<'py, PyTuple> {
        self.those(py, |area| area < 0.0)
    }

    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, Self>) -> PyResult<bool> {
        equal(slf.as_any(), other.as_any(), &["axes", "at", "area", "rings"])
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Spec)> {
        let Self { axes, at, area, rings } = slf.get();
        let rings = rings.iter().map(|(area, ring)| (*area, ring.clone_ref(slf.py())));
        let state = (axes.clone(), at.clone(), *area, rings.collect());
        Ok((slf.get_type().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        axes: (String, String),
        at: BTreeMap<String, f64>,
        area: f64,
        rings: Vec<(f64, Py<PyArray2<f64>>)>,
    ) -> PyResult<Self> {
        // An array from a pickle is writable.
        let rings = rings.into_iter().map(|(area, ring)| Ok((area, frozen(ring.into_bound(py))?)));
        Ok(Self { axes, at, area, rings: rings.collect::<PyResult<_>>()? })
    }

    fn __repr__(&self) -> String {
        let (x, y) = &self.axes;
        let holes = self.rings.iter().filter(|(area, _)| *area < 0.0).count();
        let at: String = self
            .at
            .iter()
            .map(|(name, value)| format!(" at {name} = {}", digits(*value)))
            .collect();
        format!("<Outline in {x}, {y}{at}: {} rings, {holes} of them holes>", self.rings.len())
    }
}

impl Outline {
    fn those<'py>(&self, py: Python<'py>, wanted: impl Fn(f64) -> bool) -> Bound<'py, PyTuple> {
        let rings = self.rings.iter().filter(|(area, _)| wanted(*area));
        let rings: Vec<_> = rings.map(|(_, ring)| ring.clone_ref(py)).collect();
        PyTuple::new(py, rings).expect("a list of known length")
    }
}

#[pymethods]
impl Sweep {
    /// The boundary as closed polylines in the first two coordinates that have several values; of kind ``"aspects"``, that of
    /// each aspect.
    ///
    /// Returns
    /// -------
    /// list of Outline
    ///     One outline; if a third coordinate has several values, one for each of them.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Fewer than two or more than three coordinates have several values; or the kind is ``"imaginary"``, where the
    ///     boundary of the orientations says nothing about the imaginary joints.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn boundary<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Vec<Outline>> {
        let py = slf.py();
        if !slf.get().workspace.kind().has_boundary() {
            let message = "the boundary of the orientations says nothing of the imaginary joints";
            return Err(wrong(format!("{message}; kind imaginary has none")));
        }
        let set = Self::set(slf, Parts::new(executor, shards)?.as_ref())?;
        let axes = set.varying();
        let name = |number: usize| set.axes()[axes[number]].axis.name.clone();
        let outlines = match slf.get().workspace.kind() {
            WorkspaceKind::Aspects => {
                let aspects = Self::found(slf, None)?;
                py.detach(|| aspects.boundary()).map_err(|error| failed(&error))?
            }
            _ => py.detach(|| boundary(&set)),
        };
        let Some(outlines) = outlines else {
            let several = axes.len();
            return Err(wrong(format!(
                "{several} coordinates have several values, expected two, or a third one to slice by"
            )));
        };
        let outline = |outline: opm_workspace::Outline| {
            let at = outline.slice.map(|number| (name(2), set.axes()[axes[2]].axis.value(number)));
            let area = outline.area();
            let rings = outline.rings.into_iter().map(|ring| -> PyResult<_> {
                let area = ring.area();
                // The ring is closed, so that it can be drawn as it is.
                let corners = ring.points.iter().chain(ring.points.first());
                let corners: Vec<f64> = corners.flatten().copied().collect();
                let shape = [corners.len() / 2, 2];
                Ok((area, frozen(corners.into_pyarray(py).reshape(shape)?)?))
            });
            let rings = rings.collect::<PyResult<_>>()?;
            Ok(Outline { axes: (name(0), name(1)), at: at.into_iter().collect(), area, rings })
        };
        outlines.into_iter().map(outline).collect()
    }
}
