//! Mechanisms from joints as data, and their joints.

use crate::arguments::shown;
use crate::error::{failed, wrong};
use crate::joint::{Joint, place};
use crate::manipulator::Manipulator;
use crate::snap;
use nalgebra::Point3;
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::mechanism::file::{self, Digits, FileUnits};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{BodyMasses, Difference, Mechanism, Shapes, TaskHints};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

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
    /// differences : sequence of (str, str, float, float), optional
    ///     Limits of the differences of two joints, as :attr:`differences` has them.
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
    #[pyo3(signature = (legs, *, platform = [0.0; 3], differences = Vec::new(), name = "mechanism", tolerance = None))]
    fn from_joints(
        py: Python<'_>,
        legs: &Bound<'_, PyAny>,
        platform: [f64; 3],
        differences: Vec<(String, String, f64, f64)>,
        name: &str,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let named: Vec<(String, Vec<Joint>)> = match legs.cast::<PyMapping>() {
            Ok(mapping) => mapping.items()?.extract().map_err(|_| {
                let expected = "a sequence of joints for the name of each leg";
                wrong(format!("legs is {}, expected {expected}", shown(legs)))
            })?,
            Err(_) => {
                let legs: Vec<Vec<Joint>> = legs.extract().map_err(|_| {
                    let expected = "a sequence of joints for each leg";
                    wrong(format!("legs is {}, expected {expected}", shown(legs)))
                })?;
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
            platform: Point3::from(platform),
            differences: differences.into_iter().map(difference).collect(),
            task: TaskHints::default(),
            bodies: BodyMasses::default(),
            shapes: Shapes::default(),
            units: FileUnits::SI,
        };
        mechanism.joint_differences().map_err(|error| failed(&error))?;
        Self::of_text(py, file::write(&mechanism, FileUnits::SI, Digits::All), name, tolerance)
    }

    /// Limits of the differences of two joints: their names, and the lowest and the highest value of the first less the second,
    /// radians or metres.
    #[getter]
    fn differences(&self) -> Vec<(String, String, f64, f64)> {
        let each = self.inner.mechanism().differences.iter();
        each.map(|Difference { joints: [one, other], limits: [low, high] }| {
            (one.clone(), other.clone(), *low, *high)
        })
        .collect()
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
            *joint = Joint::of(joint).with(&changes)?.to_core()?;
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

/// Limits of a difference as Python gives them.
fn difference((one, other, low, high): (String, String, f64, f64)) -> Difference {
    Difference { joints: [one, other], limits: [low, high] }
}
