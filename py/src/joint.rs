//! One joint of a mechanism as data.

use crate::arguments::shown;
use crate::error::wrong;
use crate::pickle::pickled;
use nalgebra::{Point3, Unit, Vector3};
use opm_core::mechanism::Cone;
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::mechanism::joint::{self as core, Drive};
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Vector = (f64, f64, f64);

/// Half the angle of a cone, and its axis if that is given.
type JointTilt = (f64, Option<Vector>);

/// A joint of a leg at home, in base coordinates. Its lists have an entry for each of its coordinates: one, two or three.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Joint {
    /// Name of the joint.
    name: String,
    /// ``"revolute"``, ``"prismatic"``, ``"helical"``, ``"cylindrical"``, ``"universal"`` or ``"spherical"``.
    kind: String,
    /// Unit vector along the axis; None for a spherical joint.
    axis: Option<Vector>,
    /// Unit vector along a universal joint's axis next to the platform; None for others.
    axis2: Option<Vector>,
    /// A point of the axis, metres; the centre of a universal or spherical joint; where a prismatic joint is drawn.
    point: Vector,
    /// Advance of a helical joint, metres per radian; None for others.
    pitch: Option<f64>,
    /// Whether a motor drives it.
    actuated: bool,
    /// Whether it turns back what the joint before it turned: the two are the hinges of a parallelogram.
    turns_back: bool,
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
    /// The inertia of the actuator's rotor, kg m²; 0 if nothing is given.
    rotor_inertia: Vec<f64>,
    /// How much faster than the joint the rotor turns; of a length, radians per metre; 1 if nothing is given.
    gear: Vec<f64>,
    /// The friction in proportion to the rate, N m s/rad or N s/m; 0 if nothing is given.
    viscous_friction: Vec<f64>,
    /// The friction against the motion whatever the rate is, N m or N; 0 if nothing is given.
    coulomb_friction: Vec<f64>,
}

pickled!(Joint {
    name,
    kind,
    axis,
    axis2,
    point,
    pitch,
    actuated,
    turns_back,
    coordinates,
    units,
    home,
    limits,
    max_rate,
    max_acceleration,
    max_effort,
    cone,
    rotor_inertia,
    gear,
    viscous_friction,
    coulomb_friction,
});

