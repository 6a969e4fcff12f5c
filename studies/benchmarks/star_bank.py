"""The bank of least star discrepancies, N = 1 .. 512 in two and three dimensions: checked, or searched on.

    python -m studies.benchmarks.star_bank               # every kept value computed anew, beside published ones
    python -m studies.benchmarks.star_bank --search 64 128 -d 3 --seed 7      # better sets take the place of kept ones
    python -m studies.benchmarks.star_bank --from-random 20                   # 64 random sets, annealed and placed anew

In the plane orders of the points are searched and each is placed exactly (``training.order``), in space sets are
annealed and relaxed (``training.relax``).  Published values that are lower and whose sets we do not have are named.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of, write_rows

import evenroad_studies
from evenroad import __version__
from evenroad.points import PointSet, draw
from evenroad.points.anneal import anneal
from evenroad.points.bank.star import LARGEST, Record, records
from evenroad.points.measures import MEASURES, star_discrepancy
from evenroad_studies.training.order import place_order, search_orders
from evenroad_studies.training.relax import search_in_space

OPTIMAL = "optimum, Clement, Doerr, Klamroth and Paquete 2023"
PUBLISHED = {
    10: (0.1111, OPTIMAL),
    16: (0.0739, OPTIMAL),
    20: (0.0604, OPTIMAL),
    60: (0.02336, "best public set"),
    100: (0.01504, "best public set"),
    140: (0.01151, "best public set"),
    260: (0.00831, "best public set"),
    500: (0.00509, "best public set"),
}
"""N in the plane -> least published value, and whose."""
SEED, FINDER = 20261124, f"evenroad {__version__}"
FEW, TRIES, HEATS = 21, 12, (0.003, 0.008, 0.02)
"""Number of points up to which more is tried: optimal sets are published so far."""
FOLDER = Path(evenroad_studies.__file__).parent / "sets" / "star"


def searched(n: int, d: int, seed: int) -> PointSet:
    """Return the best set of one search, as float32 numbers."""
    rng = np.random.SeedSequence([SEED, seed, d, n])
    if d == 2 and n <= FEW:
        tries = zip(rng.spawn(TRIES), HEATS * TRIES, strict=False)
        each = (search_orders(n, steps=40_000, heat=heat, rng=own) for own, heat in tries)
        made = min(each, key=lambda found: found.value)
    elif d == 2:
        made = search_orders(n, steps=8000 if n <= 100 else 4000 if n <= 260 else 2000, rng=rng)
    else:
        tries, sweeps = (8, 30) if n <= 64 else (2, 30) if n <= 128 else (1, 15) if n <= 256 else (1, 3)
        made = search_in_space(n, tries=tries, sweeps=sweeps, rng=rng)
    return PointSet(made.points.astype(np.float32))


def print_from_random(n: int, sets: int = 64) -> None:
    """Print the star discrepancies of random sets in the plane, annealed for the L2 one, and placed anew."""
    annealed = [anneal(n, 2, MEASURES["star"], steps=2000, rng=seed).points for seed in range(sets)]
    # The i-th point by x is the order[i]-th by y.
    orders = [np.argsort(np.argsort(points[np.argsort(points[:, 0]), 1])) for points in annealed]
    placed = [place_order(order).value for order in orders]
    for name, values in (("annealed", [star_discrepancy(each) for each in annealed]), ("placed anew", placed)):
        error = np.std(values, ddof=1) / np.sqrt(sets)
        print(f"n={n}, {sets} sets, {name}: best {min(values):.4f}, mean {np.mean(values):.4f} ({error:.4f})")


def check(d: int) -> int:
    """Compare kept values with those of the sets, print those that are published, and return how many differ."""
    wrong = 0
    for n, record in records(d).items():
        exact = star_discrepancy(draw("star", n, d))
        wrong += abs(exact - record.value) > 1e-12
        if d == 2 and n in PUBLISHED:
            value, whose = PUBLISHED[n]
            print(f"d=2 n={n}: {exact:.5f}, published {value} ({whose})", flush=True)
    print(f"d={d}: {len(records(d))} values, {wrong} differ")
    return wrong


def write_sets(d: int, found: dict[int, PointSet]) -> None:
    """Put sets into the place of those that are kept, with their exact values."""
    sets = np.zeros((LARGEST * (LARGEST + 1) // 2, d), dtype=np.float32)
    rows = {}
    if (FOLDER / f"d{d:02d}.npy").exists():
        sets[:] = np.load(FOLDER / f"d{d:02d}.npy")
        rows = dict(records(d))
    for n, points in found.items():
        first = n * (n - 1) // 2
        sets[first : first + n] = points
        rows[n] = Record(star_discrepancy(points), FINDER, points.hash)
    FOLDER.mkdir(exist_ok=True)
    np.save(FOLDER / f"d{d:02d}.npy", sets)
    columns = ("n", "star", "found", "hash")
    lines = ({"n": n, "star": repr(row.value), "found": row.found, "hash": row.hash} for n, row in sorted(rows.items()))
    write_rows(FOLDER / f"d{d:02d}.csv", columns, lines)


def main() -> int:
    parser = parser_of(__doc__)
    parser.add_argument("-d", type=int, nargs="*", default=[2, 3])
    parser.add_argument("--search", type=int, nargs=2, metavar=("FIRST", "LAST"), help="numbers of points")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--from-random", type=int, metavar="N", help="number of points")
    options = parser.parse_args()
    if options.from_random:
        print_from_random(options.from_random)
        return 0
    if not options.search:
        return int(sum(check(d) for d in options.d) > 0)
    first, last = options.search
    for d in options.d:
        kept = {n: record.value for n, record in records(d).items()}
        found = {}
        for n in range(first, min(last, LARGEST) + 1):
            points = searched(n, d, options.seed)
            value = star_discrepancy(points)
            if value < kept.get(n, np.inf):
                print(f"d={d} n={n}: {value:.6f}", flush=True)
                found[n] = points
        write_sets(d, found)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
