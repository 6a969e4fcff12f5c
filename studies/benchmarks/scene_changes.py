"""What it takes to change the scene of a world: one obstacle moved, added or removed, beside a world made anew.

    python -m studies.benchmarks.scene_changes

Boxes of 3 to 10 cm lie around a UR5.  Time is that of the processor, the median of 500 changes.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

import numpy as np
from studies.benchmarks.rows import parser_of

import evenroad as er


def median(task: Callable[[], object], repeats: int = 500) -> float:
    """Return the median processor time of a task [us]."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        task()
        times.append(time.process_time() - begin)
    return 1e6 * float(np.median(times))


def measured(count: int) -> str:
    """Return, in words, what changes take among so many boxes."""
    rng = np.random.default_rng(0)
    away = rng.normal(size=(count, 3))
    away *= rng.uniform(0.35, 1.0, (count, 1)) / np.linalg.norm(away, axis=1, keepdims=True)
    scene = er.Scene.of_boxes(rng.uniform(0.03, 0.1, (count, 3)), away)
    world, pose, ball = er.ArmWorld("ur5", scene), er.Pose((0.4, 0.4, 0.4)), er.Sphere(0.03, name="ball")
    q = world.robot.random(rng, 1)[0]
    kinds: dict[str, Callable[[], object]] = {
        "moved": lambda: world.moved({"box 7": pose}),
        "added": lambda: world.with_(ball),
        "removed": lambda: world.without("box 7"),
        "moved and checked": lambda: world.moved({"box 7": pose}).valid(q),
    }
    took = [f"{what} {median(task):.1f} us" for what, task in kinds.items()]
    anew = median(lambda: er.ArmWorld(world.robot, scene), 10)
    return f"{count:6d} boxes: {', '.join(took)}; made anew {anew:.1f} us"


def main() -> None:
    options = parser_of(__doc__)
    options.add_argument("--sizes", nargs="*", type=int, default=[200, 1000, 10_000])
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for count in options.parse_args().sizes:
        print(measured(count))


if __name__ == "__main__":
    main()
