"""Kinematics and workspaces of overconstrained parallel manipulators with partial subspaces.

From a mechanism file :class:`Manipulator` finds the decomposition with imaginary joints, and solves inverse kinematics in
closed form; :func:`sweep` finds which poses of a grid are reachable, :func:`trajectory` follows motions, :func:`calibrate` corrects
parameters by measurements, :mod:`plot`
draws, :mod:`design` optimises, and :func:`explore` shows a mechanism in
a browser or a notebook. Arrays are float64, numbers SI units and radians.

>>> import opm_kinematics as opm
>>> m = opm.examples.load("plano-spherical-5dof")
>>> m.inverse([m.home]).reachable
array([ True])
"""

from typing import TYPE_CHECKING, Any

from . import examples
from ._native import (
    Accuracy,
    AccuracyBounds,
    AccuracySamples,
    Analysis,
    Aspect,
    Assemblies,
    Assembly,
    Calibration,
    Certificate,
    Clearance,
    Comparison,
    Conditioning,
    Contact,
    Decomposition,
    Explorer,
    Inscribed,
    Intersection,
    Joint,
    LegSplit,
    Linkage,
    Manipulator,
    Measure,
    Motion,
    Nearest,
    NearestReachable,
    OpmError,
    Outline,
    ParameterJacobian,
    Rejection,
    Singularity,
    Solid,
    Solutions,
    Sweep,
    TaskCoordinate,
    Trajectory,
    Violation,
    __version__,
    calibrate,
    explore,
    measure,
    recover,
    sweep,
    trajectory,
)

__all__ = [
    "Accuracy",
    "AccuracyBounds",
    "AccuracySamples",
    "Analysis",
    "Aspect",
    "Assemblies",
    "Assembly",
    "Calibration",
    "Certificate",
    "Clearance",
    "Comparison",
    "Conditioning",
    "Contact",
    "Decomposition",
    "Explorer",
    "Inscribed",
    "Intersection",
    "Joint",
    "LegSplit",
    "Linkage",
    "Manipulator",
    "Measure",
    "Motion",
    "Nearest",
    "NearestReachable",
    "OpmError",
    "Outline",
    "ParameterJacobian",
    "Rejection",
    "Singularity",
    "Solid",
    "Solutions",
    "Sweep",
    "TaskCoordinate",
    "Trajectory",
    "Violation",
    "__version__",
    "calibrate",
    "design",
    "examples",
    "explore",
    "measure",
    "plot",
    "recover",
    "sweep",
    "trajectory",
]

if TYPE_CHECKING:
    from . import design, plot


def __getattr__(name: str) -> Any:
    # Only when they are asked for: they need NumPy, for which the command line has no use.
    if name in ("design", "plot"):
        from importlib import import_module

        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
