"""Draw the three shipped mazes, and measure how hard they are for uniform points.

    python tools/draw_mazes.py            # draw: src/evenroad/mazes/level{1,2,3}.png and mazes.json
    python tools/draw_mazes.py --measure  # success of uniform points on the drawn mazes, 400 runs a cell

The design rule: only the success of *uniform* points may guide it, so that no sampler is favoured.  With k = 10
symmetrised, uniform points should solve level 1 in about 90 % of runs at N = 256 and level 2 at N = 512; level 3 in
60 to 85 % at N = 1024.  The seeds used here (from 900000) are never used by a table.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

FOLDER = Path(__file__).parents[1] / "src" / "evenroad" / "mazes"
WIDTH, HEIGHT, ROBOT_RADIUS = 640, 480, 6.0
TUNING_SEED = 900_000


@dataclass(frozen=True)
class Design:
    """A rectangular maze: a random spanning tree of rooms, with a share of the remaining walls taken out."""

    cols: int
    rows: int
    wall: int
    """Thickness of walls in pixels."""
    door: int
    """Width of the opening between two rooms in pixels."""
    loops: float
    """Share of the walls outside the spanning tree that get a door too."""
    seed: int


DESIGNS = {
    1: Design(cols=7, rows=5, wall=10, door=50, loops=0.20, seed=12),
    2: Design(cols=8, rows=6, wall=8, door=54, loops=0.15, seed=15),
    3: Design(cols=10, rows=8, wall=8, door=32, loops=0.10, seed=13),
}


def draw(design: Design) -> tuple[np.ndarray, tuple[float, float], tuple[float, float]]:
    """Return the maze as bool (480, 640), True = wall, with start and goal in opposite rooms."""
    random = np.random.default_rng(design.seed)
    xs = np.linspace(0, WIDTH, design.cols + 1).round().astype(int)
    ys = np.linspace(0, HEIGHT, design.rows + 1).round().astype(int)
    wall = np.zeros((HEIGHT, WIDTH), dtype=bool)
    half = design.wall // 2
    for x in xs:
        wall[:, max(0, x - half) : x + half] = True
    for y in ys:
        wall[max(0, y - half) : y + half, :] = True
    for (c, r), (c2, r2) in _doors(design, random):
        # A door is a gap somewhere along the shared wall, not always in the middle.
        if r == r2:
            x, low, high = xs[max(c, c2)], ys[r] + half, ys[r + 1] - half
            at = _door_start(low, high, design.door, random)
            wall[at : at + min(design.door, high - low), x - half : x + half] = False
        else:
            y, low, high = ys[max(r, r2)], xs[c] + half, xs[c + 1] - half
            at = _door_start(low, high, design.door, random)
            wall[y - half : y + half, at : at + min(design.door, high - low)] = False
    return wall, _centre(xs, ys, 0, 0), _centre(xs, ys, design.cols - 1, design.rows - 1)


def _centre(xs: np.ndarray, ys: np.ndarray, c: int, r: int) -> tuple[float, float]:
    return float(xs[c] + xs[c + 1]) / 2, float(ys[r] + ys[r + 1]) / 2


def _door_start(low: int, high: int, door: int, random: np.random.Generator) -> int:
    return int(random.integers(low, max(low, high - door) + 1))


def _doors(design: Design, random: np.random.Generator) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Return the pairs of rooms that are joined: a depth-first spanning tree, and some loops."""
    doors = []
    stack, seen = [(0, 0)], {(0, 0)}
    while stack:
        room = stack[-1]
        fresh = [other for other in _neighbours(room, design) if other not in seen]
        if not fresh:
            stack.pop()
            continue
        other = fresh[random.integers(len(fresh))]
        doors.append((room, other))
        seen.add(other)
        stack.append(other)
    joined = {frozenset(pair) for pair in doors}
    for c in range(design.cols):
        for r in range(design.rows):
            for other in ((c + 1, r), (c, r + 1)):
                inside = other[0] < design.cols and other[1] < design.rows
                if inside and frozenset(((c, r), other)) not in joined and random.random() < design.loops:
                    doors.append(((c, r), other))
    return doors


def _neighbours(room: tuple[int, int], design: Design) -> list[tuple[int, int]]:
    c, r = room
    around = ((c + 1, r), (c - 1, r), (c, r + 1), (c, r - 1))
    return [(x, y) for x, y in around if 0 <= x < design.cols and 0 <= y < design.rows]


def success(wall: np.ndarray, start: tuple, goal: tuple, n: int, runs: int, k: int = 10) -> float:
    """Return the share of runs in which uniform points join start and goal."""
    from evenroad.points import draw as draw_points
    from evenroad.roadmap import KNearest, plan
    from evenroad.world import GridMap

    world = GridMap(wall).world(ROBOT_RADIUS)
    solved = 0
    for run in range(runs):
        points = draw_points("uniform", n, 2, rng=TUNING_SEED + run)
        solved += plan(world, start, goal, points, rule=KNearest(k), shorten=False).solved
    return solved / runs


def main() -> None:
    """Draw, or measure with --measure."""
    records = {}
    for level, design in DESIGNS.items():
        wall, start, goal = draw(design)
        if "--measure" in sys.argv:
            rates = {n: success(wall, start, goal, n, runs=400) for n in (128, 256, 512, 1024)}
            print(f"level {level}: " + "  ".join(f"N={n} {100 * rate:.1f} %" for n, rate in rates.items()))
            continue
        Image.fromarray(np.where(wall, 0, 255).astype(np.uint8)).save(
            FOLDER / f"level{level}.png", optimize=True
        )
        records[str(level)] = {
            "image": f"level{level}.png",
            "start": start,
            "goal": goal,
            "robot_radius": ROBOT_RADIUS,
        }
    if records:
        (FOLDER / "mazes.json").write_text(json.dumps(records, indent=2) + "\n")


if __name__ == "__main__":
    main()
