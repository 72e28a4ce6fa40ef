"""Sweeps from Python against one call of inverse kinematics for every pose."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import opm_kinematics as opm
import pytest


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


GRID = {"x": (-0.25, 0.25, 41), "y": (-0.2, 0.2, 31), "zeta": 0.1, "xi": (-0.9, 0.9, 7), "psi": (-0.3, 0.3, 2)}


def test_a_sweep_is_inverse_kinematics_of_its_grid(manipulator):
    swept = opm.sweep(manipulator, **GRID)
    axes = list(swept.axes.values())
    assert list(swept.axes) == ["x", "y", "zeta", "xi", "psi"]
    np.testing.assert_allclose(axes[0], np.linspace(-0.25, 0.25, 41), atol=1e-15)
    poses = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    solutions = manipulator.inverse(poses)
    mask = swept.mask()
    assert mask.shape == (41, 31, 1, 7, 2) and mask.dtype == np.bool_
    np.testing.assert_array_equal(mask.ravel(), solutions.within_limits)
    assert swept.poses == mask.size and swept.count == mask.sum() and 0 < swept.fraction < 1
    assert swept.fraction == swept.count / swept.poses
    for column, name in enumerate(manipulator.imaginary_names):
        values = solutions.imaginary[solutions.within_limits, column]
        np.testing.assert_allclose(swept.imaginary_range[name], (values.min(), values.max()), atol=1e-12)
    # The grid's first coordinate is the fastest of the points.
    order = np.lexsort(poses.T)
    np.testing.assert_array_equal(swept.points(), poses[order][solutions.within_limits[order]])


def test_modes_and_threads(manipulator):
    any_mode = opm.sweep(manipulator, mode="any", **GRID)
    one_mode = opm.sweep(manipulator, mode="++ ++ ++ -", threads=2, **GRID)
    assert any_mode.count >= one_mode.count > 0
    assert not (one_mode.mask() & ~any_mode.mask()).any()
    np.testing.assert_array_equal(opm.sweep(manipulator, threads=3, **GRID).mask(), opm.sweep(manipulator, **GRID).mask())


def test_nothing_reachable(manipulator):
    swept = opm.sweep(manipulator, x=5.0)
    assert swept.count == 0 and swept.points().shape == (0, 5) and not swept.mask().any()
    assert swept.imaginary_range["theta11"] is None


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ({"w": 1.0}, "w: no such task coordinate, expected one of x, y, zeta, xi, psi"),
        ({"x": (1.0, -1.0, 3)}, "x: 1 to -1"),
        ({"x": (1.0, 2.0)}, r"x is \(1\.0, 2\.0\), expected a number, \(min, max, count\)"),
        ({"x": float("nan")}, "expected numbers"),
        ({"mode": "+-"}, "sign"),
    ],
)
def test_wrong_input_is_told(manipulator, axes, message):
    with pytest.raises(opm.OpmError, match=message):
        opm.sweep(manipulator, **axes)


def test_ctrl_c_stops_a_sweep(manipulator):
    wide = {name: (-0.9, 0.9, 1501) for name in ("zeta", "xi", "psi")}
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        opm.sweep(manipulator, x=(-0.2, 0.2, 401), y=(-0.2, 0.2, 401), **wide)
    assert time.monotonic() - start < 30  # alone it would take hours


def test_other_threads_go_on_during_a_sweep(manipulator):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    ticker = threading.Thread(target=tick)
    ticker.start()
    try:
        opm.sweep(manipulator, x=(-0.2, 0.2, 301), y=(-0.2, 0.2, 301), xi=(-0.5, 0.5, 301), zeta=(0.0, 1.0, 31))
    finally:
        done.set()
        ticker.join()
    assert len(ticks) > 3


def recorded_by_the_program(path, grid, *options):
    command = [sys.executable, "-m", "opm_kinematics", "workspace", "plano-spherical-5dof", "--quiet", *options]
    for name, range_ in grid.items():
        command += ["--grid", f"{name}=" + (":".join(map(str, range_)) if isinstance(range_, tuple) else str(range_))]
    subprocess.run([*command, "-o", path], capture_output=True, check=True)
    return path.read_bytes()


@pytest.mark.parametrize("ending", ["mcap", "npy", "ply"])
@pytest.mark.parametrize(
    ("mode", "shown"),
    [
        ("home", {}),
        ("any", {"axes": ["x", "y", "psi"], "scalars": ["theta11", "S1", "inverse_condition"], "color": "theta12"}),
        ("home", {"axes": "tip"}),
    ],
)
def test_a_recording_is_that_of_the_command_line(manipulator, tmp_path, ending, mode, shown):
    swept = opm.sweep(manipulator, mode=mode, **GRID)
    options = ["--mode", mode]
    for name, value in shown.items():
        options += [f"--{name}", value if isinstance(value, str) else ",".join(value)]
    expected = recorded_by_the_program(tmp_path / f"a.{ending}", GRID, *options)
    swept.write(tmp_path / f"b.{ending}", **shown)
    assert (tmp_path / f"b.{ending}").read_bytes() == expected


def test_wrong_recordings_are_told(manipulator, tmp_path):
    swept = opm.sweep(manipulator, **GRID)
    for options, message in [
        ({"axes": ["x", "y"]}, "^axes: .*expected three different task coordinates"),
        ({"scalars": ["w"]}, "^scalars: .*not one of"),
        ({"color": "w"}, "^color: .*not one of"),
    ]:
        with pytest.raises(opm.OpmError, match=message):
            swept.write_mcap(tmp_path / "a.mcap", **options)
    with pytest.raises(opm.OpmError, match="No such file"):
        swept.write_mcap(tmp_path / "none" / "a.mcap")
    for write, name in [(swept.write, "a.txt"), (swept.write_mcap, "a.npy"), (swept.write, "-")]:
        with pytest.raises(opm.OpmError, match=f"{name}, expected a name that ends in .mcap"):
            write(tmp_path / name)
    assert list(tmp_path.iterdir()) == []
