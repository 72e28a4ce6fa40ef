"""Arrays of any shape: the axes before the last one come back in front of every result."""

import re

import numpy as np
import opm_kinematics as opm
import pandas as pd
import pytest
from shipped import LINKAGES

NAMES = ["plano-spherical-5dof", "delta", "five-bar", "stewart", "planar-3rpr"]


def poses_of(m, shape):
    widths = [0.02 if c.unit == "m" else 0.1 for c in m.task_coordinates]
    return np.array(m.home) + np.random.default_rng(11).uniform(-1, 1, (*shape, len(widths))) * widths


def arrays(thing):
    """Every array of a result, those of its parts too."""
    if isinstance(thing, np.ndarray):
        return {"": thing}
    found = {}
    for name in (n for n in dir(thing) if not n.startswith("_")):
        value = getattr(thing, name)
        if isinstance(value, np.ndarray):
            found[name] = value
        elif isinstance(value, opm.AccuracySamples):
            found |= {f"{name}.{inner}": array for inner, array in arrays(value).items()}
    return found


#: Arrays that are not of the poses.
OWN = {"sizes"}

CALLS = {
    "inverse": lambda m, p: m.inverse(p),
    "every mode": lambda m, p: m.inverse(p, mode="all"),
    "transform": lambda m, p: m.transform(p),
    "dependent": lambda m, p: m.dependent(p),
    "jacobian": lambda m, p: m.jacobian(p),
    "twist_jacobian": lambda m, p: m.twist_jacobian(p),
    "parameter_jacobian": lambda m, p: m.parameter_jacobian(p),
    "velocity": lambda m, p: m.velocity(p, p, p),
    "singularity": lambda m, p: m.singularity(p),
    "accuracy": lambda m, p: m.accuracy(p, actuators=(2e-5, 2e-5), clearance=(2e-5, None)),
    "analyze": lambda m, p: m.analyze(p, wrench=[1, 2, 3, 0.1, 0.2, 0.3], link_stiffness=(1e7, 1e3)),
    "clearance": lambda m, p: m.clearance(p),
    "locate": lambda m, p: m.locate(m.transform(p)),
    "nearest": lambda m, p: m.nearest(m.transform(p)),
    "matrices": lambda m, p: m.inverse(transforms=m.transform(p)),
}


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("name", NAMES)
def test_axes_before_the_last_come_back(name, call):
    m, call = opm.examples.load(name), CALLS[call]
    if call is CALLS["every mode"] and m.choices > 6:
        pytest.skip("too many modes")
    for shape in ((2, 3), (1, 1), (), (2, 1, 2), (0, 3), (0,)):
        poses = poses_of(m, shape)
        nested = arrays(call(m, poses))
        flat = arrays(call(m, poses.reshape(-1, poses.shape[-1])))
        assert list(nested) == list(flat) and nested
        for key in set(flat) - OWN:
            assert nested[key].shape == shape + flat[key].shape[1:], (key, shape)
            np.testing.assert_array_equal(nested[key].ravel(), flat[key].ravel(), err_msg=key)


def test_forward_has_the_axes_of_its_joints():
    m = opm.examples.load("planar-3rpr")
    joints = m.inverse(poses_of(m, (2, 3)), joints="actuated").joints
    nested, flat = m.forward(joints), m.forward(joints.reshape(6, 3))
    assert nested.poses.shape == (2, 3, *flat.poses.shape[1:]) and nested.counts.shape == (2, 3) and len(nested) == 2
    assert sum(nested.modes, []) == flat.modes and nested[1].modes == nested.modes[1]
    np.testing.assert_array_equal(nested[-1].poses, nested.poses[1])
    assert nested[1][2][0] == flat[5][0] and len(list(nested)) == 2
    # Without rows there are none, along any axis.
    assert m.forward(np.zeros((2, 0, 3))).modes == [[], []] and m.forward(np.zeros((0, 2, 3))).modes == []
    near = m.forward(joints, near=poses_of(m, (2, 3)), method="newton")
    np.testing.assert_allclose(near.poses[..., 0, :], poses_of(m, (2, 3)), atol=1e-9)


def test_a_linkage_takes_values_of_any_shape():
    linkage = opm.examples.bennett()
    low, high = linkage.range()[0]
    values = np.linspace(low, high, 6).reshape(2, 3) * 0.9
    nested, flat = linkage.positions(values), linkage.positions(values.ravel())
    assert nested.joints.shape == (2, 3, *flat.joints.shape[1:])
    np.testing.assert_array_equal(nested.joints.reshape(flat.joints.shape), flat.joints)


def test_arguments_go_together_as_those_of_numpy():
    m = opm.examples.load("delta")
    poses, rates = poses_of(m, (4, 1)), np.random.default_rng(2).uniform(-1, 1, (3, 3))
    every = m.velocity(poses, rates)
    assert every.joint_rates.shape[:2] == (4, 3)
    for i in range(4):
        for j in range(3):
            one = m.velocity(poses[i, 0], rates[j])
            np.testing.assert_array_equal(every.joint_rates[i, j], one.joint_rates)
    # One pose under many loads.
    loads = np.eye(6)
    np.testing.assert_array_equal(m.analyze(m.home, wrench=loads).efforts[2], m.analyze(m.home, wrench=loads[2]).efforts)
    # Coordinates on a grid, by name.
    x, y = np.meshgrid([-0.02, 0.0, 0.02], [0.0, 0.01])
    found = m.inverse({"x": x, "y": y})
    assert found.reachable.shape == (2, 3)
    np.testing.assert_array_equal(found.joints[1, 2], m.inverse({"x": 0.02, "y": 0.01}).joints)
    with pytest.raises(opm.OpmError, match=r"^2 rows of rates, expected 3 as of poses, or one$"):
        m.velocity(poses_of(m, (3,)), rates[:2])
    with pytest.raises(opm.OpmError, match=re.escape("(2, 2) rows of rates, expected 3 as of poses, or one")):
        m.velocity(poses_of(m, (3,)), np.zeros((2, 2, 3)))


