//! Poses as displacements in SE(3), and back.

use crate::arguments;
use crate::columns::tabled;
use crate::manipulator::Manipulator;
use crate::matrices::matrices;
use crate::pickle::pickled;
use crate::rows::{Rows, Tables};
use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};
use numpy::ndarray::ArrayViewD;
use numpy::{PyArray2, PyArrayDyn, PyArrayMethods};
use opm_core::manipulator::{Mode, OutsideMotion, PoseError};
use opm_core::numeric::rotation;
use pyo3::prelude::*;
use std::num::NonZeroUsize;

/// The poses of a manipulator's motion that are nearest to given displacements, and the differences that remain.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Nearest {
    /// (..., d): task coordinates, metres and radians.
    poses: Py<PyArrayDyn<f64>>,
    /// (..., 3): rotation vectors from the orientations at the poses to those given, base coordinates, radians; zero
    /// where the displacement is in the motion.
    rotation: Py<PyArrayDyn<f64>>,
    /// (..., 3): from the platform's points at the poses to those given, base coordinates, metres; zero
    /// where the displacement is in the motion.
    translation: Py<PyArrayDyn<f64>>,
    /// Names of the task coordinates.
    pose_names: Vec<String>,
}

tabled!(Nearest);

pickled!(Nearest { poses, rotation, translation, pose_names });

#[pymethods]
impl Nearest {
    fn __repr__(&self, py: Python<'_>) -> String {
        let [turns, ways] = [&self.rotation, &self.translation].map(|of| of.bind(py).readonly());
        let (turns, ways) = (turns.as_array(), ways.as_array());
        let threes = |of: &ArrayViewD<'_, f64>| of.iter().copied().collect::<Vec<_>>();
        let (turns, ways) = (threes(&turns), threes(&ways));
        let rows = turns.chunks_exact(3).zip(ways.chunks_exact(3));
        let off = rows.filter(|(turn, way)| turn.iter().chain(*way).any(|&part| part != 0.0));
        let (all, off) = (turns.len() / 3, off.count());
        format!("<Nearest poses to {all} displacements: {off} outside the motion>")
    }
}

#[pymethods]
impl Manipulator {
    /// The displacement of the platform at each pose, in SE(3): its reference point and its orientation, in base coordinates.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     The working mode, or ``"home"``: dependent coordinates depend on it.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., 4, 4) ndarray
    ///     Homogeneous matrices: a rotation, which is the identity at home unless the coordinates measure it, and a
    ///     position, metres. NaN where dependent coordinates have no solution.
    #[pyo3(signature = (poses, *, mode = "home", threads = None))]
    fn transform<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let poses = self.poses(poses)?;
        let poses = Rows::new(&poses)?;
        let (mode, none) = (self.mode(mode)?, || ());
        let tables = Tables::fill(py, poses.count, [16], threads, none, |(), row, [out]| {
            if poses.missing(row) {
                return Ok([false; 2]);
            }
            match self.inner.displacement_in(poses.row(row), mode) {
                Ok(displacement) => {
                    let place = self.inner.platform_at(&displacement).to_homogeneous();
                    out.copy_from_slice(place.transpose().as_slice());
                }
                Err(PoseError::Constraint { .. }) => {}
                Err(error) => return Err(format!("pose {row}: {error}")),
            }
            Ok([true; 2])
        })?;
        poses.shaped(&tables.table(0), &[4, 4])
    }

    /// The dependent coordinates of each pose.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     The working mode, or ``"home"``.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., c) ndarray
    ///     One column for each of ``dependent_coordinates``; metres and radians. NaN where they have no solution.
    #[pyo3(signature = (poses, *, mode = "home", threads = None))]
    fn dependent<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let poses = self.poses(poses)?;
        let poses = Rows::new(&poses)?;
        let (mode, none) = (self.mode(mode)?, || ());
        let width = self.inner.dependent_coordinates().len();
        let tables = Tables::fill(py, poses.count, [width], threads, none, |(), row, [out]| {
            if poses.missing(row) {
                return Ok([false; 2]);
            }
            let found = self.inner.dependent_values(poses.row(row), mode);
            if let Some(found) = found.map_err(|error| format!("pose {row}: {error}"))? {
                out.copy_from_slice(&found);
            }
            Ok([true; 2])
        })?;
        poses.shaped(&tables.table(0), &[width])
    }

    /// The poses at which the platform has the given displacements: the inverse of :meth:`transform`.
    ///
    /// Parameters
    /// ----------
    /// transforms : (..., 4, 4) array_like
    ///     Homogeneous matrices, metres; a ``RigidTransform`` of SciPy, or a pair of ``(..., 3)`` positions and rotations: a
    ///     ``Rotation`` or ``(..., 3, 3)`` matrices.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., d) ndarray
    ///     Metres and radians, angles within π of their home values. NaN where the displacement is outside the manipulator's
    ///     motion; :meth:`nearest` gives the difference.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A matrix is not a rotation and a position.
    #[pyo3(signature = (transforms, *, threads = None))]
    fn locate<'py>(
        &self,
        py: Python<'py>,
        transforms: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let transforms = matrices(transforms, "transforms")?;
        let transforms = Rows::new(&transforms)?;
        let width = self.pose_names().len();
        let poses = self.located_poses(py, &transforms, None, threads)?;
        transforms.shaped(&poses, &[width])
    }

    /// The poses nearest to the given displacements, and the differences that remain where :meth:`locate` has no pose.
    ///
    /// Parameters
    /// ----------
    /// transforms : (..., 4, 4) array_like
    ///     Homogeneous matrices, metres; a ``RigidTransform`` of SciPy, or a pair of ``(..., 3)`` positions and rotations: a
    ///     ``Rotation`` or ``(..., 3, 3)`` matrices.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Nearest
    ///     Nearest by least squares; rotations are weighted with the mechanism's size.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A matrix is not a rotation and a position.
    #[pyo3(signature = (transforms, *, threads = None))]
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        transforms: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Nearest> {
        let transforms = matrices(transforms, "transforms")?;
        let transforms = Rows::new(&transforms)?;
        let widths = [self.pose_names().len(), 3, 3];
        let located = self.located(py, &transforms, threads, widths, |place, [pose, turn, way]| {
            let zero = Vector3::zeros();
            let (nearest, rotation, translation) = match self.inner.locate_platform(place) {
                Ok(pose) => (pose, zero, zero),
                Err(OutsideMotion { nearest, rotation, translation }) => {
                    (nearest, rotation, translation)
                }
            };
            pose.copy_from_slice(&nearest);
            turn.copy_from_slice(rotation.as_slice());
            way.copy_from_slice(translation.as_slice());
        });
        let located = located?;
        Ok(Nearest {
            poses: transforms.frozen(&located.table(0), &widths[..1])?,
            rotation: transforms.frozen(&located.table(1), &[3])?,
            translation: transforms.frozen(&located.table(2), &[3])?,
            pose_names: self.pose_names().into_iter().map(str::to_owned).collect(),
        })
    }
}

