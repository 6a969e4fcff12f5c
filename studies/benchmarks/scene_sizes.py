"""What a scene costs by its size: boxes, points and triangles, to be made, to be checked, and in memory.

    python -m studies.benchmarks.scene_sizes OUT.csv OUT.png [--most 1e5] [--robot ROBOT.urdf]

The UR5, whose capsules decide, or a robot of a file, whose true shapes do, among the same bodies in ever more parts:
100 boxes of 5 to 20 cm, each cut into n / 100 boxes; the image of a depth camera with n points; a wavy plate of n
triangles.  Every row is a process of its own.  Times are of its processor, the least of several; memory is what the
process holds more when the world is made (Linux alone).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
from studies.benchmarks.arm_speed import random_boxes
from studies.benchmarks.sizes import alone, draw_costs, held, shown, sizes_parser, write_table

from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry import Mesh, PointCloud, TriangleMesh
from evenroad.loading.load import load_robot
from evenroad.scenes.scene import Scene

Floats = npt.NDArray[np.float64]
SIZES = {
    "boxes": (1, 10, 100, 300, 1000, 10_000, 100_000),
    "points": (1000, 10_000, 100_000, 307_200, 1_000_000, 10_000_000),
    "triangles": (1000, 10_000, 100_000, 1_000_000),
}
COLUMNS = ("what", "size", "free", "made [ms]", "memory [MB]", "configurations/s", "motions/s")


def boxes(count: int) -> Scene:
    """Return so many boxes; more than 100 are these, cut into equal parts."""
    whole = random_boxes(min(count, 100)).obstacles
    if count <= 100:
        return Scene(whole)
    each = count // 100
    parts = [max(k for k in range(1, round(each ** (1 / 3)) + 1) if each % k == 0)]
    left = each // parts[0]
    parts.append(max(k for k in range(1, int(left**0.5) + 1) if left % k == 0))
    parts.append(left // parts[1])
    cells = np.stack(np.meshgrid(*map(np.arange, parts), indexing="ij"), axis=-1).reshape(-1, 3) + 0.5
    sizes = np.repeat([np.array(box.size) / parts for box in whole], len(cells), axis=0)
    places = [np.array(box.xyz) + (cells / parts - 0.5) * box.size for box in whole]
    order = np.random.default_rng(5).permutation(len(sizes))
    return Scene.of_boxes(sizes[order], np.concatenate(places)[order])


def depth_image(count: int) -> Floats:
    """Return points that a camera sees of wavy ground with steps, to 2 mm, (about count, 3) [m]."""
    wide = int((count * 4 / 3) ** 0.5)
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, wide), np.linspace(-0.4, 0.4, count // wide))
    depth = 0.9 + 0.15 * np.sin(7 * u) * np.cos(9 * v) + 0.1 * (u * 5 % 1 > 0.5)
    depth += np.random.default_rng(0).normal(size=u.shape) * 0.002
    return np.stack([u * depth + 0.75, v * depth, 1.1 - depth], axis=-1).reshape(-1, 3)


def plate(count: int) -> TriangleMesh:
    """Return a wavy plate of about so many triangles."""
    side = int((count / 2) ** 0.5)
    x, y = np.meshgrid(np.linspace(0.3, 0.8, side + 1), np.linspace(-0.5, 0.5, side + 1), indexing="ij")
    corners = np.stack([x, y, 0.2 + 0.1 * np.sin(9 * x) * np.cos(7 * y)], axis=-1).reshape(-1, 3)
    first = (np.arange(side)[:, np.newaxis] * (side + 1) + np.arange(side)).ravel()
    a, b, c, d = first, first + 1, first + side + 1, first + side + 2
    return TriangleMesh(corners, np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)]))


def scene_of(what: str, size: int) -> Scene:
    """Return a scene of one kind and size."""
    if what == "boxes":
        return boxes(size)
    return Scene([PointCloud(depth_image(size), 0.005) if what == "points" else Mesh(plate(size))])


def least(task: Callable[[], object], repeats: int = 9) -> float:
    """Return the least processor time of a task [s]."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        task()
        times.append(time.process_time() - begin)
    return min(times)


def measured(what: str, size: int, of: str) -> tuple[str, int, float, float, float, float, float]:
    """Return a row of the table."""
    robot, scene = load_robot(of), scene_of(what, size)
    # What is loaded once for all does not count.
    _ = ArmWorld(robot, scene_of(what, 50)).checker, scene.rows
    before, begin = held(), time.process_time()
    world = ArmWorld(robot, scene)
    _ = world.checker
    made, memory = time.process_time() - begin, held() - before
    q = world.space.from_cube(np.random.default_rng(0).random((4000, world.space.dim)))
    free = q[world.valid(q)]
    a, b = free[:500], free[500:1000]
    rates = len(q) / least(lambda: world.valid(q)), len(a) / least(lambda: world.motion_valid(a, b))
    return what, size, len(free) / len(q), 1e3 * made, memory, *rates


def draw(rows: list[tuple[str, int, float, float, float, float, float]], file: Path) -> None:
    """Draw what a configuration takes, what a world takes to be made, and its memory, against the size."""
    titles = ("a configuration [us]", "a world is made [ms]", "memory held [MB]")
    curves = {
        what: [(size, 1e6 / rate, made, memory) for kind, size, _, made, memory, rate, _ in rows if kind == what]
        for what in SIZES
    }
    draw_costs(file, "boxes, points or triangles", titles, curves)


def main() -> None:
    """Measure, write and draw."""
    parser = sizes_parser(__doc__, 1e7)
    parser.add_argument("--robot", default="ur5", help="a URDF file: true shapes decide")
    args = parser.parse_args()
    sizes = [(what, size) for what, sizes in SIZES.items() for size in sizes if size <= args.most]
    rows = [shown(alone(measured, *each, args.robot)) for each in sizes]
    write_table(args.table, COLUMNS, rows)
    draw(rows, args.picture)


if __name__ == "__main__":
    main()
