"""How many neighbours, or how many points: success and whole planning time of roadmaps in the tuning worlds ``apart``.

    python -m studies.benchmarks.neighbours -d 4 5 --worlds 40

Every cell plans in the same worlds, in turn: N points, k neighbours, smoothing included; means of processor time.
"""

from __future__ import annotations

import time

import numpy as np
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.roadmap import KNearest
from evenroad_studies.problems.apart import SIZES, Kind, Use, make

CELLS = ((256, 10), (256, 14), (256, 20), (320, 10), (384, 10), (512, 10), (512, 20))
FIRST = 60_000


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("-d", type=int, nargs="*", default=[4, 5])
    parser.add_argument("--worlds", type=int, default=40, help="of each kind")
    options = parser.parse_args()
    for d in options.d:
        problems = [
            make(Use.TUNING, kind, d, SIZES[Use.TUNING, kind, d], FIRST + i)
            for kind in Kind
            for i in range(options.worlds)
        ]
        solved, seconds = np.zeros((2, len(CELLS), len(problems)))
        for at, problem in enumerate(problems):
            for cell, (n, k) in enumerate(CELLS):
                begin = time.process_time()
                result = er.plan(problem.world, problem.start, problem.goal, er.PRM(n, rule=KNearest(k)))
                seconds[cell, at], solved[cell, at] = time.process_time() - begin, result.solved
        for (n, k), here, took in zip(CELLS, solved, seconds, strict=True):
            error = 100 * here.std() / np.sqrt(len(here))
            print(f"d={d} N={n} k={k}: {100 * here.mean():.1f} ({error:.1f}) %, {1e3 * took.mean():.1f} ms", flush=True)


if __name__ == "__main__":
    main()
