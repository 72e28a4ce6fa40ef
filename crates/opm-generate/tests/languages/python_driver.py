"""Answers the questions of the input, all at once."""

import importlib
import sys

import numpy as np

m = importlib.import_module(sys.argv[1])
n = m.COORDINATES
record = np.dtype([("mode", "u4"), ("pose", "f8", (n,)), ("next", "f8", (n,))])
asked = np.frombuffer(sys.stdin.buffer.read(), record)
mode, pose, following = asked["mode"].astype(int), asked["pose"], asked["next"]
columns = []


def write(status, *arrays, hide=True):
    columns.append(np.asarray(status, float)[:, None])
    for array in arrays:
        array = np.asarray(array, float)
        array = array.reshape(len(asked), int(np.prod(array.shape[1:])))
        columns.append(np.where((np.asarray(status) != 0)[:, None] & hide, -77.0, array))


at = m.inverse(pose, mode)
write(at.status, at.joints, at.imaginary)
status, actuated = m.actuated(pose, mode)
write(status, actuated)
status, missed = m.deficits(pose, mode)
write(status, missed, hide=False)
columns.append(m.limits(np.where((at.status == 0)[:, None], at.joints, -77.0)).astype(float)[:, None])
write(*m.transform(pose, mode))
near, near_mode = m.nearest(following, np.where((at.status == 0)[:, None], at.joints, -77.0))
write(near.status, near_mode, near.joints, near.imaginary)
status, rates = m.jacobian(pose, mode)
write(status, rates)
write(*m.twist(pose, mode))
write(*m.rates(pose, mode, following))
if hasattr(m, "inverse_dynamics"):
    columns.append(np.ones((len(asked), 1)))
    write(*m.inverse_dynamics(pose, mode, following, pose))
else:
    columns.append(np.zeros((len(asked), 1)))
if hasattr(m, "forward"):
    columns.append(np.ones((len(asked), 1)))
    status, found, residual = m.forward(actuated, following, mode)
    # Only poses in reach are compared.
    status = np.where(at.status == 0, status, 1)
    write(status, residual, np.where(np.isnan(found), -77.0, found))
    wrong = actuated.copy()
    wrong[:, -1] = np.nan
    wrong[:, :-1] = np.nan_to_num(wrong[:, :-1])
    columns.append(m.forward(wrong, pose, mode)[0].astype(float)[:, None])
else:
    columns.append(np.zeros((len(asked), 1)))
sys.stdout.buffer.write(np.concatenate(columns, 1).tobytes())
