"""`opm schema`, compared with what opm reads: the shipped files, those of cli/src/format.md, and damaged ones."""

import copy
import datetime
import json
import math
import re
import subprocess
import sys
from pathlib import Path
from random import Random

import jsonschema
import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

REPOSITORY = Path(__file__).parents[2]
MECHANISMS = sorted((REPOSITORY / "crates/opm-core/mechanisms").glob("*.toml"))
MOTIONS = sorted((REPOSITORY / "crates/opm-core/motions").glob("*.toml"))
FORMAT = REPOSITORY / "cli/src/format.md"

# Every type of joint, every hint, every optional key.
EVERY_KEY = """
format = 1
name = "every-key"
units = { length = "in", angle = "rad" }
platform = { point = [10, 20, 30] }

[task]
axis = [0, 0, -2]
lower = { x = [1, 0, 0], normal = [0, 0, 1], origin = [0, 0, 0] }
upper = { x = [1, 0, 0], w = [0, 1, 0], normal = [0, 0, 1], origin = [0, 0, 0] }
home = { x = 1, y = 2, z = 3, h = 4, w = 5, theta = 0.1, phi = 0.2, zeta = 0.3, xi = 0.4, psi = 0.5, mu = 0.6, nu = 0.7 }

[bodies]
density = 1200
masses = { platform = 0.8, S1 = 0.25 }
centres = { platform = [1, 2, 3], S1 = [4, 5, 6] }
inertias = { platform = [1, 2, 2], S1 = [1, 2, 2, 0.1, 0.2, 0.3] }
payload = { mass = 2, centre = [0, 0, 1], inertia = [0.1, 0.1, 0.1] }
radius = 0.1
radii = { base = 0.2, platform = 0.3, S1 = 0.4 }

[[obstacle]]
name = "housing"
type = "box"
centre = [100, 0, 0]
size = [1, 2, 3]
x = [1, 1, 0]
y = [0, 1, 0]

[[obstacle]]
type = "capsule"
from = [200, 0, 0]
to = [200, 0, 9]
radius = 2

[[obstacle]]
type = "half-space"
point = [0, 0, -99]
normal = [0, 0, 1]

[[difference]]
joints = ["r1", "h1"]
limits = [-1, 0.5]

[[leg]]
name = "left"
joints = [
  { name = "S1", type = "prismatic", axis = [0, 3, 4], point = [1, 2, 3], actuated = true, home = 12.5, limits = [-300, 300] },
  { name = "r1", type = "revolute", axis = [0, 0, 2], point = [100, 40, 0], actuated = false, home = 0.5, limits = [0, 1] },
  { name = "h1", type = "helical", axis = [0, 1, 0], point = [0, 0, 0], pitch = -20, actuated = true, home = 0.5, limits = [0, 1] },
]

[[leg]]
joints = [
  { name = "u1", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [1, 2, 3], actuated = true, home = [1, -2], limits = [[0, 9], [-3, 3]] },
  { name = "c1", type = "cylindrical", axis = [0, 0, 1], point = [0, 0, 5], actuated = true, home = [3, 7], limits = [[0, 9], [-10, 10]] },
  { name = "s1", type = "spherical", point = [0, 0, 1], actuated = true, home = [0, 0, 0], limits = [[-1, 1], [-2, 2], [-3, 3]] },
]
"""

# The joints of families that may have limits.
LIMITED = {
    "plano-spherical": {"slider_leg": "S phi1 phi2 theta2 theta3", "arm_leg": "phi1 phi2"},
    "translational-helical": {"leg": "S r phi"},
    "planar-planar": {"slider_leg": "S phi1 phi2 rod hinge", "arm_leg": "phi1 phi2 fold1 fold2 hinge"},
}

# Constants, sinusoids and sums, with every optional key.
EVERY_MOTION = """
format = 1
name = "every-key"
units = { length = "cm", angle = "deg" }
duration = 0.02
rate = 100
mode = "home"

[coordinates]
x = 0.1
y = { amplitude = 0.1, frequency = 2, phase = 90, offset = 0.1 }
zeta = [1, { amplitude = 1, frequency = 1, phase = 30, offset = 0 }]
xi = []
"""

