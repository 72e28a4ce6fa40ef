from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import SupportsIndex, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Assembly",
    "Conditioning",
    "Decomposition",
    "Intersection",
    "LegSplit",
    "Linkage",
    "Manipulator",
    "Measure",
    "Motion",
    "Nearest",
    "OpmError",
    "Outline",
    "Singularity",
    "Solid",
    "Solutions",
    "Sweep",
    "TaskCoordinate",
    "Trajectory",
    "Violation",
    "__version__",
    "command",
    "example",
    "examples",
    "measure",
    "sweep",
    "trajectory",
]

__version__: str

class OpmError(ValueError):
    """A mechanism, a pose or an option that cannot be computed with."""

_Parameter: TypeAlias = float | Sequence[float] | NDArray[np.float64] | None

_Executor: TypeAlias = Executor | Callable[[], Executor]

@final
class Decomposition:
    """How the legs of a mechanism were cut in two: what ``opm decompose`` says."""

    @property
    def name(self) -> str:
        """Of the mechanism."""
    @property
    def rank(self) -> int:
        """Of all joint screws, lambda."""
    @property
    def mobility(self) -> int:
        """N."""
    @property
    def imaginary_joints(self) -> int:
        """Independent motions of the imaginary joints, J."""
    @property
    def first_section_motions(self) -> int:
        """Motions of the lower section with the imaginary joints held, M = N - J."""
    @property
    def lower(self) -> str:
        """Subspace of the lower section: ``"planar"``, for instance."""
    @property
    def upper(self) -> str:
        """Subspace of the upper section."""
    @property
    def intersection(self) -> Intersection:
        """What both have in common."""
    @property
    def legs(self) -> list[LegSplit]:
        """A leg each, in the order of the mechanism file."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def _repr_html_(self) -> str: ...

@final
class Intersection:
    """The motion that both sections have in common, in base coordinates at home."""

    @property
    def kind(self) -> str:
        """``"rotation"``, ``"translation"`` or ``"helical"``."""
    @property
    def axis(self) -> tuple[float, float, float] | None:
        """Unit vector of its positive direction, base coordinates."""
    @property
    def point(self) -> tuple[float, float, float] | None:
        """A point of the axis, metres; of a translation none."""
    @property
    def pitch(self) -> float | None:
        """Advance of a helical motion, metres per radian."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class LegSplit:
    """Where a leg was cut."""

    @property
    def name(self) -> str:
        """Of the leg."""
    @property
    def lower(self) -> list[str]:
        """Joints in the lower section, base first."""
    @property
    def upper(self) -> list[str]:
        """Joints in the upper section, base first."""
    @property
    def imaginary(self) -> str | None:
        """The imaginary joint that bridges the cut."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class TaskCoordinate:
    """One coordinate of the pose."""

    @property
    def name(self) -> str:
        """Of the coordinate: ``"x"``, ``"zeta"``, ..."""
    @property
    def home(self) -> float:
        """The value at home, metres or radians."""
    @property
    def unit(self) -> str:
        """``"m"`` or ``"rad"``."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Linkage:
    """A single loop that decomposes into two spherical four-bars, which share an imaginary joint.

    Immutable; it can be pickled, and shared between threads.

    Examples
    --------
    >>> import opm_kinematics as opm
    >>> bennett = opm.examples.bennett()
    >>> positions = bennett.positions([0.5], input="a1")
    >>> positions.modes, positions["tau"].shape
    (['+ +', '+ -', '- +', '- -'], (1, 4))
    """

    @staticmethod
    def load(path: str | PathLike[str]) -> Linkage:
        """Read a mechanism file.

        Parameters
        ----------
        path : path
            TOML. Shipped linkages are read by :func:`examples.bennett`.

        Returns
        -------
        Linkage
            Decomposed and compiled.

        Raises
        ------
        OSError
            The file cannot be read: FileNotFoundError, with its name, where there is none.
        OpmError
            Every problem of the file with its line and column, or what it has instead of two spherical four-bars.
        """
    @staticmethod
    def parse(text: str, label: str | None = None) -> Linkage:
        """Read the text of a mechanism file.

        Parameters
        ----------
        text : str
            TOML.
        label : str, optional
            What messages call it.

        Returns
        -------
        Linkage
            Decomposed and compiled.

        Raises
        ------
        OpmError
            Every problem of the text with its line and column, or what it has instead of two spherical four-bars.
        """
    @property
    def name(self) -> str:
        """The mechanism's name."""
    @property
    def text(self) -> str:
        """The mechanism file."""
    @property
    def joints(self) -> list[str]:
        """Names of all joint coordinates: the columns of joint values."""
    @property
    def imaginary(self) -> str:
        """Name of the imaginary joint."""
    @property
    def home(self) -> list[float]:
        """(k,): every joint at home, radians."""
    def home_branch(self, input: str | None = None) -> str:
        """The branch that the linkage is assembled in, moved by one of its joints.

        Parameters
        ----------
        input : str, optional
            Name of the joint; the actuated one if not given.

        Returns
        -------
        str
            Its two signs: of the four-bar that has the input, and of the other one.

        Raises
        ------
        OpmError
            There is no joint of this name.
        """
    def range(self, input: str | None = None) -> NDArray[np.float64]:
        """Where the loop closes: the range of one joint, limits apart.

        Parameters
        ----------
        input : str, optional
            Name of the joint; the actuated one if not given.

        Returns
        -------
        (r, 2) array
            Lowest and highest value of every part, radians. Of a whole turn it is the one about home.

        Raises
        ------
        OpmError
            There is no joint of this name.
        """
    def positions(
        self, values: ArrayLike, *, input: str | None = None, threads: int | None = None
    ) -> Solutions:
        """Every position for many values of one joint, in all four branches.

        Parameters
        ----------
        values : (n,) array_like
            Of the joint that moves the linkage, radians.
        input : str, optional
            Its name; the actuated one if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        Solutions
            As of all modes, with the four branches in their place: ``(n, 4, k)``, ``(n, 4, 1)``, ``(n, 4)``. NaN where the loop
            does not close. Angles are within half a turn of home, unless the limits allow another turn; ``np.unwrap`` along
            the first axis makes those of a whole turn continuous.

        Raises
        ------
        OpmError
            There is no joint of this name, or a value is not finite (which, counted from zero).
        """