def test_what_is_followed_in_time_is_rows():
    m = opm.examples.load("delta")
    for call in (lambda: m.forward_track(np.zeros((2, 2, 3))), lambda: opm.trajectory(m, np.zeros((2, 2, 3)), times=[0.0, 1.0])):
        with pytest.raises(opm.OpmError, match=r"^(joints|motion) has shape \(2, 2, 3\), expected \(n, 3\): "):
            call()


def test_a_function_that_is_mapped_over_blocks():
    """What ``jax.pure_callback`` does under nested ``vmap``: one call with the axes of all of them, and of one for what is not mapped."""
    m = opm.examples.load("delta")
    points, loads = poses_of(m, (4, 5)), np.random.default_rng(5).uniform(-1, 1, (5, 6))

    def host(poses, wrench):
        return m.analyze(poses, wrench=wrench).efforts

    found = host(points, loads[None])
    assert found.shape == (4, 5, 3)
    for i, j in np.ndindex(4, 5):
        np.testing.assert_allclose(found[i, j], host(points[i, j], loads[j]), rtol=1e-12)


def test_tables_count_along_each_axis():
    m = opm.examples.load("planar-3rpr")
    poses = poses_of(m, (2, 3))
    frame, data = m.inverse(poses).to_pandas(), m.inverse(poses).to_xarray()
    assert frame.index.names == ["pose0", "pose1"] and data["S1"].dims == ("pose0", "pose1")
    np.testing.assert_array_equal(frame.loc[(1, 2)][["S1"]], m.inverse(poses[1, 2]).to_pandas()["S1"])
    every = m.inverse(poses, mode="all").to_pandas()
    assert every.index.names == ["pose0", "pose1", "mode"]
    one = m.inverse(poses[0, 0], mode="all")
    assert one.to_pandas().index.names == ["pose", "mode"] and "<table" in one._repr_html_()
    assert "1, 2" in m.inverse(poses)._repr_html_()


@pytest.mark.parametrize("name", [name for name in opm.examples.names() if name not in LINKAGES])
def test_places_are_matrices_objects_or_pairs(name):
    transform = pytest.importorskip("scipy.spatial.transform")
    m = opm.examples.load(name)
    poses = poses_of(m, (2, 3))
    places = m.transform(poses)
    expected = m.locate(places)
    turns = transform.Rotation.from_matrix(places[..., :3, :3].reshape(-1, 3, 3))
    pairs = [(places[..., :3, 3], places[..., :3, :3]), (places[..., :3, 3].reshape(-1, 3), turns)]
    if hasattr(transform, "RigidTransform"):
        pairs.append(transform.RigidTransform.from_matrix(places.reshape(-1, 4, 4)))
    for given in pairs:
        np.testing.assert_allclose(m.locate(given).ravel(), expected.ravel(), atol=1e-9)
        np.testing.assert_allclose(m.inverse(transforms=given).joints.ravel(), m.inverse(transforms=places).joints.ravel(), atol=1e-6)
        assert m.nearest(given).poses.size == expected.size
    # One rotation is for all positions.
    same = transform.Rotation.from_matrix(places[0, 0, :3, :3])
    every = m.locate((places[..., :3, 3], same))
    np.testing.assert_allclose(every[0, 0], expected[0, 0], atol=1e-9)


def test_places_that_are_none_are_told():
    m = opm.examples.load("delta")
    for given, told in [
        (np.eye(3), "transforms is of rotations alone, expected a pair of positions and rotations"),
        (np.zeros((2, 3)), "transforms has shape (2, 3), expected (..., 4, 4) homogeneous matrices, a RigidTransform, or"),
        ((np.zeros((2, 4)), np.eye(3)), "transforms[0] has shape (2, 4), expected (..., 3) positions, metres"),
        ((np.zeros((2, 3)), np.zeros((3, 3, 3))), "transforms has positions (2, 3) and rotations (3, 3, 3): they do not go together"),
        ("home", "transforms is 'home', expected (..., 4, 4)"),
        ((np.zeros(3), 2 * np.eye(3)), "transforms[0] is not a displacement"),
    ]:
        for call in (m.locate, m.nearest, lambda given: m.inverse(transforms=given)):
            with pytest.raises(opm.OpmError, match=f"^{re.escape(told)}"):
                call(given)
    # Two matrices in a tuple are two matrices.
    assert m.locate((np.eye(4), np.eye(4))).shape == (2, 3)


def test_a_frame_of_positions():
    m = opm.examples.load("delta")
    frame = pd.DataFrame(poses_of(m, (4,)), columns=[c.name for c in m.task_coordinates])
    assert m.inverse(frame).reachable.shape == (4,)