# Points that splines join, with every optional key.
EVERY_POINT = """
format = 1
name = "every-point"
units = { length = "mm", angle = "deg" }
rate = 100
mode = "home"
ends = "periodic"

[points]
t = [0, 0.01, 0.02]
x = [0, 1, 0]
xi = 0.5
"""

# Lines and arcs, with every optional key.
EVERY_MOVE = """
format = 1
name = "every-move"
units = { length = "mm", angle = "deg" }
rate = 100
mode = "home"
feed = 100
acceleration = 1000
blend = 1
start = { x = -10, xi = 1 }

[[moves]]
to = { x = 10 }
feed = 50

[[moves]]
to = { x = 10, y = 20, psi = 2 }
via = { x = 20, y = 10 }
blend = 2

[[moves]]
to = { x = -10 }
"""

# What opm refuses and a schema cannot say. Such a file is accepted by the schema.
UNSAYABLE = [
    # values of numbers and of expressions
    ": `[^`]+`: ",
    "expected at (least|most) -?[0-9]+ (mm|deg)$",
    "is a point, expected a number",
    "is a point, which has no min and max",
    "has a point in a point",
    "is the number .*, expected a (point|direction)",
    # names of patterns
    "in every leg of the pattern, expected a name with {i}",
    "expected a finite number",
    "expected an absolute value of at most",
    "is zero, expected a direction",
    "`axis2` is parallel to `axis`",
    "`x` and `y` are parallel",
    "`pitch` is 0, expected",
    "are reversed: ",
    "exclude home: ",
    "`joints` cannot be used: ",
    "^(?!.*`(radius|base|platform|S1)`).*expected a length above 0",
    "expected a length of at least 0",
    "expected an arc between 0 and",
    # several values together
    "is the inertia of no body",
    "two (joints|legs|obstacles) are called",
    "is .* for two legs, expected different names",
    "is the name of that leg's imaginary joint",
    "has no `pitch`, expected it for exactly one leg",
    "`pitch` is given for . legs, expected it for exactly one",
    "gives the direction alpha \\+ beta = ",
    "expected a later time",
    "move .: the position does not change",
    "start, `via` and `to` are on one line",
    "and the blends at its ends need",
    "is given for the last move",
    "`feed` is missing, expected a speed, here or for all moves",
    "values?, expected . as `t` has",
    "no body is called",
    "carries the platform, expected `platform`",
    # geometry
    "home is out of this leg's reach by",
    "the joints of the leg are linearly dependent",
    # the mechanism that a motion is for
    "expected `home` or one sign for every choice",
    "unknown key `(x|y|z|w|theta|phi|zeta|xi|psi|mu|nu)`, .*expected one of (`t`, )?`x`, `y`, ",
]

# What opm says of a mechanism that it has read.
AFTER_READING = [
    r"\[task\] ",
    "decompos",
    "subspace",
    "singular",
    "mobility",
    "do not control",
    "no closed-form",
    ": lasts .* s, expected at most",
]


@pytest.fixture(scope="session")
def schema(opm):
    """Validators by the kind of file."""

    def validator(kind):
        text = subprocess.run([opm, "schema", kind], check=True, capture_output=True, text=True).stdout
        schema = json.loads(text)
        jsonschema.Draft7Validator.check_schema(schema)
        return jsonschema.Draft7Validator(schema)

    return {kind: validator(kind) for kind in ["mechanism", "motion"]}


@pytest.fixture
def problems(opm, tmp_path):
    """What opm refuses in the text of a file, line by line; nothing if it reads the file."""

    def read(kind, text):
        file = tmp_path / "file.toml"
        file.write_text(text, encoding="utf-8")
        if kind == "mechanism":
            command = [opm, "decompose", file]
        else:
            mechanism = "translational-helical-3dof" if "helical" in text else "plano-spherical-5dof"
            command = [opm, "trajectory", mechanism, "--motion", file]
        done = subprocess.run([*command, "--quiet"], capture_output=True, text=True)
        assert done.returncode in (0, 1), done.stderr
        assert "panicked" not in done.stderr
        found = [line.split("file.toml", 1)[-1] for line in done.stderr.splitlines()]
        if done.returncode == 0:
            assert found == []
        read = [line for line in found if not any(re.search(p, line) for p in AFTER_READING)]
        # Only problems of reading have a line and a column.
        assert all(re.match(r":\d+:\d+: ", line) for line in read), read
        return read

    return read