@final
class Manipulator:
    """A mechanism, decomposed and compiled for closed-form inverse kinematics.

    Immutable; it can be pickled, and shared between threads.
    """

    @staticmethod
    def load(path: str | PathLike[str]) -> Manipulator:
        """Read a mechanism file.

        Parameters
        ----------
        path : path
            TOML. Shipped mechanisms are read by :func:`examples.load`.

        Returns
        -------
        Manipulator
            Decomposed and compiled.

        Raises
        ------
        OSError
            The file cannot be read: FileNotFoundError, with its name, where there is none.
        OpmError
            Every problem of the file with its line and column, or why it has no closed-form inverse kinematics.
        """
    @staticmethod
    def from_screws(
        legs: Mapping[str, ArrayLike] | Sequence[ArrayLike],
        actuated: Sequence[Sequence[bool]] | Sequence[NDArray[np.bool_]] | NDArray[np.bool_],
        *,
        home: Sequence[Sequence[float]] | Sequence[NDArray[np.float64]] | NDArray[np.float64] | None = None,
        limits: Sequence[Sequence[tuple[float, float] | None]] | NDArray[np.float64] | None = None,
        joints: Sequence[Sequence[str]] | None = None,
        platform: Sequence[float] | NDArray[np.float64] = ...,
        name: str = "mechanism",
    ) -> Manipulator:
        """Compile a mechanism that is given by the screws of its joints at an assembled pose, home.

        It is decomposed as any other; `text` is a mechanism file that says the same.

        Parameters
        ----------
        legs : mapping of str to (n, 6) array_like, or sequence of them
            A leg each, by name; else they are called leg1, leg2, ... A row is the twist (omega; v) of a joint of one
            freedom about the base frame, base to platform, of any length but zero: ``(a, p × a + h a)`` turns about ``a``
            through ``p`` with an advance of ``h`` metres a radian, ``(0, a)`` slides along ``a``. Joints of several
            freedoms are several rows.
        actuated : sequence of (n,) sequences of bool
            Which joints are driven, a sequence a leg.
        home : sequence of (n,) sequences of float, optional
            Joint values at home, radians and metres; zero if not given.
        limits : sequence of (n,) sequences of (float, float) or None, optional
            Lowest and highest value of each joint. ``None``, or both infinite, is none.
        joints : sequence of (n,) sequences of str, optional
            Names, q1_1, q1_2, ... if not given: leg, then joint.
        platform : (3,) sequence of float
            Reference point of the platform at home, metres; the base's origin if not given.
        name : str
            Of the mechanism.

        Raises
        ------
        OpmError
            What is wrong with which joint of which leg; or why the mechanism has no closed-form inverse kinematics.
        """
    @staticmethod
    def parse(text: str, label: str | None = None) -> Manipulator:
        """Read the text of a mechanism file.

        Parameters
        ----------
        text : str
            TOML.
        label : str, optional
            What messages call it.

        Returns
        -------
        Manipulator
            Decomposed and compiled.

        Raises
        ------
        OpmError
            Every problem of the text with its line and column, or why it has no closed-form inverse kinematics.
        """
    @property
    def name(self) -> str:
        """The mechanism's name."""
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
        """(d,): the pose at home, metres and radians."""
    @property
    def home_mode(self) -> str:
        """The working mode that the mechanism is assembled in."""
    @property
    def choices(self) -> int:
        """Number of two-valued choices; there are ``2**choices`` working modes."""
    @property
    def decomposition(self) -> Decomposition:
        """How the legs were cut in two."""
    @property
    def modes(self) -> list[str]:
        """Every working mode, all-plus first: the mode axis of ``inverse(poses, mode="all")``."""
    @property
    def screws(self) -> dict[str, NDArray[np.float64]]:
        """The joints' unit screws by leg, (f, 6) each: (omega; v) at home about the base frame, a row a freedom."""
    def solids(self, pose: Sequence[float] | NDArray[np.float64] | None = None, *, mode: str = "home") -> list[Solid]:
        """The solids that the mechanism is drawn with, from its joint screws alone.

        Parameters
        ----------
        pose : (d,) array_like, optional
            Metres and radians. Home if not given.
        mode : str
            ``"home"``, or a sign for every two-valued choice.

        Returns
        -------
        list of Solid
            Metres, base coordinates.

        Raises
        ------
        OpmError
            The pose is out of reach.
        """
    def _repr_html_(self) -> str: ...
    def inverse(self, poses: ArrayLike, *, mode: str = "home", threads: int | None = None) -> Solutions:
        """Inverse kinematics of many poses, in one working mode or in all of them.

        Parameters
        ----------
        poses : (n, d) array_like
            A pose a row, a task coordinate a column; metres and radians. float64 in C order is used as it is, and must not be
            written to meanwhile; anything else is converted first, in memory of its own.
        mode : str
            ``"home"``; or a sign for every two-valued choice, a group a leg: ``"++ ++ ++ +"``; or ``"all"``, which
            gives the arrays of the result a second axis, ``(n, m, k)`` instead of ``(n, k)``, with an entry for each
            of the ``m = 2**choices`` modes of `modes`.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        Solutions
            Poses out of reach have NaN; angles are within half a turn of home, unless the limits allow another turn.

        Raises
        ------
        OpmError
            Columns that are not the task coordinates, a number that is not finite (of which pose, counted from zero), an unknown
            mode.
        """

    def jacobian(
        self, poses: ArrayLike, *, mode: str = "home", joints: str = "actuated", threads: int | None = None
    ) -> NDArray[np.float64]:
        """Rates of joints for unit rates of the task coordinates.

        Parameters
        ----------
        poses : (n, d) array_like
            A pose a row, a task coordinate a column; metres and radians.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        joints : str
            ``"actuated"``, or ``"all"`` for every joint coordinate: what the ``a`` rows are.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        (n, a, d) ndarray
            Ratios of metres and radians. NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
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
            A pose a row, a task coordinate a column; metres and radians.
        rates : (n, d) or (1, d) array_like
            First derivatives of the task coordinates by time, m/s and rad/s; one row is for all poses.
        accelerations : (n, d) or (1, d) array_like, optional
            Second derivatives, m/s² and rad/s²; none if not given.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        Motion
            NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
        """
    def singularity(
        self, poses: ArrayLike, *, mode: str = "home", length: float | None = None, threads: int | None = None
    ) -> Singularity:
        """How near each pose is to a singularity, by section.

        Parameters
        ----------
        poses : (n, d) array_like
            A pose a row, a task coordinate a column; metres and radians.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        length : float, optional
            Characteristic length of `condition` and `manipulability`, metres. The spread of the joint axes if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        Singularity
            A number a pose and measure, NaN out of reach.
        """
    def forward(
        self,
        joints: ArrayLike,
        *,
        near: ArrayLike | None = None,
        mode: str | None = None,
        threads: int | None = None,
    ) -> list[list[Assembly]]:
        """Every assembly for each row of actuated joint values; or, near a pose, the one that Newton's method finds.

        Parameters
        ----------
        joints : (n, a) array_like
            A row of actuated joint values each, in the order of `actuated`; metres and radians.
        near : (d,) or (n, d) array_like, optional
            From which pose Newton's method begins, metres and radians; one row is for all. It works for every mechanism, the
            closed form not for all.
        mode : str, optional
            Only assemblies in this working mode, ``"home"`` or a sign for every two-valued choice. Of Newton's method the mode
            that it stays in: home if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        list of list of Assembly
            A list a row: empty where there is none, or where Newton's method ends nowhere.

        Raises
        ------
        OpmError
            The mechanism's forward kinematics have no closed form, and `near` is not given; or that is out of reach.
        """
    def transform(self, poses: ArrayLike, *, threads: int | None = None) -> NDArray[np.float64]:
        """Where the platform is at each pose, in SE(3): its reference point and its orientation, in base coordinates.

        Parameters
        ----------
        poses : (n, d) array_like
            A pose a row, a task coordinate a column; metres and radians.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        (n, 4, 4) ndarray
            Homogeneous matrices: a rotation, which is none at home unless the coordinates measure it, and a position, metres.
        """
    def locate(self, transforms: ArrayLike, *, threads: int | None = None) -> NDArray[np.float64]:
        """The poses at which the platform is there: the inverse of :meth:`transform`.

        Parameters
        ----------
        transforms : (n, 4, 4) array_like
            Homogeneous matrices, metres.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        (n, d) ndarray
            Metres and radians, angles within half a turn of home. NaN where the displacement is none of the manipulator's motion:
            :meth:`nearest` says by how much.

        Raises
        ------
        OpmError
            A matrix that is no rotation and position.
        """
    def nearest(self, transforms: ArrayLike, *, threads: int | None = None) -> Nearest:
        """The poses at which the platform is nearest to there, and what it lacks: for what :meth:`locate` has no pose.

        Parameters
        ----------
        transforms : (n, 4, 4) array_like
            Homogeneous matrices, metres.
        threads : int, optional
            1 to 1024; the result does not depend on it. A processor each if not given.

        Returns
        -------
        Nearest
            Nearest by least squares, in which a rotation counts by the mechanism's size.

        Raises
        ------
        OpmError
            A matrix that is no rotation and position.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Assembly:
    """One way in which a mechanism can be assembled for given actuated joints."""

    @property
    def pose(self) -> NDArray[np.float64]:
        """(d,): task coordinates, metres and radians."""
    @property
    def mode(self) -> str:
        """The working mode that it is in."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """(k,): every joint coordinate, metres and radians."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(j,): every imaginary joint, metres and radians."""
    @property
    def within_limits(self) -> bool:
        """Whether all joints are within their limits."""
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
        """(n, j), rad/s and m/s."""
    @property
    def imaginary_accelerations(self) -> NDArray[np.float64]:
        """(n, j), rad/s² and m/s²."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): in reach, limits apart."""
    @property
    def regular(self) -> NDArray[np.bool_]:
        """(n,): in reach, and every joint has its rate."""

