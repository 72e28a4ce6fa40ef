"""`opm trajectory --efforts` against MuJoCo's inverse dynamics of the exported model: rotors, friction, given inertias, a payload."""

import re

import mujoco
import numpy as np
import pytest
from exported import run, table
from test_mjcf import Exported
from test_statics import motions

# Of the largest effort.
CLOSE = 1e-9
MOTOR = re.compile('type = "(revolute|prismatic)"(.*), actuated = true')
# A rotor of 2e-5 kg m² turns 20 times as fast as a joint, and 0.2 rad for each millimetre: kg m² and kg.
GEARS = {"revolute": 20, "prismatic": 0.2}
ROTORS = {int(mujoco.mjtJoint.mjJNT_HINGE): 2e-5 * 20**2, int(mujoco.mjtJoint.mjJNT_SLIDE): 2e-5 * 200**2}
# Of passive joints that are no balls: their friction depends on what their coordinates are.
BEARING = re.compile(r'type = "(revolute|universal|prismatic)"(?!.*actuated)')
RATES = {"revolute": "0.02", "prismatic": "0.02", "universal": "[0.02, 0.03]"}
BODIES = """
[bodies]
density = 1900
masses = { platform = 0.8, "%(link)s" = 0.3 }
centres = { "%(link)s" = [20, 30, 40] }
inertias = { "%(link)s" = [3e-4, 4e-4, 5e-4, 1e-5, -2e-5, 3e-5] }
payload = { mass = 2, centre = [10, -20, 300], inertia = [0.01, 0.02, 0.025, 0.001, 0.002, -0.003] }
"""


class Driven(Exported):
    """A mechanism with motors, bearings and a payload."""

    def __init__(self, opm, folder, name):
        path = folder / f"{name}.toml"
        run(opm, "convert", name, "--joints", "-o", path)
        text = path.read_text()
        assert 'length = "mm"' in text

        def motor(found):
            drive = f"rotor_inertia = 2e-5, gear = {GEARS[found[1]]}, viscous_friction = 0.3, coulomb_friction = 0.4"
            return f"{found[0]}, {drive}"

        text = MOTOR.sub(motor, text)

        def bearing(found):
            friction = RATES[found[1]]
            return f"{found[0]}, viscous_friction = {friction}, coulomb_friction = {friction}"

        text = BEARING.sub(bearing, text)
        link = re.search(r'name = "([^"]+)", type', text)[1]
        path.write_text(text + BODIES % {"link": link})
        super().__init__(opm, folder, path)

    def turning(self, row, joint):
        """The angular velocity of a ball in the directions of its body, and its derivative."""

        def numbers(prefix):
            return np.array([row[f"{prefix}{joint}.{axis}"] for axis in "xyz"])

        vector, rate, acceleration = numbers(""), numbers("d."), numbers("dd.")

        def velocity(t):
            at, moving = vector + rate * t + acceleration * t * t / 2, rate + acceleration * t
            angle, about = np.linalg.norm(at), np.cross(at, moving)
            if angle < 1e-6:
                return moving - about / 2
            cosine, sine = (1 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
            return moving - cosine * about + sine * np.cross(at, about)

        step = 1e-3
        ends = [8 * (velocity(step) - velocity(-step)), velocity(2 * step) - velocity(-2 * step)]
        return velocity(0), (ends[0] - ends[1]) / (12 * step)

    def move(self, row):
        """Sets places, rates and accelerations of all joints."""
        self.pose_by(row)
        for number in range(self.model.njnt):
            joint = self.model.joint(number)
            place = joint.dofadr[0]
            if joint.type[0] == mujoco.mjtJoint.mjJNT_BALL:
                turning = self.turning(row, joint.name)
                self.data.qvel[place : place + 3], self.data.qacc[place : place + 3] = turning
            else:
                self.data.qvel[place] = row[f"d.{joint.name}"]
                self.data.qacc[place] = row[f"dd.{joint.name}"]


@pytest.mark.parametrize("name", ["delta", "stewart", "plano-spherical-5dof", "planar-3rrr", "tripteron"])
def test_efforts_in_motion_are_those_of_the_model(opm, tmp_path, name):
    driven = Driven(opm, tmp_path, name)
    model, data = driven.model, driven.data
    given = {
        coordinate: (span, 0.7 + 0.2 * number, 0.3 + number, home)
        for number, (coordinate, home, span) in enumerate(driven.spans(angle=0.15, length=0.03))
    }
    motion = driven.motion_file(1, 20, given)
    columns = ["--rates", "--accelerations", "--efforts"]
    rows = table(run(opm, "trajectory", driven.name, "--motion", motion, *columns, "--quiet", "-o", "-"))
    assert len(rows) == 21
    motors = [model.actuator(i) for i in range(model.nu)]
    dofs = [model.jnt_dofadr[motor.trnid[0]] for motor in motors]
    rotors = [ROTORS[int(model.jnt_type[motor.trnid[0]])] for motor in motors]
    assert model.dof_armature[dofs] == pytest.approx(rotors)
    assert (model.dof_frictionloss > 0).sum() > len(dofs)
    for row in rows:
        driven.move(row)
        model.opt.disableflags = 0
        velocity, acceleration = data.qvel.copy(), data.qacc.copy()
        free, _ = motions(driven)
        data.qvel[:], data.qacc[:] = velocity, acceleration
        # The joints move as the loops let them.
        assert np.abs(free @ (free.T @ velocity) - velocity).max() < 1e-9 * np.abs(velocity).max()
        model.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        mujoco.mj_inverse(model, data)
        # Dry friction is a constraint of MuJoCo.
        needed = data.qfrc_inverse + model.dof_frictionloss * np.sign(velocity)
        expected, *_ = np.linalg.lstsq(free[dofs].T, free.T @ needed, rcond=None)
        found = np.array([row[f"effort.{motor.name}"] for motor in motors])
        assert np.abs(found - expected).max() < CLOSE * np.abs(found).max()
