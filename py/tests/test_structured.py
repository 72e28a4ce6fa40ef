"""Structured inputs: half and quarter turns, zeros, home, whole turns. Random ones never are where iterations stall."""

import itertools

import numpy as np
import opm_kinematics as opm
import pytest

ROUNDING = 1e-12


def loaded(name):
    try:
        return opm.examples.load(name)
    except opm.OpmError:
        return None  # the linkage, which has no platform


NAMES = [name for name in opm.examples.names() if loaded(name) is not None]

AXES = np.array([axis for axis in itertools.product((-1, 0, 1), repeat=3) if any(axis)], dtype=float)
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)


@pytest.fixture(scope="module", params=NAMES)
def manipulator(request):
    return loaded(request.param)


def quarters(manipulator, count, step=np.pi / 2):
    """Poses whose angles are whole numbers of quarter turns, and whose lengths are home's or near it."""
    rng = np.random.default_rng(7)
    home = np.asarray(manipulator.home)
    angles = np.array([coordinate.unit == "rad" for coordinate in manipulator.task_coordinates])
    turns = rng.integers(-2, 3, (count, len(home))) * step
    ways = home + rng.integers(-2, 3, (count, len(home))) * 0.05
    return np.where(angles, turns, ways)


def turns(axis, angle):
    """Rodrigues' formula, with sines and cosines of half turns exact."""
    sin, cos = (0.0, np.cos(angle)) if abs(np.sin(angle)) < 1e-15 else (np.sin(angle), np.cos(angle))
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) * cos + cross * sin + np.outer(axis, axis) * (1 - cos)


def placed(rotations):
    transforms = np.tile(np.eye(4), (len(rotations), 1, 1))
    transforms[:, :3, :3] = rotations
    return transforms


def test_poses_of_half_and_quarter_turns_come_back(manipulator):
    for step in (np.pi / 2, np.pi, np.pi / 4, 2 * np.pi):
        poses = quarters(manipulator, 3000, step)
        names = [coordinate.name for coordinate in manipulator.task_coordinates]
        if manipulator.dependent_coordinates and "pitch" in names:
            # At the poles of the angles, yaw does not follow from the others.
            poses = poses[np.abs(np.cos(poses[:, names.index("pitch")])) > 1e-3]
        transforms = manipulator.transform(poses)
        # Dependent coordinates have no solution at some poses.
        transforms = transforms[np.isfinite(transforms).all(axis=(1, 2))]
        assert len(transforms) > (100 if manipulator.dependent_coordinates else 2999)
        back = manipulator.transform(manipulator.locate(transforms))
        np.testing.assert_allclose(back, transforms, atol=ROUNDING)
        nearest = manipulator.nearest(transforms)
        np.testing.assert_array_equal(nearest.poses, manipulator.locate(transforms))
        assert not nearest.rotation.any() and not nearest.translation.any()
    # As six digits print them: least squares, which take longer.
    printed = manipulator.nearest(np.round(transforms[:20], 6))
    np.testing.assert_allclose(manipulator.transform(printed.poses), transforms[:20], atol=2e-5)


def test_exact_half_turns_are_located():
    manipulator = opm.examples.load("plano-spherical-5dof")
    axes = np.random.default_rng(3).normal(size=(2000, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    halves = 2 * axes[:, :, None] * axes[:, None, :] - np.eye(3)
    diagonal = np.diag([-1.0, 1, -1, 1])
    np.testing.assert_allclose(manipulator.transform(manipulator.locate([diagonal]))[0], diagonal, atol=ROUNDING)
    for rotations in (halves, [turns(axis, angle) for axis in AXES for angle in np.arange(-8, 9) * np.pi / 4]):
        transforms = placed(rotations)
        np.testing.assert_allclose(manipulator.transform(manipulator.locate(transforms)), transforms, atol=ROUNDING)
        assert not manipulator.nearest(transforms).rotation.any()


def test_what_is_no_rotation_is_told():
    manipulator = opm.examples.load("plano-spherical-5dof")
    away = np.eye(4)
    away[1, 3] = np.inf
    told = [
        (np.diag([1.0, 1, -1, 1]), "a reflection, not a rotation: the determinant is -1.000000, expected 1"),
        (np.diag([1.0, 1, 1.001, 1]), "not a rotation: R Rᵀ differs from the identity by 2.001e-3, expected at most 1e-5"),
        (np.zeros((4, 4)), "its last row is [0.0, 0.0, 0.0, 0.0], expected 0, 0, 0, 1"),
        (np.diag([0.0, 0, 0, 1]), "not a rotation: R Rᵀ differs from the identity by 1.000e0"),
        (away, "row 1, column 3 is inf, expected a finite number"),
    ]
    for matrix, message in told:
        with pytest.raises(opm.OpmError) as raised:
            manipulator.locate([np.eye(4), matrix])
        assert str(raised.value).startswith(f"transforms[1] is not a displacement: {message}"), raised.value
    # A matrix that is not known has no pose.
    located = manipulator.locate([np.eye(4), np.diag([1.0, np.nan, 1, 1])])
    assert np.isfinite(located[0]).any() and np.isnan(located[1]).all()


def test_inverse_kinematics_of_located_poses(manipulator):
    poses = quarters(manipulator, 400)
    home = np.asarray(manipulator.home)
    poses[::2] = home + 0.1 * np.sign(poses[::2] - home)
    solutions = manipulator.inverse(poses)
    assert solutions.reachable.any()
    one_by_one = [manipulator.inverse([pose]).joints for pose in poses]
    np.testing.assert_array_equal(solutions.joints, np.concatenate(one_by_one))
    # Forward kinematics of what is reached: one of the assemblies is where the platform is.
    if manipulator.name in {"plano-spherical-5dof", "translational-helical-3dof", "plano-cylindrical-4dof"}:
        reached = np.flatnonzero(solutions.reachable)[:100]
        expected = manipulator.transform(poses[reached])
        found = manipulator.forward(solutions.joints[np.ix_(reached, manipulator.actuated)])
        for assemblies, transform in zip(found, expected, strict=True):
            places = manipulator.transform([assembly.pose for assembly in assemblies])
            assert np.abs(places - transform).max(axis=(1, 2)).min() < 1e-6
