"""Models and code for other programs: what MuJoCo makes of models is tested in tests/python, and code with its crate."""

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


def test_code_is_that_of_the_command(tmp_path):
    mechanism = opm.examples.plano_spherical()
    command = [sys.executable, "-m", "opm_kinematics", "generate", "c", mechanism.name, "-q", "-o", tmp_path]
    subprocess.run(command, check=True)
    assert mechanism.to_c() == {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert "int plano_spherical_5dof_inverse(" in mechanism.to_c()["plano_spherical_5dof.h"]
