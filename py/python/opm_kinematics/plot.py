"""Pictures by matplotlib: ``pip install opm-kinematics[plot]``.

Every function draws on the axes that it is given, or on new ones, and returns what it drew on; nothing is shown or saved.
Numbers are SI units and radians.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._native import Manipulator, OpmError, Solid, Solutions, Sweep, Trajectory, trajectory

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D as _Axes3D  # type: ignore[import-untyped]
    from numpy.typing import ArrayLike, NDArray

    _Array = NDArray[np.float64]

__all__ = ["Animation", "animate", "imaginary", "joints", "mechanism", "workspace"]

# Colours that people with colour-blindness tell apart (Okabe and Ito's), and greys: those of recordings.
COLORS = {
    "base": (0.30, 0.30, 0.33, 1.0),
    "link": (0.72, 0.74, 0.77, 1.0),
    "actuated": (0.84, 0.37, 0.0, 1.0),
    "passive": (0.34, 0.71, 0.91, 1.0),
    "platform": (0.0, 0.45, 0.70, 1.0),
    "imaginary": (0.80, 0.47, 0.65, 0.45),
}
CURVES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]

OUTLINE = "#d55e00"

# What is on the buttons of a player of matplotlib, by the names that it gives them.
SIGNS = {
    "minus": "−",
    "fast-backward": "⏮",
    "step-backward": "⏴|",
    "play fa-flip-horizontal": "◀",
    "pause": "⏸",
    "play": "▶",
    "step-forward": "|⏵",
    "fast-forward": "⏭",
    "plus": "+",
}

# Direction of the light, a little from the left of the viewer.
LIGHT = np.array([-0.4, -0.6, 0.8]) / np.sqrt(1.16)
# Room for what stands around the box of a mechanism, inches.
LABELS = 0.62
# Sides of a cylinder, and meridians of a ball.
SIDES = 16
# Largest number of panels of a workspace if none is given.
PANELS = 12


def mechanism(
    manipulator: Manipulator,
    pose: Sequence[float] | _Array | None = None,
    *,
    mode: str = "home",
    ax: _Axes3D | None = None,
) -> _Axes3D:
    """Draw a mechanism in a pose, from its joint screws alone.

    Parameters
    ----------
    manipulator : Manipulator
    pose : (d,) sequence of float, optional
        The home pose if not given.
    mode : str
        The working mode.
    ax : Axes3D, optional
        A three-dimensional panel to draw on; a new one if not given.

    Returns
    -------
    Axes3D
        Metres. Motors are orange, other joints light blue, imaginary joints translucent, the platform blue. The panel holds all
        that moves; guides on the base that are longer are drawn as far as its box.

    Raises
    ------
    OpmError
        The pose is out of reach.
    """
    _pyplot()
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    _expect("manipulator", manipulator, Manipulator)
    solids = manipulator.solids(pose, mode=mode)
    box = _box(solids)
    faces, colors = _painted(solids, box)
    panel = _framed(box, ax)
    panel.add_collection3d(Poly3DCollection(faces, facecolors=colors, edgecolors="none", linewidths=0))
    return panel


class Animation:
    """A mechanism that moves. In a notebook it plays, with buttons, as matplotlib's player in HTML."""

    def __init__(self, panel: _Axes3D, show: Callable[[int], Any], times: _Array) -> None:
        self._panel, self._show, self._times = panel, show, times

    @property
    def times(self) -> _Array:
        """(n,): the time of each picture, seconds."""
        return self._times

    @property
    def animation(self) -> FuncAnimation:
        """The animation of matplotlib."""
        from matplotlib.animation import FuncAnimation

        # Milliseconds between two pictures.
        interval = 1000 * float(self._times[-1] - self._times[0]) / max(len(self._times) - 1, 1)
        return FuncAnimation(self._panel.figure, self._show, frames=len(self._times), interval=interval)

    def html(self) -> str:
        """The player, as HTML that needs no other file.

        Returns
        -------
        str
            A part of a page.
        """
        from matplotlib import pyplot

        page: str = self.animation.to_jshtml()
        # The signs on its buttons would come from a server.
        page = re.sub(r"<link[^>]*>", "", page)
        page = re.sub(r'<i class="fa fa-([\w-]+)([^"]*)">', lambda found: f"<i>{SIGNS.get(found[1] + found[2], found[1])}", page)
        # A notebook would show the figure once more.
        pyplot.close(self._panel.figure)
        return page

    def save(self, path: str | PathLike[str]) -> None:
        """Write it to a file.

        Parameters
        ----------
        path : path
            ``.html`` is the player; ``.gif`` needs Pillow, and films such as ``.mp4`` need FFmpeg.
        """
        place = Path(path)
        if place.suffix.lower() in (".html", ".htm"):
            place.write_text(self.html(), encoding="utf-8")
        else:
            self.animation.save(place, writer="pillow" if place.suffix.lower() == ".gif" else None)

    def _repr_html_(self) -> str:
        return self.html()

    def __repr__(self) -> str:
        return f"<Animation of {len(self._times)} pictures, {self._times[-1] - self._times[0]:g} s>"


