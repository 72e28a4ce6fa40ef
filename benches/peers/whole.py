"""Inverse kinematics of the actuated joints of two robots whose legs are solved whole, for a million poses: the leg lengths of a
6-6 hexapod, and the crank angles of a Delta. opm is compared with the closed forms that one writes by hand, with NumPy and with
numba. Each uses one thread, and they are timed alternately. All must agree. Prints a table of ratios.

The hexapod's closed form is the distance of the ends of each leg. A crank's is the cut of its circle with the sphere of its rod, on the outer
side (R. L. Williams II, "The Delta Parallel Robot: Kinematics Solutions", 2016). Neither looks at limits, as opm does, nor at which leg a
pose is out of reach of.
"""

import math
import time

import numba
import numpy as np
import opm_kinematics as opm

POSES = 1_000_000
PART = 2048  # poses; the power of two with which NumPy is fastest
ROUNDS = 7


def hexapod(manipulator):
    """The closed forms of a hexapod, with NumPy and with numba, and poses about home."""
    legs = list(manipulator.legs.values())
    base = np.array([leg[0].point for leg in legs])
    head = np.array([leg[2].point for leg in legs]) - manipulator.reference_point

    def with_numpy(poses):
        x, y, z, roll, pitch, yaw = poses.T
        cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
        r = ((cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr), (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr), (-sp, cp * sr, cp * cr))
        lengths = np.empty((len(poses), 6))
        for leg in range(6):
            d = [p + row[0] * head[leg, 0] + row[1] * head[leg, 1] + row[2] * head[leg, 2] - base[leg, k] for k, (p, row) in enumerate(zip((x, y, z), r, strict=True))]
            lengths[:, leg] = np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        return lengths

    def solve(poses, lengths):
        for i in range(len(poses)):
            x, y, z, roll, pitch, yaw = poses[i]
            cr, sr, cp, sp, cy, sy = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch), math.cos(yaw), math.sin(yaw)
            r00, r01, r02 = cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
            r10, r11, r12 = sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
            r20, r21, r22 = -sp, cp * sr, cp * cr
            for leg in range(6):
                u, v, w = head[leg, 0], head[leg, 1], head[leg, 2]
                dx = x + r00 * u + r01 * v + r02 * w - base[leg, 0]
                dy = y + r10 * u + r11 * v + r12 * w - base[leg, 1]
                dz = z + r20 * u + r21 * v + r22 * w - base[leg, 2]
                lengths[i, leg] = math.sqrt(dx * dx + dy * dy + dz * dz)

    return with_numpy, solve, 6, [0.05, 0.05, 0.05, 0.2, 0.2, 0.2]


def delta(manipulator):
    """The closed forms of a Delta: the crank angles, zero where level and growing downwards."""
    legs = list(manipulator.legs.values())
    motors = np.array([leg[0].point for leg in legs])
    radius = np.hypot(motors[:, 0], motors[:, 1])
    out = motors[:, :2] / radius[:, None]
    elbow, ball = np.array(legs[0][1].point), np.array(legs[0][2].point)
    crank, rod = np.linalg.norm(elbow - motors[0]), np.linalg.norm(ball - elbow)
    inset = math.hypot(*(ball - manipulator.reference_point)[:2])
    ahead = float(radius[0] - inset)
    constant = crank * crank - rod * rod

    def with_numpy(poses):
        x, y, z = poses.T
        angles = np.empty((len(poses), 3))
        for leg in range(3):
            # The end of the rod from the motor: outwards, along its axis, upwards.
            a = out[leg, 0] * x + out[leg, 1] * y - ahead
            b = out[leg, 0] * y - out[leg, 1] * x
            square = a * a + z * z
            k = (square + b * b + constant) / (2 * crank)
            angles[:, leg] = np.arctan2(-z, a) - np.arccos(k / np.sqrt(square))
        return angles

    def solve(poses, angles):
        for i in range(len(poses)):
            x, y, z = poses[i]
            for leg in range(3):
                a = out[leg, 0] * x + out[leg, 1] * y - ahead
                b = out[leg, 0] * y - out[leg, 1] * x
                square = a * a + z * z
                k = (square + b * b + constant) / (2 * crank)
                angles[i, leg] = math.atan2(-z, a) - math.acos(k / math.sqrt(square))

    return with_numpy, solve, 3, [0.3, 0.3, 0.15]


def contenders(manipulator, numpy_code, solve, width):
    """What is timed, by name."""

    def in_parts(poses):
        found = np.empty((len(poses), width))
        for first in range(0, len(poses), PART):
            found[first : first + PART] = numpy_code(poses[first : first + PART])
        return found

    def compiled(code):
        def run(poses):
            found = np.empty((len(poses), width))
            code(poses, found)
            return found

        return run

    return {
        f"NumPy, {PART} poses at a time": in_parts,
        "numba": compiled(numba.njit(error_model="numpy")(solve)),
        "numba, `fastmath`": compiled(numba.njit(error_model="numpy", fastmath=True)(solve)),
        "opm": lambda poses: manipulator.inverse(poses, joints="actuated", threads=1).joints,
    }


def main():
    rows = []
    for name, make in (("hexapod", hexapod), ("delta", delta)):
        manipulator = opm.examples.load(name)
        numpy_code, solve, width, spread = make(manipulator)
        rng = np.random.default_rng(1)
        poses = np.array(manipulator.home) + rng.uniform(-1, 1, (POSES, len(spread))) * spread
        all_of = contenders(manipulator, numpy_code, solve, width)
        expected = all_of["opm"](poses)
        if np.isnan(expected).any():
            raise SystemExit(f"{name}: poses out of reach")
        for other, run in all_of.items():
            difference = np.abs(run(poses) - expected).max()
            if not difference < 1e-9:
                raise SystemExit(f"{name}: opm and {other} differ by {difference}")
        times = {other: [] for other in all_of}
        for _ in range(ROUNDS):
            for other, run in all_of.items():
                start = time.perf_counter()
                run(poses)
                times[other].append(time.perf_counter() - start)
        best = {other: min(seconds) for other, seconds in times.items()}
        for other, seconds in best.items():
            rows.append(f"| {name}, {other} | {1e9 * seconds / POSES:.0f} | {seconds / best['opm']:.2f} |")
    print("| actuated joints from Python, legs solved whole, one thread | ns a pose | of opm's time |")
    print("|---|---:|---:|")
    print("\n".join(rows))


if __name__ == "__main__":
    main()
