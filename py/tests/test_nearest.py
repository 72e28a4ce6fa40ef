"""The nearest poses in reach, and warnings about files."""

import pickle
import warnings

import numpy as np
import pytest

import opm_kinematics as opm


def test_the_nearest_place_is_on_the_circle():
    """The right arm of the five-bar is 445 mm long, its shoulder at (160 mm, 0)."""
    m = opm.examples.load("five-bar")
    poses = np.array([[-1.0, 1.0], [0.0, 0.3], [np.nan, 0.0]])
    found = m.nearest_reachable(poses, mode="any")
    away = np.hypot(1.16, 1.0)
    assert found.distance[0] == pytest.approx(away - 0.445, abs=1e-9)
    assert found.distance[1] == 0 and np.array_equal(found.poses[1], poses[1])
    assert np.isnan(found.distance[2]) and np.isnan(found.poses[2]).all()
    assert repr(found) == "<NearestReachable of 3 poses: 1 moved, 1 without a pose in reach>"
    assert pickle.loads(pickle.dumps(found)) == found
    one = m.nearest_reachable(poses[0], mode="any", threads=1)
    assert one.distance.shape == () and np.array_equal(one.poses, found.poses[0])


@pytest.mark.parametrize("name", ["delta", "plano-spherical-5dof", "stewart"])
def test_what_is_found_is_in_reach(name):
    m = opm.examples.load(name)
    rng = np.random.default_rng(3)
    length = 0.2
    weights = np.array([1.0 if c.unit == "m" else length for c in m.task_coordinates])
    poses = m.home + rng.normal(size=(5, len(weights))) / weights
    found = m.nearest_reachable(poses, length=length)
    solved = m.inverse(found.poses)
    assert solved.reachable.all() and solved.within_limits.all()
    distance = np.linalg.norm((found.poses - poses) * weights, axis=1)
    np.testing.assert_allclose(found.distance, distance, rtol=1e-9)
    assert found.length == length


def test_wrong_arguments():
    m = opm.examples.load("five-bar")
    with pytest.raises(opm.OpmError, match="length is 0.0, expected a positive"):
        m.nearest_reachable([0, 0], length=0.0)
    with pytest.raises(opm.OpmError, match="pose 0"):
        m.nearest_reachable([np.inf, 0])


def test_doubts_are_warnings():
    text = opm.examples.text("planar-3rrr")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        opm.Manipulator.parse(text)
    limited = text.replace('name = "C{i}", ', 'name = "C{i}", limits = [-1.5, 1.5], ')
    with pytest.warns(UserWarning, match="limits of C1, C2, C3 are at most 1.5 deg"):
        opm.Manipulator.parse(limited)


def test_a_model_in_urdf_is_told_to_be_one(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text('<?xml version="1.0"?>\n<robot name="a"/>\n')
    with pytest.raises(opm.OpmError, match="this is a URDF model .*opm help format"):
        opm.Manipulator.load(path)
