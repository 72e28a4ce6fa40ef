//! Manipulators: from files, their decomposition, and inverse kinematics of arrays of poses.

use crate::arguments::{self, mjcf_options};
use crate::decomposition::Decomposition;
use crate::error::{failed, wrong};
use crate::explorer::{self, Explorer};
use crate::given::{Columns, Given};
use crate::html;
use crate::matrices::matrices;
use crate::one::{Memories, plain};
use crate::pickle::pickled;
use crate::place::placement;
use crate::restored;
use crate::rows::{Rows, Tables, no_memory};
use crate::snap;
use crate::solutions::{CommonNames, Names, Solutions};
use opm_core::decomposition::doubts;
use opm_core::decomposition::mobility::mobility;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{self as core, Mode};
use opm_core::mechanism::OrientationCoordinates;
use opm_core::mechanism::examples as shipped;
use opm_core::mechanism::family::{Family, ParameterValue};
use opm_core::mechanism::file::{FileUnits, Locations, MechanismFile, NamedValue};
use opm_core::task;
use opm_export::{Keyframes, mjcf};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyDictMethods, PyIterator, PyMapping};
use std::ffi::CString;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// A mechanism, decomposed and compiled for closed-form inverse kinematics.
///
/// Immutable; it can be pickled, and shared between threads.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Manipulator {
    pub inner: Arc<core::Manipulator>,
    /// The mechanism file. After :meth:`with_parameters` it is in metres and radians and gives equal results to the bit.
    text: OnceLock<String>,
    label: String,
    /// What it was assembled from; `None` for a list of joints.
    pub family: Option<Family>,
    /// The file, if it has named parameters.
    named: Option<Arc<MechanismFile>>,
    names: OnceLock<CommonNames>,
    pub memories: Memories,
}

impl PartialEq for Manipulator {
    fn eq(&self, other: &Self) -> bool {
        self.text() == other.text()
    }
}

/// One coordinate of the pose.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
#[derive(Clone)]
pub struct TaskCoordinate {
    /// Name of the coordinate: ``"x"``, ``"zeta"``, ...
    name: String,
    /// The value at home, metres or radians.
    home: f64,
    /// ``"m"`` or ``"rad"``.
    unit: String,
}

impl TaskCoordinate {
    fn of(c: &task::TaskCoordinate) -> Self {
        Self { name: c.name.into(), home: c.home, unit: c.quantity.unit().to_owned() }
    }
}

#[pymethods]
impl TaskCoordinate {
    fn __repr__(&self) -> String {
        format!("TaskCoordinate({:?}, home={:?}, unit={:?})", self.name, self.home, self.unit)
    }
}

pickled!(TaskCoordinate { name, home, unit });

/// Names of the mechanisms that come with the package.
///
/// Returns
/// -------
/// list of str
///     For :func:`example`.
#[pyfunction]
pub fn examples() -> Vec<&'static str> {
    shipped::EXAMPLES.iter().map(|example| example.name).collect()
}

/// The text of one of the mechanisms of :func:`examples`.
///
/// Parameters
/// ----------
/// name : str
///     One of :func:`examples`.
///
/// Returns
/// -------
/// str
///     The mechanism file.
///
/// Raises
/// ------
/// OpmError
///     There is no example of this name.
#[pyfunction]
pub fn example(name: &str) -> PyResult<&'static str> {
    let known = || examples().join(", ");
    let found = shipped::find(name).map(|example| example.text);
    found.ok_or_else(|| wrong(format!("{name}: no such example; there are {}", known())))
}

#[pymethods]
impl Manipulator {
    /// Read a mechanism file.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     TOML. Shipped mechanisms are read by :func:`examples.load`.
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
    /// OSError
    ///     The file cannot be read. If it does not exist, this is a FileNotFoundError with its name.
    /// OpmError
    ///     Lists every problem of the file with its line and column, or says why it has no closed-form inverse kinematics.
    #[staticmethod]
    #[pyo3(signature = (path, *, tolerance = None))]
    fn load(
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let (text, label) = arguments::mechanism(py, &path, "opm.examples.load")?;
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
    /// Manipulator
    ///     Decomposed and compiled.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Lists every problem of the text with its line and column, or says why it has no closed-form inverse kinematics.
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
        Self::compile(read, text, label)?.warned(py)
    }

