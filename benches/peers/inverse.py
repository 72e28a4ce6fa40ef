"""Inverse kinematics of a million poses with opm and with NumPy: every joint of the shipped plano-spherical-5dof, actuated,
passive and imaginary, and which poses are in reach and within limits. Each uses one thread, and they are timed alternately. All
must agree. Prints a table.

The NumPy code is the paper's formulas (Selvi, section 3.1; Eqs. 2-3 and 10-16, with its errata corrected) for the working mode
`++ ++ ++ +`, and for the passive joints the products of rotations that define them: one array operation per step, and angles only
where an angle is needed. It runs on all poses at once, as one would write it, and in parts, so that intermediate arrays stay in
the cache.
"""

import math
import time

import numpy as np
import opm_kinematics as opm

POSES = 1_000_000
PART = 2048  # poses; the power of two with which NumPy is fastest
ROUNDS = 7
BETA, ALPHA_1, ALPHA_2 = math.radians(60), math.radians(75), math.radians(75)
ETAS = [math.radians(eta) for eta in (0, 120, 240)]
ALPHAS = [math.radians(alpha) for alpha in (30, 150, 270)]
H, A1, A2 = 0.12, 0.2, 0.06
D, B1, B2 = (0.0, 0.075), 0.1, 0.1
LIMIT = 0.3  # of the sliders to either side, metres


def rotation(zeta, xi, psi):
    """The rows of Rz(zeta) Ry(xi) Rz(psi)."""
    cz, sz, cx, sx, cp, sp = np.cos(zeta), np.sin(zeta), np.cos(xi), np.sin(xi), np.cos(psi), np.sin(psi)
    cz_cx, sz_cx = cz * cx, sz * cx
    return (
        (cz_cx * cp - sz * sp, -cz_cx * sp - sz * cp, cz * sx),
        (sz_cx * cp + cz * sp, -sz_cx * sp + cz * cp, sz * sx),
        (-sx * cp, sx * sp, cx),
    )


def turned(r, v):
    """The products R v of an array of rotations and one vector."""
    return [row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in r]


def slider_leg(x, y, r, eta, alpha):
    """The joints S, phi_1, phi_2, theta_2, theta_3, and the imaginary joint theta_1."""
    # R Rz(eta) Ry(beta) = Rz(theta_1) Rx(alpha_1) Rz(theta_2) Rx(alpha_2) Rz(theta_3)
    sin_b, cos_b, sin_e, cos_e = math.sin(BETA), math.cos(BETA), math.sin(eta), math.cos(eta)
    first = turned(r, (cos_e * cos_b, sin_e * cos_b, -sin_b))
    second = [row[1] * cos_e - row[0] * sin_e for row in r]
    w = turned(r, (cos_e * sin_b, sin_e * sin_b, cos_b))
    sin_1, cos_1 = math.sin(ALPHA_1), math.cos(ALPHA_1)
    k = (math.cos(ALPHA_2) - cos_1 * w[2]) / (sin_1 * np.sqrt(w[0] * w[0] + w[1] * w[1]))
    theta_1 = np.arctan2(w[1], w[0]) + np.arcsin(k)
    c, s = np.cos(theta_1), np.sin(theta_1)
    theta_2 = np.arctan2(c * w[0] + s * w[1], cos_1 * (s * w[0] - c * w[1]) - sin_1 * w[2])
    v = sin_1 * s, -sin_1 * c
    theta_3 = np.arctan2(
        v[0] * first[0] + v[1] * first[1] + cos_1 * first[2],
        v[0] * second[0] + v[1] * second[1] + cos_1 * second[2],
    )
    # P + a2 e(theta_1) = h e(alpha) + S n(alpha) + a1 e(alpha + pi/2 + phi_1), theta_1 = alpha + pi/2 + phi_1 + phi_2
    sin_a, cos_a = math.sin(alpha), math.cos(alpha)
    outer_x, outer_y = x + A2 * c, y + A2 * s
    across, along = cos_a * outer_x + sin_a * outer_y - H, cos_a * outer_y - sin_a * outer_x
    root = np.sqrt(A1 * A1 - across * across)
    phi_1 = np.arctan2(-across, -root)
    return along + root, phi_1, theta_1 - alpha - math.pi / 2 - phi_1, theta_2, theta_3, theta_1


