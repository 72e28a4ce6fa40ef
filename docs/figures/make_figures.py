"""Draws docs/images from recordings made by `opm workspace`: `make figures`."""

import matplotlib.pyplot as plt
import numpy as np

import gallery
import schematics
from drawing import INK, STYLE, home_mark, save, slice_panel, solid
from recordings import Recording


def plano_spherical():
    recording = Recording(
        "plano-spherical-5dof", ("x", "y", "xi"),
        x="-210mm:210mm:211", y="-135mm:150mm:191",
        zeta="-40deg", xi="0:180deg:181", psi="40deg",
    )  # fmt: skip
    xi = recording.axes[2]
    colors = plt.colormaps["viridis"](xi / 180)[:, :3]

    figure = plt.figure(figsize=(10, 5.2))
    panel = figure.add_axes((-0.035, 0.0, 0.54, 1.0), projection="3d")
    solid(panel, recording, colors, view=(24, -60))
    panel.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="ξ (deg)")
    panel.set(xlim=(-210, 210), ylim=(-140, 150), zlim=(0, 180))
    panel.set_xticks([-200, -100, 0, 100, 200])
    panel.set_yticks([-100, 0, 100])
    panel.set_zticks([0, 45, 90, 135, 180])
    panel.set_box_aspect((420, 290, 360))

    panels = figure.subplots(
        3, 2, sharex=True, sharey=True,
        gridspec_kw={"left": 0.62, "right": 0.99, "bottom": 0.1, "top": 0.945, "wspace": 0.1, "hspace": 0.3},
    )  # fmt: skip
    for panel, angle in zip(panels.flat, (0, 36, 72, 108, 144, 180), strict=True):
        index = int(np.argmin(np.abs(xi - angle)))
        slice_panel(panel, recording, index, colors[index])
        home_mark(panel)
        panel.set_title(f"ξ = {angle}°")
        panel.set_xticks([-150, 0, 150])
    for panel in panels[-1]:
        panel.set_xlabel("x (mm)")
    for panel in panels[:, 0]:
        panel.set_ylabel("y (mm)")
    save(figure, "plano-spherical-workspace.png")


def translational_helical():
    recording = Recording(
        "translational-helical-3dof", ("x", "y", "phi"),
        x="-450mm:450mm:451", y="-500mm:620mm:561", phi="0:600deg:6",
    )  # fmt: skip
    x, y, phi = recording.axes
    figure, panels = plt.subplots(
        2, 3, figsize=(8, 6.9), sharex=True, sharey=True, layout="constrained"
    )
    for index, panel in enumerate(panels.flat):
        slice_panel(panel, recording, index, plt.colormaps["viridis"](phi[index] / 640))
        home_mark(panel)
        if index > 0:
            panel.contour(x, y, recording.inside[0], [0.5], colors=[INK], linestyles="dashed", linewidths=1)
        panel.set_title(f"ϕ = {phi[index]:.0f}°")
        panel.set_xticks([-400, -200, 0, 200, 400])
    for panel in panels[-1]:
        panel.set_xlabel("x (mm)")
    for panel in panels[:, 0]:
        panel.set_ylabel("y (mm)")
    save(figure, "translational-helical-workspace.png")


if __name__ == "__main__":
    with plt.rc_context(STYLE):
        plano_spherical()
        translational_helical()
        gallery.draw()
        schematics.draw()
