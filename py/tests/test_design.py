"""Design by decomposition, and what it rests on: sections alone and measures, against inverse kinematics and geometry."""

import numpy as np
import opm_kinematics as opm
import pytest
from opm_kinematics import design

TILT = np.radians(20)
ORIENTATIONS = {name: (-TILT, TILT, 3) for name in ("zeta", "xi", "psi")}
PLACES = {"x": (-0.1, 0.1, 9), "y": (-0.1, 0.1, 9)}


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


def test_the_upper_section_alone_says_what_it_asks_of_the_imaginary_joints(manipulator):
    """The ranges of +-20 degrees that were computed from Eq. 3 (errata)."""
    swept = opm.sweep(manipulator, kind="upper", **{name: (-TILT, TILT, 41) for name in ("zeta", "xi", "psi")})
    assert swept.kind == "upper" and swept.fraction == 1.0 and list(swept.axes) == ["zeta", "xi", "psi"]
    expected = {"theta11": (-0.710, 0.914), "theta12": (1.338, 3.090), "theta13": (3.614, 5.247)}
    for name, ends in expected.items():
        np.testing.assert_allclose(swept.imaginary_range[name], ends, atol=2e-3)


def test_the_lower_section_alone_is_the_planar_legs(manipulator):
    """|Q . e(alpha)| <= a1 and |S| <= 0.3 of three sliders, and the arm (Eqs. 10-16)."""
    thetas = {"theta11": (-0.7, 0.9, 5), "theta12": (1.3, 3.1, 4), "theta13": 4.3}
    swept = opm.sweep(manipulator, kind="lower", **PLACES, **thetas)
    x, y, *theta = np.meshgrid(*swept.axes.values(), indexing="ij")
    reach = np.hypot(x, y - 0.075)
    inside = reach <= 0.2
    for number, alpha in enumerate(np.radians([30.0, 150.0, 270.0])):
        q = np.stack([x + 0.06 * np.cos(theta[number]), y + 0.06 * np.sin(theta[number])])
        along = q[0] * np.cos(alpha) + q[1] * np.sin(alpha) - 0.12
        across = q[1] * np.cos(alpha) - q[0] * np.sin(alpha)
        with np.errstate(invalid="ignore"):
            inside &= np.abs(across + np.sqrt(0.2**2 - along**2)) <= 0.3
    assert 0.2 < inside.mean() < 0.95
    np.testing.assert_array_equal(swept.mask(), inside)


def test_measures_enclose_what_is_known(manipulator):
    # A leg closes unless its axis is within 30 degrees of straight down; the caps do not meet (Haar measure).
    free = manipulator.with_parameters({"limits.S": None})
    whole = opm.measure(free, section="upper", tolerance=0.02)
    share = 1 - 1.5 * (1 - np.cos(np.radians(30)))
    assert whole.lower / whole.whole <= share <= whole.upper / whole.whole
    assert whole.stop == "tolerance" and whole.units == "rad^3" and whole.upper - whole.lower <= 0.04 * whole.value
    # A fixed orientation: against a fine grid, of which only the cells on the boundary can differ.
    box = {"x": (-0.2, 0.2), "y": (-0.2, 0.2)}
    area = opm.measure(manipulator, over=box, tolerance=1e-3)
    grid = opm.sweep(manipulator, x=(-0.2, 0.2, 801), y=(-0.2, 0.2, 801))
    assert area.units == "m^2" and area.lower <= area.value <= area.upper and area.over["x"] == (-0.2, 0.2)
    assert area.fraction == pytest.approx(grid.fraction, abs=0.01) and area.whole == pytest.approx(0.16)
    assert grid.measure(tolerance=1e-3).value == area.value
    assert opm.measure(manipulator, over=box, tolerance=1e-3, threads=1).value == area.value
    with pytest.raises(opm.OpmError, match="no task coordinate w|no .* w, expected one of x, y"):
        opm.measure(manipulator, over={"w": 1.0})
    with pytest.raises(opm.OpmError, match=r"x is 'wide', expected a number or \(min, max\)"):
        opm.measure(manipulator, over={"x": "wide"})
    with pytest.raises(opm.OpmError, match='section is "none", expected one of whole, upper, lower'):
        opm.measure(manipulator, section="none")


