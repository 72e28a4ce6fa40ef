"""The workspaces of docs/gallery, from recordings made by `opm workspace`."""

import matplotlib.pyplot as plt
import numpy as np

from drawing import INK, home_mark, save, slice_panel, solid
from recordings import Recording

LABELS = {
    "x": "x (mm)", "y": "y (mm)", "z": "z (mm)", "w": "w (mm)",
    "theta": "ϑ (deg)", "phi": "ϕ (deg)",
    "mu": "μ (deg)", "nu": "ν (deg)", "zeta": "ζ (deg)", "xi": "ξ (deg)", "psi": "ψ (deg)",
}  # fmt: skip


def draw():
    planar_planar()
    double_spherical()
    plano_cylindrical()
    schoenflies()
    schoenflies_lift()
    translational_planar()


def planar_planar():
    name = "planar-planar-5dof"
    position = Recording(
        name, ("x", "y", "w"),
        x="-160mm:120mm:141", y="-230mm:230mm:231", theta="0", w="60mm:350mm:146", phi="0",
    )  # fmt: skip
    turned = Recording(
        name, ("theta", "phi", "w"),
        x="0", y="0", theta="-75deg:60deg:271", w="200mm:325mm:6", phi="-60deg:60deg:241",
    )  # fmt: skip
    figure, panels = beside(position, "xyw", view=(22, -55), box=(280, 460, 300))
    colors = plt.colormaps["viridis"](np.linspace(0, 1, 146))
    heights = position.axes[2]
    for index, panel in enumerate(panels.flat):
        w = turned.axes[2][index]
        color = colors[int(np.argmin(np.abs(heights - w)))]
        slice_panel(panel, turned, index, color, "auto")
        panel.set_title(f"w = {w:.0f} mm")
        panel.set(xticks=(-60, -30, 0, 30, 60), yticks=(-50, -25, 0, 25, 50))
    mark(panels, at=300, values=turned.axes[2])
    outer(panels, "theta", "phi")
    save(figure, "gallery-planar-planar.png")


def double_spherical():
    recording = Recording(
        "double-spherical-5dof", ("mu", "nu", "xi"),
        mu="-62deg:62deg:156", nu="-62deg:62deg:156", zeta="0", xi="-70deg:75deg:146", psi="0",
    )  # fmt: skip
    figure, panels = beside(recording, ("mu", "nu", "xi"), view=(24, -50), box=(130, 130, 130))
    slices(panels, recording, (-50, -30, -10, 10, 30, 50), "ξ = {}°")
    outer(panels, "mu", "nu")
    save(figure, "gallery-double-spherical.png")


def plano_cylindrical():
    recording = Recording(
        "plano-cylindrical-4dof", ("x", "y", "theta"),
        x="-180mm:200mm:191", y="-160mm:210mm:186", theta="-90deg:90deg:181", phi="0",
    )  # fmt: skip
    figure, panels = beside(recording, ("x", "y", "theta"), view=(24, -55), box=(380, 370, 340))
    slices(panels, recording, (-75, -45, -15, 15, 45, 75), "ϑ = {}°")
    outer(panels, "x", "y")
    save(figure, "gallery-plano-cylindrical.png")


def schoenflies():
    recording = Recording(
        "schoenflies-4dof", ("x", "y", "z"),
        x="-230mm:230mm:231", y="110mm:500mm:196", phi="0", z="-240mm:-60mm:61",
    )  # fmt: skip
    five_bar(recording, "gallery-schoenflies.png", arm=((120, 0), (240, 160), (0, 340)))


def schoenflies_lift():
    recording = Recording(
        "schoenflies-lift-4dof", ("x", "y", "z"),
        x="-370mm:370mm:247", y="220mm:620mm:134", phi="0", z="-260mm:-40mm:45",
    )  # fmt: skip
    five_bar(recording, "gallery-schoenflies-lift.png", arm=((60, 0), (210, 200), (0, 480)))


