"""Trajectories from Python, against the command line, formulas and inverse kinematics."""

import json
import pickle
import subprocess
import sys

import numpy as np
import opm_kinematics as opm
import pytest

# The shipped motion: millimetres and degrees, amplitude, frequency, phase, offset.
SINUSOIDS = [(20, 0.2, 265, 2), (18, 0.3, 85, -31), (10, 0.1, 100, -6), (8, 0.2, 120, 4), (7, 0.3, 195, -5)]


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


@pytest.fixture(scope="module")
def followed(manipulator):
    return opm.trajectory(manipulator, "plano-spherical-sinusoids")


def test_the_shipped_motion_is_its_sinusoids(manipulator, followed):
    t = np.arange(1001) / 100
    a, f, phase, offset = np.array(SINUSOIDS, dtype=float).T
    si = np.array([1e-3, 1e-3, *[np.pi / 180] * 3])
    expected = (offset + a * np.sin(2 * np.pi * f * t[:, None] + np.radians(phase))) * si
    np.testing.assert_allclose(followed.times, t, atol=1e-12)
    np.testing.assert_allclose(followed.poses, expected, atol=1e-12)
    np.testing.assert_allclose(np.gradient(followed.poses, t, axis=0)[1:-1], followed.pose_rates[1:-1], atol=2e-3)
    solutions = manipulator.inverse(followed.poses)
    turns = (followed.joints - solutions.joints) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
    np.testing.assert_allclose(followed.imaginary, solutions.imaginary, atol=1e-9)
    motion = manipulator.velocity(followed.poses, followed.pose_rates, followed.pose_accelerations)
    np.testing.assert_allclose(followed.joint_rates, motion.joint_rates, atol=1e-9)
    np.testing.assert_allclose(followed.joint_accelerations, motion.joint_accelerations, atol=1e-7)
    np.testing.assert_allclose(followed.imaginary_rates, motion.imaginary_rates, atol=1e-9)
    np.testing.assert_allclose(followed.imaginary_accelerations, motion.imaginary_accelerations, atol=1e-7)
    np.testing.assert_allclose(followed.condition, manipulator.singularity(followed.poses).condition, rtol=1e-9)
    assert followed.reachable.all() and followed.regular.all() and followed.violations == []
    assert np.abs(np.diff(followed.joints, axis=0)).max() < 0.2  # no jump by a turn
    assert followed.rows == 1001 and "0 violations" in repr(followed)


def test_it_is_what_the_command_line_says(manipulator, tmp_path):
    """A straight line out of the workspace, as a table of poses and as waypoints."""
    times, x = np.linspace(0, 3, 7), np.linspace(0, 0.3, 7)
    rows = "\n".join(f"{t!r},{v!r}" for t, v in zip(times.tolist(), x.tolist(), strict=True))
    path = tmp_path / "out.csv"
    path.write_text(f"t,x\n{rows}\n")
    command = [sys.executable, "-m", "opm_kinematics", "trajectory", "plano-spherical-5dof", "--motion", path]
    told = subprocess.run([*command, "--rate", "50", "--format", "json", "--quiet"], capture_output=True, check=True)
    told = json.loads(told.stdout)
    poses = np.zeros((7, 5))
    poses[:, 0] = x
    for found in (
        opm.trajectory(manipulator, path, rate=50),
        opm.trajectory(manipulator, poses, times=times, rate=50),
    ):
        assert (found.rows, int(found.reachable.sum()), int(found.within_limits.sum())) == (
            told["samples"], told["reached"], told["valid"],
        )  # fmt: skip
        assert 0 < told["reached"] < told["samples"] and told["violations"]
        keys = ("kind", "start", "end", "worst", "amount", "unit", "leg", "joint", "section", "bound", "singularity")
        assert [{k: getattr(v, k) for k in keys if getattr(v, k) is not None} for v in found.violations] == told["violations"]
        for name, ranges in {**told["joints"], **told["imaginary"]}.items():
            values = found[name]
            np.testing.assert_array_equal([np.nanmin(values), np.nanmax(values)], ranges["position"])
        assert np.isnan(found.joints[~found.reachable]).all() and np.isfinite(found.poses).all()
        assert str(found.violations[0].leg) in found.violations[0].message


def test_the_mode_is_that_which_was_asked_for(manipulator):
    found = opm.trajectory(manipulator, "plano-spherical-sinusoids", mode="++ ++ ++ -", rate=20)
    assert found.mode == "++ ++ ++ -" and found.rows == 201
    solutions = manipulator.inverse(found.poses, mode="++ ++ ++ -")
    # A ball's rotation vector may be the other way round, once it is past half a turn.
    for name in (n for n in found.joint_names if not n.startswith("s4.")):
        np.testing.assert_allclose(np.cos(found[name]), np.cos(solutions[name]), atol=1e-9)


