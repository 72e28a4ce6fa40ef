"""Manipulators from Python, held against formulas written here in NumPy and against themselves."""

import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import opm_kinematics as opm
import pytest

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
    assert [manipulator.joints[i] for i in manipulator.actuated] == ["S1", "S2", "S3", "phi14", "phi24"]
    assert manipulator.imaginary == ["theta11", "theta12", "theta13"]
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
    assert np.abs(difference).max() < 1e-7  # arccos near the rim
    assert np.median(np.abs(difference)) < 1e-14
    assert np.isnan(solutions.joints[~inside]).all()


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
    # The elbow bends the other way; angles are reported within half a turn of home.
    assert np.cos(plus.joints[0, column]) == pytest.approx(np.cos(minus.joints[0, column]))
    assert np.sin(plus.joints[0, column]) == pytest.approx(-np.sin(minus.joints[0, column]))


def test_wrong_input_is_told(manipulator, tmp_path):
    with pytest.raises(opm.OpmError, match="3 columns of poses, expected 5: x, y, zeta, xi, psi"):
        manipulator.inverse(np.zeros((2, 3)))
    with pytest.raises(opm.OpmError, match="xi is NaN"):
        manipulator.inverse([[0, 0, 0, np.nan, 0]])
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
            assert "bennett" in name and str(error)
            continue
        home = manipulator.inverse([manipulator.home])
        assert home.reachable.all() and len(home) == 1


def reachable_in_another_process(job):
    manipulator, poses = job
    return manipulator.inverse(poses).reachable


@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_a_manipulator_crosses_processes(manipulator, poses, start):
    expected = manipulator.inverse(poses)  # with threads, which a forked process does not have
    assert pickle.loads(pickle.dumps(manipulator)).text == manipulator.text
    with ProcessPoolExecutor(2, mp_context=get_context(start)) as pool:
        parts = pool.map(reachable_in_another_process, [(manipulator, part) for part in np.array_split(poses, 2)])
        np.testing.assert_array_equal(np.concatenate(list(parts)), expected.reachable)
