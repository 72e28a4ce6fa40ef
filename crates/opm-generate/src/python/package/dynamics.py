
def inverse_dynamics(pose, mode, rates, accelerations, geometry=DEFAULT):
    """The efforts of the actuated joints, N m and N, for rates and accelerations of the coordinates: the statuses, as of
    `jacobian`, and the efforts. They move the bodies of the geometry against their inertia and weight, the rotors, and friction,
    and are positive where the actuator pushes its joint towards larger values. The status is 2 LEGS + 1 also where the actuators
    do not hold the platform; -COORDINATES - i where rate i, from 1, is no number; -2 COORDINATES - i where acceleration i is
    none."""
    pose = _rows("pose", pose, COORDINATES, "coordinates")
    rates = _rows("rates", rates, COORDINATES, "coordinates")
    accelerations = _rows("accelerations", accelerations, COORDINATES, "coordinates")
    mode = _modes(mode)
    shape = np.broadcast_shapes(pose.shape[:-1], rates.shape[:-1], accelerations.shape[:-1], mode.shape)
    given = [_numbers_of(array) for array in (rates, accelerations)]
    efforts = [np.nan] * ACTUATED
    with np.errstate(all="ignore"):
        status = _inverse_dynamics(_doubles(geometry), _numbers_of(pose), mode, *given, efforts)
    status = _status(status, shape)
    return status, _array(efforts, shape, status)

