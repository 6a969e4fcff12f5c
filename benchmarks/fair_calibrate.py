"""How large the obstacles of the fair suite are: success of uniform points alone decides.

    python -m benchmarks.fair_calibrate --family balls boxes --out balls_boxes.csv
    python -m benchmarks.fair_calibrate --family maze se2 se3 --worlds 150 --check 400 --out others.csv

The rows of both are in docs/data/fair_calibration.csv.  For every family and dimension, uniform points are tried at
k = 10 (symmetrised) in random worlds of eight sizes; a logistic curve of the logarithm of the size through these gives
the sizes at which 25, 50 and 75 % of the queries are solved.  Each is then tried in more worlds.  All worlds are of the
stream `CALIBRATION`: neither tuning nor reporting ever sees them.  The columns:

* `uniform`: success in these worlds, in %;
* `dense`: success in the first 100 of them (10 in SE(3)) with eight times the points and k = 20: at least so many
  worlds have a solution;
* `free`: share of the cube that is free; `off_centre`: mean of |x - 1/2| over the coordinates of starts and goals,
  .25 if no place of the cube is preferred (mazes prefer their rim: two places half a map apart).
"""

from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path

import numpy as np

from benchmarks.nested_k import NEVER, smallest_k
from evenroad_studies.bench.task import Problem
from evenroad_studies.problems.fair import (
    BALLS,
    BOUNDED_AXES,
    BOXES,
    CALIBRATED_AT,
    Family,
    Stream,
    make_instance,
)

DENSE_WORLDS = {Family.SE3: 10}
"""Family -> worlds for the dense roadmap, where neighbours take seconds; 100 elsewhere."""

FIRST_LOOK = {Family.MAZE: (20.0, 60.0), Family.SE2: (0.012, 0.05), Family.SE3: (0.025, 0.065)}
"""Smallest and largest size that are tried, where no formula gives the free share."""

K = 10
TARGETS = (25, 50, 75)
FIRST_CHECK = 10**6
"""Instances from here on check what those below gave."""


def free_share_to_size(family: Family, d: int, free: float) -> float:
    """Return the size at which independent obstacles would leave this share of the cube."""
    covered = -math.log(free)
    if family is Family.BALLS:
        ball = math.pi ** (d / 2) / math.gamma(d / 2 + 1)
        return (covered / (BALLS[d] * ball)) ** (1 / d)
    return 0.5 * (covered / BOXES[d]) ** (1 / min(BOUNDED_AXES, d))


def solved(family: Family, d: int, size: float, instance: int, n: int, k: int) -> bool:
    """Return whether uniform points solve one instance of the calibration's stream."""
    problem = make_instance(Stream.CALIBRATION, family, d, 0, size, instance)
    points = np.random.default_rng([n, instance]).random((n, d))
    return smallest_k(problem, points, k) < NEVER


