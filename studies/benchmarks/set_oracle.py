"""Paths of a data set beside the slow oracle of the tests, which shares no code with planners.

    python -m studies.benchmarks.set_oracle SET [--paths 160]

From files of `evenroad generate` in Parquet, of one of our robots, paths are drawn at random.  States along each,
0.02 rad apart, and those in time are looked at: how many touch, and the least clearance of any [m].
"""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
from studies.benchmarks.rows import parser_of
from tests.robots.oracle import clearance

import evenroad as er
from evenroad.scenes.scene_file import scene_of

STEP = 0.02
OF_EACH = 4
"""Paths of one file."""


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("set", type=Path)
    parser.add_argument("--paths", type=int, default=160)
    given = parser.parse_args()
    robot = er.load_robot(json.loads((given.set / "_card.json").read_text())["request"]["robot"])
    rng, files = np.random.default_rng(7), sorted(given.set.glob("part-*.parquet"))
    apart = []
    for number in rng.integers(len(files), size=-(-given.paths // OF_EACH)):
        table = parquet.read_table(files[number], filters=[("solved", "==", True)])
        for row in rng.integers(len(table), size=OF_EACH):
            problem = table.slice(int(row), 1).to_pylist()[0]
            scene = scene_of(json.loads(problem["scene"]), "drawn")
            path = np.array(problem["path"])
            assert np.array_equal(path[[0, -1]], [problem["start"], problem["goal"]])
            along = [
                a + np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(b - a) / STEP))[:, None] * (b - a)
                for a, b in pairwise(path)
            ]
            apart.append(clearance(robot, scene, np.concatenate([*along, np.array(problem["states"], dtype=float)])))
    every = np.concatenate(apart)
    touching = sum(bool((each <= 0).any()) for each in apart)
    print(
        f"{len(apart)} paths, {len(every)} states: {touching} paths touch, the least clearance is {every.min():.2e} m"
    )


if __name__ == "__main__":
    main()
