"""HTML of the package's objects for notebooks."""

from collections.abc import Callable, Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from ._native import Decomposition, Manipulator, Measure, Singularity, Solutions, Sweep, Trajectory

__all__ = ["decomposition", "manipulator", "measure", "singularity", "solutions", "sweep", "trajectory"]

# Rows of a table of results, half of them from its end.
MOST_ROWS = 10


def decomposition(found: Decomposition) -> str:
    sections = " + ".join(escape(section) for section in (found.lower, found.upper) if section)
    if any(leg.solved == "whole" for leg in found.legs):
        summary = f"<b>{escape(found.name)}</b>: {escape(found.motion)}, every leg by itself; N = {found.mobility}"
        return _paragraph(summary) + _table(["leg", "joints"], ([leg.name, " ".join(leg.lower)] for leg in found.legs))
    shared = f", {escape(found.intersection.kind)} in common" if found.intersection else ""
    summary = (
        f"<b>{escape(found.name)}</b>: {sections}{shared}; "
        f"N = {found.mobility}, J = {found.imaginary_joints}, M = {found.first_section_motions}"
    )
    legs = ([leg.name, " ".join(leg.lower), " ".join(leg.upper), leg.imaginary or ""] for leg in found.legs)
    return _paragraph(summary) + _table(["leg", "lower", "upper", "imaginary joint"], legs)


def manipulator(found: Manipulator) -> str:
    coordinates = ([c.name, _number(c.home), c.unit] for c in found.task_coordinates)
    actuated = ", ".join(escape(found.joint_names[column]) for column in found.actuated)
    modes = f"2<sup>{found.choices}</sup> working modes, home {escape(found.home_mode)}" if found.choices else ""
    return (
        decomposition(found.decomposition)
        + _table(["task coordinate", "home", "unit"], coordinates)
        + _paragraph("; ".join(part for part in (f"actuated: {actuated}", modes) if part))
    )


def measure(found: Measure) -> str:
    amounts = {"value": found.value, "lower": found.lower, "upper": found.upper, "whole": found.whole}
    bounds = ([name, _number(amount), found.units, f"{amount / found.whole:.4%}"] for name, amount in amounts.items())
    over = ((name, ends if isinstance(ends, tuple) else (ends, ends)) for name, ends in found.over.items())
    ranges = ([name, *map(_number, ends)] for name, ends in over)
    return (
        _paragraph(f"{_summary(found)}; {found.boxes} boxes, until {found.stop}")
        + _table(["", "measure", "unit", "share"], bounds)
        + _table(["over", "min", "max"], ranges)
    )


def solutions(found: Solutions) -> str:
    several = found.mode == "all"
    shape = found.reachable.shape
    head = ["pose", *(["mode"] if several else []), "within limits", *found.imaginary_names, *found.joint_names]

    def cells(row: int) -> list[str]:
        at = tuple(map(int, np.unravel_index(row, shape)))
        inside = "yes" if found.within_limits[at] else "no" if found.reachable[at] else "out of reach"
        mode = [found.modes[at[-1]]] if several else []
        pose = at[:-1] if several else at
        values = [_number(value) for value in (*found.imaginary[at], *found.joints[at])]
        return [", ".join(map(str, pose)) or "0", *mode, inside, *values]

    return _paragraph(_summary(found)) + _table(head, _some(found.reachable.size, cells, len(head)))


def singularity(found: Singularity) -> str:
    measures = ["upper_serial", "upper_parallel", "lower_serial", "lower_parallel", "serial", "parallel"]
    head = ["pose", *measures, "condition"]

    def cells(row: int) -> list[str]:
        return [str(row), *(_number(np.ravel(getattr(found, name))[row]) for name in head[1:])]

    names = [name.replace("_", " ") for name in head]
    return _paragraph(_summary(found)) + _table(names, _some(found.reachable.size, cells, len(head)))


def trajectory(found: Trajectory) -> str:
    length = f"{found.rows} samples, {_number(found.times[0])} to {_number(found.times[-1])} s"
    rows = (
        [name, found.units[name], *map(_number, _ends(values))]
        for names, table in ((found.imaginary_names, found.imaginary), (found.joint_names, found.joints))
        for name, values in zip(names, table.T, strict=True)
    )
    told = "".join(f"<li>{escape(violation.message)}</li>\n" for violation in found.violations)
    return (
        _paragraph(f"<b>{escape(found.name)}</b>: {length}, mode {escape(found.mode)}")
        + _table(["joint", "unit", "min", "max"], rows)
        + (f"<ul>\n{told}</ul>\n" if told else _paragraph("nothing that it cannot follow"))
    )


def sweep(found: Sweep) -> str:
    axes = ([name, _number(v[0]), _number(v[-1]), str(len(v))] for name, v in found.grid.items())
    ranges = (
        [name, *(["", ""] if ends is None else map(_number, ends)), ""] for name, ends in found.imaginary_range.items()
    )
    return _paragraph(_summary(found)) + _table(["", "min", "max", "values"], [*axes, *ranges])


def _summary(found: object) -> str:
    return escape(repr(found).strip("<>"))


def _some(count: int, cells: Callable[[int], list[str]], width: int) -> list[list[str]]:
    """The cells of the first and the last rows, if there are many."""
    if count <= MOST_ROWS:
        return [cells(row) for row in range(count)]
    half = MOST_ROWS // 2
    rows = [cells(row) for row in (*range(half), *range(count - half, count))]
    return [*rows[:half], ["…"] * width, *rows[half:]]


def _ends(values: NDArray[np.float64]) -> tuple[float, float]:
    """Lowest and highest value, if there is any."""
    known = values[~np.isnan(values)]
    return (float(known.min()), float(known.max())) if len(known) else (np.nan, np.nan)


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value + 0.0:.6g}"


def _paragraph(html: str) -> str:
    return f"<p>{html}</p>\n"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    def line(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>\n"

    body = "".join(line(row, "td") for row in rows)
    return f"<table>\n<thead>{line(head, 'th')}</thead>\n<tbody>\n{body}</tbody>\n</table>\n"
