"""Files that name their dimensions, and manipulators from joints."""

import math
import pickle

import numpy as np
import opm_kinematics as opm
import pytest

DELTA = opm.examples.text("delta")


def delta() -> opm.Manipulator:
    return opm.examples.load("delta")


def test_parameters_are_read_and_changed_by_name():
    m = delta()
    assert m.parameters["rod"] == 1.244 and m.parameters["start"] == pytest.approx(-math.pi / 2)
    assert m.parameters["B"] == pytest.approx((0, -0.688, 0))
    longer = m.with_parameters(rod=1.3, crank=0.5)
    assert longer.parameters["rod"] == 1.3 and m.parameters["rod"] == 1.244
    for leg in longer.legs.values():
        elbow, ball = (np.array(joint.point) for joint in leg[1:])
        assert np.linalg.norm(ball - elbow) == pytest.approx(1.3, abs=1e-12)
    # The text is the one that was typed, but for two numbers.
    assert longer.text == DELTA.replace("value = 1244", "value = 1300").replace("value = 524", "value = 500")
    again = pickle.loads(pickle.dumps(longer))
    assert again == longer and again.parameters == longer.parameters
    poses = np.array([[0.1, 0.2, -1.0], [0, 0, -0.9]])
    assert np.array_equal(again.inverse(poses).joints, longer.inverse(poses).joints)
    # Changes add up.
    assert m.with_parameters(rod=1.3).with_parameters(crank=0.5) == longer


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"rod": 0.5}, "`C`: along: B is 644 mm from the line, expected at most R = 500 mm: 144 mm off"),
        ({"rodd": 1.0}, "did you mean `rod`"),
        ({"rod": -1.0}, "expected at least 0 mm"),
        ({"B": 1.0}, "`B` is a point"),
        ({"rod": (1.0, 2.0)}, "`rod` is a pair, expected a number"),
        ({"rod": math.nan}, "finite"),
    ],
)
def test_wrong_changes_are_told(changes, expected):
    with pytest.raises(opm.OpmError, match=None) as told:
        delta().with_parameters(changes)
    assert expected in str(told.value)


@pytest.mark.parametrize("name", ["delta", "stewart", "tricept", "planar-3rrr", "plano-spherical-5dof"])
def test_rates_with_parameters_are_those_of_rebuilt_mechanisms(name):
    m = opm.examples.load(name)
    rng = np.random.default_rng(3)
    poses = m.home + rng.uniform(-0.02, 0.02, (5, len(m.home)))
    rates = m.parameter_jacobian(poses)
    assert rates.reachable.all()
    step, compared = 1e-6, 0
    for k, parameter in enumerate(rates.parameters):
        if parameter.endswith((".x", ".y")):
            continue
        value = m.parameters[parameter]
        try:
            ends = [m.with_parameters({parameter: value + sign * step}) for sign in (1, -1)]
        except opm.OpmError:
            continue
        compared += 1
        values = [end.inverse(poses, joints="all").joints for end in ends]
        joints = (values[0] - values[1]) / (2 * step)
        np.testing.assert_allclose(rates.joints[:, :, k], joints, atol=2e-6 * max(1, np.abs(joints).max()))
        # The pose at which the motors have their values again.
        jacobian = m.jacobian(poses)
        moved = -np.linalg.solve(jacobian, joints[:, m.actuated][:, :, None])[:, :, 0]
        np.testing.assert_allclose(rates.pose[:, :, k], moved, atol=2e-5 * max(1, np.abs(moved).max()))
    assert compared >= len(rates.parameters) / 2, compared
    some = m.parameter_jacobian(poses, parameters=rates.parameters[:2])
    assert np.array_equal(some.joints, rates.joints[:, :, :2])
    with pytest.raises(opm.OpmError, match="no dimension"):
        m.parameter_jacobian(poses, parameters=["nothing"])


