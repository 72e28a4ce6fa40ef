"""Forces and transmission for arrays of poses, against virtual work and linear programs."""

import pickle

import numpy as np
import opm_kinematics as opm
import pycapacity.robot
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

GRID = {"x": (-0.15, 0.15, 21), "y": (-0.15, 0.15, 21)}


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


def poses_near(manipulator, count, size=0.1):
    generator = np.random.default_rng(7)
    return np.asarray(manipulator.home) + generator.uniform(-size, size, (count, len(manipulator.home)))


def test_efforts_do_no_work_together_with_the_load(manipulator):
    # More than a thread takes at once.
    poses = poses_near(manipulator, 2500, 0.08)
    loads = np.random.default_rng(1).uniform(-10, 10, (len(poses), 6))
    found = manipulator.analyze(poses, wrench=loads)
    assert found.reachable.all() and found.balanced.all()
    rates = manipulator.jacobian(poses)
    twists = manipulator.twist_jacobian(poses)
    # The twist has the angular velocity first.
    work = np.einsum("nk,nkd->nd", loads[:, [3, 4, 5, 0, 1, 2]], twists)
    own = np.einsum("na,nad->nd", found.efforts, rates)
    size = np.einsum("na,nad->nd", np.abs(found.efforts), np.abs(rates)) + 1
    assert np.abs(work + own).max() < 1e-9 * size.max()
    assert np.abs(work + own).max() < 1e-9 * np.abs(work).max()
    np.testing.assert_allclose(np.einsum("nak,nk->na", found.effort_jacobian, loads), found.efforts, atol=1e-8)
    assert (found.lti == np.minimum(found.iti, found.oti)).all()
    # In any number of threads.
    assert manipulator.analyze(poses, wrench=loads, threads=1) == found


def test_a_load_may_act_at_a_point_and_along_the_platform(manipulator):
    poses = poses_near(manipulator, 5)
    placed = manipulator.transform(poses)
    rotation, position = placed[:, :3, :3], placed[:, :3, 3]
    force, moment, arm = np.array([1.0, -2, 3]), np.array([0.1, 0.2, -0.3]), np.array([0.05, 0, 0.02])
    turned = lambda v: np.einsum("nij,j->ni", rotation, v)  # noqa: E731
    load = np.hstack([turned(force), turned(moment) + np.cross(turned(arm), turned(force))])
    found = manipulator.analyze(poses, wrench=[*force, *moment], at=arm, frame="platform")
    np.testing.assert_allclose(found.efforts, manipulator.analyze(poses, wrench=load).efforts, atol=1e-10)
    found = manipulator.analyze(poses, wrench=[*force, *moment], at="base")
    load = np.hstack([np.tile(force, (5, 1)), moment - np.cross(position, force)])
    np.testing.assert_allclose(found.efforts, manipulator.analyze(poses, wrench=load).efforts, atol=1e-10)


def limited(name, effort):
    """A mechanism whose actuated joints have largest efforts, and these."""
    text = opm.examples.load(name).to_joints()
    m = opm.Manipulator.parse(text)
    changes = {f"{m.joint_names[i]}.max_effort": effort + 0.1 * k for k, i in enumerate(m.actuated)}
    return m.with_parameters(changes), np.array(list(changes.values()))


@pytest.mark.parametrize("name", ["planar-3rrr", "plano-spherical-5dof", "translational-planar-4dof", "agile-eye"])
def test_the_payload_is_what_linear_programs_find(name):
    """The least of the largest forces in any direction, each the solution of a linear program; never below it, and
    reached in one."""
    m, efforts = limited(name, 3.0)
    # The second pose is not home, where the directions of some forces are special.
    poses = poses_near(m, 3, 0.05)
    found = m.analyze(poses)
    rates, twists = m.jacobian(poses), m.twist_jacobian(poses)
    generator = np.random.default_rng(3)
    for number in range(len(poses)):
        payload, closest = found.payload[number], np.inf
        a, forces = rates[number], twists[number, 3:]
        if np.abs(forces).max() < 1e-12:
            # A spherical mechanism bears every force at its centre.
            assert payload == np.inf
            continue
        # Directions, and those that single actuators bear worst.
        directions = generator.normal(size=(200, 3))
        directions = np.vstack([directions, np.nan_to_num(found.effort_jacobian[number, :, :3])])
        for direction in directions[np.linalg.norm(directions, axis=1) > 1e-9]:
            direction /= np.linalg.norm(direction)
            # Largest s with a' t + s forces' direction = 0, |t| <= efforts.
            system = np.hstack([a.T, (forces.T @ direction)[:, None]])
            bounds = [*((-e, e) for e in efforts), (0, None)]
            best = linprog([*np.zeros(len(efforts)), -1], A_eq=system, b_eq=np.zeros(len(system)), bounds=bounds)
            if best.status == 3:
                continue
            assert best.status == 0
            assert best.x[-1] >= payload * (1 - 1e-6)
            closest = min(closest, best.x[-1])
        if np.isfinite(found.effort_jacobian[number]).all():
            assert closest == pytest.approx(payload, rel=1e-6)
        else:
            assert closest < 1.2 * payload


