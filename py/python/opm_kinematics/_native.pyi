from collections.abc import Callable, ItemsView, Iterator, KeysView, Mapping, Sequence, ValuesView
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex, TypeAlias, final

import numpy as np
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from .plot import Animation

__all__ = [
    "Accuracy",
    "AccuracyBounds",
    "AccuracySamples",
    "Aspect",
    "Analysis",
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
    "OpmError",
    "Outline",
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
    "command",
    "example",
    "examples",
    "explore",
    "measure",
    "recover",
    "sweep",
    "trajectory",
]

__version__: str

class OpmError(ValueError):
    """A mechanism, a pose or an option with which opm cannot compute."""

_Parameter: TypeAlias = float | Sequence[float] | NDArray[np.float64] | None

# Numbers, one row or many; or numbers or columns by name.
_Rows: TypeAlias = ArrayLike | Mapping[str, ArrayLike] | Any

_Executor: TypeAlias = Executor | Callable[[], Executor]

@final
class Decomposition:
    """How the legs of a mechanism are split in two: the result of ``opm decompose``."""

    @property
    def name(self) -> str:
        """Name of the mechanism."""
    @property
    def rank(self) -> int:
        """Rank of all joint screws, lambda."""
    @property
    def mobility(self) -> int:
        """Mobility of the mechanism, N."""
    @property
    def imaginary_joints(self) -> int:
        """Motions of the upper section with its imaginary joints, J; the number of these joints may be another."""
    @property
    def first_section_motions(self) -> int:
        """Motions of the lower section with the imaginary joints held, M = N - J."""
    @property
    def lower(self) -> str:
        """Subspace of the lower section: ``"planar"``, for instance."""
    @property
    def upper(self) -> str | None:
        """Subspace of the upper section; None where all legs move in one subspace."""
    @property
    def intersection(self) -> Intersection | None:
        """The motion that both sections have in common; None where that is the identity alone."""
    @property
    def legs(self) -> list[LegSplit]:
        """One entry for each leg, in the order of the mechanism file."""
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
        """A point of the axis, metres; None for a translation."""
    @property
    def pitch(self) -> float | None:
        """Advance of a helical motion, metres per radian."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class LegSplit:
    """How one leg is split between the two sections."""

    @property
    def name(self) -> str:
        """Name of the leg."""
    @property
    def lower(self) -> list[str]:
        """Joints in the lower section, base first."""
    @property
    def upper(self) -> list[str]:
        """Joints in the upper section, base first."""
    @property
    def imaginary(self) -> str | None:
        """The imaginary joint at the split."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class TaskCoordinate:
    """One coordinate of the pose."""

    @property
    def name(self) -> str:
        """Name of the coordinate: ``"x"``, ``"zeta"``, ..."""
    @property
    def home(self) -> float:
        """The value at home, metres or radians."""
    @property
    def unit(self) -> str:
        """``"m"`` or ``"rad"``."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Explorer:
    """A page that shows a mechanism and its workspace in a browser, without a network: the file that ``opm explore`` writes.

    In a notebook it shows itself, as the last value of a cell.
    """

    @property
    def name(self) -> str:
        """The mechanism's name."""
    @property
    def html(self) -> str:
        """The whole page: the text of an HTML file."""
    def save(self, path: str | PathLike[str]) -> None:
        """Write the page to a file, which is replaced if it exists.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file, which ends in ``.html``.

        Raises
        ------
        OSError
            The file cannot be written.
        OpmError
            Its name does not end in ``.html``.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def _repr_html_(self) -> str: ...

@final
class Joint:
    """A joint of a leg at home, in base coordinates. Its lists have an entry for each of its coordinates: one, two or three."""

    @property
    def name(self) -> str:
        """Name of the joint."""
    @property
    def kind(self) -> str:
        """``"revolute"``, ``"prismatic"``, ``"helical"``, ``"cylindrical"``, ``"universal"`` or ``"spherical"``."""
    @property
    def axis(self) -> tuple[float, float, float] | None:
        """Unit vector along the axis; None for a spherical joint."""
    @property
    def axis2(self) -> tuple[float, float, float] | None:
        """Unit vector along a universal joint's axis next to the platform; None for others."""
    @property
    def point(self) -> tuple[float, float, float]:
        """A point of the axis, metres; the centre of a universal or spherical joint; where a prismatic joint is drawn."""
    @property
    def pitch(self) -> float | None:
        """Advance of a helical joint, metres per radian; None for others."""
    @property
    def actuated(self) -> bool:
        """Whether a motor drives it."""
    @property
    def coordinates(self) -> list[str]:
        """Names of its coordinates, as in `joints`."""
    @property
    def units(self) -> list[str]:
        """``"m"`` or ``"rad"``."""
    @property
    def home(self) -> list[float]:
        """The values at home, metres and radians."""
    @property
    def limits(self) -> list[tuple[float, float] | None]:
        """The lowest and the highest value, or None."""
    @property
    def max_rate(self) -> list[float | None]:
        """The largest rate, per second, or None."""
    @property
    def max_acceleration(self) -> list[float | None]:
        """The largest acceleration, per second squared, or None."""
    @property
    def max_effort(self) -> list[float | None]:
        """The largest effort of the actuator, N or N m, or None."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Linkage:
    """A single loop that decomposes into the loops of two sections, which share an imaginary joint.

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
    def load(path: str | PathLike[str], *, tolerance: float | None = None) -> Linkage:
        """Read a mechanism file.

        Parameters
        ----------
        path : path
            TOML. Shipped linkages are read by :func:`examples.linkage`.
        tolerance : float, optional
            Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
            count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
            much it was off; `text` is then the corrected mechanism.

        Returns
        -------
        Linkage
            Decomposed and compiled.

        Raises
        ------
        OSError
            The file cannot be read. If it does not exist, this is a FileNotFoundError with its name.
        OpmError
            Lists every problem of the file with its line and column, or says why it is not a single loop of two sections.
        """
    @staticmethod
    def parse(text: str, label: str | None = None, *, tolerance: float | None = None) -> Linkage:
        """Read the text of a mechanism file.

        Parameters
        ----------
        text : str
            TOML.
        label : str, optional
            The name that messages use for the text.
        tolerance : float, optional
            Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
            count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
            much it was off; `text` is then the corrected mechanism.

        Returns
        -------
        Linkage
            Decomposed and compiled.

        Raises
        ------
        OpmError
            Lists every problem of the text with its line and column, or says why it is not a single loop of two sections.
        """
    @property
    def name(self) -> str:
        """The mechanism's name."""
    @property
    def text(self) -> str:
        """The mechanism file."""
    @property
    def joint_names(self) -> list[str]:
        """Names of all joint coordinates: the columns of joint values."""
    @property
    def imaginary_name(self) -> str:
        """Name of the imaginary joint."""
    @property
    def home(self) -> list[float]:
        """(k,): every joint at home, radians and metres."""
    def home_branch(self, input: str | None = None) -> str:
        """The branch in which the linkage is assembled, if one of its joints moves it.

        Parameters
        ----------
        input : str, optional
            Name of the joint; the actuated one if not given.

        Returns
        -------
        str
            Two signs: the first for the loop with the input, the second for the other one. A loop without a choice has +.

        Raises
        ------
        OpmError
            There is no joint of this name.
        """
    def to_urdf(self, *, density: float | None = None) -> str:
        """The mechanism as a tree of links (URDF): the text of an XML file.

        URDF has no loops; :meth:`to_closures` closes them. Joints have the names and the values of `joints`, but a ball is
        three revolute joints ``NAME.1``, ``NAME.2`` and ``NAME.3``. A helical joint has a slide that follows it, which
        Pinocchio reads with ``mimic=True``. The platform is the link ``platform``. It is the file that ``opm export urdf``
        writes.

        Parameters
        ----------
        density : float, optional
            Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
            2700, if not given.

        Returns
        -------
        str
            For ``pinocchio.buildModelFromXML``, or a file.

        Raises
        ------
        OpmError
            The density is not positive.
        """
    def to_closures(self) -> str:
        """What closes the loops of the tree of :meth:`to_urdf`: the text of a YAML file.

        It is what the loader of Gepetto's example-parallel-robots for Pinocchio reads: ``closed_loop`` has pairs of links
        that coincide, ``type`` their type, and ``name_mot`` the actuated joints.
        """
    def to_mjcf(self, *, density: float | None = None, time_step: float = 0.001) -> str:
        """The mechanism as a model of MuJoCo (MJCF), with its closed loops: the text of an XML file.

        Joints have the names and the values of `joints`; the platform is the body ``platform``. Each actuated joint has a
        position servo of its name, and each branch with the input at home a keyframe, named by its
        signs: ``p_m`` is ``+ -``. It is the file that ``opm export mjcf`` writes.

        Parameters
        ----------
        density : float, optional
            Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
            2700, if not given.
        time_step : float
            Time step of the simulation, seconds; the loops are held as stiffly as it allows.

        Returns
        -------
        str
            For ``mujoco.MjModel.from_xml_string``, or a file.

        Raises
        ------
        OpmError
            A number is not positive.
        """
    def range(self, input: str | None = None) -> NDArray[np.float64]:
        """The range of one joint in which the loop closes, joint limits not considered.

        Parameters
        ----------
        input : str, optional
            Name of the joint; the actuated one if not given.

        Returns
        -------
        (r, 2) array
            Lowest and highest value of every interval, radians or metres; infinite where a slider has no end. A full revolution
            is given as the interval around home.

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
        values : float or (n,) array_like
            Values of the joint that moves the linkage, radians or metres. One value gives arrays without the first axis. Where
            a value is NaN, so is the position.
        input : str, optional
            Name of that joint; the actuated one if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Solutions
            The arrays have the shapes ``(n, 4, k)``, ``(n, 4, 1)`` and ``(n, 4)``, with the four branches as modes. NaN where the
            loop does not close. Angles are within π of their home values, unless the joint limits allow another revolution;
            ``np.unwrap`` along the first axis makes angles over full revolutions continuous.

        Raises
        ------
        OpmError
            There is no joint of this name, or a value is infinite; the message gives its index, counted from zero.
        """

