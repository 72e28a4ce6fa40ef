"""Calls the functions of a module with arrays of wrong shapes, and with modes that there are not."""

import importlib
import sys

import numpy as np

m = importlib.import_module(sys.argv[1])
pose, joints, actuated = m.HOME, m.inverse(m.HOME).joints, m.actuated(m.HOME)[1]
modes = 1 << m.CHOICES


def refused(word, function, *arguments):
    """Whether a ValueError names the argument."""
    try:
        found = function(*arguments)
    except ValueError as error:
        assert str(error).startswith(word + ": "), error
    else:
        raise AssertionError(f"{function.__name__}{arguments} gives {found}")


for function in (m.inverse, m.actuated, m.deficits, m.transform, m.jacobian, m.twist):
    function(pose, np.arange(modes))
    for mode in (-1, modes, 0.5, [0, modes], "+"):
        refused("mode", function, pose, mode)
for wrong in (pose[:-1], np.append(pose, 0.0), pose[0]):
    refused("pose", m.inverse, wrong)
    refused("pose", m.nearest, wrong, joints)
    refused("pose", m.rates, wrong, 0, pose)
    refused("rates", m.rates, pose, 0, wrong)
    refused("rates", m.inverse_dynamics, pose, 0, wrong, pose)
    refused("accelerations", m.inverse_dynamics, pose, 0, pose, wrong)
    refused("near", m.forward, actuated, wrong)
for wrong in (joints[:-1], np.append(joints, 0.0), joints[0]):
    refused("previous", m.nearest, pose, wrong)
    refused("joints", m.limits, wrong)
for wrong in (actuated[:-1], np.append(actuated, 0.0), actuated[0]):
    refused("actuated", m.forward, wrong, pose)
refused("mode", m.rates, pose, modes, pose)
refused("mode", m.forward, actuated, pose, modes)

assert m.nearest(pose[None], joints[None])[0].joints.shape == (1, m.JOINTS)
assert m.limits(np.zeros((0, m.JOINTS))).shape == (0,)
assert m.inverse(np.zeros((0, m.COORDINATES)), np.zeros(0, int)).joints.shape == (0, m.JOINTS)
