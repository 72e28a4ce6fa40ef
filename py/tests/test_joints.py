"""Joints as data: everything that a file says of a joint comes back."""

import pickle
import re
from pathlib import Path

import numpy as np
import opm_kinematics as opm
import pytest
from shipped import LINKAGES

tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")

NAMES = [name for name in opm.examples.names() if name not in LINKAGES]

#: A joint of every type with every key that it may have, in other units than those of Python.
EVERYTHING = """
format = 1
name = "everything"
units = { length = "mm", angle = "deg" }
[platform]
point = [0, 0, 200]
"""
DRIVEN = "max_rate = {n}, max_acceleration = {n}, max_effort = {n}, rotor_inertia = {i}, gear = {n}, viscous_friction = {n}, coulomb_friction = {n}"


def everything():
    """Three legs S-P-U of a platform, their sliders driven, with every key somewhere."""
    text = EVERYTHING
    one = DRIVEN.format(n="1.5", i="2e-5")
    two, three = (f"viscous_friction = [{', '.join(['0.1', '0.2', '0.3'][:n])}], coulomb_friction = [{', '.join(['0.4', '0', '0.6'][:n])}]" for n in (2, 3))
    for i in range(6):
        a, b = 2 * np.pi * (i // 2) / 3 + 0.3 * (-1) ** i, 2 * np.pi * (i // 2) / 3 + 0.8 * (-1) ** i
        base, top = np.array([200 * np.cos(a), 200 * np.sin(a), 0]), np.array([100 * np.cos(b), 100 * np.sin(b), 200])
        rod = (top - base) / np.linalg.norm(top - base)
        first = np.cross(rod, [0, 0, 1])
        text += f"""
[[leg]]
joints = [
  {{ name = "U{i}", type = "universal", axis = {list(map(float, first))}, axis2 = {list(map(float, np.cross(rod, first)))}, point = {list(map(float, base))}, cone = {{ angle = 70, axis = {list(map(float, rod))} }}, limits = [[-80, 80], [-70, 70]], {two} }},
  {{ name = "P{i}", type = "prismatic", axis = {list(map(float, rod))}, point = {list(map(float, base))}, home = 5, limits = [-90, 90], actuated = true, {one} }},
  {{ name = "S{i}", type = "spherical", point = {list(map(float, top))}, {three} }},
]
"""
    return text


def with_drives(m):
    """The mechanism's joints, each with numbers of its own for what only efforts depend on."""
    changes = {}
    for number, joint in enumerate(j for leg in m.legs.values() for j in leg):
        count = len(joint.home)
        changes[joint.name] = {"viscous_friction": [0.1 + number] * count, "coulomb_friction": [0.2 + number] * count}
        if joint.actuated:
            changes[joint.name] |= {"rotor_inertia": 1e-5 * (1 + number) if count == 1 else [1e-5] * count, "gear": [50.0 + number] * count}
    return m.with_joints(changes)


def keys_of(text):
    """What a file of joints says, joint by joint."""
    return [joint for leg in tomllib.loads(text)["leg"] for joint in leg["joints"]]


def flat(thing):
    """Every number and word of it, with its place. Directions are made unit vectors again, and change in the last digit."""
    if isinstance(thing, opm.Joint):
        return flat({name: getattr(thing, name) for name in vars_of_a_joint()})
    if isinstance(thing, (dict, list, tuple)):
        items = thing.items() if isinstance(thing, dict) else enumerate(thing)
        return {f"{key}.{inner}": value for key, one in items for inner, value in flat(one).items()}
    return {"": pytest.approx(thing, rel=1e-14, abs=1e-15) if isinstance(thing, float) else thing}


@pytest.mark.parametrize("name", NAMES)
def test_joints_come_back(name):
    m = opm.examples.load(name)
    m = with_drives(opm.Manipulator.parse(m.to_joints()))
    again = opm.Manipulator.from_joints(m.legs, platform=m.reference_point, name=m.name)
    assert flat(again.legs) == flat(m.legs)
    assert flat(keys_of(again.to_joints())) == flat(keys_of(m.to_joints()))
    assert all("coulomb_friction" in joint for joint in keys_of(again.to_joints()))
    driven = [joint for joint in keys_of(again.to_joints()) if joint.get("actuated")]
    assert driven and all({"rotor_inertia", "gear"} <= set(joint) for joint in driven)


def test_every_key_of_a_joint_comes_back():
    m = opm.Manipulator.parse(everything())
    rod = m.legs["leg1"][1]
    # A slider's gear is per metre: 1.5 for each millimetre are 1500 for each metre.
    assert (rod.gear, rod.rotor_inertia, rod.max_rate, rod.max_effort) == ([1500.0], [2e-5], [0.0015], [1.5])
    assert rod.coulomb_friction == [1.5] and m.legs["leg1"][2].coulomb_friction == [0.4, 0.0, 0.6]
    again = opm.Manipulator.from_joints(m.legs, platform=m.reference_point, name="everything")
    assert flat(again.legs) == flat(m.legs) and flat(keys_of(again.to_joints())) == flat(keys_of(m.to_joints()))
    known = set().union(*keys_of(m.to_joints()))
    assert known == set(vars_of_a_joint()) - {"kind", "coordinates", "units", "pitch", "turns_back"} | {"type"}
    for joint in (j for leg in m.legs.values() for j in leg):
        given = {name: getattr(joint, name) for name in vars_of_a_joint() if name not in ("coordinates", "units")}
        assert flat(opm.Joint(given.pop("name"), given.pop("kind"), **given)) == flat(joint)
        assert pickle.loads(pickle.dumps(joint)) == joint


def vars_of_a_joint():
    return [name for name in vars(opm.Joint) if not name.startswith("_")]


def test_vectors_are_tuples_lists_or_arrays():
    expected = opm.Joint("a", "universal", axis=(0, 0, 1), axis2=(1, 0, 0), point=(1, 2, 3), limits=((-1, 1), None), cone=(0.4, (0, 0, 1)), home=(0, 0.5))
    for of in (list, np.array):
        found = opm.Joint("a", "universal", axis=of([0, 0, 1]), axis2=of([1, 0, 0]), point=of([1, 2, 3]), limits=[of([-1, 1]), None], cone=(0.4, of([0, 0, 1])), home=of([0, 0.5]))
        assert found == expected


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"axis": "z"}, "joint a: axis is 'z', expected three numbers"),
        ({"point": (1, 2)}, "joint a: point is (1, 2), expected three numbers"),
        ({"home": "far"}, "joint a: home is 'far', expected a number, or None"),
        ({"limits": 3}, "joint a: limits is 3, expected (lowest, highest), or None"),
        ({"gear": [1, 2]}, "joint a: gear is [1, 2], expected a number, or None"),
        ({"pitch": "steep"}, "joint a: pitch is 'steep', expected a number, or None"),
        ({"cone": "wide"}, "joint a: cone is 'wide', expected half an angle, or that and an axis, or None"),
    ],
)
def test_what_an_attribute_may_be_is_told(given, told):
    with pytest.raises(opm.OpmError, match=f"^{re.escape(told)}$"):
        opm.Joint("a", "revolute", **({"axis": (0, 0, 1)} | given))
    with pytest.raises(opm.OpmError, match=re.escape(told.replace("joint a", "joint B1"))):
        opm.examples.load("planar-3rpr").with_joints({"B1": given})