def animate(
    manipulator: Manipulator,
    motion: Trajectory | str | PathLike[str] | ArrayLike,
    *,
    mode: str | None = None,
    frames: int = 60,
    ax: _Axes3D | None = None,
) -> Animation:
    """Draw a mechanism as it follows a motion.

    Parameters
    ----------
    manipulator : Manipulator
    motion : Trajectory, path, str or (n, d) array_like
        A motion that was followed, a motion file, a table of poses, the name of a shipped motion, or poses one after the
        other, a tenth of a second apart.
    mode : str, optional
        ``"home"``, or a sign for every two-valued choice; if not given, the mode of the motion, or home.
    frames : int
        The most pictures that it consists of, spread evenly over the motion.
    ax : Axes3D, optional
        A three-dimensional panel to draw on; a new one if not given.

    Returns
    -------
    Animation
        It plays in a notebook. Where a pose is out of reach, the mechanism stays, and the title says so.

    Raises
    ------
    OpmError
        The motion cannot be read, or no pose of it is in reach.
    """
    _pyplot()
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    _expect("manipulator", manipulator, Manipulator)
    if frames < 2:
        raise OpmError(f"frames is {frames}, expected at least 2 pictures")
    if isinstance(motion, (str, PathLike)):
        motion = trajectory(manipulator, motion, mode=mode)
    if isinstance(motion, Trajectory):
        if mode is not None and manipulator.inverse(motion.poses[:1], mode=mode).mode != motion.mode:
            raise OpmError(f"mode is {mode!r}, but the motion was followed in {motion.mode!r}")
        times, poses, reached, name = motion.times, motion.poses, motion.reachable, motion.mode
    else:
        solved = manipulator.inverse(motion, mode=mode or "home")
        poses, reached, name = np.asarray(motion, dtype=np.float64), solved.reachable, solved.mode
        times = np.arange(len(poses)) / 10
    if len(poses) < 2 or not reached.any():
        raise OpmError(f"{len(poses)} poses, {int(reached.sum())} of them in reach, expected at least two, and one in reach")
    chosen = np.unique(np.linspace(0, len(poses) - 1, min(frames, len(poses))).round().astype(int))
    # Out of reach, the last pose in reach stays; before the first one, that one.
    known = np.flatnonzero(reached)
    shown = known[np.maximum(np.searchsorted(known, chosen, side="right") - 1, 0)]
    solids = [manipulator.solids(poses[number], mode=name) for number in shown]
    box = _box([solid for picture in solids for solid in picture])
    pictures = [_painted(picture, box) for picture in solids]
    panel = _framed(box, ax)
    drawn = Poly3DCollection(pictures[0][0], facecolors=pictures[0][1], edgecolors="none", linewidths=0)
    panel.add_collection3d(drawn)

    def show(picture: int) -> list[Poly3DCollection]:
        faces, colors = pictures[picture]
        drawn.set_verts(faces)
        drawn.set_facecolor(colors)
        note = "" if reached[chosen[picture]] else ": out of reach"
        panel.set_title(f"t = {times[chosen[picture]]:.2f} s{note}", fontsize="medium")
        return [drawn]

    return Animation(panel, show, times[chosen])


