//! What is known of a workspace beside its points: boundary, components, conditioning.

use crate::arguments;
use crate::error::{failed, wrong};
use crate::html::digits;
use crate::interrupt;
use crate::parts::Parts;
use crate::pickle::{frozen, pickled};
use crate::rows::no_memory;
use crate::sweep::{Sweep, shard, spread};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_cli::recording::Kind;
use opm_workspace::{
    ConditionLimit, Conditioned, ConditioningIndex, GridSet, Progress, Shard, boundary, components,
};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::collections::BTreeMap;
use std::num::NonZeroU64;

/// The boundary of a workspace in a plane, or of one slice of it: closed polylines along the steps of the grid.
///
/// They run half-way between points that are in and their neighbours that are out, and along the edge of the grid where the
/// workspace goes on beyond.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Outline {
    /// The coordinates of the plane: the columns of the polylines.
    #[pyo3(get)]
    axes: (String, String),
    /// The coordinate that it is sliced by, and its value; empty where there is one plane.
    #[pyo3(get)]
    at: BTreeMap<String, f64>,
    /// Of the pieces without the holes, in the product of both coordinates' units.
    #[pyo3(get)]
    area: f64,
    /// Closed polylines, (n, 2) each, metres and radians; the last corner is the first one again. Counter-clockwise around
    /// pieces of the workspace, clockwise around holes.
    rings: Vec<(f64, Py<PyArray2<f64>>)>,
}

/// An outline as it crosses processes.
type Spec = ((String, String), BTreeMap<String, f64>, f64, Vec<(f64, Py<PyArray2<f64>>)>);

#[pymethods]
impl Outline {
    /// Closed polylines, (n, 2) each, metres and radians; the last corner is the first one again. Counter-clockwise around
    /// pieces of the workspace, clockwise around holes.
    #[getter]
    fn rings<'py>(&self, py: Python<'py>) -> Bound<'py, PyTuple> {
        self.those(py, |_| true)
    }

    /// Those around pieces.
    #[getter]
    fn outer<'py>(&self, py: Python<'py>) -> Bound<'py, PyTuple> {
        self.those(py, |area| area >= 0.0)
    }

    /// Those around holes.
    #[getter]
    fn holes<'py>(&self, py: Python<'py>) -> Bound<'py, PyTuple> {
        self.those(py, |area| area < 0.0)
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
        // Arrays come out of a pickle writable.
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

/// How well the poses of a workspace are conditioned: their local indices, one over the condition number each.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Conditioning {
    /// The mean of the local indices (Gosselin and Angeles); None where no pose has one.
    global_index: Option<f64>,
    /// The least.
    local_min: Option<f64>,
    /// The greatest; one at best.
    local_max: Option<f64>,
    /// Characteristic length of the condition numbers, metres.
    length: f64,
    /// Poses that have an index.
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
    /// The boundary as closed polylines in the first two coordinates that have several values.
    ///
    /// Returns
    /// -------
    /// list of Outline
    ///     One; or, where a third coordinate has several values, one for each of these.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Fewer or more coordinates with several values; or of kind ``"imaginary"``, where the boundary of the orientations
    ///     says nothing of the imaginary joints.
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
        if slf.get().asked_kind() == Kind::Imaginary {
            let message = "the boundary of the orientations says nothing of the imaginary joints";
            return Err(wrong(format!("{message}; kind imaginary has none")));
        }
        let set = Self::set(slf, Parts::new(executor, shards)?.as_ref())?;
        let axes = set.varying();
        let name = |number: usize| set.axes()[axes[number]].axis.name.clone();
        let Some(outlines) = py.detach(|| boundary(&set)) else {
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
                // Closed for whoever draws it.
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

    /// How many points each connected component has, the largest first.
    ///
    /// Points are neighbours where they differ by one step along one coordinate; an angle whose values come full circle has its
    /// last value next to the first.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn components<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let set: GridSet = Self::set(slf, Parts::new(executor, shards)?.as_ref())?;
        Ok(slf.py().detach(|| components(&set)).into_pyarray(slf.py()))
    }

    /// The global conditioning index, and the least and greatest local one: a few microseconds a reachable pose.
    ///
    /// Each pose in the first working mode that counts; every pose has the same weight.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The points are no poses.
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
    /// One over the condition number: one at best, zero at a singularity.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The points are no poses.
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
        let work = || ConditioningIndex::new(&sweep, self.length(), &progress);
        let found = interrupt::run(py, self.threads, work, || progress.cancel())?;
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
        let limit = self.limit().unwrap_or(ConditionLimit::none(self.length()));
        self.visit(
            py,
            shard,
            |hits, (made, conditioned): &mut (Vec<(u64, f64)>, Option<Conditioned<'_>>)| {
                let conditioned =
                    conditioned.get_or_insert_with(|| Conditioned::new(&self.manipulator, limit));
                let mut pose = vec![0.0; hits.others.len() + 1];
                pose[1..].copy_from_slice(hits.others);
                let numbers = hits.numbers(&self.grid).flat_map(|run| run.from..run.to);
                for (number, &first) in numbers.zip(hits.first) {
                    pose[0] = first;
                    if let Some(local) = conditioned.local_index(&pose, self.modes) {
                        made.push((number, local));
                    }
                }
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
        let kind = self.asked_kind();
        if kind.is_of_poses() {
            return Ok(());
        }
        let points = format!("the {} of kind {} have none", kind.points(), kind.name());
        Err(wrong(format!("only poses have a condition number; {points}")))
    }
}
