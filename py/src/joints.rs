//! The joints of a mechanism as data.

use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use nalgebra::{Point3, Vector3};
use opm_core::mechanism::file::{self, Digits, FileUnits};
use opm_core::mechanism::joint as core;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A joint of a leg at home, in base coordinates. Its lists have an entry for each of its coordinates: one, two or three.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Joint {
    /// Name of the joint.
    name: String,
    /// ``"revolute"``, ``"prismatic"``, ``"helical"``, ``"cylindrical"``, ``"universal"`` or ``"spherical"``.
    kind: String,
    /// Unit vector along the axis; None for a spherical joint.
    axis: Option<(f64, f64, f64)>,
    /// Unit vector along a universal joint's axis next to the platform; None for others.
    axis2: Option<(f64, f64, f64)>,
    /// A point of the axis, metres; the centre of a universal or spherical joint; where a prismatic joint is drawn.
    point: (f64, f64, f64),
    /// Advance of a helical joint, metres per radian; None for others.
    pitch: Option<f64>,
    /// Whether a motor drives it.
    actuated: bool,
    /// Names of its coordinates, as in `joints`.
    coordinates: Vec<String>,
    /// ``"m"`` or ``"rad"``.
    units: Vec<String>,
    /// The values at home, metres and radians.
    home: Vec<f64>,
    /// The lowest and the highest value, or None.
    limits: Vec<Option<(f64, f64)>>,
    /// The largest rate, per second, or None.
    max_rate: Vec<Option<f64>>,
    /// The largest acceleration, per second squared, or None.
    max_acceleration: Vec<Option<f64>>,
    /// The largest effort of the actuator, N or N m, or None.
    max_effort: Vec<Option<f64>>,
}

pickled!(Joint {
    name,
    kind,
    axis,
    axis2,
    point,
    pitch,
    actuated,
    coordinates,
    units,
    home,
    limits,
    max_rate,
    max_acceleration,
    max_effort,
});

impl Joint {
    fn of(joint: &core::Joint) -> Self {
        let direction = |v: &Vector3<f64>| (v.x, v.y, v.z);
        let (axis2, pitch) = match &joint.kind {
            core::JointKind::Universal { second } => (Some(direction(second)), None),
            core::JointKind::Helical { pitch } => (None, Some(*pitch)),
            _ => (None, None),
        };
        let each = || joint.coordinates.iter();
        Self {
            name: joint.name.clone(),
            kind: joint.kind.name().to_owned(),
            axis: (joint.kind != core::JointKind::Spherical).then(|| direction(&joint.axis)),
            axis2,
            point: place(&joint.point),
            pitch,
            actuated: joint.actuated,
            coordinates: each().map(|c| c.name.clone()).collect(),
            units: each().map(|c| c.quantity.unit().to_owned()).collect(),
            home: each().map(|c| c.home).collect(),
            limits: each().map(|c| c.limits.map(|[low, high]| (low, high))).collect(),
            max_rate: each().map(|c| c.motion_limits.max_rate).collect(),
            max_acceleration: each().map(|c| c.motion_limits.max_acceleration).collect(),
            max_effort: each().map(|c| c.max_effort).collect(),
        }
    }
}

#[pymethods]
impl Joint {
    fn __repr__(&self) -> String {
        let actuated = if self.actuated { ", actuated" } else { "" };
        format!("<Joint {}: {}{actuated}>", self.name, self.kind)
    }
}

#[pymethods]
impl Manipulator {
    /// The joints of each leg, from base to platform, by the legs' names.
    #[getter]
    fn legs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for leg in &self.inner.mechanism().legs {
            dict.set_item(&leg.name, leg.joints.iter().map(Joint::of).collect::<Vec<_>>())?;
        }
        Ok(dict)
    }

    /// The platform's reference point at home, base coordinates, metres.
    #[getter]
    fn reference_point(&self) -> (f64, f64, f64) {
        place(&self.inner.mechanism().platform)
    }

    /// The mechanism as a file that lists its joints, in metres and radians, whatever the form of its own file.
    ///
    /// It gives the same joint values at the same poses, in the same working modes. Imaginary joints are called ``tau.LEG``
    /// there, and are zero at home. It is the file that ``opm convert --joints`` writes, apart from the units.
    ///
    /// Returns
    /// -------
    /// str
    ///     For :meth:`parse`, or a file.
    fn to_joints(&self) -> String {
        file::write(self.inner.mechanism(), FileUnits::SI, Digits::All)
    }
}

fn place(point: &Point3<f64>) -> (f64, f64, f64) {
    (point.x, point.y, point.z)
}