@final
class Manipulator:
    """A mechanism, decomposed and compiled for closed-form inverse kinematics.

    Immutable; it can be pickled, and shared between threads.
    """

    @staticmethod
    def load(path: str | PathLike[str], *, tolerance: float | None = None) -> Manipulator:
        """Read a mechanism file.

        Parameters
        ----------
        path : path
            TOML. Shipped mechanisms are read by :func:`examples.load`.
        tolerance : float, optional
            Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
            count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
            much it was off; `text` is then the corrected mechanism.

        Returns
        -------
        Manipulator
            Decomposed and compiled.

        Raises
        ------
        OSError
            The file cannot be read. If it does not exist, this is a FileNotFoundError with its name.
        OpmError
            Lists every problem of the file with its line and column, or says why it has no closed-form inverse kinematics.
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
        tolerance: float | None = None,
    ) -> Manipulator:
        """Compile a mechanism that is given by the screws of its joints at an assembled pose, home.

        It is decomposed like any other; `text` is an equivalent mechanism file.

        Parameters
        ----------
        legs : mapping of str to (n, 6) array_like, or sequence of them
            One array for each leg, by name; without names the legs are leg1, leg2, ... A row is the twist (omega; v) of a
            joint with one degree of freedom, in the base frame, from base to platform, of any length except zero:
            ``(a, p × a + h a)`` rotates about ``a`` through ``p`` with an advance of ``h`` metres per radian, ``(0, a)``
            slides along ``a``. A joint with several degrees of freedom has several rows. Numbers may be rounded, as those of
            float32 are: an advance below one ten-thousandth of the mechanism's size is none.
        actuated : sequence of (n,) sequences of bool
            Which joints are actuated: one sequence for each leg.
        home : sequence of (n,) sequences of float, optional
            Joint values at home, radians and metres; zero if not given.
        limits : sequence of (n,) sequences of (float, float) or None, optional
            Lowest and highest value of each joint. ``None``, or two infinite values, means no limits.
        joints : sequence of (n,) sequences of str, optional
            Names of the joints; if not given, q1_1, q1_2, ... (number of the leg, then of the joint).
        platform : (3,) sequence of float
            Reference point of the platform at home, metres; the base's origin if not given.
        name : str
            Name of the mechanism.
        tolerance : float, optional
            Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
            count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
            much it was off; `text` is then the corrected mechanism.

        Raises
        ------
        OpmError
            Says what is wrong with which joint of which leg, or why the mechanism has no closed-form inverse kinematics.
        """
    @staticmethod
    def parse(text: str, label: str | None = None, *, tolerance: float | None = None) -> Manipulator:
        """Read the text of a mechanism file.

        Parameters
        ----------
        text : str
            TOML.
        label : str, optional
            The name that messages use for the text.
        tolerance : float, optional
            Accept joints that miss their subspaces by at most this length, metres, and move them exactly into these. Angles
            count as lengths at the mechanism's size. Each joint that is moved gives a UserWarning with its name and by how
            much it was off; `text` is then the corrected mechanism.

        Returns
        -------
        Manipulator
            Decomposed and compiled.

        Raises
        ------
        OpmError
            Lists every problem of the text with its line and column, or says why it has no closed-form inverse kinematics.
        """
    @property
    def name(self) -> str:
        """The mechanism's name."""
    @property
    def text(self) -> str:
        """The mechanism file. After :meth:`with_parameters` it is in metres and radians and gives equal results to the bit."""
    @property
    def parameters(self) -> dict[str, float | tuple[float, float] | None]:
        """The geometric parameters of its family by name; empty for a list of joints.

        ``home.x`` is a coordinate of home, ``leg1.h`` a parameter of the leg of this name, ``leg1.limits.S`` the limits of one
        of its joints, ``leg1.max_rate.S`` and ``leg1.max_acceleration.S`` those of its motion, ``leg1.max_effort.S`` that of its
        actuator, ``leg1.offset.S`` the offset of its encoder. Values are in metres, radians, seconds and newtons. A point is ``(x, y)``; limits are ``(lowest, highest)``, or None if there are none, and so is an offset.
        """
    def with_parameters(
        self, changes: Mapping[str, _Parameter] | None = None, /, **named: _Parameter
    ) -> Manipulator:
        """The same mechanism with some of its :attr:`parameters` changed, or homes and limits of a list of joints: assembled, decomposed and compiled anew.

        Parameters
        ----------
        changes : mapping, optional
            New values by name. A name without its leg (``h``, ``limits.S``) sets the parameter in every leg that has it; a
            full name (``leg1.h``) sets it in one leg and takes precedence. In a list of joints, ``S1.limits``,
            ``S1.max_rate``, ``S1.max_acceleration``, ``S1.max_effort`` and ``S1.home`` are those of one joint coordinate, and
            ``limits`` those of all joints that have any.
        **named
            New values for names without dots.

        Returns
        -------
        Manipulator
            A new manipulator, assembled at the same home pose in the same working mode; this one does not change.

        Raises
        ------
        OpmError
            A name is not a parameter (the message lists those that exist), a value is not valid, a leg does not reach home, or
            the home pose is singular. The message lists every such problem.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof")
        >>> longer = m.with_parameters({"leg1.h": 0.13, "limits.S": (-0.25, 0.25)}, a2=0.05)
        >>> longer.parameters["leg1.h"], longer.parameters["leg2.h"], longer.parameters["leg2.a2"]
        (0.13, 0.12, 0.05)
        """
    def with_coordinates(self, coordinates: str) -> Manipulator:
        """The same mechanism with other angles for its orientation.

        Parameters
        ----------
        coordinates : str
            ``"euler-angles"``: ``zeta xi psi``, R = Rz(zeta) Ry(xi) Rz(psi). ``"tilt-torsion"``: ``azimuth tilt torsion``,
            R = Rz(azimuth) Ry(tilt) Rz(torsion - azimuth), with the tilt from 0 to pi. Where that is 0 or pi, the azimuth is
            free: :meth:`locate` takes that at home.

        Returns
        -------
        Manipulator
            A new manipulator; this one does not change.

        Raises
        ------
        OpmError
            The name is unknown, or the pose has no Euler angles.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof").with_coordinates("tilt-torsion")
        >>> [c.name for c in m.task_coordinates]
        ['x', 'y', 'azimuth', 'tilt', 'torsion']
        """
    @property
    def task_coordinates(self) -> list[TaskCoordinate]:
        """The coordinates of the pose: the columns of poses."""
    @property
    def dependent_coordinates(self) -> list[TaskCoordinate]:
        """The coordinates that follow from those of the pose, because a leg with few freedoms ties them together; none in most
        mechanisms. :meth:`dependent` gives their values.
        """
    @property
    def joint_names(self) -> list[str]:
        """Names of all joint coordinates: the columns of joint values."""
    @property
    def actuated(self) -> list[int]:
        """Columns of the actuated joints."""
    @property
    def imaginary_names(self) -> list[str]:
        """Names of the imaginary joints: the columns of their values."""
    @property
    def home(self) -> list[float]:
        """(d,): the pose at home, metres and radians."""
    @property
    def home_mode(self) -> str:
        """The working mode that the mechanism is assembled in."""
    @property
    def home_warning(self) -> str | None:
        """What cannot be told at home, where home is a parallel singularity; None where it is regular. Reading such a mechanism gives this as a UserWarning."""
    @property
    def choices(self) -> int:
        """Number of two-valued choices; there are ``2**choices`` working modes."""
    @property
    def decomposition(self) -> Decomposition:
        """How the legs are split in two."""
    @property
    def modes(self) -> list[str]:
        """Every working mode, all-plus first: the mode axis of ``inverse(poses, mode="all")``."""
    @property
    def screws(self) -> dict[str, NDArray[np.float64]]:
        """The joints' unit screws by leg, (f, 6) each: (omega; v) in base coordinates, as they are at home, one row for each degree of freedom."""
    def clearance(
        self, poses: _Rows, *, mode: str = "home", threads: int | None = None
    ) -> Clearance:
        """The two bodies that are nearest to each other at every pose, and how far apart they are.

        Bodies that meet by construction are not tested: those that share a joint, or joints at one point. Nor are pairs that
        overlap at home (:attr:`Clearance.set_aside`), where the shapes are wrong rather than the mechanism.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Clearance
            Distances in metres, and names of pairs.

        Raises
        ------
        OpmError
            The columns are not the task coordinates, a number is not finite, or the mode is unknown.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof")
        >>> clearance = m.clearance([m.home])
        >>> one, other = clearance.pairs[clearance.pair[0]]
        >>> bool(clearance.distance[0] > 0)
        True
        """
    def plot(
        self, pose: _Rows | None = None, *, mode: str = "home", ax: Axes3D | None = None
    ) -> Axes3D:
        """Draw the mechanism in a pose with matplotlib: :func:`opm_kinematics.plot.mechanism`.

        Parameters
        ----------
        pose : (d,) array_like, optional
            Metres and radians. Home if not given.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        ax : Axes3D, optional
            A three-dimensional panel to draw on; a new one if not given.

        Returns
        -------
        Axes3D
            The panel.

        Raises
        ------
        OpmError
            The pose is out of reach.
        ImportError
            matplotlib is not installed.
        """
    def animate(
        self,
        motion: Trajectory | str | PathLike[str] | ArrayLike,
        *,
        mode: str | None = None,
        frames: int = 60,
        ax: Axes3D | None = None,
    ) -> Animation:
        """The mechanism as it follows a motion, as a moving picture: :func:`opm_kinematics.plot.animate`.

        Parameters
        ----------
        motion : Trajectory, path, str or (n, d) array_like
            A motion that was followed, a motion file, a table of poses, the name of a shipped motion, or poses one after the
            other.
        mode : str, optional
            ``"home"``, or a sign for every two-valued choice; if not given, the mode of the motion, or home.
        frames : int
            The most pictures that it consists of, spread evenly over the motion.
        ax : Axes3D, optional
            A three-dimensional panel to draw on; a new one if not given.

        Returns
        -------
        Animation
            It plays in a notebook; :meth:`Animation.save <opm_kinematics.plot.Animation.save>` writes it to a file.

        Raises
        ------
        OpmError
            The motion cannot be read, or no pose of it is in reach.
        ImportError
            matplotlib is not installed.
        """
    def solids(self, pose: _Rows | None = None, *, mode: str = "home") -> list[Solid]:
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
    def mjcf_reference(
        self, motion: str | PathLike[str], *, time_step: float = 0.001, mode: str | None = None
    ) -> tuple[list[str], NDArray[np.float64]]:
        """A motion in the coordinates of the model of :meth:`to_mjcf`: a row for each time step of a simulation.

        A control leads the joint's value by what the servo lags, so that the model follows. It is the table that
        ``opm export mjcf --trajectory`` writes.

        Parameters
        ----------
        motion : path or str
            A motion file, a table of poses (``.csv``), or the name of a shipped motion.
        time_step : float
            Time step of the simulation, seconds: that of :meth:`to_mjcf`.
        mode : str, optional
            ``"home"``, or a sign for every two-valued choice; if not given, the mode of the file, or home.

        Returns
        -------
        tuple of (list of str, (n, 1 + nq + nu) ndarray)
            Names of the columns, and the rows: the time, the values of ``data.qpos``, and those of ``data.ctrl``.

        Raises
        ------
        OSError
            The file cannot be read.
        OpmError
            Lists every problem of the file with its line and column; or the mechanism cannot follow the motion, or it has more
            than a million time steps.
        """
    def to_urdf(self, *, density: float | None = None) -> str:
        """The mechanism as a tree of links (URDF): the text of an XML file.

        URDF has no loops; :meth:`to_closures` closes them. Joints have the names and the values of `joints`, but a ball is
        three revolute joints ``NAME.1``, ``NAME.2`` and ``NAME.3``. A helical joint has a slide that follows it, which
        Pinocchio reads with ``mimic=True``. The platform is the link ``platform``. It is the file that ``opm export urdf``
        writes.

        Parameters
        ----------
        density : float, optional
            Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
            2700, if not given.

        Returns
        -------
        str
            For ``pinocchio.buildModelFromXML``, or a file.

        Raises
        ------
        OpmError
            The density is not positive.
        """
    def to_closures(self) -> str:
        """What closes the loops of the tree of :meth:`to_urdf`: the text of a YAML file.

        It is what the loader of Gepetto's example-parallel-robots for Pinocchio reads: ``closed_loop`` has pairs of links
        that coincide, ``type`` their type, and ``name_mot`` the actuated joints.
        """
    def to_joints(self) -> str:
        """The mechanism as a file that lists its joints, in metres and radians, whatever the form of its own file.

        It gives the same joint values at the same poses, in the same working modes. Imaginary joints are called ``tau.LEG``
        there, and are zero at home. It is the file that ``opm convert --joints`` writes, apart from the units.

        Returns
        -------
        str
            For :meth:`parse`, or a file.
        """
    @property
    def legs(self) -> dict[str, list[Joint]]:
        """The joints of each leg, from base to platform, by the legs' names."""
    @property
    def reference_point(self) -> tuple[float, float, float]:
        """The platform's reference point at home, base coordinates, metres."""
    def twist_jacobian(
        self, poses: _Rows, *, mode: str = "home", threads: int | None = None
    ) -> NDArray[np.float64]:
        """The platform's twist for unit rates of the task coordinates.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        (n, 6, d) ndarray
            The rows are the angular velocity, then the velocity of the platform's reference point, both along the axes of the
            base, rad/s and m/s. NaN where the pose is out of reach.
        """
    def to_mjcf(self, *, density: float | None = None, time_step: float = 0.001) -> str:
        """The mechanism as a model of MuJoCo (MJCF), with its closed loops: the text of an XML file.

        Joints have the names and the values of `joints`; the platform is the body ``platform``. Each actuated joint has a
        position servo of its name, and each working mode that reaches the home pose a keyframe, named by its
        signs: ``pp_mp_p`` is ``++ -+ +``. It is the file that ``opm export mjcf`` writes.

        Parameters
        ----------
        density : float, optional
            Density of all bodies without a mass in the mechanism file, kilograms per cubic metre; that in the file, or else
            2700, if not given.
        time_step : float
            Time step of the simulation, seconds; the loops are held as stiffly as it allows.

        Returns
        -------
        str
            For ``mujoco.MjModel.from_xml_string``, or a file.

        Raises
        ------
        OpmError
            A number is not positive.
        """
    def to_c(self) -> dict[str, str]:
        """The closed-form kinematics as C99 for a controller: the texts of the files, by name.

        ``NAME.h`` and ``NAME.c`` are the code, which depends on ``math.h`` alone; NAME is the mechanism's name with ``_`` for
        what a name of C cannot have. ``NAME_test.c`` compares the code with the poses in ``NAME_golden.h``, and
        ``CMakeLists.txt`` builds both. ``NAME_linuxcnc.c`` is a kinematics module for LinuxCNC. They are the files that
        ``opm generate c`` writes.

        Returns
        -------
        dict
            The text of each file.

        Raises
        ------
        OpmError
            The mechanism has more than 32 two-valued choices.
        """
    def to_rust(self) -> dict[str, str]:
        """The closed-form kinematics as a package of Rust: the texts of the files, by name.

        The package has no allocation and needs no standard library. ``tests/golden.rs`` compares it with poses that opm
        solved. They are the files that ``opm generate rust`` writes.

        Returns
        -------
        dict
            The text of each file; names have ``/`` between folders.

        Raises
        ------
        OpmError
            The mechanism has more than 32 two-valued choices.
        """
    def to_python(self) -> dict[str, str]:
        """The closed-form kinematics as a module of Python: the texts of the files, by name.

        ``NAME.py`` needs NumPy alone and solves arrays of poses at once; NAME is the mechanism's name with ``_`` for what a
        name cannot have. ``test_NAME.py`` compares it with poses that opm solved. They are the files that
        ``opm generate python`` writes.

        Returns
        -------
        dict
            The text of each file.

        Raises
        ------
        OpmError
            The mechanism has more than 32 two-valued choices.
        """
    def to_matlab(self) -> dict[str, str]:
        """The closed-form kinematics as a package of MATLAB: the texts of the files, by name.

        The package ``+NAME`` has a file for each function, which needs no other file; NAME is the mechanism's name with ``_``
        for what a name cannot have. ``NAME_test.m`` compares it with poses that opm solved. They are the files that
        ``opm generate matlab`` writes.

        Returns
        -------
        dict
            The text of each file; names have ``/`` between folders.

        Raises
        ------
        OpmError
            The mechanism has more than 32 two-valued choices.
        """
    def to_st(self) -> dict[str, str]:
        """The closed-form kinematics as structured text (IEC 61131-3) for a PLC: the texts of the files, by name.

        ``NAME.st`` has a function block for each function; NAME is the mechanism's name with ``_`` for what a name cannot have.
        ``NAME_test.st`` compares it with poses that opm solved. They are the files that ``opm generate st`` writes.

        Returns
        -------
        dict
            The text of each file.

        Raises
        ------
        OpmError
            The mechanism has more than 32 two-valued choices.
        """
    def explore(self) -> Explorer:
        """A page that shows the mechanism and its workspace in a browser, or as the value of a cell in a notebook.

        Returns
        -------
        Explorer
            :meth:`Explorer.save` writes it to a file, as ``opm explore`` does.
        """
    def _repr_html_(self) -> str: ...
    def inverse(
        self,
        poses: _Rows | None = None,
        *,
        transforms: ArrayLike | None = None,
        mode: str = "home",
        joints: str = "all",
        threads: int | None = None,
    ) -> Solutions:
        """Inverse kinematics of one pose or of many, in one working mode or in all of them.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping, optional
            One row for each pose, one column for each task coordinate; metres and radians. One pose gives arrays without the
            first axis. A mapping or a data frame has numbers or columns by name, in any order; coordinates that are not among
            them are at home. A row with NaN or a masked entry is out of reach. A float64 array in C order is used without a
            copy and must not be written to meanwhile; anything else is copied and converted first.
        transforms : (4, 4) or (n, 4, 4) array_like, optional
            Homogeneous matrices, metres, in place of poses: where the platform is to be, as :meth:`transform` gives it. What is
            outside the manipulator's motion is out of reach; :meth:`nearest` says by how much.
        mode : str
            ``"home"``; or a sign for every two-valued choice, one group for each leg: ``"++ ++ ++ +"``; or ``"all"``, which
            gives the arrays of the result a second axis, ``(n, m, k)`` instead of ``(n, k)``, with an entry for each
            of the ``m = 2**choices`` modes of `modes`.
        joints : str
            Which joints the ``k`` columns are: ``"all"`` for every joint coordinate, or ``"actuated"``, which takes less memory.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Solutions
            Joint values, NaN for poses out of reach. Angles are within π of their home values, unless the joint limits allow
            another revolution.

        Raises
        ------
        OpmError
            The columns are not the task coordinates, a number is infinite (the message gives the index of its pose, counted
            from zero), a matrix is not a rotation and a position, or the mode is unknown.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof")
        >>> one = m.inverse({"x": 0.01, "xi": 0.1})
        >>> same = m.inverse(transforms=m.transform({"x": 0.01, "xi": 0.1}))
        >>> bool(one.reachable), one["S1"].shape, bool(abs(one["S1"] - same["S1"]) < 1e-12)
        (True, (), True)
        """

    def jacobian(
        self, poses: _Rows, *, mode: str = "home", joints: str = "actuated", threads: int | None = None
    ) -> NDArray[np.float64]:
        """Rates of joints for unit rates of the task coordinates.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        joints : str
            Which joints the ``a`` rows are: ``"actuated"``, or ``"all"`` for every joint coordinate.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        (n, a, d) ndarray
            Ratios of metres and radians. NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
        """
    def velocity(
        self,
        poses: _Rows,
        rates: _Rows,
        accelerations: _Rows | None = None,
        *,
        mode: str = "home",
        threads: int | None = None,
    ) -> Motion:
        """Rates and accelerations of every joint.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        rates : (d,) or (n, d) array_like, or mapping
            First derivatives of the task coordinates by time, m/s and rad/s; one row is for all poses. By name, those that are
            not given are zero.
        accelerations : (d,) or (n, d) array_like, or mapping, optional
            Second derivatives, m/s² and rad/s²; zero if not given.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Motion
            NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
        """
    def singularity(
        self, poses: _Rows, *, mode: str = "home", length: float | None = None, threads: int | None = None
    ) -> Singularity:
        """How near each pose is to a singularity, by section.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        length : float, optional
            Characteristic length of `condition` and `manipulability`, metres. The spread of the joint axes if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Singularity
            One number for each pose and measure, NaN where the pose is out of reach.
        """
    def accuracy(
        self,
        poses: ArrayLike,
        *,
        actuators: tuple[float | None, float | None] | None = None,
        tolerances: Mapping[str, Any] | str | PathLike[str] | None = None,
        errors: str = "axes",
        clearance: tuple[float | None, float | None] | None = None,
        samples: int | None = None,
        seed: int = 1,
        mode: str = "home",
        length: float | None = None,
        threads: int | None = None,
    ) -> Accuracy:
        """Accuracy at many poses: pose errors, sensitivities, and the play that joints need for errors that no motion takes up.

        Parameters
        ----------
        poses : (n, d) array_like
            One row for each pose, one column for each task coordinate; metres and radians.
        actuators : (length, angle), optional
            Errors of actuated joints: of sliders in metres, of others in radians. Either may be None.
        tolerances : dict or path, optional
            Errors of parts, as in a file of tolerances: ``"length"`` and ``"angle"`` of all axes, ``"joint"`` with those of
            single joints, ``"parameter"`` with single errors by their names; metres and radians. Or such a file.
        errors : str
            What errors of axes are: ``"axes"``, of the numbers in the file, so that joints fit at home; ``"links"``, of parts,
            whose errors act everywhere.
        clearance : (length, angle), optional
            The play that joints have, metres and radians: asks for the tolerances that keep within it. Either may be None.
        samples : int, optional
            Draws so many mechanisms at each pose, whose errors are uniform within their sizes, and assembles them beyond first
            order: Monte Carlo. Each takes about a millisecond.
        seed : int
            Of what is drawn: equal seeds draw equal mechanisms.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        length : float, optional
            Characteristic length, by which lengths and angles are compared, metres. The spread of the joint axes if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Accuracy
            Arrays. Each error is between minus and plus its size; worst cases are to first order.

        Raises
        ------
        OpmError
            The columns are not the task coordinates, a number is not finite, or a name is unknown.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof")
        >>> found = m.accuracy([m.home], tolerances={"length": 50e-6, "angle": 350e-6}, errors="links")
        >>> bool(found.worst_length[0] > 50e-6), bool(found.misfit_length.max() > 1e-6)
        (True, True)
        """
    def accuracy_over(
        self,
        over: Mapping[str, tuple[float, float] | float],
        *,
        actuators: tuple[float | None, float | None] | None = None,
        tolerances: Mapping[str, Any] | str | PathLike[str] | None = None,
        errors: str = "axes",
        gap: float = 0.05,
        budget: int | None = None,
        mode: str = "home",
        length: float | None = None,
        threads: int | None = None,
    ) -> AccuracyBounds:
        """The worst displacement and rotation of the platform over a box of poses, with a guaranteed bound: affine arithmetic
        misses no pose between others. To first order in the errors.

        Parameters
        ----------
        over : dict of str to (min, max) or float
            A range or a value for task coordinates by their names, metres and radians. Others stay at home.
        actuators : (length, angle), optional
            As for :meth:`accuracy`.
        tolerances : dict or path, optional
            As for :meth:`accuracy`; of axes and actuators.
        errors : str
            As for :meth:`accuracy`.
        gap : float
            Stops when the bounds are within this share above the largest errors found.
        budget : int, optional
            Largest number of boxes: 20,000 if not given. Where it ends earlier, ``tight`` is False and the bounds hold.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        length : float, optional
            As for :meth:`accuracy`.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        AccuracyBounds

        Raises
        ------
        OpmError
            A coordinate is unknown, its ends are not in order, or the errors have no bounds over boxes.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("plano-spherical-5dof")
        >>> found = m.accuracy_over({"x": (-0.02, 0.02)}, tolerances={"length": 50e-6, "angle": 350e-6}, gap=0.1)
        >>> found.found_length <= found.length <= 1.1 * found.found_length
        True
        """
    def analyze(
        self,
        poses: _Rows,
        *,
        wrench: _Rows | None = None,
        at: str | ArrayLike | None = None,
        frame: str = "base",
        gravity: ArrayLike | None = None,
        density: float | None = None,
        link_stiffness: Sequence[float] | None = None,
        joint_stiffness: Mapping[str, float] | None = None,
        mode: str = "home",
        length: float | None = None,
        threads: int | None = None,
    ) -> Analysis:
        """Forces and transmission at many poses: efforts of the actuators, payload, transmission indices, stiffness, clearance.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        wrench : (6,) or (n, 6) array_like, or mapping, optional
            The load on the platform, a force and a moment: FX, FY, FZ in N, MX, MY, MZ in N m. No load if not given.
        at : str or (3,) array_like
            Where the force acts: ``"platform"``, its reference point; ``"base"``, the base's origin; or a point of the platform,
            metres from the reference point along the axes of `frame`.
        frame : str
            The axes of `wrench` and `at`: ``"base"``, or ``"platform"`` for those that the platform carries.
        gravity : (3,) array_like, optional
            How a body falls, m/s², base directions: the weight of links and platform acts, whose masses are those of
            :meth:`to_mjcf`.
        density : float, optional
            Density of bodies whose masses the mechanism does not give, kg/m³, instead of the mechanism's.
        link_stiffness : (float, float), optional
            Stiffness of each link against translations of its end, N/m, and against rotations, N m/rad.
        joint_stiffness : dict of str to float, optional
            Stiffness of actuated joints, N/m and N m/rad; others are rigid.
        mode : str
            ``"home"``, or a sign for every two-valued choice.
        length : float, optional
            Characteristic length, by which forces and torques are compared, metres. The spread of the joint axes if not given.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Analysis
            Arrays. The effort of a joint is what its actuator exerts along its coordinate so that the mechanism stays at rest
            under the load.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("planar-3rrr")
        >>> found = m.analyze([m.home], wrench=[0, 0, 0, 0, 0, 1])
        >>> found.efforts.round(3).tolist(), found.lti.round(3).tolist()
        ([[0.515, 0.515, 0.515]], [0.697])
        """
    def check(self, *, samples: int = 200, seed: int = 1) -> Certificate:
        """Hold the closed forms of the mechanism to independent computations at random poses.

        Closures of the undecomposed legs, numbers of branches against a numeric solver, derivatives against differences, rows
        of sweeps against inverse kinematics of every pose, forward kinematics against the poses that joint values came
        from. It is what ``opm check`` prints.

        Parameters
        ----------
        samples : int
            Random poses of each comparison.
        seed : int
            Seed of the random poses: the same one gives the same certificate.

        Returns
        -------
        Certificate
            What was held, and to what.

        Raises
        ------
        OpmError
            There are no samples.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> opm.examples.load("planar-3rrr").check(samples=20)
        <Certificate of planar-3rrr: everything compared holds, 20 samples>
        """
    def forward(
        self,
        joints: _Rows,
        *,
        near: _Rows | None = None,
        mode: str | None = None,
        method: str | None = None,
        threads: int | None = None,
    ) -> Assemblies:
        """Every assembly for actuated joint values, in closed form; or the one near a pose that Newton's method finds.

        In a mechanism with screws, full revolutions can matter: each of them is another assembly, one advance of the screw
        away, and there are infinitely many. Of these, the one is given whose actuated joints have the full revolutions that
        `joints` has, and whose passive joints are within π of home.

        Parameters
        ----------
        joints : (a,) or (n, a) array_like, or mapping
            Values of the actuated joints, in the order of `actuated`, or by name; metres and radians. One row gives arrays
            without the first axis. There is no assembly for a row with NaN.
        near : (d,) or (n, d) array_like, or mapping, optional
            The pose from which assemblies are sorted, the nearest first, and from which Newton's method begins; metres and
            radians; one pose is used for all rows. Home if not given.
        mode : str, optional
            Only assemblies in this working mode, ``"home"`` or a sign for every two-valued choice. Newton's method
            stays in this mode, or in the home mode if not given.
        method : str, optional
            ``"every"``: all assemblies, by the closed form that most mechanisms have. ``"newton"``: one, near `near`, for every
            mechanism. If not given, ``"every"`` where there is a closed form, otherwise ``"newton"`` if `near` is given.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Assemblies
            Arrays, and a list of :class:`Assembly` for each row: empty where there is no assembly, or where Newton's method
            does not converge.

        Raises
        ------
        OpmError
            The mechanism's forward kinematics have no closed form, and `near` is not given; or `near` is out of reach.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("planar-3rrr")
        >>> found = m.forward(m.inverse(m.home, joints="actuated").joints)
        >>> int(found.counts), found.poses.shape, bool(abs(found.poses[0] - m.home).max() < 1e-9)
        (2, (2, 3), True)
        """
    def least_change(self, joints: _Rows) -> dict[str, NDArray[np.float64]] | None:
        """The least change of the actuated joints with which the mechanism can be assembled, where it cannot with given values.

        The joints then have no pose, and :meth:`forward` finds no assembly. They reach the nearest values that have one where
        the platform is at a parallel singularity.

        Parameters
        ----------
        joints : (a,) array_like, or mapping
            Values of the actuated joints, in the order of `actuated`, or by name; metres and radians.

        Returns
        -------
        dict, or None
            ``"together"``, (a,): the changes of all joints whose sum of squares is least, with a length over the mechanism's size.
            ``"alone"``, (a,): the least change of each joint, with the others as they are given; NaN where none was found. None
            where there is an assembly, or where no answer was found that holds.

        Raises
        ------
        OpmError
            The mechanism's forward kinematics have no closed form, or a value is not a number.

        Examples
        --------
        >>> import opm_kinematics as opm
        >>> m = opm.examples.load("planar-3rpr")
        >>> change = m.least_change([0.01, 0.01, 0.5])
        >>> bool(change["alone"][2] < change["together"][2] < 0), m.least_change([0.01, 0.01, 0.01]) is None
        (True, True)
        """
    def forward_track(
        self, joints: _Rows, *, near: _Rows | None = None, mode: str = "home"
    ) -> NDArray[np.float64]:
        """The pose for each row of actuated joint values, near the pose of the row before it, in one working mode.

        Newton's method starts at the last pose that was found. Where it ends without an assembly, the closed form finds
        the nearest one in this mode, for mechanisms that have one.

        Parameters
        ----------
        joints : (n, a) array_like, or mapping
            Each row has the values of the actuated joints, in the order of `actuated`, or by name; metres and radians. A row
            with NaN is passed over.
        near : (d,) array_like, or mapping, optional
            The pose before the first row; home if not given.
        mode : str, optional
            ``"home"``, or a sign for every two-valued choice.

        Returns
        -------
        (n, d) ndarray
            Task coordinates, metres and radians; NaN in the rows for which no assembly was found.

        Raises
        ------
        OpmError
            A value is infinite.
        """
    def transform(
        self, poses: _Rows, *, mode: str = "home", threads: int | None = None
    ) -> NDArray[np.float64]:
        """The displacement of the platform at each pose, in SE(3): its reference point and its orientation, in base coordinates.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        mode : str
            The working mode, or ``"home"``: dependent coordinates depend on it.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        (n, 4, 4) ndarray
            Homogeneous matrices: a rotation, which is the identity at home unless the coordinates measure it, and a
            position, metres. NaN where dependent coordinates have no solution.
        """
    def dependent(
        self, poses: _Rows, *, mode: str = "home", threads: int | None = None
    ) -> NDArray[np.float64]:
        """The dependent coordinates of each pose.

        Parameters
        ----------
        poses : (d,) or (n, d) array_like, or mapping
            As for :meth:`inverse`.
        mode : str
            The working mode, or ``"home"``.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        (n, c) ndarray
            One column for each of ``dependent_coordinates``; metres and radians. NaN where they have no solution.
        """
    def locate(self, transforms: ArrayLike, *, threads: int | None = None) -> NDArray[np.float64]:
        """The poses at which the platform has the given displacements: the inverse of :meth:`transform`.

        Parameters
        ----------
        transforms : (4, 4) or (n, 4, 4) array_like
            Homogeneous matrices, metres.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        (n, d) ndarray
            Metres and radians, angles within π of their home values. NaN where the displacement is outside the manipulator's
            motion; :meth:`nearest` gives the difference.

        Raises
        ------
        OpmError
            A matrix is not a rotation and a position.
        """
    def nearest(self, transforms: ArrayLike, *, threads: int | None = None) -> Nearest:
        """The poses nearest to the given displacements, and the differences that remain where :meth:`locate` has no pose.

        Parameters
        ----------
        transforms : (4, 4) or (n, 4, 4) array_like
            Homogeneous matrices, metres.
        threads : int, optional
            1 to 1024; the result does not depend on it. One for each processor if not given.

        Returns
        -------
        Nearest
            Nearest by least squares; rotations are weighted with the mechanism's size.

        Raises
        ------
        OpmError
            A matrix is not a rotation and a position.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Accuracy:
    """Errors of the platform and of the joints at many poses; NaN where a pose is out of reach, and where a number is not known."""

    @property
    def pose_error(self) -> NDArray[np.float64]:
        """(n, d), metres and radians: the worst case of every task coordinate."""
    @property
    def worst_length(self) -> NDArray[np.float64]:
        """(n,), metres: the longest displacement of the platform's reference point."""
    @property
    def worst_angle(self) -> NDArray[np.float64]:
        """(n,), radians: the largest rotation of the platform."""
    @property
    def sensitivity(self) -> NDArray[np.float64]:
        """(n, p, d): the change of every task coordinate for a unit of every error, one metre or one radian, to first order."""
    @property
    def misfit_length(self) -> NDArray[np.float64]:
        """(n, j), metres: the largest play of each joint, as the displacement of its point."""
    @property
    def misfit_angle(self) -> NDArray[np.float64]:
        """(n, j), radians: the largest play of each joint, as a rotation."""
    @property
    def permitted_alone(self) -> NDArray[np.float64] | None:
        """(n, p), metres and radians: the tolerance of each error with which no joint needs more than its clearance, if it is the
        only error. Infinite where it needs no play; NaN for errors of actuators and parameters. None without `clearance`."""
    @property
    def permitted_share(self) -> NDArray[np.float64] | None:
        """(n, p), metres and radians: the same if all errors come together, and each may use an equal part of the clearance of every
        joint that it reaches. None without `clearance`."""
    @property
    def permitted_uniform(self) -> NDArray[np.float64] | None:
        """(n, 2), metres and radians: one tolerance for the places and one for the directions of all axes together. Infinite
        where no error needs play. None without `clearance`."""
    @property
    def samples(self) -> AccuracySamples | None:
        """Mechanisms with errors that are drawn at random. None without `samples`."""
    @property
    def sizes(self) -> NDArray[np.float64]:
        """(p,), metres and radians: the size of each error."""
    @property
    def parameters(self) -> list[str]:
        """Names of the errors: actuated joints, parameters of the family, axes."""
    @property
    def joints(self) -> list[str]:
        """Names of the joints, leg by leg."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach, joint limits not considered."""
    @property
    def held(self) -> NDArray[np.bool_]:
        """(n,): whether the actuators hold the platform, so that its error is known."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class AccuracyBounds:
    """The worst errors of the platform over a box of poses: the largest that was found, and a bound that no pose in reach exceeds."""

    @property
    def length(self) -> float:
        """Metres: no pose of the box that is in reach displaces the platform's reference point by more. Infinite if nothing is known."""
    @property
    def angle(self) -> float:
        """Radians: no pose of the box that is in reach rotates the platform by more."""
    @property
    def found_length(self) -> float:
        """Metres: the largest displacement that was found at a pose. NaN if no pose was in reach."""
    @property
    def found_angle(self) -> float:
        """Radians: the largest rotation that was found at a pose."""
    @property
    def pose_length(self) -> list[float]:
        """The pose with the largest displacement, metres and radians. Empty if no pose was in reach."""
    @property
    def pose_angle(self) -> list[float]:
        """The pose with the largest rotation."""
    @property
    def tight(self) -> bool:
        """Whether both bounds are within `gap` above what was found."""
    @property
    def boxes(self) -> int:
        """How many boxes were bounded."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class AccuracySamples:
    """What errors do that are drawn at random, each uniform within its size: of mechanisms that are assembled beyond first order.
    NaN where a pose is out of reach, and where a number is not known."""

    @property
    def deviations(self) -> NDArray[np.float64]:
        """(n, d), metres and radians: the standard deviation of every task coordinate from its nominal value."""
    @property
    def length(self) -> NDArray[np.float64]:
        """(n,), metres: what 95 % of the displacements of the platform's reference point do not exceed."""
    @property
    def angle(self) -> NDArray[np.float64]:
        """(n,), radians: what 95 % of the platform's rotations do not exceed."""
    @property
    def misfit_length(self) -> NDArray[np.float64]:
        """(n, j), metres: what 95 % of the plays of each joint do not exceed."""
    @property
    def misfit_angle(self) -> NDArray[np.float64]:
        """(n, j), radians: what 95 % of the plays of each joint do not exceed."""
    @property
    def failed(self) -> NDArray[np.uint64]:
        """(n,): how many mechanisms cannot be assembled near the pose."""
    @property
    def count(self) -> int:
        """How many mechanisms are drawn at each pose."""
    @property
    def seed(self) -> int:
        """The seed of what is drawn."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Analysis:
    """Forces and transmission at many poses; NaN where a pose is out of reach, and where a number is not known."""

    @property
    def efforts(self) -> NDArray[np.float64]:
        """(n, a), N and N m: the effort of every actuated joint that balances the load. NaN where the load does not determine it,
        where it is not balanced, and at a serial singularity."""
    @property
    def imaginary_efforts(self) -> NDArray[np.float64]:
        """(n, j), N and N m: the effort of every imaginary joint, which the lower section exerts on the upper one."""
    @property
    def effort_jacobian(self) -> NDArray[np.float64]:
        """(n, a, 6): the efforts for a unit force along x, y and z of the base, and a unit moment about these axes, at the
        platform's reference point."""
    @property
    def iti(self) -> NDArray[np.float64]:
        """(n,), no unit: input transmission index, the least of all inputs."""
    @property
    def oti(self) -> NDArray[np.float64]:
        """(n,), no unit: output transmission index, the least of all inputs."""
    @property
    def lti(self) -> NDArray[np.float64]:
        """(n,), no unit: local transmission index, the least of both."""
    @property
    def oci(self) -> NDArray[np.float64]:
        """(n,), no unit: output constraint index, of legs that constrain the platform."""
    @property
    def effort_per_force(self) -> NDArray[np.float64]:
        """(n,), no unit: largest effort of an actuator for a unit force in the worst direction, torques over the characteristic
        length."""
    @property
    def effort_per_moment(self) -> NDArray[np.float64]:
        """(n,), no unit: largest effort of an actuator for a unit moment in the worst direction, forces times the characteristic
        length."""
    @property
    def effort(self) -> NDArray[np.float64]:
        """(n,), N: largest effort of an actuator under the load, torques over the characteristic length."""
    @property
    def effort_share(self) -> NDArray[np.float64]:
        """(n,), no unit: largest share of its ``max_effort`` that an actuator needs under the load."""
    @property
    def payload(self) -> NDArray[np.float64]:
        """(n,), N: largest force that the actuators bear in every direction on top of the load, within their ``max_effort``."""
    @property
    def payload_moment(self) -> NDArray[np.float64]:
        """(n,), N m: largest moment that they bear about every axis, likewise."""
    @property
    def payload_ball(self) -> NDArray[np.float64]:
        """(n,), N m: radius of the largest ball in the wrench polytope around the load, a force with the characteristic length as
        its lever."""
    @property
    def stiffness(self) -> NDArray[np.float64]:
        """(n,), N/m: least force that displaces the platform by a unit of length along it."""
    @property
    def rotational_stiffness(self) -> NDArray[np.float64]:
        """(n,), N m/rad: least moment that turns the platform by a unit of angle about its axis."""
    @property
    def clearance(self) -> NDArray[np.float64]:
        """(n,), m: distance of the nearest two bodies; negative where they overlap."""
    @property
    def stiffness_matrix(self) -> NDArray[np.float64] | None:
        """(n, 6, 6): force and moment on the platform at its reference point, by its translations along x, y and z of the base and
        its rotations about them; None without stiffnesses."""
    @property
    def leg_stiffness(self) -> NDArray[np.float64] | None:
        """(n, legs, 6, 6): the same for each leg, whose sum it is: what a leg carries is this times the platform's displacement."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach, joint limits not considered."""
    @property
    def balanced(self) -> NDArray[np.bool_]:
        """(n,): whether the actuators balance the load."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Assemblies:
    """Every assembly for each of ``n`` rows of actuated joint values: arrays, and a sequence of lists of :class:`Assembly`.

    The arrays have an axis for the assemblies of a row, sorted, with ``m`` places: as many as the row with the most. Places
    beyond a row's `counts` are NaN. For one row alone the arrays have no first axis, and it is a sequence of assemblies.
    """

    @property
    def counts(self) -> NDArray[np.int64]:
        """(n,): number of assemblies of each row."""
    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, m, d): task coordinates, metres and radians."""
    @property
    def transforms(self) -> NDArray[np.float64]:
        """(n, m, 4, 4): homogeneous matrices of the platform, as :meth:`Manipulator.transform` gives them, metres."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """(n, m, k): every joint coordinate, metres and radians."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(n, m, j): every imaginary joint, metres and radians."""
    @property
    def within_limits(self) -> NDArray[np.bool_]:
        """(n, m): whether all joints are within their limits."""
    @property
    def residuals(self) -> NDArray[np.float64]:
        """(n, m), no unit: closure error of the legs: radians, and lengths divided by the mechanism's size."""
    @property
    def modes(self) -> list[Any]:
        """The working modes of the assemblies: a list for each row; a list of modes for one row alone."""
    @property
    def joint_names(self) -> list[str]:
        """Names along the last axis of `joints`."""
    @property
    def imaginary_names(self) -> list[str]:
        """Names along the last axis of `imaginary`."""
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Any]: ...
    def __getitem__(self, number: int, /) -> Any:
        """Return self[key]."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Assembly:
    """One way in which a mechanism can be assembled for given actuated joints."""

    @property
    def pose(self) -> NDArray[np.float64]:
        """(d,): task coordinates, metres and radians."""
    @property
    def mode(self) -> str:
        """The working mode of the assembly."""
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
        """Closure error of the legs: radians, and lengths divided by the mechanism's size."""

