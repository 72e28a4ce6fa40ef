"""Sets of poses as pictures: slices and solids."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from PIL import Image

IMAGES = Path(__file__).parents[1] / "images"
INK, FAINT = "#222222", "#9a9a9a"
STYLE = {
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.7,
    "figure.dpi": 160,
}


def outside(inside):
    """The gradient away from the set at each of its points, smooth over a few values of the grid."""
    blurred = np.pad(inside, 4).astype(float)
    for _ in range(2):
        for axis in range(3):
            blurred = sum(np.roll(blurred, shift, axis) for shift in (-1, 0, 1)) / 3
    return np.stack([-slope[4:-4, 4:-4, 4:-4] for slope in np.gradient(blurred)], axis=-1)


def faces(inside):
    """The faces between a point inside and one outside: corners in units of the grid, the point."""
    padded = np.pad(inside, 1)
    for axis in range(3):
        across = [np.eye(3)[other] / 2 for other in range(3) if other != axis]
        for side in (-1, 1):
            alone = inside & ~np.roll(padded, -side, axis)[1:-1, 1:-1, 1:-1]
            points = np.argwhere(alone)
            center = points + side * np.eye(3)[axis] / 2
            signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
            corners = [center + u * across[0] + v * across[1] for u, v in signs]
            yield np.stack(corners, axis=1), points


def extent(axis):
    """The edges of the pixels around an axis's values."""
    half = (axis[1] - axis[0]) / 2
    return axis[0] - half, axis[-1] + half


def slice_panel(panel, recording, index, color, aspect="equal"):
    inside = np.ma.masked_equal(recording.inside[index], 0)
    box = (*extent(recording.axes[0]), *extent(recording.axes[1]))
    panel.imshow(inside, cmap=ListedColormap([color]), extent=box, origin="lower", aspect=aspect)
    panel.tick_params(length=2.5, width=0.6)


def home_mark(panel, x=0, y=0):
    panel.plot(x, y, "+", color="white", markersize=8, markeredgewidth=2.4)
    panel.plot(x, y, "+", color=INK, markersize=7, markeredgewidth=1)


def solid(panel, recording, colors, view):
    """The set as a solid lit from the left, each slice in its colour."""
    corners, points = (np.concatenate(parts) for parts in zip(*faces(recording.inside)))
    slope = outside(recording.inside)[tuple(points.T)]
    normals = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    elevation, azimuth = np.radians(view)
    azimuth -= np.radians(35)
    light = (
        np.sin(elevation),
        np.cos(elevation) * np.sin(azimuth),
        np.cos(elevation) * np.cos(azimuth),
    )
    bright = 0.68 + 0.32 * np.clip(normals @ light, -1, 1)
    k, y, x = (
        axis[0] + (axis[1] - axis[0]) * corners[..., number]
        for number, axis in enumerate(recording.axes[::-1])
    )
    shades = colors[points[:, 0]] * bright[:, None]
    corners = np.stack([x, y, k], axis=-1)
    panel.add_collection3d(
        Poly3DCollection(corners, facecolors=shades, edgecolors=shades, linewidths=0.3)
    )
    panel.view_init(*view)


def save(figure, name):
    """Saves the figure as a PNG of 256 colours: a third of the size, with bytes that depend on the picture alone."""
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])
    IMAGES.mkdir(exist_ok=True)
    picture.quantize(256, kmeans=4, dither=Image.Dither.NONE).save(IMAGES / name, optimize=True)
    plt.close(figure)
