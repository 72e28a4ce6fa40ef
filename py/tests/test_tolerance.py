"""Mechanism files whose joints nearly fit their subspaces."""

import pickle
import warnings
from pathlib import Path

import numpy as np
import opm_kinematics as opm
import pytest

NAME = "plano-spherical-5dof-joints"


def off() -> str:
    """The shipped mechanism; one axis passes the centre at half a millimetre."""
    lines = opm.examples.text(NAME).splitlines()
    moved = [line.replace("[0, 0, 0]", "[0.4330127, 0.25, 0]") if '"theta32"' in line else line for line in lines]
    assert moved != lines
    return "\n".join(moved)


def test_a_joint_that_is_off_is_named() -> None:
    with pytest.raises(opm.OpmError, match="theta32 of leg leg2: its axis passes the centre of the others at 0.50 mm"):
        opm.Manipulator.parse(off())


def test_it_is_snapped_within_the_tolerance(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="snapped joint theta32 of leg leg2"):
        snapped = opm.Manipulator.parse(off(), tolerance=0.6e-3)
    path = tmp_path / "off.toml"
    path.write_text(off())
    with pytest.warns(UserWarning, match="snapped joint theta32"):
        assert opm.Manipulator.load(path, tolerance=0.6e-3) == snapped
    exact = opm.examples.load(NAME)
    poses = np.zeros((3, 5)) + 0.01 * np.arange(3)[:, None]
    assert np.allclose(snapped.inverse(poses).joints, exact.inverse(poses).joints, atol=1e-9)
    with pytest.raises(opm.OpmError, match="0.50 mm"):
        opm.Manipulator.parse(off(), tolerance=0.4e-3)
    # The text is that of the corrected mechanism, and needs no tolerance.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pickle.loads(pickle.dumps(snapped)) == snapped


def test_an_exact_mechanism_stays_as_it_is() -> None:
    exact = opm.examples.load(NAME)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert opm.Manipulator.parse(exact.text, tolerance=1e-3) == exact


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan"), float("inf")])
def test_a_tolerance_is_a_positive_length(tolerance: float) -> None:
    with pytest.raises(opm.OpmError, match="expected a positive length"):
        opm.Manipulator.parse(off(), tolerance=tolerance)


def test_a_joint_that_is_slightly_off_is_a_warning() -> None:
    slightly = off().replace("[0.4330127, 0.25, 0]", "[0.01, 0, 0]")
    told = "joint theta32 of leg leg2: its axis passes the centre of the others at 0.0090 mm; tolerance="
    with pytest.warns(UserWarning, match=told):
        opm.Manipulator.parse(slightly)
