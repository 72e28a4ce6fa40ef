//! The worst pose error over a box of poses, with a guaranteed bound.

use super::sizes::ErrorArguments;
use crate::arguments;
use crate::columns::tabled;
use crate::error::wrong;
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::measure::ranges;
use crate::pickle::pickled;
use opm_study::{Bounded, BoxErrors, BoxRequest};
use opm_workspace::Progress;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use std::num::NonZeroUsize;

/// The worst errors of the platform over a box of poses: the largest that was found, and a bound that no pose in reach exceeds.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct AccuracyBounds {
    /// Metres: no pose of the box that is in reach displaces the platform's reference point by more. Infinite if nothing is known.
    length: f64,
    /// Radians: no pose of the box that is in reach rotates the platform by more.
    angle: f64,
    /// Metres: the largest displacement that was found at a pose. NaN if no pose was in reach.
    found_length: f64,
    /// Radians: the largest rotation that was found at a pose.
    found_angle: f64,
    /// The pose with the largest displacement, metres and radians. Empty if no pose was in reach.
    pose_length: Vec<f64>,
    /// The pose with the largest rotation.
    pose_angle: Vec<f64>,
    /// Whether both bounds are within `gap` above what was found.
    tight: bool,
    /// How many boxes were bounded.
    boxes: u64,
}

tabled!(AccuracyBounds);

pickled!(AccuracyBounds {
    length,
    angle,
    found_length,
    found_angle,
    pose_length,
    pose_angle,
    tight,
    boxes,
});

#[pymethods]
impl AccuracyBounds {
    fn __repr__(&self) -> String {
        let Self { length, angle, boxes, .. } = self;
        format!("<AccuracyBounds: at most {length:.4e} m and {angle:.4e} rad, by {boxes} boxes>")
    }
}

#[pymethods]
impl Manipulator {
    /// The worst displacement and rotation of the platform over a box of poses, with a guaranteed bound: affine arithmetic
    /// misses no pose between others. To first order in the errors.
    ///
    /// Parameters
    /// ----------
    /// over : dict of str to (min, max) or float
    ///     A range or a value for task coordinates by their names, metres and radians. Others stay at home.
    /// actuators : (length, angle), optional
    ///     As for :meth:`accuracy`.
    /// tolerances : dict or path, optional
    ///     As for :meth:`accuracy`; of axes and actuators.
    /// errors : str
    ///     As for :meth:`accuracy`.
    /// gap : float
    ///     Stops when the bounds are within this share above the largest errors found.
    /// budget : int, optional
    ///     Largest number of boxes: 20,000 if not given. Where it ends earlier, ``tight`` is False and the bounds hold.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// length : float, optional
    ///     As for :meth:`accuracy`.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// AccuracyBounds
    ///     What is guaranteed of every pose of the box.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A coordinate is unknown, its ends are not in order, or the errors have no bounds over boxes.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("plano-spherical-5dof")
    /// >>> found = m.accuracy_over({"x": (-0.02, 0.02)}, tolerances={"length": 50e-6, "angle": 350e-6}, gap=0.1)
    /// >>> found.found_length <= found.length <= 1.1 * found.found_length
    /// True
    #[pyo3(signature = (
        over, *, actuators = None, tolerances = None, errors = "axes", gap = 0.05, budget = None, mode = "home",
        length = None, threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn accuracy_over<'py>(
        &self,
        py: Python<'py>,
        over: &Bound<'py, PyMapping>,
        actuators: Option<&Bound<'py, PyAny>>,
        tolerances: Option<&Bound<'py, PyAny>>,
        errors: &str,
        gap: f64,
        #[pyo3(from_py_with = arguments::budget)] budget: Option<u64>,
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<AccuracyBounds> {
        let mode = self.mode(mode)?;
        if !(gap > 0.0 && gap.is_finite()) {
            return Err(wrong(format!("gap is {gap}, expected a positive share")));
        }
        let given = ErrorArguments { actuators, tolerances, errors, length };
        let (model, sizes) = given.read(self)?;
        let over = ranges(over)?;
        let most = budget.unwrap_or(opm_study::BOX_BUDGET);
        let request = BoxRequest { model: &model, sizes: &sizes, mode, over: &over, gap, most };
        let progress = Progress::default();
        let found =
            interrupt::run(py, threads, || request.errors(&progress), || progress.cancel())?;
        let BoxErrors { length, angle, boxes, tight, .. } =
            found.map_err(|error| wrong(error.to_string()))?;
        let [Bounded { found: found_length, pose: pose_length, bound: length }, other] =
            [length, angle];
        let Bounded { found: found_angle, pose: pose_angle, bound: angle } = other;
        Ok(AccuracyBounds {
            length,
            angle,
            found_length,
            found_angle,
            pose_length,
            pose_angle,
            tight,
            boxes,
        })
    }
}
