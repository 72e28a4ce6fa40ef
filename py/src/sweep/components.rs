//! The connected components of a workspace.

use super::Sweep;
use crate::arguments;
use crate::error::failed;
use crate::parts::Parts;
use crate::rows::no_memory;
use numpy::{IntoPyArray, PyArray1};
use opm_study::WorkspaceKind;
use opm_workspace::{Components, Run};
use pyo3::prelude::*;
use std::num::NonZeroU64;

#[pymethods]
impl Sweep {
    /// How many points each connected component has, the largest first.
    ///
    /// Points are neighbours if they differ by one step along one coordinate; for an angle over a full revolution, the last
    /// value is next to the first. :meth:`labels` gives the component of each point. Of kind ``"aspects"``, the components are
    /// the aspects.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    ///
    /// Returns
    /// -------
    /// ndarray of uint64
    ///     Numbers of points.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn components<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let parts = Parts::new(executor, shards)?;
        if slf.get().workspace.kind() == WorkspaceKind::Aspects {
            let aspects = Self::found(slf, parts.as_ref())?;
            let sizes: Vec<u64> = aspects.list().iter().map(|aspect| aspect.poses).collect();
            return Ok(sizes.into_pyarray(slf.py()));
        }
        let set = Self::set(slf, parts.as_ref())?;
        let sizes = slf.py().detach(|| Components::new(&set).sizes().to_vec());
        Ok(sizes.into_pyarray(slf.py()))
    }

    /// Which connected component each point belongs to, in the shape of the mask: 0 where the mask is False, 1 in the largest.
    ///
    /// This is like ``scipy.ndimage.label``, except for angles over a full revolution. Component ``i`` has
    /// ``components()[i - 1]`` points; of components of equal size, the one with the first point comes first. Singular poses
    /// of kind ``"aspects"`` are 0, too.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    ///
    /// Returns
    /// -------
    /// ndarray of int32
    ///     One axis for each coordinate of the mask.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn labels<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let parts = Parts::new(executor, shards)?;
        let set = Self::set(slf, parts.as_ref())?;
        let aspects = match slf.get().workspace.kind() {
            WorkspaceKind::Aspects => Some(Self::found(slf, parts.as_ref())?),
            _ => None,
        };
        let points = usize::try_from(set.points()).map_err(|error| failed(&error))?;
        let mut labels = Vec::new();
        let short = |_| no_memory(format_args!("a label for each of {points} points"));
        labels.try_reserve_exact(points).map_err(short)?;
        py.detach(|| {
            labels.resize(points, 0);
            // A set has 2^27 runs at most, and no more components.
            let mut fill = |run: Run, label: u32| {
                labels[run.from as usize..run.to as usize].fill(label as i32);
            };
            match &aspects {
                Some(aspects) => aspects.runs().for_each(|(run, label)| fill(run, label)),
                None => {
                    let components = Components::new(&set);
                    components.runs().for_each(|(run, number)| fill(run, number + 1));
                }
            }
        });
        slf.get().shaped(&labels.into_pyarray(py))
    }
}
