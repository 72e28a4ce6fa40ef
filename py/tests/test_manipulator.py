"""Manipulators from Python, held against formulas written here in NumPy and against themselves."""

import os
import re
import signal
import subprocess
import sys
import threading
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import opm_kinematics as opm
import pytest
from shipped import LINKAGES

# The parameters of the shipped example: Selvi's, section 3.1, with lengths chosen for it.
ETA = np.radians([0.0, 120.0, 240.0])
BETA, ALPHA_1, ALPHA_2 = np.radians([60.0, 75.0, 75.0])
DIRECTION = np.radians([30.0, 150.0, 270.0])
H, A1, A2 = 0.12, 0.2, 0.06
D, B1, B2 = np.array([0.0, 0.075]), 0.1, 0.1


def rotation(zeta, xi, psi):
    """Rz(zeta) Ry(xi) Rz(psi) of many angles, (n, 3, 3)."""

    def about(axis, angle):
        c, s, matrix = np.cos(angle), np.sin(angle), np.zeros((len(angle), 3, 3))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        matrix[:, axis, axis] = 1
        matrix[:, i, i], matrix[:, i, j], matrix[:, j, i], matrix[:, j, j] = c, -s, s, c
        return matrix

    return about(2, zeta) @ about(1, xi) @ about(2, psi)


def formulas(poses):
    """theta_1i, S_i, phi_14, phi_24 in the mode ++ ++ ++ + (Eqs. 2-3 and 10-16, errata mended); NaN out of reach."""
    x, y, *angles = poses.T
    r = rotation(*angles)
    thetas, sliders = [], []
    with np.errstate(invalid="ignore"):
        for eta, alpha in zip(ETA, DIRECTION, strict=True):
            axis = np.array([np.cos(eta) * np.sin(BETA), np.sin(eta) * np.sin(BETA), np.cos(BETA)])
            w = r @ axis
            k = (np.cos(ALPHA_2) - np.cos(ALPHA_1) * w[:, 2]) / (np.sin(ALPHA_1) * np.hypot(w[:, 0], w[:, 1]))
            theta = np.arctan2(w[:, 1], w[:, 0]) + np.arcsin(k)
            q = np.stack([x + A2 * np.cos(theta) - H * np.cos(alpha), y + A2 * np.sin(theta) - H * np.sin(alpha)])
            along, across = np.array([np.cos(alpha), np.sin(alpha)]), np.array([-np.sin(alpha), np.cos(alpha)])
            thetas.append(theta)
            sliders.append(across @ q + np.sqrt(A1**2 - (along @ q) ** 2))
        reach = np.stack([x, y]) - D[:, None]
        distance = np.hypot(*reach)
        phi_14 = np.arctan2(reach[1], reach[0]) - np.arccos((B1**2 - B2**2 + distance**2) / (2 * B1 * distance))
        phi_24 = np.arccos((distance**2 - B1**2 - B2**2) / (2 * B1 * B2))
    return np.stack([*thetas, *sliders, phi_14, phi_24], axis=1)


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


@pytest.fixture(scope="module")
def poses():
    rng = np.random.default_rng(1)
    return rng.uniform(-1, 1, (20_000, 5)) * [0.15, 0.15, 1.0, 1.0, 1.0]


def test_what_it_is(manipulator):
    assert [c.name for c in manipulator.task_coordinates] == ["x", "y", "zeta", "xi", "psi"]
    assert [c.unit for c in manipulator.task_coordinates] == ["m", "m", "rad", "rad", "rad"]
    assert [manipulator.joint_names[i] for i in manipulator.actuated] == ["S1", "S2", "S3", "phi14", "phi24"]
    assert manipulator.imaginary_names == ["theta11", "theta12", "theta13"]
    found = manipulator.decomposition
    assert (found.rank, found.mobility, found.imaginary_joints, found.first_section_motions) == (5, 5, 3, 2)
    assert (found.lower, found.upper, found.intersection.kind) == ("planar", "spherical", "rotation")
    assert [leg.imaginary for leg in found.legs] == ["theta11", "theta12", "theta13", None]
    assert found.legs[3].lower == ["phi14", "phi24"] and found.legs[3].upper == ["s4"]
    assert manipulator.home_mode == "++ ++ ++ +" and manipulator.choices == 7
    assert "planar + spherical" in repr(manipulator)


