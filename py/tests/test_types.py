"""Every export is in the stubs, and the stubs tell the truth."""

import ast
import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
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


def returned():
    """The annotation of what each function of the stub returns, by its name."""
    for node in ast.parse(STUB.read_text()).body:
        for function in [node] if isinstance(node, ast.FunctionDef) else getattr(node, "body", []):
            if isinstance(function, ast.FunctionDef):
                owner = "" if function is node else f"{node.name}."
                yield f"opm_kinematics._native.{owner}{function.name}", ast.unparse(function.returns)


def test_what_is_returned_is_under_returns():
    of_stub, checked = dict(returned()), 0
    for name, thing in members():
        if isinstance(thing, type) or not callable(thing):
            continue
        of_module = name.replace("opm_kinematics.", "opm_kinematics._native.", 1) if "_native" not in name else name
        answer = of_stub.get(of_module, getattr(thing, "__annotations__", {}).get("return", "something"))
        has = re.search(r"^Returns\n-+\n\S.*\n {4}\S", inspect.getdoc(thing), re.MULTILINE)
        assert bool(has) == (answer not in ("None", None)), name
        checked += 1
    assert checked > 100


#: What is called with a wrong word, by the alias that the stub has for the right ones.
WORDS = {
    "_Joints": lambda m, word: m.inverse(m.home, joints=word),
    "_Frame": lambda m, word: m.analyze(m.home, wrench=[0.0] * 6, frame=word),
    "_Errors": lambda m, word: m.accuracy(m.home, errors=word),
    "_Method": lambda m, word: m.forward(np.zeros(3), method=word),
    "_Coordinates": lambda m, word: m.with_coordinates(word),
    "_Section": lambda m, word: opm_kinematics.measure(m, section=word),
    "_Shape": lambda m, word: opm_kinematics.sweep(m, x=(-0.01, 0.01, 3)).inscribed(word),
    "_Ends": lambda m, word: opm_kinematics.trajectory(m, np.tile(m.home, (3, 1)), times=[0, 1, 2], ends=word),
    "_Units": lambda m, word: opm_kinematics.trajectory(m, np.tile(m.home, (3, 1)), times=[0, 1, 2]).write_table("a.csv", units=word),
    "_JointKind": lambda m, word: opm_kinematics.Joint("a", word, axis=(0, 0, 1)),
    "_Kind": lambda m, word: opm_kinematics.sweep(m, kind=word),
}


def test_the_words_of_arguments_are_those_of_the_module():
    aliases = {
        node.target.id: set(re.findall(r"'([a-z-]+)'", ast.unparse(node.value)))
        for node in ast.parse(STUB.read_text()).body
        if isinstance(node, ast.AnnAssign) and node.value and ast.unparse(node.value).startswith("Literal[")
    }
    assert set(aliases) == set(WORDS)
    m = opm_kinematics.examples.load("delta")
    for alias, call in WORDS.items():
        with pytest.raises(opm_kinematics.OpmError) as told:
            call(m, "nonsense")
        message = str(told.value)
        assert re.match(r"(?:joint a: )?\w+(?: is|:) \"nonsense\", expected", message), message
        assert set(re.findall(r"[a-z-]+", message.split("expected")[1])) - {"one", "of", "or"} == aliases[alias]


class Odd:
    """What no argument can be."""

    def __repr__(self):
        return "<odd>"


def odd_calls():
    """Every argument of everything that can be called, given as something odd: its name, and the call."""
    m, linkage = opm_kinematics.examples.load("plano-spherical-5dof"), opm_kinematics.examples.bennett()
    followed = opm_kinematics.trajectory(m, "plano-spherical-sinusoids", rate=5)
    swept = opm_kinematics.sweep(m, x=(-0.1, 0.1, 5), xi=(-0.1, 0.1, 3))
    whole = {
        "poses": m.home, "rates": m.home, "accelerations": m.home, "efforts": np.zeros(5), "joints": np.zeros(5), "transforms": np.eye(4), "values": [0.1], "legs": m.screws,
        "pose": m.home, "times": [0.0, 0.1], "frequencies": [1.0], "link_stiffness": (1e6, 1e4), "path": "none.mcap", "text": m.text, "motion": "plano-spherical-sinusoids", "manipulator": m, "coordinates": "tilt-torsion",
        "measurements": {}, "over": {"x": (-0.1, 0.1)}, "shape": "disc", "start": m.home, "goal": m.home, "changes": {},
        "name": "a", "kind": "revolute", "actuated": [[True] * len(rows) for rows in m.screws.values()],
    }  # fmt: skip
    owners = [(thing, [n for n in vars(type(thing)) if not n.startswith("_")]) for thing in (m, linkage, swept, followed)]
    owners.append((opm_kinematics, ["Joint", "calibrate", "measure", "recover", "sweep", "trajectory"]))
    for owner, names in owners:
        for name in names:
            function = getattr(owner, name)
            parameters = inspect.signature(function).parameters.values() if callable(function) else ()
            for odd in parameters:
                # An executor is asked for only where it has work, and panels are matplotlib's.
                if odd.kind is odd.VAR_KEYWORD or odd.name in ("default", "executor", "ax"):
                    continue
                given = {p.name: whole[p.name] for p in parameters if p.default is p.empty and p.kind is not p.VAR_KEYWORD and p.name in whole}
                if name == "inverse" and odd.name not in ("poses", "transforms"):
                    given["poses"] = m.home
                if name == "from_joints":
                    given["legs"] = m.legs
                given[odd.name] = Odd()
                first = [given.pop(p.name) for p in parameters if p.kind is p.POSITIONAL_ONLY and p.name in given]
                yield f"{name}({odd.name}=)", odd.name, lambda f=function, a=first, g=given: f(*a, **g)


def test_a_wrong_argument_is_named():
    checked = 0
    for call, name, make in odd_calls():
        with pytest.raises((opm_kinematics.OpmError, TypeError)) as told:
            make()
        # From Python 3.11 on, the name is in a note that the traceback shows.
        message = " ".join([str(told.value), *getattr(told.value, "__notes__", [])])
        # Waypoints are poses.
        known = name in message or (name == "motion" and message.startswith("poses")) or "os.PathLike" in message
        assert known and re.search(r"odd|Odd| needs? ", message), f"{call}: {message}"
        checked += 1
    assert checked > 150
