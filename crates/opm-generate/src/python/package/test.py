"""Poses of TITLE, compared with the joints that opm VERSION found: ``python test_NAME.py``, or pytest."""

import numpy as np

import NAME

# The mode, the status, the pose, the joints and the imaginary joints; none where the pose is out of reach.
GOLDEN = [
    ROWS
]

IS_ANGLE = np.array([ANGLES])
"""Which joints are angles."""


def test_joints_are_those_of_opm():
    modes, statuses, poses = (np.array([row[i] for row in GOLDEN]) for i in range(3))
    found = NAME.inverse(poses, modes)
    assert (found.status == statuses).all(), found.status - statuses
    sizes = np.array([joint.size for joint in NAME.DEFAULT.joint])
    for row, joints in zip(GOLDEN, found.joints):
        if row[1] == 0:
            off = np.abs(joints - row[3])
            # Full revolutions are no difference where half a revolution from home decides.
            off = np.where(IS_ANGLE & (off > np.pi), np.abs(off - 2 * np.pi), off) / sizes
            assert off.max() <= 1e-10, (row, joints)


if __name__ == "__main__":
    test_joints_are_those_of_opm()
    print(f"NAME: {len(GOLDEN)} poses")
