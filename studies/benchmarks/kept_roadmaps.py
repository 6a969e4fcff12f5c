"""A kept roadmap in a scene that changes: what it takes to go on with what is known, beside a roadmap made anew.

    python -m studies.benchmarks.kept_roadmaps [--boxes 1000] [--changes 100] [--queries 5]

A roadmap of 64 milestones serves a UR5 among boxes of 5 to 20 mm.  In each change one of the boxes moves; then the same
queries, which have a path at first, are asked of the roadmap that was kept, and of one within the changed world made
anew.  Times are of the processor, medians with 95 % of their bootstrap.  Paths of both roadmaps are shortest along
their edges and not smoothed, so their lengths must be equal.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from itertools import islice
from typing import Any

import numpy as np
import numpy.typing as npt
from studies.benchmarks.rows import parser_of

import evenroad as er

Floats = npt.NDArray[np.float64]


def scene_of(count: int, rng: np.random.Generator) -> er.Scene:
    """Return boxes about a UR5."""
    away = rng.normal(size=(count, 3))
    away *= rng.uniform(0.6, 1.0, (count, 1)) / np.linalg.norm(away, axis=1, keepdims=True)
    return er.Scene.of_boxes(rng.uniform(0.005, 0.02, (count, 3)), away)


def timed(times: list[float], task: Callable[..., Any], *given: Any, **named: Any) -> Any:
    """Return what a task returns, and note its processor time [us]."""
    begin = time.process_time()
    made = task(*given, **named)
    times.append(1e6 * (time.process_time() - begin))
    return made


def length_of(path: Floats) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def shown(times: list[float], rng: np.random.Generator) -> str:
    """Return a median with its interval, in words."""
    medians = np.median(rng.choice(times, (1000, len(times))), axis=1)
    low, high = np.percentile(medians, [2.5, 97.5])
    return f"{np.median(times):.0f} us ({low:.0f} to {high:.0f})"


def main() -> None:
    options = parser_of(__doc__)
    options.add_argument("--boxes", type=int, default=1000)
    options.add_argument("--changes", type=int, default=100)
    options.add_argument("--queries", type=int, default=5)
    args = options.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    rng = np.random.default_rng(0)
    world = er.ArmWorld("ur5", scene_of(args.boxes, rng))
    roadmap = er.build_roadmap(er.ArmWorld("ur5"), er.draw("even", 64, 6))
    q = world.robot.random(rng, 20_000)
    q = q[world.valid(q)]
    kept: Any = roadmap.within(world)
    drawn = zip(q[::2], q[1::2], strict=False)
    joined = (pair for pair in drawn if len(kept.connect(pair[0], pair[1][np.newaxis], greed=1.0).path) > 2)
    pairs = list(islice(joined, args.queries))
    took: dict[str, list[float]] = {name: [] for name in ("kept", "anew", "query kept", "query anew")}
    lengths = found = unequal = 0
    for _ in range(args.changes):
        name = f"box {rng.integers(args.boxes)}"
        way = rng.normal(size=3)
        pose = er.Pose(tuple((way / np.linalg.norm(way) * rng.uniform(0.6, 1.0)).tolist()))
        world = world.moved({name: pose})
        _ = world.checker
        kept = timed(took["kept"], kept.within, world)
        anew: Any = timed(took["anew"], roadmap.within, world)
        for start, goal in pairs:
            if not world.valid(np.stack([start, goal])).all():
                continue
            one = timed(took["query kept"], kept.connect, start, goal[np.newaxis], greed=1.0)
            other = timed(took["query anew"], anew.connect, start, goal[np.newaxis], greed=1.0)
            lengths, found = lengths + 1, found + (other.goal >= 0)
            unequal += one.goal != other.goal or (one.goal >= 0 and length_of(one.path) != length_of(other.path))
    for name, times in took.items():
        print(f"{name:11s}: {shown(times, rng)}")
    print(f"{lengths} queries, {found} with a path, {unequal} with another length or another end")


if __name__ == "__main__":
    main()