@dataclass(frozen=True)
class _Rod:
    """A part of a cylinder."""

    material: str
    ends: _Array
    width: float
    shape: str = "cylinder"


def _box(solids: Sequence[Solid]) -> _Array:
    """(2, 3): the lowest and the highest corner of a box that holds all that moves, with some room. Guides on the base may be
    many times as long as everything else."""
    moving = [solid for solid in solids if solid.body != "base"] or solids
    low = np.min([solid.ends.min(axis=0) - solid.width / 2 for solid in moving], axis=0)
    high = np.max([solid.ends.max(axis=0) + solid.width / 2 for solid in moving], axis=0)
    # A flat drawing needs a box with some depth, too.
    room = 1.1 * np.maximum(high - low, 0.2 * (high - low).max())
    middle = (low + high) / 2
    return np.array([middle - room / 2, middle + room / 2])


def _inside(solid: Solid, box: _Array) -> Solid | _Rod | None:
    """What is in a box of a solid: the part of a rod on the base; everything else as it is."""
    if solid.body != "base" or solid.shape != "cylinder":
        return solid
    start, end = solid.ends
    way = end - start
    # Shares of the rod between the planes of the sides, by Liang and Barsky.
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.sort((box - start) / way, axis=0)
    along = np.abs(way) > 1e-12
    if not ((start >= box[0]) & (start <= box[1]))[~along].all():
        return None
    first, last = max(0.0, *shares[0][along]), min(1.0, *shares[1][along])
    return _Rod(solid.material, start + np.outer([first, last], way), solid.width) if last > first else None


def _painted(solids: Sequence[Solid], box: _Array) -> tuple[list[_Array], list[tuple[float, ...]]]:
    """The faces of the solids in a box, and the colour of each in the light."""
    faces: list[_Array] = []
    colors: list[tuple[float, ...]] = []
    for whole in solids:
        solid = _inside(whole, box)
        if solid is None:
            continue
        for face in _faces(solid):
            normal = np.cross(face[1] - face[0], face[2] - face[1])
            length = np.linalg.norm(normal)
            # Both sides of a face are lit; the side away from the light is darker.
            shade = 0.72 + 0.28 * float(normal @ LIGHT) / length if length > 0 else 1.0
            *rgb, alpha = COLORS[solid.material]
            faces.append(face)
            colors.append((*(float(shade * c) for c in rgb), alpha))
    return faces, colors