    /// The named parameters of its file, and the geometric parameters of its family, by name; empty for a list of joints that
    /// names none.
    ///
    /// A parameter of the table ``[parameters]`` has its own name; a point is ``(x, y, z)``. In a family, ``home.x`` is a coordinate of home, ``leg1.h`` a parameter of the leg of this name, ``leg1.limits.S`` the limits of one
    /// of its joints, ``leg1.max_rate.S`` and ``leg1.max_acceleration.S`` those of its motion, ``leg1.max_effort.S`` that of its
    /// actuator, ``leg1.offset.S`` the offset of its encoder. Values are in metres, radians, seconds and newtons. A point is ``(x, y)``; limits are ``(lowest, highest)``, or None if there are none, and so is an offset.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for parameter in self.named.iter().flat_map(|file| &file.parameters) {
            match parameter.value {
                NamedValue::Number(value) => dict.set_item(&parameter.name, value)?,
                NamedValue::Point([x, y, z]) => dict.set_item(&parameter.name, (x, y, z))?,
            }
        }
        for (name, value) in self.family.iter().flat_map(Family::parameters) {
            match value {
                ParameterValue::None => dict.set_item(name, py.None())?,
                ParameterValue::Number(value) => dict.set_item(name, value)?,
                ParameterValue::Pair([a, b]) => dict.set_item(name, (a, b))?,
            }
        }
        Ok(dict)
    }

    /// The same mechanism with some of its :attr:`parameters` changed, or homes and limits of a list of joints: assembled, decomposed and compiled anew.
    ///
    /// Parameters
    /// ----------
    /// changes : mapping, optional
    ///     New values by name, in metres, radians, or as they are for numbers without a unit. A parameter of the file changes
    ///     everything that the file gives by it. In a family, a name without its leg (``h``, ``limits.S``) sets the parameter in every leg that has it; a
    ///     full name (``leg1.h``) sets it in one leg and takes precedence. In a list of joints, ``S1.limits``,
    ///     ``S1.max_rate``, ``S1.max_acceleration``, ``S1.max_effort`` and ``S1.home`` are those of one joint coordinate, and
    ///     ``limits`` those of all joints that have any.
    /// **named
    ///     New values for names without dots.
    ///
    /// Returns
    /// -------
    /// Manipulator
    ///     A new manipulator, assembled at the same home pose in the same working mode; this one does not change.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A name is not a parameter (the message lists those that exist), a value is not valid, a leg does not reach home, or
    ///     the home pose is singular. The message lists every such problem.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("plano-spherical-5dof")
    /// >>> longer = m.with_parameters({"leg1.h": 0.13, "limits.S": (-0.25, 0.25)}, a2=0.05)
    /// >>> longer.parameters["leg1.h"], longer.parameters["leg2.h"], longer.parameters["leg2.a2"]
    /// (0.13, 0.12, 0.05)
    #[pyo3(signature = (changes = None, /, **named))]
    fn with_parameters(
        &self,
        py: Python<'_>,
        changes: Option<&Bound<'_, PyMapping>>,
        named: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut values: Vec<(String, ParameterValue)> = Vec::new();
        let named = named.map(PyDictMethods::as_mapping);
        for given in changes.into_iter().chain(named) {
            for item in given.items()? {
                let (name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
                let Ok(name) = name.extract::<String>() else {
                    return Err(wrong(format!("{} is not the name of a parameter", name.repr()?)));
                };
                if values.iter().any(|(other, _)| *other == name) {
                    return Err(wrong(format!("`{name}` is given twice")));
                }
                let value = parameter(&name, &value)?;
                values.push((name, value));
            }
        }
        py.detach(|| {
            let changes = values.iter().map(|(name, value)| (name.as_str(), *value));
            self.changed(self.file().with(changes).map_err(|e| failed(&e))?)
        })
    }

    /// The same mechanism with other angles for its orientation.
    ///
    /// Parameters
    /// ----------
    /// coordinates : str
    ///     ``"euler-angles"``: ``zeta xi psi``, R = Rz(zeta) Ry(xi) Rz(psi). ``"tilt-torsion"``: ``azimuth tilt torsion``,
    ///     R = Rz(azimuth) Ry(tilt) Rz(torsion - azimuth), with the tilt from 0 to pi. Where that is 0 or pi, the azimuth is
    ///     free: :meth:`locate` takes that at home. ``"roll-pitch-yaw"``: ``roll pitch yaw``, R = Rz(yaw) Ry(pitch) Rx(roll).
    ///
    /// Returns
    /// -------
    /// Manipulator
    ///     A new manipulator; this one does not change.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The name is unknown, or the pose has no Euler angles.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("plano-spherical-5dof").with_coordinates("tilt-torsion")
    /// >>> [c.name for c in m.task_coordinates]
    /// ['x', 'y', 'azimuth', 'tilt', 'torsion']
    fn with_coordinates(&self, py: Python<'_>, coordinates: &str) -> PyResult<Self> {
        let Some(chosen) = OrientationCoordinates::from_name(coordinates) else {
            let [first, second, third] =
                OrientationCoordinates::NAMED.map(|(name, _)| format!("{name:?}"));
            return Err(wrong(format!(
                "coordinates is {coordinates:?}, expected {first}, {second} or {third}"
            )));
        };
        let mut file = self.file();
        file.mechanism.task.coordinates = Some(chosen);
        py.detach(|| self.changed(file))
    }

    /// Mechanisms are equal if the texts of their files are equal, whatever the names of the files.
    fn __eq__(&self, other: &Self) -> bool {
        self == other
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.text().hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let this = slf.get();
        Ok((slf.get_type().getattr("_restored")?, (this.text().to_owned(), this.label.clone())))
    }

    /// What a pickle holds is its file. A process decomposes each file once, also for thousands of pickles.
    #[staticmethod]
    fn _restored(py: Python<'_>, text: String, label: String) -> PyResult<Self> {
        if let Some(known) = restored::find(&text) {
            return Ok(known.labelled(label));
        }
        // Whoever read the file was warned.
        let (file, text) = snap::unwarned(text, &label)?;
        let made = py.detach(|| Self::compile(file, text, label))?;
        restored::keep(&made);
        Ok(made)
    }

    /// Itself: it is immutable.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    /// Itself: it is immutable.
    fn __deepcopy__(slf: Py<Self>, memo: &Bound<'_, PyAny>) -> Py<Self> {
        let _ = memo;
        slf
    }

    /// The mechanism's name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.mechanism().name
    }

    /// The mechanism file. After :meth:`with_parameters` it is in metres and radians and gives equal results to the bit; a file
    /// with named parameters stays as it was typed, but for their numbers.
    #[getter]
    pub fn text(&self) -> &str {
        self.text.get_or_init(|| self.file().text())
    }

    /// The coordinates of the pose: the columns of poses.
    #[getter]
    fn task_coordinates(&self) -> Vec<TaskCoordinate> {
        self.inner.task_coordinates().iter().map(TaskCoordinate::of).collect()
    }

    /// The coordinates that follow from those of the pose, because a leg with few freedoms ties them together; none in most
    /// mechanisms. :meth:`dependent` gives their values.
    #[getter]
    fn dependent_coordinates(&self) -> Vec<TaskCoordinate> {
        self.inner.dependent_coordinates().iter().map(TaskCoordinate::of).collect()
    }

    /// Names of all joint coordinates: the columns of joint values.
    #[getter]
    pub fn joint_names(&self) -> Vec<String> {
        self.inner.coordinates().iter().map(|c| c.name.clone()).collect()
    }

    /// Columns of the actuated joints.
    #[getter]
    fn actuated(&self) -> Vec<usize> {
        self.inner.actuated().to_vec()
    }

    /// Names of the imaginary joints: the columns of their values.
    #[getter]
    pub fn imaginary_names(&self) -> Vec<String> {
        self.inner.imaginary().iter().map(|joint| joint.name.clone()).collect()
    }

    /// (d,): the pose at home, metres and radians.
    #[getter]
    fn home(&self) -> Vec<f64> {
        self.inner.home_pose()
    }

    /// The working mode that the mechanism is assembled in.
    #[getter]
    fn home_mode(&self) -> String {
        self.inner.format_mode(self.inner.home_mode())
    }

    /// What cannot be told at home, where home is a parallel singularity; None where it is regular. Reading such a mechanism gives this as a UserWarning.
    #[getter]
    fn home_warning(&self) -> Option<String> {
        mobility(self.inner.mechanism()).ok().and_then(|found| found.parallel_home())
    }

    /// Number of two-valued choices; there are ``2**choices`` working modes.
    #[getter]
    fn choices(&self) -> u32 {
        self.inner.choices()
    }

    /// Every working mode, all-plus first: the mode axis of ``inverse(poses, mode="all")``.
    #[getter]
    fn modes(&self) -> Vec<String> {
        self.inner.modes().map(|mode| self.inner.format_mode(mode)).collect()
    }

    /// How the legs are split in two.
    #[getter]
    fn decomposition(&self) -> Decomposition {
        Decomposition::of(&self.inner)
    }

    /// Inverse kinematics of one pose or of many, in one working mode or in all of them.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping, optional
    ///     Metres and radians, the last axis for the task coordinates; the arrays of the result have the axes before it, and
    ///     none for one pose. A mapping or a data frame has numbers or columns by name, in any order; coordinates that are not
    ///     among them are at home. A row with NaN or a masked entry is out of reach. A float64 array in C order is used without a
    ///     copy and must not be written to meanwhile; anything else is copied and converted first.
    /// transforms : (..., 4, 4) array_like, optional
    ///     Homogeneous matrices, metres, in place of poses: where the platform is to be, as :meth:`transform` gives it; or a
    ///     ``RigidTransform`` of SciPy, or a pair of ``(..., 3)`` positions and rotations, which are a ``Rotation`` or
    ///     ``(..., 3, 3)`` matrices. What is outside the manipulator's motion is out of reach; :meth:`nearest` says by how much.
    /// mode : str
    ///     ``"home"``; or a sign for every two-valued choice, one group for each leg: ``"++ ++ ++ +"``; or ``"all"``, which
    ///     gives the arrays of the result one more axis, ``(..., m, k)`` instead of ``(..., k)``, with an entry for each
    ///     of the ``m = 2**choices`` modes of `modes`.
    /// joints : str
    ///     Which joints the ``k`` columns are: ``"all"`` for every joint coordinate, or ``"actuated"``, which takes less memory.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Solutions
    ///     Joint values, NaN for poses out of reach. Angles are within π of their home values, unless the joint limits allow
    ///     another revolution.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The columns are not the task coordinates, a number is infinite (the message gives the index of its pose, counted
    ///     from zero), a matrix is not a rotation and a position, or the mode is unknown.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("plano-spherical-5dof")
    /// >>> one = m.inverse({"x": 0.01, "xi": 0.1})
    /// >>> same = m.inverse(transforms=m.transform({"x": 0.01, "xi": 0.1}))
    /// >>> bool(one.reachable), one["S1"].shape, bool(abs(one["S1"] - same["S1"]) < 1e-12)
    /// (True, (), True)
    #[pyo3(signature = (poses = None, *, transforms = None, mode = "home", joints = "all", threads = None))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        poses: Option<&Bound<'py, PyAny>>,
        transforms: Option<&Bound<'py, PyAny>>,
        mode: &str,
        joints: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Solutions> {
        let columns = self.columns(joints)?;
        let mode = if mode == "all" { None } else { Some(self.mode(mode)?) };
        let names = self.names.get_or_init(|| CommonNames::of(&self.inner));
        let names = names.names(&self.inner, mode, joints == "actuated");
        if let (Some(given), None, Some(mode)) = (poses, transforms, mode)
            && let Some(pose) = plain(given, self.inner.task_coordinates().len())
        {
            return self.inverse_one(py, &pose, (mode, &columns), names);
        }
        let places = transforms.map(|given| matrices(given, "transforms")).transpose()?;
        let places = places.as_ref().map(Rows::new).transpose()?;
        let given = match (poses, &places) {
            (Some(poses), None) => self.poses(poses)?,
            (None, Some(places)) => {
                let poses = self.located_poses(py, places, mode, threads)?;
                Given { array: poses.as_any().extract()?, lead: places.lead.to_vec(), index: None }
            }
            _ => return Err(wrong("expected poses or transforms, one of the two")),
        };
        let poses = Rows::new(&given)?;
        match mode {
            Some(mode) => {
                Solutions::find(py, &self.inner, &poses, (mode, &columns), names, threads)
            }
            None => self.inverse_all(py, &poses, places.as_ref(), (&columns, names), threads),
        }
    }

    /// The mechanism as a model of MuJoCo (MJCF), with its closed loops: the text of an XML file.
    ///
    /// Joints have the names and the values of `joints`; the platform is the body ``platform``. Each actuated joint has a
    /// position servo of its name, and each working mode that reaches the home pose a keyframe, named by its
    /// signs: ``pp_mp_p`` is ``++ -+ +``. It is the file that ``opm export mjcf`` writes.
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
        let options = mjcf_options(density, time_step)?;
        Ok(py.detach(|| mjcf(&Keyframes::of_manipulator(&self.inner), &options)))
    }

    /// A page that shows the mechanism and its workspace in a browser, or as the value of a cell in a notebook.
    ///
    /// Returns
    /// -------
    /// Explorer
    ///     :meth:`Explorer.save` writes it to a file, as ``opm explore`` does.
    fn explore(&self, py: Python<'_>) -> PyResult<Explorer> {
        explorer::explore(py, self)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "manipulator")
    }

    fn __repr__(&self) -> String {
        let coordinates: Vec<_> = self.inner.task_coordinates().iter().map(|c| c.name).collect();
        let decomposition = self.inner.decomposition();
        let sections = match &decomposition.upper {
            _ if decomposition.is_whole() => decomposition.motion(),
            SubspaceClass::Identity => decomposition.lower.name().to_owned(),
            upper => format!("{} + {}", decomposition.lower.name(), upper.name()),
        };
        format!(
            "<Manipulator {}: {sections}, {} degrees of freedom: {}>",
            self.inner.mechanism().name,
            decomposition.mobility,
            coordinates.join(" ")
        )
    }
}

