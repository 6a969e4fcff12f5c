"""How long planning takes: phases of one warm query on each maze, imports, and the command from end to end.

    python -m benchmarks.plan_timing

"first time" empties numba's cache (it goes to a fresh folder), so everything is compiled.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from evenroad.mazes import LEVELS, load_maze
from evenroad.points import draw
from evenroad.roadmap import plan

REPEATS = 31


def query(level: int, n: int) -> dict[str, float]:
    """Return the median milliseconds of each phase, and of their sum without shortcutting."""
    maze = load_maze(level)
    world, points = maze.world(), draw("hickernell", n, 2)
    answers = [plan(world, maze.start, maze.goal, points).seconds for _ in range(REPEATS)][3:]
    phases = {phase: 1e3 * statistics.median(each[phase] for each in answers) for phase in answers[0]}
    needed = [sum(value for phase, value in each.items() if phase != "shortcut") for each in answers]
    return phases | {"without shortcut": 1e3 * statistics.median(needed)}


def seconds(command: list[str], **environment: str) -> float:
    began = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, env=os.environ | environment)
    return time.perf_counter() - began


def main() -> None:
    for level in LEVELS:
        row = "  ".join(f"{phase} {value:.2f}" for phase, value in query(level, 1024).items())
        print(f"level {level}, N=1024, median of {REPEATS - 3} [ms]: {row}")
    imports = [seconds([sys.executable, "-c", "import evenroad"]) for _ in range(7)]
    bare = [seconds([sys.executable, "-c", "pass"]) for _ in range(7)]
    print(
        f"import evenroad: {statistics.median(imports) - statistics.median(bare):.3f} s above a bare interpreter"
    )
    with tempfile.TemporaryDirectory() as folder:
        maze = load_maze(3)
        command = [sys.executable, "-c", "from evenroad.cli import main; raise SystemExit(main())", "plan"]
        command += [str(maze.path), "--start", *map(str, maze.start), "--goal", *map(str, maze.goal)]
        command += [
            "--robot-radius",
            str(maze.robot_radius),
            "-n",
            "1024",
            "--out",
            str(Path(folder) / "result"),
        ]
        cache = {"NUMBA_CACHE_DIR": str(Path(folder) / "numba")}
        print(f"evenroad plan, first time (compiles): {seconds(command, **cache):.2f} s")
        again = [seconds(command, **cache) for _ in range(7)]
        print(
            f"evenroad plan, afterwards: median {statistics.median(again):.2f} s of 7, max {max(again):.2f} s"
        )


if __name__ == "__main__":
    main()
