//! The points of a sweep: as a mask, as rows of coordinates, and as a set.

use super::Sweep;
use super::shards::{shard, spread};
use crate::arguments;
use crate::error::failed;
use crate::interrupt::{self, few};
use crate::parts::Parts;
use crate::rows::no_memory;
use numpy::npyffi::NPY_ORDER;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_workspace::{Cancelled, GridSet, Hits, Progress, Run, Shard};
use pyo3::prelude::*;
use std::num::NonZeroU64;

#[pymethods]
impl Sweep {
    /// Which points are in the workspace: one axis for each coordinate of :attr:`axes`, with one entry for each value.
    ///
    /// `executor` and `shards` are those of :func:`sweep`, here and in all other methods; places and orientations are
    /// already known and are not computed again.
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
    /// ndarray of bool
    ///     The first axis is that of the first coordinate.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn mask<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mask = Self::flat_mask(slf, Parts::new(executor, shards)?.as_ref())?;
        slf.get().shaped(&mask)
    }

    /// (count, d): the points in the order of the grid, the first coordinate fastest; columns as :attr:`axes`.
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
    /// (count, d) ndarray
    ///     Metres and radians.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn points<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this, parts) = (slf.py(), slf.get(), Parts::new(executor, shards)?);
        match (this.workspace.required_visits(), parts) {
            (Some(_), parts) => {
                let set = Self::set(slf, parts.as_ref())?;
                let points: Vec<f64> =
                    py.detach(|| set.numbers().flat_map(|number| set.point(number)).collect());
                let shape = [set.count() as usize, set.axes().len()];
                Ok(points.into_pyarray(py).reshape(shape)?.into_any())
            }
            (None, None) => {
                this.pointed(py, Shard::WHOLE, this.count.reachable).map(Bound::into_any)
            }
            (None, Some(parts)) => {
                let parts = spread(slf, &parts, "_points", None)?;
                py.import("numpy")?.call_method1("concatenate", (parts,))
            }
        }
    }

    /// Whether each pose of one part is reachable, in their order.
    fn _mask<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        of: u64,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.masked(py, shard(number, of)?)
    }

    /// The reachable poses of one part.
    fn _points<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        of: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.pointed(py, shard(number, of)?, 0)
    }
}

impl Sweep {
    /// Whether each point is in the workspace.
    pub fn flat_mask<'py>(
        slf: &Bound<'py, Self>,
        parts: Option<&Parts<'py>>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let (py, this) = (slf.py(), slf.get());
        match (this.workspace.required_visits(), parts) {
            (Some(required), parts) => {
                let tally = Self::tally(slf, parts)?;
                Ok(PyArray1::from_iter(py, tally.iter().map(|&visits| visits >= required)))
            }
            (None, None) => this.masked(py, Shard::WHOLE),
            (None, Some(parts)) => {
                let parts = spread(slf, parts, "_mask", None)?;
                Ok(py.import("numpy")?.call_method1("concatenate", (parts,))?.cast_into()?)
            }
        }
    }

    /// The points of the workspace.
    pub fn set<'py>(slf: &Bound<'py, Self>, parts: Option<&Parts<'py>>) -> PyResult<GridSet> {
        let (py, this) = (slf.py(), slf.get());
        let set = match (this.workspace.required_visits(), parts) {
            (Some(required), parts) => {
                let tally = Self::tally(slf, parts)?;
                py.detach(|| this.workspace.set(|number| tally[number as usize] >= required))
            }
            (None, None) => {
                let (progress, sweep) = (Progress::default(), this.swept(Shard::WHOLE));
                let work = || GridSet::reached(&sweep, &progress);
                interrupt::run(py, few(this.threads, sweep.pieces()), work, || progress.cancel())?
            }
            (None, Some(parts)) => {
                let mask = Self::flat_mask(slf, Some(parts))?.readonly();
                let mask = mask.as_slice()?;
                py.detach(|| this.workspace.set(|number| mask[number as usize]))
            }
        };
        set.map_err(|error| failed(&error))
    }

    /// Values of all points in the shape of the grid.
    pub fn shaped<'py, T: numpy::Element>(
        &self,
        flat: &Bound<'py, PyArray1<T>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let axes = &self.workspace.grid().axes()[self.span()];
        let shape: Vec<usize> = axes.iter().map(|axis| axis.count as usize).collect();
        // The first coordinate is the fastest, so this is an array in Fortran's order.
        Ok(flat.reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)?.into_any())
    }

    fn masked<'py>(&self, py: Python<'py>, shard: Shard) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let sweep = self.swept(shard);
        let poses = usize::try_from(sweep.poses()).map_err(|error| failed(&error))?;
        let before = sweep.range().start;
        let mut mask = Vec::new();
        let short = |_| no_memory(format_args!("a mask of {poses} poses"));
        mask.try_reserve_exact(poses).map_err(short)?;
        mask.resize(poses, false);
        self.visit(
            py,
            shard,
            |hits, made: &mut Vec<Run>| made.extend(hits.numbers(self.workspace.grid())),
            |made| {
                for Run { from, to } in made {
                    mask[(from - before) as usize..(to - before) as usize].fill(true);
                }
            },
        )?;
        Ok(mask.into_pyarray(py))
    }

    fn pointed<'py>(
        &self,
        py: Python<'py>,
        shard: Shard,
        expected: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.workspace.grid().axes().len();
        let expected = usize::try_from(expected).map_err(|error| failed(&error))?;
        let mut all = Vec::new();
        let short = |_| no_memory(format_args!("{expected} points"));
        all.try_reserve_exact(expected.saturating_mul(width)).map_err(short)?;
        self.visit(
            py,
            shard,
            |hits, made: &mut Vec<f64>| {
                for &first in hits.first {
                    made.push(first);
                    made.extend(hits.others);
                }
            },
            |made| all.extend(made),
        )?;
        let count = all.len() / width;
        all.into_pyarray(py).reshape([count, width])
    }

    /// Sweeps again to find the points. `make` extracts values from the hits, and `take` gets them in order.
    pub fn visit<T: Default + Send>(
        &self,
        py: Python<'_>,
        shard: Shard,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        mut take: impl FnMut(T) + Send,
    ) -> PyResult<()> {
        let progress = Progress::default();
        let sweep = self.swept(shard);
        let work = || {
            sweep.points(&progress, &make, T::default, |made| {
                take(made);
                Ok::<(), Cancelled>(())
            })
        };
        let done =
            interrupt::run(py, few(self.threads, sweep.pieces()), work, || progress.cancel())?;
        done.map_err(|error| failed(&error))
    }
}