def test_the_polytope_is_that_of_pycapacity():
    m, efforts = limited("planar-3rrr", 3.0)
    poses, length = poses_near(m, 5, 0.05), 0.25
    found = m.analyze(poses, length=length)

    def nearest_facet(units):
        """The distance of the nearest facet of the polytope of wrenches (in these units) whose efforts are within limits."""
        polytope = pycapacity.robot.force_polytope(units.T, efforts, -efforts)
        assert np.abs(units @ polytope.vertices).max(axis=1) == pytest.approx(efforts, rel=1e-6)
        return -ConvexHull(polytope.vertices.T).equations[:, -1].max()

    for number in range(len(poses)):
        rows = found.effort_jacobian[number]
        assert found.payload[number] == pytest.approx(nearest_facet(rows[:, :2]), rel=1e-6)
        planar = rows[:, [0, 1, 5]] / [length, length, 1]
        assert found.payload_ball[number] == pytest.approx(nearest_facet(planar), rel=1e-6)
        moment = (efforts / np.abs(rows[:, 5])).min()
        assert found.payload_moment[number] == pytest.approx(moment, rel=1e-9)


def test_the_good_transmission_workspace_is_where_the_index_says(manipulator):
    swept = opm.sweep(manipulator, **GRID)
    limited = opm.sweep(manipulator, limits={"lti": 0.7, "effort_per_moment": 4.0}, **GRID)
    assert limited.limits == {"lti": 0.7, "effort_per_moment": 4.0} and swept.limits == {}
    found = manipulator.analyze(swept.points())
    good = (found.lti >= 0.7) & (found.effort_per_moment <= 4.0)
    assert 0 < good.sum() == limited.count < swept.count
    np.testing.assert_array_equal(limited.points(), swept.points()[good])


def test_indices_are_scalars_of_points(manipulator, tmp_path):
    swept = opm.sweep(manipulator, **GRID)
    path = tmp_path / "points.npy"
    swept.write(path, scalars=["lti"], color="effort_per_force")
    points = np.load(path)
    poses = np.zeros((len(points), 5))
    poses[:, 0], poses[:, 1] = points["x"], points["y"]
    found = manipulator.analyze(poses)
    np.testing.assert_array_equal(points["lti"], found.lti)
    np.testing.assert_array_equal(points["effort_per_force"], found.effort_per_force)


def test_what_is_not_determined_is_not_a_number():
    # A leg of this one has an actuator more than the platform has freedoms.
    m = opm.Manipulator.parse(
        opm.examples.load("planar-3rrr").to_joints().replace('name = "B1", type = "revolute"', 'name = "B1", actuated = true, type = "revolute"')
    )
    assert len(m.actuated) == 4
    found = m.analyze([m.home], wrench=[0, 0, 0, 0, 0, 1])
    assert found.balanced.all() and np.isnan(found.efforts).all() and np.isnan(found.lti).all()
    out = m.analyze([[9, 9, 0]], wrench=[0, 0, 0, 0, 0, 1])
    assert not out.reachable.any() and not out.balanced.any() and np.isnan(out.efforts).all()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"wrench": [1, 2]}, r"wrench has shape \(2,\), expected \(..., 6\): FX, FY"),
        ({"wrench": np.ones((3, 4))}, r"wrench has shape \(3, 4\), expected \(..., 6\)"),
        ({"wrench": [1, 2, 3, 4, 5, np.nan]}, "NaN is among wrench"),
        ({"frame": "tool"}, "frame is \"tool\", expected \"base\" or \"platform\""),
        ({"at": "tip"}, "at is 'tip', expected"),
        ({"at": [1, 2]}, "at"),
        ({"gravity": [1, 2]}, "gravity"),
        ({"density": 7800.0}, "density needs gravity"),
        ({"gravity": [0, 0, -9.81], "density": 0.0}, "density is 0"),
        ({"joint_stiffness": {"S1": 1e6}}, "joint_stiffness needs link_stiffness"),
        ({"link_stiffness": (1e6, -1.0)}, "link_stiffness: a stiffness is -1"),
        ({"link_stiffness": (1e6, 1e3), "joint_stiffness": {"Q": 1.0}}, "no actuated joint \"Q\", expected one of S1"),
        ({"length": 0.0}, "length is 0.0"),
    ],
)
def test_bad_input_is_refused(manipulator, given, message):
    with pytest.raises(opm.OpmError, match=message):
        manipulator.analyze([manipulator.home], **given)


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"let": 0.7}, "limits: no index \"let\", expected one of iti, oti, lti"),
        ({"lti": float("nan")}, "limits: lti is NaN, expected a finite number"),
        ({"payload": 3.0}, "limits: payload: no actuated joint has a `max_effort`"),
    ],
)
def test_limits_that_make_no_sense_are_refused(manipulator, limits, message):
    with pytest.raises(opm.OpmError, match=message):
        opm.sweep(manipulator, limits=limits, x=0.1)


