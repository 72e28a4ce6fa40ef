"""The closed-form kinematics of TITLE, for arrays of poses.

Written by opm VERSION; write it anew rather than change it. It needs NumPy alone.

Numbers are metres and radians. A pose is an array whose last axis has the coordinates COORDINATE_NAMES; all other axes are
poses, which are solved together. Results have the same axes before their own. Bit i of a working mode, the lowest first, is
set where sign i of opm's text is a minus. MODE A mode may be an array, too: one for each pose.

The status of a pose is 0; or the number of the first leg, from 1, that it is out of reach of; or -i where coordinate i, from 1,
is no number or far too large. Results are NaN where it is not 0.

>>> solution = inverse(HOME, HOME_MODE)
>>> solution.joints.shape == (JOINTS,)
True
"""

from typing import Any, NamedTuple

import numpy as np

CONSTANTS
HOME_MODE = MODE_BITS
"""The working mode at home."""

HOME = np.array([HOME_POSE])
"""The pose at home."""


class Solution(NamedTuple):
    """Every joint at every pose."""

    status: np.ndarray
    """The status of each pose."""
    joints: np.ndarray
    """The joint coordinates, leg by leg: angles are within half a revolution of home, or within their limits where full
    revolutions bring them there. Limits are not tested."""
    imaginary: np.ndarray
    """The imaginary joints."""


TYPES
DEFAULT = GEOMETRY
"""The mechanism as it was when this code was written. ``DEFAULT._replace(...)`` makes a calibrated one."""


def inverse(pose, mode=HOME_MODE, geometry=DEFAULT):
    """Every joint at poses in a working mode: a `Solution`."""
    pose, mode, shape = _poses(pose, mode)
    joints, imaginary = [np.nan] * JOINTS, [np.nan] * IMAGINARY
    with np.errstate(all="ignore"):
        status = _inverse(_doubles(geometry), pose, mode, joints, imaginary)
    status = _status(status, shape)
    return Solution(status, _array(joints, shape, status), _array(imaginary, shape, status))


def all_modes(pose, geometry=DEFAULT):
    """Every joint in all working modes: a `Solution` with one more axis, of the modes from 0 on."""
    return inverse(np.asarray(pose, float)[..., None, :], np.arange(1 << CHOICES), geometry)


def actuated(pose, mode=HOME_MODE, geometry=DEFAULT):
    """The actuated joints alone: the statuses, and their values."""
    pose, mode, shape = _poses(pose, mode)
    values = [np.nan] * ACTUATED
    with np.errstate(all="ignore"):
        status = _actuated(_doubles(geometry), pose, mode, values)
    status = _status(status, shape)
    return status, _array(values, shape, status)


def nearest(pose, previous, geometry=DEFAULT):
    """Every joint at poses in that mode in which the joints move least from previous ones (the sum of the squares, lengths
    over the size of the mechanism), angles with the revolutions nearest to the previous ones: a `Solution`, and the modes."""
    pose = _rows("pose", pose, COORDINATES, "coordinates")
    previous = _rows("previous", previous, JOINTS, "joints")
    shape = np.broadcast_shapes(pose.shape[:-1], previous.shape[:-1])
    joints, imaginary = [np.nan] * JOINTS, [np.nan] * IMAGINARY
    with np.errstate(all="ignore"):
        found = _nearest(_doubles(geometry), _numbers_of(pose), _numbers_of(previous), NEAREST_ARGUMENTSjoints, imaginary)
    status, mode = _status(found[0], shape), np.broadcast_to(found[1], shape)
    return Solution(status, _array(joints, shape, status), _array(imaginary, shape, status)), mode


def deficits(pose, mode=HOME_MODE, geometry=DEFAULT):
    """The statuses, and by how much poses are out of reach: for each leg, of its lower and of its upper section, in metres, or
    radians where the section is spherical; zero where it closes, infinite where it is not known. A section that follows
    another one out of reach counts as closed."""
    pose, mode, shape = _poses(pose, mode)
    missed = [0.0] * (2 * LEGS)
    with np.errstate(all="ignore"):
        status = _deficits(_doubles(geometry), pose, mode, missed)
    return _status(status, shape), _array(missed, shape).reshape(shape + (LEGS, 2))


def limits(joints, geometry=DEFAULT):
    """The number of the first joint, from 1, that is past its limits; 0 if none is."""
    joints = _rows("joints", joints, JOINTS, "joints")
    return _status(_limits(_doubles(geometry), _numbers_of(joints)), joints.shape[:-1])


def transform(pose, mode=HOME_MODE, geometry=DEFAULT):
    """Where the platform is, in base coordinates: the statuses, the positions of its reference point, and rotation matrices.
    They depend on the mode only where coordinates follow from those of the pose; no leg is tested."""
    pose, mode, shape = _poses(pose, mode)
    position, rotation = [np.nan] * 3, [np.nan] * 9
    with np.errstate(all="ignore"):
        status = _transform(_doubles(geometry), pose, mode, position, rotation)
    status = _status(status, shape)
    return status, _array(position, shape, status), _array(rotation, shape, status).reshape(shape + (3, 3))


