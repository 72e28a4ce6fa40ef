"""Workspaces as `opm workspace` records them, for the figures."""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

REPOSITORY = Path(__file__).parents[2]
OPM = "cargo run --quiet --release --bin opm --".split()

# Names of the lengths among the task coordinates; the others are angles.
LENGTHS = {"x", "y", "z", "w"}


class Recording:
    """A recorded grid over three of the task coordinates, and which of its poses are reachable."""

    def __init__(self, mechanism, axes, **grid):
        """Sweeps `grid`, `name=values` as on the command line, where all coordinates except `axes` are fixed."""
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory) / "workspace.mcap"
            flags = [f"--grid={name}={values}" for name, values in grid.items()]
            output = [f"--axes={','.join(axes)}", "--scale=none", "-o", path, "--quiet"]
            opm("workspace", mechanism, *flags, *output)
            with open(path, "rb") as file:
                reader = make_reader(file, decoder_factories=[DecoderFactory()])
                run = next(m.metadata for m in reader.iter_metadata() if m.name == "run")
                clouds = list(reader.iter_decoded_messages(topics=["/workspace/slices"]))
        # Radians and metres.
        values = [axis(run[f"grid.{name}"]) for name in axes]
        self.inside = np.zeros([len(v) for v in values[::-1]], bool)
        """The mask, indexed by third, second and first coordinate."""
        for _, _, _, cloud in clouds:
            points = positions(cloud).T
            first, second, third = (number(p, v) for p, v in zip(points, values, strict=True))
            self.inside[third, second, first] = True
        self.axes = [shown(name, v) for name, v in zip(axes, values, strict=True)]
        """Values of the three coordinates in millimetres and degrees."""


def opm(*arguments):
    """What an `opm` command prints."""
    command = [*OPM, *map(str, arguments)]
    done = subprocess.run(command, cwd=REPOSITORY, check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout


def axis(text):
    low, high, count = text.split(":")
    return np.linspace(float(low), float(high), int(count))


def shown(name, values):
    """A value in the unit that a figure uses."""
    return 1000 * values if name in LENGTHS else np.degrees(values)


def positions(cloud):
    """The coordinates of a `foxglove.PointCloud`: its first three fields, each a float32."""
    words = np.frombuffer(cloud.data, "<f4").reshape(-1, cloud.point_stride // 4)
    return words[:, :3]


def number(values, axis):
    return np.rint((values - axis[0]) / (axis[1] - axis[0])).astype(int)
