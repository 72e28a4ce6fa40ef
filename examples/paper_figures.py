"""Redraws the figures of Selvi's paper that can be redrawn: ``python paper_figures.py [FOLDER]``.

M. Ö. Selvi, "Kinematic analysis of overconstrained manipulators with partial subspaces using decomposition method",
Robotica. The paper prints curves without the numbers behind them, and not all lengths of its manipulators. The shipped
mechanisms have chosen lengths, and the shipped motions are sinusoids of the same kind. Not redrawn are the sketches of the
method (Figs. 2, 3, 5, 6, 12); Fig. 1 is a linkage, which has no platform (``opm linkage``).
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import opm_kinematics as opm
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from opm_kinematics import plot

SPHERICAL = opm.examples.load("plano-spherical-5dof")
HELICAL = opm.examples.load("translational-helical-3dof")
# The sources of the figures' curves.
SPHERICAL_MOTION = opm.trajectory(SPHERICAL, "plano-spherical-sinusoids")
HELICAL_MOTION = opm.trajectory(HELICAL, "translational-helical-sinusoids")


def coordinates(
    panels: Sequence[Axes], times: NDArray[np.float64], values: NDArray[np.float64], m: opm.Manipulator, per: str = ""
) -> None:
    """The motion of the platform over time: lengths on the first panel, angles on the second."""
    for unit, panel in zip(("m", "rad"), panels, strict=True):
        for column, coordinate in enumerate(m.task_coordinates):
            if coordinate.unit == unit:
                panel.plot(times, values[:, column], label=coordinate.name)
        panel.set(xlabel="t (s)", ylabel=unit + per)
        panel.legend(frameon=False)
        panel.margins(x=0, y=0.12)


def panels(count: int) -> tuple[Figure, list[Axes]]:
    """A figure with several panels in a row, marked with letters."""
    figure = plt.figure(figsize=(3.7 * count, 3.2), layout="constrained")
    return figure, [figure.add_subplot(1, count, i + 1, title=f"({'abc'[i]})") for i in range(count)]


def actuated(manipulator: opm.Manipulator) -> list[str]:
    return [manipulator.joint_names[column] for column in manipulator.actuated]


def figure_4() -> Figure:
    """The 5-DoF manipulator, with its imaginary joints."""
    figure = plt.figure(figsize=(7, 5))
    panel = figure.add_subplot(projection="3d", elev=32, azim=-60)
    plot.mechanism(SPHERICAL, SPHERICAL_MOTION.poses[150].tolist(), ax=panel)
    return figure


def figure_7() -> Figure:
    """Objective motion of the 5-DoF manipulator: translation, orientation."""
    figure, row = panels(2)
    coordinates(row, SPHERICAL_MOTION.times, SPHERICAL_MOTION.poses, SPHERICAL)
    return figure


def figure_8() -> Figure:
    """Imaginary joints of the 5-DoF manipulator."""
    figure, row = panels(1)
    plot.joints(SPHERICAL_MOTION, SPHERICAL.imaginary_names, ax=row)
    return figure


def figure_9() -> Figure:
    """Actuated joints of the 5-DoF manipulator: (a) sliders, (b) arms."""
    figure, row = panels(2)
    plot.joints(SPHERICAL_MOTION, actuated(SPHERICAL), ax=row)
    return figure


def figure_10() -> Figure:
    """Velocities: (a) imaginary joints, (b) linear actuators, (c) angular actuators."""
    figure, row = panels(3)
    plot.joints(SPHERICAL_MOTION, SPHERICAL.imaginary_names, rates=True, ax=row[0])
    plot.joints(SPHERICAL_MOTION, actuated(SPHERICAL), rates=True, ax=row[1:])
    return figure


def figure_11() -> Figure:
    """Workspaces: (a) of the upper section at zeta = 0, (b) in x and y, (c) of the imaginary joints."""
    figure = plt.figure(figsize=(12, 4), layout="constrained")
    ours = figure.add_subplot(1, 3, 1)
    upper = opm.sweep(SPHERICAL, kind="upper", zeta=0.0, xi=(0.0, np.pi, 91), psi=(-np.pi, np.pi, 181))
    plot.workspace(upper, "xi", "psi", ax=ours)
    ours.set_title("(a)")
    plane = opm.sweep(SPHERICAL, x=(-0.22, 0.22, 177), y=(-0.16, 0.16, 129))
    plot.workspace(plane, ax=figure.add_subplot(1, 3, 2, title="(b)"))
    tilted = opm.sweep(SPHERICAL, zeta=(-0.35, 0.35, 25), xi=(-0.35, 0.35, 25), psi=(-0.35, 0.35, 25))
    panel = figure.add_subplot(1, 3, 3, projection="3d", elev=24, azim=-60, title="(c)")
    panel.set_box_aspect(None, zoom=0.82)  # room for the label of z
    points = tilted.points()
    plot.imaginary(SPHERICAL.inverse(points), color=np.abs(points[:, 3]), ax=panel)
    return figure


def figure_13() -> Figure:
    """The 3-DoF manipulator, on shorter rails than its own, which would dwarf it."""
    figure = plt.figure(figsize=(7, 5), layout="constrained")
    panel = figure.add_subplot(projection="3d", elev=45, azim=-75)
    plot.mechanism(HELICAL.with_parameters({"limits.S": (-0.026, 0.022)}), [0.03, 0.02, 1.0], ax=panel)
    for axis in (panel.xaxis, panel.yaxis, panel.zaxis):
        axis.labelpad = 10
    return figure


def figure_14() -> Figure:
    """Objective motion of the 3-DoF manipulator: (a) translation, (b) orientation."""
    figure, row = panels(2)
    coordinates(row, HELICAL_MOTION.times, HELICAL_MOTION.poses, HELICAL)
    return figure


def figure_15() -> Figure:
    """Joints of the 3-DoF manipulator: (a) the imaginary joint, (b) the sliders."""
    figure, row = panels(2)
    plot.joints(HELICAL_MOTION, HELICAL.imaginary_names, ax=row[0])
    plot.joints(HELICAL_MOTION, actuated(HELICAL), ax=row[1])
    return figure


def figure_16() -> Figure:
    """Velocities of the platform, (a) and (b), and of the sliders, (c)."""
    figure, row = panels(3)
    coordinates(row[:2], HELICAL_MOTION.times, HELICAL_MOTION.pose_rates, HELICAL, "/s")
    plot.joints(HELICAL_MOTION, actuated(HELICAL), rates=True, ax=row[2])
    return figure


def figure_17() -> Figure:
    """Workspace of the 3-DoF manipulator at phi = 0, 120, ..., 600 degrees: it moves with the helical joint."""
    turned = opm.sweep(HELICAL, x=(-0.6, 0.6, 161), y=(-0.6, 0.6, 161), phi=(0.0, np.radians(600), 6))
    figure = plot.workspace(turned, slices="phi")[0].figure
    assert isinstance(figure, Figure)
    return figure


FIGURES = (
    figure_4,
    figure_7,
    figure_8,
    figure_9,
    figure_10,
    figure_11,
    figure_13,
    figure_14,
    figure_15,
    figure_16,
    figure_17,
)


def main(folder: Path) -> None:
    """Draw all figures as PNG files in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for draw in FIGURES:
        figure = draw()
        figure.savefig(folder / f"{draw.__name__}.png", dpi=120)
        plt.close(figure)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "paper_figures"))
