"""Sizes of obstacles of the family ``apart`` with which uniform points solve half of the worlds, as in ``apart.toml``.

    python -m studies.benchmarks.apart_sizes -d 2 3      # prints tables as in apart.toml

Bisection over the sizes between nothing and everything: 100 worlds of each kind, the N of the family, k = 10
symmetrised, start and goal linked by the rule.  ``apart.toml`` has the sizes of an earlier run of the same rule,
between other bounds; sizes differ by up to a third where success changes slowly with them.
"""

from __future__ import annotations

import numpy as np
from studies.benchmarks.rows import parser_of

from evenroad_studies.candidates import CANDIDATES
from evenroad_studies.connected import connected
from evenroad_studies.problems.apart import COUNTS, Kind, Use, make

OPENINGS = (Kind.SLOTS, Kind.ROOMS, Kind.CAVE)
SMALLEST, LARGEST = 0.01, 1.0


def success(use: Use, kind: Kind, d: int, size: float, worlds: int) -> float:
    """Return the share of worlds in which uniform points join start and goal."""
    draw, n = CANDIDATES["uniform"], COUNTS[d]
    found = [connected(make(use, kind, d, size, i), draw(n, d, i), (10,))[0, 0] for i in range(worlds)]
    return float(np.mean(found))


def size_of_half(use: Use, kind: Kind, d: int, worlds: int, halvings: int) -> float:
    """Return the size at which about half of the worlds are solved, by halving the logarithm of the bounds."""
    low, high = SMALLEST, LARGEST
    for _ in range(halvings):
        middle = float(np.sqrt(low * high))
        too_easy = success(use, kind, d, middle, worlds) > 0.5
        if too_easy == (kind in OPENINGS):
            high = middle
        else:
            low = middle
    return float(np.sqrt(low * high))


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("-d", type=int, nargs="*", default=list(COUNTS))
    parser.add_argument("--worlds", type=int, default=100)
    parser.add_argument("--halvings", type=int, default=7)
    options = parser.parse_args()
    for use in Use:
        for kind in Kind:
            print(f"[{use.name.lower()}.{kind.name.lower()}]")
            for d in options.d:
                print(f"{d} = {size_of_half(use, kind, d, options.worlds, options.halvings):.4g}", flush=True)


if __name__ == "__main__":
    main()
