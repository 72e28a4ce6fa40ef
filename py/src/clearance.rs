//! How far the bodies of a mechanism are from each other at many poses.

use crate::arguments;
use crate::columns::tabled;
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use crate::rows::{Rows, Tables};
use numpy::PyArrayDyn;
use opm_interference::{Distances, Interference};
use pyo3::prelude::*;
use std::num::NonZeroUsize;

/// The two bodies that are nearest to each other, at each pose.
///
/// Links and the platform are rods between their joints, with the radii of the mechanism file; obstacles are those of the file.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Clearance {
    /// (...): the distance of the nearest two, metres; negative where they overlap, NaN where the pose is out of reach.
    distance: Py<PyArrayDyn<f64>>,
    /// (...): which two these are, as an index of `pairs`; -1 where the pose is out of reach.
    pair: Py<PyArrayDyn<i64>>,
    /// The names of the pairs that are tested.
    pairs: Vec<(String, String)>,
    /// The pairs that are not tested because they overlap at home: their names, and by how much, metres.
    set_aside: Vec<(String, String, f64)>,
    /// The working mode.
    mode: String,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(Clearance);

pickled!(Clearance { distance, pair, pairs, set_aside, mode, index });

#[pymethods]
impl Clearance {
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.distance.bind(py).getattr("size")?.extract()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<Clearance of {} poses, {} pairs>", self.__len__(py)?, self.pairs.len()))
    }
}

#[pymethods]
impl Manipulator {
    /// The two bodies that are nearest to each other at every pose, and how far apart they are.
    ///
    /// Bodies that meet by construction are not tested: those that share a joint, or joints at one point. Nor are pairs that
    /// overlap at home (:attr:`Clearance.set_aside`), where the shapes are wrong rather than the mechanism.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Clearance
    ///     Distances in metres, and names of pairs.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The columns are not the task coordinates, a number is not finite, or the mode is unknown.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("plano-spherical-5dof")
    /// >>> clearance = m.clearance([m.home])
    /// >>> one, other = clearance.pairs[clearance.pair[0]]
    /// >>> bool(clearance.distance[0] > 0)
    /// True
    #[pyo3(signature = (poses, *, mode = "home", threads = None))]
    fn clearance(
        &self,
        py: Python<'_>,
        poses: &Bound<'_, PyAny>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Clearance> {
        let poses = self.poses(poses)?;
        let poses = Rows::new(&poses)?;
        let (manipulator, mode) = (&*self.inner, self.mode(mode)?);
        let interference = Interference::new(manipulator.mechanism());
        let tables = Tables::fill(
            py,
            poses.count,
            [1, 1],
            threads,
            || (manipulator.solution(), Distances::new(&interference)),
            |(solution, distances), row, [distance, pair]| {
                pair[0] = -1.0;
                if !self.solve(&poses, row, mode, solution)? {
                    return Ok([false; 2]);
                }
                distances.place(manipulator, solution);
                if let Some(nearest) = distances.nearest() {
                    (distance[0], pair[0]) = (nearest.distance, nearest.pair as f64);
                }
                Ok([true; 2])
            },
        )?;
        let pair = tables.table(1).call_method1("astype", ("int64",))?;
        let own = |name: &str| name.to_owned();
        let names = |number| -> (String, String) { interference.names_of(number).map(own).into() };
        let set_aside = interference.set_aside_pairs().iter().map(|pair| {
            let [one, other] = pair.names.clone();
            (one, other, pair.overlap)
        });
        Ok(Clearance {
            distance: poses.frozen(&tables.table(0), &[])?,
            pair: poses.frozen(&pair, &[])?,
            pairs: (0..interference.pairs()).map(names).collect(),
            set_aside: set_aside.collect(),
            mode: manipulator.format_mode(mode),
            index: poses.index(py),
        })
    }
}
