"""One pose alone takes a way of its own: the same results, to the bit, and nothing that is shared can be spoilt."""

import copy
import pickle
import re
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import opm_kinematics as opm
import pytest
from shipped import LINKAGES

NAMES = [name for name in opm.examples.names() if name not in LINKAGES]


def poses_of(m, count):
    """Poses near home and far from it, some out of reach."""
    widths = [0.05 if c.unit == "m" else 0.3 for c in m.task_coordinates]
    scales = np.geomspace(0.1, 30, count)[:, None]
    return np.array(m.home) + np.random.default_rng(3).uniform(-1, 1, (count, len(widths))) * widths * scales


@pytest.mark.parametrize("name", NAMES)
def test_one_pose_is_that_of_many(name):
    m = opm.examples.load(name)
    poses = poses_of(m, 30)
    for mode in {"home", m.modes[0], m.modes[-1]}:
        for joints in ("all", "actuated"):
            many, jacobians = m.inverse(poses, mode=mode, joints=joints), m.jacobian(poses, mode=mode, joints=joints)
            out = np.empty(jacobians.shape[1:])
            for row, pose in enumerate(poses):
                for given in (pose, pose.tolist(), pose[None]):
                    one = m.inverse(given, mode=mode, joints=joints)
                    for part in ("joints", "imaginary", "reachable", "within_limits"):
                        np.testing.assert_array_equal(np.squeeze(getattr(one, part)), np.squeeze(getattr(many, part)[row]))
                    assert (one.joint_names, one.mode, one.units) == (many.joint_names, many.mode, many.units)
                assert m.jacobian(pose, mode=mode, joints=joints, out=out) is out
                np.testing.assert_array_equal(out, jacobians[row])
                np.testing.assert_array_equal(m.jacobian(pose, mode=mode, joints=joints), jacobians[row])


@pytest.mark.parametrize("name", ["delta", "five-bar", "plano-spherical-5dof"])
def test_one_pose_out_of_reach(name):
    m = opm.examples.load(name)
    far = np.array(m.home) + 9.0
    one, many = m.inverse(far), m.inverse([far])
    assert not one.reachable and not one.within_limits and one.joints.shape == many.joints.shape[1:]
    assert np.isnan(one.joints).all() and np.isnan(one.imaginary).all() and np.isnan(m.jacobian(far)).all()


def test_what_is_shared_cannot_be_written_to():
    m = opm.examples.load("delta")
    one, other = m.inverse(m.home), m.inverse(m.home)
    for array in (one.joints, one.reachable, one.within_limits):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    for answer in (one.reachable, one.within_limits):
        with pytest.raises(ValueError, match="cannot set WRITEABLE"):
            answer.setflags(write=True)
    one.joint_names.clear()
    one.units.clear()
    assert one.joint_names == other.joint_names == m.joint_names and one.units == other.units != {}
    assert one == other and pickle.loads(pickle.dumps(one)) == one


def test_out_is_what_it_has_to_be():
    m = opm.examples.load("delta")
    home, rows = np.array(m.home), np.tile(m.home, (4, 1))
    several = np.empty((4, 3, 3))
    assert m.jacobian(rows, out=several) is several
    np.testing.assert_array_equal(several, m.jacobian(rows))
    frozen = np.empty((3, 3))
    frozen.setflags(write=False)
    for poses, out, told in [
        (home, np.empty((3, 4)), "out has shape (3, 4), expected a float64 array of the shape (3, 3) in C order"),
        (home, np.empty((3, 3)).T[::-1], "out has shape (3, 3), expected"),
        (home, np.empty((3, 3), dtype=np.float32), "out is an object of ndarray of float32, expected"),
        (home, [[0.0] * 3] * 3, "out is an object of list, expected"),
        (home, frozen, "out is read-only, or shares memory with poses; expected"),
        (rows, np.empty((3, 3)), "out has shape (3, 3), expected a float64 array of the shape (4, 3, 3)"),
    ]:
        with pytest.raises(opm.OpmError, match=f"^{re.escape(told)}"):
            m.jacobian(poses, out=out)


def test_wrong_poses_are_told_as_ever():
    m = opm.examples.load("delta")
    for call in (m.inverse, m.jacobian):
        with pytest.raises(opm.OpmError, match="^pose 0: x is inf"):
            call([np.inf, 0.0, m.home[2]])
        with pytest.raises(opm.OpmError, match=r"^poses has shape \(2,\), expected \(..., 3\)"):
            call([0.0, 0.0])
        with pytest.raises(opm.OpmError, match="^poses has entries of <U"):
            call(["a", "b", "c"])
    assert not m.inverse([np.nan, 0.0, 0.0]).reachable and np.isnan(m.jacobian([np.nan, 0.0, 0.0])).all()


def test_threads_have_memory_of_their_own():
    m = opm.examples.load("stewart")
    poses = poses_of(m, 200)
    expected = m.inverse(poses).joints
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda pose: m.inverse(pose).joints, poses))
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("name", NAMES)
def test_a_copy_is_the_object_itself(name):
    m = opm.examples.load(name)
    assert copy.copy(m) is m and copy.deepcopy(m) is m and copy.deepcopy({"a": [m]})["a"][0] is m


@pytest.mark.parametrize("name", ["delta", "stewart", "plano-spherical-5dof"])
def test_pickles_of_one_file_are_decomposed_once(name):
    m = opm.examples.load(name)
    # A mechanism that no pickle held before.
    moved = opm.Manipulator.parse(m.text + f"\n# {time.monotonic_ns()}\n", "moved.toml")
    packed = pickle.dumps(moved)
    first = time.perf_counter()
    again = pickle.loads(packed)
    first = time.perf_counter() - first
    many = time.perf_counter()
    copies = [pickle.loads(packed) for _ in range(100)]
    many = (time.perf_counter() - many) / 100
    assert many < first / 3
    poses = poses_of(m, 20)
    for copied in (again, copies[-1]):
        assert copied == moved and copied.text == moved.text and hash(copied) == hash(moved)
        np.testing.assert_array_equal(copied.inverse(poses).joints, moved.inverse(poses).joints)
        assert copied.parameters == moved.parameters and copied.to_joints() == moved.to_joints()
    # Its name in messages is its own.
    other = pickle.loads(pickle.dumps(opm.Manipulator.parse(moved.text, "other.toml")))
    assert pickle.dumps(other) != packed and b"other.toml" in pickle.dumps(other)
