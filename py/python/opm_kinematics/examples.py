"""The mechanisms that come with the package."""

from ._native import Manipulator
from ._native import example as _text
from ._native import examples as names

__all__ = ["load", "names", "text"]


def text(name: str) -> str:
    """The mechanism file of an example.

    Raises
    ------
    OpmError
        There is no example of this name.
    """
    return _text(name)


def load(name: str) -> Manipulator:
    """An example as a manipulator.

    Raises
    ------
    OpmError
        There is no example of this name, or it has no closed-form inverse kinematics.
    """
    return Manipulator.parse(_text(name), label=name)
