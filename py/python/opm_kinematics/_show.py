"""A mechanism that is shown in a browser by viser, which is imported only here."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from threading import Thread
from time import monotonic, sleep
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Manipulator, OpmError, Solid, Trajectory, trajectory
from .plot import COLORS

_Array = NDArray[np.float64]

# How often the picture changes while it plays, per second.
PICTURES = 30
# Where the camera stands at first, from the middle of what moves, in shares of its size.
CAMERA = np.array([0.5, -1.2, 0.7])
# Length and radius of the axes of frames, as shares of the mechanism's size.
AXES = (0.12, 0.004)


def show(
    manipulator: Manipulator,
    poses: Trajectory | str | PathLike[str] | ArrayLike | None = None,
    *,
    mode: str | None = None,
    rate: float = 10.0,
    port: int = 8080,
) -> Any:
    if not 0 < rate < np.inf:
        raise OpmError(f"rate is {rate}, expected a number of poses per second above 0")
    frames, times = _followed(manipulator, poses, mode, rate)
    reached: NDArray[np.bool_] = np.logical_not(np.isnan(frames["platform"]).any(axis=(1, 2)))
    if not reached.any():
        raise OpmError(f"{len(reached)} poses, none of them in reach, expected one in reach")
    try:
        import viser  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError as error:
        raise ImportError("m.show() needs viser: pip install viser") from error
    server = viser.ViserServer(host="127.0.0.1", port=port, label="opm")
    server.scene.set_up_direction("+z")
    handles = _bodies(server, manipulator)

    def place(number: int) -> None:
        # Out of reach, the last pose in reach stays; before the first one, that one.
        before = np.flatnonzero(reached[: number + 1])
        shown = before[-1] if len(before) else np.flatnonzero(reached)[0]
        with server.atomic():
            for name, handle in handles.items():
                matrix = frames[name][shown]
                handle.wxyz = viser.transforms.SO3.from_matrix(matrix[:3, :3]).wxyz
                handle.position = matrix[:3, 3]

    place(0)
    _controls(server, handles, (times, reached), place)
    return server


def _followed(
    manipulator: Manipulator,
    poses: Trajectory | str | PathLike[str] | ArrayLike | None,
    mode: str | None,
    rate: float,
) -> tuple[dict[str, _Array], _Array]:
    """The frames of all links at each pose, and the times of the poses, from zero."""
    if isinstance(poses, (str, PathLike)):
        poses = trajectory(manipulator, poses, mode=mode)
    if isinstance(poses, Trajectory):
        if mode is not None and manipulator.inverse(poses.poses[:1], mode=mode).mode != poses.mode:
            raise OpmError(f"mode is {mode!r}, but the motion was followed in {poses.mode!r}")
        found = manipulator.link_frames(poses.poses, mode=poses.mode)
        times: _Array | None = poses.times - poses.times[0]
    else:
        found, times = manipulator.link_frames(poses, mode=mode or "home"), None
    frames = {name: np.reshape(frame, (-1, 4, 4)) for name, frame in found.items()}
    count = len(frames["platform"])
    return frames, np.arange(count) / rate if times is None else times


def _bodies(server: Any, manipulator: Manipulator) -> dict[str, Any]:
    """A frame for each link, by its name, with the solids of the link."""
    home = manipulator.link_frames()
    solids = manipulator.solids()
    moving = np.concatenate([solid.ends for solid in solids if solid.body != "base"])
    size = float(np.linalg.norm(np.ptp(moving, axis=0)))
    camera, middle = server.initial_camera, (moving.min(axis=0) + moving.max(axis=0)) / 2
    camera.look_at, camera.position = tuple(middle), tuple(middle + CAMERA * size)
    handles = {
        name: server.scene.add_frame(
            f"/{name}", show_axes=False, axes_length=AXES[0] * size, axes_radius=AXES[1] * size
        )
        for name in home
    }
    for number, solid in enumerate(solids):
        frame = home[solid.body]
        ends = (solid.ends - frame[:3, 3]) @ frame[:3, :3]
        _add(server, f"/{solid.body}/solid {number}", solid, ends)
    return handles


def _add(server: Any, name: str, solid: Solid, ends: _Array) -> None:
    """Adds a solid, whose axis is given in the frame of its link."""
    *rgb, alpha = COLORS[solid.material]
    way = ends[1] - ends[0]
    length = float(np.linalg.norm(way))
    options = {
        "color": tuple(round(255 * channel) for channel in rgb),
        "opacity": None if alpha == 1 else alpha,
        "position": ends.mean(axis=0),
    }
    if solid.shape == "ball":
        server.scene.add_icosphere(name, radius=solid.width / 2, subdivisions=2, **options)
        return
    # The turn from z to the axis of the solid.
    along = way / length if length > 0 else np.array([0.0, 0.0, 1.0])
    wxyz = np.array([1 + along[2], -along[1], along[0], 0.0])
    norm = np.linalg.norm(wxyz)
    options["wxyz"] = wxyz / norm if norm > 1e-9 else np.array([0.0, 1.0, 0.0, 0.0])
    if solid.shape == "block":
        server.scene.add_box(name, dimensions=(solid.width, solid.width, length), **options)
    else:
        server.scene.add_cylinder(name, radius=solid.width / 2, height=length, **options)


def _controls(
    server: Any,
    handles: dict[str, Any],
    of: tuple[_Array, NDArray[np.bool_]],
    place: Callable[[int], None],
) -> None:
    """What is beside the picture: the axes of frames, and, of several poses, a slider that plays."""
    times, reached = of
    axes = server.gui.add_checkbox("frames", initial_value=False)

    @axes.on_update
    def _(_: Any) -> None:
        for handle in handles.values():
            handle.show_axes = axes.value

    if len(times) < 2:
        return
    slider = server.gui.add_slider("pose", min=0, max=len(times) - 1, step=1, initial_value=0)
    told = server.gui.add_text("time", initial_value="", disabled=True)
    plays = server.gui.add_checkbox("play", initial_value=False)

    def tell() -> None:
        number = int(slider.value)
        place(number)
        told.value = f"{times[number]:.3f} s" + ("" if reached[number] else ": out of reach")

    slider.on_update(lambda _: tell())
    tell()

    def play() -> None:
        begun = None
        while True:
            sleep(1 / PICTURES)
            if not plays.value:
                begun = None
                continue
            now = monotonic()
            if begun is None:
                start = 0.0 if slider.value == len(times) - 1 else float(times[int(slider.value)])
                begun = now - start
            number = int(np.searchsorted(times, now - begun, side="right")) - 1
            if number >= len(times) - 1:
                plays.value = False
            slider.value = max(number, 0)

    Thread(target=play, daemon=True).start()
