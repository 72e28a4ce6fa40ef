from os import PathLike
from typing import TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Manipulator",
    "OpmError",
    "Solutions",
    "Sweep",
    "TaskCoordinate",
    "__version__",
    "example",
    "examples",
    "sweep",
]

__version__: str

class OpmError(ValueError):
    """A mechanism, a pose or an option that cannot be computed with."""

class _Subspace(TypedDict):
    subspace: str

class _Leg(TypedDict):
    name: str
    lower: list[str]
    upper: list[str]
    imaginary: str | None

_Decomposition = TypedDict(
    "_Decomposition",
    {
        "lambda": int,
        "mobility": int,
        "imaginary_joints": int,
        "first_section_motions": int,
        "lower": _Subspace,
        "upper": _Subspace,
        "legs": list[_Leg],
    },
)

@final
class TaskCoordinate:
    """One coordinate of the pose."""

    @property
    def name(self) -> str: ...
    @property
    def home(self) -> float:
        """The value at home, metres or radians."""
    @property
    def unit(self) -> str:
        """``"m"`` or ``"rad"``."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Manipulator:
    """A mechanism, decomposed and compiled for closed-form inverse kinematics.

    Immutable; it can be pickled, and shared between threads.
    """

    @staticmethod
    def load(path: str | PathLike[str]) -> Manipulator:
        """Read a mechanism file.

        Raises
        ------
        OSError
            The file cannot be read.
        OpmError
            Every problem of the file with its line and column, or why it has no closed-form inverse kinematics.
        """
    @staticmethod
    def parse(text: str, label: str | None = None) -> Manipulator:
        """Read the text of a mechanism file; messages call it `label`."""
    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str:
        """The mechanism file."""
    @property
    def task_coordinates(self) -> list[TaskCoordinate]:
        """The coordinates of the pose: the columns of poses."""
    @property
    def joints(self) -> list[str]:
        """Names of all joint coordinates: the columns of joint values."""
    @property
    def actuated(self) -> list[int]:
        """Columns of the actuated joints."""
    @property
    def imaginary(self) -> list[str]:
        """Names of the imaginary joints: the columns of their values."""
    @property
    def home(self) -> list[float]:
        """The pose at home."""
    @property
    def home_mode(self) -> str:
        """The working mode that the mechanism is assembled in."""
    @property
    def choices(self) -> int:
        """Number of two-valued choices; there are ``2**choices`` working modes."""
    @property
    def decomposition(self) -> _Decomposition:
        """How the legs were cut in two: the keys are those of ``opm decompose --format json``."""
    def inverse(self, poses: ArrayLike, *, mode: str = "home", threads: int | None = None) -> Solutions:
        """Inverse kinematics of many poses in one working mode.

        Parameters
        ----------
        poses : (n, d) array_like
            A pose a row, a task coordinate a column; metres and radians. float64 in C order is used as it is.
        mode : str
            ``"home"``, or a sign for every two-valued choice, a group a leg: ``"++ ++ ++ +"``.
        threads : int, optional
            How many; the result does not depend on it. A processor each if not given.

        Raises
        ------
        OpmError
            Columns that are not the task coordinates, a number that is not finite, an unknown mode.
        """

@final
class Solutions:
    """Joint values of many poses in one working mode; rows of poses out of reach are NaN."""

    @property
    def joints(self) -> NDArray[np.float64]:
        """(n, k): every joint coordinate, metres and radians."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(n, j): every imaginary joint."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): in reach, limits apart."""
    @property
    def within_limits(self) -> NDArray[np.bool_]:
        """(n,): in reach, and all joints within their limits."""
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def imaginary_names(self) -> list[str]: ...
    @property
    def mode(self) -> str: ...
    @property
    def rows(self) -> int: ...
    def __len__(self) -> int: ...

@final
class Sweep:
    """A grid of poses, swept."""

    @property
    def count(self) -> int:
        """Poses in reach and within all limits."""
    @property
    def poses(self) -> int:
        """Poses of the grid."""
    @property
    def fraction(self) -> float:
        """``count / poses``."""
    @property
    def imaginary_range(self) -> dict[str, tuple[float, float] | None]:
        """Lowest and highest value of every imaginary joint over the reachable poses."""
    @property
    def axes(self) -> dict[str, NDArray[np.float64]]:
        """The values of every task coordinate, in the order of the mask's axes."""
    def mask(self) -> NDArray[np.bool_]:
        """Which poses are reachable: an axis a task coordinate, as many values as the grid has."""
    def points(self) -> NDArray[np.float64]:
        """(count, d): the reachable poses in the order of the grid, the first coordinate fastest."""

def sweep(
    manipulator: Manipulator,
    /,
    *,
    mode: str = "home",
    threads: int | None = None,
    **axes: float | tuple[float, float, int],
) -> Sweep:
    """Find which poses of a grid are reachable and within all limits.

    Parameters
    ----------
    manipulator : Manipulator
    mode : str
        ``"home"``, ``"any"``, or a sign for every two-valued choice.
    threads : int, optional
        How many; the result does not depend on it. A processor each if not given.
    **axes
        Of each task coordinate one value, or ``(min, max, count)`` with both ends on the grid; metres and radians. One that
        is not given stays at home.

    Raises
    ------
    OpmError
        An axis that is none, ends that are not numbers or reversed, an unknown mode.
    """

def examples() -> list[str]:
    """Names of the mechanisms that come with the package."""

def example(name: str) -> str:
    """The text of one of them."""
