"""Manipulators from arrays of screws, held against the mechanism files that say the same."""

import contextlib
import pickle
import re
import warnings

import numpy as np
import opm_kinematics as opm
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import LINKAGES

# The 3-DoF manipulator of Selvi's section 3.2: two PPR legs and a PPH, one common direction of the R and H axes.
ALPHA, BETA = np.radians([210.0, 330.0, 90.0]), np.radians([45.0, 285.0, 165.0])
PITCH = 0.02


def hat(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def adjoint(rotation, shift):
    """What a displacement of the whole mechanism does to twists (omega; v)."""
    return np.block([[rotation, np.zeros((3, 3))], [hat(shift) @ rotation, rotation]])


def exponential(screw, amount):
    """The displacement along a screw, by the series of the matrix exponential."""
    x = np.zeros((4, 4))
    x[:3, :3], x[:3, 3] = hat(screw[:3]), screw[3:]
    x *= amount / 1024
    g = np.eye(4) + x + x @ x / 2 + x @ x @ x / 6 + x @ x @ x @ x / 24
    for _ in range(10):
        g = g @ g
    return g


def helical():
    """Legs by the geometry: a slider perpendicular to alpha, a passive one along it, and the joint along alpha + beta."""
    legs = []
    for number, (alpha, beta) in enumerate(zip(ALPHA, BETA, strict=True)):
        along, across = np.array([np.cos(alpha), np.sin(alpha), 0]), np.array([-np.sin(alpha), np.cos(alpha), 0])
        axis = np.array([np.cos(alpha + beta), np.sin(alpha + beta), 0])
        pitch = PITCH if number == 0 else 0.0
        legs.append([[0, 0, 0, *across], [0, 0, 0, *along], [*axis, *(pitch * axis)]])
    return np.array(legs)


ROWS = helical().tolist()
FLAGS = [[True, False, False]] * 3


def rotations():
    angles = st.floats(-3, 3)
    return st.tuples(angles, angles, angles).map(lambda w: exponential(np.array([*w, 0, 0, 0]), 1.0)[:3, :3])


def test_the_helical_manipulator_from_its_geometry():
    m = opm.Manipulator.from_screws(helical(), actuated=FLAGS, name="2-PPR + PPH")
    d = m.decomposition
    assert (d.lower, d.upper, d.intersection.kind) == ("translational plane", "cylindrical", "translation")
    assert (d.rank, d.mobility, d.imaginary_joints, d.first_section_motions) == (3, 3, 1, 2)
    assert m.joint_names == [f"q{i}_{j}" for i in (1, 2, 3) for j in (1, 2, 3)] and m.name == "2-PPR + PPH"
    same = opm.examples.load("translational-helical-3dof")
    x, y, phi = np.random.default_rng(6).uniform(-1, 1, (3, 200)) * [[0.1], [0.1], [3]]
    poses = np.stack([x, y, phi], axis=1)
    # Both count from home; home of the shipped one is elsewhere.
    moved = [s.inverse(poses).joints[:, s.actuated] - s.inverse([s.home]).joints[:, s.actuated] for s in (m, same)]
    np.testing.assert_allclose(np.abs(moved[0]), np.abs(moved[1]), atol=1e-12)


# A ball's three coordinates are one rotation vector: legs with one are left to the Rust tests.
ALL_BALLS = ("stewart", "hexa", "tricept", "ankle")


@pytest.mark.parametrize("name", [n for n in opm.examples.names() if n not in (*LINKAGES, *ALL_BALLS)])
def test_closure_of_every_leg_by_its_own_exponentials(name):
    """The legs' products of exponentials, written here, agree on where the platform is."""
    m = opm.examples.load(name)
    rng = np.random.default_rng(7)
    scale = [0.02 if c.unit == "m" else 0.1 for c in m.task_coordinates]
    poses = np.array(m.home) + rng.uniform(-1, 1, (40, len(scale))) * scale
    found, home = m.inverse(poses), m.inverse([m.home]).joints[0]
    rows = np.cumsum([0, *(len(screws) for screws in m.screws.values())])
    balls = {n[:-2] for n in m.joint_names if n.endswith(".z")}
    legs = [
        (screws, slice(a, b))
        for screws, a, b in zip(m.screws.values(), rows, rows[1:], strict=False)
        if not any(n[:-2] in balls for n in m.joint_names[a:b])
    ]
    assert found.reachable.mean() > 0.5 and len(legs) >= 2
    for q in found.joints[found.reachable]:
        placed = []
        for screws, part in legs:
            g = np.eye(4)
            for screw, amount in zip(screws, q[part] - home[part], strict=True):
                g = g @ exponential(screw, amount)
            placed.append(g)
        for g in placed[1:]:
            np.testing.assert_allclose(g, placed[0], atol=1e-9)


@settings(max_examples=25, deadline=None)
@given(rotation=rotations(), shift=st.tuples(*[st.floats(-2, 2)] * 3), lengths=st.lists(st.floats(0.1, 10), min_size=9, max_size=9))
def test_a_mechanism_moved_as_a_whole_is_the_same(rotation, shift, lengths):
    """Neither where it stands nor how long its screws are matters to what it is, and joints see no difference."""
    plain = opm.Manipulator.from_screws(helical(), actuated=FLAGS)
    screws = helical() @ adjoint(rotation, np.array(shift)).T * np.reshape(lengths, (3, 3, 1))
    moved = opm.Manipulator.from_screws(screws, actuated=FLAGS, platform=shift)
    for attribute in ("rank", "mobility", "lower", "upper", "imaginary_joints"):
        assert getattr(moved.decomposition, attribute) == getattr(plain.decomposition, attribute)
    # The frames of the two are not the same, so that poses differ: joints move a platform of both alike.
    moved_home = moved.forward([[0.0] * 3])[0][0].pose
    np.testing.assert_allclose(moved_home, moved.home, atol=1e-7)
    singular = [np.linalg.svd(m.jacobian([m.home])[0], compute_uv=False) for m in (plain, moved)]
    np.testing.assert_allclose(singular[1], singular[0], rtol=1e-6)


def test_the_screws_of_a_mechanism_make_it_again():
    m = opm.examples.load("schoenflies-4dof")
    singles = [n for n in m.joint_names if n.rsplit(".", 1)[-1] not in ("x", "y", "z", "1", "2", "angle", "slide")]
    if len(singles) != len(m.joint_names):
        pytest.skip("a joint of several freedoms")
    ends = np.cumsum([0, *(len(s) for s in m.screws.values())])
    parts = [slice(a, b) for a, b in zip(ends, ends[1:], strict=False)]
    flags = np.isin(np.arange(len(m.joint_names)), m.actuated)
    again = opm.Manipulator.from_screws(
        m.screws, [flags[p] for p in parts], joints=[m.joint_names[p] for p in parts], home=[m.inverse([m.home]).joints[0][p] for p in parts]
    )
    assert again.joint_names == m.joint_names and again.actuated == m.actuated and list(again.screws) == list(m.screws)
    for mine, theirs in zip(again.screws.values(), m.screws.values(), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e-14)
    assert pickle.loads(pickle.dumps(again)).text == again.text
    assert opm.Manipulator.parse(again.text).joint_names == again.joint_names


def parts_of(m):
    ends = np.cumsum([0, *(len(s) for s in m.screws.values())])
    flags = np.isin(np.arange(len(m.joint_names)), m.actuated)
    return [flags[a:b] for a, b in zip(ends, ends[1:], strict=False)]


def rounded(screws, how):
    """Screws of no particular length, in single precision or with six digits."""
    scaled = {leg: 0.7 * rows for leg, rows in screws.items()}
    if how == "float32":
        return {leg: rows.astype(np.float32) for leg, rows in scaled.items()}
    return {leg: [[float(f"{c:.5e}") for c in row] for row in rows] for leg, rows in scaled.items()}


@pytest.mark.parametrize("how", ["float32", "six digits"])
@pytest.mark.parametrize("name", ["planar-3rrr", "agile-eye", "schoenflies-4dof", "plano-spherical-5dof-joints"])
def test_rounded_screws_are_no_helical_joints(name, how):
    m = opm.examples.load(name)
    again = opm.Manipulator.from_screws(rounded(m.screws, how), parts_of(m))
    assert again.text.count("helical") == m.text.count('type = "helical"')
    for mine, theirs in zip(again.screws.values(), m.screws.values(), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=2e-5)
    assert again.check(samples=10).holds
    snapped = again
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        snapped = opm.Manipulator.from_screws(rounded(m.screws, how), parts_of(m), tolerance=1e-4)
    assert all("snapped" in str(warning.message) and "leg" in str(warning.message) for warning in told)
    assert snapped.check(samples=10).holds


def test_screws_that_miss_tell_by_how_much():
    m = opm.examples.load("planar-3rrr")
    screws = {leg: rows.copy() for leg, rows in m.screws.items()}
    first = next(iter(screws))
    # One of the parallel axes is tilted by a milliradian.
    turn = exponential(np.array([1e-3, 0, 0, 0, 0, 0]), 1.0)
    screws[first][1] = adjoint(turn[:3, :3], np.zeros(3)) @ screws[first][1]
    with pytest.raises(opm.OpmError, match="tolerance of .* m: .*0.0010 rad off"):
        opm.Manipulator.from_screws(screws, parts_of(m))
    with pytest.warns(UserWarning, match="snapped"):
        snapped = opm.Manipulator.from_screws(screws, parts_of(m), tolerance=1e-2)
    assert snapped.check(samples=10).holds
    with pytest.raises(opm.OpmError, match="tolerance is -1.0, expected a positive length"):
        opm.Manipulator.from_screws(screws, parts_of(m), tolerance=-1)


def test_the_least_change_of_joints_that_do_not_close():
    """Two chains from spools that are 2 m apart, which are too short by half a metre in sum."""
    rows = [[0, 0, 1, 0, 1, 0], [0, 0, 0, 0.8, -0.6, 0], [0, 0, 1, 0, 0, 0]], [[0, 0, 1, 0, -1, 0], [0, 0, 0, -0.8, -0.6, 0]]
    # Spools at (-1, 0.75) and (1, 0.75): the rows above have their axes there.
    rows[0][0][3:], rows[1][0][3:] = [0.75, 1, 0], [0.75, -1, 0]
    m = opm.Manipulator.from_screws(
        list(rows), [[False, True, False], [False, True]], home=[[0, 1.25, 0], [0, 1.25]], joints=[["a", "l", "b"], ["c", "r"]]
    )
    change = m.least_change({"l": 0.7, "r": 0.8})
    np.testing.assert_allclose(change["together"], [0.25, 0.25], atol=1e-8)
    np.testing.assert_allclose(change["alone"], [0.5, 0.5], atol=1e-8)
    assert m.least_change([1.2, 1.3]) is None
    assert m.forward([0.7, 0.8]).counts == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"legs": np.zeros((3, 3, 5))}, r"leg1 has shape \(3, 5\), expected an \(n, 6\) array of screws"),
        ({"legs": [ROWS[0], "no", ROWS[2]]}, r"leg2 is 'no', expected an \(n, 6\) array"),
        ({"legs": {"a": ROWS[0], "b": [ROWS[1][0], [0] * 6, ROWS[1][2]], "c": ROWS[2]}}, "b, joint 2: all six components are zero"),
        ({"legs": [ROWS[0], ROWS[1], [*ROWS[2][:2], [0, 0, np.nan, 0, 0, 1]]]}, "leg3, joint 3: NaN is among its components"),
        ({"legs": ROWS[:1], "actuated": FLAGS[:1]}, "found 1 .*leg.*, expected at least 2 legs"),
        ({"actuated": FLAGS[:2]}, "actuated: 2 sequences, expected 3, one for each leg"),
        ({"actuated": [[True], *FLAGS[1:]]}, "actuated: 1 of leg1, expected 3, one for each joint"),
        ({"actuated": [[0.5, 0, 0], *FLAGS[1:]]}, "actuated: .* of leg1, expected 3 bools"),
        ({"actuated": [[False] * 3] * 3}, "actuated"),
        ({"home": [[0, 0, np.inf], [0] * 3, [0] * 3]}, "leg1, joint 3: home is inf"),
        ({"limits": [[None, (0, np.nan), None], [None] * 3, [None] * 3]}, "leg1, joint 2: limits are 0 and NaN"),
        ({"limits": [[(1, 0), None, None], [None] * 3, [None] * 3]}, "leg1, joint 1: .*reversed"),
        ({"limits": [[(1, 2), None, None], [None] * 3, [None] * 3]}, "leg1, joint 1: .*exclude home"),
        ({"joints": [["a", "b", "a"], ["c", "d", "e"], ["f", "g", "h"]]}, "leg1, joint 3: .*a"),
        ({"joints": [["x", "b", "a"], ["c", "d", "e"], ["f", "g", "h"]]}, "leg1, joint 1: .*x"),
        ({"joints": [["a\nb", "b", "a"], ["c", "d", "e"], ["f", "g", "h"]]}, "leg1, joint 1: .*name"),
        ({"name": "a,b"}, "mechanism: .*a,b"),
        ({"platform": (0, 0, np.nan)}, "platform has NaN in it"),
    ],
)
def test_wrong_input_is_told(change, message):
    with pytest.raises(opm.OpmError, match=message):
        opm.Manipulator.from_screws(**{"legs": ROWS, "actuated": FLAGS, **change})


