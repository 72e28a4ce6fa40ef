"""Every export is in the stubs, and the stubs tell the truth."""

import ast
import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import opm_kinematics
import pytest
from opm_kinematics import _native

STUB = Path(opm_kinematics.__file__).with_name("_native.pyi")


def test_every_export_is_in_the_stubs():
    stub = ast.parse(STUB.read_text())
    named = {node.name for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    named |= {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
    exported = {name for name in dir(_native) if not name.startswith("_")} | {"__version__"}
    assert exported == {name for name in named if not name.startswith("_")} | {"__version__"}
    assert set(opm_kinematics.__all__) <= set(dir(opm_kinematics))


def test_every_export_of_the_package_is_documented():
    for name in opm_kinematics.__all__:
        exported = getattr(opm_kinematics, name)
        assert name == "__version__" or exported.__doc__, name


#: Forms of arguments that no example has.
FORMS = """
import numpy as np
import opm_kinematics as opm

m = opm.examples.load("plano-spherical-5dof")
opm.sweep(m, x=np.linspace(-0.1, 0.1, 5), y=[-0.1, 0.0, 0.1], zeta=0.1, xi=(0.0, 0.3, 4))
m.inverse({"x": 0.01, "xi": 0.1})
m.inverse(transforms=np.eye(4))
"""


def test_the_examples_are_typed(tmp_path):
    examples = sorted(map(str, (Path(__file__).parents[2] / "examples").glob("*.py")))
    forms = tmp_path / "forms.py"
    forms.write_text(FORMS)
    command = [sys.executable, "-m", "mypy", "--strict", "--disable-error-code=import-untyped", *examples, str(forms)]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert examples and found.returncode == 0, found.stdout + found.stderr


def test_the_stubs_are_those_of_the_module():
    command = [sys.executable, "-m", "mypy.stubtest", "opm_kinematics"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr


MODULES = [importlib.import_module(f"opm_kinematics{name}") for name in ("", "._native", ".design", ".examples", ".plot")]


def members():
    """Everything public: its name, itself, and its arguments where it is called."""
    for module in MODULES:
        for name in module.__all__ if hasattr(module, "__all__") else vars(module):
            thing = getattr(module, name)
            if inspect.ismodule(thing) or isinstance(thing, (str, tuple)) or not hasattr(thing, "__module__"):
                continue
            yield f"{module.__name__}.{name}", thing
            for member in vars(thing) if isinstance(thing, type) else ():
                if not member.startswith("_"):
                    yield f"{module.__name__}.{name}.{member}", getattr(thing, member)


def arguments(thing):
    if isinstance(thing, type) or not callable(thing):
        return []
    return [name for name in inspect.signature(thing).parameters if name != "self"]


def test_everything_public_has_a_docstring_at_run_time():
    found = list(members())
    assert len(found) > 150
    for name, thing in found:
        # The attributes of a dataclass are described where they are.
        if name.count(".") < 3 or not name.startswith("opm_kinematics.design"):
            assert inspect.getdoc(thing), name


def test_every_argument_is_under_parameters():
    checked = 0
    for name, thing in members():
        if not (names := arguments(thing)):
            continue
        section = re.search(r"^Parameters\n-+\n(.*?)(?:\n\n\S|\Z)", inspect.getdoc(thing) or "", re.DOTALL | re.MULTILINE)
        assert section, f"{name} has no Parameters"
        listed = {n.strip(" *") for line in re.findall(r"^\S[^\n]*", section[1], re.MULTILINE) for n in line.split(" : ")[0].split(",")}
        assert listed == set(names), name
        checked += 1
    assert checked > 40


@pytest.mark.parametrize("of", ["Assembly", "Motion", "Singularity", "Solid", "Solutions", "Trajectory"])
def test_every_array_tells_its_shape_and_unit(of):
    stub = ast.parse(STUB.read_text())
    body = next(node.body for node in stub.body if isinstance(node, ast.ClassDef) and node.name == of)
    arrays = [f for f in body if isinstance(f, ast.FunctionDef) and ast.unparse(f.returns or f).startswith("NDArray[np.float64]") and not f.args.args[1:]]
    for f in (f for f in arrays if not f.name.startswith("_")):
        doc = inspect.getdoc(getattr(getattr(_native, of), f.name))
        assert re.match(r"\([\w, .]+\)", doc), f.name
        assert re.search(r"metres|radians|seconds|no unit|rad/s|m/s", doc), f.name


def test_the_stub_leaves_docstrings_to_the_module():
    described = [node for node in ast.walk(ast.parse(STUB.read_text())) if isinstance(node, (ast.ClassDef, ast.FunctionDef))]
    assert len(described) > 400
    assert [node.name for node in described if ast.get_docstring(node)] == []
