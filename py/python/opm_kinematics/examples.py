"""The mechanisms that come with the package.

:func:`names` lists them. Each mechanism of the paper has a function of its own; :func:`load` reads any of them by its name.

>>> import opm_kinematics as opm
>>> opm.examples.plano_spherical() == opm.examples.load("plano-spherical-5dof")
True
"""

from ._native import Linkage, Manipulator
from ._native import example as _text
from ._native import examples as names

__all__ = ["bennett", "linkage", "load", "names", "plano_spherical", "text", "translational_helical"]


def text(name: str) -> str:
    """The mechanism file of an example.

    Parameters
    ----------
    name : str
        One of :func:`names`.

    Returns
    -------
    str
        TOML.

    Raises
    ------
    OpmError
        There is no example of this name.
    """
    return _text(name)


def load(name: str) -> Manipulator:
    """An example as a manipulator.

    Parameters
    ----------
    name : str
        One of :func:`names`.

    Returns
    -------
    Manipulator
        Decomposed and compiled.

    Raises
    ------
    OpmError
        There is no example of this name, or it has no closed-form inverse kinematics.
    """
    return Manipulator.parse(_text(name), label=name)


def plano_spherical() -> Manipulator:
    """The paper's plano-spherical manipulator, of five degrees of freedom: x, y, zeta, xi, psi.

    Returns
    -------
    Manipulator
        Decomposed and compiled.
    """
    return load("plano-spherical-5dof")


def translational_helical() -> Manipulator:
    """The paper's translational-helical manipulator, of three degrees of freedom: x, y, phi.

    Returns
    -------
    Manipulator
        Decomposed and compiled.
    """
    return load("translational-helical-3dof")


def linkage(name: str) -> Linkage:
    """An example as a linkage: a single loop that one of its joints moves.

    Parameters
    ----------
    name : str
        One of :func:`names`, such as "sarrus".

    Returns
    -------
    Linkage
        Decomposed and compiled.

    Raises
    ------
    OpmError
        There is no example of this name, or it is not a single loop of two sections.
    """
    return Linkage.parse(_text(name), label=name)


def bennett() -> Linkage:
    """Bennett's double spherical 6R (the paper's Fig. 1), which is moved by its joint a1.

    Returns
    -------
    Linkage
        Decomposed and compiled.
    """
    return linkage("bennett-double-spherical-6r")