def test_inverse_is_what_the_formulas_say(manipulator, poses):
    solutions = manipulator.inverse(poses)
    expected = formulas(poses)
    inside = ~np.isnan(expected).any(axis=1)
    assert 0.2 < inside.mean() < 0.95
    np.testing.assert_array_equal(solutions.reachable, inside)
    found = np.hstack([solutions.imaginary, solutions.joints[:, manipulator.actuated]])[inside]
    difference = found - expected[inside]
    difference[:, [0, 1, 2, 6, 7]] -= 2 * np.pi * np.round(difference[:, [0, 1, 2, 6, 7]] / (2 * np.pi))
    assert np.abs(difference).max() < 1e-7  # arccos near the boundary of reach
    assert np.median(np.abs(difference)) < 1e-14
    assert np.isnan(solutions.joints[~inside]).all()


def test_passive_joints_close_the_legs(manipulator, poses):
    """By the products of rotations and of plane displacements that define the joints."""
    solutions = manipulator.inverse(poses)
    assert 0.2 < solutions.reachable.mean() < 0.95
    inside = solutions.reachable
    joint = dict(zip(solutions.joint_names, solutions.joints[inside].T, strict=True))
    x, y, *angles = poses[inside].T
    point, r = x + 1j * y, rotation(*angles)
    zero = np.zeros(len(x))
    for leg, (eta, alpha) in enumerate(zip(ETA, DIRECTION, strict=True), 1):
        s, phi_1, phi_2, theta_2, theta_3 = (joint[f"{name}{leg}"] for name in ("S", "phi1", "phi2", "theta2", "theta3"))
        theta_1 = solutions.imaginary[inside, leg - 1]
        # R Rz(eta) Ry(beta) = Rz(theta_1) Rx(alpha_1) Rz(theta_2) Rx(alpha_2) Rz(theta_3), with Rx(a) = Rz(-pi/2) Ry(a) Rz(pi/2).
        arcs = rotation(theta_1 - np.pi / 2, zero + ALPHA_1, theta_2) @ rotation(zero, zero + ALPHA_2, theta_3 + np.pi / 2)
        assert np.abs(r @ rotation(zero + eta, zero + BETA, zero) - arcs).max() < 1e-7  # as accurate as arccos is at the boundary of reach
        assert np.median(np.abs(r @ rotation(zero + eta, zero + BETA, zero) - arcs)) < 1e-15
        # The slider, link a1 and link a2 end at P.
        along, link = np.exp(1j * alpha), np.exp(1j * (alpha + np.pi / 2 + phi_1))
        assert np.abs((H + 1j * s) * along + A1 * link - A2 * np.exp(1j * theta_1) - point).max() < 1e-13
        assert np.abs(link * np.exp(1j * phi_2) - np.exp(1j * theta_1)).max() < 1e-14
    # The arm turns what it carries from where it is at home; the ball, a rotation vector, makes up for that.
    turned = joint["phi14"] + joint["phi24"] - manipulator.inverse([manipulator.home]).joints[0, [15, 16]].sum()
    vector = np.stack([joint[f"s4.{axis}"] for axis in "xyz"], axis=1)
    angle = np.linalg.norm(vector, axis=1)[:, None, None]
    assert angle.max() <= np.pi + 1e-15
    axes = vector[:, :, None] / angle
    cross = np.cross(axes.transpose(0, 2, 1), np.eye(3)).transpose(0, 2, 1)
    ball = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)
    assert np.abs(rotation(turned, zero, zero) @ ball - r).max() < 1e-13


def test_what_comes_in_and_goes_out(manipulator, poses):
    expected = manipulator.inverse(poses)
    for table in (expected.joints, expected.imaginary):
        assert table.dtype == np.float64 and table.flags.c_contiguous and not table.flags.writeable and (table.base is None or not table.base.flags.writeable)
    for same in (poses[:, ::-1][:, ::-1], np.repeat(poses, 2, axis=0)[::2], poses.astype(">f8"), poses.astype(object)):
        np.testing.assert_array_equal(manipulator.inverse(same).joints, expected.joints)
    single = poses.astype(np.float32)
    np.testing.assert_array_equal(manipulator.inverse(single).joints, manipulator.inverse(single.astype(float)).joints)
    whole = np.zeros((3, 5), int)
    np.testing.assert_array_equal(manipulator.inverse(whole).joints, manipulator.inverse(whole.astype(float)).joints)
    none = manipulator.inverse(np.zeros((0, 5)))
    assert none.joints.shape == (0, 20) and none.imaginary.shape == (0, 3) and none.reachable.shape == (0,)
    unaligned = np.frombuffer(b"." + poses.tobytes(), np.float64, poses.size, 1).reshape(poses.shape)
    np.testing.assert_array_equal(manipulator.inverse(unaligned).joints, expected.joints)
    read_only = poses.copy()
    read_only.flags.writeable = False
    np.testing.assert_array_equal(manipulator.inverse(read_only).joints, expected.joints)


