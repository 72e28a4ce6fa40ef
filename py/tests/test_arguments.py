"""Wrong arguments: one error that names the argument, what was given and what was expected."""

import errno
import re
import subprocess
import sys

import numpy as np
import opm_kinematics as opm
import pytest

POSES = "expected (..., 5): x, y, zeta, xi, psi"


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


def the_program_says(*arguments):
    command = [sys.executable, "-m", "opm_kinematics", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    return done.stderr


@pytest.mark.parametrize("threads", [0, -1, 1025, 4000, 10**30, 1.5, "two"])
def test_threads_are_as_many_as_the_program_allows(manipulator, threads):
    home = [manipulator.home]
    calls = [
        lambda: manipulator.inverse(np.zeros((10_000, 5)), threads=threads),
        lambda: manipulator.forward(np.zeros((1, 5)), threads=threads),
        lambda: manipulator.jacobian(home, threads=threads),
        lambda: manipulator.velocity(home, home, threads=threads),
        lambda: manipulator.singularity(home, threads=threads),
        lambda: manipulator.transform(home, threads=threads),
        lambda: manipulator.locate([np.eye(4)], threads=threads),
        lambda: opm.sweep(manipulator, x=0.0, threads=threads),
        lambda: opm.measure(manipulator, over={"x": 0.0}, threads=threads),
    ]
    for call in calls:
        with pytest.raises(opm.OpmError, match=re.escape(f"threads is {threads!r}, expected a whole number from 1 to 1024")):
            call()
    assert "1..=1024" in the_program_says("workspace", "plano-spherical-5dof", "--threads", "1025")


@pytest.mark.parametrize(
    ("poses", "given"),
    [
        (np.zeros(4), "has shape (4,)"),
        ([], "has shape (0,)"),
        (np.zeros((2, 3)), "has shape (2, 3)"),
        (np.zeros((1, 5, 2)), "has shape (1, 5, 2)"),
        ([[0, 0], [0]], "is [[0, 0], [0]]"),
        (np.zeros((1, 5), dtype=complex), "has entries of complex128"),
        ([["a"] * 5], "has entries of <U1"),
    ],
    ids=str,
)
def test_the_shape_of_poses_is_told(manipulator, poses, given):
    message = f"^poses {re.escape(given)}, {re.escape(POSES)}$"
    for call in (
        manipulator.inverse,
        manipulator.jacobian,
        manipulator.singularity,
        manipulator.transform,
        lambda wrong: manipulator.velocity(wrong, np.zeros((1, 5))),
    ):
        with pytest.raises(opm.OpmError, match=message):
            call(poses)
    home = [manipulator.home]
    for call, name in [
        (lambda: manipulator.velocity(home, poses), "rates"),
        (lambda: opm.trajectory(manipulator, poses, times=[0, 1, 2]), "motion"),
    ]:
        with pytest.raises(opm.OpmError, match=f"^{name} {re.escape(given)}, "):
            call()
    with pytest.raises(opm.OpmError, match=f"^joints {re.escape(given)}, .*S1, S2, S3, phi14, phi24"):
        manipulator.forward(poses)


def test_other_arrays_are_taken_as_they_were(manipulator):
    from fractions import Fraction

    expected = manipulator.inverse([manipulator.home]).joints
    for poses in (
        [[Fraction(0)] * 5],
        np.zeros((1, 5), dtype=np.int8),
        np.zeros((1, 5), dtype=np.float32),
        np.zeros((1, 10))[:, ::2],
        np.zeros((1, 5), dtype=">f8"),
    ):
        np.testing.assert_array_equal(manipulator.inverse(poses).joints, expected)


def test_files_that_cannot_be_read_are_named(manipulator, tmp_path):
    for call in (opm.Manipulator.load, lambda path: opm.trajectory(manipulator, path)):
        with pytest.raises(FileNotFoundError) as missing:
            call(tmp_path / "none.toml")
        assert (missing.value.filename, missing.value.errno) == (str(tmp_path / "none.toml"), errno.ENOENT)
        with pytest.raises(IsADirectoryError) as directory:
            call(tmp_path)
        assert directory.value.filename == str(tmp_path)
        (tmp_path / "a.png").write_bytes(b"a\nb\n\x89PNG")
        with pytest.raises(opm.OpmError, match=r"a\.png:3: not UTF-8, expected a (mechanism|motion) file"):
            call(tmp_path / "a.png")
    with pytest.raises(FileNotFoundError, match=re.escape('opm.examples.load("plano-spherical-5dof")')):
        opm.Manipulator.load("plano-spherical-5dof")
    with pytest.raises(TypeError, match="path"):
        opm.Manipulator.load(3)
    (tmp_path / "a.toml").write_text(manipulator.text)
    assert opm.Manipulator.load(bytes(tmp_path / "a.toml")) == manipulator


def test_ranges_are_those_of_the_program(manipulator):
    swept = opm.sweep(manipulator, x=(-0.1, 0.1, 3))
    share = "expected a share of at least 0 and less than 1"
    for tolerance in (1.0, -0.1, np.nan, np.inf):
        for call in (swept.measure, lambda **options: opm.measure(manipulator, over={"x": 0.0}, **options)):
            with pytest.raises(opm.OpmError, match=f"^tolerance is .*, {share}"):
                call(tolerance=tolerance)
    assert share in the_program_says("measure", "plano-spherical-5dof", "--tolerance", "1")
    for budget in (0, -1, 0.5):
        with pytest.raises(opm.OpmError, match=f"^budget is {budget}, expected a whole number of at least 1"):
            swept.measure(budget=budget)
    for shards in (0, -1, "a"):
        with pytest.raises(opm.OpmError, match="^shards is .*, expected a whole number of at least 1"):
            swept.mask(shards=shards)
    with pytest.raises(opm.OpmError, match="^scalars is 'theta11', expected a sequence of names"):
        swept.write("a.mcap", scalars="theta11")
    for write in (swept.write, swept.write_mcap):
        with pytest.raises(opm.OpmError, match="^axes is 5, expected three names or \"tip\""):
            write("a.mcap", axes=5)
    with pytest.raises(opm.OpmError, match=re.escape("pose has shape (3,), expected (..., 5): x, y, zeta, xi, psi")):
        manipulator.solids([0, 0, 0])
    with pytest.raises(opm.OpmError, match=re.escape("times has shape (1, 3), expected (n,) numbers")):
        opm.trajectory(manipulator, np.zeros((3, 5)), times=[[0, 1, 2]])


def test_a_range_has_a_width(manipulator):
    told = re.escape("x is (1.0, 1.0), expected min below max, or one value to hold it")
    with pytest.raises(opm.OpmError, match=f"^{told}"):
        opm.measure(manipulator, over={"x": (1.0, 1.0)})
    # What a measure was taken over can be asked for again.
    measured = opm.measure(manipulator, over={"x": (-0.1, 0.1), "y": 0.01})
    assert measured.over["y"] == 0.01 and measured.over["x"] == (-0.1, 0.1)
    assert opm.measure(manipulator, over=measured.over) == measured


def test_a_mapping_of_any_kind(manipulator):
    from types import MappingProxyType

    over = {"x": (-0.1, 0.1)}
    assert opm.measure(manipulator, over=MappingProxyType(over)).value == opm.measure(manipulator, over=over).value
