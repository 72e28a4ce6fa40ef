//! Frequency responses for arrays of poses.

use crate::arguments;
use crate::error::{request, wrong};
use crate::manipulator::Manipulator;
use crate::rows::{Rows, Tables};
use crate::setup::Given;
use opm_analysis::{Compliant, Damping, Gravity};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

#[pymethods]
impl Manipulator {
    /// How the platform answers to a force that swings: its compliance by frequency.
    ///
    /// Actuators and links are springs, as for :meth:`analyze`, and masses are those of its natural frequencies.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// frequencies : (n,) array_like
    ///     Hz, not negative.
    /// link_stiffness : (float, float)
    ///     As for :meth:`analyze`.
    /// joint_stiffness : dict of str to float, optional
    ///     Likewise.
    /// loss_factor : float
    ///     Structural damping: all springs are ``k (1 + 1j * loss_factor)``.
    /// damping_ratio : float
    ///     Viscous damping: the share of critical damping of each natural vibration. One of the two is above 0.
    /// density : float, optional
    ///     As for :meth:`mass_matrix`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., n, 6, 6) ndarray of complex
    ///     For a unit of each component FX, FY, FZ, MX, MY, MZ at the reference point (columns), the amplitude and the phase of its
    ///     translation along x, y and z of the base, m, and of the platform's rotation vector, rad (rows). NaN where the pose is out of
    ///     reach, and where the platform moves without resistance.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> motors = {m.joint_names[i]: 2000.0 for i in m.actuated}
    /// >>> response = m.frequency_response(m.home, [0, 5, 50], link_stiffness=(1e6, 1e4), joint_stiffness=motors)
    /// >>> response.shape, bool(abs(response[2, 2, 2]) < abs(response[0, 2, 2]))
    /// ((3, 6, 6), True)
    #[pyo3(signature = (
        poses, frequencies, *, link_stiffness, joint_stiffness = None, loss_factor = 0.0, damping_ratio = 0.02, density = None,
        mode = "home", threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn frequency_response<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        frequencies: &Bound<'py, PyAny>,
        link_stiffness: [f64; 2],
        joint_stiffness: Option<BTreeMap<String, f64>>,
        loss_factor: f64,
        damping_ratio: f64,
        density: Option<f64>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let frequencies = arguments::list(frequencies, "frequencies")?;
        if let Some(odd) = frequencies.iter().find(|f| !f.is_finite() || **f < 0.0) {
            return Err(wrong(format!(
                "{odd} is among frequencies, expected numbers from 0 on, Hz"
            )));
        }
        let damping = Damping { loss_factor, ratio: damping_ratio };
        let known = [loss_factor, damping_ratio].iter().all(|part| (0.0..=10.0).contains(part));
        if !known || loss_factor + damping_ratio == 0.0 {
            return Err(wrong(format!(
                "loss_factor is {loss_factor} and damping_ratio is {damping_ratio}, expected 0 to 10, and one above 0: without \
                 damping it is infinite at natural frequencies"
            )));
        }
        let given = Given {
            wrench: None,
            at: None,
            frame: "base",
            gravity: None,
            density: None,
            link_stiffness: Some(link_stiffness),
            joint_stiffness,
            length: None,
        };
        let setup = given.options()?.check(&self.inner).map_err(|error| request(&error))?;
        let masses = Gravity { density: arguments::density(density)?, ..Gravity::default() };
        let width = 2 * 36 * frequencies.len();
        let tables = Tables::fill(
            py,
            poses.count,
            [width],
            threads,
            || {
                let springs = setup.springs.clone();
                let compliant = springs.and_then(|of| Compliant::new(&self.inner, of).ok());
                (self.inner.solution(), compliant.map(|of| of.with_gravity(&masses)))
            },
            |(at, compliant), row, [out]| {
                if !self.solve(&poses, row, mode, at)? {
                    return Ok([false; 2]);
                }
                let found = compliant.as_mut().and_then(|compliant| {
                    let stiffness = compliant.stiffness(at)?;
                    compliant.response(&stiffness)
                });
                let Some(found) = found else { return Ok([true, false]) };
                for (out, &frequency) in out.chunks_exact_mut(72).zip(&frequencies) {
                    // Symmetric: columns are rows.
                    let all = found.compliance(frequency, damping);
                    for (pair, value) in out.chunks_exact_mut(2).zip(all.iter()) {
                        pair.copy_from_slice(&[value.re, value.im]);
                    }
                }
                Ok([true; 2])
            },
        )?;
        let pairs = poses.shaped::<f64>(&tables.table(0), &[frequencies.len(), 6, 12])?;
        pairs.as_any().call_method1("view", ("complex128",))
    }
}
