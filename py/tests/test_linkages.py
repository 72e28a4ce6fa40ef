"""Linkages: loops that close by the product of exponentials, written here, and what the program says."""

import json
import pickle
import subprocess
import sys

import numpy as np
import opm_kinematics as opm
import pytest
from shipped import LINKAGES

NAME = "bennett-double-spherical-6r"
LINKAGE = opm.examples.bennett()


def rotation(axis, angle):
    """Rodrigues' formula."""
    axis = np.asarray(axis) / np.linalg.norm(axis)
    k = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)


def platform(joints, angles):
    """Where a leg of revolute joints takes the platform: products of exponentials, base to platform."""
    pose = np.eye(4)
    for joint, angle in zip(joints, angles, strict=True):
        turn, point = rotation(joint["axis"], angle), np.asarray(joint["point"], dtype=float)
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = turn, point - turn @ point
        pose = pose @ step
    return pose


@pytest.mark.parametrize("shipped", LINKAGES)
def test_every_position_closes_the_loop(shipped):
    tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")
    linkage = opm.examples.linkage(shipped)
    # The file may give numbers by expressions.
    command = [sys.executable, "-m", "opm_kinematics", "convert", shipped, "--joints"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    legs = [leg["joints"] for leg in tomllib.loads(text)["leg"]]
    names = [joint["name"] for leg in legs for joint in leg]
    assert names == linkage.joint_names and len(names) == 6
    for name in names:
        found = linkage.positions(np.linspace(-3, 3, 61), input=name)
        assert found.joints.shape == (61, 4, 6) and found.imaginary.shape == (61, 4, 1)
        assert found.reachable.any() and np.array_equal(found.reachable, ~np.isnan(found.joints).any(axis=2))
        for angles in found.joints[found.reachable] - np.array(linkage.home):
            one, two = (platform(leg, part) for leg, part in zip(legs, np.split(angles, [len(legs[0])]), strict=True))
            assert np.abs(one - two).max() < 1e-9 * max(1, np.abs(one).max())


def test_its_positions_are_those_of_the_program():
    command = [sys.executable, "-m", "opm_kinematics", "linkage", NAME, "--input", "a2=0.1", "--format", "json"]
    told = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    found = LINKAGE.positions([0.1], input="a2")
    branches = [solution["branch"] for solution in told["solutions"]]
    assert branches and branches == [mode for mode, yes in zip(found.modes, found.reachable[0], strict=True) if yes]
    for solution in told["solutions"]:
        branch = found.modes.index(solution["branch"])
        assert {name: found[name][0, branch] for name in LINKAGE.joint_names} == solution["joints"]
        assert found[LINKAGE.imaginary_name][0, branch] == solution["imaginary"][LINKAGE.imaginary_name]
        assert found.within_limits[0, branch] == solution["within_limits"]
    assert LINKAGE.range("a2").tolist() == told["range"]
    assert LINKAGE.home_branch("a2") == told["home_branch"]


def test_the_loop_closes_in_the_range_and_nowhere_else():
    for name in LINKAGE.joint_names:
        values = np.linspace(-np.pi, np.pi, 1001)
        parts = LINKAGE.range(name)
        turned = values + 2 * np.pi * np.array([-1, 0, 1])[:, None, None]
        inside = ((turned >= parts[:, :1]) & (turned <= parts[:, 1:])).any(axis=(0, 1))
        sure = np.abs(turned - parts.reshape(-1, 1)).min(axis=(0, 1)) > 1e-6 if parts.size else np.ones(1001, dtype=bool)
        assert np.count_nonzero(sure) > 990
        reachable = LINKAGE.positions(values, input=name, threads=1).reachable.any(axis=1)
        assert np.array_equal(reachable[sure], inside[sure])


def test_sarrus_platform_is_lifted():
    """The height of a slider-crank: plates of 100 mm whose hinges are 60 and 40 mm from the vertical."""
    sarrus = opm.examples.linkage("sarrus")
    angle = np.linspace(0.7, 5.5, 101)
    heights = sarrus.positions(angle).imaginary[..., 0] + 0.158016824663872
    up, out = 0.1 * np.sin(angle), 0.02 + 0.1 * np.cos(angle)
    for branch, sign in zip(range(4), np.sign(heights[50] - up[50]), strict=True):
        assert np.allclose(heights[:, branch], up + sign * np.sqrt(0.1**2 - out**2), atol=1e-12)
    assert sarrus.range()[0] == pytest.approx([np.arccos(0.8), 2 * np.pi - np.arccos(0.8)], abs=1e-9)


def test_home_is_a_position():
    found = LINKAGE.positions([LINKAGE.home[LINKAGE.joint_names.index("a1")]])
    branch = found.modes.index(LINKAGE.home_branch())
    assert found.joints[0, branch] == pytest.approx(LINKAGE.home, abs=1e-12)


def test_it_pickles():
    again = pickle.loads(pickle.dumps(LINKAGE))
    values = np.linspace(-3, 3, 1001)
    assert again.text == LINKAGE.text and again.name == NAME
    one, other = LINKAGE.positions(values), again.positions(values, threads=2)
    assert np.array_equal(one.joints, other.joints, equal_nan=True)


def test_what_is_wrong_is_told():
    with pytest.raises(opm.OpmError, match='input is "q", expected one of a1'):
        LINKAGE.positions([0], input="q")
    with pytest.raises(opm.OpmError, match="value 1 is inf, expected a finite number"):
        LINKAGE.positions([0, np.inf])
    with pytest.raises(opm.OpmError, match=r"values is 'far', expected a number or an array of numbers"):
        LINKAGE.positions("far")
    with pytest.raises(opm.OpmError, match="expected two, which form one loop"):
        opm.Linkage.parse(opm.examples.text("plano-spherical-5dof"))
    with pytest.raises(FileNotFoundError, match="opm.examples.text"):
        opm.Linkage.load(NAME)


FOUR_BAR = """
format = 1
name = "four-bar"
units = { length = "mm", angle = "deg" }
[platform]
point = [50, 80, 0]
[[leg]]
name = "crank"
joints = [
  { name = "a", type = "revolute", axis = [0, 0, 1], point = [0, 0, 0], actuated = true },
  { name = "b", type = "revolute", axis = [0, 0, 1], point = [0, 40, 0] },
]
[[leg]]
name = "rocker"
joints = [
  { name = "d", type = "revolute", axis = [0, 0, 1], point = [100, 0, 0] },
  { name = "c", type = "revolute", axis = [0, 0, 1], point = [100, 80, 0] },
]
"""


def test_a_four_bar_is_traced():
    linkage = opm.Linkage.parse(FOUR_BAR)
    assert linkage.imaginary_name is None and linkage.home_branch() == "1"
    turns = np.linspace(0, 2 * np.pi, 60)
    found = linkage.positions(turns)
    assert found.modes == ["1", "2"] and found.imaginary.shape == (60, 2, 0)
    assert linkage.range() == pytest.approx(np.array([[-np.pi, np.pi]]))
    rod = np.hypot(0.1, 0.04)
    for turn, branches, rocker in zip(turns, found.joints, found["d"], strict=True):
        pin = 0.04 * np.array([-np.sin(turn), np.cos(turn)])
        for joints, angle in zip(branches, rocker, strict=True):
            other = np.array([0.1, 0]) + 0.08 * np.array([-np.sin(angle), np.cos(angle)])
            assert np.linalg.norm(other - pin) == pytest.approx(rod, abs=1e-12)
            assert joints[0] == turn
        assert abs(np.sin((rocker[0] - rocker[1]) / 2)) > 0.1
