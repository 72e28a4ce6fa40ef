"""`opm analyze` against MuJoCo: efforts by the bodies' Jacobians and the constraints of the exported model."""

import random

import mujoco
import numpy as np
import pytest
from exported import LOOPS, MECHANISMS, answer
from test_mjcf import Exported

# Of the load's work.
CLOSE = 1e-6
LOAD = [3.0, -2.0, 5.0, 0.4, -0.3, 0.2]


@pytest.fixture(scope="module", params=[name for name in MECHANISMS if name not in LOOPS])
def exported(opm, tmp_path_factory, request):
    return Exported(opm, tmp_path_factory.mktemp("statics"), request.param)


GRAVITY = [1.0, -2.0, -9.81]


def weight(exported):
    """What the model's weight does for a rate of each joint."""
    model, data = exported.model, exported.data
    model.opt.gravity[:] = GRAVITY
    data.qvel[:] = 0
    mujoco.mj_forward(model, data)
    # The bias is what has to be overcome: at rest, that is the weight.
    return -data.qfrc_bias.copy()


def motions(exported):
    """Velocities of the joints that the constraints allow, as columns; and what of them is the platform's, as (v; w)."""
    model, data = exported.model, exported.data
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_sensorPos(model, data)
    rows = data.efc_J.reshape(-1, model.nv)[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]
    _, values, right = np.linalg.svd(rows)
    rank = int((values > 1e-9 * values[0]).sum())
    free = right[rank:].T
    point = data.sensor("platform.position").data.copy()
    moves = np.zeros((2, 3, model.nv))
    mujoco.mj_jac(model, data, moves[0], moves[1], point, model.body("platform").id)
    return free, moves.reshape(6, -1) @ free


def test_efforts_are_those_of_the_model(exported):
    model = exported.model
    generator = random.Random(f"{exported.answer['name']} statics")
    dofs = {model.actuator(i).name: model.jnt_dofadr[model.actuator_trnid[i][0]] for i in range(model.nu)}
    compared = 0
    for _ in range(4):
        pose = ",".join(
            f"{name}={home + generator.uniform(-1, 1) * span!r}"
            for name, home, span in exported.spans(angle=0.2, length=0.03)
        )
        wrench = ",".join(map(str, LOAD))
        found = answer(exported.opm, "analyze", exported.name, "--pose", pose, "--wrench", wrench)
        joints = answer(exported.opm, "ik", exported.name, "--pose", pose)["solutions"][0]["joints"]
        exported.pose_by(joints)
        free, platform = motions(exported)
        work = platform.T @ LOAD
        rates = free[list(dofs.values())]
        held = np.linalg.matrix_rank(rates, tol=1e-9)
        # Rods that spin between two balls do not move the platform.
        spins = max(0, exported.answer["mobility"] - len(dofs))
        assert found["loose_motions"] == free.shape[1] - held - spins
        assert found["internal_efforts"] == len(dofs) - held
        assert list(found["efforts"]) == list(dofs)
        efforts = list(found["efforts"].values())
        if found["internal_efforts"]:
            # What is not determined is not given.
            internal = np.linalg.svd(rates.T)[2][held:]
            assert [effort is None for effort in efforts] == list((np.abs(internal) > 1e-9).any(axis=0))
            continue
        assert found["balance"] == "balanced"
        assert np.abs(rates.T @ efforts + work).max() < CLOSE * np.abs(work).max()
        own = free.T @ weight(exported)
        heavy = ["--gravity", ",".join(map(str, GRAVITY))]
        for wrench, work in [([], own), (["--wrench", wrench], own + work)]:
            found = answer(exported.opm, "analyze", exported.name, "--pose", pose, *wrench, *heavy)
            assert found["balance"] == "balanced"
            efforts = list(found["efforts"].values())
            assert np.abs(rates.T @ efforts + work).max() < CLOSE * max(np.abs(work).max(), np.abs(own).max())
        masses = model.body_mass.sum() - model.body("base").mass[0]
        assert found["gravity"]["mass"] == pytest.approx(masses, rel=1e-9)
        compared += 1
    assert compared == 4 or found["internal_efforts"]