impl Joint {
    pub fn of(joint: &core::Joint) -> Self {
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
            turns_back: joint.turns_back,
            coordinates: each().map(|c| c.name.clone()).collect(),
            units: each().map(|c| c.quantity.unit().to_owned()).collect(),
            home: each().map(|c| c.home).collect(),
            limits: each().map(|c| c.limits.map(|[low, high]| (low, high))).collect(),
            max_rate: each().map(|c| c.motion_limits.max_rate).collect(),
            max_acceleration: each().map(|c| c.motion_limits.max_acceleration).collect(),
            max_effort: each().map(|c| c.max_effort).collect(),
            cone: joint.cone.map(|cone| (cone.half_angle, cone.axis.map(|axis| direction(&axis)))),
            rotor_inertia: each().map(|c| c.drive.rotor_inertia).collect(),
            gear: each().map(|c| c.drive.gear).collect(),
            viscous_friction: each().map(|c| c.drive.viscous_friction).collect(),
            coulomb_friction: each().map(|c| c.drive.coulomb_friction).collect(),
        }
    }

    /// The joint of a mechanism, if its directions are some.
    pub fn to_core(&self) -> PyResult<core::Joint> {
        let told = |problem: String| wrong(format!("joint {}: {problem}", self.name));
        let direction = |what: &str, given: Option<Vector>| match given {
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
        joint.turns_back = self.turns_back;
        let count = joint.coordinates.len();
        let lengths = [
            ("home", self.home.len()),
            ("limits", self.limits.len()),
            ("max_rate", self.max_rate.len()),
            ("max_acceleration", self.max_acceleration.len()),
            ("max_effort", self.max_effort.len()),
            ("rotor_inertia", self.rotor_inertia.len()),
            ("gear", self.gear.len()),
            ("viscous_friction", self.viscous_friction.len()),
            ("coulomb_friction", self.coulomb_friction.len()),
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
            c.drive = Drive {
                rotor_inertia: self.rotor_inertia[number],
                gear: self.gear[number],
                viscous_friction: self.viscous_friction[number],
                coulomb_friction: self.coulomb_friction[number],
            };
        }
        if let Some((half_angle, axis)) = self.cone {
            let axis = axis.map(|axis| direction("the cone's axis", Some(axis))).transpose()?;
            joint.cone = Some(Cone { half_angle, axis });
        }
        Ok(joint)
    }

    /// The same joint with other attributes.
    pub fn with(&self, changes: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut joint = self.clone();
        for (key, value) in changes {
            joint.set(&key.extract::<String>()?, &value)?;
        }
        Ok(joint)
    }

    /// Sets one attribute.
    fn set(&mut self, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        const KEYS: [&str; 16] = [
            "axis",
            "axis2",
            "point",
            "pitch",
            "actuated",
            "turns_back",
            "home",
            "limits",
            "max_rate",
            "max_acceleration",
            "max_effort",
            "cone",
            "rotor_inertia",
            "gear",
            "viscous_friction",
            "coulomb_friction",
        ];
        let count = self.home.len();
        let given = Attribute { joint: &self.name, key, value };
        let number = || given.each(count, None, NUMBER, |one| one.extract().map(Some));
        let number_or = |other: f64| given.each(count, other, NUMBER, |one| one.extract());
        match key {
            "axis" => self.axis = given.vector()?,
            "axis2" => self.axis2 = given.vector()?,
            "point" => self.point = given.vector()?.unwrap_or_default(),
            "pitch" => self.pitch = given.read("a number, or None", |value| value.extract())?,
            "actuated" => self.actuated = given.read("True or False", |value| value.extract())?,
            "turns_back" => {
                self.turns_back = given.read("True or False", |value| value.extract())?;
            }
            "home" => self.home = number_or(0.0)?,
            "limits" => {
                let pair = |one: &Bound<'_, PyAny>| Ok(Some(one.extract::<[f64; 2]>()?.into()));
                self.limits = given.each(count, None, "(lowest, highest)", pair)?;
            }
            "max_rate" => self.max_rate = number()?,
            "max_acceleration" => self.max_acceleration = number()?,
            "max_effort" => self.max_effort = number()?,
            "cone" => self.cone = given.cone()?,
            "rotor_inertia" => self.rotor_inertia = number_or(0.0)?,
            "gear" => self.gear = number_or(1.0)?,
            "viscous_friction" => self.viscous_friction = number_or(0.0)?,
            "coulomb_friction" => self.coulomb_friction = number_or(0.0)?,
            _ => return Err(wrong(expected_one_of(key, &KEYS))),
        }
        Ok(())
    }
}

const NUMBER: &str = "a number";

/// What is given for an attribute of a joint.
#[derive(Clone, Copy)]
struct Attribute<'a, 'py> {
    joint: &'a str,
    key: &'a str,
    value: &'a Bound<'py, PyAny>,
}

