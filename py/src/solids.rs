//! The solids with which a mechanism is drawn in a pose.

use crate::arguments;
use crate::error::{failed, wrong};
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use crate::rows::{Rows, Tables};
use nalgebra::{Isometry3, Point3};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_core::manipulator::Solution;
use opm_core::skeleton::{self, Configuration, ImaginaryJoints, Skeleton};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyEllipsis, PySlice};
use std::num::NonZeroUsize;

/// A simple body to draw, in base coordinates.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Solid {
    /// The body that it is a part of: ``"base"``, ``"LEG/JOINT"``, ``"platform"``, ``"imaginary/NAME"``.
    body: String,
    /// ``"cylinder"``, ``"ball"`` or ``"block"``.
    shape: String,
    /// ``"base"``, ``"link"``, ``"actuated"``, ``"passive"``, ``"platform"`` or ``"imaginary"``.
    material: String,
    /// (2, 3): the ends of its axis, metres; for a ball both are its centre.
    ends: Py<PyArray2<f64>>,
    /// Diameter, or side of the square section of a block, metres.
    width: f64,
}

pickled!(Solid { body, shape, material, ends, width });

#[pymethods]
impl Solid {
    fn __repr__(&self) -> String {
        format!("<Solid {} of {}, {}>", self.shape, self.body, self.material)
    }
}

#[pymethods]
impl Manipulator {
    /// The solids that the mechanism is drawn with, from its joint screws alone.
    ///
    /// Parameters
    /// ----------
    /// pose : (d,) array_like, optional
    ///     Metres and radians. Home if not given.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    ///
    /// Returns
    /// -------
    /// list of Solid
    ///     Metres, base coordinates.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The pose is out of reach.
    #[pyo3(signature = (pose = None, *, mode = "home"))]
    fn solids(
        &self,
        py: Python<'_>,
        pose: Option<&Bound<'_, PyAny>>,
        mode: &str,
    ) -> PyResult<Vec<Solid>> {
        let manipulator = &self.inner;
        let mode = self.mode(mode)?;
        let pose = match pose {
            Some(given) => self.pose(given, "pose")?,
            None => manipulator.home_pose(),
        };
        let mut solution = manipulator.solution();
        let found = manipulator.inverse(&pose, mode, &mut solution);
        if found.map_err(|error| failed(&error))?.is_none() {
            let legs = solution.unreachable().iter();
            let legs: Vec<_> = legs.map(|u| &*manipulator.mechanism().legs[u.leg].name).collect();
            return Err(wrong(format!("the pose {pose:?} is out of reach of {}", legs.join(", "))));
        }
        let skeleton = self.skeleton();
        let places = skeleton.place_in_base(&self.configuration(&solution));
        let places = places.map_err(|error| failed(&error))?;
        let mut solids = Vec::new();
        for (body, place) in skeleton.bodies().iter().zip(&places) {
            for part in &body.parts {
                let (shape, ends, width) = shape(&part.solid, place);
                let ends = ends.iter().flat_map(|p| [p.x, p.y, p.z]).collect::<Vec<_>>();
                solids.push(Solid {
                    body: body.name.clone(),
                    shape: shape.to_owned(),
                    material: part.material.name().to_owned(),
                    ends: frozen(ends.into_pyarray(py).reshape([2, 3])?)?,
                    width,
                });
            }
        }
        Ok(solids)
    }

    /// The frames of all links at each pose, by the links' names: for a viewer.
    ///
    /// Links are those of :meth:`solids` and of recordings: ``base``, ``platform``, and ``leg1/A1`` for the link that joint A1 carries. A
    /// frame is parallel to the base's at home, and stands where the link's joint is.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping, optional
    ///     As for :meth:`inverse`. Home if not given.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// dict of str to (..., 4, 4) ndarray
    ///     Homogeneous matrices from the link to the base, metres; NaN where the pose is out of reach.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The columns are not the task coordinates, a number is infinite, or the mode is unknown.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("planar-3rpr")
    /// >>> frames = m.link_frames({"x": 0.01})
    /// >>> frames["platform"].shape, bool((frames["platform"] == m.transform({"x": 0.01})).all())
    /// ((4, 4), True)
    #[pyo3(signature = (poses = None, *, mode = "home", threads = None))]
    fn link_frames<'py>(
        &self,
        py: Python<'py>,
        poses: Option<&Bound<'py, PyAny>>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (manipulator, mode) = (&*self.inner, self.mode(mode)?);
        let poses = match poses {
            Some(poses) => self.poses(poses)?,
            None => self.poses(manipulator.home_pose().into_pyarray(py).as_any())?,
        };
        let poses = Rows::new(&poses)?;
        let skeleton = self.skeleton();
        let bodies = skeleton.bodies();
        let tables = Tables::fill(
            py,
            poses.count,
            [16 * bodies.len()],
            threads,
            || manipulator.solution(),
            |solution, row, [out]| {
                if !self.solve(&poses, row, mode, solution)? {
                    return Ok([false; 2]);
                }
                let places = skeleton.place_in_base(&self.configuration(solution));
                let places = places.map_err(|error| error.to_string())?;
                for (out, place) in out.chunks_exact_mut(16).zip(&places) {
                    out.copy_from_slice(place.to_homogeneous().transpose().as_slice());
                }
                Ok([true; 2])
            },
        )?;
        let all = poses.shaped::<f64>(&tables.table(0), &[bodies.len(), 4, 4])?;
        let whole = PySlice::full(py);
        let dict = PyDict::new(py);
        for (number, body) in bodies.iter().enumerate() {
            dict.set_item(
                &body.name,
                all.get_item((PyEllipsis::get(py), number, &whole, &whole))?,
            )?;
        }
        Ok(dict)
    }
}

impl Manipulator {
    /// The bodies that it is drawn with.
    fn skeleton(&self) -> Skeleton {
        let (decomposition, imaginary) = (self.inner.decomposition(), self.inner.imaginary());
        let joints = ImaginaryJoints { decomposition, imaginary };
        Skeleton::new(self.inner.mechanism(), Some(joints))
    }

    /// Where they are at a solved pose.
    fn configuration<'a>(&self, solution: &'a Solution) -> Configuration<'a> {
        Configuration {
            joints: solution.joints(),
            imaginary: solution.imaginary(),
            platform: solution.displacement(&self.inner),
        }
    }
}

/// The name of a shape, the ends of its axis, and its diameter or width.
fn shape(solid: &skeleton::Solid, place: &Isometry3<f64>) -> (&'static str, [Point3<f64>; 2], f64) {
    match *solid {
        skeleton::Solid::Cylinder { from, to, radius } => {
            ("cylinder", [place * from, place * to], 2.0 * radius)
        }
        skeleton::Solid::Ball { centre, radius } => ("ball", [place * centre; 2], 2.0 * radius),
        skeleton::Solid::Block { centre, axis, length, width } => {
            let half = axis.into_inner() * (length / 2.0);
            ("block", [place * (centre - half), place * (centre + half)], width)
        }
    }
}
