//! Manipulators from arrays of joint screws, and the screws of any manipulator.

use crate::arguments::shown;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::snap;
use nalgebra::{Point3, Vector3, Vector6};
use numpy::{AllowTypeChange, IntoPyArray, PyArrayLike2, PyArrayMethods, PyUntypedArrayMethods};
use opm_core::group::screw::Screw;
use opm_core::mechanism::file::{self, Digits, FileErrors, FileUnits};
use opm_core::mechanism::{Mechanism, ScrewJoint};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use std::ffi::CString;

/// A leg's name and the screws of its joints.
type Leg = (String, Vec<Screw>);

#[pymethods]
impl Manipulator {
    /// Compile a mechanism that is given by the screws of its joints at an assembled pose, home.
    ///
    /// It is decomposed like any other; `text` is an equivalent mechanism file.
    ///
    /// Parameters
    /// ----------
    /// legs : mapping of str to (n, 6) array_like, or sequence of them
    ///     One array for each leg, by name; without names the legs are leg1, leg2, ... A row is the twist (omega; v) of a
    ///     joint with one degree of freedom, in the base frame, from base to platform, of any length except zero:
    ///     ``(a, p × a + h a)`` rotates about ``a`` through ``p`` with an advance of ``h`` metres per radian, ``(0, a)``
    ///     slides along ``a``. A joint with several degrees of freedom has several rows. Numbers may be rounded, as those of
    ///     float32 are: an advance below one ten-thousandth of the mechanism's size is none.
    /// actuated : sequence of (n,) sequences of bool
    ///     Which joints are actuated: one sequence for each leg.
    /// home : sequence of (n,) sequences of float, optional
    ///     Joint values at home, radians and metres; zero if not given.
    /// limits : sequence of (n,) sequences of (float, float) or None, optional
    ///     Lowest and highest value of each joint. ``None``, or two infinite values, means no limits.
    /// joints : sequence of (n,) sequences of str, optional
    ///     Names of the joints; if not given, q1_1, q1_2, ... (number of the leg, then of the joint).
    /// platform : (3,) sequence of float
    ///     Reference point of the platform at home, metres; the base's origin if not given.
    /// name : str
    ///     Name of the mechanism.
    /// tolerance : float, optional
    ///     Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
    ///     count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
    ///     much it was off; `text` is then the corrected mechanism.
    ///
    /// Returns
    /// -------
    /// Manipulator
    ///     Decomposed and compiled.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Says what is wrong with which joint of which leg, or why the mechanism has no closed-form inverse kinematics.
    #[staticmethod]
    #[pyo3(signature = (
        legs, actuated, *, home = None, limits = None, joints = None, platform = [0.0; 3],
        name = "mechanism", tolerance = None,
    ))]
    // One a keyword of Python's.
    #[allow(clippy::too_many_arguments)]
    fn from_screws(
        py: Python<'_>,
        legs: &Bound<'_, PyAny>,
        actuated: &Bound<'_, PyAny>,
        home: Option<&Bound<'_, PyAny>>,
        limits: Option<&Bound<'_, PyAny>>,
        joints: Option<&Bound<'_, PyAny>>,
        platform: [f64; 3],
        name: &str,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let legs = read_legs(legs)?;
        let turned = halves_look_exchanged(&legs);
        let made = || {
            let actuated: Vec<Vec<bool>> = per_joint(actuated, "actuated", "bools", &legs)?;
            let home = home.map(|given| per_joint::<f64>(given, "home", "numbers", &legs));
            let home = home.transpose()?;
            let limits = limits.map(|given| per_joint(given, "limits", "pairs or None", &legs));
            let limits: Option<Vec<Vec<Option<[f64; 2]>>>> = limits.transpose()?;
            let names = joints.map(|given| per_joint::<String>(given, "joints", "names", &legs));
            let names = names.transpose()?;
            let joint = |leg: usize, joint: usize, screw: Screw| {
                let place = || place(&legs[leg].0, joint);
                let home = home.as_ref().map_or(0.0, |home| home[leg][joint]);
                if !home.is_finite() {
                    return Err(wrong(format!("{}: home is {home}, expected a number", place())));
                }
                let limits = match limits.as_ref().and_then(|limits| limits[leg][joint]) {
                    Some([f64::NEG_INFINITY, f64::INFINITY]) | None => None,
                    Some(pair) if pair.iter().all(|limit| limit.is_finite()) => Some(pair),
                    Some([low, high]) => {
                        return Err(wrong(format!(
                            "{}: limits are {low} and {high}, expected two numbers, or both infinite \
                         for none",
                            place()
                        )));
                    }
                };
                let name = match &names {
                    Some(names) => names[leg][joint].clone(),
                    None => format!("q{}_{}", leg + 1, joint + 1),
                };
                Ok(ScrewJoint { name, screw, actuated: actuated[leg][joint], home, limits })
            };
            let legs_of_joints = legs.iter().enumerate().map(|(number, (name, screws))| {
                let joints = screws.iter().enumerate();
                let joints = joints.map(|(i, &screw)| joint(number, i, screw));
                Ok((name.clone(), joints.collect::<PyResult<_>>()?))
            });
            let legs_of_joints = legs_of_joints.collect::<PyResult<Vec<_>>>()?;
            if let Some(odd) = platform.iter().find(|c| !c.is_finite()) {
                return Err(wrong(format!("platform has {odd} in it, expected a point [x, y, z]")));
            }
            let mechanism = Mechanism::from_screws(name, legs_of_joints, Point3::from(platform))
                .map_err(|(leg, joint, error)| {
                    wrong(format!("{}: {error}", place(&legs[leg].0, joint)))
                })?;
            // The mechanism goes through a file, so that it is checked like any other, can be saved, and can be pickled.
            let text = file::write(&mechanism, FileUnits::SI, Digits::All);
            let file = file::read(&text).map_err(|e| wrong(message(&e, &text, &legs)))?;
            let (file, text) = snap::within(py, (file, text), name, tolerance)?;
            Self::compile(file, text, name.to_owned())
        };
        let hint = "the rows of legs look like (v; omega), expected (omega; v)";
        match made() {
            Err(error) if turned => Err(wrong(format!("{}; {hint}", error.value(py)))),
            Err(error) => Err(error),
            Ok(made) => {
                if turned {
                    let text = CString::new(format!("{name}: {hint}"))?;
                    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
                }
                made.warned(py)
            }
        }
    }

    /// The joints' unit screws by leg, (f, 6) each: (omega; v) in base coordinates, as they are at home, one row for each degree of freedom.
    #[getter]
    fn screws<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for leg in &self.inner.mechanism().legs {
            let screws = leg.screws();
            let rows = screws.iter().flat_map(|screw| <[f64; 6]>::from(screw.to_vector()));
            let rows = rows.collect::<Vec<_>>().into_pyarray(py).reshape([screws.len(), 6])?;
            dict.set_item(&leg.name, rows)?;
        }
        Ok(dict)
    }
}

