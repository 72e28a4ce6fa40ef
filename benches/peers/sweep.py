"""Sweeps of one grid with opm and with what one writes otherwise: NumPy for every pose, NumPy and numba with the orientations
factored out. All count the same poses of the shipped plano-spherical-5dof, in one thread, turn and turn about; prints tables.

The formulas are the paper's (Selvi, section 3.1; Eqs. 2-3 and 10-16, its errata mended) for one working mode, `++ ++ ++ +`.
"""

import math
import time

import numba
import numpy as np
import opm_kinematics as opm

ROUNDS = 9
LIMIT = 0.3  # of the sliders
BETA, ALPHA_1, ALPHA_2 = math.radians(60), math.radians(75), math.radians(75)
ETAS = np.radians([0.0, 120.0, 240.0])
ALPHAS = np.radians([30.0, 150.0, 270.0])
H, A1, A2 = 0.12, 0.2, 0.06
D, B1, B2 = (0.0, 0.075), 0.1, 0.1


class Grid:
    """Points in the plane, and orientations."""

    def __init__(self, points, orientations):
        self.ranges = {
            "x": (-0.15, 0.15, points),
            "y": (-0.15, 0.15, points),
            "zeta": (-0.4, 0.4, orientations),
            "xi": (-0.4, 0.4, orientations),
            "psi": (-0.4, 0.4, orientations),
        }
        self.x, self.y, *angles = (np.linspace(*r) for r in self.ranges.values())
        self.angles = np.stack([a.ravel() for a in np.meshgrid(*angles, indexing="ij")])
        self.poses = math.prod(r[2] for r in self.ranges.values())


def imaginary(zeta, xi, psi):
    """theta_1i for arrays of orientations; NaN where a leg's upper section does not close."""
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
    """Whether the three slider legs follow."""
    inside = True
    for theta, alpha in zip(thetas, ALPHAS, strict=True):
        qx, qy = x + A2 * np.cos(theta) - H * math.cos(alpha), y + A2 * np.sin(theta) - H * math.sin(alpha)
        along, across = math.cos(alpha) * qx + math.sin(alpha) * qy, math.cos(alpha) * qy - math.sin(alpha) * qx
        s = across + np.sqrt(A1 * A1 - along * along)  # NaN out of reach, which no comparison holds of
        inside &= (s >= -LIMIT) & (s <= LIMIT)
    return inside


def arm(x, y):
    square = (x - D[0]) ** 2 + (y - D[1]) ** 2
    return (square >= (B1 - B2) ** 2) & (square <= (B1 + B2) ** 2)


def numpy_per_pose(grid):
    """Every formula for every pose, a sheet of points at a time."""
    count = 0
    x, y = (a.ravel() for a in np.meshgrid(grid.x, grid.y))
    with np.errstate(invalid="ignore"):
        for angles in grid.angles.T:
            thetas = imaginary(*(np.full_like(x, angle) for angle in angles))
            count += np.count_nonzero(sliders(x, y, thetas) & arm(x, y))
    return count


def numpy_factorised(grid):
    """The imaginary joints once an orientation, the arm once a point."""
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


def compare(points, orientations, contenders):
    """Times the contenders, each on a grid with its own number of orientations, and prints a table."""
    manipulator = opm.examples.load("plano-spherical-5dof")

    def of_opm(threads):
        return lambda grid: opm.sweep(manipulator, threads=threads, **grid.ranges).count

    contenders = {**contenders, "opm, one thread": of_opm(1), "opm, two threads": of_opm(2)}
    grids = {name: Grid(points, orientations.get(name, orientations[""])) for name in contenders}
    for name, count in contenders.items():
        expected = of_opm(1)(grids[name])
        found = count(grids[name])
        if found != expected:
            raise SystemExit(f"{name} counts {found} of {grids[name].poses} poses, opm {expected}")
    times = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, count in contenders.items():
            start = time.perf_counter()
            count(grids[name])
            times[name].append((time.perf_counter() - start) / grids[name].poses)
    base = times["opm, one thread"]
    print(f"| sweep, {points} poses a row | million poses a second | opm is faster by |")
    print("|---|---:|---:|")
    for name, seconds in times.items():
        ratio = np.median(np.array(seconds) / np.array(base))
        print(f"| {name} | {1e-6 / np.median(seconds):.1f} | {ratio:.2f} |")


if __name__ == "__main__":
    peers = {"NumPy, pose by pose": numpy_per_pose, "NumPy, factorised": numpy_factorised}
    compare(64, {"": 25, "NumPy, pose by pose": 4, "NumPy, factorised": 7}, {**peers, "numba, factorised": numba_factorised})
    compare(256, {"": 12}, {"numba, factorised": numba_factorised})