@final
class Nearest:
    """The poses of a manipulator's motion that are nearest to displacements of the platform, and what these are off by."""

    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, d): task coordinates, metres and radians."""
    @property
    def rotation(self) -> NDArray[np.float64]:
        """(n, 3): rotation vectors from the orientations at the poses to those given, base coordinates, radians; zero in the motion."""
    @property
    def translation(self) -> NDArray[np.float64]:
        """(n, 3): from the platform's points at the poses to those given, base coordinates, metres; zero in the motion."""

@final
class Singularity:
    """How near many poses are to singular, (n,) each: signed measures without dimension that vanish at a singularity.

    NaN where a pose is out of reach, and of parallel ones where the inputs are too few to hold the section at all.
    """

    def _repr_html_(self) -> str: ...
    @property
    def upper_serial(self) -> NDArray[np.float64]:
        """(n,), no unit: of the upper section: zero where the chain of a leg is."""
    @property
    def upper_parallel(self) -> NDArray[np.float64]:
        """(n,), no unit: of the upper section: zero where its inputs do not hold it."""
    @property
    def lower_serial(self) -> NDArray[np.float64]:
        """(n,), no unit: of the lower section: zero where the chain of a leg is."""
    @property
    def lower_parallel(self) -> NDArray[np.float64]:
        """(n,), no unit: of the lower section: zero where its inputs do not hold it."""
    @property
    def serial(self) -> NDArray[np.float64]:
        """(n,), no unit: of the whole mechanism."""
    @property
    def parallel(self) -> NDArray[np.float64]:
        """(n,), no unit: of the whole mechanism."""
    @property
    def condition(self) -> NDArray[np.float64]:
        """(n,), no unit: condition number of the actuated joints' Jacobian by the platform's twist; infinite at a singularity."""
    @property
    def manipulability(self) -> NDArray[np.float64]:
        """(n,), no unit: the volume that unit rates of the actuated joints span of twists, lengths over the characteristic length."""
    @property
    def coordinates(self) -> NDArray[np.float64]:
        """(n,), no unit: zero where the coordinates of the pose are singular, which is nothing to the mechanism."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): in reach, limits apart."""