/// Whether the rows are twists with unit directions if their halves are exchanged, and are not as they are given.
fn halves_look_exchanged(legs: &[Leg]) -> bool {
    let unit = |vector: &Vector3<f64>| (vector.norm() - 1.0).abs() < 1e-6;
    let tells = |first: &Vector3<f64>, second: &Vector3<f64>| {
        unit(first) || (first.norm() == 0.0 && unit(second))
    };
    let all = |exchanged: bool| {
        legs.iter().flat_map(|(_, screws)| screws).all(|screw| match exchanged {
            true => tells(&screw.linear, &screw.angular),
            false => tells(&screw.angular, &screw.linear),
        })
    };
    all(true) && !all(false)
}

fn place(leg: &str, joint: usize) -> String {
    format!("{leg}, joint {}", joint + 1)
}

/// A mapping of names to arrays, or a sequence of arrays: `leg1`, `leg2`, ...
fn read_legs(given: &Bound<'_, PyAny>) -> PyResult<Vec<Leg>> {
    let named: Vec<(String, Bound<'_, PyAny>)> = match given.cast::<PyMapping>() {
        Ok(mapping) => mapping.items()?.extract()?,
        Err(_) => {
            let none = |_| {
                let expected = "an (n, 6) array of screws for each leg";
                wrong(format!("legs is {}, expected {expected}", shown(given)))
            };
            let arrays: Vec<_> = given.try_iter().map_err(none)?.collect::<PyResult<_>>()?;
            arrays.into_iter().enumerate().map(|(i, leg)| (format!("leg{}", i + 1), leg)).collect()
        }
    };
    let read = |(name, rows): (String, Bound<'_, PyAny>)| {
        let expected = "expected an (n, 6) array of screws (omega; v), a row a joint";
        let array = rows.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>();
        let array = array.map_err(|_| wrong(format!("{name} is {}, {expected}", shown(&rows))))?;
        let [joints, width] = [array.shape()[0], array.shape()[1]];
        if width != 6 || joints == 0 {
            return Err(wrong(format!("{name} has shape ({joints}, {width}), {expected}")));
        }
        let rows = array.as_array();
        let screw = |row| Screw::from_vector(&Vector6::from_fn(|i, _| rows[[row, i]]));
        Ok((name, (0..joints).map(screw).collect()))
    };
    named.into_iter().map(read).collect()
}

