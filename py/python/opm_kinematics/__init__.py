"""Kinematics and workspaces of overconstrained parallel manipulators with partial subspaces.

From a mechanism file :class:`Manipulator` finds the decomposition with imaginary joints, and solves inverse kinematics in
closed form; :func:`sweep` finds which poses of a grid are reachable. Arrays are float64, numbers SI units and radians.

>>> import opm_kinematics as opm
>>> m = opm.examples.load("plano-spherical-5dof")
>>> m.inverse([m.home]).reachable
array([ True])
"""

from . import examples
from ._native import (
    Manipulator,
    OpmError,
    Solutions,
    Sweep,
    TaskCoordinate,
    __version__,
    sweep,
)

__all__ = [
    "Manipulator",
    "OpmError",
    "Solutions",
    "Sweep",
    "TaskCoordinate",
    "__version__",
    "examples",
    "sweep",
]
