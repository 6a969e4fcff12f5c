"""What queries cost by their number: `er.plan_many` beside a loop over `er.plan`, in time and in memory.

    python -m studies.benchmarks.many_sizes OUT.csv OUT.png [--most 1e5]

A UR5 among 25 boxes: motions of 0.2 times the way between random free configurations, and the whole ways; and whole
ways where each query has a world of its own.  Every row is a process of its own, in one thread.  Times are of the
processor, with the default smoothing; memory is what the process holds at most beyond what it held before.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from studies.benchmarks.plan_call import BOXES, boxes_around
from studies.benchmarks.sizes import alone, draw_costs, most_held, shown, sizes_parser, write_table

import evenroad as er

KINDS = ("short motions", "whole ways", "a world each", "a loop over plan")
SIZES = (1, 10, 100, 1000, 10_000, 100_000)
MOST_PLANS, MOST_WORLDS = 1000, 10_000
"""No more queries for the loop, and where each has its world."""
COLUMNS = ("what", "queries", "solved", "all [s]", "a query [us]", "memory [MB]")
Row = tuple[str, int, float, float, float, float]


def measured(kind: str, count: int) -> Row:
    """Return a row of the table."""
    world = er.ArmWorld("ur5", er.Scene.of_boxes(*boxes_around(BOXES)))
    rng = np.random.default_rng(3)
    q = world.robot.random(rng, 20_000)
    q = q[world.valid(q)]
    starts, goals = (q[rng.integers(len(q), size=2 * count + 20)] for _ in range(2))
    if kind == "short motions":
        goals = starts + 0.2 * (goals - starts)
    starts, goals = (ends[world.valid(goals)][:count] for ends in (starts, goals))
    for _ in range(2):
        _ = er.plan_many(world, q[:20], q[20:40], threads=1), er.plan(world, q[0], q[1])
    size, xyz = boxes_around(BOXES)
    worlds: Any = world
    if kind == "a world each":
        moves = rng.normal(size=(len(starts), *np.shape(xyz))) * 0.02
        worlds = [er.ArmWorld(world.robot, er.Scene.of_boxes(size, xyz + move)) for move in moves]
    before, begin = most_held(), time.process_time()
    if kind == "a loop over plan":
        solved = np.mean([er.plan(world, start, goal).solved for start, goal in zip(starts, goals, strict=True)])
    else:
        solved = er.plan_many(worlds, starts, goals, threads=1).solved.mean()
    took = time.process_time() - begin
    return kind, len(starts), float(solved), took, 1e6 * took / len(starts), most_held() - before


def main() -> None:
    """Measure, write and draw."""
    args = sizes_parser(__doc__, SIZES[-1]).parse_args()
    limits = dict(zip(KINDS, (args.most, args.most, MOST_WORLDS, MOST_PLANS), strict=True))
    asked = [(kind, size) for kind in KINDS for size in SIZES if size <= min(limits[kind], args.most)]
    rows: list[Row] = [shown(alone(measured, *each)) for each in asked]
    write_table(args.table, COLUMNS, rows)
    curves = {kind: [(row[1], row[4], row[5]) for row in rows if row[0] == kind] for kind in KINDS}
    draw_costs(args.picture, "queries", ("a query [us]", "memory [MB]"), curves)


if __name__ == "__main__":
    main()