/// One sequence for each leg, with one entry for each joint.
fn per_joint<'py, T: FromPyObjectOwned<'py>>(
    given: &Bound<'py, PyAny>,
    what: &str,
    entries: &str,
    legs: &[Leg],
) -> PyResult<Vec<Vec<T>>> {
    let expected = |found: String| wrong(format!("{what}: {found}"));
    let of_legs: Vec<Bound<'py, PyAny>> = given.extract().map_err(|_| {
        let sequences = "expected a sequence for each leg, with an entry for each joint";
        expected(format!("{}, {sequences}", shown(given)))
    })?;
    if of_legs.len() != legs.len() {
        let (found, legs) = (of_legs.len(), legs.len());
        return Err(expected(format!("{found} sequences, expected {legs}, one for each leg")));
    }
    let read = |(given, (name, screws)): (Bound<'py, PyAny>, &Leg)| {
        let joints = screws.len();
        let list: Vec<T> = given.extract().map_err(|_| {
            let given = given.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
            expected(format!("{given} of {name}, expected {joints} {entries}, one for each joint"))
        })?;
        if list.len() != joints {
            let found = list.len();
            return Err(expected(format!(
                "{found} of {name}, expected {joints}, one for each joint"
            )));
        }
        Ok(list)
    };
    of_legs.into_iter().zip(legs).map(read).collect()
}

/// The problems of a generated file, with the joints concerned instead of lines.
fn message(errors: &FileErrors, text: &str, legs: &[Leg]) -> String {
    let (mut leg, mut joint) = (0, 0);
    let places: Vec<String> = text
        .lines()
        .map(|line| {
            if line == "[[leg]]" {
                (leg, joint) = (leg + 1, 0);
            } else if line.starts_with("  {") {
                joint += 1;
            }
            match (leg, joint) {
                (0, _) => "mechanism".to_owned(),
                (leg, 0) => legs[leg - 1].0.clone(),
                (leg, joint) => place(&legs[leg - 1].0, joint - 1),
            }
        })
        .collect();
    let problems = errors.problems.iter();
    let lines = problems.map(|problem| {
        let place = places.get(problem.line - 1).map_or("mechanism", String::as_str);
        format!("{place}: {}", problem.message)
    });
    lines.collect::<Vec<_>>().join("\n")
}