def test_drives_are_checked_as_in_files():
    m = opm.examples.load("delta")
    joint = next(j.name for leg in m.legs.values() for j in leg if j.actuated)
    for key in ("rotor_inertia", "gear", "viscous_friction", "coulomb_friction"):
        with pytest.raises(opm.OpmError, match=key):
            m.with_joints({joint: {key: -1.0}})
        with pytest.raises(opm.OpmError, match="nan|NaN"):
            m.with_joints({joint: {key: float("nan")}})


def test_a_parallelogram_is_two_hinges():
    text = (Path(__file__).parents[2] / "tests/tests/parallelograms/rail.toml").read_text(encoding="utf-8")
    rail = opm.Manipulator.parse(text)
    first, back = rail.legs["leg1"][1:]
    assert (first.name, first.turns_back, back.name, back.turns_back) == ("p1", False, "p1.end", True)
    values = dict(zip(rail.joint_names, rail.inverse([0.05, -0.32]).joints))
    assert values["p1"] == pytest.approx(-values["p1.end"])
    # The end of the bar is 20 mm lower and 50 mm to the right: the slider follows with the bar's length of 360.6 mm.
    out = np.sqrt(0.2**2 + 0.3**2 - 0.32**2)
    assert values["s1"] == pytest.approx(0.05 + 0.2 - out, abs=1e-12)
    again = opm.Manipulator.from_joints(rail.legs, platform=rail.reference_point)
    assert again.decomposition.mobility == rail.decomposition.mobility == 2
    # Without what holds them, the hinges let the platform turn.
    with pytest.raises(opm.OpmError, match="rotation about"):
        rail.with_joints({"p1.end": {"turns_back": False}, "p2.end": {"turns_back": False}})
    moved = rail.with_joints({"p1.end": {"point": (-0.05, 0, -0.31)}})
    assert moved.legs["leg1"][2].point == (-0.05, 0.0, -0.31) and moved.legs["leg1"][2].turns_back


def test_differences_of_joints_are_limited():
    """Two cranks that may be at most so far apart."""
    legs = opm.examples.load("five-bar").legs
    five_bar = opm.Manipulator.from_joints(legs)
    one, other = (five_bar.joint_names[number] for number in five_bar.actuated)
    joints = five_bar.inverse(five_bar.home)
    apart = float(np.ravel(joints[one] - joints[other])[0])
    difference = (one, other, apart - 0.1, apart + 0.1)
    limited = opm.Manipulator.from_joints(legs, differences=[difference])
    assert limited.differences == [difference]
    # All along a line, the solutions that were within limits and have the difference still are.
    poses = five_bar.home + np.linspace(-0.05, 0.05, 41)[:, None] * np.ones(len(five_bar.home))
    free, held = five_bar.inverse(poses), limited.inverse(poses)
    kept = np.abs(free[one] - free[other] - apart) <= 0.1
    np.testing.assert_array_equal(held.within_limits, free.within_limits & kept)
    assert 5 < held.within_limits.sum() < free.within_limits.sum()
    with pytest.raises(opm.OpmError, match=f"{one} - {other} is"):
        opm.Manipulator.from_joints(legs, differences=[(one, other, apart + 0.2, apart + 0.4)])