def _framed(box: _Array, ax: _Axes3D | None) -> _Axes3D:
    """A panel that holds a box, with one scale for all axes. A new one is filled by the box and its labels."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform  # type: ignore[import-untyped]

    panel = ax if ax is not None else _panel3d()
    for name, ends in zip("xyz", box.T, strict=True):
        panel.set(**{f"{name}lim": tuple(ends), f"{name}label": f"{name} (m)"})
    room = tuple(box[1] - box[0])
    panel.set_box_aspect(room)
    panel.locator_params(nbins=4)
    if ax is None:
        panel.figure.subplots_adjust(left=0, right=1, bottom=0, top=0.93)
        panel.apply_aspect()
        corners = np.array(list(product(*box.T))).T
        seen = panel.transData.transform(np.transpose(proj_transform(*corners, panel.get_proj())[:2]))
        middle = (panel.bbox.p0 + panel.bbox.p1) / 2
        reach = np.abs(seen - middle).max(axis=0)
        # Around the box are the numbers and the names of the axes; above it is room for a title.
        free = np.minimum(middle, panel.figure.bbox.size * (1, 0.95) - middle) - LABELS * panel.figure.dpi
        zoom = (free / reach).min()
        panel.set_box_aspect(room, zoom=zoom)
    return panel


def workspace(
    sweep: Sweep,
    x: str | None = None,
    y: str | None = None,
    *,
    slices: str | None = None,
    values: Sequence[float] | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> list[Axes]:
    """Draw slices of a workspace of any kind.

    Parameters
    ----------
    sweep : Sweep
    x, y : str, optional
        The coordinates along the axes; the first two with several values if not given.
    slices : str, optional
        The coordinate that has a panel for each of its values; without it there is one panel.
    values : sequence of float, optional
        The values to draw: the nearest ones on the grid are taken. If not given, all up to twelve; of more, twelve that are
        spread over them, and the title says so.
    ax : Axes or sequence of them, optional
        The panels to draw on; a new figure if not given.

    Returns
    -------
    list of Axes
        Metres and radians. Darker where more of the values of the coordinates that are not shown are reached; for reachable and
        dexterous places, darker where more of the orientations are. A new figure has a colour bar for these shares. The boundary
        is a line, for all kinds except ``"grid"`` and ``"imaginary"``, if the panels show it: two coordinates with several
        values, or a third one for `slices`.
    """
    pyplot = _pyplot()
    from matplotlib.colors import LinearSegmentedColormap

    _expect("sweep", sweep, Sweep)
    axes = sweep.axes
    several = [name for name, v in axes.items() if len(v) > 1 and name != slices]
    free = [name for name in several if name not in (x, y)]
    x = x if x is not None else _take(free, "x")
    y = y if y is not None else _take(free, "y")
    for name in (x, y, *([slices] if slices is not None else [])):
        if name not in axes:
            raise OpmError(f"{name}: no such coordinate, expected one of {', '.join(axes)}")
    if len({x, y, slices}) < 3:
        raise OpmError(f"x, y and slices are {x}, {y} and {slices}, expected different coordinates")

    order = list(axes)
    kept = [order.index(name) for name in (y, x, *([slices] if slices is not None else []))]
    others = tuple(i for i in range(len(order)) if i not in kept)
    reached = sweep.visits() / sweep.orientations if sweep.kind in ("reachable", "dexterous") else sweep.mask().astype(np.float64)
    # The mean over no axis would be one over all.
    share = reached.mean(axis=others) if others else reached
    remaining = [i for i in range(len(order)) if i in kept]
    share = np.transpose(share, [remaining.index(i) for i in kept])
    numbers: list[int | None] = [None]
    if slices is not None:
        grid = axes[slices]
        spread = np.linspace(0, len(grid) - 1, min(PANELS, len(grid))).round().astype(int)
        wanted = values if values is not None else grid[spread]
        numbers = [int(np.argmin(np.abs(grid - value))) for value in wanted]
    panels = _panels(pyplot, len(numbers), ax)
    units = sweep.units
    shades = LinearSegmentedColormap.from_list("reached", ["#ffffff", "#9ecae1", "#08519c"])
    shown = [name for name, v in axes.items() if len(v) > 1]
    planar = shown in ([x, y], [y, x], [x, y, slices], [y, x, slices])
    outlines = sweep.boundary() if planar and sweep.kind not in ("grid", "imaginary") else []
    for panel, number in zip(panels, numbers, strict=True):
        image = share if number is None else share[:, :, number]
        mesh = panel.pcolormesh(axes[x], axes[y], image, shading="nearest", cmap=shades, vmin=0, vmax=1, rasterized=True)
        for ring in outlines[number or 0].rings if outlines else ():
            first, second = ring.T if shown[:2] == [x, y] else ring.T[::-1]
            panel.plot(first, second, color=OUTLINE, linewidth=1.2)
        panel.set(xlabel=f"{x} ({units[x]})", ylabel=f"{y} ({units[y]})")
        if units[x] == units[y]:
            panel.set_aspect("equal")
        if slices is not None and number is not None:
            panel.set_title(f"{slices} = {axes[slices][number] + 0.0:.3g} {units[slices]}", fontsize="medium")
    if ax is None:
        figure = panels[0].figure
        of = [name for name in several if name not in (x, y)]
        if sweep.kind in ("reachable", "dexterous"):
            figure.colorbar(mesh, ax=panels, label="share of the orientations")
        elif of:
            figure.colorbar(mesh, ax=panels, label=f"share of the values of {', '.join(of)}")
        if slices is not None and values is None and len(numbers) < len(axes[slices]):
            figure.suptitle(f"{len(numbers)} of {len(axes[slices])} values of {slices}", fontsize="medium")
    return panels


def imaginary(
    solutions: Solutions,
    names: Sequence[str] | None = None,
    *,
    color: ArrayLike | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the workspace of imaginary joints: their values at the poses that are reached within the limits.

    Parameters
    ----------
    solutions : Solutions
        ``m.inverse(sweep.points())``, for instance.
    names : sequence of str, optional
        Two or three imaginary joints; the first three if not given.
    color : (n,) array_like, optional
        One number for each pose, for its colour.
    ax : Axes, optional
        The panel to draw on, with three dimensions for three joints; a new one if not given.

    Returns
    -------
    Axes
        The panel.
    """
    pyplot = _pyplot()
    _expect("solutions", solutions, Solutions)
    names = list(names) if names is not None else solutions.imaginary_names[:3]
    if len(names) not in (2, 3):
        raise OpmError(f"{len(names)} imaginary joints, expected two or three to draw")
    inside = solutions.within_limits
    values = [solutions[name][inside] for name in names]
    shade: str | _Array = CURVES[0]
    if color is not None:
        given = np.asarray(color, dtype=np.float64)
        if given.shape != inside.shape:
            raise OpmError(f"color has shape {given.shape}, expected {inside.shape}: one number for each pose")
        shade = given[inside]
    panel: Any = ax
    if panel is None:
        panel = _panel3d() if len(names) == 3 else pyplot.figure().add_subplot()
    panel.scatter(*values, c=shade, s=2, linewidths=0, rasterized=True)
    for axis, name in zip("xyz", names, strict=False):
        panel.set(**{f"{axis}label": f"{name} ({solutions.units[name]})"})
    result: Axes = panel
    return result


