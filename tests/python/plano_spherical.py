"""The paper's 5-DoF plano-spherical manipulator (section 3.1) in closed form, for arrays of poses.

Written from the geometry of its legs, only for these tests. Metres and radians; the last axis of an
array is the leg.
"""

import numpy as np

# Printed in the paper.
ETA, BETA, ARC = np.radians([0, 120, 240]), np.radians(60), np.radians(75)
ARM_BASE, ARM_LINKS = np.array([0, 0.075]), (0.1, 0.1)
# Chosen by the project, because the paper prints none.
ALPHA, OFFSET, LINKS, SLIDER = np.radians([30, 150, 270]), 0.12, (0.2, 0.06), 0.3


def direction(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def platform_axes(zeta, xi, psi):
    """Unit vectors of the platform's three joint axes: Rz(zeta) Ry(xi) Rz(psi + eta) Ry(beta) z."""
    turn = psi[..., None] + ETA
    x, y, z = np.sin(BETA) * np.cos(turn), np.sin(BETA) * np.sin(turn), np.cos(BETA)
    xi, zeta = xi[..., None], zeta[..., None]
    x, z = np.cos(xi) * x + np.sin(xi) * z, np.cos(xi) * z - np.sin(xi) * x
    return np.cos(zeta) * x - np.sin(zeta) * y, np.sin(zeta) * x + np.cos(zeta) * y, z


def imaginary(zeta, xi, psi, upper=1):
    """The imaginary joints theta11, theta12, theta13, and each leg's margin of reach (of its sine).

    `upper` is 1 for the solution `atan2 + asin` and -1 for the other one.
    """
    x, y, z = platform_axes(zeta, xi, psi)
    sine = (np.cos(ARC) - np.cos(ARC) * z) / (np.sin(ARC) * np.hypot(x, y))
    turn = np.arcsin(np.clip(sine, -1, 1))
    return np.arctan2(y, x) + np.where(upper == 1, turn, np.pi - turn), 1 - np.abs(sine)


def sliders(x, y, theta, root=1):
    """The sliders S1, S2, S3, and the smaller margin of reach and of the sliders' limits.

    `root` is 1 for the positive square root and -1 for the negative one.
    """
    link, crank = LINKS
    to_platform = np.stack([x, y], axis=-1)[..., None, :]
    q = to_platform + crank * direction(theta) - OFFSET * direction(ALPHA)
    across = np.sum(q * direction(ALPHA), axis=-1)
    height = np.sqrt(np.maximum(link**2 - across**2, 0))
    value = np.sum(q * direction(ALPHA + np.pi / 2), axis=-1) + root * height
    return value, np.minimum(link - np.abs(across), SLIDER - np.abs(value))


def arm(x, y):
    """The joints phi14 and phi24, and the margin of the arm's reach."""
    first, second = ARM_LINKS
    dx, dy = x - ARM_BASE[0], y - ARM_BASE[1]
    distance = np.hypot(dx, dy)
    cosine = (distance**2 - first**2 - second**2) / (2 * first * second)
    elbow = np.arccos(np.clip(cosine, -1, 1))
    shoulder = np.arctan2(dy, dx) - np.arctan2(
        second * np.sin(elbow), first + second * np.cos(elbow)
    )
    return shoulder, elbow, first + second - distance


def nearest(angle, reference):
    """The value of an angle, modulo 2π, that is nearest to a reference."""
    return reference + (angle - reference + np.pi) % (2 * np.pi) - np.pi


def joints(x, y, zeta, xi, psi):
    """Every imaginary and actuated joint by its name, and the smallest margin of each pose.

    In the working mode `++ ++ ++ +`, with angles nearest to home modulo 2π. A pose is in the
    workspace if its margin is not negative.
    """
    home = np.zeros(1)
    theta_home = imaginary(home, home, home)[0][..., :1] + ETA  # the legs are equal
    shoulder_home, elbow_home, _ = arm(home, home)

    theta, upper = imaginary(zeta, xi, psi)
    slider, lower = sliders(x, y, theta)
    shoulder, elbow, stretch = arm(x, y)
    theta = nearest(theta, theta_home)
    values = {f"theta1{leg + 1}": theta[..., leg] for leg in range(3)}
    values |= {f"S{leg + 1}": slider[..., leg] for leg in range(3)}
    values["phi14"] = nearest(shoulder, shoulder_home)
    values["phi24"] = nearest(elbow, elbow_home)
    margin = np.minimum(np.minimum(upper, lower).min(axis=-1), stretch)
    return values, margin


def margins(x, y, zeta, xi, psi):
    """The smallest margin of each leg, as a dictionary by its choices (1, 1), (1, -1), ...; then that
    of the arm, which is the same for both of its elbows."""

    def leg(upper, root):
        theta, within_reach = imaginary(zeta, xi, psi, upper)
        return np.minimum(within_reach, sliders(x, y, theta, root)[1])

    return {(upper, root): leg(upper, root) for upper in (1, -1) for root in (1, -1)}, arm(x, y)[2]
