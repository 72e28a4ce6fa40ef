"""Distances of bodies at many poses."""

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
