"""How often does each sampler solve the level-1 maze with 128 points?  (The real table: docs/results.md.)"""

import evenroad as er
from evenroad.world.gridmap.load import load_maze

maze = load_maze(1)
world = maze.world()
for sampler in ("uniform", "halton", "sobol", "lattice", "hickernell", "even"):
    runs = 50
    solved = sum(
        er.plan(world, maze.start, maze.goal, er.PRM(er.draw(sampler, 128, 2, rng=run)), smooth=False).solved
        for run in range(runs)
    )
    print(f"{sampler:12} {100 * solved / runs:.0f} %")
