//! Linkages: the positions of a single loop, moved by one of its joints.

use crate::arguments;
use crate::error::{failed, wrong};
use crate::pickle::frozen;
use crate::rows::{Rows, Tables};
use crate::snap;
use crate::solutions::{Names, Solutions};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use opm_core::linkage::{self as core, Input, InputRange};
use opm_core::mechanism::Mechanism;
use opm_export::{Keyframes, mjcf};
use pyo3::prelude::*;
use std::f64::consts::PI;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// A single loop of two legs with one freedom, moved by one of its joints: four-bars, RSSR, Bennett's linkage, any.
///
/// Loops of two sections, which share an imaginary joint, are solved in closed form. All others are traced.
///
/// Immutable; it can be pickled, and shared between threads.
///
/// Examples
/// --------
/// >>> import opm_kinematics as opm
/// >>> bennett = opm.examples.bennett()
/// >>> positions = bennett.positions([0.5], input="a1")
/// >>> positions.modes, positions["tau"].shape
/// (['+ +', '+ -', '- +', '- -'], (1, 4))
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Linkage {
    inner: core::Linkage,
    text: String,
    label: String,
}

#[pymethods]
impl Linkage {
    /// Read a mechanism file.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     TOML. Shipped linkages are read by :func:`examples.linkage`.
    /// tolerance : float, optional
    ///     Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
    ///     count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
    ///     much it was off; `text` is then the corrected mechanism.
    ///
    /// Returns
    /// -------
    /// Linkage
    ///     Decomposed and compiled.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be read. If it does not exist, this is a FileNotFoundError with its name.
    /// OpmError
    ///     Lists every problem of the file with its line and column, or says why it is not a single loop with one freedom.
    #[staticmethod]
    #[pyo3(signature = (path, *, tolerance = None))]
    fn load(
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let (text, label) = arguments::mechanism(py, &path, "opm.examples.text")?;
        Self::parse(py, text, Some(label), tolerance)
    }

    /// Read the text of a mechanism file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     TOML.
    /// label : str, optional
    ///     The name that messages use for the text.
    /// tolerance : float, optional
    ///     Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
    ///     count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
    ///     much it was off; `text` is then the corrected mechanism.
    ///
    /// Returns
    /// -------
    /// Linkage
    ///     Decomposed and compiled.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Lists every problem of the text with its line and column, or says why it is not a single loop with one freedom.
    #[staticmethod]
    #[pyo3(signature = (text, label = None, *, tolerance = None))]
    fn parse(
        py: Python<'_>,
        text: String,
        label: Option<String>,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let label = label.unwrap_or_else(|| "mechanism".to_owned());
        let (read, text) = snap::read(py, text, &label, tolerance)?;
        let inner = core::Linkage::new(&read.mechanism).map_err(|error| failed(&error))?;
        Ok(Self { inner, text, label })
    }

    /// Linkages are equal if the texts of their files are equal, whatever the names of the files.
    fn __eq__(&self, other: &Self) -> bool {
        self.text == other.text
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.text.hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let this = slf.get();
        Ok((slf.get_type().getattr("parse")?, (this.text.clone(), this.label.clone())))
    }

