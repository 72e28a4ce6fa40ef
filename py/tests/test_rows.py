"""What is given and what comes back: one pose or many, by name, with gaps, as matrices, as tables."""

from collections.abc import Mapping

import numpy as np
import opm_kinematics as opm
import pandas as pd
import pytest
import xarray as xr
from shipped import LINKAGES

NAMES = [name for name in opm.examples.names() if name not in LINKAGES]


@pytest.fixture(scope="module")
def m():
    return opm.examples.load("plano-spherical-5dof")


def poses_of(m, count=40):
    widths = [0.03 if c.unit == "m" else 0.2 for c in m.task_coordinates]
    return np.array(m.home) + np.random.default_rng(7).uniform(-1, 1, (count, len(widths))) * widths


@pytest.mark.parametrize("name", NAMES)
def test_one_pose_is_a_row_without_its_axis(name):
    m = opm.examples.load(name)
    rows, one = poses_of(m, 3), poses_of(m, 3)[1]
    for call in (
        lambda p: vars_of(m.inverse(p)),
        lambda p: vars_of(m.inverse(p, mode="all")) if m.choices < 8 else {},
        lambda p: {"": m.transform(p)},
        lambda p: {"": m.dependent(p)},
        lambda p: {"": m.jacobian(p)},
        lambda p: {"": m.twist_jacobian(p)},
        lambda p: vars_of(m.velocity(p, p)),
        lambda p: vars_of(m.singularity(p)),
        lambda p: vars_of(m.analyze(p, wrench=[1, 2, 3, 0.1, 0.2, 0.3])),
        lambda p: vars_of(m.clearance(p)),
        lambda p: vars_of(m.nearest(m.transform(p))),
    ):
        many, single = call(rows), call(one)
        assert list(many) == list(single)
        for key, value in many.items():
            np.testing.assert_array_equal(value[1], single[key], err_msg=key)


def vars_of(thing):
    names = [name for name in dir(thing) if not name.startswith("_")]
    return {name: value for name in names if isinstance(value := getattr(thing, name), np.ndarray)}


@pytest.mark.parametrize("name", NAMES)
def test_matrices_in_are_poses_in(name):
    """The platform's place is all that is told: joint values are those of the poses it was computed from."""
    m = opm.examples.load(name)
    poses = poses_of(m)
    for mode in {m.home_mode, m.modes[0], m.modes[-1]}:
        expected = m.inverse(poses, mode=mode)
        places = m.transform(poses, mode=mode)
        found = m.inverse(transforms=places, mode=mode)
        known = expected.reachable
        np.testing.assert_array_equal(found.reachable[known], True)
        # Home of some mechanisms is a singularity of their Euler angles: other angles, the same place.
        np.testing.assert_allclose(found.joints[known], expected.joints[known], atol=1e-6)
        if known.any():
            one = int(np.flatnonzero(known)[0])
            np.testing.assert_array_equal(m.inverse(transforms=places[one], mode=mode).joints, found.joints[one])
    if m.choices < 8 and not m.dependent_coordinates:
        every, each = m.inverse(poses, mode="all"), m.inverse(transforms=m.transform(poses), mode="all")
        np.testing.assert_allclose(each.joints, every.joints, atol=1e-6)


def test_a_place_that_only_another_mode_has_is_out_of_reach():
    """Dependent coordinates differ between modes, and so does the place of the platform."""
    found = 0
    for name in NAMES:
        m = opm.examples.load(name)
        if not m.dependent_coordinates or m.choices == 0:
            continue
        pose = m.home
        home = m.transform(pose)
        for number, mode in enumerate(m.modes):
            there = m.transform(pose, mode=mode)
            apart = not np.allclose(there, home, atol=1e-6)
            solution = m.inverse(transforms=home, mode=mode)
            assert bool(solution.reachable) == (bool(m.inverse(pose, mode=mode).reachable) and not apart)
            every = m.inverse(transforms=home, mode="all")
            assert bool(every.reachable[number]) == bool(solution.reachable)
            found += apart
    assert found > 0