impl Manipulator {
    /// The poses of displacements; NaN where they are outside the manipulator's motion, or outside that of a mode.
    pub fn located_poses<'py>(
        &self,
        py: Python<'py>,
        transforms: &Rows<'_>,
        mode: Option<Mode>,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let widths = [self.pose_names().len()];
        // Without dependent coordinates, the platform is at the same place in every mode.
        let mode = mode.filter(|_| !self.inner.dependent_coordinates().is_empty());
        let located = self.located(py, transforms, threads, widths, |place, [out]| {
            let found = match mode {
                Some(mode) => self.inner.locate_platform_in(place, mode),
                None => self.inner.locate_platform(place),
            };
            let Ok(pose) = found else { return };
            if mode.is_none_or(|mode| self.inner.is_at(&pose, mode, place)) {
                out.copy_from_slice(&pose);
            }
        });
        Ok(located?.table(0))
    }

    /// Tables that `fill` writes, from each displacement.
    fn located<'py, const N: usize>(
        &self,
        py: Python<'py>,
        transforms: &Rows<'_>,
        threads: Option<NonZeroUsize>,
        widths: [usize; N],
        fill: impl Fn(&Isometry3<f64>, [&mut [f64]; N]) + Sync,
    ) -> PyResult<Tables<'py, N>> {
        let none = || ();
        Tables::fill(py, transforms.count, widths, threads, none, |(), row, out| {
            if !transforms.missing(row) {
                fill(&placement(transforms, row)?, out);
            }
            Ok([true; 2])
        })
    }
}

/// The displacement in this row.
pub fn placement(transforms: &Rows<'_>, row: usize) -> Result<Isometry3<f64>, String> {
    isometry(transforms.row(row))
        .map_err(|why| format!("transforms[{row}] is not a displacement: {why}"))
}

/// The displacement of a matrix that is given row by row, or what is wrong with it.
fn isometry(matrix: &[f64]) -> Result<Isometry3<f64>, String> {
    let last = &matrix[12..];
    if last != [0.0, 0.0, 0.0, 1.0] {
        return Err(format!("its last row is {last:?}, expected 0, 0, 0, 1"));
    }
    let position = Vector3::from_fn(|i, _| matrix[4 * i + 3]);
    if let Some((row, value)) = position.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(format!("row {row}, column 3 is {value:?}, expected a finite number"));
    }
    let rotation = rotation::nearest(&Matrix3::from_fn(|i, j| matrix[4 * i + j]))
        .map_err(|error| error.to_string())?;
    Ok(Isometry3::from_parts(Translation3::from(position), rotation))
}
