"""Calibration: a machine that is off its drawing is found from what it shows."""

import numpy as np
import opm_kinematics as opm
import pytest


@pytest.fixture(scope="module")
def drawing():
    return opm.examples.load("plano-spherical-5dof")


def measured(machine, count, noise, seed=3):
    """What a machine shows near home: a dictionary of columns."""
    generator = np.random.default_rng(seed)
    poses = np.asarray(machine.home) + generator.uniform(-0.08, 0.08, (count, len(machine.home)))
    poses[:, 2:] *= 5
    solved = machine.inverse(poses)
    poses, joints = poses[solved.reachable], solved.joints[solved.reachable]
    table = {c.name: poses[:, i] for i, c in enumerate(machine.task_coordinates)}
    table |= {machine.joint_names[i]: joints[:, i] for i in machine.actuated}
    return {name: values + noise * generator.standard_normal(len(values)) for name, values in table.items()}


def test_a_machine_is_found(drawing):
    truth = {"leg1.h": 0.1203, "leg2.a1": 0.1998, "leg4.base": (0.0002, 0.0751), "leg3.offset.S": 0.0004}
    machine = drawing.with_parameters(truth)
    table = measured(machine, 60, 20e-6)
    found = opm.calibrate(drawing, table, sigma=(20e-6, 20e-6))
    assert found.columns == list(table)
    assert found.rank == len(found.parameters) == 33
    real = {f"{name}{part}": v for name, value in truth.items() for part, v in zip(("", "") if np.isscalar(value) else (".x", ".y"), np.atleast_1d(value))}
    expected = [real.get(name, before) for name, before in zip(found.parameters, found.before)]
    scores = (found.after - expected) / found.standard_errors
    assert np.abs(scores).max() < 4 and 0.5 < found.deviation < 1.5 < found.deviation_before
    # The calibrated mechanism shows what the machine shows.
    pose = [[0.01, 0.02, 0.1, 0.2, -0.1]]
    off = np.abs(found.manipulator.inverse(pose).joints - machine.inverse(pose).joints)[:, machine.actuated]
    assert off.max() < 1e-4
    assert found.residuals.shape == (len(table["x"]), len(table)) and not found.outliers.any()


def test_partial_tables_and_wrong_ones(drawing):
    table = measured(drawing.with_parameters({"leg1.h": 0.1203}), 30, 0.0)
    table["xi"][3] = np.nan
    found = opm.calibrate(drawing, table, only=["leg1.h"])
    assert found.parameters == ["leg1.h"] and abs(found.after[0] - 0.1203) < 1e-8
    assert np.isnan(found.residuals[3, list(table).index("xi")])
    with pytest.raises(opm.OpmError, match="is a passive joint"):
        opm.calibrate(drawing, {"phi11": [0.0]})
    with pytest.raises(opm.OpmError, match="names no parameter"):
        opm.calibrate(drawing, table, only=["leg9"])
    with pytest.raises(opm.OpmError, match="expected 30|values, expected"):
        opm.calibrate(drawing, {**table, "x": [0.0]})
    with pytest.raises(opm.OpmError, match="say nothing"):
        opm.calibrate(drawing, {name: table[name] for name in ("x", "y", "zeta", "xi", "psi")})
