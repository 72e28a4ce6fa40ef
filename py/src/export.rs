//! Mechanisms as models of other programs.

use crate::arguments;
use crate::error::failed;
use crate::linkage::Linkage;
use crate::manipulator::Manipulator;
use crate::trajectory;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_core::mechanism::Mechanism;
use opm_core::trajectory::Trajectory;
use opm_export::{MjcfReference, Urdf, urdf};
use pyo3::prelude::*;

/// The columns of a table, and its rows.
type Table<'py> = (Vec<String>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl Manipulator {
    /// A motion in the coordinates of the model of :meth:`to_mjcf`: a row for each time step of a simulation.
    ///
    /// A control leads the joint's value by what the servo lags, so that the model follows. It is the table that
    /// ``opm export mjcf --trajectory`` writes.
    ///
    /// Parameters
    /// ----------
    /// motion : path or str
    ///     A motion file, a table of poses (``.csv``), or the name of a shipped motion.
    /// time_step : float
    ///     Time step of the simulation, seconds: that of :meth:`to_mjcf`.
    /// mode : str, optional
    ///     ``"home"``, or a sign for every two-valued choice; if not given, the mode of the file, or home.
    ///
    /// Returns
    /// -------
    /// tuple of (list of str, (n, 1 + nq + nu) ndarray)
    ///     Names of the columns, and the rows: the time, the values of ``data.qpos``, and those of ``data.ctrl``.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be read.
    /// OpmError
    ///     Lists every problem of the file with its line and column; or the mechanism cannot follow the motion, or it has more
    ///     than a million time steps.
    #[pyo3(signature = (motion, *, time_step = 0.001, mode = None))]
    fn mjcf_reference<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, PyAny>,
        time_step: f64,
        mode: Option<&str>,
    ) -> PyResult<Table<'py>> {
        let time_step = arguments::mjcf_options(None, time_step)?.time_step();
        let motion = trajectory::motion(self, motion)?;
        let mode = match mode {
            Some(mode) => self.mode(mode)?,
            None => motion.mode.unwrap_or_else(|| self.inner.home_mode()),
        };
        let follow = || {
            let followed = Trajectory::new(&self.inner, &motion, mode, time_step.recip())?;
            MjcfReference::new(&self.inner, followed)
        };
        let found = py.detach(follow).map_err(|error| failed(&error))?;
        let shape = [found.len(), found.columns().len()];
        let rows = found.values().to_vec().into_pyarray(py).reshape(shape)?;
        Ok((found.columns().to_vec(), rows))
    }

    /// The mechanism as a tree of links (URDF): the text of an XML file.
    ///
    /// URDF has no loops; :meth:`to_closures` closes them. Joints have the names and the values of `joints`, but a ball is
    /// three revolute joints ``NAME.1``, ``NAME.2`` and ``NAME.3``. A helical joint has a slide that follows it, which
    /// Pinocchio reads with ``mimic=True``. The platform is the link ``platform``. It is the file that ``opm export urdf``
    /// writes.
    ///
    /// Parameters
    /// ----------
    /// density : float, optional
    ///     Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
    ///     2700, if not given.
    ///
    /// Returns
    /// -------
    /// str
    ///     For ``pinocchio.buildModelFromXML``, or a file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The density is not positive.
    #[pyo3(signature = (*, density = None))]
    fn to_urdf(&self, py: Python<'_>, density: Option<f64>) -> PyResult<String> {
        Ok(model(py, self.inner.mechanism(), density)?.tree)
    }

    /// What closes the loops of the tree of :meth:`to_urdf`: the text of a YAML file.
    ///
    /// It is what the loader of Gepetto's example-parallel-robots for Pinocchio reads: ``closed_loop`` has pairs of links
    /// that coincide, ``type`` their type, and ``name_mot`` the actuated joints.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text of a YAML file.
    fn to_closures(&self, py: Python<'_>) -> PyResult<String> {
        Ok(model(py, self.inner.mechanism(), None)?.closures)
    }
}

#[pymethods]
impl Linkage {
    /// The mechanism as a tree of links (URDF): the text of an XML file.
    ///
    /// URDF has no loops; :meth:`to_closures` closes them. Joints have the names and the values of `joints`, but a ball is
    /// three revolute joints ``NAME.1``, ``NAME.2`` and ``NAME.3``. A helical joint has a slide that follows it, which
    /// Pinocchio reads with ``mimic=True``. The platform is the link ``platform``. It is the file that ``opm export urdf``
    /// writes.
    ///
    /// Parameters
    /// ----------
    /// density : float, optional
    ///     Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
    ///     2700, if not given.
    ///
    /// Returns
    /// -------
    /// str
    ///     For ``pinocchio.buildModelFromXML``, or a file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The density is not positive.
    #[pyo3(signature = (*, density = None))]
    fn to_urdf(&self, py: Python<'_>, density: Option<f64>) -> PyResult<String> {
        Ok(model(py, self.mechanism(), density)?.tree)
    }

    /// What closes the loops of the tree of :meth:`to_urdf`: the text of a YAML file.
    ///
    /// It is what the loader of Gepetto's example-parallel-robots for Pinocchio reads: ``closed_loop`` has pairs of links
    /// that coincide, ``type`` their type, and ``name_mot`` the actuated joints.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text of a YAML file.
    fn to_closures(&self, py: Python<'_>) -> PyResult<String> {
        Ok(model(py, self.mechanism(), None)?.closures)
    }
}

/// The model of a mechanism.
fn model(py: Python<'_>, mechanism: &Mechanism, density: Option<f64>) -> PyResult<Urdf> {
    let density = arguments::density(density)?;
    Ok(py.detach(|| urdf(mechanism, density)))
}
