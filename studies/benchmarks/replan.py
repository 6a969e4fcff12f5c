"""What an update of `er.Replanner` takes: a UR5 drives among 100 boxes that all move, 100 times a second.

    python -m studies.benchmarks.replan

Boxes of 2 to 6 cm float at up to 0.3 m/s between 0.45 and 1.2 m from the base, through whatever is there.  The arm
follows its path at two radians a second, and takes another goal where it arrives.  Where a box stays in the arm, or in
its goal, updates have no path: they count, too.  Time is that of the processor, with what the scene is changed by.
"""

from __future__ import annotations

import os
import time
from collections import defaultdict

import numpy as np
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad._arrays import Floats
from evenroad.space.path import configuration_at

TICK, SPEED = 0.01, 2.0
NEAR, FAR = 0.45, 1.2


class Boxes:
    """Boxes that float, and turn back at two balls around the base."""

    def __init__(self, count: int, rng: np.random.Generator) -> None:
        directions, self.speeds = (rng.normal(size=(count, 3)) for _ in range(2))
        self.positions = (
            directions * rng.uniform(NEAR, FAR, (count, 1)) / np.linalg.norm(directions, axis=1, keepdims=True)
        )
        self.speeds *= 0.3 * rng.random((count, 1)) / np.linalg.norm(self.speeds, axis=1, keepdims=True)
        self.scene = er.Scene.of_boxes(rng.uniform(0.02, 0.06, (count, 3)), self.positions)

    def move(self) -> dict[str, er.Pose]:
        """Float on for one tick, and return where all of them are."""
        self.positions = self.positions + TICK * self.speeds
        away = np.linalg.norm(self.positions, axis=1)
        self.speeds[(away < NEAR) | (away > FAR)] *= -1.0
        return {name: er.Pose(tuple(position)) for name, position in zip(self.scene.names, self.positions, strict=True)}


def drive(boxes: Boxes, goals: Floats, updates: int, took: dict[str, list[float]]) -> int:
    """Drive along the goals, and return how many were reached; `took` gets the time of each update [s]."""
    reached, q = 0, goals[0]
    live = er.Replanner(er.ArmWorld("ur5", boxes.scene), goals[1])
    for _ in range(updates):
        moved = boxes.move()
        begin = time.process_time()
        result = live.update(q, moved=moved)
        took[f"{result.planner}, {result.status}"].append(time.process_time() - begin)
        if result.path is None or result.cost is None:
            continue
        if result.cost > SPEED * TICK:
            q = configuration_at(result.path, live.world.space, SPEED * TICK / result.cost)[0]
        else:
            reached += 1
            q, live = goals[reached], er.Replanner(live.world, goals[reached + 1])
    return reached


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--boxes", type=int, default=100)
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--updates", type=int, default=1000)
    options = parser.parse_args()
    took: dict[str, list[float]] = defaultdict(list)
    reached = 0
    for seed in range(options.runs):
        rng = np.random.default_rng(seed)
        boxes = Boxes(options.boxes, rng)
        world = er.ArmWorld("ur5", boxes.scene)
        drawn = world.robot.random(rng, 4000)
        reached += drive(boxes, drawn[world.valid(drawn)][: options.updates + 2], options.updates, took)
    took["all"] = [each for times in took.values() for each in times]
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}; {reached} goals reached")
    for what, times in took.items():
        median, most = 1e3 * np.percentile(times, (50, 99))
        print(f"{what:25s} {len(times):6d} updates, median {median:.2f} ms, 99 %: {most:.2f} ms")


if __name__ == "__main__":
    main()