@final
class Motion:
    """Rates and accelerations of every joint at many poses; NaN where a joint has none."""

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
        """(n,): whether the pose is in reach, joint limits not considered."""
    @property
    def regular(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach and every joint has a rate."""

@final
class Nearest:
    """The poses of a manipulator's motion that are nearest to given displacements, and the differences that remain."""

    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, d): task coordinates, metres and radians."""
    @property
    def rotation(self) -> NDArray[np.float64]:
        """(n, 3): rotation vectors from the orientations at the poses to those given, base coordinates, radians; zero
        where the displacement is in the motion."""
    @property
    def translation(self) -> NDArray[np.float64]:
        """(n, 3): from the platform's points at the poses to those given, base coordinates, metres; zero
        where the displacement is in the motion."""

@final
class Singularity:
    """How near many poses are to a singularity: signed measures without unit, (n,) each, that vanish at a singularity.

    They are NaN where a pose is out of reach. Parallel measures are NaN, too, where the inputs are too few to hold the section.
    """

    def _repr_html_(self) -> str: ...
    @property
    def upper_serial(self) -> NDArray[np.float64]:
        """(n,), no unit: a measure of the upper section that is zero where the chain of a leg is singular."""
    @property
    def upper_parallel(self) -> NDArray[np.float64]:
        """(n,), no unit: a measure of the upper section that is zero where its inputs do not hold it."""
    @property
    def lower_serial(self) -> NDArray[np.float64]:
        """(n,), no unit: a measure of the lower section that is zero where the chain of a leg is singular."""
    @property
    def lower_parallel(self) -> NDArray[np.float64]:
        """(n,), no unit: a measure of the lower section that is zero where its inputs do not hold it."""
    @property
    def serial(self) -> NDArray[np.float64]:
        """(n,), no unit: the measure of this kind for the whole mechanism."""
    @property
    def parallel(self) -> NDArray[np.float64]:
        """(n,), no unit: the measure of this kind for the whole mechanism."""
    @property
    def condition(self) -> NDArray[np.float64]:
        """(n,), no unit: condition number of the actuated joints' Jacobian with respect to the platform's twist;
        infinite at a singularity."""
    @property
    def manipulability(self) -> NDArray[np.float64]:
        """(n,), no unit: volume of the twists that unit rates of the actuated joints span, with lengths divided by the
        characteristic length."""
    @property
    def coordinates(self) -> NDArray[np.float64]:
        """(n,), no unit: zero where the coordinates of the pose are singular; this is not a singularity of the mechanism."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach, joint limits not considered."""

