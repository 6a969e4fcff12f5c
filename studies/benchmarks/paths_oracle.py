"""Paths of every public planner beside independent oracles, at a twentieth of the resolution; of disks, exactly.

    python -m studies.benchmarks.paths_oracle --csv studies/docs/data/paths_oracle.csv

Each kind of world: so many different shortened paths as asked for, shared out among the planners and some worlds, with
the paths along the roadmap that they came from.  "touch" counts those of which some state touches; "nearest" is the
least clearance of any: [mm] for arms, in units of the map or space for others.  "sampled" worlds ask the verdicts of
rigid bodies state by state, as a user's function is: their paths are looked at with the oracle's density, no more.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

from studies.benchmarks.rows import parser_of, write_rows
from tests.robots.kernel_arms import random_scene, random_tree, seven_joint_arm, ur5
from tests.studies.free_paths import (
    PLANNERS,
    disk_world,
    nearest,
    planners_of,
    queries,
    sampled,
    solid_world,
)

from evenroad.collision.certified import CertifiedWorld
from evenroad.robot import ArmWorld

QUERIES = 4
"""Of each world."""
TREES = (0, 3, 4, 5, 6, 8, 9, 10, 12, 13)


def _arms(robot: Any) -> Iterator[ArmWorld]:
    for seed in count():
        yield ArmWorld(robot, random_scene(1000 + seed, count=10, spread=1.0, clear=0.35))


def _trees() -> Iterator[ArmWorld]:
    for seed in count():
        scene = random_scene(100 + seed, spread=0.7, clear=0.45)
        yield ArmWorld(random_tree(TREES[seed % len(TREES)]), scene)


def _certified() -> Iterator[CertifiedWorld]:
    return (CertifiedWorld(world) for world in _arms(ur5(3.14)))


def _solids(kind: str) -> Iterator[Any]:
    return (solid_world(seed, kind) for seed in count())


KINDS: dict[str, tuple[Any, float, float]] = {
    "UR5": (lambda: _arms(ur5(3.14)), 1e3, 1.0),
    "seven joints": (lambda: _arms(seven_joint_arm()), 1e3, 1.0),
    "random trees": (_trees, 1e3, 1.0),
    "UR5, certified": (_certified, 1e3, 0.1),
    "disk": (lambda: (disk_world(seed) for seed in count()), 1.0, 0.5),
    "SE(2)": (lambda: _solids("SE(2)"), 1.0, 0.5),
    "SE(3)": (lambda: _solids("SE(3)"), 1.0, 0.5),
    "boxes, not turning": (lambda: _solids("boxes"), 1.0, 0.5),
    "SE(2), sampled": (lambda: map(sampled, _solids("SE(2)")), 1.0, 0.5),
    "SE(3), sampled": (lambda: map(sampled, _solids("SE(3)")), 1.0, 0.5),
}
"""Name -> endless worlds, factor of the clearance, and share of the paths asked for."""


@dataclass
class Row:
    """What the oracle said of one planner's paths."""

    solved: int = 0
    queries: int = 0
    shortened: list[float] = field(default_factory=list)
    raw: list[float] = field(default_factory=list)

    def cells(self, factor: float) -> list[object]:
        """Queries, solved, then of shortened and raw paths: how many, how many touch, the nearest."""
        cells: list[object] = [self.queries, self.solved]
        for values in (self.shortened, self.raw):
            cells += [len(values), sum(value <= 0.0 for value in values)]
            cells.append(f"{factor * min(values):.4f}" if values else "")
        return cells


HEADER = [
    *("world", "planner", "queries", "solved"),
    *("shortened", "shortened_touch", "shortened_nearest"),
    *("raw", "raw_touch", "raw_nearest"),
]


def compare(kind: str, wanted: int, most_seconds: float) -> list[list[object]]:
    """Return a row a planner, and one of all; different paths only, each looked at once."""
    make, factor, share = KINDS[kind]
    begin, rows, seen = time.perf_counter(), {}, set()
    for number, world in enumerate(make()):
        if sum(len(row.shortened) for row in rows.values()) >= share * wanted:
            break
        if time.perf_counter() - begin > most_seconds:
            print(f"{kind}: stopped after {most_seconds:g} s")
            break
        for start, goal in queries(world, QUERIES, seed=number):
            for planner in planners_of(world):
                row = rows.setdefault(planner, Row())
                row.queries += 1
                result = PLANNERS[planner](world, start, goal, smooth=True)
                if not result.solved or len(result.milestone_path) < 3:
                    # None, or straight at once.
                    continue
                row.solved += 1
                for path, values in ((result.path, row.shortened), (result.milestone_path, row.raw)):
                    if path.tobytes() not in seen:
                        seen.add(path.tobytes())
                        values.append(nearest(world, path))
    total = Row()
    for row in rows.values():
        total.queries, total.solved = total.queries + row.queries, total.solved + row.solved
        total.shortened, total.raw = total.shortened + row.shortened, total.raw + row.raw
    table = [[kind, name, *row.cells(factor)] for name, row in [*rows.items(), ("all", total)]]
    print(", ".join(map(str, table[-1])), f"({time.perf_counter() - begin:.0f} s)", flush=True)
    return table


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=1_100, help="shortened paths of each kind of arm")
    parser.add_argument("--only", nargs="*", default=list(KINDS), help="kinds of worlds")
    parser.add_argument("--seconds", type=float, default=3_600.0, help="at most, for each kind")
    parser.add_argument("--csv", type=Path, help="where the table goes, a line a planner")
    options = parser.parse_args()
    print(", ".join(HEADER))
    table: list[list[object]] = []
    for kind in options.only:
        table += compare(kind, options.count, options.seconds)
        if options.csv:
            # After each kind: all of them take a quarter of an hour.
            write_rows(options.csv, HEADER, [dict(zip(HEADER, row, strict=True)) for row in table])


if __name__ == "__main__":
    main()
