"""Rates, Jacobians and forward kinematics from Python against differences of inverse kinematics."""

import numpy as np
import opm_kinematics as opm
import pytest

STEP = 1e-5


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


@pytest.fixture(scope="module")
def poses(manipulator):
    drawn = np.random.default_rng(2).uniform(-1, 1, (2_500, 5)) * [0.08, 0.08, 0.4, 0.4, 0.4]
    near = manipulator.singularity(drawn)
    return drawn[near.reachable & (np.abs(near.serial) > 0.05)]


def difference(manipulator, path):
    """First and second derivative by time of all joints and imaginary joints on a path, at time zero."""
    found = [manipulator.inverse(path(t)) for t in (-STEP, 0.0, STEP)]
    before, now, after = (np.hstack([f.joints, f.imaginary]) for f in found)
    turn = 2 * np.pi  # angles near the end of their range may come a turn apart
    back, ahead = ((d + np.pi) % turn - np.pi for d in (now - before, after - now))
    return (ahead + back) / (2 * STEP), (ahead - back) / STEP**2


def test_rates_are_derivatives_of_inverse_kinematics(manipulator, poses):
    rng = np.random.default_rng(3)
    rates, accelerations = rng.normal(size=(2, *poses.shape))
    first, second = difference(manipulator, lambda t: poses + t * rates + t * t / 2 * accelerations)
    motion = manipulator.velocity(poses, rates, accelerations)
    assert len(poses) > 500 and motion.regular.all()
    found = np.hstack([motion.joint_rates, motion.imaginary_rates])
    np.testing.assert_allclose(found, first, rtol=1e-5, atol=1e-5 * np.abs(first).max())
    found = np.hstack([motion.joint_accelerations, motion.imaginary_accelerations])
    np.testing.assert_allclose(found, second, rtol=1e-2, atol=1e-3 * np.abs(second).max())


@pytest.mark.parametrize("name", ["plano-spherical-5dof", "five-bar", "translational-helical-3dof"])
def test_the_twist_is_that_of_the_transform(name):
    m = opm.examples.load(name)
    rng = np.random.default_rng(5)
    poses = m.home + rng.uniform(-1, 1, (200, len(m.home))) * [0.01 if c.unit == "m" else 0.2 for c in m.task_coordinates]
    rates = rng.normal(size=poses.shape)
    reachable = m.inverse(poses).reachable
    poses, rates = poses[reachable], rates[reachable]
    assert len(poses) > 50
    before, now, after = (m.transform(poses + t * rates) for t in (-STEP, 0.0, STEP))
    change = (after - before) / (2 * STEP)
    spin = change[:, :3, :3] @ now[:, :3, :3].transpose(0, 2, 1)
    expected = np.column_stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0], change[:, :3, 3]])
    found = np.einsum("nij,nj->ni", m.twist_jacobian(poses), rates)
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_the_jacobian_gives_the_rates(manipulator, poses):
    rates = np.random.default_rng(4).normal(size=(1, 5))
    motion = manipulator.velocity(poses, rates)
    whole = manipulator.jacobian(poses, joints="all")
    np.testing.assert_allclose(whole @ rates[0], motion.joint_rates, atol=1e-9)
    np.testing.assert_array_equal(manipulator.jacobian(poses), whole[:, manipulator.actuated])
    assert whole.shape == (len(poses), len(manipulator.joint_names), 5)


def test_the_helical_jacobian_is_the_printed_one():
    """Rows [-sin alpha, cos alpha, sin beta p] (Eq. 29, mended), the same everywhere."""
    manipulator = opm.examples.load("translational-helical-3dof")
    alpha, beta, p = np.radians([210, 330, 90]), np.radians([45, 285, 165]), [0.02, 0, 0]
    expected = np.stack([-np.sin(alpha), np.cos(alpha), np.sin(beta) * p], axis=1)
    for jacobian in manipulator.jacobian([[0, 0, 0], [0.05, -0.03, 2.0]]):
        np.testing.assert_allclose(jacobian, expected, atol=1e-12)


def test_a_stretched_arm_is_singular(manipulator):
    """The arm b1 + b2 = 200 mm from (0, 75) mm."""
    angle = -2.0
    near, at = ([r * np.cos(angle), 0.075 + r * np.sin(angle), 0, 0, 0] for r in (0.15, 0.2))
    found = manipulator.singularity([near, at])
    assert found.lower_serial[1] == pytest.approx(0, abs=1e-6) and abs(found.lower_serial[0]) > 0.1
    assert np.isinf(found.condition[1]) and np.isfinite(found.condition[0])
    assert np.isnan(manipulator.jacobian([at])[0, 3:]).all()


def test_forward_finds_the_pose_again(manipulator, poses):
    few = poses[:20]
    solutions = manipulator.inverse(few)
    for pose, assemblies in zip(few, manipulator.forward(solutions.joints[:, manipulator.actuated]), strict=True):
        assert 1 <= len(assemblies) <= 64
        gaps = [np.abs(a.pose - pose).max() for a in assemblies if a.mode == manipulator.home_mode]
        assert min(gaps) < 1e-6
        assert max(a.residual for a in assemblies) < 1e-12


def test_wrong_input_is_told(manipulator):
    home = [manipulator.home]
    with pytest.raises(opm.OpmError, match="joints is 'none'|joints is \"none\""):
        manipulator.jacobian(home, joints="none")
    with pytest.raises(opm.OpmError, match="3 rows of rates, expected 2 as of poses, or one"):
        manipulator.velocity(home * 2, np.zeros((3, 5)))
    with pytest.raises(opm.OpmError, match=r"rates has shape \(\d+, 4\), expected \(..., 5\)"):
        manipulator.velocity(home, np.zeros((1, 4)))
    with pytest.raises(opm.OpmError, match="length is -1"):
        manipulator.singularity(home, length=-1.0)
    with pytest.raises(opm.OpmError, match=r"joints has shape \(\d+, 2\), expected \(..., 5\): S1, S2, S3, phi14, phi24"):
        manipulator.forward(np.zeros((1, 2)))
    with pytest.raises(opm.OpmError):
        manipulator.forward([[np.inf] * 5])