def test_a_longer_rod_moves_a_delta_along_its_axis_by_geometry():
    # rod² = (its radius)² + (its height)² at home; the radius and the crank stay, so dz/drod = rod / height.
    m = delta()
    elbow, ball = (np.array(joint.point) for joint in m.legs["leg1"][1:3])
    rates = m.parameter_jacobian(np.array([m.home]), parameters=["rod"])
    assert rates.pose[0, :, 0] == pytest.approx([0, 0, 1.244 / (ball - elbow)[2]], abs=1e-8)


def test_a_mechanism_is_made_of_joints():
    m = opm.examples.load("stewart")
    again = opm.Manipulator.from_joints(m.legs, platform=m.reference_point, name="again")
    poses = m.home + np.random.default_rng(4).uniform(-0.02, 0.02, (20, 6))
    np.testing.assert_allclose(again.inverse(poses).joints, m.inverse(poses).joints, atol=1e-12)
    assert again.name == "again" and list(again.legs) == list(m.legs)
    for joints, copies in zip(m.legs.values(), again.legs.values(), strict=True):
        for joint, copy in zip(joints, copies, strict=True):
            assert (joint.name, joint.kind, joint.actuated) == (copy.name, copy.kind, copy.actuated)
            assert joint.point == copy.point and joint.limits == copy.limits and joint.home == copy.home
            assert copy.axis == (None if joint.axis is None else pytest.approx(joint.axis, abs=1e-15))
    helical = opm.Joint("h", "helical", axis=(0, 0, 2), point=(1, 0, 0), pitch=0.01, home=0.5, limits=(0, 1), max_rate=2)
    assert helical.axis == (0, 0, 1) and helical.limits == [(0, 1)] and helical.max_rate == [2]
    ball = opm.Joint("b", "spherical", point=(1, 2, 3), cone=0.4)
    assert ball.axis is None and ball.cone == (0.4, None) and ball.home == [0, 0, 0]
    assert pickle.loads(pickle.dumps(ball)) == ball


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda: opm.Joint("a", "revolut", axis=(0, 0, 1)), "kind is"),
        (lambda: opm.Joint("a", "revolute"), "needs axis"),
        (lambda: opm.Joint("a", "revolute", axis=(0, 0, 0)), "expected a direction"),
        (lambda: opm.Joint("a", "helical", axis=(0, 0, 1)), "needs pitch"),
        (lambda: opm.Joint("a", "universal", axis=(0, 0, 1)), "needs axis2"),
        (lambda: opm.Joint("a", "spherical", home=[0.0]), "expected 3"),
        (lambda: opm.Manipulator.from_joints([[opm.Joint("a", "revolute", axis=(0, 0, 1))]] * 2), "called"),
        (lambda: opm.examples.load("planar-3rpr").with_joints({"B9": {}}), "no joint"),
        (lambda: opm.examples.load("planar-3rpr").with_joints({"B1": {"pint": 0}}), "did you mean `point`"),
        (lambda: opm.examples.load("planar-3rpr").with_joints({"S1": {"limits": (2.0, 1.0)}}), "reversed"),
        (lambda: opm.examples.load("planar-3rpr").with_joints({"A1": {"point": (math.nan, 0, 0)}}), "nan"),
    ],
)
def test_wrong_joints_are_told(make, expected):
    with pytest.raises(opm.OpmError) as told:
        make()
    assert expected.lower() in str(told.value).lower()


def test_joints_are_changed_in_the_text():
    m = opm.examples.load("planar-3rpr")
    changed = m.with_joints({"A2": {"point": (0.016, 0, 0)}, "S1": {"limits": None}})
    assert changed.legs["leg2"][0].point == (0.016, 0, 0) and changed.legs["leg1"][1].limits == [None]
    # The others are written out by numbers, where the file has them by dimensions.
    for one, other in zip(changed.legs["leg3"], m.legs["leg3"], strict=True):
        assert one.name == other.name and one.kind == other.kind
        np.testing.assert_allclose(one.point, other.point, rtol=0, atol=1e-15)
        np.testing.assert_allclose(one.axis, other.axis, rtol=0, atol=1e-15)
