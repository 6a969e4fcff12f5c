"""``evenroad demo``: the main job on a map that ships with the package."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from evenroad.cli.plan import PlanDisk


@dataclass(frozen=True, kw_only=True)
class Demo:
    """Plan through a maze that ships with evenroad."""

    level: int = 3
    """Which maze: 1, 2 or 3, of rising difficulty."""
    n: Annotated[int, "-n"] = 1024
    """How many points to draw."""
    out: Path = Path("demo")
    """Where results go: OUT.png and OUT.json."""

    def run(self) -> int:
        """Run ``evenroad plan`` on the maze with its own start and goal."""
        from evenroad.research.mazes import load_maze

        maze = load_maze(self.level)
        return PlanDisk(
            world=maze.path,
            start=tuple(map(str, maze.start)),
            goal=(tuple(map(str, maze.goal)),),
            robot_radius=maze.robot_radius,
            n=self.n,
            out=self.out,
        ).run()
