//! Pictures of a manipulator, which the package's Python module `plot` draws.

use crate::manipulator::Manipulator;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The Python module that draws.
const MODULE: &str = "opm_kinematics.plot";

#[pymethods]
impl Manipulator {
    /// Draw the mechanism in a pose with matplotlib: :func:`opm_kinematics.plot.mechanism`.
    ///
    /// Parameters
    /// ----------
    /// pose : (d,) array_like, optional
    ///     Metres and radians. Home if not given.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// ax : Axes3D, optional
    ///     A three-dimensional panel to draw on; a new one if not given.
    ///
    /// Returns
    /// -------
    /// Axes3D
    ///     The panel.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The pose is out of reach.
    /// ImportError
    ///     matplotlib is not installed.
    #[pyo3(signature = (pose = None, *, mode = "home", ax = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        pose: Option<&Bound<'py, PyAny>>,
        mode: &str,
        ax: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(slf.py());
        options.set_item("mode", mode)?;
        options.set_item("ax", ax)?;
        slf.py().import(MODULE)?.call_method("mechanism", (slf, pose), Some(&options))
    }

    /// The mechanism as it follows a motion, as a moving picture: :func:`opm_kinematics.plot.animate`.
    ///
    /// Parameters
    /// ----------
    /// motion : Trajectory, path, str or (n, d) array_like
    ///     A motion that was followed, a motion file, a table of poses, the name of a shipped motion, or poses one after the
    ///     other.
    /// mode : str, optional
    ///     ``"home"``, or a sign for every two-valued choice; if not given, the mode of the motion, or home.
    /// frames : int
    ///     The most pictures that it consists of, spread evenly over the motion.
    /// ax : Axes3D, optional
    ///     A three-dimensional panel to draw on; a new one if not given.
    ///
    /// Returns
    /// -------
    /// Animation
    ///     It plays in a notebook; :meth:`Animation.save <opm_kinematics.plot.Animation.save>` writes it to a file.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The motion cannot be read, or no pose of it is in reach.
    /// ImportError
    ///     matplotlib is not installed.
    #[pyo3(signature = (motion, *, mode = None, frames = 60, ax = None))]
    fn animate<'py>(
        slf: &Bound<'py, Self>,
        motion: &Bound<'py, PyAny>,
        mode: Option<&str>,
        frames: usize,
        ax: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(slf.py());
        options.set_item("mode", mode)?;
        options.set_item("frames", frames)?;
        options.set_item("ax", ax)?;
        slf.py().import(MODULE)?.call_method("animate", (slf, motion), Some(&options))
    }

    /// Show the mechanism in a browser with `viser <https://viser.studio>`_, poses as a moving picture.
    ///
    /// Each link is a frame with the name that :meth:`link_frames` has for it, in the tree of the scene and in Python:
    /// ``server.scene`` takes more, such as a mesh at ``/platform/tool``. Beside the picture, frames show their axes, and several
    /// poses play.
    ///
    /// Parameters
    /// ----------
    /// poses : Trajectory, path, str, (..., d) array_like or mapping, optional
    ///     A motion that was followed, a motion file, a table of poses, the name of a shipped motion, or poses one after the other.
    ///     Home if not given.
    /// mode : str, optional
    ///     ``"home"``, or a sign for every two-valued choice; if not given, the mode of the motion, or home.
    /// rate : float
    ///     Poses per second while they play; a motion has its own times.
    /// port : int
    ///     The port of the server on this machine; the next free one if it is taken.
    ///
    /// Returns
    /// -------
    /// viser.ViserServer
    ///     The server, which runs on: open its address in a browser. ``server.sleep_forever()`` keeps a script alive,
    ///     ``server.stop()`` ends it.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The motion cannot be read, or no pose of it is in reach.
    /// ImportError
    ///     viser is not installed.
    #[pyo3(signature = (poses = None, *, mode = None, rate = 10.0, port = 8080))]
    fn show<'py>(
        slf: &Bound<'py, Self>,
        poses: Option<&Bound<'py, PyAny>>,
        mode: Option<&str>,
        rate: f64,
        port: u16,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(slf.py());
        options.set_item("mode", mode)?;
        options.set_item("rate", rate)?;
        options.set_item("port", port)?;
        let module = slf.py().import("opm_kinematics._show")?;
        module.call_method("show", (slf, poses), Some(&options))
    }
}
