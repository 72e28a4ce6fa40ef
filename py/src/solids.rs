//! The solids with which a mechanism is drawn in a pose.

use crate::error::{failed, wrong};
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use nalgebra::{Isometry3, Point3};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_core::skeleton::{self, Configuration, ImaginaryJoints, Skeleton};
use pyo3::prelude::*;

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
        let decomposition = manipulator.decomposition();
        let joints = ImaginaryJoints { decomposition, imaginary: manipulator.imaginary() };
        let skeleton = Skeleton::new(manipulator.mechanism(), Some(joints));
        let posture = Configuration {
            joints: solution.joints(),
            imaginary: solution.imaginary(),
            platform: solution.displacement(manipulator),
        };
        let places = skeleton.place_in_base(&posture).map_err(|error| failed(&error))?;
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