@final
class Certificate:
    """What was held of a mechanism, and to what: the result of :meth:`Manipulator.check`."""

    @property
    def name(self) -> str:
        """Name of the mechanism."""
    @property
    def samples(self) -> int:
        """Random poses of each comparison."""
    @property
    def seed(self) -> int:
        """Seed of the random poses."""
    @property
    def holds(self) -> bool:
        """Whether every comparison holds."""
    @property
    def comparisons(self) -> list[Comparison]:
        """Every kind of comparison."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Comparison:
    """One kind of comparison of a :class:`Certificate`."""

    @property
    def name(self) -> str:
        """``"closure"``, ``"branches"``, ``"derivatives"``, ``"rows"`` or ``"forward"``."""
    @property
    def what(self) -> str:
        """What was compared with what."""
    @property
    def holds(self) -> bool:
        """Whether all that was compared agrees."""
    @property
    def compared(self) -> int:
        """The number of comparisons that were made."""
    @property
    def left_out(self) -> int:
        """The number that was left out, because the two cannot be expected to agree."""
    @property
    def because(self) -> str | None:
        """Why some were left out."""
    @property
    def worst(self) -> float | None:
        """The largest difference, if it is one of numbers."""
    @property
    def tolerance(self) -> float | None:
        """The largest difference that is allowed."""
    @property
    def problem(self) -> str | None:
        """The first comparison that does not hold: what differs, and where."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Clearance:
    """The two bodies that are nearest to each other, at each of ``n`` poses.

    Links and the platform are rods between their joints, with the radii of the mechanism file; obstacles are those of the file.
    """

    @property
    def distance(self) -> NDArray[np.float64]:
        """(n,): the distance of the nearest two, metres; negative where they overlap, NaN where the pose is out of reach."""
    @property
    def pair(self) -> NDArray[np.int64]:
        """(n,): which two these are, as an index of `pairs`; -1 where the pose is out of reach."""
    @property
    def pairs(self) -> list[tuple[str, str]]:
        """The names of the pairs that are tested."""
    @property
    def set_aside(self) -> list[tuple[str, str, float]]:
        """The pairs that are not tested because they overlap at home: their names, and by how much, metres."""
    @property
    def mode(self) -> str:
        """The working mode."""
    def __len__(self) -> int: ...

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
        """(2, 3): the ends of its axis, metres; for a ball both are its centre."""
    @property
    def width(self) -> float:
        """Diameter, or side of the square section of a block, metres."""

