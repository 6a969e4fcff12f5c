"""Foreign robots, tried as their owners would: read, sampled, and planned for between two free configurations.

    python -m studies.benchmarks.robots FOLDER... --state after --out docs/data/robots.csv

Every URDF, xacro and MJCF in the folders that has a joint which moves is a row; files that are equal byte for byte
are one.  A robot is read without an SRDF, all its joints planned for, in empty space; where the refusal names an
option of `load_model` that would help (``--use-visuals``), the owner follows.  Each has a process and a time limit of
its own.  Rows of another state (``before``) that the CSV holds already stay.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import re
import resource
import signal
import subprocess
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from studies.benchmarks.rows import parser_of, write_rows

from evenroad.planning import plan

COLUMNS = ("robot", "state", "answer", "joints", "free_percent", "seconds", "reason")
SUFFIXES = (".urdf", ".xacro", ".xml")
MOVES = re.compile(rb"type\s*=\s*[\"'](revolute|continuous|prismatic)[\"']|<mujoco[\s\S]*<joint")
SAMPLES = 2000
MOTIONS = 300_000
"""That the plan may check; on a quiet core a few seconds."""

RIGHTLY = (
    "is missing",
    "which is no joint",
    "no joint that could be planned for",
    "the group must name one joint or more",
    "no collision geometry at all",
    "MuJoCo cannot read",
    "must satisfy lower <= upper",
    "more than one root",
    "must be 3 finite numbers",
    "must be a finite number",
    "unknown type of joint",
    "not well-formed",
)
"""Refusals of files in which a piece is not there, or wrong: what no reader could make up."""


def robots_in(folders: list[Path]) -> Iterator[tuple[str, Path]]:
    """Yield a short name and the file of every robot that moves."""
    seen = set()
    for folder in folders:
        for path in sorted(path for path in folder.rglob("*") if path.suffix in SUFFIXES):
            content = path.read_bytes()
            digest = hashlib.sha256(content).digest()
            if MOVES.search(content) and digest not in seen:
                seen.add(digest)
                yield "/".join(path.relative_to(folder).parts[-3:]), path


def tried(path: Path) -> dict[str, object]:
    """Return the row of one robot, without its name."""
    import numpy as np

    from evenroad.errors import EvenroadError
    from evenroad.points import draw
    from evenroad.roadmap import Budget
    from evenroad.robot import ArmWorld, Scene, load_model

    scene, options = Scene(name="empty space"), {}
    try:
        try:
            model = load_model(path)
        except EvenroadError as error:
            if "--use-visuals" not in str(error):
                raise
            options = {"use_visuals": True}
            model = load_model(path, **options)
        world = ArmWorld(model.robot, scene)
        q = world.space.from_cube(draw("halton", SAMPLES, world.space.cube_dim, rng=0).points)
        free = q[world.valid(q)]
        row = {"joints": world.space.dim, "free_percent": round(100.0 * len(free) / len(q), 1)}
        if len(free) < 2:
            pair = world.explain(np.mean([world.space.low, world.space.high], axis=0))
            return row | {"answer": "0 % free" if len(free) == 0 else "no path", "reason": pair}
        budget = Budget(seconds=600.0, motions=MOTIONS)
        result = plan(scene, free[0], free[-1], robot=str(path), limits=budget, **options)
    except EvenroadError as error:
        reason = str(error).replace(str(path.parent) + "/", "")
        drawn = "no collision geometry" in reason and b"<visual" in path.read_bytes()
        rightly = any(said in reason for said in RIGHTLY) and not drawn
        return {"answer": f"refused {'rightly' if rightly else 'wrongly'}", "reason": reason}
    if result.solved:
        return row | {"answer": "solved", "reason": "with its visuals" if options else ""}
    return row | {"answer": "no path", "reason": f"{result.status}: {result.message}"}


def in_its_process(path: Path, limit: float) -> dict[str, object]:
    """Return the row of one robot, and the processor time that it took, start of Python included."""
    try:
        run = subprocess.run(
            [sys.executable, "-m", "studies.benchmarks.robots", "--one", str(path)],
            capture_output=True,
            text=True,
            timeout=20.0 * limit,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit))),
        )
        lines = run.stdout.splitlines() or [""]
        row = json.loads(lines[-1]) if run.returncode == 0 else {"answer": "crashed", "reason": run.stderr[-300:]}
        if run.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            row = {"answer": "out of time", "seconds": limit}
    except subprocess.TimeoutExpired:
        row = {"answer": "out of time", "seconds": limit}
    return row


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("folders", type=Path, nargs="*")
    parser.add_argument("--state", default="after")
    parser.add_argument("--out", type=Path, default=Path("out/robots.csv"))
    parser.add_argument("--limit", type=float, default=180.0, help="processor seconds for one robot")
    parser.add_argument("--only", default="", help="robots with this in their name")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        warnings.simplefilter("ignore")
        print(json.dumps(tried(options.one) | {"seconds": round(time.process_time(), 1)}))
        return
    rows: dict[tuple[str, str], dict[str, object]] = {}
    if options.out.exists():
        with open(options.out, newline="") as file:
            rows = {(row["robot"], row["state"]): dict(row) for row in csv.DictReader(file)}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    chosen = [each for each in robots_in(options.folders) if options.only in each[0]]
    with ThreadPoolExecutor(options.jobs) as pool:
        answers = pool.map(lambda each: in_its_process(each[1], options.limit), chosen)
        for (name, _), row in zip(chosen, answers, strict=True):
            row["reason"] = " ".join(str(row.get("reason", "")).split())[:200]
            rows[name, options.state] = {"robot": name, "state": options.state, **row}
            print(f"{name:60} {row['answer']:16} {row.get('seconds')} s  {row['reason']}", flush=True)
            write_rows(options.out, COLUMNS, [rows[key] for key in sorted(rows)])
    for state in sorted({state for _, state in rows}):
        counts = Counter(row["answer"] for (_, of), row in rows.items() if of == state)
        print(f"{state}: " + ", ".join(f"{count} {answer}" for answer, count in counts.most_common()))


if __name__ == "__main__":
    main()