def test_what_is_outside_the_motion_is_out_of_reach(m):
    lifted = m.transform(m.home)
    lifted[2, 3] += 0.01
    solution = m.inverse(transforms=[m.transform(m.home), lifted])
    assert solution.reachable.tolist() == [True, False] and np.isnan(solution.joints[1]).all()
    with pytest.raises(opm.OpmError, match=r"^transforms\[0\] is not a displacement"):
        m.inverse(transforms=2 * np.eye(4))
    for wrong in ({}, {"poses": m.home, "transforms": np.eye(4)}):
        with pytest.raises(opm.OpmError, match="^expected poses or transforms, one of the two$"):
            m.inverse(**wrong)


def test_by_name_in_any_order(m):
    pose = {"xi": 0.1, "x": 0.01}
    expected = m.inverse([0.01, 0, 0, 0.1, 0]).joints
    np.testing.assert_array_equal(m.inverse(pose).joints, expected)
    np.testing.assert_array_equal(m.inverse(pd.Series(pose)).joints, expected)
    poses = poses_of(m)
    names = [c.name for c in m.task_coordinates]
    expected = m.inverse(poses).joints
    frame = pd.DataFrame(poses, columns=names)[["psi", "x", "zeta", "y", "xi"]]
    record = np.array([tuple(p) for p in poses], dtype=[(n, float) for n in names])[["psi", "x", "zeta", "y", "xi"]]
    for given in (frame, dict(frame), frame.to_xarray()[names], record, {n: frame[n].to_numpy() for n in frame}, pd.DataFrame(poses)):
        np.testing.assert_array_equal(m.inverse(given).joints, expected)
    # A number is for all rows; what is not among them is at home.
    partly = m.inverse({"x": poses[:, 0], "y": 0.01}).joints
    np.testing.assert_array_equal(partly, m.inverse(np.column_stack([poses[:, 0], [0.01] * 40, *np.zeros((3, 40))])).joints)
    joints = {n: 0.0 for n in ("phi24", "S1", "S2", "S3", "phi14")}
    assert repr(m.forward(joints)) == repr(m.forward([0.0] * 5))
    assert m.velocity(m.home, {"x": 1.0}) == m.velocity(m.home, [1, 0, 0, 0, 0])


def test_names_that_do_not_fit_are_refused(m):
    for given, told in [
        ({"x": 0.0, "X": 0.0}, "poses has a column 'X', expected x, y, zeta, xi, psi"),
        (pd.DataFrame({"x": [0.0], "tilt": [0.0]}), "poses has a column 'tilt', expected x, y"),
        ({"x": [0.0, 1.0], "y": [0.0] * 3}, "poses has columns of shapes that do not go together: x \\(2,\\), y \\(3,\\)"),
        ({"x": "a"}, "x of poses is 'a', expected a number"),
        ({3: 0.0}, "poses has a column 3, expected x"),
    ]:
        with pytest.raises(opm.OpmError, match=f"^{told}"):
            m.inverse(given)
    frame = pd.DataFrame(np.zeros((2, 2)), columns=["x", "x"])
    with pytest.raises(opm.OpmError, match="two columns x"):
        m.inverse(frame)
    with pytest.raises(opm.OpmError, match="^joints has no column S2, expected S1, S2, S3, phi14, phi24"):
        m.forward({"S1": 0.0})