@final
class Solutions:
    """Joint values of ``n`` poses, NaN where a pose is out of reach.

    For one working mode the arrays have the shapes below. For all modes they have one more axis after the first, with one
    entry for each mode: ``(n, m, k)``, ``(n, m, j)``, ``(n, m)``.
    """

    @property
    def joints(self) -> NDArray[np.float64]:
        """(n, k): every joint coordinate, metres and radians."""
    @property
    def imaginary(self) -> NDArray[np.float64]:
        """(n, j): every imaginary joint, metres and radians."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach, joint limits not considered."""
    @property
    def within_limits(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach and all joints are within their limits."""
    @property
    def joint_names(self) -> list[str]:
        """Names along the last axis of `joints`."""
    @property
    def imaginary_names(self) -> list[str]:
        """Names along the last axis of `imaginary`."""
    @property
    def units(self) -> dict[str, str]:
        """``"m"`` or ``"rad"`` of every joint and imaginary joint, by name."""
    @property
    def mode(self) -> str:
        """The working mode, or ``"all"``."""
    @property
    def modes(self) -> list[str]:
        """The working modes, in the order of the mode axis if there is one."""
    @property
    def rows(self) -> int:
        """Number of rows, n."""
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[str]: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __getitem__(self, name: str, /) -> NDArray[np.float64]:
        """The values of one joint or imaginary joint, (n,): a view."""
    def keys(self) -> KeysView[str]:
        """The names of the joints, then of the imaginary joints."""
    def values(self) -> ValuesView[NDArray[np.float64]]:
        """The values of each joint and imaginary joint: views."""
    def items(self) -> ItemsView[str, NDArray[np.float64]]:
        """Names and values."""
    def get(self, name: str, default: Any = None, /) -> Any:
        """The values of one joint or imaginary joint, or something else if there is none of this name.

        Parameters
        ----------
        name : str
            Name of the joint.
        default : object, optional
            What is returned if there is none.
        """
    def to_pandas(self) -> Any:
        """A table of pandas, with a row for each row of the arrays and each mode, and a column for each joint."""
    def to_xarray(self) -> Any:
        """A dataset of xarray, with a variable for each joint, which has its unit."""
    def _repr_html_(self) -> str: ...

@final
class Measure:
    """The measure of the part of a box that is in reach and within all limits, with guaranteed bounds.

    Its unit is the product of those of the coordinates with a range; a tilt is weighted with its sine, so that the measure
    of orientations is the Haar measure.
    """

    @property
    def value(self) -> float:
        """The middle of the bounds."""
    @property
    def lower(self) -> float:
        """Lower bound of the measure."""
    @property
    def upper(self) -> float:
        """Upper bound of the measure."""
    @property
    def whole(self) -> float:
        """The measure of the whole box."""
    @property
    def fraction(self) -> float:
        """``value / whole``."""
    @property
    def units(self) -> str:
        """Unit of the measure: ``"m^2"``, ``"m^2 rad^3"``, ``"1"``."""
    @property
    def boxes(self) -> int:
        """Number of boxes that were examined."""
    @property
    def stop(self) -> str:
        """Why the computation stopped: ``"tolerance"`` is met, ``"budget"`` is used up, or ``"exhausted"`` where splitting brings
        the bounds no closer."""
    @property
    def over(self) -> dict[str, float | tuple[float, float]]:
        """Lowest and highest value of every coordinate, or the value at which it is held, as :func:`measure` takes them."""

@final
class Outline:
    """The boundary of a workspace in a plane, or of one slice of it: closed polylines along the steps of the grid.

    They run half-way between points inside and their neighbours outside, and along the edge of the grid where the
    workspace continues beyond it.
    """

    @property
    def axes(self) -> tuple[str, str]:
        """The coordinates of the plane: the columns of the polylines."""
    @property
    def at(self) -> dict[str, float]:
        """The coordinate of the slice and its value; empty if there is only one plane."""
    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """Closed polylines, (n, 2) each, metres and radians; the last corner is the first one again. Counter-clockwise around
        pieces of the workspace, clockwise around holes."""
    @property
    def outer(self) -> tuple[NDArray[np.float64], ...]:
        """The polylines around pieces."""
    @property
    def holes(self) -> tuple[NDArray[np.float64], ...]:
        """The polylines around holes."""
    @property
    def area(self) -> float:
        """Area of the pieces without the holes, in the product of both coordinates' units."""

@final
class Aspect:
    """A connected part of the poses in reach in one working mode that has no singularity."""

    @property
    def number(self) -> int:
        """Number of the aspect, from 1 for the largest: its label in :meth:`Sweep.labels`."""
    @property
    def sign(self) -> int:
        """1 or -1, the sign of the parallel measure of the whole mechanism. Only whether two signs differ has a meaning."""
    @property
    def count(self) -> int:
        """Number of its poses."""
    @property
    def extent(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of each coordinate, radians and metres."""

@final
class Conditioning:
    """How well the poses of a workspace are conditioned. The local index of a pose is the inverse of its condition number."""

    @property
    def global_index(self) -> float | None:
        """The mean of the local indices (Gosselin and Angeles); None where no pose has one."""
    @property
    def local_min(self) -> float | None:
        """The smallest local index."""
    @property
    def local_max(self) -> float | None:
        """The largest local index; one at best."""
    @property
    def length(self) -> float:
        """Characteristic length of the condition numbers, metres."""
    @property
    def poses(self) -> int:
        """Number of poses that have an index."""

@final
class Rejection:
    """One cause that rejects poses of a grid: a leg that does not reach them, or a joint that is past a limit."""

    @property
    def leg(self) -> str:
        """Name of the leg."""
    @property
    def section(self) -> str | None:
        """``"lower"`` or ``"upper"``, the section that does not close; None for a limit."""
    @property
    def joint(self) -> str | None:
        """Name of the joint coordinate that is past a limit; None for a leg that does not reach."""
    @property
    def limit(self) -> str | None:
        """``"lowest"`` or ``"highest"``; None for a leg that does not reach."""
    @property
    def alone(self) -> int:
        """Number of poses that would be reached without it."""
    @property
    def with_others(self) -> int:
        """Number of other poses in whose rejection it takes part."""

@final
class Inscribed:
    """The largest disc, ball or box in a set of points of a grid."""

    @property
    def shape(self) -> str:
        """``"disc"``, ``"ball"`` or ``"box"``."""
    @property
    def centre(self) -> dict[str, float]:
        """The centre by coordinate, radians and metres."""
    @property
    def radii(self) -> dict[str, float]:
        """The radius by coordinate, of a box half of each side; radians and metres."""
    @property
    def error(self) -> dict[str, float]:
        """How far the true boundary may be from the cells of the grid: half of a cell's diagonal for a disc or a ball, half a step
        along each coordinate for a box.
        """
    @property
    def measure(self) -> float:
        """Area or volume, with the units of its coordinates multiplied."""
    @property
    def at_edge(self) -> bool:
        """Whether it touches the edge of the grid, beyond which the workspace may go on."""

@final
class Sweep:
    """A swept grid: a workspace of some kind, whose points are poses, places or orientations."""

    @property
    def kind(self) -> str:
        """The kind of the workspace, as it was given."""
    @property
    def mode(self) -> str:
        """The working mode, as it was given."""
    @property
    def max_condition(self) -> float | None:
        """The largest condition number at which a pose counts, if it is limited."""
    @property
    def clearance(self) -> float | None:
        """The least distance of bodies at which a pose counts, metres, if it is limited."""
    @property
    def limits(self) -> dict[str, float]:
        """The worst values of indices at which a pose counts, by name."""
    @property
    def length(self) -> float:
        """Characteristic length of condition numbers, metres."""
    def to_pandas(self) -> Any:
        """The points as a table of pandas, with a column for each coordinate."""
    def to_xarray(self) -> Any:
        """The mask as an array of xarray, with the values of each coordinate along its axes."""
    def _repr_html_(self) -> str: ...
    @property
    def count(self) -> int:
        """Number of points of the workspace. A pose counts if it is in reach and within all limits."""
    @property
    def poses(self) -> int:
        """Number of points of the grid: its poses, places or orientations."""
    @property
    def fraction(self) -> float:
        """``count / poses``."""
    @property
    def orientations(self) -> int:
        """Number of orientations of the grid: combinations of values of its coordinates."""
    @property
    def imaginary_range(self) -> dict[str, tuple[float, float] | None]:
        """Lowest and highest value of every imaginary joint over the reachable poses of the grid."""
    @property
    def axes(self) -> dict[str, NDArray[np.float64]]:
        """The values of every coordinate of the points, in the order of the mask's axes."""
    @property
    def grid(self) -> dict[str, NDArray[np.float64]]:
        """The values of every coordinate of the grid, including those that places or orientations do not have."""
    @property
    def units(self) -> dict[str, str]:
        """``"m"`` or ``"rad"`` of every coordinate of the grid, by name."""
    def mask(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.bool_]:
        """Which points are in the workspace: one axis for each coordinate of :attr:`axes`, with one entry for each value.

        `executor` and `shards` are those of :func:`sweep`, here and in all other methods; places and orientations are
        already known and are not computed again.

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
            The kind is neither ``"reachable"`` nor ``"dexterous"``.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def boundary(self, *, executor: _Executor | None = None, shards: int | None = None) -> list[Outline]:
        """The boundary as closed polylines in the first two coordinates that have several values; of kind ``"aspects"``, that of
        each aspect.

        Returns
        -------
        list of Outline
            One outline; if a third coordinate has several values, one for each of them.

        Raises
        ------
        OpmError
            Fewer than two or more than three coordinates have several values; or the kind is ``"imaginary"``, where the
            boundary of the orientations says nothing about the imaginary joints.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def components(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.uint64]:
        """How many points each connected component has, the largest first.

        Points are neighbours if they differ by one step along one coordinate; for an angle over a full revolution, the last
        value is next to the first. :meth:`labels` gives the component of each point. Of kind ``"aspects"``, the components are
        the aspects.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def labels(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.int32]:
        """Which connected component each point belongs to, in the shape of the mask: 0 where the mask is False, 1 in the largest.

        This is like ``scipy.ndimage.label``, except for angles over a full revolution. Component ``i`` has
        ``components()[i - 1]`` points; of components of equal size, the one with the first point comes first. Singular poses
        of kind ``"aspects"`` are 0, too.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def aspects(self, *, executor: _Executor | None = None, shards: int | None = None) -> list[Aspect]:
        """The aspects, the largest first: connected parts of the poses that have no singularity.

        :meth:`labels` gives the number of the aspect of each pose, 0 for one that is out of reach or singular.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`: for the sweep; the aspects are found here.
        shards : int, optional
            As for :func:`sweep`.

        Raises
        ------
        OpmError
            The kind of the workspace is not ``"aspects"``.
        """
    def path(self, start: ArrayLike, goal: ArrayLike, *, duration: float = 10.0) -> NDArray[np.float64]:
        """A path of the platform between two poses that passes no singularity, in the working mode of the sweep.

        It is straight if that is possible, else it leads through the aspect that both poses are in, far from singularities.
        :func:`trajectory` follows it: ``opm.trajectory(m, path[:, 1:], times=path[:, 0])``.

        Parameters
        ----------
        start : sequence of float
            The first pose, a value for each task coordinate.
        goal : sequence of float
            The last pose; angles may end full turns from it.
        duration : float
            Time that the path takes, seconds.

        Returns
        -------
        numpy.ndarray
            (n, 1 + number of task coordinates): the time of each pose, seconds, and its coordinates. The motion through the
            poses, at rest at both ends, has been watched between them for singularities, limits of joints and reach.

        Raises
        ------
        OpmError
            There is no such path on this grid; the kind of the workspace is not ``"aspects"``; or a pose is out of reach,
            beyond limits or singular.
        """
    def rejections(self) -> list[Rejection]:
        """What rejects the other poses of the grid: each leg that does not reach them, and each limit.

        Every pose is solved in the working mode, or in all of them. A leg that is out of reach has no joint values, so that
        its limits reject nothing there. With mode ``"any"``, what rejects a pose alone is what would have to go in one of
        the modes, and a leg that reaches the pose in one of them rejects nothing.

        Returns
        -------
        list[Rejection]
            The causes that reject any pose, leg by leg.

        Raises
        ------
        OpmError
            The kind has no poses of both sections.
        """
    def inscribed(
        self,
        shape: str,
        *,
        centre: Mapping[str, float] | None = None,
        executor: _Executor | None = None,
        shards: int | None = None,
    ) -> Inscribed | None:
        """The largest disc, ball or box in the set of points.

        Each point stands for a cell of the grid, and what lies beyond the grid is outside. A disc or ball is the largest in
        these cells, to 1e-9 of its radius; a box is inside the boundary, with sides at points or half-way between them. The disc
        in the kind ``"dexterous"`` is the regular dexterous workspace.

        Parameters
        ----------
        shape : str
            ``"disc"`` in two coordinates, ``"ball"`` in three, or ``"box"`` in two or three.
        centre : mapping, optional
            The centre by coordinate, radians and metres. The best one if not given.
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.

        Returns
        -------
        Inscribed or None
            None if the set is empty, or the given centre is not inside it.

        Raises
        ------
        OpmError
            The set does not suit the shape: it varies in other coordinates, or a disc would have different units.
        """
    def conditioning(self, *, executor: _Executor | None = None, shards: int | None = None) -> Conditioning:
        """The global conditioning index, and the smallest and largest local one, of every reachable pose.

        Each pose is taken in the first working mode that counts; every pose has the same weight.

        Raises
        ------
        OpmError
            The points are not poses.

        Parameters
        ----------
        executor : concurrent.futures.Executor or callable, optional
            As for :func:`sweep`.
        shards : int, optional
            As for :func:`sweep`.
        """
    def local_conditioning(self, *, executor: _Executor | None = None, shards: int | None = None) -> NDArray[np.float64]:
        """The local conditioning index of every pose, in the shape of the mask: NaN where the mask is False.

        The index is the inverse of the condition number: one at best, zero at a singularity.

        Raises
        ------
        OpmError
            The points are not poses.

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
            The points are places or orientations, or there is a `max_condition`, which a measure does not support.

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
        scale: Literal["comparable", "none"] = "comparable",
        inscribed: Inscribed | None = None,
        explain: bool = False,
    ) -> None:
        """Record the points as ``opm workspace -o`` does, byte for byte.

        The boundary is recorded too, except for kind ``"grid"``. Points that are not poses can only be written as MCAP. The
        fields of an NPY file are those of ``axes``, then of ``scalars``, then of ``color``, each once; without ``scalars`` the
        other task coordinates come last.

        Parameters
        ----------
        path : path
            Ends in ``.mcap`` (Foxglove, Lichtblick, Rerun), ``.npy`` (NumPy) or ``.ply`` (mesh tools). The file appears
            when it is complete.
        axes : sequence of three str, or "tip", optional
            The coordinates that are x, y and z of the cloud (imaginary joints for kind ``"imaginary"``), or the platform's point.
        scalars : sequence of str, optional
            Values stored with every point: task coordinates, imaginary joints, actuated joints, ``inverse_condition``; for places
            the ``share`` of orientations in which they are reached.
        color : str, optional
            The value that the colour shows.
        scale : {"comparable", "none"}, optional
            The scale of the cloud's axes in an MCAP file: those of another unit than the first are multiplied by 1, 2 or 5
            times a power of ten, so that the extents are comparable, or no axis is.
        inscribed : Inscribed, optional
            A shape in the set, from :meth:`inscribed`; ``opm plot`` draws it. In MCAP only.
        explain : bool, optional
            Also record the points that are rejected, with their causes (:meth:`rejections`) as colours. In MCAP only.

        Raises
        ------
        OpmError
            A name is unknown, or the file cannot be written.
        """
    def write_mcap(
        self,
        path: str | PathLike[str],
        *,
        axes: Sequence[str] | None = None,
        scalars: Sequence[str] | None = None,
        color: str | None = None,
        scale: Literal["comparable", "none"] = "comparable",
        inscribed: Inscribed | None = None,
        explain: bool = False,
    ) -> None:
        """Like :meth:`write` for a path that ends in ``.mcap``.

        Parameters
        ----------
        path : path
            The file appears when it is complete.
        axes : sequence of three str, or "tip", optional
            As for :meth:`write`.
        scalars : sequence of str, optional
            As for :meth:`write`.
        color : str, optional
            As for :meth:`write`.
        scale : {"comparable", "none"}, optional
            As for :meth:`write`.
        inscribed : Inscribed, optional
            As for :meth:`write`.
        explain : bool, optional
            As for :meth:`write`.
        """

@final
class Calibration:
    """What a calibration found. Metres and radians."""

    @property
    def manipulator(self) -> Manipulator:
        """The calibrated mechanism."""
    @property
    def parameters(self) -> list[str]:
        """Names of the parameters that might vary: those of :attr:`Manipulator.parameters`, ``leg4.base.x`` of a point, or places
        of joints of a list, ``leg1.r1.offset.1``."""
    @property
    def before(self) -> NDArray[np.float64]:
        """(p,): values in the file; zero for a displacement of an axis."""
    @property
    def after(self) -> NDArray[np.float64]:
        """(p,): calibrated values."""
    @property
    def standard_errors(self) -> NDArray[np.float64]:
        """(p,): standard errors; NaN where the measurements do not determine the parameter."""
    @property
    def identifiable(self) -> NDArray[np.bool_]:
        """(p,): whether the measurements determine the parameter."""
    @property
    def correlations(self) -> NDArray[np.float64]:
        """(p, p): correlations of the parameters; NaN where one is not determined."""
    @property
    def rank(self) -> int:
        """Number of independent combinations of parameters that the measurements determine."""
    @property
    def singular_values(self) -> NDArray[np.float64]:
        """(p,): singular values of the weighted derivatives, largest first; with `sigma` each is one over the standard error of a
        combination, in radians and units of the characteristic length."""
    @property
    def held(self) -> list[list[tuple[str, float]]]:
        """Combinations that are not determined and keep their values: names with changes, the first of which is one."""
    @property
    def columns(self) -> list[str]:
        """Names of the measured columns."""
    @property
    def residuals(self) -> NDArray[np.float64]:
        """(n, c): measured less predicted; NaN where nothing was measured."""
    @property
    def studentised(self) -> NDArray[np.float64]:
        """(n, c): residuals over their own standard deviations; NaN where no other measurement checks one."""
    @property
    def outliers(self) -> NDArray[np.bool_]:
        """(n, c): whether a residual is too large for chance."""
    @property
    def rejected(self) -> NDArray[np.bool_]:
        """(n, c): whether a cell was left out by `reject_outliers`."""
    @property
    def unused(self) -> list[int]:
        """Numbers of the rows that took no part: no pose in reach comes near."""
    @property
    def surplus(self) -> int:
        """Number of measured values in excess of what poses and parameters take up."""
    @property
    def deviation(self) -> float | None:
        """Root of the sum of squared residuals over the surplus: about 1 if `sigma` is right, and an estimate of it without. None
        without surplus."""
    @property
    def deviation_before(self) -> float | None:
        """The same with the values of the file."""
    @property
    def play_combinations(self) -> int:
        """How many combinations of errors that leave the class the residuals show beyond chance."""
    @property
    def play(self) -> dict[str, tuple[float, float]]:
        """(length, angle) by the name of each joint: the play that it needs at least."""

def calibrate(
    manipulator: Manipulator,
    measurements: Mapping[str, ArrayLike],
    *,
    sigma: tuple[float, float] | None = None,
    joint_sigma: tuple[float, float] | None = None,
    points: Mapping[str, Sequence[float]] | None = None,
    only: Sequence[str] | None = None,
    hold: Sequence[str] | None = None,
    reject_outliers: bool = False,
    weakest: float = 0.05,
    mode: str = "home",
) -> Calibration:
    """Calibrate a mechanism: its parameters, joint places and encoder offsets from measured poses and joints.

    Parameters
    ----------
    manipulator : Manipulator
    measurements : mapping
        A dictionary or a DataFrame: one sequence for each column by its name, all of the same length; NaN where nothing was measured. Columns are task
        coordinates (``x``), actuated joints (``S1``: what the encoder shows), ``point.x``, ``point.y``, ``point.z`` (the platform's
        reference point), ``distance.NAME`` (its distance from one of `points`), ``incline.x``, ``incline.y`` (how far the platform's
        axes rise). Metres and radians.
    sigma : (float, float), optional
        Standard deviations of measured lengths and angles. Without them all cells weigh the same, lengths in units of the
        characteristic length, and the deviation is estimated.
    joint_sigma : (float, float), optional
        Those of actuated joints, if they are others.
    points : mapping, optional
        Points (x, y, z) of the base by name, for columns ``distance.NAME``.
    only : sequence of str, optional
        Calibrate only parameters whose names have these words: ``leg1``, ``home``, ``leg1.h``.
    hold : sequence of str, optional
        Hold parameters whose names have these words.
    reject_outliers : bool
        Leave out outliers, the worst first, until there are none.
    weakest : float
        With `sigma`, hold combinations whose standard error would be larger than this, in radians and units of the
        characteristic length.
    mode : str
        Working mode of all measurements.

    Returns
    -------
    Calibration

    Raises
    ------
    OpmError
        A column or a parameter is unknown, or the measurements say nothing.
    """
def recover(path: str | PathLike[str], output: str | PathLike[str] | None = None) -> str:
    """Recover a recording that was cut short, as far as it goes.

    A run that is killed, or whose disk is full, leaves a ``.partial`` file. What it holds is copied into a recording that every
    viewer opens, and that says that it is not whole. It is what ``opm recover`` does.

    Parameters
    ----------
    path : path
        The MCAP file that was cut short.
    output : path, optional
        The file to write; ``NAME.recovered.mcap``, beside it, if not given.

    Returns
    -------
    str
        Name of the file that was written.

    Raises
    ------
    OpmError
        The file cannot be read or written, is not MCAP, is whole, or is still being written.
    """

def sweep(
    manipulator: Manipulator,
    /,
    *,
    kind: str = "grid",
    mode: str = "home",
    max_condition: float | None = None,
    limits: Mapping[str, float] | None = None,
    clearance: float | None = None,
    wrench: ArrayLike | None = None,
    at: str | ArrayLike | None = None,
    frame: str = "base",
    gravity: ArrayLike | None = None,
    density: float | None = None,
    link_stiffness: Sequence[float] | None = None,
    joint_stiffness: Mapping[str, float] | None = None,
    length: float | None = None,
    threads: int | None = None,
    executor: _Executor | None = None,
    shards: int | None = None,
    **axes: float | tuple[float, float, SupportsIndex] | Sequence[float] | NDArray[np.float64],
) -> Sweep:
    """Find which poses of a grid are reachable and within all limits, or another kind of workspace.

    Parameters
    ----------
    manipulator : Manipulator
    kind : str
        Kind of the workspace, in Merlet's terms; orientations are the coordinates of the upper section, places those of the
        lower one. In one subspace, orientations are its angles, places its lengths.

        * ``"grid"``: poses.
        * ``"constant-orientation"``, ``"orientation"``: poses, with each coordinate of the orientation or of the place held at
          one value.
        * ``"aspects"``: poses in one working mode, divided into connected parts without a singularity (:meth:`Sweep.aspects`).
        * ``"reachable"``, ``"dexterous"``: places that are reached in any, or in every orientation of the grid.
        * ``"imaginary"``: orientations in which any place of the grid is reached: those that the imaginary joints follow from.
        * ``"upper"``: the upper section alone, by its task coordinates, with the ranges of the imaginary joints that it needs.
        * ``"lower"``: the lower section alone, by its task coordinates and the imaginary joints.
    mode : str
        ``"home"``, ``"any"``, or a sign for every two-valued choice.
    max_condition : float, optional
        Only poses whose condition number is at most this count, in a mode in which it is.
    limits : dict of str to float, optional
        Only poses whose indices are as good as these values, in a mode in which they are: ``{"lti": 0.7}``. The names are
        those of :class:`Analysis`.
    clearance : float, optional
        Only poses count at which all bodies are at least this far apart, metres (:meth:`Manipulator.clearance`), in one working
        mode.
    wrench, at, frame, gravity, density, link_stiffness, joint_stiffness : optional
        What indices are computed with, as for :meth:`Manipulator.analyze`, with one wrench for all poses: for `limits` and for
        the values of a recording, such as ``"effort.S1"``.
    length : float, optional
        Characteristic length of condition numbers, metres. The spread of the joint axes if not given.
    threads : int, optional
        1 to 1024, here or in each worker; the result does not depend on it. One for each processor if not given.
    executor : concurrent.futures.Executor or callable, optional
        Where the work is done: a ``ProcessPoolExecutor``, a Dask cluster's ``client.get_executor(pure=False)``, one of
        ``mpi4py.futures``. What is sent is the manipulator, the grid and the number of a shard; the result is that of one
        process, to the bit. The shard of a lost worker runs again, three times at most. A process pool that has lost a worker
        takes no more work: give a function that makes one, and the shards that are missing go to a new one.
    shards : int, optional
        How many parts the executor gets: 8 for each worker if not given, 64 if it does not say how many it has; fewer for
        small grids.
    **axes
        For each coordinate one value, or ``(min, max, count)`` with both ends on the grid, or a list or an array of evenly
        spaced values, such as ``numpy.linspace`` gives; metres and radians. A coordinate that is not given stays at home. If
        none is given, the grid is fitted to the workspace, with a warning if the workspace continues beyond it.

    Raises
    ------
    OpmError
        An axis is not a coordinate; its ends are reversed or not numbers; the kind or mode is unknown; the grid does not suit
        the kind; the places or orientations do not fit in memory; or shards were lost repeatedly.

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
        For each coordinate ``(min, max)`` or one value; metres and radians. A coordinate that is not given stays at home. If
        none is given, ranges are fitted to the workspace; for the upper section alone, every orientation is measured.
    section : str
        ``"whole"``: poses. ``"upper"`` or ``"lower"``: one section alone, as those kinds of :func:`sweep`.
    mode : str
        ``"home"``, ``"any"``, or a sign for every two-valued choice.
    tolerance : float, optional
        How far the true measure may be from the value, as a share of it: 0.01 if not given.
    budget : int, optional
        Largest number of boxes to examine: 2**22 if not given.
    threads : int, optional
        1 to 1024, here or in each worker; the result does not depend on it. One for each processor if not given.
    executor : concurrent.futures.Executor or callable, optional
        Where the boxes are examined, as for :func:`sweep`; the result is that of one process, to the bit. It gets the rounds of
        more than 4096 boxes; smaller rounds are computed in this process, which also fits the ranges. An executor that a
        function makes serves all rounds.
    shards : int, optional
        How many parts of a round the executor gets: as for :func:`sweep`, but each except the last has at least 4096 boxes.

    Raises
    ------
    OpmError
        A coordinate is unknown; its ends are not numbers in order; the section or mode is unknown; or parts were lost
        repeatedly.
    """

@final
class Trajectory:
    """A motion as the joints follow it, ``n`` samples; NaN where it is out of reach, or a joint has no rate."""

    @property
    def name(self) -> str:
        """Name of the motion."""
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
    def dependent(self) -> NDArray[np.float64]:
        """(n, e): every dependent coordinate, metres and radians; angles are continuous, not wrapped at π."""
    @property
    def dependent_rates(self) -> NDArray[np.float64]:
        """(n, e), m/s and rad/s."""
    @property
    def dependent_accelerations(self) -> NDArray[np.float64]:
        """(n, e), m/s² and rad/s²."""
    @property
    def joints(self) -> NDArray[np.float64]:
        """(n, k): every joint coordinate, metres and radians; angles are continuous, not wrapped at π."""
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
        """(n,), no unit: condition number of the actuated joints' Jacobian with respect to the platform's twist."""
    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach, joint limits not considered."""
    @property
    def within_limits(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach and all joints are within their limits."""
    @property
    def regular(self) -> NDArray[np.bool_]:
        """(n,): whether the pose is in reach and every joint has a rate."""
    @property
    def violations(self) -> list[Violation]:
        """What the mechanism cannot follow, also between the samples, in the order of time."""
    @property
    def contacts(self) -> list[Contact] | None:
        """Where two bodies are nearer than `clearance`, also between the samples, in the order of time; None if that was not given."""
    @property
    def nearest(self) -> tuple[str, str, float, float] | None:
        """The two bodies that are nearest in the whole motion, their distance in metres and the time in seconds."""
    @property
    def joint_names(self) -> list[str]:
        """Names of the columns of `joints`."""
    @property
    def imaginary_names(self) -> list[str]:
        """Names of the columns of `imaginary`."""
    @property
    def units(self) -> dict[str, str]:
        """``"m"`` or ``"rad"`` of every joint and imaginary joint, by name."""
    @property
    def pose_names(self) -> list[str]:
        """Names of the columns of `poses`."""
    @property
    def rows(self) -> int:
        """Number of rows, n."""
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[str]: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __getitem__(self, name: str, /) -> NDArray[np.float64]:
        """The values of one joint or imaginary joint, (n,): a view."""
    def keys(self) -> KeysView[str]:
        """The names of the joints, then of the imaginary joints."""
    def values(self) -> ValuesView[NDArray[np.float64]]:
        """The values of each joint and imaginary joint: views."""
    def items(self) -> ItemsView[str, NDArray[np.float64]]:
        """Names and values."""
    def get(self, name: str, default: Any = None, /) -> Any:
        """The values of one joint or imaginary joint, or something else if there is none of this name.

        Parameters
        ----------
        name : str
            Name of the joint.
        default : object, optional
            What is returned if there is none.
        """
    def to_pandas(self) -> Any:
        """A table of pandas, with a row for each row of the arrays and each mode, and a column for each joint."""
    def to_xarray(self) -> Any:
        """A dataset of xarray, with a variable for each joint, which has its unit."""
    def write_mcap(self, path: str | PathLike[str], *, indices: bool = False) -> None:
        """Record the motion as ``opm trajectory -o`` does, byte for byte: it plays in Foxglove, Lichtblick and Rerun.

        Parameters
        ----------
        path : path
            The file appears when it is complete.
        indices : bool, optional
            Also the indices of :class:`Analysis` that the mechanism has.

        Raises
        ------
        OpmError
            The file cannot be written.
        """
    def write_table(
        self,
        path: str | PathLike[str],
        *,
        rates: bool = False,
        accelerations: bool = False,
        indices: bool = False,
        units: str = "si",
    ) -> None:
        """Write the motion as a table, as ``opm trajectory -o`` does, byte for byte: a row for each sample.

        The columns are ``t``, the task coordinates, the dependent coordinates, the joints and the imaginary joints, by
        their names; then ``d.NAME`` of all of them but ``t``, and ``dd.NAME``. Where there is no number, a cell of a CSV
        file is empty, and NaN in an NPY file.

        Parameters
        ----------
        path : path
            Its name ends in ``.csv``, or in ``.npy`` for a structured array. The file appears when it is complete.
        rates : bool, optional
            Also the first derivatives by time.
        accelerations : bool, optional
            Also the second derivatives by time.
        indices : bool, optional
            Also the indices of :class:`Analysis` that the mechanism has, by their names.
        units : str, optional
            ``"si"``: metres and radians; or ``"file"``: those of the mechanism file, which the header names: ``S1 [mm]``.

        Raises
        ------
        OpmError
            The file cannot be written, or its name ends otherwise.
        """

@final
class Contact:
    """A part of a motion in which two bodies are nearer than the clearance."""

    @property
    def one(self) -> str:
        """The name of one body."""
    @property
    def other(self) -> str:
        """The name of the other."""
    @property
    def start(self) -> float:
        """Time at which it begins, seconds."""
    @property
    def end(self) -> float:
        """Time at which it ends, seconds."""
    @property
    def worst(self) -> float:
        """Time at which the two are nearest, seconds."""
    @property
    def distance(self) -> float:
        """Their distance then, metres; negative where they overlap."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Violation:
    """A part of a motion that the mechanism cannot follow, or a singularity on its way."""

    @property
    def kind(self) -> str:
        """``"reach"``, ``"limit"``, ``"rate"``, ``"acceleration"`` or ``"singularity"``."""
    @property
    def start(self) -> float:
        """Time at which it starts, seconds."""
    @property
    def end(self) -> float:
        """Time at which it ends, seconds; equal to `start` for a singularity."""
    @property
    def worst(self) -> float:
        """Time at which it is worst, seconds."""
    @property
    def amount(self) -> float:
        """How large the violation is at that time, in :attr:`unit`."""
    @property
    def unit(self) -> str:
        """Unit of the amount: ``"m"``, ``"rad"``; ``"m/s"``, ``"rad/s"``, ``"m/s^2"``, ``"rad/s^2"`` beyond a limit of motion; or ``"1"`` for the remaining measure of a singularity."""
    @property
    def leg(self) -> str | None:
        """The leg that the violation is about."""
    @property
    def joint(self) -> str | None:
        """The joint that is past its limit, or too fast."""
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
        """The whole violation in one line."""
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
    ends: str | None = None,
    columns: Mapping[str, str] | None = None,
    relative_time: bool = False,
    time_optimal: bool = False,
    clearance: float | None = None,
) -> Trajectory:
    """Follow a motion of the platform.

    Parameters
    ----------
    manipulator : Manipulator
    motion : path, str or (w, d) array_like
        A motion file, a table of poses (``.csv``), or the name of a shipped motion; or, with `times`, waypoints with one
        column for each task coordinate, through which a cubic spline passes. Angles are brought within π of the
        preceding waypoint, as those of a table are.
    times : (w,) sequence of float, optional
        Times of the waypoints, seconds, increasing; at least two. With `time_optimal` they may be left out: the curve is
        then that of waypoints one second apart.
    rate : float, optional
        Samples per second; if not given, the rate of the file, or 100. The last sample is at the end of the motion.
    mode : str, optional
        ``"home"``, or a sign for every two-valued choice; if not given, the mode of the file, or home.
    ends : str, optional
        How a spline through waypoints or the poses of a table starts and ends: ``"rest"`` (no speed; if not given),
        ``"natural"`` (no acceleration), or ``"periodic"`` (as it ends, so it starts). A motion file says it itself.
    columns : dict of str, optional
        The columns of a table of poses (``.csv``) that are read: for ``t`` and each task coordinate the heading of its column,
        such as ``{"t": "stamp", "x": "pos_x"}``. Others are passed over.
    relative_time : bool, optional
        Count the times of a table of poses (``.csv``) from that of its first row, such as seconds since 1970.
    time_optimal : bool, optional
        The fastest timing along the same path, from rest to rest, within ``max_rate`` and ``max_acceleration`` of the
        joints in the mechanism file. Every actuated joint needs a ``max_acceleration``.
    clearance : float, optional
        Least distance of two bodies, metres: where it is less, they are in contact (:attr:`Trajectory.contacts`); 0 for
        overlaps.

    Raises
    ------
    OSError
        The file cannot be read.
    OpmError
        Lists every problem of the file with its line and column; or waypoints are not poses, or times do not increase (the
        message gives the index of the waypoint, counted from zero).
    """

def explore(manipulator: Manipulator) -> Explorer:
    """A page that shows a mechanism and its workspace in a browser: the mechanism in space, to be moved; slices and kinds of its
    workspace, which follow every dimension; motions. The page needs no network.

    Parameters
    ----------
    manipulator : Manipulator
        The mechanism.

    Returns
    -------
    Explorer
        It shows itself in a notebook; :meth:`Explorer.save` writes it to a file.
    """
def examples() -> list[str]:
    """Names of the mechanisms that come with the package."""

def example(name: str) -> str:
    """The text of one of the mechanisms of :func:`examples`.

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
    """Run a command line of ``opm``.

    Parameters
    ----------
    arguments : sequence of str
        The program's name first.

    Returns
    -------
    int
        The exit status.
    """