ROOM = """
import resource, sys
from pathlib import Path
import numpy as np
import opm_kinematics as opm

manipulator = opm.examples.load("plano-spherical-5dof")
poses = np.zeros((400_000, 5), order=sys.argv[1])
manipulator.inverse(poses[:5000], threads=1)
held = int(Path("/proc/self/status").read_text().split("VmData:")[1].split()[0]) * 1024
answers = len(poses) * (8 * 20 + 8 * 3 + 2)
resource.setrlimit(resource.RLIMIT_DATA, (held + answers + poses.nbytes * 3 // 4,) * 2)
try:
    print(manipulator.inverse(poses, threads=1).reachable.all())
except MemoryError:
    print("MemoryError")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="counts the memory of a process as Linux does")
def test_poses_in_c_order_are_not_copied():
    """With room for the answers, but not for the poses again."""
    for order, expected in [("C", "True"), ("F", "MemoryError")]:
        run = subprocess.run([sys.executable, "-c", ROOM, order], capture_output=True, text=True)
        assert run.stdout == f"{expected}\n", (order, run)


def test_ctrl_c_stops_it(manipulator):
    poses = np.zeros((2_000_000, 5))
    poses[:, 3] = 0.1
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            manipulator.inverse(poses, threads=1)


def test_threads_and_memory_orders_do_not_matter(manipulator, poses):
    expected = manipulator.inverse(poses, threads=1)
    for same in [
        manipulator.inverse(poses, threads=3),
        manipulator.inverse(np.asfortranarray(poses)),
        manipulator.inverse(poses[::-1][::-1]),
        manipulator.inverse(poses.tolist()),
    ]:
        np.testing.assert_array_equal(same.joints, expected.joints)
        np.testing.assert_array_equal(same.within_limits, expected.within_limits)


def test_modes(manipulator):
    plus, minus = (manipulator.inverse([manipulator.home], mode=m) for m in ("home", "++ ++ ++ -"))
    column = manipulator.actuated[-1]
    # The elbow bends in the other direction. Joint angles are between -180 and 180 degrees from home.
    assert np.cos(plus.joints[0, column]) == pytest.approx(np.cos(minus.joints[0, column]))
    assert np.sin(plus.joints[0, column]) == pytest.approx(-np.sin(minus.joints[0, column]))


def test_wrong_input_is_told(manipulator, tmp_path):
    with pytest.raises(opm.OpmError, match=r"poses has shape \(2, 3\), expected \(..., 5\): x, y, zeta, xi, psi"):
        manipulator.inverse(np.zeros((2, 3)))
    # A pose that is not known is not reached.
    many = np.zeros((20_000, 5))
    many[[7_777, 19_999], 3] = np.nan
    assert np.flatnonzero(~manipulator.inverse(many, threads=3).reachable).tolist() == [7_777, 19_999]
    many[7_777, 3] = np.inf
    with pytest.raises(opm.OpmError, match="pose 7777: xi is inf"):
        manipulator.inverse(many, threads=3)
    with pytest.raises(opm.OpmError, match="sign"):
        manipulator.inverse([manipulator.home], mode="+")
    with pytest.raises(opm.OpmError, match="no such example"):
        opm.examples.load("none")
    with pytest.raises(FileNotFoundError):
        opm.Manipulator.load(tmp_path / "none.toml")
    (tmp_path / "wrong.toml").write_text("format = 1\nname = 3\n")
    with pytest.raises(opm.OpmError, match=r"wrong\.toml:2:8: "):
        opm.Manipulator.load(tmp_path / "wrong.toml")


def test_every_example_is_one_or_says_why_not():
    for name in opm.examples.names():
        try:
            manipulator = opm.examples.load(name)
        except opm.OpmError as error:
            assert name in LINKAGES and str(error)
            continue
        home = manipulator.inverse([manipulator.home])
        assert home.reachable.all() and home.rows == 1


def reachable_in_another_process(job):
    manipulator, poses = job
    return manipulator.inverse(poses).reachable


@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_a_manipulator_crosses_processes(manipulator, poses, start):
    expected = manipulator.inverse(poses)  # with threads, which a forked process does not have
    with ProcessPoolExecutor(2, mp_context=get_context(start)) as pool:
        parts = pool.map(reachable_in_another_process, [(manipulator, part) for part in np.array_split(poses, 2)])
        np.testing.assert_array_equal(np.concatenate(list(parts)), expected.reachable)


def test_the_papers_mechanisms_have_names():
    assert opm.examples.plano_spherical() == opm.examples.load("plano-spherical-5dof")
    assert opm.examples.translational_helical() == opm.examples.load("translational-helical-3dof")


def test_poses_are_displacements(manipulator, poses):
    """By the definition of the coordinates: a place in the plane, and R = Rz(zeta) Ry(xi) Rz(psi)."""
    poses = poses[:200]
    found = manipulator.transform(poses)
    expected = np.zeros((200, 4, 4))
    expected[:, :3, :3], expected[:, :2, 3], expected[:, 3, 3] = rotation(*poses[:, 2:].T), poses[:, :2], 1
    np.testing.assert_allclose(found, expected, atol=1e-14)
    # Two triples of Euler angles are one rotation.
    np.testing.assert_allclose(manipulator.transform(manipulator.locate(found)), expected, atol=1e-8)
    np.testing.assert_array_equal(manipulator.locate(found, threads=2), manipulator.locate(found, threads=1))
    lifted = np.eye(4)
    lifted[2, 3] = 0.1  # the platform's point stays in the plane
    assert np.isnan(manipulator.locate([lifted])).all()
    nearest = manipulator.nearest([lifted, *found[:2]])
    np.testing.assert_allclose(nearest.translation, [[0, 0, 0.1], [0, 0, 0], [0, 0, 0]], atol=1e-9)
    np.testing.assert_allclose(nearest.rotation, 0, atol=1e-9)
    np.testing.assert_allclose(manipulator.transform(nearest.poses), [np.eye(4), *found[:2]], atol=1e-8)
    np.testing.assert_array_equal(nearest.poses[1:], manipulator.locate(found[:2]))
    assert repr(nearest) == "<Nearest poses to 3 displacements: 1 outside the motion>"
    for wrong in (2 * np.eye(4), np.diag([1.0, 1, -1, 1]), np.full((4, 4), np.inf)):
        with pytest.raises(opm.OpmError, match=r"transforms\[1\] is not a displacement"):
            manipulator.locate([np.eye(4), wrong])
    with pytest.raises(opm.OpmError, match=r"transforms has shape \(3, 4\), expected \(..., 4, 4\)"):
        manipulator.locate(np.eye(4)[:3])
    with pytest.raises(opm.OpmError, match="pose 1: xi is inf"):
        manipulator.transform([[0] * 5, [0, 0, 0, np.inf, 0]])


def test_newton_finds_the_pose_that_it_starts_near():
    for name in ("plano-spherical-5dof", "translational-planar-4dof"):
        manipulator = opm.examples.load(name)
        near = np.asarray(manipulator.home)
        poses = near + np.random.default_rng(2).uniform(-0.02, 0.02, (50, len(near)))
        solutions = manipulator.inverse(poses)
        joints = solutions.joints[:, manipulator.actuated]
        assert solutions.reachable.all()
        for starts in (near, poses + 1e-3):
            found = manipulator.forward(joints, near=starts, method="newton")
            assert all(len(one) == 1 for one in found)
            np.testing.assert_allclose([one.pose for (one,) in found], poses, atol=1e-9)
            assert {one.mode for (one,) in found} == {manipulator.home_mode}
        for threads in (1, 3):
            again = manipulator.forward(joints, near=near, method="newton", threads=threads)
            np.testing.assert_array_equal([a.pose for (a,) in again], [a.pose for (a,) in manipulator.forward(joints, near=near, method="newton")])
        with pytest.raises(opm.OpmError, match="row 0: near is out of reach in mode"):
            manipulator.forward(joints, near=near + 10, method="newton")
    with pytest.raises(opm.OpmError, match="near= says from where Newton's method begins"):
        manipulator.forward(joints)
    with pytest.raises(opm.OpmError, match="2 rows of near, expected 50 as of joints, or one"):
        manipulator.forward(joints, near=poses[:2])


def test_assemblies_of_one_mode(manipulator):
    joints = manipulator.inverse([manipulator.home]).joints[:, manipulator.actuated]
    (every,) = manipulator.forward(joints)
    assert len({one.mode for one in every}) > 1
    for mode in {one.mode for one in every}:
        (some,) = manipulator.forward(joints, mode=mode)
        expected = [one.pose for one in every if one.mode == mode]
        np.testing.assert_array_equal([one.pose for one in some], expected)


def test_ctrl_c_stops_all_modes_of_many_poses(manipulator):
    """Tables of gigabytes, which nobody is to wait for."""
    import time

    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        manipulator.inverse(np.zeros((60_000, 5)), mode="all", threads=1)
        # On a machine that is done sooner, it is pressed here.
        time.sleep(5)
    assert time.monotonic() - start < 4


def test_what_is_shown_has_seven_digits(manipulator):
    measured = opm.measure(manipulator, over={"x": (0.0, 0.12345678901)}, tolerance=0.3)
    for text in (repr(measured), repr(manipulator.decomposition.intersection)):
        for shown in re.findall(r"\d[\d.]*", text):
            assert len(shown.replace(".", "").strip("0")) <= 7, text
