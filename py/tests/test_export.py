"""Models for other programs: what MuJoCo makes of them is tested with the command, in tests/python."""

import subprocess
import sys
from xml.etree import ElementTree

import opm_kinematics as opm
import pytest


@pytest.mark.parametrize(
    "mechanism", [opm.examples.plano_spherical(), opm.examples.bennett()], ids=lambda m: m.name
)
def test_a_model_is_that_of_the_command(mechanism):
    command = [sys.executable, "-m", "opm_kinematics", "export", "mjcf", mechanism.name]
    options = ["--density", "1200", "--time-step", "0.002"]
    for arguments, given in ([], {}), (options, {"density": 1200, "time_step": 2e-3}):
        done = subprocess.run([*command, *arguments, "-q"], capture_output=True, check=True, text=True)
        assert mechanism.to_mjcf(**given) == done.stdout
    model = ElementTree.fromstring(mechanism.to_mjcf())
    names = {joint.get("name") for joint in model.iter("joint")}
    balls = {joint.get("name") for joint in model.iter("joint") if joint.get("type") == "ball"}
    assert names == {name.split(".")[0] if name.split(".")[0] in balls else name for name in mechanism.joints}


@pytest.mark.parametrize("option", ["density", "time_step"])
@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf")])
def test_numbers_that_are_not_positive_are_refused(option, value):
    for mechanism in opm.examples.plano_spherical(), opm.examples.bennett():
        with pytest.raises(opm.OpmError, match=f"{option} is .*, expected a positive number"):
            mechanism.to_mjcf(**{option: value})
