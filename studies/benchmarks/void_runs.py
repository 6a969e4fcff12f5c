"""A model of Table 1's corridors in R^2 and R^3, which no correct checker gives: a run is void with probability q.

    python -m studies.benchmarks.void_runs

In a void run no point is free, so that |V| is the 3 that the print adds.  In any other all N points are tested, and |V|
is 3 plus the free ones.  q is what gives the printed |V| of a cell; its printed standard deviation then tests the
model.  For MPMC, whose other runs nearly all succeed, the printed success tests it as well: it is 1 - q.
"""

from __future__ import annotations

import math
import tomllib
from importlib.resources import files

from studies.benchmarks.rows import parser_of

ADDED = 3.0
WIDTHS = {"corridor-2d-0.1": (2, 0.1), "corridor-3d-0.2": (3, 0.2)}
"""Problem -> dimension and width of the corridor."""

NEAR = 3.0
"""Largest difference from the print that counts as agreement, in milestones."""


def free_share(d: int, width: float) -> float:
    """Return the share of the cube that is free: d boxes along edges, each of which shares its end with the next."""
    one, end = width ** (d - 1), width**d
    return d * one - (d - 1) * end


def deviation(n: int, free: float, q: float, even: bool) -> float:
    """Return the standard deviation of |V|: whether a run is void, and for independent points how many are free."""
    count = n * free
    within = 0.0 if even else count * (1.0 - free)
    return math.sqrt((1.0 - q) * within + q * (1.0 - q) * count * count)


def main() -> None:
    parser_of(__doc__).parse_args()
    text = files("evenroad_studies.report").joinpath("expected/paper.toml").read_text(encoding="utf-8")
    rows = [row for row in tomllib.loads(text)["rows"] if row["problem"] in WIDTHS]
    agree, by_success, cells, of_mpmc = 0, 0, 0, 0
    print("| problem | sampler | N | q | deviation, print | model | V, print | V by success |")
    print("| :-- | :-- | --: | --: | --: | --: | --: | --: |")
    for row in rows:
        free = free_share(*WIDTHS[row["problem"]])
        for n, success, v, spread in zip(row["n"], row["success"], row["v"], row["v_sd"], strict=True):
            q = min(max(1.0 - (v - ADDED) / (free * n), 0.0), 1.0)
            model = deviation(n, free, q, row["sampler"] != "uniform")
            cells, agree = cells + 1, agree + (abs(model - spread) <= NEAR)
            again = ""
            if row["sampler"] == "mpmc":
                of_success = ADDED + success / 100.0 * free * n
                again = f"{of_success:.1f}"
                of_mpmc, by_success = of_mpmc + 1, by_success + (abs(of_success - v) <= NEAR)
            print(f"| {row['problem']} | {row['sampler']} | {n} | {q:.2f} | {spread} | {model:.1f} | {v} | {again} |")
    print(f"\nthe deviation is within {NEAR:g} of the print in {agree} of {cells} cells;")
    print(f"V by the success of MPMC is within {NEAR:g} of the print in {by_success} of {of_mpmc}")


if __name__ == "__main__":
    main()
