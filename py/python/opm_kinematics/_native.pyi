from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TypeAlias, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Assembly",
    "Manipulator",
    "Motion",
    "OpmError",
    "Singularity",
    "Solutions",
    "Sweep",
    "TaskCoordinate",
    "__version__",
    "command",
    "example",
    "examples",
    "sweep",
]

__version__: str

class OpmError(ValueError):
    """A mechanism, a pose or an option that cannot be computed with."""

_Parameter: TypeAlias = float | Sequence[float] | NDArray[np.float64] | None

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
        """The mechanism file. After :meth:`with_parameters` one in metres and radians that gives the same to the bit."""
    @property
    def parameters(self) -> dict[str, float | tuple[float, float] | None]:
        """The geometric parameters of its family by name; empty for a list of joints.

        ``home.x`` is a coordinate of home, ``leg1.h`` a parameter of the leg of this name, ``leg1.limits.S`` the limits of one
        of its joints. Metres and radians; points ``(x, y)``, limits ``(lowest, highest)`` or None where there are none.
        """
    def with_parameters(
        self, changes: Mapping[str, _Parameter] | None = None, /, **named: _Parameter
    ) -> Manipulator:
        """The same mechanism with some of its :attr:`parameters` changed: assembled, decomposed and compiled anew.

        Parameters
        ----------
        changes : mapping, optional
            New values by name. A name without its leg (``h``, ``limits.S``) sets the parameter in every leg that has it, and a
            whole one (``leg1.h``) in one leg, whatever the other says.
        **named
            Likewise, for names without dots.

        Returns
        -------
        Manipulator
            A new one; this one stays as it is. It is assembled at the same home pose in the same working mode.

        Raises
        ------
        OpmError
            Every name that is no parameter, with those that there are, and every value that is none; every leg that does not
            reach home; home poses that are singular.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof")
        >>> longer = m.with_parameters({"leg1.h": 0.13, "limits.S": (-0.25, 0.25)}, a2=0.05)
        >>> longer.parameters["leg1.h"], longer.parameters["leg2.h"], longer.parameters["leg2.a2"]
        (0.13, 0.12, 0.05)
        """
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

    def jacobian(
        self, poses: ArrayLike, *, mode: str = "home", joints: str = "actuated", threads: int | None = None
    ) -> NDArray[np.float64]:
        """Rates of joints for unit rates of the task coordinates, ``(n, a, d)``.

        Parameters
        ----------
        poses : (n, d) array_like
        joints : str
            ``"actuated"``, or ``"all"`` for every joint coordinate: what the ``a`` rows are.

        Returns
        -------
        (n, a, d) ndarray
            NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
        """
    def velocity(
        self,
        poses: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike | None = None,
        *,
        mode: str = "home",
        threads: int | None = None,
    ) -> Motion:
        """Rates and accelerations of every joint.

        Parameters
        ----------
        poses : (n, d) array_like
        rates, accelerations : (n, d) or (1, d) array_like
            First and second derivatives of the task coordinates by time; one row is for all poses.
        """
    def singularity(
        self, poses: ArrayLike, *, mode: str = "home", length: float | None = None, threads: int | None = None
    ) -> Singularity:
        """How near each pose is to a singularity, by section.

        Parameters
        ----------
        poses : (n, d) array_like
        length : float, optional
            Characteristic length of `condition` and `manipulability`, metres. The spread of the joint axes if not given.
        """
    def forward(self, joints: ArrayLike) -> list[list[Assembly]]:
        """Every assembly for each row of actuated joint values, (n, a).

        Raises
        ------
        OpmError
            The mechanism's forward kinematics have no closed form.
        """

@final
class Assembly:
    """One way in which a mechanism can be assembled for given actuated joints."""

    @property
    def pose(self) -> NDArray[np.float64]:
        """(d,): task coordinates."""
    @property
    def mode(self) -> str:
        """The working mode that it is in."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """(k,): every joint coordinate."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(j,): every imaginary joint."""
    @property
    def within_limits(self) -> bool: ...
    @property
    def residual(self) -> float:
        """How far the legs fail to close: radians, and lengths over the mechanism's size."""

@final
class Motion:
    """Rates and accelerations of every joint at many poses; NaN where there is none."""

    @property
    def joint_rates(self) -> NDArray[np.float64]:
        """(n, k), rad/s and m/s."""
    @property
    def joint_accelerations(self) -> NDArray[np.float64]:
        """(n, k), rad/s² and m/s²."""
    @property
    def imaginary_rates(self) -> NDArray[np.float64]:
        """(n, j)."""
    @property
    def imaginary_accelerations(self) -> NDArray[np.float64]:
        """(n, j)."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): in reach, limits apart."""
    @property
    def regular(self) -> NDArray[np.bool_]:
        """(n,): in reach, and every joint has its rate."""

@final
class Singularity:
    """How near many poses are to singular, (n,) each: signed measures without dimension that vanish at a singularity.

    NaN where a pose is out of reach, and of parallel ones where the inputs are too few to hold the section at all.
    """

    @property
    def upper_serial(self) -> NDArray[np.float64]: ...
    @property
    def upper_parallel(self) -> NDArray[np.float64]: ...
    @property
    def lower_serial(self) -> NDArray[np.float64]: ...
    @property
    def lower_parallel(self) -> NDArray[np.float64]: ...
    @property
    def serial(self) -> NDArray[np.float64]:
        """Of the whole mechanism."""
    @property
    def parallel(self) -> NDArray[np.float64]:
        """Of the whole mechanism."""
    @property
    def condition(self) -> NDArray[np.float64]:
        """Condition number of the actuated joints' Jacobian by the platform's twist; infinite at a singularity."""
    @property
    def manipulability(self) -> NDArray[np.float64]: ...
    @property
    def coordinates(self) -> NDArray[np.float64]:
        """Zero where the coordinates of the pose are singular, which is nothing to the mechanism."""
    @property
    def reachable(self) -> NDArray[np.bool_]: ...

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

def command(arguments: Sequence[str]) -> int:
    """Do what a command line asks for, the program's name first; the status to exit with."""
