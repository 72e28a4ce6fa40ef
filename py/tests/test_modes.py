"""All working modes at once, against each one alone and against the command line."""

import json
import subprocess
import sys

import numpy as np
import opm_kinematics as opm
import pytest
from shipped import LINKAGES


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


@pytest.fixture(scope="module")
def poses():
    return np.random.default_rng(5).uniform(-1, 1, (2000, 5)) * [0.15, 0.15, 1.0, 1.0, 1.0]


def test_all_modes_are_each_mode(manipulator, poses):
    every = manipulator.inverse(poses, mode="all")
    assert every.modes == manipulator.modes and len(set(every.modes)) == 128 and every.mode == "all"
    assert every.joints.shape == (2000, 128, len(manipulator.joint_names)) and every.imaginary.shape == (2000, 128, 3)
    assert every.reachable.shape == every.within_limits.shape == (2000, 128) and every.rows == 2000
    for number in range(0, 128, 9):
        one = manipulator.inverse(poses, mode=every.modes[number])
        assert one.modes == [one.mode] == [every.modes[number]]
        np.testing.assert_array_equal(every.reachable[:, number], one.reachable)
        np.testing.assert_array_equal(every.within_limits[:, number], one.within_limits)
        # Out of reach of one leg is out of reach.
        np.testing.assert_allclose(every.joints[:, number], one.joints, atol=1e-13)
        np.testing.assert_allclose(every.imaginary[:, number], one.imaginary, atol=1e-13)
    np.testing.assert_array_equal(manipulator.inverse(poses, mode="all", threads=1).joints, every.joints)


def test_joints_by_name_are_views(manipulator, poses):
    every, one = manipulator.inverse(poses, mode="all"), manipulator.inverse(poses)
    assert every["S2"].shape == (2000, 128) and np.shares_memory(every["S2"], every.joints)
    column = one.joint_names.index("S2")
    np.testing.assert_array_equal(one["S2"], one.joints[:, column])
    np.testing.assert_array_equal(one["theta12"], one.imaginary[:, 1])
    assert one.units["S2"] == "m" and one.units["theta12"] == "rad"
    with pytest.raises(KeyError, match="S9: no such joint among S1"):
        one["S9"]


def test_a_mechanism_without_choices_has_one_mode():
    manipulator = opm.examples.load("translational-helical-3dof")
    every = manipulator.inverse([manipulator.home] * 3, mode="all")
    assert every.modes == [""] and every.joints.shape == (3, 1, len(manipulator.joint_names))
    assert manipulator.inverse(np.zeros((0, 3)), mode="all").joints.shape == (0, 1, len(manipulator.joint_names))


def test_it_is_what_the_command_line_says(manipulator):
    pose = "x=0.03,y=-0.02,zeta=0.2,xi=0.4,psi=-0.1"
    command = [sys.executable, "-m", "opm_kinematics", "ik", "plano-spherical-5dof", "--pose", pose, "--all-modes"]
    told = json.loads(subprocess.run([*command, "--format", "json"], capture_output=True, check=True).stdout)
    every = manipulator.inverse([list(told["pose"].values())], mode="all")
    reached = np.flatnonzero(every.reachable[0])
    assert [solution["mode"] for solution in told["solutions"]] == [every.modes[i] for i in reached]
    for number, solution in zip(reached, told["solutions"], strict=True):
        assert dict(zip(every.joint_names, every.joints[0, number], strict=True)) == solution["joints"]
        assert dict(zip(every.imaginary_names, every.imaginary[0, number], strict=True)) == solution["imaginary"]
        assert every.within_limits[0, number] == solution["within_limits"]


@pytest.mark.parametrize("name", opm.examples.names())
def test_a_decomposition_is_what_the_command_line_says(name):
    command = [sys.executable, "-m", "opm_kinematics", "decompose", name, "--format", "json"]
    told = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    try:
        found = opm.examples.load(name).decomposition
    except opm.OpmError:
        assert name in LINKAGES
        return
    assert (found.name, found.rank, found.mobility) == (told["name"], told["lambda"], told["mobility"])
    assert found.imaginary_joints == told["imaginary_joints"]
    assert found.first_section_motions == told["first_section_motions"]
    assert found.lower == told["lower"]["subspace"]
    assert found.upper == (told["upper"] and told["upper"]["subspace"])
    for leg, given in zip(found.legs, told["legs"], strict=True):
        given.pop("kernels", None)
        assert {key: getattr(leg, key) for key in ("name", "lower", "upper", "imaginary", "solved")} == given
    common = found.intersection
    if told["intersection"] is None:
        assert common is None
        return
    assert {"kind": common.kind, "pitch": common.pitch} == {k: told["intersection"][k] for k in ("kind", "pitch")}
    for name in ("axis", "point"):
        given = told["intersection"][name]
        assert getattr(common, name) == (None if given is None else tuple(given))


