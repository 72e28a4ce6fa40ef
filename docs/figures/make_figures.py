"""Draws docs/images from recordings made by opm: `make figures`."""

import matplotlib.pyplot as plt
import numpy as np

import gallery
import plots
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


if __name__ == "__main__":
    with plt.rc_context(STYLE):
        plano_spherical()
        gallery.draw()
        schematics.draw()
    plots.draw()