SETUP = {
    "wrench": [10, 0, -3, 0, 0, 0.5],
    "at": [0.01, 0, 0.02],
    "frame": "platform",
    "gravity": [0, 0, -9.81],
    "link_stiffness": (1e7, 1e4),
    "joint_stiffness": {"S1": 1e6},
}


def test_stiffness_displaces_the_platform_by_what_the_legs_carry(manipulator):
    found = manipulator.analyze([manipulator.home, [9, 9, 0, 0, 0]], link_stiffness=(1e7, 1e4))
    matrix, legs = found.stiffness_matrix, found.leg_stiffness
    assert matrix.shape == (2, 6, 6) and legs.shape == (2, 4, 6, 6) and np.isnan(matrix[1]).all()
    np.testing.assert_allclose(legs[0].sum(axis=0), matrix[0], rtol=1e-9, atol=1e-3)
    np.testing.assert_allclose(matrix[0], matrix[0].T, rtol=1e-9, atol=1e-3)
    # A force, and a moment, in the worst direction.
    compliance = np.linalg.inv(matrix[0])
    for least, block in [(found.stiffness, compliance[:3, :3]), (found.rotational_stiffness, compliance[3:, 3:])]:
        assert least[0] == pytest.approx(1 / np.linalg.norm(block, 2), rel=1e-6)
    assert manipulator.analyze([manipulator.home]).stiffness_matrix is None


def test_a_sweep_is_limited_by_loads_springs_and_clearance(manipulator, tmp_path):
    swept = opm.sweep(manipulator, **GRID)
    found = manipulator.analyze(swept.points(), **SETUP)
    clearance = manipulator.clearance(swept.points()).distance
    np.testing.assert_array_equal(found.clearance, clearance)
    # At serial singularities there is no effort.
    effort, stiff = np.nanmedian(found.effort), np.nanmedian(found.stiffness)
    apart = np.quantile(clearance[clearance > 0], 0.3)
    limits = {"effort": effort, "stiffness": stiff}
    limited = opm.sweep(manipulator, limits=limits, clearance=apart, **SETUP, **GRID)
    good = (found.effort <= effort) & (found.stiffness >= stiff) & (clearance >= apart)
    assert 0 < good.sum() == limited.count
    np.testing.assert_array_equal(limited.points(), swept.points()[good])
    assert limited.clearance == apart and swept.clearance is None
    assert opm.sweep(manipulator, limits={**limits, "clearance": apart}, **SETUP, **GRID).count == limited.count
    # The points of a recording have the efforts of joints.
    limited.write(tmp_path / "points.npy", scalars=["effort.S1", "clearance"], color="effort.theta11")
    points = np.load(tmp_path / "points.npy")
    np.testing.assert_array_equal(points["effort.S1"], found.efforts[good, 0])
    np.testing.assert_array_equal(points["effort.theta11"], found.imaginary_efforts[good, 0])
    np.testing.assert_array_equal(points["clearance"], clearance[good])
    # It is the same after a journey to another process.
    assert pickle.loads(pickle.dumps(limited)) == limited
    assert opm.sweep(manipulator, limits=limits, **SETUP, **GRID) != limited


def test_weights_are_loads(manipulator):
    found = manipulator.analyze([manipulator.home, [0.01, 0, 0, 0.1, 0]], gravity=[0, -9.81, 0])
    heavy = manipulator.analyze([manipulator.home, [0.01, 0, 0, 0.1, 0]], gravity=[0, -9.81, 0], density=5400)
    # All bodies of the shipped mechanism have masses by density, 2700 kg/m³ unless said otherwise.
    np.testing.assert_allclose(heavy.efforts, 2 * found.efforts, rtol=1e-9, atol=1e-12)
    assert (np.abs(found.efforts) > 1e-3).any()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"limits": {"effort": 3.0}}, "limits: effort: nothing acts on the mechanism"),
        ({"limits": {"stiffness": 3.0}}, "limits: stiffness: nothing gives way"),
        ({"limits": {"oci": 0.5}}, "limits: oci: no leg constrains the platform"),
        ({"clearance": -1.0}, "clearance: -1.0 m, expected a length of 0 or more"),
        ({"clearance": 0.001, "limits": {"clearance": 0.002}}, "clearance is given twice"),
        ({"clearance": 0.001, "mode": "any"}, "clearance"),
        ({"at": "base"}, "at and frame need wrench"),
    ],
)
def test_setups_that_make_no_sense_are_refused(manipulator, given, message):
    with pytest.raises(opm.OpmError, match=message):
        opm.sweep(manipulator, x=0.1, **given)
