"""Design by decomposition: the dimensions of one section after the other, instead of all at once.

The imaginary joints cut a mechanism in two, and its parameters with it (Selvi, section 3.1: 25 parameters into 9 and 16). The
upper section is optimised first, for a set of orientations. The result is the range of each imaginary joint that it requires.
Then the lower section is optimised to reach as many places as it can *with every value in these ranges*. A place that it
reaches so is dexterous: the whole mechanism reaches it in every orientation of the set.

This module is for costs that are functions in Python, alone or beside :func:`dexterous`. The command ``opm design`` designs
by a file: it has more measures, constraints, the front of two objectives, and goes on after an interruption.

The optimiser is CMA-ES from the package ``cma``: ``pip install 'opm-kinematics[design]'``. Values are in SI units and radians.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from operator import index
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._native import Manipulator, OpmError, Sweep, sweep

if TYPE_CHECKING:
    from ._native import _Kind

__all__ = ["LOWER", "UPPER", "Design", "Found", "Variables", "dexterous", "minimise", "sections", "undivided"]

Axes: TypeAlias = Mapping[str, float | tuple[float, float, int]]
Bounds: TypeAlias = tuple[float, float]
Vector: TypeAlias = NDArray[np.float64]

#: The parameters of the plano-spherical family's upper section: both arcs and the platform axis's angle of each slider leg. The
#: paper does not list its nine; what is left of the upper section is where the axes point about the platform's normal, eta.
UPPER = tuple(f"leg{leg}.{name}" for leg in (1, 2, 3) for name in ("alpha1", "alpha2", "beta"))
#: Those of its lower section: the direction, place and links of each slider, the arm's foot and links; sixteen numbers.
LOWER = (*(f"leg{leg}.{name}" for leg in (1, 2, 3) for name in ("alpha", "h", "a1", "a2")), "leg4.base", "leg4.b1", "leg4.b2")

#: The cost of a design that does not assemble: more than that of one that assembles and reaches nothing.
UNASSEMBLED = 2.0


@dataclass(frozen=True)
class Variables:
    """Parameters that may vary, each between two bounds.

    Parameters
    ----------
    bounds : mapping
        Lowest and highest value by the name of the parameter, as in ``Manipulator.parameters``; for a point, a pair of bounds.

    Examples
    --------
    >>> from opm_kinematics.design import Variables
    >>> variables = Variables({"h": (0.1, 0.2), "leg4.base": ((-0.1, 0.1), (0.0, 0.1))})
    >>> len(variables)
    3
    >>> variables.parameters([0.5, 0.0, 1.0])
    {'h': 0.15000000000000002, 'leg4.base': (-0.1, 0.1)}
    """

    bounds: Mapping[str, Bounds | tuple[Bounds, Bounds]]
    _ends: NDArray[np.float64] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        ends = [np.reshape(np.asarray(bounds, dtype=np.float64), (-1, 2)) for bounds in self.bounds.values()]
        stacked = np.concatenate(ends) if ends else np.empty((0, 2))
        if not (np.isfinite(stacked).all() and (stacked[:, 0] < stacked[:, 1]).all()):
            raise OpmError("bounds of variables are finite, the lower one first")
        object.__setattr__(self, "_ends", stacked)

    def __len__(self) -> int:
        """The number of scalar variables."""
        return len(self._ends)

    def parameters(self, shares: Iterable[float]) -> dict[str, float | tuple[float, float]]:
        """The values of the parameters at these shares of the way between the bounds.

        Parameters
        ----------
        shares : (len,) iterable of float
            From 0 to 1.

        Returns
        -------
        dict
            Values by name, in SI units and radians; a pair for a point.
        """
        low, high = self._ends.T
        values = iter((low + (high - low) * np.fromiter(shares, np.float64, len(self))).tolist())
        return {
            name: next(values) if np.ndim(bounds) == 1 else (next(values), next(values)) for name, bounds in self.bounds.items()
        }

    def __or__(self, other: "Variables") -> "Variables":
        """These variables and others together."""
        return Variables({**self.bounds, **other.bounds})


@dataclass(frozen=True)
class Found:
    """The best that an optimiser found."""

    #: (len,): shares of the way between the bounds.
    shares: Vector
    cost: float
    #: How often the cost was evaluated.
    evaluations: int
    #: (evaluations,): the least cost so far.
    history: Vector


@dataclass(frozen=True)
class Design:
    """A mechanism that was designed."""

    manipulator: Manipulator
    #: Share of the places that are dexterous: see :func:`dexterous`.
    dexterous: float
    #: Ranges of the imaginary joints that the lower section was designed for; empty if all was designed at once.
    imaginary_range: dict[str, tuple[float, float]]
    #: The optima of the sections in the order of their design; or the one optimum of all variables at once.
    found: tuple[Found, ...]

    @property
    def evaluations(self) -> int:
        """How many designs were evaluated."""
        return sum(found.evaluations for found in self.found)


def minimise(cost: Callable[[Vector], float], dimension: int, *, budget: int, seed: int, step: float = 0.25) -> Found:
    """Minimise over the unit cube with CMA-ES, from a random place.

    Parameters
    ----------
    cost : callable
        A function of a vector (dimension,) of numbers from 0 to 1.
    dimension : int
        At least 2.
    budget : int
        Largest number of evaluations of `cost`, at least 1.
    seed : int
        Seed of all random numbers: equal seeds give equal results.
    step : float
        Standard deviation of the first generation.

    Returns
    -------
    Found
        The least cost, where it is, and the evaluations.
    """
    try:
        import cma  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except ImportError as error:
        raise OpmError("designs need the package cma: pip install 'opm-kinematics[design]'") from error
    budget, seed = _whole("budget", budget, 1), _whole("seed", seed, 0)
    if dimension < 2:
        raise OpmError(f"{dimension} variables, expected at least 2: for one, scan it")
    rng = np.random.default_rng(seed)
    asked: list[float] = []
    best, least = np.full(dimension, 0.5), np.inf

    def look(shares: Vector) -> float:
        nonlocal best, least
        asked.append(float(cost(shares)))
        if asked[-1] < least:
            best, least = np.array(shares), asked[-1]
        return asked[-1]

    options = {"bounds": [0.0, 1.0], "verbose": -9, "tolfun": 0, "tolflatfitness": 10**9, "tolstagnation": 10**9}
    while len(asked) < budget:  # restart elsewhere if it has converged early
        options["seed"] = int(rng.integers(1, 2**31))
        evolution = cma.CMAEvolutionStrategy(rng.uniform(0.25, 0.75, dimension).tolist(), step, options)
        while len(asked) < budget and not evolution.stop():
            generation = evolution.ask()
            if len(asked) + len(generation) > budget:
                for shares in generation[: budget - len(asked)]:
                    look(np.asarray(shares))
                break
            evolution.tell(generation, [look(np.asarray(shares)) for shares in generation])
    return Found(best, float(least), len(asked), np.minimum.accumulate(asked))


def dexterous(manipulator: Manipulator, *, places: Axes, orientations: Axes, mode: str = "home") -> float:
    """The share of the places that are reached in every orientation.

    Parameters
    ----------
    manipulator : Manipulator
    places, orientations : mapping
        Axes of a grid as for :func:`~opm_kinematics.sweep`: of the lower section's task coordinates, and of the upper one's.
    mode : str

    Returns
    -------
    float
        From 0 to 1.
    """
    _disjoint(places, orientations)
    return _everywhere(_swept(manipulator, mode, places, orientations), places)[0]


def sections(
    manipulator: Manipulator,
    upper: Variables,
    lower: Variables,
    *,
    places: Axes,
    orientations: Axes,
    budget: int,
    seed: int = 0,
    values: int = 5,
    mode: str = "home",
) -> Design:
    """Design the upper section first, then the lower one for the ranges of the imaginary joints that the upper one requires.

    Parameters
    ----------
    manipulator : Manipulator
        A mechanism of a family; parameters that are not variables keep their values.
    upper, lower : Variables
        Variables of the sections; for the plano-spherical family :data:`UPPER` and :data:`LOWER` name them.
    places, orientations : mapping
        Grids as for :func:`dexterous`.
    budget : int
        Number of designs to evaluate, shared in proportion to the numbers of variables; at least 2.
    seed : int
    values : int
        Number of values of each imaginary joint over its range, both ends included, with which the lower section is evaluated.
    mode : str

    Returns
    -------
    Design
        The mechanism that was found, and its parameters.
    """
    _disjoint(places, orientations)
    budget, values = _whole("budget", budget, 2), _whole("values", values, 1)
    share = min(max(round(budget * len(upper) / (len(upper) + len(lower))), 1), budget - 1)
    above = minimise(_cost(manipulator, upper, lambda m: _upper_cost(m, orientations, mode)), len(upper), budget=share, seed=seed)
    chosen = manipulator.with_parameters(upper.parameters(above.shares))
    asked = _swept(chosen, mode, orientations, kind="upper").imaginary_range
    ranges = {name: found for name, found in asked.items() if found is not None}
    if len(ranges) < len(asked):
        raise OpmError("the upper section reaches none of the orientations; give it a larger budget or other bounds")
    cuts: Axes = {name: (low, high, values) if low < high else low for name, (low, high) in ranges.items()}

    def cost(m: Manipulator) -> float:
        return _whole_cost(_swept(m, mode, places, cuts, kind="lower"), places)

    below = minimise(_cost(chosen, lower, cost), len(lower), budget=budget - share, seed=seed)
    whole = chosen.with_parameters(lower.parameters(below.shares))
    return Design(whole, dexterous(whole, places=places, orientations=orientations, mode=mode), ranges, (above, below))


def undivided(
    manipulator: Manipulator,
    variables: Variables,
    *,
    places: Axes,
    orientations: Axes,
    budget: int,
    seed: int = 0,
    mode: str = "home",
) -> Design:
    """Design all variables at once: the problem of :func:`sections` for the whole mechanism.

    Parameters
    ----------
    manipulator : Manipulator
        A mechanism of a family; parameters that are not variables keep their values.
    variables : Variables
    places, orientations : mapping
        Grids as for :func:`dexterous`.
    budget : int
        Number of designs to evaluate, at least 1.
    seed : int
    mode : str

    Returns
    -------
    Design
        The mechanism that was found, and its parameters.
    """
    _disjoint(places, orientations)

    def cost(m: Manipulator) -> float:
        return _whole_cost(_swept(m, mode, places, orientations), places)

    found = minimise(_cost(manipulator, variables, cost), len(variables), budget=budget, seed=seed)
    whole = manipulator.with_parameters(variables.parameters(found.shares))
    return Design(whole, dexterous(whole, places=places, orientations=orientations, mode=mode), {}, (found,))


#: Weight of a place that is reached in some orientations, relative to one reached in all: it leads to the first dexterous place.
SOME = 0.01
#: Cost of one radian of the imaginary joints' ranges, relative to that of an orientation out of reach.
WIDTH = 0.01


def _whole(what: str, value: int, least: int) -> int:
    """The value as a whole number of at least `least`."""
    try:
        number = index(value)
    except TypeError:
        number = least - 1
    if number < least:
        raise OpmError(f"{what} is {value!r}, expected a whole number of at least {least}")
    return number


def _disjoint(places: Axes, orientations: Axes) -> None:
    """Check that no coordinate belongs to both places and orientations."""
    both = [name for name in places if name in orientations]
    if both:
        raise OpmError(f"places and orientations both give {', '.join(both)}, expected each coordinate once")


def _swept(manipulator: Manipulator, mode: str, *grids: Axes, kind: "_Kind" = "grid") -> Sweep:
    axes: dict[str, Any] = {name: axis for grid in grids for name, axis in grid.items()}
    return sweep(manipulator, mode=mode, kind=kind, **axes)


def _cost(manipulator: Manipulator, variables: Variables, cost: Callable[[Manipulator], float]) -> Callable[[Vector], float]:
    """The cost as a function of the shares: the cost of the mechanism if it assembles."""

    def of(shares: Vector) -> float:
        try:
            changed = manipulator.with_parameters(variables.parameters(shares))
        except OpmError:
            return UNASSEMBLED
        return cost(changed)

    known = manipulator.parameters
    for name in variables.bounds:
        if not any(full == name or full.endswith(f".{name}") for full in known):
            manipulator.with_parameters({name: 0.0})  # raises an error that lists the parameters
    return of


def _upper_cost(manipulator: Manipulator, orientations: Axes, mode: str) -> float:
    """The share of orientations out of reach, then the widths of the imaginary joints' ranges."""
    swept = _swept(manipulator, mode, orientations, kind="upper")
    widths = [found[1] - found[0] for found in swept.imaginary_range.values() if found is not None]
    return 1.0 - swept.fraction + (WIDTH * float(np.mean(widths)) if widths else 0.0)


def _whole_cost(swept: Sweep, places: Axes) -> float:
    """The share of places that are not reached with all values of the other coordinates."""
    every, some = _everywhere(swept, places)
    return 1.0 - every - SOME * some


def _everywhere(swept: Sweep, places: Axes) -> tuple[float, float]:
    """The share of places that are reached with all values of the other coordinates, and the share of the grid."""
    others = tuple(number for number, name in enumerate(swept.axes) if name not in places)
    return float(swept.mask().all(axis=others).mean()), swept.fraction