def test_limits_and_home_are_kept():
    limits = [[(-0.1003, 0.3007), (-np.inf, np.inf), None]] * 3
    m = opm.Manipulator.from_screws(ROWS, FLAGS, home=[[0.2, 0.0, 1.0]] * 3, limits=limits)
    assert m.inverse([m.home]).joints[0].tolist() == [0.2, 0.0, 1.0] * 3
    swept = opm.sweep(m, x=(-0.5, 0.5, 101))
    inside = m.inverse(np.stack([np.linspace(-0.5, 0.5, 101), np.zeros(101), np.zeros(101)], axis=1)).joints[:, m.actuated]
    np.testing.assert_array_equal(swept.mask().ravel(), ((inside >= -0.1003) & (inside <= 0.3007)).all(axis=1))
    assert 0 < swept.count < 101


def exchanged(screws):
    return {name: np.roll(rows, 3, axis=1) for name, rows in screws.items()}


@pytest.mark.parametrize("name", ["plano-spherical-5dof", "planar-3rpr", "delta"])
def test_halves_that_look_exchanged_are_told(name):
    m = opm.examples.load(name)
    flags = [[True] * len(rows) for rows in m.screws.values()]
    hint = re.escape("the rows of legs look like (v; omega), expected (omega; v)")
    with warnings.catch_warnings(record=True) as told, contextlib.suppress(opm.OpmError):
        warnings.simplefilter("always")
        opm.Manipulator.from_screws(m.screws, flags)
    assert not any(re.search(hint, str(one.message)) for one in told)
    found = []
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            opm.Manipulator.from_screws(exchanged(m.screws), flags)
        except opm.OpmError as error:
            found.append(str(error))
    assert any(re.search(hint, text) for text in [*found, *(str(one.message) for one in told)])
    # Of any length, nothing can be told.
    with pytest.raises(opm.OpmError) as error:
        opm.Manipulator.from_screws({leg: 2 * rows for leg, rows in exchanged(m.screws).items()}, [])
    assert "omega" not in str(error.value)


def test_legs_are_one_array():
    m = opm.examples.load("planar-3rpr")
    legs = np.array(list(m.screws.values()))
    again = opm.Manipulator.from_screws(legs, np.array([[j.actuated for j in leg] for leg in m.legs.values()]))
    assert legs.shape == (3, 3, 6) and list(again.screws) == ["leg1", "leg2", "leg3"]
