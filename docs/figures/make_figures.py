"""Draws docs/images from recordings made by `opm workspace`: `make figures`."""

import subprocess
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from PIL import Image

REPOSITORY = Path(__file__).parents[2]
IMAGES = REPOSITORY / "docs" / "images"
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


class Recording:
    """The slices of a recorded grid x by y by a third coordinate: occupancy, an array per slice."""

    def __init__(self, mechanism, third, **grid):
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory) / "workspace.mcap"
            opm = "cargo run --quiet --release --bin opm -- workspace".split()
            flags = [f"--grid={name}={values}" for name, values in grid.items()]
            output = [f"--axes=x,y,{third}", "-o", path, "--quiet"]
            command = [*opm, mechanism, *flags, *output]
            subprocess.run(command, cwd=REPOSITORY, check=True, stdout=subprocess.DEVNULL)
            with open(path, "rb") as file:
                reader = make_reader(file, decoder_factories=[DecoderFactory()])
                run = next(m.metadata for m in reader.iter_metadata() if m.name == "run")
                clouds = list(reader.iter_decoded_messages(topics=["/workspace/slices"]))
        self.x, self.y, self.third = (axis(run[f"grid.{name}"]) for name in ("x", "y", third))
        self.inside = np.zeros((len(clouds), len(self.y), len(self.x)), bool)
        for inside, (_, _, _, cloud) in zip(self.inside, clouds, strict=True):
            x, y, _ = positions(cloud).T
            inside[number(y, self.y), number(x, self.x)] = True


def axis(text):
    low, high, count = text.split(":")
    return np.linspace(float(low), float(high), int(count))


def positions(cloud):
    """The coordinates of a `foxglove.PointCloud`: its first three fields, each a float32."""
    words = np.frombuffer(cloud.data, "<f4").reshape(-1, cloud.point_stride // 4)
    return words[:, :3]


def number(values, axis):
    return np.rint((values - axis[0]) / (axis[1] - axis[0])).astype(int)


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
    """Of the pixels around an axis's values, in millimetres."""
    half = (axis[1] - axis[0]) / 2
    return 1000 * (axis[0] - half), 1000 * (axis[-1] + half)


def slice_panel(panel, recording, index, color):
    inside = np.ma.masked_equal(recording.inside[index], 0)
    box = (*extent(recording.x), *extent(recording.y))
    panel.imshow(inside, cmap=ListedColormap([color]), extent=box, origin="lower")
    panel.plot(0, 0, "+", color="white", markersize=8, markeredgewidth=2.4)
    panel.plot(0, 0, "+", color=INK, markersize=7, markeredgewidth=1)
    panel.tick_params(length=2.5, width=0.6)


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
    axes = (np.degrees(recording.third), 1000 * recording.y, 1000 * recording.x)
    k, y, x = (
        axis[0] + (axis[1] - axis[0]) * corners[..., number] for number, axis in enumerate(axes)
    )
    shades = colors[points[:, 0]] * bright[:, None]
    corners = np.stack([x, y, k], axis=-1)
    panel.add_collection3d(
        Poly3DCollection(corners, facecolors=shades, edgecolors=shades, linewidths=0.3)
    )
    panel.view_init(*view)


def plano_spherical():
    recording = Recording(
        "plano-spherical-5dof", "xi",
        x="-210mm:210mm:211", y="-135mm:150mm:191",
        zeta="-40deg", xi="0:180deg:181", psi="40deg",
    )  # fmt: skip
    xi = np.degrees(recording.third)
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
        panel.set_title(f"ξ = {angle}°")
        panel.set_xticks([-150, 0, 150])
    for panel in panels[-1]:
        panel.set_xlabel("x (mm)")
    for panel in panels[:, 0]:
        panel.set_ylabel("y (mm)")
    save(figure, "plano-spherical-workspace.png")


def translational_helical():
    recording = Recording(
        "translational-helical-3dof", "phi",
        x="-450mm:450mm:451", y="-500mm:620mm:561", phi="0:600deg:6",
    )  # fmt: skip
    phi = np.degrees(recording.third)
    x, y = 1000 * recording.x, 1000 * recording.y
    figure, panels = plt.subplots(
        2, 3, figsize=(8, 6.9), sharex=True, sharey=True, layout="constrained"
    )
    for index, panel in enumerate(panels.flat):
        slice_panel(panel, recording, index, plt.colormaps["viridis"](phi[index] / 640))
        if index > 0:
            panel.contour(x, y, recording.inside[0], [0.5], colors=[INK], linestyles="dashed", linewidths=1)
        panel.set_title(f"ϕ = {phi[index]:.0f}°")
        panel.set_xticks([-400, -200, 0, 200, 400])
    for panel in panels[-1]:
        panel.set_xlabel("x (mm)")
    for panel in panels[:, 0]:
        panel.set_ylabel("y (mm)")
    save(figure, "translational-helical-workspace.png")


def save(figure, name):
    """As a PNG of 256 colours, a third of the size, whose bytes depend on the picture alone."""
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])
    IMAGES.mkdir(exist_ok=True)
    picture.quantize(256, kmeans=4, dither=Image.Dither.NONE).save(IMAGES / name, optimize=True)
    plt.close(figure)


if __name__ == "__main__":
    with plt.rc_context(STYLE):
        plano_spherical()
        translational_helical()
