"""Sweeps of the shipped plano-spherical-5dof without opm (NumPy for every pose; NumPy and numba with the orientations factored
out), and with opm from Python. For each input line `contender points rows orientations` it prints the number of reachable poses.
`benches/benches/sweep.rs` sends these lines and measures the time.

The formulas are the paper's (Selvi, section 3.1; Eqs. 2-3 and 10-16, with its errata corrected) for one working mode, `++ ++ ++ +`.
"""

import math
import sys

import numba
import numpy as np
import opm_kinematics as opm

LIMIT = 0.3  # of the sliders to either side, metres
BETA, ALPHA_1, ALPHA_2 = math.radians(60), math.radians(75), math.radians(75)
ETAS = np.radians([0.0, 120.0, 240.0])
ALPHAS = np.radians([30.0, 150.0, 270.0])
H, A1, A2 = 0.12, 0.2, 0.06
D, B1, B2 = (0.0, 0.075), 0.1, 0.1


class Grid:
    """The grid of points in the plane, and the grid of orientations."""

    def __init__(self, points, rows, orientations):
        self.ranges = {
            "x": (-0.15, 0.15, points),
            "y": (-0.15, 0.15, rows),
            "zeta": (-0.4, 0.4, orientations),
            "xi": (-0.4, 0.4, orientations),
            "psi": (-0.4, 0.4, orientations),
        }
        self.x, self.y, *angles = (np.linspace(*r) for r in self.ranges.values())
        self.angles = np.stack([a.ravel() for a in np.meshgrid(*angles, indexing="ij")])
        self.poses = math.prod(r[2] for r in self.ranges.values())


def imaginary(zeta, xi, psi):
    """The imaginary joints theta_1i for arrays of orientations; NaN where a leg's upper section does not close."""
    cz, sz, cx, sx = np.cos(zeta), np.sin(zeta), np.cos(xi), np.sin(xi)
    thetas = []
    for eta in ETAS:
        a = math.sin(BETA) * np.cos(psi + eta), math.sin(BETA) * np.sin(psi + eta), math.cos(BETA)
        tilted = cx * a[0] + sx * a[2]
        w = cz * tilted - sz * a[1], sz * tilted + cz * a[1], cx * a[2] - sx * a[0]
        k = (math.cos(ALPHA_2) - math.cos(ALPHA_1) * w[2]) / (math.sin(ALPHA_1) * np.hypot(w[0], w[1]))
        thetas.append(np.arctan2(w[1], w[0]) + np.arcsin(k))
    return thetas


def sliders(x, y, thetas):
    """Whether the three slider legs reach."""
    inside = True
    for theta, alpha in zip(thetas, ALPHAS, strict=True):
        qx, qy = x + A2 * np.cos(theta) - H * math.cos(alpha), y + A2 * np.sin(theta) - H * math.sin(alpha)
        along, across = math.cos(alpha) * qx + math.sin(alpha) * qy, math.cos(alpha) * qy - math.sin(alpha) * qx
        s = across + np.sqrt(A1 * A1 - along * along)  # NaN out of reach, so that every comparison is false
        inside &= (s >= -LIMIT) & (s <= LIMIT)
    return inside


def arm(x, y):
    square = (x - D[0]) ** 2 + (y - D[1]) ** 2
    return (square >= (B1 - B2) ** 2) & (square <= (B1 + B2) ** 2)


def numpy_per_pose(grid):
    """Every formula for every pose, for all points of one orientation at a time."""
    count = 0
    x, y = (a.ravel() for a in np.meshgrid(grid.x, grid.y))
    with np.errstate(invalid="ignore"):
        for angles in grid.angles.T:
            thetas = imaginary(*(np.full_like(x, angle) for angle in angles))
            count += np.count_nonzero(sliders(x, y, thetas) & arm(x, y))
    return count


def numpy_factorised(grid):
    """The imaginary joints once per orientation, the arm once per point."""
    count = 0
    x, y = np.meshgrid(grid.x, grid.y)
    reached = arm(x, y)
    with np.errstate(invalid="ignore"):
        for thetas in np.stack(imaginary(*grid.angles)).T:
            count += np.count_nonzero(sliders(x, y, thetas) & reached)
    return count


