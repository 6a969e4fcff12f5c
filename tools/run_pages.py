"""Find the code in the pages, and run it: the tests and ``tools/run_examples.py`` read pages with this.

A page is a story: what one block makes, a later one may use.  What a page takes for granted (a file, a name) is put
there by `PREPARED`; commands that take long are run smaller, or not at all, as `INSTEAD` says, with the reason.
"""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import yaml

from evenroad.loading.find import example_robots

ROOT = Path(__file__).parents[1]
DATA = ROOT / "src" / "evenroad" / "loading" / "data"

MAPS = """
import numpy as np
from pathlib import Path
from PIL import Image
Image.fromarray(np.full((200, 200), 254, dtype=np.uint8)).save("office.pgm")
Path("office.yaml").write_text(
    "image: office.pgm\\nresolution: 0.05\\norigin: [0, 0, 0]\\n"
    "negate: 0\\noccupied_thresh: 0.65\\nfree_thresh: 0.2\\n")
"""
SQUARE = """
import numpy as np
import evenroad, evenroad as er
world = er.FunctionWorld(evenroad.space.BoxSpace((0, 0), (1, 1)), lambda q: abs(q[:, 0] - 0.5) > 0.1, 0.01)
start, goal, points = (0.1, 0.1), (0.3, 0.9), er.draw("cover", 512, 2)
"""
ARM = """
import evenroad as er
from evenroad.robot import ArmWorld
robot, cell = er.load_robot("ur5"), None
scene = er.load_scene("box-reach")
world, start, goal = ArmWorld(robot, scene), "home", "inside"
pose = er.Pose.from_rpy((0.65, 0, 0.2), (0, 1.5708, 0))
"""
CLOUD = """
import numpy as np, trimesh
from evenroad.geometry import Mesh, PointCloud
from evenroad.robot import Obstacle, Seen
points = np.random.default_rng(0).random((200, 3))
trimesh.creation.box((100, 100, 100)).export("shelf.stl")
"""
TRAJECTORY = "from evenroad.trajectory import arm_trajectory, save_trajectory\n"
PREPARED = {
    "guarantees.md": MAPS + SQUARE,
    "pose-goals.md": ARM,
    "arm-planning.md": ARM,
    "trajectories.md": ARM + TRAJECTORY,
    "clouds.md": CLOUD,
}
"""Page -> Python that is run before its first block."""

NEEDS = {"adapters.md": ("ompl", "klampt", "mujoco")}
"""Page -> packages of extras that its code imports; where they are missing, `make test-peers` runs it."""

ARM_FILES = ("robots.md", "arm.md", "ros2.md")
"""Pages that speak of ``my_arm.urdf``, ``cell.yaml`` and ``today.yaml``: files that stand for the reader's own."""


class Instead(NamedTuple):
    """What is run in place of a command, if anything, and why."""

    command: str | None
    why: str


TASTE = "--only maze-1 --runs 1 --jobs 1 --store"
INSTEAD = {
    "make *": Instead(None, "a Makefile's target: that there is such a one is tested"),
    "python3 -m venv *": Instead(None, "an environment: the release check makes one"),
    "pip install *": Instead(None, "needs a network: the release check tries it"),
    "evenroad ros2 *": Instead(None, "a node runs until it is stopped: tests/ros2 starts it"),
    "python -m studies.benchmarks*": Instead(None, "minutes to hours: that there is such a one is tested"),
    "evenroad bench paper --runs 400 *": Instead(f"evenroad bench paper {TASTE} paper.db", "18 minutes"),
    "evenroad bench fair --runs 400 *": Instead(
        "evenroad bench fair --only fair-balls-2d-50 --runs 1 --jobs 1 --store fair.db", "42 minutes"
    ),
    "evenroad bench paper --quick *": Instead(f"evenroad bench paper {TASTE} results.db", "half a minute"),
    "evenroad train -n 100 -d 2 --objective star *": Instead(
        "evenroad train -n 12 -d 2 --objective star --sets 1 --steps 20 -o sets", "minutes"
    ),
    "evenroad train -n 256 -d 2 --method mpmc *": Instead(
        "evenroad train -n 16 -d 2 --method mpmc --sets 1 --steps 2 -o plane", "minutes"
    ),
    "evenroad train -n 100 -d 2 --method mpmc *": Instead(
        "evenroad train -n 12 -d 2 --method mpmc --objective star --judge star --sets 1 --steps 2 -o stars",
        "minutes",
    ),
    "evenroad train -n 256 -d 3 --method mpmc *": Instead(
        'evenroad train -n 16 -d 3 --method mpmc --objective "prefixes(hickernell)" --sets 1 --steps 2 -o prefix-sets',
        "an hour",
    ),
    "evenroad view box-reach.json --gif *": Instead(None, "seconds of drawing: an example and tests/cli do"),
    "evenroad view box-reach.json": Instead(None, "serves a page until it is stopped"),
    "evenroad send box-reach.json --host *": Instead(None, "needs an arm: tests_peers has one on loopback"),
    "evenroad robot duo.urdf *": Instead(None, "a robot of two arms that does not ship"),
    "evenroad robot arm.urdf.xacro *": Instead(None, "needs a package of ROS"),
    "evenroad plan docs/data/humanoid_table.yaml *": Instead(None, "a humanoid that does not ship"),
}
"""A command, or how it begins -> what is run in its place."""

