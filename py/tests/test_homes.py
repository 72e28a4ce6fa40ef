"""Homes that are a parallel singularity: a five-bar with its forearms in line, and one that is off by 1e-4."""

import math

import numpy as np
import opm_kinematics as opm
import pytest

LINK, FOREARM = math.hypot(50, 50), 150.0


def five_bar(off=0.0, unit="mm", right=True):
    elbow = [200 + FOREARM * math.cos(off), 50 + FOREARM * math.sin(off), 0]
    joints = [("L", [0, 0, 0], True), ("LE", [50, 50, 0], False), ("pen", [200, 50, 0], False)]
    legs = [joints, [("R", [400, 0, 0], right), ("RE", elbow, False)]]
    text = f'format = 1\nname = "flat"\nunits = {{ length = "{unit}", angle = "deg" }}\n[platform]\npoint = [200, 50, 0]\n'
    for leg in legs:
        text += "[[leg]]\njoints = [\n"
        for name, point, actuated in leg:
            text += (
                f'  {{ name = "{name}", type = "revolute", axis = [0, 0, 1], point = {point}, '
                f"actuated = {str(actuated).lower()} }},\n"
            )
        text += "]\n"
    return text


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_a_flat_home_is_one_warning_in_the_units_of_the_file(unit):
    with pytest.warns(UserWarning, match="parallel singularity") as told:
        m = opm.Manipulator.parse(five_bar(unit=unit))
    assert len(told) == 1
    assert f"through (350, 50, 0) {unit}" in str(told[0].message)
    assert m.home_warning in str(told[0].message)


def test_inverse_kinematics_need_no_regular_home():
    with pytest.warns(UserWarning):
        m = opm.Manipulator.parse(five_bar())
    pen = np.array([0.195, 0.06])
    solutions = m.inverse(pen[None, :])
    assert solutions.reachable.all()
    # The law of cosines, with the elbow on the side on which it is drawn.
    for name, base, side, drawn in [("L", 0.0, 1, 45), ("R", 0.4, -1, 135)]:
        x, y = pen - [base, 0]
        reach = math.hypot(x, y)
        inner = math.acos(((LINK / 1e3) ** 2 + reach**2 - (FOREARM / 1e3) ** 2) / (2 * reach * LINK / 1e3))
        candidates = [math.atan2(y, x) + sign * inner - math.radians(drawn) for sign in (side, -side)]
        off = [math.remainder(solutions[name][0] - candidate, math.tau) for candidate in candidates]
        assert min(map(abs, off)) < 1e-12


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("off", [1e-3, 1e-4])
def test_a_home_near_a_singularity_is_regular(off):
    assert opm.Manipulator.parse(five_bar(off)).home_warning is None


def test_errors_speak_the_units_of_the_file():
    with pytest.raises(opm.OpmError, match="1 actuated freedom controls 1 of the 2") as refused:
        opm.Manipulator.parse(five_bar(right=False))
    assert str(refused.value).endswith("through (350, 50, 0) mm")