def test_wrong_input_is_told(manipulator, tmp_path):
    with pytest.raises(FileNotFoundError):
        opm.trajectory(manipulator, tmp_path / "none.toml")
    (tmp_path / "wrong.csv").write_text("t,w\n0,1\n")
    with pytest.raises(opm.OpmError, match=r"wrong\.csv:1:3: "):
        opm.trajectory(manipulator, tmp_path / "wrong.csv")
    home = np.zeros((4, 5))
    for motion, options, message in [
        (home, {"times": [0, 1, 2]}, "3 times for 4 poses"),
        (home, {"times": [0, 1, 1, 2]}, "waypoint 2: t is 1.0 after 1.0|waypoint 2: t is 1 after 1"),
        (home[:1], {"times": [0]}, "expected at least 2"),
        (home[:2], {"times": [0, 1], "ends": "periodic"}, "expected at least 3"),
        (home, {"times": [0, 1, 2, 3], "ends": "soft"}, "ends: \"soft\", expected one of \"rest\", \"natural\""),
        ("plano-spherical-sinusoids", {"ends": "rest"}, "a motion file says it itself"),
        (home[:, :3], {"times": [0, 1, 2, 3]}, r"motion has shape \(4, 3\), expected \(..., 5\)"),
        (home * np.nan, {"times": [0, 1, 2, 3]}, "^waypoint 0: x is NaN, expected a number$"),
        (home, {}, "expected a path, the name of a shipped motion, or poses with times"),
        ("plano-spherical-sinusoids", {"rate": 0.0}, "expected a rate above zero"),
        ("plano-spherical-sinusoids", {"rate": np.nan}, "expected a rate above zero"),
        ("plano-spherical-sinusoids", {"mode": "+"}, "sign"),
    ]:
        with pytest.raises(opm.OpmError, match=message):
            opm.trajectory(manipulator, motion, **options)
    with pytest.raises(MemoryError):
        opm.trajectory(manipulator, "plano-spherical-sinusoids", rate=1e14)


@pytest.mark.parametrize("motion", ["plano-spherical-sinusoids", "out.csv"])
def test_a_recording_is_that_of_the_command_line(manipulator, tmp_path, motion):
    rows = "\n".join(f"{t},{0.1 * t}" for t in range(4))
    (tmp_path / "out.csv").write_text(f"t,x\n{rows}\n")
    given = tmp_path / motion if motion.endswith("csv") else motion
    command = [sys.executable, "-m", "opm_kinematics", "trajectory", "plano-spherical-5dof", "--motion", given]
    subprocess.run([*command, "--rate", "30", "--quiet", "-o", tmp_path / "a.mcap"], capture_output=True, check=True)
    found = opm.trajectory(manipulator, given, rate=30)
    found.write_mcap(tmp_path / "b.mcap")
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()
    with pytest.raises(opm.OpmError, match=r"none.*No such file"):
        found.write_mcap(tmp_path / "none" / "b.mcap")


def test_waypoints_are_recorded_too(manipulator, tmp_path):
    found = opm.trajectory(manipulator, np.zeros((3, 5)), times=[0, 1, 2])
    found.write_mcap(tmp_path / "a.mcap")
    command = [sys.executable, "-m", "opm_kinematics", "inspect", tmp_path / "a.mcap", "--format", "json"]
    told = subprocess.run(command, capture_output=True, check=True).stdout
    assert b"waypoints" in told and sorted(p.name for p in tmp_path.iterdir()) == ["a.mcap"]


@pytest.mark.parametrize(("ends", "boundary"), [("rest", "clamped"), ("natural", "natural"), ("periodic", "periodic")])
def test_splines_are_those_of_scipy(manipulator, ends, boundary):
    interpolate = pytest.importorskip("scipy.interpolate")
    times = np.array([0, 0.4, 1.0, 1.3, 2.0])
    poses = np.random.default_rng(4).uniform(-0.02, 0.02, (5, 5))
    poses[-1] = poses[0]
    found = opm.trajectory(manipulator, poses, times=times, ends=ends, rate=200)
    spline = interpolate.CubicSpline(times, poses, bc_type=boundary)
    for order, values in enumerate([found.poses, found.pose_rates, found.pose_accelerations]):
        np.testing.assert_allclose(values, spline(found.times, order), atol=1e-12)


