"""The frames of links: products of exponentials of the joints' screws, written here, and the solids that stand in them."""

import numpy as np
import opm_kinematics as opm
import pytest
from shipped import LINKAGES

NAMES = [name for name in opm.examples.names() if name not in LINKAGES]


def hat(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def exponential(screw, value):
    """The displacement of a unit screw (omega; v) by a value: Rodrigues' formula, and its integral for the translation."""
    w, v = hat(screw[:3]), screw[3:]
    place = np.eye(4)
    if not w.any():
        place[:3, 3] = v * value
        return place
    place[:3, :3] = np.eye(3) + np.sin(value) * w + (1 - np.cos(value)) * w @ w
    place[:3, 3] = (value * np.eye(3) + (1 - np.cos(value)) * w + (value - np.sin(value)) * w @ w) @ v
    return place


def moved(joint, screws, values):
    """What a joint does: one exponential for each freedom, or one rotation about the centre of a ball."""
    change = np.array(values) - joint.home
    if joint.kind == "spherical":
        angle = np.linalg.norm(change)
        axis = change / angle if angle > 0 else np.array([0.0, 0.0, 1.0])
        return exponential(np.concatenate([axis, np.cross(joint.point, axis)]), angle)
    place = np.eye(4)
    for screw, value in zip(screws, change, strict=True):
        place = place @ exponential(screw, value)
    return place


def poses_of(m, count):
    widths = [0.01 if c.unit == "m" else 0.05 for c in m.task_coordinates]
    return np.array(m.home) + np.random.default_rng(8).uniform(-1, 1, (count, len(widths))) * widths


@pytest.mark.parametrize("name", NAMES)
def test_links_are_where_their_joints_bring_them(name):
    m = opm.examples.load(name)
    poses = poses_of(m, 4)
    home, frames, solved = m.link_frames(), m.link_frames(poses), m.inverse(poses)
    assert solved.reachable.any() and list(frames) == list(home)
    np.testing.assert_array_equal(frames["base"][solved.reachable], np.tile(np.eye(4), (solved.reachable.sum(), 1, 1)))
    np.testing.assert_allclose(frames["platform"], m.transform(poses), atol=1e-12)
    for frame in home.values():
        np.testing.assert_allclose(frame[:3, :3], np.eye(3), atol=1e-12)
    checked = 0
    for row in np.flatnonzero(solved.reachable):
        for leg, joints in m.legs.items():
            place, first = np.eye(4), 0
            for joint in joints:
                screws = m.screws[leg][first : first + len(joint.home)]
                values = [solved[coordinate][row] for coordinate in joint.coordinates]
                place, first = place @ moved(joint, screws, values), first + len(joint.home)
                # The last joint carries the platform.
                of = "platform" if joint is joints[-1] else f"{leg}/{joint.name}"
                if of == "platform" or of in frames:
                    np.testing.assert_allclose(frames[of][row], place @ home[of], atol=1e-9, err_msg=f"{name} {of}")
                    checked += of != "platform"
    assert checked > 0


@pytest.mark.parametrize("name", ["plano-spherical-5dof", "delta", "stewart"])
def test_solids_stand_in_the_frames(name):
    m = opm.examples.load(name)
    pose = poses_of(m, 1)[0]
    home, frames = m.link_frames(), m.link_frames(pose)
    for before, after in zip(m.solids(), m.solids(pose), strict=True):
        change = frames[after.body] @ np.linalg.inv(home[before.body])
        ends = before.ends @ change[:3, :3].T + change[:3, 3]
        np.testing.assert_allclose(ends, after.ends, atol=1e-12)


def test_shapes_gaps_and_wrong_poses():
    m = opm.examples.load("delta")
    poses = poses_of(m, 6).reshape(2, 3, 3)
    poses[1, 2] = 9.0
    frames = m.link_frames(poses)
    assert all(frame.shape == (2, 3, 4, 4) for frame in frames.values())
    assert all(np.isnan(frame[1, 2]).all() and not np.isnan(frame[0]).any() for frame in frames.values())
    for name, frame in m.link_frames(poses[0, 1]).items():
        np.testing.assert_array_equal(frame, frames[name][0, 1])
    with pytest.raises(opm.OpmError, match="^poses has shape"):
        m.link_frames([0.0, 0.0])
    with pytest.raises(opm.OpmError, match="^pose 0: x is inf"):
        m.link_frames([np.inf, 0.0, 0.0])
