"""The pictures that `opm plot` draws."""

import tempfile
from pathlib import Path

from drawing import IMAGES
from recordings import opm


def draw():
    mechanism("plano-spherical-5dof", "xi=20deg", "plano-spherical-mechanism.png")
    motion("plano-spherical-5dof", "plano-spherical-sinusoids", "plano-spherical-motion.png")
    workspace(
        "plano-spherical-5dof", "gallery-plano-spherical-imaginary.png",
        "--axes=zeta,psi,xi", "--scalars=theta11,theta12,theta13", panels="imaginary",
        zeta="-20deg:20deg:41", xi="-20deg:20deg:41", psi="-20deg:20deg:41",
    )  # fmt: skip
    workspace(
        "plano-spherical-5dof", "plano-spherical-places.png", "--kind=reachable", panels="slices",
        x="-230mm:230mm:231", y="-150mm:150mm:151",
        zeta="-40deg:40deg:17", xi="-40deg:40deg:17", psi="-40deg:40deg:17",
    )  # fmt: skip
    workspace(
        "plano-spherical-5dof", "gallery-plano-spherical-disc.png",
        "--kind=dexterous", "--inscribed=disc", "--centre=x=0,y=0", panels="slices",
        x="-200mm:200mm:401", y="-150mm:200mm:351", xi="-20deg:20deg:9", psi="-20deg:20deg:9",
    )  # fmt: skip
    workspace(
        "translational-helical-3dof", "translational-helical-workspace.png", panels="slices",
        x="-450mm:450mm:451", y="-500mm:620mm:561", phi="0:600deg:6",
    )  # fmt: skip
    workspace(
        "five-bar", "gallery-five-bar.png", panels="slices", x="-270mm:270mm:541", y="50mm:420mm:371"
    )
    workspace(
        "schoenflies-column-4dof", "gallery-schoenflies-column.png", panels="slices",
        x="-75mm:75mm:7", y="-75mm:105mm:361", theta="-100deg:100deg:201",
    )  # fmt: skip
    workspace(
        "cartesian-wrist-6dof", "gallery-cartesian-wrist.png", panels="slices", x="0", y="0", z="400mm",
        zeta="-180deg:180deg:361", xi="0:80deg:161", psi="-150deg:150deg:6",
    )  # fmt: skip
    workspace(
        "delta", "gallery-delta.png", panels="slices",
        x="-1000mm:1000mm:5", y="-1200mm:1200mm:241", z="-1600mm:-500mm:111",
    )  # fmt: skip
    workspace(
        "tricept", "gallery-tricept.png", panels="slices",
        x="-800mm:800mm:5", y="-1200mm:1200mm:241", z="300mm:1300mm:101",
    )  # fmt: skip


def mechanism(name, pose, picture):
    IMAGES.mkdir(exist_ok=True)
    opm("plot", name, f"--pose={pose}", "-o", IMAGES / picture, "--quiet")


def motion(mechanism, name, picture):
    record("trajectory", mechanism, f"--motion={name}", picture=picture, panels="imaginary,actuated")


def workspace(mechanism, picture, *flags, panels, **grid):
    grid = [f"--grid={name}={values}" for name, values in grid.items()]
    record("workspace", mechanism, *grid, *flags, picture=picture, panels=panels)


def record(*arguments, picture, panels):
    """Runs a command that records, and draws the recording."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "recording.mcap"
        opm(*arguments, "-o", path, "--quiet")
        IMAGES.mkdir(exist_ok=True)
        opm("plot", path, "-o", IMAGES / picture, f"--panels={panels}", "--quiet")