/// The value of a parameter, as Python gives it.
fn parameter(name: &str, value: &Bound<'_, PyAny>) -> PyResult<ParameterValue> {
    if value.is_none() {
        return Ok(ParameterValue::None);
    }
    if let Ok(number) = value.extract() {
        return Ok(ParameterValue::Number(number));
    }
    let numbers = |items: Bound<'_, PyIterator>| -> PyResult<Vec<f64>> {
        items.map(|item| item?.extract()).collect()
    };
    match value.try_iter().and_then(numbers).as_deref() {
        Ok(&[a, b]) => Ok(ParameterValue::Pair([a, b])),
        _ => {
            let found = value.repr()?;
            Err(wrong(format!(
                "`{name}` is {found}, expected a number, a pair of numbers, or None"
            )))
        }
    }
}

/// The file, if it has named parameters.
fn named(file: MechanismFile) -> Option<Arc<MechanismFile>> {
    (!file.parameters.is_empty()).then(|| Arc::new(file))
}

impl Manipulator {
    /// Its mechanism file; in metres and radians, unless it has named parameters.
    pub fn file(&self) -> MechanismFile {
        let mechanism = self.inner.mechanism().clone();
        if let Some(named) = &self.named {
            return MechanismFile { mechanism, ..(**named).clone() };
        }
        MechanismFile {
            mechanism,
            units: FileUnits::SI,
            family: self.family.clone(),
            mode: self.family.as_ref().map(Family::mode),
            places: Locations::default(),
            parameters: Vec::new(),
            patterns: Vec::new(),
            source: None,
        }
    }