@final
class Solid:
    """A simple body to draw, in base coordinates."""

    @property
    def body(self) -> str:
        """The body that it is a part of: ``"base"``, ``"LEG/JOINT"``, ``"platform"``, ``"imaginary/NAME"``."""
    @property
    def shape(self) -> str:
        """``"cylinder"``, ``"ball"`` or ``"block"``."""
    @property
    def material(self) -> str:
        """``"base"``, ``"link"``, ``"actuated"``, ``"passive"``, ``"platform"`` or ``"imaginary"``."""
    @property
    def ends(self) -> NDArray[np.float64]:
        """(2, 3): the ends of its axis, metres; of a ball both are its middle."""
    @property
    def width(self) -> float:
        """Diameter, or side of the square of a block; metres."""

@final
class Solutions:
    """Joint values of ``n`` poses, NaN where a pose is out of reach.

    Of one working mode the arrays have the shapes below. Of all of them there is an axis more after the first, with an
    entry a mode: ``(n, m, k)``, ``(n, m, j)``, ``(n, m)``.
    """

    @property
    def joints(self) -> NDArray[np.float64]:
        """(n, k): every joint coordinate, metres and radians."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(n, j): every imaginary joint, metres and radians."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): in reach, limits apart."""
    @property
    def within_limits(self) -> NDArray[np.bool_]:
        """(n,): in reach, and all joints within their limits."""
    @property
    def joint_names(self) -> list[str]:
        """Of the last axis of `joints`."""
    @property
    def imaginary_names(self) -> list[str]:
        """Of the last axis of `imaginary`."""
    @property
    def units(self) -> dict[str, str]:
        """``"m"`` or ``"rad"`` of every joint and imaginary joint, by name."""
    @property
    def mode(self) -> str:
        """The working mode, or ``"all"``."""
    @property
    def modes(self) -> list[str]:
        """The working modes: of the mode axis, if there is one."""
    @property
    def rows(self) -> int:
        """n."""
    def __len__(self) -> int: ...
    def __getitem__(self, name: str, /) -> NDArray[np.float64]:
        """The values of one joint or imaginary joint, (n,): a view."""
    def _repr_html_(self) -> str: ...