def sizes_for(family: Family, d: int, worlds: int) -> list[float]:
    """Return the sizes at which the fitted curve passes the targets: a coarse curve says where to look closely."""
    if family in FIRST_LOOK:
        coarse = np.geomspace(*FIRST_LOOK[family], 8)
    else:
        coarse = np.array([free_share_to_size(family, d, free) for free in np.geomspace(0.75, 0.08, 8)])
    intercept, slope = fitted_curve(family, d, coarse, worlds // 3, instance=0)
    ends = np.exp([(logit(share) - intercept) / slope for share in (15, 85)])
    # Far beyond what was tried, no world has room for a query any more.
    ends = np.clip(ends, 0.25 * coarse.min(), 1.2 * coarse.max())
    intercept, slope = fitted_curve(family, d, np.geomspace(*ends, 8), worlds, instance=10**5)
    return [math.exp((logit(target) - intercept) / slope) for target in TARGETS]


def logit(percent: float) -> float:
    return math.log(percent / (100 - percent))


def fitted_curve(
    family: Family, d: int, sizes: np.ndarray, worlds: int, instance: int
) -> tuple[float, float]:
    """Return intercept and slope of success over the logarithm of the size, from instances counted from `instance`."""
    rates = []
    for number, size in enumerate(sizes):
        first = instance + number * worlds
        rates.append(
            np.mean([solved(family, d, size, first + i, CALIBRATED_AT[family, d], K) for i in range(worlds)])
        )
    return logistic_fit(np.log(sizes), np.array(rates))


def logistic_fit(x: np.ndarray, rates: np.ndarray) -> tuple[float, float]:
    """Return intercept and slope of the logistic curve of greatest likelihood (Newton's method)."""
    centre = x.mean()
    design = np.column_stack([np.ones_like(x), x - centre])
    beta = np.zeros(2)
    for _ in range(50):
        fitted = 1 / (1 + np.exp(-design @ beta))
        information = design.T @ (design * (fitted * (1 - fitted))[:, None])
        step = np.linalg.solve(information, design.T @ (rates - fitted))
        # A full step from the flat start may overshoot a steep curve.
        beta += step * min(1.0, 5.0 / np.abs(step).max())
    return float(beta[0] - beta[1] * centre), float(beta[1])


def check(family: Family, d: int, target: int, size: float, worlds: int) -> dict[str, object]:
    """Return the row of one calibrated size."""
    instances = [FIRST_CHECK + 10**5 * target + i for i in range(worlds)]
    dense = [
        solved(family, d, size, i, 8 * CALIBRATED_AT[family, d], 20)
        for i in instances[: DENSE_WORLDS.get(family, 100)]
    ]
    problems = [make_instance(Stream.CALIBRATION, family, d, 0, size, i) for i in instances[:200]]
    probe = problems[0].world.space.from_cube(np.random.default_rng(0).random((500, d)))
    return {
        "family": family.name.lower(),
        "d": d,
        "difficulty": target,
        "size": f"{size:.4g}",
        "n": CALIBRATED_AT[family, d],
        "k": K,
        "worlds": worlds,
        "uniform": round(
            100
            * float(np.mean([solved(family, d, size, i, CALIBRATED_AT[family, d], K) for i in instances])),
            1,
        ),
        "dense": round(100 * float(np.mean(dense)), 1),
        "free": round(float(np.mean([problem.world.valid(probe).mean() for problem in problems])), 3),
        "off_centre": round(float(np.mean([off_centre(family, d, problem) for problem in problems])), 4),
    }


def off_centre(family: Family, d: int, problem: Problem) -> float:
    """Return the mean of |x - 1/2| over the coordinates of the two ends' places, as shares of the space's extent."""
    places, extent = d, np.ones(d)
    if family is Family.MAZE:
        extent = np.array([640.0, 480.0])
    elif family in (Family.SE2, Family.SE3):
        places = 2 if family is Family.SE2 else 3
        extent = np.ones(places)
    ends = np.stack([problem.start, problem.goal])[:, :places]
    return float(np.abs(ends / extent - 0.5).mean())


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("out/bench/fair_calibration.csv"))
    parser.add_argument("--worlds", type=int, default=300, help="worlds a size while searching")
    parser.add_argument("--check", type=int, default=600, help="worlds a calibrated size")
    parser.add_argument("--family", nargs="*", help="only these, e.g. balls se2")
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with open(options.out, "w", newline="") as file:
        writer = None
        for family, d in CALIBRATED_AT:
            if options.family and family.name.lower() not in options.family:
                continue
            for target, size in zip(TARGETS, sizes_for(family, d, options.worlds), strict=True):
                row = check(family, d, target, float(f"{size:.4g}"), options.check)
                writer = writer or csv.DictWriter(file, fieldnames=list(row), lineterminator="\n")
                if file.tell() == 0:
                    writer.writeheader()
                writer.writerow(row)
                file.flush()
                print("  ".join(f"{name} {value}" for name, value in row.items()), flush=True)


if __name__ == "__main__":
    main()
