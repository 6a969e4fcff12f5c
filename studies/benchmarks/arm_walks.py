"""An adversary of proofs that an arm cannot get somewhere: walks that it did take, every motion proved free.

    python -m studies.benchmarks.arm_walks  # 10 000 places that are joined to their starts by construction

Random arms (`tests.robots.kernel_arms`) with joints that turn, turn on, slide and follow others, whole and with a ball
for each body, among obstacles that lock some of them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from studies.benchmarks.rows import parser_of
from tests.robots.kernel_arms import random_scene, random_tree, walk

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.infeasibility.prefix_cells import piece_of
from evenroad.infeasibility.proof import QUICK, apart, outer_bodies

TRIES = (
    *QUICK,
    (1, (0.5,), 300),
    (2, (0.5, 0.5), 3_000),
    (3, (np.inf,) * 3, 20_000),
    (3, (0.5,) * 3, 20_000),
)
"""As of ``robot.separated``, with coarser cells: those are wrong where others are."""


def world_of(seed: int) -> ArmWorld:
    """Return a random arm among random obstacles."""
    robot = random_tree(seed)
    if seed % 3:
        balls = tuple(replace(each, b=each.a, radius=0.06) for each in robot.capsules)
        robot = replace(robot, capsules=balls, pairs=() if seed % 3 == 1 else robot.pairs)
    return ArmWorld(robot, random_scene(seed, count=6 + seed % 12, clear=0.4, spread=0.6))


def refuted(world: ArmWorld, places: Floats) -> tuple[int, int]:
    """Return how many proofs there are that the first place is apart from others, and how many of these are wrong."""
    shown, wrong, bodies = 0, 0, outer_bodies(world)
    for joints, reach, cells in TRIES:
        if joints <= world.space.dim:
            piece = piece_of(bodies, places[0], reach, cells)
            if piece is not None and not piece.reached.all():
                shown += 1
                wrong += sum(not piece.holds(place) for place in places)
    return shown, wrong + (apart(world, places[0], places[-1:], quickly=True) is not None)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--pairs", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1_000)
    options = parser.parse_args()
    pairs = shown = wrong = arms = 0
    seed = options.seed
    while pairs < options.pairs:
        seed += 1
        world, rng = world_of(seed), np.random.default_rng(seed)
        q = world.space.from_cube(rng.random((400, world.space.dim)))
        free = q[world.valid(q)]
        if not len(free):
            continue
        places = walk(world, rng, free[0], 25)
        now_shown, now_wrong = refuted(world, places)
        arms, pairs, shown, wrong = arms + 1, pairs + len(places) - 1, shown + now_shown, wrong + now_wrong
    print(f"{pairs} places of {arms} arms, {shown} times cells are closed off, {wrong} places wrongly outside of them")


if __name__ == "__main__":
    main()