@final
class Measure:
    """How much of a box is in reach and within all limits, between two bounds that are guaranteed.

    In the product of metres and radians of the coordinates with a range; a tilt is weighed by its sine, so that a measure of
    orientations is Haar's.
    """

    @property
    def value(self) -> float:
        """The middle of the bounds."""
    @property
    def lower(self) -> float:
        """The measure is not less."""
    @property
    def upper(self) -> float:
        """The measure is not more."""
    @property
    def whole(self) -> float:
        """The measure of the whole box."""
    @property
    def fraction(self) -> float:
        """``value / whole``."""
    @property
    def units(self) -> str:
        """What it is in: ``"m^2"``, ``"m^2 rad^3"``, ``"1"``."""
    @property
    def boxes(self) -> int:
        """Boxes that were looked at."""
    @property
    def stop(self) -> str:
        """Why it was taken no further: ``"tolerance"`` is met, ``"budget"`` is used up, ``"exhausted"`` where splitting brings
        the bounds no closer."""
    @property
    def over(self) -> dict[str, float | tuple[float, float]]:
        """Of every coordinate lowest and highest value, or the one that it is held at, as :func:`measure` takes them."""

@final
class Outline:
    """The boundary of a workspace in a plane, or of one slice of it: closed polylines along the steps of the grid.

    They run half-way between points that are in and their neighbours that are out, and along the edge of the grid where the
    workspace goes on beyond.
    """

    @property
    def axes(self) -> tuple[str, str]:
        """The coordinates of the plane: the columns of the polylines."""
    @property
    def at(self) -> dict[str, float]:
        """The coordinate that it is sliced by, and its value; empty where there is one plane."""
    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """Closed polylines, (n, 2) each, metres and radians; the last corner is the first one again. Counter-clockwise around
        pieces of the workspace, clockwise around holes."""
    @property
    def outer(self) -> tuple[NDArray[np.float64], ...]:
        """Those around pieces."""
    @property
    def holes(self) -> tuple[NDArray[np.float64], ...]:
        """Those around holes."""
    @property
    def area(self) -> float:
        """Of the pieces without the holes, in the product of both coordinates' units."""

@final
class Conditioning:
    """How well the poses of a workspace are conditioned: their local indices, one over the condition number each."""

    @property
    def global_index(self) -> float | None:
        """The mean of the local indices (Gosselin and Angeles); None where no pose has one."""
    @property
    def local_min(self) -> float | None:
        """The least."""
    @property
    def local_max(self) -> float | None:
        """The greatest; one at best."""
    @property
    def length(self) -> float:
        """Characteristic length of the condition numbers, metres."""
    @property
    def poses(self) -> int:
        """Poses that have an index."""