    /// The manipulator of a changed file.
    fn changed(&self, file: MechanismFile) -> PyResult<Self> {
        let mechanism = file.mechanism.clone();
        let inner = core::Manipulator::new(mechanism).map_err(|error| failed(&error))?;
        let (inner, text, label) = (Arc::new(inner), OnceLock::new(), self.label.clone());
        let (names, memories) = (OnceLock::new(), Memories::default());
        let family = file.family.clone();
        Ok(Self { inner, text, label, family, named: named(file), names, memories })
    }

    /// The same with another name in messages.
    pub fn labelled(&self, label: String) -> Self {
        Self {
            inner: self.inner.clone(),
            text: self.text.clone(),
            label,
            family: self.family.clone(),
            named: self.named.clone(),
            names: OnceLock::new(),
            memories: Memories::default(),
        }
    }

    /// What it is called in messages.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The name of its file, without folders.
    pub fn file_name(&self) -> String {
        let path = Path::new(&self.label);
        let name = path.file_name().map_or_else(|| self.label.clone(), |n| n.display().to_string());
        if path.extension().is_some() { name } else { format!("{name}.toml") }
    }

    /// The decomposed mechanism of a file; `text` is its text.
    pub fn compile(file: MechanismFile, text: String, label: String) -> PyResult<Self> {
        let mechanism = file.mechanism.clone();
        let inner = core::Manipulator::new(mechanism).map_err(|error| failed(&error))?;
        let (inner, family) = (Arc::new(inner), file.family.clone());
        let (names, memories) = (OnceLock::new(), Memories::default());
        Ok(Self { inner, text: text.into(), label, family, named: named(file), names, memories })
    }

