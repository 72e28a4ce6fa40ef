"""Durations of the fastest timings along some paths, by the package toppra.

    pip install toppra==0.6.10 scipy==1.17.1
    python reference.py > durations.csv

The joints are those of the mechanisms by their geometry, written out here. The paths are those of the motion files beside
this script. Metres, radians and seconds.
"""

import pathlib
import tomllib

import numpy as np
import toppra
import toppra.algorithm
import toppra.constraint
from scipy.interpolate import CubicSpline

HERE = pathlib.Path(__file__).parent
SAMPLES, GRID = 2001, 4001


def coordinate(value, angle):
    """A sum of sinusoids of a motion file as a function of time."""
    scale = np.pi / 180 if angle else 1e-3
    terms = value if isinstance(value, list) else [value]

    def at(t):
        total = np.zeros_like(t)
        for term in terms:
            term = {"offset": term, "amplitude": 0, "frequency": 0} if isinstance(term, (int, float)) else term
            wave = np.sin(2 * np.pi * term["frequency"] * t + np.radians(term.get("phase", 0)))
            total += scale * (term.get("offset", 0) + term["amplitude"] * wave)
        return total

    return at


def poses(name):
    """The times of samples, and the coordinates there by name."""
    motion = tomllib.loads((HERE / f"{name}.toml").read_text())
    if "points" in motion:
        points = motion["points"]
        times = np.linspace(points["t"][0], points["t"][-1], SAMPLES)
        scale = {key: np.pi / 180 if key == "theta" else 1e-3 for key in points}
        splines = {
            key: CubicSpline(points["t"], np.multiply(values, scale[key]), bc_type=motion["ends"])
            for key, values in points.items()
            if key != "t"
        }
        return times, {key: spline(times) for key, spline in splines.items()}
    times = np.linspace(0, motion["duration"], SAMPLES)
    return times, {key: coordinate(value, key == "phi")(times) for key, value in motion["coordinates"].items()}


def helical(x, y, phi):
    """The sliders of translational-helical-3dof: cli/src/format.md, C = P + (k + pitch phi) k_hat and S = C n(alpha)."""
    legs = [(210, 45, 0.010, 0.020), (330, 285, 0.015, 0.0), (90, 165, 0.025, 0.0)]
    sliders = []
    for alpha, beta, k, pitch in legs:
        alpha, direction = np.radians(alpha), np.radians(alpha + beta)
        reach = k + pitch * phi
        cx, cy = x + reach * np.cos(direction), y + reach * np.sin(direction)
        sliders.append(-np.sin(alpha) * cx + np.cos(alpha) * cy)
    return np.stack(sliders, axis=1)


def cartesian(x, y, z):
    """The sliders of cartesian-wrist-6dof, from home; its wrist does not move."""
    return np.stack([x, y, z - 0.4], axis=1)


def planar(x, y, theta):
    """The first joints of planar-3rrr: two links from A by way of B to C, which the platform carries."""
    first = np.array([[-165.5, -95.551469550883], [165.5, -95.551469550883], [0, 191.102939101766]]) / 1000
    elbow = np.array([[-2.745425422171, -128.215646472856], [112.410719719224, 61.730215076632],
                      [-109.665294297052, 66.485431396224]]) / 1000  # fmt: skip
    last = np.array([[-65.00386680806, -37.53], [65.00386680806, -37.53], [0, 75.06]]) / 1000
    cos, sin = np.cos(theta), np.sin(theta)
    angles = []
    for a, b, c in zip(first, elbow, last, strict=True):
        at = np.stack([x + cos * c[0] - sin * c[1], y + sin * c[0] + cos * c[1]], axis=1) - a
        one, two = np.linalg.norm(b - a), np.linalg.norm(c - b)
        distance = np.linalg.norm(at, axis=1)
        inner = np.arccos((one**2 + distance**2 - two**2) / (2 * one * distance))
        side = np.sign(np.cross(np.append(c - a, 0), np.append(b - a, 0))[2])
        home = np.arctan2(*(b - a)[::-1])
        angles.append(np.unwrap(np.arctan2(at[:, 1], at[:, 0]) + side * inner) - home)
    return np.stack(angles, axis=1)


CASES = [
    ("helical", "translational-helical-3dof", helical, 0.3, 1.5),
    ("helical", "translational-helical-3dof", helical, None, 1.5),
    ("circle", "cartesian-wrist-6dof", cartesian, 0.25, 2.0),
    ("circle", "cartesian-wrist-6dof", cartesian, 0.05, 2.0),
    ("platform", "planar-3rrr", planar, 1.0, 8.0),
    ("platform", "planar-3rrr", planar, None, 3.0),
    ("line", "planar-3rrr", planar, 1.0, 8.0),
]

print("motion,mechanism,max_rate,max_acceleration,duration")
toppra.setup_logging("ERROR")
for name, mechanism, joints, rate, acceleration in CASES:
    times, at = poses(name)
    path = toppra.SplineInterpolator(times, joints(**at))
    both = np.array([-1.0, 1.0]) * np.ones((path.dof, 1))
    scheme = toppra.constraint.DiscretizationType.Interpolation
    limits = [toppra.constraint.JointAccelerationConstraint(acceleration * both, discretization_scheme=scheme)]
    if rate:
        limits.append(toppra.constraint.JointVelocityConstraint(rate * both))
    grid = np.linspace(times[0], times[-1], GRID)
    solver = toppra.algorithm.TOPPRA(limits, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    duration = solver.compute_trajectory(0, 0).duration
    print(f"{name},{mechanism},{rate or ''},{acceleration},{float(duration)!r}")