impl<'py> Attribute<'_, 'py> {
    fn read<T>(
        self,
        expected: &str,
        read: impl Fn(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<T> {
        read(self.value).map_err(|_| {
            let (joint, key, found) = (self.joint, self.key, shown(self.value));
            wrong(format!("joint {joint}: {key} is {found}, expected {expected}"))
        })
    }

    /// Three numbers, or None.
    fn vector(self) -> PyResult<Option<Vector>> {
        let three = |value: &Bound<'py, PyAny>| value.extract::<Option<[f64; 3]>>();
        Ok(self.read("three numbers", three)?.map(Into::into))
    }

    /// One value for the only coordinate, or a sequence with one for each; None is `otherwise`, for one of them or for all.
    fn each<T: Clone>(
        self,
        count: usize,
        otherwise: T,
        what: &str,
        read: impl Fn(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<Vec<T>> {
        let or_none = |one: &Bound<'py, PyAny>| match one.is_none() {
            true => Ok(otherwise.clone()),
            false => read(one),
        };
        let expected = match count {
            1 => format!("{what}, or None"),
            _ => format!("{count} values, each {what} or None"),
        };
        self.read(&expected, |value| {
            if value.is_none() {
                return Ok(vec![otherwise.clone(); count]);
            }
            if count == 1
                && let Ok(one) = read(value)
            {
                return Ok(vec![one]);
            }
            let all = value.try_iter()?.map(|one| or_none(&one?)).collect::<PyResult<Vec<_>>>()?;
            let enough = (all.len() == count).then_some(all);
            enough.ok_or_else(|| wrong("another number of values"))
        })
    }

    /// A cone: half its angle, or that and its axis.
    fn cone(self) -> PyResult<Option<JointTilt>> {
        self.read("half an angle, or that and an axis, or None", |value| {
            if value.is_none() {
                return Ok(None);
            }
            if let Ok(angle) = value.extract::<f64>() {
                return Ok(Some((angle, None)));
            }
            let (angle, axis): (f64, Option<[f64; 3]>) = value.extract()?;
            Ok(Some((angle, axis.map(Into::into))))
        })
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
    /// turns_back : bool
    ///     Whether it turns back what the joint before it turned: the two are the hinges of a parallelogram.
    /// home : float or sequence of float, optional
    ///     The value at home, metres or radians; one for each coordinate. Zero if not given.
    /// limits : (float, float) or sequence of them, optional
    ///     The lowest and the highest value; a pair for each coordinate.
    /// max_rate, max_acceleration, max_effort : float or sequence of float, optional
    ///     The largest rate, acceleration and effort, SI.
    /// rotor_inertia, gear : float or sequence of float, optional
    ///     Of an actuated joint: the inertia of the rotor, kg m², and how much faster than the joint it turns; of a length, radians
    ///     per metre. Zero and one if not given.
    /// viscous_friction, coulomb_friction : float or sequence of float, optional
    ///     Friction in proportion to the rate, N m s/rad or N s/m, and against it whatever the rate is, N m or N.
    /// cone : float or (float, (float, float, float)), optional
    ///     Of a universal or spherical joint: how far its rod may tilt, radians, and from which direction.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The kind is unknown, or lacks an axis or a pitch.
    #[new]
    #[pyo3(signature = (
        name, kind, *, axis = None, point = None, axis2 = None, pitch = None, actuated = false, turns_back = false,
        home = None, limits = None, max_rate = None, max_acceleration = None, max_effort = None, cone = None,
        rotor_inertia = None, gear = None, viscous_friction = None, coulomb_friction = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        name: String,
        kind: String,
        axis: Option<&Bound<'_, PyAny>>,
        point: Option<&Bound<'_, PyAny>>,
        axis2: Option<&Bound<'_, PyAny>>,
        pitch: Option<&Bound<'_, PyAny>>,
        actuated: bool,
        turns_back: bool,
        home: Option<&Bound<'_, PyAny>>,
        limits: Option<&Bound<'_, PyAny>>,
        max_rate: Option<&Bound<'_, PyAny>>,
        max_acceleration: Option<&Bound<'_, PyAny>>,
        max_effort: Option<&Bound<'_, PyAny>>,
        cone: Option<&Bound<'_, PyAny>>,
        rotor_inertia: Option<&Bound<'_, PyAny>>,
        gear: Option<&Bound<'_, PyAny>>,
        viscous_friction: Option<&Bound<'_, PyAny>>,
        coulomb_friction: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let count = match &*kind {
            "cylindrical" | "universal" => 2,
            "spherical" => 3,
            _ => 1,
        };
        let mut joint = Self {
            name,
            kind,
            axis: None,
            axis2: None,
            point: Vector::default(),
            pitch: None,
            actuated,
            turns_back,
            coordinates: Vec::new(),
            units: Vec::new(),
            home: vec![0.0; count],
            limits: vec![None; count],
            max_rate: vec![None; count],
            max_acceleration: vec![None; count],
            max_effort: vec![None; count],
            cone: None,
            rotor_inertia: vec![0.0; count],
            gear: vec![1.0; count],
            viscous_friction: vec![0.0; count],
            coulomb_friction: vec![0.0; count],
        };
        for (key, given) in [
            ("axis", axis),
            ("axis2", axis2),
            ("point", point),
            ("pitch", pitch),
            ("home", home),
            ("limits", limits),
            ("max_rate", max_rate),
            ("max_acceleration", max_acceleration),
            ("max_effort", max_effort),
            ("cone", cone),
            ("rotor_inertia", rotor_inertia),
            ("gear", gear),
            ("viscous_friction", viscous_friction),
            ("coulomb_friction", coulomb_friction),
        ] {
            given.map_or(Ok(()), |given| joint.set(key, given))?;
        }
        Ok(Self::of(&joint.to_core()?))
    }

    fn __repr__(&self) -> String {
        let actuated = if self.actuated { ", actuated" } else { "" };
        format!("<Joint {}: {}{actuated}>", self.name, self.kind)
    }
}

/// A point as Python has it.
pub fn place(point: &Point3<f64>) -> Vector {
    (point.x, point.y, point.z)
}
