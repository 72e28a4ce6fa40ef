"""Errors of parts and actuators for arrays of poses, against forward kinematics and each other."""

import pickle

import numpy as np
import opm_kinematics as opm
import pytest

AXES = {"length": 50e-6, "angle": np.deg2rad(0.02)}


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


def poses_near(manipulator, count, size=0.08):
    generator = np.random.default_rng(7)
    return np.asarray(manipulator.home) + generator.uniform(-size, size, (count, len(manipulator.home)))


def test_actuator_errors_move_the_platform_by_the_inverse_jacobian(manipulator):
    poses = poses_near(manipulator, 40)
    found = manipulator.accuracy(poses, actuators=(20e-6, 20e-6))
    assert found.reachable.all() and found.held.all()
    actuated = found.sizes > 0
    inverse = np.linalg.inv(manipulator.jacobian(poses))
    np.testing.assert_allclose(found.sensitivity[:, actuated].transpose(0, 2, 1), inverse, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found.pose_error, 20e-6 * np.abs(inverse).sum(axis=2), rtol=1e-7)
    # They fit: no joint needs play.
    assert found.misfit_length.max() < 1e-12 and found.misfit_angle.max() < 1e-12
    assert manipulator.accuracy(poses, actuators=(20e-6, 20e-6), threads=1) == found


def test_parameters_move_the_platform_as_forward_kinematics_do(manipulator):
    pose = poses_near(manipulator, 1)
    found = manipulator.accuracy(pose)
    joints = manipulator.inverse(pose).joints[:, manipulator.actuated]
    step = 1e-5
    for name in ("leg1.h", "leg2.a2"):
        value = manipulator.parameters[name]
        ends = []
        for sign in (1, -1):
            changed = manipulator.with_parameters({name: value + sign * step})
            ends.append(changed.forward(joints, near=pose)[0][0].pose)
        expected = (ends[0] - ends[1]) / (2 * step)
        own = found.sensitivity[0, found.parameters.index(name)]
        np.testing.assert_allclose(own, expected, rtol=1e-5, atol=1e-6)


def test_permitted_tolerances_keep_the_clearance(manipulator):
    poses = poses_near(manipulator, 5)
    clearance = 20e-6
    found = manipulator.accuracy(poses, errors="links", clearance=(clearance, None))
    least = found.permitted_share.min(axis=0)
    of_axes = np.isfinite(least)
    single = {name: value for name, value, own in zip(found.parameters, least, of_axes) if own}
    kept = manipulator.accuracy(poses, tolerances={"parameter": single}, errors="links")
    assert clearance / 100 < kept.misfit_length.max() <= clearance * (1 + 1e-9)
    # One tolerance for all axes needs the whole clearance somewhere.
    length, angle = found.permitted_uniform.min(axis=0)
    kept = manipulator.accuracy(poses, tolerances={"length": length, "angle": angle}, errors="links")
    assert kept.misfit_length.max() == pytest.approx(clearance, rel=1e-8)
    # A single error does so by itself.
    alone = found.permitted_alone[0]
    number = int(np.nanargmin(alone))
    single = {found.parameters[number]: alone[number]}
    kept = manipulator.accuracy(poses[:1], tolerances={"parameter": single}, errors="links")
    assert kept.misfit_length.max() == pytest.approx(clearance, rel=1e-8)
    assert manipulator.accuracy(poses[:1]).permitted_alone is None


def test_files_and_dicts_say_the_same(manipulator, tmp_path):
    path = tmp_path / "parts.toml"
    path.write_text(
        'units = { length = "um", angle = "mrad" }\nlength = 50\nangle = 0.3\n'
        'actuators = { length = 20, angle = 0.02 }\n[joint.S1]\nangle = 0.1\n[parameter]\n"leg1.h" = 10\n'
    )
    given = {
        "length": 50e-6,
        "angle": 0.3e-3,
        "actuators": {"length": 20e-6, "angle": 0.02e-3},
        "joint": {"S1": {"angle": 0.1e-3}},
        "parameter": {"leg1.h": 10e-6},
    }
    one, other = (manipulator.accuracy([manipulator.home], tolerances=t) for t in (path, given))
    assert one == other
    assert one.sizes[one.parameters.index("leg1.h")] == 10e-6


