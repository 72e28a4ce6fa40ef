"""Aspects of a planar 3-RPR, by the signs of a determinant that is written here."""

import numpy as np
import opm_kinematics as opm
import pytest

BASES = np.array([[0.0, 0.0], [0.01591, 0.0], [0.0, 0.01]])
GRID = {"x": (-0.036, 0.036, 19), "y": (-0.036, 0.036, 19), "theta": (-np.pi, np.pi, 19)}


def determinant(poses):
    """The determinant of the lines of the telescopes, and their lengths."""
    home = np.array([[14.9201332471544, -1.33791774304624], [24.0976354874709, 13.0194863617697], [8.48644174731943, 18.4841208424512]])
    corners = 1e-3 * (home - home[0])
    poses = np.asarray(poses)
    turn = poses[..., 2, None]
    arms = np.stack(
        [np.cos(turn) * corners[:, 0] - np.sin(turn) * corners[:, 1], np.sin(turn) * corners[:, 0] + np.cos(turn) * corners[:, 1]], axis=-1
    )
    along = poses[..., None, :2] + arms - BASES
    lengths = np.linalg.norm(along, axis=-1)
    # A telescope without length has no direction; it is beyond its limits.
    unit = along / np.where(lengths > 0, lengths, 1)[..., None]
    moment = arms[..., 0] * unit[..., 1] - arms[..., 1] * unit[..., 0]
    lines = np.concatenate([unit, moment[..., None] / 0.017], axis=-1)
    return np.linalg.det(lines), lengths


@pytest.fixture(scope="module")
def sweep():
    return opm.sweep(opm.examples.load("planar-3rpr"), kind="aspects", **GRID)


def test_labels_are_those_of_the_aspects(sweep):
    aspects, labels = sweep.aspects(), sweep.labels()
    assert labels.shape == (19, 19, 19) and ((labels > 0) <= sweep.mask()).all()
    assert [aspect.count for aspect in aspects] == list(sweep.components()) == list(np.bincount(labels[labels > 0])[1:])
    assert aspects[0].sign == -aspects[1].sign
    axes = sweep.axes
    poses = np.stack(np.meshgrid(*axes.values(), indexing="ij"), axis=-1)
    found, _ = determinant(poses)
    for aspect in aspects:
        own = labels == aspect.number
        signs = np.sign(found[own])
        assert (signs == signs[0]).all()
        for name, values in zip(axes, np.moveaxis(poses[own], -1, 0)):
            assert aspect.extent[name] == (values.min(), values.max())
    rings = sum(len(outline.rings) for outline in sweep.boundary())
    plain = sum(len(outline.rings) for outline in opm.sweep(opm.examples.load("planar-3rpr"), **GRID).boundary())
    assert rings > plain


def test_a_path_keeps_the_sign_and_the_limits(sweep):
    m = opm.examples.load("planar-3rpr")
    assemblies = [one.pose for one in m.forward([[0.01498, 0.01538, 0.012]])[0]]
    assert len(assemblies) == 6
    signs = [np.sign(determinant(pose)[0]) for pose in assemblies]
    start = assemblies[0]
    for goal, sign in zip(assemblies[1:], signs[1:]):
        if sign != signs[0]:
            with pytest.raises(opm.OpmError, match="different aspects"):
                sweep.path(start, goal)
            continue
        path = sweep.path(start, goal, duration=3)
        assert path[0, 0] == 0 and path[-1, 0] == 3
        assert np.allclose(path[-1, 1:3], goal[:2])
        found, lengths = determinant(path[:, 1:])
        assert (np.sign(found) == signs[0]).all()
        assert (lengths >= 0.005).all() and (lengths <= 0.035).all()
        followed = opm.trajectory(m, path[:, 1:], times=path[:, 0], rate=200)
        assert not followed.violations


def test_what_has_no_aspects_is_refused(sweep):
    m = opm.examples.load("planar-3rpr")
    plain = opm.sweep(m, x=(-0.01, 0.01, 3))
    for call in (plain.aspects, lambda: plain.path([0, 0, 0], [0, 0, 0])):
        with pytest.raises(opm.OpmError, match='kind="aspects"'):
            call()
    with pytest.raises(opm.OpmError, match="other aspects"):
        opm.sweep(m, kind="aspects", mode="any", **GRID)
    with pytest.raises(opm.OpmError, match="the start is beyond the limits"):
        sweep.path([1, 0, 0], m.home)
    with pytest.raises(opm.OpmError, match="duration"):
        sweep.path(m.home, m.home, duration=0)