def test_variables():
    variables = design.Variables({"h": (0.1, 0.3), "leg4.base": ((-1.0, 1.0), (2.0, 4.0))})
    assert len(variables) == 3
    assert variables.parameters([0.5, 0.25, 1.0]) == {"h": pytest.approx(0.2), "leg4.base": (-0.5, 4.0)}
    assert len(variables | design.Variables({"a1": (0.1, 0.2)})) == 4
    with pytest.raises(opm.OpmError, match="the lower one first"):
        design.Variables({"h": (0.3, 0.1)})


def test_the_papers_parameters_are_9_and_16(manipulator):
    known = manipulator.parameters
    numbers = [sum(np.size(known[name]) for name in names) for names in (design.UPPER, design.LOWER)]
    assert numbers == [9, 16]


def test_the_optimiser_finds_a_known_minimum_in_its_budget():
    asked = []

    def bowl(shares):
        assert shares.shape == (6,) and (0 <= shares).all() and (shares <= 1).all()
        asked.append(1)
        return float(((shares - 0.7) ** 2 * np.arange(1, 7)).sum())

    found = design.minimise(bowl, 6, budget=1000, seed=3)
    assert len(asked) == found.evaluations == len(found.history) == 1000
    np.testing.assert_allclose(found.shares, 0.7, atol=1e-4)
    assert found.cost == found.history[-1] == pytest.approx(bowl(found.shares), abs=0)
    assert (np.diff(found.history) <= 0).all()
    again = design.minimise(bowl, 6, budget=1000, seed=3)
    np.testing.assert_array_equal(again.history, found.history)


def test_both_ways_to_design_improve_on_chance(manipulator):
    upper = design.Variables({"beta": (0.8, 1.5), "alpha1": (0.8, 1.5)})
    lower = design.Variables({"a2": (0.03, 0.1), "h": (0.0, 0.2), "leg4.base": ((-0.1, 0.1), (0.0, 0.15))})
    asked = {"places": PLACES, "orientations": ORIENTATIONS}
    split = design.sections(manipulator, upper, lower, budget=120, seed=1, **asked)
    whole = design.undivided(manipulator, upper | lower, budget=120, seed=1, **asked)
    assert split.evaluations == whole.evaluations == 120 and set(split.imaginary_range) == set(manipulator.imaginary_names)
    for found in (split, whole):
        # Dexterous: every orientation, by one call of inverse kinematics a pose.
        grid = np.stack(np.meshgrid(*(np.linspace(*axis) for axis in (*PLACES.values(), *ORIENTATIONS.values())), indexing="ij"))
        solved = found.manipulator.inverse(grid.reshape(5, -1).T)
        every = solved.within_limits.reshape(81, 27).all(axis=1)
        assert found.dexterous == every.mean() >= design.dexterous(manipulator, **asked)
        low, high = (np.nanmin(solved.imaginary, axis=0), np.nanmax(solved.imaginary, axis=0))
        for column, (below, above) in enumerate(found.imaginary_range.values()):
            assert below - 1e-9 <= low[column] and high[column] <= above + 1e-9
    with pytest.raises(opm.OpmError, match="`hh` is not a parameter; did you mean `h`[?] home has x"):
        design.undivided(manipulator, design.Variables({"hh": (0.0, 1.0)}), budget=3, **asked)


def test_wrong_questions_are_told(manipulator):
    variables = design.Variables({"leg1.h": (0.1, 0.2), "leg2.h": (0.1, 0.2)})
    asked = {"places": PLACES, "orientations": ORIENTATIONS}
    for call in (
        lambda **options: design.undivided(manipulator, variables, **asked, **options),
        lambda **options: design.sections(manipulator, variables, variables, **asked, **options),
        lambda **options: design.minimise(lambda shares: 0.0, 2, **{"seed": 0, **options}),
    ):
        for budget in (0, -5, 1.5, "x"):
            with pytest.raises(opm.OpmError, match=f"^budget is {budget!r}, expected a whole number of at least"):
                call(budget=budget)
        for seed in ("x", -1, 0.5):
            with pytest.raises(opm.OpmError, match=f"^seed is {seed!r}, expected a whole number of at least 0"):
                call(budget=2, seed=seed)
    twice = {"places": {"x": (-0.1, 0.1, 3)}, "orientations": {"x": (0.0, 0.1, 3)}}
    with pytest.raises(opm.OpmError, match="^places and orientations both give x, expected each coordinate once"):
        design.dexterous(manipulator, **twice)
    with pytest.raises(opm.OpmError, match="both give x"):
        design.undivided(manipulator, variables, **twice, budget=1)


def test_it_is_loaded_on_demand():
    assert opm.design is design