def jacobian(pose, mode=HOME_MODE, geometry=DEFAULT):
    """The rates of all joints for unit rates of the coordinates: the statuses, and matrices with a row for each joint, rad/s
    and m/s. The status is LEGS + i where leg i, from 1, is singular; 2 LEGS + 1 where coordinates that follow from those of the
    pose have no rates."""
    pose, mode, shape = _poses(pose, mode)
    rates = [np.nan] * (JOINTS * COORDINATES)
    with np.errstate(all="ignore"):
        status = _jacobian(_doubles(geometry), pose, mode, rates)
    status = _status(status, shape)
    return status, _array(rates, shape, status).reshape(shape + (JOINTS, COORDINATES))


def twist(pose, mode=HOME_MODE, geometry=DEFAULT):
    """The platform's twist for unit rates of the coordinates: the statuses, and matrices with three rows of the angular
    velocity and three of the velocity of the reference point, base coordinates."""
    pose, mode, shape = _poses(pose, mode)
    rates = [np.nan] * (6 * COORDINATES)
    with np.errstate(all="ignore"):
        status = _twist(_doubles(geometry), pose, mode, rates)
    status = _status(status, shape)
    return status, _array(rates, shape, status).reshape(shape + (6, COORDINATES))


def rates(pose, mode, rates, geometry=DEFAULT):
    """The rates of all joints for given rates of the coordinates: the statuses, as of `jacobian`, and the rates. The status is
    -COORDINATES - i where rate i, from 1, is no number."""
    pose = _rows("pose", pose, COORDINATES, "coordinates")
    rates = _rows("rates", rates, COORDINATES, "coordinates")
    mode = _modes(mode)
    shape = np.broadcast_shapes(pose.shape[:-1], rates.shape[:-1], mode.shape)
    found = [np.nan] * JOINTS
    with np.errstate(all="ignore"):
        status = _rates(_doubles(geometry), _numbers_of(pose), mode, _numbers_of(rates), found)
    status = _status(status, shape)
    return status, _array(found, shape, status)

FORWARD
DYNAMICS
def _poses(pose, mode):
    """The numbers of poses, the modes, and the axes of results."""
    pose, mode = _rows("pose", pose, COORDINATES, "coordinates"), _modes(mode)
    return _numbers_of(pose), mode, np.broadcast_shapes(pose.shape[:-1], mode.shape)


def _rows(name, array, count, what):
    """An array whose last axis has as many numbers as expected."""
    array = np.asarray(array, float)
    if array.ndim == 0 or array.shape[-1] != count:
        raise ValueError(f"{name}: the last axis has the {count} {what}; this is an array of shape {array.shape}")
    return array


def _modes(mode):
    """An array of working modes."""
    mode = np.asarray(mode)
    if mode.dtype.kind not in "iu" or ((mode < 0) | (mode >= 1 << CHOICES)).any():
        raise ValueError(f"mode: {mode}, expected whole numbers from 0 to {(1 << CHOICES) - 1}")
    return mode


def _numbers_of(array):
    """The numbers of an array's last axis."""
    return list(np.moveaxis(array, -1, 0))


def _status(status, shape):
    return np.broadcast_to(np.asarray(status, int), shape).copy()


def _array(numbers, shape, status=0):
    """Numbers as the last axis of an array; NaN where the status is not zero."""
    each = [np.broadcast_to(np.asarray(number, float), shape) for number in numbers]
    array = np.stack(each, -1) if each else np.zeros(shape + (0,))
    return np.where(np.asarray(status)[..., None] == 0, array, np.nan)


def _doubles(value):
    """A constant whose numbers divide by zero as those of arrays do."""
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*map(_doubles, value))
    if isinstance(value, (tuple, list, np.ndarray)):
        return tuple(map(_doubles, value))
    return np.float64(value)


def _not(test):
    return np.logical_not(test)


def _where(test, value, other):
    """The value where the test is true, else the other one; of structs and lists, each number."""
    if value is other or test is True or other is None:
        return value
    if value is None:
        return other
    if isinstance(value, tuple):
        return type(value)(*(_where(test, a, b) for a, b in zip(value, other)))
    if isinstance(value, list):
        return [_where(test, a, b) for a, b in zip(value, other)]
    return np.where(test, value, other)


def _get(numbers, index):
    """An element of a list; of another one for each pose."""
    all_of = np.array(np.broadcast_arrays(*numbers, index)[:-1])
    index = np.broadcast_to(np.clip(index, 0, len(numbers) - 1), all_of.shape[1:])
    return np.take_along_axis(all_of, index[None], 0)[0]


def _put(numbers, index, value):
    """Changes an element of a list; another one for each pose."""
    for place, number in enumerate(numbers):
        numbers[place] = np.where(index == place, value, number)


def _round(x):
    """The nearest whole number; of two, that farther from zero."""
    return np.copysign(np.floor(np.abs(x) + 0.5), x)


FUNCTIONS
