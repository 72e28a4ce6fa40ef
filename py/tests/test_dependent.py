"""Mechanisms whose legs tie coordinates of the pose together, by the law of cosines."""

import pickle

import numpy as np
import opm_kinematics as opm
import pytest

UPPER, FORE, HALF = 0.138, 0.307, 0.160


def forearm(x, y, side):
    """Direction of the right forearm."""
    way = x - HALF + 1j * y
    cosine = (UPPER**2 + abs(way) ** 2 - FORE**2) / (2 * UPPER * abs(way))
    elbow = HALF + UPPER * np.exp(1j * (np.angle(way) + side * np.arccos(cosine)))
    return np.angle(x + 1j * y - elbow)


def test_the_forearm_follows_the_hand():
    m = opm.examples.load("five-bar")
    assert [c.name for c in m.task_coordinates] == ["x", "y"]
    assert [(c.name, c.home, c.unit) for c in m.dependent_coordinates] == [("theta", 0, "rad")]
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-0.1, 0.1, 9), np.linspace(0.2, 0.34, 9)))
    poses = np.column_stack([x, y])
    home = forearm(*m.home, -1)
    for mode, side in (("-+", -1), ("--", 1)):
        theta = m.dependent(poses, mode=mode)[:, 0]
        off = forearm(x, y, side) - home - theta
        assert np.abs(np.angle(np.exp(1j * off))).max() < 1e-9
        # The platform is the forearm.
        places = m.transform(poses, mode=mode)
        assert np.abs(places[:, :2, 3] - poses).max() < 1e-12
        assert np.abs(np.arctan2(places[:, 1, 0], places[:, 0, 0]) - theta).max() < 1e-12
    solutions = m.inverse(poses)
    assert solutions.reachable.all() and np.isfinite(solutions.joints).all()
    assert np.isnan(m.dependent([[0, 0.5]])).all() and np.isnan(m.transform([[0, 0.5]])).all()
    assert np.allclose(m.locate(m.transform(poses)), poses)
    assert m.dependent(poses[:0]).shape == (0, 1)


def test_most_mechanisms_have_none():
    m = opm.examples.load("plano-spherical-5dof")
    assert m.dependent_coordinates == [] and m.dependent([m.home]).shape == (1, 0)


def test_they_are_no_axes():
    m = opm.examples.load("five-bar")
    follows = "theta follows from x, y; give these instead"
    with pytest.raises(opm.OpmError, match=follows):
        opm.sweep(m, theta=(-0.1, 0.1, 5))
    with pytest.raises(opm.OpmError, match=follows):
        opm.sweep(m, x=0.1).write("never.mcap", color="theta")


def test_the_area_of_the_hand_is_bounded():
    m = opm.examples.load("five-bar")
    found = opm.measure(m, over={"x": (-0.1, 0.1), "y": (0.0, 0.3)})
    # The arms reach rings about the shoulders, at x = -160 mm and 160 mm.
    x, y = np.meshgrid((np.arange(1000) + 0.5) * 2e-4 - 0.1, (np.arange(1000) + 0.5) * 3e-4)
    far = [np.hypot(x - side * HALF, y) for side in (-1, 1)]
    inside = np.all([(FORE - UPPER < d) & (d < FORE + UPPER) for d in far], axis=0)
    assert found.lower < 0.06 * inside.mean() < found.upper < 1.02 * found.lower


def test_a_motion_has_them_with_their_rates():
    m = opm.examples.load("five-bar")
    times = np.linspace(0, 2, 9)
    places = np.column_stack([0.1 * np.sin(3 * times), 0.3 + 0.03 * np.cos(2 * times)])
    followed = opm.trajectory(m, places, times=times, rate=500, ends="natural")
    assert followed.reachable.all() and followed.dependent.shape == (1001, 1)
    np.testing.assert_allclose(followed.dependent, m.dependent(followed.poses), atol=1e-12)
    for value, rate in (("dependent", "dependent_rates"), ("dependent_rates", "dependent_accelerations")):
        found = np.gradient(getattr(followed, value), followed.times, axis=0)
        # The step, 2 ms, times jumps of the third derivative of a spline.
        np.testing.assert_allclose(found[1:-1], getattr(followed, rate)[1:-1], atol=1e-2)
    whole = pickle.loads(pickle.dumps(followed))
    assert whole == followed and (whole.dependent == followed.dependent).all()
    most = opm.trajectory(opm.examples.load("plano-spherical-5dof"), "plano-spherical-sinusoids")
    assert most.dependent.shape == (1001, 0)