def test_a_table_is_that_of_the_command_line(manipulator, tmp_path):
    found = opm.trajectory(manipulator, np.array([[0.0] * 5, [0, -0.15, 0, 0.1, 0]]), times=[0, 1], rate=40)
    (tmp_path / "down.csv").write_text("t,y,xi\n0,0,0\n1,-0.15,0.1\n")
    command = [sys.executable, "-m", "opm_kinematics", "trajectory", "plano-spherical-5dof", "--rate", "40", "--quiet"]
    command += ["--motion", tmp_path / "down.csv"]
    for units in ("si", "file"):
        for ending in ("csv", "npy"):
            told = tmp_path / f"told.{ending}"
            flags = ["--rates", "--accelerations", "--units", units]
            subprocess.run([*command, *flags, "-o", told], check=True, capture_output=True)
            found.write_table(tmp_path / f"a.{ending}", rates=True, accelerations=True, units=units)
            assert (tmp_path / f"a.{ending}").read_bytes() == told.read_bytes()
    mm = np.load(tmp_path / "a.npy")
    found.write_table(tmp_path / "si.npy", rates=True)
    si = np.load(tmp_path / "si.npy")
    np.testing.assert_allclose(mm["dd.S1 [mm/s2]"], 1e3 * found.joint_accelerations[:, found.joint_names.index("S1")])
    np.testing.assert_allclose(mm["xi [deg]"], np.degrees(found.poses[:, 3]))
    assert np.isnan(si["S1"]).sum() == (~found.reachable).sum() > 5
    np.testing.assert_array_equal(si["t"], found.times)
    for name in found.joint_names:
        np.testing.assert_array_equal(si[name], found[name])
    np.testing.assert_array_equal(si["d.theta11"], found.imaginary_rates[:, 0])
    assert "dd.S1" not in si.dtype.names
    with pytest.raises(opm.OpmError, match=r"a\.txt, expected a name that ends in \.csv or \.npy"):
        found.write_table(tmp_path / "a.txt")
    with pytest.raises(opm.OpmError, match='units: "mm"'):
        found.write_table(tmp_path / "a.csv", units="mm")


def test_actuated_joints_lead_back_to_the_motion(manipulator, followed):
    joints = followed.joints[:, manipulator.actuated].copy()
    joints[500] = 9
    poses = manipulator.forward_track(joints, near=followed.poses[0])
    assert np.isnan(poses[500]).all()
    # Where xi is zero, only the sum of the other two angles is told.
    rest = (np.arange(len(joints)) != 500) & (np.abs(followed.poses[:, 3]) > 1e-9)
    assert rest.sum() >= len(joints) - 5
    np.testing.assert_allclose(poses[rest], followed.poses[rest], atol=1e-9)
    # A gap in the table is one in the poses.
    joints[3, 1] = np.nan
    gap = manipulator.forward_track(joints, near=followed.poses[0])
    assert np.isnan(gap[3]).all() and np.isfinite(gap[4]).all()


def test_a_joint_above_its_rate_is_a_violation():
    """A slider of the helical manipulator moves as x does: its speed is 50 pi mm/s at most."""
    slow = opm.examples.load("translational-helical-3dof").with_parameters({"leg3.max_rate.S": 0.15})
    times = np.linspace(0, 1, 201)
    poses = np.zeros((201, 3))
    poses[:, 0] = 0.05 * np.sin(np.pi * times)
    found = opm.trajectory(slow, poses, times=times, rate=500, ends="natural")
    assert found.within_limits.all()
    assert [(v.kind, v.unit, v.leg, v.joint) for v in found.violations] == [("rate", "m/s", "leg3", "S3")] * 2
    assert found.violations[0].amount == pytest.approx(0.05 * np.pi - 0.15, rel=1e-3)
    assert "S3 above its max_rate" in found.violations[0].message


def test_the_fastest_timing_keeps_the_limits_and_the_poses(tmp_path):
    """Along x, the slider S3 goes the whole way, which takes the time of the trapezoid of its speed."""
    limits = {"max_rate.S": 0.4, "max_acceleration.S": 2.0}
    fast = opm.examples.load("translational-helical-3dof").with_parameters(limits)
    poses, times = [[-0.1, 0, 0], [0.1, 0, 0]], [0, 5]
    found = opm.trajectory(fast, poses, times=times, rate=1000, time_optimal=True)
    assert found.times[-1] == pytest.approx(0.2 / 0.4 + 0.4 / 2.0, rel=5e-4)
    assert found.violations == [] and np.abs(found["S3"][[0, -1]] - found["S3"].mean()).min() > 0.09
    actuated = [found.joint_names.index(f"S{i}") for i in (1, 2, 3)]
    assert np.abs(found.joint_rates[:, actuated]).max() <= 0.4 * (1 + 1e-9)
    assert np.abs(found.joint_accelerations[:, actuated]).max() <= 2 * (1 + 1e-9)
    # The trapezoid does not depend on the times, which may be left out.
    untimed = opm.trajectory(fast, poses, rate=1000, time_optimal=True)
    assert untimed.times[-1] == pytest.approx(found.times[-1], rel=5e-4)
    with pytest.raises(opm.OpmError, match="motion is .*, expected a path, the name of a shipped motion, or poses with times"):
        opm.trajectory(fast, poses)
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    one, other = tmp_path / "one.csv", tmp_path / "other.csv"
    found.write_table(one), again.write_table(other)
    assert one.read_bytes() == other.read_bytes()
    with pytest.raises(opm.OpmError, match="no max_acceleration of S1, S2, S3"):
        opm.trajectory(opm.examples.load("translational-helical-3dof"), poses, times=times, time_optimal=True)


