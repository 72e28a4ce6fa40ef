//! The equations of motion for arrays of poses.

use crate::arguments;
use crate::error::wrong;
use crate::given::{Columns, Given, together};
use crate::manipulator::Manipulator;
use crate::rows::{Rows, Tables};
use crate::setup;
use crate::velocity::characteristic_length;
use nalgebra::DVector;
use numpy::PyArrayDyn;
use opm_analysis::{Dynamics, Gravity, Setup, Springs, State};
use opm_core::manipulator::Mode;
use pyo3::prelude::*;
use pyo3::types::{PyEllipsis, PySlice};
use std::num::NonZeroUsize;

/// Rows that belong to poses, and what they are called in messages.
type Named<'a, 'py> = (&'a Bound<'py, PyAny>, &'a str);

/// What is asked for each pose.
struct Asked<'a, 'py, const N: usize> {
    poses: &'a Bound<'py, PyAny>,
    /// Rows of other numbers: those of the task coordinates, and efforts.
    others: [Named<'a, 'py>; N],
    gravity: Gravity,
    mode: Mode,
    threads: Option<NonZeroUsize>,
}

#[pymethods]
impl Manipulator {
    /// Mass matrices in task coordinates.
    ///
    /// The equations of motion are ``M(x) x'' + c(x, x') + g(x) + f(x, x') = J.T @ efforts``, with :meth:`bias`, :meth:`gravity`,
    /// :meth:`friction` and :meth:`jacobian`.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// density : float, optional
    ///     Density of bodies whose masses the mechanism does not give, kg/m³, instead of the mechanism's.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., d, d) ndarray
    ///     Symmetric; kg between lengths, kg m² between angles, kg m between both. NaN where the pose is out of reach, and at
    ///     serial singularities.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> mass = m.mass_matrix(m.home)
    /// >>> mass.shape, bool(mass[2, 2] > 0)
    /// ((3, 3), True)
    #[pyo3(signature = (poses, *, density = None, mode = "home", threads = None))]
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(None, density)?);
        let asked = Asked { poses, others: [], gravity, mode, threads };
        let count = self.pose_names().len();
        self.each_pose(py, &asked, &[count, count], |dynamics, _, []| {
            // Row by row, as NumPy has it.
            Some(dynamics.mass_matrix()?.transpose().as_slice().to_vec())
        })
    }

    /// Coriolis and centrifugal forces on the task coordinates.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// rates : (..., d) array_like, or mapping
    ///     First derivatives of the task coordinates by time, m/s and rad/s; one row is for all poses. By name, those that are
    ///     not given are zero.
    /// density : float, optional
    ///     As for :meth:`mass_matrix`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., d) ndarray
    ///     N for lengths, N m for angles. NaN where the pose is out of reach, and at serial singularities.
    #[pyo3(signature = (poses, rates, *, density = None, mode = "home", threads = None))]
    #[allow(clippy::too_many_arguments)]
    fn bias<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(None, density)?);
        let asked = Asked { poses, others: [(rates, "rates")], gravity, mode, threads };
        let count = self.pose_names().len();
        self.each_pose(py, &asked, &[count], |dynamics, _, [rates]| {
            dynamics.bias(rates).map(|forces| forces.as_slice().to_vec())
        })
    }

    /// What the weight of all bodies needs of the task coordinates.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// gravity : (3,) array_like, optional
    ///     How a body falls, m/s², base directions; 9.81 m/s² along -z if not given.
    /// density : float, optional
    ///     As for :meth:`mass_matrix`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., d) ndarray
    ///     N for lengths, N m for angles: the derivative of the potential energy. NaN where the pose is out of reach, and at
    ///     serial singularities.
    #[pyo3(signature = (poses, *, gravity = None, density = None, mode = "home", threads = None))]
    #[allow(clippy::too_many_arguments)]
    fn gravity<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        gravity: Option<&Bound<'py, PyAny>>,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(gravity, density)?);
        let asked = Asked { poses, others: [], gravity, mode, threads };
        let count = self.pose_names().len();
        self.each_pose(py, &asked, &[count], |dynamics, _, []| {
            dynamics.gravity().map(|forces| forces.as_slice().to_vec())
        })
    }

    /// What the friction of joints needs of the task coordinates.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// rates : (..., d) array_like, or mapping
    ///     As for :meth:`bias`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., d) ndarray
    ///     N for lengths, N m for angles. A joint at rest has no friction. NaN where the pose is out of reach, and at serial
    ///     singularities.
    #[pyo3(signature = (poses, rates, *, mode = "home", threads = None))]
    fn friction<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (mode, gravity) = (self.mode(mode)?, Gravity::default());
        let asked = Asked { poses, others: [(rates, "rates")], gravity, mode, threads };
        let count = self.pose_names().len();
        self.each_pose(py, &asked, &[count], |dynamics, _, [rates]| {
            dynamics.friction(rates).map(|forces| forces.as_slice().to_vec())
        })
    }

    /// The efforts of actuators that give accelerations: inverse dynamics.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// rates : (..., d) array_like, or mapping
    ///     As for :meth:`bias`.
    /// accelerations : (..., d) array_like, or mapping
    ///     Second derivatives, m/s² and rad/s², likewise.
    /// gravity : (3,) array_like, optional
    ///     As for :meth:`gravity`.
    /// density : float, optional
    ///     As for :meth:`mass_matrix`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., a) ndarray
    ///     The effort of every actuated joint, N and N m. NaN where the pose is out of reach, at singularities, and where
    ///     redundant actuators leave an effort open.
    #[pyo3(signature = (
        poses, rates, accelerations, *, gravity = None, density = None, mode = "home", threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        accelerations: &Bound<'py, PyAny>,
        gravity: Option<&Bound<'py, PyAny>>,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(gravity, density)?);
        let others = [(rates, "rates"), (accelerations, "accelerations")];
        let asked = Asked { poses, others, gravity, mode, threads };
        let count = self.inner.actuated().len();
        self.each_pose(py, &asked, &[count], |dynamics, _, [rates, accelerations]| {
            let found = dynamics.efforts(rates, accelerations).actuated;
            Some(found.into_iter().map(|effort| effort.unwrap_or(f64::NAN)).collect())
        })
    }

    /// The accelerations that efforts of actuators give: forward dynamics.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// rates : (..., d) array_like, or mapping
    ///     As for :meth:`bias`.
    /// efforts : (..., a) array_like, or mapping
    ///     The effort of every actuated joint, N and N m; one row is for all poses. By name, those that are not given are zero.
    /// gravity : (3,) array_like, optional
    ///     As for :meth:`gravity`.
    /// density : float, optional
    ///     As for :meth:`mass_matrix`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., d) ndarray
    ///     Second derivatives of the task coordinates, m/s² and rad/s². NaN where the pose is out of reach, at serial
    ///     singularities, and where the coordinates are singular (:attr:`Singularity.coordinates` is 0).
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> holding = m.inverse_dynamics(m.home, [0, 0, 0], [0, 0, 0])
    /// >>> accelerations = m.forward_dynamics(m.home, [0, 0, 0], holding)
    /// >>> bool(abs(accelerations).max() < 1e-9)
    /// True
    #[pyo3(signature = (
        poses, rates, efforts, *, gravity = None, density = None, mode = "home", threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        efforts: &Bound<'py, PyAny>,
        gravity: Option<&Bound<'py, PyAny>>,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(gravity, density)?);
        let others = [(rates, "rates"), (efforts, EFFORTS)];
        let asked = Asked { poses, others, gravity, mode, threads };
        let count = self.pose_names().len();
        self.each_pose(py, &asked, &[count], |dynamics, _, [rates, efforts]| {
            dynamics.forward(rates, efforts).map(|found| found.as_slice().to_vec())
        })
    }

    /// The linear model for controllers at a state: ``d/dt [δx, δx'] = A @ [δx, δx'] + B @ δefforts``.
    ///
    /// Dry friction is left out of it. `A` is found by differences, to some ten digits.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// rates : (..., d) array_like, or mapping
    ///     As for :meth:`bias`.
    /// efforts : (..., a) array_like, or mapping
    ///     As for :meth:`forward_dynamics`; those of :meth:`inverse_dynamics` hold the state.
    /// gravity : (3,) array_like, optional
    ///     As for :meth:`gravity`.
    /// density : float, optional
    ///     As for :meth:`mass_matrix`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// A : (..., 2 d, 2 d) ndarray
    ///     SI units and radians. NaN where :meth:`forward_dynamics` is.
    /// B : (..., 2 d, a) ndarray
    ///     Likewise.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> rest = np.zeros(3)
    /// >>> A, B = m.linear_model(m.home, rest, m.inverse_dynamics(m.home, rest, rest))
    /// >>> A.shape, B.shape
    /// ((6, 6), (6, 3))
    #[pyo3(signature = (
        poses, rates, efforts, *, gravity = None, density = None, mode = "home", threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn linear_model<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        efforts: &Bound<'py, PyAny>,
        gravity: Option<&Bound<'py, PyAny>>,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(gravity, density)?);
        let others = [(rates, "rates"), (efforts, EFFORTS)];
        let asked = Asked { poses, others, gravity, mode, threads };
        let (states, inputs) = (2 * self.pose_names().len(), self.inner.actuated().len());
        let both =
            self.each_pose(py, &asked, &[states, states + inputs], |dynamics, pose, given| {
                let [rates, efforts] = given.map(DVector::clone);
                let state = State { pose: DVector::from_column_slice(pose), rates };
                let model = dynamics.linear_model(&state, mode, &efforts).ok()??;
                // Row by row: A, then B.
                let row = |i: usize| {
                    model.a.row(i).iter().chain(model.b.row(i).iter()).copied().collect()
                };
                Some((0..states).flat_map(|i| -> Vec<f64> { row(i) }).collect())
            })?;
        let both = both.into_any();
        let columns = |from: usize, to: usize| {
            both.get_item((PyEllipsis::get(py), PySlice::new(py, from as isize, to as isize, 1)))
        };
        Ok((columns(0, states)?, columns(states, states + inputs)?))
    }
}

