//! How well the poses of a workspace are conditioned.

use super::Sweep;
use super::shards::{shard, spread};
use crate::arguments;
use crate::error::{failed, wrong};
use crate::html::digits;
use crate::interrupt::{self, few};
use crate::parts::Parts;
use crate::pickle::pickled;
use crate::rows::no_memory;
use numpy::{IntoPyArray, PyArray1};
use opm_workspace::{Conditioned, ConditioningIndex, Progress, Shard};
use pyo3::prelude::*;
use std::num::NonZeroU64;

/// How well the poses of a workspace are conditioned. The local index of a pose is the inverse of its condition number.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Conditioning {
    /// The mean of the local indices (Gosselin and Angeles); None where no pose has one.
    global_index: Option<f64>,
    /// The smallest local index.
    local_min: Option<f64>,
    /// The largest local index; one at best.
    local_max: Option<f64>,
    /// Characteristic length of the condition numbers, metres.
    length: f64,
    /// Number of poses that have an index.
    poses: u64,
}

pickled!(Conditioning { global_index, local_min, local_max, length, poses });

#[pymethods]
impl Conditioning {
    fn __repr__(&self) -> String {
        let Self { poses, length, .. } = self;
        match (self.global_index, self.local_min, self.local_max) {
            (Some(mean), Some(min), Some(max)) => format!(
                "<Conditioning of {poses} poses: {} on average, {} to {}, lengths over {} m>",
                digits(mean),
                digits(min),
                digits(max),
                digits(*length)
            ),
            _ => "<Conditioning of 0 poses>".to_owned(),
        }
    }
}

/// Of a part: poses that have an index, the least, the greatest, and their sum in parts of 2^-60.
type Indices = (u64, f64, f64, u128);

#[pymethods]
impl Sweep {
    /// The global conditioning index, and the smallest and largest local one, of every reachable pose.
    ///
    /// Each pose is taken in the first working mode that counts; every pose has the same weight.
    ///
    /// Returns
    /// -------
    /// Conditioning
    ///     Without unit.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The points are not poses.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn conditioning(
        slf: &Bound<'_, Self>,
        executor: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Conditioning> {
        let (py, this) = (slf.py(), slf.get());
        this.check_conditioned()?;
        let length = this.length();
        let mut all = ConditioningIndex::nothing(length);
        let parts: Vec<Indices> = match Parts::new(executor, shards)? {
            None => vec![this._conditioning(py, 1, 1)?],
            Some(parts) => spread(slf, &parts, "_conditioning", None)?.extract()?,
        };
        for (poses, min, max, sum) in parts {
            all.add(&ConditioningIndex { length, poses, min, max, sum });
        }
        let any = all.poses > 0;
        Ok(Conditioning {
            global_index: all.global(),
            local_min: any.then_some(all.min),
            local_max: any.then_some(all.max),
            length,
            poses: all.poses,
        })
    }

    /// The local conditioning index of every pose, in the shape of the mask: NaN where the mask is False.
    ///
    /// The index is the inverse of the condition number: one at best, zero at a singularity.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Without unit.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The points are not poses.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn local_conditioning<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        this.check_conditioned()?;
        let flat = match Parts::new(executor, shards)? {
            None => this._local_conditioning(py, 1, 1)?,
            Some(parts) => {
                let parts = spread(slf, &parts, "_local_conditioning", None)?;
                py.import("numpy")?.call_method1("concatenate", (parts,))?.cast_into()?
            }
        };
        this.shaped(&flat)
    }

    /// What the poses of one part add to the conditioning index.
    fn _conditioning(&self, py: Python<'_>, number: u64, of: u64) -> PyResult<Indices> {
        let (progress, sweep) = (Progress::default(), self.swept(shard(number, of)?));
        let work = || ConditioningIndex::of(&sweep, self.length(), &progress);
        let found =
            interrupt::run(py, few(self.threads, sweep.pieces()), work, || progress.cancel())?;
        let ConditioningIndex { poses, min, max, sum, .. } = found.map_err(|e| failed(&e))?;
        Ok((poses, min, max, sum))
    }

    /// The local conditioning index of every pose of one part, in their order.
    fn _local_conditioning<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        of: u64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let shard: Shard = shard(number, of)?;
        let range = self.swept(shard).range();
        let poses = usize::try_from(range.end - range.start).map_err(|error| failed(&error))?;
        let mut all = Vec::new();
        let short = |_| no_memory(format_args!("a number for each of {poses} poses"));
        all.try_reserve_exact(poses).map_err(short)?;
        all.resize(poses, f64::NAN);
        let manipulator = self.workspace.manipulator();
        let limit = self.workspace.limit_or_none();
        self.visit(
            py,
            shard,
            |hits, (made, conditioned): &mut (Vec<(u64, f64)>, Option<Conditioned<'_>>)| {
                let conditioned =
                    conditioned.get_or_insert_with(|| Conditioned::new(manipulator, limit.clone()));
                let mut poses = Vec::with_capacity(hits.first.len() * (1 + hits.others.len()));
                for &first in hits.first {
                    poses.push(first);
                    poses.extend_from_slice(hits.others);
                }
                let mut indices = vec![f64::NAN; hits.first.len()];
                conditioned.local_indices(&poses, self.workspace.modes(), &mut indices);
                let numbers = hits.numbers(self.workspace.grid()).flat_map(|run| run.from..run.to);
                made.extend(numbers.zip(indices));
            },
            |(made, _)| {
                for (number, local) in made {
                    all[(number - range.start) as usize] = local;
                }
            },
        )?;
        Ok(all.into_pyarray(py))
    }
}

impl Sweep {
    fn check_conditioned(&self) -> PyResult<()> {
        let kind = self.workspace.kind();
        if kind.is_of_poses() {
            return Ok(());
        }
        let points = format!("the {} of kind {} have none", kind.point_name(), kind.name());
        Err(wrong(format!("only poses have a condition number; {points}")))
    }
}