def test_a_box_has_a_bound(manipulator):
    half = 0.02
    found = manipulator.accuracy_over({"x": (-half, half), "y": (0, half)}, tolerances=AXES, gap=0.1)
    assert found.tight and repr(found).startswith("<AccuracyBounds: at most ")
    generator = np.random.default_rng(3)
    poses = np.tile(manipulator.home, (200, 1))
    poses[:, 0] += generator.choice([-half, half, 0.3 * half], 200)
    poses[:, 1] += generator.uniform(0, half, 200)
    at = manipulator.accuracy(poses, tolerances=AXES)
    for values, bound, largest in [
        (at.worst_length, found.length, found.found_length),
        (at.worst_angle, found.angle, found.found_angle),
    ]:
        assert values.max() <= bound <= 1.1 * largest * (1 + 1e-9)
    at = manipulator.accuracy([found.pose_length, found.pose_angle], tolerances=AXES)
    assert at.worst_length[0] == pytest.approx(found.found_length, rel=1e-9)
    assert at.worst_angle[1] == pytest.approx(found.found_angle, rel=1e-9)
    again = manipulator.accuracy_over({"x": (-half, half), "y": (0, half)}, tolerances=AXES, gap=0.1, threads=1)
    assert found == again == pickle.loads(pickle.dumps(found))
    away = manipulator.accuracy_over({"x": (9, 10)}, tolerances=AXES)
    assert np.isnan(away.found_length) and away.pose_length == []


@pytest.mark.parametrize(
    ("over", "options", "expected"),
    [
        ({"X": (0, 1)}, {}, "no task coordinate X, expected one of x, y"),
        ({"x": (1, 0)}, {}, "the smaller one first"),
        ({"x": "far"}, {}, "expected a number or"),
        ({"x": (0, 0.01)}, {"gap": 0}, "expected a positive share"),
        ({"x": (0, 0.01)}, {"budget": 0}, "at least 1"),
        ({"x": (0, 0.01)}, {"tolerances": {"parameter": {"leg1.h": 1e-5}}}, "has no bounds over boxes"),
    ],
)
def test_wrong_boxes_are_named(manipulator, over, options, expected):
    with pytest.raises(opm.OpmError, match=expected):
        manipulator.accuracy_over(over, **({"tolerances": AXES} | options))


def test_drawn_mechanisms_spread_as_first_order_says(manipulator):
    poses = np.asarray(manipulator.home) + [[0, 0, 0, 0.2, 0], [10, 0, 0, 0, 0], [0.02, 0, 0, 0.3, 0]]
    small = {"length": 1e-6, "angle": 1e-6}
    found = manipulator.accuracy(poses, tolerances=small, errors="links", samples=500, seed=4)
    drawn = found.samples
    assert (drawn.count, drawn.seed, drawn.failed.tolist()) == (500, 4, [0, 0, 0])
    # Uniform errors within a size deviate by the size over the root of three.
    expected = np.sqrt(np.square(found.sensitivity * found.sizes[None, :, None]).sum(axis=1) / 3)
    np.testing.assert_allclose(drawn.deviations[[0, 2]], expected[[0, 2]], rtol=0.2)
    assert np.isnan(drawn.deviations[1]).all() and np.isnan(drawn.length[1])
    reached = [0, 2]
    assert (drawn.length[reached] <= found.worst_length[reached] * (1 + 1e-4)).all()
    assert (drawn.misfit_length[reached] <= found.misfit_length[reached] * (1 + 1e-4) + 1e-15).all()
    again = manipulator.accuracy(poses, tolerances=small, errors="links", samples=500, seed=4, threads=1)
    assert again == found == pickle.loads(pickle.dumps(found))
    assert manipulator.accuracy(poses[:1], tolerances=small, samples=20, seed=5).samples.seed == 5
    assert manipulator.accuracy(poses[:1], tolerances=small).samples is None


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"samples": 0}, "samples is 0, expected a whole number from 1"),
        ({"samples": 2.5}, "samples is 2.5"),
        ({"samples": 10, "seed": -1}, "seed is -1"),
        ({"errors": "parts"}, 'expected "axes" or "links"'),
        ({"tolerances": {"lenght": 1}}, "did you mean `length`"),
        ({"tolerances": {"joint": {"S9": {}}}}, "is not a joint"),
        ({"tolerances": {"parameter": {"leg1.h": -1}}}, "expected a number of at least 0"),
        ({"tolerances": {"joint": 3}}, "expected a dict"),
        ({"actuators": 3}, "expected two numbers"),
        ({"actuators": (None, 1e-6)}, "is a length, and no size is given for it"),
        ({"length": -1}, "length"),
    ],
)
def test_wrong_input_is_named(manipulator, options, expected):
    with pytest.raises(opm.OpmError, match=expected):
        manipulator.accuracy([manipulator.home], **options)


def test_out_of_reach_is_an_answer(manipulator):
    pose = np.asarray(manipulator.home) + [10, 0, 0, 0, 0]
    # At xi = 0, zeta and psi are not determined.
    tilted = np.asarray(manipulator.home) + [0, 0, 0, 0.2, 0]
    found = manipulator.accuracy([pose, tilted], tolerances=AXES)
    assert found.reachable.tolist() == [False, True]
    assert np.isnan(found.pose_error[0]).all() and np.isfinite(found.pose_error[1]).all()
    assert np.isnan(found.misfit_length[0]).all()
