
def forward(actuated, near, mode=HOME_MODE, geometry=DEFAULT):
    """The poses at which the actuated joints have given values, by Newton's method from poses nearby, in the working mode of
    those: the statuses, the poses, and how far the actuated joints are off in the end, radians or sizes of the mechanism. The
    status is that of `jacobian` where it cannot go on; 2 LEGS + 1 where the actuated joints do not determine the pose;
    2 LEGS + 2 where it does not converge; -COORDINATES - i where actuated joint i, from 1, is no number."""
    actuated = _rows("actuated", actuated, ACTUATED, "actuated joints")
    near = _rows("near", near, COORDINATES, "coordinates")
    mode = _modes(mode)
    shape = np.broadcast_shapes(actuated.shape[:-1], near.shape[:-1], mode.shape)
    pose = _numbers_of(near)
    with np.errstate(all="ignore"):
        found = _forward(_doubles(geometry), _numbers_of(actuated), mode, pose)
    status, residual = _status(found[0], shape), np.broadcast_to(found[1], shape)
    return status, _array(pose, shape, status), residual

