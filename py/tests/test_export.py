"""Models and code for other programs: what MuJoCo makes of models is tested in tests/python, and code with its crate."""

import importlib
import pickle
import re
import subprocess
import sys
from html.parser import HTMLParser
from xml.etree import ElementTree

import blark.parse
import numpy as np
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
    assert names == {name.split(".")[0] if name.split(".")[0] in balls else name for name in mechanism.joint_names}


def test_a_tree_and_its_closures_are_those_of_the_command(tmp_path):
    for mechanism in opm.examples.plano_spherical(), opm.examples.bennett():
        path = tmp_path / "model.urdf"
        command = [sys.executable, "-m", "opm_kinematics", "export", "urdf", mechanism.name, "-q", "-o", path]
        subprocess.run([*command, "--density", "1200"], check=True)
        assert mechanism.to_urdf(density=1200) == path.read_text()
        assert mechanism.to_closures() == path.with_suffix(".yaml").read_text()
        with pytest.raises(opm.OpmError, match="density is -1, expected a number from"):
            mechanism.to_urdf(density=-1)


def test_a_reference_is_that_of_the_command(tmp_path):
    mechanism, motion = opm.examples.plano_spherical(), "plano-spherical-sinusoids"
    path = tmp_path / "model.xml"
    command = [sys.executable, "-m", "opm_kinematics", "export", "mjcf", mechanism.name, "-q", "-o", path]
    subprocess.run([*command, "--trajectory", motion, "--time-step", "0.01"], check=True)
    names, rows = mechanism.mjcf_reference(motion, time_step=0.01)
    header, *lines = path.with_suffix(".csv").read_text().splitlines()
    assert names == header.split(",")
    np.testing.assert_array_equal(rows, [[float(cell) for cell in line.split(",")] for line in lines])
    with pytest.raises(opm.OpmError, match="is out of reach"):
        far = tmp_path / "far.csv"
        far.write_text("t,x\n0,0\n1,5\n")
        mechanism.mjcf_reference(far)


def test_joints_are_data():
    mechanism = opm.examples.plano_spherical()
    assert list(mechanism.legs) == ["leg1", "leg2", "leg3", "leg4"]
    joints = [joint for leg in mechanism.legs.values() for joint in leg]
    assert [name for joint in joints for name in joint.coordinates] == mechanism.joint_names
    slider, ball = joints[0], joints[-1]
    assert (slider.name, slider.kind, slider.actuated, slider.units) == ("S1", "prismatic", True, ["m"])
    assert (ball.kind, ball.axis, ball.pitch, len(ball.home)) == ("spherical", None, None, 3)
    home = mechanism.inverse([mechanism.home]).joints[0]
    np.testing.assert_allclose([value for joint in joints for value in joint.home], home, atol=1e-12)
    copied = pickle.loads(pickle.dumps(slider))
    assert copied == slider


def test_a_list_of_joints_gives_the_same_joints():
    generator = np.random.default_rng(19)
    for mechanism in opm.examples.plano_spherical(), opm.examples.load("planar-planar-5dof"):
        listed = opm.Manipulator.parse(mechanism.to_joints())
        assert listed.parameters == {} and listed.reference_point == mechanism.reference_point
        poses = mechanism.home + 0.1 * generator.uniform(-1, 1, (50, len(mechanism.home)))
        one, other = (m.inverse(poses, mode="all") for m in (listed, mechanism))
        np.testing.assert_array_equal(one.reachable, other.reachable)
        np.testing.assert_allclose(one.joints, other.joints, rtol=0, atol=1e-12)


@pytest.mark.parametrize("option", ["density", "time_step"])
@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf")])
def test_numbers_that_are_not_positive_are_refused(option, value):
    for mechanism in opm.examples.plano_spherical(), opm.examples.bennett():
        with pytest.raises(opm.OpmError, match=f"{option} is .*, expected a number from"):
            mechanism.to_mjcf(**{option: value})


@pytest.mark.parametrize("language", ["c", "rust", "python", "matlab", "st"])
def test_code_is_that_of_the_command(language, tmp_path):
    mechanism = opm.examples.plano_spherical()
    command = [sys.executable, "-m", "opm_kinematics", "generate", language, mechanism.name, "-q", "-o", tmp_path]
    subprocess.run(command, check=True)
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    code = getattr(mechanism, f"to_{language}")()
    assert code == {path.relative_to(tmp_path).as_posix(): path.read_text() for path in files}


def test_generated_python_is_opm(tmp_path, monkeypatch):
    mechanism = opm.examples.plano_spherical()
    for name, text in mechanism.to_python().items():
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    code = importlib.import_module("plano_spherical_5dof")
    poses = np.random.default_rng(0).uniform(-0.1, 0.1, (500, code.COORDINATES))
    expected, found = mechanism.inverse(poses), code.inverse(poses)
    assert expected.reachable.any()
    np.testing.assert_array_equal(found.status == 0, expected.reachable)
    joints = expected.joints[expected.reachable]
    np.testing.assert_allclose(found.joints[expected.reachable], joints, rtol=0, atol=1e-11)


def test_a_page_is_that_of_the_command(tmp_path):
    mechanism = opm.examples.plano_spherical()
    command = [sys.executable, "-m", "opm_kinematics", "explore", mechanism.name, "-q", "-o", tmp_path / "a.html"]
    subprocess.run(command, check=True)
    page = mechanism.explore()
    page.save(tmp_path / "b.html")
    assert (tmp_path / "b.html").read_bytes() == (tmp_path / "a.html").read_bytes()
    assert opm.explore(mechanism).html == page.html == (tmp_path / "a.html").read_text()
    assert {path.name for path in tmp_path.iterdir()} == {"a.html", "b.html"}
    assert (page.name, repr(page)) == (mechanism.name, f"<Explorer of {mechanism.name}: {len(page.html.encode())} bytes of HTML>")


def test_a_page_shows_itself_in_a_notebook():
    class Frame(HTMLParser):
        def handle_starttag(self, tag, attrs):
            self.tag, self.attributes = tag, dict(attrs)

    page = opm.examples.plano_spherical().with_parameters({"leg1.h": 0.13}).explore()
    frame = Frame()
    frame.feed(page._repr_html_())
    assert frame.tag == "iframe"
    # A browser reads the page that the file has.
    assert frame.attributes["srcdoc"] == page.html
    assert "0.13" in page.html


def test_a_page_that_cannot_be_written_says_where(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        opm.examples.plano_spherical().explore().save(tmp_path / "nowhere" / "a.html")
    assert list(tmp_path.iterdir()) == []


def test_a_grammar_of_others_accepts_structured_text():
    text = opm.examples.load("five-bar").to_st()["five_bar.st"]
    declarations = re.split(r"(?<=END_TYPE)\n\n|(?<=END_FUNCTION)\n\n|(?<=END_FUNCTION_BLOCK)\n\n", text)
    assert len(declarations) > 90
    # All of them would take half a minute.
    for declaration in declarations[::5]:
        assert blark.parse.parse_source_code(declaration).exception is None, declaration
    # It does find errors.
    assert blark.parse.parse_source_code("FUNCTION f : LREAL f := 1.0 END_FUNCTION").exception is not None