def test_no_memory_is_told(manipulator):
    with pytest.raises(MemoryError, match="no memory for|Unable to allocate"):
        manipulator.inverse(np.broadcast_to(np.zeros(5), (1 << 27, 5)), mode="all")


def test_what_notebooks_show(manipulator, poses):
    html = manipulator._repr_html_()
    assert "planar + spherical" in html and "<td>theta11</td>" in html and "++ ++ ++ +" in html
    assert "<td>phi14 phi24</td>" in manipulator.decomposition._repr_html_()
    solutions = manipulator.inverse(poses)
    assert repr(solutions).startswith("<Solutions of 2000 poses in mode \"++ ++ ++ +\": ")
    assert solutions._repr_html_().count("<tr>") == 12 and "<th>S1</th>" in solutions._repr_html_()
    assert manipulator.inverse(poses[:1], mode="all")._repr_html_().count("<tr>") == 12
    assert "out of reach" in manipulator.inverse([[1.0, 0, 0, 0, 0]])._repr_html_()
    swept = opm.sweep(manipulator, x=(-0.1, 0.1, 5))
    assert "of 5 poses reachable" in swept._repr_html_() and "theta11" in swept._repr_html_()
    assert "<td>" in opm.sweep(manipulator, x=9.0)._repr_html_()
    measured = opm.measure(manipulator, over={"x": (-0.3, 0.3), "y": (-0.25, 0.25)}, tolerance=0.05)
    html = measured._repr_html_()
    # A head and four amounts, a head and five coordinates.
    assert html.count("<tr>") == 11 and f"{measured.boxes} boxes, until tolerance" in html
    assert f"<tr><td>upper</td><td>{measured.upper:.6g}</td><td>m^2</td><td>{100 * measured.upper / 0.3:.4f}%</td></tr>" in html
    assert "<tr><td>y</td><td>-0.25</td><td>0.25</td></tr>" in html
    motion = manipulator.velocity(poses, np.ones((1, 5)))
    assert repr(motion) == f"<Motion at 2000 poses: {motion.reachable.sum()} reachable, {motion.regular.sum()} regular>"


def test_objects_are_immutable(manipulator):
    for thing, name in [(manipulator, "name"), (manipulator.decomposition, "lower"), (manipulator.inverse([manipulator.home]), "joints")]:
        with pytest.raises(AttributeError):
            setattr(thing, name, None)


def test_notebooks_show_singularities_and_motions(manipulator):
    poses = np.zeros((11, 5))
    poses[:, 3], poses[10, 0] = np.linspace(0.2, 0.9, 11), 9.0
    measured = manipulator.singularity(poses)
    html = measured._repr_html_()
    # A head, five rows from either end, and dots between.
    assert html.count("<tr>") == 12 and html.count("<th>") == 8 and "11 poses: 10 reachable" in html
    assert f"<td>{measured.lower_serial[9]:.6g}</td>" in html and f"<td>{measured.condition[0]:.6g}</td>" in html
    assert "<tr><td>10</td>" + 7 * "<td>–</td>" + "</tr>" in html
    followed = opm.trajectory(manipulator, [[0, 0, 0, 0.2, 0], [0.5, 0, 0, 0.2, 0], [0, 0, 0, 0.2, 0]], times=[0, 1, 2])
    html = followed._repr_html_()
    assert html.count("<tr>") == 1 + len(followed.joint_names) + len(followed.imaginary_names)
    low, high = np.nanmin(followed["S1"]), np.nanmax(followed["S1"])
    assert f"<td>S1</td><td>m</td><td>{low:.6g}</td><td>{high:.6g}</td>" in html
    assert followed.violations and html.count("<li>") == len(followed.violations)
    fine = opm.trajectory(manipulator, np.array([[0, 0, 0, 0.2, 0]] * 3), times=[0, 1, 2])._repr_html_()
    assert "nothing that it cannot follow" in fine and "<li>" not in fine