def blocks():
    """The complete files in cli/src/format.md, with their kinds."""
    for block in re.findall(r"^```toml\n(.*?)^```", FORMAT.read_text(encoding="utf-8"), re.M | re.S):
        yield ("motion" if re.search(r"^\[(coordinates|points|\[moves\])\]", block, re.M) else "mechanism", block)


def fragments():
    """The parts of files in cli/src/format.md, completed to files."""
    named = {path.stem: path.read_text(encoding="utf-8") for path in MECHANISMS}
    for kind, block in re.findall(r"^```toml \((.*?)\)\n(.*?)^```", FORMAT.read_text(encoding="utf-8"), re.M | re.S):
        if kind == "joints":
            head, _, _ = EVERY_KEY.partition("[[leg]]")
            joints = ",\n".join(block.splitlines())
            other = '{ name = "other", type = "spherical", point = [0, 0, 0] }'
            text = head.replace('angle = "rad"', 'angle = "deg"').partition("[task]")[0]
            yield text + f"[[leg]]\njoints = [\n{joints}\n]\n[[leg]]\njoints = [{other}]\n"
        elif kind.startswith(("obstacles of ", "differences of ")):
            yield named[kind.partition(" of ")[2]] + "\n" + block
        elif kind.startswith("part of "):
            yield named[kind.removeprefix("part of ")].partition("[[leg]]")[0] + block
        else:
            text = named[kind.removeprefix("task of ")]
            yield re.sub(r"^\[task\]\n.*?\n\n", block + "\n", text, count=1, flags=re.M | re.S)


def documents():
    yield from (("mechanism", path.read_text(encoding="utf-8")) for path in MECHANISMS)
    yield from (("motion", path.read_text(encoding="utf-8")) for path in MOTIONS)
    yield from blocks()
    yield from (("mechanism", text) for text in fragments())
    yield from [("mechanism", EVERY_KEY), ("motion", EVERY_MOTION), ("motion", EVERY_POINT), ("motion", EVERY_MOVE)]


def test_what_is_shipped_and_explained_is_valid(schema, problems):
    found = list(documents())
    explained = FORMAT.read_text(encoding="utf-8").count("```toml")
    assert explained >= 6
    assert len(found) == len(MECHANISMS) + len(MOTIONS) + explained + 4
    for kind, text in found:
        errors = [error.message for error in schema[kind].iter_errors(tomllib.loads(text))]
        assert errors == [], text
        assert problems(kind, text) == [], text


def test_the_explained_mechanisms_can_be_solved(opm, tmp_path):
    """All but the list of joints, which is no mechanism."""
    found = [text for kind, text in blocks() if kind == "mechanism"]
    found += [text for text in fragments() if "every-key" not in text]
    assert len(found) >= 4
    for text in found:
        file = tmp_path / "file.toml"
        file.write_text(text, encoding="utf-8")
        done = subprocess.run([opm, "ik", file, "--pose", "y=1mm"], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, ""), text
        assert "mode" in done.stdout


def test_every_key_is_explained(schema):
    """In editors, which show the descriptions, and in cli/src/format.md."""
    page = re.findall(r"`\"?([\w-]+)\"?`", FORMAT.read_text(encoding="utf-8"))

    def keys(schema):
        for key, value in schema.get("properties", {}).items():
            if value is not True:
                yield key, value
                yield from keys(value)
                for part in [value.get("items", {}), *value.get("anyOf", [])]:
                    if isinstance(part, dict):
                        yield from keys(part)

    for kind in schema:
        found = list(keys(schema[kind].schema))
        assert len(found) > 20
        for key, value in found:
            assert len(value.get("description", "")) > 10, (kind, key)
            for word in [key, *value.get("enum", [])]:
                assert word in {*page, "platform", "task", "bodies", "obstacle", "difference", "leg", "slider_leg", "arm_leg", "coordinates", "points", "moves", "parameters"}, (kind, word)