def test_the_tool_keeps_caps_of_its_own(tmp_path):
    """A hexapod without limits of its joints, by differences of its poses; caps are pickled."""
    hexapod = opm.examples.load("stewart")
    home = np.array(hexapod.home)
    poses = home + np.array([[0, 0, 0, 0, 0, 0], [0.05, 0.02, 0, 0.1, 0, 0], [0.05, 0, 0.02, 0, 0.1, 0]])
    caps = {"tool_speed": 0.2, "tool_acceleration": 1.0, "tool_angular_speed": 0.5, "tool_angular_acceleration": 3.0}
    found = opm.trajectory(hexapod, poses, rate=2000, time_optimal=True, **caps)
    names = [coordinate.name for coordinate in hexapod.task_coordinates]
    place = found.poses[:, [names.index(name) for name in "xyz"]]
    first, second = np.diff(place, axis=0) * 2000, np.diff(place, n=2, axis=0) * 2000**2
    assert 0.9 < np.linalg.norm(second[:-2], axis=1).max() < 1.0 + 1e-3
    assert np.linalg.norm(first[:-1], axis=1).max() < 0.2 * (1 + 1e-6)
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    one, other = tmp_path / "one.csv", tmp_path / "other.csv"
    found.write_table(one), again.write_table(other)
    assert one.read_bytes() == other.read_bytes()
    with pytest.raises(opm.OpmError, match="largest speed of the tool is -1, expected a number above 0"):
        opm.trajectory(hexapod, poses, time_optimal=True, tool_speed=-1.0)
    with pytest.raises(opm.OpmError, match="caps of the fastest timing, expected time_optimal=True"):
        opm.trajectory(hexapod, poses, times=[0, 1, 2], tool_speed=1.0)
    with pytest.raises(opm.OpmError, match="caps of the tool's acceleration, and of its angular"):
        opm.trajectory(hexapod, poses, time_optimal=True, tool_acceleration=1.0)


PLAIN = "t,x,xi\n0,0,0\n0.5,0.01,0.1\n"


def test_tables_of_other_programs_are_read_by_name_and_from_their_first_time(manipulator, tmp_path):
    def follow(text, **options):
        path = tmp_path / "motion.csv"
        path.write_text(text)
        return opm.trajectory(manipulator, path, **options)

    plain = follow(PLAIN)
    other = "stamp,pos_x (mm),quality,xi\n1700000000.25,0,9,0\n1700000000.75,10,8,0.1\n"
    with pytest.raises(opm.OpmError, match=r'motion.csv:1:1: no coordinate "stamp".*columns=\{"t": "stamp", "x": "pos_x"'):
        follow(other)
    names = {"t": "stamp", "x": "pos_x", "xi": "xi"}
    with pytest.raises(opm.OpmError, match="motion.csv:2:1: .*since 1970.*relative_time=True"):
        follow(other, columns=names)
    named = follow(other, columns=names, relative_time=True)
    np.testing.assert_array_equal(named.times, plain.times)
    np.testing.assert_allclose(named.joints, plain.joints, atol=1e-12)
    again = pickle.loads(pickle.dumps(named))
    np.testing.assert_allclose(again.joints, plain.joints, atol=1e-12)
    with pytest.raises(opm.OpmError, match='no column "z" for x'):
        follow(other, columns={"t": "stamp", "x": "z"})
    with pytest.raises(opm.OpmError, match="columns: .*CSV file"):
        opm.trajectory(manipulator, "plano-spherical-sinusoids", columns=names)
    with pytest.raises(opm.OpmError, match="relative_time: .*CSV file"):
        opm.trajectory(manipulator, np.zeros((2, 5)), times=[0, 1], relative_time=True)
    with pytest.raises(opm.OpmError, match="motion.csv:1:1: the columns are separated by semicolons"):
        follow("t;x\n0;0\n1;0,01\n")


def test_a_motion_in_millimetres_is_doubted(manipulator, tmp_path):
    path = tmp_path / "motion.csv"
    path.write_text("t,x\n0,0\n1,30\n")
    with pytest.warns(UserWarning, match=r"motion.csv:3: x has no unit and was read as 30 m.*head the column x \[mm\]"):
        opm.trajectory(manipulator, path)