/// The argument that has a column for each actuated joint.
const EFFORTS: &str = "efforts";

impl Manipulator {
    /// What is found at each pose, as rows of this shape; NaN where nothing is.
    fn each_pose<'py, const N: usize>(
        &self,
        py: Python<'py>,
        asked: &Asked<'_, 'py, N>,
        shape: &[usize],
        found: impl Fn(&mut Dynamics<'_>, &[f64], [&DVector<f64>; N]) -> Option<Vec<f64>> + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let mut poses = self.poses(asked.poses)?;
        let others = asked.others.iter().map(|(given, what)| self.numbers(given, what));
        let mut others = others.collect::<PyResult<Vec<Given<'_>>>>()?;
        let mut named: Vec<_> = others
            .iter_mut()
            .zip(&asked.others)
            .map(|(own, (_, what))| (Some(own), *what))
            .collect();
        together((&mut poses, "poses"), &mut named)?;
        let poses = Rows::new(&poses)?;
        let others = others.iter().map(Rows::new).collect::<PyResult<Vec<_>>>()?;
        for (rows, (_, what)) in others.iter().zip(&asked.others) {
            if let Some(odd) = rows.values().iter().find(|value| !value.is_finite()) {
                return Err(wrong(format!("{odd} is among {what}, expected finite numbers")));
            }
        }
        let setup = Setup {
            gravity: Some(asked.gravity),
            ..Setup::new(characteristic_length(&self.inner, None)?)
        };
        let mode = asked.mode;
        let tables = Tables::fill(
            py,
            poses.count,
            [shape.iter().product()],
            asked.threads,
            || (self.inner.solution(), Dynamics::new(&self.inner, &setup)),
            |(at, dynamics), row, [out]| {
                if !self.solve(&poses, row, mode, at)? {
                    return Ok([false; 2]);
                }
                if !dynamics.update(at).map_err(|error| error.to_string())? {
                    return Ok([true, false]);
                }
                let own: [DVector<f64>; N] = std::array::from_fn(|i| {
                    let row = others[i].row(row.min(others[i].count - 1));
                    DVector::from_column_slice(row)
                });
                if let Some(found) = found(dynamics, poses.row(row), own.each_ref()) {
                    out.copy_from_slice(&found);
                }
                Ok([true; 2])
            },
        )?;
        poses.shaped(&tables.table(0), shape)
    }

    /// Rows of numbers of the task coordinates, or of efforts.
    fn numbers<'py>(&self, given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
        let names = match what {
            EFFORTS => Springs::names(&self.inner),
            _ => self.pose_names(),
        };
        let none = vec![0.0; names.len()];
        Columns { names: &names, otherwise: Some(&none) }.read(given, what)
    }
}