def toml(value):
    """A value as TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, datetime.date):
        return value.isoformat()
    return json.dumps(value).replace("NaN", "nan")


def in_toml(document):
    return "".join(f"{json.dumps(key)} = {toml(value)}\n" for key, value in document.items())


def with_all_limits(document):
    """The document of a family with limits on every joint that may have them."""
    for table, joints in LIMITED.get(document.get("family"), {}).items():
        legs = document[table]
        for leg in legs if isinstance(legs, list) else [legs]:
            leg["limits"] = {joint: [-1000, 1000] for joint in joints.split()}
            leg["max_rate"] = dict.fromkeys(joints.split(), 500)
            leg["max_acceleration"] = dict.fromkeys(joints.split(), 2000)
            leg["max_effort"] = dict.fromkeys(joints.split(), 80)
            leg["offset"] = dict.fromkeys(joints.split(), 0.5)
    return document


def places(value, path=()):
    """Every place in a document, the outer ones first."""
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from places(item, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


def alike(document, path):
    """What two places have in common, if damage there is the same: the keys, and the types of joints."""
    common = [document.get("family")]
    for depth, key in enumerate(path, 1):
        value = at(document, path[:depth])
        common.append(key if isinstance(key, str) else "#")
        common.append(value.get("type") if isinstance(value, dict) else None)
    return tuple(common)


WRONG = [
    *["text", "", True, datetime.date(2026, 1, 2), {}, {"x": 1}],
    *[7, -0.5, 0, 1e12, math.nan, [], [1, 2], [2, 1], [0, 0, 0], [[1, 2], [3, 4]]],
]


# How many of the wrong values are tried at a place: 2,000 files take half a minute.
SHARE = 0.15


def damaged(document, path, random):
    """Documents with one thing wrong at a place, each with a description."""
    *outer, key = path

    def changed(change):
        copied = copy.deepcopy(document)
        change(at(copied, outer))
        return copied

    yield f"{path} is missing", changed(lambda table: table.pop(key))
    for wrong in (wrong for wrong in WRONG if random.random() < SHARE):
        yield f"{path} is {wrong!r}", changed(lambda table: table.__setitem__(key, wrong))
    value = at(document, path)
    if isinstance(key, str):
        rest = [f"{key}_", key.swapcase()]
        for other in rest:
            yield f"{path} is called {other}", changed(lambda table: table.__setitem__(other, table.pop(key)))
    if isinstance(value, dict):
        # A value that others of the table have.
        more = copy.deepcopy(next(iter(value.values()), 1))
        yield f"{path} has one key more", changed(lambda table: table[key].__setitem__("surplus", more))
    if isinstance(value, list) and value:
        yield f"{path} has one item more", changed(lambda table: table[key].append(copy.deepcopy(value[0])))
    if isinstance(value, str):
        for wrong in [f"{value}_", f" {value}", f"{value} ", f"a,{value}", value.upper(), "+", "++ ++ ++", "x", "home"]:
            yield f"{path} is {wrong!r}", changed(lambda table: table.__setitem__(key, wrong))


def joints_of_other_types(document):
    """Every joint with the type of every other."""
    for leg, table in enumerate(document.get("leg", [])):
        for number, joint in enumerate(table.get("joints", [])):
            for other in ["revolute", "prismatic", "helical", "cylindrical", "universal", "spherical", "ball"]:
                if other != joint["type"]:
                    changed = copy.deepcopy(document)
                    changed["leg"][leg]["joints"][number]["type"] = other
                    yield f"{joint['name']} is {other}", changed


def several_things_together(document):
    """What no schema can say."""
    one, other = document["leg"]
    first, second = one["joints"][:2]
    yield "one leg", {**document, "leg": [one]}
    yield "two legs are called the same", {**document, "leg": [one, {**other, "name": one["name"]}]}
    for name in [second["name"], "tau.left", "s1.x"]:
        joints = [{**first, "name": name}, *one["joints"][1:]]
        yield f"a joint is called {name}", {**document, "leg": [{**one, "joints": joints}, other]}
    passive = [{**leg, "joints": [{**joint, "actuated": False} for joint in leg["joints"]]} for leg in [one, other]]
    yield "no joint is actuated", {**document, "leg": passive}
    helical = {**one["joints"][2], "pitch": 0}
    yield "a pitch of 0", {**document, "leg": [{**one, "joints": [first, helical]}, other]}
    universal = {**other["joints"][0], "axis2": [2, 0, 0]}
    yield "axes are parallel", {**document, "leg": [one, {**other, "joints": [universal]}]}
    axisless = {**first, "axis": [0, 0, 0]}
    yield "an axis is zero", {**document, "leg": [{**one, "joints": [axisless, *one["joints"][1:]]}, other]}
    box, *obstacles = document["obstacle"]
    yield "edges are parallel", {**document, "obstacle": [{**box, "y": box["x"]}, *obstacles]}


def legs_of_families_together(document):
    if document["family"] == "translational-helical":
        legs = document["leg"]
        yield "two legs are helical", {**document, "leg": [legs[0], {**legs[1], "pitch": 3}, legs[2]]}
    if "slider_leg" in document:
        first, *others = document["slider_leg"]
        yield "a distance is negative", {**document, "slider_leg": [{**first, "h": -1}, *others]}
        yield "a length is zero", {**document, "slider_leg": [{**first, "a1": 0}, *others]}
    for key in ["leg", "slider_leg"]:
        if key in document:
            yield "legs are called the same", {**document, key: [{**leg, "name": "leg"} for leg in document[key]]}


def moves_of_other_blends(document):
    """What no schema can say of moves."""
    *others, last = document["moves"]
    yield "the last move has a blend", {**document, "moves": [*others, {**last, "blend": 1}]}
    yield "blends overlap", {**document, "blend": 1000}


def families_of_other_names(document):
    for other in ["plano-spherical", "translational-helical", "planar-planar", "planar"]:
        if document.get("family") != other:
            yield f"family is {other}", {**document, "family": other}


def damages(kind):
    """Damage of each kind at each place of the documents, once for all places that are alike."""
    done = set()
    for of, text in documents():
        if of != kind:
            continue
        document = with_all_limits(tomllib.loads(text))
        for path in places(document):
            common = alike(document, path)
            if path and common not in done:
                done.add(common)
                # Of its own for each place, so that other keys do not change what is drawn here.
                yield from damaged(document, path, Random(f"1 {path}"))
    if kind == "motion":
        yield from moves_of_other_blends(tomllib.loads(EVERY_MOVE))
    if kind == "mechanism":
        document = tomllib.loads(EVERY_KEY)
        yield from joints_of_other_types(document)
        yield from several_things_together(document)
        for path in MECHANISMS:
            if "family" in (document := tomllib.loads(path.read_text(encoding="utf-8"))):
                yield from families_of_other_names(document)
                yield from legs_of_families_together(document)


def test_the_schema_refuses_what_the_reader_refuses(schema, problems):
    refused, accepted, differ, unsaid = 0, 0, [], set(UNSAYABLE)
    for kind in schema:
        for damage, document in damages(kind):
            text = in_toml(document)
            told = problems(kind, text)
            unsaid -= {pattern for pattern in unsaid if any(re.search(pattern, line) for line in told)}
            structural = [line for line in told if not any(re.search(pattern, line) for pattern in UNSAYABLE)]
            errors = [error.message for error in schema[kind].iter_errors(tomllib.loads(text))]
            refused, accepted = refused + bool(structural), accepted + (not structural)
            if bool(structural) != bool(errors):
                differ.append(f"{document.get('name')}: {damage}: opm says {told}, the schema {errors}")
    assert not differ, f"{len(differ)} of {refused + accepted}:\n" + "\n".join(differ)
    assert refused > 1000 and accepted > 200
    assert not unsaid, "each of these is said of some file"
