//! The joints of a mechanism as data.

use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use crate::snap;
use nalgebra::{Point3, Unit, Vector3};
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::mechanism::file::{self, Digits, FileUnits};
use opm_core::mechanism::joint as core;
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{BodyMasses, Cone, Mechanism, Shapes, TaskHints};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

/// Half the angle of a cone, and its axis if that is given.
type JointTilt = (f64, Option<(f64, f64, f64)>);

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
    /// Of a universal or spherical joint: how far its rod may tilt, radians, and from which direction, None for that at home.
    cone: Option<JointTilt>,
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
    cone,
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
            cone: joint.cone.map(|cone| (cone.half_angle, cone.axis.map(|axis| direction(&axis)))),
        }
    }

    /// The joint of a mechanism, if its directions are some.
    fn to_core(&self) -> PyResult<core::Joint> {
        let told = |problem: String| wrong(format!("joint {}: {problem}", self.name));
        let direction = |what: &str, given: Option<(f64, f64, f64)>| match given {
            Some((x, y, z)) => {
                let vector = Vector3::new(x, y, z);
                let finite = vector.iter().all(|c| c.is_finite());
                let unit = vector.try_normalize(1e-12).filter(|_| finite).map(Unit::new_normalize);
                unit.ok_or_else(|| told(format!("{what} is {given:?}, expected a direction")))
            }
            None => Err(told(format!("a {} joint needs {what}", self.kind))),
        };
        let axis = match &*self.kind {
            "spherical" => Vector3::z_axis(),
            _ => direction("axis", self.axis)?,
        };
        let kind = match &*self.kind {
            "revolute" => core::JointKind::Revolute,
            "prismatic" => core::JointKind::Prismatic,
            "cylindrical" => core::JointKind::Cylindrical,
            "spherical" => core::JointKind::Spherical,
            "helical" => core::JointKind::Helical {
                pitch: self.pitch.ok_or_else(|| told("a helical joint needs pitch".to_owned()))?,
            },
            "universal" => core::JointKind::Universal { second: direction("axis2", self.axis2)? },
            other => {
                return Err(told(format!(
                    "kind is {other:?}, expected \"revolute\", \"prismatic\", \"helical\", \"cylindrical\", \
                     \"universal\" or \"spherical\""
                )));
            }
        };
        let (x, y, z) = self.point;
        let mut joint = core::Joint::new(self.name.clone(), kind, axis, Point3::new(x, y, z));
        joint.actuated = self.actuated;
        let count = joint.coordinates.len();
        let lengths = [
            ("home", self.home.len()),
            ("limits", self.limits.len()),
            ("max_rate", self.max_rate.len()),
            ("max_acceleration", self.max_acceleration.len()),
            ("max_effort", self.max_effort.len()),
        ];
        if let Some((what, found)) = lengths.into_iter().find(|(_, found)| *found != count) {
            return Err(told(format!(
                "{what} has {found} entries, expected {count}, one for each coordinate"
            )));
        }
        for (number, c) in joint.coordinates.iter_mut().enumerate() {
            c.home = self.home[number];
            c.limits = self.limits[number].map(|(low, high)| [low, high]);
            c.motion_limits.max_rate = self.max_rate[number];
            c.motion_limits.max_acceleration = self.max_acceleration[number];
            c.max_effort = self.max_effort[number];
        }
        if let Some((half_angle, axis)) = self.cone {
            let axis = axis.map(|axis| direction("the cone's axis", Some(axis))).transpose()?;
            joint.cone = Some(Cone { half_angle, axis });
        }
        Ok(joint)
    }

    /// The same joint with other attributes.
    fn with(&self, changes: &Bound<'_, PyDict>) -> PyResult<Self> {
        const KEYS: [&str; 11] = [
            "axis",
            "axis2",
            "point",
            "pitch",
            "actuated",
            "home",
            "limits",
            "max_rate",
            "max_acceleration",
            "max_effort",
            "cone",
        ];
        let mut joint = self.clone();
        let count = self.coordinates.len();
        for (key, value) in changes {
            let key: String = key.extract()?;
            match &*key {
                "axis" => joint.axis = value.extract()?,
                "axis2" => joint.axis2 = value.extract()?,
                "point" => joint.point = value.extract()?,
                "pitch" => joint.pitch = value.extract()?,
                "actuated" => joint.actuated = value.extract()?,
                "home" => joint.home = each(&value, count, 0.0)?,
                "limits" => joint.limits = each(&value, count, None)?,
                "max_rate" => joint.max_rate = each(&value, count, None)?,
                "max_acceleration" => joint.max_acceleration = each(&value, count, None)?,
                "max_effort" => joint.max_effort = each(&value, count, None)?,
                "cone" => joint.cone = cone(Some(&value))?,
                _ => return Err(wrong(expected_one_of(&key, &KEYS))),
            }
        }
        Ok(joint)
    }
}

