"""Every export is in the stubs, and the stubs tell the truth."""

import ast
import subprocess
import sys
from pathlib import Path

import opm_kinematics
from opm_kinematics import _native


def test_every_export_is_in_the_stubs():
    stub = ast.parse(Path(opm_kinematics.__file__).with_name("_native.pyi").read_text())
    named = {node.name for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    named |= {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
    exported = {name for name in dir(_native) if not name.startswith("_")} | {"__version__"}
    assert exported == {name for name in named if not name.startswith("_")} | {"__version__"}
    assert set(opm_kinematics.__all__) <= set(dir(opm_kinematics))


def test_every_export_of_the_package_is_documented():
    for name in opm_kinematics.__all__:
        exported = getattr(opm_kinematics, name)
        assert name == "__version__" or exported.__doc__, name


def test_the_examples_are_typed():
    examples = sorted(map(str, (Path(__file__).parents[2] / "examples").glob("*.py")))
    command = [sys.executable, "-m", "mypy", "--strict", "--disable-error-code=import-untyped", *examples]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert examples and found.returncode == 0, found.stdout + found.stderr


def test_the_stubs_are_those_of_the_module():
    command = [sys.executable, "-m", "mypy.stubtest", "opm_kinematics"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr
