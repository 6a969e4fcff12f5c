"""The commands of docs/start/arm.md for one's own robot, as they are printed, with the robots of other people.

    python -m studies.benchmarks.arm_page OUT.csv ROBOT.urdf FOLDER ...
    python -m studies.benchmarks.arm_page OUT.csv --table

For each robot: its file stands in place of `my_arm.urdf`, in an empty folder with a fresh home, and each command is a
process of its own.  A row says with what they ended, what they printed last, how many arms the robot has (chains of at
least `ARM` joints, none of them another's), and the processor's seconds.
"""

from __future__ import annotations

import json
import os
import resource
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from studies.benchmarks.rows import given_or_table, parser_of, row_per_robot

from evenroad.loading.groups import chains
from evenroad.robot import load_robot

PAGE = Path(__file__).parents[2] / "docs" / "start" / "arm.md"
ARM = 4
"""A chain of fewer joints is no arm."""
FIELDS = (
    *("robot", "arms", "joints", "robot_exit", "robot_s", "plan_exit", "plan_s"),
    *("status", "proof", "bodies", "waypoints", "said"),
)


def printed_commands() -> list[str]:
    """Return the page's commands for one's own robot: that which writes the SRDF, and that which plans with it."""
    lines = [line.partition("  #")[0] for line in PAGE.read_text().splitlines()]
    return [line for line in lines if line.startswith("evenroad") and ("--write" in line or "--srdf my_arm" in line)]


def run(command: str, folder: Path) -> tuple[subprocess.CompletedProcess[str], float]:
    """Run a command of the page in a folder; return it, and the processor's seconds that it took."""
    words = [sys.executable, "-m", *shlex.split(command)]
    home = {"HOME": str(folder), "XDG_CACHE_HOME": str(folder / ".cache")}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, cwd=folder, env={**os.environ, **home}, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def last_line(done: subprocess.CompletedProcess[str]) -> str:
    """Return the last line that a command wrote: its error, if there is one."""
    lines = (done.stderr if done.returncode == 2 else done.stdout).strip().splitlines()
    return lines[-1][:200] if lines else ""


def measured(file: Path) -> dict[str, object]:
    """Return the row of one robot."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write, plan = (line.replace("my_arm.urdf", shlex.quote(str(file.resolve()))) for line in printed_commands())
        done, spent = run(write, folder)
        row: dict[str, object] = {"robot": file.stem, "robot_exit": done.returncode, "robot_s": round(spent, 1)}
        row["said"] = last_line(done)
        srdf = folder / "my_arm.srdf"
        if not srdf.exists():
            return row
        groups = chains(load_robot(file, srdf=srdf).joints).values()
        arms: list[set[str]] = []
        for chain in sorted(({joint.name for joint in group} for group in groups), key=len, reverse=True):
            if len(chain) >= ARM and not any(chain & other for other in arms):
                arms.append(chain)
        row |= {"arms": len(arms), "joints": max(map(len, groups), default=0)}
        done, spent = run(plan, folder)
        row |= {"plan_exit": done.returncode, "plan_s": round(spent, 1), "said": last_line(done)}
        found = json.loads((folder / "empty.json").read_text()) if (folder / "empty.json").exists() else {}
        row |= {key: found.get(key, "") for key in ("status", "proof", "bodies")}
        row["waypoints"] = len(found.get("path") or ())
    return row


def table(rows: Sequence[dict[str, str]]) -> str:
    """Return the rows as a table of a page."""
    head = ("robot", "joints", "ended with", "answer", "seconds")
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    for row in rows:
        answer = f"{row['status']}, {row['proof']}" if row["status"] else row["said"]
        spent = sum(float(row[key] or 0) for key in ("robot_s", "plan_s"))
        cells = (row["robot"], row["joints"], f"{row['robot_exit']}, {row['plan_exit']}", answer, f"{spent:.1f}")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Write a row for each robot as soon as it is there, or print the table of a file's rows."""
    given = given_or_table(parser_of(__doc__), table)
    row_per_robot(FIELDS, "*.urdf", measured, lambda file: file.stem, [given.out, *given.robots])


if __name__ == "__main__":
    main()