/// One value for the only coordinate, or a sequence with one for each; None is `otherwise` for all of them.
fn each<T>(given: &Bound<'_, PyAny>, count: usize, otherwise: T) -> PyResult<Vec<T>>
where
    T: for<'a> FromPyObjectOwned<'a> + Clone,
{
    if given.is_none() {
        return Ok(vec![otherwise; count]);
    }
    if count == 1
        && let Ok(one) = given.extract::<T>().map_err(Into::<PyErr>::into)
    {
        return Ok(vec![one]);
    }
    given.extract::<Vec<T>>()
}

/// A cone: half its angle, or that and its axis.
fn cone(given: Option<&Bound<'_, PyAny>>) -> PyResult<Option<JointTilt>> {
    let Some(given) = given.filter(|given| !given.is_none()) else { return Ok(None) };
    match given.extract::<f64>() {
        Ok(angle) => Ok(Some((angle, None))),
        Err(_) => given.extract().map(Some),
    }
}

#[pymethods]
impl Joint {
    /// A joint at home, in base coordinates, for :meth:`Manipulator.from_joints`.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Unlike the names of all other joints of the mechanism.
    /// kind : str
    ///     ``"revolute"``, ``"prismatic"``, ``"helical"``, ``"cylindrical"``, ``"universal"`` or ``"spherical"``.
    /// axis : (3,) sequence of float, optional
    ///     Direction of the axis; all kinds but a spherical joint need it.
    /// point : (3,) sequence of float
    ///     A point of the axis, metres; the centre of a universal or spherical joint.
    /// axis2 : (3,) sequence of float, optional
    ///     Direction of a universal joint's axis next to the platform.
    /// pitch : float, optional
    ///     Advance of a helical joint, metres per radian.
    /// actuated : bool
    ///     Whether a motor drives it.
    /// home : float or sequence of float, optional
    ///     The value at home, metres or radians; one for each coordinate. Zero if not given.
    /// limits : (float, float) or sequence of them, optional
    ///     The lowest and the highest value; a pair for each coordinate.
    /// max_rate, max_acceleration, max_effort : float or sequence of float, optional
    ///     The largest rate, acceleration and effort, SI.
    /// cone : float or (float, (float, float, float)), optional
    ///     Of a universal or spherical joint: how far its rod may tilt, radians, and from which direction.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The kind is unknown, or lacks an axis or a pitch.
    #[new]
    #[pyo3(signature = (
        name, kind, *, axis = None, point = (0.0, 0.0, 0.0), axis2 = None, pitch = None, actuated = false, home = None,
        limits = None, max_rate = None, max_acceleration = None, max_effort = None, cone = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        name: String,
        kind: String,
        axis: Option<(f64, f64, f64)>,
        point: (f64, f64, f64),
        axis2: Option<(f64, f64, f64)>,
        pitch: Option<f64>,
        actuated: bool,
        home: Option<&Bound<'_, PyAny>>,
        limits: Option<&Bound<'_, PyAny>>,
        max_rate: Option<&Bound<'_, PyAny>>,
        max_acceleration: Option<&Bound<'_, PyAny>>,
        max_effort: Option<&Bound<'_, PyAny>>,
        cone: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let count = match &*kind {
            "cylindrical" | "universal" => 2,
            "spherical" => 3,
            _ => 1,
        };
        let number = |given: Option<&Bound<'_, PyAny>>| match given {
            Some(given) => each(given, count, None),
            None => Ok(vec![None; count]),
        };
        let joint = Self {
            name,
            kind,
            axis,
            axis2,
            point,
            pitch,
            actuated,
            coordinates: Vec::new(),
            units: Vec::new(),
            home: home.map_or_else(|| Ok(vec![0.0; count]), |given| each(given, count, 0.0))?,
            limits: limits
                .map_or_else(|| Ok(vec![None; count]), |given| each(given, count, None))?,
            max_rate: number(max_rate)?,
            max_acceleration: number(max_acceleration)?,
            max_effort: number(max_effort)?,
            cone: self::cone(cone)?,
        };
        Ok(Self::of(&joint.to_core()?))
    }

    fn __repr__(&self) -> String {
        let actuated = if self.actuated { ", actuated" } else { "" };
        format!("<Joint {}: {}{actuated}>", self.name, self.kind)
    }
}