def five_bar(recording, name, arm):
    """The prism that a shaft reaches, and a section of it with the arms that carry the shaft."""
    size = [values[-1] - values[0] for values in recording.axes]
    figure = plt.figure(figsize=(10, 4.6))
    panel = figure.add_axes((0.0, 0.0, 0.5, 1.0), projection="3d")
    view_solid(panel, recording, ("x", "y", "z"), view=(28, -60), box=(*size[:2], 1.1 * size[2]))
    plan = figure.add_axes((0.63, 0.11, 0.36, 0.81))
    slice_panel(plan, recording, len(recording.axes[2]) // 2, plt.colormaps["viridis"](0.5))
    x, y = np.array(arm).T
    for side in (-1, 1):
        plan.plot(side * x, y, "-o", color=INK, markerfacecolor="white", linewidth=1.6, markersize=6)
    wide = max(recording.axes[0][-1], x.max()) + 50
    plan.set(xlim=(-wide, wide), ylim=(-30, recording.axes[1][-1] + 10))
    plan.set(xlabel=LABELS["x"], ylabel=LABELS["y"])
    plan.set_title("from above, with the arms at home")
    save(figure, name)


def translational_planar():
    name = "translational-planar-4dof"
    position = Recording(
        name, ("x", "y", "w"),
        x="-250mm:250mm:201", y="-250mm:250mm:201", w="60mm:360mm:121", phi="0",
    )  # fmt: skip
    tilted = Recording(
        name, ("x", "y", "phi"),
        x="-250mm:250mm:251", y="-250mm:250mm:251", w="280mm", phi="-50deg:50deg:6",
    )  # fmt: skip
    figure, panels = beside(position, "xyw", view=(22, -60), box=(500, 500, 330))
    # The solid's colour at this height.
    color = plt.colormaps["viridis"]((280 - 60) / (360 - 60))
    for index, panel in enumerate(panels.flat):
        slice_panel(panel, tilted, index, color)
        panel.set_title(f"w = 280 mm, ϕ = {degrees(tilted.axes[2][index])}°")
        panel.set(xticks=(-200, 0, 200), yticks=(-200, 0, 200))
    outer(panels, "x", "y")
    save(figure, "gallery-translational-planar.png")


def beside(recording, axes, view, box):
    """A solid on the left and six panels on the right."""
    figure = plt.figure(figsize=(10, 5.2))
    panel = figure.add_axes((-0.035, 0.0, 0.54, 1.0), projection="3d")
    view_solid(panel, recording, axes, view, box)
    panels = figure.subplots(
        3, 2, sharex=True, sharey=True,
        gridspec_kw={"left": 0.62, "right": 0.99, "bottom": 0.1, "top": 0.945, "wspace": 0.1, "hspace": 0.3},
    )  # fmt: skip
    return figure, panels


def view_solid(panel, recording, axes, view, box):
    colors = plt.colormaps["viridis"](np.linspace(0, 1, len(recording.axes[2])))[:, :3]
    solid(panel, recording, colors, view)
    for along, name, values in zip("xyz", axes, recording.axes, strict=True):
        panel.set(**{f"{along}lim": (values[0], values[-1]), f"{along}label": LABELS[name]})
    panel.locator_params(nbins=5)
    panel.set_box_aspect(box, zoom=0.95)


def slices(panels, recording, thirds, title):
    values = recording.axes[2]
    for panel, third in zip(panels.flat, thirds, strict=True):
        index = int(np.argmin(np.abs(values - third)))
        color = plt.colormaps["viridis"](index / (len(values) - 1))
        slice_panel(panel, recording, index, color)
        panel.set_title(title.format(degrees(third)))


def degrees(value):
    return f"{value:.0f}".replace("-", "−")


def mark(panels, at, values):
    """Marks home in the one panel that shows its slice."""
    home_mark(panels.flat[int(np.argmin(np.abs(values - at)))])


def outer(panels, x, y):
    for panel in panels[-1]:
        panel.set_xlabel(LABELS[x])
    for panel in panels[:, 0]:
        panel.set_ylabel(LABELS[y])