SMALLER = {
    "world, runs = maze.world(), 100": "world, runs = maze.world(), 5",
    # A cloud of 11 000 points: each clearance of a drawn state makes a surface of it.
    "(6000, 3))": "(600, 3))",
    "(3000, 3))": "(300, 3))",
    "(2000, 3))": "(200, 3))",
    # Each is smoothed until its time is over.
    "(0.6, 1.5, 0.0), (4.4, 1.5, 0.0))": "(0.6, 1.5, 0.0), (4.4, 1.5, 0.0), seconds=1)",
    "(0.6, 1.5, 0.0), (4.4, 1.5, 0.0), planner)": "(0.6, 1.5, 0.0), (4.4, 1.5, 0.0), planner, seconds=2)",
    "--count 64 --rows 32": "--count 16 --rows 8 --jobs 1",
}
"""Part of a block or command that takes long -> what is run in its place."""


if not example_robots():
    for each in ("evenroad robot panda", "evenroad plan shelf.yaml --robot panda *"):
        INSTEAD[each] = Instead(None, "needs the extra [robots]")


class Block(NamedTuple):
    """Code of a page: its language, "" where the page does not say, and the line it begins at."""

    language: str
    line: int
    code: str


def pages() -> list[Path]:
    """Return the README and all pages that are written by hand."""
    folder = ROOT / "docs"
    return [
        ROOT / "README.md",
        ROOT / "AGENTS.md",
        ROOT / "SKILL.md",
        *(each for each in sorted(folder.rglob("*.md")) if "generated" not in each.parts),
        *sorted((ROOT / "studies" / "docs").glob("*.md")),
    ]


def blocks(page: Path) -> list[Block]:
    """Return the code of a page, fenced or indented by four spaces."""
    found: list[Block] = []
    fence, language, begun, lines, before = "", "", 0, [], ""
    for number, line in enumerate(page.read_text().splitlines(), start=1):
        if fence:
            if line.strip() == fence:
                found.append(Block(language, begun, "\n".join(lines)))
                fence, lines = "", []
            else:
                lines.append(line)
        elif match := re.match(r"(```+|:::+)\s*(.*)", line):
            fence, language, begun = match[1], match[2].strip(), number
        elif line.startswith("    ") and not before.strip():
            found.append(Block("", number, line.strip()))
        before = line
    return found


def commands(block: Block) -> Iterator[str]:
    """Yield the commands of a shell block, with continued lines joined and without comments."""
    for command, _ in said(block):
        yield command


def said(block: Block) -> Iterator[tuple[str, bool]]:
    """Yield the commands, each with whether a comment behind it says that its exit code is 1."""
    for line in block.code.replace("\\\n", " ").splitlines():
        if words := shlex.split(line, comments=True):
            yield shlex.join(words), "exit code 1" in line


def instead_of(command: str) -> Instead | None:
    """Return what is run in place of a command; None if it is itself."""
    for pattern, instead in INSTEAD.items():
        if command == pattern or (pattern.endswith("*") and command.startswith(pattern[:-1])):
            return instead
    return None


def shortened(code: str) -> str:
    """Return a block or command with what takes long made smaller."""
    for long, short in SMALLER.items():
        code = code.replace(long, short)
    return code


def prepare(page: Path, names: dict[str, object]) -> None:
    """Put into the current folder, and among the names, what a page takes for granted."""
    exec(compile(PREPARED.get(page.name, ""), f"before {page.name}", "exec"), names)
    if page.name in ARM_FILES:
        for name in ("ur5.urdf", "ur5.srdf"):
            shutil.copy(DATA / name, name.replace("ur5", "my_arm"))
        shutil.copytree(DATA / "meshes", "meshes")
        scene = yaml.safe_load((DATA / "box-reach.yaml").read_text())
        Path("today.yaml").write_text(yaml.safe_dump(scene))
        Path("cell.yaml").write_text("obstacles:\n  fence: {shape: box, size: [0.1, 2, 1], xyz: [-1, 0, 0.5]}\n")


def run_page(page: Path) -> Iterator[tuple[Block, str]]:
    """Run a page's code in the current folder, block by block; yield each command or text that was run, before it is.

    Raises what the code raises, and AssertionError where a command gives neither 0 nor 1, or on one of the first pages
    1 without a comment that says so, or 0 with one.
    """
    from evenroad.cli import main

    names: dict[str, object] = {"__name__": page.stem}
    prepare(page, names)
    for block in blocks(page):
        if block.language == "python":
            code = shortened(block.code)
            yield block, code
            exec(compile("\n" * block.line + code, str(page), "exec"), names)
        elif block.language == "yaml":
            yield block, block.code
            yaml.safe_load(block.code)
        elif block.language == "sh":
            for command, is_refused in said(block):
                instead = instead_of(command)
                run = command if instead is None else instead.command
                if run is not None:
                    run = shortened(run)
                    yield block, run
                    answer = main(shlex.split(run)[1:])
                    # No path is an answer (1); a misspelt option would be 2.
                    allowed = (int(is_refused),) if page.parent.name == "start" else (0, 1)
                    assert answer in allowed, f"exit code {answer} of {run}"
