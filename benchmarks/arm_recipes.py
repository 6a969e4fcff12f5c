"""Recipes of roadmaps on the problems that are kept for choosing, paired with the control.

    python -m benchmarks.arm_recipes --robot ur5-5 -n 256 --problems 60 --draws 2 --recipes 0:0 2:0 0:1500 2:1500

A recipe is GAMMA:ENDS, as `evenroad.make_roadmap` takes them; the control are the first scrambled Sobol points that
are free of robot and cell, in the same metric.  The differences have standard errors over problems.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evenroad.research.arms.problems import ARM_ROBOTS, draw_problem, joins
from evenroad.research.arms.roadmaps import cell_of, first_free
from evenroad.research.arms.robots import arm_named
from evenroad.research.arms.scenes import GENERATORS
from evenroad.robot_roadmap.make import joined, make_roadmap
from evenroad.robot_roadmap.pockets import links_of


def main() -> None:
    """Print success by generator and the difference from the control, for each recipe."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robot", default="ur5-5", choices=ARM_ROBOTS)
    parser.add_argument("-n", type=int, default=256)
    parser.add_argument("-k", type=int, default=10)
    parser.add_argument(
        "--links", type=int, help="of start and goal; default: as evenroad.robot_roadmap links them"
    )
    parser.add_argument("--problems", type=int, default=60, help="of each generator")
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("--recipes", nargs="+", default=["0:0", "2:0", "0:1500", "2:1500"])
    options = parser.parse_args()
    arm = arm_named(options.robot)
    cell, links = cell_of(arm), options.links or links_of(options.n)
    found = [
        draw_problem(options.robot, name, "tune", i) for name in GENERATORS for i in range(options.problems)
    ]
    kind = np.repeat(np.arange(len(GENERATORS)), options.problems)
    solved: dict[str, list[list[bool]]] = {}
    for draw in range(options.draws):
        for recipe in options.recipes:
            gamma, ends = recipe.split(":")
            began = time.process_time()
            made = make_roadmap(
                arm, cell, options.n, k=options.k, gamma=float(gamma), ends=int(ends), rng=1000 + draw
            )
            print(f"draw {draw}, {recipe}: made in {time.process_time() - began:.1f} s", flush=True)
            solved.setdefault(recipe, []).append([joins(made, problem, links) for problem in found])
        free = first_free(made.world, options.n, np.random.default_rng(2000 + draw))
        control = joined(made, free, options.k)
        solved.setdefault("control", []).append([joins(control, problem, links) for problem in found])
    shares = {recipe: np.mean(values, axis=0) for recipe, values in solved.items()}
    print(f"{options.robot}, N = {options.n}, {len(found)} problems, links {links}: " + " ".join(GENERATORS))
    for recipe, share in shares.items():
        apart = 100.0 * (share - shares["control"])
        cells = " ".join(f"{100.0 * share[kind == g].mean():4.0f}" for g in range(len(GENERATORS)))
        error = apart.std(ddof=1) / np.sqrt(len(apart))
        print(
            f"{recipe:10} {cells} | {100.0 * share.mean():5.1f} | {apart.mean():+5.1f} ± {error:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