@pytest.mark.parametrize("count", [3, 10_000])
def test_rows_with_gaps_are_out_of_reach(m, count):
    poses = np.tile(poses_of(m), (count // 40 + 1, 1))[:count]
    expected = m.inverse(poses)
    gaps = poses.copy()
    gaps[1::7, 2] = np.nan
    masked = np.ma.masked_invalid(gaps)
    frame = pd.DataFrame(gaps, columns=[c.name for c in m.task_coordinates]).astype("Float64")
    for given in (gaps, masked, frame):
        for joints in ("all", "actuated"):
            found = m.inverse(given, joints=joints)
            missing = np.zeros(count, dtype=bool)
            missing[1::7] = True
            assert not found.reachable[missing].any() and not found.within_limits[missing].any()
            assert np.isnan(found.joints[missing]).all() and np.isnan(found.imaginary[missing]).all()
            columns = slice(None) if joints == "all" else m.actuated
            np.testing.assert_array_equal(found.joints[~missing], expected.joints[~missing][:, columns])
    few = gaps[:3]
    for answer in (m.transform(few), m.jacobian(few), m.twist_jacobian(few), m.singularity(few).condition, m.clearance(few).distance):
        assert np.isnan(answer[1]).all() and not np.isnan(answer[0]).any()
    assert not m.inverse(few, mode="all").reachable[1].any() and m.inverse(few, mode="all").reachable[0].any()
    places = m.transform(few)
    assert m.inverse(transforms=places).reachable.tolist() == [True, False, True]
    assert np.isnan(m.locate(places)[1]).all()
    joints = m.inverse(few, joints="actuated").joints
    assert m.forward(joints).counts[1] == 0 < m.forward(joints).counts[0]
    assert np.isnan(m.forward_track(joints)[1]).all() and not np.isnan(m.forward_track(joints)[2]).any()
    with pytest.raises(opm.OpmError, match="pose 1: zeta is inf"):
        m.inverse(np.nan_to_num(few, nan=np.inf))


def test_actuated_joints_alone(m):
    poses = poses_of(m)
    for mode in ("home", "all"):
        every, some = m.inverse(poses, mode=mode), m.inverse(poses, mode=mode, joints="actuated")
        np.testing.assert_array_equal(some.joints, every.joints[..., m.actuated])
        assert some.joint_names == [m.joint_names[i] for i in m.actuated]
        np.testing.assert_array_equal(some.imaginary, every.imaginary)
    with pytest.raises(opm.OpmError, match='^joints is "passive", expected "actuated" or "all"'):
        m.inverse(poses, joints="passive")


def test_results_are_mappings(m):
    for found in (m.inverse(poses_of(m)), m.inverse(m.home), opm.trajectory(m, "plano-spherical-sinusoids", rate=5)):
        assert isinstance(found, Mapping)
        names = [*found.joint_names, *found.imaginary_names]
        assert list(found) == list(found.keys()) == names and len(found) == len(names)
        assert "S1" in found and "S9" not in found and 3 not in found
        for name, value in found.items():
            np.testing.assert_array_equal(value, found[name])
        assert list(dict(found)) == names and len(list(found.values())) == len(names)
        assert found.get("S9") is None and found.get("S9", 1) == 1
        np.testing.assert_array_equal(found.get("S1"), found["S1"])
        with pytest.raises(KeyError, match="S9: no such joint"):
            found["S9"]


def test_forward_gives_arrays(m):
    poses = poses_of(m, 6)
    joints = m.inverse(poses, joints="actuated").joints
    found = m.forward(joints)
    most = found.counts.max()
    assert found.poses.shape == (6, most, 5) and found.transforms.shape == (6, most, 4, 4) and len(found) == 6
    for row, assemblies in enumerate(found):
        assert len(assemblies) == found.counts[row] == len(found.modes[row])
        assert np.isnan(found.poses[row, len(assemblies) :]).all()
        for place, one in enumerate(assemblies):
            np.testing.assert_array_equal(one.pose, found.poses[row, place])
            np.testing.assert_array_equal(one.joints, found.joints[row, place])
            assert one.mode == found.modes[row][place] and one.within_limits == found.within_limits[row, place]
            assert one.residual == found.residuals[row, place] < 1e-12
            np.testing.assert_allclose(found.transforms[row, place], m.transform(one.pose, mode=one.mode), atol=1e-15)
    one = m.forward(joints[2])
    assert one.counts == found.counts[2] and one.poses.shape == (one.counts, 5) and len(one) == one.counts
    np.testing.assert_array_equal(one[-1].pose, found[2][-1].pose)
    with pytest.raises(IndexError):
        found[6]
    assert len(m.forward(np.zeros((0, 5)))) == 0 and m.forward([9.0] * 5).poses.shape == (0, 5)


def test_all_assemblies_of_a_hexapod_are_found():
    m = opm.examples.load("stewart")
    poses = m.home + np.array([[0.02, -0.01, 0.03, 0.1, 0.05, -0.1], [-0.03, 0.02, 0.01, -0.05, 0.1, 0.2]])
    joints = m.inverse(poses, joints="actuated").joints
    found = m.forward(joints)
    assert found.complete.all() and (found.counts > 1).all() and (found.counts % 2 == 0).all()
    for row, pose in enumerate(poses):
        off = np.abs(found.poses[row, : found.counts[row]] - pose).max(axis=1)
        assert off.min() < 1e-9
        again = m.inverse(found.poses[row, : found.counts[row]], joints="actuated").joints
        np.testing.assert_allclose(again, np.broadcast_to(joints[row], again.shape), atol=1e-9)
    # Near a pose it is Newton's method, as before: one row, and nothing is said of others.
    near = m.forward(joints, near=poses)
    assert near.poses.shape == (2, 1, 6) and not near.complete.any()
    np.testing.assert_allclose(near.poses[:, 0], poses, atol=1e-9)


def test_assemblies_are_sorted_from_near(m):
    joints = m.inverse(poses_of(m, 4), joints="actuated").joints
    from_home = m.forward(joints)
    for row in range(4):
        last = from_home[row][-1]
        near = m.forward(joints[row], near=last.pose)
        np.testing.assert_array_equal(near.poses[0], last.pose)
        assert sorted(map(tuple, near.poses)) == sorted(map(tuple, from_home.poses[row, : from_home.counts[row]]))
    by_newton = m.forward(joints, near=m.home, method="newton")
    assert by_newton.poses.shape == (4, 1, 5)
    np.testing.assert_allclose(by_newton.poses[:, 0], poses_of(m, 4), atol=1e-9)
    with pytest.raises(opm.OpmError, match='^method is "all", expected "every" or "newton"'):
        m.forward(joints, method="all")


def test_axes_as_values(m):
    expected = opm.sweep(m, x=(-0.1, 0.1, 5), y=0.01)
    for x in (np.linspace(-0.1, 0.1, 5), [-0.1, -0.05, 0.0, 0.05, 0.1], np.linspace(-0.1, 0.1, 5, dtype=np.float32), pd.Series(np.linspace(-0.1, 0.1, 5))):
        for y in (np.float64(0.01), np.array(0.01), [0.01], np.array([0.01])):
            found = opm.sweep(m, x=x, y=y)
            assert found.count == expected.count and found.poses == 5
    for x, told in [
        ([0.0, 0.1, 0.3], r"x\[1\] is 0.1, expected 0.15 for even steps from 0.0 to 0.3"),
        ([], "x has no values, expected a number, "),
        ([0.0, np.nan, 1.0], r"x\[1\] is nan|x\[1\] is NaN"),
        ([1.0, 0.0], "grid axis x: 1 to 0"),
        ([[0.0]], "x has shape"),
        ("wide", "x is 'wide', expected a number, "),
    ]:
        with pytest.raises(opm.OpmError, match=f"^{told}"):
            opm.sweep(m, x=x)


def test_tables(m):
    poses = poses_of(m, 4)
    found = m.inverse(poses)
    frame = found.to_pandas()
    assert list(frame) == [*found, "reachable", "within_limits"] and len(frame) == 4
    np.testing.assert_array_equal(frame["theta11"], found["theta11"])
    every = m.inverse(poses, mode="all")
    frame, data = every.to_pandas(), every.to_xarray()
    assert frame.index.names == ["pose", "mode"]
    np.testing.assert_array_equal(frame.loc[(2, m.home_mode)][found.joint_names], found.joints[2])
    np.testing.assert_array_equal(data["S1"].sel(mode=m.home_mode), found["S1"])
    assert data["S1"].attrs == {"units": "m"} and data["S1"].dims == ("pose", "mode")
    assert m.inverse(m.home).to_xarray()["S1"].dims == () and len(m.inverse(m.home).to_pandas()) == 1
    followed = opm.trajectory(m, "plano-spherical-sinusoids", rate=5)
    frame, data = followed.to_pandas(), followed.to_xarray()
    np.testing.assert_array_equal(frame.index, followed.times)
    np.testing.assert_array_equal(frame[followed.pose_names], followed.poses)
    np.testing.assert_array_equal(data["phi24"].sel(t=followed.times[3]), followed["phi24"][3])
    # A table's poses are poses again.
    np.testing.assert_allclose(m.inverse(frame[followed.pose_names]).joints, followed.joints, atol=1e-9)
    swept = opm.sweep(m, x=(-0.1, 0.1, 5), xi=(-0.2, 0.2, 3))
    assert list(swept.to_pandas()) == list(swept.axes) and len(swept.to_pandas()) == swept.count
    mask = swept.to_xarray()
    assert isinstance(mask, xr.DataArray) and mask.sum() == swept.count
    np.testing.assert_array_equal(mask.coords["xi"], swept.axes["xi"])