@final
class Sweep:
    """A grid, swept: a workspace of some kind, of which a point is a pose, a place or an orientation."""

    @property
    def kind(self) -> str:
        """What the workspace is of, as it was asked for."""
    @property
    def mode(self) -> str:
        """The working mode, as it was asked for."""
    @property
    def max_condition(self) -> float | None:
        """The largest condition number at which a pose counts, if there is one."""
    @property
    def length(self) -> float:
        """Characteristic length of condition numbers, metres."""
    def _repr_html_(self) -> str: ...
    @property
    def count(self) -> int:
        """Points of the workspace: of poses, those in reach and within all limits."""
    @property
    def poses(self) -> int:
        """Points of the grid that could be in: poses, places of the grid, or orientations of it."""
    @property
    def fraction(self) -> float:
        """``count / poses``."""
    @property
    def orientations(self) -> int:
        """Orientations of the grid: values of the upper section's coordinates together."""
    @property
    def imaginary_range(self) -> dict[str, tuple[float, float] | None]:
        """Lowest and highest value of every imaginary joint over the reachable poses of the grid."""
    @property
    def axes(self) -> dict[str, NDArray[np.float64]]:
        """The values of every coordinate of the points, in the order of the mask's axes."""
    @property
    def grid(self) -> dict[str, NDArray[np.float64]]:
        """The values of every coordinate of the grid; of places and orientations, the others as well."""
    @property
    def units(self) -> dict[str, str]:
        """``"m"`` or ``"rad"`` of every coordinate of the grid, by name."""
    def mask(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.bool_]:
        """Which points are in: an axis a coordinate of :attr:`axes`, as many values as the grid has.

        `executor` and `shards` are those of :func:`sweep`, here and in all other methods; places and orientations are known
        already, and nobody is asked again.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def points(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.float64]:
        """(count, d): the points in the order of the grid, the first coordinate fastest; columns as :attr:`axes`.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def visits(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.uint64]:
        """In how many :attr:`orientations` each place is reached, in the shape of the mask.

        Raises
        ------
        OpmError
            Of another kind than ``"reachable"`` and ``"dexterous"``.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def boundary(self, *, executor: _Executor | None = None, shards: int | None = None) -> list[Outline]:
        """The boundary as closed polylines in the first two coordinates that have several values.

        Returns
        -------
        list of Outline
            One; or, where a third coordinate has several values, one for each of these.

        Raises
        ------
        OpmError
            Fewer or more coordinates with several values; or of kind ``"imaginary"``, where the boundary of the orientations
            says nothing of the imaginary joints.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def components(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.uint64]:
        """How many points each connected component has, the largest first.

        Points are neighbours where they differ by one step along one coordinate; an angle whose values come full circle has its
        last value next to the first. :meth:`labels` tells which point is in which.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def labels(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.int32]:
        """Which connected component each point belongs to, in the shape of the mask: 0 where the mask is False, 1 in the largest.

        As of ``scipy.ndimage.label``, but for angles that come full circle. Component ``i`` has ``components()[i - 1]`` points;
        of several of one size the one with the first point comes first.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def conditioning(self, *, executor: _Executor | None = None, shards: int | None = None) -> Conditioning:
        """The global conditioning index, and the least and greatest local one: a few microseconds a reachable pose.

        Each pose in the first working mode that counts; every pose has the same weight.

        Raises
        ------
        OpmError
            The points are no poses.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def local_conditioning(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.float64]:
        """The local conditioning index of every pose, in the shape of the mask: NaN where the mask is False.

        One over the condition number: one at best, zero at a singularity.

        Raises
        ------
        OpmError
            The points are no poses.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def measure(
        self,
        *,
        tolerance: float | None = None,
        budget: int | None = None,
        executor: _Executor | None = None,
        shards: int | None = None,
    ) -> Measure:
        """How much of the box that the grid covers is in reach: :func:`measure` over it.

        Raises
        ------
        OpmError
            The points are places or orientations, or there is a `max_condition`, of which a measure knows nothing.

        Parameters
        ----------
        tolerance : float, optional
            As for :func:`measure`.
        budget : int, optional
            As for :func:`measure`.
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def write(
        self,
        path: str | PathLike[str],
        *,
        axes: Sequence[str] | None = None,
        scalars: Sequence[str] | None = None,
        color: str | None = None,
    ) -> None:
        """Record the points as ``opm workspace -o`` does, byte for byte.

        With the boundary, but for kind ``"grid"``. Points that are no poses are written as MCAP only. The fields of an NPY file
        are those of ``axes``, then of ``scalars``, then of ``color``, each once; without ``scalars`` the other task coordinates
        come last.

        Parameters
        ----------
        path : path
            Ends in ``.mcap`` (Foxglove, Lichtblick, Rerun), ``.npy`` (NumPy) or ``.ply`` (mesh tools). The file appears
            when it is whole.
        axes : sequence of three str, or "tip", optional
            The coordinates that are x, y and z of the cloud (of kind ``"imaginary"`` imaginary joints), or the platform's point.
        scalars : sequence of str, optional
            Values stored with every point: task coordinates, imaginary joints, actuated joints, ``inverse_condition``; of places
            the ``share`` of orientations in which they are reached.
        color : str, optional
            The one of them that the colour shows.

        Raises
        ------
        OpmError
            A name that is none, a file that cannot be written.
        """
    def write_mcap(
        self,
        path: str | PathLike[str],
        *,
        axes: Sequence[str] | None = None,
        scalars: Sequence[str] | None = None,
        color: str | None = None,
    ) -> None:
        """:meth:`write`, of a name that ends in ``.mcap``.

        Parameters
        ----------
        path : path
            The file appears when it is whole.
        axes : sequence of three str, or "tip", optional
            As for :meth:`write`.
        scalars : sequence of str, optional
            As for :meth:`write`.
        color : str, optional
            As for :meth:`write`.
        """

def sweep(
    manipulator: Manipulator,
    /,
    *,
    kind: str = "grid",
    mode: str = "home",
    max_condition: float | None = None,
    length: float | None = None,
    threads: int | None = None,
    executor: _Executor | None = None,
    shards: int | None = None,
    **axes: float | tuple[float, float, SupportsIndex],
) -> Sweep:
    """Find which poses of a grid are reachable and within all limits, or another kind of workspace.

    Parameters
    ----------
    manipulator : Manipulator
    kind : str
        What the workspace is of, in Merlet's terms; orientations are the coordinates of the upper section, places those of the
        lower one.

        * ``"grid"``: poses.
        * ``"constant-orientation"``, ``"orientation"``: poses, with each coordinate of the upper or of the lower section held
          at one value.
        * ``"reachable"``, ``"dexterous"``: places that are reached in any, or in every orientation of the grid.
        * ``"imaginary"``: orientations in which any place of the grid is reached: those that the imaginary joints follow from.
        * ``"upper"``: the upper section alone, by its task coordinates, with the ranges of the imaginary joints that it needs.
        * ``"lower"``: the lower section alone, by its task coordinates and the imaginary joints.
    mode : str
        ``"home"``, ``"any"``, or a sign for every two-valued choice.
    max_condition : float, optional
        Only poses with a condition number of at most this count, in a mode in which they have it.
    length : float, optional
        Characteristic length of condition numbers, metres. The spread of the joint axes if not given.
    threads : int, optional
        1 to 1024, here or in each worker; the result does not depend on it. A processor each if not given.
    executor : concurrent.futures.Executor or callable, optional
        Who does the work: a ``ProcessPoolExecutor``, a Dask cluster's ``client.get_executor(pure=False)``, one of
        ``mpi4py.futures``. What is sent is the manipulator, the grid and the number of a shard; the result is that of one
        process, to the bit. The shard of a lost worker runs again, three times at most. A process pool that has lost a worker
        takes no more work: give a function that makes one, and the shards that are missing go to a new one.
    shards : int, optional
        How many parts the executor gets: 8 a worker if not given, 64 where it does not say how many it has; fewer for small
        grids.
    **axes
        Of each coordinate one value, or ``(min, max, count)`` with both ends on the grid; metres and radians. One that
        is not given stays at home. Where none is given, the grid is fitted to the workspace, with a warning where that goes
        on beyond it.

    Raises
    ------
    OpmError
        An axis that is none, ends that are not numbers or reversed, an unknown kind or mode, a grid that the kind is not of;
        more places or orientations than fit in memory; shards that were lost again and again.

    Examples
    --------
    >>> import opm_kinematics as opm
    >>> m = opm.examples.load("plano-spherical-5dof")
    >>> tilt = (-0.2, 0.2, 5)
    >>> opm.sweep(m, kind="dexterous", x=(-0.1, 0.1, 41), y=(-0.1, 0.1, 41), zeta=tilt, xi=tilt, psi=tilt)
    """

def measure(
    manipulator: Manipulator,
    /,
    *,
    over: Mapping[str, float | tuple[float, float]] | None = None,
    section: str = "whole",
    mode: str = "home",
    tolerance: float | None = None,
    budget: int | None = None,
    threads: int | None = None,
    executor: _Executor | None = None,
    shards: int | None = None,
) -> Measure:
    """Measure the workspace, or how much of orientations or places one section alone reaches, with guaranteed bounds.

    Parameters
    ----------
    manipulator : Manipulator
    over : mapping, optional
        Of each coordinate ``(min, max)`` or one value; metres and radians. If nothing is given, ranges that are fitted to the
        workspace, and of the upper section alone every orientation; else one that is not given stays at home.
    section : str
        ``"whole"``: poses. ``"upper"`` or ``"lower"``: one section alone, as those kinds of :func:`sweep`.
    mode : str
        ``"home"``, ``"any"``, or a sign for every two-valued choice.
    tolerance : float, optional
        How far the true measure may be from the value, as a share of it: 0.01 if not given.
    budget : int, optional
        Boxes to look at, at most: 2**22 if not given.
    threads : int, optional
        1 to 1024, here or in each worker; the result does not depend on it. A processor each if not given.
    executor : concurrent.futures.Executor or callable, optional
        Who is asked for the boxes, as for :func:`sweep`; the result is that of one process, to the bit. It gets the rounds of
        more than 4096 boxes; smaller ones, not worth the way, are answered in this process, which fits ranges, too. An
        executor that a function makes serves all rounds.
    shards : int, optional
        How many parts of a round the executor gets: as for :func:`sweep`, but of at least 4096 boxes each but for the last.

    Raises
    ------
    OpmError
        A coordinate that is none, ends that are not numbers in order, an unknown section or mode; parts that were lost again
        and again.
    """

@final
class Trajectory:
    """A motion as the joints follow it, ``n`` samples; NaN where it is out of reach, or a joint has no rate."""

    @property
    def name(self) -> str:
        """Of the motion."""
    @property
    def mode(self) -> str:
        """The working mode."""
    @property
    def times(self) -> NDArray[np.float64]:
        """(n,), seconds."""
    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, d): task coordinates, metres and radians."""
    @property
    def pose_rates(self) -> NDArray[np.float64]:
        """(n, d): their first derivatives by time, m/s and rad/s."""
    @property
    def pose_accelerations(self) -> NDArray[np.float64]:
        """(n, d): their second derivatives, m/s² and rad/s²."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """(n, k): every joint coordinate, metres and radians; angles go on across half turns."""
    @property
    def joint_rates(self) -> NDArray[np.float64]:
        """(n, k), m/s and rad/s."""
    @property
    def joint_accelerations(self) -> NDArray[np.float64]:
        """(n, k), m/s² and rad/s²."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(n, j): every imaginary joint, metres and radians."""
    @property
    def imaginary_rates(self) -> NDArray[np.float64]:
        """(n, j), m/s and rad/s."""
    @property
    def imaginary_accelerations(self) -> NDArray[np.float64]:
        """(n, j), m/s² and rad/s²."""
    @property
    def condition(self) -> NDArray[np.float64]:
        """(n,), no unit: condition number of the actuated joints' Jacobian by the platform's twist."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): in reach, limits apart."""
    @property
    def within_limits(self) -> NDArray[np.bool_]:
        """(n,): in reach, and all joints within their limits."""
    @property
    def regular(self) -> NDArray[np.bool_]:
        """(n,): in reach, and every joint has its rate."""
    @property
    def violations(self) -> list[Violation]:
        """What it cannot follow, found between the samples too, in the order of time."""
    @property
    def joint_names(self) -> list[str]:
        """Of the columns of `joints`."""
    @property
    def imaginary_names(self) -> list[str]:
        """Of the columns of `imaginary`."""
    @property
    def units(self) -> dict[str, str]:
        """``"m"`` or ``"rad"`` of every joint and imaginary joint, by name."""
    @property
    def rows(self) -> int:
        """n."""
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...
    def __getitem__(self, name: str, /) -> NDArray[np.float64]:
        """The values of one joint or imaginary joint, (n,): a view."""
    def write_mcap(self, path: str | PathLike[str]) -> None:
        """Record the motion as ``opm trajectory -o`` does, byte for byte: it plays in Foxglove, Lichtblick and Rerun.

        Parameters
        ----------
        path : path
            The file appears when it is whole.

        Raises
        ------
        OpmError
            A file that cannot be written.
        """

