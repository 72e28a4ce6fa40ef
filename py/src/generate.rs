//! Mechanisms as source code.

use crate::error::failed;
use crate::manipulator::Manipulator;
use opm_generate::{Content, GenerateError, Package};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// The texts of files, by name.
type Files = BTreeMap<String, String>;

#[pymethods]
impl Manipulator {
    /// The closed-form kinematics as C99 for a controller: the texts of the files, by name.
    ///
    /// ``NAME.h`` and ``NAME.c`` are the code, which depends on ``math.h`` alone; NAME is the mechanism's name with ``_`` for
    /// what a name of C cannot have. ``NAME_test.c`` compares the code with the poses in ``NAME_golden.h``, and
    /// ``CMakeLists.txt`` builds both. ``NAME_linuxcnc.c`` is a kinematics module for LinuxCNC. They are the files that
    /// ``opm generate c`` writes.
    ///
    /// Parameters
    /// ----------
    /// dynamics : bool
    ///     Whether the code has the inverse dynamics, too: the efforts of the actuated joints for a pose with its rates and
    ///     accelerations. The masses of all bodies, rotors, friction, the payload and gravity are in its geometry.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The text of each file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism has more than 32 two-valued choices; or, with `dynamics`, its actuators are redundant or too few, or a
    ///     spherical joint has friction.
    #[pyo3(signature = (*, dynamics = false))]
    fn to_c(&self, py: Python<'_>, dynamics: bool) -> PyResult<Files> {
        self.code(py, dynamics, opm_generate::c_package)
    }

    /// The closed-form kinematics as a package of Rust: the texts of the files, by name.
    ///
    /// The package has no allocation and needs no standard library. ``tests/golden.rs`` compares it with poses that opm
    /// solved. They are the files that ``opm generate rust`` writes.
    ///
    /// Parameters
    /// ----------
    /// dynamics : bool
    ///     Whether the code has the inverse dynamics, too: the efforts of the actuated joints for a pose with its rates and
    ///     accelerations. The masses of all bodies, rotors, friction, the payload and gravity are in its geometry.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The text of each file; names have ``/`` between folders.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism has more than 32 two-valued choices; or, with `dynamics`, its actuators are redundant or too few, or a
    ///     spherical joint has friction.
    #[pyo3(signature = (*, dynamics = false))]
    fn to_rust(&self, py: Python<'_>, dynamics: bool) -> PyResult<Files> {
        self.code(py, dynamics, opm_generate::rust)
    }

    /// The closed-form kinematics as a module of Python: the texts of the files, by name.
    ///
    /// ``NAME.py`` needs NumPy alone and solves arrays of poses at once; NAME is the mechanism's name with ``_`` for what a
    /// name cannot have. ``test_NAME.py`` compares it with poses that opm solved. They are the files that
    /// ``opm generate python`` writes.
    ///
    /// Parameters
    /// ----------
    /// dynamics : bool
    ///     Whether the code has the inverse dynamics, too: the efforts of the actuated joints for a pose with its rates and
    ///     accelerations. The masses of all bodies, rotors, friction, the payload and gravity are in its geometry.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The text of each file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism has more than 32 two-valued choices; or, with `dynamics`, its actuators are redundant or too few, or a
    ///     spherical joint has friction.
    #[pyo3(signature = (*, dynamics = false))]
    fn to_python(&self, py: Python<'_>, dynamics: bool) -> PyResult<Files> {
        self.code(py, dynamics, opm_generate::python)
    }

    /// The closed-form kinematics as a package of MATLAB: the texts of the files, by name.
    ///
    /// The package ``+NAME`` has a file for each function, which needs no other file; NAME is the mechanism's name with ``_``
    /// for what a name cannot have. ``NAME_test.m`` compares it with poses that opm solved. They are the files that
    /// ``opm generate matlab`` writes.
    ///
    /// Parameters
    /// ----------
    /// dynamics : bool
    ///     Whether the code has the inverse dynamics, too: the efforts of the actuated joints for a pose with its rates and
    ///     accelerations. The masses of all bodies, rotors, friction, the payload and gravity are in its geometry.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The text of each file; names have ``/`` between folders.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism has more than 32 two-valued choices; or, with `dynamics`, its actuators are redundant or too few, or a
    ///     spherical joint has friction.
    #[pyo3(signature = (*, dynamics = false))]
    fn to_matlab(&self, py: Python<'_>, dynamics: bool) -> PyResult<Files> {
        self.code(py, dynamics, opm_generate::matlab)
    }

    /// The closed-form kinematics as structured text (IEC 61131-3) for a PLC: the texts of the files, by name.
    ///
    /// ``NAME.st`` has a function block for each function; NAME is the mechanism's name with ``_`` for what a name cannot have.
    /// ``NAME_test.st`` compares it with poses that opm solved. They are the files that ``opm generate st`` writes.
    ///
    /// Parameters
    /// ----------
    /// dynamics : bool
    ///     Whether the code has the inverse dynamics, too: the efforts of the actuated joints for a pose with its rates and
    ///     accelerations. The masses of all bodies, rotors, friction, the payload and gravity are in its geometry.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The text of each file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism has more than 32 two-valued choices; or, with `dynamics`, its actuators are redundant or too few, or a
    ///     spherical joint has friction.
    #[pyo3(signature = (*, dynamics = false))]
    fn to_st(&self, py: Python<'_>, dynamics: bool) -> PyResult<Files> {
        self.code(py, dynamics, opm_generate::st)
    }
}

impl Manipulator {
    /// The files of a language.
    fn code(
        &self,
        py: Python<'_>,
        dynamics: bool,
        generate: impl Fn(&opm_core::Manipulator, Content) -> Result<Package, GenerateError>
        + Send
        + Sync,
    ) -> PyResult<Files> {
        let content = if dynamics { Content::Dynamics } else { Content::Kinematics };
        let package =
            py.detach(|| generate(&self.inner, content)).map_err(|error| failed(&error))?;
        Ok(package.with_dimensions(&self.file()).files.into_iter().collect())
    }
}