    /// The mechanism's name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.mechanism().name
    }

    /// The mechanism file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Names of all joint coordinates: the columns of joint values.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.inner.coordinates().iter().map(|c| c.name.clone()).collect()
    }

    /// Name of the imaginary joint, which two sections share; None of a loop that is traced.
    #[getter]
    fn imaginary_name(&self) -> Option<&str> {
        self.inner.imaginary().first().map(|joint| &*joint.name)
    }

    /// (k,): every joint at home, radians and metres.
    #[getter]
    fn home(&self) -> Vec<f64> {
        self.inner.coordinates().iter().map(|c| c.home).collect()
    }

    /// The branch in which the linkage is assembled, if one of its joints moves it.
    ///
    /// Parameters
    /// ----------
    /// input : str, optional
    ///     Name of the joint; the actuated one if not given.
    ///
    /// Returns
    /// -------
    /// str
    ///     Two signs, of a loop of two sections: the first for the loop with the input, the second for the other one. A loop
    ///     without a choice has +. Of a traced loop it is "1": branches are numbered along the motion from home.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     There is no joint of this name that can move the linkage.
    #[pyo3(signature = (input = None))]
    fn home_branch(&self, input: Option<&str>) -> PyResult<String> {
        Ok(self.input(input)?.home_branch().to_string())
    }

    /// The range of one joint in which the loop closes, joint limits not considered.
    ///
    /// Parameters
    /// ----------
    /// input : str, optional
    ///     Name of the joint; the actuated one if not given.
    ///
    /// Returns
    /// -------
    /// (r, 2) array
    ///     Lowest and highest value of every interval, radians or metres; infinite where a slider has no end. A full revolution
    ///     is given as the interval around home.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     There is no joint of this name that can move the linkage.
    #[pyo3(signature = (input = None))]
    fn range(&self, py: Python<'_>, input: Option<&str>) -> PyResult<Py<PyArray2<f64>>> {
        let input = self.input(input)?;
        let home = input.coordinate().home;
        let parts = match input.range() {
            InputRange::FullTurn => vec![[home - PI, home + PI]],
            InputRange::Intervals { intervals, .. } => intervals,
        };
        let ends = PyArray1::from_slice(py, parts.as_flattened());
        frozen(ends.reshape([parts.len(), 2])?)
    }

    /// Every position for many values of one joint, in all branches.
    ///
    /// Parameters
    /// ----------
    /// values : float or (...) array_like
    ///     Values of the joint that moves the linkage, radians or metres. The arrays of the result begin with their axes. Where
    ///     a value is NaN, so is the position.
    /// input : str, optional
    ///     Name of that joint; the actuated one if not given.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Solutions
    ///     The arrays have the shapes ``(..., b, k)``, ``(..., b, i)`` and ``(..., b)``, with the b branches as modes: four of a loop
    ///     of two sections, which has i = 1 imaginary joint; a traced loop has none. NaN where the loop does not close. Angles are within π of their home values, unless the joint limits allow another revolution;
    ///     ``np.unwrap`` along the first axis makes angles over full revolutions continuous.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     There is no joint of this name, or a value is infinite; the message gives its index, counted from zero.
    #[pyo3(signature = (values, *, input = None, threads = None))]
    fn positions(
        &self,
        py: Python<'_>,
        values: &Bound<'_, PyAny>,
        input: Option<&str>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Solutions> {
        let input = self.input(input)?;
        let given = arguments::column(values, "values")?;
        let values = Rows::new(&given)?;
        if let Some(number) = values.values().iter().position(|value| value.is_infinite()) {
            let value = values.values()[number];
            return Err(wrong(format!("value {number} is {value}, expected a finite number")));
        }
        let branches = input.branches();
        let tables = Tables::fill(
            py,
            values.count * branches.len(),
            [self.inner.coordinates().len(), self.inner.imaginary().len()],
            threads,
            || input.home(),
            |position, row, [joints, imaginary]| {
                let (value, branch) =
                    (values.values()[row / branches.len()], branches[row % branches.len()]);
                if value.is_nan() || !input.position(value, branch, position) {
                    return Ok([false; 2]);
                }
                joints.copy_from_slice(&position.joints);
                imaginary.iter_mut().zip(position.imaginary).for_each(|(to, from)| *to = from);
                Ok([true, position.within_limits])
            },
        )?;
        Solutions::of_all_modes(Names::of_branches(&self.inner, &branches), &values, tables)
    }

    /// The mechanism as a model of MuJoCo (MJCF), with its closed loops: the text of an XML file.
    ///
    /// Joints have the names and the values of `joints`; the platform is the body ``platform``. Each actuated joint has a
    /// position servo of its name, and each branch with the input at home a keyframe, named by its
    /// signs or its number: ``p_m`` is ``+ -``, ``branch1`` is 1. It is the file that ``opm export mjcf`` writes.
    ///
    /// Parameters
    /// ----------
    /// density : float, optional
    ///     Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
    ///     2700, if not given.
    /// time_step : float
    ///     Time step of the simulation, seconds; the loops are held as stiffly as it allows.
    ///
    /// Returns
    /// -------
    /// str
    ///     For ``mujoco.MjModel.from_xml_string``, or a file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A number is not positive.
    #[pyo3(signature = (*, density = None, time_step = 0.001))]
    fn to_mjcf(&self, py: Python<'_>, density: Option<f64>, time_step: f64) -> PyResult<String> {
        let options = arguments::mjcf_options(density, time_step)?;
        Ok(py.detach(|| mjcf(&Keyframes::of(self.inner.mechanism()), &options)))
    }

    fn __repr__(&self) -> String {
        format!("<Linkage {}: {} joints>", self.name(), self.inner.coordinates().len())
    }
}

impl Linkage {
    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        self.inner.mechanism()
    }

    /// The input joint of this name, or the actuated joint.
    fn input(&self, name: Option<&str>) -> PyResult<Input<'_>> {
        let actuated = || {
            let joint = self.inner.mechanism().joints().find(|joint| joint.actuated);
            joint.map_or("", |joint| &joint.coordinates[0].name)
        };
        let name = name.unwrap_or_else(actuated);
        let known = || self.inner.inputs().collect::<Vec<_>>().join(", ");
        let unknown = || wrong(format!("input is {name:?}, expected one of {}", known()));
        self.inner.input(name).ok_or_else(unknown)
    }
}
