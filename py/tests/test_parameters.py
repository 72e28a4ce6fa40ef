"""Parameters changed by name, against files with the parameters in them."""

import pickle
import re

import numpy as np
import opm_kinematics as opm
import pytest


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


def same(a, b):
    """Manipulators that solve alike, to the bit."""
    poses = np.random.default_rng(5).uniform(-1, 1, (2_000, len(a.home))) * [0.1, 0.1, 1, 1, 1][: len(a.home)]
    one, other = a.inverse(poses), b.inverse(poses)
    np.testing.assert_array_equal(one.joints, other.joints)
    np.testing.assert_array_equal(one.imaginary, other.imaginary)
    np.testing.assert_array_equal(one.within_limits, other.within_limits)
    assert one.reachable.any()


def test_the_parameters_are_those_of_the_file(manipulator):
    parameters = manipulator.parameters
    assert parameters["leg1.h"] == 0.12 and parameters["leg4.base"] == (0.0, 0.075)
    assert parameters["leg2.alpha"] == pytest.approx(np.radians(150), rel=1e-15)
    assert parameters["leg3.limits.S"] == (-0.3, 0.3) and parameters["leg3.limits.phi1"] is None
    assert parameters["leg3.max_rate.S"] is None
    assert opm.examples.load("plano-spherical-5dof-joints").parameters == {}
    # The paper's count: 9 of the upper section, 16 of the lower one; and where the platform's axes point.
    upper = [f"leg{i}.{name}" for i in (1, 2, 3) for name in ("alpha1", "alpha2", "beta")]
    lower = [f"leg{i}.{name}" for i in (1, 2, 3) for name in ("alpha", "h", "a1", "a2")]
    arm = ["leg4.base", "leg4.b1", "leg4.b2"]
    rest = {name for name in parameters if not name.startswith("home.") and len(name.split(".")) < 3}
    assert rest - {*upper, *lower, *arm} == {f"leg{i}.eta" for i in (1, 2, 3)}


def test_a_change_is_the_change_in_the_file(manipulator):
    text = re.sub(r"\nh = 120 .*", "\nh = 130", manipulator.text)
    text = text.replace("base = [0, 75]", "base = [10, 70]").replace("[-300, 300]", "[-250, 300]")
    changed = manipulator.with_parameters(
        {"leg4.base": np.array([0.01, 0.07]), "limits.S": [-0.25, 0.3]}, h=np.float64(0.13)
    )
    same(changed, opm.Manipulator.parse(text))
    assert changed.parameters["leg2.h"] == 0.13 and manipulator.parameters["leg2.h"] == 0.12
    # A whole name goes before a short one, in whatever order.
    mixed = manipulator.with_parameters({"leg2.h": 0.1, "h": 0.11}).parameters
    assert [mixed[f"leg{i}.h"] for i in (1, 2, 3)] == [0.11, 0.1, 0.11]


@pytest.mark.parametrize("name", ["plano-spherical-5dof", "translational-helical-3dof", "planar-planar-5dof"])
def test_its_text_and_its_pickle_are_it_to_the_bit(name):
    loaded = opm.examples.load(name)
    number = {key: value for key, value in loaded.parameters.items() if key.endswith((".b1", ".k", ".x"))}
    changed = loaded.with_parameters({key: value + 0.001 / 3 for key, value in number.items()})
    assert number and changed.parameters != loaded.parameters
    for again in (opm.Manipulator.parse(changed.text), pickle.loads(pickle.dumps(changed))):
        same(changed, again)
        assert again.parameters == changed.parameters and again.home_mode == changed.home_mode


def test_what_cannot_be_is_told(manipulator):
    for changes, message in [
        ({"leg1.hh": 1.0}, "`leg1.hh` is not a parameter; did you mean `leg1.h`[?] home has x, y, zeta, xi, psi; leg1, leg2, leg3 have alpha, h, a1"),
        ({"h": -1.0}, "leg1: `h` is -1 m, expected a length of at least 0; leg2"),
        ({"h": float("nan")}, "`h` is NaN, expected a finite number"),
        ({"limits.S": (0.3, -0.3)}, "`limits.S` are reversed: 0.3 m is above -0.3 m"),
        ({"limits.S": (0.2, 0.3)}, "leg1: `limits` exclude home: S1 is "),
        ({"h": "long"}, "`h` is 'long', expected a number, a pair of numbers, or None"),
        ({"base": (1, 2, 3)}, r"`base` is \(1, 2, 3\), expected a number, a pair"),
        ({"b1": 9.0}, "leg4: home is out of this leg's reach by 8"),
        ({3: 9.0}, "3 is not the name of a parameter"),
    ]:
        with pytest.raises(opm.OpmError, match=message):
            manipulator.with_parameters(changes)
    with pytest.raises(opm.OpmError, match="`h` is given twice"):
        manipulator.with_parameters({"h": 0.1}, h=0.1)
    listed = opm.examples.load("plano-spherical-5dof-joints")
    with pytest.raises(opm.OpmError, match="`h` is not a number of a list of joints"):
        listed.with_parameters(h=0.1)
    with pytest.raises(opm.OpmError, match="did you mean `leg1.h`"):
        manipulator.with_parameters({"leg1.hh": 0.1})


def test_limits_of_a_list_of_joints_are_changed_by_name() -> None:
    listed = opm.examples.load("plano-spherical-5dof-joints")
    changed = listed.with_parameters({"S1.limits": (-0.17, 0.17)})
    assert changed == opm.Manipulator.parse(changed.text)
    grid = {"x": (-0.2, 0.2, 21), "y": (-0.2, 0.2, 21)}
    assert 0 < opm.sweep(changed, **grid).count < opm.sweep(listed, **grid).count