def joints(
    followed: Trajectory | Solutions,
    names: Sequence[str] | None = None,
    *,
    rates: bool = False,
    times: ArrayLike | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> list[Axes]:
    """Draw joints as curves over time.

    Parameters
    ----------
    followed : Trajectory or Solutions
        Solutions of one working mode need `times`.
    names : sequence of str, optional
        Joints and imaginary joints; all imaginary ones if not given.
    rates : bool
        Draw the rates of a trajectory's joints instead of their values.
    times : (n,) array_like, optional
        Seconds.
    ax : Axes or sequence of them, optional
        The panels to draw on, one for lengths and one for angles if there are both; a new figure if not given.

    Returns
    -------
    list of Axes
        Lengths, then angles. Curves have gaps where the motion is out of reach.
    """
    _expect("followed", followed, Trajectory, Solutions)
    names = list(names) if names is not None else followed.imaginary_names
    units = {name: followed.units[name] for name in names}
    if isinstance(followed, Trajectory):
        t = followed.times if times is None else np.asarray(times, dtype=np.float64)
        if rates:
            columns = [*followed.joint_names, *followed.imaginary_names]
            table = np.hstack([followed.joint_rates, followed.imaginary_rates])
            curves = {name: table[:, columns.index(name)] for name in names}
            units = {name: f"{unit}/s" for name, unit in units.items()}
        else:
            curves = {name: followed[name] for name in names}
    else:
        t = np.asarray(times if times is not None else [], dtype=np.float64)
        if rates or followed.mode == "all":
            raise OpmError(f"{followed!r} has no curves of this kind, expected a Trajectory, or one working mode")
        curves = {name: followed[name] for name in names}
    if t.shape != (followed.rows,):
        raise OpmError(f"times of shape {t.shape} for {followed!r}, expected a time a pose")
    return _curves(t, curves, units, ax)


def _curves(
    times: _Array, curves: dict[str, _Array], units: dict[str, str], ax: Axes | Sequence[Axes] | None
) -> list[Axes]:
    """Curves over time, with one panel for each unit."""
    kinds = sorted(set(units.values()))
    panels = _panels(_pyplot(), len(kinds), ax)
    for panel, kind in zip(panels, kinds, strict=True):
        panel.set_prop_cycle(color=CURVES)
        of_kind = [name for name in curves if units[name] == kind]
        for name in of_kind:
            panel.plot(times, curves[name], label=name, linewidth=1.2)
        panel.set(xlabel="t (s)", ylabel=kind)
        panel.margins(x=0, y=0.12)
        panel.legend(ncols=min(len(of_kind), 3), fontsize="small", frameon=False)
    return panels


def _expect(what: str, given: object, *classes: type) -> None:
    """Check that an argument is an instance of one of these classes."""
    if not isinstance(given, classes):
        names = " or ".join(f"a {kind.__name__}" for kind in classes)
        raise TypeError(f"{what} is {given!r}, expected {names}")


def _pyplot() -> Any:
    """Matplotlib, or an error if it is not installed."""
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("pictures need matplotlib: pip install 'opm-kinematics[plot]'") from error
    return pyplot


def _panel3d() -> Any:
    panel = _pyplot().figure().add_subplot(projection="3d")
    panel.view_init(elev=32, azim=-60)
    panel.figure.subplots_adjust(left=0.02, right=0.94, bottom=0.04, top=1.0)
    return panel


def _panels(pyplot: Any, count: int, given: Axes | Sequence[Axes] | None) -> list[Axes]:
    """As many panels as are needed: those given, or those of a new figure."""
    if given is not None:
        panels = list(given) if isinstance(given, (Sequence, np.ndarray)) else [given]
        if len(panels) != count:
            raise OpmError(f"{len(panels)} axes to draw on, expected {count}")
        for panel in panels:
            _make_room(panel)
        return panels
    columns = min(count, 3)
    rows = -(-count // columns)
    figure: Figure = pyplot.figure(figsize=(1.0 + 3.2 * columns, 0.6 + 2.6 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    for unused in grid.flat[count:]:
        unused.remove()
    return list(grid.flat[:count])


def _make_room(panel: Axes) -> None:
    """Let the labels of a panel fit on its figure, unless somebody has laid that out."""
    from matplotlib.figure import Figure, SubplotParams

    figure = panel.figure
    if not isinstance(figure, Figure) or figure.get_layout_engine() is not None:
        return
    sides = ("left", "right", "bottom", "top", "wspace", "hspace")
    if all(getattr(figure.subplotpars, side) == getattr(SubplotParams(), side) for side in sides):
        figure.set_layout_engine("constrained")


def _take(free: list[str], what: str) -> str:
    """The next coordinate with several values."""
    if not free:
        raise OpmError(f"{what} is not given, and no coordinate is left that the grid has several values of")
    return free.pop(0)


def _faces(solid: Solid | _Rod) -> list[_Array]:
    """Polygons of a solid, corners counter-clockwise as seen from outside: four of them, some twice, since
    matplotlib reads uninitialised memory if one polygon has fewer corners than another."""
    start, end = solid.ends
    radius = solid.width / 2
    if solid.shape == "ball":
        return _ball(start, radius)
    axis = end - start
    length = np.linalg.norm(axis)
    axis = axis / length if length > 0 else np.array([0.0, 0.0, 1.0])
    # Any perpendicular direction, the same for parallel axes.
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    up = np.cross(axis, across)
    if solid.shape == "block":
        ring = [(a * across + b * up) * radius for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    else:
        angles = np.arange(SIDES) * 2 * np.pi / SIDES
        ring = [(np.cos(t) * across + np.sin(t) * up) * radius for t in angles]
    low, high = [start + r for r in ring], [end + r for r in ring]
    return [
        np.array(corners)
        for i in range(len(ring))
        for corners in (
            [low[i - 1], low[i], high[i], high[i - 1]],
            [low[i], low[i - 1], start, start],
            [high[i - 1], high[i], end, end],
        )
    ]


def _ball(centre: _Array, radius: float) -> list[_Array]:
    """Quadrilaterals between meridians and parallels."""
    u = np.arange(SIDES + 1) * 2 * np.pi / SIDES
    v = np.linspace(-np.pi / 2, np.pi / 2, SIDES // 2 + 1)
    p = np.stack(
        [np.cos(u)[:, None] * np.cos(v), np.sin(u)[:, None] * np.cos(v), np.broadcast_to(np.sin(v), (len(u), len(v)))],
        axis=-1,
    )
    p = centre + radius * p
    return [
        np.array([p[i, j], p[i + 1, j], p[i + 1, j + 1], p[i, j + 1]])
        for i in range(SIDES)
        for j in range(SIDES // 2)
    ]
