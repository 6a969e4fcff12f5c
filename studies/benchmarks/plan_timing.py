"""How long planning takes: phases of one warm query on each maze, imports, and the command from end to end.

    python -m studies.benchmarks.plan_timing

"first time" empties numba's cache (it goes to a fresh folder), so everything is compiled.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from evenroad.points import draw
from evenroad.roadmap import plan
from evenroad.world.gridmap.shipped import LEVELS, load_maze

REPEATS = 31


def query(level: int, n: int) -> dict[str, float]:
    """Return the median milliseconds of each phase, and of their sum without shortcutting."""
    maze = load_maze(level)
    world, points = maze.world(), draw("hickernell", n, 2)
    answers = [plan(world, maze.start, maze.goal, points).timings for _ in range(REPEATS)][3:]
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
    maze = load_maze(3)
    ends = ["--start", *map(str, maze.start), "--goal", *map(str, maze.goal)]
    disk = [str(maze.path), *ends, "--robot-radius", str(maze.robot_radius)]
    arm = ["box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside"]
    for name, options, n in (("level 3", disk, "1024"), ("--robot ur5", arm, "512")):
        end_to_end(name, options)
        end_to_end(f"{name} -n {n}", [*options, "-n", n])


def end_to_end(name: str, options: list[str]) -> None:
    """Print the seconds of ``evenroad plan`` with an empty cache and with a full one, and what of these is planning."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", "from evenroad.cli import main; raise SystemExit(main())", "plan"]
        command += [*options, "--out", str(Path(folder) / "result")]
        cache = {"NUMBA_CACHE_DIR": str(Path(folder) / "numba")}
        first = seconds(command, **cache)
        again, planning = [], []
        for _ in range(7):
            again.append(seconds(command, **cache))
            record = json.loads((Path(folder) / "result.json").read_text())
            planning.append(1e3 * sum(record["seconds"].values()))
        print(
            f"evenroad plan {name}: first time (compiles) {first:.2f} s; then median"
            f" {statistics.median(again):.2f} s of 7, max {max(again):.2f} s, of which planning"
            f" {statistics.median(planning):.1f} ms, max {max(planning):.1f} ms"
        )


if __name__ == "__main__":
    main()
