"""Designs the paper's 5-DoF manipulator by decomposition (9 parameters, then 16), and with all 25 at once, in the same budget.

The goal is a large dexterous area: positions in a square, 200 mm wide, that the platform reaches in every orientation
within 20 degrees of level (each of the three Euler angles). Both methods start at random designs within the same bounds
and evaluate the same number of designs. The results are medians over several seeds. `--quick` is a shorter run, which
the tests use. Needs `pip install 'opm-kinematics[design]'`.
"""

import argparse
import time
from statistics import median
from typing import Any

import numpy as np
import opm_kinematics as opm
from opm_kinematics import design

DEGREE = np.pi / 180
UPPER = design.Variables({name: (45 * DEGREE, 90 * DEGREE) for name in design.UPPER})
LOWER = design.Variables(
    {
        **{f"leg{i}.alpha": ((120 * i - 120) * DEGREE, (120 * i - 60) * DEGREE) for i in (1, 2, 3)},
        **{f"leg{i}.h": (0.0, 0.2) for i in (1, 2, 3)},
        **{f"leg{i}.a1": (0.1, 0.2) for i in (1, 2, 3)},
        **{f"leg{i}.a2": (0.03, 0.1) for i in (1, 2, 3)},
        "leg4.base": ((-0.1, 0.1), (0.0, 0.15)),
        "leg4.b1": (0.06, 0.12),
        "leg4.b2": (0.06, 0.12),
    }
)


def question(points: int, angles: int) -> dict[str, Any]:
    """The grid of positions and the grid of orientations."""
    tilt = 20 * DEGREE
    places = {"x": (-0.1, 0.1, points), "y": (-0.1, 0.1, points)}
    return {"places": places, "orientations": {name: (-tilt, tilt, angles) for name in ("zeta", "xi", "psi")}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--budget", type=int, default=1000, help="designs that each way looks at (default 1000)")
    parser.add_argument("--seeds", type=int, default=3, help="runs of each way (default 3)")
    parser.add_argument("--quick", action="store_true", help="one seed, 100 designs")
    options = parser.parse_args()
    budget, seeds = (100, 1) if options.quick else (options.budget, options.seeds)

    manipulator = opm.examples.load("plano-spherical-5dof").with_parameters({"limits.S": (-0.25, 0.25)})
    asked, finely = question(21, 5), question(41, 9)
    print(f"as shipped: {100 * design.dexterous(manipulator, **finely):5.1f} % of the places in every orientation")
    print(f"{len(UPPER)} + {len(LOWER)} parameters, {budget} designs a run\n")
    print("seed   way           dexterous   seconds   imaginary joints within (rad)")
    shares: dict[str, list[float]] = {"sections": [], "undivided": []}
    for seed in range(seeds):
        for way, results in shares.items():
            start = time.perf_counter()
            if way == "sections":
                found = design.sections(manipulator, UPPER, LOWER, budget=budget, seed=seed, **asked)
            else:
                found = design.undivided(manipulator, UPPER | LOWER, budget=budget, seed=seed, **asked)
            seconds = time.perf_counter() - start
            results.append(100 * design.dexterous(found.manipulator, **finely))
            ranges = "  ".join(f"{low:.2f}..{high:.2f}" for low, high in found.imaginary_range.values())
            print(f"{seed:4}   {way:<12} {results[-1]:8.1f} %   {seconds:7.1f}   {ranges}")
    print()
    for way, results in shares.items():
        print(f"{way:<12} median {median(results):5.1f} %, from {min(results):.1f} to {max(results):.1f} %")


if __name__ == "__main__":
    main()
