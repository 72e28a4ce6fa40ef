"""Mechanisms whose legs tie coordinates of the pose together, by the law of cosines."""

import numpy as np
import opm_kinematics as opm

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