def arm_leg(x, y, zeta, xi, psi, phi_home):
    """The joints phi_14, phi_24, and the spherical joint's rotation vector: Rz(phi_14 + phi_24 - phi_home) exp(ball) = R."""
    dx, dy = x - D[0], y - D[1]
    square = dx * dx + dy * dy
    phi_14 = np.arctan2(dy, dx) - np.arccos((B1 * B1 - B2 * B2 + square) / (2 * B1 * np.sqrt(square)))
    phi_24 = np.arccos((square - (B1 * B1 + B2 * B2)) / (2 * B1 * B2))
    # The quaternion, from half the Euler angles.
    rest = zeta + (phi_home - phi_14 - phi_24)
    total, difference, half = 0.5 * (rest + psi), 0.5 * (rest - psi), 0.5 * xi
    c, s = np.cos(half), np.sin(half)
    qw, qx, qy, qz = c * np.cos(total), -s * np.sin(difference), s * np.cos(difference), c * np.sin(total)
    length = np.sqrt(qx * qx + qy * qy + qz * qz)
    scale = 2 * np.arctan2(length, np.abs(qw)) / np.copysign(length, qw)
    return phi_14, phi_24, scale * qx, scale * qy, scale * qz


def solve(poses, phi_home, joints, imaginary, reachable, within_limits):
    """Fills the rows of joints and of imaginary joints, and the two masks."""
    x, y, zeta, xi, psi = poses.T
    r = rotation(zeta, xi, psi)
    inside, limited = True, True
    for leg in range(3):
        *of_leg, imaginary[:, leg] = slider_leg(x, y, r, ETAS[leg], ALPHAS[leg])
        for column, values in enumerate(of_leg, 5 * leg):
            joints[:, column] = values
        inside &= ~np.isnan(of_leg[0])
        limited &= np.abs(of_leg[0]) <= LIMIT
    of_arm = arm_leg(x, y, zeta, xi, psi, phi_home)
    for column, values in enumerate(of_arm, 15):
        joints[:, column] = values
    reachable[:] = inside & ~np.isnan(of_arm[1])
    within_limits[:] = limited & reachable
    joints[~reachable], imaginary[~reachable] = np.nan, np.nan


def numpy_in_parts(part):
    def inverse(poses, phi_home):
        count = len(poses)
        tables = np.empty((count, 20)), np.empty((count, 3)), np.empty(count, bool), np.empty(count, bool)
        with np.errstate(invalid="ignore"):
            for first in range(0, count, part):
                rows = slice(first, first + part)
                solve(poses[rows], phi_home, *(table[rows] for table in tables))
        return tables

    return inverse


def agree(found, expected):
    """Compares angles modulo 2π. Those of a stretched arm lose half of their digits."""
    for same in (2, 3):
        if not np.array_equal(found[same], expected[same]):
            raise SystemExit("opm and NumPy differ about what is in reach, or within limits")
    for table in (0, 1):
        difference = (found[table] - expected[table])[expected[2]]
        difference = np.abs(difference - 2 * math.pi * np.round(difference / (2 * math.pi)))
        if not (difference.max() < 1e-6 and np.median(difference) < 1e-15):
            raise SystemExit(f"opm and NumPy differ by {difference.max()}, half of all by {np.median(difference)}")


def main():
    manipulator = opm.examples.load("plano-spherical-5dof")
    names = [f"{name}{leg}" for leg in (1, 2, 3) for name in ("S", "phi1", "phi2", "theta2", "theta3")]
    assert manipulator.joint_names == [*names, "phi14", "phi24", "s4.x", "s4.y", "s4.z"], manipulator.joint_names
    at_home = manipulator.inverse([manipulator.home]).joints[0]
    phi_home = at_home[15] + at_home[16]
    rng = np.random.default_rng(1)
    poses = rng.uniform(-1, 1, (POSES, 5)) * [0.1, 0.1, 0.4, 0.4, 0.4]

    def with_opm(poses, phi_home, threads=1):
        found = manipulator.inverse(poses, threads=threads)
        return found.joints, found.imaginary, found.reachable, found.within_limits

    contenders = {
        "NumPy, all poses at a time": numpy_in_parts(POSES),
        f"NumPy, {PART} poses at a time": numpy_in_parts(PART),
        "opm": with_opm,
        "opm, two threads": lambda *arguments: with_opm(*arguments, threads=2),
    }
    expected = with_opm(poses, phi_home)
    for inverse in contenders.values():
        agree(inverse(poses, phi_home), expected)
    times = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, inverse in contenders.items():
            start = time.perf_counter()
            inverse(poses, phi_home)
            times[name].append(time.perf_counter() - start)
    best = min(times["opm"])
    print(f"{expected[2].mean():.0%} of {POSES} poses in reach, every joint of each")
    print()
    print("| inverse kinematics from Python, 5 DoF | ns a pose | of opm's time |")
    print("|---|---:|---:|")
    for name, seconds in times.items():
        print(f"| {name} | {1e9 * min(seconds) / POSES:.0f} | {min(seconds) / best:.2f} |")


if __name__ == "__main__":
    main()