@final
class Violation:
    """A part of a motion that the mechanism cannot follow, or a singularity on its way."""

    @property
    def kind(self) -> str:
        """``"reach"``, ``"limit"`` or ``"singularity"``."""
    @property
    def start(self) -> float:
        """Seconds."""
    @property
    def end(self) -> float:
        """Seconds; of a singularity, as `start`."""
    @property
    def worst(self) -> float:
        """When it is worst, seconds."""
    @property
    def amount(self) -> float:
        """By how much, there; in :attr:`unit`."""
    @property
    def unit(self) -> str:
        """Of the amount: ``"m"``, ``"rad"``, or ``"1"`` for what is left of a singularity's measure."""
    @property
    def leg(self) -> str | None:
        """The leg that it is about."""
    @property
    def joint(self) -> str | None:
        """The joint that is past its limit."""
    @property
    def section(self) -> str | None:
        """``"lower"`` or ``"upper"``: what is out of reach or singular."""
    @property
    def bound(self) -> str | None:
        """``"lowest"`` or ``"highest"``: the limit that is passed."""
    @property
    def singularity(self) -> str | None:
        """``"serial"`` or ``"parallel"``."""
    @property
    def message(self) -> str:
        """All of it, as a line."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

def trajectory(
    manipulator: Manipulator,
    motion: str | PathLike[str] | ArrayLike,
    /,
    *,
    times: Sequence[float] | NDArray[np.float64] | None = None,
    rate: float | None = None,
    mode: str | None = None,
) -> Trajectory:
    """Follow a motion of the platform.

    Parameters
    ----------
    manipulator : Manipulator
    motion : path, str or (w, d) array_like
        A motion file, a table of poses (``.csv``), or the name of a shipped motion; or, with `times`, waypoints, a task
        coordinate a column, which a natural cubic spline goes through; angles are brought within half a turn of the
        waypoint before, as those of a table are.
    times : (w,) sequence of float, optional
        When the waypoints are, seconds, increasing; three at least.
    rate : float, optional
        Samples a second; what the file asks for, or 100, if not given. The last sample is at the end of the motion.
    mode : str, optional
        ``"home"``, or a sign for every two-valued choice; what the file asks for, or home, if not given.

    Raises
    ------
    OSError
        The file cannot be read.
    OpmError
        Every problem of the file with its line and column; waypoints that are not poses, times that do not increase (of which waypoint,
        counted from zero).
    """

def examples() -> list[str]:
    """Names of the mechanisms that come with the package."""

def example(name: str) -> str:
    """The text of one of them.

    Parameters
    ----------
    name : str
        One of :func:`examples`.

    Returns
    -------
    str
        The mechanism file.

    Raises
    ------
    OpmError
        There is no example of this name.
    """

def command(arguments: Sequence[str]) -> int:
    """Do what a command line asks for.

    Parameters
    ----------
    arguments : sequence of str
        The program's name first.

    Returns
    -------
    int
        The status to exit with.
    """