@numba.njit(fastmath=False, error_model="numpy")
def count_points(x, y, thetas, alphas):
    count = 0
    for i in range(thetas.shape[1]):
        for row in range(len(y)):
            for column in range(len(x)):
                px, py = x[column], y[row]
                square = (px - D[0]) ** 2 + (py - D[1]) ** 2
                inside = (square >= (B1 - B2) ** 2) & (square <= (B1 + B2) ** 2)
                for leg in range(3):
                    c, s = alphas[0, leg], alphas[1, leg]
                    qx, qy = px + thetas[leg, i, 0] - H * c, py + thetas[leg, i, 1] - H * s
                    along, across = c * qx + s * qy, c * qy - s * qx
                    slider = across + math.sqrt(A1 * A1 - along * along)
                    inside &= (slider >= -LIMIT) & (slider <= LIMIT)
                count += inside
    return count


def numba_factorised(grid):
    with np.errstate(invalid="ignore"):
        thetas = np.stack(imaginary(*grid.angles))
    outer = A2 * np.stack([np.cos(thetas), np.sin(thetas)], axis=-1)
    return count_points(grid.x, grid.y, outer, np.stack([np.cos(ALPHAS), np.sin(ALPHAS)]))


@numba.njit(fastmath=False, error_model="numpy")
def count_points_within(x, y, thetas, alphas, links, turned, least):
    """As `count_points`, with the cosines of the angles between each link and a direction: at home for the slider's pivot,
    and turned by the imaginary joint for the other one."""
    count = 0
    for i in range(thetas.shape[1]):
        for row in range(len(y)):
            for column in range(len(x)):
                px, py = x[column], y[row]
                square = (px - D[0]) ** 2 + (py - D[1]) ** 2
                inside = (square >= (B1 - B2) ** 2) & (square <= (B1 + B2) ** 2)
                for leg in range(3):
                    c, s = alphas[0, leg], alphas[1, leg]
                    qx, qy = px + thetas[leg, i, 0] - H * c, py + thetas[leg, i, 1] - H * s
                    along, across = c * qx + s * qy, c * qy - s * qx
                    root = math.sqrt(A1 * A1 - along * along)
                    slider = across + root
                    inside &= (slider >= -LIMIT) & (slider <= LIMIT)
                    inside &= along * links[0] + root * links[1] >= least[0]
                    inside &= along * turned[leg, i, 0] + root * turned[leg, i, 1] >= least[1]
                count += inside
    return count


def numba_within(grid):
    """With the two pivots of each link that slides within 0.7 and 0.9 radians of home."""
    with np.errstate(invalid="ignore"):
        thetas = np.stack(imaginary(*grid.angles))
    homes = np.stack(imaginary(*np.zeros((3, 1))))
    outer = A2 * np.stack([np.cos(thetas), np.sin(thetas)], axis=-1)
    # The link at home, in directions across and against the slide, so that angles are clockwise; it is the same in every leg.
    along = A2 * math.cos(homes[0, 0] - ALPHAS[0]) - H
    home = math.atan2(math.sqrt(A1 * A1 - along * along), along)
    turns = home - (thetas - homes)
    turned = np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    links = np.array([math.cos(home), math.sin(home)])
    least = A1 * np.cos([0.7, 0.9])
    alphas = np.stack([np.cos(ALPHAS), np.sin(ALPHAS)])
    return count_points_within(grid.x, grid.y, outer, alphas, links, turned, least)


def by_opm(threads):
    manipulator = opm.examples.load("plano-spherical-5dof")
    return lambda grid: opm.sweep(manipulator, threads=threads, **grid.ranges).count


def main():
    contenders = {
        "numpy-per-pose": numpy_per_pose,
        "numpy-factorised": numpy_factorised,
        "numba-factorised": numba_factorised,
        "numba-within": numba_within,
        "opm-1": by_opm(1),
        "opm-2": by_opm(2),
    }
    for line in sys.stdin:
        name, *sizes = line.split()
        print(contenders[name](Grid(*map(int, sizes))), flush=True)


if __name__ == "__main__":
    main()
