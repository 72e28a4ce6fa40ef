//! Rates of joints and poses with the dimensions of a mechanism.

use crate::arguments;
use crate::columns::tabled;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use crate::rows::{Rows, Tables};
use numpy::{IntoPyArray, PyArrayDyn, PyUntypedArrayMethods};
use opm_accuracy::Dimensions;
use opm_core::mechanism::file::hint::expected_one_of;
use pyo3::prelude::*;
use std::num::NonZeroUsize;

/// Poses that a thread works on between two checks whether it should stop: each takes a millisecond or less.
const BLOCK: usize = 16;

/// Rates with the dimensions of a mechanism at many poses; NaN where a pose is out of reach, and where they are not known.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct ParameterJacobian {
    /// (..., j, p): the rate of each joint coordinate with each parameter, while the pose stays. Metres and radians.
    joints: Py<PyArrayDyn<f64>>,
    /// (..., d, p): the rate of each task coordinate with each parameter, while the actuated joints keep their values.
    pose: Py<PyArrayDyn<f64>>,
    /// Names of the parameters.
    parameters: Vec<String>,
    /// (...): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArrayDyn<bool>>,
    /// Names along the second axis from the end of `joints`.
    joint_names: Vec<String>,
    /// Names of the task coordinates.
    pose_names: Vec<String>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(ParameterJacobian);

pickled!(ParameterJacobian { joints, pose, parameters, reachable, joint_names, pose_names, index });

#[pymethods]
impl ParameterJacobian {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let poses = self.reachable.bind(py).len();
        Ok(format!("<ParameterJacobian at {poses} poses: {}>", self.parameters.join(", ")))
    }
}

#[pymethods]
impl Manipulator {
    /// Rates of all joints, and of the pose, with the dimensions of the mechanism.
    ///
    /// The mechanism is assembled with a larger and with a smaller value of each parameter, once; at each pose the rates are
    /// central differences of the closed forms of both, exact to some 1e-9.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like
    ///     One row for each pose, one column for each task coordinate; metres and radians.
    /// parameters : sequence of str, optional
    ///     Lengths and angles of :attr:`parameters` that follow from no others; of a point in a family, ``leg4.base.x``. All of
    ///     them if not given.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// ParameterJacobian
    ///     `joints` while the pose stays, `pose` while the actuated joints stay.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A name is not that of a length or an angle which can change alone, or a number is not finite.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> rates = m.parameter_jacobian([m.home], parameters=["rod"])
    /// >>> rates.pose[0, :, 0].round(3)  # with longer rods the platform hangs lower
    /// array([ 0.   , -0.   , -1.169])
    #[pyo3(signature = (poses, *, parameters = None, mode = "home", threads = None))]
    fn parameter_jacobian<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        parameters: Option<Vec<String>>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<ParameterJacobian> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let inner = &*self.inner;
        let dimensions = Dimensions::new(inner, &self.file());
        let known: Vec<&str> = dimensions.names().collect();
        let names =
            parameters.unwrap_or_else(|| known.iter().copied().map(str::to_owned).collect());
        let column = |name: &String| {
            let found = known.iter().position(|known| known == name);
            found.ok_or_else(|| {
                wrong(format!(
                    "parameters: no dimension {name:?}; {}",
                    expected_one_of(name, &known)
                ))
            })
        };
        let columns = names.iter().map(column).collect::<PyResult<Vec<usize>>>()?;
        let (p, d, j) = (columns.len(), inner.task_coordinates().len(), inner.coordinates().len());
        let mut tables = Tables::fill_in_blocks(
            py,
            (poses.count, BLOCK),
            [j * p, d * p],
            threads,
            || inner.solution(),
            |solution, row, [joints, pose]| {
                if !self.solve(&poses, row, mode, solution)? {
                    return Ok([false; 2]);
                }
                let rates =
                    dimensions.at(solution, mode).map_err(|e| format!("pose {row}: {e}"))?;
                for (out, rates) in [(joints, &rates.joints), (pose, &rates.pose)] {
                    for (row, out) in out.chunks_exact_mut(p.max(1)).enumerate() {
                        for (out, &column) in out.iter_mut().zip(&columns) {
                            *out = rates[(row, column)];
                        }
                    }
                }
                Ok([true, true])
            },
        )?;
        let [reachable, _] =
            std::mem::take(&mut tables.answers).map(|answers| answers.into_pyarray(py));
        Ok(ParameterJacobian {
            joints: poses.frozen(&tables.table(0), &[j, p])?,
            pose: poses.frozen(&tables.table(1), &[d, p])?,
            parameters: names,
            joint_names: self.joint_names(),
            pose_names: self.pose_names().into_iter().map(str::to_owned).collect(),
            index: poses.index(py),
            reachable: poses.frozen(&reachable, &[])?,
        })
    }
}