#[pymethods]
impl Manipulator {
    /// Compile a mechanism that is given by its joints at an assembled pose, home.
    ///
    /// Parameters
    /// ----------
    /// legs : mapping of str to sequence of Joint, or sequence of them
    ///     The joints of each leg, from base to platform, by the leg's name; without names the legs are leg1, leg2, ...
    /// platform : (3,) sequence of float
    ///     Reference point of the platform at home, metres; the base's origin if not given.
    /// name : str
    ///     Name of the mechanism.
    /// tolerance : float, optional
    ///     As for :meth:`parse`.
    ///
    /// Returns
    /// -------
    /// Manipulator
    ///     Decomposed and compiled; `text` is its mechanism file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Says what is wrong with which joint, or why the mechanism has no closed-form inverse kinematics.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> from math import cos, sin, pi
    /// >>> def leg(i):
    /// ...     def at(r, turn):
    /// ...         return (r * cos(2 * pi * i / 3 + turn), r * sin(2 * pi * i / 3 + turn), 0)
    /// ...     points = [at(0.3, 0), at(0.25, 0.5), at(0.1, 0)]
    /// ...     return [opm.Joint(f"{n}{i}", "revolute", axis=(0, 0, 1), point=p, actuated=n == "A") for n, p in zip("ABC", points)]
    /// >>> m = opm.Manipulator.from_joints([leg(i) for i in range(3)], name="3-RRR")
    /// >>> [c.name for c in m.task_coordinates]
    /// ['x', 'y', 'theta']
    #[staticmethod]
    #[pyo3(signature = (legs, *, platform = (0.0, 0.0, 0.0), name = "mechanism", tolerance = None))]
    fn from_joints(
        py: Python<'_>,
        legs: &Bound<'_, PyAny>,
        platform: (f64, f64, f64),
        name: &str,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let named: Vec<(String, Vec<Joint>)> = match legs.cast::<PyMapping>() {
            Ok(mapping) => mapping.items()?.extract()?,
            Err(_) => {
                let legs: Vec<Vec<Joint>> = legs.extract()?;
                let number = |(i, leg)| (format!("leg{}", i + 1), leg);
                legs.into_iter().enumerate().map(number).collect()
            }
        };
        let legs = named.into_iter().map(|(name, joints)| {
            let joints = joints.iter().map(Joint::to_core).collect::<PyResult<Vec<_>>>()?;
            Ok(Leg::new(name, joints))
        });
        let mechanism = Mechanism {
            name: name.to_owned(),
            legs: legs.collect::<PyResult<_>>()?,
            platform: Point3::new(platform.0, platform.1, platform.2),
            task: TaskHints::default(),
            bodies: BodyMasses::default(),
            shapes: Shapes::default(),
            units: FileUnits::SI,
        };
        Self::of_text(py, file::write(&mechanism, FileUnits::SI, Digits::All), name, tolerance)
    }

    /// The same mechanism with some joints changed.
    ///
    /// Parameters
    /// ----------
    /// changes : mapping of str to mapping
    ///     By the name of a joint, new values of the attributes of :class:`Joint`:
    ///     ``{"e1": {"point": (0.1, 0, 0), "limits": None}}``.
    ///
    /// Returns
    /// -------
    /// Manipulator
    ///     A new manipulator; this one does not change. Its `text` keeps what is not changed, where it can say the change.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     There is no such joint or attribute, or the changed mechanism is not valid.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("planar-3rpr").with_joints({"A2": {"point": (0.016, 0, 0)}})
    /// >>> m.legs["leg2"][0].point
    /// (0.016, 0.0, 0.0)
    fn with_joints(&self, py: Python<'_>, changes: &Bound<'_, PyMapping>) -> PyResult<Self> {
        let mut file = self.file();
        let items: Vec<(String, Bound<'_, PyDict>)> = changes.items()?.extract()?;
        for (name, changes) in items {
            let names: Vec<String> =
                file.mechanism.joints().map(|joint| joint.name.clone()).collect();
            let mut joints = file.mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
            let Some(joint) = joints.find(|joint| joint.name == name) else {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                return Err(wrong(format!(
                    "no joint {name:?}; {}",
                    expected_one_of(&name, &names)
                )));
            };
            let drives: Vec<_> = joint.coordinates.iter().map(|c| c.drive).collect();
            *joint = Joint::of(joint).with(&changes)?.to_core()?;
            joint.coordinates.iter_mut().zip(drives).for_each(|(c, drive)| c.drive = drive);
        }
        Self::of_text(py, file.text(), self.label(), None)
    }

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

impl Manipulator {
    /// The mechanism of a text that was made here: it is checked like any other, can be saved, and can be pickled.
    fn of_text(
        py: Python<'_>,
        text: String,
        label: &str,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let file = file::read(&text).map_err(|errors| {
            // Lines of that text would mean nothing.
            let problems = errors.problems.into_iter().map(|problem| problem.message);
            wrong(problems.collect::<Vec<_>>().join("; "))
        })?;
        let (file, text) = snap::within(py, (file, text), label, tolerance)?;
        Self::compile(file, text, label.to_owned())?.warned(py)
    }
}

fn place(point: &Point3<f64>) -> (f64, f64, f64) {
    (point.x, point.y, point.z)
}
