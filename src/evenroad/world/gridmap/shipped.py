"""The three mazes that ship, each with a query for a disk: harder and harder for points at random."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from evenroad._checks import require_known
from evenroad.world.gridmap.gridmap import DiskWorld, GridMap
from evenroad.world.gridmap.load import MAPS, load_map

LEVELS = (1, 2, 3)


@dataclass(frozen=True)
class Maze:
    """A maze and its query, in pixels: x right, y down, origin in the top-left corner."""

    level: int
    path: Path
    start: tuple[float, float]
    goal: tuple[float, float]
    robot_radius: float

    def map(self) -> GridMap:
        """Read the maze's picture."""
        return load_map(self.path)

    def world(self) -> DiskWorld:
        """Return the world of the maze's own robot."""
        return self.map().world(self.robot_radius)


def load_maze(level: int) -> Maze:
    """Return the maze of level 1, 2 or 3, harder and harder for uniform points; else an UnknownName."""
    require_known("maze level", level, LEVELS)
    record = json.loads((MAPS / "mazes.json").read_text(encoding="utf-8"))[str(level)]
    start, goal = tuple(record["start"]), tuple(record["goal"])
    return Maze(level, MAPS / record["image"], start, goal, record["robot_radius"])
