"""Draw the three shipped mazes, and measure how hard they are for uniform points.

    python studies/tools/draw_mazes.py          # draw: src/evenroad/world/gridmap/maps/maze{1,2,3}.png and mazes.json
    python studies/tools/draw_mazes.py --measure # success of uniform points on the drawn mazes, 400 runs a cell

The design rule: only the success of *uniform* points may guide it, so that no sampler is favoured.  With k = 10
symmetrised, uniform points should solve level 1 in about 90 % of runs at N = 256 and level 2 at N = 512; level 3 in
60 to 85 % at N = 1024.  The seeds used here (from 900000) are never used by a table.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from evenroad.planning import PRM
from evenroad_studies.mazes import DrawnMaze, MazeDesign, draw_maze

FOLDER = Path(__file__).parents[2] / "src" / "evenroad" / "world" / "gridmap" / "maps"
ROBOT_RADIUS = 6.0
TUNING_SEED = 900_000


DESIGNS = {
    1: (MazeDesign(cols=7, rows=5, wall=10, door=50, loops=0.20), 12),
    2: (MazeDesign(cols=8, rows=6, wall=8, door=54, loops=0.15), 15),
    3: (MazeDesign(cols=10, rows=8, wall=8, door=32, loops=0.10), 13),
}
"""Level -> design and seed."""


def success(maze: DrawnMaze, n: int, runs: int, k: int = 10) -> float:
    """Return the share of runs in which uniform points join start and goal."""
    from evenroad.points import draw as draw_points
    from evenroad.roadmap import KNearest, plan

    world = maze.map.world(ROBOT_RADIUS)
    solved = 0
    for run in range(runs):
        points = draw_points("uniform", n, 2, rng=TUNING_SEED + run)
        solved += plan(world, maze.start, maze.goal, PRM(points, rule=KNearest(k), links=None), smooth=False).solved
    return solved / runs


def main() -> None:
    """Draw, or measure with --measure."""
    records = {}
    for level, (design, seed) in DESIGNS.items():
        maze = draw_maze(design, rng=seed)
        if "--measure" in sys.argv:
            rates = {n: success(maze, n, runs=400) for n in (128, 256, 512, 1024)}
            print(f"level {level}: " + "  ".join(f"N={n} {100 * rate:.1f} %" for n, rate in rates.items()))
            continue
        Image.fromarray(np.where(maze.map.occupied, 0, 255).astype(np.uint8)).save(
            FOLDER / f"maze{level}.png", optimize=True
        )
        records[str(level)] = {
            "image": f"maze{level}.png",
            "start": maze.start,
            "goal": maze.goal,
            "robot_radius": ROBOT_RADIUS,
        }
    if records:
        (FOLDER / "mazes.json").write_text(json.dumps(records, indent=2) + "\n")


if __name__ == "__main__":
    main()
