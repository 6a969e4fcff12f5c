"""Cars by an oracle: poses, and paths walked each tenth of a cell, tested by shapely's polygons.

The oracle shares nothing with the kernel: occupied cells are boxes of shapely, and footprints and paths are placed
here, from the pieces alone.  ``depot.yaml`` is the map of nav2_bringup; shapely is no dependency of evenroad::

    pip install shapely
    python -m studies.benchmarks.drive_walk --map depot.yaml --poses 1000000
    python -m studies.benchmarks.drive_walk --map depot.yaml --paths 500 --slice 3 --totals walked.json

Each slice has queries of its own, and `--totals` adds up what slices found, so that a long run is many short ones.
"""

from __future__ import annotations

import argparse
import json
import math
from collections import Counter
from pathlib import Path

import numpy as np
import shapely
from studies.benchmarks.drive import RADII, ROBOT

import evenroad as er
from evenroad._files import atomic_write

BATCH = 20_000
"""Number of poses that are tested at once."""
TOUCHING = 1e-7
"""A footprint that is smaller by this on all sides may touch: what is free may lie along a cell [m]."""
ROUNDING = 1e-9
"""Nearer to contact than this, both answers are right [m]."""


def obstacles(grid: er.GridMap) -> shapely.STRtree:
    """Return the occupied cells as boxes, a run of each row as one, and boxes around the map."""
    rows, columns = grid.shape
    padded = np.pad(grid.occupied, ((0, 0), (1, 1))).astype(int)
    row, first = np.nonzero(np.diff(padded, axis=1) == 1)
    last = np.nonzero(np.diff(padded, axis=1) == -1)[1]
    far = max(rows, columns)
    around = [(-far, -far, columns + far, 0), (-far, rows, columns + far, rows + far)]
    around += [(-far, 0, 0, rows), (columns, 0, columns + far, rows)]
    boxes = np.vstack([np.column_stack([first, row, last, row + 1]), around]).astype(float)
    corners = np.stack([boxes[:, [i, j]] for i, j in ((0, 1), (2, 1), (2, 3), (0, 3))], axis=1)
    on_map = grid.frame.to_map(corners.reshape(-1, 2)).reshape(-1, 4, 2)
    return shapely.STRtree(shapely.polygons(on_map))


def placed(outline: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Return the footprint at poses, (n, 3), as polygons of shapely, (n,)."""
    c, s = np.cos(poses[:, 2])[:, np.newaxis], np.sin(poses[:, 2])[:, np.newaxis]
    x, y = outline.T
    corners = np.stack([poses[:, :1] + c * x - s * y, poses[:, 1:2] + s * x + c * y], axis=2)
    return shapely.polygons(corners)


def meets(tree: shapely.STRtree, polygons: np.ndarray) -> np.ndarray:
    """Return which polygons have a point in common with an obstacle, (n,)."""
    met = np.zeros(len(polygons), dtype=bool)
    met[tree.query(polygons, predicate="intersects")[0]] = True
    return met


def driven(start: np.ndarray, pieces: np.ndarray, step: float) -> np.ndarray:
    """Return poses along pieces of a curvature and a signed length, at most a step apart, (n, 3)."""
    poses = [np.asarray(start, dtype=float)[np.newaxis]]
    for curvature, length in pieces:
        x, y, angle = poses[-1][-1]
        along = length * np.linspace(0.0, 1.0, max(math.ceil(abs(length) / step), 1) + 1)[1:]
        turned = angle + curvature * along
        if curvature == 0.0:
            at = x + along * math.cos(angle), y + along * math.sin(angle)
        else:
            at = (
                x + (np.sin(turned) - math.sin(angle)) / curvature,
                y - (np.cos(turned) - math.cos(angle)) / curvature,
            )
        poses.append(np.column_stack([*at, turned]))
    return np.concatenate(poses)


def check_poses(grid: er.GridMap, count: int, part: int) -> Counter[str]:
    """Compare random poses of the whole map."""
    world, tree, found = grid.world(footprint=ROBOT), obstacles(grid), Counter[str]()
    rng = np.random.default_rng([7, part])
    for first in range(0, count, BATCH):
        poses = world.space.from_cube(rng.random((min(BATCH, count - first), 3)))
        polygons, free = placed(np.array(ROBOT), poses), world.valid(poses)
        for row in np.nonzero(free == meets(tree, polygons))[0]:
            near = tree.geometries[tree.query(polygons[row], predicate="dwithin", distance=1.0)]
            depth = math.sqrt(max(shapely.area(shapely.intersection(polygons[row], near)), default=0.0))
            gap = min(shapely.distance(polygons[row], near), default=math.inf)
            found["poses that differ" if max(depth, gap) > ROUNDING else "poses at contact"] += 1
        found["poses"] += len(poses)
        found["free poses"] += int(free.sum())
    return found


def walk_paths(grid: er.GridMap, count: int, part: int) -> Counter[str]:
    """Walk the paths of random queries, a third for each turning radius."""
    tree, found = obstacles(grid), Counter[str]()
    smaller = np.array(shapely.Polygon(ROBOT).buffer(-TOUCHING, join_style="mitre").exterior.coords)[:-1]
    for number, radius in enumerate(RADII):
        world = grid.world(footprint=ROBOT, turning_radius=radius)
        wanted = (count + number) // len(RADII)
        q = world.space.from_cube(np.random.default_rng([8, part, number]).random((8 * wanted + 400, 3)))
        q = q[world.valid(q)][: 2 * wanted]
        for start, goal in zip(q[: len(q) // 2], q[len(q) // 2 :], strict=False):
            result = er.plan(world, start, goal)
            found["queries"] += 1
            if result.pieces is None:
                continue
            poses = driven(result.start, result.pieces, 0.1 * grid.resolution)
            end = np.abs(poses[-1] - goal)
            off = max(end[0], end[1], abs(math.remainder(poses[-1, 2] - goal[2], 2.0 * math.pi)))
            found["paths"] += 1
            found["poses on paths"] += len(poses)
            found["paths that touch"] += bool(meets(tree, placed(smaller, poses)).any())
            found["paths that end elsewhere"] += bool(off > 1e-6)
    return found


def main() -> None:
    """Run what the options name, and print or add up what is found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", type=Path, required=True)
    parser.add_argument("--poses", type=int, default=0, help="number of random poses")
    parser.add_argument("--paths", type=int, default=0, help="number of random queries")
    parser.add_argument("--slice", type=int, default=0, help="which queries and poses: each slice has others")
    parser.add_argument("--totals", type=Path, help="a JSON file that sums what slices found")
    given = parser.parse_args()
    grid = er.load_map(given.map)
    found = check_poses(grid, given.poses, given.slice) + walk_paths(grid, given.paths, given.slice)
    if given.totals is not None:
        before = json.loads(given.totals.read_text()) if given.totals.exists() else {"slices": [], "found": {}}
        if given.slice in before["slices"]:
            parser.error(f"slice {given.slice} is in {given.totals} already")
        found.update(before["found"])
        with atomic_write(given.totals) as file:
            file.write(json.dumps({"slices": [*before["slices"], given.slice], "found": found}).encode())
    for name in ("poses", "free poses", "poses at contact", "poses that differ", "queries", "paths", "poses on paths"):
        print(f"{name}: {found[name]}")
    for name in ("paths that touch", "paths that end elsewhere"):
        print(f"{name}: {found[name]}")


if __name__ == "__main__":
    main()