    /// The same, after warnings where home is a parallel singularity, and of what is probably a mistake in the file.
    pub fn warned(self, py: Python<'_>) -> PyResult<Self> {
        let Ok(report) = mobility(self.inner.mechanism()) else { return Ok(self) };
        for text in report.parallel_home().into_iter().chain(doubts(self.inner.mechanism())) {
            let message = CString::new(format!("{}: {text}", self.label))?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
        }
        Ok(self)
    }

    /// The columns of joints that an argument names.
    pub fn columns(&self, joints: &str) -> PyResult<Vec<usize>> {
        match joints {
            "actuated" => Ok(self.inner.actuated().to_vec()),
            "all" => Ok((0..self.inner.coordinates().len()).collect()),
            other => Err(wrong(format!("joints is {other:?}, expected \"actuated\" or \"all\""))),
        }
    }

    /// Every working mode of every pose: one row for each mode, with the rows of a pose together. If places are
    /// given, only modes in which the platform is there.
    fn inverse_all(
        &self,
        py: Python<'_>,
        poses: &Rows<'_>,
        places: Option<&Rows<'_>>,
        (columns, names): (&[usize], Names),
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Solutions> {
        let many = || {
            let (choices, poses) = (self.inner.choices(), poses.count);
            no_memory(format_args!("2^{choices} working modes of {poses} poses"))
        };
        let count = usize::try_from(1u64 << self.inner.choices()).map_err(|_| many())?;
        let rows = count.checked_mul(poses.count).ok_or_else(many)?;
        let mut modes = Vec::new();
        modes.try_reserve_exact(count).map_err(|_| many())?;
        modes.extend(self.inner.modes());
        let widths = [columns.len(), self.inner.imaginary().len()];
        let places = places.filter(|_| !self.inner.dependent_coordinates().is_empty());
        let tables = Tables::fill(
            py,
            rows,
            widths,
            threads,
            || (None, self.inner.all_modes(), self.inner.solution()),
            |(at, all, solution), row, [joints, imaginary]| {
                let (pose, mode) = (row / modes.len(), modes[row % modes.len()]);
                if poses.missing(pose) {
                    return Ok([false; 2]);
                }
                if *at != Some(pose) {
                    let solved = self.inner.inverse_all(poses.row(pose), all);
                    solved.map_err(|error| format!("pose {pose}: {error}"))?;
                    *at = Some(pose);
                }
                let Some(solution) = self.inner.solution_in_mode(all, mode, solution) else {
                    return Ok([false; 2]);
                };
                if let Some(places) = places {
                    let place = placement(places, pose)?;
                    if !self.inner.is_at(poses.row(pose), mode, &place) {
                        return Ok([false; 2]);
                    }
                }
                joints
                    .iter_mut()
                    .zip(columns)
                    .for_each(|(out, &column)| *out = solution.joints()[column]);
                imaginary.copy_from_slice(solution.imaginary());
                Ok([true, solution.within_limits()])
            },
        )?;
        Solutions::of_all_modes(names, poses, tables)
    }

    /// Rows of poses; coordinates that are not among those given by name are at home.
    pub fn poses<'py>(&self, given: &Bound<'py, PyAny>) -> PyResult<Given<'py>> {
        self.poses_of(given, "poses")
    }

    /// The same of another argument.
    pub fn poses_of<'py>(&self, given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
        let home = self.inner.home_pose();
        Columns { names: &self.pose_names(), otherwise: Some(&home) }.read(given, what)
    }

    /// One pose.
    pub fn pose(&self, given: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        let home = self.inner.home_pose();
        arguments::row(given, what, Columns { names: &self.pose_names(), otherwise: Some(&home) })
    }

    /// Rows of values of the actuated joints.
    pub fn inputs<'py>(&self, given: &Bound<'py, PyAny>) -> PyResult<Given<'py>> {
        Columns::all(&self.input_names()).read(given, "joints")
    }

    /// The names of the actuated joints.
    pub fn input_names(&self) -> Vec<&str> {
        let coordinates = self.inner.coordinates();
        self.inner.actuated().iter().map(|&i| coordinates[i].name.as_str()).collect()
    }

    /// The names of the task coordinates.
    pub fn pose_names(&self) -> Vec<&str> {
        self.inner.task_coordinates().iter().map(|c| c.name).collect()
    }

    /// The working mode that `mode` names.
    pub fn mode(&self, mode: &str) -> PyResult<Mode> {
        match mode {
            "home" => Ok(self.inner.home_mode()),
            signs => self.inner.parse_mode(signs).map_err(|error| failed(&error)),
        }
    }
}
