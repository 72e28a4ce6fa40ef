"""Distances of bodies at many poses."""

import pickle

import numpy as np
import opm_kinematics as opm
import pytest

BALL = """
[bodies]
radius = 2

[[obstacle]]
name = "ball"
type = "capsule"
from = [0, 0, 30]
to = [0, 0, 30]
radius = 5
"""


@pytest.fixture(scope="module")
def manipulator():
    # All links move in the plane z = 0, and the ball is above the platform's reference point.
    return opm.Manipulator.parse(opm.examples.text("planar-3rrr") + BALL)


def test_the_nearest_pair_is_that_of_geometry(manipulator):
    clearance = manipulator.clearance([manipulator.home, [9, 9, 0]])
    assert len(clearance) == 2
    assert clearance.distance[0] == pytest.approx(0.030 - 0.002 - 0.005, abs=1e-9)
    assert clearance.pairs[clearance.pair[0]] == ("platform", "ball")
    assert np.isnan(clearance.distance[1])
    assert clearance.pair[1] == -1
    assert clearance.set_aside == []


def test_threads_and_order_do_not_matter(manipulator):
    rng = np.random.default_rng(3)
    poses = manipulator.home + rng.uniform(-0.05, 0.05, (3000, 3))
    one, two = (manipulator.clearance(poses, threads=threads) for threads in (1, 2))
    assert one == two
    back = manipulator.clearance(poses[::-1])
    np.testing.assert_array_equal(back.distance[::-1], one.distance)


def test_what_is_wrong_is_named(manipulator):
    with pytest.raises(opm.OpmError):
        manipulator.clearance([manipulator.home], mode="+")


def test_contacts_of_a_motion_are_found_between_samples(tmp_path):
    m = opm.examples.load("plano-spherical-5dof")
    motion = "plano-spherical-sinusoids"
    assert opm.trajectory(m, motion, clearance=0.004).contacts == []
    found = opm.trajectory(m, motion, clearance=0.01)
    assert found.contacts
    assert opm.trajectory(m, motion).contacts is None and opm.trajectory(m, motion).nearest is None
    apart = m.clearance(found.poses)
    one, other, distance, time = found.nearest
    assert distance <= apart.distance.min() + 1e-12 and found.times[0] <= time <= found.times[-1]
    assert (one, other) in apart.pairs
    # Some pair is in contact at just those samples at which the nearest two are too near.
    near = np.any([(c.start <= found.times) & (found.times <= c.end) for c in found.contacts], axis=0)
    np.testing.assert_array_equal(near, apart.distance < 0.01)
    for contact in found.contacts:
        assert contact.start <= contact.worst <= contact.end and contact.distance < 0.01
    assert pickle.loads(pickle.dumps(found)) == found
    found.write_mcap(tmp_path / "motion.mcap", indices=True)
    with pytest.raises(opm.OpmError, match="clearance is -1.0 m"):
        opm.trajectory(m, motion, clearance=-1.0)
