"""What notebooks show of the package's objects."""

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from ._native import Decomposition, Manipulator, Solutions, Sweep

__all__ = ["decomposition", "manipulator", "solutions", "sweep"]

# Rows of a table of results, half of them from its end.
MOST_ROWS = 10


def decomposition(found: Decomposition) -> str:
    summary = (
        f"<b>{escape(found.name)}</b>: {escape(found.lower)} + {escape(found.upper)}, "
        f"{escape(found.intersection.kind)} in common; "
        f"N = {found.mobility}, J = {found.imaginary_joints}, M = {found.first_section_motions}"
    )
    legs = ([leg.name, " ".join(leg.lower), " ".join(leg.upper), leg.imaginary or ""] for leg in found.legs)
    return _paragraph(summary) + _table(["leg", "lower", "upper", "imaginary joint"], legs)


def manipulator(found: Manipulator) -> str:
    coordinates = ([c.name, _number(c.home), c.unit] for c in found.task_coordinates)
    actuated = ", ".join(escape(found.joints[column]) for column in found.actuated)
    modes = f"2<sup>{found.choices}</sup> working modes, home {escape(found.home_mode)}" if found.choices else ""
    return (
        decomposition(found.decomposition)
        + _table(["task coordinate", "home", "unit"], coordinates)
        + _paragraph("; ".join(part for part in (f"actuated: {actuated}", modes) if part))
    )


def solutions(found: Solutions) -> str:
    several = found.mode == "all"
    shape = found.reachable.shape
    head = ["pose", *(["mode"] if several else []), "within limits", *found.imaginary_names, *found.joint_names]

    def cells(row: int) -> list[str]:
        at = np.unravel_index(row, shape)
        inside = "yes" if found.within_limits[at] else "no" if found.reachable[at] else "out of reach"
        mode = [found.modes[at[1]]] if several else []
        values = [_number(value) for value in (*found.imaginary[at], *found.joints[at])]
        return [str(at[0]), *mode, inside, *values]

    count = found.reachable.size
    half = MOST_ROWS // 2
    if count <= MOST_ROWS:
        rows = [cells(row) for row in range(count)]
    else:
        rows = [cells(row) for row in range(half)] + [["…"] * len(head)]
        rows += [cells(row) for row in range(count - half, count)]
    return _paragraph(escape(repr(found).strip("<>"))) + _table(head, rows)


def sweep(found: Sweep) -> str:
    summary = f"{found.count} of {found.poses} poses reachable ({found.fraction:.4%}), mode {escape(found.mode)}"
    axes = ([name, _number(v[0]), _number(v[-1]), str(len(v))] for name, v in found.axes.items())
    ranges = (
        [name, *(["", ""] if ends is None else map(_number, ends)), ""] for name, ends in found.imaginary_range.items()
    )
    return _paragraph(summary) + _table(["", "min", "max", "values"], [*axes, *ranges])


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value + 0.0:.6g}"


def _paragraph(html: str) -> str:
    return f"<p>{html}</p>\n"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    def line(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>\n"

    body = "".join(line(row, "td") for row in rows)
    return f"<table>\n<thead>{line(head, 'th')}</thead>\n<tbody>\n{body}</tbody>\n</table>\n"
