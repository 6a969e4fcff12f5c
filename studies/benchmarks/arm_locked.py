"""Proofs that an arm cannot get from one configuration to another: its first links alone cannot.

    python -m studies.benchmarks.arm_locked  # cages that trees do not solve, of the problems of arm_planner

What a plan itself proves in a tenth of a second (`evenroad.infeasibility.proof`), with finer cells and more joints.
"""

from __future__ import annotations

import numpy as np
from studies.benchmarks.arm_problems import REPORTING, Pool, Problem, arm_named, problems
from studies.benchmarks.rows import parser_of

from evenroad.collision.arm_world import ArmWorld
from evenroad.infeasibility.proof import THOROUGH, outer_bodies, shown_by

TRIES = (
    (3, (0.35, 0.35, np.inf), 20_000_000),
    (4, (0.35, 0.7, 1.4, np.inf), 40_000_000),
    (4, (0.35, 0.35, np.inf, np.inf), 100_000_000),
    (4, (0.5, 0.5, np.inf, np.inf), 300_000_000),
)
"""How many of the first joints are looked at, how far from an end the cells reach along each [rad], how many cells."""


def locked_by(problem: Problem) -> int:
    """Return by how many of the first joints it is proved that there is no path; 0 where that is not proved."""
    bodies = outer_bodies(ArmWorld(problem.robot, problem.scene))
    return len(shown_by(bodies, problem.start, problem.goal[np.newaxis], (), (*THOROUGH, *TRIES))[0])


def main() -> None:
    from studies.benchmarks.arm_planner import MOST_MOTIONS

    from evenroad.planning.arm_trees import connect

    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=30, help="cages for each arm, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    options = parser.parse_args()
    for name in options.arms:
        unsolved, solved = {}, 0
        for problem in problems(Pool(arm_named(name)), REPORTING[: options.count], ("cage",)):
            world = ArmWorld(problem.robot, problem.scene)
            goals = problem.goal[np.newaxis]
            if connect(world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60).goal >= 0:
                solved += 1
                continue
            unsolved[problem.seed] = joints = locked_by(problem)
            print(name, problem.seed, f"no path: {joints} joints show it" if joints else "open", flush=True)
        locked = sum(joints > 0 for joints in unsolved.values())
        print(
            f"{name}: {options.count} cages, {locked} proved to have no path; of the others {solved} are solved within"
            f" {MOST_MOTIONS} motions, open: {[seed for seed, joints in unsolved.items() if not joints]}"
        )


if __name__ == "__main__":
    main()
